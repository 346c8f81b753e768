//! All times of contact, and how long two triangles that met stay together.
//!
//! Once found, the condition that holds them together is followed. A side of one that passes
//! through the interior of the other keeps doing so as long as five determinants keep their signs;
//! two points closer than the threshold stay so as long as a polynomial is positive. Where no such
//! condition holds, in sliding and touching, the distance itself is computed at advancing times,
//! first a rounding apart and then twice as far each time: an absence shorter than the last step
//! may be missed there.

use super::chart::LONGEST;
use super::clip::Clipped;
use super::encounter::Encounter;
use super::moving_pair::MovingPair;
use super::nearest::Part;
use super::search::{MOST_VISITS, Search, Task};
use super::separation::{self, Course};
use super::times::Times;
use crate::numeric::area::area_vector;
use crate::numeric::roots::{MOST_TERMS, positive_until};
use crate::numeric::tolerance::{CONTACT_ROUNDING, JOINT_GAP, ROOT_RESOLUTION};
use glam::DVec3;
use rayon::prelude::*;

/// A path, with as many coefficients as the window needs.
type Coefficients = [DVec3; MOST_TERMS];

/// Most pieces of one presence: after that it is assumed to last to the end.
const MOST_PIECES: usize = 10_000;

/// Longest step where nothing is certified, as a fraction of half a window.
const LONGEST_STEP: f64 = 1.0 / 64.0;

/// All times during which the shapes are closer than the threshold, or one contains a part of the
/// other.
///
/// Times in doubt are included.
pub(super) fn times(encounter: &Encounter, threshold: f64) -> Times {
    let count = encounter.cover();
    let half = 0.5 / f64::from(count);
    let window = |number: u32| {
        let middle = f64::from(2 * number + 1) * half;
        times_in_window(&mut Search::new(encounter, threshold), [middle, half])
    };
    let each: Vec<Times> = (0..count).into_par_iter().map(window).collect();
    let mut times = Times::none(JOINT_GAP);
    for &interval in each.iter().flat_map(Times::intervals) {
        times.add(interval);
    }
    // Between these times no surface meets the other: a part that is inside stays inside.
    for gap in times.gaps() {
        let still = encounter.still(gap[0].midpoint(gap[1]));
        if still.contained().is_some() {
            times.add(gap);
        }
    }
    times
}

/// All times within the window around `middle` during which the surfaces are closer than the
/// threshold.
fn times_in_window(search: &mut Search, [middle, half]: [f64; 2]) -> Times {
    let mut times = Times::none(JOINT_GAP);
    let mut visits = 0;
    let whole = search.open(middle, half);
    let mut open = Vec::from_iter(search.entered([0, 0], whole, [-half, half]));
    while let Some(mut task) = open.pop() {
        let middle = search.windows[task.window].middle;
        let Some([from, to]) = times.rest_of([middle + task.from, middle + task.to]) else {
            continue;
        };
        visits += 1;
        if visits > MOST_VISITS || search.encounter.work.check().is_err() {
            let start = |task: &Task| search.windows[task.window].middle + task.from;
            let first = open.iter().map(start).fold(from, f64::min);
            times.add([first, search.windows[whole].middle + half]);
            break;
        }
        // Not beyond the times that the boxes left: the difference of times is rounded.
        (task.from, task.to) = (task.from.max(from - middle), task.to.min(to - middle));
        let shapes = search.encounter.shapes;
        let [a, b] = [0, 1].map(|which: usize| shapes[which].nodes[task.nodes[which] as usize]);
        let stretch = [task.from, task.to];
        let at = &search.windows[task.window];
        if task.from > task.to || at.separates([&a, &b], search.threshold, stretch) {
            continue;
        }
        if !(a.is_leaf() && b.is_leaf() && at.reduced <= LONGEST) {
            search.divide(task, &mut open);
            continue;
        }
        let triangles = [a.triangle, b.triangle];
        match search.clipped(at, triangles, stretch) {
            Clipped::Apart(normal) => search.windows[task.window].remember(normal),
            Clipped::Open([from, to]) => {
                let curves = search.curves(at, triangles);
                let pair = search.pair(at, &curves);
                times_of_pair(&pair, from, to, |interval| {
                    times.add(interval.map(|time| (middle + time).clamp(0.0, 1.0)));
                });
            }
        }
    }
    times
}

