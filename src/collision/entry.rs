//! The first entry of an obstacle, from a time on: the search for surfaces that sink in (`sunk`),
//! and the test for parts that the body contains from the start (`engulfed`).

use super::Limited;
use super::encounter::Encounter;
use super::engulfed::{self, Engulfed, MOST_CELLS};
use super::sinking::{Deep, Sinking};
use super::sunk::{self, Sunk};
use glam::DVec3;
use std::cell::OnceCell;

/// The first entry of an obstacle.
pub(super) enum Entry {
    /// A point sinks in, as found by a search.
    Sunk { bracket: [f64; 2], deep: Deep },
    /// It is entered from the start, at this point of the world.
    Held(DVec3),
    /// Not before this time; then work or precision ran out.
    Unknown(f64, Limited),
}

/// The first entry from a local time on.
///
/// - `anew`: whether nothing is known about earlier times.
/// - `spare`: work that may be done ([`sunk::allowance`]); the work done is subtracted.
/// - `thin`: whether the solid is thin ([`engulfed::is_thin`]), which is the same at all times;
///   computed on demand.
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
    // Near the middle of a part no thicker than twice the depth, little margin is left for proofs,
    // and none is needed.
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
