//! The elements of a PLY file, one by one, with the place of each.

use crate::io::error::{EXPORT_AGAIN, InputProblem, Place, quote};
use glam::DVec3;
use ply_rs_bw::parser::{ParseError, Parser};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Property, PropertyAccess, PropertyAccessResult, PropertyDef,
    PropertyType, ScalarType,
};
use std::io::{self, BufRead, Cursor};

/// Names of the list of corners of a face.
pub(super) const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// What is kept of a vertex or a face.
#[derive(Debug, Clone)]
pub(super) struct PlyElement {
    pub(super) position: DVec3,
    pub(super) corners: Vec<u32>,
}

impl PropertyAccess for PlyElement {
    fn new() -> PlyElement {
        PlyElement {
            position: DVec3::ZERO,
            corners: Vec::new(),
        }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if CORNERS.contains(&name) {
            let Some(corners) = property.to_u32_list() else {
                return PropertyAccessResult::UnsupportedType;
            };
            self.corners = corners;
            return PropertyAccessResult::Set;
        }
        let Some(axis) = ["x", "y", "z"].iter().position(|&axis| axis == name) else {
            return PropertyAccessResult::Ignored;
        };
        self.position[axis] = match property {
            Property::Char(v) => f64::from(v),
            Property::UChar(v) => f64::from(v),
            Property::Short(v) => f64::from(v),
            Property::UShort(v) => f64::from(v),
            Property::Int(v) => f64::from(v),
            Property::UInt(v) => f64::from(v),
            Property::Float(v) => f64::from(v),
            Property::Double(v) => v,
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }

    fn get_double(&self, name: &str) -> Option<f64> {
        match name {
            "x" => Some(self.position.x),
            "y" => Some(self.position.y),
            "z" => Some(self.position.z),
            _ => None,
        }
    }

    fn get_list_uint(&self, _name: &str) -> Option<&[u32]> {
        Some(&self.corners)
    }
}

/// Bytes of a scalar in a binary file.
fn size(scalar: &ScalarType) -> u128 {
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

/// Where an element stands in the file.
#[derive(Debug, Clone, Copy)]
pub(super) struct ElementPlace<'a> {
    what: &'a str,
    /// Its number among those of its kind.
    pub(super) index: usize,
    start: Start,
}

#[derive(Debug, Clone, Copy)]
enum Start {
    Line(usize),
    Byte(u64),
}

impl ElementPlace<'_> {
    pub(super) fn place(&self) -> Place {
        match self.start {
            Start::Line(line) => Place::Line(line),
            Start::Byte(byte) => Place::Element {
                what: self.what.to_owned(),
                index: self.index as u64,
                byte,
            },
        }
    }
}

/// The rest of a file after its header.
pub(super) struct PlyBody<'a> {
    pub(super) parser: Parser<PlyElement>,
    pub(super) bytes: Cursor<&'a [u8]>,
    pub(super) encoding: Encoding,
    /// Number of the next line of a text file.
    pub(super) line: usize,
}

impl PlyBody<'_> {
    /// Refuses an element whose count needs more bytes than the rest of the file has.
    pub(super) fn check_claim(&self, definition: &ElementDef) -> Result<(), InputProblem> {
        let least = |property: &PropertyDef| match (&self.encoding, &property.data_type) {
            // A digit, and a space or line break.
            (Encoding::Ascii, _) => 2,
            (_, PropertyType::Scalar(scalar)) => size(scalar),
            (_, PropertyType::List(count, _)) => size(count),
        };
        let each: u128 = definition.properties.values().map(least).sum();
        let held_bytes = self.bytes.get_ref().len() as u64 - self.bytes.position();
        let claimed_bytes = definition.count as u128 * each;
        // The last line of a text may lack its line break.
        if claimed_bytes > u128::from(held_bytes) + 1 {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "not more than the bytes of the file"
            )]
            let held = (u128::from(held_bytes) / each) as u64;
            let what = format!("elements \"{}\"", definition.name);
            let claimed = definition.count as u64;
            return Err(InputProblem::Claims {
                what,
                claimed,
                claimed_bytes,
                held,
                held_bytes,
            });
        }
        Ok(())
    }

    /// Reads the elements of one kind.
    pub(super) fn each<'d>(
        &mut self,
        definition: &'d ElementDef,
        mut visit: impl FnMut(ElementPlace<'d>, PlyElement) -> Result<(), InputProblem>,
    ) -> Result<(), InputProblem> {
        // Elements without properties take no bytes, so that any number of them fits.
        if definition.properties.is_empty() && self.encoding != Encoding::Ascii {
            return Ok(());
        }
        for index in 0..definition.count {
            let spot = ElementPlace {
                what: &definition.name,
                index,
                start: match self.encoding {
                    Encoding::Ascii => Start::Line(self.line),
                    _ => Start::Byte(self.bytes.position()),
                },
            };
            let element = match self.encoding {
                Encoding::Ascii => match self.next_line() {
                    Some(line) => self
                        .parser
                        .read_ascii_element(&line, definition)
                        .or_else(|_| {
                            self.parser
                                .read_ascii_element(&with_full_numbers(&line), definition)
                        })
                        .map_err(|_| quote(&line)),
                    None => Err("the end of the file".to_owned()),
                },
                Encoding::BinaryBigEndian => self
                    .parser
                    .read_big_endian_element(&mut self.bytes, definition)
                    .map_err(|e| self.found(&e)),
                Encoding::BinaryLittleEndian => self
                    .parser
                    .read_little_endian_element(&mut self.bytes, definition)
                    .map_err(|e| self.found(&e)),
            };
            let element = element.map_err(|found| InputProblem::Malformed {
                place: spot.place(),
                expected: format!(
                    "element \"{}\" {index} of {}",
                    definition.name, definition.count
                ),
                found,
                remedy: EXPORT_AGAIN,
            })?;
            visit(spot, element)?;
        }
        Ok(())
    }

    /// `None` at the end of the file; reading from memory cannot fail otherwise.
    fn next_line(&mut self) -> Option<String> {
        let mut line = Vec::new();
        self.bytes
            .read_until(b'\n', &mut line)
            .ok()
            .filter(|&length| length > 0)?;
        self.line += 1;
        Some(String::from_utf8_lossy(&line).into_owned())
    }

    fn found(&self, error: &ParseError) -> String {
        if error.kind() == io::ErrorKind::UnexpectedEof {
            "the end of the file".to_owned()
        } else {
            quote(&error.to_string())
        }
    }
}

/// A line in which numbers like `1.` and `.5`, which the parser does not know, have digits on both
/// sides of the point.
fn with_full_numbers(line: &str) -> String {
    let full = |word: &str| match word.parse::<f64>() {
        Ok(number) if word.contains('.') && number.is_finite() => format!("{number:?}"),
        _ => word.to_owned(),
    };
    line.split_ascii_whitespace()
        .map(full)
        .collect::<Vec<_>>()
        .join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_get_digits_on_both_sides() {
        assert_eq!(
            with_full_numbers(" 1. -.5 .25e1 7 x.y\n"),
            "1.0 -0.5 2.5 7 x.y"
        );
    }
}
