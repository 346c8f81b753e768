//! Style sheets: the rules that say what is an outline, and which of them meet an element.

use super::super::error::{InputProblem, Place, quote};
use super::SVG;
use super::style::{self, Declaration};
use roxmltree::{Document, Node};
use simplecss::{AttributeOperator, Element, PseudoClass, Selector};

/// Rules of a sheet that begin by `@` and change no element.
const HARMLESS: &[&str] = &["charset", "namespace", "font-face", "page"];

const REMEDY: &str = "write fill, fill-rule, display, visibility and the like at the elements themselves, or let the \
                      program that wrote the file do so (presentation attributes)";

/// The text of a `style` element, without comments, and the line at which it begins.
pub(super) struct Source {
    line: usize,
    text: String,
}

/// A selector, and what it says of the elements that it meets.
pub(super) struct Rule<'a> {
    selector: Selector<'a>,
    declarations: Vec<Declaration<'a>>,
}

impl<'a> Rule<'a> {
    /// The number of ids, of classes and of names in its selector: rules with more of the first that differs come before others.
    pub(super) fn specificity(&self) -> [u8; 3] {
        self.selector.specificity()
    }

    pub(super) fn declarations(&self) -> &[Declaration<'a>] {
        &self.declarations
    }

    pub(super) fn meets(&self, node: &Node<'_, '_>) -> bool {
        self.selector.matches(&Met(*node))
    }
}

/// The sheets of a document, wherever they stand in it.
///
/// # Errors
/// When a sheet is in another file.
pub(super) fn sources(document: &Document<'_>) -> Result<Vec<Source>, InputProblem> {
    let line = |node: &Node<'_, '_>| document.text_pos_at(node.range().start).row as usize;
    let mut instructions = document
        .root()
        .children()
        .filter_map(|node| Some((node, node.pi()?)));
    if let Some((node, _)) = instructions.find(|(_, pi)| pi.target == "xml-stylesheet") {
        return Err(unread(line(&node), "a style sheet in another file"));
    }
    let mut sources = Vec::new();
    for node in document.descendants() {
        let is_link = node.tag_name().name() == "link";
        if is_link
            && node
                .attribute("rel")
                .is_some_and(|rel| rel.contains("stylesheet"))
        {
            return Err(unread(line(&node), "a style sheet in another file"));
        }
        if node.tag_name().name() != "style"
            || !matches!(node.tag_name().namespace(), None | Some(SVG))
            || node
                .attribute("type")
                .is_some_and(|kind| !kind.trim().is_empty() && !kind.contains("css"))
        {
            continue;
        }
        let texts: Vec<Node<'_, '_>> = node.children().filter(Node::is_text).collect();
        let text: String = texts.iter().filter_map(Node::text).collect();
        let text = style::without_comments(&text);
        let line = line(texts.first().unwrap_or(&node));
        let medium = node.attribute("media").unwrap_or("all").trim();
        if !matches!(medium, "" | "all" | "screen") && decides(&text) {
            return Err(unread(line, medium));
        }
        sources.push(Source { line, text });
    }
    Ok(sources)
}

/// The rules of sheets that say something of an outline, in their order.
///
/// # Errors
/// When such a rule has a selector or a condition that is not understood.
pub(super) fn rules(sources: &[Source]) -> Result<Vec<Rule<'_>>, InputProblem> {
    let mut rules = Vec::new();
    for source in sources {
        let mut rest = source.text.as_str();
        loop {
            rest = rest
                .trim_start_matches(|c: char| c.is_whitespace() || c == ';')
                .trim_start_matches("<!--")
                .trim_start_matches("-->")
                .trim_start();
            if rest.is_empty() {
                break;
            }
            let before = source.text.len() - rest.len();
            let line = source.line + source.text[..before].matches('\n').count();
            let block = Block::first(rest).ok_or_else(|| unread(line, rest))?;
            rest = &rest[block.length..];
            if let Some(condition) = block.prelude.strip_prefix('@') {
                let name = condition
                    .split(|c: char| !(c.is_alphanumeric() || c == '-'))
                    .next()
                    .unwrap_or_default();
                let decides = name == "import" || decides(block.body);
                if decides && !(HARMLESS.contains(&name) || name.ends_with("keyframes")) {
                    return Err(unread(line, block.prelude));
                }
                continue;
            }
            if !decides(block.body) {
                continue;
            }
            if block.body.contains('{') {
                return Err(unread(line, block.prelude));
            }
            for text in block.prelude.split(',') {
                // Links and languages are not told apart here, and names are compared as they are written.
                let known = !text.contains(":l") && !text.contains('\\');
                let selector = Selector::parse(text.trim()).filter(|_| known);
                rules.push(Rule {
                    selector: selector.ok_or_else(|| unread(line, text))?,
                    declarations: style::declarations(block.body)
                        .filter(|declaration| style::decides(declaration.name))
                        .collect(),
                });
            }
        }
    }
    Ok(rules)
}

fn unread(line: usize, found: &str) -> InputProblem {
    InputProblem::Malformed {
        place: Place::Line(line),
        expected: "a style sheet of plain rules that hold everywhere".to_owned(),
        found: quote(found),
        remedy: REMEDY,
    }
}

