//! B-splines as Bézier curves.

use super::curve::Curve;
use glam::DVec3;

/// Largest degree: drawing programs know no larger one. The work of cutting a spline grows as its
/// square for each control point.
const LARGEST_DEGREE: usize = 25;

/// Largest relative difference of the steps between knots that are meant to be equal.
const EQUAL_STEPS: f64 = 1e-9;

/// A B-spline as a file gives it.
#[derive(Debug, Clone, Copy)]
pub(in crate::io) struct Spline<'a> {
    pub(in crate::io) degree: usize,
    pub(in crate::io) knots: &'a [f64],
    /// Coordinates times weight, and weight.
    pub(in crate::io) controls: &'a [DVec3],
    pub(in crate::io) ends: SplineEnds,
}

/// What a file says about the ends of a B-spline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::io) enum SplineEnds {
    /// Nothing.
    Any,
    /// That it is closed or periodic.
    Joined,
}

/// The Bézier curves of a B-spline, or what is wrong with the numbers when they make none.
///
/// With n control points and degree p, the spline is the curve over the interval from knot p to
/// knot n, where its basis is complete. This holds whether or not its first and last knots are
/// repeated, and whether or not it is closed. There are n + p + 1 knots. For a spline that is said
/// to be closed there may also be
/// - n + 2p + 1: the control points are those of one turn, and the first p of them follow the last
///   one again;
/// - n + 1, in equal steps: the knots are those of one turn, too. (With unequal steps it would be
///   uncertain which of them belongs to the first control point.)
pub(in crate::io) fn spline(given: &Spline<'_>) -> Result<Vec<Curve>, &'static str> {
    let Spline {
        degree,
        knots,
        controls,
        ends,
    } = *given;
    if !(1..=LARGEST_DEGREE).contains(&degree) {
        return Err("of a degree that is not from 1 to 25");
    }
    if !controls.iter().all(|c| c.is_finite() && c.z > 0.0) {
        return Err("with weights or control points that make no curve");
    }
    if !(knots.iter().all(|t| t.is_finite()) && knots.is_sorted()) {
        return Err("with knots that do not ascend");
    }
    let count = controls.len();
    let is_turn = ends == SplineEnds::Joined && count > degree;
    let (knots, controls) = if count > degree && knots.len() == count + degree + 1 {
        (knots.to_vec(), controls.to_vec())
    } else if is_turn && knots.len() == count + 2 * degree + 1 {
        (knots.to_vec(), [controls, &controls[..degree]].concat())
    } else if is_turn && knots.len() == count + 1 && are_equal_steps(knots) {
        let all = repeated(degree, knots);
        (all, [controls, &controls[..degree]].concat())
    } else {
        return Err("with knots whose number does not fit that of its control points");
    };
    Ok(cut(degree, &knots, &controls))
}

fn are_equal_steps(knots: &[f64]) -> bool {
    let (steps, length) = (knots.len() - 1, knots[knots.len() - 1] - knots[0]);
    let step = length / steps as f64;
    step > 0.0
        && knots
            .windows(2)
            .all(|pair| (pair[1] - pair[0] - step).abs() <= EQUAL_STEPS * step)
}

/// The knots of one turn, with `degree` knots of the turns before and after it.
fn repeated(degree: usize, knots: &[f64]) -> Vec<f64> {
    let last = knots.len() - 1;
    let length = knots[last] - knots[0];
    let before = knots[last - degree..last].iter().map(|t| t - length);
    let after = knots[1..=degree].iter().map(|t| t + length);
    before.chain(knots.iter().copied()).chain(after).collect()
}

/// One Bézier curve for each non-empty interval between knots.
fn cut(degree: usize, knots: &[f64], controls: &[DVec3]) -> Vec<Curve> {
    let intervals = (degree..controls.len()).filter(|&i| knots[i] < knots[i + 1]);
    let curves = intervals.map(|i| {
        let control = |k: usize| {
            // The blossom of the polynomial piece, at k times the end and otherwise the start of
            // the interval.
            let mut points = controls[i - degree..=i].to_vec();
            for level in 1..=degree {
                let at = if level <= k { knots[i + 1] } else { knots[i] };
                for j in (level..=degree).rev() {
                    let (low, high) = (knots[j + i - degree], knots[j + 1 + i - level]);
                    points[j] = points[j - 1].lerp(points[j], (at - low) / (high - low));
                }
            }
            points[degree]
        };
        Curve::Bezier((0..=degree).map(control).collect())
    });
    curves.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, Vec3Swizzles};

    /// Basis functions by their recursive definition (Cox & de Boor).
    fn basis(i: usize, degree: usize, knots: &[f64], t: f64) -> f64 {
        if degree == 0 {
            return f64::from(u8::from(knots[i] <= t && t < knots[i + 1]));
        }
        let part = |numerator: f64, denominator: f64| {
            if denominator > 0.0 {
                numerator / denominator
            } else {
                0.0
            }
        };
        part(t - knots[i], knots[i + degree] - knots[i]) * basis(i, degree - 1, knots, t)
            + part(
                knots[i + degree + 1] - t,
                knots[i + degree + 1] - knots[i + 1],
            ) * basis(i + 1, degree - 1, knots, t)
    }

    /// Interval by interval, the Bézier curves agree with the sum over the basis functions.
    #[track_caller]
    fn check(curves: &[Curve], degree: usize, knots: &[f64], controls: &[DVec3]) {
        let spans: Vec<[f64; 2]> = (degree..controls.len())
            .map(|i| [knots[i], knots[i + 1]])
            .filter(|[a, b]| a < b)
            .collect();
        assert_eq!(curves.len(), spans.len(), "one curve per interval");
        for (curve, [from, to]) in curves.iter().zip(spans) {
            for share in [0.0, 0.1, 0.5, 0.9] {
                let t = from + (to - from) * share;
                let sum: DVec3 = (0..controls.len())
                    .map(|i| controls[i] * basis(i, degree, knots, t))
                    .sum();
                let (found, expected) = (curve.point_at(share), sum.xy() / sum.z);
                assert!(
                    found.distance(expected) < 1e-12,
                    "{found} for {expected} at {t}"
                );
            }
        }
    }

    fn read(
        degree: usize,
        knots: &[f64],
        controls: &[DVec3],
        ends: SplineEnds,
    ) -> Result<Vec<Curve>, &'static str> {
        spline(&Spline {
            degree,
            knots,
            controls,
            ends,
        })
    }

    #[test]
    fn a_spline_is_what_the_basis_functions_say() {
        let controls: Vec<DVec3> = [
            [0.0, 0.0, 1.0],
            [1.0, 3.0, 2.0],
            [2.0, -1.0, 0.5],
            [4.0, 1.0, 1.0],
            [5.0, 5.0, 1.0],
            [6.0, 0.0, 3.0],
        ]
        .map(|[x, y, w]| DVec3::new(x * w, y * w, w))
        .to_vec();
        let cases: [(usize, &[f64]); 4] = [
            (3, &[0.0, 0.0, 0.0, 0.0, 1.0, 2.5, 3.0, 3.0, 3.0, 3.0]),
            (3, &[0.0, 1.0, 2.0, 3.0, 4.0, 4.0, 6.0, 7.0, 8.0, 9.0]),
            (2, &[0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 4.0, 4.0, 4.0]),
            (2, &[-1.0, 0.0, 0.5, 1.0, 1.0, 2.0, 4.0, 4.0, 7.0]),
        ];
        for (degree, knots) in cases {
            for ends in [SplineEnds::Any, SplineEnds::Joined] {
                let curves = read(degree, knots, &controls, ends).expect("a spline");
                check(&curves, degree, knots, &controls);
            }
        }
    }

    /// Control points of one turn, with weights.
    fn turn(count: u32) -> Vec<DVec3> {
        (0..count)
            .map(|i| {
                let way =
                    DVec2::from_angle(std::f64::consts::TAU * f64::from(i) / f64::from(count));
                let (place, weight) = (way * f64::from(2 + i % 3), f64::from(1 + i % 2));
                (place * weight).extend(weight)
            })
            .collect()
    }

    #[test]
    fn a_closed_spline_is_the_same_however_its_turn_is_written() {
        for degree in 1..=7usize {
            let controls = turn(9);
            let wrapped = [&controls[..], &controls[..degree]].concat();
            let uniform: Vec<f64> = (0u32..).take(9 + 2 * degree + 1).map(f64::from).collect();
            let expected = read(degree, &uniform, &wrapped, SplineEnds::Joined).expect("wrapped");
            check(&expected, degree, &uniform, &wrapped);
            let ends = [expected[0].ends()[0], expected[8].ends()[1]];
            assert!(ends[0].distance(ends[1]) < 1e-14, "closed: {ends:?}");
            assert_eq!(
                read(degree, &uniform, &controls, SplineEnds::Joined),
                Ok(expected.clone()),
                "control points of one turn"
            );
            let one_turn = &uniform[degree..=degree + 9];
            assert_eq!(
                read(degree, one_turn, &controls, SplineEnds::Joined),
                Ok(expected),
                "knots of one turn, too"
            );
            for knots in [&uniform[..], one_turn] {
                let found = read(degree, knots, &controls, SplineEnds::Any);
                assert!(found.is_err(), "nothing says that it is closed");
            }
        }
    }

    #[test]
    fn a_closed_spline_may_have_unequal_knots() {
        let (degree, controls) = (3, turn(6));
        // One turn of 10, with the knots before and after it.
        let knots = [
            -7.0, -4.0, -2.0, 0.0, 1.0, 3.0, 3.0, 6.0, 8.0, 10.0, 11.0, 13.0, 13.0,
        ];
        let curves = read(degree, &knots, &controls, SplineEnds::Joined).expect("a turn");
        let [first, last] = [&curves[0], &curves[curves.len() - 1]];
        assert!(first.ends()[0].distance(last.ends()[1]) < 1e-14, "closed");
        let wrapped = [&controls[..], &controls[..degree]].concat();
        check(&curves, degree, &knots, &wrapped);
        assert!(
            read(degree, &knots[3..10], &controls, SplineEnds::Joined).is_err(),
            "it is not certain which control point comes first"
        );
    }

    #[test]
    fn numbers_that_make_no_spline_are_refused() {
        let controls = [
            DVec3::Z,
            DVec3::new(1.0, 0.0, 1.0),
            DVec3::new(1.0, 1.0, 1.0),
        ];
        for ends in [SplineEnds::Any, SplineEnds::Joined] {
            let refused = |degree: usize, knots: &[f64], controls: &[DVec3]| {
                read(degree, knots, controls, ends).expect_err("no spline")
            };
            let knots = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
            assert!(read(2, &knots, &controls, ends).is_ok());
            let missing = refused(2, &knots[..5], &controls);
            assert!(missing.contains("knots whose number"), "{missing}");
            let descending = refused(2, &[0.0, 0.0, 2.0, 1.0, 1.0, 1.0], &controls);
            assert!(descending.contains("ascend"), "{descending}");
            let few = refused(3, &[0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0], &controls);
            assert!(few.contains("knots whose number"), "{few}");
            let mut heavy = controls;
            heavy[1].z = 0.0;
            assert!(refused(2, &knots, &heavy).contains("weights"));
            for degree in [0, 26, 1_000_000] {
                assert!(refused(degree, &knots, &controls).contains("from 1 to 25"));
            }
            assert!(refused(2, &[], &[]).contains("knots whose number"));
        }
    }
}
