//! All times during which a body is deeper in an obstacle than allowed.
//!
//! Their beginnings are searched and certified (`sinking`, `engulfed`). Their ends are followed: a point that is deeper than allowed stays
//! so at least until the fastest point has gone the difference; beyond that the deepest point is asked again at times that move on,
//! by rounding first and then twice as far each time. An absence that is shorter than such a step may be passed over.

use super::engulfed::Engulfed;
use super::entering::Entry;
use super::intervals::Times;
use super::piece::{Piece, Plane, blend, lowest};
use super::sinking::Sinking;
use super::window::Encounter;
use crate::numeric::area::area_vector;
use crate::numeric::tolerance::{JOINT_GAP, ROOT_RESOLUTION};
use glam::DVec3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Most intervals of one obstacle in one stage, and most steps in one of them: past them it is taken to last to the end.
const MOST_PIECES: usize = 10_000;

/// Longest step where nothing is certified.
const LONGEST_STEP: f64 = 1.0 / 256.0;

/// Cells that are looked at for what the body holds.
const MOST_CELLS: usize = 2_000;

/// Parts of triangles that are looked at for the deepest point.
const MOST_CUT: usize = 256;

impl Encounter<'_> {
    /// The times, local; what is in doubt is in them.
    pub(super) fn deep_times(&self, depth: f64) -> Times {
        let mut times = Times::none(JOINT_GAP);
        let mut from = 0.0;
        for _ in 0..MOST_PIECES {
            let (start, held) = match self.entry(true, from, depth) {
                None => return times,
                Some(Entry::Unknown(time)) => {
                    from = time;
                    break;
                }
                Some(Entry::Sunk { bracket, .. }) => (bracket[1], false),
                Some(Entry::Held(_)) => (from, true),
            };
            let end = self.deep_until(start, depth, held);
            times.add([start, end]);
            from = end + ROOT_RESOLUTION;
            if from >= 1.0 {
                return times;
            }
        }
        times.add([from, 1.0]);
        times
    }

    /// The end of a time that begins at `start`.
    fn deep_until(&self, start: f64, depth: f64, mut held: bool) -> f64 {
        let sinking = Sinking::new(self, depth);
        let (mut time, mut step) = (start, ROOT_RESOLUTION);
        for _ in 0..MOST_PIECES {
            if time >= 1.0 {
                return 1.0;
            }
            let next = (time + step).min(1.0);
            if let Some(excess) = self.excess(&sinking, next, &mut held) {
                step = (2.0 * step).min(LONGEST_STEP);
                let certain = excess / self.speed_within(next, LONGEST_STEP);
                time = (next + certain.min(LONGEST_STEP)).min(1.0);
                continue;
            }
            let (mut inside, mut outside) = (time, next);
            while outside - inside > ROOT_RESOLUTION {
                let middle = inside.midpoint(outside);
                if self.excess(&sinking, middle, &mut held).is_some() {
                    inside = middle;
                } else {
                    outside = middle;
                }
            }
            return inside;
        }
        1.0
    }

    /// By how much something is deeper than allowed at a time, at least, or `None` where nothing was found.
    ///
    /// - `held`: whether the body holds a part of the obstacle that is; looked at first where it did last.
    fn excess(&self, sinking: &Sinking, time: f64, held: &mut bool) -> Option<f64> {
        let sunk = || sinking.deepest(time).map(|depth| depth - sinking.depth);
        let holds = || {
            let found = self.shapes[1].closed()
                && matches!(
                    self.engulfed(time, sinking.depth, MOST_CELLS),
                    Engulfed::Point(_)
                );
            found.then_some(0.0)
        };
        if *held && let Some(excess) = holds() {
            return Some(excess);
        }
        let sunk = sunk();
        let found = if *held { sunk } else { sunk.or_else(holds) };
        *held = found.is_some() && sunk.is_none();
        found
    }
}

/// What of the surface may be deep: nodes of its tree, then pieces of triangles.
enum Part {
    Node(u32),
    Piece(Piece),
}

struct Ranked {
    bound: f64,
    number: usize,
    part: Part,
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
        self.bound
            .total_cmp(&other.bound)
            .then(other.number.cmp(&self.number))
    }
}

impl Sinking<'_> {
    /// Depth of a point of the surface that is certainly too deep at a time, the most promising places first; `None` if none is
    /// found.
    fn deepest(&self, time: f64) -> Option<f64> {
        let shape = self.encounter.shapes[self.surface];
        let pose = self.encounter.movers[self.surface].pose(time);
        let solid = self.encounter.solid(1 - self.surface, time);
        let frame = pose.matrix3 * shape.frame;
        let mut open = BinaryHeap::new();
        let mut number = 0;
        // Bounds a part, unless one of its points decides.
        let mut look = |part: Part, open: &mut BinaryHeap<Ranked>| -> Option<f64> {
            number += 1;
            let (middle, reach) = match &part {
                Part::Node(node) => {
                    let node = &shape.nodes[*node as usize];
                    let half = frame.x_axis.abs() * node.half.x
                        + frame.y_axis.abs() * node.half.y
                        + frame.z_axis.abs() * node.half.z;
                    (frame * node.centre + pose.translation, half.length())
                }
                Part::Piece(piece) => {
                    let corners = shape.corners(piece.triangle);
                    let corners = piece.corners(&corners).map(|c| pose.transform_point3(c));
                    let middle = blend(&corners, [1.0 / 3.0; 3]);
                    let mut planes: Vec<Plane> = Vec::new();
                    for point in [middle, corners[0], corners[1], corners[2]] {
                        let sounding = solid.sound(point);
                        if self.is_deep(sounding.depth, time) {
                            return Some(sounding.depth);
                        }
                        let face = solid.corners(sounding.triangle);
                        if let Some(normal) = area_vector(face).try_normalize() {
                            let offset = normal.dot(face[0]);
                            planes.push(Plane { normal, offset });
                        }
                    }
                    // Between two faces the deepest point is on a line.
                    if !planes.is_empty() {
                        let weights = lowest(&corners, &planes).weights;
                        let depth = solid.sound(blend(&corners, weights)).depth;
                        if self.is_deep(depth, time) {
                            return Some(depth);
                        }
                    }
                    let reach = corners.map(|c: DVec3| c.distance(middle));
                    (middle, reach.into_iter().fold(0.0, f64::max))
                }
            };
            let bound = solid.sound(middle).depth + reach;
            if bound > self.depth {
                open.push(Ranked {
                    bound,
                    number,
                    part,
                });
            }
            None
        };
        if let Some(depth) = look(Part::Node(0), &mut open) {
            return Some(depth);
        }
        let mut cut = 0;
        while let Some(Ranked { part, .. }) = open.pop() {
            let parts = match part {
                Part::Node(node) => {
                    let node = &shape.nodes[node as usize];
                    if node.is_leaf() {
                        vec![Part::Piece(Piece::whole(node.triangle))]
                    } else {
                        vec![Part::Node(node.children), Part::Node(node.children + 1)]
                    }
                }
                Part::Piece(piece) => {
                    cut += 1;
                    if cut > MOST_CUT {
                        break;
                    }
                    let corners = piece.corners(&shape.corners(piece.triangle));
                    let halves = piece.halves(&corners);
                    halves.into_iter().map(Part::Piece).collect()
                }
            };
            for part in parts {
                if let Some(depth) = look(part, &mut open) {
                    return Some(depth);
                }
            }
        }
        None
    }
}
