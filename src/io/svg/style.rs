//! The few properties of style that say what is an outline: fill, its rule, and whether an element is shown.

use crate::body::FillRule;
use roxmltree::Node;

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
    /// As SVG has it: filled, by the nonzero rule.
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
    /// The style of an element inside one of this style.
    pub(super) fn inherited(self, node: &Node<'_, '_>) -> Style {
        let mut style = self;
        match property(node, "fill") {
            None | Some("inherit") => {}
            Some(paint) => style.filled = !matches!(paint, "none" | "transparent"),
        }
        if property(node, "fill-opacity").and_then(|value| value.parse::<f64>().ok()) == Some(0.0) {
            style.filled = false;
        }
        match property(node, "fill-rule") {
            Some("evenodd") => style.rule = FillRule::EvenOdd,
            Some("nonzero") => style.rule = FillRule::NonZero,
            _ => {}
        }
        match property(node, "visibility") {
            Some("hidden" | "collapse") => style.invisible = true,
            Some("visible") => style.invisible = false,
            _ => {}
        }
        // What is in a group that is not displayed is not displayed either; what is in an invisible one may be visible.
        let is_group = matches!(node.tag_name().name(), "g" | "a" | "svg");
        style.hidden = self.hidden
            || property(node, "display") == Some("none")
            || (style.invisible && !is_group);
        style
    }

    /// The rule by which an element of this style is filled.
    pub(super) fn fill(self) -> Option<FillRule> {
        self.filled.then_some(self.rule)
    }
}

/// A property of an element, from its style or else its attribute.
pub(super) fn property<'a>(node: &Node<'a, '_>, name: &str) -> Option<&'a str> {
    let from_style = node
        .attribute("style")
        .and_then(|style| declaration(style, name));
    from_style.or_else(|| node.attribute(name).map(str::trim))
}

/// The value of a property in a list of declarations; the last one counts.
pub(super) fn declaration<'a>(style: &'a str, name: &str) -> Option<&'a str> {
    let declarations = style
        .split(';')
        .filter_map(|declaration| declaration.split_once(':'));
    let values = declarations
        .filter(|(key, _)| key.trim() == name)
        .map(|(_, value)| value);
    values
        .last()
        .map(|value| value.trim().trim_end_matches("!important").trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_declaration_of_a_style_counts() {
        let style = "fill:red; stroke : #000;fill: none !important";
        assert_eq!(declaration(style, "fill"), Some("none"));
        assert_eq!(declaration(style, "stroke"), Some("#000"));
        assert_eq!(declaration(style, "strok"), None);
    }

    #[test]
    fn styles_come_before_attributes_and_are_inherited() {
        let text = r#"<g fill="none" fill-rule="evenodd"><path style="fill:#123" fill="none"/><path/></g>"#;
        let document = roxmltree::Document::parse(text).expect("XML");
        let group = Style::default().inherited(&document.root_element());
        let fills: Vec<_> = document
            .root_element()
            .children()
            .map(|child| group.inherited(&child).fill())
            .collect();
        assert_eq!(fills, [Some(FillRule::EvenOdd), None]);
    }
}
