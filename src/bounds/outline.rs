//! A tree of boxes over the edges of closed outlines in the plane, and the exact winding number.

use super::tree::SurfaceTree;
use crate::numeric::exact::signs::{Side, side_of_line};
use glam::{DVec2, Vec3Swizzles};

/// Directed edges in the plane under a tree of boxes, for queries by segment and by point.
///
/// Holds its own copy of the edges: a [`SurfaceTree`] of segments.
#[derive(Debug, Clone)]
pub(crate) struct OutlineTree {
    tree: SurfaceTree,
}

impl OutlineTree {
    /// - `positions`: #V finite points.
    /// - `edges`: #E pairs of indices into `positions`, all in range: start, end.
    ///
    /// # Cost
    /// O(#E log #E), on one thread: about a microsecond per edge.
    pub(crate) fn new(positions: &[DVec2], edges: &[[u32; 2]]) -> OutlineTree {
        OutlineTree {
            tree: SurfaceTree::of_segments(positions, edges),
        }
    }

    /// The two ends of an edge.
    pub(crate) fn ends(&self, edge: u32) -> [DVec2; 2] {
        let [from, to, _] = self.tree.corners(edge);
        [from.xy(), to.xy()]
    }

    /// Every edge whose box comes within `radius` of the segment from `start` to `end`, and perhaps
    /// a few others.
    pub(crate) fn for_each_near_segment(
        &self,
        start: DVec2,
        end: DVec2,
        radius: f64,
        visit: impl FnMut(u32),
    ) {
        self.tree
            .for_each_near_segment(start.extend(0.0), end.extend(0.0), radius, visit);
    }

    /// Distance of a point from the nearest edge.
    pub(crate) fn distance(&self, point: DVec2) -> f64 {
        self.tree.distance_to_surface(point.extend(0.0))
    }

    /// How many times the closed outlines wind around `point` counter-clockwise, or `None` on an
    /// edge. Exact.
    pub(crate) fn winding_number(&self, point: DVec2) -> Option<i32> {
        let [min, max] = self.tree.bounds()?.map(|corner| corner.xy());
        if point.cmplt(min).any() || point.cmpgt(max).any() {
            return Some(0);
        }
        // Any half line would do; the one that leaves the box first meets the fewest edges.
        let [to_min, to_max] = [point - min, max - point];
        let forward = if to_max.min_element() <= to_min.min_element() {
            1
        } else {
            -1
        };
        let ways = if forward > 0 { to_max } else { to_min };
        let axis = usize::from(ways.y < ways.x);
        // Turned so that the half line runs along x. This is exact.
        let turned = |p: DVec2| match (axis, forward) {
            (0, 1) => p,
            (0, _) => -p,
            (_, 1) => -p.perp(),
            _ => p.perp(),
        };
        let target = turned(point);
        let mut winding = 0;
        let mut on_edge = false;
        self.tree
            .for_each_along_axis(point.extend(0.0), axis, forward, |edge| {
                let [from, to] = self.ends(edge).map(turned);
                match passage(from, to, target) {
                    Some(change) => winding += change,
                    None => on_edge = true,
                }
            });
        (!on_edge).then_some(winding)
    }
}