/// Calls `found` for the times in [`from`, `to`] during which the two are closer than the
/// threshold.
pub(super) fn times_of_pair(
    pair: &MovingPair,
    from: f64,
    to: f64,
    mut found: impl FnMut([f64; 2]),
) {
    let mut time = from;
    for _ in 0..MOST_PIECES {
        match separation::course(pair, time, to, f64::INFINITY) {
            Course::Apart(_) => return,
            // Times in doubt are not reported as free of contact.
            Course::Unknown(doubt) => return found([doubt, to]),
            Course::Met(meeting) => {
                let end = together_until(pair, meeting.by.min(to), to);
                found([meeting.time.min(end), end]);
                if end >= to {
                    return;
                }
                time = end + ROOT_RESOLUTION * (end.abs() + pair.half);
            }
        }
    }
    found([time, to]);
}

/// A time until which the two stay together, at most `to`.
fn together_until(pair: &MovingPair, from: f64, to: f64) -> f64 {
    let limit = pair.threshold + CONTACT_ROUNDING * pair.slack();
    let smallest = ROOT_RESOLUTION * pair.half;
    let mut time = from;
    let mut step = smallest;
    for _ in 0..MOST_PIECES {
        if time >= to {
            return to;
        }
        let held = held_until(pair, time, to);
        if held > time + smallest {
            (time, step) = (held, smallest);
            continue;
        }
        let next = (time + step).min(to);
        if pair.nearest(next).distance() <= limit {
            time = next;
            step = (2.0 * step).min(LONGEST_STEP * pair.half);
            continue;
        }
        let (mut inside, mut outside) = (time, next);
        while outside - inside > smallest {
            let middle = inside.midpoint(outside);
            if middle <= inside || middle >= outside {
                break;
            }
            if pair.nearest(middle).distance() <= limit {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        return inside;
    }
    to
}

/// A time until which something certainly holds them together; `time` if nothing is found.
fn held_until(pair: &MovingPair, time: f64, to: f64) -> f64 {
    if pair.threshold > 0.0 {
        return near_until(pair, time, to);
    }
    let mut until = time;
    for pierced in [1, 0] {
        let piercing = 1 - pierced;
        if pair.curves[pierced].len() < 3 {
            continue;
        }
        for side in 0..pair.curves[piercing].len() {
            until = until.max(pierces_until(pair, pierced, side, time, to));
        }
    }
    until
}

/// The time until which side number `side` of one passes through the other one, number `pierced`.
fn pierces_until(pair: &MovingPair, pierced: usize, side: usize, time: f64, to: f64) -> f64 {
    let piercing = 1 - pierced;
    let ends = pair.curves[piercing];
    let (p, q) = (&ends[side], &ends[(side + 1) % ends.len()]);
    let face = pair.curves[pierced];
    let terms = pair.charts.map(|chart| chart.terms);
    let total = terms[0].max(terms[1]);
    let at = |which: usize, path: &Coefficients| {
        path[..terms[which]]
            .iter()
            .rev()
            .fold(DVec3::ZERO, |sum, &c| sum * time + c)
    };
    // A quick test at the start.
    let (start, end) = (at(piercing, &p.0), at(piercing, &q.0));
    let corners = [0, 1, 2].map(|k: usize| at(pierced, &face[k].0));
    let normal = area_vector(corners);
    let size = normal.length();
    let heights = [start, end].map(|x| normal.dot(x - corners[0]));
    let margin = MARGIN * pair.slack();
    let sign = heights[0].signum();
    if heights[0] * sign <= margin * size || heights[1] * sign >= -margin * size {
        return time;
    }
    let difference = |a: &Coefficients, b: &Coefficients| -> Coefficients {
        std::array::from_fn(|k| a[k] - b[k])
    };
    let own = |which: usize, path: &Coefficients| -> Coefficients {
        std::array::from_fn(|k| {
            if k < terms[which] {
                path[k]
            } else {
                DVec3::ZERO
            }
        })
    };
    let p = own(piercing, &p.0);
    let along = difference(&own(piercing, &q.0), &p);
    let face = [0, 1, 2].map(|k: usize| difference(&own(pierced, &face[k].0), &p));
    let mut until = to;
    let longest = (end - start).length()
        + corners
            .iter()
            .map(|c| c.distance(start))
            .fold(0.0, f64::max);
    for k in 0..3 {
        // The side passes the edge on its inner side.
        let mut volume = [0.0; MOST_TERMS];
        let turn = cross(&face[k], &face[(k + 1) % 3], total);
        dot(&along, &turn, -sign, &mut volume[..total]);
        volume[0] -= margin * longest * longest;
        until = until.min(positive_until(&volume[..total], time, until));
        if until <= time {
            return time;
        }
    }
    let edges = [
        difference(&face[1], &face[0]),
        difference(&face[2], &face[0]),
    ];
    let normals = cross(&edges[0], &edges[1], total);
    // The face is relative to p, whose height over the face is -n . face.
    let beyond: Coefficients = std::array::from_fn(|k| along[k] - face[0][k]);
    for (place, sign) in [(&face[0], -sign), (&beyond, -sign)] {
        let mut height = [0.0; MOST_TERMS];
        dot(&normals, place, sign, &mut height[..total]);
        height[0] -= margin * size * 2.0;
        until = until.min(positive_until(&height[..total], time, until));
        if until <= time {
            return time;
        }
    }
    until
}

/// The time until which the points that are nearest at a time stay closer than the threshold.
fn near_until(pair: &MovingPair, time: f64, to: f64) -> f64 {
    let near = pair.nearest(time);
    let terms = pair.charts.map(|chart| chart.terms);
    let total = terms[0].max(terms[1]);
    let mut apart = [DVec3::ZERO; MOST_TERMS];
    for (which, sign) in [(0, 1.0), (1, -1.0)] {
        let curves = pair.curves[which];
        let corners: Vec<DVec3> = curves.iter().map(|c| c.at(terms[which], time)).collect();
        let weights = weights(&corners, near.parts[which], near.points[which]);
        for (curve, weight) in curves.iter().zip(weights) {
            for (sum, place) in apart.iter_mut().zip(&curve.0[..terms[which]]) {
                *sum += *place * (sign * weight);
            }
        }
    }
    let mut square = [0.0; MOST_TERMS];
    dot(&apart, &apart, -1.0, &mut square[..total]);
    let limit = pair.threshold - pair.slack();
    if limit <= 0.0 {
        return time;
    }
    square[0] += limit * limit;
    positive_until(&square[..total], time, to)
}

/// Number of errors of a position by which something must pass through for this to be followed.
const MARGIN: f64 = 4.0;

/// The weights of the corners in a point of a triangle, segment or point.
fn weights(corners: &[DVec3], part: Part, point: DVec3) -> [f64; 3] {
    let mut weights = [0.0; 3];
    match part {
        Part::Corner(k) => weights[k] = 1.0,
        Part::Side(k) => {
            let next = (k + 1) % corners.len();
            let along = corners[next] - corners[k];
            let share = along.dot(point - corners[k]) / along.length_squared();
            (weights[k], weights[next]) = (1.0 - share, share);
        }
        Part::Inside => {
            let normal = area_vector([corners[0], corners[1], corners[2]]);
            for k in 0..3 {
                let opposite = area_vector([point, corners[(k + 1) % 3], corners[(k + 2) % 3]]);
                weights[k] = opposite.dot(normal) / normal.length_squared();
            }
        }
    }
    weights
}

/// The first coefficients of the product of two paths.
fn cross(a: &Coefficients, b: &Coefficients, terms: usize) -> Coefficients {
    let mut product = [DVec3::ZERO; MOST_TERMS];
    for i in 0..terms {
        for j in 0..terms - i {
            product[i + j] += a[i].cross(b[j]);
        }
    }
    product
}

/// The first coefficients of the product of two paths, times a factor.
fn dot(a: &Coefficients, b: &Coefficients, factor: f64, into: &mut [f64]) {
    into.fill(0.0);
    let terms = into.len();
    for i in 0..terms {
        for j in 0..terms - i {
            into[i + j] += factor * a[i].dot(b[j]);
        }
    }
}
