//! Two trees of boxes, both in motion: from pairs of boxes over long windows to pairs of triangles over short ones.

use super::chart::{Chart, Curve, LONGEST, Mover};
use super::clip::{Clipped, Clipper};
use super::distance::{Closest, Still};
use super::intervals::Times;
use super::nearest::Nearest;
use super::separation::{Course, Meeting, Pair};
use super::shape::{Node, Shape};
use crate::motion::Generator;
use crate::numeric::tolerance::JOINT_GAP;
use glam::{DAffine3, DMat3, DVec3};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Two shapes on their ways over one stretch of the clock; local time runs from 0 to 1.
pub(super) struct Encounter<'a> {
    pub(super) shapes: [&'a Shape; 2],
    pub(super) movers: [Mover; 2],
}

impl Encounter<'_> {
    /// Both shapes at a local time.
    pub(super) fn still(&self, time: f64) -> Still<'_> {
        Still {
            shapes: self.shapes,
            poses: [0, 1].map(|which: usize| self.movers[which].pose(time)),
        }
    }

    /// From the middle of the second to that of the first, half way.
    pub(super) fn between_centres(&self) -> DVec3 {
        let [a, b] = [0, 1].map(|which: usize| self.movers[which].centre_at(0.5));
        a - b
    }

    /// Bound of the error of a distance at a local time.
    pub(super) fn slack(&self, time: f64) -> f64 {
        self.movers
            .iter()
            .map(|mover| mover.chart(time, 0.0, 0.0).slack)
            .sum()
    }

    /// Largest speed of any point against any other at a local time.
    pub(super) fn speed(&self, time: f64) -> f64 {
        self.movers.iter().map(|mover| mover.speed(time)).sum()
    }
}

/// The least distance of two shapes over a stretch of the clock.
#[derive(Debug, Clone, Copy)]
pub(super) struct Least {
    /// Nowhere less, for certain.
    pub(super) lower: f64,
    /// Where it was seen: local time and nearest triangles; `None` if nothing came below the limit.
    pub(super) seen: Option<(f64, Closest)>,
}

/// A meeting of two triangles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Found {
    /// Times are local.
    pub(super) meeting: Meeting,
    pub(super) triangles: [u32; 2],
}

/// What a search knows about the first meeting.
#[derive(Debug, Clone, Copy)]
pub(super) struct Earliest {
    /// The first one, by time, then triangles.
    pub(super) found: Option<Found>,
    /// Nothing is closer than the threshold before the first of these times, something is by the second one.
    pub(super) bracket: [f64; 2],
    /// From this time on there are pairs about which nothing is known.
    pub(super) unknown: f64,
}

impl Earliest {
    /// Nothing found up to `end`.
    pub(super) fn none() -> Earliest {
        Earliest {
            found: None,
            bracket: [f64::INFINITY; 2],
            unknown: f64::INFINITY,
        }
    }

    fn add(&mut self, found: Found) {
        let key = |f: &Found| (f.meeting.time, f.triangles);
        if self
            .found
            .as_ref()
            .is_none_or(|best| key(&found) < key(best))
        {
            self.found = Some(found);
        }
        self.bracket[0] = self.bracket[0].min(found.meeting.after);
        self.bracket[1] = self.bracket[1].min(found.meeting.by);
    }
}

/// Most pairs of boxes that one search looks at, some 10 s of work; past it, it is undecided.
const MOST_VISITS: usize = 200_000_000;

/// Most windows that a search starts with; beyond, they are wider, and halved more often.
const MOST_WINDOWS: f64 = 1e6;

/// Largest |M| h, over both movers, of the windows that a search starts with: the way of a point departs from its tangent by half of its
/// square then.
const WIDEST: f64 = 0.5;

/// Windows are cut rather than boxes while the path of a box departs from a straight one by more than this part of
/// the size of the boxes.
const WOBBLE: f64 = 0.25;

