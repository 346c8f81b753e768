//! Two moving trees of boxes: from pairs of boxes over long windows to pairs of triangles over
//! short ones.

use super::chart::{Chart, LONGEST};
use super::clip::Clipped;
use super::crossing::Meeting;
use super::encounter::Encounter;
use super::moving_pair::MovingPair;
use super::separation::{self, Clearing, Course};
use super::shape::ShapeNode;
use super::window::{Moved, Window};
use crate::motion::expansion::Curve;

/// A meeting of two triangles.
#[derive(Debug, Clone, Copy)]
pub(super) struct FoundMeeting {
    /// The meeting, in local times.
    pub(super) meeting: Meeting,
    pub(super) triangles: [u32; 2],
}

/// The result of a search for the first meeting.
#[derive(Debug, Clone, Copy)]
pub(super) struct Earliest {
    /// The first meeting, by time, then by triangles.
    pub(super) found: Option<FoundMeeting>,
    /// Nothing is closer than the threshold before the first of these times; something is by the
    /// second one.
    pub(super) bracket: [f64; 2],
    /// The time from which on there are pairs about which nothing is known.
    pub(super) unknown: f64,
    /// Number of pairs of boxes examined.
    pub(super) visits: usize,
}

impl Earliest {
    fn none() -> Earliest {
        Earliest {
            found: None,
            bracket: [f64::INFINITY, 1.0],
            unknown: f64::INFINITY,
            visits: 0,
        }
    }

    fn add(&mut self, found: FoundMeeting) {
        let key = |f: &FoundMeeting| (f.meeting.time, f.triangles);
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

/// Most pairs of boxes that one search examines, some 10 s of work; beyond, it is undecided.
pub(super) const MOST_VISITS: usize = 200_000_000;

/// Fraction of a window after a meeting that is still examined: rounding must not cut off another
/// meeting at the same time.
const ROOM: f64 = 1e-6;

/// Number of pairs of boxes between two tests of whether the search is still wanted.
const ASKING: usize = 1024;

/// Windows are cut rather than boxes while the path of a box departs from a straight one by more
/// than this fraction of the size of the boxes.
const WOBBLE: f64 = 0.1;

/// Two nodes during a stretch of a window; times are relative to its middle.
#[derive(Clone, Copy)]
pub(super) struct Task {
    pub(super) nodes: [u32; 2],
    pub(super) window: usize,
    pub(super) from: f64,
    pub(super) to: f64,
}

/// The search for the first time at which two shapes come closer than a threshold.
pub(super) struct Search<'a> {
    pub(super) encounter: &'a Encounter<'a>,
    pub(super) windows: Vec<Window>,
    pub(super) threshold: f64,
    /// Number of pairs of boxes that a search for the least distance examined, or equivalent work.
    pub(super) work: usize,
}

impl<'a> Search<'a> {
    pub(super) fn new(encounter: &'a Encounter<'a>, threshold: f64) -> Search<'a> {
        Search {
            encounter,
            windows: Vec::new(),
            threshold,
            work: 0,
        }
    }

    /// The first meeting in the window around `middle`.
    ///
    /// - `most`: most pairs of boxes to examine; `None` when they do not suffice, unless that is
    ///   [`MOST_VISITS`]: then it is undecided.
    /// - `is_late`: called now and then to test whether the answer is no longer wanted.
    pub(super) fn first(
        &mut self,
        [middle, half]: [f64; 2],
        most: usize,
        is_late: &dyn Fn() -> bool,
    ) -> Option<Earliest> {
        let mut earliest = Earliest::none();
        let window = self.open(middle, half);
        let mut open = Vec::from_iter(self.entered([0, 0], window, [-half, half]));
        while let Some(mut task) = open.pop() {
            let Window { middle, half, .. } = self.windows[task.window];
            // Later events than a meeting do not matter.
            let limit = earliest.bracket[1] - middle;
            if task.from > limit {
                continue;
            }
            task.to = task.to.min(limit + ROOM * half);
            earliest.visits += 1;
            if earliest.visits.is_multiple_of(ASKING) && is_late() {
                return None;
            }
            if earliest.visits >= most {
                if most < MOST_VISITS {
                    return None;
                }
                let rest = open.iter().chain([&task]);
                let first = rest.map(|task| self.windows[task.window].middle + task.from);
                earliest.unknown = first.fold(earliest.unknown, f64::min);
                break;
            }
            self.refine(task, &mut open, &mut earliest);
            if earliest.bracket[1] <= 0.0 {
                // Nothing is earlier than the start.
                break;
            }
        }
        Some(earliest)
    }

    pub(super) fn pair<'b>(&self, at: &'b Window, curves: &'b [[Curve; 3]; 2]) -> MovingPair<'b> {
        MovingPair {
            charts: [&at.charts[0], &at.charts[1]],
            curves: [&curves[0], &curves[1]],
            half: at.half,
            threshold: self.threshold,
        }
    }

    /// Opens a new window.
    pub(super) fn open(&mut self, middle: f64, half: f64) -> usize {
        self.windows.push(Window::new(self.encounter, middle, half));
        self.windows.len() - 1
    }

    /// The box of a node over a window.
    pub(super) fn moved(&self, which: usize, node: u32, window: usize) -> Moved {
        self.windows[window].frames[which].moved(&self.encounter.shapes[which].nodes[node as usize])
    }

    /// The result of trimming a stretch of time by the planes of two triangles.
    pub(super) fn clipped(&self, at: &Window, triangles: [u32; 2], stretch: [f64; 2]) -> Clipped {
        let [a, b] = [0, 1].map(|which: usize| {
            self.encounter.shapes[which]
                .corners(triangles[which])
                .map(|corner| at.charts[which].pose.transform_point3(corner))
        });
        at.clipper
            .clip([&a, &b], self.threshold + at.slack, stretch)
    }

