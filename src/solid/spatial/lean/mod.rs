//! A lean boundary: edges collapse where the surface hardly bends.
//!
//! A vertex moves into a neighbour, and the two triangles between them vanish (`star`). So all
//! remaining vertices keep their places, and the surface its topology. Vertices on a sharp edge move
//! along it only, and corners where sharp edges meet stay.
//!
//! # The error
//! The old triangles around the vertex and the new ones are graphs over one polygon, seen along an
//! axis. Moving each point along it is a continuous map from the old surface onto the new one that
//! covers it once; the maps of all collapses, one after the other, are a map f from the given
//! surface onto the lean one. For each triangle, a box contains the displacements f(p) - p of all
//! points p that f takes there (`reach`), and the largest of them is at most the allowed distance e.
//!
//! So the straight homotopy from p to f(p) moves no point farther than e. A point x that is in one
//! of the two regions only is passed by it: x lies between some p and f(p), so it is within e of the
//! boundary of the other region. Hence each region reaches out of the other by at most e, and e is
//! added to both error bounds.
//!
//! # No crossings
//! A collapse is refused where a new triangle would meet another triangle elsewhere than in common
//! corners and edges (exactly, `bounds::meeting`), nearly lie on a neighbour, or pass over another.
//! Those near it are found in a tree of boxes that grow with the triangles (`boxes`).
//!
//! # Order
//! In each round the best collapse of every vertex whose surroundings changed is found, in parallel;
//! then they are made one after the other, those that move points least first, and of these the
//! shortest. Those next to one that was made wait for the next round. The limit grows from round to
//! round, so that triangles of a smooth part grow evenly. The result does not depend on the number
//! of threads.

mod boxes;
mod reach;
mod star;
#[cfg(test)]
mod tests;

use crate::bounds::{meeting, triangle_box};
use crate::numeric::exact::signs::{Side, side_of_plane};
use crate::numeric::index;
use crate::numeric::tolerance::UNIT_ROUNDOFF;
use crate::surface::Collapsing;
use crate::watch::{Interrupted, Work};
use boxes::{GrowingBoxes, Place};
use glam::DVec3;
use rayon::prelude::*;
use reach::Reach;
use star::Star;

/// A boundary with fewer triangles and the same positions.
pub(super) struct Lean {
    pub(super) triangles: Vec<[u32; 3]>,
    /// How far each of the two regions may reach out of the other.
    pub(super) error: f64,
}

/// The limits of distance, as shares of the allowed one; a smaller step costs rounds, and a larger
/// one leaves a few percent more triangles.
const LIMITS: i32 = 13;
const STEP: f64 = 0.7;

/// Cosine between the normals at an edge below which the two triangles nearly lie on each other.
const FOLDED: f64 = -0.99;

/// Fewest vertices per parallel task.
const TASK: usize = 256;

/// The boundary with as few triangles as the order of collapses finds, each region within `allowed`
/// of the other.
///
/// - `positions`, `triangles`: a closed oriented surface, two triangles at every edge.
///
/// # Errors
/// [`Interrupted`] when the run is to stop.
///
/// # Cost
/// O(n) per round and O(log n) per collapse that is tried; some dozens of rounds. Finding collapses
/// is parallel, making them is not.
pub(super) fn lean(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    allowed: f64,
    work: Work,
) -> Result<Lean, Interrupted> {
    let mut leaning = Leaning::new(positions, triangles, allowed);
    let mut changed: Vec<u32> = (0..index(positions.len())).collect();
    for limit in (0..LIMITS).rev() {
        loop {
            let found = leaning.found(&changed, work)?;
            for (vertex, best) in changed.drain(..).zip(found) {
                leaning.best[vertex as usize] = best;
            }
            changed = leaning.round(limit, work)?;
            if changed.is_empty() {
                break;
            }
        }
    }
    Ok(leaning.finish())
}

/// The move of a vertex into a neighbour.
#[derive(Debug, Clone, Copy)]
struct Collapse {
    gone: u32,
    kept: u32,
    /// Number of the first limit from which it is allowed on, downwards.
    limit: i32,
    length_squared: f64,
}

struct Leaning<'a> {
    positions: &'a [DVec3],
    allowed: f64,
    surface: Collapsing,
    /// Per triangle.
    reaches: Vec<Reach>,
    boxes: GrowingBoxes,
    /// The best collapse of each vertex.
    best: Vec<Option<Collapse>>,
}

