//! Motions in the plane as they are written in a motion file.

use super::file::{MotionFile, Origin, motion_of};
use super::items::{
    Item, KeyPose, SPATIAL, affine, alone, fitted, point, point_pairs, scale_factors,
};
use crate::io::error::{InputError, InputProblem};
use crate::io::file::read_bytes;
use crate::motion::HalfTurns;
use crate::motion::planar::{Flow, Generator, Motion, Span, Spiral, from_points};
use glam::{DAffine2, DVec2};
use serde::Deserialize;
use serde_json::Value;
use std::path::Path;

/// Reads a motion in the plane from a JSON file.
///
/// # Errors
/// [`InputError`] with line, column and number of the key or span where the file is not as
/// described, also where it describes a motion in space. It wraps a
/// [`MotionError`](crate::motion::MotionError) where the poses make no motion or are half a turn
/// apart.
pub fn read_planar_motion(path: &Path) -> Result<Motion, InputError> {
    read_planar_motion_turning(path, &HalfTurns::Refused)
}

/// As [`read_planar_motion`], with chosen senses for the half turns between keyframes.
///
/// # Errors
/// As [`read_planar_motion`], except for half turns.
pub fn read_planar_motion_turning(
    path: &Path,
    half_turns: &HalfTurns,
) -> Result<Motion, InputError> {
    read_bytes(path)
        .and_then(|bytes| chain_in(&bytes, Origin::File(path), half_turns))
        .and_then(MotionFile::itself)
        .map(|read| read.motion)
        .map_err(|problem| InputError::new(path, problem))
}

/// Reads a motion in the plane from the bytes of a JSON file; see [`read_planar_motion`].
///
/// # Errors
/// [`InputProblem`] with the place in the bytes.
///
/// # Example
/// ```
/// use glam::DVec2;
/// use steadysweep::io::parse_planar_motion;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let motion = parse_planar_motion(br#"{"spans": [{"turn_deg": 90, "through": [1, 0]}]}"#)?;
/// let end = motion.pose_at_time(1.0).transform_point2(DVec2::ZERO);
/// assert!(end.distance(DVec2::new(1.0, -1.0)) < 1e-15);
/// # Ok(())
/// # }
/// ```
pub fn parse_planar_motion(bytes: &[u8]) -> Result<Motion, InputProblem> {
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
/// As [`read_planar_motion`], except for half turns and for what following finds.
pub fn read_planar_motion_file(
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
    let foreign = [
        ("rotation", "give \"rotation_deg\""),
        ("axis", "leave it out, turns are from x towards y"),
        (
            "advance",
            "for a translation by x, y give \"generator\": [[0, 0, x], [0, 0, y]]",
        ),
    ]
    .map(|(field, remedy)| (field, format!("{SPATIAL}; {remedy}")));
    motion_of(bytes, origin, &foreign, half_turns)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WrittenKey {
    time: Option<f64>,
    matrix: Option<Vec<Vec<f64>>>,
    translation: Option<Vec<f64>>,
    rotation_deg: Option<f64>,
    scale: Option<Value>,
    points: Option<Vec<[Vec<f64>; 2]>>,
    turns: Option<i32>,
}

impl Item for KeyPose<DAffine2> {
    const NAME: &'static str = "keyframe";
    type Written = WrittenKey;

    fn new(written: WrittenKey) -> Result<KeyPose<DAffine2>, String> {
        let WrittenKey {
            time,
            matrix,
            translation,
            rotation_deg,
            scale,
            points,
            turns,
        } = written;
        let parts = translation.is_some() || rotation_deg.is_some() || scale.is_some();
        let mut fit = None;
        let pose = if let Some(pairs) = points {
            let others = matrix.is_some() || parts;
            let names = "matrix, translation, rotation_deg or scale";
            alone("points", others.then_some(names))?;
            let (pose, quality) = fitted(from_points(&point_pairs(&pairs)?))?;
            fit = Some(quality);
            pose
        } else if let Some(rows) = matrix {
            let names = "translation, rotation_deg or scale";
            alone("matrix", parts.then_some(names))?;
            let rows: [[f64; 3]; 2] = affine("matrix", &rows)?;
            let column = |j: usize| DVec2::from(rows.map(|row| row[j]));
            DAffine2::from_cols(column(0), column(1), column(2))
        } else {
            let scale = scale.map_or(Ok([1.0; 2]), |scale| scale_factors(&scale))?;
            let angle = rotation_deg.unwrap_or(0.0).to_radians();
            let translation = point("translation", translation)?;
            DAffine2::from_scale_angle_translation(scale.into(), angle, translation)
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
    through: Option<Vec<f64>>,
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
            through,
            scale,
            generator,
            duration,
        } = written;
        let generator = if let Some(rows) = generator {
            let others = turn_deg.or(scale).is_some() || through.is_some();
            alone("generator", others.then_some("turn_deg, through or scale"))?;
            Generator::from_rows(affine("generator", &rows)?)
        } else {
            let spiral = Spiral {
                through: point("through", through)?,
                turn: turn_deg.unwrap_or(0.0).to_radians(),
                scale: scale.unwrap_or(1.0),
            };
            spiral.generator()
        };
        generator
            .and_then(|generator| Span::new(generator, duration.unwrap_or(1.0)))
            .map_err(|error| error.to_string())
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
                "keyframe 1: unknown field `matrx`, expected one of `time`, `matrix`, `translation`, `rotation_deg`, `scale`, `points`, `turns`"
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
}