/// A window of time with both motions.
pub(super) struct Window {
    pub(super) middle: f64,
    pub(super) half: f64,
    /// Sum of |M| h.
    reduced: f64,
    pub(super) charts: [Chart; 2],
    /// Bound of the error of a distance.
    slack: f64,
    bulge: f64,
    frames: [Frame; 2],
    /// Along which boxes of the second are compared.
    turn: DMat3,
    /// Across the sides of the boxes of the first.
    axes: [Axis; 3],
    /// Directions in which something was found apart lately: what is near by will often be, too.
    lately: [Option<Axis>; AXES],
    /// Which of them is replaced next.
    oldest: usize,
    clipper: Clipper,
    children: Option<[usize; 2]>,
}

/// What boxes do in a window.
struct Frame {
    /// From the frame of the boxes to the axes along which they are compared.
    pose: DAffine3,
    /// M times the pose: velocities by points of the own frame.
    velocity: DAffine3,
    /// Half the extent of a moved box, from that of the box: entry by entry the pose and what it may change to in the window.
    extent: DMat3,
    /// Largest sum of a row of |M pose|: how fast a box of size 1 grows.
    spin: f64,
}

/// Unit normals of the sides of the boxes of a mover.
fn sides(frame: &Frame) -> [DVec3; 3] {
    let DMat3 {
        x_axis: x,
        y_axis: y,
        z_axis: z,
    } = frame.pose.matrix3;
    [y.cross(z), z.cross(x), x.cross(y)].map(|normal| normal.normalize_or(DVec3::X))
}

/// A rotation with its first axis along the first column, and the second near the second one.
fn orthonormal(matrix: &DMat3) -> DMat3 {
    let third = matrix.x_axis.cross(matrix.y_axis);
    match (matrix.x_axis.try_normalize(), third.try_normalize()) {
        (Some(x), Some(z)) => DMat3::from_cols(x, z.cross(x), z),
        _ => DMat3::IDENTITY,
    }
}

/// Directions that a window remembers.
const AXES: usize = 3;

/// A direction, as heights and their rates in the frames of both movers.
#[derive(Clone, Copy)]
struct Axis {
    direction: DVec3,
    sides: [Heights; 2],
}

/// Heights of points of a mover's own frame in the world, and what a box adds to that of its centre.
#[derive(Clone, Copy)]
struct Heights {
    height: DVec3,
    offset: f64,
    rate: DVec3,
    rate_offset: f64,
    extent: DVec3,
}

impl Axis {
    fn new(direction: DVec3, frames: &[Frame; 2], half: f64) -> Axis {
        let side = |which: usize| {
            let Frame { pose, velocity, .. } = &frames[which];
            let height = pose.matrix3.transpose() * direction;
            let rate = velocity.matrix3.transpose() * direction;
            Heights {
                height,
                offset: direction.dot(pose.translation),
                rate,
                rate_offset: direction.dot(velocity.translation),
                extent: height.abs() + rate.abs() * half,
            }
        };
        Axis {
            direction,
            sides: [side(0), side(1)],
        }
    }

    /// How far two boxes are apart along it at all times up to `longest` from the middle, but for what departs from tangents;
    /// negative when they are not.
    fn gap(&self, nodes: [&Node; 2], longest: f64) -> f64 {
        let [a, b] = &self.sides;
        let [p, q] = nodes;
        let apart = a.height.dot(p.centre) + a.offset - (b.height.dot(q.centre) + b.offset);
        let rate = a.rate.dot(p.centre) + a.rate_offset - (b.rate.dot(q.centre) + b.rate_offset);
        apart.abs() - rate.abs() * longest - a.extent.dot(p.half) - b.extent.dot(q.half)
    }
}

/// A box in the world over a window: its centre and velocity in the middle, and half the extent that holds it, but for
/// the way of the centre.
struct Moved {
    centre: DVec3,
    velocity: DVec3,
    extent: DVec3,
}

