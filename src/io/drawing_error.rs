//! Why a drawing makes no planar body.

use super::units::Unit;
use crate::body::{PolygonError, PolylineError};
use crate::numeric::Readable;
use glam::DVec2;
use std::collections::{BTreeMap, HashMap};
use std::fmt;

/// Most ends, kinds or lines that a message lists.
const LISTED: usize = 6;

/// An element of an SVG or an entity of a DXF.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FigurePlace {
    /// Line of the file at which it begins, counted from 1.
    pub line: usize,
    /// Its kind and its name in the file, such as `path "rim"` or `ARC (handle 2F)`.
    pub name: String,
}

/// An end of a curve at which no other curve continues, or more than one.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenEnd {
    /// The figure to which the curve belongs.
    pub figure: FigurePlace,
    /// Position of the end.
    pub at: DVec2,
    /// Number of ends that meet there, this one included: 1, or an odd number from 3 on, where the
    /// outline branches.
    pub meeting: usize,
    /// Distance to the nearest other open end; `None` where there is none or where the outline
    /// branches.
    pub gap: Option<f64>,
}

/// Figures of one kind that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnsupportedKind {
    /// The element or entity, as the file calls it, and what is not supported about it.
    pub kind: String,
    /// Lines of the file at which they begin.
    pub lines: Vec<usize>,
}

/// Why a drawing was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DrawingError {
    /// Nothing in the file draws a line.
    #[error(
        "the drawing is empty: expected {expected}, found {found}; draw the closed outline of the body"
    )]
    Empty {
        /// What can be read instead.
        expected: &'static str,
        /// What the file holds.
        found: String,
    },
    /// Curves whose ends meet no other end, or an even number of others.
    #[error("{}", OpenEnds(ends, *.distance))]
    Open {
        /// The ends, in the order of the file.
        ends: Vec<OpenEnd>,
        /// Distance within which ends are joined.
        distance: f64,
    },
    /// What was read as lines is none.
    #[error(transparent)]
    Lines(#[from] PolylineError),
    /// Figures that cannot be read.
    #[error("{}", Unsupported(.0))]
    Unsupported(Vec<UnsupportedKind>),
    /// Two outlines cross, or one crosses itself.
    #[error(
        "the outline crosses itself at ({}, {}): {} crosses {}; separate the two, or unite the areas that overlap",
        Readable(at.x), Readable(at.y), figures[0], if figures[0] == figures[1] { "itself".to_owned() } else { figures[1].to_string() }
    )]
    Crossing {
        /// The figures, in the order of the file.
        figures: Box<[FigurePlace; 2]>,
        /// Where.
        at: DVec2,
    },
    /// An outline is partly inside another one, whose border it passes at corners or along edges.
    #[error(
        "the outlines overlap: {figure} is inside of another outline from ({}, {}) on, and outside elsewhere; separate the two, or unite \
         the areas that overlap",
        Readable(at.x), Readable(at.y)
    )]
    Overlap {
        /// The figure.
        figure: FigurePlace,
        /// Where.
        at: DVec2,
    },
    /// A coordinate is not finite, or too large for the computation.
    #[error("{figure} reaches ({}, {}): coordinates must be finite and not exceed 1e18; correct the place or choose a larger unit",
        Readable(at.x), Readable(at.y))]
    Coordinate {
        /// The figure.
        figure: FigurePlace,
        /// The coordinates.
        at: DVec2,
    },
    /// The outlines make no body for another reason.
    #[error("{0}")]
    Polygon(PolygonError),
    /// The polylines would have too many corners.
    #[error(
        "{figure}: with curves flattened to within {flattening:e} the drawing has more than {limit} corners; use a larger \
         tolerance"
    )]
    TooFine {
        /// The figure at which the limit is reached.
        figure: FigurePlace,
        /// Distance allowed between a curve and its chords.
        flattening: f64,
        /// Largest number of corners.
        limit: usize,
    },
    /// Too many pairs of open ends are near enough to each other for a line.
    #[error(
        "gaps up to {} are to be closed, but more than {limit} pairs of open ends are that near to each other; allow shorter lines \
         (--close-gaps LEN)",
        Readable(*.length)
    )]
    TooManyGaps {
        /// Longest gap that was to be closed.
        length: f64,
        /// Largest number of pairs.
        limit: usize,
    },
    /// A unit was asked for, but the file does not say which one its lengths are in.
    #[error(
        "lengths cannot be changed to {asked}: the file does not say which unit they are in; leave the option out, or declare the \
         unit in the program that wrote the file"
    )]
    UnknownUnit {
        /// The unit that was asked for.
        asked: Unit,
    },
}

