//! Two features, one of them carried by a steady motion: the first time at which they meet.
//!
//! The two are followed from the start of the window: through wide windows, with paths of few
//! terms, while they are clearly apart; and through short ones, with paths that are polynomials to
//! rounding, where they may meet. Planes between the two certify how long they stay apart
//! (`separation`). A hard limit on the number of windows bounds the work.

use super::chart::{Chart, LONGEST};
use super::mover::Mover;
use super::moving_pair::MovingPair;
use super::separation::{self, Course};
use crate::motion::expansion::Curve;
use crate::motion::{Flow, Generator};
use crate::numeric::roots::{MOST_TERMS, positive_until};
use crate::numeric::tolerance::{CONTACT_ROUNDING, ROOT_RESOLUTION};
use glam::{DAffine3, DVec3};

/// The result of a search for the meeting of two features during a window of time, in fractions of
/// the span.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PairOutcome {
    /// They do not meet: a proof.
    None,
    /// They meet.
    First {
        /// They are certainly apart before the first of these times, and within rounding of each
        /// other, or past it, at the second one.
        bracket: [f64; 2],
        /// Whether rounding leaves open that they only touch; `false` when they certainly cross.
        touch: bool,
    },
    /// Certainly apart before the start of this window; after that, the limit on work was reached.
    Undecided {
        /// The undecided window.
        window: [f64; 2],
    },
}

/// The first time at which a vertex that moves by exp(tG) meets a triangle at rest.
///
/// - `window`: `[start, end]` in fractions of the span, `start <= end`.
///
/// # Guarantee
/// `None` is a proof, and so is that they are apart before the bracket or the window of the other
/// outcomes. Nothing is an error: motions that are too long or not finite are undecided.
///
/// # Cost
/// 1 to 2 microseconds for most, growing with the number of turns; at most some milliseconds.
pub fn vertex_face(
    generator: &Generator,
    vertex: DVec3,
    face: [DVec3; 3],
    window: [f64; 2],
) -> PairOutcome {
    first(generator, &[vertex], &face, window)
}

/// The first time at which a triangle that moves by exp(tG) meets a point at rest; see
/// [`vertex_face`].
pub fn face_vertex(
    generator: &Generator,
    face: [DVec3; 3],
    vertex: DVec3,
    window: [f64; 2],
) -> PairOutcome {
    let Generator { linear, .. } = generator;
    if *linear == -linear.transpose() {
        // Distances are the same in the frame of the face, in which it rests.
        return vertex_face(&generator.scaled(-1.0), vertex, face, window);
    }
    first(generator, &face, &[vertex], window)
}

/// The first time at which a segment that moves by exp(tG) meets a segment at rest; see
/// [`vertex_face`].
pub fn edge_edge(
    generator: &Generator,
    moving: [DVec3; 2],
    resting: [DVec3; 2],
    window: [f64; 2],
) -> PairOutcome {
    first(generator, &moving, &resting, window)
}

/// Most windows for one pair: some milliseconds.
const MOST_WINDOWS: usize = 10_000;

/// Largest |M| h of the windows in which paths of few terms are compared.
const WIDEST: f64 = 0.8;

/// Number of terms of these paths: the remainder is up to 0.8^5 / 5!, 0.3%, of the distance from
/// the axis.
const FEW_TERMS: usize = 5;

