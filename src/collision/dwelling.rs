//! All times during which a body is deeper in an obstacle than allowed, certified from beginning to end.
//!
//! Their beginnings are searched (`sinking`, `engulfed`): before them nothing is as deep, for certain. Then a point that is deeper is followed
//! until that ends (`following`), and another one is looked for there. Where none is found any more the search for a beginning goes on
//! from there: it certifies that nothing is as deep in between, or finds at once what was missed. So what is listed is deeper than
//! allowed and what is between is not, but for rounding; what is in doubt is listed.

use super::entering::Entry;
use super::intervals::Times;
use super::sinking::Sinking;
use super::window::Encounter;
use crate::numeric::tolerance::{JOINT_GAP, ROOT_RESOLUTION};

/// Most points that are followed, one after the other, in one stage with one obstacle; past them it is taken to be deep to the end.
const MOST_FOLLOWED: usize = 10_000;

impl Encounter<'_> {
    /// The times, local; what is in doubt is in them.
    pub(super) fn deep_times(&self, depth: f64) -> Times {
        let sinking = Sinking::new(self, depth);
        let mut times = Times::none(JOINT_GAP);
        let (mut from, mut skipped) = (0.0, ROOT_RESOLUTION);
        let mut left = MOST_FOLLOWED;
        while from < 1.0 {
            let (start, first) = match self.entry(true, from, depth) {
                None => return times,
                Some(Entry::Unknown(time)) => {
                    times.add([time, 1.0]);
                    return times;
                }
                Some(Entry::Sunk { bracket, deep }) => (bracket, sinking.surface_point(&deep)),
                Some(Entry::Held(point)) => ([from; 2], self.held_point(point, from)),
            };
            let mut end = self.follow(first, start[1]);
            while end < 1.0 && left > 0 {
                left -= 1;
                let next = sinking
                    .deep_points(end)
                    .into_iter()
                    .map(|point| self.follow(point, end));
                let next = next.fold(end, f64::max);
                if next <= end + ROOT_RESOLUTION {
                    break;
                }
                end = next;
            }
            if left == 0 {
                end = 1.0;
            }
            // Where rounding decides again and again, twice as much is passed over each time.
            skipped = if end > from + JOINT_GAP {
                ROOT_RESOLUTION
            } else {
                2.0 * skipped
            };
            times.add([start[0], end]);
            from = end + skipped;
        }
        times
    }
}
