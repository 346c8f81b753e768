//! What a document would cost the XML parser, estimated before it is parsed.
//!
//! The parser compares each attribute of an element with every other one, each prefix with all that
//! are in scope, and each entity reference with all definitions; and it copies the text of an
//! entity wherever it is referenced. All this is little in files that programs write, but a hostile
//! file can make it grow as the square of its size.

use super::super::error::{InputProblem, Place};
use std::collections::HashSet;

/// Most comparisons of one kind: about a second.
const MOST_COMPARISONS: u64 = 1_000_000_000;

/// Most bytes to which the entities of a small file may expand.
const LEAST_ROOM: u64 = 1 << 20;

/// The same of a large file, as a multiple of its size.
const ROOM: u64 = 16;

/// Most references that the parser follows inside one entity.
const NESTED: u64 = 256;

const REMEDY: &str = "no drawing program writes such a file: export it again, as plain SVG";

/// Counts of comparisons, each over the whole document.
#[derive(Debug, Default)]
struct Counts<'a> {
    /// Sum of the squares of the numbers of attributes of the elements.
    attributes_squared: u64,
    /// Number of names that may have a prefix.
    names: u64,
    /// Number of elements that declare prefixes.
    declaring: u64,
    prefixes: HashSet<&'a str>,
    entities: u64,
    /// Bytes of the longest definition of an entity.
    longest_entity: u64,
    /// Most attributes in the elements of an entity.
    attributes_in_entity: u64,
    nested: bool,
}

/// Refuses a document that would take the parser more time or memory than its size warrants.
///
/// # Errors
/// [`InputProblem::TooMuch`] with the number.
///
/// # Cost
/// O(n): nothing is compared here.
pub(super) fn check(text: &str) -> Result<(), InputProblem> {
    let counts = Counts::of(text);
    let mut references = 0;
    if counts.entities > 0 {
        references = text.matches('&').count() as u64;
    }
    let followed = if counts.nested {
        references.saturating_mul(NESTED)
    } else {
        references
    };
    let prefixes = counts.prefixes.len() as u64 + 1;
    let in_entities = counts.attributes_in_entity.saturating_pow(2);
    let comparisons = [
        (
            "to tell the attributes of each element apart",
            counts
                .attributes_squared
                .saturating_add(followed.saturating_mul(in_entities)),
        ),
        (
            "to find what prefixes stand for",
            counts
                .names
                .saturating_mul(prefixes)
                .saturating_add(counts.declaring.saturating_mul(prefixes * prefixes)),
        ),
        (
            "to find what entities stand for",
            followed.saturating_mul(counts.entities),
        ),
    ];
    for (purpose, number) in comparisons {
        if number > MOST_COMPARISONS {
            return Err(InputProblem::TooMuch {
                place: Place::File,
                what: format!("{purpose}, the XML takes {number} comparisons"),
                limit: MOST_COMPARISONS,
                remedy: REMEDY,
            });
        }
    }
    let bytes = followed.saturating_mul(counts.longest_entity);
    let room = (ROOM * text.len() as u64).max(LEAST_ROOM);
    if bytes > room {
        return Err(InputProblem::TooMuch {
            place: Place::File,
            what: format!("the entities of the XML stand for up to {bytes} bytes"),
            limit: room,
            remedy: REMEDY,
        });
    }
    Ok(())
}