fn first(
    generator: &Generator,
    moving: &[DVec3],
    resting: &[DVec3],
    window: [f64; 2],
) -> PairOutcome {
    let [start, end] = window;
    let bounds = |points: &[DVec3]| {
        points
            .iter()
            .fold([points[0]; 2], |[low, high], &p| [low.min(p), high.max(p)])
    };
    let mover = Mover::followed(Flow::new(*generator), bounds(moving));
    let still = Mover::resting(DAffine3::IDENTITY, bounds(resting)).chart(0.0, 0.0, 0.0);
    let resting_curves = curves(&still, resting);
    let mut slack = slack_before(&mover, start);
    let mut time = start;
    for _ in 0..MOST_WINDOWS {
        let undecided = |time: f64| PairOutcome::Undecided {
            window: [time, end],
        };
        // Are they clearly apart?
        let until = (time + 2.0 * WIDEST / mover.size).min(end);
        let half = 0.5 * (until - time);
        let reduced = half * mover.size;
        if !reduced.is_finite() {
            return undecided(time);
        }
        let mut chart = mover.chart(time + half, half, reduced);
        slack = chart.slack.max(slack);
        chart.slack = slack;
        chart.shorten(FEW_TERMS);
        let moving_curves = curves(&chart, moving);
        let pair = MovingPair {
            charts: [&chart, &still],
            curves: [
                &moving_curves[..moving.len()],
                &resting_curves[..resting.len()],
            ],
            half,
            threshold: 0.0,
        };
        let clear = separation::clear_until(&pair, -half, half);
        let Some(placed) = clear.placed else {
            if until >= end {
                return PairOutcome::None;
            }
            time = until;
            continue;
        };
        time = (time + half + clear.until).clamp(time, until);
        // They are near.
        let longest = 2.0 * LONGEST / mover.size;
        let soon = (AHEAD * pair.ahead(&placed)).clamp(SHORTEST * longest, longest);
        let until = (time + soon).min(end);
        let half = 0.5 * (until - time);
        let mut chart = mover.chart(time + half, half, half * mover.size);
        chart.slack = slack;
        let moving_curves = curves(&chart, moving);
        let pair = MovingPair {
            charts: [&chart, &still],
            curves: [
                &moving_curves[..moving.len()],
                &resting_curves[..resting.len()],
            ],
            half,
            threshold: 0.0,
        };
        let middle = time + half;
        match separation::course(&pair, -half, half, f64::INFINITY) {
            Course::Apart(_) => {
                if until >= end {
                    return PairOutcome::None;
                }
                time = until;
            }
            Course::Met(meeting) => {
                let after = (middle + meeting.after).clamp(time, end);
                return PairOutcome::First {
                    bracket: [after, (middle + meeting.by).clamp(after, end)],
                    touch: !meeting.crosses,
                };
            }
            Course::Unknown(time) => return undecided(middle + time),
        }
    }
    PairOutcome::Undecided {
        window: [time, end],
    }
}

/// Windows near a possible meeting, as multiples of the time that the features seem to need to
/// meet.
const AHEAD: f64 = 2.0;

/// The shortest such window, as a fraction of the longest one.
const SHORTEST: f64 = 1.0 / 16.0;

/// The paths of some points.
fn curves(chart: &Chart, points: &[DVec3]) -> [Curve; 3] {
    let mut curves = [Curve::ORIGIN; 3];
    for (curve, &point) in curves.iter_mut().zip(points) {
        chart.draw(point, curve);
    }
    curves
}

/// The slack of a followed mover up to a time.
fn slack_before(mover: &Mover, start: f64) -> f64 {
    if start <= 0.0 {
        return 0.0;
    }
    let windows = 0.5 * start * mover.size / WIDEST;
    let count = windows.ceil().clamp(1.0, MOST_WINDOWS as f64);
    let half = 0.5 * start / count;
    let mut slack = 0.0_f64;
    let mut number = 0.0;
    while number < count {
        let middle = (2.0 * number + 1.0) * half;
        slack = slack.max(mover.chart(middle, half, half * mover.size).slack);
        number += 1.0;
    }
    slack
}

/// The first time at which a point that moves by exp(tG) meets the plane through `anchor` with
/// normal `normal`, of any length but 0; see [`vertex_face`].
pub fn point_plane(
    generator: &Generator,
    point: DVec3,
    anchor: DVec3,
    normal: DVec3,
    window: [f64; 2],
) -> PairOutcome {
    let [start, end] = window;
    let normal = normal.normalize_or_zero();
    let flow = Flow::new(*generator);
    let mover = Mover::moving(&flow, [0.0, 1.0], DAffine3::IDENTITY, [point; 2]);
    let still = Mover::resting(DAffine3::IDENTITY, [anchor; 2]).chart(0.0, 0.0, 0.0);
    let count = (0.5 * (end - start) * mover.size / LONGEST).ceil().max(1.0);
    let undecided = |time: f64| PairOutcome::Undecided {
        window: [time, end],
    };
    if count > MOST_WINDOWS as f64 || normal == DVec3::ZERO {
        return undecided(start);
    }
    let mut number = 0.0;
    while number < count {
        let piece = [number, number + 1.0].map(|n| start + (end - start) * (n / count));
        number += 1.0;
        let half = 0.5 * (piece[1] - piece[0]);
        let middle = piece[0] + half;
        let chart = mover.chart(middle, half, half * mover.size);
        let slack = chart.slack + still.slack;
        let curve = chart.curve(point);
        let mut heights = [0.0; MOST_TERMS];
        for (height, place) in heights.iter_mut().zip(&curve.0[..chart.terms]) {
            *height = normal.dot(*place);
        }
        heights[0] -= normal.dot(anchor);
        if let Some((after, by)) = meets_plane(&heights[..chart.terms], half, slack) {
            let after = (middle + after).clamp(start, end);
            let touch = by.is_none();
            let by = by.map_or(after, |by| (middle + by).clamp(after, end));
            return PairOutcome::First {
                bracket: [after, by],
                touch,
            };
        }
    }
    PairOutcome::None
}

