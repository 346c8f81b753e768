//! A broken invariant of this library: an error of its own name, never an answer.

/// An invariant of this library does not hold: no answer is given, since it could be wrong.
///
/// Checked in every build wherever a statement that is called proven rests on it: that the sweep cycle is closed, that
/// winding numbers fit together, that the boundary of the result is closed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "fault of the library: {broken}; please report it with the input (another tolerance may help meanwhile)"
)]
pub struct Fault {
    /// What does not hold.
    pub broken: &'static str,
}

impl Fault {
    pub(crate) const fn new(broken: &'static str) -> Fault {
        Fault { broken }
    }
}
