//! Motion files: keyframes or spans, as JSON.
//!
//! ```json
//! {"keyframes": [{"time": 0, "matrix": [[1,0,0,0], [0,1,0,0], [0,0,1,0]]},
//!                {"time": 1, "translation": [0,0,3], "rotation": [0,0,0,1], "scale": [1,1,1]}]}
//! {"spans": [{"turn_deg": 540, "axis": [0,0,1], "through": [0,0,0], "advance": 3, "scale": 1, "duration": 1},
//!            {"generator": [[0,0,0,1], [0,0,0,0], [0,0,0,0]], "duration": 2}]}
//! ```
//!
//! - A keyframe maps body to world: by a matrix of 3 rows, or by scale (a number or one per axis), rotation (unit quaternion
//!   x, y, z, w) and translation, in this order; what is left out stays at rest. Without times the keys are one unit apart.
//! - A span acts on world coordinates and is described as a whole; `duration`, 1 when left out, is its share of the clock.
//! - Unknown fields are errors.

use super::error::{InputError, InputProblem, Place};
use super::mesh_file::read_bytes;
use super::motion_items::{Item, Key, PLANAR};
use super::motion_words::{Foreign, Object, words_of_json};
use crate::motion::{HalfTurns, Keyframe, Motion, Span};
use glam::DAffine3;
use serde::Deserialize;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use std::fmt;
use std::marker::PhantomData;
use std::path::Path;

/// Reads a motion from a JSON file.
///
/// # Errors
/// [`InputError`] with line, column and number of the key or span where the file is not as described, and around
/// [`MotionError`](crate::motion::MotionError) where its poses make no motion, or are half a turn apart.
pub fn read_motion(path: &Path) -> Result<Motion, InputError> {
    read_motion_turning(path, &HalfTurns::Refused)
}

/// [`read_motion`] with the senses of half turns between keyframes chosen.
///
/// # Errors
/// As [`read_motion`], except for half turns.
pub fn read_motion_turning(path: &Path, half_turns: &HalfTurns) -> Result<Motion, InputError> {
    read_bytes(path)
        .and_then(|bytes| motion_in(&bytes, half_turns))
        .map_err(|problem| InputError::new(path, problem))
}

/// Reads a motion from the bytes of a JSON file; see [`read_motion`].
///
/// # Errors
/// [`InputProblem`] with the place in the bytes.
pub fn parse_motion(bytes: &[u8]) -> Result<Motion, InputProblem> {
    motion_in(bytes, &HalfTurns::Refused)
}

pub(super) fn motion_in(bytes: &[u8], half_turns: &HalfTurns) -> Result<Motion, InputProblem> {
    let foreign = (
        "rotation_deg",
        format!("{PLANAR}; give \"rotation\" as a quaternion [x, y, z, w]"),
    );
    let motion = match parse::<Key<DAffine3>, Span>(bytes, &[foreign])? {
        Written::Keyframes(keys) => {
            let keys = timed(keys)?.map(|(time, pose)| Keyframe { time, pose });
            Motion::from_keyframes_turning(&keys.collect::<Vec<_>>(), half_turns)
        }
        Written::Spans(spans) => Motion::from_spans(spans),
    };
    motion.map_err(InputProblem::Motion)
}

/// What a file holds: one of the two.
pub(super) enum Written<K, S> {
    Keyframes(Vec<K>),
    Spans(Vec<S>),
}

/// - `foreign`: keys of motions of the other dimension.
pub(super) fn parse<K: Item, S: Item>(
    bytes: &[u8],
    foreign: &[Foreign],
) -> Result<Written<K, S>, InputProblem> {
    let Object(file): Object<MotionFile<K, S>> = serde_json::from_slice(without_mark(bytes))
        .map_err(|error| {
            let place = Place::LineColumn(error.line(), error.column().max(1));
            let text = error.to_string();
            let suffix = format!(" at line {} column {}", error.line(), error.column());
            let message = words_of_json(text.strip_suffix(&suffix).unwrap_or(&text), foreign);
            InputProblem::MotionFile { place, message }
        })?;
    match (file.keyframes, file.spans) {
        (Some(keys), None) => Ok(Written::Keyframes(keys.0)),
        (None, Some(spans)) => Ok(Written::Spans(spans.0)),
        (Some(_), Some(_)) => Err(whole(
            "expected either \"keyframes\" or \"spans\", found both; give one of the two",
        )),
        (None, None) => Err(whole(
            "expected \"keyframes\" or \"spans\", found neither; add one of the two",
        )),
    }
}

