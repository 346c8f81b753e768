//! SVG: the curves of its shapes, in user units, with y as in the file.

mod cost;
mod lines;
mod path;
mod selector;
mod shapes;
mod sheet;
mod style;

use super::drawing::{Figure, LeftOut, Sketch};
use super::drawing_error::{FigurePlace, refuse_unsupported};
use super::error::{EXPORT_AGAIN, InputProblem, Place, quote};
use super::units::{DeclaredUnit, Unit};
use glam::{DAffine2, DVec2};
use lines::Lines;
use roxmltree::{Document, Node, ParsingOptions};
use selector::{Meetings, Rules};
use std::collections::BTreeMap;
use std::str::FromStr;
use style::{Properties, Style};

/// Namespace of SVG elements.
const SVG: &str = "http://www.w3.org/2000/svg";

/// Attribute by which our own files mark the elements that are no part of the region.
pub(super) const MARK: &str = "data-steadysweep";

/// Value of [`MARK`] for poses, trajectories and texts around the region.
pub(super) const PICTURE: &str = "picture";

/// Value of [`MARK`] for a group whose transform only turns the picture, so that y is up on the
/// screen.
pub(super) const UPRIGHT: &str = "upright";

/// Relative difference from 1 below which the size of a user unit is taken for rounding of the
/// width and the viewBox.
const UNIT_FACTOR_ROUNDING: f64 = 1e-9;

/// Most conditions of style sheets that are compared with elements: about a second. A sheet of a
/// thousand classes and a drawing of a hundred thousand elements take less than a hundredth of it.
const MOST_STYLE: u64 = 100_000_000;

/// Elements that draw nothing by themselves.
const SILENT: &[&str] = &[
    "title",
    "desc",
    "metadata",
    "defs",
    "symbol",
    "clipPath",
    "mask",
    "marker",
    "pattern",
    "linearGradient",
    "radialGradient",
    "filter",
    "script",
    "style",
    "view",
    "font",
    "font-face",
    "cursor",
    "color-profile",
];

/// Elements that are by their nature no outline.
const ANNOTATION: &[&str] = &["text", "image"];

/// Reads the figures of an SVG.
pub(super) fn read(bytes: &[u8]) -> Result<Sketch, InputProblem> {
    let text = text(bytes)?;
    cost::check(text)?;
    let options = ParsingOptions {
        allow_dtd: true,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(text, options).map_err(|error| {
        let at = error.pos();
        InputProblem::Malformed {
            place: Place::LineColumn(at.row as usize, at.col as usize),
            expected: "XML".to_owned(),
            found: error.to_string(),
            remedy: EXPORT_AGAIN,
        }
    })?;
    let root = document.root_element();
    let lines = Lines::of(document.input_text());
    let sheets = sheet::sources(&document, &lines)?;
    let rules = sheet::rules(&sheets)?;
    let meetings =
        selector::meetings(&document, &rules, MOST_STYLE).ok_or_else(|| InputProblem::TooMuch {
            place: Place::File,
            what:
                "to apply the style sheets, selectors and declarations would be looked at too often"
                    .to_owned(),
            limit: MOST_STYLE,
            remedy: sheet::REMEDY,
        })?;
    let mut reader = Reader {
        lines: &lines,
        rules: &rules,
        meetings: &meetings,
        figures: Vec::new(),
        unsupported: BTreeMap::new(),
        left_out: LeftOut::default(),
    };
    if root.tag_name().name() != "svg" {
        return Err(reader.malformed(root, "an svg element at the root", root.tag_name().name()));
    }
    let declared = reader.declared(root)?;
    reader.walk(root)?;
    let Reader {
        figures,
        unsupported,
        left_out,
        ..
    } = reader;
    refuse_unsupported(unsupported)?;
    Ok(Sketch {
        figures,
        declared,
        notes: left_out.notes(),
    })
}

fn text(bytes: &[u8]) -> Result<&str, InputProblem> {
    let problem = |expected: &str, found: String, remedy| {
        Err(InputProblem::Malformed {
            place: Place::File,
            expected: expected.to_owned(),
            found,
            remedy,
        })
    };
    if bytes.starts_with(&[0x1f, 0x8b]) {
        return problem(
            "an SVG as text",
            "a compressed one".to_owned(),
            "decompress it (gunzip) first",
        );
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.trim_start_matches('\u{feff}')),
        Err(error) => problem(
            "text in UTF-8",
            format!("another byte sequence at byte {}", error.valid_up_to()),
            "save the file in UTF-8",
        ),
    }
}

