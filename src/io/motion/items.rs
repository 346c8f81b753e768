//! What keyframes and spans have in common in space and in the plane.

use crate::motion::{FitQuality, MotionError, PointFit};
use serde::Deserialize;
use serde_json::Value;

/// An item of a list, made from what is written in the file.
pub(super) trait Item: Sized {
    const NAME: &'static str;
    type Written: for<'de> Deserialize<'de>;
    /// The item, or what is wrong with it: where, what was expected, what was found, and the
    /// remedy.
    fn new(written: Self::Written) -> Result<Self, String>;
}

/// A pose with or without a time.
pub(super) struct KeyPose<Pose> {
    pub(super) time: Option<f64>,
    pub(super) pose: Pose,
    /// Whole turns added to the span that ends here.
    pub(super) turns: i32,
    /// How well the pose fits, where it was found from points.
    pub(super) fit: Option<FitQuality>,
}

/// What a message says about input that would fit a motion in the plane.
pub(super) const PLANAR: &str = "a planar motion, a mesh needs one in space";

/// What a message says about input that would fit a motion in space.
pub(super) const SPATIAL: &str = "a motion in space, a drawing needs one in the plane";

/// The number of coordinates of the other dimension, and what a message says about input of that
/// dimension.
fn other_than(dimension: usize) -> (usize, &'static str) {
    if dimension == 3 {
        (2, PLANAR)
    } else {
        (3, SPATIAL)
    }
}

/// Checks that a field that describes a whole item stands alone.
///
/// - `others`: the other fields of the item, if any.
pub(super) fn alone(field: &str, others: Option<&str>) -> Result<(), String> {
    others.map_or(Ok(()), |others| {
        Err(format!(
            "expected \"{field}\" alone, found it with {others}; leave out one of them"
        ))
    })
}

/// An affine map of `ROWS` coordinates: `ROWS` rows of `ROWS` + 1 numbers.
pub(super) fn affine<const ROWS: usize, const COLUMNS: usize>(
    name: &str,
    rows: &[Vec<f64>],
) -> Result<[[f64; COLUMNS]; ROWS], String> {
    let (other, remark) = other_than(ROWS);
    let expected = format!("{ROWS} rows of {COLUMNS} numbers");
    let lengths: Vec<usize> = rows.iter().map(Vec::len).collect();
    if lengths == [COLUMNS; ROWS] {
        return Ok(std::array::from_fn(|row| {
            std::array::from_fn(|column| rows[row][column])
        }));
    }
    if lengths == vec![other + 1; other] {
        let columns = other + 1;
        return Err(format!(
            "\"{name}\" is {other} x {columns}: {remark}, {expected}"
        ));
    }
    let remedy = if lengths == [COLUMNS; COLUMNS] {
        "; leave out the last row"
    } else {
        ""
    };
    Err(format!(
        "\"{name}\": expected {expected}, found {}{remedy}",
        shape(&lengths)
    ))
}

/// The number of rows and of the numbers in them, in words.
fn shape(lengths: &[usize]) -> String {
    let lengths: Vec<String> = lengths.iter().map(usize::to_string).collect();
    match &lengths[..] {
        [] => "no rows".to_owned(),
        [first, others @ ..] if others.iter().all(|n| n == first) => {
            format!("{} rows of {first}", lengths.len())
        }
        _ => format!("{} rows of {} numbers", lengths.len(), lengths.join(", ")),
    }
}

/// A vector, with as many numbers as there are coordinates.
fn vector<const N: usize>(name: &str, numbers: &[f64]) -> Result<[f64; N], String> {
    let (other, remark) = other_than(N);
    numbers.try_into().map_err(|_| match numbers.len() {
        found if found == other => {
            format!("\"{name}\" has {found} numbers: {remark}, {N} numbers")
        }
        found => format!("\"{name}\": expected {N} numbers, found {found}"),
    })
}

/// A point or direction by its coordinates; zero when they are left out.
pub(super) fn point<const N: usize, P: From<[f64; N]>>(
    name: &str,
    numbers: Option<Vec<f64>>,
) -> Result<P, String> {
    let coordinates = numbers.map_or(Ok([0.0; N]), |numbers| vector(name, &numbers))?;
    Ok(coordinates.into())
}

/// Pairs of points, source and target, by their coordinates.
pub(super) fn point_pairs<const N: usize, P: From<[f64; N]>>(
    pairs: &[[Vec<f64>; 2]],
) -> Result<Vec<[P; 2]>, String> {
    let pair = |[source, target]: &[Vec<f64>; 2]| {
        Ok([
            vector("points", source)?.into(),
            vector("points", target)?.into(),
        ])
    };
    pairs.iter().map(pair).collect()
}

/// The pose of a fit and its quality, or what is wrong with the points.
pub(super) fn fitted<Pose>(
    fit: Result<PointFit<Pose>, MotionError>,
) -> Result<(Pose, FitQuality), String> {
    fit.map(|fit| (fit.pose, fit.quality))
        .map_err(|error| format!("\"points\": {error}"))
}

/// A number above 0 for all axes, or one for each.
pub(super) fn scale_factors<const N: usize>(scale: &Value) -> Result<[f64; N], String> {
    let count = if N == 3 { "three" } else { "two" };
    let wrong = || {
        Err(format!(
            "\"scale\": expected a number above 0 or {count} of them, found {scale}"
        ))
    };
    let numbers: Option<Vec<f64>> = match scale {
        Value::Array(list) => list.iter().map(Value::as_f64).collect(),
        one => one.as_f64().map(|one| vec![one; N]),
    };
    let Some(numbers) = numbers else {
        return wrong();
    };
    let factors = vector("scale", &numbers)?;
    if factors.iter().all(|&factor| factor > 0.0) {
        Ok(factors)
    } else {
        wrong()
    }
}
