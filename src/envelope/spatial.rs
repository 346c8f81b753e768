//! Envelope and sweep cycle of a triangle mesh.

use super::caps::{Cap, Joint};
use super::lines::{SpanLines, boundary};
use super::points::BodyPoints;
use super::sampling::Sampling;
use super::sinking::{Carried, Sunk, sink};
use crate::body::Mesh;
use crate::grazing::spatial::{GrazingSet, Simplification};
use crate::motion::{Generator, Motion, Span};
use crate::numeric::index;
use crate::numeric::tolerance::{Budget, MOST_TRIANGLES, REST, SAME_POSE, SINK_DEPTH};
use glam::{DAffine3, DVec3};
use std::collections::BTreeMap;

pub use super::lines::{Fold, Source};

/// A sheet of the untrimmed envelope: a straight grazing segment, fixed on the body, carried along for one span.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// The edge or face that grazes there.
    pub source: Source,
    /// Number of the span.
    pub span: usize,
    /// Which winding numbers the sheet separates.
    pub fold: Fold,
    /// Ends of the segment in the world at the start of the motion, the egress region on the left.
    pub ends: [DVec3; 2],
}

impl Sheet {
    /// The point at `along` in \[0, 1\] of the segment, `share` in \[0, 1\] of the span after its start (world).
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
/// `body` is given in its own frame. Sheets come in the order of the spans, then edges before faces, by index. The
/// boundary of the swept region is part of these sheets and of the body's faces at the start, at the joints and at
/// the end. O(#F) per span; nothing is sampled.
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

fn grazing_at(
    body: &Mesh,
    frame: &DAffine3,
    generator: &Generator,
    simplification: Simplification,
) -> GrazingSet {
    let positions: Vec<DVec3> = body
        .positions()
        .iter()
        .map(|&p| frame.transform_point3(p))
        .collect();
    GrazingSet::new(body, &positions, generator, simplification)
}

/// The closed oriented surface whose winding number counts the time intervals that a point spends inside the body.
#[derive(Debug, Clone)]
pub struct SweepCycle {
    /// World.
    pub positions: Vec<DVec3>,
    /// Index triples; the surface crosses itself.
    pub triangles: Vec<[u32; 3]>,
    /// What sampling and simplification may have changed.
    pub errors: CycleErrors,
}

/// Bounds, lengths in the world, on what a sampled cycle differs from the exact one by.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CycleErrors {
    /// Distance between the sampled sheets and the exact ones.
    pub sampling: f64,
    /// Depth of the folds that were given up.
    pub dropped_fold: f64,
    /// Depth to which inner sheets were sunk.
    pub sinking: f64,
    /// Distance that break points were moved by, and the displacements of points that rest.
    pub merge: f64,
    /// Number of time steps, over all spans.
    pub steps: usize,
}

/// Why no sweep cycle was made.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CycleError {
    /// Too many triangles.
    #[error(
        "the sampled surface would have {triangles:.1e} triangles, more than {MOST_TRIANGLES:.0e}; \
         use a coarser tolerance or a shorter motion"
    )]
    TooLarge {
        /// How many there would be.
        triangles: f64,
    },
}