impl<'a> Counts<'a> {
    fn of(text: &'a str) -> Counts<'a> {
        let mut counts = Counts::default();
        let mut rest = text;
        while let Some(start) = rest.find('<') {
            rest = &rest[start..];
            let behind = |end: &str| rest.find(end).map_or(rest.len(), |place| place + end.len());
            let length = if rest.starts_with("<!--") {
                behind("-->")
            } else if rest.starts_with("<![CDATA[") {
                behind("]]>")
            } else if rest.starts_with("<?") {
                behind("?>")
            } else if rest.starts_with("<!ENTITY") {
                counts.add_entity(rest)
            } else if rest.starts_with("<!") || rest.starts_with("</") {
                // The definitions of entities follow inside the document type.
                2
            } else {
                counts.add_element(rest)
            };
            rest = &rest[length..];
        }
        counts
    }

    /// Counts the definition at the start of a text, and returns its length.
    fn add_entity(&mut self, text: &str) -> usize {
        let (length, attributes) = tag(text, |_| {});
        let definition = &text[..length];
        self.entities += 1;
        self.longest_entity = self.longest_entity.max(length as u64);
        self.nested |= definition.contains('&');
        if definition.matches('<').count() > 1 {
            let equal_signs = definition.matches('=').count() as u64;
            self.attributes_in_entity = self.attributes_in_entity.max(equal_signs + attributes);
        }
        length
    }

    /// Counts the opening tag at the start of a text, and returns its length.
    fn add_element(&mut self, text: &'a str) -> usize {
        let mut declares = false;
        let (length, attributes) = tag(text, |before| {
            let name = before.trim_ascii_end();
            let start = name.rfind([' ', '\t', '\n', '\r', '"', '\'', '<']);
            let name = &name[start.map_or(0, |place| place + 1)..];
            if let Some(prefix) = name.strip_prefix("xmlns") {
                declares = true;
                self.prefixes.insert(prefix);
            }
        });
        self.attributes_squared = self
            .attributes_squared
            .saturating_add(attributes.saturating_pow(2));
        self.names += 1 + attributes;
        self.declaring += u64::from(declares);
        length
    }
}

/// The length of the tag at the start of a text, and the number of its equal signs outside
/// quotation marks. `visit` receives the text before each of them, back to the value before it or
/// to the start.
fn tag<'a>(text: &'a str, mut visit: impl FnMut(&'a str)) -> (usize, u64) {
    let mut attributes = 0;
    let (mut quote, mut behind) = (None, 0);
    for (place, byte) in text.bytes().enumerate() {
        match (quote, byte) {
            (None, b'>') => return (place + 1, attributes),
            (None, b'"' | b'\'') => quote = Some(byte),
            (None, b'=') => {
                attributes += 1;
                visit(&text[behind..place]);
            }
            (Some(mark), _) if mark == byte => {
                quote = None;
                behind = place + 1;
            }
            _ => {}
        }
    }
    (text.len(), attributes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(text: &str) -> String {
        check(text).expect_err("too much").to_string()
    }

    #[test]
    fn files_that_programs_write_are_let_through() {
        let illustrator = "<?xml version='1.0'?><!DOCTYPE svg PUBLIC '-//W3C//DTD SVG 1.1//EN' 'a.dtd' [\n\
            <!ENTITY ns_svg \"http://www.w3.org/2000/svg\"> <!ENTITY ns_x 'http://x'> ]>\n\
            <svg xmlns='&ns_svg;' xmlns:x='&ns_x;'>";
        let element = "<path xmlns='http://www.w3.org/2000/svg' x:a = '>' d='M0 0'/><!-- <a =======> -->\
            <style><![CDATA[ a[b=c]>d{} ]]></style>";
        let text = format!("{illustrator}{}</svg>", element.repeat(10_000));
        assert_eq!(check(&text), Ok(()));
        let counts = Counts::of(&text);
        assert_eq!((counts.entities, counts.declaring), (2, 10_001));
        assert_eq!(counts.prefixes, HashSet::from(["", ":x"]));
        assert_eq!(counts.attributes_squared, 4 + 9 * 10_000, "{counts:?}");
    }

    #[test]
    fn what_grows_as_a_square_is_refused_with_the_number() {
        let attributes: String = (0..40_000).map(|i| format!(" a{i}=''")).collect();
        assert_eq!(
            message(&format!("<svg{attributes}/>")),
            "to tell the attributes of each element apart, the XML takes 1600000000 comparisons, more than 1000000000; no drawing \
             program writes such a file: export it again, as plain SVG"
        );
        let groups: String = (0..2_000).map(|i| format!("<g xmlns:a{i}='u'>")).collect();
        assert!(message(&groups).starts_with("to find what prefixes stand for"));
        let entities: String = (0..40_000).map(|i| format!("<!ENTITY e{i} 'a'>")).collect();
        let references = "&e39999;".repeat(40_000);
        assert!(
            message(&format!(
                "<!DOCTYPE svg [{entities}]><svg>{references}</svg>"
            ))
            .starts_with("to find what entities stand for")
        );
        let long = format!("<!DOCTYPE svg [<!ENTITY e '{}'>]>", "a".repeat(100_000));
        let text = message(&format!("{long}<svg>{}</svg>", "&e;".repeat(10_000)));
        assert!(
            text.starts_with("the entities of the XML stand for up to 1000140000 bytes, more than"),
            "{text}"
        );
        let laughs: String = (1..9)
            .map(|i| format!("<!ENTITY e{i} '{}'>", format!("&e{};", i - 1).repeat(10)))
            .collect();
        let text = format!(
            "<!DOCTYPE svg [<!ENTITY e0 'lol'>{laughs}]><svg>{}</svg>",
            "&e8;".repeat(999)
        );
        assert!(message(&text).starts_with("the entities of the XML"));
        let paths = "<path a=\"\"/>".repeat(3_000);
        let markup = format!(
            "<!DOCTYPE svg [<!ENTITY e '{paths}'>]><svg>{}</svg>",
            "&e;".repeat(999)
        );
        assert!(message(&markup).starts_with("to tell the attributes"));
    }
}
