//! The least distance of two moving shapes: the best boxes first, then triangles, with a certified bound of what is left.

use super::chart::LONGEST;
use super::descent::{Search, Task};
use super::distance::Closest;
use super::nearest::Nearest;
use super::separation::{Course, Pair};
use glam::DVec3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// The least distance of two shapes over a stretch of the clock.
#[derive(Debug, Clone, Copy)]
pub(super) struct Least {
    /// Nowhere less, for certain.
    pub(super) lower: f64,
    /// Where it was seen: local time and nearest triangles; `None` if nothing came below the limit.
    pub(super) seen: Option<(f64, Closest)>,
}

impl Search<'_> {
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
        let count = self.encounter.cover();
        let half = 0.5 / f64::from(count);
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

    /// A lower bound of the distance during a task.
    fn bound(&self, task: &Task) -> f64 {
        let [a, b] = [0, 1].map(|which: usize| self.moved(which, task.nodes[which], task.window));
        let at = &self.windows[task.window];
        let nodes = [0, 1]
            .map(|which: usize| &self.encounter.shapes[which].nodes[task.nodes[which] as usize]);
        let longest = task.from.abs().max(task.to.abs());
        let along = at.axes.iter().chain(&at.lately);
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
}

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
