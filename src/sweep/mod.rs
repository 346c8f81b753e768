//! The swept region of a body, from the body and its motion, through all stages.

mod clock;
pub(crate) mod inspection;
pub(crate) mod planar;
mod reach;
mod refine;
pub(crate) mod sources;
pub(crate) mod spatial;

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
    /// Whether the bound is proven, as all bounds of sweeps are; otherwise it is an estimate.
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
