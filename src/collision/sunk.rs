//! The first time at which a surface is somewhere deeper in a solid than allowed.
//!
//! The trees descend over short windows of time to the triangles that come near the solid's
//! surface; parts that do not come near it are inside or outside as a whole. A triangle that comes
//! near is followed: it is pushed out (`push`) for as long as that is certified, and then in
//! another direction. Where no direction leads out any more, its deepest point is sought. If it is
//! as deep as allowed, the time when it is certainly deeper ends the search. Otherwise the triangle
//! is cut where two faces of the solid are equally near, or in half, and its parts are followed.
//!
//! Parts of the surface that never reach the innermost part of the solid (`innermost`) are skipped.
//!
//! - A piece is certified to be shallow by pushes as long as the allowed depth; where the depth
//!   equals that for some time, pushes longer by a few errors of position ([`DEPTH_ROOM`]) are
//!   accepted, so that there is always an answer.
//! - A point is deep when it is inside the solid, and farther from its surface than the depth plus
//!   rounding.

use super::Limited;
use super::chart::LONGEST;
use super::depth::PlacedSolid;
use super::innermost;
use super::push::{Near, Pushing, Surroundings};
use super::ranked::Ranked;
use super::shape::ShapeNode;
use super::sinking::{CERTAIN, Deep, Sinking};
use super::triangle_piece::{TrianglePiece, blend, lowest};
use super::window::{Moved, Window};
use crate::numeric::Ordered;
use crate::numeric::tolerance::{DEPTH_ROOM, ROOT_RESOLUTION};
use glam::DVec3;
use rayon::prelude::*;
use std::cell::Cell;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The result of a search, in local times.
#[derive(Debug, Clone, Copy)]
pub(super) enum Sunk {
    /// It is nowhere deeper.
    Never,
    /// It is not deeper before the first time, and is deeper at the second one.
    First { bracket: [f64; 2], deep: Deep },
    /// It is not deeper before this time; then work or precision ran out.
    Unknown(f64, Limited),
}

/// Number of windows that are searched at once: a few, since nothing after the first find is of
/// use.
const BATCH: u32 = 8;

/// Most windows of a search.
const MOST_WINDOWS: f64 = 1e7;

/// Number of windows of a search above which the total work in all of them is limited; that limit,
/// some seconds; and the work that is counted for each window at least, about that of an idle one.
const MANY_WINDOWS: u32 = 10_000;
const MOST_WORK_IN_ALL: usize = 2_000_000;
const WINDOW_WORK: usize = 1;

/// Work in one window, as a multiple of that on one of its triangles.
const TRIANGLES: usize = 4;

/// Steps of work (pushes followed, points sounded) on one triangle in one window, a second or so;
/// and more of them for each triangle.
const MOST_WORK: usize = 40_000;
const MOST_WORK_EACH: usize = 16;

/// Approximate number of triangles that are examined in one step of work, and of pairs of boxes
/// that are as much work as one of them.
const STEP: usize = 64;
const BOXES: usize = 8;

/// Most directions in which one piece is pushed before it is cut.
const MOST_STEPS: usize = 200;

/// Most nested cuts of one triangle, each at another time, and at one time.
const MOST_CUTS: u32 = 100;
const MOST_STUCK: u32 = 120;

/// Number of parts of a triangle that are followed before it is taken as a whole again, and the
/// multiple of the number into which it had to be cut at once.
const FEW_PARTS: usize = 64;
const MANY_TIMES: usize = 8;

/// Fraction of the requested time for which a bound on the depth must hold.
const SLOW: f64 = 1e-2;

/// Width of a bracket, in local time, that is narrow enough.
const NARROW: f64 = 1e-12;

/// The number of windows of a search; `None` when there are too many.
fn windows(sinking: &Sinking) -> Option<u32> {
    let size = sinking.encounter.movers[0].size + sinking.encounter.movers[1].size;
    let needed = (0.5 * size / LONGEST)
        .ceil()
        .max(f64::from(sinking.encounter.cover()));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "within the limit"
    )]
    (needed <= MOST_WINDOWS).then_some(needed as u32)
}

