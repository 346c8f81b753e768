//! A point of the plane and a moving planar body: during which times is the point inside?
//!
//! The method is that of space, see [`super`]: the plane is z = 0 there, and an edge of the body is
//! the piece of a line that a path crosses. The remarks on rounding there hold here too.

mod edge;

use super::deviating::Deviating;
use super::event::Event;
use super::path::{SpanPaths, Stretch};
use super::settings::{ProbeSettings, ProbeStage};
use super::timeline::{Resting, Timeline, gaps};
use crate::body::Polygon;
use crate::bounds::{OutlineTree, rectangle_corners};
use crate::motion::Pace;
use crate::motion::planar::{Flow, Motion, in_space};
use crate::numeric::tolerance::{PATH_ROUNDING, UNIT_ROUNDOFF};
use crate::watch::Interrupted;
use edge::EdgePatch;
use glam::{DVec2, DVec3, Vec3Swizzles};
use rayon::prelude::*;

/// A moving planar body prepared for many point queries.
///
/// # Example
/// ```
/// use glam::DVec2;
/// use steadysweep::planar::{FillRule, Generator, Membership, Motion, Polygon, Span};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(DVec2::from_array);
/// let body = Polygon::new(vec![corners.to_vec()], FillRule::EvenOdd)?;
/// let along = Generator::translation(DVec2::new(2.0, 0.0));
/// let motion = Motion::from_spans(vec![Span::new(along, 1.0)?])?;
///
/// // At the height of the point the triangle reaches from x = 0 to x = 1/2, and moves by 2.
/// let times = Membership::new(&body, &motion).intervals(DVec2::new(1.0, 0.5));
/// assert!(matches!(times[..], [[from, to]] if (from - 0.25).abs() + (to - 0.5).abs() < 1e-12));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Membership {
    body: Edges,
    timeline: Timeline,
    deviating: Option<Deviating<Flow>>,
}

/// The edges of a body.
#[derive(Debug)]
struct Edges {
    tree: OutlineTree,
    /// One entry per edge; `None` for an edge that is too short to be passed through.
    edges: Vec<Option<EdgePatch>>,
}

impl Resting for Edges {
    fn meet(&self, stretch: &Stretch, found: &mut Vec<Event>) {
        let [start, end] = [stretch.start, stretch.end].map(|position| position.xy());
        self.tree
            .for_each_near_segment(start, end, stretch.bulge, |edge| {
                if let Some(edge) = &self.edges[edge as usize] {
                    edge.meet(stretch, found);
                }
            });
    }

    fn winding_number(&self, point: DVec3) -> Option<i32> {
        self.tree.winding_number(point.xy())
    }
}

impl Membership {
    /// Prepares `body`, given in its own frame and carried by `motion`.
    ///
    /// # Cost
    /// O(#E log #E), about a microsecond per edge, and some 100 poses per turn of the motion (more
    /// for shorter edges).
    pub fn new(body: &Polygon, motion: &Motion) -> Membership {
        let positions = body.positions();
        let ends: Vec<[u32; 2]> = body.edges().collect();
        let [min, max] = body.bounds();
        let least_length = PATH_ROUNDING * UNIT_ROUNDOFF * min.abs().max(max.abs()).max_element();
        let edges = ends.iter().map(|ends| {
            let ends = ends.map(|end| positions[end as usize]);
            EdgePatch::of(ends, least_length)
        });
        let corners = rectangle_corners([min, max]);
        let at_start = corners.map(|corner| motion.start_pose().transform_point2(corner));
        let merged = motion.merged(&at_start, Pace::Even);
        let corners = corners.map(|corner| corner.extend(0.0));
        let detail = body.perimeter() / ends.len() as f64;
        let spans = merged.motion.spans().iter().zip(merged.motion.joints());
        let spans = spans.map(|(span, joint)| {
            let flow = span.flow();
            SpanPaths::new(
                &flow.generator().in_space(),
                |s| in_space(&flow.pose_at(s)),
                &in_space(&(*joint * *motion.start_pose())),
                &corners,
                detail,
            )
            .deviating(merged.deviation)
        });
        Membership {
            deviating: Deviating::new(motion, &corners),
            timeline: Timeline {
                spans: spans.collect(),
                joint_times: merged.motion.joint_times().to_vec(),
                gaps: gaps(&merged, motion.joint_times()),
            },
            body: Edges {
                tree: OutlineTree::new(positions, &ends),
                edges: edges.collect(),
            },
        }
    }

    /// Closed time intervals on the motion's clock during which `point` (world) is in the closed
    /// body: ascending, disjoint, merged across joints. Empty for a point that is not finite.
    ///
    /// # Guarantee
    /// Up to rounding, no interval is missed and none is invented. Times of transversal entries and
    /// exits are accurate to 1e-9 of their span, and far better for ordinary motions. The head of
    /// [`super`] has the details.
    ///
    /// # Cost
    /// Some 10 microseconds for points anywhere near a smooth outline of 1,000 edges on half a
    /// turn, and 30 for points on its corners (`benches/membership.rs`). The time grows as the
    /// square root of the number of edges, since shorter edges need shorter windows.
    pub fn intervals(&self, point: DVec2) -> Vec<[f64; 2]> {
        self.timeline.intervals(&self.body, point.extend(0.0))
    }

    /// Whether `point` (world) is ever in the closed body, given its
    /// [`intervals`](Membership::intervals); `None` where the motion stands for another one
    /// ([`Motion::deviation`]) and may deviate from it by more than what decides.
    pub fn is_inside_for_certain(&self, point: DVec2, intervals: &[[f64; 2]]) -> Option<bool> {
        match &self.deviating {
            None => Some(!intervals.is_empty()),
            Some(deviating) => {
                let distance = |place: DVec3| self.body.tree.distance(place.xy());
                deviating.is_ever_inside(point.extend(0.0), intervals, &distance)
            }
        }
    }

    /// [`Membership::intervals`] for many points, in their order, in parallel. The result does not
    /// depend on the number of threads.
    pub fn intervals_of(&self, points: &[DVec2]) -> Vec<Vec<[f64; 2]>> {
        points
            .par_iter()
            .map(|&point| self.intervals(point))
            .collect()
    }

    /// [`Membership::intervals_of`], observed, and stopped on request.
    ///
    /// # Errors
    /// [`Interrupted`] when the flag of the settings was set.
    pub fn probe(
        &self,
        points: &[DVec2],
        settings: &ProbeSettings,
    ) -> Result<Vec<Vec<[f64; 2]>>, Interrupted> {
        let stages = settings.watch.start();
        let items = stages.begin(ProbeStage::Points)?.items(points.len());
        points
            .par_iter()
            .map(|&point| {
                items.next()?;
                Ok(self.intervals(point))
            })
            .collect()
    }

    /// Whether `point` (world) is ever in the closed body: whether it has any
    /// [`intervals`](Membership::intervals).
    pub fn is_ever_inside(&self, point: DVec2) -> bool {
        self.timeline.is_ever_inside(&self.body, point.extend(0.0))
    }
}
