//! Two trees of boxes, both in motion: from pairs of boxes over long windows to pairs of triangles over short ones.

use super::chart::{Chart, Curve, LONGEST, Mover};
use super::clip::Clipper;
use super::distance::{Closest, Still};
use super::nearest::Nearest;
use super::separation::{Course, Meeting, Pair};
use super::shape::{Node, Shape};
use glam::{DMat3, DVec3};
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
    frames: [Frame; 2],
    clipper: Clipper,
    children: Option<[usize; 2]>,
}

/// What boxes do in a window.
struct Frame {
    still: bool,
    pose: DMat3,
    /// Entry by entry.
    size: DMat3,
    /// Of M times the pose.
    spin: DMat3,
}

/// A box in the world over a window: centre, velocity, half the extent at rest, and by how much that grows per time.
struct Moved {
    centre: DVec3,
    velocity: DVec3,
    extent: DVec3,
    spread: DVec3,
}

impl Window {
    fn new(movers: &[Mover; 2], middle: f64, half: f64) -> Window {
        let reduced = half * (movers[0].size + movers[1].size);
        let charts = [0, 1].map(|which| movers[which].chart(middle, half, reduced));
        let frames = [0, 1].map(|which: usize| {
            let pose = charts[which].pose.matrix3;
            Frame {
                still: movers[which].rests() && pose == DMat3::IDENTITY,
                pose,
                size: pose.abs(),
                spin: (charts[which].generator.linear * pose).abs(),
            }
        });
        Window {
            middle,
            half,
            reduced,
            clipper: Clipper::new(
                [charts[0].generator, charts[1].generator],
                [movers[0].size, movers[1].size],
                half,
                [charts[0].stretch, charts[1].stretch],
            ),
            charts,
            frames,
            children: None,
        }
    }

    fn moved(&self, which: usize, node: &Node) -> Moved {
        let frame = &self.frames[which];
        if frame.still {
            return Moved {
                centre: node.centre + self.charts[which].pose.translation,
                velocity: DVec3::ZERO,
                extent: node.half,
                spread: DVec3::ZERO,
            };
        }
        let centre = frame.pose * node.centre + self.charts[which].pose.translation;
        Moved {
            centre,
            velocity: self.charts[which].generator.velocity(centre),
            extent: frame.size * node.half,
            spread: frame.spin * node.half,
        }
    }

    fn slack(&self) -> f64 {
        self.charts[0].slack + self.charts[1].slack
    }

