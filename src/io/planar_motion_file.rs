//! Motion files of the plane: keyframes or spans, as JSON.
//!
//! ```json
//! {"keyframes": [{"time": 0, "matrix": [[1,0,0], [0,1,0]]},
//!                {"time": 1, "translation": [0,3], "rotation_deg": 90, "scale": [1,1]}]}
//! {"spans": [{"turn_deg": 540, "through": [0,0], "scale": 1, "duration": 1},
//!            {"generator": [[0,0,1], [0,0,0]], "duration": 2}]}
//! ```
//!
//! As in space (`motion_file`), with angles in degrees, from x towards y: counter-clockwise where y is up. A file may fit only one of the two: what
//! belongs to space is refused by name.

use super::error::{InputError, InputProblem};
use super::mesh_file::read_bytes;
use super::motion_file::{Written, motion_in, parse, timed, without_mark};
use super::motion_items::Key;
use super::planar_motion_items::SPATIAL;
use crate::motion::planar::{Keyframe, Motion, Span};
use crate::motion::{self, HalfTurns};
use glam::DAffine2;
use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny, SeqAccess, Visitor};
use serde_json::Value;
use std::fmt;
use std::path::Path;

/// A motion of a file that may be of either dimension.
#[derive(Debug, Clone)]
pub enum AnyMotion {
    /// In the plane.
    Plane(Motion),
    /// In space.
    Space(motion::Motion),
}

/// Where a motion takes place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Two coordinates.
    Plane,
    /// Three coordinates.
    Space,
}

/// Reads a motion in the plane from a JSON file.
///
/// # Errors
/// [`InputError`] with line, column and number of the key or span where the file is not as described, also where it
/// describes a motion in space, and around [`MotionError`](crate::motion::MotionError) where its poses make no motion, or are half
/// a turn apart.
pub fn read_planar_motion(path: &Path) -> Result<Motion, InputError> {
    read_planar_motion_turning(path, &HalfTurns::Refused)
}

/// [`read_planar_motion`] with the senses of half turns between keyframes chosen.
///
/// # Errors
/// As [`read_planar_motion`], except for half turns.
pub fn read_planar_motion_turning(
    path: &Path,
    half_turns: &HalfTurns,
) -> Result<Motion, InputError> {
    read_bytes(path)
        .and_then(|bytes| planar_motion_in(&bytes, half_turns))
        .map_err(|problem| InputError::new(path, problem))
}

/// Reads a motion in the plane from the bytes of a JSON file; see [`read_planar_motion`].
///
/// # Errors
/// [`InputProblem`] with the place in the bytes.
pub fn parse_planar_motion(bytes: &[u8]) -> Result<Motion, InputProblem> {
    planar_motion_in(bytes, &HalfTurns::Refused)
}

fn planar_motion_in(bytes: &[u8], half_turns: &HalfTurns) -> Result<Motion, InputProblem> {
    let foreign = [
        ("rotation", "give \"rotation_deg\""),
        ("axis", "leave it out, turns are from x towards y"),
        (
            "advance",
            "for a translation by x, y give \"generator\": [[0, 0, x], [0, 0, y]]",
        ),
    ]
    .map(|(field, remedy)| (field, format!("{SPATIAL}; {remedy}")));
    let motion = match parse::<Key<DAffine2>, Span>(bytes, &foreign)? {
        Written::Keyframes(keys) => {
            let keys = timed(keys)?.map(|(time, pose)| Keyframe { time, pose });
            Motion::from_keyframes_turning(&keys.collect::<Vec<_>>(), half_turns)
        }
        Written::Spans(spans) => Motion::from_spans(spans),
    };
    motion.map_err(InputProblem::Motion)
}

/// Reads a motion from a JSON file, in the plane or in space as the file says, with the senses of half turns between keyframes
/// chosen.
///
/// A file that says neither, such as one that only scales about the origin, is read as a motion in space.
///
/// # Errors
/// Those of [`read_motion`](super::read_motion) or [`read_planar_motion`].
pub fn read_any_motion(path: &Path, half_turns: &HalfTurns) -> Result<AnyMotion, InputError> {
    read_bytes(path)
        .and_then(|bytes| parse_any_motion(&bytes, half_turns))
        .map_err(|problem| InputError::new(path, problem))
}

/// Reads a motion from the bytes of a JSON file; see [`read_any_motion`].
///
/// # Errors
/// [`InputProblem`] with the place in the bytes.
pub fn parse_any_motion(bytes: &[u8], half_turns: &HalfTurns) -> Result<AnyMotion, InputProblem> {
    match motion_dimension(bytes) {
        Some(Dimension::Plane) => planar_motion_in(bytes, half_turns).map(AnyMotion::Plane),
        Some(Dimension::Space) | None => motion_in(bytes, half_turns).map(AnyMotion::Space),
    }
}

