//! Exponentials and growth rates with proven bounds on their rounding, for bounds that must not be
//! too small.
//!
//! This is independent of the spectral form of [`super::Flow`], which is faster and more accurate
//! but has no error analysis of its own here. All norms of errors are Frobenius norms; u is the
//! unit roundoff and gamma_n = n u / (1 - n u).

use crate::numeric::norms::frobenius_squared;
use crate::numeric::tolerance::UNIT_ROUNDOFF as U;
use glam::{DMat3, DVec3};

/// Logarithmic norms of M and of -M, bounded from above.
#[derive(Debug, Clone, Copy)]
pub(super) struct GrowthRates {
    /// |exp(tM)| <= e^(t forward) for t >= 0.
    pub(super) forward: f64,
    /// |exp(-tM)| <= e^(t backward) for t >= 0.
    pub(super) backward: f64,
}

impl GrowthRates {
    pub(super) fn new(linear: &DMat3) -> GrowthRates {
        GrowthRates {
            forward: growth_rate(linear),
            backward: growth_rate(&-*linear),
        }
    }

    /// The largest rate at which the norm of exp(tM) may change.
    pub(super) fn largest(&self) -> f64 {
        self.forward.max(self.backward)
    }

    /// Bound on the logarithmic norm of tM.
    fn at(&self, t: f64) -> f64 {
        if t >= 0.0 {
            above(t * self.forward)
        } else {
            above(-t * self.backward)
        }
    }
}

/// exp(X) - I and phi1(X), each with a bound on its error.
#[derive(Debug, Clone, Copy)]
pub(super) struct Enclosure {
    /// exp(X) - I.
    pub(super) change: DMat3,
    pub(super) change_error: f64,
    /// phi1(X) = integral of exp(sX) over s in [0, 1].
    pub(super) integral: DMat3,
    pub(super) integral_error: f64,
}

/// Terms of the Taylor sum: for |X| <= 1/2, the remainder |X|^14/15! is below u/2.
const TERMS: u32 = 13;
/// Bound on both errors of the Taylor sum, in units of u. Horner: 2 gamma_4 (|X| |P| + sqrt 3) < 23
/// u with |P| < 2.25; the remainder, the coefficients and the rounding of X itself: below 3 u each.
/// exp(X) - I = X P adds 4 u |X| |P|.
const TAYLOR_ERROR: f64 = 32.0 * U;
/// A little more than gamma_5: one product of 3 x 3 matrices and two sums.
const PRODUCT_ERROR: f64 = 6.0 * U;

impl Enclosure {
    /// Encloses exp(tM) - I and phi1(tM). The bounds are infinite (or NaN) beyond the range of f64.
    ///
    /// Taylor sum of X / 2^k, then k doublings, A' = A^2 and P' = (A + I) P / 2. With |A| <= s, an
    /// error e of A grows to 2 s e + e^2, and an error p of P to (1 + s) p / 2 + e |P| / 2. The
    /// growth s is bounded by the logarithmic norm, so that the errors of rotations only double.
    pub(super) fn new(linear: &DMat3, t: f64, rates: &GrowthRates) -> Enclosure {
        let whole = *linear * t;
        let size = frobenius_bound(&whole);
        let halvings = if size > 0.5 {
            (2.0 * size).log2().ceil().clamp(0.0, 1100.0)
        } else {
            0.0
        };
        let shrink = (-halvings).exp2();
        let x = whole * shrink;
        let mut coefficient = 1.0 / factorial(TERMS + 1);
        let mut integral = DMat3::IDENTITY * coefficient;
        for j in (1..=TERMS).rev() {
            coefficient *= f64::from(j + 1);
            integral = x * integral + DMat3::IDENTITY * coefficient;
        }
        let mut change = x * integral;
        let (mut change_error, mut integral_error) = (TAYLOR_ERROR, TAYLOR_ERROR);
        let mut rate = rates.at(t) * shrink + 2.0 * U * frobenius_bound(&x);
        let mut done = 0.0;
        while done < halvings {
            let (e, p) = (frobenius_bound(&change), frobenius_bound(&integral));
            let growth =
                above(rate.exp()).min(frobenius_bound(&(change + DMat3::IDENTITY)) + change_error);
            integral_error = above(
                0.5 * (1.0 + growth) * integral_error
                    + 0.5 * change_error * p
                    + PRODUCT_ERROR * (p + 0.5 * e * p),
            );
            change_error = above(
                2.0 * growth * change_error
                    + change_error * change_error
                    + PRODUCT_ERROR * (2.0 * e + e * e),
            );
            integral += change * integral * 0.5;
            change = change * 2.0 + change * change;
            rate *= 2.0;
            done += 1.0;
        }
        Enclosure {
            change,
            change_error,
            integral,
            integral_error,
        }
    }

