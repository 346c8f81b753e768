//! The swept region of a body, from the body and its motion: the whole way through the stages.

mod clock;
pub(crate) mod inspection;
pub(crate) mod planar;
mod reach;
mod refine;
pub(crate) mod spatial;

/// A stage of a sweep, in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stage {
    /// Grazing sets and the sampled sweep cycle.
    Cycle,
    /// Arrangement of the cycle and winding numbers.
    Arrangement,
    /// Pockets, rounding and measures.
    Boundary,
}

/// A length that bounds a difference, and what kind of statement that is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// In the body's unit.
    pub length: f64,
    /// Proven, or an estimate.
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
