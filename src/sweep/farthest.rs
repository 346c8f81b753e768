//! How far some segments reach out of a region.

use crate::solid::planar::{Arrangement, Proximity};
use glam::DVec2;

/// A region of the plane that answers how far away it is.
pub(super) struct Region {
    proximity: Proximity,
}

impl Region {
    /// The region of an arrangement. O(n log n).
    pub(super) fn new(arrangement: &Arrangement) -> Region {
        Region {
            proximity: arrangement.proximity(),
        }
    }

    /// Distance of a point from the region, 0 in it.
    pub(super) fn distance(&self, point: DVec2) -> f64 {
        self.proximity.distance(point)
    }

    /// Bound on the distance of the points of a segment, at most `slack` above the largest one or `known`, whichever is larger.
    ///
    /// The distance grows by at most the way, so half of the length and of the two distances at the ends bound it; longer
    /// segments are halved.
    pub(super) fn farthest_of_segment(&self, ends: [DVec2; 2], known: f64, slack: f64) -> f64 {
        let mut bound = known;
        let mut open = vec![(ends, ends.map(|end| self.distance(end)))];
        while let Some(([from, to], distances)) = open.pop() {
            let length = from.distance(to);
            let reached = distances[0].max(distances[1]);
            let most = 0.5 * (distances[0] + distances[1] + length);
            if most <= bound || most <= reached + slack {
                bound = bound.max(most);
                continue;
            }
            let middle = from.midpoint(to);
            let distance = self.distance(middle);
            open.push(([from, middle], [distances[0], distance]));
            open.push(([middle, to], [distance, distances[1]]));
        }
        bound
    }
}
