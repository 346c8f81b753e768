//! Whether two features that met certainly pass through each other.

use super::moving_pair::{MovingPair, Placed};
use super::nearest::{Nearest, Part};
use crate::numeric::area::area_vector;
use crate::numeric::tolerance::{CONTACT_ROUNDING, ROOT_RESOLUTION};
use glam::DVec3;

/// A pair at the threshold. Times are relative to the middle of the window.
#[derive(Debug, Clone, Copy)]
pub(super) struct Meeting {
    /// The pair is certainly apart before this time.
    pub(super) after: f64,
    /// Best estimate of the time at which the threshold is passed.
    pub(super) time: f64,
    /// The pair is closer than the threshold at this time, certainly or within rounding.
    pub(super) by: f64,
    /// Whether they certainly cross (the threshold is passed) by then.
    pub(super) crosses: bool,
    /// The nearest points and parts at `after`.
    pub(super) nearest: Nearest,
    /// Unit vector from the second to the first.
    pub(super) normal: DVec3,
    /// Speed at which the nearest points approach each other along the normal.
    pub(super) closing: f64,
}

/// Describes the meeting at `time`, when the nearest points are at the threshold.
pub(super) fn meeting(pair: &MovingPair, time: f64, placed: &Placed) -> Meeting {
    let slack = pair.slack();
    let normal = pair.direction(placed);
    let near = &placed.near;
    let velocity = |which: usize| pair.charts[which].generator.velocity(near.points[which]);
    let closing = normal.dot(velocity(1) - velocity(0));
    let mut meeting = Meeting {
        after: time,
        time,
        by: time,
        crosses: false,
        nearest: *near,
        normal,
        closing,
    };
    let gap = (near.distance() - pair.threshold).max(0.0);
    for depth in [4.0, 16.0, 64.0] {
        let by = time + (gap + depth * slack) / closing;
        if !(closing > 0.0 && by <= pair.half * (1.0 + 1e-3)) {
            break;
        }
        if crosses(pair, near, normal, [time, by]) {
            meeting.time = (time + gap / closing).min(by);
            meeting.by = by;
            meeting.crosses = true;
            break;
        }
    }
    let there = time + gap / closing;
    if !meeting.crosses && closing > 0.0 && there <= pair.half {
        // Where it should be 0 there may still be a touch, which the bracket then contains.
        let by = there + ROOT_RESOLUTION * (there.abs() + pair.half);
        if pair.nearest(by).distance() <= pair.threshold + CONTACT_ROUNDING * slack {
            (meeting.time, meeting.by) = (there, by);
        }
    }
    meeting
}

/// Whether the features certainly pass through each other (the threshold) between two times.
fn crosses(pair: &MovingPair, near: &Nearest, normal: DVec3, [from, to]: [f64; 2]) -> bool {
    let slack = pair.slack();
    if pair.threshold > 0.0 {
        return pair.nearest(to).distance() < pair.threshold - slack;
    }
    let corners = [from, to].map(|time| {
        let mut corners = [[DVec3::ZERO; 3]; 2];
        for (which, corners) in corners.iter_mut().enumerate() {
            pair.corners(which, time, corners);
        }
        corners
    });
    // A generous bound on the distance by which anything moves relative to anything else.
    let [before, after] = &corners;
    let pairs = before.iter().flatten().zip(after.iter().flatten());
    let shift: f64 = pairs.map(|(a, b)| a.distance(*b)).sum();
    let room = 4.0 * (shift + slack);
    match near.parts {
        [Part::Corner(k), Part::Inside] => {
            passes_face(corners[0][0][k], corners[0][1], room)
                && height(corners[1][0][k], corners[1][1], normal) < -2.0 * slack
        }
        [Part::Inside, Part::Corner(k)] => {
            passes_face(corners[0][1][k], corners[0][0], room)
                && height(corners[1][1][k], corners[1][0], -normal) < -2.0 * slack
        }
        [Part::Side(i), Part::Side(j)] => {
            let side = |at: usize, which: usize, number: usize| {
                let c = &corners[at][which];
                [c[number], c[(number + 1) % pair.curves[which].len()]]
            };
            let depth = |at: usize| {
                let ([a, b], [c, d]) = (side(at, 0, i), side(at, 1, j));
                let across = (b - a).cross(d - c);
                let across = if across.dot(normal) < 0.0 {
                    -across
                } else {
                    across
                };
                (
                    across.normalize_or_zero().dot(a - c),
                    across.length() / ((b - a).length() * (d - c).length()),
                )
            };
            let (before, after) = (depth(0), depth(1));
            let inside = |[a, b]: [DVec3; 2], point: DVec3| {
                point.distance(a).min(point.distance(b)) > room / after.1.min(before.1)
            };
            after.0 < -2.0 * slack
                && inside(side(0, 0, i), near.points[0])
                && inside(side(0, 1, j), near.points[1])
        }
        _ => false,
    }
}

/// Whether a point over a face is farther than `room` from its sides.
fn passes_face(point: DVec3, [a, b, c]: [DVec3; 3], room: f64) -> bool {
    let normal = area_vector([a, b, c]).normalize_or_zero();
    [(a, b), (b, c), (c, a)]
        .iter()
        .all(|&(p, q)| normal.cross(q - p).normalize_or_zero().dot(point - p) > room)
}

/// The height of a point over a face, positive on the side of `towards`.
fn height(point: DVec3, face: [DVec3; 3], towards: DVec3) -> f64 {
    let normal = area_vector(face).normalize_or_zero();
    let height = normal.dot(point - face[0]);
    if normal.dot(towards) < 0.0 {
        -height
    } else {
        height
    }
}
