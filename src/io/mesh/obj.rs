//! OBJ.
//!
//! Only vertices and faces make a body; groups, materials, normals and texture coordinates are left
//! out. This module parses the text itself, because a message must name the line, and libraries
//! split the body into one mesh per group and renumber its vertices.

use super::list::{TriangleList, number};
use super::polygon::{too_involved, triangulate};
use crate::io::error::{EXPORT_AGAIN, InputProblem, Place, quote};
use glam::DVec3;
use std::borrow::Cow;
use std::io;

/// The vertices in the order of the file, and the faces as triangles.
pub(super) fn read(bytes: &[u8]) -> Result<TriangleList, InputProblem> {
    let text = String::from_utf8_lossy(bytes);
    // Some editors mark UTF-8 with this character.
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let [vertices, faces] = counts(text);
    if faces == 0 {
        return Err(InputProblem::Malformed {
            place: Place::File,
            expected: "lines \"v x y z\" and \"f i j k\"".to_owned(),
            found: format!(
                "none, it begins with {}",
                quote(text.lines().next().unwrap_or_default())
            ),
            remedy: "this is no OBJ file with a mesh",
        });
    }
    let mut list = TriangleList::default();
    let mut corners: Vec<u32> = Vec::new();
    // For each face its line, and where its corners end in the list.
    let mut ends = Vec::with_capacity(faces);
    for (line, text) in logical_lines(text) {
        let mut words = words(&text);
        match words.next() {
            Some("v") => match position(words) {
                Some(position) => list.positions.push(position),
                None => {
                    let expected = "three finite coordinates".to_owned();
                    return Err(malformed(line, &text.replace('\n', " "), expected));
                }
            },
            Some("f") => {
                let indices = Indices {
                    vertices,
                    above: list.positions.len(),
                };
                for word in words {
                    match indices.vertex(word) {
                        Some(vertex) => corners.push(number(vertex)),
                        None => return Err(indices.refusal(line, &text)),
                    }
                }
                ends.push((line, corners.len()));
            }
            _ => {}
        }
    }
    // Not before all lines are read: faces may stand before their vertices.
    let mut start = 0;
    for (line, end) in ends {
        if !list.push_polygon(&corners[start..end], triangulate) {
            return Err(InputProblem::Malformed {
                place: Place::Line(line),
                expected: "a simple polygon".to_owned(),
                found: too_involved(end - start),
                remedy: "export triangles",
            });
        }
        start = end;
    }
    Ok(list)
}

/// Numbers of vertices and of faces.
fn counts(text: &str) -> [usize; 2] {
    let mut counts = [0; 2];
    for (_, line) in logical_lines(text) {
        match words(&line).next() {
            Some("v") => counts[0] += 1,
            Some("f") => counts[1] += 1,
            _ => {}
        }
    }
    counts
}

/// The finite position x y z, or x y z w with weight w; any other numbers after the first three are
/// a colour.
fn position<'a>(mut words: impl Iterator<Item = &'a str>) -> Option<DVec3> {
    let mut coordinate = || words.next()?.parse::<f64>().ok();
    let place = DVec3::new(coordinate()?, coordinate()?, coordinate()?);
    let place = match (words.next(), words.next()) {
        (Some(weight), None) => {
            let weight = weight.parse::<f64>().ok().filter(|w| w.is_finite())?;
            place / weight
        }
        _ => place,
    };
    place.is_finite().then_some(place)
}

/// What the indices of a face may be.
struct Indices {
    /// Number of vertices in the whole file.
    vertices: usize,
    /// Number of vertices above the face, from which negative indices count back.
    above: usize,
}

impl Indices {
    /// The vertex of a corner, counted from 0.
    fn vertex(&self, word: &str) -> Option<usize> {
        let index: i64 = word.split('/').next()?.parse().ok()?;
        let distance = usize::try_from(index.unsigned_abs()).ok()?;
        if index > 0 {
            (distance <= self.vertices).then(|| distance - 1)
        } else if index < 0 {
            self.above.checked_sub(distance)
        } else {
            None
        }
    }

    /// Says which line of a face is at fault; the face may continue over several lines.
    fn refusal(&self, line: usize, face: &str) -> InputProblem {
        // The word "f" stands before the indices.
        let mut is_before = true;
        for (line, part) in (line..).zip(before_comment(face).split('\n')) {
            let mut words = part.split_whitespace();
            is_before = is_before && words.next().is_none();
            if words.any(|word| self.vertex(word).is_none()) {
                return malformed(line, part, self.words());
            }
        }
        malformed(line, face, self.words())
    }

