//! Zeros of a scalar function of time: isolated by bounds, never by sampling.

use super::tolerance::ROOT_RESOLUTION;

/// A time at which a function is zero, or cannot be told from zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Zero {
    /// The function changes sign, once, and is monotone there.
    Crossing {
        /// The time of the change.
        time: f64,
        /// Whether it changes from negative to positive.
        rising: bool,
        /// The times near this zero at which |f| <= slack lie in here.
        window: [f64; 2],
    },
    /// A zero at an end of the window, within the slack, or a stretch on which f cannot be told
    /// from 0.
    Flat {
        /// |f| <= 5 slack from the first to the last of these times, which may be one and the same.
        times: [f64; 2],
        /// The times near this zero at which |f| <= slack lie in here.
        window: [f64; 2],
    },
}

/// A function with its slope, and bounds on it.
pub(crate) struct Searched<F> {
    /// Value and slope at a time.
    pub(crate) function: F,
    /// Upper bound of |f''| over the window that is searched.
    pub(crate) curvature: f64,
    /// Bound on the error of `function`: a value smaller than this may have either sign.
    pub(crate) slack: f64,
}

impl<F: Fn(f64) -> [f64; 2]> Searched<F> {
    /// Finds all zeros in the closed `window`, in no particular order.
    ///
    /// # Guarantee
    /// Every zero of every function within `slack` of this one (and with the same bound on the
    /// second derivative) lies in the window of one of the zeros that are found. Times are
    /// fractions of a span: [`ROOT_RESOLUTION`] is absolute.
    ///
    /// # Cost
    /// The function at a few points for each simple zero; near a double zero about 4 log2(w /
    /// sqrt(slack / curvature)) points for a window of width w, at most 4 * 50.
    ///
    /// # Why it ends
    /// Write B for the curvature and h for the width of a piece. The function differs from its
    /// chord by at most B h^2 / 8, and its slope from the one in the middle by at most B h / 2. A
    /// piece that is neither free of zeros nor monotone has |f| <= 5 slack as soon as B h^2 <=
    /// slack, and is then flat.
    pub(crate) fn zeros(&self, window: [f64; 2], mut found: impl FnMut(Zero)) {
        let ends = window.map(|time| (self.function)(time)[0]);
        if ![self.curvature, self.slack, ends[0], ends[1]]
            .iter()
            .all(|x| x.is_finite())
        {
            // Overflow: nothing is known, and cutting would not help.
            return found(Zero::Flat {
                times: window,
                window,
            });
        }
        self.search(window, ends, &mut found);
    }

    fn search(
        &self,
        [start, end]: [f64; 2],
        [at_start, at_end]: [f64; 2],
        found: &mut impl FnMut(Zero),
    ) {
        let width = end - start;
        let bulge = self.curvature * width * width / 8.0;
        let (lowest, highest) = (at_start.min(at_end), at_start.max(at_end));
        if lowest > bulge + self.slack || highest < -(bulge + self.slack) {
            return;
        }
        let largest = highest.max(-lowest) + bulge;
        if largest <= 5.0 * self.slack || width <= ROOT_RESOLUTION {
            return found(Zero::Flat {
                times: [start, end],
                window: [start - ROOT_RESOLUTION, end + ROOT_RESOLUTION],
            });
        }
        let middle = start + width / 2.0;
        let [at_middle, slope] = (self.function)(middle);
        if slope.abs() * width / 2.0 > 2.0 * bulge + self.slack {
            return self.monotone([start, end], [at_start, at_end], slope, found);
        }
        self.search([start, middle], [at_start, at_middle], found);
        self.search([middle, end], [at_middle, at_end], found);
    }