/// What an element inherits from those around it.
#[derive(Clone, Copy)]
struct Context {
    map: DAffine2,
    style: Style,
}

struct Reader<'a> {
    lines: &'a Lines,
    rules: &'a Rules<'a>,
    meetings: &'a Meetings,
    figures: Vec<Figure>,
    /// Lines of the file, by the kind of element.
    unsupported: BTreeMap<String, Vec<usize>>,
    left_out: LeftOut,
}

impl Reader<'_> {
    fn walk(&mut self, root: Node<'_, '_>) -> Result<(), InputProblem> {
        let mut open = vec![(
            root,
            Context {
                map: DAffine2::IDENTITY,
                style: Style::default(),
            },
        )];
        while let Some((node, around)) = open.pop() {
            if !matches!(node.tag_name().namespace(), None | Some(SVG)) {
                continue;
            }
            let name = node.tag_name().name();
            if SILENT.contains(&name) {
                continue;
            }
            if node.attribute(MARK) == Some(PICTURE) {
                self.left_out.add(
                    "group of the picture that steadysweep drew around the region",
                    "groups of the picture that steadysweep drew around the region",
                );
                continue;
            }
            let attribute = style::without_comments(node.attribute("style").unwrap_or_default());
            let met = self.meetings.of(&node).iter();
            let rules = met.map(|&selector| &self.rules.said[selector as usize]);
            let properties = Properties::of(&node, rules, &attribute);
            let style = around.style.inherited(&node, &properties);
            if style.hidden {
                self.left_out.add(
                    "element that is not displayed",
                    "elements that are not displayed",
                );
                continue;
            }
            if ANNOTATION.contains(&name) {
                let [one, several] = if name == "text" {
                    ["text element", "text elements"]
                } else {
                    ["image", "images"]
                };
                self.left_out.add(one, several);
                continue;
            }
            for attribute in ["clip-path", "mask"] {
                if properties
                    .get(attribute)
                    .is_some_and(|value| value != "none")
                {
                    self.refuse(&node, format!("{name} with {attribute}"));
                }
            }
            if node.attribute("transform-origin").is_some() {
                self.refuse(&node, format!("{name} with transform-origin"));
            }
            if let Some(what) = properties.unread(node == root) {
                self.refuse(&node, format!("{name} {what}"));
            }
            let context = Context {
                map: around.map * self.transform(&node)?,
                style,
            };
            match name {
                "g" | "a" => {}
                "svg" if node == root => {}
                "path" | "rect" | "circle" | "ellipse" | "line" | "polyline" | "polygon" => {
                    self.shape(node, &context)?;
                    continue;
                }
                other => {
                    self.refuse(&node, other.to_owned());
                    continue;
                }
            }
            let children: Vec<Node<'_, '_>> = node.children().filter(Node::is_element).collect();
            open.extend(children.into_iter().rev().map(|child| (child, context)));
        }
        Ok(())
    }

    fn shape(&mut self, node: Node<'_, '_>, context: &Context) -> Result<(), InputProblem> {
        let mut paths = shapes::paths(self, &node)?;
        for curve in paths.iter_mut().flat_map(|path| &mut path.curves) {
            *curve = curve.transformed(&context.map);
        }
        if paths.is_empty() {
            return Ok(());
        }
        // A line has no interior to fill.
        let fill = context
            .style
            .fill()
            .filter(|_| node.tag_name().name() != "line");
        let place = FigurePlace {
            line: self.line(&node),
            name: name_of(&node),
        };
        self.figures.push(Figure { place, paths, fill });
        Ok(())
    }

    fn refuse(&mut self, node: &Node<'_, '_>, kind: String) {
        let line = self.line(node);
        self.unsupported.entry(kind).or_default().push(line);
    }

    fn line(&self, node: &Node<'_, '_>) -> usize {
        self.lines.at(node.range().start)
    }

    fn malformed(
        &self,
        node: Node<'_, '_>,
        expected: impl Into<String>,
        found: &str,
    ) -> InputProblem {
        InputProblem::Malformed {
            place: Place::Line(self.line(&node)),
            expected: expected.into(),
            found: quote(found),
            remedy: EXPORT_AGAIN,
        }
    }

    fn transform(&self, node: &Node<'_, '_>) -> Result<DAffine2, InputProblem> {
        if node.attribute(MARK) == Some(UPRIGHT) {
            return Ok(DAffine2::IDENTITY);
        }
        let Some(text) = node
            .attribute("transform")
            .filter(|text| !text.trim().is_empty())
        else {
            return Ok(DAffine2::IDENTITY);
        };
        match svgtypes::Transform::from_str(text) {
            Ok(t) => Ok(DAffine2::from_cols_array(&[t.a, t.b, t.c, t.d, t.e, t.f])),
            Err(_) => Err(self.malformed(*node, "a transform", text)),
        }
    }

    /// A length in user units.
    fn length(&self, node: &Node<'_, '_>, attribute: &str) -> Result<Option<f64>, InputProblem> {
        let Some(text) = node.attribute(attribute) else {
            return Ok(None);
        };
        if text.trim() == "auto" {
            return Ok(None);
        }
        let length = svgtypes::Length::from_str(text.trim()).ok();
        let relative = length.filter(|length| in_user_units(length.unit).is_none());
        let user = length.and_then(|length| Some(length.number * in_user_units(length.unit)?));
        let is_size = ["width", "height", "r", "rx", "ry"].contains(&attribute);
        match user.filter(|value| value.is_finite()) {
            Some(value) if value < 0.0 && is_size => {
                let expected = format!("a length that is not negative as {attribute}");
                Err(self.malformed(*node, expected, text))
            }
            Some(value) => Ok(Some(value)),
            None if relative.is_some() => Err(InputProblem::Malformed {
                place: Place::Line(self.line(node)),
                expected: format!("a length in user units, mm, cm, in, pt or pc as {attribute}"),
                found: quote(text),
                remedy: "lengths relative to a page or a font (%, em, ex) are not supported: write it in user units",
            }),
            None => Err(self.malformed(
                *node,
                format!("a length in user units, mm, cm, in, pt or pc as {attribute}"),
                text,
            )),
        }
    }

    /// The physical size of a user unit, from width, height and viewBox.
    fn declared(&self, root: Node<'_, '_>) -> Result<Option<DeclaredUnit>, InputProblem> {
        let size = |attribute: &str| {
            let length = svgtypes::Length::from_str(root.attribute(attribute)?.trim()).ok()?;
            Some((length.number, physical(length.unit)?))
                .filter(|(number, _)| *number > 0.0 && number.is_finite())
        };
        let view = match root.attribute("viewBox") {
            None => None,
            Some(text) => match svgtypes::ViewBox::from_str(text) {
                Ok(view) => Some(view),
                Err(_) => {
                    return Err(self.malformed(
                        root,
                        "a viewBox of four numbers, the last two above 0",
                        text,
                    ));
                }
            },
        };
        let Some((width, unit)) = size("width").or(size("height")) else {
            return Ok(None);
        };
        let Some(view) = view else {
            // Without a viewBox a user unit is a pixel of CSS.
            return Ok(Some(DeclaredUnit {
                unit: Unit::Inch,
                factor: 1.0 / 96.0,
            }));
        };
        let across = if size("width").is_some() {
            width / view.w
        } else {
            width / view.h
        };
        // The drawing keeps its proportions and fits in width and in height.
        let along = size("height")
            .map(|(height, other)| height * other.millimetres() / unit.millimetres() / view.h);
        let factor = along.map_or(across, |along| across.min(along));
        let factor = if (factor - 1.0).abs() < UNIT_FACTOR_ROUNDING {
            1.0
        } else {
            factor
        };
        Ok(Some(DeclaredUnit { unit, factor }))
    }
}

fn physical(unit: svgtypes::LengthUnit) -> Option<Unit> {
    match unit {
        svgtypes::LengthUnit::In => Some(Unit::Inch),
        svgtypes::LengthUnit::Cm => Some(Unit::Centimetre),
        svgtypes::LengthUnit::Mm => Some(Unit::Millimetre),
        svgtypes::LengthUnit::Pt => Some(Unit::Point),
        svgtypes::LengthUnit::Pc => Some(Unit::Pica),
        // Pixels and plain numbers say nothing about the size of a part; the others depend on a
        // font or a window.
        _ => None,
    }
}

fn in_user_units(unit: svgtypes::LengthUnit) -> Option<f64> {
    match unit {
        svgtypes::LengthUnit::None | svgtypes::LengthUnit::Px => Some(1.0),
        // A user unit is a pixel of CSS, 1/96 in.
        other => physical(other).map(|unit| unit.millimetres() / 25.4 * 96.0),
    }
}

/// The element and its id.
fn name_of(node: &Node<'_, '_>) -> String {
    let name = node.tag_name().name();
    match node.attribute("id") {
        Some(id) => format!("{name} {}", quote(id)),
        None => name.to_owned(),
    }
}

fn point(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}
