//! Two shapes at one instant: their distance, and whether they pass through each other.

use super::nearest::{Nearest, nearest};
use super::shape::{Shape, ShapeNode};
use crate::numeric::area::area_vector;
use crate::watch::Work;
use glam::{DAffine3, DVec3};

/// Two shapes in their poses.
pub(super) struct Still<'a> {
    pub(super) shapes: [&'a Shape; 2],
    pub(super) poses: [DAffine3; 2],
    /// The work that this is a part of: when it is stopped, searches end with what they have.
    pub(super) work: Work<'a>,
}

/// The nearest triangles of two shapes.
#[derive(Debug, Clone, Copy)]
pub(super) struct ClosestTriangles {
    pub(super) nearest: Nearest,
    pub(super) triangles: [u32; 2],
}

/// Relative rounding of the boxes of nodes in a pose: some 10 u, with a margin.
const BOX_ROUNDING: f64 = 1e-14;

/// Most pairs of triangles with meeting boxes that are examined for an overlap: surfaces that lie
/// on each other have very many pairs without overlap, and those that overlap have one that is soon
/// found.
const MOST_TOUCHING: usize = 20_000;

impl Still<'_> {
    fn corners(&self, which: usize, triangle: u32) -> [DVec3; 3] {
        self.shapes[which]
            .corners(triangle)
            .map(|corner| self.poses[which].transform_point3(corner))
    }

    /// A lower bound of the distance of the contents of two nodes.
    fn gap(&self, nodes: [u32; 2]) -> f64 {
        let placed = |which: usize| {
            let node: &ShapeNode = &self.shapes[which].nodes[nodes[which] as usize];
            let DAffine3 {
                matrix3,
                translation,
            } = self.poses[which];
            let turned = matrix3 * self.shapes[which].frame;
            (turned * node.centre + translation, turned.abs() * node.half)
        };
        let ((a, reach_a), (b, reach_b)) = (placed(0), placed(1));
        let rounding = BOX_ROUNDING * (a.abs() + b.abs()).max_element();
        let apart = (a - b).abs() - (reach_a + reach_b) - DVec3::splat(rounding);
        apart.max(DVec3::ZERO).length()
    }

    /// Calls `visit` for pairs of triangles, near ones first, that may be nearer than the limit
    /// that it last returned; the first limit is `limit`.
    fn for_each_nearer(&self, limit: f64, mut visit: impl FnMut([u32; 2], f64) -> f64) {
        let mut limit = limit;
        let mut open = vec![([0, 0], self.gap([0, 0]))];
        while let Some((nodes, gap)) = open.pop() {
            if self.work.check().is_err() {
                return;
            }
            if gap > limit {
                continue;
            }
            let [a, b] = [0, 1].map(|which: usize| self.shapes[which].nodes[nodes[which] as usize]);
            if a.is_leaf() && b.is_leaf() {
                limit = visit([a.triangle, b.triangle], limit);
                continue;
            }
            let size = |node: &ShapeNode| node.half.max_element();
            let divided = usize::from(a.is_leaf() || (!b.is_leaf() && size(&b) > size(&a)));
            let first = [a, b][divided].children;
            let mut pair = [first, first + 1].map(|child| {
                let mut nodes = nodes;
                nodes[divided] = child;
                (nodes, self.gap(nodes))
            });
            // * The nearer one comes on top of the stack.
            if pair[0].1 < pair[1].1 {
                pair.swap(0, 1);
            }
            open.extend(pair.into_iter().filter(|(_, gap)| *gap <= limit));
        }
    }

    /// The nearest triangles, if they are nearer than `limit`; their distance is 0 where surfaces
    /// meet.
    pub(super) fn closest(&self, limit: f64) -> Option<ClosestTriangles> {
        let mut best: Option<ClosestTriangles> = None;
        self.for_each_nearer(limit, |triangles, limit| {
            let near = nearest(
                &self.corners(0, triangles[0]),
                &self.corners(1, triangles[1]),
            );
            if near.distance() >= limit {
                return limit;
            }
            best = Some(ClosestTriangles {
                nearest: near,
                triangles,
            });
            // No distance is below 0: a negative limit ends the search.
            if near.distance_squared == 0.0 {
                -1.0
            } else {
                near.distance()
            }
        });
        best
    }

    /// Whether some side of a triangle passes through another triangle with a margin of more than
    /// `margin` on all sides, or one shape contains a part of the other.
    pub(super) fn overlap(&self, margin: f64) -> bool {
        let (mut through, mut looked) = (false, 0);
        self.for_each_nearer(0.0, |triangles, limit| {
            looked += 1;
            if looked > MOST_TOUCHING {
                return -1.0;
            }
            let corners = [0, 1].map(|which: usize| self.corners(which, triangles[which]));
            through |=
                pierces(corners[0], corners[1], margin) || pierces(corners[1], corners[0], margin);
            if through { -1.0 } else { limit }
        });
        through || self.contained().is_some()
    }

    /// The number of the shape of which the other contains a part, and a vertex of that part.
    pub(super) fn contained(&self) -> Option<(usize, u32)> {
        [0, 1].into_iter().find_map(|inner| {
            let outer = 1 - inner;
            if !self.shapes[outer].closed() {
                return None;
            }
            let from = self.poses[outer].inverse() * self.poses[inner];
            self.shapes[inner]
                .parts()
                .find(|(_, point)| self.shapes[outer].contains(from.transform_point3(*point)))
                .map(|(vertex, _)| (inner, vertex))
        })
    }
}

/// Whether a side of `a` passes through `b`, with its ends and the triangle's sides more than
/// `margin` away.
fn pierces(a: [DVec3; 3], b: [DVec3; 3], margin: f64) -> bool {
    let normal = area_vector(b).normalize_or_zero();
    let [p, q, r] = b;
    let heights = a.map(|corner| normal.dot(corner - p));
    let inward = [(p, q), (q, r), (r, p)]
        .map(|(from, to)| (from, normal.cross(to - from).normalize_or_zero()));
    (0..3).any(|k| {
        let (h, g) = (heights[k], heights[(k + 1) % 3]);
        if h.abs() <= margin || g.abs() <= margin || h.signum() == g.signum() {
            return false;
        }
        let crossing = a[k] + (a[(k + 1) % 3] - a[k]) * (h / (h - g));
        inward
            .iter()
            .all(|(from, inward)| inward.dot(crossing - from) > margin)
    })
}
