//! An edge of a planar body, prepared to be crossed by paths in the plane z = 0.

use crate::membership::event::Event;
use crate::membership::height::Height;
use crate::membership::patch::Patch;
use crate::membership::path::Stretch;
use crate::numeric::tolerance::UNIT_ROUNDOFF;
use glam::DVec2;

/// An edge as what is between its ends on a line.
pub(super) type Edge = Patch<2>;

impl Edge {
    /// From `from` to `to`, the body on the left.
    ///
    /// - `least_length`: what rounding leaves of a length, from the size of the body.
    ///
    /// `None` for an edge that is shorter: what passes through it passes, within rounding, its neighbours.
    pub(super) fn of([from, to]: [DVec2; 2], least_length: f64) -> Option<Edge> {
        let length = from.distance(to);
        if length <= least_length {
            return None;
        }
        let along = (to - from) / length;
        let in_space = |vector: DVec2| vector.extend(0.0);
        Some(Edge {
            normal: in_space(-along.perp()),
            corners: [from, to].map(in_space),
            inward: [along, -along].map(in_space),
            error: NORMAL_ROUNDING * UNIT_ROUNDOFF * length,
        })
    }

    /// Appends every event between the path over a window and this edge.
    pub(super) fn meet(&self, stretch: &Stretch, found: &mut Vec<Event>) {
        let half_spaces = |height: &Height| {
            [
                *height,
                height.negative(),
                self.over_side(stretch, 0),
                self.over_side(stretch, 1),
            ]
        };
        self.meet_within(stretch, half_spaces, found);
    }
}

/// Unit roundoffs by which the direction of an edge may be off: of a difference, a length and a quotient.
const NORMAL_ROUNDING: f64 = 4.0;
