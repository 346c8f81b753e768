//! The least distance of two moving shapes: the most promising boxes first, then triangles, with a
//! certified bound on the rest.

use super::chart::LONGEST;
use super::moving_pair::MovingPair;
use super::nearest::Nearest;
use super::orbit::Orbits;
use super::ranked::Ranked;
use super::search::{Search, Task};
use super::separation::{self, Course};
use crate::numeric::tolerance::CLEARANCE_PRECISION;
use crate::watch::{Interrupted, Items, Work};
use glam::DVec3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The least distance of two shapes over a stretch of the clock.
#[derive(Debug, Clone, Copy)]
pub(super) struct Least {
    /// A certain lower bound on the distance.
    pub(super) lower: f64,
    /// The least distance seen, or the limit.
    upper: f64,
    /// The local time at which a distance below the limit was seen, if any.
    pub(super) seen: Option<f64>,
    /// Whether the work ended before the bound was as sharp as intended.
    pub(super) is_limited: bool,
}

/// The least distance, if it is below `limit`.
///
/// Boxes that may come nearest are examined first. Wherever a pair is nearer than the least
/// distance seen, its own least distance is sought by sampling; then it is certified, as for a
/// threshold, that the rest is not much nearer. Where very many pairs come equally near, as in a
/// bearing, their orbits are compared instead.
///
/// - `limit`: finite. `hint`: the expected direction of the nearest points, from the second to the
///   first.
/// - `spare`: work beyond the allowance of each search; the work used is subtracted. When it is
///   used up, the search ends with the bound reached so far.
/// - `work`: the work of this search.
pub(super) fn of(
    search: &mut Search,
    limit: f64,
    hint: DVec3,
    spare: &mut usize,
    work: Work,
) -> Result<Least, Interrupted> {
    let mut least = Least {
        lower: limit,
        upper: limit,
        seen: None,
        is_limited: false,
    };
    search.threshold = below(limit, 0.0);
    let allowed = LEAST_BUDGET + *spare;
    let items = work.items(allowed);
    let unproven = unproven(search, hint, allowed, &mut least, &items)?;
    *spare -= search.work.saturating_sub(LEAST_BUDGET).min(*spare);
    if let Some(bound) = unproven {
        least.is_limited = true;
        least.lower = least.lower.min(bound);
    }
    least.lower = least.lower.min(search.threshold);
    Ok(least)
}

/// Searches until nothing is left that may be nearer than the threshold, or until the work ends:
/// then returns the bound on the rest.
///
/// Boxes and orbits take turns, each turn longer than the last, until one of them is done.
fn unproven(
    search: &mut Search,
    hint: DVec3,
    allowed: usize,
    least: &mut Least,
    items: &Items,
) -> Result<Option<f64>, Interrupted> {
    let triangles: usize = search
        .encounter
        .shapes
        .iter()
        .map(|shape| shape.len())
        .sum();
    let mut turn = ORBITS_AFTER * triangles.max(FEW);
    let mut boxes = all(search, hint);
    let mut paths = Candidates::default();
    paths.push(0.0, Candidate::Orbits(Orbits::WHOLE));
    let mut orbits = None;
    let mut proven = 0.0;
    loop {
        let until = allowed.min(search.work + turn);
        let Some(rest) = drain(search, &mut boxes, None, least, until, items)? else {
            return Ok(None);
        };
        proven = rest.max(proven);
        if search.work >= allowed {
            return Ok(Some(proven));
        }
        let allowance = NEGLIGIBLE_ORBITS * search.threshold;
        if let Some(orbits) = orbits.get_or_insert_with(|| Orbits::new(search.encounter, allowance))
        {
            let until = allowed.min(search.work + turn / ORBITS_SHARE);
            let rest = drain(search, &mut paths, Some(orbits), least, until, items)?;
            // Of turns that repeat themselves only one is examined; they repeat within rounding.
            least.lower = least.lower.min(search.threshold - orbits.slack);
            let Some(rest) = rest else {
                return Ok(None);
            };
            proven = rest.max(proven);
        }
        turn *= 2;
    }
}

