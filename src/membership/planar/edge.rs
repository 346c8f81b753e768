//! An edge of a planar body, prepared to be crossed by paths in the plane z = 0.

use crate::membership::event::Event;
use crate::membership::height::Height;
use crate::membership::patch::Patch;
use crate::membership::path::Stretch;
use crate::numeric::tolerance::UNIT_ROUNDOFF;
use glam::DVec2;

/// An edge as the part of a line between its ends.
pub(super) type EdgePatch = Patch<2>;

impl EdgePatch {
    /// The edge from `from` to `to`, with the body on its left.
    ///
    /// - `least_length`: the least length that rounding leaves meaningful, from the size of the
    ///   body.
    ///
    /// `None` for a shorter edge: a path that passes through it also passes, within rounding,
    /// through its neighbours.
    pub(super) fn of([from, to]: [DVec2; 2], least_length: f64) -> Option<EdgePatch> {
        let length = from.distance(to);
        if length <= least_length {
            return None;
        }
        let along = (to - from) / length;
        let in_space = |vector: DVec2| vector.extend(0.0);
        Some(EdgePatch {
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

/// Unit roundoffs by which the direction of an edge may be off: those of a difference, a length and
/// a quotient.
const NORMAL_ROUNDING: f64 = 4.0;
