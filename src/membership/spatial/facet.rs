//! A triangle of the body, prepared to be crossed by paths.

use crate::membership::event::Event;
use crate::membership::height::Height;
use crate::membership::patch::Patch;
use crate::membership::path::Stretch;
use crate::numeric::area::{THIN, area_vector};
use crate::numeric::tolerance::UNIT_ROUNDOFF;
use glam::DVec3;

/// A triangle as the intersection of a plane with half spaces.
pub(super) type FacePatch = Patch<3>;

impl FacePatch {
    /// - `least_height`: the least height that rounding leaves meaningful, from the size of the
    ///   body.
    ///
    /// `None` for a triangle lower than that: a path that passes through it also passes, within
    /// rounding, through its neighbours.
    pub(super) fn new([a, b, c]: [DVec3; 3], least_height: f64) -> Option<FacePatch> {
        // The normal is most accurate from the corner opposite the longest edge.
        let lengths = [(c - b).length(), (a - c).length(), (b - a).length()];
        let longest = lengths.into_iter().fold(0.0, f64::max);
        let corners = if lengths[0] == longest {
            [a, b, c]
        } else if lengths[1] == longest {
            [b, c, a]
        } else {
            [c, a, b]
        };
        let area = area_vector(corners);
        if area.length() <= least_height * longest {
            return None;
        }
        let normal = area.normalize();
        let edge = |from: DVec3, to: DVec3| normal.cross(to - from).normalize_or_zero();
        let inward = [
            edge(corners[0], corners[1]),
            edge(corners[1], corners[2]),
            edge(corners[2], corners[0]),
        ];
        let sine =
            area.length() / (corners[0].distance(corners[1]) * corners[0].distance(corners[2]));
        let error = CROSS_ROUNDING / sine.max(THIN) * UNIT_ROUNDOFF * longest;
        Some(FacePatch {
            normal,
            corners,
            inward,
            error,
        })
    }

    /// Appends every event between the path over a window and this triangle.
    pub(super) fn meet(&self, stretch: &Stretch, found: &mut Vec<Event>) {
        self.meet_within(stretch, |height| self.half_spaces(stretch, height), found);
    }

    /// - `height`: the height over the plane.
    fn half_spaces(&self, stretch: &Stretch, height: &Height) -> [Height; 8] {
        let [a, b, c] = self.corners;
        // Near a sharp corner, a point may be far from the triangle and yet near the half spaces of
        // both edges. With a third one, across the corner, a point within d of all is within
        // sqrt(2) d of the triangle.
        let tip = |corner: DVec3, next: DVec3, last: DVec3| {
            let along = |to: DVec3| (to - corner).normalize_or_zero();
            let inward = (along(next) + along(last)).normalize_or_zero();
            Height::new(stretch, inward, corner)
        };
        [
            *height,
            height.negative(),
            self.over_side(stretch, 0),
            self.over_side(stretch, 1),
            self.over_side(stretch, 2),
            tip(a, b, c),
            tip(b, c, a),
            tip(c, a, b),
        ]
    }
}

/// Unit roundoffs by which a cross product of two edges may be off, relative to the product of
/// their lengths.
const CROSS_ROUNDING: f64 = 4.0;
