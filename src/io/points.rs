//! Lists of points: lines `x,y,z`, or `x,y` in the plane.

use super::error::{InputError, InputProblem, Place, quote};
use super::file::read_bytes;
use glam::{DVec2, DVec3};
use std::path::Path;

/// Reads points from a text file with three numbers per line, separated by commas.
///
/// The first line may be a header. Either it begins with `#`, or each of its fields, quoted or not,
/// begins with a letter and is no number (`nan`). A point with a slip in it, such as `1.2.3,4,5`,
/// is therefore never taken for a header. Blank lines, spaces around numbers and CRLF are allowed.
/// Every point is finite, and there is at least one.
///
/// # Errors
/// [`InputError`] with the line at fault.
pub fn read_points(path: &Path) -> Result<Vec<DVec3>, InputError> {
    bytes_of(path)
        .and_then(|bytes| parse_points(&bytes))
        .map_err(|problem| InputError::new(path, problem))
}

/// Reads points of the plane from a text file with two numbers per line, separated by commas;
/// otherwise as [`read_points`].
///
/// # Errors
/// [`InputError`] with the line at fault.
pub fn read_planar_points(path: &Path) -> Result<Vec<DVec2>, InputError> {
    bytes_of(path)
        .and_then(|bytes| parse_planar_points(&bytes))
        .map_err(|problem| InputError::new(path, problem))
}

/// Reads points from the bytes of a text file; see [`read_points`].
///
/// # Errors
/// [`InputProblem`] with the place in the bytes.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use steadysweep::io::parse_points;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// assert_eq!(parse_points(b"x,y,z\n0,0.5,1e-3\n")?, [DVec3::new(0.0, 0.5, 1e-3)]);
/// let error = parse_points(b"0,0,0\n1,2\n").expect_err("two numbers");
/// assert!(error.to_string().starts_with("line 2"));
/// # Ok(())
/// # }
/// ```
pub fn parse_points(bytes: &[u8]) -> Result<Vec<DVec3>, InputProblem> {
    let points = parse(
        bytes,
        &Expected {
            line: "x,y,z",
            numbers: "three finite numbers x,y,z",
            other: (2, "points of a body in space have three coordinates"),
        },
    )?;
    Ok(points.into_iter().map(DVec3::from_array).collect())
}

/// Reads points of the plane from the bytes of a text file; see [`read_planar_points`].
///
/// # Errors
/// [`InputProblem`] with the place in the bytes.
pub fn parse_planar_points(bytes: &[u8]) -> Result<Vec<DVec2>, InputProblem> {
    let points = parse(
        bytes,
        &Expected {
            line: "x,y",
            numbers: "two finite numbers x,y",
            other: (3, "points of a drawing have two coordinates"),
        },
    )?;
    Ok(points.into_iter().map(DVec2::from_array).collect())
}

/// The bytes of a file. There may be none: that is a list without points.
fn bytes_of(path: &Path) -> Result<Vec<u8>, InputProblem> {
    match read_bytes(path) {
        Err(InputProblem::Empty) => Ok(Vec::new()),
        other => other,
    }
}

/// Whether a first line names the columns or is a comment.
fn is_header(line: &str) -> bool {
    let is_name = |field: &str| {
        let field = field.trim().trim_matches(['"', '\'']);
        field.starts_with(char::is_alphabetic) && field.parse::<f64>().is_err()
    };
    line.trim_start().starts_with('#') || line.split(',').all(is_name)
}

/// Whether a line holds numbers separated by something other than commas.
fn otherwise_separated(line: &str) -> bool {
    let mut words = line
        .split([';', ' ', '\t'])
        .filter(|word| !word.is_empty())
        .peekable();
    words.peek().is_some() && words.all(|word| word.trim().parse::<f64>().is_ok())
}

