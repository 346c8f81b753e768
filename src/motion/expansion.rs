//! Short paths of points under a steady motion, as polynomials of time with a bound on the
//! remainder.
//!
//! Key: v(p) = M p + tau the velocity field, h half the width of a window of time, s the time from
//! its middle. A point that is at p in the middle is at p(s) = sum_j s^j d_j with
//!
//! > d_0 = p,   d_1 = v(p),   d_(j+1) = M d_j / (j + 1).
//!
//! # The rest
//! The k-th derivative of the path is M times the one before. So a bound on one of them over the
//! whole window bounds all higher ones, and the terms from s^n on add at most h^n / n! times the
//! largest n-th derivative (Taylor).

use super::Generator;
use crate::numeric::roots::MOST_TERMS;
use crate::numeric::tolerance::{PATH_ROUNDING, UNIT_ROUNDOFF};
use glam::DVec3;

/// The inverses 1 / k.
const INVERSE: [f64; MOST_TERMS + 1] = {
    let mut table = [1.0; MOST_TERMS + 1];
    let mut k = 2;
    while k <= MOST_TERMS {
        table[k] = 1.0 / k as f64;
        k += 1;
    }
    table
};

/// The path of a point over a window: the coefficients of s^0, s^1, ...; the user knows how many of
/// them count.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Curve(pub(crate) [DVec3; MOST_TERMS]);

impl Curve {
    /// At rest at the origin.
    pub(crate) const ORIGIN: Curve = Curve([DVec3::ZERO; MOST_TERMS]);

    /// Makes this the path of the point that is at a place in the middle of the window;
    /// coefficients beyond `terms` are left unchanged.
    pub(crate) fn draw(&mut self, generator: &Generator, place: DVec3, terms: usize) {
        self.0[0] = place;
        if terms > 1 {
            let mut last = generator.velocity(place);
            self.0[1] = last;
            for (coefficient, inverse) in self.0[2..terms].iter_mut().zip(&INVERSE[2..]) {
                last = generator.linear * last * *inverse;
                *coefficient = last;
            }
        }
    }

    /// The position at a time from the middle.
    pub(crate) fn at(&self, terms: usize, time: f64) -> DVec3 {
        sum(&self.0[..terms], time)
    }

    /// The position at a time from the middle, relative to that in the middle.
    pub(crate) fn displacement(&self, terms: usize, time: f64) -> DVec3 {
        sum(&self.0[1..terms], time) * time
    }
}

fn sum(coefficients: &[DVec3], time: f64) -> DVec3 {
    let coefficients = coefficients.iter().rev();
    coefficients.fold(DVec3::ZERO, |sum, &c| sum * time + c)
}

/// A bound on the remainder of a path of `terms` terms, at most `MOST_TERMS`.
///
/// - `term`: bound on h^k / k! times the k-th derivative over the window, k = `degree`.
/// - `reduced`: |M| h.
pub(crate) fn remainder(term: f64, degree: usize, terms: usize, reduced: f64) -> f64 {
    let inverses = INVERSE[degree + 1..=terms].iter();
    inverses.fold(term, |rest, inverse| rest * (reduced * inverse))
}

/// The number of terms for which the remainder is below rounding, relative to the second term.
///
/// - `reduced`: |M| h.
pub(crate) fn terms(reduced: f64) -> usize {
    (2..MOST_TERMS)
        .find(|&terms| remainder(1.0, 1, terms, reduced) <= UNIT_ROUNDOFF)
        .unwrap_or(MOST_TERMS)
}

/// A bound on the rounding of a position on a path, relative to the largest coordinate in its
/// computation (`PATH_ROUNDING`).
///
/// - `sizes`: |M| over all of the motions that lead there.
pub(crate) fn rounding(sizes: &[f64]) -> f64 {
    PATH_ROUNDING * UNIT_ROUNDOFF * sizes.iter().fold(1.0, |sum, size| sum + size)
}

#[cfg(test)]
mod tests {
    use super::super::path_bounds;
    use super::*;
    use glam::DMat3;

    fn generators() -> [Generator; 4] {
        [
            Generator::screw(DVec3::Z, DVec3::X, 3.0, 2.0, 1.0),
            Generator::screw(DVec3::Y, DVec3::ZERO, 1.0, 0.0, 0.3),
            Generator {
                linear: DMat3::from_cols(DVec3::ZERO, DVec3::X * 3.0, DVec3::ZERO),
                offset: DVec3::Z,
            },
            Generator {
                linear: DMat3::from_cols_array(&[0.3, 2.0, -0.4, -1.7, -0.5, 0.6, 0.2, -0.9, 0.1]),
                offset: DVec3::new(0.4, -0.7, 0.5),
            },
        ]
    }

    #[test]
    fn what_a_path_leaves_out_is_within_the_remainder() {
        let place = DVec3::new(1.0, -2.0, 0.5);
        for generator in generators() {
            let half = 0.5 / generator.size();
            let reduced = generator.size() * half;
            // No velocity within the window is larger than e^(|M| h) times that in its middle.
            let speed = generator.velocity(place).length() * reduced.exp();
            let mut curve = Curve::ORIGIN;
            curve.draw(&generator, place, MOST_TERMS);
            for terms in 2..=MOST_TERMS {
                let rest = remainder(half * speed, 1, terms, reduced);
                for share in [-1.0, -0.4, 0.7, 1.0] {
                    let time = share * half;
                    let [low, high] = path_bounds(&generator, place, [time, time]);
                    let found = curve.at(terms, time);
                    let miss = (low - found).max(found - high).max(DVec3::ZERO).length();
                    let slack = rounding(&[generator.size()]) * place.length();
                    assert!(miss <= rest + slack, "{terms} terms at {time}: {miss:e}");
                    let apart = (curve.displacement(terms, time) + place).distance(found);
                    assert!(apart <= slack, "{terms} terms at {time}: {apart:e}");
                }
            }
        }
    }

    #[test]
    fn paths_have_no_more_terms_than_rounding_can_tell() {
        // A half, a sixth and a 24th of 1e-5 to the power of 1, 2 and 3, relative to the second
        // term.
        assert_eq!(terms(1e-5), 4, "4e-17 is below the unit roundoff");
        assert_eq!(terms(1e-16), 2, "a straight line");
        assert_eq!(terms(1.0), MOST_TERMS, "as many as there are");
        for k in 1..200 {
            let reduced = 1e-3 * f64::from(k);
            let found = terms(reduced);
            let rest = remainder(1.0, 1, found, reduced);
            assert!(rest <= UNIT_ROUNDOFF || found == MOST_TERMS, "{reduced}");
        }
    }

    #[test]
    fn few_terms_leave_the_others_alone() {
        let mut curve = Curve::ORIGIN;
        curve.draw(&generators()[0], DVec3::ONE, 3);
        assert!(
            curve.0[2] != DVec3::ZERO && curve.0[3] == DVec3::ZERO,
            "three"
        );
        curve.draw(&generators()[0], DVec3::X, 1);
        assert_eq!(curve.at(1, 9.0), DVec3::X, "at rest");
    }
}
