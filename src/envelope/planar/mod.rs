//! The sweep cycle of a polygon: its edges at the start and at the end, and the sampled paths of
//! the grazing points.

mod exact;
mod same_poses;

use crate::Fault;
use crate::body::Polygon;
use crate::grazing::planar::{Change, EdgeFlux, GrazingSet};
use crate::motion::planar::{Flow, Generator, Motion, stretch};
use crate::numeric::index;
use crate::numeric::tolerance::{MOST_SEGMENTS, SAME_POSE};
use crate::watch::{Interrupted, Work};
use glam::{DAffine2, DVec2};
use std::collections::HashMap;
use std::f64::consts::TAU;

pub use crate::numeric::tolerance::PlanarBudget;
pub use exact::{Curve, SampledCurve, envelope, sampled_envelope};

/// A closed set of directed segments with weights. Its winding number at a point is the number of
/// time intervals that the point spends inside the body.
#[derive(Debug, Clone, Default)]
pub struct SweepCycle {
    /// Positions in the world.
    pub points: Vec<DVec2>,
    /// Start and end of each segment.
    pub segments: Vec<[u32; 2]>,
    /// The winding number on the left of each segment, minus that on its right.
    pub weights: Vec<i32>,
    /// The sampled paths of the grazing points, each as the indices of its points, forwards in
    /// time.
    pub paths: Vec<Vec<u32>>,
    /// Bounds on the errors of the cycle.
    pub errors: CycleErrors,
}

impl SweepCycle {
    /// Checks that as many segments start as end at every point, counted with their weights;
    /// otherwise winding numbers have no meaning. O(n).
    ///
    /// # Errors
    /// [`Fault`] when the cycle is not closed.
    pub fn check(&self) -> Result<(), Fault> {
        let mut balance = vec![0_i64; self.points.len()];
        for (segment, &weight) in self.segments.iter().zip(&self.weights) {
            balance[segment[0] as usize] += i64::from(weight);
            balance[segment[1] as usize] -= i64::from(weight);
        }
        if balance.iter().all(|&sum| sum == 0) {
            Ok(())
        } else {
            Err(Fault::new("the sweep cycle is not closed"))
        }
    }
}

/// Errors of a sweep cycle: lengths, all of them proven bounds.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct CycleErrors {
    /// Error of the chords of the paths over a time step.
    pub sampling: f64,
    /// Depth of the dropped folds, at the time of their largest growth.
    pub dropped_fold: f64,
    /// Distance by which poses of joints were moved onto others that are the same up to rounding,
    /// at the time of the largest growth of that move.
    pub shared: f64,
    /// Number of time steps, over all spans.
    pub steps: usize,
}