/// What a line should hold, in words.
struct Expected {
    line: &'static str,
    numbers: &'static str,
    /// Number of fields in a line of the other dimension, and what a message says about such a
    /// line.
    other: (usize, &'static str),
}

fn parse<const N: usize>(bytes: &[u8], expected: &Expected) -> Result<Vec<[f64; N]>, InputProblem> {
    let text = String::from_utf8_lossy(bytes);
    // Some editors mark UTF-8 with this character.
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let lines = (1..)
        .zip(text.lines())
        .filter(|(_, line)| !line.trim().is_empty());
    let mut points = Vec::new();
    for (i, (number, line)) in lines.enumerate() {
        let fields: Vec<Option<f64>> = line
            .split(',')
            .map(|field| field.trim().parse().ok())
            .collect();
        let finite = fields.iter().map(|field| field.filter(|x| x.is_finite()));
        let numbers: Option<Vec<f64>> = finite.collect();
        match numbers.and_then(|numbers| <[f64; N]>::try_from(numbers).ok()) {
            Some(point) => points.push(point),
            None if i == 0 && is_header(line) => {}
            None => {
                let (others, remark) = expected.other;
                let remedy = if line.contains(';') {
                    "separate the numbers by commas, not by semicolons, and write decimals with points"
                } else if fields.len() == 1 && otherwise_separated(line) && line.contains('\t') {
                    "separate the numbers by commas, not by tabs"
                } else if fields.len() == 1 && otherwise_separated(line) {
                    "separate the numbers by commas, not by blanks"
                } else if fields.len() == others {
                    remark
                } else if i == 0 && fields.contains(&None) {
                    "correct or remove the line; a header begins with #, or each of its fields with a letter"
                } else {
                    "correct or remove the line"
                };
                return Err(InputProblem::Malformed {
                    place: Place::Line(number),
                    expected: expected.numbers.to_owned(),
                    found: quote(line),
                    remedy,
                });
            }
        }
    }
    if points.is_empty() {
        return Err(InputProblem::Malformed {
            place: Place::File,
            expected: format!("lines {}", expected.line),
            found: "no point".to_owned(),
            remedy: "add at least one point",
        });
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(text: &str) -> String {
        parse_points(text.as_bytes())
            .expect_err("refused")
            .to_string()
    }

    #[test]
    fn points_are_read_with_and_without_header() {
        let expected = [DVec3::new(1.0, -2.0, 3e-5), DVec3::new(0.5, 0.0, 7.0)];
        for text in [
            "1,-2,3e-5\n0.5,0,7\n",
            "x,y,z\n1,-2,3e-5\n0.5,0,7",
            "\u{feff}# points\r\n\r\n 1 , -2 , 3e-5 \r\n\r\n.5,0,+7\r\n\r\n",
        ] {
            assert_eq!(
                parse_points(text.as_bytes()).expect("points"),
                expected,
                "{text:?}"
            );
        }
    }

    #[test]
    fn a_wrong_line_is_named() {
        assert_eq!(
            message("x,y,z\n1,2,3\n\n1,2,z\n"),
            "line 4: expected three finite numbers x,y,z, found \"1,2,z\"; correct or remove the line"
        );
        assert!(
            message("1,2,3\nx,y,z\n").starts_with("line 2:"),
            "a header is the first line"
        );
        assert!(
            message("1,b,c\n").starts_with("line 1:"),
            "a header has no number"
        );
        assert!(
            message("1,2\n").ends_with("points of a body in space have three coordinates"),
            "planar points"
        );
        assert!(message("1,2,3,4\n").starts_with("line 1:"), "four numbers");
        assert!(message("1,2,nan\n").starts_with("line 1:"), "not finite");
        assert!(
            message("1,2,1e999\n").starts_with("line 1:"),
            "beyond all numbers"
        );
        for (text, separator) in [
            ("1 2 3\n", "blanks"),
            ("1;2;3\n", "semicolons"),
            ("x;y;z\n1,5;2,5;3\n", "semicolons"),
            ("1\t2\t3\n", "tabs"),
        ] {
            let remedy = format!("separate the numbers by commas, not by {separator}");
            assert!(
                message(text).contains(&remedy),
                "{text:?}: {}",
                message(text)
            );
        }
        assert!(message("").contains("no point"), "no line");
        assert!(message("1,2,3\n\u{0}\n").starts_with("line 2:"), "garbage");
        assert!(
            message("x,y,z\n").starts_with("expected lines x,y,z, found no point"),
            "only a header"
        );
    }

    #[test]
    fn a_header_is_a_remark_or_has_names_in_all_fields() {
        for header in [
            "x,y,z",
            " X [mm] , \"y\",'z'",
            "points",
            "#",
            "# 1,2,3",
            "\u{3b8},r,h",
        ] {
            let points = parse_points(format!("{header}\n1,2,3\n").as_bytes());
            assert_eq!(points, Ok(vec![DVec3::new(1.0, 2.0, 3.0)]), "{header}");
        }
        for slip in [
            "1.2.3",
            "1.2.3,4.5.6,7.8.9",
            "1,,0,5,2,0",
            "-x,-y,-z",
            "\u{2212}1,\u{2212}2,\u{2212}3",
            "0x1,0x2,0x3",
            "1_000,2_000,3_000",
            "\"1a\",2b,3c",
            "nan,nan,nan",
            "x,y,",
            ",,",
        ] {
            let text = message(&format!("{slip}\n1,2,3\n"));
            assert!(
                text.starts_with("line 1: expected three finite numbers x,y,z, found "),
                "{slip}: {text}"
            );
        }
        assert!(
            message("1.2.3\n")
                .ends_with("a header begins with #, or each of its fields with a letter"),
            "{}",
            message("1.2.3\n")
        );
    }

    #[test]
    fn points_of_the_plane_have_two_coordinates() {
        let points = parse_planar_points(b"x,y\n1,-2\n\n 3e-5 , 0\r\n");
        assert_eq!(
            points,
            Ok(vec![DVec2::new(1.0, -2.0), DVec2::new(3e-5, 0.0)])
        );
        let text = parse_planar_points(b"1,2\n1,2,3\n")
            .expect_err("refused")
            .to_string();
        assert_eq!(
            text,
            "line 2: expected two finite numbers x,y, found \"1,2,3\"; points of a drawing have two coordinates"
        );
    }
}
