//! Paths of points over a time window, bounded.

use super::Generator;
use glam::{DMat3, DVec3};

/// Upper bound of the spectral norm of exp(t M) for t in `window`; within rounding of 1 when M is skew.
pub fn stretch(_linear: &DMat3, _window: [f64; 2]) -> f64 {
    todo!()
}

/// A box [min, max] that contains exp(tG) p for all t in `window`.
pub fn path_bounds(_generator: &Generator, _point: DVec3, _window: [f64; 2]) -> [DVec3; 2] {
    todo!()
}
