//! How an obstacle is entered first, from a time on: what sinks in is searched (`sinking`), and what is held from the start (`engulfed`).

use super::Limited;
use super::encounter::Encounter;
use super::engulfed::{self, Engulfed, MOST_CELLS};
use super::sinking::{Deep, Sinking};
use super::sunk::{self, Sunk};
use glam::DVec3;
use std::cell::OnceCell;

/// How an obstacle is entered first.
pub(super) enum Entry {
    /// Deep in the sense of a search.
    Sunk { bracket: [f64; 2], deep: Deep },
    /// From the beginning, at this point of the world.
    Held(DVec3),
    /// Not before this time; then work or precision ran out.
    Unknown(f64, Limited),
}

/// The first entry from a local time on.
///
/// - `anew`: whether nothing is known about the time before.
/// - `spare`: work that may be done ([`sunk::allowance`]); what was done is taken off.
/// - `thin`: whether the solid is thin ([`engulfed::is_thin`]), the same at all times; found out when it is first asked for.
pub(super) fn first(
    encounter: &Encounter,
    anew: bool,
    from: f64,
    depth: f64,
    spare: &mut usize,
    thin: &OnceCell<bool>,
) -> Option<Entry> {
    let sinking = Sinking::new(encounter, depth);
    let sunk = sunk::first(&sinking, from, spare);
    // Near the middle of what is as thin as twice the depth little room is left for proofs, and none is needed.
    let is_thin = || *thin.get_or_init(|| engulfed::is_thin(encounter, 1 - sinking.surface, depth));
    if matches!(sunk, Sunk::Unknown(..)) && is_thin() {
        return None;
    }
    if let Sunk::First { bracket, deep } = sunk
        && bracket[1] <= from
    {
        return Some(Entry::Sunk { bracket, deep });
    }
    if anew && encounter.shapes[1].closed() {
        match engulfed::at(encounter, from, depth, MOST_CELLS) {
            Engulfed::Nothing => {}
            Engulfed::Point(point) => return Some(Entry::Held(point)),
            Engulfed::Unknown => return Some(Entry::Unknown(from, Limited::Work)),
        }
    }
    match sunk {
        Sunk::Never => None,
        Sunk::First { bracket, deep } => Some(Entry::Sunk { bracket, deep }),
        Sunk::Unknown(time, limited) => Some(Entry::Unknown(time, limited)),
    }
}
