//! How far some segments reach out of a region.

use super::{Arrangement, Proximity};
use glam::DVec2;

/// A region of the plane, for queries of the distance from it.
pub(crate) struct NearRegion {
    proximity: Proximity,
}

impl NearRegion {
    /// The region of an arrangement. O(n log n).
    pub(crate) fn new(arrangement: &Arrangement) -> NearRegion {
        NearRegion {
            proximity: arrangement.proximity(),
        }
    }

    /// The distance of a point from the region, 0 inside it.
    pub(crate) fn distance(&self, point: DVec2) -> f64 {
        self.proximity.distance(point)
    }

    /// A bound on the distance of the points of a segment, at most `slack` above the largest
    /// distance or `known`, whichever is larger.
    ///
    /// The distance changes by at most the distance travelled, so half of the sum of the length and
    /// the distances at the ends bounds it; longer segments are halved.
    pub(crate) fn farthest_of_segment(&self, ends: [DVec2; 2], known: f64, slack: f64) -> f64 {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::planar::{Segment, arrange};

    /// The unit square.
    fn square() -> NearRegion {
        let points = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        let segments: Vec<Segment> = (0..4)
            .map(|i| Segment {
                ends: [i, (i + 1) % 4],
                weight: 1,
            })
            .collect();
        NearRegion::new(&arrange(&points, &segments).expect("a square is closed"))
    }

    #[test]
    fn the_farthest_point_of_a_segment_is_bounded_closely() {
        let region = square();
        // Over the corner, farthest at an end; across the square; and an arch whose ends are near
        // but whose middle is far.
        for (ends, farthest) in [
            ([[1.5, 0.5], [1.5, 0.9]], 0.5),
            ([[-0.25, 0.5], [1.125, 0.5]], 0.25),
            ([[2.0, 0.0], [0.0, 2.0]], 1.0),
            ([[0.25, 0.5], [0.75, 0.5]], 0.0),
        ] {
            let ends = ends.map(DVec2::from_array);
            let bound = region.farthest_of_segment(ends, 0.0, 1e-3);
            assert!(
                bound >= farthest && bound <= farthest + 1.1e-3,
                "{ends:?}: {bound} for {farthest}"
            );
        }
        let known = region.farthest_of_segment([DVec2::new(1.5, 0.5); 2], 0.7, 1e-3);
        assert_eq!(known, 0.7, "what is known already stays");
    }
}