    /// How far a path departs from its tangent within `time` of the middle.
    fn bulge(&self, time: f64) -> f64 {
        0.5 * time * time * (self.charts[0].acceleration + self.charts[1].acceleration)
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
        for window in self.cover() {
            let half = self.windows[window].half;
            if self.windows[window].middle - half > earliest.bracket[1] {
                break;
            }
            open.extend(self.entered([0, 0], window, -half, half));
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

    /// Windows that cover a stretch of time, the earliest first.
    fn cover(&mut self) -> Vec<usize> {
        let movers = &self.encounter.movers;
        let size = movers[0].size + movers[1].size;
        let count = (0.5 * size / WIDEST).ceil().max(1.0);
        let half = 0.5 / count;
        let mut number = 0.0;
        let mut all = Vec::new();
        while number < count {
            all.push(self.windows.len());
            self.windows
                .push(Window::new(movers, (2.0 * number + 1.0) * half, half));
            number += 1.0;
        }
        all
    }

    /// The least distance, if it is below `limit`.
    ///
    /// Boxes that may come nearest are looked at first. Wherever a pair is nearer than what was seen, its least distance is sought by
    /// sampling; that what is left is not much nearer is then certified as for a threshold.
    pub(super) fn least(&mut self, limit: f64) -> Least {
        let mut least = Least {
            lower: limit,
            seen: None,
        };
        self.threshold = limit;
        let mut open = BinaryHeap::new();
        for time in [0.0, 0.5, 1.0] {
            self.see(time, &mut least);
        }
        for window in self.cover() {
            let half = self.windows[window].half;
            if let Some(task) = self.entered([0, 0], window, -half, half) {
                let bound = self.bound(&task);
                open.push(Ranked { bound, task });
            }
        }
        let mut visits = 0;
        let mut next = Vec::new();
        while let Some(Ranked { bound, task }) = open.pop() {
            if bound > self.threshold {
                break;
            }
            visits += 1;
            if visits > MOST_VISITS {
                least.lower = least.lower.min(bound);
                return least;
            }
            let [a, b] = [0, 1]
                .map(|which: usize| self.encounter.shapes[which].nodes[task.nodes[which] as usize]);
            if a.is_leaf() && b.is_leaf() && self.windows[task.window].reduced <= LONGEST {
                self.approach(task, [a.triangle, b.triangle], &mut least);
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

    /// Takes the distance at a local time into account.
    fn see(&mut self, time: f64, least: &mut Least) {
        let limit = match &least.seen {
            Some((_, closest)) => closest.nearest.distance(),
            None => self.threshold,
        };
        if let Some(closest) = self.encounter.still(time).closest(limit) {
            least.seen = Some((time, closest));
            let slack = self.encounter.slack(time);
            self.threshold = self
                .threshold
                .min(below(closest.nearest.distance(), slack).max(0.0));
        }
    }

    /// A lower bound of the distance during a task.
    fn bound(&self, task: &Task) -> f64 {
        let at = &self.windows[task.window];
        let [a, b] = [0, 1].map(|which: usize| {
            at.moved(
                which,
                &self.encounter.shapes[which].nodes[task.nodes[which] as usize],
            )
        });
        let longest = task.to.abs().max(task.from.abs());
        let pad = at.bulge(longest) + at.slack();
        let extent = a.extent + b.extent + (a.spread + b.spread) * longest + pad;
        let (offset, velocity) = (a.centre - b.centre, a.velocity - b.velocity);
        let (start, end) = (offset + velocity * task.from, offset + velocity * task.to);
        // Along an axis the boxes stay apart by this much if they do not change sides.
        let apart = start.abs().min(end.abs());
        let apart = DVec3::select((start * end).cmpgt(DVec3::ZERO), apart, DVec3::ZERO);
        (apart - extent).max_element().max(0.0)
    }

    /// Brings the least distance that was seen below that of a pair, or certifies that the pair is not much nearer.
    fn approach(&mut self, task: Task, triangles: [u32; 2], least: &mut Least) {
        let at = &self.windows[task.window];
        let curves = self.curves(at, triangles);
        let mut pair = Pair {
            charts: [&at.charts[0], &at.charts[1]],
            curves: [&curves[0], &curves[1]],
            half: at.half,
            threshold: self.threshold,
        };
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
                Course::Apart => {
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
    }

    /// What the planes of two triangles leave of a stretch of time.
    fn clipped(&self, at: &Window, triangles: [u32; 2], stretch: [f64; 2]) -> Option<[f64; 2]> {
        let [a, b] = [0, 1].map(|which: usize| {
            self.encounter.shapes[which]
                .corners(triangles[which])
                .map(|corner| at.charts[which].pose.transform_point3(corner))
        });
        at.clipper
            .clip([&a, &b], self.threshold + at.slack(), stretch)
    }

    fn curves(&self, at: &Window, triangles: [u32; 2]) -> [[Curve; 3]; 2] {
        [0, 1].map(|which: usize| {
            self.encounter.shapes[which]
                .corners(triangles[which])
                .map(|corner| at.charts[which].curve(corner))
        })
    }

    /// The part of a stretch during which the boxes of two nodes may be closer than the threshold.
    fn entered(&self, nodes: [u32; 2], window: usize, from: f64, to: f64) -> Option<Task> {
        let at = &self.windows[window];
        let shapes = self.encounter.shapes;
        let [a, b] =
            [0, 1].map(|which| at.moved(which, &shapes[which].nodes[nodes[which] as usize]));
        let longest = to.abs().max(from.abs());
        let pad = at.bulge(longest) + self.threshold + at.slack();
        let extent = a.extent + b.extent + (a.spread + b.spread) * longest + pad;
        let offset = a.centre - b.centre;
        let velocity = a.velocity - b.velocity;
        let (mut from, mut to) = (from, to);
        for axis in 0..3 {
            let (reach, place, speed) = (extent[axis], offset[axis], velocity[axis]);
            if speed == 0.0 {
                if place.abs() > reach {
                    return None;
                }
                continue;
            }
            let (one, other) = ((-reach - place) / speed, (reach - place) / speed);
            from = from.max(one.min(other));
            to = to.min(one.max(other));
        }
        (from <= to).then_some(Task {
            nodes,
            window,
            from,
            to,
        })
    }

    fn refine(&mut self, task: Task, open: &mut Vec<Task>, earliest: &mut Earliest) {
        let shapes = self.encounter.shapes;
        let [a, b] = [0, 1].map(|which: usize| shapes[which].nodes[task.nodes[which] as usize]);
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
        let divides_time = (a.is_leaf() && b.is_leaf()) || {
            let longest = task.to.abs().max(task.from.abs());
            let spread = |which: usize, node: &Node| at.moved(which, node).spread.max_element();
            let wobble = at.bulge(longest) + (spread(0, &a) + spread(1, &b)) * longest;
            wobble > WOBBLE * (a.half.max_element() + b.half.max_element()) && at.reduced > FINEST
        };
        if divides_time {
            let halves = self.halves(task.window);
            let quarter = 0.5 * self.windows[task.window].half;
            for (child, shift) in [(halves[1], -quarter), (halves[0], quarter)] {
                let from = (task.from + shift).max(-quarter);
                let to = (task.to + shift).min(quarter);
                if from <= to {
                    open.extend(self.entered(task.nodes, child, from, to));
                }
            }
            return;
        }
        let size = |node: &Node| node.half.max_element();
        let divided = usize::from(a.is_leaf() || (!b.is_leaf() && size(&b) > size(&a)));
        let children = [a, b][divided].children;
        let mut pair = [children, children + 1].map(|child| {
            let mut nodes = task.nodes;
            nodes[divided] = child;
            self.entered(nodes, task.window, task.from, task.to)
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
        let children = [self.windows.len(), self.windows.len() + 1];
        for middle in [middle - half, middle + half] {
            self.windows
                .push(Window::new(&self.encounter.movers, middle, half));
        }
        self.windows[window].children = Some(children);
        children
    }

    fn meet(&mut self, task: Task, triangles: [u32; 2], earliest: &mut Earliest) {
        let at = &self.windows[task.window];
        let Some([from, to]) = self.clipped(at, triangles, [task.from, task.to]) else {
            return;
        };
        let curves = self.curves(at, triangles);
        let pair = Pair {
            charts: [&at.charts[0], &at.charts[1]],
            curves: [&curves[0], &curves[1]],
            half: at.half,
            threshold: self.threshold,
        };
        let limit = earliest.bracket[1] - at.middle;
        match pair.course(from, to, limit) {
            Course::Apart => {}
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
const CLEARANCE_PRECISION: f64 = 1e-6;

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