/// 1 where an edge crosses the half line from `point` along x upwards, -1 where downwards, 0 where
/// it does not; `None` for a point on the edge. The lower end belongs to an edge, the upper one
/// does not.
fn passage(from: DVec2, to: DVec2, point: DVec2) -> Option<i32> {
    let side = side_of_line(from, to, point);
    let in_box = point.cmpge(from.min(to)).all() && point.cmple(from.max(to)).all();
    if side == Side::On && in_box {
        return None;
    }
    let upward = from.y <= point.y && point.y < to.y;
    let downward = to.y <= point.y && point.y < from.y;
    Some(match side {
        Side::Above if upward => 1,
        Side::Below if downward => -1,
        _ => 0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::random;

    /// A square with a hole that touches its outline from within, on a coarse grid: every query on
    /// it meets a degenerate case.
    fn tree() -> OutlineTree {
        let positions = [
            (0, 0),
            (4, 0),
            (4, 4),
            (0, 4), // counter-clockwise
            (4, 2),
            (2, 1),
            (1, 2),
            (2, 3), // clockwise
        ]
        .map(|(x, y)| DVec2::new(f64::from(x), f64::from(y)));
        let edges = [
            [0, 1],
            [1, 2],
            [2, 3],
            [3, 0],
            [4, 5],
            [5, 6],
            [6, 7],
            [7, 4],
        ];
        OutlineTree::new(&positions, &edges)
    }

    #[test]
    fn points_on_edges_and_corners_are_on_the_outline() {
        let on = [
            (0.0, 0.0),
            (4.0, 2.0),
            (3.0, 1.5),
            (1.5, 1.5),
            (0.0, 3.0),
            (1.0, 2.0),
        ];
        for (x, y) in on {
            let point = DVec2::new(x, y);
            assert_eq!(tree().winding_number(point), None, "{point}");
        }
    }

    #[test]
    fn points_beside_corners_are_counted_once() {
        let cases = [
            ((0.5, 2.0), 1),
            ((1.5, 2.0), 0),
            ((3.0, 1.0), 1),
            ((3.0, 2.0), 0),
            ((3.0, 3.0), 1),
            ((2.0, 0.5), 1),
            ((5.0, 2.0), 0),
            ((4.0, 4.0_f64.next_up()), 0),
            ((4.0_f64.next_up(), 2.0), 0),
        ];
        for ((x, y), expected) in cases {
            let point = DVec2::new(x, y);
            assert_eq!(tree().winding_number(point), Some(expected), "{point}");
        }
    }

    #[test]
    fn the_winding_number_is_that_of_the_angles() {
        let mut next = random(3);
        for case in 0..200 {
            // A closed polygon that crosses itself.
            let corners: Vec<DVec2> = (0..9).map(|_| DVec2::new(next(), next())).collect();
            let edges: Vec<[u32; 2]> = (0..9).map(|i| [i, (i + 1) % 9]).collect();
            let tree = OutlineTree::new(&corners, &edges);
            for _ in 0..20 {
                let point = DVec2::new(next(), next());
                let angles = edges.iter().map(|edge| {
                    let [from, to] = edge.map(|corner| corners[corner as usize] - point);
                    from.perp_dot(to).atan2(from.dot(to))
                });
                let turns = angles.sum::<f64>() / std::f64::consts::TAU;
                assert_eq!(
                    tree.winding_number(point).map(f64::from),
                    Some(turns.round()),
                    "case {case}: {point}"
                );
            }
        }
    }

    #[test]
    fn every_edge_near_a_segment_is_visited_and_few_others() {
        let mut next = random(4);
        for (unit, away) in [(1.0, 0.0), (1e-6, 1e3), (1e15, 0.0)] {
            // A spiral whose pieces slowly grow in length.
            let corner = |i: u32| {
                let angle = 0.01 * f64::from(i);
                DVec2::from_angle(angle) * (unit * (0.05 * angle).exp()) + DVec2::splat(away * unit)
            };
            let corners: Vec<DVec2> = (0..2001).map(corner).collect();
            let edges: Vec<[u32; 2]> = (0..2000).map(|i| [i, i + 1]).collect();
            let tree = OutlineTree::new(&corners, &edges);
            let mut visits = 0;
            for _ in 0..100 {
                let place = |x: f64, y: f64| DVec2::new(x, y) * (2.0 * unit) + away * unit;
                let start = place(next(), next());
                let end = start + DVec2::new(next(), next()) * (0.1 * unit);
                let radius = 0.01 * unit;
                let mut visited = vec![false; edges.len()];
                tree.for_each_near_segment(start, end, radius, |edge| {
                    visited[edge as usize] = true;
                    visits += 1;
                });
                for (edge, ends) in (0_u32..).zip(&edges) {
                    let ends = ends.map(|corner| corners[corner as usize]);
                    let is_near = (0..=20).any(|k| {
                        let p = start.lerp(end, f64::from(k) / 20.0);
                        ends.iter().any(|corner| corner.distance(p) <= radius)
                    });
                    assert!(
                        !is_near || visited[edge as usize],
                        "edge {edge}, unit {unit:e}"
                    );
                }
            }
            assert!(visits < 20_000, "{visits} of 200,000");
        }
    }
}
