//! The few style properties that decide what is an outline: fill, its rule, and whether an element
//! is shown.

use crate::body::FillRule;
use roxmltree::Node;
use std::rc::Rc;

/// Properties that are read, also where they are given as attributes of these names.
const READ: &[&str] = &[
    "fill",
    "fill-opacity",
    "fill-rule",
    "display",
    "visibility",
    "clip-path",
    "mask",
];

/// Properties of sheets and of style attributes that would move or shape an element, but are not
/// read.
const UNREAD: &[&str] = &[
    "all",
    "transform",
    "transform-origin",
    "translate",
    "rotate",
    "scale",
    "d",
    "x",
    "y",
    "width",
    "height",
    "cx",
    "cy",
    "r",
    "rx",
    "ry",
];

/// Inherited properties.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Style {
    filled: bool,
    rule: FillRule,
    invisible: bool,
    /// Nothing of the element is drawn.
    pub(super) hidden: bool,
}

impl Default for Style {
    /// The defaults of SVG: filled, by the nonzero rule.
    fn default() -> Style {
        Style {
            filled: true,
            rule: FillRule::NonZero,
            invisible: false,
            hidden: false,
        }
    }
}

impl Style {
    /// The style of an element inside an element of this style.
    pub(super) fn inherited(self, node: &Node<'_, '_>, properties: &Properties<'_>) -> Style {
        let mut style = self;
        match properties.get("fill").as_deref() {
            None | Some("inherit" | "unset") => {}
            Some(paint) => style.filled = !matches!(paint, "none" | "transparent"),
        }
        let opacity = properties.get("fill-opacity");
        if opacity.is_some_and(|value| value.trim_end_matches('%').parse::<f64>() == Ok(0.0)) {
            style.filled = false;
        }
        match properties.get("fill-rule").as_deref() {
            Some("evenodd") => style.rule = FillRule::EvenOdd,
            Some("nonzero" | "initial") => style.rule = FillRule::NonZero,
            _ => {}
        }
        match properties.get("visibility").as_deref() {
            Some("hidden" | "collapse") => style.invisible = true,
            Some("visible" | "initial") => style.invisible = false,
            _ => {}
        }
        // Elements in a group that is not displayed are not displayed either; elements in an
        // invisible one may be visible.
        let is_group = matches!(node.tag_name().name(), "g" | "a" | "svg");
        style.hidden = self.hidden
            || properties.get("display").as_deref() == Some("none")
            || (style.invisible && !is_group);
        style
    }

    /// The rule by which an element of this style is filled.
    pub(super) fn fill(self) -> Option<FillRule> {
        self.filled.then_some(self.rule)
    }
}

/// A property that decides what is an outline, and its value as written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Declaration<'a> {
    /// Its index among the known properties, see [`known`].
    property: usize,
    value: &'a str,
    important: bool,
}

/// What a selector says about the elements that it matches.
pub(super) struct Rule<'a> {
    /// The numbers of ids, of classes and of names in the selector. Of two rules, the one with the
    /// larger first number that differs takes precedence.
    pub(super) specificity: [u32; 3],
    /// The declarations that decide what is an outline, shared by the selectors of a list.
    pub(super) declarations: Rc<[Declaration<'a>]>,
}

/// Number of properties that decide what is an outline.
const KNOWN: usize = READ.len() + UNREAD.len();

/// The index of a property among those that are read and those that are not.
fn known(name: &str) -> Option<usize> {
    let mut names = READ.iter().chain(UNREAD);
    names.position(|known| known.eq_ignore_ascii_case(name))
}

/// Decides which of two declarations counts: first important ones, then style attributes, then the
/// more specific selector.
type Priority = (bool, bool, [u32; 3]);

