//! The steady motion between two poses.

use super::{Flow, MotionError};
use glam::DAffine3;

/// log A.
#[derive(Debug, Clone)]
pub struct Logarithm {
    /// exp(t log A), prepared.
    pub flow: Flow,
    /// False for an exact half turn: both senses of rotation lead there.
    pub unique: bool,
}

/// The real logarithm of an affinity.
pub fn logarithm(_a: &DAffine3) -> Result<Logarithm, MotionError> {
    todo!()
}
