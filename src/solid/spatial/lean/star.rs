//! The triangles around a vertex, and how far the surface moves when the vertex moves into a
//! neighbour.
//!
//! Seen along an axis to which all these triangles turn their outside, before and after, both
//! surfaces are graphs over the same polygon. Moved along the axis, every point of the old one comes
//! to a point of the new one, and those at the border stay. Where an old and a new triangle overlap,
//! the difference of their heights is linear, so it is largest at a corner of the overlap: at the
//! vertex, or where an edge from it crosses a new edge; at the border it is zero.

use super::reach::Reach;
use crate::numeric::tolerance::UNIT_ROUNDOFF;
use crate::surface::Collapsing;
use glam::{DVec2, DVec3, Vec3Swizzles};

/// Most neighbours of a vertex that may go: the cost grows as their cube.
const MOST_NEIGHBOURS: usize = 32;

/// Least cosine between the axis and the normal of a triangle. Where a triangle is steeper, heights
/// say little about distances.
const LEAST_COSINE: f64 = 0.25;

/// Cosine of 30 degrees: the least angle of a sharp edge, and the largest by which a triangle may
/// turn.
const SHARP: f64 = 0.866;

/// Rounding of a height, in units of roundoff of the longest edge at the vertex: three products make
/// up a coordinate, and a height at a crossing is a mean of four of them.
const HEIGHT_ROUNDING: f64 = 64.0;

/// Least height of a new triangle, relative to its longest side: well above the rounding of `f32`.
const THINNEST: f64 = 1e-6;

/// The triangles around a vertex.
#[derive(Default)]
pub(super) struct Star {
    /// The neighbours of the vertex, counter-clockwise seen from outside.
    pub(super) ring: Vec<u32>,
    /// Number i lies between neighbours i and i + 1.
    pub(super) triangles: Vec<u32>,
    /// The neighbours, relative to the vertex.
    places: Vec<DVec3>,
    /// Unit normals of the triangles.
    normals: Vec<DVec3>,
    axis: DVec3,
    /// Two directions across the axis.
    across: [DVec3; 2],
    /// The neighbours in a frame whose third direction is the axis.
    framed: Vec<DVec3>,
    /// A bound on the rounding of a height.
    rounding: f64,
    /// How far points have moved that came to the triangles so far.
    before: Vec<Reach>,
    /// The same after the last move asked for, for the triangles that remain.
    pub(super) after: Vec<Reach>,
}

impl Star {
    /// Fills in the star of a vertex. Returns whether it is a fan of triangles that all have an area
    /// and turn their outside to an axis.
    ///
    /// - `reaches`: per triangle of the surface, how far points have moved that came to it.
    pub(super) fn fill(
        &mut self,
        surface: &Collapsing,
        positions: &[DVec3],
        reaches: &[Reach],
        vertex: u32,
    ) -> bool {
        self.is_fan(surface, vertex) && {
            let centre = positions[vertex as usize];
            self.places.clear();
            self.places
                .extend(self.ring.iter().map(|&v| positions[v as usize] - centre));
            self.before.clear();
            self.before
                .extend(self.triangles.iter().map(|&t| reaches[t as usize]));
            self.has_axis()
        }
    }

    fn is_fan(&mut self, surface: &Collapsing, vertex: u32) -> bool {
        self.ring.clear();
        self.triangles.clear();
        let count = surface.around(vertex).len();
        if !(3..=MOST_NEIGHBOURS).contains(&count) {
            return false;
        }
        let first = surface.spokes(vertex).next().map(|spoke| spoke.next);
        let mut next = first;
        for _ in 0..count {
            let Some(spoke) = surface.spokes(vertex).find(|s| Some(s.next) == next) else {
                return false;
            };
            self.ring.push(spoke.next);
            self.triangles.push(spoke.triangle);
            next = Some(spoke.last);
        }
        next == first
    }

