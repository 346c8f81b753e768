//! The envelope and the sweep cycle of a triangle mesh.

mod alignment;
mod assembly;
mod caps;
mod carrying;
mod coincidence;
mod lines;
mod points;
mod room;
mod runs;
mod sampling;
mod sinking;
mod size;
mod straightening;

use crate::Fault;
use crate::body::Mesh;
use crate::grazing::spatial::{GrazingSet, Simplification};
use crate::motion::Motion;
use crate::numeric::index;
use crate::numeric::tolerance::SAME_POSE;
use crate::surface::is_closed;
use assembly::Assembly;
use caps::{Cap, Joint};
use carrying::{Carry, carried, check_size, grazing_at};
use coincidence::join;
use glam::DVec3;
use lines::{SpanLines, boundary};
use points::BodyPoints;
use room::Room;
use runs::{Run, runs};
use size::refuse_many;

pub use crate::numeric::tolerance::Budget;
pub use carrying::CycleError;
pub use lines::{Fold, Source};

/// A sheet of the untrimmed envelope: a straight grazing segment, fixed on the body, carried along
/// for one span.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// The edge or face that grazes there.
    pub source: Source,
    /// Number of the span, from 0.
    pub span: usize,
    /// The winding numbers that the sheet separates.
    pub fold: Fold,
    /// Ends of the segment in the world at the start of the motion, with the egress region on the
    /// left.
    pub ends: [DVec3; 2],
}

impl Sheet {
    /// The point of the sheet in the world, at `along` in \[0, 1\] of the segment and `share` in
    /// \[0, 1\] of the span.
    pub fn point(&self, motion: &Motion, along: f64, share: f64) -> DVec3 {
        let start =
            motion.joints()[self.span].transform_point3(self.ends[0].lerp(self.ends[1], along));
        motion.spans()[self.span]
            .flow()
            .pose_at(share)
            .transform_point3(start)
    }
}

/// The untrimmed envelope of a mesh under a motion: every grazing segment, exact, once per span.
///
/// `body` is given in its own frame. Sheets come in the order of the spans, then edges before
/// faces, by index. The boundary of the swept region is part of these sheets and of the body's
/// faces at the start, at the joints and at the end. O(#F) per span; nothing is sampled.
pub fn envelope(body: &Mesh, motion: &Motion) -> Vec<Sheet> {
    let body = body.transformed(motion.start_pose());
    let exact = Simplification {
        fold: 0.0,
        merge: 0.0,
    };
    let mut sheets = Vec::new();
    for (number, (span, frame)) in motion.spans().iter().zip(motion.joints()).enumerate() {
        let grazing = grazing_at(&body, frame, span.flow().generator(), exact);
        for interval in boundary(&body, &grazing, frame, span.flow().generator()) {
            let mut ends = interval.ends.map(|t| interval.at(t));
            if interval.reversed {
                ends.reverse();
            }
            sheets.push(Sheet {
                source: interval.source,
                span: number,
                fold: interval.fold,
                ends,
            });
        }
    }
    sheets
}

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
}

impl SweepCycle {
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
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct CycleErrors {
    /// Distance between the sampled sheets and the exact ones.
    pub sampling: f64,
    /// Distance from the body of what was added to fill the dents of its egress boundary.
    pub filled_dent: f64,
    /// Depth of the dropped folds.
    pub dropped_fold: f64,
    /// Largest distance by which a break point was moved, to join others.
    pub merge: f64,
    /// Largest distance between a point and its assumed place: it counts as resting though it moves
    /// a little, or as back though it is not quite.
    pub snapped: f64,
    /// Number of time steps, over all spans.
    pub steps: usize,
    /// Whether the shortfall is a bound too: nothing is simplified except what `GrazingSet::proven`
    /// accounts for.
    pub proven: bool,
}

impl CycleErrors {
    /// How far the exact sweep may reach out of the region of the sampled cycle, if no piece of the
    /// cycle is left outside the region (see [`crate::envelope`]): a bound if `proven`, otherwise
    /// an estimate.
    pub fn shortfall(&self) -> f64 {
        self.sampling + self.dropped_fold + self.merge
    }