    pub(super) fn curves(&self, at: &Window, triangles: [u32; 2]) -> [[Curve; 3]; 2] {
        self.drawn([&at.charts[0], &at.charts[1]], triangles)
    }

    fn drawn(&self, charts: [&Chart; 2], triangles: [u32; 2]) -> [[Curve; 3]; 2] {
        let mut curves = [[Curve::ORIGIN; 3]; 2];
        for which in [0, 1] {
            let corners = self.encounter.shapes[which].corners(triangles[which]);
            for (curve, corner) in curves[which].iter_mut().zip(corners) {
                charts[which].draw(corner, curve);
            }
        }
        curves
    }

    /// The part of a stretch of a window during which two nodes may be closer than the threshold.
    pub(super) fn entered(
        &self,
        nodes: [u32; 2],
        window: usize,
        stretch: [f64; 2],
    ) -> Option<Task> {
        let [a, b] = [0, 1].map(|which: usize| self.moved(which, nodes[which], window));
        let [from, to] = self.windows[window].entered(&a, &b, self.threshold, stretch)?;
        Some(Task {
            nodes,
            window,
            from,
            to,
        })
    }

    fn nodes(&self, task: &Task) -> [&'a ShapeNode; 2] {
        let shapes = self.encounter.shapes;
        [0, 1].map(|which: usize| &shapes[which].nodes[task.nodes[which] as usize])
    }

    fn refine(&mut self, task: Task, open: &mut Vec<Task>, earliest: &mut Earliest) {
        let [a, b] = self.nodes(&task);
        let stretch = [task.from, task.to];
        if self.windows[task.window].separates([a, b], self.threshold, stretch) {
            return;
        }
        if a.is_leaf() && b.is_leaf() && self.windows[task.window].reduced <= LONGEST {
            self.meet(task, [a.triangle, b.triangle], earliest);
        } else {
            self.divide(task, open);
        }
    }

    /// Divides the window of a task, or one of its nodes; of the remaining parts, the earliest is
    /// pushed last.
    pub(super) fn divide(&mut self, task: Task, open: &mut Vec<Task>) {
        let shapes = self.encounter.shapes;
        let [a, b] = self.nodes(&task);
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
        let whole = at.frames[1 - divided].moved([a, b][1 - divided]);
        let first = [a, b][divided].children;
        let before = open.len();
        for child in [first, first + 1] {
            let part = at.frames[divided].moved(&shapes[divided].nodes[child as usize]);
            let stretch = [task.from, task.to];
            if let Some([from, to]) = at.entered(&part, &whole, self.threshold, stretch) {
                let mut nodes = task.nodes;
                nodes[divided] = child;
                open.push(Task {
                    nodes,
                    from,
                    to,
                    ..task
                });
            }
        }
        if let [one, other] = &mut open[before..]
            && one.from < other.from
        {
            std::mem::swap(one, other);
        }
    }

    /// The windows of both halves of a window.
    fn halves(&mut self, window: usize) -> [usize; 2] {
        if let Some(children) = self.windows[window].children {
            return children;
        }
        let (middle, half) = (self.windows[window].middle, 0.5 * self.windows[window].half);
        let children = [middle - half, middle + half].map(|middle| self.open(middle, half));
        for child in children {
            for axis in self.windows[window].lately.clone() {
                let direction = self.windows[window].turn * axis.direction;
                self.windows[child].remember(direction);
            }
        }
        self.windows[window].children = Some(children);
        children
    }

    /// The stretch during which paths of few terms show two triangles to be apart.
    fn clear(&self, at: &Window, triangles: [u32; 2], [from, to]: [f64; 2]) -> Clearing {
        let coarse = at.coarse();
        let charts = [&coarse[0], &coarse[1]];
        let curves = self.drawn(charts, triangles);
        let pair = MovingPair {
            charts,
            ..self.pair(at, &curves)
        };
        separation::clear_until(&pair, from, to)
    }

    /// The part of the time of a task during which quick tests do not show two triangles to be
    /// apart; `None` if there is no such part: the window then remembers the direction.
    pub(super) fn doubtful(&mut self, task: &Task, triangles: [u32; 2]) -> Option<[f64; 2]> {
        let at = &self.windows[task.window];
        let direction = match self.clipped(at, triangles, [task.from, task.to]) {
            Clipped::Open([from, to]) => {
                let clear = self.clear(at, triangles, [from, to]);
                if clear.placed.is_some() {
                    return Some([clear.until, to]);
                }
                clear.normal
            }
            Clipped::Apart(normal) => normal,
        };
        self.windows[task.window].remember(direction);
        None
    }

    fn meet(&mut self, task: Task, triangles: [u32; 2], earliest: &mut Earliest) {
        let Some([from, to]) = self.doubtful(&task, triangles) else {
            return;
        };
        let at = &self.windows[task.window];
        let curves = self.curves(at, triangles);
        let pair = self.pair(at, &curves);
        let limit = earliest.bracket[1] - at.middle;
        match separation::course(&pair, from, to, limit) {
            Course::Apart(Some(direction)) => self.windows[task.window].remember(direction),
            Course::Apart(None) => {}
            Course::Unknown(time) => earliest.unknown = earliest.unknown.min(at.middle + time),
            Course::Met(mut meeting) => {
                for time in [&mut meeting.after, &mut meeting.time, &mut meeting.by] {
                    *time = (*time + at.middle).clamp(0.0, 1.0);
                }
                earliest.add(FoundMeeting { meeting, triangles });
            }
        }
    }
}

/// Least |M| h of a window: further cutting would not make paths straighter than rounding does.
const FINEST: f64 = 1e-6;