/// The time at which a height first falls to rounding during a window, and the time by which it has
/// certainly changed its sign.
fn meets_plane(heights: &[f64], half: f64, slack: f64) -> Option<(f64, Option<f64>)> {
    let value = |time: f64| heights.iter().rev().fold(0.0, |sum, c| sum * time + c);
    let sign = if value(-half) < 0.0 { -1.0 } else { 1.0 };
    let mut above = [0.0; MOST_TERMS];
    for (to, from) in above.iter_mut().zip(heights) {
        *to = sign * from;
    }
    above[0] -= slack;
    let above = &above[..heights.len()];
    let mut time = -half;
    for _ in 0..MOST_LEAPS {
        if sign * value(time) <= CONTACT_ROUNDING * slack {
            break;
        }
        let until = positive_until(above, time, half);
        if until >= half {
            return None;
        }
        if until - time <= ROOT_RESOLUTION * half {
            break;
        }
        time = until;
    }
    let slope = (1..heights.len())
        .rev()
        .fold(0.0, |sum, k| sum * time + heights[k] * k as f64);
    let closing = -sign * slope;
    let by = time + (sign * value(time) + 4.0 * slack) / closing;
    let crosses = closing > 0.0 && by <= half * (1.0 + 1e-3) && sign * value(by) < -2.0 * slack;
    Some((time, crosses.then_some(by)))
}

