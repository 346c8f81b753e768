//! Signs of exact numbers.

use dashu_int::IBig;
use std::cmp::Ordering;

/// Sign of an exact number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Sign {
    Negative,
    Zero,
    Positive,
}

impl Sign {
    pub(super) fn of_float(x: f64) -> Sign {
        if x > 0.0 {
            Sign::Positive
        } else if x < 0.0 {
            Sign::Negative
        } else {
            Sign::Zero
        }
    }

    pub(super) fn of_integer(x: i128) -> Sign {
        match x.cmp(&0) {
            Ordering::Less => Sign::Negative,
            Ordering::Equal => Sign::Zero,
            Ordering::Greater => Sign::Positive,
        }
    }

    pub(super) fn of_long(x: &IBig) -> Sign {
        if x.is_zero() {
            Sign::Zero
        } else if x.sign() == dashu_int::Sign::Positive {
            Sign::Positive
        } else {
            Sign::Negative
        }
    }

    pub(super) fn flipped(self) -> Sign {
        match self {
            Sign::Negative => Sign::Positive,
            Sign::Zero => Sign::Zero,
            Sign::Positive => Sign::Negative,
        }
    }

    /// Flipped unless the condition holds.
    pub(super) fn flipped_unless(self, condition: bool) -> Sign {
        if condition { self } else { self.flipped() }
    }
}
