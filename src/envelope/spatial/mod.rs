//! The envelope and the sweep cycle of a triangle mesh.

mod alignment;
mod assembly;
mod caps;
mod carrying;
mod coincidence;
mod cycle;
mod lines;
mod points;
mod room;
mod runs;
mod sampled;
mod sampling;
mod sinking;
mod size;
mod straightening;
mod traces;

use crate::body::Mesh;
use crate::grazing::spatial::{GrazingSet, Simplification, boundary};
use crate::motion::{Flow, Generator, Motion};
use crate::surface::SurfacePoint;
use crate::watch::{Interrupted, Work};
use assembly::Assembly;
use caps::{Cap, Joint};
use carrying::{Carry, carried, check_size, grazing_at};
use cycle::Gathered;
use glam::{DAffine3, DVec3};
use lines::SpanLines;
use points::BodyPoints;
use room::Room;
use runs::{Run, runs};
use sampling::Sampling;
use size::refuse_many;

pub use crate::grazing::spatial::{Fold, Source};
pub use crate::numeric::tolerance::Budget;
pub use carrying::CycleError;
pub(crate) use cycle::WrongSheet;
pub use cycle::{CycleErrors, SweepCycle};
pub use sampled::{SampledEnvelope, sampled_envelope};
pub(crate) use traces::{Trace, TracePart, Traces, traces};

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

    /// The unit normal of the sheet at that place, towards the lower of the winding numbers that it
    /// separates: out of the swept region where the sheet bounds it. `None` where the segment moves
    /// along itself.
    pub fn normal(&self, motion: &Motion, along: f64, share: f64) -> Option<DVec3> {
        let flow = motion.spans()[self.span].flow();
        let pose = flow.pose_at(share) * motion.joints()[self.span];
        let segment = pose.transform_vector3(self.ends[1] - self.ends[0]);
        let velocity = flow.generator().velocity(self.point(motion, along, share));
        segment.cross(velocity).try_normalize()
    }
}

/// The untrimmed envelope of a mesh under a motion: every grazing segment, exact, once per span.
///
/// `body` is given in its own frame. Sheets come in the order of the spans, then edges before
/// faces, by index. The boundary of the swept region is part of these sheets and of the body's
/// faces at the start, at the joints and at the end. O(#F) per span; nothing is sampled.
pub fn envelope(body: &Mesh, motion: &Motion) -> Vec<Sheet> {
    let body = body.transformed(motion.start_pose());
    let mut sheets = Vec::new();
    for (number, (span, frame)) in motion.spans().iter().zip(motion.joints()).enumerate() {
        let generator = span.flow().generator();
        let grazing = GrazingSet::exact(&body, frame, generator);
        sheets.extend(sheets_of(&body, &grazing, (frame, generator), number));
    }
    sheets
}

/// The sheets of span `number`, which begins at `frame` relative to the start of the motion.
fn sheets_of(
    body: &Mesh,
    grazing: &GrazingSet,
    (frame, generator): (&DAffine3, &Generator),
    number: usize,
) -> impl Iterator<Item = Sheet> {
    let intervals = boundary(body, grazing, frame, generator).into_iter();
    intervals.map(move |interval| {
        let mut ends = interval.ends.map(|t| interval.at(t));
        if interval.reversed {
            ends.reverse();
        }
        Sheet {
            source: interval.source,
            span: number,
            fold: interval.fold,
            ends,
        }
    })
}

/// The sheets that [`sweep_cycles`] samples: those of [`envelope`], but without the shallow folds
/// that the budget drops, and with no span longer than one period. For debugging: it repeats that
/// part of the work.
pub(crate) fn sampled_sheets(
    body: &Mesh,
    motion: &Motion,
    budget: &Budget,
    work: Work,
) -> Result<Vec<Sheet>, Interrupted> {
    let mut sheets = Vec::new();
    let mut number = 0;
    for run in runs(motion) {
        let sets = grazing_of(body, &run, budget, work)?;
        for ((flow, frame), grazing) in run.flows.iter().zip(&run.frames).zip(&sets) {
            sheets.extend(sheets_of(body, grazing, (frame, flow.generator()), number));
            number += 1;
        }
    }
    Ok(sheets)
}

