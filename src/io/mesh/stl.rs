//! STL, text and binary. Binary through `stl_io`.
//!
//! This module reads text itself: coordinates must not be narrowed to `f32` before vertices are
//! joined, several solids in one file are one body, and a message must name its line; `stl_io`
//! stops after the first solid and counts no lines.

use super::list::TriangleList;
use crate::io::error::{EXPORT_AGAIN, InputProblem, Place, quote};
use glam::DVec3;
use std::io;
use stl_io::{Normal, Triangle, Vertex};

/// Bytes before the first triangle: 80 of free text, and the number of triangles.
const HEADER: usize = 84;

/// Bytes of free text at the start of a header.
const TITLE: usize = 80;

/// Bytes of a triangle: normal, three corners, two spare bytes.
const TRIANGLE: usize = 50;

/// Number of bytes that are examined to tell text from binary.
const PROBE: usize = 512;

/// Three positions per triangle, in the order of the file.
pub(super) fn read(bytes: Vec<u8>) -> Result<TriangleList, InputProblem> {
    // Many binary files begin with the word "solid" too: the size decides first.
    if claimed_triangles(&bytes)
        .is_some_and(|n| n > 0 && HEADER as u64 + n * TRIANGLE as u64 == bytes.len() as u64)
    {
        return read_binary(bytes);
    }
    // Some editors mark UTF-8 with these three bytes.
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes);
    let start = &text[..text.len().min(PROBE)];
    let is_text = start
        .iter()
        .all(|&b| b.is_ascii_graphic() || b.is_ascii_whitespace() || b >= 0x80);
    let solid = start
        .trim_ascii_start()
        .get(..5)
        .is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    if solid && is_text {
        return read_text(&String::from_utf8_lossy(text));
    }
    if is_text {
        return Err(InputProblem::Malformed {
            place: Place::Line(1),
            expected: "\"solid\", as a text STL begins, or the header of a binary STL".to_owned(),
            found: quote(
                String::from_utf8_lossy(start)
                    .lines()
                    .next()
                    .unwrap_or_default(),
            ),
            remedy: "this is no STL file",
        });
    }
    read_binary(bytes)
}

/// The number of triangles in the header, if there is one.
fn claimed_triangles(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(TITLE..HEADER)?.try_into().ok()?;
    Some(u64::from(u32::from_le_bytes(count)))
}

fn read_binary(mut bytes: Vec<u8>) -> Result<TriangleList, InputProblem> {
    let Some(claimed) = claimed_triangles(&bytes) else {
        return Err(InputProblem::Malformed {
            place: Place::File,
            expected: format!("at least the {HEADER} bytes of the header of a binary STL"),
            found: format!("{} bytes", bytes.len()),
            remedy: "the file is cut off: export it again",
        });
    };
    let held_bytes = (bytes.len() - HEADER) as u64;
    let held = held_bytes / TRIANGLE as u64;
    if claimed != held {
        let claimed_bytes = u128::from(claimed) * TRIANGLE as u128;
        return Err(InputProblem::Claims {
            what: "triangles".to_owned(),
            claimed,
            claimed_bytes,
            held,
            held_bytes,
        });
    }
    // `stl_io` takes a file for text when its title begins with "solid".
    bytes[..TITLE].fill(0);
    let mut source = io::Cursor::new(bytes);
    let unreadable = |error: io::Error| InputProblem::Unreadable {
        reason: error.to_string(),
    };
    let mut list = TriangleList::default();
    for (index, triangle) in stl_io::create_stl_reader(&mut source)
        .map_err(unreadable)?
        .enumerate()
    {
        let corners = triangle
            .map_err(unreadable)?
            .vertices
            .map(|v| DVec3::from_array(v.0.map(f64::from)));
        if let Some(corner) = corners.iter().find(|corner| !corner.is_finite()) {
            let byte = (HEADER + index * TRIANGLE) as u64;
            return Err(InputProblem::Malformed {
                place: Place::Element {
                    what: "triangle".to_owned(),
                    index: index as u64,
                    byte,
                },
                expected: "finite coordinates".to_owned(),
                found: corner.to_string(),
                remedy: EXPORT_AGAIN,
            });
        }
        list.push_triangle(corners);
    }
    Ok(list)
}