impl fmt::Display for FigurePlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} at line {}", self.name, self.line)
    }
}

struct OpenEnds<'a>(&'a [OpenEnd], f64);

impl fmt::Display for OpenEnds<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let OpenEnds(all, distance) = self;
        let ends: Vec<&OpenEnd> = all.iter().filter(|end| end.meeting == 1).collect();
        if ends.len() < all.len() {
            write_branches(f, all)?;
            if ends.is_empty() {
                return Ok(());
            }
            f.write_str("\n")?;
        }
        let count = match ends.len() {
            1 => "one end meets".to_owned(),
            many => format!("{many} ends meet"),
        };
        write!(
            f,
            "the outline is open: {count} no other within {}:",
            Readable(*distance)
        )?;
        for end in ends.iter().take(LISTED) {
            write!(
                f,
                "\n  {} ends at ({}, {})",
                end.figure,
                Readable(end.at.x),
                Readable(end.at.y)
            )?;
            if let Some(gap) = end.gap {
                write!(f, ", {} from the nearest other open end", Readable(gap))?;
            }
        }
        if ends.len() > LISTED {
            write!(f, "\n  and {} more", ends.len() - LISTED)?;
        }
        write!(
            f,
            "\nclose the gaps in the drawing, or allow straight lines across them (--close-gaps LEN); remove lines that bound \
             nothing (axes, marks, frames)"
        )
    }
}

/// The places at which three or more curves meet, with the figures that may be one too many there.
fn write_branches(f: &mut fmt::Formatter<'_>, ends: &[OpenEnd]) -> fmt::Result {
    let mut places: Vec<(DVec2, Vec<&FigurePlace>)> = Vec::new();
    let mut number_of: HashMap<[u64; 2], usize> = HashMap::new();
    for end in ends.iter().filter(|end| end.meeting > 1) {
        let number = *number_of
            .entry(end.at.to_array().map(f64::to_bits))
            .or_insert(places.len());
        if number == places.len() {
            places.push((end.at, Vec::new()));
        }
        places[number].1.push(&end.figure);
    }
    write!(
        f,
        "the outline branches, three or more curves meet at one place:"
    )?;
    for (at, figures) in places.iter().take(LISTED) {
        let names: Vec<String> = figures
            .iter()
            .take(LISTED)
            .map(|figure| figure.to_string())
            .collect();
        write!(
            f,
            "\n  {} at ({}, {}): {}{}",
            figures.len(),
            Readable(at.x),
            Readable(at.y),
            names.join(", "),
            if figures.len() > LISTED { ", ..." } else { "" }
        )?;
    }
    if places.len() > LISTED {
        write!(f, "\n  and {} more", places.len() - LISTED)?;
    }
    write!(
        f,
        "\nremove the curves that divide the body or stick out of it"
    )?;
    // A curve that leads from one such place to another, or to a free end, can be removed without
    // leaving anything open.
    let mut seen: HashMap<usize, usize> = HashMap::new();
    let surplus = ends
        .iter()
        .filter(|end| {
            let count = seen.entry(end.figure.line).or_default();
            *count += 1;
            *count == 2
        })
        .take(LISTED)
        .map(|end| end.figure.to_string())
        .collect::<Vec<String>>();
    if !surplus.is_empty() {
        write!(f, ", perhaps {}", surplus.join(", "))?;
    }
    Ok(())
}

/// Refuses a drawing with figures that cannot be read, and names the lines of the file at which
/// those of each kind begin.
pub(super) fn refuse_unsupported(found: BTreeMap<String, Vec<usize>>) -> Result<(), DrawingError> {
    if found.is_empty() {
        return Ok(());
    }
    let kinds = found
        .into_iter()
        .map(|(kind, lines)| UnsupportedKind { kind, lines });
    Err(DrawingError::Unsupported(kinds.collect()))
}

struct Unsupported<'a>(&'a [UnsupportedKind]);

impl fmt::Display for Unsupported<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the drawing has figures that cannot be read:")?;
        for UnsupportedKind { kind, lines } in self.0 {
            write!(
                f,
                "\n  {} {kind} at line{} ",
                lines.len(),
                if lines.len() == 1 { "" } else { "s" }
            )?;
            for (i, line) in lines.iter().take(LISTED).enumerate() {
                write!(f, "{}{line}", if i == 0 { "" } else { ", " })?;
            }
            if lines.len() > LISTED {
                write!(f, ", ...")?;
            }
        }
        write!(
            f,
            "\nconvert them to lines, arcs or curves in the program that wrote the file, or remove them"
        )
    }
}