/// The total work that searches of this encounter may do.
pub(super) fn allowance(sinking: &Sinking) -> usize {
    match windows(sinking) {
        Some(count) if count <= MANY_WINDOWS => usize::MAX,
        _ => MOST_WORK_IN_ALL,
    }
}

/// The first time from `from` on.
///
/// - `spare`: work that may be done; the work done is subtracted.
pub(super) fn first(sinking: &Sinking, from: f64, spare: &mut usize) -> Sunk {
    let Some(count) = windows(sinking) else {
        return Sunk::Unknown(from, Limited::Work);
    };
    let Some(innermost) = innermost::around(sinking.encounter, 1 - sinking.surface, sinking.depth)
    else {
        return Sunk::Never;
    };
    let half = 0.5 / f64::from(count);
    let middle = |number: u32| f64::from(2 * number + 1) * half;
    let window = |number: u32| {
        let start = (from - middle(number)).max(-half);
        if start >= half {
            return (Sunk::Never, 0);
        }
        WindowSearch::new(sinking, innermost, middle(number), half).run(start)
    };
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "at most the number of windows"
    )]
    let mut number = ((from * f64::from(count)) as u32).saturating_sub(1);
    while number < count {
        if *spare == 0 || sinking.encounter.work.check().is_err() {
            let start = (middle(number) - half).clamp(from, 1.0);
            return Sunk::Unknown(start, Limited::Work);
        }
        let end = (number + BATCH).min(count);
        let found: Vec<_> = (number..end).into_par_iter().map(window).collect();
        for (sunk, work) in found {
            *spare = spare.saturating_sub(WINDOW_WORK + work);
            if !matches!(sunk, Sunk::Never) {
                return sunk;
            }
        }
        number = end;
    }
    Sunk::Never
}

/// The search in one window; times are relative to its middle.
struct WindowSearch<'a> {
    sinking: &'a Sinking<'a>,
    /// A box around the part of the solid that is deep enough.
    innermost: ShapeNode,
    at: Window,
    findings: Findings,
    /// Number of triangles examined, the limit for one triangle, and the number up to which the
    /// current one may go on.
    work: Cell<usize>,
    most_work: usize,
    limit: usize,
    last: DVec3,
}

/// What is known about the first time in a window.
struct Findings {
    /// Certainly not deeper before this time.
    after: f64,
    /// Deeper at this time.
    by: f64,
    deep: Option<Deep>,
    /// Not deeper before this time; after it nothing is known.
    unknown: f64,
    limited: Limited,
}

impl Findings {
    fn add(&mut self, after: f64, by: f64, deep: Deep) {
        self.after = self.after.min(after);
        if by < self.by {
            (self.by, self.deep) = (by, Some(deep));
        }
    }

    fn doubt(&mut self, from: f64, limited: Limited) {
        if from < self.unknown {
            (self.unknown, self.limited) = (from, limited);
        }
    }
}

/// A part of a triangle that is followed over some time.
struct FollowedPiece {
    piece: TrianglePiece,
    near: Vec<Near>,
    from: f64,
    to: f64,
    /// The number of cuts that led to it, and of those at this time.
    cuts: u32,
    stuck: u32,
}

/// Parts to be followed: the earliest first, and among those from one time on, the newest first.
#[derive(Default)]
struct PieceQueue {
    parts: BinaryHeap<Ranked<(Reverse<Ordered>, usize), FollowedPiece>>,
    count: usize,
}

impl PieceQueue {
    fn add(&mut self, part: FollowedPiece) {
        self.count += 1;
        self.parts.push(Ranked {
            key: (Reverse(Ordered(part.from)), self.count),
            item: part,
        });
    }

    fn next(&mut self) -> Option<FollowedPiece> {
        self.parts.pop().map(|ranked| ranked.item)
    }
}

