//! Two trees of boxes, both in motion: from pairs of boxes over long windows to pairs of triangles over short ones.

use super::chart::{Chart, LONGEST, Mover};
use super::separation::{Course, Meeting, Pair};
use super::shape::{Node, Shape};
use glam::{DMat3, DVec3};

/// Two shapes on their ways over one stretch of the clock; local time runs from 0 to 1.
pub(super) struct Encounter<'a> {
    pub(super) shapes: [&'a Shape; 2],
    pub(super) movers: [Mover; 2],
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
        let movers = &self.encounter.movers;
        let size = movers[0].size + movers[1].size;
        let count = (0.5 * size / WIDEST).ceil().max(1.0);
        let mut visits = 0;
        let mut number = 0.0;
        let mut open = Vec::new();
        while number < count {
            let (start, end) = (number / count, (number + 1.0) / count);
            number += 1.0;
            if start > earliest.bracket[1] {
                break;
            }
            let half = 0.5 * (end - start);
            self.windows.clear();
            self.windows.push(Window::new(movers, start + half, half));
            open.clear();
            open.extend(self.entered([0, 0], 0, -half, half));
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
            }
        }
        earliest
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
        let at = &self.windows[task.window];
        let leaves = a.is_leaf() && b.is_leaf();
        let divides = if leaves {
            at.reduced > LONGEST
        } else {
            let longest = task.to.abs().max(task.from.abs());
            let spread = |which: usize, node: &Node| at.moved(which, node).spread.max_element();
            let wobble = at.bulge(longest) + (spread(0, &a) + spread(1, &b)) * longest;
            wobble > WOBBLE * (a.half.max_element() + b.half.max_element()) && at.reduced > FINEST
        };
        if divides {
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
        if leaves {
            return self.meet(task, [a.triangle, b.triangle], earliest);
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
        let shapes = self.encounter.shapes;
        let curves = [0, 1].map(|which: usize| {
            shapes[which]
                .corners(triangles[which])
                .map(|corner| at.charts[which].curve(corner))
        });
        let pair = Pair {
            charts: [&at.charts[0], &at.charts[1]],
            curves: [&curves[0], &curves[1]],
            half: at.half,
            threshold: self.threshold,
        };
        let limit = earliest.bracket[1] - at.middle;
        match pair.course(task.from, task.to, limit) {
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