/// The sweep cycle of `body` (given in the world at the start of the motion) at a tolerance.
///
/// `room` tells, for a point of the body and a direction (body frame), how far one may go before half of what is left of the body
/// there is passed: it limits sinking.
///
/// # Cost
/// O(#F) per span, and O(grazing pieces x time steps) triangles.
pub fn sweep_cycle(
    body: &Mesh,
    motion: &Motion,
    budget: &Budget,
    room: impl Fn(DVec3, DVec3) -> f64 + Copy,
) -> Result<SweepCycle, CycleError> {
    let mut points = BodyPoints::default();
    let vertices: Vec<u32> = body.positions().iter().map(|&p| points.intern(p)).collect();
    let simplification = Simplification {
        fold: budget.fold,
        merge: budget.merge,
    };
    let grazing: Vec<GrazingSet> = motion
        .spans()
        .iter()
        .zip(motion.joints())
        .map(|(span, frame)| grazing_at(body, frame, span.flow().generator(), simplification))
        .collect();
    let mut errors = CycleErrors::default();
    let mut triangles: f64 = 0.0;
    let mut lines = Vec::new();
    let mut sunk = Vec::new();
    for ((span, frame), grazing) in motion.spans().iter().zip(motion.joints()).zip(&grazing) {
        let generator = span.flow().generator();
        let intervals = boundary(body, grazing, frame, generator);
        let ends = intervals
            .iter()
            .flat_map(|i| i.ends.map(|t| frame.transform_point3(i.at(t))));
        let sampling = Sampling::new(generator, |t| span.flow().pose_at(t), ends, budget);
        let on_body = SpanLines::new(
            body,
            grazing,
            frame,
            &intervals,
            sampling,
            budget,
            &mut points,
        );
        let sampling_error = on_body.sampling.chord_error + on_body.twist_error;
        let depth = SINK_DEPTH * sampling_error;
        let moved = sink(&on_body.pieces, frame, generator, depth, room, &mut points);
        errors.sampling = errors.sampling.max(sampling_error);
        errors.dropped_fold = errors.dropped_fold.max(grazing.dropped_fold);
        errors.sinking = errors
            .sinking
            .max(if moved.fins.is_empty() { 0.0 } else { depth });
        errors.steps += on_body.sampling.steps;
        triangles += 2.0 * (moved.carried.len() as f64) * (on_body.sampling.steps as f64);
        if !(triangles <= MOST_TRIANGLES as f64) {
            return Err(CycleError::TooLarge { triangles });
        }
        lines.push(on_body);
        sunk.push(moved);
    }
    errors.merge = budget.merge;
    let (caps, joints) = caps(body, &vertices, &grazing, &lines, &mut points);
    let mut assembly = Assembly::new(body, motion, &points);
    for (joint, cap) in caps.iter().enumerate() {
        cap.triangles
            .iter()
            .for_each(|&triangle| assembly.push_at_joint(joint, triangle));
    }
    for (number, (lines, sunk)) in lines.iter().zip(&sunk).enumerate() {
        let [below, above] = [number, number + 1].map(|joint| (&joints[joint], &caps[joint]));
        assembly.span(number, lines, sunk, below, above);
    }
    let Assembly {
        positions,
        triangles,
        ..
    } = assembly;
    debug_assert!(
        is_closed(&triangles),
        "the sweep cycle is closed whatever the input"
    );
    Ok(SweepCycle {
        positions,
        triangles,
        errors,
    })
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

/// Vertices and triangles of the cycle as they are put together.
struct Assembly<'a> {
    motion: &'a Motion,
    points: &'a BodyPoints,
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// Per joint and point, its vertex.
    at_joints: Vec<Vec<Option<u32>>>,
    /// Whether the last joint is the first again.
    is_closed: bool,
    /// Per span, speed below which a point rests.
    rest: Vec<f64>,
}

impl<'a> Assembly<'a> {
    fn new(body: &Mesh, motion: &'a Motion, points: &'a BodyPoints) -> Self {
        let top_speed = |(span, frame): (&Span, &DAffine3)| {
            let generator = span.flow().generator();
            let speed = |p: &DVec3| generator.velocity(frame.transform_point3(*p)).length();
            REST * body.positions().iter().map(speed).fold(0.0, f64::max)
        };
        let size = body
            .positions()
            .iter()
            .map(|p| p.abs().max_element())
            .fold(0.0, f64::max);
        let end = motion
            .joints()
            .last()
            .copied()
            .unwrap_or(DAffine3::IDENTITY);
        let back = |p: &DVec3| end.transform_point3(*p).distance(*p) <= SAME_POSE * size;
        Assembly {
            motion,
            points,
            positions: Vec::new(),
            triangles: Vec::new(),
            at_joints: vec![vec![None; points.positions().len()]; motion.joints().len()],
            is_closed: body.positions().iter().all(back),
            rest: motion
                .spans()
                .iter()
                .zip(motion.joints())
                .map(top_speed)
                .collect(),
        }
    }

