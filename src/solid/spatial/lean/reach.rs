//! How far the points that have come to a triangle are from where they started.

use glam::DVec3;

/// A box of displacements that contains zero: corners of a triangle have not moved.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Reach {
    low: DVec3,
    high: DVec3,
}

impl Reach {
    /// The displacements of both.
    pub(super) fn or(self, other: Reach) -> Reach {
        Reach {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// The displacements after the points have moved on, each by some part of `by`, which is off
    /// by up to `rounding`.
    pub(super) fn moved(self, by: DVec3, rounding: f64) -> Reach {
        Reach {
            low: self.low + by.min(DVec3::ZERO) - rounding,
            high: self.high + by.max(DVec3::ZERO) + rounding,
        }
    }

    /// The largest distance.
    pub(super) fn distance(&self) -> f64 {
        self.high.max(-self.low).length()
    }
}
