//! The swept region of a body, from the body and its motion, through all stages.

mod clock;
pub(crate) mod inspection;
pub(crate) mod planar;
mod reach;
mod refine;
pub(crate) mod sources;
pub(crate) mod spatial;
pub(crate) mod surface;

use crate::motion::MotionError;
use crate::motion::chain::{Motion, Steady};
use glam::DVec3;

/// A stage of a sweep, in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stage {
    /// Computing the grazing sets and the sampled sweep cycle.
    Cycle,
    /// Arranging the cycle, and computing winding numbers.
    Arrangement,
    /// Filling pockets, rounding, simplifying, and measuring.
    Boundary,
}

/// A length that bounds a difference, and whether the bound is proven.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// The length in the body's unit.
    pub length: f64,
    /// Whether the bound is proven; otherwise it is an estimate. All bounds of sweeps are, unless the
    /// motion stands for one that is known only by an estimate.
    pub proven: bool,
}

/// How far the result and the exact sweep of the given body may differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorBound {
    /// How far the exact sweep may reach out of the result.
    pub inside: Bound,
    /// How far the result may reach out of the exact sweep.
    pub outside: Bound,
}

/// The bound that a sweep aims at. Finer sampling does not make up for a motion that deviates by
/// more than the tolerance: half of the tolerance is left to the sampling.
fn target(tolerance: f64, motion: &Bound) -> f64 {
    tolerance.max(motion.length + 0.5 * tolerance)
}

impl ErrorBound {
    /// Both bounds are only as good as the one on the motion.
    fn as_proven_as(&mut self, motion: &Bound) {
        self.inside.proven &= motion.proven;
        self.outside.proven &= motion.proven;
    }
}

/// How far a motion may be from the one that it stands for, over a body.
///
/// - `bounds`: corners of a box around the body, in its frame; in the plane with z = 0.
///
/// # Errors
/// [`MotionError::FollowedForAnother`].
fn deviation_of<F: Steady>(motion: &Motion<F>, bounds: [DVec3; 2]) -> Result<Bound, MotionError> {
    let deviation = motion.deviation_over(bounds)?;
    Ok(Bound {
        length: deviation.map_or(0.0, |deviation| deviation.length),
        proven: deviation.is_none_or(|deviation| deviation.proven),
    })
}
