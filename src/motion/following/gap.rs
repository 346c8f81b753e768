//! How far a steady motion is from a motion that it stands for: a proven bound.
//!
//! Over a window both are polynomials with a bound on the rest ([`series`](super::super::series)),
//! and so is their difference, sum_k s^k D_k, s in [-1, 1]. A point x of the body is off by at least
//! |D_0 x| - rest, and by at most sum_k |D_k x| + rest. Windows are halved until the most is near
//! the least, and on the same side of what is allowed. As a function of x it is convex, so that the corners of a polytope that contains the
//! body are enough.

use crate::motion::scheme::Piece;
use crate::motion::series::{Series, TERMS};
use crate::motion::{Flow, Generator};
use crate::numeric::tolerance::{FOLLOWED_ROUNDING, UNIT_ROUNDOFF};
use glam::{DAffine3, DVec3};

/// How loose a bound may be, as a factor.
const LOOSE: f64 = 1.25;
/// Windows for each piece on average, beyond which the bound stays as loose as it is.
const MOST_WINDOWS: usize = 64;

/// A part of a piece, and the share of the steady motion that belongs to it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part<'a> {
    pub(super) piece: &'a Piece,
    /// From where to where on the piece.
    pub(super) u: [f64; 2],
    /// From where to where on the steady motion.
    pub(super) share: [f64; 2],
}

/// The largest distance of a point from its place on the steady motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gap {
    /// At least as large as the distance.
    pub(super) length: f64,
    /// The share of the steady motion where it is found.
    pub(super) share: f64,
}

/// A steady motion from a pose of the body on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chord<'a> {
    pub(super) flow: &'a Flow,
    pub(super) start: &'a DAffine3,
}

impl Chord<'_> {
    pub(super) fn pose_at(&self, share: f64) -> DAffine3 {
        self.flow.pose_at(share) * *self.start
    }

    /// Largest distance of points between a pose and that of the chord.
    pub(super) fn distance(&self, pose: &DAffine3, share: f64, points: &[DVec3]) -> f64 {
        let chord = self.pose_at(share);
        let distances = points
            .iter()
            .map(|&x| pose.transform_point3(x).distance(chord.transform_point3(x)));
        distances.fold(0.0, f64::max)
    }
}

/// The bound for some parts one after the other; `None` where it exceeds `most`.
///
/// - `points`: in the frame of the body; the bound holds for their convex hull.
///
/// # Cost
/// Some microseconds for each part, and for each radian of turning.
pub(super) fn gap<'a>(
    parts: impl Iterator<Item = Part<'a>>,
    chord: &Chord,
    points: &[DVec3],
    most: f64,
) -> Option<Gap> {
    let mut windows: Vec<Part> = parts.collect();
    let mut left = MOST_WINDOWS * windows.len();
    let mut found = Gap {
        length: 0.0,
        share: 0.0,
    };
    // A first look decides which windows need to be halved.
    let mut least = 0.0_f64;
    for part in looks(&windows) {
        let [u, share] = [part.u, part.share].map(|[from, to]| 0.5 * (from + to));
        least = least.max(chord.distance(&part.piece.pose_at(u), share, points));
        if least > most || least.is_nan() {
            return None;
        }
    }
    windows.reverse();
    while let Some(window) = windows.pop() {
        let [near, far, rounding] = bounds(&window, chord, points);
        if near > most {
            return None;
        }
        least = least.max(near);
        left = left.saturating_sub(1);
        let is_near = far <= (LOOSE * least).max(rounding);
        if left == 0 && far > most {
            return None;
        }
        if (is_near && far <= most) || left == 0 {
            if far > found.length {
                let [from, to] = window.share;
                found = Gap {
                    length: far,
                    share: 0.5 * (from + to),
                };
            }
            continue;
        }
        let [u, share] = [window.u, window.share].map(|[from, to]| 0.5 * (from + to));
        let part = |u, share| Part {
            piece: window.piece,
            u,
            share,
        };
        windows.push(part([u, window.u[1]], [share, window.share[1]]));
        windows.push(part([window.u[0], u], [window.share[0], share]));
    }
    Some(found)
}

/// Up to eight of the parts, evenly chosen; a single one in quarters.
fn looks<'a>(parts: &[Part<'a>]) -> Vec<Part<'a>> {
    if let [part] = parts {
        let quarter = |[from, to]: [f64; 2], k: f64| {
            let at = |k: f64| from + (to - from) * (0.25 * k);
            [at(k), at(k + 1.0)]
        };
        return [0.0, 1.0, 2.0, 3.0]
            .map(|k| Part {
                piece: part.piece,
                u: quarter(part.u, k),
                share: quarter(part.share, k),
            })
            .to_vec();
    }
    let step = parts.len().div_ceil(8);
    parts.iter().skip(step / 2).step_by(step).copied().collect()
}

/// What a point is off by in a window: at least, at most, and what is left of the difference when
/// the two are equal up to rounding.
fn bounds(window: &Part, chord: &Chord, points: &[DVec3]) -> [f64; 3] {
    let [middle, half] = middle_and_half(window.u);
    let given = window.piece.series(middle, half);
    let [share, half] = middle_and_half(window.share);
    let generator = chord.flow.generator();
    let pose = chord.pose_at(share);
    let steady = Series::steady(generator, &pose, half);
    let difference = given.minus(&steady);
    let rounding = place_rounding(generator);
    let (mut near, mut far, mut floor) = (0.0_f64, 0.0_f64, 0.0_f64);
    for &point in points {
        let reach = point.length();
        let off = difference.terms.map(|term| term.at(point));
        let place = pose.transform_point3(point).length() + steady.terms[0].reach(reach);
        let rounded = rounding * place;
        let rest = difference.rest.at(reach) + rounded;
        let sizes: [f64; TERMS] = off.map(DVec3::length);
        let sum: f64 = sizes.iter().sum();
        near = near.max(sizes[0] - rest);
        // NaN is no bound.
        far = if sum.is_nan() || rest.is_nan() {
            f64::INFINITY
        } else {
            far.max(sum * (1.0 + 32.0 * UNIT_ROUNDOFF) + rest)
        };
        floor = floor.max(FOLLOWED_ROUNDING * place);
    }
    [near, far, floor]
}

/// Rounding of a pose in the middle of a window, of the given motion and of the steady one, relative
/// to the size of what it moves.
fn place_rounding(generator: &Generator) -> f64 {
    32.0 * UNIT_ROUNDOFF * (1.0 + generator.size())
}

fn middle_and_half([from, to]: [f64; 2]) -> [f64; 2] {
    [0.5 * (from + to), 0.5 * (to - from)]
}