impl<'a> Leaning<'a> {
    fn new(positions: &'a [DVec3], triangles: &[[u32; 3]], allowed: f64) -> Leaning<'a> {
        let bounds: Vec<[DVec3; 2]> = triangles
            .par_iter()
            .map(|&corners| bounds_of(corners, positions))
            .collect();
        Leaning {
            positions,
            allowed,
            surface: Collapsing::new(triangles.to_vec(), positions.len()),
            reaches: vec![Reach::default(); triangles.len()],
            boxes: GrowingBoxes::new(&bounds),
            best: vec![None; positions.len()],
        }
    }

    /// The best collapses of some vertices.
    fn found(&self, vertices: &[u32], work: Work) -> Result<Vec<Option<Collapse>>, Interrupted> {
        vertices
            .par_iter()
            .with_min_len(TASK)
            .map_init(Star::default, |star, &vertex| {
                work.check()?;
                Ok(self.best_of(vertex, star))
            })
            .collect()
    }

    /// The best collapse of a vertex: that of the lowest limit, and of these the shortest.
    fn best_of(&self, gone: u32, star: &mut Star) -> Option<Collapse> {
        if !self.fill(star, gone) {
            return None;
        }
        let neighbours = 0..star.ring.len();
        let sharp: Vec<bool> = neighbours.clone().map(|i| star.is_sharp(i)).collect();
        let along_sharp = match sharp.iter().filter(|&&sharp| sharp).count() {
            0 => false,
            2 => true,
            _ => return None,
        };
        let mut best: Option<Collapse> = None;
        for to in neighbours.filter(|&i| !along_sharp || sharp[i]) {
            let Some(distance) = star.moved(to, self.allowed) else {
                continue;
            };
            let collapse = Collapse {
                gone,
                kept: star.ring[to],
                limit: self.limit_of(distance),
                length_squared: star.length_squared(to),
            };
            if best.is_none_or(|best| collapse.is_before(&best)) {
                best = Some(collapse);
            }
        }
        best
    }

    fn fill(&self, star: &mut Star, vertex: u32) -> bool {
        star.fill(&self.surface, self.positions, &self.reaches, vertex)
    }

    /// The lowest limit that a distance keeps.
    fn limit_of(&self, distance: f64) -> i32 {
        let keeps = |&limit: &i32| distance <= self.allowed * STEP.powi(limit);
        (0..LIMITS).rev().find(keeps).unwrap_or(0)
    }

    /// Makes the collapses that keep a limit. Returns the vertices whose surroundings changed.
    fn round(&mut self, limit: i32, work: Work) -> Result<Vec<u32>, Interrupted> {
        let mut collapses: Vec<Collapse> = self
            .best
            .iter()
            .flatten()
            .filter(|collapse| collapse.limit >= limit)
            .copied()
            .collect();
        collapses.sort_unstable_by(|a, b| {
            (b.limit.cmp(&a.limit))
                .then(a.length_squared.total_cmp(&b.length_squared))
                .then(a.gone.cmp(&b.gone))
        });
        let mut star = Star::default();
        let mut changed = Vec::new();
        let mut is_changed = vec![false; self.positions.len()];
        for Collapse { gone, kept, .. } in collapses {
            work.check()?;
            if is_changed[gone as usize] {
                continue;
            }
            // Even if it is not possible now, it is not asked for again before something changes.
            self.best[gone as usize] = None;
            if !self.collapse(gone, kept, &mut star) {
                continue;
            }
            is_changed[gone as usize] = true;
            for &vertex in &star.ring {
                if !std::mem::replace(&mut is_changed[vertex as usize], true) {
                    changed.push(vertex);
                }
            }
        }
        Ok(changed)
    }

    /// Moves `gone` into `kept`, and returns true, unless the surface would change its topology or
    /// meet itself. `star` becomes that of `gone`.
    fn collapse(&mut self, gone: u32, kept: u32, star: &mut Star) -> bool {
        if !self.surface.may_collapse(kept, gone) || !self.fill(star, gone) {
            return false;
        }
        let Some(to) = star.ring.iter().position(|&vertex| vertex == kept) else {
            return false;
        };
        if star.moved(to, self.allowed).is_none()
            || self.folds(star, to)
            || self.meets(gone, star, to)
        {
            return false;
        }
        self.surface.collapse(kept, gone);
        for (number, &reach) in star.remaining(to).zip(&star.after) {
            let triangle = star.triangles[number];
            self.reaches[triangle as usize] = reach;
            if let Some(corners) = self.surface.triangle(triangle) {
                self.boxes
                    .grow(triangle, bounds_of(corners, self.positions));
            }
        }
        true
    }

    /// Whether the surface would fold up at an edge of the ring, and sharper than before.
    fn folds(&self, star: &Star, to: usize) -> bool {
        let count = star.ring.len();
        let corner = |i: usize| star.ring[(to + i) % count];
        (0..count).any(|i| {
            let [a, b] = [corner(i), corner(i + 1)];
            let Some(beyond) = self.surface.spokes(b).find(|spoke| spoke.next == a) else {
                return true;
            };
            // At the edges from the kept corner, the first and the last of the new triangles take
            // the place of those that vanish.
            let new = i.clamp(1, count - 2);
            let new = self.normal([corner(0), corner(new), corner(new + 1)]);
            let beyond = self.normal([b, a, beyond.last]);
            let before = star.normal((to + i) % count).dot(beyond);
            new.dot(beyond) < before.min(FOLDED)
        })
    }

    /// The unit normal of a triangle.
    fn normal(&self, corners: [u32; 3]) -> DVec3 {
        let [a, b, c] = corners.map(|v| self.positions[v as usize]);
        (b - a).cross(c - a).normalize_or_zero()
    }

    /// Whether the new triangles would meet others, or pass over them, when `gone` moves to
    /// neighbour `to` of its star.
    fn meets(&self, gone: u32, star: &Star, to: usize) -> bool {
        let count = star.ring.len();
        let corner = |i: usize| star.ring[i % count];
        let place = |v: u32| self.positions[v as usize];
        let new: Vec<(usize, [u32; 3], [DVec3; 2])> = star
            .remaining(to)
            .map(|i| (i, [star.ring[to], corner(i), corner(i + 1)]))
            .map(|(i, corners)| (i, corners, bounds_of(corners, self.positions)))
            .collect();
        // The old triangles have the same corners, except for the vertex.
        let bounds = new
            .iter()
            .fold([place(gone); 2], |[low, high], (_, _, bounds)| {
                [low.min(bounds[0]), high.max(bounds[1])]
            });
        let (axis, heights) = star.slab();
        let level = axis.dot(place(gone));
        // Products with coordinates are rounded, those of boxes as well.
        let largest = bounds[0].abs().max(bounds[1].abs());
        let slack = 8.0 * UNIT_ROUNDOFF * largest.element_sum();
        let heights = [heights[0] - slack, heights[1] + slack];
        let around = Place {
            bounds,
            axis,
            heights: heights.map(|height| level + height),
        };
        self.boxes.any_near(&around, |other| {
            let Some(corners) = self.surface.triangle(other) else {
                return false;
            };
            if corners.contains(&gone) {
                return false;
            }
            let [low, high] = bounds_of(corners, self.positions);
            let seen = star.seen(corners, place(gone), self.positions);
            let touches = new.iter().any(|(i, triangle, bounds)| {
                let is_near = bounds[0].cmple(high).all() && bounds[1].cmpge(low).all();
                is_near
                    && !star.is_beside(to, *i, &seen)
                    && meeting(self.positions, [*triangle, corners]).is_some()
            });
            // What the surface passes over without touching it is a whole shell between the old
            // triangles and the new ones.
            let is_passed = || {
                let point = place(corners[0]);
                let is_within = low.cmpge(bounds[0]).all() && high.cmple(bounds[1]).all();
                is_within
                    && !corners.iter().any(|v| star.ring.contains(v))
                    && new.iter().any(|(_, triangle, _)| {
                        is_in_tetrahedron(triangle.map(place), place(gone), point)
                    })
            };
            touches || is_passed()
        })
    }

    fn finish(self) -> Lean {
        let left = (0..index(self.reaches.len())).filter_map(|number| {
            let corners = self.surface.triangle(number)?;
            Some((corners, self.reaches[number as usize].distance()))
        });
        let (triangles, distances): (Vec<[u32; 3]>, Vec<f64>) = left.unzip();
        Lean {
            triangles,
            error: distances.into_iter().fold(0.0, f64::max),
        }
    }
}

impl Collapse {
    fn is_before(&self, other: &Collapse) -> bool {
        self.limit > other.limit
            || (self.limit == other.limit && self.length_squared < other.length_squared)
    }
}

fn bounds_of(corners: [u32; 3], positions: &[DVec3]) -> [DVec3; 2] {
    triangle_box(corners.map(|v| positions[v as usize]))
}

/// Whether a point lies in the closed tetrahedron of a triangle and an apex; never, if it is flat.
fn is_in_tetrahedron([a, b, c]: [DVec3; 3], apex: DVec3, point: DVec3) -> bool {
    let faces = [[a, b, c], [a, c, apex], [c, b, apex], [b, a, apex]];
    let sides = faces.map(|[a, b, c]| side_of_plane(a, b, c, point));
    sides.contains(&Side::Above) != sides.contains(&Side::Below)
}