/// Why a sweep cycle was refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CycleError {
    /// There would be too many segments.
    #[error(
        "the sampled paths would have {segments:.1e} segments, more than {MOST_SEGMENTS:.0e}; \
         use a coarser tolerance or a shorter motion"
    )]
    TooLarge {
        /// Number of segments that there would be.
        segments: f64,
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

/// The sweep cycle of `body` (given in the world at the start of the motion) at a tolerance.
///
/// # Cost
/// O(n log n) per span for the n edges of the body, and O(changes of sign x time steps) segments.
pub fn sweep_cycle(
    body: &Polygon,
    motion: &Motion,
    budget: &PlanarBudget,
) -> Result<SweepCycle, CycleError> {
    cycle_as(body, motion, budget, Work::UNWATCHED)
}

/// [`sweep_cycle`] as a part of some work.
pub(crate) fn cycle_as(
    body: &Polygon,
    motion: &Motion,
    budget: &PlanarBudget,
    work: Work,
) -> Result<SweepCycle, CycleError> {
    // Each span is examined, then its start, then its paths.
    let items = work.items(3 * motion.spans().len() + 1);
    let poses = same_poses::shared(motion.joints(), body.bounds());
    let moves = same_poses::moves(motion.joints(), &poses, body.bounds());
    let edges = BodyEdges {
        positions: body.positions(),
        ends: body.edges().collect(),
    };
    let mut cycle = SweepCycle::default();
    let mut sets = Vec::with_capacity(motion.spans().len());
    let mut changes = Vec::with_capacity(motion.spans().len());
    let mut samplings = Vec::with_capacity(motion.spans().len());
    let mut segments = 0.0;
    for ((span, pose), moved) in motion.spans().iter().zip(&poses).zip(moves.windows(2)) {
        items.next()?;
        let generator = span.flow().generator();
        let positions: Vec<DVec2> = body
            .positions()
            .iter()
            .map(|&p| pose.transform_point2(p))
            .collect();
        let growth = stretch(&generator.linear, [0.0, 1.0]).max(1.0);
        let set = GrazingSet::new(body, &positions, generator, budget.fold / growth);
        let changed = set.changes(body);
        let places: Vec<DVec2> = changed
            .iter()
            .map(|change| edges.place(change.edge, change.at, pose))
            .collect();
        let sampling = Sampling::new(span.flow(), growth, &places, budget.chord);
        let errors = &mut cycle.errors;
        errors.sampling = errors.sampling.max(sampling.error);
        errors.dropped_fold = errors.dropped_fold.max(set.dropped_fold * growth);
        errors.shared = errors.shared.max(moved[0] * growth).max(moved[1]);
        errors.steps += sampling.steps;
        segments += changed.len() as f64 * sampling.steps as f64 + 3.0 * places.len() as f64;
        if segments > MOST_SEGMENTS as f64 {
            return Err(CycleError::TooLarge { segments });
        }
        sets.push(set);
        changes.push(changed);
        samplings.push(sampling);
    }
    let mut joints = Joints {
        edges: &edges,
        poses: &poses,
        places: HashMap::new(),
    };
    for joint in 0..poses.len() {
        items.next()?;
        joints.add_cap(joint, &sets, &mut cycle);
    }
    for (span, (changes, sampling)) in changes.iter().zip(&samplings).enumerate() {
        items.next()?;
        for change in changes {
            joints.add_path(span, change, sampling, &mut cycle);
        }
    }
    Ok(cycle)
}

/// The edges of a body, given in the world at the start of the motion.
struct BodyEdges<'a> {
    positions: &'a [DVec2],
    /// Corners of each edge; edge i begins at corner i.
    ends: Vec<[u32; 2]>,
}

impl BodyEdges<'_> {
    /// The position of a place of the body at a pose.
    fn place(&self, edge: u32, at: f64, pose: &DAffine2) -> DVec2 {
        let [from, to] = self.ends[edge as usize].map(|corner| self.positions[corner as usize]);
        pose.transform_point2(if at == 0.0 { from } else { from.lerp(to, at) })
    }
}

/// Equal time steps of a span, the last of which may be shorter.
struct Sampling {
    steps: usize,
    /// Length of a step, as a share of the span.
    step: f64,
    /// Poses after each step except the last, relative to the start of the span.
    between: Vec<DAffine2>,
    /// Bound on the distance between chords and their paths.
    error: f64,
}

impl Sampling {
    /// Steps for the paths through `places` (world, start of the span), with chords closer than
    /// `chord`.
    ///
    /// |d2/dt2 exp(tG) p| = |exp(tM) M v(p)| <= growth |M v(p)|, and a chord misses by at most an
    /// eighth of that times the square of the step.
    fn new(flow: &Flow, growth: f64, places: &[DVec2], chord: f64) -> Sampling {
        let generator = flow.generator();
        let bend = if generator.moves_straight() {
            0.0
        } else {
            places
                .iter()
                .map(|&p| generator.acceleration(p).length())
                .fold(0.0, f64::max)
                * growth
        };
        let mut step = (8.0 * chord / bend).sqrt().min(1.0);
        if let Some(turn) = turn_time(generator)
            && turn < 1.0
        {
            // Then laps, and images of a symmetric body, come to the same places.
            step = turn / (turn / step / SYMMETRY).ceil().max(1.0) / SYMMETRY;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "positive; saturates, and is then refused as too many"
        )]
        let steps = (1.0 / step - SHORTEST_STEP).ceil().max(1.0) as usize;
        let between = if steps > MOST_SEGMENTS {
            Vec::new()
        } else {
            (1..steps).map(|i| flow.pose_at(i as f64 * step)).collect()
        };
        Sampling {
            steps,
            step,
            between,
            error: bend * step * step / 8.0,
        }
    }
}

impl Sampling {
    /// The share of the span that is over after a number of steps.
    fn time(&self, step: usize) -> f64 {
        if step == self.steps {
            1.0
        } else {
            step as f64 * self.step
        }
    }
}

/// The number of steps per turn is a multiple of this, which in turn is a multiple of most
/// symmetries of parts.
const SYMMETRY: f64 = 24.0;

