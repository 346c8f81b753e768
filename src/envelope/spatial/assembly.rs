//! The sweep cycle put together: vertices of caps, fins and strips, and the triangles between them.

use super::caps::{Cap, Joint};
use super::lines::SpanLines;
use super::points::BodyPoints;
use super::runs::Run;
use super::sampling::Sampling;
use super::sinking::{Carried, SunkBoundary};
use crate::body::Mesh;
use crate::motion::stretch;
use crate::numeric::index;
use crate::numeric::tolerance::{REST, SAME_POSE};
use crate::watch::{Interrupted, Work};
use glam::DVec3;
use std::collections::{BTreeMap, HashMap};

/// Vertices and triangles of the cycle during its assembly.
pub(crate) struct Assembly<'a> {
    run: &'a Run,
    points: &'a BodyPoints,
    pub(crate) positions: Vec<DVec3>,
    /// Per position, the number of its pose: first the joints, then the time steps inside the
    /// spans.
    pub(crate) poses: Vec<u32>,
    /// Number of the next pose.
    next_pose: u32,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The vertex of a point at a joint.
    at_joints: HashMap<(usize, u32), u32>,
    /// Whether the last joint is the first again.
    is_closed: bool,
    /// Per span, the speed below which a point counts as resting, and the factor by which it may
    /// get farther than that speed times a time of 1.
    rest: Vec<[f64; 2]>,
    /// Bound on the distance by which points were moved because they count as resting or as closing
    /// a circle.
    pub(crate) snapped: f64,
}

impl<'a> Assembly<'a> {
    pub(crate) fn new(body: &Mesh, run: &'a Run, points: &'a BodyPoints) -> Self {
        let rest: Vec<[f64; 2]> = run
            .flows
            .iter()
            .zip(&run.frames)
            .map(|(flow, frame)| {
                let speed = |p: &DVec3| {
                    flow.generator()
                        .velocity(frame.transform_point3(*p))
                        .length()
                };
                let fastest = body.positions().iter().map(speed).fold(0.0, f64::max);
                [
                    REST * fastest,
                    stretch(&flow.generator().linear, [0.0, 1.0]),
                ]
            })
            .collect();
        let [start, end] = [0, run.flows.len()].map(|joint| run.frames[joint]);
        let size = body
            .positions()
            .iter()
            .map(|&p| start.transform_point3(p).abs().max_element());
        let same = SAME_POSE * size.fold(0.0, f64::max);
        let gap = body
            .positions()
            .iter()
            .map(|&p| start.transform_point3(p).distance(end.transform_point3(p)))
            .fold(0.0, f64::max);
        Assembly {
            run,
            points,
            positions: Vec::new(),
            poses: Vec::new(),
            next_pose: index(run.frames.len()),
            triangles: Vec::new(),
            at_joints: HashMap::new(),
            is_closed: gap <= same,
            rest,
            snapped: if gap <= same { gap } else { 0.0 },
        }
    }

    /// The speed of a point at the start of a span.
    fn speed(&self, span: usize, point: u32) -> f64 {
        let place = self.run.frames[span].transform_point3(self.points.at(point));
        self.run.flows[span].generator().velocity(place).length()
    }

    /// Whether a point counts as resting during a span; if so, the distance that it should have
    /// moved is recorded.
    fn rests(&mut self, span: usize, point: u32) -> bool {
        let speed = self.speed(span, point);
        let [slowest, growth] = self.rest[span];
        let rests = speed <= slowest;
        if rests {
            self.snapped = self.snapped.max(speed * growth);
        }
        rests
    }

    fn vertex(&mut self, position: DVec3, pose: u32) -> u32 {
        self.positions.push(position);
        self.poses.push(pose);
        index(self.positions.len() - 1)
    }

    /// The vertex of a point at the pose of a joint.
    fn at_joint(&mut self, joint: usize, point: u32) -> u32 {
        let mut since = joint;
        if self.is_closed && joint + 1 == self.run.frames.len() {
            since = 0;
        }
        let vertex = loop {
            if let Some(&vertex) = self.at_joints.get(&(since, point)) {
                break vertex;
            }
            // A resting point keeps its vertex.
            if since > 0 && self.rests(since - 1, point) {
                since -= 1;
            } else {
                let place = self.run.frames[since].transform_point3(self.points.at(point));
                let vertex = self.vertex(place, index(since));
                self.at_joints.insert((since, point), vertex);
                break vertex;
            }
        };
        self.at_joints.insert((joint, point), vertex);
        vertex
    }

