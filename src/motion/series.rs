//! Affine maps that change with time, as polynomials over a window with a proven bound on the rest.
//!
//! Over a window with the middle m and half the width h, with s = (t - m) / h in [-1, 1],
//!
//! > P(t) = sum_k s^k C_k + rest,   k < [`TERMS`],
//!
//! where the C_k have a linear part and an offset, as the pose has. Since |s| <= 1, the sum of the
//! norms of the omitted terms bounds the rest.
//!
//! - A steady motion exp(tG) P: C_k = (h G)^k P(m) / k!. Each term is at most |h M| / k times the
//!   one before, so the omitted ones add up to the first of them over 1 - |h M| / (`TERMS` + 1).
//! - exp(X + tY) with X and Y that need not commute: the exponential series of Z = (X + tY) / 2^n,
//!   |Z| <= 1/2, by Horner's rule, then n squarings, all with polynomials (Alexa's and Kaji &
//!   Ochiai's motions are of this form).
//! - A product: the products of terms of higher order, and of terms with a rest, go to the rest.
//!
//! Norms are Frobenius norms, rounded up, and the rounding of the terms is part of the rest.

use super::Generator;
use super::enclosure::{above, frobenius_bound};
use crate::numeric::tolerance::UNIT_ROUNDOFF;
use glam::{DAffine3, DMat3, DVec3};

/// Number of terms. A window in which something turns by half a radian leaves a rest of 5e-13 of
/// the size.
pub(super) const TERMS: usize = 12;

/// Terms of the exponential series of a matrix of norm 1/2 at most: the omitted ones are below
/// 0.5^16 / 16! < 1e-18.
const EXPONENTIAL_TERMS: u32 = 15;

/// A coefficient: what it does to a point x is L x + o.
#[derive(Debug, Clone, Copy)]
pub(super) struct Term {
    pub(super) linear: DMat3,
    pub(super) offset: DVec3,
}

/// Rounding of a sum of [`TERMS`] products of 3 x 3 matrices relative to the product of the sums of
/// norms: gamma_3 times sqrt(3) for a product, and a rounding for each sum.
const ROUNDING: f64 = (6 + TERMS) as f64 * UNIT_ROUNDOFF;

/// An affine map over a window.
#[derive(Debug, Clone)]
pub(super) struct Series {
    pub(super) terms: [Term; TERMS],
    pub(super) rest: Rest,
}

/// A bound: |what is left out| <= linear |x| + offset at any time in the window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rest {
    pub(super) linear: f64,
    pub(super) offset: f64,
}

impl Term {
    const ZERO: Term = Term {
        linear: DMat3::ZERO,
        offset: DVec3::ZERO,
    };

    pub(super) fn of_pose(pose: &DAffine3) -> Term {
        Term {
            linear: pose.matrix3,
            offset: pose.translation,
        }
    }

    /// M L, M o.
    fn carried(&self, matrix: &DMat3) -> Term {
        Term {
            linear: *matrix * self.linear,
            offset: *matrix * self.offset,
        }
    }

    fn plus(&self, other: &Term) -> Term {
        Term {
            linear: self.linear + other.linear,
            offset: self.offset + other.offset,
        }
    }

    fn scaled(&self, factor: f64) -> Term {
        Term {
            linear: self.linear * factor,
            offset: self.offset * factor,
        }
    }

    pub(super) fn at(&self, point: DVec3) -> DVec3 {
        self.linear * point + self.offset
    }

    /// Bound on |L x| + |o| for points up to a distance from the origin.
    pub(super) fn reach(&self, distance: f64) -> f64 {
        self.size().at(distance)
    }

    fn size(&self) -> Rest {
        Rest {
            linear: frobenius_bound(&self.linear),
            offset: above(self.offset.length()),
        }
    }
}

impl Rest {
    const NONE: Rest = Rest {
        linear: 0.0,
        offset: 0.0,
    };

    fn plus(self, other: Rest) -> Rest {
        Rest {
            linear: above(self.linear + other.linear),
            offset: above(self.offset + other.offset),
        }
    }

    fn scaled(self, factor: f64) -> Rest {
        Rest {
            linear: above(self.linear * factor),
            offset: above(self.offset * factor),
        }
    }

    /// The bound for points up to a distance from the origin.
    pub(super) fn at(self, distance: f64) -> f64 {
        above(self.linear * distance + self.offset)
    }
}

impl Series {
    /// A map that does not change.
    pub(super) fn constant(pose: &DAffine3) -> Series {
        Series::line(Term::of_pose(pose), Term::ZERO)
    }

    /// `middle` + s `slope`.
    pub(super) fn line(middle: Term, slope: Term) -> Series {
        let mut terms = [Term::ZERO; TERMS];
        (terms[0], terms[1]) = (middle, slope);
        Series {
            terms,
            rest: Rest::NONE,
        }
    }

