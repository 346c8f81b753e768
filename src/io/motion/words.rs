//! Messages about motion files speak of JSON: an object must be written as an object, and messages
//! use JSON's own words.

use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, MapAccess, Visitor};
use std::fmt;
use std::marker::PhantomData;

/// A structure that is written as an object; a list of its fields in the order of the declaration
/// is refused.
pub(super) struct Object<T>(pub(super) T);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Object<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Object<T>, D::Error> {
        deserializer
            .deserialize_map(ObjectVisitor(PhantomData))
            .map(Object)
    }
}

struct ObjectVisitor<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for ObjectVisitor<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object with named fields")
    }

    fn visit_map<A: MapAccess<'de>>(self, fields: A) -> Result<T, A::Error> {
        T::deserialize(MapAccessDeserializer::new(fields))
    }
}

/// A key that belongs to motions of the other dimension, and what a message says about it: a list
/// of the known keys would not help.
pub(super) type Foreign = (&'static str, String);

/// A message of the parser, rewritten as "expected .., found .." with JSON's names for things.
pub(super) fn words_of_json(message: &str, foreign: &[Foreign]) -> String {
    for (field, remark) in foreign {
        if let Some((place, _)) = message.split_once(&format!("unknown field `{field}`")) {
            return format!("{place}\"{field}\" belongs to {remark}");
        }
    }
    let at_problem = |problem| message.split_once(problem);
    let found = at_problem("invalid type: ").or_else(|| at_problem("invalid value: "));
    let Some((place, types)) = found else {
        return message.to_owned();
    };
    // What was found may quote the file; what was expected does not.
    let Some((found, expected)) = types.rsplit_once(", expected ") else {
        return message.to_owned();
    };
    format!(
        "{place}expected {}, found {}",
        json_name(expected),
        json_name(found)
    )
}

fn json_name(of_parser: &str) -> &str {
    match of_parser {
        "f64" => "a number",
        "i32" => "a whole number",
        "sequence" | "a sequence" => "a list",
        "map" | "a map" => "an object",
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_have_the_names_of_json() {
        let cases = [
            (
                "key 1: invalid type: sequence, expected f64",
                "key 1: expected a number, found a list",
            ),
            (
                "invalid type: map, expected a sequence",
                "expected a list, found an object",
            ),
            (
                "invalid type: string \"a, expected b\", expected f64",
                "expected a number, found string \"a, expected b\"",
            ),
            (
                "invalid type: floating point `0.5`, expected i32",
                "expected a whole number, found floating point `0.5`",
            ),
            (
                "invalid value: integer `3000000000`, expected i32",
                "expected a whole number, found integer `3000000000`",
            ),
            ("trailing comma", "trailing comma"),
        ];
        for (of_parser, expected) in cases {
            assert_eq!(words_of_json(of_parser, &[]), expected, "{of_parser}");
        }
    }
}
