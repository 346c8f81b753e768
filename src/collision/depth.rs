//! How deep a point lies in a solid at rest, and where its surface is nearest.

use super::nearest::{Nearest, nearest};
use super::shape::Shape;
use glam::{DAffine3, DMat3, DVec3};

/// A closed shape in a pose.
pub(super) struct Solid<'a> {
    shape: &'a Shape,
    pose: DAffine3,
    inverse: DAffine3,
    /// No length becomes smaller than this part of itself in the pose.
    shrinking: f64,
}

/// A point and the surface of a solid.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sounding {
    /// Distance from the surface; negative outside of the solid.
    pub(super) depth: f64,
    /// The point, and the nearest one of the surface.
    pub(super) nearest: Nearest,
    /// What that lies on.
    pub(super) triangle: u32,
}

impl Sounding {
    /// Unit vector out of the solid by the shortest way; `None` on the surface.
    pub(super) fn outward(&self) -> Option<DVec3> {
        let [point, surface] = self.nearest.points;
        let way = (surface - point).try_normalize()?;
        Some(if self.depth < 0.0 { -way } else { way })
    }
}

/// Part of a length by which rounding may make a bound of it too large.
const ROUNDING: f64 = 1e-12;

impl<'a> Solid<'a> {
    pub(super) fn new(shape: &'a Shape, pose: DAffine3) -> Solid<'a> {
        let inverse = pose.inverse();
        Solid {
            shape,
            pose,
            inverse,
            shrinking: shrinking(&pose.matrix3, &inverse.matrix3) * (1.0 - ROUNDING),
        }
    }

    /// Whether a point is inside, exactly for the coordinates as the solid sees them.
    pub(super) fn contains(&self, point: DVec3) -> bool {
        self.shape.contains(self.inverse.transform_point3(point))
    }

    /// - `point`: in the world.
    ///
    /// # Cost
    /// Some microseconds for a thousand triangles.
    pub(super) fn sound(&self, point: DVec3) -> Sounding {
        let (triangle, nearest) = self.nearest(point);
        let distance = nearest.distance();
        Sounding {
            depth: if self.contains(point) {
                distance
            } else {
                -distance
            },
            nearest,
            triangle,
        }
    }

    /// The nearest triangle, and where.
    fn nearest(&self, point: DVec3) -> (u32, Nearest) {
        let own = self.shape.frame.transpose() * self.inverse.transform_point3(point);
        let gap_squared = |node: u32| self.gap(own, node).powi(2);
        let mut best: Option<(u32, Nearest)> = None;
        let mut open = vec![(0, gap_squared(0))];
        while let Some((number, gap)) = open.pop() {
            if best.is_some_and(|(_, near)| gap >= near.distance_squared) {
                continue;
            }
            let node = &self.shape.nodes[number as usize];
            if node.is_leaf() {
                let near = nearest(&[point], &self.corners(node.triangle));
                if best.is_none_or(|(_, best)| near.distance_squared < best.distance_squared) {
                    best = Some((node.triangle, near));
                }
                continue;
            }
            let [one, other] = [node.children, node.children + 1].map(|c| (c, gap_squared(c)));
            // The nearer child on top.
            open.extend(if one.1 <= other.1 {
                [other, one]
            } else {
                [one, other]
            });
        }
        best.unwrap_or_else(|| (0, nearest(&[point], &self.corners(0))))
    }

    /// A lower bound of the distance of a point, in the frame of the boxes, from what is in a node.
    fn gap(&self, own: DVec3, node: u32) -> f64 {
        let node = &self.shape.nodes[node as usize];
        let apart = (own - node.centre).abs() - node.half;
        apart.max(DVec3::ZERO).length() * self.shrinking
    }

    /// Calls `visit` for every triangle within `reach` of a point, and perhaps a few others, until it returns `false`.
    pub(super) fn for_each_within(
        &self,
        point: DVec3,
        reach: f64,
        mut visit: impl FnMut(u32, &Nearest) -> bool,
    ) {
        let own = self.shape.frame.transpose() * self.inverse.transform_point3(point);
        let mut open = vec![0];
        while let Some(number) = open.pop() {
            if self.gap(own, number) > reach {
                continue;
            }
            let node = &self.shape.nodes[number as usize];
            if !node.is_leaf() {
                open.extend([node.children + 1, node.children]);
                continue;
            }
            let near = nearest(&[point], &self.corners(node.triangle));
            if near.distance() <= reach && !visit(node.triangle, &near) {
                return;
            }
        }
    }

    /// Corners of a triangle in the world.
    pub(super) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.shape
            .corners(triangle)
            .map(|corner| self.pose.transform_point3(corner))
    }
}

