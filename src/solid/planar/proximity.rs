//! The distance of points from a region.

use crate::bounds::SurfaceTree;
use crate::numeric::exact::signs::{Side, side_of_line};
use crate::numeric::index;
use glam::DVec2;

/// The boundary of a region, prepared for distances of points.
#[derive(Debug, Clone)]
pub struct Proximity {
    /// A tree over the boundary edges.
    tree: SurfaceTree,
    /// The same edges, with the region on their left.
    edges: Vec<[DVec2; 2]>,
}

impl Proximity {
    /// - `edges`: the boundary of a region, which is on their left.
    pub(super) fn new(edges: Vec<[DVec2; 2]>) -> Proximity {
        let positions: Vec<DVec2> = edges.iter().flatten().copied().collect();
        let segments: Vec<[u32; 2]> = (0..index(edges.len()))
            .map(|edge| [2 * edge, 2 * edge + 1])
            .collect();
        Proximity {
            tree: SurfaceTree::of_segments(&positions, &segments),
            edges,
        }
    }

    /// Whether a point lies in the region. On the boundary, either answer is possible.
    ///
    /// # Cost
    /// O(log n), plus the number of edges right above the point.
    pub fn contains(&self, point: DVec2) -> bool {
        let mut winding = 0;
        self.tree
            .for_each_along_axis(point.extend(0.0), 1, 1, |edge| {
                let [a, b] = self.edges[edge as usize];
                // An edge counts from its left end up to, but not including, its right one.
                if a.x <= point.x && point.x < b.x {
                    winding -= i32::from(side_of_line(a, b, point) == Side::Below);
                } else if b.x <= point.x && point.x < a.x {
                    winding += i32::from(side_of_line(a, b, point) == Side::Above);
                }
            });
        winding > 0
    }

    /// The distance of a point from the region: 0 inside it, infinite from an empty one.
    pub fn distance(&self, point: DVec2) -> f64 {
        if self.contains(point) {
            0.0
        } else {
            self.tree.distance_to_surface(point.extend(0.0))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_taken_from_outside() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(DVec2::from_array);
        let edges = (0..4).map(|i| [corners[i], corners[(i + 1) % 4]]).collect();
        let square = Proximity::new(edges);
        for (point, expected) in [
            ([0.5, 0.5], 0.0),
            ([2.0, 0.5], 1.0),
            // 3 to the left and 4 below the nearest corner.
            ([-3.0, -4.0], 5.0),
        ] {
            let found = square.distance(DVec2::from_array(point));
            assert!((found - expected).abs() < 1e-6, "{found} at {point:?}");
        }
        // Above one corner and below another, where two edges end.
        assert!(!square.contains(DVec2::new(0.0, 2.0)) && !square.contains(DVec2::new(1.0, -1.0)));
    }

    #[test]
    fn an_empty_region_is_infinitely_far() {
        let nothing = Proximity::new(Vec::new());
        assert_eq!(nothing.distance(DVec2::ZERO), f64::INFINITY);
    }
}