/// Shortest last step, as a share of the others: anything less is rounding of the time.
const SHORTEST_STEP: f64 = 1e-6;

/// The time after which a pure rotation returns.
fn turn_time(generator: &Generator) -> Option<f64> {
    let linear = generator.linear;
    let half_trace = 0.5 * (linear.x_axis.x + linear.y_axis.y);
    let frequency = linear.determinant().sqrt();
    (half_trace.abs() < SAME_POSE * frequency).then_some(TAU / frequency)
}

/// A place on the body: a corner, or the grazing point of an edge in a span.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Spot {
    Corner(u32),
    Grazing { edge: u32, span: usize },
}

/// The poses of the joints, and the points of the cycle there.
struct Joints<'a> {
    edges: &'a BodyEdges<'a>,
    poses: &'a [DAffine2],
    places: HashMap<(usize, Spot), u32>,
}

impl Joints<'_> {
    /// Number of a point of the cycle.
    fn point(&mut self, joint: usize, spot: Spot, at: f64, cycle: &mut SweepCycle) -> u32 {
        let (edge, at) = match spot {
            Spot::Corner(corner) => (corner, 0.0),
            Spot::Grazing { edge, .. } => (edge, at),
        };
        let (edges, pose) = (self.edges, &self.poses[joint]);
        *self.places.entry((joint, spot)).or_insert_with(|| {
            cycle.points.push(edges.place(edge, at, pose));
            index(cycle.points.len() - 1)
        })
    }

    /// Adds the edges of the body that remain at a joint: the egress part of the span before, minus
    /// that of the span after; at the start the ingress part, at the end the egress part.
    fn add_cap(&mut self, joint: usize, sets: &[GrazingSet], cycle: &mut SweepCycle) {
        let before = joint.checked_sub(1);
        let after = Some(joint).filter(|&span| span < sets.len());
        for (edge, ends) in (0..).zip(&self.edges.ends) {
            let mut stops = vec![(0.0, Spot::Corner(ends[0]))];
            for span in [before, after].into_iter().flatten() {
                if let EdgeFlux::Cut { at, .. } = sets[span].edges[edge as usize] {
                    stops.push((at, Spot::Grazing { edge, span }));
                }
            }
            stops.push((1.0, Spot::Corner(ends[1])));
            // The sort is stable: at the same place the span before comes first.
            stops.sort_by(|a, b| a.0.total_cmp(&b.0));
            // The sign follows from the grazing points that are passed, not from positions: between
            // two that coincide, or are next to each other in `f64`, there is no position.
            let mut egress = [before, after].map(|span| {
                span.map(|span| sets[span].edges[edge as usize].is_egress_at_ends()[0])
            });
            for pair in stops.windows(2) {
                let [(from, from_spot), (to, to_spot)] = [pair[0], pair[1]];
                if let Spot::Grazing { span, .. } = from_spot {
                    let passed = &mut egress[usize::from(Some(span) == after)];
                    *passed = passed.map(|egress| !egress);
                }
                let weight = egress[0].map_or(1, i32::from) - egress[1].map_or(0, i32::from);
                if weight != 0 {
                    let ends = [(from_spot, from), (to_spot, to)]
                        .map(|(spot, at)| self.point(joint, spot, at, cycle));
                    cycle.segments.push(ends);
                    cycle.weights.push(weight);
                }
            }
        }
    }

    /// Adds the path of a grazing point.
    fn add_path(
        &mut self,
        span: usize,
        change: &Change,
        sampling: &Sampling,
        cycle: &mut SweepCycle,
    ) {
        let spot = if change.at == 0.0 {
            Spot::Corner(change.edge)
        } else {
            let edge = change.edge;
            Spot::Grazing { edge, span }
        };
        let start = self.edges.place(change.edge, change.at, &self.poses[span]);
        let mut path = vec![self.point(span, spot, change.at, cycle)];
        for pose in &sampling.between {
            path.push(index(cycle.points.len()));
            cycle.points.push(pose.transform_point2(start));
        }
        path.push(self.point(span + 1, spot, change.at, cycle));
        for pair in path.windows(2) {
            cycle.segments.push([pair[0], pair[1]]);
            // Where ingress at the start changes to egress at the end, the cycle continues along
            // the path.
            cycle.weights.push(if change.to_egress { 1 } else { -1 });
        }
        cycle.paths.push(path);
    }
}