    /// The axis is in the middle between the two normals that differ most.
    fn has_axis(&mut self) -> bool {
        let count = self.ring.len();
        self.normals.clear();
        self.normals.extend((0..count).map(|i| {
            let area = self.places[i].cross(self.places[(i + 1) % count]);
            area.normalize_or_zero()
        }));
        let mut least = f64::INFINITY;
        for (i, one) in self.normals.iter().enumerate() {
            for other in &self.normals[..=i] {
                if one.dot(*other) < least {
                    least = one.dot(*other);
                    self.axis = (one + other).normalize_or_zero();
                }
            }
        }
        let farthest = self.places.iter().map(|p| p.length_squared());
        self.rounding = HEIGHT_ROUNDING * UNIT_ROUNDOFF * farthest.fold(0.0, f64::max).sqrt();
        self.across = self.axis.any_orthonormal_pair().into();
        let [x, y] = self.across;
        self.framed.clear();
        self.framed.extend(
            self.places
                .iter()
                .map(|p| DVec3::new(p.dot(x), p.dot(y), p.dot(self.axis))),
        );
        self.normals
            .iter()
            .all(|normal| normal.dot(self.axis) >= LEAST_COSINE)
    }

    /// Whether the edge to a neighbour is sharp.
    pub(super) fn is_sharp(&self, neighbour: usize) -> bool {
        let before = (neighbour + self.ring.len() - 1) % self.ring.len();
        self.normals[before].dot(self.normals[neighbour]) < SHARP
    }

    /// The unit normal of a triangle.
    pub(super) fn normal(&self, triangle: usize) -> DVec3 {
        self.normals[triangle]
    }

    /// The squared length of the edge to a neighbour.
    pub(super) fn length_squared(&self, neighbour: usize) -> f64 {
        self.places[neighbour].length_squared()
    }

    /// The axis, and the least and the largest height of a corner above the vertex.
    pub(super) fn slab(&self) -> (DVec3, [f64; 2]) {
        let heights = self.framed.iter().map(|p| p.z);
        let [low, high] = heights.fold([0.0_f64; 2], |[low, high], z| [low.min(z), high.max(z)]);
        (self.axis, [low - self.rounding, high + self.rounding])
    }

    /// The triangles that remain when the vertex moves to a neighbour, by their numbers among
    /// [`Star::triangles`].
    pub(super) fn remaining(&self, to: usize) -> impl Iterator<Item = usize> + use<> {
        let count = self.ring.len();
        (1..count - 1).map(move |j| (to + j) % count)
    }

    /// Finds how far points will have moved that come to the triangles that remain when the vertex
    /// moves to neighbour `to`; returns the largest distance. `None` if it exceeds `limit`, or where
    /// a triangle would turn over, turn too far, or have hardly any area.
    pub(super) fn moved(&mut self, to: usize, limit: f64) -> Option<f64> {
        let mut after = std::mem::take(&mut self.after);
        after.clear();
        let are_upright = self
            .remaining(to)
            .all(|triangle| self.stays_upright(to, triangle));
        if are_upright {
            self.find_moved(to, &mut after);
        }
        self.after = after;
        let farthest = self.after.iter().map(Reach::distance).fold(0.0, f64::max);
        (are_upright && farthest <= limit).then_some(farthest)
    }

    fn find_moved(&self, to: usize, after: &mut Vec<Reach>) {
        let count = self.ring.len();
        // From here on neighbours and triangles are counted from neighbour `to`. New triangle j has
        // the corners 0, j and j + 1; it replaces triangle j.
        let at = |i: usize| self.framed[(to + i) % count];
        let reach = |i: usize| self.before[(to + i) % count];
        let kept = at(0);
        let from_kept = |i: usize| at(i).xy() - kept.xy();
        let vertex = -kept.xy();
        for j in 1..count - 1 {
            // It overlaps the triangle with the same outer edge.
            let mut own = reach(j);
            let (a, b) = (from_kept(j), from_kept(j + 1));
            let area = a.perp_dot(b);
            let [s, t] = [vertex.perp_dot(b) / area, a.perp_dot(vertex) / area];
            // Seen from the kept corner, in this triangle: the vertex.
            if s >= 0.0 && t >= 0.0 {
                let height = kept.z + s * (at(j).z - kept.z) + t * (at(j + 1).z - kept.z);
                for i in 0..count {
                    own = own.or(reach(i).moved(self.axis * height, self.rounding));
                }
            }
            after.push(own);
        }
        after[0] = after[0].or(reach(0));
        after[count - 3] = after[count - 3].or(reach(count - 1));
        for j in 2..count - 1 {
            for i in (1..count).filter(|&i| i != j) {
                let Some(height) = rise(kept, [at(i), at(j)]) else {
                    continue;
                };
                let both = reach(i)
                    .or(reach(i - 1))
                    .moved(self.axis * height, self.rounding);
                after[j - 2] = after[j - 2].or(both);
                after[j - 1] = after[j - 1].or(both);
            }
        }
    }