impl Frame {
    /// - `turned`: from the frame of the boxes to that of the shape. `axes`: along which boxes are compared.
    fn new(chart: &Chart, turned: &DMat3, axes: &DMat3, half: f64) -> Frame {
        let Generator { linear, offset } = chart.generator;
        let own = chart.pose.matrix3 * *turned;
        let place = chart.pose.translation;
        let back = axes.transpose();
        let pose = DAffine3 {
            matrix3: back * own,
            translation: back * place,
        };
        let velocity = DAffine3 {
            matrix3: back * (linear * own),
            translation: back * (linear * place + offset),
        };
        let spin = velocity.matrix3.abs();
        Frame {
            pose,
            extent: pose.matrix3.abs() + spin * half,
            spin: (spin.x_axis + spin.y_axis + spin.z_axis).max_element(),
            velocity,
        }
    }

    fn moved(&self, node: &Node) -> Moved {
        Moved {
            centre: self.pose.transform_point3(node.centre),
            velocity: self.velocity.transform_point3(node.centre),
            extent: self.extent * node.half,
        }
    }
}

impl Window {
    fn new(encounter: &Encounter, middle: f64, half: f64) -> Window {
        let movers = &encounter.movers;
        let reduced = half * (movers[0].size + movers[1].size);
        let charts = [0, 1].map(|which| movers[which].chart(middle, half, reduced));
        let slack = charts[0].slack + charts[1].slack;
        // Along the boxes of the second: they are thin where its faces are flat.
        let turned = [0, 1].map(|which: usize| encounter.shapes[which].frame);
        let axes = orthonormal(&(charts[1].pose.matrix3 * turned[1]));
        let frames =
            [0, 1].map(|which: usize| Frame::new(&charts[which], &turned[which], &axes, half));
        // How far a path departs from its tangent.
        let bulge = 0.5 * half * half * (charts[0].acceleration + charts[1].acceleration);
        Window {
            middle,
            half,
            reduced,
            slack,
            bulge,
            clipper: Clipper::new(
                [charts[0].generator, charts[1].generator],
                [movers[0].size, movers[1].size],
                half,
                [charts[0].stretch, charts[1].stretch],
            ),
            axes: sides(&frames[0]).map(|direction| Axis::new(direction, &frames, half)),
            frames,
            charts,
            lately: [None; AXES],
            oldest: 0,
            turn: axes,
            children: None,
        }
    }

    /// Remembers a direction.
    fn remember(&mut self, direction: DVec3) {
        let axis = Axis::new(self.turn.transpose() * direction, &self.frames, self.half);
        self.lately[self.oldest] = Some(axis);
        self.oldest = (self.oldest + 1) % AXES;
    }

    /// Whether one of the directions keeps two boxes farther apart than `reach` during a stretch.
    fn separates(&self, nodes: [&Node; 2], reach: f64, [from, to]: [f64; 2]) -> bool {
        let longest = from.abs().max(to.abs());
        let pad = self.bulge + self.slack + reach;
        let all = self.axes.iter().chain(self.lately.iter().flatten());
        all.map(|axis| axis.gap(nodes, longest))
            .any(|gap| gap > pad)
    }

    /// The part of a stretch during which two boxes may be closer than `reach`.
    fn entered(&self, a: &Moved, b: &Moved, reach: f64, stretch: [f64; 2]) -> Option<[f64; 2]> {
        let extent = a.extent + b.extent + (self.bulge + self.slack + reach);
        let (offset, velocity) = (a.centre - b.centre, a.velocity - b.velocity);
        let [mut from, mut to] = stretch;
        let way = velocity.abs() * from.abs().max(to.abs());
        if (offset.abs() - extent).cmpgt(way).any() {
            return None;
        }
        for axis in 0..3 {
            let speed = velocity[axis];
            if speed == 0.0 {
                continue;
            }
            let (low, high) = (-extent[axis] - offset[axis], extent[axis] - offset[axis]);
            let inverse = 1.0 / speed;
            let (one, other) = (low * inverse, high * inverse);
            from = from.max(one.min(other));
            to = to.min(one.max(other));
        }
        (from <= to).then_some([from, to])
    }

