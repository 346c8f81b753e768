//! What the flow of one span carries along: the boundary of the egress region, prepared for the
//! sweep.

use super::lines::SpanLines;
use super::points::BodyPoints;
use super::room::Room;
use super::sampling::Sampling;
use super::sinking::{SunkBoundary, sink};
use super::straightening::straighten;
use crate::body::Mesh;
use crate::grazing::spatial::{GrazingSet, Interval, Simplification, boundary};
use crate::motion::{Flow, Generator};
use crate::numeric::tolerance::{Budget, MOST_TRIANGLES};
use crate::watch::{Interrupted, Work};
use glam::{DAffine3, DVec3};

/// Why a sweep cycle was refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CycleError {
    /// There would be too many triangles.
    #[error(
        "the sampled surface would have at least {triangles:.1e} triangles, more than {MOST_TRIANGLES:.0e}; \
         use a coarser tolerance or a shorter motion"
    )]
    TooLarge {
        /// Number of triangles that there would be at least: pieces that have to be divided count
        /// once, where the others are enough for a refusal.
        triangles: f64,
    },
    /// There would be too many triangles, estimated from some of the spans before any is swept.
    #[error(
        "the sampled surface of {spans} spans would have about {triangles:.1e} triangles (estimated from {sampled} of \
         the spans), more than {MOST_TRIANGLES:.0e}; use fewer keyframes, a shorter motion, a coarser tolerance or a \
         coarser body"
    )]
    ManySpans {
        /// Approximate number of triangles that there would be.
        triangles: f64,
        /// Number of spans.
        spans: usize,
        /// Number of spans that were examined.
        sampled: usize,
    },
    /// The flag that stops a whole sweep was set; a cycle alone has none.
    #[error("interrupted")]
    Interrupted,
}

impl From<Interrupted> for CycleError {
    fn from(_: Interrupted) -> CycleError {
        CycleError::Interrupted
    }
}

/// The grazing set of a body in the pose `frame` relative to the start of the motion.
pub(super) fn grazing_at(
    body: &Mesh,
    frame: &DAffine3,
    generator: &Generator,
    simplification: Simplification,
    work: Work,
) -> Result<GrazingSet, Interrupted> {
    let positions: Vec<DVec3> = body
        .positions()
        .iter()
        .map(|&p| frame.transform_point3(p))
        .collect();
    GrazingSet::new(body, &positions, generator, simplification, work)
}

/// What the flow of one span carries along.
pub(super) struct Carry {
    pub(super) on_body: SpanLines,
    pub(super) moved: SunkBoundary,
    /// Distance of filled dents from the body.
    pub(super) filled_reach: f64,
}

impl Carry {
    /// Number of triangles of its sheets.
    pub(super) fn triangles(&self) -> f64 {
        self.moved.carried.len() as f64 * 2.0 * self.on_body.sampling.steps as f64
    }
}

/// The boundary of the egress region of a span, and the sampling of what it sweeps.
pub(super) fn sampled_boundary(
    body: &Mesh,
    grazing: &GrazingSet,
    (flow, frame): (&Flow, &DAffine3),
    budget: &Budget,
) -> (Vec<Interval>, Sampling) {
    let intervals = boundary(body, grazing, frame, flow.generator());
    let ends = intervals
        .iter()
        .flat_map(|i| i.ends.map(|t| frame.transform_point3(i.at(t))));
    let sampling = Sampling::new(flow, ends, budget);
    (intervals, sampling)
}

/// The boundary of the egress region of a span, divided, straightened and sunk.
///
/// # Errors
/// [`CycleError`] when it sweeps too many triangles even undivided.
pub(super) fn carried(
    body: &Mesh,
    grazing: &GrazingSet,
    (flow, frame): (&Flow, &DAffine3),
    budget: &Budget,
    room: &Room,
    points: &mut BodyPoints,
    work: Work,
) -> Result<Carry, CycleError> {
    let [dividing, sinking] = work.parts([1, 1]);
    let (intervals, sampling) = sampled_boundary(body, grazing, (flow, frame), budget);
    // The size before long pieces are divided and inner ones get fins.
    check_size(intervals.len() as f64 * 2.0 * sampling.steps as f64)?;
    let on_body = SpanLines::new(
        body,
        grazing,
        (frame, &intervals),
        sampling,
        budget,
        points,
        dividing,
    )?;
    let sampling = &on_body.sampling;
    work.check()?;
    let filled = straighten(&on_body.pieces, frame, sampling, budget, points);
    let absorbed = &filled.absorbed;
    let mut moved = sink(
        &on_body.pieces,
        absorbed,
        frame,
        sampling,
        room,
        points,
        sinking,
    )?;
    moved.carried.extend(filled.chords);
    moved.fins.extend(filled.fins);
    Ok(Carry {
        on_body,
        moved,
        filled_reach: filled.reach,
    })
}

/// Refuses more triangles than a cycle may have.
pub(super) fn check_size(triangles: f64) -> Result<(), CycleError> {
    if triangles <= MOST_TRIANGLES as f64 {
        Ok(())
    } else {
        Err(CycleError::TooLarge { triangles })
    }
}
