//! Style sheets: the rules that decide what is an outline.

use super::super::error::{InputProblem, Place, quote};
use super::SVG;
use super::lines::Lines;
use super::selector::{Rules, Selector};
use super::style::{self, Rule};
use roxmltree::{Document, Node};
use std::rc::Rc;

/// Rules of a sheet that begin by `@` and change no element.
const HARMLESS: &[&str] = &["charset", "namespace", "font-face", "page"];

pub(super) const REMEDY: &str = "write fill, fill-rule, display, visibility and the like at the elements themselves, or let the \
                      program that wrote the file do so (presentation attributes)";

/// The text of a `style` element, without comments, and the line at which it begins.
pub(super) struct StyleText {
    line: usize,
    text: String,
}

/// The sheets of a document, wherever they stand in it.
///
/// # Errors
/// When a sheet is in another file.
pub(super) fn sources(
    document: &Document<'_>,
    lines: &Lines,
) -> Result<Vec<StyleText>, InputProblem> {
    let line = |node: &Node<'_, '_>| lines.at(node.range().start);
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
        if !matches!(medium, "" | "all" | "screen") && style::decides(&text) {
            return Err(unread(line, medium));
        }
        sources.push(StyleText { line, text });
    }
    Ok(sources)
}

/// The rules of sheets that decide on outlines, in their order.
///
/// # Errors
/// When such a rule has a selector or a condition that is not understood.
pub(super) fn rules(sources: &[StyleText]) -> Result<Rules<'_>, InputProblem> {
    let mut rules = Rules::default();
    for source in sources {
        let mut rest = source.text.as_str();
        let (mut line, mut counted) = (source.line, 0);
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
            line += source.text[counted..before].matches('\n').count();
            counted = before;
            let block = Block::first(rest).ok_or_else(|| unread(line, rest))?;
            rest = &rest[block.length..];
            if let Some(condition) = block.prelude.strip_prefix('@') {
                let name = condition
                    .split(|c: char| !(c.is_alphanumeric() || c == '-'))
                    .next()
                    .unwrap_or_default();
                let counts = name == "import" || style::decides(block.body);
                if counts && !(HARMLESS.contains(&name) || name.ends_with("keyframes")) {
                    return Err(unread(line, block.prelude));
                }
                continue;
            }
            if !style::decides(block.body) {
                continue;
            }
            if block.body.contains('{') {
                return Err(unread(line, block.prelude));
            }
            let declarations: Rc<[_]> = style::last_declarations(block.body).into();
            for text in block.prelude.split(',') {
                // Names are compared as they are written.
                let plain = Some(text.trim()).filter(|text| !text.contains('\\'));
                let selector = plain.and_then(Selector::parse);
                let selector = selector.ok_or_else(|| unread(line, text))?;
                rules.said.push(Rule {
                    specificity: selector.specificity(),
                    declarations: Rc::clone(&declarations),
                });
                rules.selectors.push(selector);
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

/// The text before a block in braces, the text in it, and the length of both together. The block is
/// empty in a statement that ends with `;`.
struct Block<'a> {
    prelude: &'a str,
    body: &'a str,
    length: usize,
}

impl Block<'_> {
    fn first(text: &str) -> Option<Block<'_>> {
        // The search does not go beyond the end of the block.
        let open = if text.starts_with('@') {
            text.find(['{', ';'])?
        } else {
            text.find('{')?
        };
        if text[open..].starts_with(';') {
            return Some(Block {
                prelude: text[..open].trim(),
                body: "",
                length: open + 1,
            });
        }
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

#[cfg(test)]
mod tests {
    use super::super::selector::meetings;
    use super::*;
    use crate::samples::random_below;

    fn source(text: &str) -> StyleText {
        StyleText {
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
        let specificities: Vec<_> = found.said.iter().map(|rule| rule.specificity).collect();
        assert_eq!(specificities, [[0, 1, 0], [1, 0, 1]], "two selectors");
        for rule in &found.said {
            assert_eq!(
                *rule.declarations,
                style::last_declarations("fill: none"),
                "stroke is none of ours"
            );
        }
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
        let mut below = random_below(7);
        let mut random = move |limit: usize| usize::try_from(below(limit as u64)).expect("31 bits");
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
            if let Ok(found) = found {
                readable += found.said.len();
                let met = meetings(&document, &found, u64::MAX).expect("no limit");
                let elements = document.descendants().filter(Node::is_element);
                elements.for_each(|node| assert!(met.of(&node).len() <= found.said.len()));
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