    /// A bound on how far the region of the sampled cycle may reach out of the exact sweep.
    pub fn excess(&self) -> f64 {
        self.sampling + self.filled_dent
    }
}

/// The sweep cycle of `body` (given in the world at the start of the motion) at a tolerance.
///
/// # Cost
/// O(#F) per span, and O(grazing pieces x time steps) triangles. When there are many spans, some
/// are examined first, so that a motion far beyond the limit is refused before the others take time
/// and memory.
pub fn sweep_cycle(
    body: &Mesh,
    motion: &Motion,
    budget: &Budget,
) -> Result<SweepCycle, CycleError> {
    let room = Room::new(body);
    let mut cycle = SweepCycle {
        positions: Vec::new(),
        triangles: Vec::new(),
        errors: CycleErrors::default(),
    };
    let mut poses = Vec::new();
    cycle.errors.proven = true;
    let runs = runs(motion);
    refuse_many(body, &runs, budget, &room)?;
    for run in runs {
        let grazing = grazing_of(body, &run, budget);
        for (run, grazing) in parts(&run, &grazing) {
            add_cycle(body, &run, grazing, budget, &room, &mut cycle, &mut poses)?;
        }
    }
    // Paths that lead to one place, such as those of an edge and of its image after a third of a
    // turn about an axis of symmetry, miss it by their rounding and by that of the body. Where
    // nothing is sampled, everything is kept.
    let reach = cycle
        .positions
        .iter()
        .map(|p| p.abs().max_element())
        .fold(0.0, f64::max);
    let same = SAME_POSE * reach;
    let is_sampled = cycle.errors.sampling > same;
    let distance = if is_sampled { budget.merge } else { same };
    let joined = join(&cycle.positions, &poses, &cycle.triangles, same, distance);
    cycle.errors.snapped += joined.largest_move;
    (cycle.positions, cycle.triangles) = (joined.positions, joined.triangles);
    Ok(cycle)
}

/// The grazing sets of the spans of a run.
fn grazing_of(body: &Mesh, run: &Run, budget: &Budget) -> Vec<GrazingSet> {
    let simplification = Simplification {
        fold: budget.fold,
        merge: budget.merge,
    };
    run.flows
        .iter()
        .zip(&run.frames)
        .map(|(flow, frame)| grazing_at(body, frame, flow.generator(), simplification))
        .collect()
}

/// The parts of a run of translations, with their grazing sets; any other run as a whole.
///
/// Each translation has exact signs, but perhaps for a body of its own that differs from the given
/// one by rounding ([`crate::grazing`]). Where two spans of a run meet, faces of one sign cancel;
/// with different bodies, the cycle could lose what lies between the two without a piece near it.
/// So a span with a body of its own is a separate part, with both caps in the cycle. Winding
/// numbers of parts add up as those of runs do.
fn parts<'a>(run: &Run, grazing: &'a [GrazingSet]) -> Vec<(Run, &'a [GrazingSet])> {
    let are_translations = grazing.iter().all(|set| set.proven.is_some());
    let is_given = |set: &GrazingSet| set.proven.as_ref().is_some_and(Vec::is_empty);
    let mut first = 0;
    grazing
        .chunk_by(|a, b| !are_translations || is_given(a) && is_given(b))
        .map(|sets| {
            let spans = first..first + sets.len();
            first = spans.end;
            (run.part(spans), sets)
        })
        .collect()
}

/// Adds the cycle of one part of a run, and the numbers of the poses of its vertices.
fn add_cycle(
    body: &Mesh,
    run: &Run,
    grazing: &[GrazingSet],
    budget: &Budget,
    room: &Room,
    cycle: &mut SweepCycle,
    poses: &mut Vec<u32>,
) -> Result<(), CycleError> {
    let mut points = BodyPoints::default();
    let vertices: Vec<u32> = body.positions().iter().map(|&p| points.intern(p)).collect();
    cycle.errors.proven &= grazing.iter().all(|set| set.proven.is_some());
    let mut triangles = cycle.triangles.len() as f64;
    let mut lines = Vec::new();
    let mut sunk = Vec::new();
    for ((flow, frame), grazing) in run.flows.iter().zip(&run.frames).zip(grazing) {
        let carried = carried(body, grazing, (flow, frame), budget, room, &mut points)?;
        triangles += carried.triangles();
        check_size(triangles)?;
        let Carry {
            on_body,
            moved,
            filled_reach,
        } = carried;
        let sampling = &on_body.sampling;
        let errors = &mut cycle.errors;
        for carried in &moved.carried {
            let [a, b] = carried.ends.map(|p| frame.transform_point3(points.at(p)));
            errors.sampling = errors.sampling.max(sampling.error(a, b));
        }
        errors.filled_dent = errors.filled_dent.max(filled_reach);
        errors.dropped_fold = errors.dropped_fold.max(grazing.dropped_fold);
        errors.merge = errors.merge.max(grazing.merged);
        errors.steps += sampling.steps;
        lines.push(on_body);
        sunk.push(moved);
    }
    let (caps, joints) = caps(body, &vertices, grazing, &lines, &mut points);
    let mut assembly = Assembly::new(body, run, &points);
    for (joint, cap) in caps.iter().enumerate() {
        cap.triangles
            .iter()
            .for_each(|&triangle| assembly.push_at_joint(joint, triangle));
    }
    for (number, (lines, sunk)) in lines.iter().zip(&sunk).enumerate() {
        let [below, above] = [number, number + 1].map(|joint| (&joints[joint], &caps[joint]));
        assembly.span(number, lines, sunk, below, above);
    }
    cycle.errors.snapped = cycle.errors.snapped.max(assembly.snapped);
    let first = index(cycle.positions.len());
    let first_pose = poses.iter().max().map_or(0, |last| last + 1);
    poses.extend(assembly.poses.iter().map(|pose| first_pose + pose));
    cycle.positions.extend(assembly.positions);
    cycle
        .triangles
        .extend(assembly.triangles.iter().map(|t| t.map(|v| first + v)));
    Ok(())
}

/// The caps of all joints, in order, with the joints themselves.
fn caps<'a>(
    body: &'a Mesh,
    vertices: &'a [u32],
    grazing: &'a [GrazingSet],
    lines: &'a [SpanLines],
    points: &mut BodyPoints,
) -> (Vec<Cap>, Vec<Joint<'a>>) {
    let last = grazing.len();
    let joints: Vec<Joint> = (0..=last)
        .map(|joint| {
            let spans = (joint.saturating_sub(1)..(joint + 1).min(last))
                .map(|s| (&grazing[s], &lines[s]))
                .collect();
            Joint {
                mesh: body,
                vertices,
                spans,
            }
        })
        .collect();
    let caps = joints
        .iter()
        .enumerate()
        .map(|(number, joint)| match number {
            0 => joint.cap(|egress| i8::from(!egress[0]), points),
            _ if number == last => joint.cap(|egress| i8::from(egress[0]), points),
            _ => joint.cap(|egress| i8::from(egress[0]) - i8::from(egress[1]), points),
        })
        .collect();
    (caps, joints)
}
