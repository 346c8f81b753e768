//! The sweep cycle as a surface, and how it is assembled from the spans.

use super::assembly::Assembly;
use super::coincidence::join;
use crate::Fault;
use crate::numeric::index;
use crate::numeric::tolerance::{Budget, SAME_POSE};
use crate::surface::{SurfacePoint, is_closed};
use crate::watch::{Interrupted, Work};
use glam::{DAffine3, DVec3};

/// The closed oriented surface whose winding number counts the time intervals that a point spends
/// inside the body.
#[derive(Debug, Clone)]
pub struct SweepCycle {
    /// Positions in the world.
    pub positions: Vec<DVec3>,
    /// Index triples; the surface crosses itself.
    pub triangles: Vec<[u32; 3]>,
    /// What sampling and simplification may have changed.
    pub errors: CycleErrors,
    /// What parts of faces with the wrong sign sweep: only there may the cycle wind round too few
    /// points, apart from its sampling.
    pub(crate) wrong: Vec<WrongSheet>,
}

/// Parts of faces that count with the sign opposite to that of their flux, carried by one span.
#[derive(Debug, Clone)]
pub(crate) struct WrongSheet {
    /// In the world at the start of the span.
    pub(crate) parts: Vec<[SurfacePoint; 3]>,
    /// Poses at the time steps, from that start; at least two.
    pub(crate) poses: Vec<DAffine3>,
    /// Bound on the distance of a path of their points from its chords between these poses.
    pub(crate) bend: f64,
}

impl SweepCycle {
    /// A cycle without any spans yet.
    fn none() -> SweepCycle {
        SweepCycle {
            positions: Vec::new(),
            triangles: Vec::new(),
            errors: CycleErrors::none(),
            wrong: Vec::new(),
        }
    }

    /// Checks that every edge is run through equally often in both senses; otherwise winding
    /// numbers have no meaning. O(n).
    ///
    /// # Errors
    /// [`Fault`] when the cycle is not closed.
    pub fn check(&self) -> Result<(), Fault> {
        if is_closed(&self.triangles) {
            Ok(())
        } else {
            Err(Fault::new("the sweep cycle is not closed"))
        }
    }
}

/// Bounds on the deviation of a sampled cycle from the exact one: lengths in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CycleErrors {
    /// Distance between the sampled sheets and the exact ones.
    pub sampling: f64,
    /// Distance from the body of what was added to fill the dents of its egress boundary.
    pub filled_dent: f64,
    /// Estimated depth of the dropped folds, which wrong signs cut out. What they do cut out is
    /// found afterwards.
    pub dropped_fold: f64,
    /// Largest distance by which a break point was moved, to join others.
    pub merge: f64,
    /// Distance between the given body and one for which the signs of a translation are exact,
    /// twice.
    pub displaced: f64,
    /// Largest distance between a point and its assumed place: it counts as resting though it moves
    /// a little, or as back though it is not quite.
    pub snapped: f64,
    /// Number of time steps, over all spans.
    pub steps: usize,
}

impl CycleErrors {
    /// A bound on how far the exact sweep may reach out of the region of the sampled cycle, apart
    /// from pieces of the cycle that are left outside the region and from what wrong signs cut out
    /// (see [`crate::envelope`]).
    pub fn shortfall(&self) -> f64 {
        self.sampling + self.displaced
    }

    /// Width up to which cavities, handles and loose pieces may be artefacts of the sampling and of
    /// the dropped folds: an estimate. Whether they are is then looked at.
    pub(crate) fn artefact(&self) -> f64 {
        self.sampling + self.dropped_fold + self.merge + self.displaced
    }

    /// A bound on how far the region of the sampled cycle may reach out of the exact sweep.
    pub fn excess(&self) -> f64 {
        self.sampling + self.filled_dent
    }

    /// The errors of a cycle without spans.
    pub(crate) fn none() -> CycleErrors {
        CycleErrors {
            sampling: 0.0,
            filled_dent: 0.0,
            dropped_fold: 0.0,
            merge: 0.0,
            displaced: 0.0,
            snapped: 0.0,
            steps: 0,
        }
    }