    /// The allowed range in words: the vertices of the whole file, or those above the line, counted
    /// backwards.
    fn words(&self) -> String {
        match (self.vertices, self.above) {
            (0, _) => "lines \"v x y z\" that say where the vertices are".to_owned(),
            (vertices, 0) => format!("indices from 1 to {vertices}"),
            (vertices, above) => {
                format!("indices from 1 to {vertices}, or from -1 to -{above} here")
            }
        }
    }
}

fn malformed(line: usize, found: &str, expected: String) -> InputProblem {
    InputProblem::Malformed {
        place: Place::Line(line),
        expected,
        found: quote(found),
        remedy: EXPORT_AGAIN,
    }
}

/// Lines with their numbers from 1. A line that ends in a backslash continues in the next: both are
/// one text, in which the line break is kept.
fn logical_lines(text: &str) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let mut lines = (1..).zip(text.lines());
    std::iter::from_fn(move || {
        let (number, line) = lines.next()?;
        let Some(start) = line.strip_suffix('\\') else {
            return Some((number, Cow::Borrowed(line)));
        };
        // One text that grows: copying it for each continued line would take a time that grows as
        // the square of their number.
        let mut whole = start.to_owned();
        for (_, rest) in lines.by_ref() {
            whole.push('\n');
            let Some(rest) = rest.strip_suffix('\\') else {
                whole.push_str(rest);
                break;
            };
            whole.push_str(rest);
        }
        Some((number, Cow::Owned(whole)))
    })
}

fn before_comment(line: &str) -> &str {
    line.split('#').next().unwrap_or_default()
}

/// The words before a comment.
fn words(line: &str) -> impl Iterator<Item = &str> {
    before_comment(line).split_whitespace()
}