    /// The corners of another triangle, seen along the axis.
    ///
    /// - `centre`: the vertex.
    pub(super) fn seen(&self, corners: [u32; 3], centre: DVec3, positions: &[DVec3]) -> [Seen; 3] {
        corners.map(|corner| {
            let neighbour = self.ring.iter().position(|&v| v == corner);
            if let Some(neighbour) = neighbour {
                return Seen {
                    neighbour: Some(neighbour),
                    at: self.framed[neighbour].xy(),
                    rounding: self.rounding,
                };
            }
            let place = positions[corner as usize] - centre;
            let [x, y] = self.across;
            Seen {
                neighbour,
                at: DVec2::new(place.dot(x), place.dot(y)),
                rounding: self
                    .rounding
                    .max(HEIGHT_ROUNDING * UNIT_ROUNDOFF * place.length()),
            }
        })
    }

    /// Whether another triangle, seen along the axis, is certainly beside the triangle of the
    /// neighbours `to`, `j` and `j + 1`, so that they have no more in common than corners and edge.
    pub(super) fn is_beside(&self, to: usize, j: usize, other: &[Seen; 3]) -> bool {
        let corners = [to, j, (j + 1) % self.ring.len()];
        [[0, 1], [1, 2], [2, 0]].into_iter().any(|edge| {
            let ends = edge.map(|k| corners[k]);
            let [from, end] = ends.map(|i| self.framed[i].xy());
            other.iter().all(|corner| {
                let is_end = corner.neighbour.is_some_and(|i| ends.contains(&i));
                is_end || is_right_of(end - from, corner.at - from, corner.rounding)
            })
        })
    }

    /// Whether the triangle at neighbours `j` and `j + 1` is upright with its third corner at
    /// neighbour `to`.
    fn stays_upright(&self, to: usize, j: usize) -> bool {
        let [a, b, c] = [to, j, (j + 1) % self.ring.len()];
        let flat = [a, b, c].map(|i| self.framed[i].xy());
        let seen = (flat[1] - flat[0]).perp_dot(flat[2] - flat[0]);
        let [a, b, c] = [a, b, c].map(|i| self.places[i]);
        let area = (b - a).cross(c - a);
        let size = area.length();
        let longest = [b - a, c - b, a - c]
            .map(DVec3::length_squared)
            .into_iter()
            .fold(0.0, f64::max);
        size > THINNEST * longest
            && seen >= LEAST_COSINE * size
            && self.normals.iter().any(|old| old.dot(area) >= SHARP * size)
    }
}

/// A corner of a triangle near a star, seen along its axis.
pub(super) struct Seen {
    /// Its number in the ring, if it is there.
    neighbour: Option<usize>,
    at: DVec2,
    /// A bound on the rounding of this place and of those of the ring.
    rounding: f64,
}

/// Whether a point is certainly to the right of a line, both given from one point of the line and
/// each off by up to twice the rounding.
fn is_right_of(line: DVec2, point: DVec2, rounding: f64) -> bool {
    let certain = 4.0 * rounding * (line.length() + point.length() + rounding);
    line.perp_dot(point) < -certain
}

/// By how much the new edge from `kept` to `end` is above the old one from the vertex, the origin,
/// to `spoke`, where they cross.
fn rise(kept: DVec3, [spoke, end]: [DVec3; 2]) -> Option<f64> {
    let along: DVec2 = (end - kept).xy();
    let [vertex, tip] = [DVec3::ZERO, spoke].map(|p| along.perp_dot(p.xy() - kept.xy()));
    if vertex * tip >= 0.0 {
        return None;
    }
    let on_spoke = vertex / (vertex - tip);
    let crossing = on_spoke * spoke.xy() - kept.xy();
    let on_edge = crossing.dot(along) / along.length_squared();
    let rise = kept.z + on_edge * (end.z - kept.z) - on_spoke * spoke.z;
    (0.0..=1.0).contains(&on_edge).then_some(rise)
}
