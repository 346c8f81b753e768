//! Whether a piece of a surface can be pushed out of a solid by a depth, and for how long it then
//! stays out.
//!
//! Suppose that a piece, moved by a vector not longer than a depth, meets no triangle of the
//! solid's surface and lies outside the solid. Then it is nowhere deeper than that: the path from
//! each point to its moved place leads out through the surface. The same planes as everywhere
//! (`separation`) certify that it meets nothing, for as long as they hold; one point that is
//! outside then shows that all are, at all these times. The choice of the vector does not matter
//! for the proof: the normals of the triangles nearby are tried, and the direction that leads away
//! from all of them.

use super::clip::Clipped;
use super::depth::PlacedSolid;
use super::halfspace::farthest_out;
use super::moving_pair::MovingPair;
use super::nearest::nearest;
use super::separation::{self, Course};
use super::triangle_piece::Plane;
use super::window::Window;
use crate::motion::expansion::Curve;
use crate::numeric::area::area_vector;
use crate::numeric::tolerance::CONTACT_ROUNDING;
use glam::DVec3;
use std::cell::Cell;

/// A triangle of the solid that may be near during a stretch of a window.
#[derive(Debug, Clone, Copy)]
pub(super) struct Near {
    pub(super) triangle: u32,
    pub(super) from: f64,
    pub(super) to: f64,
}

/// A moving piece in a window, and the triangles that may be near it.
pub(super) struct Pushing<'a> {
    pub(super) at: &'a Window,
    /// The number of the shape to which the piece belongs; the other one is the solid.
    pub(super) pushed: usize,
    /// Paths of the corners.
    pub(super) curves: [Curve; 3],
    /// The corners of the triangles of the solid, in its own frame.
    pub(super) corners_of: &'a dyn Fn(u32) -> [DVec3; 3],
    pub(super) near: &'a [Near],
    /// Counts the triangles that are examined.
    pub(super) looked_at: &'a Cell<usize>,
}

/// Triangles near a piece at one time.
pub(super) struct Surroundings {
    /// Corners of the piece.
    pub(super) corners: [DVec3; 3],
    /// Distance and corners of the triangles, nearest first.
    triangles: Vec<(f64, [DVec3; 3])>,
    /// The distinct planes of those within some distance.
    pub(super) planes: Vec<Plane>,
}

/// Most planes that are considered at one place.
const MOST_PLANES: usize = 8;

/// Fraction of the squared length up to which the last successful vector may serve again.
const STILL_SHORT: f64 = 1.0 - 1e-9;

/// Most vectors that are followed from one place; more are examined.
const MOST_TRIED: usize = 3;

/// Fraction of the push length that must remain as a gap for no better vector to be sought.
const GOOD: f64 = 0.7;

