//! Whether a motion file holds a motion in the plane or in space.

use super::file::{FittedKey, Origin, ReadChain, log_path, without_mark};
use super::pose_log::{are_in_space, header_of};
use super::{planar, spatial};
use crate::io::error::{InputError, InputProblem};
use crate::io::file::read_bytes;
use crate::motion::{self, HalfTurns};
use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny, SeqAccess, Visitor};
use serde_json::Value;
use std::fmt;
use std::path::Path;

/// A motion from a file that may be of either dimension.
#[derive(Debug, Clone)]
pub enum AnyMotion {
    /// In the plane.
    Plane(motion::planar::Motion),
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

/// A motion from a file, and what its reader did.
#[derive(Debug, Clone)]
pub struct ReadMotion {
    /// The motion.
    pub motion: AnyMotion,
    /// Keyframes that were found from pairs of points, in order.
    pub fitted: Vec<FittedKey>,
}

/// Reads a motion from a JSON file, in the plane or in space as the file says, with the senses of
/// half turns between keyframes chosen.
///
/// A file that says neither, such as one that only scales about the origin, is read as a motion in
/// space.
///
/// # Errors
/// Those of [`read_motion`](super::read_motion) or
/// [`read_planar_motion`](super::read_planar_motion).
pub fn read_any_motion(path: &Path, half_turns: &HalfTurns) -> Result<ReadMotion, InputError> {
    read_bytes(path)
        .and_then(|bytes| read_in(&bytes, Origin::File(path), half_turns))
        .map_err(|problem| InputError::new(path, problem))
}

/// Reads a motion from the bytes of a JSON file; see [`read_any_motion`].
///
/// # Errors
/// [`InputProblem`] with the place in the bytes.
pub fn parse_any_motion(bytes: &[u8], half_turns: &HalfTurns) -> Result<AnyMotion, InputProblem> {
    read_in(bytes, Origin::Bytes, half_turns).map(|read| read.motion)
}

fn read_in(
    bytes: &[u8],
    origin: Origin,
    half_turns: &HalfTurns,
) -> Result<ReadMotion, InputProblem> {
    Ok(
        match motion_dimension(bytes).or_else(|| dimension_of_log(bytes, origin)) {
            Some(Dimension::Plane) => {
                let file = planar::chain_in(bytes, origin, half_turns)?;
                let ReadChain { motion, fitted } = file.itself()?;
                ReadMotion {
                    motion: AnyMotion::Plane(motion),
                    fitted,
                }
            }
            Some(Dimension::Space) | None => {
                let file = spatial::chain_in(bytes, origin, half_turns)?;
                let ReadChain { motion, fitted } = file.itself()?;
                ReadMotion {
                    motion: AnyMotion::Space(motion),
                    fitted,
                }
            }
        },
    )
}

/// The dimension that the numbers and names in a motion file fit; `None` where they fit both, or
/// where the file is no motion file.
pub fn motion_dimension(bytes: &[u8]) -> Option<Dimension> {
    let written = Written::of(bytes)?;
    let said = [written.keyframes, written.spans].into_iter().flatten();
    let in_lists = said.into_iter().find_map(|Said(dimension)| dimension);
    in_lists.or_else(
        || match (&written.columns, written.format, written.rotation) {
            (Some(columns), ..) => Some(dimension_of_columns(columns.split_ascii_whitespace())),
            (None, None, None) => None,
            _ => Some(Dimension::Space),
        },
    )
}

/// The dimension that the header of a pose log tells, where the motion file does not.
fn dimension_of_log(bytes: &[u8], origin: Origin) -> Option<Dimension> {
    let (Origin::File(file), Some(name)) = (origin, Written::of(bytes)?.poses) else {
        return None;
    };
    let names = header_of(&log_path(file, &name))?;
    Some(dimension_of_columns(names.iter().map(String::as_str)))
}

fn dimension_of_columns<'a>(names: impl Iterator<Item = &'a str>) -> Dimension {
    if are_in_space(names) {
        Dimension::Space
    } else {
        Dimension::Plane
    }
}

/// What a motion file says. Where the lists are no lists, the reader of the motion refuses the
/// file.
#[derive(Deserialize)]
struct Written {
    keyframes: Option<Said>,
    spans: Option<Said>,
    poses: Option<String>,
    columns: Option<String>,
    format: Option<IgnoredAny>,
    rotation: Option<IgnoredAny>,
}

impl Written {
    fn of(bytes: &[u8]) -> Option<Written> {
        serde_json::from_slice(without_mark(bytes)).ok()
    }
}

/// What the items of a list say about its dimension. They are read one at a time: there may be
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
        "points" => match length(value.as_array()?.first()?.as_array()?.first()?)? {
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
                "{\"keyframes\": [{\"points\": [[[1,2],[3,4]]]}]}",
                Some(Dimension::Plane),
            ),
            (
                "{\"keyframes\": [{\"points\": [[[1,2,3],[3,4,5]]]}]}",
                Some(Dimension::Space),
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