    /// Whether a point keeps its place during a span.
    fn rests(&self, span: usize, point: u32) -> bool {
        let place = self.motion.joints()[span].transform_point3(self.points.at(point));
        self.motion.spans()[span]
            .flow()
            .generator()
            .velocity(place)
            .length()
            <= self.rest[span]
    }

    fn vertex(&mut self, position: DVec3) -> u32 {
        self.positions.push(position);
        index(self.positions.len() - 1)
    }

    /// The vertex of a point at the pose of a joint.
    fn at_joint(&mut self, joint: usize, point: u32) -> u32 {
        if self.is_closed && joint + 1 == self.at_joints.len() && joint > 0 {
            return self.at_joint(0, point);
        }
        if let Some(vertex) = self.at_joints[joint][point as usize] {
            return vertex;
        }
        let vertex = if joint > 0 && self.rests(joint - 1, point) {
            self.at_joint(joint - 1, point)
        } else {
            self.vertex(self.motion.joints()[joint].transform_point3(self.points.at(point)))
        };
        self.at_joints[joint][point as usize] = Some(vertex);
        vertex
    }

    /// Adds a triangle unless it is degenerate.
    fn push(&mut self, triangle: [u32; 3]) {
        let [a, b, c] = triangle;
        if a != b && b != c && c != a {
            self.triangles.push(triangle);
        }
    }

    fn push_at_joint(&mut self, joint: usize, triangle: [u32; 3]) {
        let triangle = triangle.map(|point| self.at_joint(joint, point));
        self.push(triangle);
    }

    /// The strips and fins of one span. `below`, `above`: the joints at its start and end with their caps.
    fn span(
        &mut self,
        number: usize,
        lines: &SpanLines,
        sunk: &Sunk,
        below: (&Joint, &Cap),
        above: (&Joint, &Cap),
    ) {
        let span_in_joint = |joint: usize| {
            if joint == number {
                usize::from(number > 0)
            } else {
                0
            }
        };
        let extras = |(joint, cap): (&Joint, &Cap), at: usize, piece: usize| {
            let piece = &lines.pieces[piece];
            let mut between = joint.between(cap, span_in_joint(at), piece.source, piece.place);
            if piece.reversed {
                between.reverse();
            }
            between
        };
        for fin in &sunk.fins {
            let [a, b] = lines.pieces[fin.piece].ends;
            let [a_copy, b_copy] = fin.copies;
            for (joint, at, sign) in [(number, below, -1), (number + 1, above, 1)] {
                let mut path = vec![a];
                path.extend(extras(at, joint, fin.piece));
                path.push(b);
                let mut triangles: Vec<[u32; 3]> = path
                    .windows(2)
                    .map(|pair| [pair[1], pair[0], a_copy])
                    .collect();
                triangles.push([b, a_copy, b_copy]);
                for [p, q, r] in triangles {
                    self.push_at_joint(joint, if sign > 0 { [p, q, r] } else { [p, r, q] });
                }
            }
        }
        let layers = Layers::new(self, number, lines.sampling.steps, &sunk.carried);
        for carried in &sunk.carried {
            let [a, b] = carried.ends;
            let ends = |at: (&Joint, &Cap), joint: usize| {
                carried
                    .piece
                    .map_or_else(Vec::new, |piece| extras(at, joint, piece))
            };
            let forward = self.is_low_forward(number, carried, lines.sampling.steps);
            let last = lines.sampling.steps;
            for step in 0..last {
                let mut low = vec![layers.vertex(self, step, a)];
                if step == 0 {
                    low.extend(
                        ends(below, number)
                            .iter()
                            .map(|&p| self.at_joint(number, p)),
                    );
                }
                low.push(layers.vertex(self, step, b));
                let mut high = vec![layers.vertex(self, step + 1, a)];
                if step + 1 == last {
                    high.extend(
                        ends(above, number + 1)
                            .iter()
                            .map(|&p| self.at_joint(number + 1, p)),
                    );
                }
                high.push(layers.vertex(self, step + 1, b));
                self.quadrilateral(&low, &high, forward);
            }
        }
    }

