//! Motions in space as they are written in a motion file.

use super::file::{MotionFile, Origin, motion_of};
use super::items::{
    Item, KeyPose, PLANAR, affine, alone, fitted, point, point_pairs, scale_factors,
};
use super::rotation::rotation_of;
use crate::io::error::{InputError, InputProblem};
use crate::io::file::read_bytes;
use crate::motion::{Flow, Generator, HalfTurns, Motion, Screw, Span, from_points};
use glam::{DAffine3, DQuat, DVec3};
use serde::Deserialize;
use serde_json::Value;
use std::path::Path;

/// Reads a motion from a JSON file.
///
/// # Errors
/// [`InputError`] with line, column and number of the key or span where the file is not as
/// described. It wraps a [`MotionError`](crate::motion::MotionError) where the poses make no motion
/// or are half a turn apart.
pub fn read_motion(path: &Path) -> Result<Motion, InputError> {
    read_motion_turning(path, &HalfTurns::Refused)
}

/// As [`read_motion`], with chosen senses for the half turns between keyframes.
///
/// # Errors
/// As [`read_motion`], except for half turns.
pub fn read_motion_turning(path: &Path, half_turns: &HalfTurns) -> Result<Motion, InputError> {
    read_bytes(path)
        .and_then(|bytes| chain_in(&bytes, Origin::File(path), half_turns))
        .and_then(MotionFile::itself)
        .map(|read| read.motion)
        .map_err(|problem| InputError::new(path, problem))
}

/// Reads a motion from the bytes of a JSON file; see [`read_motion`].
///
/// # Errors
/// [`InputProblem`] with the place in the bytes.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use steadysweep::io::parse_motion;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let text = r#"{"spans": [{"turn_deg": 540, "axis": [0, 0, 1], "advance": 3}]}"#;
/// let motion = parse_motion(text.as_bytes())?;
/// let end = motion.pose_at_time(1.0).transform_point3(DVec3::X);
/// assert!(end.distance(DVec3::new(-1.0, 0.0, 3.0)) < 1e-14);
/// # Ok(())
/// # }
/// ```
pub fn parse_motion(bytes: &[u8]) -> Result<Motion, InputProblem> {
    chain_in(bytes, Origin::Bytes, &HalfTurns::Refused)
        .and_then(MotionFile::itself)
        .map(|read| read.motion)
}

/// Reads a motion from a JSON file, also one that is followed by steady spans over a body: by
/// another interpolation, or within a `deviation`.
///
/// - `half_turns`: senses of the half turns of steady motions, which [`MotionFile::over`] chooses
///   anew.
///
/// # Errors
/// As [`read_motion`], except for half turns and for what following finds.
pub fn read_motion_file(
    path: &Path,
    half_turns: &HalfTurns,
) -> Result<MotionFile<Flow>, InputError> {
    read_bytes(path)
        .and_then(|bytes| chain_in(&bytes, Origin::File(path), half_turns))
        .map_err(|problem| InputError::new(path, problem))
}

pub(super) fn chain_in(
    bytes: &[u8],
    origin: Origin,
    half_turns: &HalfTurns,
) -> Result<MotionFile<Flow>, InputProblem> {
    let foreign = (
        "rotation_deg",
        format!("{PLANAR}; give \"rotation\" as a quaternion [x, y, z, w]"),
    );
    motion_of(bytes, origin, &[foreign], half_turns)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WrittenKey {
    time: Option<f64>,
    matrix: Option<Vec<Vec<f64>>>,
    translation: Option<Vec<f64>>,
    rotation: Option<Value>,
    scale: Option<Value>,
    points: Option<Vec<[Vec<f64>; 2]>>,
    turns: Option<i32>,
}

impl Item for KeyPose<DAffine3> {
    const NAME: &'static str = "keyframe";
    type Written = WrittenKey;

    fn new(written: WrittenKey) -> Result<KeyPose<DAffine3>, String> {
        let WrittenKey {
            time,
            matrix,
            translation,
            rotation,
            scale,
            points,
            turns,
        } = written;
        let parts = translation.is_some() || rotation.is_some() || scale.is_some();
        let mut fit = None;
        let pose = if let Some(pairs) = points {
            let others = matrix.is_some() || parts;
            let names = "matrix, translation, rotation or scale";
            alone("points", others.then_some(names))?;
            let (pose, quality) = fitted(from_points(&point_pairs(&pairs)?))?;
            fit = Some(quality);
            pose
        } else if let Some(rows) = matrix {
            alone("matrix", parts.then_some("translation, rotation or scale"))?;
            let rows: [[f64; 4]; 3] = affine("matrix", &rows)?;
            let column = |j: usize| DVec3::from(rows.map(|row| row[j]));
            DAffine3::from_cols(column(0), column(1), column(2), column(3))
        } else {
            let scale = scale.map_or(Ok([1.0; 3]), |scale| scale_factors(&scale))?;
            let rotation =
                rotation.map_or(Ok(DQuat::IDENTITY), |rotation| rotation_of(&rotation))?;
            let translation = point("translation", translation)?;
            DAffine3::from_scale_rotation_translation(scale.into(), rotation, translation)
        };
        let turns = turns.unwrap_or(0);
        Ok(KeyPose {
            time,
            pose,
            turns,
            fit,
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WrittenSpan {
    turn_deg: Option<f64>,
    axis: Option<Vec<f64>>,
    through: Option<Vec<f64>>,
    advance: Option<f64>,
    scale: Option<f64>,
    generator: Option<Vec<Vec<f64>>>,
    duration: Option<f64>,
}

impl Item for Span {
    const NAME: &'static str = "span";
    type Written = WrittenSpan;

    fn new(written: WrittenSpan) -> Result<Span, String> {
        let WrittenSpan {
            turn_deg,
            axis,
            through,
            advance,
            scale,
            generator,
            duration,
        } = written;
        let generator = if let Some(rows) = generator {
            let others =
                turn_deg.or(advance).or(scale).is_some() || axis.is_some() || through.is_some();
            let names = "turn_deg, axis, through, advance or scale";
            alone("generator", others.then_some(names))?;
            Generator::from_rows(affine("generator", &rows)?)
        } else {
            let through = point("through", through)?;
            let has_direction = [turn_deg, advance]
                .iter()
                .any(|size| size.is_some_and(|size| size != 0.0));
            if axis.is_none() && has_direction {
                return Err(
                    "expected \"axis\", the direction to turn about or to advance along, found none; \
                     add for example \"axis\": [0, 0, 1]; a turn in the plane has \
                     \"through\": [x, y] instead"
                        .to_owned(),
                );
            }
            let screw = Screw {
                axis: point("axis", axis)?,
                through,
                turn: turn_deg.unwrap_or(0.0).to_radians(),
                advance: advance.unwrap_or(0.0),
                scale: scale.unwrap_or(1.0),
            };
            screw.generator()
        };
        generator
            .and_then(|generator| Span::new(generator, duration.unwrap_or(1.0)))
            .map_err(|error| error.to_string())
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
                .contains("unknown field `frames`, expected one of `keyframes`, `spans`, `poses`")
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
        assert!(message("{}").contains("found none"), "nothing");
        assert!(
            message("{\"keyframes\": [], \"spans\": []}").contains("found more than one"),
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
