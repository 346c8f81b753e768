//! The region swept by lines of the plane, which have no inside.
//!
//! # Both sides of the lines
//! Lines pass a point when it crosses them, in the one sense or in the other. Added with their
//! signs, crossings in opposite senses would cancel: what a segment sweeps forth and back would
//! have a winding number of 0, and an S-shaped line that turns about its middle would lose half of
//! what it sweeps. So the lines are taken as the border of a body without an inside, along each
//! line and back. Where one side moves forwards, the flux of the other is negative: of the two, just
//! one is egress. The sweep cycle of this body ([`crate::envelope`]) therefore has the winding
//! number
//!
//! > w(x) = the number of times at which x crosses the lines, in either sense,
//!
//! which is never negative, and the region is where it is at least 1. It is the sum of the two
//! cycles that one gets from the egress and from the ingress parts apart, and closed with the same
//! strips: paths of the ends of the lines, of corners, and of the points at which the flux changes
//! sign, which come from both sides.
//!
//! # What is covered without being crossed
//! The lines cover a point of the plane without crossing it only
//! - on the curves of the cycle: at the start or at the end, or at a point at which they graze; the
//!   proof for bodies holds for these;
//! - on an edge that moves along itself, on which the flux is zero, and stays zero for the whole
//!   span. Its edge and twin count as egress both, and cancel. It moves within its straight line,
//!   monotonously. So it covers no more than itself at the start of the span and the straight paths
//!   of its ends. These segments bound no area; how far they reach out of the region is part of the
//!   bound on what the result lacks.
//!
//! SAM, Fig. 10, shows the region of one segment.

use super::{Subject, Sweep, SweepError, SweepSettings, swept};
use crate::body::{Polygon, Polylines};
use crate::grazing::planar::{EdgeFlux, GrazingSet};
use crate::motion::planar::Motion;
use glam::DVec2;

/// The region that lines sweep under `motion`: all points that they pass over.
///
/// - `lines`: in their own frame; they may cross each other.
/// - `motion`: carries that frame through the plane.
/// - `settings`: as for [`sweep`](super::sweep()).
///
/// A line that is closed is still a line: what it encloses counts only where it passes.
///
/// # Guarantee
/// As for [`sweep`](super::sweep()), both bounds are proven. An edge that moves along itself sweeps
/// no area: where it reaches out of the region, `error_bound.inside` is at least as large, and finer
/// sampling does not help. Holes that only the sampling made are not filled.
///
/// # Errors
/// [`SweepError`]; [`SweepError::NoArea`] where all lines rest or move along themselves.
///
/// # Cost
/// As for a polygon of twice as many edges.
///
/// # Example
/// ```
/// use glam::DVec2;
/// use std::f64::consts::{PI, TAU};
/// use steadysweep::planar::{Generator, Motion, Polylines, Span, SweepSettings, sweep_lines};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // A segment that turns about its middle sweeps a disc; each end half of its border.
/// let segment = Polylines::new(vec![vec![DVec2::new(-1.0, 0.0), DVec2::new(1.0, 0.0)]])?;
/// let turn = Generator::spiral(DVec2::ZERO, PI, 1.0);
/// let motion = Motion::from_spans(vec![Span::new(turn, 1.0)?])?;
///
/// let swept = sweep_lines(&segment, &motion, &SweepSettings::default())?;
/// assert!((swept.measures.area - PI).abs() < TAU * swept.error_bound.inside.length);
/// assert_eq!((swept.measures.pieces, swept.measures.holes), (1, 0));
/// # Ok(())
/// # }
/// ```
pub fn sweep_lines(
    lines: &Polylines,
    motion: &Motion,
    settings: &SweepSettings,
) -> Result<Sweep, SweepError> {
    let sides = lines.transformed(motion.start_pose()).both_sides();
    let subject = Subject {
        groups: vec![sides.polygon.clone()],
        body: None,
        bounds: lines.bounds(),
        twins: sides.twins,
    };
    swept(&sides.polygon, subject, motion, settings)
}

/// Segments that together hold all that edges cover while they move along themselves.
///
/// - `sides`: both sides of lines, where the motion starts.
/// - `twins`: for each edge the one that runs back along it; empty for a body.
pub(super) fn sliding(sides: &Polygon, twins: &[u32], motion: &Motion) -> Vec<[DVec2; 2]> {
    let mut segments = Vec::new();
    if twins.is_empty() {
        return segments;
    }
    let edges: Vec<[u32; 2]> = sides.edges().collect();
    for (span, joint) in motion.spans().iter().zip(motion.joints()) {
        let place = |&p: &DVec2| joint.transform_point2(p);
        let positions: Vec<DVec2> = sides.positions().iter().map(place).collect();
        let set = GrazingSet::new(sides, &positions, span.flow().generator(), 0.0);
        let end = span.flow().pose_at(1.0);
        for (edge, &twin) in (0u32..).zip(twins) {
            let slides =
                [edge, twin].map(|e| set.edges[e as usize] == EdgeFlux::Egress) == [true; 2];
            if slides && edge < twin {
                let [a, b] = edges[edge as usize].map(|corner| positions[corner as usize]);
                let [c, d] = [a, b].map(|p| end.transform_point2(p));
                segments.extend([[a, b], [a, c], [b, d]]);
            }
        }
    }
    segments
}
