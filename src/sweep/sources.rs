//! What swept each triangle of a solid.
//!
//! It is looked up at the end, among all that the body sweeps ([`Traces`]): so it holds whatever
//! was cut, filled, joined and moved on the way to the solid. What is near the triangle's centre and
//! faces in its direction is proposed, and then measured: at a time that is found, the part of the
//! given body, carried by the given motion, passes the centre within the error bound.

use crate::body::Mesh;
use crate::bounds::distance_to_triangle;
use crate::envelope::spatial::{Source, Trace, TracePart, Traces};
use crate::motion::{Merged, Motion};
use crate::numeric::area::area_vector;
use crate::numeric::closest::distance_to_segment;
use crate::solid::spatial::Solid;
use crate::watch::{Interrupted, Work};
use glam::DVec3;
use rayon::prelude::*;

/// What swept a triangle of a solid: a part of the body, and when.
///
/// # Guarantee
/// The part passes the centre of the triangle (the mean of its corners), within the larger of the
/// two error bounds, at the time or at some time of the interval: this is measured, with the body
/// and the motion as they were given. Where several parts do, one that faces as the triangle does is
/// preferred, and of those that lie on each other always the same.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum TriangleSource {
    /// It lies on the sheet of an edge, or of a face that grazes, which was carried along.
    Sheet {
        /// The edge or the face of the body.
        source: Source,
        /// Number of the span of the motion as it was given, from 0.
        span: usize,
        /// Start and end, on the clock of the motion, of the time step of the sampling, as far as it
        /// belongs to the span.
        times: [f64; 2],
    },
    /// It lies on a face of the body where that stands at the start or the end of a span, or, in a
    /// rotation by more than one turn, at the end of the first.
    Cap {
        /// The face of the body.
        face: u32,
        /// Time on the clock of the motion.
        time: f64,
    },
    /// No part of the body was found to pass there: it closes what a repair of the solid cut open.
    Repair,
}

/// The given body and motion, in terms of the motion with merged spans.
pub(super) struct Given<'a> {
    body: &'a Mesh,
    motion: &'a Motion,
    /// Per merged span, its first span and the shares of it at which its spans begin, and 1.
    spans: Vec<(usize, Vec<f64>)>,
}

impl<'a> Given<'a> {
    /// - `corners`: those with which the spans were merged.
    pub(super) fn new(
        body: &'a Mesh,
        motion: &'a Motion,
        merged: &Merged<Motion>,
        corners: &[DVec3],
    ) -> Given<'a> {
        let spans = (0..merged.motion.spans().len()).map(|run| {
            let spans = merged.spans_of(run);
            (spans.start, motion.shares_of_spans(corners, spans))
        });
        Given {
            body,
            motion,
            spans: spans.collect(),
        }
    }

    /// The number of the span at a share of a merged span, and the clock times of shares about it,
    /// as far as they belong to that span.
    fn times<const N: usize>(&self, run: usize, share: f64, about: [f64; N]) -> (usize, [f64; N]) {
        let (first, starts) = &self.spans[run];
        // At a joint, the span into which they reach.
        let reaches_on = about.iter().any(|&other| other > share);
        let after = starts.partition_point(|&start| start < share || reaches_on && start == share);
        let after = after.clamp(1, starts.len() - 1);
        let [from, to] = [starts[after - 1], starts[after]];
        let span = first + after - 1;
        let [start, end] = [span, span + 1].map(|joint| self.motion.joint_times()[joint]);
        let time = |share: f64| {
            if share >= to {
                end
            } else if share <= from {
                start
            } else {
                (start + (end - start) * ((share - from) / (to - from))).min(end)
            }
        };
        (span, about.map(time))
    }

    /// Distance of a place from a part of the body at a share of a merged span.
    fn distance(&self, place: DVec3, part: TracePart, run: usize, share: f64) -> f64 {
        let (_, [time]) = self.times(run, share, [share]);
        let pose = self.motion.pose_at_time(time);
        let at = |vertex: u32| pose.transform_point3(self.body.positions()[vertex as usize]);
        match part {
            TracePart::Sheet(Source::Edge(edge)) => {
                distance_to_segment(self.body.edges()[edge as usize].vertices.map(at), place)
            }
            TracePart::Sheet(Source::Face(face)) | TracePart::Cap(face) => {
                distance_to_triangle(self.body.triangles()[face as usize].map(at), place)
            }
        }
    }
}

