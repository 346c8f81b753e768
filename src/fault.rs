//! A broken invariant of this library: an error of its own, never an answer.

/// An invariant of this library does not hold. No answer is given, since it could be wrong.
///
/// Every build checks the invariants on which a proven statement rests: that the sweep cycle is
/// closed, that winding numbers are consistent, that the boundary of the result is closed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "fault of the library: {broken}; please report it with the input (another tolerance may help meanwhile)"
)]
pub struct Fault {
    /// The invariant that does not hold.
    pub broken: &'static str,
}

impl Fault {
    pub(crate) const fn new(broken: &'static str) -> Fault {
        Fault { broken }
    }
}
