//! Selectors of style sheets, and which of them match which elements of a document.

use super::style::Rule;
use crate::numeric::index;
use roxmltree::{Document, Node};
use simplecss::{AttributeOperator, SelectorToken, SelectorTokenizer};
use std::collections::HashMap;

/// A selector: one condition for each step down to the element that it matches.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Selector<'a> {
    /// At least one; the last is the condition on the element itself.
    compounds: Vec<Compound<'a>>,
}

/// The condition on one element, and its relation to the element of the compound before.
#[derive(Debug, Clone, PartialEq)]
struct Compound<'a> {
    relation: Relation,
    name: Option<&'a str>,
    conditions: Vec<Condition<'a>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Relation {
    /// The first compound of a selector, wherever the element stands.
    Anywhere,
    Descendant,
    Child,
    NextSibling,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Condition<'a> {
    Id(&'a str),
    Class(&'a str),
    Attribute(&'a str, AttributeOperator<'a>),
    FirstChild,
    /// A state of a page on a screen, which no element of a file is ever in.
    Never,
}

/// The property of an element by which the compounds that can match it are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Key<'a> {
    Id(&'a str),
    Class(&'a str),
    Name(&'a str),
    Any,
}

impl<'a> Selector<'a> {
    /// `None` when it is not understood.
    pub(super) fn parse(text: &'a str) -> Option<Selector<'a>> {
        let mut compounds: Vec<Compound<'a>> = Vec::new();
        let mut relation = Some(Relation::Anywhere);
        for token in SelectorTokenizer::from(text) {
            let condition = match token.ok()? {
                SelectorToken::DescendantCombinator => {
                    relation = Some(Relation::Descendant);
                    continue;
                }
                SelectorToken::ChildCombinator => {
                    relation = Some(Relation::Child);
                    continue;
                }
                SelectorToken::AdjacentCombinator => {
                    relation = Some(Relation::NextSibling);
                    continue;
                }
                SelectorToken::UniversalSelector => None,
                SelectorToken::TypeSelector(name) => {
                    compounds.push(Compound::new(relation.take()?, Some(name)));
                    continue;
                }
                SelectorToken::IdSelector(id) => Some(Condition::Id(id)),
                SelectorToken::ClassSelector(class) => Some(Condition::Class(class)),
                SelectorToken::AttributeSelector(name, operator) => {
                    Some(Condition::Attribute(name, operator))
                }
                SelectorToken::PseudoClass("first-child") => Some(Condition::FirstChild),
                SelectorToken::PseudoClass("hover" | "active" | "focus" | "visited") => {
                    Some(Condition::Never)
                }
                // Links and languages are not distinguished here.
                SelectorToken::PseudoClass(_) | SelectorToken::LangPseudoClass(_) => return None,
            };
            if let Some(relation) = relation.take() {
                compounds.push(Compound::new(relation, None));
            }
            compounds.last_mut()?.conditions.extend(condition);
        }
        let begins = compounds.first()?.relation == Relation::Anywhere;
        (begins && relation.is_none()).then_some(Selector { compounds })
    }

    /// The numbers of ids, of classes and the like, and of names.
    pub(super) fn specificity(&self) -> [u32; 3] {
        let mut specificity = [0; 3];
        for compound in &self.compounds {
            specificity[2] += u32::from(compound.name.is_some());
            for condition in &compound.conditions {
                specificity[usize::from(!matches!(condition, Condition::Id(_)))] += 1;
            }
        }
        specificity
    }
}

impl<'a> Compound<'a> {
    fn new(relation: Relation, name: Option<&'a str>) -> Compound<'a> {
        Compound {
            relation,
            name,
            conditions: Vec::new(),
        }
    }

    /// The rarest property that it requires.
    fn key(&self) -> Key<'a> {
        let id = self
            .conditions
            .iter()
            .find_map(|condition| match condition {
                Condition::Id(id) => Some(Key::Id(id)),
                _ => None,
            });
        let class = || {
            self.conditions
                .iter()
                .find_map(|condition| match condition {
                    Condition::Class(class) => Some(Key::Class(class)),
                    _ => None,
                })
        };
        id.or_else(class)
            .or(self.name.map(Key::Name))
            .unwrap_or(Key::Any)
    }
}

/// The rules in the sheets of a file that decide on outlines, in their order.
#[derive(Default)]
pub(super) struct Rules<'a> {
    pub(super) selectors: Vec<Selector<'a>>,
    /// One per selector.
    pub(super) said: Vec<Rule<'a>>,
}

/// Which selectors match which elements.
#[derive(Debug)]
pub(super) struct Meetings {
    /// Per node of the document, where its selectors begin in the list, and the end of the list.
    first: Vec<usize>,
    /// Numbers of selectors, ascending for each node.
    selectors: Vec<u32>,
}

impl Meetings {
    /// Numbers of the selectors that match an element, ascending.
    pub(super) fn of(&self, node: &Node<'_, '_>) -> &[u32] {
        let number = node.id().get_usize();
        &self.selectors[self.first[number]..self.first[number + 1]]
    }
}

/// An element between the root and the current place of the walk.
struct Open<'a, 'input> {
    node: Node<'a, 'input>,
    /// Compounds that match it, together with all that their selectors require before them;
    /// ascending.
    met: Vec<u32>,
    /// The same for its latest child element, if there was one.
    child: Option<Vec<u32>>,
}

/// Finds which selectors match which elements of a document.
///
/// One walk goes down from the root. At each element it examines the compounds that share a key
/// with the element. Such a compound matches when it fits the element, and when the compound before
/// it matched an ancestor, the parent or the previous sibling, which the walk has at hand. So no
/// path through the ancestors is tried twice.
///
/// `None` when more than `most` conditions and declarations of matching selectors would have to be
/// examined.
pub(super) fn meetings(document: &Document<'_>, rules: &Rules<'_>, most: u64) -> Option<Meetings> {
    let compounds = Compounds::of(&rules.selectors);
    let mut meetings = Meetings {
        first: vec![0],
        selectors: Vec::new(),
    };
    let mut looked_at = 0;
    // Per compound, how many open elements it matches.
    let mut open_with = vec![0u32; compounds.all.len()];
    let mut path: Vec<Open<'_, '_>> = Vec::new();
    for node in document.root().descendants().filter(Node::is_element) {
        while let Some(last) = path.pop_if(|last| Some(last.node) != node.parent_element()) {
            let parent = path.last_mut();
            for &compound in &last.met {
                open_with[compound as usize] -= 1;
            }
            if let Some(parent) = parent {
                parent.child = Some(last.met);
            }
        }
        let parent = path.last();
        let before = parent.and_then(|parent| parent.child.as_deref());
        let element = Element::new(node, before.is_none());
        let mut met = Vec::new();
        for &number in element.keys().flat_map(|key| compounds.with(key)) {
            let compound = compounds.all[number as usize];
            looked_at += element.cost(compound);
            if looked_at > most {
                return None;
            }
            let met_by = |others: Option<&[u32]>| {
                others.is_some_and(|others| others.binary_search(&(number - 1)).is_ok())
            };
            let is_reached = match compound.relation {
                Relation::Anywhere => true,
                Relation::Descendant => open_with[number as usize - 1] > 0,
                Relation::Child => met_by(parent.map(|parent| &*parent.met)),
                Relation::NextSibling => met_by(before),
            };
            if is_reached && element.fits(compound) {
                met.push(number);
            }
        }
        met.sort_unstable();
        meetings
            .first
            .resize(node.id().get_usize() + 1, meetings.selectors.len());
        for selector in met
            .iter()
            .filter_map(|&number| compounds.ends[number as usize])
        {
            meetings.selectors.push(selector);
            looked_at += rules.said[selector as usize].declarations.len() as u64;
        }
        if looked_at > most {
            return None;
        }
        for &compound in &met {
            open_with[compound as usize] += 1;
        }
        path.push(Open {
            node,
            met,
            child: None,
        });
    }
    let nodes = document.descendants().count();
    meetings.first.resize(nodes + 1, meetings.selectors.len());
    Some(meetings)
}

/// The compounds of all selectors, one after the other.
struct Compounds<'s, 'a> {
    all: Vec<&'s Compound<'a>>,
    /// Per compound, the selector of which it is the last.
    ends: Vec<Option<u32>>,
    by_key: HashMap<Key<'a>, Vec<u32>>,
}

impl<'s, 'a> Compounds<'s, 'a> {
    fn of(selectors: &'s [Selector<'a>]) -> Compounds<'s, 'a> {
        let mut compounds = Compounds {
            all: Vec::new(),
            ends: Vec::new(),
            by_key: HashMap::new(),
        };
        for (number, selector) in (0u32..).zip(selectors) {
            for compound in &selector.compounds {
                let place = index(compounds.all.len());
                compounds.all.push(compound);
                compounds.ends.push(None);
                compounds
                    .by_key
                    .entry(compound.key())
                    .or_default()
                    .push(place);
            }
            if let Some(end) = compounds.ends.last_mut() {
                *end = Some(number);
            }
        }
        compounds
    }

    fn with<'k>(&'k self, key: Key<'k>) -> &'k [u32] {
        self.by_key.get(&key).map_or(&[], Vec::as_slice)
    }
}

/// An element as selectors see it.
struct Element<'a, 'input> {
    node: Node<'a, 'input>,
    /// Ascending, all different.
    classes: Vec<&'a str>,
    attributes: usize,
    is_first_child: bool,
}

impl<'a, 'input> Element<'a, 'input> {
    fn new(node: Node<'a, 'input>, is_first_child: bool) -> Element<'a, 'input> {
        let classes = node.attribute("class").unwrap_or_default();
        let mut classes: Vec<&str> = classes.split_ascii_whitespace().collect();
        classes.sort_unstable();
        classes.dedup();
        Element {
            node,
            classes,
            attributes: node.attributes().len(),
            is_first_child,
        }
    }

    fn keys(&self) -> impl Iterator<Item = Key<'_>> {
        let id = self.node.attribute("id").map(Key::Id);
        let classes = self.classes.iter().map(|class| Key::Class(class));
        let name = Key::Name(self.node.tag_name().name());
        id.into_iter().chain(classes).chain([name, Key::Any])
    }

    fn fits(&self, compound: &Compound<'_>) -> bool {
        let has_name = compound
            .name
            .is_none_or(|name| self.node.tag_name().name() == name);
        has_name
            && compound.conditions.iter().all(|condition| match condition {
                Condition::Id(id) => self.node.attribute("id") == Some(*id),
                Condition::Class(class) => self.classes.binary_search(class).is_ok(),
                Condition::Attribute(name, operator) => {
                    let value = self.node.attribute(*name);
                    value.is_some_and(|value| operator.matches(value))
                }
                Condition::FirstChild => self.is_first_child,
                Condition::Never => false,
            })
    }

    /// Most comparisons that [`Element::fits`] can make.
    fn cost(&self, compound: &Compound<'_>) -> u64 {
        let of = |condition: &Condition<'_>| match condition {
            Condition::Id(_) => 1 + self.attributes,
            // The operators that search for words run through the value.
            Condition::Attribute(name, AttributeOperator::Contains(_)) => {
                1 + self.attributes + self.node.attribute(*name).map_or(0, str::len)
            }
            Condition::Attribute(..) => 1 + self.attributes,
            Condition::Class(_) | Condition::FirstChild | Condition::Never => 1,
        };
        1 + compound.conditions.iter().map(of).sum::<usize>() as u64
    }
}