/// The deepest point of a piece.
#[derive(Debug, Clone, Copy)]
struct Deepest {
    deep: Deep,
    depth: f64,
    /// No point is deeper.
    most: f64,
}

impl<'a> WindowSearch<'a> {
    fn new(
        sinking: &'a Sinking<'a>,
        innermost: ShapeNode,
        middle: f64,
        half: f64,
    ) -> WindowSearch<'a> {
        let most_work = STEP * (MOST_WORK + MOST_WORK_EACH * sinking.encounter.triangles());
        WindowSearch {
            innermost,
            at: Window::new(sinking.encounter, middle, half),
            sinking,
            findings: Findings {
                after: f64::INFINITY,
                by: f64::INFINITY,
                deep: None,
                unknown: f64::INFINITY,
                limited: Limited::Work,
            },
            work: Cell::new(0),
            most_work,
            limit: TRIANGLES * most_work,
            last: DVec3::ZERO,
        }
    }

    fn run(mut self, start: f64) -> (Sunk, usize) {
        let shape = self.sinking.encounter.shapes[self.sinking.surface];
        let mut open = vec![(0, vec![0])];
        while let Some((number, known)) = open.pop() {
            if self.findings.by <= start {
                // Nothing is earlier than that.
                break;
            }
            let node = &shape.nodes[number as usize];
            let stretch = [start, self.at.half.min(self.findings.by)];
            let moved = self.at.frames[self.sinking.surface].moved(node);
            let Some(stretch) = self.innermost_during(&moved, stretch) else {
                continue;
            };
            self.limit = TRIANGLES * self.most_work;
            if self.is_exhausted() {
                self.findings.doubt(stretch[0], Limited::Work);
                continue;
            }
            if node.is_leaf() {
                let near = self.near(&moved, known, stretch);
                self.triangle(node, near, stretch);
                continue;
            }
            let met = self.met(&moved, node, known, stretch);
            if met.is_empty() {
                self.whole(node, stretch[0]);
                continue;
            }
            open.push((node.children + 1, met.clone()));
            open.push((node.children, met));
        }
        let middle = self.at.middle;
        let local = |time: f64| (middle + time).clamp(0.0, 1.0);
        let Findings {
            after,
            by,
            deep,
            unknown,
            limited,
        } = self.findings;
        let sunk = match deep {
            Some(deep) => Sunk::First {
                bracket: [local(after.min(unknown).min(by)), local(by)],
                deep,
            },
            None if unknown < f64::INFINITY => Sunk::Unknown(local(unknown), limited),
            None => Sunk::Never,
        };
        (sunk, self.work.get() / STEP)
    }

    /// The largest length of pushes.
    fn reach(&self) -> f64 {
        self.sinking.depth + DEPTH_ROOM * self.at.slack
    }

    /// The part of a stretch during which a box may be where the solid is deep enough.
    fn innermost_during(&self, moved: &Moved, stretch: [f64; 2]) -> Option<[f64; 2]> {
        let innermost = self.at.frames[1 - self.sinking.surface].moved(&self.innermost);
        self.at.entered(moved, &innermost, 0.0, stretch)
    }

    /// The nodes of the solid, not much larger than a box, to which the box may come near.
    fn met(&self, moved: &Moved, node: &ShapeNode, known: Vec<u32>, stretch: [f64; 2]) -> Vec<u32> {
        let size = node.half.max_element();
        let mut met = Vec::new();
        self.descend(moved, known, stretch, |number, other, _| {
            let stops = other.is_leaf() || other.half.max_element() <= size;
            if stops {
                met.push(number);
            }
            stops
        });
        met
    }

    /// The triangles of the solid to which a box may come near.
    fn near(&self, moved: &Moved, known: Vec<u32>, stretch: [f64; 2]) -> Vec<Near> {
        let mut near = Vec::new();
        self.descend(moved, known, stretch, |_, other, [from, to]| {
            if other.is_leaf() {
                near.push(Near {
                    triangle: other.triangle,
                    from,
                    to,
                });
            }
            other.is_leaf()
        });
        near
    }

    /// Calls `stops` for nodes of the solid to which a box may come near; where it returns true,
    /// nothing below the node is examined.
    fn descend(
        &self,
        moved: &Moved,
        mut open: Vec<u32>,
        stretch: [f64; 2],
        mut stops: impl FnMut(u32, &ShapeNode, [f64; 2]) -> bool,
    ) {
        let which = 1 - self.sinking.surface;
        let shape = self.sinking.encounter.shapes[which];
        let mut count = 0;
        while let Some(number) = open.pop() {
            count += 1;
            let node = &shape.nodes[number as usize];
            let other = self.at.frames[which].moved(node);
            if let Some(stretch) = self.at.entered(moved, &other, self.reach(), stretch)
                && !stops(number, node, stretch)
            {
                open.extend([node.children, node.children + 1]);
            }
        }
        self.works(count / BOXES);
    }

    fn works(&self, triangles: usize) {
        self.work.set(self.work.get() + triangles);
    }

    fn is_exhausted(&self) -> bool {
        self.work.get() > self.limit || self.sinking.encounter.work.check().is_err()
    }

    /// Treats a part that comes near nothing: it is outside the solid, or deeper as a whole.
    fn whole(&mut self, node: &ShapeNode, start: f64) {
        let sinking = self.sinking;
        let shape = sinking.encounter.shapes[sinking.surface];
        let time = self.at.middle + start;
        let pose = sinking.encounter.movers[sinking.surface].pose(time);
        let centre = pose.transform_point3(shape.frame * node.centre);
        if !sinking.solid(time).contains(centre) {
            return;
        }
        let mut leaf = *node;
        while !leaf.is_leaf() {
            leaf = shape.nodes[leaf.children as usize];
        }
        let deep = Deep {
            triangle: leaf.triangle,
            weights: [1.0, 0.0, 0.0],
        };
        self.findings.add(start, start, deep);
    }

    fn triangle(&mut self, node: &ShapeNode, near: Vec<Near>, [from, to]: [f64; 2]) {
        if near.is_empty() {
            return self.whole(node, from);
        }
        let whole = |from: f64| FollowedPiece {
            piece: TrianglePiece::whole(node.triangle),
            near: near.clone(),
            from,
            to,
            cuts: 0,
            stuck: 0,
        };
        // Cuts help at the time for which they are made. Later they leave parts that must all be
        // cut again, so that there are ever more: once all have passed that time, the triangle is
        // taken as a whole again.
        self.limit = self.limit.min(self.work.get() + self.most_work);
        let mut open = PieceQueue::default();
        open.add(whole(from));
        let (mut begun, mut followed, mut at_once) = (from, 0, 0);
        while let Some(mut part) = open.next() {
            if self.is_exhausted() {
                // The other parts are later.
                return self.findings.doubt(part.from, Limited::Work);
            }
            let is_cut_up = followed > FEW_PARTS + MANY_TIMES * at_once || part.cuts > MOST_CUTS;
            if is_cut_up && part.from > begun {
                part = whole(part.from);
                open = PieceQueue::default();
                (begun, followed, at_once) = (part.from, 0, 0);
            }
            followed += 1;
            at_once += usize::from(part.from <= begun);
            let mut parts = Vec::new();
            self.follow(part, &mut parts);
            parts.into_iter().for_each(|part| open.add(part));
        }
    }

    /// Follows a part until it is certified to the end of its time, or found deep, or cut: then its
    /// parts are left in `open`.
    fn follow(&mut self, part: FollowedPiece, open: &mut Vec<FollowedPiece>) {
        let sinking = self.sinking;
        let shape = sinking.encounter.shapes[sinking.surface];
        let solid_shape = sinking.encounter.shapes[1 - sinking.surface];
        let own = part.piece.corners(&shape.corners(part.piece.triangle));
        let slack = self.at.slack;
        let smallest = ROOT_RESOLUTION * self.at.half;
        let mut time = part.from;
        for step in 0.. {
            let limit = part.to.min(self.findings.by);
            if time >= limit {
                return;
            }
            if self.is_exhausted() {
                return self.findings.doubt(time, Limited::Work);
            }
            let chart = &self.at.charts[sinking.surface];
            let corners_of = |triangle: u32| solid_shape.corners(triangle);
            let pushing = Pushing {
                at: &self.at,
                pushed: sinking.surface,
                curves: own.map(|corner| chart.curve(corner)),
                corners_of: &corners_of,
                near: &part.near,
                looked_at: &self.work,
            };
            let around = pushing.around(time, 2.0 * self.reach());
            let solid = sinking.solid(self.at.middle + time);
            let mut last = self.last;
            let mut until =
                pushing.out_until(&around, &solid, sinking.depth, [time, limit], &mut last);
            if until >= limit {
                self.last = last;
                return;
            }
            if until - time > smallest && step < MOST_STEPS {
                (time, self.last) = (until, last);
                continue;
            }
            // No direction leads out: is it as deep as that?
            let (deepest, between) = self.deepest(&part.piece, &around, &solid);
            let is_close = deepest.depth >= sinking.depth - DEPTH_ROOM * slack;
            let look = |time: f64| {
                let around = pushing.around(time, 2.0 * self.reach());
                let solid = sinking.solid(self.at.middle + time);
                self.deepest(&part.piece, &around, &solid).0
            };
            if (is_close || part.cuts == 0)
                && let Some((by, deep)) = self.deep_from(deepest, [time, limit], look)
            {
                if is_close || by - time <= NARROW {
                    return self.findings.add(time, by, deep);
                }
                // Not before, but no later than that time.
                self.findings.add(f64::INFINITY, by, deep);
            }
            if self.findings.by - time <= NARROW {
                return self.findings.after = self.findings.after.min(time);
            }
            until = pushing.out_until(
                &around,
                &solid,
                self.reach(),
                [time, limit.min(self.findings.by)],
                &mut last,
            );
            if until - time > smallest && step < MOST_STEPS {
                time = until;
                continue;
            }
            // Far from as deep, as is usual when the allowed depth is not small: for how long is
            // that certain?
            let room = sinking.depth - deepest.most - CERTAIN * slack;
            let fastest = sinking
                .encounter
                .speed_within(self.at.middle + time, limit - time);
            if room > SLOW * (limit - time) * fastest && step < MOST_STEPS {
                time += room / fastest;
                continue;
            }
            let part = FollowedPiece {
                // Where it made progress, a line between two faces may have moved on it.
                stuck: if time > part.from { 0 } else { part.stuck },
                ..part
            };
            let size = (0..3)
                .map(|k| own[k].distance(own[(k + 1) % 3]))
                .fold(0.0, f64::max);
            if part.stuck >= MOST_STUCK || size <= slack {
                return self.findings.doubt(time, Limited::Rounding);
            }
            return self.cut(part, &own, between, time, open);
        }
    }

    fn cut(
        &mut self,
        part: FollowedPiece,
        own: &[DVec3; 3],
        between: Option<[f64; 3]>,
        time: f64,
        open: &mut Vec<FollowedPiece>,
    ) {
        let sinking = self.sinking;
        let shape = sinking.encounter.shapes[sinking.surface];
        // Alternately along lines on which two faces are equally near, and in halves.
        let mut pieces = match between {
            Some(heights) if part.stuck.is_multiple_of(2) => part.piece.cut(heights),
            _ => Vec::new(),
        };
        if pieces.len() < 2 {
            pieces = part.piece.halves(own);
        }
        for piece in pieces {
            let corners = piece.corners(&shape.corners(piece.triangle));
            let moved = self.at.frames[sinking.surface].moved(&shape.around(&corners));
            let Some([from, to]) = self.innermost_during(&moved, [time, part.to]) else {
                continue;
            };
            self.works(part.near.len() / BOXES);
            let which = 1 - sinking.surface;
            let solid = sinking.encounter.shapes[which];
            let near = part.near.iter().filter_map(|near| {
                let other =
                    self.at.frames[which].moved(&solid.around(&solid.corners(near.triangle)));
                let stretch = [near.from.max(from), near.to.min(to)];
                let [from, to] = self.at.entered(&moved, &other, self.reach(), stretch)?;
                Some(Near { from, to, ..*near })
            });
            open.push(FollowedPiece {
                piece,
                near: near.collect(),
                from,
                to,
                cuts: part.cuts + 1,
                stuck: part.stuck + 1,
            });
        }
    }

    /// The deepest point of a piece among the candidates: its depth, and the line along which the
    /// piece is to be cut.
    fn deepest(
        &self,
        piece: &TrianglePiece,
        around: &Surroundings,
        solid: &PlacedSolid,
    ) -> (Deepest, Option<[f64; 3]>) {
        let third = 1.0 / 3.0;
        let mut candidates = vec![
            [third; 3],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
        ];
        let mut between = None;
        if !around.planes.is_empty() {
            let lowest = lowest(&around.corners, &around.planes);
            candidates.push(lowest.weights);
            between = lowest.between;
        }
        let before = solid.looked_at();
        let mut best = ([third; 3], f64::NEG_INFINITY);
        let mut most = f64::INFINITY;
        for weights in candidates {
            let point = blend(&around.corners, weights);
            let depth = solid.sound(point).depth;
            if most == f64::INFINITY {
                // The middle of the piece: no point is deeper by more than its distance from it.
                let reach = around.corners.map(|corner| corner.distance(point));
                most = depth + reach.into_iter().fold(0.0, f64::max);
            }
            if depth > best.1 {
                best = (weights, depth);
            }
        }
        let climbed = solid.climb(&around.corners, best.0);
        self.works(solid.looked_at() - before);
        let deep = Deep {
            triangle: piece.triangle,
            weights: piece.of_triangle(climbed.weights),
        };
        let depth = climbed.sounding.depth;
        (Deepest { deep, depth, most }, climbed.between.or(between))
    }

    /// A time in [`from`, `to`], not much later than necessary, at which a piece is certainly too
    /// deep, and the point.
    ///
    /// - `at_start`: its deepest point at `from`. `look`: its deepest point at any time.
    fn deep_from(
        &self,
        at_start: Deepest,
        [from, to]: [f64; 2],
        look: impl Fn(f64) -> Deepest,
    ) -> Option<(f64, Deep)> {
        let sinking = self.sinking;
        let middle = self.at.middle;
        let is_deep = |found: &Deepest, time: f64| sinking.is_deep(found.depth, middle + time);
        if is_deep(&at_start, from) {
            return Some((from, at_start.deep));
        }
        // It gets deeper no faster than the fastest point moves.
        let fastest = sinking.encounter.speed_within(middle + from, to - from);
        let missing = sinking.depth - at_start.depth;
        if missing > fastest * (to - from) {
            return None;
        }
        let smallest = ROOT_RESOLUTION * self.at.half;
        let step = (8.0 * self.at.slack / fastest).max(0.5 * missing / fastest);
        let (mut shallow, mut step) = (from, step.max(smallest));
        let (mut late, mut deep) = loop {
            let next = (shallow + step).min(to);
            let found = look(next);
            if is_deep(&found, next) {
                break (next, found.deep);
            }
            // Where it certainly gets out, the search continues when it no longer does.
            let gets_out = found.depth < at_start.depth - CERTAIN * self.at.slack;
            if next >= to || gets_out || self.is_exhausted() {
                return None;
            }
            shallow = next;
            step *= 2.0;
        };
        while late - shallow > smallest && !self.is_exhausted() {
            let between = shallow.midpoint(late);
            let found = look(between);
            if is_deep(&found, between) {
                (late, deep) = (between, found.deep);
            } else {
                shallow = between;
            }
        }
        Some((late, deep))
    }
}
