//! A surface that sinks into a solid, and the depth of its points.

use super::depth::{PlacedSolid, Sounding};
use super::encounter::Encounter;
use super::triangle_piece::{Weights, blend};
use glam::DVec3;

/// A surface that sinks into a solid.
pub(super) struct Sinking<'a> {
    pub(super) encounter: &'a Encounter<'a>,
    /// Number of the shape whose surface sinks; the other one is the solid.
    pub(super) surface: usize,
    /// The allowed depth.
    pub(super) depth: f64,
}

/// A point of the surface that is deeper than allowed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Deep {
    pub(super) triangle: u32,
    pub(super) weights: Weights,
}

/// Number of errors of position by which a point must be deeper to be certainly so.
pub(super) const CERTAIN: f64 = 2.0;

impl<'a> Sinking<'a> {
    /// The surface that sinks when two shapes meet: that of the first into the second if the second
    /// is closed; otherwise the second, a sheet, into the first.
    pub(super) fn new(encounter: &'a Encounter<'a>, depth: f64) -> Sinking<'a> {
        Sinking {
            encounter,
            surface: usize::from(!encounter.shapes[1].closed()),
            depth,
        }
    }

    pub(super) fn solid(&self, time: f64) -> PlacedSolid<'a> {
        self.encounter.solid(1 - self.surface, time)
    }

    /// A point of the surface in its own frame.
    pub(super) fn own(&self, deep: &Deep) -> DVec3 {
        let corners = self.encounter.shapes[self.surface].corners(deep.triangle);
        blend(&corners, deep.weights)
    }

    /// A point of the surface at a time, and how deep it is.
    pub(super) fn sound(&self, deep: &Deep, time: f64) -> Sounding {
        let pose = self.encounter.movers[self.surface].pose(time);
        self.solid(time)
            .sound(pose.transform_point3(self.own(deep)))
    }

    /// Whether a point is certainly deeper than allowed.
    pub(super) fn is_deep(&self, depth: f64, time: f64) -> bool {
        depth > self.depth + CERTAIN * self.encounter.slack(time)
    }
}