fn read_text(text: &str) -> Result<TriangleList, InputProblem> {
    let mut list = TriangleList::default();
    let mut facet: Option<Vec<DVec3>> = None;
    let mut in_solid = false;
    let mut last_line = 0;
    for (number, line) in (1..).zip(text.lines()) {
        let malformed = |expected: &str| InputProblem::Malformed {
            place: Place::Line(number),
            expected: expected.to_owned(),
            found: quote(line),
            remedy: EXPORT_AGAIN,
        };
        let mut words = line.split_ascii_whitespace();
        let Some(word) = words.next() else { continue };
        last_line = number;
        match (word.to_ascii_lowercase().as_str(), &mut facet) {
            ("solid", None) if !in_solid => in_solid = true,
            ("endsolid", None) if in_solid => in_solid = false,
            ("facet", None) if in_solid => facet = Some(Vec::with_capacity(3)),
            ("outer" | "endloop", Some(_)) => {}
            ("vertex", Some(corners)) if corners.len() < 3 => {
                let expected = "\"vertex\" and three finite numbers";
                let numbers: Vec<f64> = words
                    .map_while(|w| w.parse().ok())
                    .filter(|x: &f64| x.is_finite())
                    .collect();
                let [x, y, z] = numbers[..] else {
                    return Err(malformed(expected));
                };
                if line.split_ascii_whitespace().count() != 4 {
                    return Err(malformed(expected));
                }
                corners.push(DVec3::new(x, y, z));
            }
            ("endfacet", Some(corners)) => {
                let [a, b, c] = corners[..] else {
                    return Err(malformed("three vertices before \"endfacet\""));
                };
                list.push_triangle([a, b, c]);
                facet = None;
            }
            (_, None) if in_solid => return Err(malformed("\"facet\" or \"endsolid\"")),
            (_, None) => return Err(malformed("\"solid\"")),
            (_, Some(corners)) if corners.len() < 3 => return Err(malformed("\"vertex\"")),
            (_, Some(_)) => return Err(malformed("\"endfacet\"")),
        }
    }
    if in_solid {
        return Err(InputProblem::Malformed {
            place: Place::Line(last_line),
            expected: "\"endsolid\" at the end".to_owned(),
            found: format!(
                "the end of the file after {} whole triangles",
                list.triangles.len()
            ),
            remedy: "the file is cut off: export it again",
        });
    }
    Ok(list)
}

/// Writes binary STL with coordinates rounded to `f32` and the normals of the rounded triangles.
pub(super) fn write(
    out: &mut impl io::Write,
    positions: &[DVec3],
    triangles: &[[u32; 3]],
) -> io::Result<()> {
    if u32::try_from(triangles.len()).is_err() {
        return Err(io::Error::other(format!(
            "binary STL cannot count {} triangles",
            triangles.len()
        )));
    }
    let narrow = |v: u32| positions[v as usize].as_vec3();
    if let Some(&v) = triangles
        .iter()
        .flatten()
        .find(|&&v| !narrow(v).is_finite())
    {
        let position = positions[v as usize];
        return Err(io::Error::other(format!(
            "vertex {v} at {position} does not fit the 32-bit numbers of STL"
        )));
    }
    let facet = |triangle: &[u32; 3]| {
        let corners = triangle.map(narrow);
        // In f64, where the product of small edges cannot vanish.
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        let normal = (b - a).cross(c - a).normalize_or_zero().as_vec3();
        Triangle {
            normal: Normal::new(normal.to_array()),
            vertices: corners.map(|p| Vertex::new(p.to_array())),
        }
    };
    let mut titled = Titled { out, written: 0 };
    stl_io::write_stl(&mut titled, triangles.iter().map(facet))
}

/// Replaces the blank title that `stl_io` writes.
struct Titled<'a, W> {
    out: &'a mut W,
    written: usize,
}

