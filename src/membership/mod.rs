//! A point against the moving body: during which times is it inside?
//!
//! A world point x is in the body at time t iff the point that the body sees, c(t) = pose(t)^-1 x, is in the body at rest. Per
//! span c is a curve with a known expansion (`path`). It is followed in short windows: over each it stays within a certified
//! distance of its chord, so a thick segment through the tree of the body finds every triangle that it can meet.
//! The height over the plane of such a triangle is a polynomial; its zeros are isolated by bounds (`numeric::roots`), never by sampling.
//! Between consecutive zeros nothing can change: the winding number follows from the crossings, and wherever one
//! is in doubt (edges, vertices, tangency, joints) from the exact test at rest in the middle of the piece.
//!
//! # Rounding
//! Every position c is known to within a slack of k u L (L: the largest of the coordinates of the point, the motion and the body,
//! as the body sees them up to that time; [`PATH_ROUNDING`]). What is within a few slacks of a triangle, not only of its plane,
//! counts as touching it (`touch`):
//! - The body is closed: sliding along a face, an edge or a vertex counts as inside, also when the body is
//!   never entered. A touch at one instant gives a degenerate interval, [t, t] or slightly longer.
//! - The time of a transversal crossing is known to the slack over the normal speed, far below 1e-9 of the span
//!   for ordinary motions. At a tangency it is the square root of that: an absence or a visit
//!   that is not deeper than a few slacks may be lost or appear.
//! - Two crossings that rounding cannot keep apart, and anything else below this resolution, is united.

mod event;
mod facet;
mod height;
mod path;
mod touch;

use crate::body::Mesh;
use crate::bounds::{Location, SurfaceTree};
use crate::motion::Motion;
use crate::numeric::tolerance::{JOINT_GAP, PATH_ROUNDING, UNIT_ROUNDOFF};
use event::{Event, unite};
use facet::Facet;
use glam::DVec3;
use path::{Path, SpanPaths};
use rayon::prelude::*;

/// A moving body prepared for many point queries.
#[derive(Debug)]
pub struct Membership {
    tree: SurfaceTree,
    /// One per triangle; `None` for one that is too low to be passed through.
    facets: Vec<Option<Facet>>,
    spans: Vec<SpanPaths>,
    joint_times: Vec<f64>,
}

impl Membership {
    /// `body` in its own frame, carried by `motion`.
    ///
    /// # Cost
    /// O(#F log #F), about a microsecond per triangle, and some 100 poses per turn of the motion.
    pub fn new(body: &Mesh, motion: &Motion) -> Membership {
        let tree = SurfaceTree::new(body.positions(), body.triangles());
        let [min, max] = body.bounds();
        let least_height = PATH_ROUNDING * UNIT_ROUNDOFF * min.abs().max(max.abs()).max_element();
        let indices = 0..u32::try_from(body.triangles().len()).unwrap_or(u32::MAX);
        let facets = indices.map(|index| Facet::new(tree.corners(index), least_height));
        let facets = facets.collect();

        let corners = std::array::from_fn(|corner| {
            let pick = |axis: usize| {
                if corner >> axis & 1 == 0 {
                    min[axis]
                } else {
                    max[axis]
                }
            };
            DVec3::new(pick(0), pick(1), pick(2))
        });
        let edges = body.edges().iter().map(|edge| {
            let [from, to] = edge
                .vertices
                .map(|vertex| body.positions()[vertex as usize]);
            from.distance(to)
        });
        let detail = edges.sum::<f64>() / body.edges().len() as f64;
        let spans = motion.spans().iter().enumerate();
        let spans = spans
            .map(|(index, span)| SpanPaths::new(motion, index, span, &corners, detail))
            .collect();
        Membership {
            tree,
            facets,
            spans,
            joint_times: motion.joint_times(),
        }
    }

    /// Closed time intervals on the motion's clock during which `point` (world) is in the closed body: ascending, disjoint,
    /// merged across joints. Empty for a point that is not finite.
    ///
    /// # Guarantee
    /// No interval is missed and none invented beyond rounding; times of transversal entries and exits are good to
    /// 1e-9 of their span, and far better for ordinary motions. The head of this module has it in full.
    ///
    /// # Cost
    /// 5 microseconds for points anywhere near a body of 7,000 triangles on half a turn, 20 for
    /// points on its vertices (`benches/membership.rs`).
    pub fn intervals(&self, point: DVec3) -> Vec<[f64; 2]> {
        let mut intervals = Vec::new();
        for span in 0..self.spans.len() {
            self.append_span(span, point, &mut intervals);
        }
        intervals
    }

