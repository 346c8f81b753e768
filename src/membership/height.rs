//! The height of a path over a plane during a window: a polynomial in the time from its middle.

use super::path::Stretch;
use crate::numeric::roots::{MOST_TERMS, Searched, Zero};
use glam::DVec3;

/// The coefficients of t^0, t^1, ...
#[derive(Debug, Clone, Copy)]
pub(super) struct Height(pub(super) [f64; MOST_TERMS]);

impl Height {
    /// The height over the plane through `anchor` with unit normal `normal`.
    pub(super) fn new(stretch: &Stretch, normal: DVec3, anchor: DVec3) -> Height {
        Height(stretch.height(normal, anchor))
    }

    /// The height below the plane instead of above it.
    pub(super) fn negative(&self) -> Height {
        Height(self.0.map(|coefficient| -coefficient))
    }

    pub(super) fn value(&self, time: f64) -> f64 {
        self.0
            .iter()
            .rev()
            .fold(0.0, |value, coefficient| value * time + coefficient)
    }

    /// Upper bound of the second derivative at all times up to `longest` from the middle.
    pub(super) fn curvature(&self, longest: f64) -> f64 {
        let terms = self.0.iter().enumerate().skip(2).rev();
        terms.fold(0.0, |sum, (j, c)| {
            sum * longest + c.abs() * (j * (j - 1)) as f64
        })
    }

    /// The times at which it is zero or, within the slack, may be; see [`Searched::zeros`].
    pub(super) fn zeros(&self, window: [f64; 2], slack: f64, found: impl FnMut(Zero)) {
        let function = |time: f64| {
            self.0.iter().rev().fold([0.0, 0.0], |[value, slope], c| {
                [value * time + c, slope * time + value]
            })
        };
        let longest = window[1].abs().max(window[0].abs());
        Searched {
            function,
            curvature: self.curvature(longest),
            slack,
        }
        .zeros(window, found);
    }
}
