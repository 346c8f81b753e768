//! All times during which a body is deeper in an obstacle than allowed, certified from start to
//! end.
//!
//! The search for their starts (`sunk`, `engulfed`) certifies that nothing is as deep before. Then
//! a point that is deeper is followed until that ends (`following`), and another one is sought at
//! that time. Where none is found, the search for a start continues from there: it certifies that
//! nothing is as deep in between, or immediately finds what was missed. So during the listed times
//! something is deeper than allowed, and between them nothing is, up to rounding.
//!
//! Where a search reaches a time at which work or precision runs out, a short time is skipped, and
//! a longer one if this happens again, until the search makes progress. The skipped time is listed,
//! and reported as a doubt.

use super::Limited;
use super::encounter::Encounter;
use super::entry::{self, Entry};
use super::following::{self, Follower};
use super::sinking::Sinking;
use super::sunk;
use super::times::Times;
use crate::numeric::tolerance::{JOINT_GAP, ROOT_RESOLUTION};
use std::cell::OnceCell;

/// Most points that are followed, one after the other, in one stage with one obstacle; after that,
/// the rest is in doubt.
const MOST_FOLLOWED: usize = 10_000;

/// Most times at which a search may run out of work or precision, in one stage with one obstacle;
/// after that, the rest is in doubt.
const MOST_STOPS: usize = 64;

/// Time that is skipped where a search stops, and the factor by which it grows where the search
/// stops again at once.
const PASSED: f64 = JOINT_GAP;
const LONGER: f64 = 16.0;

/// The times at which something is deeper than allowed, in local time.
pub(super) struct Dwelling {
    /// The times, including those in doubt.
    pub(super) times: Times,
    /// The parts of the times that are in doubt, ascending, and the reasons.
    pub(super) doubts: Vec<([f64; 2], Limited)>,
}

impl Dwelling {
    fn doubt(&mut self, times: [f64; 2], limited: Limited) {
        self.times.add(times);
        match self.doubts.last_mut() {
            Some((last, why)) if times[0] <= last[1] && *why == limited => last[1] = times[1],
            _ => self.doubts.push((times, limited)),
        }
    }
}

/// All times at which something is deeper than `depth`.
///
/// - `thin`: as in [`entry::first`].
pub(super) fn of(encounter: &Encounter, depth: f64, thin: &OnceCell<bool>) -> Dwelling {
    let sinking = Sinking::new(encounter, depth);
    let mut found = Dwelling {
        times: Times::none(JOINT_GAP),
        doubts: Vec::new(),
    };
    let (mut from, mut skipped) = (0.0, ROOT_RESOLUTION);
    let (mut stops, mut passed) = (0, PASSED);
    let mut left = MOST_FOLLOWED;
    let mut spare = sunk::allowance(&sinking);
    while from < 1.0 && encounter.work.check().is_ok() {
        let (start, first) = match entry::first(encounter, true, from, depth, &mut spare, thin) {
            None => break,
            Some(Entry::Unknown(time, limited)) => {
                stops += 1;
                if stops > MOST_STOPS || spare == 0 {
                    found.doubt([time, 1.0], Limited::Work);
                    break;
                }
                passed = if time > from + passed {
                    PASSED
                } else {
                    LONGER * passed
                };
                from = (time + passed).min(1.0);
                found.doubt([time, from], limited);
                continue;
            }
            Some(Entry::Sunk { bracket, deep }) => (bracket, Follower::on_surface(&sinking, &deep)),
            Some(Entry::Held(point)) => ([from; 2], Follower::resting(encounter, point, from)),
        };
        let mut end = following::until(encounter, first, start[1]);
        while end < 1.0 && left > 0 && encounter.work.check().is_ok() {
            left -= 1;
            let next = following::deep_points(&sinking, end)
                .into_iter()
                .map(|point| following::until(encounter, point, end));
            let next = next.fold(end, f64::max);
            if next <= end + ROOT_RESOLUTION {
                break;
            }
            end = next;
        }
        if start[1] > start[0] + JOINT_GAP {
            found.doubt(start, Limited::Work);
        }
        found.times.add([start[0], end]);
        if left == 0 {
            found.doubt([end, 1.0], Limited::Work);
            break;
        }
        // Where rounding decides again and again, twice as much is skipped each time.
        skipped = if end > from + JOINT_GAP {
            ROOT_RESOLUTION
        } else {
            2.0 * skipped
        };
        from = end + skipped;
        if skipped > JOINT_GAP {
            found.doubt([end, from.min(1.0)], Limited::Rounding);
        }
    }
    found
}
