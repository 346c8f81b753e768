//! Two triangles, segments or points, each on its path through one window.

use super::chart::Chart;
use super::nearest::{Nearest, Part, nearest};
use crate::motion::expansion::Curve;
use crate::numeric::area::area_vector;
use glam::DVec3;

/// Two things with one, two or three corners each, over one window.
pub(super) struct MovingPair<'a> {
    pub(super) charts: [&'a Chart; 2],
    pub(super) curves: [&'a [Curve]; 2],
    /// Half the width of the window.
    pub(super) half: f64,
    /// Distance below which they are too close.
    pub(super) threshold: f64,
}

/// Both things at one time.
pub(super) struct Placed {
    /// The corners of each, as many as it has.
    pub(super) corners: [[DVec3; 3]; 2],
    pub(super) near: Nearest,
}

impl MovingPair<'_> {
    /// Writes the positions of the corners at a time, and returns their number.
    pub(super) fn corners(&self, which: usize, time: f64, into: &mut [DVec3; 3]) -> usize {
        let curves = self.curves[which];
        for (corner, curve) in into.iter_mut().zip(curves) {
            *corner = curve.at(self.charts[which].terms, time);
        }
        curves.len()
    }

    /// Both things at a time.
    pub(super) fn placed(&self, time: f64) -> Placed {
        let mut corners = [[DVec3::ZERO; 3]; 2];
        let [a, b] = &mut corners;
        let counts = [self.corners(0, time, a), self.corners(1, time, b)];
        let near = nearest(&a[..counts[0]], &b[..counts[1]]);
        Placed { corners, near }
    }

    /// The nearest points at a time.
    pub(super) fn nearest(&self, time: f64) -> Nearest {
        self.placed(time).near
    }

    /// Bound on the error of a distance.
    pub(super) fn slack(&self) -> f64 {
        self.charts[0].slack + self.charts[1].slack
    }

    /// The time that the nearest points would take to meet if they kept their velocities; infinite
    /// where they do not approach.
    pub(super) fn ahead(&self, placed: &Placed) -> f64 {
        let [a, b] = placed.near.points;
        let between = a - b;
        let velocity = |which: usize, point: DVec3| self.charts[which].generator.velocity(point);
        let closing = between.dot(velocity(1, b) - velocity(0, a));
        if closing > 0.0 {
            placed.near.distance_squared / closing
        } else {
            f64::INFINITY
        }
    }

    /// The unit normal of a plane between the nearest points, as accurate as the features allow.
    pub(super) fn direction(&self, placed: &Placed) -> DVec3 {
        let Placed {
            corners: [a, b],
            near,
        } = placed;
        let between = near.points[0] - near.points[1];
        let side = |corners: &[DVec3; 3], which: usize, number: usize| {
            corners[(number + 1) % self.curves[which].len()] - corners[number]
        };
        let across = |along: DVec3| {
            between - along * (along.dot(between) / along.length_squared().max(f64::MIN_POSITIVE))
        };
        let sharp = match near.parts {
            [_, Part::Inside] => area_vector(*b),
            [Part::Inside, _] => area_vector(*a),
            [Part::Side(i), Part::Side(j)] => {
                let (u, v) = (side(a, 0, i), side(b, 1, j));
                let cross = u.cross(v);
                if cross.length_squared()
                    > PARALLEL * PARALLEL * u.length_squared() * v.length_squared()
                {
                    cross
                } else {
                    across(u)
                }
            }
            [Part::Side(i), _] => across(side(a, 0, i)),
            [_, Part::Side(j)] => across(side(b, 1, j)),
            _ => between,
        };
        let sharp = if sharp.dot(between) < 0.0 {
            -sharp
        } else {
            sharp
        };
        sharp.normalize_or(DVec3::Z)
    }
}

/// Sine of the angle between two sides below which they count as parallel when a direction across
/// both is needed: above it, at least half of the digits of their cross product are valid.
const PARALLEL: f64 = 1e-7;
