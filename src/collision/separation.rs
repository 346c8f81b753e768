//! Planes that certify two moving triangles, segments or points to be apart for a stretch of time.
//!
//! Between the nearest points of two convex things lies a plane. How it must move to stay between
//! them depends on the nearest features: a plane at a face is carried by the body of the face; at a
//! side and a corner, by the body of the side; and between two sides it stays parallel to both. Its
//! normal n(s) is then a polynomial of time, and so is the height n . (a - b) of any corner a of
//! one over any corner b of the other. As long as all of these exceed (d + e) |n|, the distance
//! exceeds d; e bounds the error of positions.
//!
//! The length of n is bounded by a polynomial too: |n| <= (n . n + c^2) / (2 c) for any c > 0; with
//! c = |n| at the start, the difference is of second order.

use super::chart::Chart;
use super::crossing::{self, Meeting};
use super::moving_pair::{MovingPair, Placed};
use super::nearest::Part;
use crate::motion::expansion::Curve;
use crate::numeric::area::area_vector;
use crate::numeric::roots::{MOST_TERMS, positive_until};
use crate::numeric::tolerance::{CONTACT_ROUNDING, DOUBTFUL_CONTACT, ROOT_RESOLUTION};
use glam::DVec3;

/// Most steps of one search; beyond, a pair is undecided. Ordinary contacts take 4 to 8, grazing
/// ones some 20.
const MOST_STEPS: usize = 500;

/// Number of steps after which all planes are tried, not only the one that the nearest points
/// suggest.
const QUICK_STEPS: usize = 10;

/// Fraction of the remaining time for which a plane that does not turn must hold for another such
/// plane to be tried.
const FAIR_LEAP: f64 = 0.03;

/// The course of a pair during a stretch of time.
#[derive(Debug, Clone, Copy)]
pub(super) enum Course {
    /// Farther apart than the threshold throughout; with the approximate direction between them at
    /// the end, if it was computed.
    Apart(Option<DVec3>),
    /// At the threshold, within rounding, for the first time.
    Met(Meeting),
    /// Apart before this time; then work or precision ran out.
    Unknown(f64),
}

/// A stretch of time during which a pair is certainly apart.
pub(super) struct Clearing {
    /// The end of the stretch.
    pub(super) until: f64,
    /// The unit normal of the last plane between them.
    pub(super) normal: DVec3,
    /// Both things at its end, if that is before the requested end.
    pub(super) placed: Option<Placed>,
}

/// The motion that a plane follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Carrier {
    First,
    Second,
    /// It stays parallel to these sides of the first and of the second.
    Both([usize; 2]),
}

/// The first time in [`from`, `to`] at which the pair comes as close as the threshold; stops with
/// `Apart` when it certainly does not happen before `limit`.
///
/// # Why it ends
/// Each step uses a plane that is exact at its start, and takes off a fraction of the gap that
/// tends to all of it: convergence is quadratic. Where the gap has a minimum just above rounding,
/// steps first shrink and then grow geometrically.
pub(super) fn course(pair: &MovingPair, from: f64, to: f64, limit: f64) -> Course {
    let slack = pair.slack();
    if !slack.is_finite() {
        return Course::Unknown(from);
    }
    let mut time = from;
    for step in 0..MOST_STEPS {
        if time > limit {
            return Course::Apart(None);
        }
        let placed = pair.placed(time);
        let distance = placed.near.distance();
        if distance <= pair.threshold + CONTACT_ROUNDING * slack {
            return Course::Met(crossing::meeting(pair, time, &placed));
        }
        let mut until = apart_until(pair, &placed, time, to);
        if until < to && (step >= QUICK_STEPS || is_stuck(pair, time, until)) {
            until = until.max(any_plane_until(pair, time, to));
        }
        if is_stuck(pair, time, until) {
            let gap = distance - pair.threshold - CONTACT_ROUNDING * slack;
            until = until.max(unreachable_until(pair, gap, time, to));
        }
        if until >= to {
            let [a, b] = placed.near.points;
            return Course::Apart((a - b).try_normalize());
        }
        if is_stuck(pair, time, until) {
            break;
        }
        time = until;
    }
    // A pair that cannot be certified to be apart is in contact, if it is near enough.
    let placed = pair.placed(time);
    if placed.near.distance() <= pair.threshold + DOUBTFUL_CONTACT * slack {
        Course::Met(crossing::meeting(pair, time, &placed))
    } else {
        Course::Unknown(time)
    }
}

