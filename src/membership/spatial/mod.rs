//! A point and a moving body in space: during which times is the point inside?

mod facet;

use super::deviating::Deviating;
use super::event::Event;
use super::path::{SpanPaths, Stretch};
use super::settings::{ProbeSettings, ProbeStage};
use super::timeline::{Resting, Timeline, gaps};
use crate::body::Mesh;
use crate::bounds::{SurfaceTree, box_corners};
use crate::motion::{Flow, Motion, Pace};
use crate::numeric::tolerance::{PATH_ROUNDING, UNIT_ROUNDOFF};
use crate::watch::Interrupted;
use facet::FacePatch;
use glam::DVec3;
use rayon::prelude::*;

/// A moving body prepared for many point queries.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use steadysweep::body::Mesh;
/// use steadysweep::membership::Membership;
/// use steadysweep::motion::{Generator, Motion, Span};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let body = Mesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])?;
/// let along = Generator::translation(2.0 * DVec3::X);
/// let motion = Motion::from_spans(vec![Span::new(along, 1.0)?])?;
///
/// // At the height of the point the tetrahedron reaches from x = 0 to x = 1/2, and moves by 2.
/// let times = Membership::new(&body, &motion).intervals(DVec3::new(1.0, 0.25, 0.25));
/// assert!(matches!(times[..], [[from, to]] if (from - 0.25).abs() + (to - 0.5).abs() < 1e-12));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Membership {
    body: Facets,
    timeline: Timeline,
    deviating: Option<Deviating<Flow>>,
}

/// The triangles of a body.
#[derive(Debug)]
struct Facets {
    tree: SurfaceTree,
    /// One entry per triangle; `None` for a triangle that is too low to be passed through.
    facets: Vec<Option<FacePatch>>,
}

impl Resting for Facets {
    fn meet(&self, stretch: &Stretch, found: &mut Vec<Event>) {
        let Stretch {
            start, end, bulge, ..
        } = *stretch;
        self.tree
            .for_each_near_segment(start, end, bulge, |triangle| {
                if let Some(facet) = &self.facets[triangle as usize] {
                    facet.meet(stretch, found);
                }
            });
    }

    fn winding_number(&self, point: DVec3) -> Option<i32> {
        self.tree.winding_number(point)
    }
}

impl Membership {
    /// Prepares `body`, given in its own frame and carried by `motion`.
    ///
    /// # Cost
    /// O(#F log #F), about a microsecond per triangle, and some 100 poses per turn of the motion.
    pub fn new(body: &Mesh, motion: &Motion) -> Membership {
        let tree = SurfaceTree::new(body.positions(), body.triangles());
        let [min, max] = body.bounds();
        let least_height = PATH_ROUNDING * UNIT_ROUNDOFF * min.abs().max(max.abs()).max_element();
        let indices = 0..u32::try_from(body.triangles().len()).unwrap_or(u32::MAX);
        let facets = indices.map(|index| FacePatch::new(tree.corners(index), least_height));
        let facets = facets.collect();

        let corners = box_corners([min, max]);
        let at_start = corners.map(|corner| motion.start_pose().transform_point3(corner));
        let merged = motion.merged(&at_start, Pace::Even);
        let edges = body.edges().iter().map(|edge| {
            let [from, to] = edge
                .vertices
                .map(|vertex| body.positions()[vertex as usize]);
            from.distance(to)
        });
        let detail = edges.sum::<f64>() / body.edges().len() as f64;
        let spans = (0..merged.motion.spans().len()).map(|index| {
            let paths = SpanPaths::of_span(&merged.motion, index, &corners, detail);
            paths.deviating(merged.deviation)
        });
        Membership {
            deviating: Deviating::new(motion, &corners),
            body: Facets { tree, facets },
            timeline: Timeline {
                spans: spans.collect(),
                joint_times: merged.motion.joint_times().to_vec(),
                gaps: gaps(&merged, motion.joint_times()),
            },
        }
    }

    /// Closed time intervals on the motion's clock during which `point` (world) is in the closed
    /// body: ascending, disjoint, merged across joints. Empty for a point that is not finite.
    ///
    /// # Guarantee
    /// Up to rounding, no interval is missed and none is invented. Times of transversal entries and
    /// exits are accurate to 1e-9 of their span, and far better for ordinary motions. See
    /// [`crate::membership`].
    ///
    /// # Cost
    /// 5 microseconds for points anywhere near a body of 7,000 triangles on half a turn, and 20 for
    /// points on its vertices (`benches/membership.rs`).
    pub fn intervals(&self, point: DVec3) -> Vec<[f64; 2]> {
        self.timeline.intervals(&self.body, point)
    }

    /// Whether `point` (world) is ever in the closed body, given its
    /// [`intervals`](Membership::intervals); `None` where the motion stands for another one
    /// ([`Motion::deviation`]) and may deviate from it by more than what decides.
    pub fn is_inside_for_certain(&self, point: DVec3, intervals: &[[f64; 2]]) -> Option<bool> {
        match &self.deviating {
            None => Some(!intervals.is_empty()),
            Some(deviating) => {
                let distance = |place| self.body.tree.distance_to_surface(place);
                deviating.is_ever_inside(point, intervals, &distance)
            }
        }
    }

    /// [`Membership::intervals`] for many points, in their order, in parallel. The result does not
    /// depend on the number of threads.
    pub fn intervals_of(&self, points: &[DVec3]) -> Vec<Vec<[f64; 2]>> {
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
        points: &[DVec3],
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
    pub fn is_ever_inside(&self, point: DVec3) -> bool {
        self.timeline.is_ever_inside(&self.body, point)
    }
}