    /// exp(s half G) P with the pose P in the middle of the window.
    pub(super) fn steady(generator: &Generator, middle: &DAffine3, half: f64) -> Series {
        let linear = generator.linear * half;
        let mut terms = [Term::ZERO; TERMS];
        terms[0] = Term::of_pose(middle);
        terms[1] = Term {
            linear: linear * middle.matrix3,
            offset: linear * middle.translation + generator.offset * half,
        };
        for k in 2..TERMS {
            terms[k] = terms[k - 1].carried(&linear).scaled(1.0 / k as f64);
        }
        let size = frobenius_bound(&linear);
        let next = terms[TERMS - 1].size().scaled(size / TERMS as f64);
        let omitted = next.scaled(tail_factor(size / (TERMS + 1) as f64));
        let mut series = Series {
            terms,
            rest: omitted,
        };
        // Every term is the one before times a matrix: 5 u each time, and most of the sum is in the
        // first few.
        series.rest = omitted.plus(series.size().scaled(ROUNDING * (1.0 + size)));
        series
    }

    /// exp(X + s Y) for generators X and Y, which need not commute.
    pub(super) fn exponential(middle: &Generator, slope: &Generator) -> Series {
        let size = above(middle.size() + slope.size());
        let halvings = if size > 0.5 {
            (2.0 * size).log2().ceil().min(64.0)
        } else {
            0.0
        };
        let shrink = (-halvings).exp2();
        let [x, y] = [middle, slope].map(|generator| Term {
            linear: generator.linear * shrink,
            offset: generator.offset * shrink,
        });
        let identity = Term::of_pose(&DAffine3::IDENTITY);
        // 1 + Z (1 + Z/2 (1 + Z/3 (...))).
        let mut sum = Series::constant(&DAffine3::IDENTITY);
        for k in (1..=EXPONENTIAL_TERMS).rev() {
            let inverse = 1.0 / f64::from(k);
            sum = Series::line(x.scaled(inverse), y.scaled(inverse)).after(&sum);
            sum.terms[0] = sum.terms[0].plus(&identity);
        }
        let largest = x.size().plus(y.size());
        let omitted = (1..=EXPONENTIAL_TERMS + 1)
            .fold(1.0, |product, k| product * largest.linear / f64::from(k))
            * tail_factor(largest.linear);
        // Z^k = M^(k-1) [M tau]: the offset of a term is |tau| / |M| times its linear part.
        let offset = if largest.linear > 0.0 {
            omitted * (largest.offset / largest.linear)
        } else {
            0.0
        };
        sum.rest = sum.rest.plus(Rest {
            linear: above(omitted),
            offset: above(offset),
        });
        let mut done = 0.0;
        while done < halvings {
            sum = sum.after(&sum);
            done += 1.0;
        }
        sum
    }

    /// The map that applies `first` and then this one. Where this one is a generator rather than a
    /// map, `first` must be a map: its constant term maps 1 to 1.
    pub(super) fn after(&self, first: &Series) -> Series {
        let used = |series: &Series| {
            let is_zero = |term: &Term| term.linear == DMat3::ZERO && term.offset == DVec3::ZERO;
            TERMS
                - series
                    .terms
                    .iter()
                    .rev()
                    .take_while(|term| is_zero(term))
                    .count()
        };
        let [outer, inner] = [used(self), used(first)];
        let mut terms = [Term::ZERO; TERMS];
        for (i, left) in self.terms[..outer].iter().enumerate() {
            terms[i].offset += left.offset;
            for (j, right) in first.terms[..inner.min(TERMS - i)].iter().enumerate() {
                terms[i + j] = terms[i + j].plus(&right.carried(&left.linear));
            }
        }
        // What is left out: the products of high order, and those with a rest.
        let mut beyond = [Rest::NONE; TERMS + 1];
        for k in (0..inner).rev() {
            beyond[k] = beyond[k + 1].plus(first.terms[k].size());
        }
        let whole = beyond[0].plus(first.rest);
        let mut rest = whole.scaled(self.rest.linear);
        rest.offset = above(rest.offset + self.rest.offset);
        for (i, left) in self.terms[..outer].iter().enumerate() {
            let missing = beyond[TERMS - i].plus(first.rest);
            rest = rest.plus(missing.scaled(frobenius_bound(&left.linear)));
        }
        // A term is the sum of at most TERMS products.
        let [left, right] = [self.size(), first.size()];
        let products = Rest {
            linear: left.linear * right.linear,
            offset: left.linear * right.offset + left.offset,
        };
        rest = rest.plus(products.scaled(ROUNDING));
        Series { terms, rest }
    }