    /// A lower bound of the distance of two boxes during a stretch.
    fn gap(&self, a: &Moved, b: &Moved, [from, to]: [f64; 2]) -> f64 {
        let extent = a.extent + b.extent + (self.bulge + self.slack);
        let (offset, velocity) = (a.centre - b.centre, a.velocity - b.velocity);
        let (start, end) = (offset + velocity * from, offset + velocity * to);
        // Along an axis the boxes stay apart by this much if they do not change sides.
        let apart = start.abs().min(end.abs());
        let apart = DVec3::select((start * end).cmpgt(DVec3::ZERO), apart, DVec3::ZERO);
        (apart - extent).max(DVec3::ZERO).length()
    }
}

/// Two nodes during a stretch of a window; times are from its middle.
#[derive(Clone, Copy)]
struct Task {
    nodes: [u32; 2],
    window: usize,
    from: f64,
    to: f64,
}

/// The search for the first time at which two shapes come closer than a threshold.
pub(super) struct Search<'a> {
    encounter: &'a Encounter<'a>,
    windows: Vec<Window>,
    threshold: f64,
}

impl<'a> Search<'a> {
    pub(super) fn new(encounter: &'a Encounter<'a>, threshold: f64) -> Search<'a> {
        Search {
            encounter,
            windows: Vec::new(),
            threshold,
        }
    }

    /// The first meeting, if there is one before `limit` (local time).
    pub(super) fn first(&mut self, limit: f64) -> Earliest {
        let mut earliest = Earliest::none();
        earliest.bracket[1] = limit;
        let mut visits = 0;
        let mut open = Vec::new();
        let (count, half) = self.cover();
        for number in 0..count {
            let middle = f64::from(2 * number + 1) * half;
            if middle - half > earliest.bracket[1] {
                break;
            }
            let window = self.open(middle, half);
            open.extend(self.entered([0, 0], window, [-half, half]));
            while let Some(task) = open.pop() {
                let start = self.windows[task.window].middle + task.from;
                if start > earliest.bracket[1] {
                    continue;
                }
                visits += 1;
                if visits > MOST_VISITS {
                    let rest = open.iter().chain([&task]);
                    let first = rest.map(|task| self.windows[task.window].middle + task.from);
                    earliest.unknown = first.fold(earliest.unknown, f64::min);
                    return earliest;
                }
                self.refine(task, &mut open, &mut earliest);
                if earliest.bracket[1] <= 0.0 {
                    // Nothing is earlier than the beginning.
                    return earliest;
                }
            }
        }
        earliest
    }

    /// All times during which the shapes are closer than the threshold, or one contains a part of the other.
    ///
    /// What is in doubt is in them.
    pub(super) fn presences(&mut self) -> Times {
        let mut times = Times::none(JOINT_GAP);
        let mut open = Vec::new();
        let mut visits = 0;
        let (count, half) = self.cover();
        for number in 0..count {
            let window = self.open(f64::from(2 * number + 1) * half, half);
            open.extend(self.entered([0, 0], window, [-half, half]));
            while let Some(mut task) = open.pop() {
                let middle = self.windows[task.window].middle;
                let Some([from, to]) = times.rest_of([middle + task.from, middle + task.to]) else {
                    continue;
                };
                visits += 1;
                if visits > MOST_VISITS {
                    times.add([from, 1.0]);
                    break;
                }
                // Not beyond what the boxes left: the difference of times is rounded.
                (task.from, task.to) = (task.from.max(from - middle), task.to.min(to - middle));
                let shapes = self.encounter.shapes;
                let [a, b] =
                    [0, 1].map(|which: usize| shapes[which].nodes[task.nodes[which] as usize]);
                let stretch = [task.from, task.to];
                let at = &self.windows[task.window];
                if task.from > task.to || at.separates([&a, &b], self.threshold, stretch) {
                    continue;
                }
                if !(a.is_leaf() && b.is_leaf() && at.reduced <= LONGEST) {
                    self.divide(task, &mut open);
                    continue;
                }
                let triangles = [a.triangle, b.triangle];
                match self.clipped(at, triangles, stretch) {
                    Clipped::Apart(normal) => self.windows[task.window].remember(normal),
                    Clipped::Open([from, to]) => {
                        let curves = self.curves(at, triangles);
                        self.pair(at, &curves).presences(from, to, |interval| {
                            times.add(interval.map(|time| (middle + time).clamp(0.0, 1.0)));
                        });
                    }
                }
            }
        }
        // Between these times no surface meets the other: what is inside stays inside.
        for gap in times.gaps() {
            let still = self.encounter.still(gap[0].midpoint(gap[1]));
            if still.contained().is_some() {
                times.add(gap);
            }
        }
        times
    }

    fn pair<'b>(&self, at: &'b Window, curves: &'b [[Curve; 3]; 2]) -> Pair<'b> {
        Pair {
            charts: [&at.charts[0], &at.charts[1]],
            curves: [&curves[0], &curves[1]],
            half: at.half,
            threshold: self.threshold,
        }
    }

    /// How many windows cover the time, and half the width of each.
    fn cover(&self) -> (u32, f64) {
        let movers = &self.encounter.movers;
        let wanted = (0.5 * (movers[0].size + movers[1].size) / WIDEST).ceil();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped"
        )]
        let count = wanted.clamp(1.0, MOST_WINDOWS) as u32;
        (count, 0.5 / f64::from(count))
    }

    /// A new window.
    fn open(&mut self, middle: f64, half: f64) -> usize {
        self.windows.push(Window::new(self.encounter, middle, half));
        self.windows.len() - 1
    }

    /// The least distance, if it is below `limit`.
    ///
    /// Boxes that may come nearest are looked at first. Wherever a pair is nearer than what was seen, its least distance is sought by
    /// sampling; that what is left is not much nearer is then certified as for a threshold.
    ///
    /// - `limit`: finite. `hint`: where it is thought to be nearest, from the second to the first.
    /// - `budget`: of work; what is used is taken off. Where it ends, so does the search, with the bound reached so far.
    pub(super) fn least(&mut self, limit: f64, hint: DVec3, budget: &mut usize) -> Least {
        let mut least = Least {
            lower: limit,
            seen: None,
        };
        self.threshold = below(limit, 0.0);
        let mut open = BinaryHeap::new();
        let (count, half) = self.cover();
        for number in 0..count {
            let window = self.open(f64::from(2 * number + 1) * half, half);
            if let Some(direction) = hint.try_normalize() {
                self.windows[window].remember(direction);
            }
            if let Some(task) = self.entered([0, 0], window, [-half, half]) {
                let bound = self.bound(&task);
                open.push(Ranked { bound, task });
            }
        }
        let mut next = Vec::new();
        let mut own = LEAST_BUDGET;
        while let Some(Ranked { bound, task }) = open.pop() {
            if bound > self.threshold {
                break;
            }
            if own == 0 && *budget == 0 {
                least.lower = least.lower.min(bound);
                return least;
            }
            own = own.saturating_sub(1);
            *budget = budget.saturating_sub(1);
            let [a, b] = [0, 1]
                .map(|which: usize| self.encounter.shapes[which].nodes[task.nodes[which] as usize]);
            if a.is_leaf() && b.is_leaf() && self.windows[task.window].reduced <= LONGEST {
                self.approach(task, [a.triangle, b.triangle], &mut least);
                own = own.saturating_sub(COURSE_WORK);
                *budget = budget.saturating_sub(COURSE_WORK);
                continue;
            }
            // Neither leaf pairs nor what is found matter here: they are divided or kept.
            self.divide(task, &mut next);
            for task in next.drain(..) {
                let bound = self.bound(&task);
                open.push(Ranked { bound, task });
            }
        }
        least.lower = least.lower.min(self.threshold);
        least
    }

    /// The box of a node over a window.
    fn moved(&self, which: usize, node: u32, window: usize) -> Moved {
        self.windows[window].frames[which].moved(&self.encounter.shapes[which].nodes[node as usize])
    }

    /// A lower bound of the distance during a task.
    fn bound(&self, task: &Task) -> f64 {
        let [a, b] = [0, 1].map(|which: usize| self.moved(which, task.nodes[which], task.window));
        let at = &self.windows[task.window];
        let nodes = [0, 1]
            .map(|which: usize| &self.encounter.shapes[which].nodes[task.nodes[which] as usize]);
        let longest = task.from.abs().max(task.to.abs());
        let along = at.axes.iter().chain(at.lately.iter().flatten());
        along
            .map(|axis| axis.gap(nodes, longest) - at.bulge - at.slack)
            .fold(at.gap(&a, &b, [task.from, task.to]), f64::max)
    }

    /// Brings the least distance that was seen below that of a pair, or certifies that the pair is not much nearer.
    fn approach(&mut self, task: Task, triangles: [u32; 2], least: &mut Least) {
        let at = &self.windows[task.window];
        let curves = self.curves(at, triangles);
        let mut pair = self.pair(at, &curves);
        let mut apart = None;
        let mut from = task.from;
        let mut threshold = self.threshold;
        // Less than the threshold only where that could not be certified.
        let mut certain = threshold;
        let mut seen = match &least.seen {
            Some((_, closest)) => closest.nearest.distance(),
            None => f64::INFINITY,
        };
        loop {
            pair.threshold = certain;
            match pair.course(from, task.to, f64::INFINITY) {
                Course::Apart(direction) => {
                    apart = direction;
                    least.lower = least.lower.min(certain);
                    break;
                }
                Course::Unknown(time) => {
                    // What cannot be certified at this distance may be at a smaller one.
                    certain *= 0.5;
                    if certain <= NEGLIGIBLE * pair.slack() {
                        least.lower = 0.0;
                        break;
                    }
                    from = time;
                }
                Course::Met(meeting) => {
                    let (time, near) = nearest_time(&pair, [meeting.after, task.to]);
                    let closest = Closest {
                        nearest: near,
                        triangles,
                    };
                    if near.distance() < seen {
                        seen = near.distance();
                        least.seen = Some(((at.middle + time).clamp(0.0, 1.0), closest));
                    }
                    threshold = threshold.min(below(near.distance(), pair.slack()));
                    if threshold <= 0.0 {
                        // Contact: nothing below rounding can be certified.
                        least.lower = 0.0;
                        break;
                    }
                    certain = certain.min(threshold);
                    from = meeting.after;
                }
            }
        }
        self.threshold = threshold;
        if let Some(direction) = apart {
            self.windows[task.window].remember(direction);
        }
    }

    /// What the planes of two triangles leave of a stretch of time.
    fn clipped(&self, at: &Window, triangles: [u32; 2], stretch: [f64; 2]) -> Clipped {
        let [a, b] = [0, 1].map(|which: usize| {
            self.encounter.shapes[which]
                .corners(triangles[which])
                .map(|corner| at.charts[which].pose.transform_point3(corner))
        });
        at.clipper
            .clip([&a, &b], self.threshold + at.slack, stretch)
    }

    fn curves(&self, at: &Window, triangles: [u32; 2]) -> [[Curve; 3]; 2] {
        [0, 1].map(|which: usize| {
            self.encounter.shapes[which]
                .corners(triangles[which])
                .map(|corner| at.charts[which].curve(corner))
        })
    }

    /// What is left of a stretch of a window during which two nodes may be closer than the threshold.
    fn entered(&self, nodes: [u32; 2], window: usize, stretch: [f64; 2]) -> Option<Task> {
        let [a, b] = [0, 1].map(|which: usize| self.moved(which, nodes[which], window));
        let [from, to] = self.windows[window].entered(&a, &b, self.threshold, stretch)?;
        Some(Task {
            nodes,
            window,
            from,
            to,
        })
    }

    fn refine(&mut self, task: Task, open: &mut Vec<Task>, earliest: &mut Earliest) {
        let shapes = self.encounter.shapes;
        let [a, b] = [0, 1].map(|which: usize| shapes[which].nodes[task.nodes[which] as usize]);
        let stretch = [task.from, task.to];
        if self.windows[task.window].separates([&a, &b], self.threshold, stretch) {
            return;
        }
        if a.is_leaf() && b.is_leaf() && self.windows[task.window].reduced <= LONGEST {
            self.meet(task, [a.triangle, b.triangle], earliest);
        } else {
            self.divide(task, open);
        }
    }

    /// Divides the window of a task, or one of its nodes; of the parts that are left the earliest is pushed last.
    fn divide(&mut self, task: Task, open: &mut Vec<Task>) {
        let shapes = self.encounter.shapes;
        let [a, b] = [0, 1].map(|which: usize| shapes[which].nodes[task.nodes[which] as usize]);
        let at = &self.windows[task.window];
        let sizes = [a, b].map(|node| node.half.max_element());
        let divides_time = (a.is_leaf() && b.is_leaf()) || {
            let spin = at.frames[0].spin * sizes[0] + at.frames[1].spin * sizes[1];
            let wobble = at.bulge + spin * at.half;
            wobble > WOBBLE * (sizes[0] + sizes[1]) && at.reduced > FINEST
        };
        if divides_time {
            let halves = self.halves(task.window);
            let quarter = 0.5 * self.windows[task.window].half;
            for (child, shift) in [(halves[1], -quarter), (halves[0], quarter)] {
                let from = (task.from + shift).max(-quarter);
                let to = (task.to + shift).min(quarter);
                if from <= to {
                    open.extend(self.entered(task.nodes, child, [from, to]));
                }
            }
            return;
        }
        let divided = usize::from(a.is_leaf() || (!b.is_leaf() && sizes[1] > sizes[0]));
        let whole = at.frames[1 - divided].moved(&[a, b][1 - divided]);
        let first = [a, b][divided].children;
        let mut pair = [first, first + 1].map(|child| {
            let part = at.frames[divided].moved(&shapes[divided].nodes[child as usize]);
            let stretch = [task.from, task.to];
            let [from, to] = if divided == 0 {
                at.entered(&part, &whole, self.threshold, stretch)
            } else {
                at.entered(&whole, &part, self.threshold, stretch)
            }?;
            let mut nodes = task.nodes;
            nodes[divided] = child;
            Some(Task {
                nodes,
                from,
                to,
                ..task
            })
        });
        if let [Some(one), Some(other)] = pair
            && one.from < other.from
        {
            pair.swap(0, 1);
        }
        open.extend(pair.into_iter().flatten());
    }

    /// The windows of both halves of a window.
    fn halves(&mut self, window: usize) -> [usize; 2] {
        if let Some(children) = self.windows[window].children {
            return children;
        }
        let (middle, half) = (self.windows[window].middle, 0.5 * self.windows[window].half);
        let children = [middle - half, middle + half].map(|middle| self.open(middle, half));
        for child in children {
            for axis in self.windows[window].lately.into_iter().flatten() {
                let direction = self.windows[window].turn * axis.direction;
                self.windows[child].remember(direction);
            }
        }
        self.windows[window].children = Some(children);
        children
    }

    fn meet(&mut self, task: Task, triangles: [u32; 2], earliest: &mut Earliest) {
        let at = &self.windows[task.window];
        let [from, to] = match self.clipped(at, triangles, [task.from, task.to]) {
            Clipped::Open(stretch) => stretch,
            Clipped::Apart(normal) => return self.windows[task.window].remember(normal),
        };
        let curves = self.curves(at, triangles);
        let pair = self.pair(at, &curves);
        let limit = earliest.bracket[1] - at.middle;
        match pair.course(from, to, limit) {
            Course::Apart(Some(direction)) => self.windows[task.window].remember(direction),
            Course::Apart(None) => {}
            Course::Unknown(time) => earliest.unknown = earliest.unknown.min(at.middle + time),
            Course::Met(mut meeting) => {
                for time in [&mut meeting.after, &mut meeting.time, &mut meeting.by] {
                    *time = (*time + at.middle).clamp(0.0, 1.0);
                }
                earliest.add(Found { meeting, triangles });
            }
        }
    }
}