impl<W: io::Write> io::Write for Titled<'_, W> {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        const NAME: &[u8; 11] = b"steadysweep";
        let titled: Vec<u8>;
        let bytes = if self.written < NAME.len() {
            let name = NAME[self.written..].iter().copied();
            titled = name.zip(buffer).map(|(title, _)| title).collect();
            &titled
        } else {
            buffer
        };
        let count = self.out.write(bytes)?;
        self.written += count;
        Ok(count)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::tests::tetrahedron;

    fn binary() -> Vec<u8> {
        let (positions, triangles) = tetrahedron();
        let mut bytes = Vec::new();
        write(&mut bytes, &positions, &triangles).expect("a vector takes everything");
        bytes
    }

    const TEXT: &str = "solid a b\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 1e-3\n   vertex 0 1 0\n  \
                        endloop\n endfacet\nendsolid a b\n";

    fn message(bytes: impl Into<Vec<u8>>) -> String {
        read(bytes.into()).expect_err("refused").to_string()
    }

    #[test]
    fn binary_files_come_back_as_written() {
        let bytes = binary();
        assert_eq!(bytes.len(), 84 + 4 * 50, "header and four triangles");
        assert!(bytes.starts_with(b"steadysweep\0\0"), "title");
        let list = read(bytes).expect("binary");
        let (positions, triangles) = tetrahedron();
        let corners: Vec<DVec3> = triangles
            .iter()
            .flatten()
            .map(|&v| positions[v as usize])
            .collect();
        assert_eq!(list.positions, corners, "coordinates are exact in f32");
    }

    #[test]
    fn normals_are_unit_and_outward() {
        let normals: Vec<[f32; 3]> = binary()[HEADER..]
            .chunks(TRIANGLE)
            .map(|t| {
                [0, 4, 8].map(|i| f32::from_le_bytes(t[i..i + 4].try_into().expect("4 bytes")))
            })
            .collect();
        assert_eq!(normals[0], [0.0, 0.0, -1.0], "bottom");
        assert_eq!(normals[1], [0.0, -1.0, 0.0], "front");
    }

    #[test]
    fn a_binary_file_that_begins_with_solid_is_binary() {
        let mut bytes = binary();
        bytes[..80].fill(b' ');
        bytes[..12].copy_from_slice(b"solid binary");
        assert_eq!(read(bytes).expect("binary").triangles.len(), 4);
    }

    #[test]
    fn text_keeps_full_precision_and_joins_several_solids() {
        let twice = TEXT
            .repeat(2)
            .to_uppercase()
            .replace("1E-3", "0.12345678901234567");
        let list = read(twice.into_bytes()).expect("text");
        assert_eq!(list.triangles, [[0, 1, 2], [3, 4, 5]]);
        assert_eq!(
            list.positions[4].z, 0.123_456_789_012_345_67,
            "not narrowed"
        );
        let windows = TEXT.replace('\n', "\r\n").replace("solid a b", "solid");
        assert_eq!(
            read(windows.into_bytes()).expect("text").triangles.len(),
            1,
            "CRLF and no name"
        );
    }

    #[test]
    fn a_cut_binary_file_says_how_many_triangles_it_holds() {
        let bytes = binary();
        assert_eq!(
            message(&bytes[..84 + 120]),
            "the header claims 4 triangles (200 bytes), but the file holds 2 (120 bytes): it is cut off or damaged; \
             export it again"
        );
        assert_eq!(
            message(&bytes[..60]),
            "expected at least the 84 bytes of the header of a binary STL, found 60 bytes; the file is cut off: \
             export it again"
        );
    }

    #[test]
    fn a_file_that_claims_four_billion_triangles_is_refused_before_anything_is_allocated() {
        let mut bytes = binary();
        bytes[80..84].fill(0xff);
        assert!(message(bytes).contains(
            "claims 4294967295 triangles (214748364750 bytes), but the file holds 4 (200 bytes)"
        ));
    }

    #[test]
    fn numbers_that_are_not_finite_are_named_with_their_place() {
        let mut bytes = binary();
        bytes[84 + 50 + 12..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
        let text = message(bytes);
        assert!(
            text.starts_with(
                "triangle 1 (counted from 0, at byte 134): expected finite coordinates, found [NaN"
            ),
            "{text}"
        );
        for bad in ["nan", "inf", "1e999", "1,0", "1 2"] {
            let text = message(TEXT.replace("1e-3", bad));
            assert!(
                text.starts_with(
                    "line 5: expected \"vertex\" and three finite numbers, found \"vertex 1 0"
                ),
                "{text}"
            );
        }
    }

    #[test]
    fn broken_text_is_named_with_its_line() {
        let text = message(TEXT.replace("   vertex 0 1 0\n", ""));
        assert!(
            text.starts_with(
                "line 7: expected three vertices before \"endfacet\", found \"endfacet\""
            ),
            "{text}"
        );
        let whole = TEXT.find("endsolid").expect("the end");
        assert_eq!(
            message(&TEXT[..whole]),
            "line 8: expected \"endsolid\" at the end, found the end of the file after 1 whole triangles; the file is cut off: \
             export it again"
        );
        let text = message("hello\nworld");
        assert!(
            text.starts_with("line 1: expected \"solid\", as a text STL begins"),
            "{text}"
        );
        assert!(text.contains("found \"hello\""), "{text}");
        let text = message(TEXT.replace("facet normal", "polygon"));
        assert!(
            text.starts_with("line 2: expected \"facet\" or \"endsolid\", found \"polygon 0 0 1\""),
            "{text}"
        );
    }

    #[test]
    fn coordinates_beyond_f32_are_not_written() {
        let (mut positions, triangles) = tetrahedron();
        positions[1].x = 1e39;
        let error = write(&mut Vec::new(), &positions, &triangles).expect_err("too large");
        assert!(error.to_string().contains("vertex 1"), "{error}");
    }
}