/// Lengths that decide what swept a triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Nearness {
    /// Largest distance of the part from the centre.
    pub(super) bound: f64,
    /// Extra distance at which a part that faces as the triangle does is as good as one that is
    /// square to it.
    pub(super) turn: f64,
    /// Distances that differ by less count as equal.
    pub(super) same: f64,
}

/// What swept each triangle of the solid.
///
/// # Cost
/// O(log n) per triangle for n triangles of the traces, in parallel: some microseconds.
pub(super) fn sources(
    solid: &Solid,
    traces: &Traces,
    given: &Given,
    nearness: Nearness,
    work: Work,
) -> Result<Vec<TriangleSource>, Interrupted> {
    let items = work.items(solid.triangles().len());
    solid
        .triangles()
        .par_iter()
        .map(|triangle| {
            items.next()?;
            let corners = triangle.map(|v| solid.positions()[v as usize]);
            Ok(source(corners, traces, given, nearness))
        })
        .collect()
}

/// What swept a triangle.
fn source(
    corners: [DVec3; 3],
    traces: &Traces,
    given: &Given,
    nearness: Nearness,
) -> TriangleSource {
    let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
    let normal = area_vector(corners).normalize_or_zero();
    // One that faces elsewhere is better than none.
    let found = [nearness.turn, 0.0].into_iter().find_map(|turn| {
        let number = proposed(centre, normal, traces, Nearness { turn, ..nearness })?;
        let trace = traces.at(number);
        let corners = traces.tree.corners(number);
        passing(centre, corners, &trace, given, nearness).map(|share| (trace, share))
    });
    let Some((trace, share)) = found else {
        return TriangleSource::Repair;
    };
    let steps = trace.shares;
    let step = [
        steps.into_iter().fold(f64::INFINITY, f64::min),
        steps.into_iter().fold(f64::NEG_INFINITY, f64::max),
    ];
    let (span, times) = given.times(trace.span, share, step);
    match trace.part {
        TracePart::Sheet(source) => TriangleSource::Sheet {
            source,
            span,
            times,
        },
        TracePart::Cap(face) => TriangleSource::Cap {
            face,
            time: times[0],
        },
    }
}

/// The triangle of the traces that is near a place and faces in a direction; the first of those
/// that are as good.
fn proposed(place: DVec3, normal: DVec3, traces: &Traces, nearness: Nearness) -> Option<u32> {
    let tree = &traces.tree;
    let cost = |triangle: u32, distance: f64| {
        let facing = area_vector(tree.corners(triangle)).normalize_or_zero();
        distance + nearness.turn * (1.0 - normal.dot(facing)).max(0.0)
    };
    let (_, least) = tree.least(place, cost)?;
    let enough = least + nearness.same;
    let mut first = None;
    tree.for_each_in_box([place - enough, place + enough], |triangle| {
        let distance = tree.distance_to(triangle, place);
        if first.is_none_or(|first| triangle < first) && cost(triangle, distance) <= enough {
            first = Some(triangle);
        }
    });
    first
}

/// Number of times by which the interval is shortened in which the part comes nearest: to the
/// rounding of times.
const SHORTENINGS: usize = 80;

/// A share of the span, of those of the corners of a triangle of the traces, at which the part
/// passes a place within the bound.
fn passing(
    place: DVec3,
    corners: [DVec3; 3],
    trace: &Trace,
    given: &Given,
    nearness: Nearness,
) -> Option<f64> {
    let distance = |share: f64| given.distance(place, trace.part, trace.span, share);
    let near = share_at(place, corners, trace.shares);
    if distance(near) <= nearness.bound {
        return Some(near);
    }
    let [mut from, mut to] = [near; 2];
    for share in trace.shares {
        (from, to) = (from.min(share), to.max(share));
    }
    // Within one step, the distance falls and then rises.
    for _ in 0..SHORTENINGS {
        let [first, second] = [from + (to - from) / 3.0, to - (to - from) / 3.0];
        if distance(first) <= distance(second) {
            to = second;
        } else {
            from = first;
        }
    }
    let nearest = from.midpoint(to);
    (distance(nearest) <= nearness.bound).then_some(nearest)
}

