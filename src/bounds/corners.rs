//! Boxes along the axes: their corners, those around triangles, and whether they meet.

use glam::{DVec2, DVec3};

/// The smallest box around a triangle: its lowest and its highest corner.
pub(crate) fn triangle_box([a, b, c]: [DVec3; 3]) -> [DVec3; 2] {
    [a.min(b).min(c), a.max(b).max(c)]
}

/// Whether two closed boxes meet.
pub(crate) fn boxes_meet([low, high]: [DVec3; 2], [other_low, other_high]: [DVec3; 2]) -> bool {
    low.cmple(other_high).all() && other_low.cmple(high).all()
}

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