/// The sweep cycle of `body` (given in the world at the start of the motion) at a tolerance.
///
/// # Errors
/// [`CycleError`] when it would have too many triangles.
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
    let mut cycles = cycles(body, motion, budget, f64::INFINITY, Work::UNWATCHED)?;
    Ok(cycles.swap_remove(0))
}

/// As [`sweep_cycle`], in one or more parts: each is the cycle of consecutive spans, with both
/// caps. The motion sweeps the union of what they sweep.
///
/// Sheets of spans that are far apart in time need not be arranged with each other where both are
/// hidden. A part ends as soon as its caps are few compared with its sheets.
///
/// # Errors
/// As [`sweep_cycle`].
pub(crate) fn sweep_cycles(
    body: &Mesh,
    motion: &Motion,
    budget: &Budget,
    work: Work,
) -> Result<Vec<SweepCycle>, CycleError> {
    let enough = SHEETS_PER_FACE * body.triangles().len() as f64;
    cycles(body, motion, budget, enough, work)
}

/// Number of triangles of sheets per face of the body at which a part ends. Each part adds the
/// body's faces at one pose to the triangles to be arranged, then a tenth. The worm of 12 spans
/// whose sheets lie in the body takes 57 s in parts, and is not done in 150 s as a whole; where
/// next to nothing is hidden (200 keyframes of a smooth path), both take the same time.
const SHEETS_PER_FACE: f64 = 10.0;

/// Cycles of at least `enough` triangles of sheets, except for the last.
fn cycles(
    body: &Mesh,
    motion: &Motion,
    budget: &Budget,
    enough: f64,
    work: Work,
) -> Result<Vec<SweepCycle>, CycleError> {
    let room = Room::new(body);
    work.check()?;
    let runs = runs(motion);
    refuse_many(body, &runs, budget, &room, work.uncounted())?;
    let spans = runs.iter().map(|run| run.flows.len() as u64).sum();
    let [grazing_work, carrying_work, joining_work] = work.part(1, spans).parts([3, 2, 2]);
    let mut gathered = Gathered::new(budget, enough);
    for run in runs {
        let grazing = grazing_of(body, &run, budget, grazing_work)?;
        for (run, grazing) in parts(&run, &grazing) {
            let mut first = 0;
            while first < grazing.len() {
                let spans = carry(body, &run, grazing, first, &room, &gathered, carrying_work)?;
                let count = spans.carried.len();
                let part = run.part(first..first + count);
                let grazing = &grazing[first..first + count];
                add_cycle(body, &part, grazing, spans, &mut gathered, joining_work)?;
                first += count;
            }
        }
    }
    Ok(gathered.finish(work.uncounted())?)
}