    /// The sum of two maps, such as a map and a displacement.
    pub(super) fn plus(&self, other: &Series) -> Series {
        Series {
            terms: std::array::from_fn(|k| self.terms[k].plus(&other.terms[k])),
            rest: self.rest.plus(other.rest),
        }
    }

    /// This map minus another.
    pub(super) fn minus(&self, other: &Series) -> Series {
        Series {
            terms: std::array::from_fn(|k| self.terms[k].plus(&other.terms[k].scaled(-1.0))),
            rest: self.rest.plus(other.rest),
        }
    }

    /// The sum of the sizes of the terms.
    fn size(&self) -> Rest {
        let sizes = self.terms.iter().map(Term::size);
        sizes.fold(Rest::NONE, Rest::plus)
    }

    /// The map at s in [-1, 1].
    #[cfg(test)]
    fn at(&self, s: f64) -> Term {
        let terms = self.terms.iter().rev();
        terms.fold(Term::ZERO, |sum, term| sum.scaled(s).plus(term))
    }
}

/// 1 / (1 - q): what a geometric series with the ratio q adds up to; infinite where it diverges.
fn tail_factor(ratio: f64) -> f64 {
    if ratio < 1.0 {
        above(1.0 / (1.0 - ratio))
    } else {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Flow;
    use crate::samples::random;

    fn generator(random: &mut impl FnMut() -> f64, size: f64) -> Generator {
        let linear = DMat3::from_cols_array(&std::array::from_fn(|_| size * random()));
        Generator {
            linear,
            offset: DVec3::new(random(), random(), random()) * 10.0,
        }
    }

    /// Each entry of the polynomial is within the rest and a rounding of 1e-12 of the exact pose.
    fn assert_near(series: &Series, s: f64, pose: &DAffine3, what: &str) {
        let found = series.at(s);
        let linear = (found.linear - pose.matrix3).to_cols_array();
        let off = linear.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let scale = frobenius_bound(&pose.matrix3) + 1.0;
        assert!(
            off <= series.rest.linear + 1e-12 * scale,
            "{what} at {s}: {off:e} > {:e}",
            series.rest.linear
        );
        let off = (found.offset - pose.translation).length();
        assert!(
            off <= series.rest.offset + 1e-12 * scale * (pose.translation.length() + 10.0),
            "{what} at {s}: {off:e} > {:e}",
            series.rest.offset
        );
    }

    #[test]
    fn a_steady_motion_is_within_its_rest() {
        let mut random = random(5);
        for size in [1e-3, 0.3, 2.0] {
            for half in [0.05, 0.5, 1.0] {
                let generator = generator(&mut random, size);
                let middle = Flow::new(generator).pose_at(0.7);
                let series = Series::steady(&generator, &middle, half);
                for s in [-1.0, -0.4, 0.0, 0.9, 1.0] {
                    let pose = Flow::new(generator).pose_at(half * s) * middle;
                    assert_near(&series, s, &pose, &format!("size {size}, half {half}"));
                }
                if size * half <= 0.15 {
                    assert!(series.rest.linear < 1e-9, "{:e}", series.rest.linear);
                }
            }
        }
    }

    #[test]
    fn an_exponential_of_what_does_not_commute_is_within_its_rest() {
        let mut random = random(6);
        for size in [0.01, 0.5, 3.0] {
            let [x, y] = [size, 0.2].map(|size| generator(&mut random, size));
            let series = Series::exponential(&x, &y);
            for s in [-1.0, -0.3, 0.0, 0.8, 1.0] {
                let at = Generator {
                    linear: x.linear + y.linear * s,
                    offset: x.offset + y.offset * s,
                };
                let pose = Flow::new(at).pose_at(1.0);
                assert_near(&series, s, &pose, &format!("size {size}"));
            }
        }
    }

    /// The rest is a bound of what is left out, not a multiple of it that says nothing.
    #[test]
    fn the_rest_is_small_in_short_windows() {
        let mut random = random(7);
        let [x, y] = [1.0, 0.05].map(|size| generator(&mut random, size));
        let series = Series::exponential(&x, &y);
        assert!(series.rest.linear < 1e-11, "{:e}", series.rest.linear);
    }

    #[test]
    fn products_apply_the_right_one_first() {
        let mut random = random(8);
        let [a, b] = [0.7, 0.4].map(|size| generator(&mut random, size));
        let identity = DAffine3::IDENTITY;
        let [first, then] = [&a, &b].map(|generator| Series::steady(generator, &identity, 0.3));
        let both = then.after(&first);
        for s in [-1.0, 0.2, 1.0] {
            let [first, then] = [&a, &b].map(|generator| Flow::new(*generator).pose_at(0.3 * s));
            assert_near(&both, s, &(then * first), "product");
        }
    }
}
