//! Keyframes and spans of motions in the plane as they are written in a motion file.

use super::motion_items::{Item, Key, numbers_per_axis, shape};
use crate::motion::planar::{Generator, Span, Spiral};
use glam::{DAffine2, DMat2, DVec2};
use serde::Deserialize;
use serde_json::Value;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WrittenKey {
    time: Option<f64>,
    matrix: Option<Vec<Vec<f64>>>,
    translation: Option<Vec<f64>>,
    rotation_deg: Option<f64>,
    scale: Option<Value>,
}

impl Item for Key<DAffine2> {
    const NAME: &'static str = "keyframe";
    type Written = WrittenKey;

    fn new(written: WrittenKey) -> Result<Key<DAffine2>, String> {
        let WrittenKey {
            time,
            matrix,
            translation,
            rotation_deg,
            scale,
        } = written;
        let pose = if let Some(rows) = matrix {
            if translation.is_some() || rotation_deg.is_some() || scale.is_some() {
                return Err(
                    "expected \"matrix\" alone, found it with translation, rotation_deg or scale; leave out one of them"
                        .to_owned(),
                );
            }
            affine("matrix", &rows)?
        } else {
            DAffine2::from_scale_angle_translation(
                scale.map_or(Ok(DVec2::ONE), |scale| scale_factors(&scale))?,
                rotation_deg.unwrap_or(0.0).to_radians(),
                translation.map_or(Ok(DVec2::ZERO), |translation| {
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
            if turn_deg.or(scale).is_some() || through.is_some() {
                return Err(
                    "expected \"generator\" alone, found it with turn_deg, through or scale; leave out one of them"
                        .to_owned(),
                );
            }
            let DAffine2 {
                matrix2,
                translation,
            } = affine("generator", &rows)?;
            Generator {
                linear: matrix2,
                offset: translation,
            }
        } else {
            let spiral = Spiral {
                through: through.map_or(Ok(DVec2::ZERO), |through| vector("through", &through))?,
                turn: turn_deg.unwrap_or(0.0).to_radians(),
                scale: scale.unwrap_or(1.0),
            };
            spiral.generator().map_err(|error| error.to_string())?
        };
        Span::new(generator, duration.unwrap_or(1.0)).map_err(|error| error.to_string())
    }
}

/// Said of what would fit a motion in space.
pub(super) const SPATIAL: &str = "a motion in space, a drawing needs one in the plane";

/// Two rows of three numbers.
fn affine(name: &str, rows: &[Vec<f64>]) -> Result<DAffine2, String> {
    let columns: Vec<usize> = rows.iter().map(Vec::len).collect();
    match columns[..] {
        [3, 3] => {
            let column = |j: usize| DVec2::new(rows[0][j], rows[1][j]);
            Ok(DAffine2 {
                matrix2: DMat2::from_cols(column(0), column(1)),
                translation: column(2),
            })
        }
        [4, 4, 4] => Err(format!(
            "\"{name}\" is 3 x 4: {SPATIAL}, 2 rows of 3 numbers"
        )),
        [3, 3, 3] => Err(format!(
            "\"{name}\": expected 2 rows of 3 numbers, found 3 rows of 3; leave out the last row"
        )),
        _ => Err(format!(
            "\"{name}\": expected 2 rows of 3 numbers, found {}",
            shape(&columns)
        )),
    }
}

fn vector(name: &str, numbers: &[f64]) -> Result<DVec2, String> {
    match *numbers {
        [x, y] => Ok(DVec2::new(x, y)),
        [_, _, _] => Err(format!("\"{name}\" has 3 numbers: {SPATIAL}, 2 numbers")),
        _ => Err(format!(
            "\"{name}\": expected 2 numbers, found {}",
            numbers.len()
        )),
    }
}

fn scale_factors(scale: &Value) -> Result<DVec2, String> {
    let wrong = || {
        Err(format!(
            "\"scale\": expected a number above 0 or two of them, found {scale}"
        ))
    };
    let Some(numbers) = numbers_per_axis(scale, 2) else {
        return wrong();
    };
    let factors = vector("scale", &numbers)?;
    if factors.cmpgt(DVec2::ZERO).all() {
        Ok(factors)
    } else {
        wrong()
    }
}