    /// Finds at most one zero between the ends; a value at an end that may be zero belongs to it,
    /// or is a zero of its own.
    fn monotone(
        &self,
        [start, end]: [f64; 2],
        [at_start, at_end]: [f64; 2],
        slope: f64,
        found: &mut impl FnMut(Zero),
    ) {
        let rising = slope > 0.0;
        if (at_start < 0.0 && at_end > 0.0) || (at_start > 0.0 && at_end < 0.0) {
            let time = self.refine([start, end], rising);
            let reach = self.reach((self.function)(time)[1]);
            let window = [time - reach, time + reach];
            return found(Zero::Crossing {
                time,
                rising,
                window,
            });
        }
        for (time, value) in [(start, at_start), (end, at_end)] {
            if value.abs() <= self.slack {
                let reach = self.reach((self.function)(time)[1]);
                found(Zero::Flat {
                    times: [time; 2],
                    window: [time - reach, time + reach],
                });
            }
        }
    }

    /// How far from a zero with this slope the value may still be below the slack.
    ///
    /// With f' the slope and B the curvature, |f| >= f' t - B t^2 / 2, which exceeds the slack at 2
    /// slack / f' when f'^2 >= 2 B slack. Otherwise the function turns so nearby that the next zero
    /// cannot be separated from this one.
    fn reach(&self, slope: f64) -> f64 {
        let steep = 2.0 * self.slack / slope.abs();
        let turning = 2.0 * (2.0 * self.slack / self.curvature).sqrt();
        ROOT_RESOLUTION
            + if steep <= turning || self.curvature == 0.0 {
                steep
            } else {
                turning
            }
    }

    /// Newton's method on a monotone piece with a change of sign, kept inside the bracket by
    /// bisection.
    fn refine(&self, [mut start, mut end]: [f64; 2], rising: bool) -> f64 {
        let mut time = start + (end - start) / 2.0;
        // Both kinds of step at least halve the error here: the slope does not vanish within the
        // piece, so Newton's method is slowest next to a double zero. Usually far fewer steps are
        // taken than there are bits.
        for _ in 0..MAX_STEPS {
            let [value, slope] = (self.function)(time);
            if value == 0.0 {
                return time;
            }
            if (value > 0.0) == rising {
                end = time;
            } else {
                start = time;
            }
            let newton = time - value / slope;
            let next = if newton > start && newton < end {
                newton
            } else {
                start + (end - start) / 2.0
            };
            if (next - time).abs() <= ROOT_RESOLUTION {
                return next;
            }
            time = next;
        }
        time
    }
}

/// Most steps of a refinement: about twice the bits of a time.
const MAX_STEPS: usize = 128;

/// Most coefficients of a polynomial that [`positive_until`] takes.
pub(crate) const MOST_TERMS: usize = 11;

/// A time up to which a polynomial is positive, at most `to`; `from` if it is not positive there.
///
/// - `coefficients`: of t^0, t^1, ..., at most [`MOST_TERMS`] of them. The caller subtracts the
///   possible rounding error of the value.
///
/// # Guarantee
/// Positive on all of [`from`, result), up to the rounding of the evaluation. The result falls
/// short of the first zero by a fraction of the distance to it, and this fraction decreases with
/// the square of the distance.
///
/// # Cost
/// At most [`LEAPS`] evaluations of value, slope and curvature, about 20 ns each for short ones.
///
/// # Why
/// Around a time, the polynomial is at least q0 + q1 x + (q2 - R T) x^2 for x in [0, T], with R a
/// bound on a sixth of the third derivative. So it is positive up to the first zero of that
/// parabola. Stopping there and starting again is Newton's method from one side.
pub(crate) fn positive_until(coefficients: &[f64], from: f64, to: f64) -> f64 {
    let farthest = from.abs().max(to.abs());
    let third = coefficients.iter().zip(&THREE_OF).skip(3).rev();
    let third = third.fold(0.0, |sum, (c, three)| sum * farthest + three * c.abs());
    let mut at = from;
    for _ in 0..LEAPS {
        let mut q = [0.0; 3];
        for c in coefficients.iter().rev() {
            q = [q[0] * at + c, q[1] * at + q[0], q[2] * at + q[1]];
        }
        if q[0].is_nan() || q[0] <= 0.0 {
            return at;
        }
        let left = to - at;
        let leap = leap(q, third, left);
        if leap >= left {
            return to;
        }
        at += leap;
        if leap <= LAST_LEAP * (at - from) {
            return at;
        }
    }
    at
}

