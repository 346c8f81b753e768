//! Corners of boxes.

use glam::{DVec2, DVec3};

/// The corners of a box [min, max].
pub(crate) fn box_corners([min, max]: [DVec3; 2]) -> [DVec3; 8] {
    std::array::from_fn(|corner| {
        let pick = |axis: usize| {
            if corner >> axis & 1 == 0 {
                min[axis]
            } else {
                max[axis]
            }
        };
        DVec3::new(pick(0), pick(1), pick(2))
    })
}

/// The corners of a rectangle [min, max].
pub(crate) fn rectangle_corners([min, max]: [DVec2; 2]) -> [DVec2; 4] {
    [min, max, DVec2::new(min.x, max.y), DVec2::new(max.x, min.y)]
}