/// The dimension that the numbers and names in a motion file fit; `None` where they fit both, or where it is no motion file.
pub fn motion_dimension(bytes: &[u8]) -> Option<Dimension> {
    let Lists { keyframes, spans } = serde_json::from_slice(without_mark(bytes)).ok()?;
    [keyframes, spans]
        .into_iter()
        .flatten()
        .find_map(|Said(dimension)| dimension)
}

/// The lists of a motion file. A file in which they are no lists is refused by whoever reads it.
#[derive(Deserialize)]
struct Lists {
    keyframes: Option<Said>,
    spans: Option<Said>,
}

/// What the items of a list say of its dimension. They are read one at a time: there may be
/// millions.
struct Said(Option<Dimension>);

impl<'de> Deserialize<'de> for Said {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Said, D::Error> {
        deserializer.deserialize_seq(SaidVisitor)
    }
}

struct SaidVisitor;

impl<'de> Visitor<'de> for SaidVisitor {
    type Value = Said;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Said, A::Error> {
        let mut said = None;
        while said.is_none()
            && let Some(item) = list.next_element::<Value>()?
        {
            let mut fields = item.as_object().into_iter().flatten();
            said = fields.find_map(|(name, value)| dimension_of(name, value));
        }
        while list.next_element::<IgnoredAny>()?.is_some() {}
        Ok(Said(said))
    }
}