/// Most evaluations of one polynomial: each squares the error, and two are usual.
const LEAPS: usize = 8;

/// A leap that is shorter than this fraction of the distance so far is the last one: the bounds
/// behind it are soon renewed anyway.
const LAST_LEAP: f64 = 1e-3;

/// k (k - 1) (k - 2) / 6, a sixth of the third derivative of t^k at 1.
const THREE_OF: [f64; MOST_TERMS] = {
    let mut table = [0.0; MOST_TERMS];
    let mut k = 3;
    while k < MOST_TERMS {
        table[k] = (k * (k - 1) * (k - 2) / 6) as f64;
        k += 1;
    }
    table
};

/// A distance from 0, at most `longest`, up to which q0 + q1 x + q2 x^2 - `third` x^3 with a
/// positive q0 is certainly positive.
fn leap(q: [f64; 3], third: f64, longest: f64) -> f64 {
    let mut reach = longest;
    let mut certain: f64 = 0.0;
    // A shorter reach makes the cubic term smaller.
    for _ in 0..2 {
        let rest = third * reach;
        let zero = first_zero(q[0], q[1], q[2] - rest);
        if zero.is_nan() {
            return certain;
        }
        let way = zero.min(reach);
        certain = certain.max(way);
        if way >= reach || rest * way * way <= SMALL_REST * q[0] {
            break;
        }
        reach = longest.min(4.0 * way);
    }
    certain
}

/// Fraction of the value that the cubic term may take where the parabola ends: a smaller term is
/// not reduced further.
const SMALL_REST: f64 = 0.05;

