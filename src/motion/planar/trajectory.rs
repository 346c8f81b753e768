//! Bounds on the paths of points of the plane over a time window: those of [`crate::motion`] for
//! the plane z = 0 of space.

use super::Generator;
use crate::motion;
use glam::{DAffine2, DAffine3, DMat2, DMat3, DVec2, DVec3, Vec3Swizzles};

/// A pose of the plane as one of the plane z = 0 of space. Along z everything scales by the root of
/// the determinant: this increases no norm, nor that of the inverse.
pub(crate) fn in_space(pose: &DAffine2) -> DAffine3 {
    let [x, y] = [pose.matrix2.x_axis, pose.matrix2.y_axis];
    let scale = pose.matrix2.determinant().abs().sqrt();
    DAffine3 {
        matrix3: DMat3::from_cols(x.extend(0.0), y.extend(0.0), DVec3::new(0.0, 0.0, scale)),
        translation: pose.translation.extend(0.0),
    }
}

/// Upper bound of the spectral norm of exp(t M) for t in `window`; guarantee as
/// [`motion::stretch`].
///
/// - `window`: `[start, end]` in spans, `start <= end`; need not contain 0.
pub fn stretch(linear: &DMat2, window: [f64; 2]) -> f64 {
    let generator = Generator {
        linear: *linear,
        offset: DVec2::ZERO,
    };
    motion::stretch(&generator.in_space().linear, window)
}

/// A box [min, max] that contains exp(tG) p for all t in `window`; guarantee and cost as
/// [`motion::path_bounds`].
pub fn path_bounds(generator: &Generator, point: DVec2, window: [f64; 2]) -> [DVec2; 2] {
    motion::path_bounds(&generator.in_space(), point.extend(0.0), window).map(|corner| corner.xy())
}

/// Upper bound of |d2/dt2 exp(tG) p| for t in `window`; accurate to a few units in the last place
/// for rigid motions and similarities.
///
/// A chord over a step h departs from the path by at most h^2/8 times this bound.
pub fn acceleration_bound(generator: &Generator, point: DVec2, window: [f64; 2]) -> f64 {
    motion::acceleration_bound(&generator.in_space(), point.extend(0.0), window)
}
