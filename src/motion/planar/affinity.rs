//! The affine map of the plane that carries given points to given points.

use super::logarithm::check_pose;
use crate::motion::MotionError;
use crate::motion::affinity::{Fitted, PointFit, fitted};
use glam::{DAffine2, DMat2, DVec2};

/// The affine map of the plane that carries points to points: through three pairs exactly, up to
/// rounding; of more it is the one with the least sum of squared distances. Otherwise as
/// [`motion::from_points`](crate::motion::from_points).
///
/// # Errors
/// As [`motion::from_points`](crate::motion::from_points), with lines for planes.
pub fn from_points(pairs: &[[DVec2; 2]]) -> Result<PointFit<DAffine2>, MotionError> {
    let numbers: Vec<[[f64; 2]; 2]> = pairs
        .iter()
        .map(|pair| pair.map(|point| point.to_array()))
        .collect();
    let Fitted { columns, centres } = fitted(&numbers)?;
    let [source, target] = centres.map(DVec2::from_array);
    let matrix2 = DMat2::from_cols_array_2d(&columns);
    let pose = DAffine2 {
        matrix2,
        translation: target - matrix2 * source,
    };
    check_pose(&pose).map_err(MotionError::of_targets)?;
    let left = |pair: &[DVec2; 2]| pose.transform_point2(pair[0]).distance(pair[1]);
    Ok(PointFit::new(pose, pairs.iter().map(left)))
}