/// Tasks for both shapes in every window.
fn all(search: &mut Search, hint: DVec3) -> Candidates {
    let count = search.encounter.cover();
    let half = 0.5 / f64::from(count);
    let mut open = Candidates::default();
    for number in 0..count {
        let window = search.open(f64::from(2 * number + 1) * half, half);
        if let Some(direction) = hint.try_normalize() {
            search.windows[window].remember(direction);
        }
        if let Some(task) = search.entered([0, 0], window, [-half, half]) {
            open.push(lower_bound(search, &task), Candidate::Boxes(task));
        }
    }
    open
}

/// Examines the candidates that may come nearest until none is left that may come nearer than the
/// threshold. Where the work ends before that, returns the bound on the rest.
fn drain(
    search: &mut Search,
    open: &mut Candidates,
    mut orbits: Option<&mut Orbits>,
    least: &mut Least,
    allowed: usize,
    items: &Items,
) -> Result<Option<f64>, Interrupted> {
    let mut counted = search.work;
    let mut next = Vec::new();
    while let Some(Ranked { item, .. }) = open.items.pop() {
        items.advance(search.work - counted)?;
        counted = search.work;
        let (bound, item) = item;
        if bound > search.threshold {
            continue;
        }
        if search.work >= allowed {
            let rest = open.items.iter().map(|ranked| ranked.item.0);
            return Ok(Some(rest.fold(bound, f64::min)));
        }
        search.work += 1;
        match (item, &mut orbits) {
            (Candidate::Boxes(task), _) => {
                let [a, b] = [0, 1].map(|which: usize| {
                    search.encounter.shapes[which].nodes[task.nodes[which] as usize]
                });
                if a.is_leaf() && b.is_leaf() && search.windows[task.window].reduced <= LONGEST {
                    approach(search, task, [a.triangle, b.triangle], least);
                    search.work += PAIR_WORK;
                    continue;
                }
                // The pairs of leaves are treated like the others here: they are divided or kept.
                search.divide(task, &mut next);
            }
            (Candidate::Orbits(bundles), Some(orbits)) => {
                let before = orbits.work;
                match orbits.triangles(bundles) {
                    Some(triangles) => {
                        let across = search.threshold * search.threshold - bound * bound;
                        let reach = across.max(0.0).sqrt();
                        for stretch in orbits.times(triangles, reach) {
                            enter(search, triangles, stretch, &mut next);
                        }
                    }
                    None => {
                        for part in orbits.divide(bundles) {
                            let apart = orbits.bound(part, search.threshold).max(bound);
                            if apart <= search.threshold {
                                open.push(apart, Candidate::Orbits(part));
                            }
                        }
                    }
                }
                search.work += (orbits.work - before) / BOUNDING_SHARE;
            }
            (Candidate::Orbits(_), None) => {}
        }
        for task in next.drain(..) {
            let apart = lower_bound(search, &task).max(bound);
            if apart <= search.threshold {
                open.push(apart, Candidate::Boxes(task));
            }
        }
    }
    Ok(None)
}

/// Tasks for two triangles during a stretch of local time, window by window.
///
/// The first windows of the search must be those that [`all`] opened: their numbers are their
/// places in time.
fn enter(search: &Search, triangles: [u32; 2], [from, to]: [f64; 2], into: &mut Vec<Task>) {
    let count = search.encounter.cover();
    let half = 0.5 / f64::from(count);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped"
    )]
    let window = |time: f64| ((time / (2.0 * half)) as usize).min(count as usize - 1);
    let nodes = [0, 1].map(|which: usize| search.encounter.shapes[which].leaf(triangles[which]));
    for number in window(from)..=window(to) {
        let middle = search.windows[number].middle;
        debug_assert!(
            middle == (2 * number + 1) as f64 * half,
            "the windows of the whole time come first"
        );
        let stretch = [from - middle, to - middle].map(|time| time.clamp(-half, half));
        into.extend(search.entered(nodes, number, stretch));
    }
}