/// The first positive zero of q0 + q1 x + q2 x^2 for q0 > 0, or infinity.
fn first_zero(q0: f64, q1: f64, q2: f64) -> f64 {
    let discriminant = q1 * q1 - 4.0 * q2 * q0;
    if discriminant < 0.0 || (q2 >= 0.0 && q1 >= 0.0) {
        return f64::INFINITY;
    }
    let root = discriminant.sqrt();
    if q1 <= 0.0 {
        2.0 * q0 / (root - q1)
    } else {
        (q1 + root) / (-2.0 * q2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::random;

    fn zeros(function: impl Fn(f64) -> [f64; 2], curvature: f64, window: [f64; 2]) -> Vec<Zero> {
        let mut all = Vec::new();
        Searched {
            function,
            curvature,
            slack: 1e-15,
        }
        .zeros(window, |zero| all.push(zero));
        all
    }

    /// Product of (t - root), with its slope.
    fn product(roots: &[f64]) -> impl Fn(f64) -> [f64; 2] {
        move |t| {
            roots.iter().fold([1.0, 0.0], |[value, slope], root| {
                [value * (t - root), slope * (t - root) + value]
            })
        }
    }

    #[test]
    fn simple_zeros_are_found_once_each_with_their_sense() {
        let roots = [0.1, 0.2, 0.20001, 0.9];
        let mut found = zeros(product(&roots), 12.0, [0.0, 1.0]);
        found.sort_by(|a, b| window(a)[0].total_cmp(&window(b)[0]));
        assert_eq!(found.len(), 4, "{found:?}");
        for (k, zero) in found.iter().enumerate() {
            let Zero::Crossing {
                time,
                rising,
                window,
            } = *zero
            else {
                panic!("{zero:?} is simple")
            };
            assert!((time - roots[k]).abs() < 1e-11, "{time} for {}", roots[k]);
            assert_eq!(rising, k % 2 == 1, "the product starts positive");
            assert!(
                window[0] <= roots[k] && roots[k] <= window[1],
                "{window:?} holds {}",
                roots[k]
            );
        }
    }

    #[test]
    fn a_double_zero_is_one_small_flat_stretch() {
        let found = zeros(product(&[0.3, 0.3]), 2.0, [0.0, 1.0]);
        assert!(!found.is_empty(), "it must not be lost");
        for zero in &found {
            let [start, end] = window(zero);
            assert!(start > 0.3 - 2e-7 && end < 0.3 + 2e-7, "{zero:?}");
        }
    }

    #[test]
    fn a_near_miss_beyond_the_slack_is_no_zero() {
        assert!(
            zeros(
                |t| [(t - 0.3) * (t - 0.3) + 1e-13, 2.0 * (t - 0.3)],
                2.0,
                [0.0, 1.0]
            )
            .is_empty(),
            "1e-13 apart"
        );
    }

    #[test]
    fn a_zero_at_an_end_is_found_from_either_side() {
        for (window, at) in [([0.0, 0.5], 0.5), ([0.5, 1.0], 0.5)] {
            let found = zeros(|t| [t - at, 1.0], 0.0, window);
            assert_eq!(found.len(), 1, "{found:?}");
            let [start, end] = self::window(&found[0]);
            assert!(start <= at && at <= end, "{found:?}");
        }
    }

    #[test]
    fn a_function_that_vanishes_is_flat_throughout() {
        let found = zeros(|_| [0.0, 0.0], 0.0, [-1.0, 2.0]);
        let [Zero::Flat { times, .. }] = found[..] else {
            panic!("one stretch, not {found:?}")
        };
        assert_eq!(times, [-1.0, 2.0], "all of it");
    }

    #[test]
    fn fast_oscillation_is_resolved_by_the_bound_on_its_curvature() {
        let omega = 300.0;
        let found = zeros(
            |t| [(omega * t).sin(), omega * (omega * t).cos()],
            omega * omega,
            [0.001, 0.999],
        );
        let crossings = found
            .iter()
            .filter(|zero| matches!(zero, Zero::Crossing { .. }))
            .count();
        assert_eq!(crossings, 95, "multiples of pi in (0.3, 299.7)");
    }

    #[test]
    fn a_polynomial_is_positive_until_near_its_first_zero() {
        // (t - 0.5)(t - 0.7)(t + 2) from below 0.5: positive there.
        let cubic = [0.7, -2.05, 0.8, 1.0];
        let until = positive_until(&cubic, 0.0, 1.0);
        assert!(until <= 0.5 && until > 0.5 - 1e-9, "{until}");
        assert_eq!(positive_until(&cubic, 0.6, 1.0), 0.6, "negative at once");
        assert_eq!(
            positive_until(&cubic, 0.71, 9.0),
            9.0,
            "positive to the end"
        );
        assert_eq!(positive_until(&[1.0], 0.0, 3.0), 3.0, "a constant");
        assert_eq!(
            positive_until(&[0.0, 1.0], 0.0, 3.0),
            0.0,
            "zero is not positive"
        );
        let near_miss = [0.09 + 1e-13, -0.6, 1.0];
        assert_eq!(positive_until(&near_miss, 0.0, 1.0), 1.0, "a miss by 1e-13");
    }

    #[test]
    fn positive_until_never_passes_a_zero() {
        let mut next = random(1);
        for case in 0..2000 {
            let coefficients: [f64; MOST_TERMS] = std::array::from_fn(|_| next());
            let value = |t: f64| coefficients.iter().rev().fold(0.0, |sum, c| sum * t + c);
            let until = positive_until(&coefficients, -1.0, 1.0);
            let sampled = (0..=2000)
                .map(|i| f64::from(i) / 1000.0 - 1.0)
                .find(|&t| value(t) <= -1e-12)
                .unwrap_or(1.0);
            assert!(until <= sampled, "case {case}: {until} beyond {sampled}");
            if value(-1.0) > 0.0 {
                assert!(until > -1.0, "case {case}: some way");
            }
        }
    }

    fn window(zero: &Zero) -> [f64; 2] {
        match *zero {
            Zero::Crossing { window, .. } | Zero::Flat { window, .. } => window,
        }
    }
}