    /// Two fans of triangles between the paths `low` and `high`, divided from the start of one to the end of the other:
    /// `forward` from the start of `low`.
    fn quadrilateral(&mut self, low: &[u32], high: &[u32], forward: bool) {
        let (low_apex, high_apex) = if forward {
            (high[high.len() - 1], low[0])
        } else {
            (high[0], low[low.len() - 1])
        };
        for pair in low.windows(2) {
            self.push([pair[0], pair[1], low_apex]);
        }
        for pair in high.windows(2) {
            self.push([pair[1], pair[0], high_apex]);
        }
    }

    /// Which diagonal of a strip's quadrilaterals is on its low side, so that twist only adds: the one from the start
    /// of the earlier segment to the end of the later. The same in every step, since steps are affine images.
    fn is_low_forward(&self, number: usize, carried: &Carried, steps: usize) -> bool {
        let flow = self.motion.spans()[number].flow();
        let frame = &self.motion.joints()[number];
        let [a, b] = carried
            .ends
            .map(|p| frame.transform_point3(self.points.at(p)));
        let step = flow.pose_at(1.0 / steps as f64);
        let twist = (step.transform_point3(b) - step.transform_point3(a)) - (b - a);
        let low = (b - a).cross(flow.generator().velocity(a.midpoint(b)));
        twist.dot(low) > 0.0
    }
}

/// The vertices of one span's carried points at its inner time steps.
struct Layers {
    number: usize,
    steps: usize,
    /// Per carried point that moves, its slot in a layer.
    slots: BTreeMap<u32, u32>,
    /// Vertex of slot 0 in the first inner layer.
    base: u32,
}

impl Layers {
    fn new(assembly: &mut Assembly, number: usize, steps: usize, carried: &[Carried]) -> Layers {
        let mut moving: Vec<u32> = carried.iter().flat_map(|c| c.ends).collect();
        moving.sort_unstable();
        moving.dedup();
        moving.retain(|&point| !assembly.rests(number, point));
        let base = index(assembly.positions.len());
        let frame = assembly.motion.joints()[number];
        let flow = assembly.motion.spans()[number].flow();
        for step in 1..steps {
            let pose = flow.pose_at(step as f64 / steps as f64) * frame;
            assembly.positions.extend(
                moving
                    .iter()
                    .map(|&p| pose.transform_point3(assembly.points.at(p))),
            );
        }
        let slots = moving
            .iter()
            .enumerate()
            .map(|(slot, &point)| (point, index(slot)))
            .collect();
        Layers {
            number,
            steps,
            slots,
            base,
        }
    }

    fn vertex(&self, assembly: &mut Assembly, step: usize, point: u32) -> u32 {
        if step == self.steps {
            return assembly.at_joint(self.number + 1, point);
        }
        match self.slots.get(&point) {
            Some(slot) if step > 0 => self.base + index(step - 1) * index(self.slots.len()) + slot,
            _ => assembly.at_joint(self.number, point),
        }
    }
}

/// Whether every directed edge is matched by an opposite one.
fn is_closed(triangles: &[[u32; 3]]) -> bool {
    let mut balance = std::collections::HashMap::<(u32, u32), i32>::new();
    for t in triangles {
        for i in 0..3 {
            let (a, b) = (t[i], t[(i + 1) % 3]);
            *balance.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
        }
    }
    balance.values().all(|&count| count == 0)
}