/// Whether any declaration in a text, in blocks or not, says what is an outline.
fn decides(text: &str) -> bool {
    text.split(['{', '}', ';'])
        .filter_map(|part| part.split_once(':'))
        .any(|(name, _)| style::decides(name.trim()))
}

/// What stands before a block in braces, what in it, and how long both are; the block is empty in a statement that ends by `;`.
struct Block<'a> {
    prelude: &'a str,
    body: &'a str,
    length: usize,
}

impl Block<'_> {
    fn first(text: &str) -> Option<Block<'_>> {
        let open = text.find('{');
        if let Some(end) = text.find(';').filter(|_| text.starts_with('@'))
            && open.is_none_or(|open| end < open)
        {
            return Some(Block {
                prelude: text[..end].trim(),
                body: "",
                length: end + 1,
            });
        }
        let open = open?;
        let mut depth = 0usize;
        for (at, character) in text[open..].char_indices() {
            match character {
                '{' => depth += 1,
                '}' => depth -= 1,
                _ => {}
            }
            if depth == 0 {
                return Some(Block {
                    prelude: text[..open].trim(),
                    body: &text[open + 1..open + at],
                    length: open + at + 1,
                });
            }
        }
        None
    }
}

/// An element as selectors see it.
struct Met<'a, 'input>(Node<'a, 'input>);

impl Element for Met<'_, '_> {
    fn parent_element(&self) -> Option<Self> {
        self.0.parent_element().map(Met)
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.0.prev_sibling_element().map(Met)
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.0.tag_name().name() == name
    }

    fn attribute_matches(&self, local_name: &str, operator: AttributeOperator<'_>) -> bool {
        self.0
            .attribute(local_name)
            .is_some_and(|value| operator.matches(value))
    }

    fn pseudo_class_matches(&self, class: PseudoClass<'_>) -> bool {
        matches!(class, PseudoClass::FirstChild) && self.0.prev_sibling_element().is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(text: &str) -> Source {
        Source {
            line: 3,
            text: style::without_comments(text),
        }
    }

    #[test]
    fn rules_that_say_nothing_of_outlines_are_passed_over() {
        let sheet = [source(
            "@charset 'utf-8'; /* fill: none; */ @font-face { src: url(a) }\n.a, #b > path { stroke: red; FILL: none }\n\
             text:hover { font-size: 3px } @media print { text { color: red } }",
        )];
        let found = rules(&sheet).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(found.len(), 2, "two selectors");
        for rule in &found {
            let names: Vec<&str> = rule.declarations().iter().map(|d| d.name).collect();
            assert_eq!(names, ["FILL"], "stroke is none of ours");
        }
        assert_eq!(found[0].specificity(), [0, 1, 0]);
        assert_eq!(found[1].specificity(), [1, 0, 1]);
    }

    #[test]
    fn damaged_sheets_never_make_the_reader_panic() {
        let document = Document::parse("<svg><g class='a'><path id='b'/></g></svg>").expect("XML");
        let whole: Vec<char> = "@media x{.\u{e9}{stroke:none}} g > .a:first-child + #b[d~='\u{fc}'], * {fill : none !important;d:\u{1f600}}"
            .chars()
            .collect();
        let odd: Vec<char> = "{}[]()<>:;,.#*@!\\'\"=~|+-_ \n\u{e9}\u{1f600}a0"
            .chars()
            .collect();
        let mut state = 7u64;
        let mut random = move |limit: usize| {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            ((state >> 33) % limit as u64) as usize
        };
        let mut readable = 0;
        for _ in 0..20_000 {
            let mut text = whole.clone();
            for _ in 0..=random(6) {
                let at = random(text.len());
                match random(3) {
                    0 => text[at] = odd[random(odd.len())],
                    1 => drop(text.drain(at..(at + random(12)).min(text.len()))),
                    _ => text.insert(at, odd[random(odd.len())]),
                }
                if text.is_empty() {
                    text.push(' ');
                }
            }
            let sheet = [source(&text.iter().collect::<String>())];
            let found = rules(&sheet);
            for rule in found.iter().flatten() {
                readable += 1;
                for node in document.descendants().filter(Node::is_element) {
                    rule.meets(&node);
                }
            }
        }
        assert!(
            readable > 5_000,
            "some of the damage does no harm: {readable}"
        );
    }

    #[test]
    fn rules_that_are_not_understood_are_named_with_their_line() {
        for text in [
            "@media print { path { display: none } }",
            "@import url(other.css);",
            "path:not(.a) { fill: none }",
            "path ~ path { fill: none }",
            "a:link { visibility: hidden }",
            "g { path { fill: none } }",
            "path { fill: none",
        ] {
            let sheet = [source(&format!("/* two\nlines */ {text}"))];
            let Err(error) = rules(&sheet) else {
                panic!("{text}")
            };
            let message = error.to_string();
            assert!(
                message.starts_with("line 4: expected a style sheet"),
                "{message}"
            );
        }
    }
}