    /// Upper bound of the spectral norm of exp(X); infinite beyond the range of f64.
    pub(super) fn norm(&self) -> f64 {
        let exponential = self.change + DMat3::IDENTITY;
        let square = exponential.transpose() * exponential;
        let size = frobenius_bound(&exponential);
        let largest = largest_eigenvalue(&square) + PRODUCT_ERROR * size * size;
        let norm = above(largest.sqrt() + self.change_error + 2.0 * U * size);
        if norm.is_nan() { f64::INFINITY } else { norm }
    }
}

/// Lower bound of |L x| / |x|: the least singular value of L, up to rounding below it; 0 where L is
/// singular.
pub(crate) fn least_stretch(linear: &DMat3) -> f64 {
    let inverse = linear.inverse();
    let square = inverse.transpose() * inverse;
    let size = frobenius_bound(&inverse);
    let norm = above((largest_eigenvalue(&square) + PRODUCT_ERROR * size * size).sqrt());
    // The inverse is off by its condition, a few roundings of |L^-1| |L|.
    let condition = size * frobenius_bound(linear);
    let least = (1.0 - 16.0 * U * condition) / norm;
    if least > 0.0 { least } else { 0.0 }
}

/// Upper bound of the logarithmic norm of M: |exp(tM)| <= e^(t mu) for t >= 0, with equality for
/// multiples of the identity plus a skew matrix, for which the bound is exact.
fn growth_rate(linear: &DMat3) -> f64 {
    let symmetric = (*linear + linear.transpose()) * 0.5;
    // Off the diagonal the sum is rounded; on it, the doubling is exact.
    let mixed = DVec3::new(symmetric.y_axis.x, symmetric.z_axis.x, symmetric.z_axis.y);
    largest_eigenvalue(&symmetric) + 2.0 * U * mixed.length()
}

/// Upper bound of the largest eigenvalue of a symmetric matrix, above it by a few units in the last
/// place of the matrix norm.
///
/// An approximation by Jacobi rotations is raised until Cholesky's method proves that c I - S is
/// positive definite. Success in floating point proves it for a matrix within gamma_4 trace(c I -
/// S) (Higham, Accuracy and Stability, theorem 10.3).
fn largest_eigenvalue(symmetric: &DMat3) -> f64 {
    let s = symmetric;
    let diagonal = DVec3::new(s.x_axis.x, s.y_axis.y, s.z_axis.z);
    if s.y_axis.x == 0.0 && s.z_axis.x == 0.0 && s.z_axis.y == 0.0 {
        return diagonal.max_element();
    }
    let size = frobenius_bound(s);
    if !size.is_finite() {
        return f64::INFINITY;
    }
    let approximation = jacobi(s).max_element();
    let mut lift = 8.0 * U * size;
    // When raised by 2 |S| at the latest, the shifted matrix is positive definite by far: 4^27 u
    // > 2.
    for _ in 0..30 {
        let bound = approximation + lift;
        if is_positive_definite(&(DMat3::from_diagonal(DVec3::splat(bound)) - *s)) {
            return bound + 16.0 * U * (size + bound.abs());
        }
        lift *= 4.0;
    }
    above(size)
}

/// Approximate eigenvalues.
fn jacobi(symmetric: &DMat3) -> DVec3 {
    let mut s = symmetric.to_cols_array_2d();
    // Cyclic sweeps converge quadratically: 3 to 5 are usual.
    for _ in 0..8 {
        for (p, q, r) in [(0, 1, 2), (0, 2, 1), (1, 2, 0)] {
            let off = s[p][q];
            if off == 0.0 {
                continue;
            }
            let cotangent = (s[q][q] - s[p][p]) / (2.0 * off);
            let tangent = 1.0_f64.copysign(cotangent) / (cotangent.abs() + cotangent.hypot(1.0));
            let cosine = 1.0 / tangent.hypot(1.0);
            let sine = tangent * cosine;
            s[p][p] -= tangent * off;
            s[q][q] += tangent * off;
            (s[p][q], s[q][p]) = (0.0, 0.0);
            let (a, b) = (s[p][r], s[q][r]);
            (s[p][r], s[q][r]) = (cosine * a - sine * b, sine * a + cosine * b);
            (s[r][p], s[r][q]) = (s[p][r], s[q][r]);
        }
    }
    DVec3::new(s[0][0], s[1][1], s[2][2])
}