impl Pushing<'_> {
    fn look_at(&self, triangles: usize) {
        self.looked_at.set(self.looked_at.get() + triangles);
    }

    /// The surroundings at a time, with the planes of the triangles within `reach`.
    pub(super) fn around(&self, time: f64, reach: f64) -> Surroundings {
        let chart = &self.at.charts[self.pushed];
        let other = &self.at.charts[1 - self.pushed];
        let corners = self.curves.map(|curve| curve.at(chart.terms, time));
        let place = |point: DVec3| other.curve(point).at(other.terms, time);
        let mut triangles: Vec<(f64, [DVec3; 3])> = self
            .near
            .iter()
            .filter(|near| near.from <= time && time <= near.to)
            .map(|near| {
                let placed = (self.corners_of)(near.triangle).map(place);
                (nearest(&corners, &placed).distance(), placed)
            })
            .collect();
        self.look_at(self.near.len());
        triangles.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut planes: Vec<Plane> = Vec::new();
        for (distance, placed) in &triangles {
            if *distance > reach || planes.len() == MOST_PLANES {
                break;
            }
            let Some(normal) = area_vector(*placed).try_normalize() else {
                continue;
            };
            let offset = normal.dot(placed[0]);
            let plane = Plane { normal, offset };
            if !planes
                .iter()
                .any(|known| known.is_same(&plane, SAME_HEIGHT * reach))
            {
                planes.push(plane);
            }
        }
        Surroundings {
            corners,
            triangles,
            planes,
        }
    }

    /// A time up to which, from `from` on, some vector of at most this length keeps the piece out
    /// of the solid; `from` if none is found.
    ///
    /// - `solid`: the solid at that time. `last`: the last successful vector; replaced by the one
    ///   that succeeds now.
    pub(super) fn out_until(
        &self,
        around: &Surroundings,
        solid: &PlacedSolid,
        length: f64,
        [from, to]: [f64; 2],
        last: &mut DVec3,
    ) -> f64 {
        let slack = self.at.slack;
        let room = |vector: DVec3| -> f64 {
            let moved = around.corners.map(|corner| corner + vector);
            let mut least = f64::INFINITY;
            for (distance, triangle) in &around.triangles {
                // No nearer triangle can follow.
                if *distance - length >= least {
                    break;
                }
                self.look_at(1);
                least = least.min(nearest(&moved, triangle).distance());
                if least <= CONTACT_ROUNDING * slack {
                    return 0.0;
                }
            }
            let middle = (moved[0] + moved[1] + moved[2]) / 3.0;
            if solid.contains(middle) { 0.0 } else { least }
        };
        let mut until = from;
        if room(DVec3::ZERO) > 0.0 {
            until = self.clear_until(DVec3::ZERO, from, to);
            if until >= to {
                return to;
            }
        }
        if last.length_squared() <= length * length * STILL_SHORT
            && *last != DVec3::ZERO
            && room(*last) > 0.0
        {
            until = until.max(self.clear_until(*last, from, to));
            if until - from > FAIR * (to - from) {
                return until;
            }
        }
        let length = length * SHORTER;
        // The distance by which each plane requires it to be pushed; planes that require too much
        // are left out, since the piece may be beyond an edge.
        let wanted = around.planes.iter().filter_map(|plane| {
            let deepest = around.corners.map(|c| -plane.height(c));
            let wanted = deepest.into_iter().fold(f64::NEG_INFINITY, f64::max);
            (wanted < length).then_some((plane.normal, wanted))
        });
        let all = farthest_out(&wanted.collect::<Vec<_>>(), length);
        let single = around.planes.iter().map(|plane| plane.normal * length);
        let mut vectors: Vec<(f64, DVec3)> = Vec::new();
        for vector in all.into_iter().chain(single) {
            let room = room(vector);
            if room > 0.0 {
                vectors.push((room, vector));
            }
            if room >= GOOD * length {
                break;
            }
        }
        vectors.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (_, vector) in vectors.into_iter().take(MOST_TRIED) {
            let next = self.clear_until(vector, from, to);
            if next > until {
                (until, *last) = (next, vector);
            }
            if until - from > FAIR * (to - from) {
                break;
            }
        }
        until
    }

    /// A time up to which the piece, moved by a vector, certainly meets no triangle.
    fn clear_until(&self, vector: DVec3, from: f64, to: f64) -> f64 {
        let (at, pushed) = (self.at, self.pushed);
        let mut moved = self.curves;
        moved.iter_mut().for_each(|curve| curve.0[0] += vector);
        let middle = moved.map(|curve| curve.0[0]);
        let mut until = to;
        for near in self.near {
            let stretch = [near.from.max(from), near.to.min(until)];
            if stretch[0] > stretch[1] {
                continue;
            }
            self.look_at(1);
            let other = &at.charts[1 - pushed];
            let own = (self.corners_of)(near.triangle);
            let there = own.map(|corner| other.pose.transform_point3(corner));
            let corners = if pushed == 0 {
                [&middle, &there]
            } else {
                [&there, &middle]
            };
            let Clipped::Open([start, end]) = at.clipper.clip(corners, at.slack, stretch) else {
                continue;
            };
            let theirs = own.map(|corner| other.curve(corner));
            let curves: [&[Curve]; 2] = if pushed == 0 {
                [&moved, &theirs]
            } else {
                [&theirs, &moved]
            };
            let pair = MovingPair {
                charts: [&at.charts[0], &at.charts[1]],
                curves,
                half: at.half,
                threshold: 0.0,
            };
            let clear = separation::clear_until(&pair, start, end);
            if clear.placed.is_none() {
                continue;
            }
            match separation::course(&pair, clear.until, end, until) {
                Course::Apart(_) => {}
                Course::Met(meeting) => until = until.min(meeting.after),
                Course::Unknown(time) => until = until.min(time),
            }
            if until <= from {
                return from;
            }
        }
        until
    }
}

/// Factor by which vectors are shorter than the depth, so that rounding does not make them longer.
const SHORTER: f64 = 1.0 - 1e-14;

/// Fraction of the reach within which parallel planes count as one.
const SAME_HEIGHT: f64 = 1e-3;

/// Fraction of the requested time for which a vector must hold for no other one to be sought.
const FAIR: f64 = 0.1;