/// At most the least factor by which a matrix changes a length; sharp for similarities.
fn shrinking(matrix: &DMat3, inverse: &DMat3) -> f64 {
    let frobenius = |m: &DMat3| {
        m.x_axis.length_squared() + m.y_axis.length_squared() + m.z_axis.length_squared()
    };
    let square = matrix.transpose() * *matrix;
    let scale = frobenius(matrix) / 3.0;
    let off = square + DMat3::from_diagonal(DVec3::splat(-scale));
    // Eigenvalues of the square are within |off| of the scale.
    let least = (scale - frobenius(&off).sqrt()).max(0.0).sqrt();
    let general = 1.0 / frobenius(inverse).sqrt();
    if general.is_finite() {
        least.max(general)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::Surface;
    use crate::samples::{cuboid, random};

    #[test]
    fn depth_in_a_box_is_the_distance_from_the_nearest_side() {
        let (positions, triangles) = cuboid(DVec3::ZERO, DVec3::new(4.0, 2.0, 1.0));
        let shape = Shape::new(&Surface::new(positions, triangles).expect("a box"));
        let mut next = random(5);
        for scale in [1.0, 3.0] {
            let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 2.0) / 3.0, 0.7);
            let pose = DAffine3::from_mat3_translation(turn * scale, DVec3::new(5.0, -3.0, 2.0));
            let solid = Solid::new(&shape, pose);
            for _ in 0..200 {
                let p = DVec3::new(next() * 3.0 + 2.0, next() * 2.0 + 1.0, next() + 0.5);
                let beyond = (p - DVec3::new(4.0, 2.0, 1.0)).max(-p);
                let expected = if beyond.max_element() < 0.0 {
                    -beyond.max_element()
                } else {
                    -beyond.max(DVec3::ZERO).length()
                };
                let found = solid.sound(pose.transform_point3(p));
                assert!(
                    (found.depth - scale * expected).abs() < 1e-12,
                    "{p}: {} for {expected}",
                    found.depth
                );
                let mut least = f64::INFINITY;
                solid.for_each_within(pose.transform_point3(p), 2.0 * scale, |_, near| {
                    least = least.min(near.distance());
                    true
                });
                assert!(
                    found.depth.abs() > 2.0 * scale || least == found.depth.abs(),
                    "the same triangles"
                );
            }
        }
    }

    #[test]
    fn no_length_shrinks_more_than_the_bound_says() {
        let mut next = random(9);
        for _ in 0..200 {
            let matrix = DMat3::from_cols_array(&std::array::from_fn(|_| next()));
            let bound = shrinking(&matrix, &matrix.inverse());
            for _ in 0..50 {
                let v = DVec3::new(next(), next(), next());
                assert!(
                    (matrix * v).length() >= bound * v.length() * (1.0 - 1e-9),
                    "{v}"
                );
            }
        }
        let turned = DMat3::from_rotation_x(1.0) * 2.0;
        assert!(
            (shrinking(&turned, &turned.inverse()) - 2.0).abs() < 1e-7,
            "sharp for a similarity"
        );
    }
}
