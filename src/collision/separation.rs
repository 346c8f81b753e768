//! Planes that keep two moving triangles, segments or points apart for a stretch of time, certified.
//!
//! Between the nearest points of two convex things lies a plane. How it has to move to stay between them depends on the features
//! that are nearest: with a face it is carried along, with a side and a corner by the body of the side, and between two sides it stays parallel to both. Its
//! normal n(s) is a polynomial of time then, and so is the height n . (a - b) of any corner a of the one over any corner b of the
//! other. As long as all of these exceed (d + e) |n| the distance exceeds d; e bounds the error of positions.
//!
//! The length of n is bounded by a polynomial too: |n| <= (n . n + c^2) / (2 c) for any c > 0; with c = |n| at
//! the beginning the difference is of second order.

use super::chart::{Chart, Curve};
use super::nearest::{Nearest, Part, nearest};
use crate::numeric::area::area_vector;
use crate::numeric::roots::{MOST_TERMS, positive_until};
use crate::numeric::tolerance::{CONTACT_ROUNDING, DOUBTFUL_CONTACT, ROOT_RESOLUTION};
use glam::DVec3;

/// Steps of one search; past them a pair is undecided. Ordinary contacts take 4 to 8, grazing ones some 20.
const MOST_STEPS: usize = 500;

/// Steps after which all planes are tried, not only the one that the nearest points suggest.
const QUICK_STEPS: usize = 10;

/// Part of the time that is left that a plane without a turn has to be good for, if another one is to be tried.
const FAIR_LEAP: f64 = 0.03;

/// Two things with one, two or three corners each, over one window.
pub(super) struct Pair<'a> {
    pub(super) charts: [&'a Chart; 2],
    pub(super) curves: [&'a [Curve]; 2],
    /// Half the width of the window.
    pub(super) half: f64,
    /// Distance below which they are too close.
    pub(super) threshold: f64,
}

/// What becomes of a pair during a stretch of time.
#[derive(Debug, Clone, Copy)]
pub(super) enum Course {
    /// Farther apart than the threshold throughout, at the end of it in about this direction, if it was looked at.
    Apart(Option<DVec3>),
    /// At the threshold, within rounding, for the first time.
    Met(Meeting),
    /// Apart before this time; then work or precision ran out.
    Unknown(f64),
}

/// A pair at the threshold. Times are from the middle of the window.
#[derive(Debug, Clone, Copy)]
pub(super) struct Meeting {
    /// Apart before this time, for certain.
    pub(super) after: f64,
    /// Best estimate of when the threshold is passed.
    pub(super) time: f64,
    /// Closer than the threshold, certainly or within rounding, at this time.
    pub(super) by: f64,
    /// Whether they cross (the threshold is passed) for certain by then.
    pub(super) crosses: bool,
    /// The nearest points and parts at `after`.
    pub(super) nearest: Nearest,
    /// Unit vector from the second to the first.
    pub(super) normal: DVec3,
    /// Speed at which the nearest points approach each other along it.
    pub(super) closing: f64,
}

/// A stretch of time during which a pair is apart for certain.
pub(super) struct Clearing {
    /// When it ends.
    pub(super) until: f64,
    /// Unit normal of the last plane between them.
    pub(super) normal: DVec3,
    /// Where they are at its end, if that comes before the end of what was asked for.
    pub(super) placed: Option<Placed>,
}

/// Both things at one time.
pub(super) struct Placed {
    /// As many of each as it has.
    pub(super) corners: [[DVec3; 3]; 2],
    pub(super) near: Nearest,
}

/// Which motion a plane follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Carrier {
    First,
    Second,
    /// It stays parallel to this side of the first and that of the second.
    Both([usize; 2]),
}