/// Some editors mark UTF-8 by three bytes.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

fn whole(message: &str) -> InputProblem {
    InputProblem::MotionFile {
        place: Place::File,
        message: message.to_owned(),
    }
}

/// Times and poses: the times of the file, or one unit apart when there are none.
pub(super) fn timed<Pose>(
    keys: Vec<Key<Pose>>,
) -> Result<impl Iterator<Item = (f64, Pose)>, InputProblem> {
    let first = keys.iter().position(|key| key.time.is_some());
    let without = keys.iter().position(|key| key.time.is_none());
    if let (Some(with), Some(without)) = (first, without) {
        return Err(whole(&format!(
            "expected a time in every keyframe or in none, found one in keyframe {with} and none in keyframe {without}"
        )));
    }
    let clock = (0_u32..).map(f64::from);
    Ok(clock
        .zip(keys)
        .map(|(clock, key)| (key.time.unwrap_or(clock), key.pose)))
}

/// The file as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, bound(deserialize = "K: Item, S: Item"))]
struct MotionFile<K, S> {
    keyframes: Option<Numbered<K>>,
    spans: Option<Numbered<S>>,
}

/// A list whose errors begin with name and number of the item.
struct Numbered<T>(Vec<T>);

impl<'de, T: Item> Deserialize<'de> for Numbered<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Numbered<T>, D::Error> {
        deserializer.deserialize_seq(ItemVisitor(PhantomData))
    }
}

struct ItemVisitor<T>(PhantomData<T>);