/// What is declared for one element itself, without inheritance.
pub(super) struct Properties<'a> {
    attributes: Vec<(&'a str, &'a str)>,
    /// Per known property, the declaration that counts among those of the sheets and the style
    /// attribute.
    declared: [Option<(Priority, &'a str)>; KNOWN],
}

impl<'a> Properties<'a> {
    /// - `rules`: those that match the element, in the order of the file.
    /// - `style`: the style attribute of the element, without comments.
    pub(super) fn of(
        node: &Node<'a, '_>,
        rules: impl Iterator<Item = &'a Rule<'a>>,
        style: &'a str,
    ) -> Properties<'a> {
        let attributes = READ
            .iter()
            .filter_map(|&name| Some((name, node.attribute(name)?)));
        let mut properties = Properties {
            attributes: attributes.collect(),
            declared: [None; KNOWN],
        };
        for rule in rules {
            for declaration in &*rule.declarations {
                properties.declare(declaration, false, rule.specificity);
            }
        }
        for declaration in declarations(style) {
            properties.declare(&declaration, true, [0; 3]);
        }
        properties
    }

    /// Takes a declaration into account; of equals the last one counts.
    fn declare(&mut self, declaration: &Declaration<'a>, in_style: bool, specificity: [u32; 3]) {
        let priority = (declaration.important, in_style, specificity);
        let declared = &mut self.declared[declaration.property];
        if declared.is_none_or(|(other, _)| other <= priority) {
            *declared = Some((priority, declaration.value));
        }
    }

    /// The value of a property in lower case: from the sheets and the style attribute, or else from
    /// the attribute of that name.
    pub(super) fn get(&self, name: &str) -> Option<String> {
        let value = self.declared(name).or_else(|| {
            let mut attributes = self.attributes.iter();
            Some(attributes.find(|(key, _)| *key == name)?.1)
        });
        value.map(|value| value.trim().to_ascii_lowercase())
    }

    /// The value of a property that the sheets or the style attribute declare.
    fn declared(&self, name: &str) -> Option<&'a str> {
        Some(self.declared[known(name)?]?.1)
    }

    /// What the sheets or the style attribute declare and this reader cannot take into account, in
    /// words.
    ///
    /// - `is_root`: for the root, place and size on a page or a screen do not matter, since they
    ///   are not those of the body.
    pub(super) fn unread(&self, is_root: bool) -> Option<String> {
        let on_page = |name: &&&str| is_root && ["x", "y", "width", "height"].contains(*name);
        let mut names = UNREAD.iter().filter(|name| !on_page(name));
        if let Some(name) = names.find(|name| self.declared(name).is_some()) {
            return Some(format!("with {name} in its style"));
        }
        let computed = |name: &&&str| self.get(name).is_some_and(|value| value.contains("var("));
        let name = READ.iter().find(computed)?;
        Some(format!("with a variable as {name}"))
    }
}

/// Whether a text declares anything that decides what is an outline, in blocks or not.
pub(super) fn decides(text: &str) -> bool {
    text.split(['{', '}', ';'])
        .filter_map(|part| part.split_once(':'))
        .any(|(name, _)| known(name.trim()).is_some())
}

/// The declarations of a list that decide what is an outline, in their order.
fn declarations(style: &str) -> impl Iterator<Item = Declaration<'_>> {
    style.split(';').filter_map(|text| {
        let (name, value) = text.split_once(':')?;
        let (value, important) = match value.rsplit_once('!') {
            Some((value, word)) if word.trim().eq_ignore_ascii_case("important") => (value, true),
            _ => (value, false),
        };
        Some(Declaration {
            property: known(name.trim())?,
            value: value.trim(),
            important,
        })
    })
}

/// The declarations of a list that can count: per property, the last important one and the last
/// other one.
pub(super) fn last_declarations(style: &str) -> Vec<Declaration<'_>> {
    let mut last: Vec<Declaration<'_>> = Vec::new();
    for declaration in declarations(style) {
        last.retain(|other| {
            (other.property, other.important) != (declaration.property, declaration.important)
        });
        last.push(declaration);
    }
    last
}

/// A CSS text with blanks in place of its comments; line breaks stay.
pub(super) fn without_comments(text: &str) -> String {
    let mut result = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find("/*") {
        result.push_str(&rest[..start]);
        let end = rest[start + 2..]
            .find("*/")
            .map_or(rest.len(), |end| start + 2 + end + 2);
        result.push(' ');
        result.extend(rest[start..end].chars().filter(|&c| c == '\n'));
        rest = &rest[end..];
    }
    result + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use roxmltree::Document;

    #[test]
    fn declarations_are_read_with_their_importance() {
        let style = without_comments(
            "fill:red; stroke : #000; DISPLAY: none;/* fill:\nblue; */fill: none !important;fill:blue",
        );
        let read = |d: Declaration<'_>| (READ[d.property], d.value.to_owned(), d.important);
        let found: Vec<_> = declarations(&style).map(read).collect();
        let expected = [
            ("fill", "red", false),
            ("display", "none", false),
            ("fill", "none", true),
            ("fill", "blue", false),
        ]
        .map(|(name, value, important)| (name, value.to_owned(), important));
        assert_eq!(found, expected);
        let found: Vec<_> = last_declarations(&style).into_iter().map(read).collect();
        assert_eq!(
            found,
            expected[1..],
            "of the two plain fills the last counts"
        );
        assert_eq!(style.matches('\n').count(), 1, "lines stay lines");
    }

    #[test]
    fn styles_come_before_attributes_and_are_inherited() {
        let text = r#"<g fill="none" fill-rule="evenodd"><path style="fill:#123" fill="none"/><path/></g>"#;
        let document = Document::parse(text).expect("XML");
        let style = |around: Style, node: &Node<'_, '_>| {
            let attribute = node.attribute("style").unwrap_or_default();
            around.inherited(node, &Properties::of(node, std::iter::empty(), attribute))
        };
        let group = style(Style::default(), &document.root_element());
        let fills: Vec<_> = document
            .root_element()
            .children()
            .map(|child| style(group, &child).fill())
            .collect();
        assert_eq!(fills, [Some(FillRule::EvenOdd), None]);
    }
}
