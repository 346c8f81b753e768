//! What each part of the body sweeps, to look up what swept a place.
//!
//! The cycle does not serve for this: some of its sheets are sunk into the body, or cut across dents
//! of its boundary, and what they then stand for is no part of the body. So this surface has the
//! sheets of all parts of the boundary of the egress region, sampled as those of the cycle, and the
//! faces of the body where they bound the cycle at the ends of spans. It need not be closed.

use super::carrying::sampled_boundary;
use super::grazing_of;
use super::runs::{Run, runs};
use super::sampling::Sampling;
use crate::body::Mesh;
use crate::bounds::SurfaceTree;
use crate::grazing::spatial::{FaceFlux, GrazingSet, Interval, Source};
use crate::motion::Motion;
use crate::numeric::index;
use crate::numeric::tolerance::Budget;
use crate::watch::{Interrupted, Work};
use glam::{DAffine3, DVec3};

/// The surface that the parts of a body sweep, in a tree.
pub(crate) struct Traces {
    pub(crate) tree: SurfaceTree,
    strips: Vec<Strip>,
    /// Per span of the motion.
    spans: Vec<TracedSpan>,
}

/// Consecutive triangles of one part of the body in one span: a face at an end of the span, or two
/// for each time step.
struct Strip {
    /// Its first triangle.
    first: u32,
    part: TracePart,
    span: u32,
    /// The share of the span at which a face stands; sheets reach over all of it.
    at: Option<f64>,
}

/// The time steps of a span.
struct TracedSpan {
    sampling: Sampling,
    /// The share of the span that is swept.
    covered: f64,
}

/// A part of the body that bounds the cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum TracePart {
    /// Carried along.
    Sheet(Source),
    /// A face at rest.
    Cap(u32),
}

/// What a triangle of the surface stands for.
pub(crate) struct Trace {
    pub(crate) part: TracePart,
    /// Number of the span.
    pub(crate) span: usize,
    /// The share of the span at which each corner of the triangle lies on the part.
    pub(crate) shares: [f64; 3],
}

impl Traces {
    /// What a triangle of the tree stands for.
    pub(crate) fn at(&self, triangle: u32) -> Trace {
        let after = self.strips.partition_point(|strip| strip.first <= triangle);
        let strip = &self.strips[after - 1];
        let span = strip.span as usize;
        let TracedSpan { sampling, covered } = &self.spans[span];
        let shares = match strip.at {
            Some(at) => [at; 3],
            None => {
                let number = triangle - strip.first;
                let step = number as usize / 2;
                let [low, high] = [step, step + 1].map(|step| sampling.time(step));
                if number.is_multiple_of(2) {
                    [low, low, high]
                } else {
                    [high, high, low]
                }
            }
        };
        Trace {
            part: strip.part,
            span,
            shares: shares.map(|share| share * covered),
        }
    }
}

/// The traces of `body` (given in the world at the start of the motion), as [`super::sweep_cycles`]
/// samples what it carries along.
///
/// # Cost
/// That of the cycle without its assembly, and of a tree over as many triangles.
pub(crate) fn traces(
    body: &Mesh,
    motion: &Motion,
    budget: &Budget,
    work: Work,
) -> Result<Traces, Interrupted> {
    let [sweeping, building] = work.parts([1, 1]);
    let part = sweeping.part(1, motion.spans().len() as u64);
    let mut gathered = Gathered::default();
    for run in runs(motion) {
        let grazing = grazing_of(body, &run, budget, part)?;
        for number in 0..run.flows.len() {
            gathered.add_span(body, &run, &grazing, number, budget, sweeping)?;
        }
    }
    let Gathered {
        positions,
        triangles,
        strips,
        spans,
    } = gathered;
    Ok(Traces {
        tree: SurfaceTree::during(building, &positions, &triangles)?,
        strips,
        spans,
    })
}

/// The surface of the spans so far.
#[derive(Default)]
struct Gathered {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    strips: Vec<Strip>,
    spans: Vec<TracedSpan>,
}

impl Gathered {
    /// Adds span `number` of a run: the faces at its start, if it is the first, its sheets, and the
    /// faces at its end.
    fn add_span(
        &mut self,
        body: &Mesh,
        run: &Run,
        grazing: &[GrazingSet],
        number: usize,
        budget: &Budget,
        work: Work,
    ) -> Result<(), Interrupted> {
        let own = &grazing[number];
        let [start, end] = [&run.frames[number], &run.frames[number + 1]];
        let flow = &run.flows[number];
        let (intervals, sampling) = sampled_boundary(body, own, (flow, start), budget);
        if number == 0 {
            let is_cap = |face: usize| own.faces[face] != FaceFlux::Egress;
            self.add_faces(body, start, 0.0, is_cap);
        }
        let mut poses = vec![*start];
        poses.extend((1..sampling.steps).map(|step| flow.pose_at(sampling.time(step)) * *start));
        poses.push(*end);
        for interval in &intervals {
            work.check()?;
            self.add_strips(interval, &poses, &sampling, budget);
        }
        // Between two spans, only what is egress before and ingress after bounds the cycle.
        let next = grazing.get(number + 1);
        let is_cap = |face: usize| {
            own.faces[face] != FaceFlux::Ingress
                && next.is_none_or(|next| next.faces[face] != FaceFlux::Egress)
        };
        self.add_faces(body, end, 1.0, is_cap);
        self.spans.push(TracedSpan {
            sampling,
            covered: run.covered[number],
        });
        Ok(())
    }

    /// Adds some of the faces of the body at a pose.
    fn add_faces(&mut self, body: &Mesh, pose: &DAffine3, at: f64, is_cap: impl Fn(usize) -> bool) {
        for (face, corners) in body.triangles().iter().enumerate() {
            if is_cap(face) {
                self.begin(TracePart::Cap(index(face)), Some(at));
                let first = index(self.positions.len());
                let place = |&v: &u32| pose.transform_point3(body.positions()[v as usize]);
                self.positions.extend(corners.iter().map(place));
                self.triangles.push([first, first + 1, first + 2]);
            }
        }
    }

    /// Adds what the parts of an interval sweep, through poses at the time steps.
    fn add_strips(
        &mut self,
        interval: &Interval,
        poses: &[DAffine3],
        sampling: &Sampling,
        budget: &Budget,
    ) {
        let mut stops = sampling.divide_interval(interval, &poses[0], budget.twist);
        if interval.reversed {
            stops.reverse();
        }
        let first = index(self.positions.len());
        let places = poses.iter().flat_map(|pose| {
            let place = |&stop: &f64| pose.transform_point3(interval.at(stop));
            stops.iter().map(place)
        });
        self.positions.extend(places);
        let row = index(stops.len());
        for a in (first..first + row).take(stops.len() - 1) {
            self.begin(TracePart::Sheet(interval.source), None);
            let [from, to] = [a, a + 1].map(|corner| self.positions[corner as usize]);
            let is_low_forward = sampling.is_low_forward(from, to);
            for step in 0..index(sampling.steps) {
                let a = a + step * row;
                let [b, a_next, b_next] = [a + 1, a + row, a + row + 1];
                self.triangles.extend(if is_low_forward {
                    [[a, b, b_next], [b_next, a_next, a]]
                } else {
                    [[a, b, a_next], [b_next, a_next, b]]
                });
            }
        }
    }

    /// Begins a strip of the span that is added next.
    fn begin(&mut self, part: TracePart, at: Option<f64>) {
        self.strips.push(Strip {
            first: index(self.triangles.len()),
            part,
            span: index(self.spans.len()),
            at,
        });
    }
}
