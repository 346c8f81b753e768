//! Finds when a path is within rounding of a convex region.
//!
//! Some paths pass the plane of a triangle so slowly, or so close to an edge, that rounding decides
//! whether they meet the triangle. For these, this module finds the times at which they are near
//! all of the triangle's half spaces *at once*. A bound on the distance that they cover during the
//! doubtful time would not do: next to a needle, that is many lengths of it.

use super::height::Height;
use crate::numeric::tolerance::ROOT_RESOLUTION;

/// A time counts as near the region if no half space is missed by more than this many slacks at
/// that time.
///
/// Every time at which none is missed by more than one slack must be found. The margin between the
/// two lets the search end: a piece on which no height changes by more than that margin is decided.
const NEAR: f64 = 2.0;

/// An intersection of `N` half spaces: a path is inside it where all its heights are positive.
#[derive(Debug)]
pub(super) struct HalfSpaces<const N: usize> {
    /// The heights over the planes that bound it, positive inward.
    pub(super) heights: [Height; N],
    /// Bound on the error of a height.
    pub(super) slack: f64,
}

impl<const N: usize> HalfSpaces<N> {
    /// Calls `found` for disjoint stretches of time in `window`, in ascending order.
    ///
    /// # Guarantee
    /// All times at which every height is at least -slack are in them, and at all times in them
    /// every height is at least -[`NEAR`] slack.
    ///
    /// # Cost
    /// Some log2(change of the heights during the window / slack) steps per end of a stretch.
    pub(super) fn touches(&self, window: [f64; 2], mut found: impl FnMut([f64; 2])) {
        let longest = window[0].abs().max(window[1].abs());
        let curvatures = self.heights.map(|height| height.curvature(longest));
        let mut last: Option<[f64; 2]> = None;
        // The earliest piece is on top.
        let mut open = vec![(window, window.map(|time| self.values(time)))];
        while let Some(([start, end], [at_start, at_end])) = open.pop() {
            let width = end - start;
            let (mut is_near, mut is_apart) = (true, false);
            for k in 0..N {
                let bulge = curvatures[k] * width * width / 8.0;
                is_near &= at_start[k].min(at_end[k]) - bulge >= -NEAR * self.slack;
                is_apart |= at_start[k].max(at_end[k]) + bulge < -self.slack;
            }
            if is_apart {
                continue;
            }
            // Only overflow leaves pieces shorter than that undecided.
            if is_near || width <= ROOT_RESOLUTION {
                match &mut last {
                    Some(last) if last[1] >= start => last[1] = end,
                    _ => last.replace([start, end]).into_iter().for_each(&mut found),
                }
                continue;
            }
            let middle = start + width / 2.0;
            let at_middle = self.values(middle);
            open.push(([middle, end], [at_middle, at_end]));
            open.push(([start, middle], [at_start, at_middle]));
        }
        last.into_iter().for_each(found);
    }

    fn values(&self, time: f64) -> [f64; N] {
        self.heights.map(|height| height.value(time))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::roots::MOST_TERMS;

    const SLACK: f64 = 1e-15;

    /// `of[0]` + `of[1]` t + `of[2]` t^2.
    fn height(of: [f64; 3]) -> Height {
        let mut coefficients = [0.0; MOST_TERMS];
        coefficients[..3].copy_from_slice(&of);
        Height(coefficients)
    }

    fn touches<const N: usize>(heights: [[f64; 3]; N]) -> Vec<[f64; 2]> {
        let heights = heights.map(height);
        let mut all = Vec::new();
        let slack = SLACK;
        HalfSpaces { heights, slack }.touches([-1.0, 1.0], |times| all.push(times));
        all
    }

    #[test]
    fn the_times_within_all_half_spaces_are_found_to_the_slack_and_not_short_of_it() {
        // t >= 0.2 and t^2 <= 0.36.
        let found = touches([[-0.2, 1.0, 0.0], [0.36, 0.0, -1.0]]);
        let [[first, last]] = found[..] else {
            panic!("one stretch, not {found:?}")
        };
        assert!(first <= 0.2 && first > 0.2 - 4.0 * SLACK, "{first}");
        assert!((0.6..0.6 + 4.0 * SLACK).contains(&last), "{last}");
    }

    #[test]
    fn two_planes_touched_at_different_times_are_no_touch() {
        // Each half space is reached, but never both: t >= 0.5, and t <= 0.5 - 1e-12.
        let found = touches([[-0.5, 1.0, 0.0], [0.5 - 1e-12, -1.0, 0.0]]);
        assert!(found.is_empty(), "{found:?}");
        // A height of 1e-13 t is always within 100 slacks, while the other plane is 0.3 away at
        // that end.
        let found = touches([[0.0, 1e-13, 0.0], [0.0, -1e-13, 0.0], [-0.3, 1.0, 0.0]]);
        assert!(found.is_empty(), "{found:?}");
    }

    #[test]
    fn a_path_that_leaves_and_comes_back_touches_twice() {
        // t^2 >= 0.25.
        let found = touches([[-0.25, 0.0, 1.0]]);
        let expected = [[-1.0, -0.5], [0.5, 1.0]];
        assert_eq!(found.len(), 2, "{found:?}");
        for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
            assert!((found - expected).abs() < 4.0 * SLACK, "{found}");
        }
    }

    #[test]
    fn a_path_within_the_slack_throughout_touches_throughout() {
        let found = touches([[0.0; 3], [SLACK / 2.0, 0.0, 0.0], [1.0, 0.3, 0.0]]);
        assert_eq!(found, [[-1.0, 1.0]], "all of the window");
    }
}
