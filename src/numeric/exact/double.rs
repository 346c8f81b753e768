//! Numbers with twice the precision of `f64`, as an unevaluated sum of two.
//!
//! The error of a sum or product is less than 2^-100 of the sum of the magnitudes that go in.

use std::ops::{Add, Mul, Sub};

/// `high + low`, where `low` is below half a unit of `high`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Double {
    pub(crate) high: f64,
    pub(crate) low: f64,
}

/// Relative error of one operation, rounded up.
pub(crate) const DOUBLE_ROUNDOFF: f64 = 7.9e-31;

fn two_sum(a: f64, b: f64) -> Double {
    let high = a + b;
    let back = high - a;
    Double {
        high,
        low: (a - (high - back)) + (b - back),
    }
}

/// The sum when `a` is not smaller than `b`.
fn fast_two_sum(a: f64, b: f64) -> Double {
    let high = a + b;
    Double {
        high,
        low: b - (high - a),
    }
}

fn split(a: f64) -> (f64, f64) {
    // Multiplying by 2^27 + 1 splits 53 bits into halves.
    let c = 134_217_729.0 * a;
    let high = c - (c - a);
    (high, a - high)
}

impl Double {
    pub(crate) fn product(a: f64, b: f64) -> Double {
        let high = a * b;
        let ((a1, a2), (b1, b2)) = (split(a), split(b));
        Double {
            high,
            low: ((a1 * b1 - high) + a1 * b2 + a2 * b1) + a2 * b2,
        }
    }

    /// The number nearest to an integer.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "what the first conversion loses is the second part"
    )]
    pub(crate) fn from_integer(x: i128) -> Double {
        let high = x as f64;
        Double {
            high,
            low: (x - high as i128) as f64,
        }
    }

    pub(crate) fn value(self) -> f64 {
        self.high
    }

    /// The quotient, with an error of a few units in the last place of the second part.
    pub(crate) fn over(self, divisor: Double) -> Double {
        let first = self.high / divisor.high;
        let rest = self - divisor * Double::from(first);
        let second = rest.high / divisor.high;
        let rest = rest - divisor * Double::from(second);
        let sum = fast_two_sum(first, second);
        sum + Double::from(rest.high / divisor.high)
    }
}

impl From<f64> for Double {
    fn from(high: f64) -> Double {
        Double { high, low: 0.0 }
    }
}

impl Add for Double {
    type Output = Double;
    fn add(self, other: Double) -> Double {
        let high = two_sum(self.high, other.high);
        let low = two_sum(self.low, other.low);
        let sum = fast_two_sum(high.high, high.low + low.high);
        fast_two_sum(sum.high, sum.low + low.low)
    }
}

impl Sub for Double {
    type Output = Double;
    fn sub(self, other: Double) -> Double {
        self + Double {
            high: -other.high,
            low: -other.low,
        }
    }
}

impl Mul for Double {
    type Output = Double;
    fn mul(self, other: Double) -> Double {
        let product = Double::product(self.high, other.high);
        fast_two_sum(
            product.high,
            product.low + (self.high * other.low + self.low * other.high),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_of_integers_beyond_single_precision_are_exact() {
        let (a, b) = (4_503_599_627_370_495_i128, 4_503_599_627_370_301_i128);
        let product = Double::from_integer(a) * Double::from_integer(b);
        assert_eq!(product, Double::from_integer(a * b), "103 bits");
    }

    #[test]
    fn a_quotient_times_its_divisor_is_the_dividend() {
        let (a, b) = (Double::from_integer(10_i128.pow(30) + 7), Double::from(3.7));
        let rest = a.over(b) * b - a;
        assert!(
            rest.value().abs() < 1e30 * 8.0 * DOUBLE_ROUNDOFF,
            "{rest:?}"
        );
    }
}