fn dimension_of(name: &str, value: &Value) -> Option<Dimension> {
    let length = |value: &Value| value.as_array().map(Vec::len);
    match name {
        "rotation" | "axis" | "advance" => Some(Dimension::Space),
        "rotation_deg" => Some(Dimension::Plane),
        "translation" | "through" | "scale" => match length(value)? {
            2 => Some(Dimension::Plane),
            3 => Some(Dimension::Space),
            _ => None,
        },
        "matrix" | "generator" => {
            let rows = value.as_array()?;
            match (rows.len(), length(rows.first()?)?) {
                (2, 3) => Some(Dimension::Plane),
                (_, 4) => Some(Dimension::Space),
                _ => None,
            }
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    fn motion(text: &str) -> Motion {
        parse_planar_motion(text.as_bytes()).unwrap_or_else(|problem| panic!("{problem}"))
    }
    fn message(text: &str) -> String {
        parse_planar_motion(text.as_bytes())
            .expect_err("refused")
            .to_string()
    }
    fn key_message(fields: &str) -> String {
        message(&format!("{{\"keyframes\": [{{}}, {{{fields}}}]}}"))
    }
    fn span_message(fields: &str) -> String {
        message(&format!("{{\"spans\": [{{}}, {{{fields}}}]}}"))
    }

    #[test]
    fn keyframes_are_read_as_matrices_and_as_translation_rotation_scale() {
        let motion = motion(
            "\u{feff}{\"keyframes\": [{\"time\": 2, \"matrix\": [[1,0,0],[0,1,0]]},
               {\"time\": 2.5, \"translation\": [0,3], \"rotation_deg\": 90, \"scale\": [2,3]}, {\"time\": 4, \"scale\": 2}]}",
        );
        assert_eq!(motion.joint_times(), [2.0, 2.5, 4.0]);
        let pose = motion.joints()[1];
        let images = [DVec2::X, DVec2::Y].map(|point| pose.transform_point2(point));
        let expected = [DVec2::new(0.0, 5.0), DVec2::new(-3.0, 3.0)];
        for (image, expected) in images.iter().zip(expected) {
            assert!((*image - expected).length() < 1e-15, "{image}");
        }
    }

    #[test]
    fn spans_are_read_as_spirals_and_as_generators() {
        let motion = motion(
            "{\"spans\": [{\"turn_deg\": 90, \"through\": [1,0]}, {\"generator\": [[0,0,1],[0,0,0]], \"duration\": 2},
              {\"scale\": 0.5}, {}]}",
        );
        assert_eq!(motion.joint_times(), [0.0, 1.0, 3.0, 4.0, 5.0]);
        let end = |k: usize| motion.joints()[k].transform_point2(DVec2::new(2.0, 0.0));
        let expected = [(1.0, 1.0), (2.0, 1.0), (1.0, 0.5), (1.0, 0.5)];
        for (k, expected) in expected.into_iter().enumerate() {
            let gap = (end(k + 1) - DVec2::from(expected)).length();
            assert!(gap < 1e-15, "after span {k}: {}", end(k + 1));
        }
    }

    #[test]
    fn what_belongs_to_space_is_refused_by_name() {
        let cases = [
            (
                key_message("\"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]"),
                "keyframe 1: \"matrix\" is 3 x 4: a motion in space, a drawing needs one in the plane, 2 rows of 3 numbers",
            ),
            (
                key_message("\"rotation\": [0,0,0,1]"),
                "keyframe 1: \"rotation\" belongs to a motion in space, a drawing needs one in the plane; give \"rotation_deg\"",
            ),
            (
                key_message("\"translation\": [1,2,3]"),
                "keyframe 1: \"translation\" has 3 numbers: a motion in space",
            ),
            (
                key_message("\"scale\": [1,2,3]"),
                "keyframe 1: \"scale\" has 3 numbers: a motion in space",
            ),
            (
                span_message("\"axis\": [0,0,1]"),
                "span 1: \"axis\" belongs to a motion in space",
            ),
            (
                span_message("\"advance\": 3"),
                "span 1: \"advance\" belongs to a motion in space",
            ),
            (
                span_message("\"generator\": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]"),
                "span 1: \"generator\" is 3 x 4: a motion in space",
            ),
        ];
        for (text, expected) in cases {
            assert!(text.contains(expected), "{text}");
        }
    }

    #[test]
    fn what_is_not_as_it_should_be_is_named() {
        let text = key_message("\"matrx\": 3");
        assert!(
            text.contains(
                "keyframe 1: unknown field `matrx`, expected one of `time`, `matrix`, `translation`, `rotation_deg`, `scale`"
            ),
            "{text}"
        );
        let text = span_message("\"turn\": 3");
        assert!(text.contains("span 1: unknown field `turn`"), "{text}");
        let text = key_message("\"matrix\": [[1,0,0],[0,1,0],[0,0,1]]");
        assert!(
            text.contains("found 3 rows of 3; leave out the last row"),
            "{text}"
        );
        let text = key_message("\"matrix\": [[1,0],[0,1]]");
        assert!(
            text.contains("expected 2 rows of 3 numbers, found 2 rows of 2"),
            "{text}"
        );
        let text = span_message("\"through\": [1]");
        assert!(text.contains("expected 2 numbers, found 1"), "{text}");
        for bad in ["0", "[1,-2]", "\"a\""] {
            let text = key_message(&format!("\"scale\": {bad}"));
            assert!(
                text.contains("expected a number above 0 or two of them, found "),
                "{text}"
            );
        }
        let text = key_message("\"matrix\": [], \"scale\": 2");
        assert!(text.contains("expected \"matrix\" alone"), "{text}");
        let text = span_message("\"generator\": [], \"scale\": 2");
        assert!(text.contains("expected \"generator\" alone"), "{text}");
        let text = span_message("\"scale\": -2");
        assert!(text.contains("span 1: the scale is -2"), "{text}");
        let text = key_message("\"matrix\": [[1,0,0],[0,-1,0]]");
        assert!(text.starts_with("keyframe 1: a reflection"), "{text}");
        let text = key_message("\"matrix\": [[-1,0,0],[0,-2,0]]");
        assert!(
            text.starts_with("between keyframes 0 and 1: no steady motion leads there"),
            "{text}"
        );
    }

    #[test]
    fn the_dimension_of_a_file_is_seen_in_its_numbers_and_names() {
        let cases = [
            ("{\"spans\": [{\"turn_deg\": 90}]}", None),
            ("{\"spans\": [{}, {\"scale\": 2}]}", None),
            ("not a file", None),
            (
                "{\"spans\": [{}, {\"turn_deg\": 90, \"through\": [1,2]}]}",
                Some(Dimension::Plane),
            ),
            (
                "{\"spans\": [{\"generator\": [[0,0,1],[0,0,0]]}]}",
                Some(Dimension::Plane),
            ),
            (
                "{\"keyframes\": [{}, {\"rotation_deg\": 5}]}",
                Some(Dimension::Plane),
            ),
            (
                "{\"keyframes\": [{}, {\"translation\": [1,2,3]}]}",
                Some(Dimension::Space),
            ),
            (
                "{\"spans\": [{\"turn_deg\": 90, \"axis\": [0,0,1]}]}",
                Some(Dimension::Space),
            ),
        ];
        for (text, expected) in cases {
            assert_eq!(motion_dimension(text.as_bytes()), expected, "{text}");
        }
        let any = |text: &str| parse_any_motion(text.as_bytes(), &HalfTurns::Refused);
        let text = any(cases[0].0).expect_err("refused").to_string();
        assert!(
            text.contains("expected \"axis\"") && text.contains("in the plane"),
            "a turn without an axis may be either: {text}"
        );
        assert!(
            matches!(any(cases[1].0), Ok(AnyMotion::Space(_))),
            "where both would do, space"
        );
        let text = any("{\"spans\": [{\"turn_deg\": true}]}")
            .expect_err("refused")
            .to_string();
        assert!(text.contains("expected a number, found boolean"), "{text}");
    }
}