/// Most calls of the root search for one window: each continues Newton's method, and two are usual.
const MOST_LEAPS: usize = 200;

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const FACE: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    fn first_at(outcome: PairOutcome, expected: f64, crosses: bool) {
        let PairOutcome::First { bracket, touch } = outcome else {
            panic!("{outcome:?} instead of {expected}")
        };
        assert!(
            bracket[0] <= expected + 1e-15 && expected <= bracket[1] + 1e-15,
            "{bracket:?} does not hold {expected}"
        );
        assert!(bracket[1] - bracket[0] < 1e-12, "{bracket:?} is too wide");
        assert_eq!(touch, !crosses, "{bracket:?}");
    }

    #[test]
    fn a_vertex_falls_onto_a_face_and_past_it() {
        let fall = Generator::translation(-2.0 * DVec3::Z);
        let above = |x: f64, y: f64| DVec3::new(x, y, 1.0);
        let window = [0.0, 1.0];
        first_at(
            vertex_face(&fall, above(0.25, 0.25), FACE, window),
            0.5,
            true,
        );
        assert_eq!(
            vertex_face(&fall, above(0.75, 0.75), FACE, window),
            PairOutcome::None
        );
        assert_eq!(
            vertex_face(&fall, above(0.25, 0.25), FACE, [0.0, 0.499]),
            PairOutcome::None,
            "not that early"
        );
        first_at(
            face_vertex(
                &fall,
                FACE.map(|p| p + DVec3::Z),
                DVec3::new(0.25, 0.25, 0.0),
                window,
            ),
            0.5,
            true,
        );
        first_at(
            point_plane(&fall, above(5.0, 5.0), DVec3::ZERO, DVec3::Z, window),
            0.5,
            true,
        );
    }

    #[test]
    fn a_turning_point_meets_a_face_after_three_quarters_of_a_turn_and_not_on_the_other_side() {
        // From (1, 0, 0) about z by three turns; the face stands in the plane y = 0 at x < 0,
        // beyond a half turn.
        let turn = Generator::screw(DVec3::Z, DVec3::ZERO, 6.0 * PI, 0.0, 1.0);
        let face = [
            DVec3::new(-2.0, 0.0, -1.0),
            DVec3::new(-0.5, 0.0, -1.0),
            DVec3::new(-1.0, 0.0, 2.0),
        ];
        first_at(
            vertex_face(&turn, DVec3::X, face, [0.0, 1.0]),
            1.0 / 6.0,
            true,
        );
        first_at(vertex_face(&turn, DVec3::X, face, [0.2, 1.0]), 0.5, true);
        assert_eq!(
            vertex_face(&turn, DVec3::X * 0.4, face, [0.0, 1.0]),
            PairOutcome::None,
            "passes nearer to the axis"
        );
    }

    #[test]
    fn edges_cross_touch_and_slide() {
        let fall = Generator::translation(-2.0 * DVec3::Z);
        let across = [DVec3::new(-1.0, 0.3, 1.0), DVec3::new(1.0, 0.3, 1.0)];
        let along = [-DVec3::Y, DVec3::Y];
        first_at(edge_edge(&fall, across, along, [0.0, 1.0]), 0.5, true);
        // Always parallel, one on the other at half time: a touch, since nothing says what lies
        // beside them.
        let parallel = [DVec3::new(0.0, -0.5, 1.0), DVec3::new(0.0, 0.5, 1.0)];
        first_at(edge_edge(&fall, parallel, along, [0.0, 1.0]), 0.5, false);
        // Sliding in one plane from the start.
        let slide = Generator::translation(DVec3::Y * 0.1);
        let flat = across.map(|p| p - DVec3::Z);
        first_at(edge_edge(&slide, flat, along, [0.0, 1.0]), 0.0, false);
        assert_eq!(
            edge_edge(&slide, across, along, [0.0, 1.0]),
            PairOutcome::None,
            "one above the other"
        );
    }

    #[test]
    fn a_point_that_only_touches_a_plane_touches_and_one_that_misses_by_little_is_clear() {
        // A circle about the y axis through the origin, lowest at half time.
        let turn = Generator::screw(DVec3::Y, DVec3::Z, 2.0, 0.0, 1.0);
        let start = DVec3::new(1.0_f64.sin(), 0.0, 1.0 - 1.0_f64.cos());
        let lower = |by: f64| point_plane(&turn, start, -DVec3::Z * by, DVec3::Z, [0.0, 1.0]);
        let PairOutcome::First { bracket, touch } = lower(0.0) else {
            panic!("{:?}", lower(0.0))
        };
        assert!(touch && (bracket[0] - 0.5).abs() < 1e-6, "{bracket:?}");
        assert_eq!(lower(1e-10), PairOutcome::None, "clear by 1e-10");
        let PairOutcome::First { bracket, touch } = lower(-1e-6) else {
            panic!("{:?}", lower(-1e-6))
        };
        // 1 - cos(2 s) = 1e-6 before the middle.
        let expected = 0.5 - 0.5 * (1.0_f64 - 1e-6).acos();
        assert!(
            !touch && bracket[0] <= expected + 1e-15 && expected <= bracket[1] + 1e-15,
            "{bracket:?} for {expected}"
        );
    }

    #[test]
    fn a_window_without_length_is_one_instant() {
        let fall = Generator::translation(-2.0 * DVec3::Z);
        let at = |time: f64| {
            vertex_face(&fall, DVec3::new(0.25, 0.25, 1.0), FACE, [time; 2]) == PairOutcome::None
        };
        assert_eq!(
            [0.0, 0.25, 0.5, 0.75].map(at),
            [true, true, false, true],
            "on the face at half time only"
        );
    }

    #[test]
    fn features_without_extent_are_points_and_segments() {
        let fall = Generator::translation(-2.0 * DVec3::Z);
        let above = DVec3::new(0.25, 0.0, 1.0);
        let flat = [DVec3::ZERO, DVec3::X, DVec3::X * 0.5];
        first_at(vertex_face(&fall, above, flat, [0.0, 1.0]), 0.5, false);
        first_at(
            vertex_face(&fall, above, [above - DVec3::Z; 3], [0.0, 1.0]),
            0.5,
            false,
        );
        assert_eq!(
            vertex_face(&fall, above + DVec3::Y * 1e-9, flat, [0.0, 1.0]),
            PairOutcome::None,
            "passes beside the segment"
        );
    }
}
