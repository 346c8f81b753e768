//! Paths of points of the plane over a time window, bounded: the bounds of [`crate::motion`] on the plane z = 0 of space.

use super::Generator;
use crate::motion;
use glam::{DMat2, DVec2, Vec3Swizzles};

/// Upper bound of the spectral norm of exp(t M) for t in `window`; guarantee as [`motion::stretch`].
///
/// - `window`: `[start, end]` in spans, `start <= end`; need not contain 0.
pub fn stretch(linear: &DMat2, window: [f64; 2]) -> f64 {
    let generator = Generator {
        linear: *linear,
        offset: DVec2::ZERO,
    };
    motion::stretch(&generator.in_space().linear, window)
}

/// A box [min, max] that contains exp(tG) p for all t in `window`; guarantee and cost as [`motion::path_bounds`].
pub fn path_bounds(generator: &Generator, point: DVec2, window: [f64; 2]) -> [DVec2; 2] {
    motion::path_bounds(&generator.in_space(), point.extend(0.0), window).map(|corner| corner.xy())
}

/// A box [min, max] that contains the paths of all points of the box `corners` = [min, max] over `window`; guarantee as
/// [`motion::path_bounds`].
pub fn box_path_bounds(generator: &Generator, corners: [DVec2; 2], window: [f64; 2]) -> [DVec2; 2] {
    let corners = corners.map(|corner| corner.extend(0.0));
    motion::box_path_bounds(&generator.in_space(), corners, window).map(|corner| corner.xy())
}

/// Upper bound of |d2/dt2 exp(tG) p| for t in `window`; to some units in the last place for rigid motions and similarities.
///
/// A chord over a step h departs from the path by at most h^2/8 of it.
pub fn acceleration_bound(generator: &Generator, point: DVec2, window: [f64; 2]) -> f64 {
    motion::acceleration_bound(&generator.in_space(), point.extend(0.0), window)
}

/// Upper bound of the absolute value of any coordinate that a point of the box `corners` = [min, max] reaches in `window`.
pub fn largest_coordinate(generator: &Generator, corners: [DVec2; 2], window: [f64; 2]) -> f64 {
    let [low, high] = box_path_bounds(generator, corners, window);
    low.abs().max(high.abs()).max_element()
}
