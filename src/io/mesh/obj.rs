//! OBJ, through `tobj`.
//!
//! Only vertices and faces make a body; groups, materials, normals and texture coordinates are left out before `tobj`
//! sees them (it would split the body into one mesh per group). Where it refuses, the place is looked up in the text.

use super::list::TriangleList;
use super::polygon::{too_involved, triangulate};
use crate::io::error::{EXPORT_AGAIN, InputProblem, Place, quote};
use glam::DVec3;
use std::borrow::Cow;
use std::io::{self, Cursor};
use tobj::{LoadError, LoadOptions, load_obj_buf};

/// Vertices in the order of the file, faces as triangles.
pub(super) fn read(bytes: &[u8]) -> Result<TriangleList, InputProblem> {
    let text = String::from_utf8_lossy(bytes);
    // Some editors mark UTF-8 by this character.
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let (essence, lines) = essence(text);
    if lines.is_empty() {
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
    let options = LoadOptions::default();
    let mut models = match load_obj_buf(&mut Cursor::new(essence), &options, |_| {
        Err(LoadError::ReadError)
    }) {
        Ok((models, _)) => models,
        Err(error) => return Err(locate(text, &error.to_string())),
    };
    let Some(mesh) = models.pop().map(|model| model.mesh) else {
        return Err(locate(text, "no mesh"));
    };
    let positions: Vec<DVec3> = mesh
        .positions
        .chunks_exact(3)
        .map(DVec3::from_slice)
        .collect();
    if !positions.iter().all(|p| p.is_finite()) {
        return Err(locate(text, "a coordinate that is not finite"));
    }
    let mut list = TriangleList {
        positions,
        ..TriangleList::default()
    };
    let mut start = 0;
    // The first face is ours, see `essence`. No arities mean triangles only.
    for face in 0..=lines.len() {
        let arity = mesh.face_arities.get(face).map_or(3, |&n| n as usize);
        let corners = &mesh.indices[start..start + arity];
        start += arity;
        if face > 0 && !list.push_polygon(corners, triangulate) {
            return Err(InputProblem::Malformed {
                place: Place::Line(lines[face - 1]),
                expected: "a simple polygon".to_owned(),
                found: too_involved(arity),
                remedy: "export triangles",
            });
        }
    }
    Ok(list)
}

/// The vertices and faces of a file as text for `tobj`, and the line of each face.
///
/// A face over all vertices comes first: `tobj` numbers vertices in the order of their first use, with it that is the order
/// of the file.
fn essence(text: &str) -> (String, Vec<usize>) {
    let mut body = String::with_capacity(text.len());
    let (mut vertices, mut faces) = (0, Vec::new());
    for (number, line) in logical_lines(text) {
        let mut words = words(&line);
        match words.next() {
            Some("v") => {
                vertices += 1;
                // x y z w, or x y z and colours of which only the first is a number we must not pass on.
                let numbers = words.clone().count();
                body.push('v');
                for word in words.take(if numbers == 4 { 4 } else { 3 }) {
                    body.extend([" ", word]);
                }
                body.push('\n');
            }
            Some("f") => {
                faces.push(number);
                body.push('f');
                for word in words {
                    // tobj refuses what is no number, and we say where it is.
                    let index = first_index(word);
                    body.extend([" ", if index.is_empty() { "?" } else { index }]);
                }
                body.push('\n');
            }
            _ => {}
        }
    }
    let mut essence = String::with_capacity(2 * body.len());
    essence.push('f');
    for v in 1..=vertices {
        essence.push_str(&format!(" {v}"));
    }
    essence.push('\n');
    essence.push_str(&body);
    (essence, faces)
}

/// Lines with their numbers from 1; a line that ends in a backslash goes on in the next, and is one
/// text with it, in which the end of the first is still to be seen.
fn logical_lines(text: &str) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let mut lines = (1..).zip(text.lines());
    std::iter::from_fn(move || {
        let (number, line) = lines.next()?;
        let Some(start) = line.strip_suffix('\\') else {
            return Some((number, Cow::Borrowed(line)));
        };
        // One text that grows: to copy what is there for each line that follows takes a time that
        // grows as their square.
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

/// Of the indices of a corner that of the vertex.
fn first_index(word: &str) -> &str {
    word.split('/').next().unwrap_or_default()
}

fn before_comment(line: &str) -> &str {
    line.split('#').next().unwrap_or_default()
}

/// Words before a comment.
fn words(line: &str) -> impl Iterator<Item = &str> + Clone {
    before_comment(line).split_whitespace()
}

/// The first line that is at fault.
fn locate(text: &str, reason: &str) -> InputProblem {
    let total = logical_lines(text)
        .filter(|(_, line)| words(line).next() == Some("v"))
        .count();
    let mut so_far = 0;
    for (number, line) in logical_lines(text) {
        let malformed = |number: usize, line: &str, expected: String| InputProblem::Malformed {
            place: Place::Line(number),
            expected,
            found: quote(line),
            remedy: EXPORT_AGAIN,
        };
        let mut words = words(&line);
        match words.next() {
            Some("v") => {
                so_far += 1;
                let numbers: Vec<f64> =
                    words.map(|word| word.parse().unwrap_or(f64::NAN)).collect();
                let weight = if let [_, _, _, w] = numbers[..] {
                    w
                } else {
                    1.0
                };
                let place = numbers.iter().take(3).map(|x| x / weight);
                if numbers.len() < 3
                    || !place.fold(weight, |sum, x| sum + x).is_finite()
                    || weight == 0.0
                {
                    let expected = "three finite coordinates".to_owned();
                    return malformed(number, &line.replace('\n', " "), expected);
                }
            }
            Some("f") => {
                let is_legal = |word: &str| match first_index(word).parse::<i64>() {
                    Ok(i) if i > 0 => usize::try_from(i).is_ok_and(|i| i <= total),
                    Ok(i) if i < 0 => usize::try_from(i.unsigned_abs()).is_ok_and(|i| i <= so_far),
                    _ => false,
                };
                // The word "f" stands before them.
                let mut is_before = true;
                for (number, part) in (number..).zip(before_comment(&line).split('\n')) {
                    let mut words = part.split_whitespace();
                    is_before = is_before && words.next().is_none();
                    if !words.all(is_legal) {
                        return malformed(number, part, legal_indices(total, so_far));
                    }
                }
            }
            _ => {}
        }
    }
    InputProblem::Malformed {
        place: Place::File,
        expected: "vertices and faces".to_owned(),
        found: reason.to_owned(),
        remedy: EXPORT_AGAIN,
    }
}

/// What may stand in a face: the vertices of the whole file, or backwards those above the line.
fn legal_indices(total: usize, above: usize) -> String {
    match (total, above) {
        (0, _) => "lines \"v x y z\" that say where the vertices are".to_owned(),
        (_, 0) => format!("indices from 1 to {total}"),
        _ => format!("indices from 1 to {total}, or from -1 to -{above} here"),
    }
}

/// Writes OBJ; coordinates in the shortest form that reads back as the same number.
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
