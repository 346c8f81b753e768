//! Whether a steady motion leads from one pose of the plane to another, and by what margin.

use super::{Flow, logarithm};
use crate::motion::chain::Steady;
use crate::motion::existence::answered;
use crate::motion::{Existence, MotionError};
use glam::{DAffine2, DMat3, DVec3};

/// Whether a steady motion leads from one pose of the plane to another, and by what margin; as
/// [`motion::existence`](crate::motion::existence()).
///
/// # Errors
/// As [`motion::existence`](crate::motion::existence()).
pub fn existence(from: &DAffine2, to: &DAffine2) -> Result<Existence, MotionError> {
    Flow::check_pose(from)?;
    let relative = Flow::relative(from, to);
    let found = logarithm(&relative).map(|steady| (steady.unique(), steady.flow.turns()));
    let [x, y] = [relative.matrix2.x_axis, relative.matrix2.y_axis];
    // Across the plane a factor as large as any in it: it is never the nearest to a negative one,
    // and hardly enlarges the norm.
    let across = DVec3::new(0.0, 0.0, x.length().max(y.length()));
    answered(
        found,
        &DMat3::from_cols(x.extend(0.0), y.extend(0.0), across),
    )
}