/// The share at the foot of a place on a triangle, between those of its corners.
fn share_at(place: DVec3, corners: [DVec3; 3], shares: [f64; 3]) -> f64 {
    let normal = area_vector(corners);
    let weights = [1, 2, 0].map(|next| {
        let side = [place, corners[next], corners[(next + 1) % 3]];
        area_vector(side).dot(normal).max(0.0)
    });
    let sum: f64 = weights.iter().sum();
    let least = shares.into_iter().fold(f64::INFINITY, f64::min);
    if sum > 0.0 {
        let above = |i: usize| (shares[i] - least) * (weights[i] / sum);
        least + above(0) + above(1) + above(2)
    } else {
        least
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envelope::spatial::{Budget, traces};
    use crate::motion::{Generator, Span};
    use crate::samples::cuboid;

    fn unit_box() -> Mesh {
        let (positions, triangles) = cuboid(DVec3::ZERO, DVec3::ONE);
        Mesh::new(positions, triangles).expect("a body")
    }

    /// Two slides along x, the second at half the speed, between which the body waits.
    fn slide() -> Motion {
        let span = |length: f64, duration: f64| {
            let along = Generator::translation(DVec3::X * length);
            Span::new(along, duration).expect("legal")
        };
        let spans = vec![span(1.0, 1.0), span(0.0, 5.0), span(1.0, 2.0)];
        Motion::from_spans(spans).expect("legal")
    }

    #[test]
    fn shares_of_a_merged_span_are_times_of_the_given_ones() {
        let (body, motion) = (unit_box(), slide());
        let corners = body.positions().to_vec();
        let merged = motion.merged_within(&corners, 0.0);
        assert_eq!(merged.spans_of(0), 0..3, "one slide");
        let given = Given::new(&body, &motion, &merged, &corners);
        for (share, about, expected) in [
            (0.0, [0.0, 0.25], (0, [0.0, 0.5])),
            (0.25, [0.25, 0.75], (0, [0.5, 1.0])),
            (0.5, [0.25, 0.5], (0, [0.5, 1.0])),
            (0.5, [0.5, 0.75], (2, [6.0, 7.0])),
            (0.75, [0.25, 1.0], (2, [6.0, 8.0])),
            (1.0, [1.0, 1.0], (2, [8.0, 8.0])),
        ] {
            assert_eq!(given.times(0, share, about), expected, "at {share}");
        }
    }

    #[test]
    fn what_nothing_passes_within_the_bound_is_a_repair() {
        let (body, motion) = (unit_box(), slide());
        let corners = body.positions().to_vec();
        let merged = motion.merged_within(&corners, 0.0);
        let given = Given::new(&body, &motion, &merged, &corners);
        let budget = Budget::of(1e-3);
        let traces = traces(&body, &merged.motion, &budget, Work::UNWATCHED).expect("not stopped");
        // A small triangle above what only the edges of the top pass.
        let at = |x: f64, y: f64| DVec3::new(x, y, 1.0 + 1e-3);
        let above = [at(1.4, 0.1), at(1.6, 0.1), at(1.5, 0.4)];
        let found = |bound: f64| {
            let nearness = Nearness {
                bound,
                turn: bound,
                same: 1e-14,
            };
            source(above, &traces, &given, nearness)
        };
        assert_eq!(found(0.9e-3), TriangleSource::Repair);
        let swept = found(1.1e-3);
        assert!(
            matches!(
                swept,
                TriangleSource::Sheet {
                    source: Source::Edge(_),
                    span: 0 | 2,
                    ..
                }
            ),
            "{swept:?}"
        );
    }

    #[test]
    fn the_share_at_a_foot_lies_between_those_of_the_corners() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
        for (place, expected) in [
            (DVec3::new(0.25, 0.5, 3.0), 0.5),
            (DVec3::new(-1.0, 0.5, 0.0), 0.25),
            (DVec3::new(0.2, 9.0, 0.0), 1.0),
            (DVec3::new(0.2, -9.0, 0.0), 0.0),
        ] {
            let share = share_at(place, corners, [0.0, 0.0, 1.0]);
            assert!((share - expected).abs() < 0.05, "{share} at {place}");
        }
        let point = [DVec3::X; 3];
        assert_eq!(share_at(DVec3::Y, point, [0.25, 0.25, 0.5]), 0.25);
    }
}