/// How long planes with a fixed direction hold the two apart: quickly found, but not sharp.
///
/// The rest is left to [`course`]: paths of few terms suffice here.
pub(super) fn clear_until(pair: &MovingPair, from: f64, to: f64) -> Clearing {
    let slack = pair.slack();
    let mut time = from;
    loop {
        let placed = pair.placed(time);
        let normal = pair.direction(&placed);
        let near = pair.threshold + CONTACT_ROUNDING * slack;
        let is_apart = slack.is_finite() && placed.near.distance() > near;
        let until = if is_apart {
            still_plane_until(pair, normal, time, to)
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

/// A time up to which some plane separates the two.
fn apart_until(pair: &MovingPair, placed: &Placed, time: f64, to: f64) -> f64 {
    let carriers: &[Carrier] = match placed.near.parts {
        [Part::Corner(_), _] => &[Carrier::Second, Carrier::First],
        [_, Part::Corner(_)] => &[Carrier::First, Carrier::Second],
        [Part::Side(i), Part::Side(j)] => &[Carrier::Both([i, j]), Carrier::Second, Carrier::First],
        _ => return time,
    };
    let normal = pair.direction(placed);
    let mut until = time;
    for (number, &carrier) in carriers.iter().enumerate() {
        // The plane that follows the nearest features is tried alone unless it fails.
        if number > 0 && !is_stuck(pair, time, until) {
            break;
        }
        until = until.max(plane_until(pair, normal, carrier, time, to));
        if until >= to {
            break;
        }
    }
    until
}

/// A time up to which the two cannot cross a gap, however they move.
///
/// Between nearly parallel sides no plane is accurate enough; this bound is slow, but always makes
/// progress.
fn unreachable_until(pair: &MovingPair, gap: f64, time: f64, to: f64) -> f64 {
    let latest = time.abs().max(to.abs());
    let speed = |which: usize| {
        let terms = pair.charts[which].terms;
        let of = |curve: &Curve| {
            (1..terms)
                .rev()
                .fold(0.0, |sum, k| sum * latest + k as f64 * curve.0[k].length())
        };
        pair.curves[which].iter().map(of).fold(0.0, f64::max)
    };
    (time + gap / (speed(0) + speed(1))).min(to)
}

/// Whether a step makes no progress.
fn is_stuck(pair: &MovingPair, time: f64, until: f64) -> bool {
    until - time <= ROOT_RESOLUTION * (time.abs() + pair.half)
}

/// A time up to which some plane through a face, or along two sides, separates the two.
///
/// Two points at a distance of 1e-9 determine the direction between them only to 1e-7, which is too
/// little where corners and sides lie over a face. One of the planes tried here always separates
/// two things that are apart, and they are accurate.
fn any_plane_until(pair: &MovingPair, time: f64, to: f64) -> f64 {
    let mut corners = [[DVec3::ZERO; 3]; 2];
    let counts = [0, 1].map(|which: usize| pair.corners(which, time, &mut corners[which]));
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
        if gap.max(opposite) > pair.threshold && until < to {
            let normal = if gap < opposite { -normal } else { normal };
            until = until.max(plane_until(pair, normal, carrier, time, to));
        }
    };
    for (which, carrier) in [(1, Carrier::Second), (0, Carrier::First)] {
        if counts[which] == 3 {
            consider(area_vector(corners[which]), carrier);
        }
    }
    let side = |which: usize, k: usize| corners[which][(k + 1) % counts[which]] - corners[which][k];
    let sides = counts.map(|count| if count == 3 { 3 } else { count - 1 });
    for i in 0..sides[0] {
        for j in 0..sides[1] {
            consider(side(0, i).cross(side(1, j)), Carrier::Both([i, j]));
        }
    }
    // Normals in the plane of a face, across a side: for two things in one plane, and for things
    // without faces.
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

/// A time up to which the plane with this normal at `time` separates the two.
fn plane_until(pair: &MovingPair, normal: DVec3, carrier: Carrier, time: f64, to: f64) -> f64 {
    let keeps_direction = match carrier {
        Carrier::First => pair.charts[0].terms <= 2,
        Carrier::Second => pair.charts[1].terms <= 2,
        Carrier::Both(_) => false,
    };
    if keeps_direction {
        return still_plane_until(pair, normal, time, to);
    }
    let (normals, count) = normals(pair, normal, carrier, time);
    let total = count.max(pair.charts[0].terms).max(pair.charts[1].terms);
    // (d + e) |n|.
    let size = Curve(normals).at(count, time).length();
    if size == 0.0 {
        return time;
    }
    let mut margin = [0.0; MOST_TERMS];
    let higher: f64 = normals[1..count]
        .iter()
        .rev()
        .fold(0.0, |sum, n| (sum + n.abs().element_sum()) * pair.half);
    let longest = normals[0].length() + higher;
    if pair.threshold > 0.0 {
        dot(&normals[..count], &normals[..count], &mut margin[..total]);
        for coefficient in &mut margin[..total] {
            *coefficient *= pair.threshold / (2.0 * size);
        }
        margin[0] += pair.threshold * size / 2.0;
    }
    margin[0] += pair.slack() * longest;

    let mut heights = [[[0.0; MOST_TERMS]; 3]; 2];
    for (which, heights) in heights.iter_mut().enumerate() {
        let terms = pair.charts[which].terms;
        for (height, curve) in heights.iter_mut().zip(pair.curves[which]) {
            dot(&normals[..count], &curve.0[..terms], &mut height[..total]);
        }
    }
    above_until(pair, &mut heights, [false; 2], &margin[..total], [time, to])
}

/// A time up to which a plane with this fixed unit normal separates the two.
fn still_plane_until(pair: &MovingPair, normal: DVec3, time: f64, to: f64) -> f64 {
    let total = pair.charts[0].terms.max(pair.charts[1].terms);
    let mut heights = [[[0.0; MOST_TERMS]; 3]; 2];
    for (which, heights) in heights.iter_mut().enumerate() {
        let terms = pair.charts[which].terms;
        for (height, curve) in heights.iter_mut().zip(pair.curves[which]) {
            for (height, place) in height.iter_mut().zip(&curve.0[..terms]) {
                *height = normal.dot(*place);
            }
        }
    }
    let mut margin = [0.0; MOST_TERMS];
    margin[0] = (pair.threshold + pair.slack()) * normal.length();
    let still = [0, 1].map(|which: usize| pair.charts[which].terms == 1);
    above_until(pair, &mut heights, still, &margin[..total], [time, to])
}

/// A time up to which all heights of the first exceed those of the second by more than a margin.
///
/// - `still`: the one whose heights do not change.
fn above_until(
    pair: &MovingPair,
    heights: &mut [[[f64; MOST_TERMS]; 3]; 2],
    still: [bool; 2],
    margin: &[f64],
    [time, to]: [f64; 2],
) -> f64 {
    let total = margin.len();
    let mut counts = [pair.curves[0].len(), pair.curves[1].len()];
    for which in [0, 1] {
        if still[which] {
            // Only one counts: the lowest of the first, or the highest of the second.
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
            // Often nothing happens in the whole window.
            let change = gap[1..total]
                .iter()
                .rev()
                .fold(0.0, |sum, c| (sum + c.abs()) * pair.half);
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

/// The normal as a polynomial, and its number of coefficients.
fn normals(
    pair: &MovingPair,
    normal: DVec3,
    carrier: Carrier,
    time: f64,
) -> ([DVec3; MOST_TERMS], usize) {
    let mut normals = [DVec3::ZERO; MOST_TERMS];
    let carried = |chart: &Chart, normals: &mut [DVec3; MOST_TERMS]| {
        // n' = -M^T n for planes that the motion carries along.
        let back = -chart.generator.linear.transpose();
        normals[0] = normal;
        let terms = chart.terms;
        // First backwards in time to the middle of the window.
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
        Carrier::First => carried(pair.charts[0], &mut normals),
        Carrier::Second => carried(pair.charts[1], &mut normals),
        Carrier::Both(sides) => {
            let side = |which: usize, k: usize| {
                let curves = pair.curves[which];
                let from = sides[which];
                curves[(from + 1) % curves.len()].0[k] - curves[from].0[k]
            };
            let terms = [pair.charts[0].terms, pair.charts[1].terms];
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

/// The coefficients of the product of two polynomials of vectors, as many as fit.
fn dot(a: &[DVec3], b: &[DVec3], into: &mut [f64]) {
    into.fill(0.0);
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate().take(into.len().saturating_sub(i)) {
            into[i + j] += x.dot(*y);
        }
    }
}
