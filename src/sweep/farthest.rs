//! How far some segments or triangles reach out of a region.

use crate::bounds::SurfaceTree;
use crate::solid::planar::Arrangement;
use glam::{DVec2, DVec3};

/// A region of the plane that answers how far away it is.
pub(super) struct Region {
    tree: SurfaceTree,
}

impl Region {
    /// The region of an arrangement. O(n log n).
    pub(super) fn new(arrangement: &Arrangement) -> Region {
        let positions: Vec<DVec3> = arrangement
            .positions()
            .iter()
            .map(|p| p.extend(0.0))
            .collect();
        let triangles = arrangement.triangles().iter().zip(arrangement.is_inside());
        let inside: Vec<[u32; 3]> = triangles
            .filter_map(|(&triangle, &is_inside)| is_inside.then_some(triangle))
            .collect();
        Region {
            tree: SurfaceTree::new(&positions, &inside),
        }
    }

    /// Distance of a point from the region, 0 in it.
    pub(super) fn distance(&self, point: DVec2) -> f64 {
        self.tree.distance_to_surface(point.extend(0.0))
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

    /// The same of the points of a triangle.
    ///
    /// A point is no farther from the nearest corner than the longest side over the square root of 3, and from the middle of
    /// that side than the longest median.
    pub(super) fn farthest_of_triangle(&self, corners: [DVec2; 3], known: f64, slack: f64) -> f64 {
        let mut bound = known;
        let mut open = vec![corners];
        while let Some(corners) = open.pop() {
            let sides = [0, 1, 2].map(|i| corners[i].distance(corners[(i + 1) % 3]));
            let longest = (0..3)
                .max_by(|&i, &k| sides[i].total_cmp(&sides[k]))
                .unwrap_or_default();
            let [a, b, c] = [0, 1, 2].map(|i| corners[(longest + i) % 3]);
            let reached = corners
                .iter()
                .map(|&corner| self.distance(corner))
                .fold(0.0, f64::max);
            let most = reached + sides[longest] / 3.0_f64.sqrt();
            if most <= bound || most <= reached + slack {
                bound = bound.max(most);
                continue;
            }
            let middle = a.midpoint(b);
            open.push([a, middle, c]);
            open.push([middle, b, c]);
        }
        bound
    }
}
