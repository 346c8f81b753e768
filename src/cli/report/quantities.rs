//! Counts and vectors for reading.

use crate::numeric::Readable;
use std::fmt;

/// "1 edge", "2 edges", "1234567 vertices".
pub(super) fn counted(count: usize, noun: &str) -> String {
    match (count, noun) {
        (1, _) => format!("1 {noun}"),
        (_, "vertex") => format!("{count} vertices"),
        _ => format!("{count} {noun}s"),
    }
}

/// A vector for reading: `(x, y, z)` or `(x, y)`.
pub(super) struct Vector<const N: usize>(pub(super) [f64; N]);

impl<const N: usize> fmt::Display for Vector<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let numbers = without_noise(self.0).map(|number| Readable(number).to_string());
        write!(f, "({})", numbers.join(", "))
    }
}

/// Entries of a vector or matrix for reading: those that are rounding noise compared with the
/// largest one become 0.
pub(super) fn without_noise<const N: usize>(entries: [f64; N]) -> [f64; N] {
    /// Some hundred roundings, as in the logarithm of a pose; far below the seven digits that are
    /// shown.
    const NOISE: f64 = 1e-13;
    let largest = entries
        .iter()
        .fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
    entries.map(|entry| {
        if entry.abs() <= NOISE * largest {
            0.0
        } else {
            entry
        }
    })
}