    /// Adds a triangle unless it is degenerate.
    fn push(&mut self, triangle: [u32; 3]) {
        let [a, b, c] = triangle;
        if a != b && b != c && c != a {
            self.triangles.push(triangle);
        }
    }

    pub(crate) fn push_at_joint(&mut self, joint: usize, triangle: [u32; 3]) {
        let triangle = triangle.map(|point| self.at_joint(joint, point));
        self.push(triangle);
    }

    /// Adds the strips and fins of one span. `below`, `above`: the joints at its start and end,
    /// with their caps.
    pub(crate) fn span(
        &mut self,
        number: usize,
        lines: &SpanLines,
        sunk: &SunkBoundary,
        below: (&Joint, &Cap),
        above: (&Joint, &Cap),
        work: Work,
    ) -> Result<(), Interrupted> {
        let items = work.items(sunk.carried.len());
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
            for (joint, at, sign) in [(number, below, -1), (number + 1, above, 1)] {
                let side = |side: usize| {
                    let [from, to] = [fin.corners[side], fin.corners[(side + 1) % 3]];
                    let mut path = vec![from];
                    if let Some(piece) = fin.pieces[side] {
                        let between = extras(at, joint, piece);
                        if lines.pieces[piece].ends[0] == from {
                            path.extend(between);
                        } else {
                            path.extend(between.into_iter().rev());
                        }
                    }
                    path.push(to);
                    path
                };
                // One fan over the second side, and one over the third side from the last point
                // before it.
                let (second, third) = (side(1), side(2));
                let turn = second[second.len() - 2];
                let over_second = second[..second.len() - 1]
                    .windows(2)
                    .map(|pair| [fin.corners[0], pair[0], pair[1]]);
                let over_third = third.windows(2).map(|pair| [turn, pair[0], pair[1]]);
                for [p, q, r] in over_second.chain(over_third) {
                    self.push_at_joint(joint, if sign > 0 { [p, q, r] } else { [p, r, q] });
                }
            }
        }
        let layers = Layers::new(self, number, &lines.sampling, &sunk.carried);
        for carried in &sunk.carried {
            items.next()?;
            let [a, b] = carried.ends;
            let ends = |at: (&Joint, &Cap), joint: usize| {
                carried
                    .piece
                    .map_or_else(Vec::new, |piece| extras(at, joint, piece))
            };
            let [from, to] = carried
                .ends
                .map(|p| self.run.frames[number].transform_point3(self.points.at(p)));
            let forward = lines.sampling.is_low_forward(from, to);
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
        Ok(())
    }

    /// Adds two fans of triangles between the paths `low` and `high`, divided by a diagonal from
    /// the start of one to the end of the other: with `forward`, from the start of `low`.
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
}

/// The vertices of the carried points of one span at its inner time steps.
struct Layers {
    number: usize,
    steps: usize,
    /// The slot in a layer of each carried point that moves.
    slots: BTreeMap<u32, u32>,
    /// Vertex of slot 0 in the first inner layer.
    base: u32,
}

impl Layers {
    fn new(
        assembly: &mut Assembly,
        number: usize,
        sampling: &Sampling,
        carried: &[Carried],
    ) -> Layers {
        let steps = sampling.steps;
        let mut moving: Vec<u32> = carried.iter().flat_map(|c| c.ends).collect();
        moving.sort_unstable();
        moving.dedup();
        moving.retain(|&point| !assembly.rests(number, point));
        let base = index(assembly.positions.len());
        let frame = assembly.run.frames[number];
        let flow = &assembly.run.flows[number];
        for step in 1..steps {
            let pose = flow.pose_at(sampling.time(step)) * frame;
            let pose_number = assembly.next_pose;
            assembly.next_pose += 1;
            for &point in &moving {
                let place = pose.transform_point3(assembly.points.at(point));
                assembly.vertex(place, pose_number);
            }
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