/// The grazing sets of the spans of a run. `part` is the work of one span.
fn grazing_of(
    body: &Mesh,
    run: &Run,
    budget: &Budget,
    part: Work,
) -> Result<Vec<GrazingSet>, Interrupted> {
    let simplification = Simplification {
        fold: budget.fold,
        merge: budget.merge,
    };
    run.flows
        .iter()
        .zip(&run.frames)
        .map(|(flow, frame)| grazing_at(body, frame, flow.generator(), simplification, part))
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
    let are_translations = grazing.iter().all(|set| set.translated.is_some());
    let is_given = |set: &GrazingSet| set.translated.is_some_and(|body| body.is_given);
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

/// What consecutive spans carry along.
struct CarriedSpans {
    points: BodyPoints,
    /// The body's vertices among the points: they come first, so that their numbers are the same
    /// in every span.
    vertices: Vec<u32>,
    carried: Vec<Carry>,
    /// Triangles of their sheets.
    sheets: f64,
}

/// What the spans of a run from `first` on carry along, until they suffice for a cycle. `part` is
/// the work of one span.
fn carry(
    body: &Mesh,
    run: &Run,
    grazing: &[GrazingSet],
    first: usize,
    room: &Room,
    gathered: &Gathered,
    part: Work,
) -> Result<CarriedSpans, CycleError> {
    let mut points = BodyPoints::default();
    let vertices = body.positions().iter().map(|&p| points.intern(p)).collect();
    let mut spans = CarriedSpans {
        points,
        vertices,
        carried: Vec::new(),
        sheets: 0.0,
    };
    let flows = run.flows.iter().zip(&run.frames);
    for (flow, grazing) in flows.zip(grazing).skip(first) {
        let carried = carried(
            body,
            grazing,
            flow,
            gathered.budget,
            room,
            &mut spans.points,
            part,
        )?;
        spans.sheets += carried.triangles();
        check_size(gathered.triangles() + spans.sheets)?;
        spans.carried.push(carried);
        if gathered.is_enough(spans.sheets) {
            break;
        }
    }
    Ok(spans)
}

/// Adds the cycle of spans that meet. `part` is the work of one span.
fn add_cycle(
    body: &Mesh,
    run: &Run,
    grazing: &[GrazingSet],
    spans: CarriedSpans,
    gathered: &mut Gathered,
    part: Work,
) -> Result<(), Interrupted> {
    let [capping, assembling] = part.parts([1, 2]);
    let CarriedSpans {
        mut points,
        vertices,
        carried,
        sheets,
    } = spans;
    let mut errors = CycleErrors::none();
    let mut wrong = Vec::new();
    // The signs of translations alone are those of a body nearby. Where other spans join them,
    // those that may be wrong for the given body count like any other.
    let are_translations = grazing.iter().all(|set| set.translated.is_some());
    let mut lines = Vec::new();
    let mut sunk = Vec::new();
    for (((carried, frame), flow), grazing) in carried
        .into_iter()
        .zip(&run.frames)
        .zip(&run.flows)
        .zip(grazing)
    {
        let Carry {
            on_body,
            moved,
            filled_reach,
        } = carried;
        let sampling = &on_body.sampling;
        for carried in &moved.carried {
            let [a, b] = carried.ends.map(|p| frame.transform_point3(points.at(p)));
            errors.sampling = errors.sampling.max(sampling.error(a, b));
        }
        errors.filled_dent = errors.filled_dent.max(filled_reach);
        errors.dropped_fold = errors.dropped_fold.max(grazing.dropped_fold);
        errors.merge = errors.merge.max(grazing.merged);
        if are_translations {
            // Once from the given body to that body, once back.
            let distance = grazing.translated.map_or(0.0, |body| body.distance);
            errors.displaced = errors.displaced.max(2.0 * distance);
        } else if !grazing.wrong.is_empty() {
            wrong.push(wrong_sheet(flow, &grazing.wrong, gathered.budget));
        }
        errors.steps += sampling.steps;
        lines.push(on_body);
        sunk.push(moved);
    }
    let (caps, joints) = caps(body, &vertices, grazing, &lines, &mut points, capping)?;
    let mut assembly = Assembly::new(body, run, &points);
    for (joint, cap) in caps.iter().enumerate() {
        cap.triangles
            .iter()
            .for_each(|&triangle| assembly.push_at_joint(joint, triangle));
    }
    for (number, (lines, sunk)) in lines.iter().zip(&sunk).enumerate() {
        let [below, above] = [number, number + 1].map(|joint| (&joints[joint], &caps[joint]));
        assembly.span(number, lines, sunk, below, above, assembling)?;
    }
    errors.snapped = assembly.snapped;
    gathered.add(assembly, errors, wrong, sheets, part.uncounted())
}

/// What the wrong parts of a grazing set sweep.
fn wrong_sheet(flow: &Flow, parts: &[[SurfacePoint; 3]], budget: &Budget) -> WrongSheet {
    let points = parts.as_flattened().iter().map(|corner| corner.place);
    // Steps of half the length leave more of the distance to what is looked for.
    let finer = Budget {
        chord: 0.25 * budget.chord,
        ..*budget
    };
    let sampling = Sampling::uniform(flow, points.clone(), &finer);
    WrongSheet {
        parts: parts.to_vec(),
        poses: (0..=sampling.steps)
            .map(|step| flow.pose_at(sampling.time(step)))
            .collect(),
        bend: points.map(|p| sampling.bend(p)).fold(0.0, f64::max),
    }
}

/// The caps of all joints, in order, with the joints themselves.
fn caps<'a>(
    body: &'a Mesh,
    vertices: &'a [u32],
    grazing: &'a [GrazingSet],
    lines: &'a [SpanLines],
    points: &mut BodyPoints,
    part: Work,
) -> Result<(Vec<Cap>, Vec<Joint<'a>>), Interrupted> {
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
            0 => joint.cap(|egress| i8::from(!egress[0]), points, part),
            _ if number == last => {
                joint.cap(|egress| i8::from(egress[0]), points, part.uncounted())
            }
            _ => joint.cap(
                |egress| i8::from(egress[0]) - i8::from(egress[1]),
                points,
                part,
            ),
        })
        .collect::<Result<_, Interrupted>>()?;
    Ok((caps, joints))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::SurfaceTree;
    use crate::motion::{Generator, Span};
    use crate::samples::cuboid;

    /// A point has as many time intervals in the parts as in the whole, and one more for each joint
    /// between parts at which the body contains it: there, an interval is cut in two.
    #[test]
    fn parts_wind_round_what_the_whole_winds_round() {
        let (positions, triangles) = cuboid(DVec3::ZERO, DVec3::new(1.0, 0.7, 0.4));
        let body = Mesh::new(positions, triangles).expect("a box is a body");
        let spans = [
            Generator::screw(DVec3::Z, DVec3::X, 1.2, 0.3, 1.0),
            Generator::translation(DVec3::new(-0.5, 0.8, 0.1)),
            Generator::screw(DVec3::X, DVec3::Y, -2.0, 0.2, 1.1),
        ];
        let spans = spans.map(|generator| Span::new(generator, 1.0).expect("a legal span"));
        let motion = Motion::from_spans(spans.to_vec()).expect("a legal motion");
        let budget = Budget::of(0.02);
        let whole = sweep_cycle(&body, &motion, &budget).expect("small");
        let parts = cycles(&body, &motion, &budget, 1.0, Work::UNWATCHED).expect("small");
        assert_eq!(parts.len(), 3, "each span has enough");
        let tree = |cycle: &SweepCycle| SurfaceTree::new(&cycle.positions, &cycle.triangles);
        let (tree_of_whole, trees) = (tree(&whole), parts.iter().map(tree).collect::<Vec<_>>());
        let at_joints = [1, 2].map(|joint| {
            let posed = body.transformed(&motion.joints()[joint]);
            SurfaceTree::new(posed.positions(), posed.triangles())
        });
        let mut seen = [0; 5];
        for number in 0..4_000_u32 {
            let [x, y, z] = [0.754_877_666, 0.569_840_291, 0.362_780_102]
                .map(|step: f64| (f64::from(number) * step).fract());
            let point = DVec3::new(x, y, z) * 3.0 - DVec3::splat(1.0);
            let sum = |trees: &[SurfaceTree]| -> i32 {
                let windings = trees.iter().map(|tree| tree.winding_number(point));
                windings.map(|w| w.expect("off the surface")).sum()
            };
            let w = sum(std::slice::from_ref(&tree_of_whole));
            assert_eq!(sum(&trees), w + sum(&at_joints), "{point}");
            seen[usize::try_from(w).expect("none negative").min(4)] += 1;
        }
        assert!(seen[0] > 100 && seen[1] > 100 && seen[2] > 0, "{seen:?}");
    }
}
