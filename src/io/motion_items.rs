//! Keyframes and spans of motions in space as they are written in a motion file.

use crate::motion::{Generator, Screw, Span};
use crate::numeric::tolerance::UNIT_QUATERNION;
use glam::{DAffine3, DMat3, DQuat, DVec3};
use serde::Deserialize;
use serde_json::Value;

/// An item of a list, made of what is written in the file.
pub(super) trait Item: Sized {
    const NAME: &'static str;
    type Written: for<'de> Deserialize<'de>;
    /// The item, or what is wrong: where, expected, found, remedy.
    fn new(written: Self::Written) -> Result<Self, String>;
}

/// A pose with or without a time.
pub(super) struct Key<Pose> {
    pub(super) time: Option<f64>,
    pub(super) pose: Pose,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WrittenKey {
    time: Option<f64>,
    matrix: Option<Vec<Vec<f64>>>,
    translation: Option<Vec<f64>>,
    rotation: Option<Vec<f64>>,
    scale: Option<Value>,
}

impl Item for Key<DAffine3> {
    const NAME: &'static str = "keyframe";
    type Written = WrittenKey;

    fn new(written: WrittenKey) -> Result<Key<DAffine3>, String> {
        let WrittenKey {
            time,
            matrix,
            translation,
            rotation,
            scale,
        } = written;
        let pose = if let Some(rows) = matrix {
            if translation.is_some() || rotation.is_some() || scale.is_some() {
                return Err("expected \"matrix\" alone, found it with translation, rotation or scale; leave out one of them"
                    .to_owned());
            }
            affine("matrix", &rows)?
        } else {
            DAffine3::from_scale_rotation_translation(
                scale.map_or(Ok(DVec3::ONE), |scale| scale_factors(&scale))?,
                rotation.map_or(Ok(DQuat::IDENTITY), |rotation| unit_quaternion(&rotation))?,
                translation.map_or(Ok(DVec3::ZERO), |translation| {
                    vector("translation", &translation)
                })?,
            )
        };
        Ok(Key { time, pose })
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
            if turn_deg.or(advance).or(scale).is_some() || axis.or(through).is_some() {
                return Err("expected \"generator\" alone, found it with turn_deg, axis, through, advance or scale; leave out one \
                            of them"
                    .to_owned());
            }
            let DAffine3 {
                matrix3,
                translation,
            } = affine("generator", &rows)?;
            Generator {
                linear: matrix3,
                offset: translation,
            }
        } else {
            let through = through.map_or(Ok(DVec3::ZERO), |through| vector("through", &through))?;
            let has_direction = [turn_deg, advance]
                .iter()
                .any(|size| size.is_some_and(|size| size != 0.0));
            if axis.is_none() && has_direction {
                return Err(
                    "expected \"axis\", the direction to turn about or to advance along, found none; add for example \
                     \"axis\": [0, 0, 1]; a turn in the plane has \"through\": [x, y] instead"
                        .to_owned(),
                );
            }
            let screw = Screw {
                axis: axis.map_or(Ok(DVec3::ZERO), |axis| vector("axis", &axis))?,
                through,
                turn: turn_deg.unwrap_or(0.0).to_radians(),
                advance: advance.unwrap_or(0.0),
                scale: scale.unwrap_or(1.0),
            };
            screw.generator().map_err(|error| error.to_string())?
        };
        Span::new(generator, duration.unwrap_or(1.0)).map_err(|error| error.to_string())
    }
}

/// Said of what would fit a motion in the plane.
pub(super) const PLANAR: &str = "a planar motion, a mesh needs one in space";

/// Three rows of four numbers.
fn affine(name: &str, rows: &[Vec<f64>]) -> Result<DAffine3, String> {
    let columns: Vec<usize> = rows.iter().map(Vec::len).collect();
    match columns[..] {
        [4, 4, 4] => {
            let column = |j: usize| DVec3::new(rows[0][j], rows[1][j], rows[2][j]);
            Ok(DAffine3 {
                matrix3: DMat3::from_cols(column(0), column(1), column(2)),
                translation: column(3),
            })
        }
        [3, 3] => Err(format!(
            "\"{name}\" is 2 x 3: {PLANAR}, 3 rows of 4 numbers"
        )),
        [4, 4, 4, 4] => Err(format!(
            "\"{name}\": expected 3 rows of 4 numbers, found 4 rows of 4; leave out the last row"
        )),
        _ => Err(format!(
            "\"{name}\": expected 3 rows of 4 numbers, found {}",
            shape(&columns)
        )),
    }
}

/// Rows of so many numbers, in words.
pub(super) fn shape(columns: &[usize]) -> String {
    let lengths: Vec<String> = columns.iter().map(usize::to_string).collect();
    match &lengths[..] {
        [] => "no rows".to_owned(),
        [first, others @ ..] if others.iter().all(|n| n == first) => {
            format!("{} rows of {first}", lengths.len())
        }
        _ => format!("{} rows of {} numbers", lengths.len(), lengths.join(", ")),
    }
}

fn vector(name: &str, numbers: &[f64]) -> Result<DVec3, String> {
    match *numbers {
        [x, y, z] => Ok(DVec3::new(x, y, z)),
        [_, _] => Err(format!("\"{name}\" has 2 numbers: {PLANAR}, 3 numbers")),
        _ => Err(format!(
            "\"{name}\": expected 3 numbers, found {}",
            numbers.len()
        )),
    }
}

fn unit_quaternion(numbers: &[f64]) -> Result<DQuat, String> {
    let [x, y, z, w] = *numbers else {
        let found = numbers.len();
        return Err(format!(
            "\"rotation\": expected a quaternion of 4 numbers [x, y, z, w], found {found} numbers"
        ));
    };
    let quaternion = DQuat::from_xyzw(x, y, z, w);
    let length = quaternion.length();
    // Not `>`, so that a length beyond all numbers is refused too.
    if (length - 1.0).abs() <= UNIT_QUATERNION {
        Ok(quaternion.normalize())
    } else {
        Err(format!(
            "\"rotation\": expected a unit quaternion, length 1 within {UNIT_QUATERNION:e}, found length {length}; divide it by its \
             length"
        ))
    }
}

/// A number for all of `axes` axes, or one for each; `None` where there is something else.
pub(super) fn numbers_per_axis(scale: &Value, axes: usize) -> Option<Vec<f64>> {
    match scale {
        Value::Array(list) => list.iter().map(Value::as_f64).collect(),
        one => one.as_f64().map(|one| vec![one; axes]),
    }
}

fn scale_factors(scale: &Value) -> Result<DVec3, String> {
    let numbers = numbers_per_axis(scale, 3);
    let wrong = |found: &str| {
        Err(format!(
            "\"scale\": expected a number above 0 or three of them, found {found}"
        ))
    };
    let Some(numbers) = numbers else {
        return wrong(&scale.to_string());
    };
    let factors = vector("scale", &numbers)?;
    if factors.cmpgt(DVec3::ZERO).all() {
        Ok(factors)
    } else {
        wrong(&scale.to_string())
    }
}