fn is_positive_definite(matrix: &DMat3) -> bool {
    let m = matrix;
    let l00 = m.x_axis.x.sqrt();
    let (l10, l20) = (m.x_axis.y / l00, m.x_axis.z / l00);
    let l11 = (m.y_axis.y - l10 * l10).sqrt();
    let l21 = (m.y_axis.z - l20 * l10) / l11;
    let last = m.z_axis.z - l20 * l20 - l21 * l21;
    // The square root of a negative number is NaN and fails these comparisons.
    l00 > 0.0 && l11 > 0.0 && last > 0.0
}

/// An upper bound of |M|_F, rounding included.
pub(super) fn frobenius_bound(matrix: &DMat3) -> f64 {
    let sum = frobenius_squared(matrix);
    // The squares of entries below 1e-154 underflow, but the entries still count.
    let tiny = super::deflation::largest_entry(matrix);
    above(sum.sqrt()).max(if sum < f64::MIN_POSITIVE / U {
        3.0 * tiny
    } else {
        0.0
    })
}

/// A number computed with at most eight roundings, raised above the exact one.
pub(super) fn above(value: f64) -> f64 {
    value + 8.0 * U * value.abs()
}

fn factorial(n: u32) -> f64 {
    (1..=n).map(f64::from).product()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{Flow, Generator};
    use crate::samples::random;

    #[test]
    fn the_enclosure_contains_the_spectral_exponential() {
        let mut next = random(7);
        for case in 0..2000 {
            let size = [1e-6, 0.1, 1.0, 4.0][case % 4];
            let linear = DMat3::from_cols_array(&std::array::from_fn(|_| size * next()));
            let enclosure = Enclosure::new(&linear, 1.0, &GrowthRates::new(&linear));
            let pose = Flow::new(Generator {
                linear,
                offset: DVec3::X,
            })
            .pose_at(1.0);
            let norm = frobenius_bound(&pose.matrix3);
            let miss = frobenius_bound(&(pose.matrix3 - (enclosure.change + DMat3::IDENTITY)));
            // The other method's own error is added to what is allowed.
            let other = 50.0 * f64::EPSILON * norm;
            assert!(
                miss <= enclosure.change_error + other,
                "case {case}: {miss:e} > {:e}",
                enclosure.change_error
            );
            assert!(
                enclosure.change_error < 1e-11 * norm,
                "case {case}: error {:e}",
                enclosure.change_error
            );
            let shift = (pose.translation - enclosure.integral.x_axis).length();
            assert!(
                shift <= enclosure.integral_error + other,
                "case {case}: integral off by {shift:e}"
            );
        }
    }

    #[test]
    fn errors_of_rotations_only_double() {
        let turn = DMat3::from_cols_array(&[0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0]);
        let enclosure = Enclosure::new(&turn, 1000.0, &GrowthRates::new(&turn));
        assert!(
            enclosure.change_error < 5e-11,
            "11 doublings of some 60 u: error {:e}",
            enclosure.change_error
        );
    }

    #[test]
    fn the_growth_rate_bounds_every_direction() {
        let mut next = random(3);
        for _ in 0..500 {
            let linear = DMat3::from_cols_array(&std::array::from_fn(|_| next()));
            let rate = growth_rate(&linear);
            let mut best = f64::NEG_INFINITY;
            for _ in 0..200 {
                let direction = DVec3::new(next(), next(), next()).normalize();
                best = best.max(direction.dot(linear * direction));
            }
            assert!(best <= rate, "{best} > {rate}");
            let exact = jacobi(&((linear + linear.transpose()) * 0.5)).max_element();
            assert!(rate - exact < 3e-14, "not tight: {rate} against {exact}");
        }
    }

    #[test]
    fn the_growth_rate_of_a_similarity_is_exact() {
        let generator = Generator::screw(DVec3::new(0.6, 0.0, 0.8), DVec3::X, 3.0, 1.0, 0.6);
        assert_eq!(
            growth_rate(&generator.linear),
            0.6_f64.ln(),
            "the rate of the scale"
        );
        assert_eq!(growth_rate(&DMat3::ZERO), 0.0, "no growth");
    }

    #[test]
    fn repeated_and_tiny_eigenvalues_are_bounded() {
        let flat = DMat3::from_cols_array(&[1.0; 9]);
        let bound = largest_eigenvalue(&flat);
        assert!(
            (3.0..3.0 + 1e-13).contains(&bound),
            "eigenvalues 3, 0, 0: {bound}"
        );
        let double = DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0]);
        let bound = largest_eigenvalue(&double);
        assert!(
            (1.0..1.0 + 1e-13).contains(&bound),
            "eigenvalues 1, 1, -1: {bound}"
        );
        let tiny = largest_eigenvalue(&(flat * 1e-200));
        assert!(
            (3e-200..3.1e-200).contains(&tiny),
            "small is not zero: {tiny:e}"
        );
    }
}