/// Writes an OBJ file with coordinates in the shortest form that reads back as the same number.
pub(super) fn write(
    out: &mut impl io::Write,
    positions: &[DVec3],
    triangles: &[[u32; 3]],
) -> io::Result<()> {
    writeln!(out, "# steadysweep")?;
    for p in positions {
        writeln!(out, "v {:?} {:?} {:?}", p.x, p.y, p.z)?;
    }
    for t in triangles {
        let [a, b, c] = t.map(|v| u64::from(v) + 1);
        writeln!(out, "f {a} {b} {c}")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::tests::tetrahedron;

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    fn triangles(faces: &str) -> Vec<[u32; 3]> {
        read(format!("{SQUARE}{faces}").as_bytes())
            .expect("an OBJ")
            .triangles
    }

    fn message(faces: &str) -> String {
        read(format!("{SQUARE}{faces}").as_bytes())
            .expect_err("refused")
            .to_string()
    }

    #[test]
    fn faces_may_have_slashes_negative_indices_and_many_corners() {
        assert_eq!(
            triangles("f 4 2 1\n"),
            [[3, 1, 0]],
            "vertices keep the numbers of the file"
        );
        assert_eq!(
            triangles("f 1/7/9 2//4 3/1"),
            [[0, 1, 2]],
            "texture and normal indices do not matter"
        );
        assert_eq!(
            triangles("f -4 -3 -2 -1\n"),
            [[0, 1, 2], [0, 2, 3]],
            "from the end, a square"
        );
        assert_eq!(triangles("f 1 2 \\\n 3\n"), [[0, 1, 2]], "continued line");
        assert_eq!(
            triangles("o a\ng b\nusemtl c\nmtllib d\nf 1 2 3 # comment\ng e\nf 3 4 1\n"),
            [[0, 1, 2], [2, 3, 0]]
        );
        assert_eq!(
            triangles("l 1 2\np 1\nf 1 2\nf 1 2 3\nf 4\nf\n"),
            [[0, 1, 0], [0, 1, 2], [3, 3, 3]],
            "points and lines are no faces; faces of fewer than three corners have no area"
        );
    }

    #[test]
    fn vertices_may_have_weights_and_colours() {
        let list = read(b"v 2 4 6 2\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0\nf 1 2 3\n").expect("an OBJ");
        assert_eq!(
            list.positions,
            [DVec3::new(1.0, 2.0, 3.0), DVec3::X, DVec3::Y]
        );
    }

    #[test]
    fn coordinates_come_back_bit_by_bit() {
        let (mut positions, triangles) = tetrahedron();
        positions[1] = DVec3::new(0.1 + 0.2, -1.0 / 3.0, 1e-300);
        positions[2] = DVec3::new(f64::MAX, f64::MIN_POSITIVE, -0.0);
        let mut bytes = Vec::new();
        write(&mut bytes, &positions, &triangles).expect("a vector takes everything");
        let list = read(&bytes).expect("an OBJ");
        let bits = |points: &[DVec3]| {
            points
                .iter()
                .map(|p| p.to_array().map(f64::to_bits))
                .collect::<Vec<_>>()
        };
        assert_eq!(bits(&list.positions), bits(&positions));
        assert_eq!(list.triangles, triangles);
    }

    #[test]
    fn a_wrong_index_is_named_with_its_line() {
        assert_eq!(
            message("f 1 2 3\nf 1 2 99\n"),
            "line 6: expected indices from 1 to 4, or from -1 to -4 here, found \"f 1 2 99\"; the file is damaged: correct \
             the place or export it again"
        );
        for bad in [
            "0",
            "-5",
            "x",
            "/1",
            "99999999999999999999",
            "-9223372036854775808",
            "9223372036854775807",
            "1.5",
        ] {
            let text = message(&format!("f 1 2 {bad}\n"));
            assert!(
                text.starts_with("line 5: expected indices from 1 to 4"),
                "{bad}: {text}"
            );
        }
    }

    #[test]
    fn a_wrong_index_on_a_line_that_is_continued_is_named_with_the_line_that_it_is_on() {
        for (faces, line) in [
            ("f 1 2 \\\n 3 99 \\\n 4\n", 6),
            ("\\\nf 1 2 \\\n\\\n f\n", 8),
            ("f \\\n0 2 3 # 4 \\\n5\n", 6),
        ] {
            let text = message(faces);
            let start = format!("line {line}: expected indices from 1 to 4");
            assert!(text.starts_with(&start), "{faces:?}: {text}");
        }
        let text = message("f 1 2 3\nv 1 \\\n 2\n");
        assert!(
            text.starts_with("line 6: expected three finite coordinates, found \"v 1   2\""),
            "{text}"
        );
    }

    #[test]
    fn continued_lines_take_no_time_that_grows_as_their_square() {
        // Copied anew for each line, this would be 2e12 bytes.
        let lines = 1_000_000;
        let text = format!("{SQUARE}f 1 \\\n{}2 3\n", "\\\n".repeat(lines));
        let list = read(text.as_bytes()).expect("an OBJ");
        assert_eq!(list.triangles, [[0, 1, 2]]);
    }

    #[test]
    fn faces_may_stand_before_their_vertices() {
        let list = read(format!("f 1 2 3\n{SQUARE}").as_bytes()).expect("an OBJ");
        assert_eq!(list.triangles, [[0, 1, 2]]);
        let text = read(format!("f 1 2 -1\n{SQUARE}").as_bytes())
            .expect_err("refused")
            .to_string();
        assert!(
            text.starts_with("line 1: expected indices from 1 to 4, found"),
            "no vertex stands above the line: {text}"
        );
    }

    #[test]
    fn a_mark_of_utf_8_is_no_part_of_the_first_vertex() {
        let list = read(format!("\u{feff}{SQUARE}f 1 2 3\n").as_bytes()).expect("an OBJ");
        assert_eq!(list.positions.len(), 4, "the first vertex counts");
        assert_eq!(list.triangles, [[0, 1, 2]]);
    }

    #[test]
    fn a_wrong_number_is_named_with_its_line() {
        for bad in [
            "v 1 2",
            "v 1 2 x",
            "v 1 nan 3",
            "v inf 0 0",
            "v 1 1e999 1",
            "v 1 2 3 0",
            "v 1 2 3 nan",
            "v 1 2 3 inf",
            "v 1 2 3 x",
            "v 1e300 1e300 1e300 1e-300",
        ] {
            let text = message(&format!("\n{bad}\nf 1 2 3\n"));
            assert!(
                text.starts_with("line 6: expected three finite coordinates, found \"v "),
                "{bad}: {text}"
            );
        }
    }

    #[test]
    fn a_file_without_faces_is_no_mesh() {
        assert!(
            message("").starts_with("expected lines \"v x y z\" and \"f i j k\", found none"),
            "vertices only"
        );
        let text = read(b"\xff\xfe\x00garbage")
            .expect_err("refused")
            .to_string();
        assert!(text.contains("this is no OBJ file with a mesh"), "{text}");
        let text = read(b"f 1 2 3\n").expect_err("refused").to_string();
        assert!(
            text.starts_with("line 1: expected lines \"v x y z\" that say where"),
            "no vertices: {text}"
        );
    }
}