    /// [`Membership::intervals`] of many points, in their order, in parallel. The result does not depend on the number of threads.
    pub fn intervals_of(&self, points: &[DVec3]) -> Vec<Vec<[f64; 2]>> {
        points
            .par_iter()
            .map(|&point| self.intervals(point))
            .collect()
    }

    /// Whether `point` (world) is ever in the closed body: whether it has any [`intervals`](Membership::intervals).
    pub fn is_ever_inside(&self, point: DVec3) -> bool {
        let mut intervals = Vec::new();
        (0..self.spans.len()).any(|span| {
            self.append_span(span, point, &mut intervals);
            !intervals.is_empty()
        })
    }

    /// Appends the intervals within one span, uniting them with what ends where they begin.
    fn append_span(&self, span: usize, point: DVec3, intervals: &mut Vec<[f64; 2]>) {
        if !point.is_finite() {
            return;
        }
        let path = self.spans[span].path(point);
        let events = self.events(span, &path);
        let mut append = |[start, end]: [f64; 2]| {
            let [start, end] = [self.clock(span, start), self.clock(span, end)];
            match intervals.last_mut() {
                Some(last) if start <= last[1] || self.is_joint_gap(span, [last[1], start]) => {
                    last[1] = last[1].max(end);
                }
                _ => intervals.push([start, end]),
            }
        };

        let mut winding = None;
        let mut piece_start = [0.0; 2];
        for index in 0..=events.len() {
            let event = events.get(index);
            let piece_end = event.map_or([1.0; 2], |event| [event.window[0], event.times[0]]);
            // Nothing before an event at the very start, or after one at the very end.
            if piece_end[0] > piece_start[0] || events.is_empty() {
                let middle = piece_start[0] + (piece_end[0] - piece_start[0]) / 2.0;
                let inside = match winding {
                    Some(winding) => winding >= 1,
                    None => {
                        winding = self.tree.winding_number(path.at(middle));
                        winding.is_none_or(|winding| winding >= 1)
                    }
                };
                debug_assert_eq!(
                    inside,
                    self.tree.locate(path.at(middle)) != Location::Outside,
                    "carried winding number {winding:?} of {point} at {middle} of span {span}"
                );
                if inside {
                    append([piece_start[1], piece_end[1]]);
                }
            }
            if let Some(event) = event {
                append(event.times);
                winding = winding
                    .zip(event.change)
                    .map(|(winding, change)| winding + change);
                piece_start = [event.window[1], event.times[1]];
            }
        }
    }

    /// Everything that happens to the point in a span, in order.
    fn events(&self, span: usize, path: &Path) -> Vec<Event> {
        let mut events = Vec::new();
        let mut start = path.tabulated(0);
        for window in 0..self.spans[span].windows() {
            let end = path.tabulated(2 * window + 2);
            let stretch = path.window(window, start, end);
            self.tree
                .for_each_near_segment(start, end, stretch.bulge, |triangle| {
                    if let Some(facet) = &self.facets[triangle as usize] {
                        facet.meet(&stretch, &mut events);
                    }
                });
            start = end;
        }
        unite(&mut events);
        events
    }

    /// Whether the two ends of a gap lie so near the start of a span that they cannot be told from it.
    fn is_joint_gap(&self, span: usize, [leaves, returns]: [f64; 2]) -> bool {
        let joint = self.joint_times[span];
        let length = |span: usize| self.joint_times[span + 1] - self.joint_times[span];
        span > 0
            && joint - leaves <= JOINT_GAP * length(span - 1)
            && returns - joint <= JOINT_GAP * length(span)
    }

    /// Time within a span to time on the motion's clock; exact at the joints.
    fn clock(&self, span: usize, time: f64) -> f64 {
        let (start, end) = (self.joint_times[span], self.joint_times[span + 1]);
        if time >= 1.0 {
            end
        } else {
            (start + time * (end - start)).min(end)
        }
    }
}