/// A lower bound of the distance during a task.
fn lower_bound(search: &Search, task: &Task) -> f64 {
    let [a, b] = [0, 1].map(|which: usize| search.moved(which, task.nodes[which], task.window));
    let at = &search.windows[task.window];
    let nodes = [0, 1]
        .map(|which: usize| &search.encounter.shapes[which].nodes[task.nodes[which] as usize]);
    let longest = task.from.abs().max(task.to.abs());
    let along = at.axes.iter().chain(&at.lately);
    along
        .map(|axis| axis.gap(nodes, longest) - at.slack)
        .fold(at.gap(&a, &b, [task.from, task.to]), f64::max)
}

/// Lowers the least distance seen to that of a pair, or certifies that the pair is not much nearer.
fn approach(search: &mut Search, task: Task, triangles: [u32; 2], least: &mut Least) {
    // Most pairs are always farther apart, which is soon found.
    let Some([mut from, to]) = search.doubtful(&task, triangles) else {
        return;
    };
    search.work += COURSE_WORK;
    let at = &search.windows[task.window];
    let curves = search.curves(at, triangles);
    let mut pair = search.pair(at, &curves);
    let mut apart = None;
    let mut threshold = search.threshold;
    // Less than the threshold only where the threshold could not be certified.
    let mut certain = threshold;
    loop {
        pair.threshold = certain;
        match separation::course(&pair, from, to, f64::INFINITY) {
            Course::Apart(direction) => {
                apart = direction;
                least.lower = least.lower.min(certain);
                break;
            }
            Course::Unknown(time) => {
                // If this distance cannot be certified, a smaller one may be.
                certain *= 0.5;
                if certain <= NEGLIGIBLE * pair.slack() {
                    least.lower = 0.0;
                    break;
                }
                from = time;
            }
            Course::Met(meeting) => {
                let (time, near) = nearest_time(&pair, [meeting.after, to]);
                if near.distance() < least.upper {
                    least.upper = near.distance();
                    least.seen = Some((at.middle + time).clamp(0.0, 1.0));
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
    search.threshold = threshold;
    if let Some(direction) = apart {
        search.windows[task.window].remember(direction);
    }
}

/// Pairs of boxes that each search for a least distance may examine, whatever the others used.
const LEAST_BUDGET: usize = 2_000;

/// Number of pairs of boxes per triangle, for at least this many triangles, after which orbits are
/// compared: preparing them takes about as long.
const ORBITS_AFTER: usize = 4;
const FEW: usize = 5_000;

/// Orbits get one part in this many of the work that boxes get.
const ORBITS_SHARE: usize = 4;

/// Error of a distance of orbits, as a fraction of the distance, up to which orbits are useful.
const NEGLIGIBLE_ORBITS: f64 = 0.1 * CLEARANCE_PRECISION;

/// Number of triangles that are bounded with the work of one pair of boxes.
const BOUNDING_SHARE: usize = 2;

/// Cost of comparing two triangles, and of following them, in pairs of boxes.
const PAIR_WORK: usize = 4;
const COURSE_WORK: usize = 16;

/// Number of errors of a distance by which a threshold must be below a distance seen, to be
/// certified.
const NEGLIGIBLE: f64 = 16.0;

/// A distance slightly below one that was seen: no more than that must be certified.
fn below(distance: f64, slack: f64) -> f64 {
    distance - (CLEARANCE_PRECISION * distance).max(NEGLIGIBLE * slack)
}

/// The candidates that are left to examine, by the distance that they may have.
#[derive(Default)]
struct Candidates {
    items: BinaryHeap<Ranked<Rank, (f64, Candidate)>>,
    pushed: u64,
}

impl Candidates {
    fn push(&mut self, bound: f64, item: Candidate) {
        self.pushed += 1;
        self.items.push(Ranked {
            key: key(bound, self.pushed),
            item: (bound, item),
        });
    }
}

#[derive(Clone, Copy)]
enum Candidate {
    /// Two boxes during a stretch of time.
    Boxes(Task),
    /// Two bundles of orbits, at all times.
    Orbits([u32; 2]),
}

/// The order in which a heap gives items: the least bound first, and among nearly equal ones the
/// last.
type Rank = (Reverse<u64>, u64);

/// Bounds that agree to one part in some thousands count as equal: the candidate divided last is
/// nearest to an answer.
fn key(bound: f64, number: u64) -> Rank {
    (Reverse(bound.max(0.0).to_bits() >> COARSE), number)
}

/// Bits of a bound that do not count in the order.
const COARSE: u32 = 41;

/// A time at which a pair is about as near as it gets during a stretch, by samples and then golden
/// sections. This gives only an upper bound of the least distance.
fn nearest_time(pair: &MovingPair, [from, to]: [f64; 2]) -> (f64, Nearest) {
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

#[cfg(test)]
mod tests {
    use super::super::encounter::Encounter;
    use super::super::mover::Mover;
    use super::super::shape::Shape;
    use super::*;
    use crate::body::Surface;
    use crate::motion::{Flow, Generator};
    use glam::DAffine3;
    use std::f64::consts::{PI, TAU};

    /// A prism with regular ends, and a similar hole.
    fn tube(sides: u32, radii: [f64; 2]) -> Shape {
        let corners = [
            (radii[0], 0.0),
            (radii[1], 0.0),
            (radii[1], 1.0),
            (radii[0], 1.0),
        ];
        let mut positions = Vec::new();
        let mut triangles = Vec::new();
        for j in 0..sides {
            let (sin, cos) = (TAU * f64::from(j) / f64::from(sides)).sin_cos();
            positions.extend(corners.map(|(r, z)| DVec3::new(r * cos, r * sin, z)));
            let next = (j + 1) % sides;
            for k in 0..4 {
                let (a, b) = (4 * j + k, 4 * j + (k + 1) % 4);
                let (c, d) = (4 * next + k, 4 * next + (k + 1) % 4);
                triangles.extend([[a, c, d], [a, d, b]]);
            }
        }
        Shape::new(&Surface::new(positions, triangles).expect("a surface"))
    }

    #[test]
    fn a_shaft_of_many_sides_takes_work_by_the_side() {
        let flow = Flow::new(Generator::screw(DVec3::Z, DVec3::ZERO, TAU, 0.0, 1.0));
        for sides in [40, 160, 640, 2560] {
            let shapes = [tube(sides, [0.5, 3.8]), tube(sides, [4.0, 5.0])];
            let movers = [
                Mover::moving(&flow, [0.0, 1.0], DAffine3::IDENTITY, shapes[0].bounds()),
                Mover::resting(DAffine3::IDENTITY, shapes[1].bounds()),
            ];
            let encounter = Encounter::new([&shapes[0], &shapes[1]], movers);
            let expected = 4.0 * (PI / f64::from(sides)).cos() - 3.8;
            let mut search = Search::new(&encounter, 0.0);
            let least = of(
                &mut search,
                1.0,
                DVec3::ZERO,
                &mut 10_000_000,
                Work::UNWATCHED,
            )
            .expect("nobody stops it");
            assert!(
                least.lower > 0.9985 * expected && least.lower <= expected && !least.is_limited,
                "{sides} sides: {} for {expected}",
                least.lower
            );
            // One turn of the boxes; and of the orbits, each triangle at most once at every level
            // of its tree.
            let triangles = shapes[0].len() + shapes[1].len();
            let levels = usize::BITS - triangles.leading_zeros();
            let most = ORBITS_AFTER * triangles.max(FEW) + 4 * triangles * levels as usize;
            assert!(
                search.work < most,
                "{sides} sides: {} of {most}",
                search.work
            );
        }
    }
}