/// Least |M| h of a window: cutting below would not make paths straighter than rounding does.
const FINEST: f64 = 1e-6;

/// The least distance is known to this part of itself.
const CLEARANCE_PRECISION: f64 = 1e-3;

/// Pairs of boxes that each search for a least distance may look at, whatever the others used.
const LEAST_BUDGET: usize = 2_000;

/// What following two triangles costs, in pairs of boxes.
const COURSE_WORK: usize = 20;

/// Errors of a distance by which a threshold has to be below one that was seen, to be certified.
const NEGLIGIBLE: f64 = 16.0;

/// What is not much below a distance that was seen: no more than that has to be certified.
fn below(distance: f64, slack: f64) -> f64 {
    distance - (CLEARANCE_PRECISION * distance).max(NEGLIGIBLE * slack)
}

/// A task by the distance that it may have; the least is the greatest of these, as a heap wants it.
struct Ranked {
    bound: f64,
    task: Task,
}

impl Ranked {
    fn key(&self) -> (f64, usize, [u32; 2]) {
        (self.bound, self.task.window, self.task.nodes)
    }
}

impl PartialEq for Ranked {
    fn eq(&self, other: &Ranked) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Ranked {}

impl PartialOrd for Ranked {
    fn partial_cmp(&self, other: &Ranked) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Ranked {
    fn cmp(&self, other: &Ranked) -> Ordering {
        let ((a, window_a, nodes_a), (b, window_b, nodes_b)) = (self.key(), other.key());
        b.total_cmp(&a)
            .then(window_b.cmp(&window_a))
            .then(nodes_b.cmp(&nodes_a))
    }
}

/// A time at which a pair is about as near as it gets during a stretch: samples, then golden sections. An upper bound of
/// the least distance, no more.
fn nearest_time(pair: &Pair, [from, to]: [f64; 2]) -> (f64, Nearest) {
    const SAMPLES: u32 = 8;
    const SECTIONS: u32 = 40;
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let at = |time: f64| (time, pair.nearest(time));
    let better = |a: (f64, Nearest), b: (f64, Nearest)| {
        if b.1.distance_squared < a.1.distance_squared {
            b
        } else {
            a
        }
    };
    let step = (to - from) / f64::from(SAMPLES);
    let mut best = at(from);
    for k in 1..=SAMPLES {
        best = better(best, at(from + step * f64::from(k)));
    }
    let (mut low, mut high) = ((best.0 - step).max(from), (best.0 + step).min(to));
    let mut inner = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)].map(at);
    for _ in 0..SECTIONS {
        if inner[0].1.distance_squared <= inner[1].1.distance_squared {
            high = inner[1].0;
            inner = [at(high - GOLDEN * (high - low)), inner[0]];
        } else {
            low = inner[0].0;
            inner = [inner[1], at(low + GOLDEN * (high - low))];
        }
        best = better(best, better(inner[0], inner[1]));
    }
    best
}