impl<'de, T: Item> Visitor<'de> for ItemVisitor<T> {
    type Value = Numbered<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a list of {}s", T::NAME)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Numbered<T>, A::Error> {
        let mut items = Vec::new();
        loop {
            let place =
                |message: &dyn fmt::Display| format!("{} {}: {message}", T::NAME, items.len());
            // The message of an inner error ends in its line, which `serde_json` recognises and keeps.
            let written = list
                .next_element::<Object<T::Written>>()
                .map_err(|error| A::Error::custom(place(&error)))?;
            let Some(Object(written)) = written else {
                return Ok(Numbered(items));
            };
            let item = T::new(written).map_err(|error| A::Error::custom(place(&error)))?;
            items.push(item);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    const REST: &str = "[[1,0,0,0],[0,1,0,0],[0,0,1,0]]";

    fn motion(text: &str) -> Motion {
        parse_motion(text.as_bytes()).unwrap_or_else(|problem| panic!("{problem}"))
    }

    fn message(text: &str) -> String {
        parse_motion(text.as_bytes())
            .expect_err("refused")
            .to_string()
    }

    fn key_message(fields: &str) -> String {
        message(&format!(
            "{{\"keyframes\": [\n{{\"matrix\": {REST}}},\n{{{fields}}}]}}"
        ))
    }

    fn span_message(fields: &str) -> String {
        message(&format!(
            "{{\"spans\": [\n{{\"turn_deg\": 5, \"axis\": [0,0,1]}},\n{{{fields}}}]}}"
        ))
    }

    #[test]
    fn keyframes_are_read_as_matrices_and_as_translation_rotation_scale() {
        let motion = motion(&format!(
            "\u{feff}{{\"keyframes\": [{{\"time\": 2, \"matrix\": {REST}}},
               {{\"time\": 2.5, \"translation\": [0,0,3], \"rotation\": [0,0,0.6,0.8], \"scale\": [2,2,2]}},
               {{\"time\": 4, \"scale\": 2}}]}}"
        ));
        assert_eq!(motion.joint_times(), [2.0, 2.5, 4.0]);
        let pose = motion.joints()[1];
        // Twice the rotation by 2 atan(0.6 / 0.8) about z: cos = 0.28, sin = 0.96.
        assert!(
            (pose.transform_point3(DVec3::X) - DVec3::new(0.56, 1.92, 3.0)).length() < 1e-15,
            "{pose}"
        );
    }

    #[test]
    fn keys_without_times_are_one_unit_apart() {
        let key = format!("{{\"matrix\": {REST}}}");
        assert_eq!(
            motion(&format!("{{\"keyframes\": [{key},{key},{key}]}}")).joint_times(),
            [0.0, 1.0, 2.0]
        );
    }

    #[test]
    fn spans_are_read_as_screws_and_as_generators() {
        let motion = motion(
            "{\"spans\": [{\"turn_deg\": 90, \"axis\": [0,0,5], \"through\": [1,0,0], \"advance\": 3},
              {\"generator\": [[0,0,0,1],[0,0,0,0],[0,0,0,0]], \"duration\": 2}, {\"scale\": 0.5}, {}]}",
        );
        assert_eq!(motion.joint_times(), [0.0, 1.0, 3.0, 4.0, 5.0]);
        let end = |k: usize| motion.joints()[k].transform_point3(DVec3::new(2.0, 0.0, 0.0));
        assert!(
            (end(1) - DVec3::new(1.0, 1.0, 3.0)).length() < 1e-14,
            "a quarter turn about x = 1: {}",
            end(1)
        );
        assert!(
            (end(2) - DVec3::new(2.0, 1.0, 3.0)).length() < 1e-14,
            "and one along x: {}",
            end(2)
        );
        assert!(
            (end(3) - DVec3::new(1.0, 0.5, 1.5)).length() < 1e-14,
            "halved: {}",
            end(3)
        );
        assert_eq!(end(3), end(4), "an empty span stands still");
    }

    #[test]
    fn unknown_fields_are_named_with_line_and_item() {
        let text = key_message("\"matrx\": 3");
        assert!(text.starts_with("line 3, column 8: keyframe 1: unknown field `matrx`, expected one of `time`, `matrix`"), "{text}");
        assert!(span_message("\"turn\": 3").starts_with(
            "line 3, column 7: span 1: unknown field `turn`, expected one of `turn_deg`"
        ));
        assert!(
            message("{\"frames\": []}")
                .contains("unknown field `frames`, expected `keyframes` or `spans`")
        );
    }

    #[test]
    fn wrong_shapes_are_named() {
        let text = key_message("\"matrix\": [[1,0,0],[0,1,0]]");
        assert_eq!(
            text,
            "line 3, column 30: keyframe 1: \"matrix\" is 2 x 3: a planar motion, a mesh needs one in space, 3 rows of 4 numbers"
        );
        assert!(
            key_message("\"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]")
                .ends_with("found 4 rows of 4; leave out the last row")
        );
        assert!(
            key_message("\"matrix\": [[1,0,0],[0,1,0],[0,0,1]]")
                .ends_with("expected 3 rows of 4 numbers, found 3 rows of 3")
        );
        assert!(
            key_message("\"matrix\": [[1,0,0,0],[0,1],[]]")
                .ends_with("found 3 rows of 4, 2, 0 numbers")
        );
        assert!(key_message("\"matrix\": []").ends_with("found no rows"));
        assert!(
            key_message("\"matrix\": 1").contains("keyframe 1: expected a list, found integer `1`")
        );
        assert!(
            key_message("\"translation\": [1, 2]")
                .contains("\"translation\" has 2 numbers: a planar motion")
        );
        assert!(key_message("\"rotation_deg\": 90").contains("belongs to a planar motion"));
        assert!(
            key_message("\"rotation\": [0, 0, 1]")
                .contains("expected a quaternion of 4 numbers [x, y, z, w], found 3")
        );
        assert!(
            span_message("\"generator\": [[0,0,0],[0,0,0]]")
                .contains("span 1: \"generator\" is 2 x 3: a planar motion")
        );
        assert!(
            span_message("\"through\": [0,0]")
                .contains("\"through\" has 2 numbers: a planar motion")
        );
    }

    #[test]
    fn what_is_no_object_is_named_in_the_words_of_json() {
        assert_eq!(
            message("[]"),
            "line 1, column 1: expected an object with named fields, found a list"
        );
        assert_eq!(
            message("{\"keyframes\": [[0, [], [], []]]}"),
            "line 1, column 15: keyframe 0: expected an object with named fields, found a list"
        );
        assert_eq!(
            span_message("\"turn_deg\": {\"a\": 1}"),
            "line 3, column 13: span 1: expected a number, found an object"
        );
        assert_eq!(
            span_message("\"axis\": \"z\""),
            "line 3, column 12: span 1: expected a list, found string \"z\""
        );
    }

    #[test]
    fn a_field_of_planar_motions_is_not_offered() {
        let text = key_message("\"matrx\": 3");
        assert!(!text.contains("rotation_deg"), "{text}");
    }

    #[test]
    fn wrong_values_are_named() {
        let text = key_message("\"rotation\": [0,0,0,1.00001]");
        assert!(text.contains("keyframe 1: \"rotation\": expected a unit quaternion, length 1 within 1e-6, found length 1.00001"), "{text}");
        assert!(
            parse_motion(b"{\"keyframes\":[{},{\"rotation\":[0,0,0,1.0000005]}]}").is_ok(),
            "within 1e-6"
        );
        for bad in ["0", "-1", "[1,0,1]", "[1,1,-2]", "\"a\"", "[1,1,null]"] {
            let text = key_message(&format!("\"scale\": {bad}"));
            assert!(
                text.contains(
                    "keyframe 1: \"scale\": expected a number above 0 or three of them, found "
                ),
                "{bad}: {text}"
            );
        }
        assert!(
            key_message("\"scale\": [1,1]").contains("\"scale\" has 2 numbers"),
            "a planar scale"
        );
        assert!(
            key_message(&format!("\"matrix\": {REST}, \"scale\": 2"))
                .contains("expected \"matrix\" alone")
        );
        assert!(
            span_message("\"generator\": [], \"scale\": 2")
                .contains("expected \"generator\" alone")
        );
        assert!(
            span_message("\"turn_deg\": 90")
                .contains("span 1: expected \"axis\", the direction to turn about or to advance along, found none"),
            "axis needed"
        );
        assert!(
            span_message("\"turn_deg\": 90, \"axis\": [0,0,0]")
                .contains("span 1: the axis is (0, 0, 0)"),
            "zero axis"
        );
        assert!(
            span_message("\"scale\": 0")
                .contains("span 1: the scale is 0, expected a number above 0")
        );
        assert!(
            span_message("\"scale\": -2").contains("span 1: the scale is -2"),
            "negative scale"
        );
        assert!(
            span_message("\"duration\": 0").contains("span 1: the duration is 0"),
            "no duration"
        );
        assert!(
            span_message("\"advance\": 1e999").contains("number out of range"),
            "infinite"
        );
    }

    #[test]
    fn motions_that_are_none_are_refused_with_their_key() {
        assert!(
            message("{\"keyframes\": [{}]}").contains("1 keyframe"),
            "a single key"
        );
        assert!(message("{\"spans\": []}").contains("no span"), "no spans");
        let text = message("{\"keyframes\": [{\"time\": 1}, {\"time\": 1}]}");
        assert!(text.starts_with("keyframe 1 is at time 1"), "{text}");
        let text = message("{\"keyframes\": [{\"time\": 1}, {}]}");
        assert!(text.contains("expected a time in every keyframe or in none, found one in keyframe 0 and none in keyframe 1"), "{text}");
        let text = key_message("\"matrix\": [[-1,0,0,0],[0,1,0,0],[0,0,1,0]]");
        assert!(text.starts_with("keyframe 1: a reflection"), "{text}");
        let text = key_message("\"matrix\": [[-1,0,0,0],[0,-2,0,0],[0,0,1,0]]");
        assert!(
            text.starts_with("between keyframes 0 and 1: no steady motion leads there"),
            "{text}"
        );
        assert!(message("{}").contains("found neither"), "nothing");
        assert!(
            message("{\"keyframes\": [], \"spans\": []}").contains("found both"),
            "both"
        );
    }

    #[test]
    fn what_is_no_json_is_named_with_line_and_column() {
        let text = message("{\"spans\": [\n  {\"scale\": 2,}]}");
        assert!(
            text.starts_with("line 2, column 15: span 0: trailing comma"),
            "{text}"
        );
        assert!(
            message("hello").starts_with("line 1, column 1: expected value"),
            "no JSON"
        );
        assert!(
            message("{\"spans\": 3}").contains("expected a list of spans, found integer `3`"),
            "no list"
        );
        assert!(
            message(&"[".repeat(100_000)).starts_with("line 1, column"),
            "deep nesting ends"
        );
        assert!(message("\u{0}").starts_with("line 1"), "garbage");
    }
}