impl Pair<'_> {
    /// Positions of the corners at a time.
    pub(super) fn corners(&self, which: usize, time: f64, into: &mut [DVec3; 3]) -> usize {
        let curves = self.curves[which];
        for (corner, curve) in into.iter_mut().zip(curves) {
            *corner = curve.at(self.charts[which].terms, time);
        }
        curves.len()
    }

    /// Both at a time.
    pub(super) fn placed(&self, time: f64) -> Placed {
        let mut corners = [[DVec3::ZERO; 3]; 2];
        let [a, b] = &mut corners;
        let counts = [self.corners(0, time, a), self.corners(1, time, b)];
        let near = nearest(&a[..counts[0]], &b[..counts[1]]);
        Placed { corners, near }
    }

    /// Nearest points at a time.
    pub(super) fn nearest(&self, time: f64) -> Nearest {
        self.placed(time).near
    }

    /// Bound of the error of a distance.
    pub(super) fn slack(&self) -> f64 {
        self.charts[0].slack + self.charts[1].slack
    }

    /// The first time in [`from`, `to`] at which the pair comes as close as the threshold; gives up as `Apart` when it is certain not
    /// to happen before `limit`.
    ///
    /// # Why it ends
    /// Each step stands on a plane that is exact at its beginning, and takes off a part of the gap that tends to all of it:
    /// convergence is quadratic. Where the gap has a minimum just above rounding, steps first shrink and then grow geometrically.
    pub(super) fn course(&self, from: f64, to: f64, limit: f64) -> Course {
        let slack = self.slack();
        if !slack.is_finite() {
            return Course::Unknown(from);
        }
        let mut time = from;
        for step in 0..MOST_STEPS {
            if time > limit {
                return Course::Apart(None);
            }
            let placed = self.placed(time);
            let distance = placed.near.distance();
            if distance <= self.threshold + CONTACT_ROUNDING * slack {
                return Course::Met(self.meeting(time, &placed));
            }
            let mut until = self.apart_until(&placed, time, to);
            if until < to && (step >= QUICK_STEPS || self.is_stuck(time, until)) {
                until = until.max(self.any_plane_until(time, to));
            }
            if self.is_stuck(time, until) {
                let gap = distance - self.threshold - CONTACT_ROUNDING * slack;
                until = until.max(self.unreachable_until(gap, time, to));
            }
            if until >= to {
                let [a, b] = placed.near.points;
                return Course::Apart((a - b).try_normalize());
            }
            if self.is_stuck(time, until) {
                break;
            }
            time = until;
        }
        // What cannot be certified apart is contact, if it is near enough to be one.
        let placed = self.placed(time);
        if placed.near.distance() <= self.threshold + DOUBTFUL_CONTACT * slack {
            Course::Met(self.meeting(time, &placed))
        } else {
            Course::Unknown(time)
        }
    }

    /// How far planes that keep their direction hold the two apart: soon found, but not sharp.
    ///
    /// What is left is for [`course`](Pair::course): paths of few terms serve here.
    pub(super) fn clear_until(&self, from: f64, to: f64) -> Clearing {
        let slack = self.slack();
        let mut time = from;
        loop {
            let placed = self.placed(time);
            let normal = self.direction(&placed);
            let near = self.threshold + CONTACT_ROUNDING * slack;
            let is_apart = slack.is_finite() && placed.near.distance() > near;
            let until = if is_apart {
                self.still_plane_until(normal, time, to)
            } else {
                time
            };
            if is_apart && until >= to {
                return Clearing {
                    until: to,
                    normal,
                    placed: None,
                };
            }
            if !is_apart || until - time <= FAIR_LEAP * (to - time) {
                return Clearing {
                    until: time,
                    normal,
                    placed: Some(placed),
                };
            }
            time = until;
        }
    }

    /// How long the nearest points would take to meet if they went on as they do; infinite where they do not approach.
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

    /// A time up to which some plane keeps the two apart.
    fn apart_until(&self, placed: &Placed, time: f64, to: f64) -> f64 {
        let carriers: &[Carrier] = match placed.near.parts {
            [Part::Corner(_), _] => &[Carrier::Second, Carrier::First],
            [_, Part::Corner(_)] => &[Carrier::First, Carrier::Second],
            [Part::Side(i), Part::Side(j)] => {
                &[Carrier::Both([i, j]), Carrier::Second, Carrier::First]
            }
            _ => return time,
        };
        let normal = self.direction(placed);
        let mut until = time;
        for (number, &carrier) in carriers.iter().enumerate() {
            // What follows the nearest features is tried alone unless it fails.
            if number > 0 && !self.is_stuck(time, until) {
                break;
            }
            until = until.max(self.plane_until(normal, carrier, time, to));
            if until >= to {
                break;
            }
        }
        until
    }

    /// A time up to which the two cannot cross a gap, however they move.
    ///
    /// Between nearly parallel sides no plane is sharp enough, and this is slow, but always makes headway.
    fn unreachable_until(&self, gap: f64, time: f64, to: f64) -> f64 {
        let latest = time.abs().max(to.abs());
        let speed = |which: usize| {
            let terms = self.charts[which].terms;
            let of = |curve: &Curve| {
                (1..terms)
                    .rev()
                    .fold(0.0, |sum, k| sum * latest + k as f64 * curve.0[k].length())
            };
            self.curves[which].iter().map(of).fold(0.0, f64::max)
        };
        (time + gap / (speed(0) + speed(1))).min(to)
    }

    /// Whether a step makes no headway.
    fn is_stuck(&self, time: f64, until: f64) -> bool {
        until - time <= ROOT_RESOLUTION * (time.abs() + self.half)
    }

    /// A time up to which some plane through a face, or along two sides, keeps the two apart.
    ///
    /// Two points at a distance of 1e-9 give the direction between them to 1e-7 only, too little where corners and sides lie over a
    /// face. One of these planes always separates what is apart, and they are sharp.
    fn any_plane_until(&self, time: f64, to: f64) -> f64 {
        let mut corners = [[DVec3::ZERO; 3]; 2];
        let counts = [0, 1].map(|which: usize| self.corners(which, time, &mut corners[which]));
        let mut until = time;
        let mut consider = |normal: DVec3, carrier: Carrier| {
            let Some(normal) = normal.try_normalize() else {
                return;
            };
            let heights = |which: usize| {
                let of = corners[which][..counts[which]]
                    .iter()
                    .map(|c| normal.dot(*c));
                of.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], h| {
                    [low.min(h), high.max(h)]
                })
            };
            let ([low_a, high_a], [low_b, high_b]) = (heights(0), heights(1));
            let (gap, opposite) = (low_a - high_b, low_b - high_a);
            if gap.max(opposite) > self.threshold && until < to {
                let normal = if gap < opposite { -normal } else { normal };
                until = until.max(self.plane_until(normal, carrier, time, to));
            }
        };
        for (which, carrier) in [(1, Carrier::Second), (0, Carrier::First)] {
            if counts[which] == 3 {
                consider(area_vector(corners[which]), carrier);
            }
        }
        let side =
            |which: usize, k: usize| corners[which][(k + 1) % counts[which]] - corners[which][k];
        let sides = counts.map(|count| if count == 3 { 3 } else { count - 1 });
        for i in 0..sides[0] {
            for j in 0..sides[1] {
                consider(side(0, i).cross(side(1, j)), Carrier::Both([i, j]));
            }
        }
        // In the plane of a face, across a side: what lies in one plane, and what has no faces.
        for (which, carrier) in [(1, Carrier::Second), (0, Carrier::First)] {
            let other = 1 - which;
            for k in 0..sides[which] {
                let along = side(which, k);
                if counts[which] == 3 {
                    consider(along.cross(area_vector(corners[which])), carrier);
                }
                for corner in &corners[other][..counts[other]] {
                    let away = *corner - corners[which][k];
                    consider(along.cross(away).cross(along), carrier);
                }
            }
        }
        until
    }

    /// Unit normal of the plane between the nearest points, as sharp as the features allow.
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

    /// A time up to which the plane with this normal at `time` keeps the two apart.
    fn plane_until(&self, normal: DVec3, carrier: Carrier, time: f64, to: f64) -> f64 {
        let keeps_direction = match carrier {
            Carrier::First => self.charts[0].terms <= 2,
            Carrier::Second => self.charts[1].terms <= 2,
            Carrier::Both(_) => false,
        };
        if keeps_direction {
            return self.still_plane_until(normal, time, to);
        }
        let (normals, count) = self.normals(normal, carrier, time);
        let total = count.max(self.charts[0].terms).max(self.charts[1].terms);
        // (d + e) |n|.
        let size = Curve(normals).at(count, time).length();
        if size == 0.0 {
            return time;
        }
        let mut margin = [0.0; MOST_TERMS];
        let higher: f64 = normals[1..count]
            .iter()
            .rev()
            .fold(0.0, |sum, n| (sum + n.abs().element_sum()) * self.half);
        let longest = normals[0].length() + higher;
        if self.threshold > 0.0 {
            dot(&normals[..count], &normals[..count], &mut margin[..total]);
            for coefficient in &mut margin[..total] {
                *coefficient *= self.threshold / (2.0 * size);
            }
            margin[0] += self.threshold * size / 2.0;
        }
        margin[0] += self.slack() * longest;

        let mut heights = [[[0.0; MOST_TERMS]; 3]; 2];
        for (which, heights) in heights.iter_mut().enumerate() {
            let terms = self.charts[which].terms;
            for (height, curve) in heights.iter_mut().zip(self.curves[which]) {
                dot(&normals[..count], &curve.0[..terms], &mut height[..total]);
            }
        }
        self.above_until(&mut heights, [false; 2], &margin[..total], [time, to])
    }

    /// A time up to which a plane that keeps this unit normal holds the two apart.
    fn still_plane_until(&self, normal: DVec3, time: f64, to: f64) -> f64 {
        let total = self.charts[0].terms.max(self.charts[1].terms);
        let mut heights = [[[0.0; MOST_TERMS]; 3]; 2];
        for (which, heights) in heights.iter_mut().enumerate() {
            let terms = self.charts[which].terms;
            for (height, curve) in heights.iter_mut().zip(self.curves[which]) {
                for (height, place) in height.iter_mut().zip(&curve.0[..terms]) {
                    *height = normal.dot(*place);
                }
            }
        }
        let mut margin = [0.0; MOST_TERMS];
        margin[0] = (self.threshold + self.slack()) * normal.length();
        let still = [0, 1].map(|which: usize| self.charts[which].terms == 1);
        self.above_until(&mut heights, still, &margin[..total], [time, to])
    }

    /// A time up to which all heights of the first exceed those of the second by more than a margin.
    ///
    /// - `still`: whose heights stay what they are.
    fn above_until(
        &self,
        heights: &mut [[[f64; MOST_TERMS]; 3]; 2],
        still: [bool; 2],
        margin: &[f64],
        [time, to]: [f64; 2],
    ) -> f64 {
        let total = margin.len();
        let mut counts = [self.curves[0].len(), self.curves[1].len()];
        for which in [0, 1] {
            if still[which] {
                // One counts: the lowest of the first, the highest of the second.
                let own = heights[which][..counts[which]].iter().map(|h| h[0]);
                heights[which][0][0] = if which == 0 {
                    own.fold(f64::INFINITY, f64::min)
                } else {
                    own.fold(f64::NEG_INFINITY, f64::max)
                };
                counts[which] = 1;
            }
        }
        let [first, second] = &*heights;
        let mut until = to;
        let mut gap = [0.0; MOST_TERMS];
        for a in &first[..counts[0]] {
            for b in &second[..counts[1]] {
                for k in 0..total {
                    gap[k] = a[k] - b[k] - margin[k];
                }
                // Often nothing happens in all of the window.
                let change = gap[1..total]
                    .iter()
                    .rev()
                    .fold(0.0, |sum, c| (sum + c.abs()) * self.half);
                if gap[0] > change {
                    continue;
                }
                until = until.min(positive_until(&gap[..total], time, until));
                if until <= time {
                    return time;
                }
            }
        }
        until
    }

    /// The normal as a polynomial, and how many coefficients it has.
    fn normals(&self, normal: DVec3, carrier: Carrier, time: f64) -> ([DVec3; MOST_TERMS], usize) {
        let mut normals = [DVec3::ZERO; MOST_TERMS];
        let carried = |chart: &Chart, normals: &mut [DVec3; MOST_TERMS]| {
            // n' = -M^T n: planes that the motion carries along.
            let back = -chart.generator.linear.transpose();
            normals[0] = normal;
            let terms = chart.terms;
            // First to the middle of the window, backwards in time.
            let mut power = normal;
            for k in 1..terms {
                power = back * power * (-time / k as f64);
                normals[0] += power;
            }
            for k in 1..terms {
                normals[k] = back * normals[k - 1] * (1.0 / k as f64);
            }
            terms
        };
        let count = match carrier {
            Carrier::First => carried(self.charts[0], &mut normals),
            Carrier::Second => carried(self.charts[1], &mut normals),
            Carrier::Both(sides) => {
                let side = |which: usize, k: usize| {
                    let curves = self.curves[which];
                    let from = sides[which];
                    curves[(from + 1) % curves.len()].0[k] - curves[from].0[k]
                };
                let terms = [self.charts[0].terms, self.charts[1].terms];
                let count = terms[0].max(terms[1]);
                for i in 0..terms[0] {
                    let a = side(0, i);
                    for j in 0..terms[1].min(count - i) {
                        normals[i + j] += a.cross(side(1, j));
                    }
                }
                if Curve(normals).at(count, time).dot(normal) < 0.0 {
                    normals.iter_mut().for_each(|n| *n = -*n);
                }
                count
            }
        };
        (normals, count)
    }
}

/// Sine of the angle between two sides below which they count as parallel when a direction across both is wanted: half of the digits of
/// their cross product are left.
const PARALLEL: f64 = 1e-7;

/// Coefficients of the product of two polynomials of vectors, as many as there is room for.
fn dot(a: &[DVec3], b: &[DVec3], into: &mut [f64]) {
    into.fill(0.0);
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate().take(into.len().saturating_sub(i)) {
            into[i + j] += x.dot(*y);
        }
    }
}