#[cfg(test)]
mod tests {
    use super::super::style;
    use super::*;
    use crate::samples::random_below;
    use std::rc::Rc;

    fn rules<'a>(selectors: &[&'a str]) -> Rules<'a> {
        let parsed = selectors.iter().map(|text| Selector::parse(text));
        let selectors: Vec<Selector<'a>> = parsed.map(|found| found.expect("one")).collect();
        let said = selectors.iter().map(|selector| Rule {
            specificity: selector.specificity(),
            declarations: Rc::from(style::last_declarations("fill: none")),
        });
        Rules {
            said: said.collect(),
            selectors,
        }
    }

    /// An element as `simplecss` sees it, which tries every path through the ancestors.
    struct Slow<'a, 'input>(Node<'a, 'input>);

    impl simplecss::Element for Slow<'_, '_> {
        fn parent_element(&self) -> Option<Self> {
            self.0.parent_element().map(Slow)
        }
        fn prev_sibling_element(&self) -> Option<Self> {
            self.0.prev_sibling_element().map(Slow)
        }
        fn has_local_name(&self, name: &str) -> bool {
            self.0.tag_name().name() == name
        }
        fn attribute_matches(&self, name: &str, operator: AttributeOperator<'_>) -> bool {
            let value = self.0.attribute(name);
            value.is_some_and(|value| operator.matches(value))
        }
        fn pseudo_class_matches(&self, class: simplecss::PseudoClass<'_>) -> bool {
            class == simplecss::PseudoClass::FirstChild && self.0.prev_sibling_element().is_none()
        }
    }

    fn random(seed: u64) -> impl FnMut(usize) -> usize {
        let mut below = random_below(seed);
        move |limit| usize::try_from(below(limit as u64)).expect("31 bits")
    }

    #[test]
    fn selectors_meet_what_trying_all_ways_meets() {
        let mut random = random(5);
        let (mut met, mut passed_over) = (0, 0);
        for _ in 0..300 {
            let mut text = String::new();
            let mut open = Vec::new();
            for _ in 0..30 {
                if !open.is_empty() && random(3) == 0 {
                    let name = open.pop().expect("one is open");
                    text.push_str(&format!("</{name}>"));
                }
                let name = ["g", "a", "path"][random(3)];
                let class = ["", " class='x'", " class='x y'", " class='y'"][random(4)];
                let id = ["", "", " id='i'", " d='p q'"][random(4)];
                text.push_str(&format!("<!-- --> \n<{name}{class}{id}>"));
                open.push(name);
            }
            let closing: String = open.iter().rev().map(|name| format!("</{name}>")).collect();
            let text = format!("<svg>{text}{closing}</svg>");
            let document = Document::parse(&text).expect("XML");
            let mut compound = || {
                let name = ["g", "a", "path", "*", "svg"][random(5)];
                let more = [
                    "",
                    "",
                    ".x",
                    ".y",
                    "#i",
                    ":first-child",
                    "[d~=q]",
                    ".x.y",
                    ":hover",
                ];
                let relation = [" ", " ", ">", " + "][random(4)];
                (format!("{name}{}", more[random(more.len())]), relation)
            };
            let selectors: Vec<String> = (0..20)
                .map(|length| {
                    let steps = (0..length % 6).map(|_| compound());
                    let steps: String = steps.map(|(step, relation)| step + relation).collect();
                    steps + &compound().0
                })
                .collect();
            let parsed: Vec<&str> = selectors.iter().map(String::as_str).collect();
            let found = meetings(&document, &rules(&parsed), u64::MAX).expect("no limit");
            for node in document.descendants().filter(Node::is_element) {
                for (number, text) in (0u32..).zip(&selectors) {
                    let slow = simplecss::Selector::parse(text).expect("a selector");
                    let expected = slow.matches(&Slow(node));
                    let is_met = found.of(&node).contains(&number);
                    assert_eq!(
                        is_met,
                        expected,
                        "{text} and {:?} in {}",
                        node,
                        document.input_text()
                    );
                    *if expected { &mut met } else { &mut passed_over } += 1;
                }
            }
        }
        assert!(
            met > 3_000 && passed_over > 100_000,
            "{met} of {passed_over}"
        );
    }

    #[test]
    fn what_is_no_selector_is_not_understood() {
        for text in [
            "",
            "a >",
            "> a",
            "a ~ b",
            "a:link",
            "a:not(.b)",
            "a:lang(en)",
            "a b ] c",
        ] {
            assert_eq!(Selector::parse(text), None, "{text}");
        }
        let specificity = |text| Selector::parse(text).expect("one").specificity();
        assert_eq!(specificity("g#a.b[c]:hover > * path"), [1, 3, 2]);
    }

    /// A path inside `depth` nested groups.
    fn nested(depth: usize) -> String {
        let (open, close) = ("<g>".repeat(depth), "</g>".repeat(depth));
        format!("<svg>{open}<path/>{close}</svg>")
    }

    #[test]
    fn descendants_are_looked_for_once() {
        // There are 2e9 choices of eleven groups out of forty.
        let text = nested(40);
        let document = Document::parse(&text).expect("XML");
        let selector = format!("{}.none path", "g ".repeat(11));
        assert!(
            meetings(&document, &rules(&[&selector]), 41 * 12).is_some(),
            "each group with each of the eleven"
        );
    }

    #[test]
    fn only_rules_that_share_a_key_with_an_element_are_looked_at() {
        let text = nested(500).replace("<path", "<path class='c7 c8'");
        let document = Document::parse(&text).expect("XML");
        let selectors: Vec<String> = (0..1000).map(|i| format!("#i{} .c{i}", i % 10)).collect();
        let selectors: Vec<&str> = selectors.iter().map(String::as_str).collect();
        let found = meetings(&document, &rules(&selectors), 10);
        assert!(found.is_some(), "two of a thousand classes, and no id");
        // Rules that apply to every element take one comparison per rule and element, and no more.
        let everywhere = rules(&vec!["g g"; 1000]);
        assert!(meetings(&document, &everywhere, 500 * 3 * 1000).is_some());
        assert!(meetings(&document, &everywhere, 500 * 2 * 1000).is_none());
    }
}