    /// The errors of two cycles together.
    #[must_use]
    pub(crate) fn worse(self, other: &CycleErrors) -> CycleErrors {
        CycleErrors {
            sampling: self.sampling.max(other.sampling),
            filled_dent: self.filled_dent.max(other.filled_dent),
            dropped_fold: self.dropped_fold.max(other.dropped_fold),
            merge: self.merge.max(other.merge),
            displaced: self.displaced.max(other.displaced),
            snapped: self.snapped.max(other.snapped),
            steps: self.steps + other.steps,
        }
    }
}

/// Cycles that are being assembled; the last one is open to more spans.
pub(super) struct Gathered<'a> {
    pub(super) budget: &'a Budget,
    /// Number of triangles of sheets at which a cycle is closed.
    enough: f64,
    closed: Vec<SweepCycle>,
    open: SweepCycle,
    /// Numbers of the poses of the open cycle's vertices.
    poses: Vec<u32>,
    /// Number of triangles of its sheets.
    sheets: f64,
}

impl<'a> Gathered<'a> {
    pub(super) fn new(budget: &'a Budget, enough: f64) -> Gathered<'a> {
        Gathered {
            budget,
            enough,
            closed: Vec::new(),
            open: SweepCycle::none(),
            poses: Vec::new(),
            sheets: 0.0,
        }
    }

    /// Number of triangles of all cycles.
    pub(super) fn triangles(&self) -> f64 {
        let closed: usize = self.closed.iter().map(|cycle| cycle.triangles.len()).sum();
        (closed + self.open.triangles.len()) as f64
    }

    /// Whether the open cycle has enough triangles of sheets with this many more.
    pub(super) fn is_enough(&self, sheets: f64) -> bool {
        self.sheets + sheets >= self.enough
    }

    /// Adds a closed surface to the open cycle: winding numbers add up.
    pub(super) fn add(
        &mut self,
        assembly: Assembly,
        errors: CycleErrors,
        wrong: Vec<WrongSheet>,
        sheets: f64,
        work: Work,
    ) -> Result<(), Interrupted> {
        let first = index(self.open.positions.len());
        let first_pose = self.poses.iter().max().map_or(0, |last| last + 1);
        self.poses
            .extend(assembly.poses.iter().map(|pose| first_pose + pose));
        self.open.positions.extend(assembly.positions);
        self.open
            .triangles
            .extend(assembly.triangles.iter().map(|t| t.map(|v| first + v)));
        self.open.errors = self.open.errors.worse(&errors);
        self.open.wrong.extend(wrong);
        self.sheets += sheets;
        if self.is_enough(0.0) {
            self.close(work)?;
        }
        Ok(())
    }

    /// Joins points that are the same up to rounding.
    ///
    /// Paths that lead to one place, such as those of an edge and of its image after a third of a
    /// turn about an axis of symmetry, miss it by their rounding and by that of the body. Where
    /// nothing is sampled, everything is kept.
    fn close(&mut self, work: Work) -> Result<(), Interrupted> {
        let mut cycle = std::mem::replace(&mut self.open, SweepCycle::none());
        let poses = std::mem::take(&mut self.poses);
        self.sheets = 0.0;
        let reach = cycle
            .positions
            .iter()
            .map(|p| p.abs().max_element())
            .fold(0.0, f64::max);
        let same = SAME_POSE * reach;
        let is_sampled = cycle.errors.sampling > same;
        let distance = if is_sampled { self.budget.merge } else { same };
        let joined = join(
            &cycle.positions,
            &poses,
            &cycle.triangles,
            same,
            distance,
            work,
        )?;
        cycle.errors.snapped += joined.largest_move;
        (cycle.positions, cycle.triangles) = (joined.positions, joined.triangles);
        self.closed.push(cycle);
        Ok(())
    }

    /// The cycles, at least one.
    pub(super) fn finish(mut self, work: Work) -> Result<Vec<SweepCycle>, Interrupted> {
        if !self.open.triangles.is_empty() || self.closed.is_empty() {
            self.close(work)?;
        }
        Ok(self.closed)
    }
}
