//! How deep a point lies in a solid at rest, and the nearest place of its surface.

use super::nearest::{Nearest, nearest};
use super::shape::Shape;
use super::triangle_piece::{Plane, Weights, blend, lowest};
use crate::numeric::area::area_vector;
use crate::numeric::norms::{frobenius, frobenius_squared};
use glam::{DAffine3, DMat3, DVec3};
use std::cell::Cell;

/// A closed shape in a pose.
pub(super) struct PlacedSolid<'a> {
    shape: &'a Shape,
    pose: DAffine3,
    inverse: DAffine3,
    /// A lower bound on the factor by which the pose changes lengths.
    shrinking: f64,
    /// Number of boxes and triangles examined so far.
    looked_at: Cell<usize>,
}

/// The position of a point relative to the surface of a solid.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sounding {
    /// Distance from the surface, negative outside the solid.
    pub(super) depth: f64,
    /// The point, and the nearest point of the surface.
    pub(super) nearest: Nearest,
    /// The triangle on which that lies.
    pub(super) triangle: u32,
}

impl Sounding {
    /// The unit vector in the shortest direction out of the solid; `None` on the surface.
    pub(super) fn outward(&self) -> Option<DVec3> {
        let [point, surface] = self.nearest.points;
        let way = (surface - point).try_normalize()?;
        Some(if self.depth < 0.0 { -way } else { way })
    }
}

/// A point of a triangle that is about as deep as any other near it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Climbed {
    pub(super) weights: Weights,
    pub(super) sounding: Sounding,
    /// The approximate difference of the distances from the two nearest places of the surface, at
    /// the corners; `None` when there is one place.
    pub(super) between: Option<[f64; 3]>,
}

/// Relative error by which rounding may make a bound on a length too large.
const ROUNDING: f64 = 1e-12;

/// Most steps of a climb; convergence is quadratic where three places are equally near, as at most
/// of the deepest points.
const STEPS: usize = 8;

/// Most places of the surface that are considered in one step: the nearest ones.
const MOST_PLACES: usize = 6;

/// Most triangles that are examined for them.
const MOST_VISITED: usize = 256;

/// Fraction of the reach within which heights of parallel planes count as equal.
const SAME_HEIGHT: f64 = 1e-6;

impl<'a> PlacedSolid<'a> {
    pub(super) fn new(shape: &'a Shape, pose: DAffine3) -> PlacedSolid<'a> {
        let inverse = pose.inverse();
        PlacedSolid {
            shape,
            pose,
            inverse,
            shrinking: shrinking(&pose.matrix3, &inverse.matrix3) * (1.0 - ROUNDING),
            looked_at: Cell::new(0),
        }
    }

    /// The number of boxes and triangles examined in search of the nearest ones, a measure of work:
    /// near the centre of a ball, every one of its faces is about the nearest.
    pub(super) fn looked_at(&self) -> usize {
        self.looked_at.get()
    }

    fn look(&self) {
        self.looked_at.set(self.looked_at.get() + 1);
    }

    /// Whether a point is inside, exactly for its coordinates in the frame of the solid.
    pub(super) fn contains(&self, point: DVec3) -> bool {
        self.shape.contains(self.inverse.transform_point3(point))
    }

    /// - The sounding of a point of the world.
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

    /// The nearest triangle, and the nearest points.
    fn nearest(&self, point: DVec3) -> (u32, Nearest) {
        let own = self.shape.frame.transpose() * self.inverse.transform_point3(point);
        let gap_squared = |node: u32| self.gap(own, node).powi(2);
        let mut best: Option<(u32, Nearest)> = None;
        let mut open = vec![(0, gap_squared(0))];
        while let Some((number, gap)) = open.pop() {
            self.look();
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
            // * The nearer child comes on top of the stack.
            open.extend(if one.1 <= other.1 {
                [other, one]
            } else {
                [one, other]
            });
        }
        best.unwrap_or_else(|| (0, nearest(&[point], &self.corners(0))))
    }

    /// A lower bound of the distance of a point, in the frame of the boxes, from the contents of a
    /// node.
    fn gap(&self, own: DVec3, node: u32) -> f64 {
        let node = &self.shape.nodes[node as usize];
        let apart = (own - node.centre).abs() - node.half;
        apart.max(DVec3::ZERO).length() * self.shrinking
    }

    /// Calls `visit` for every triangle within `reach` of a point, and perhaps a few others, until
    /// it returns `false`.
    pub(super) fn for_each_within(
        &self,
        point: DVec3,
        reach: f64,
        mut visit: impl FnMut(u32, &Nearest) -> bool,
    ) {
        let own = self.shape.frame.transpose() * self.inverse.transform_point3(point);
        let mut open = vec![0];
        while let Some(number) = open.pop() {
            self.look();
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

    /// Climbs from a point of a triangle to a deeper one, as long as a few steps find any.
    ///
    /// For a place q of the surface, take the plane through q square to the line from the first
    /// point. The distance of any point from q is at least its height below this plane. So the
    /// point that is deepest below all these planes is at least as deep as that height, unless the
    /// surface is near elsewhere.
    pub(super) fn climb(&self, corners: &[DVec3; 3], from: Weights) -> Climbed {
        let mut best = Climbed {
            weights: from,
            sounding: self.sound(blend(corners, from)),
            between: None,
        };
        let size = (0..3)
            .map(|k| corners[k].distance(corners[(k + 1) % 3]))
            .fold(0.0, f64::max);
        let mut reach = size;
        for _ in 0..STEPS {
            let planes = self.ways_out(&best.sounding, reach);
            if planes.is_empty() {
                break;
            }
            let lowest = lowest(corners, &planes);
            best.between = lowest.between;
            let sounding = self.sound(blend(corners, lowest.weights));
            let gain = sounding.depth - best.sounding.depth;
            if gain > 0.0 {
                (best.weights, best.sounding) = (lowest.weights, sounding);
            }
            if gain <= ROUNDING * size {
                // Either places too far to be nearest at that point lead astray, or no point is
                // deeper.
                reach *= 0.25;
                if gain.abs() <= ROUNDING * size {
                    break;
                }
            }
        }
        best
    }

    /// Planes through the places of the surface that are nearest to a point, square to the lines to
    /// these places, with the outward direction as normal.
    ///
    /// - `reach`: largest excess of their distance over that of the nearest one.
    fn ways_out(&self, from: &Sounding, reach: f64) -> Vec<Plane> {
        let sign = if from.depth < 0.0 { -1.0 } else { 1.0 };
        let point = from.nearest.points[0];
        let mut places: Vec<(f64, DVec3, DVec3)> = Vec::new();
        let mut visited = 0;
        self.for_each_within(point, from.depth.abs() + reach, |triangle, near| {
            let place = near.points[1];
            let normal = match (place - point).try_normalize() {
                Some(way) => Some(way * sign),
                None => area_vector(self.corners(triangle)).try_normalize(),
            };
            if let Some(normal) = normal {
                places.push((near.distance(), normal, place));
            }
            visited += 1;
            visited < MOST_VISITED
        });
        places.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut planes: Vec<Plane> = Vec::new();
        for (_, normal, place) in places {
            let offset = normal.dot(place);
            let plane = Plane { normal, offset };
            if !planes
                .iter()
                .any(|known| known.is_same(&plane, SAME_HEIGHT * reach))
            {
                planes.push(plane);
            }
            if planes.len() == MOST_PLACES {
                break;
            }
        }
        planes
    }

    /// The number of triangles of its surface.
    pub(super) fn triangles(&self) -> usize {
        self.shape.len()
    }

    /// The indices of the vertices of a triangle.
    pub(super) fn indices(&self, triangle: u32) -> [u32; 3] {
        self.shape.indices(triangle)
    }

    /// The corners of a triangle in the world.
    pub(super) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.shape
            .corners(triangle)
            .map(|corner| self.pose.transform_point3(corner))
    }
}

/// A lower bound of the factor by which a matrix changes a length; sharp for similarities.
fn shrinking(matrix: &DMat3, inverse: &DMat3) -> f64 {
    let square = matrix.transpose() * *matrix;
    let scale = frobenius_squared(matrix) / 3.0;
    let off = square + DMat3::from_diagonal(DVec3::splat(-scale));
    // Eigenvalues of the square are within |off| of the scale.
    let least = (scale - frobenius(&off)).max(0.0).sqrt();
    let general = 1.0 / frobenius(inverse);
    if general.is_finite() {
        least.max(general)
    } else {
        0.0
    }
}

/// An upper bound of the factor by which a matrix changes a length; sharp for similarities.
pub(super) fn stretching(matrix: &DMat3) -> f64 {
    let square = matrix.transpose() * *matrix;
    let scale = frobenius_squared(matrix) / 3.0;
    let off = square + DMat3::from_diagonal(DVec3::splat(-scale));
    (scale + frobenius(&off)).sqrt() * (1.0 + ROUNDING)
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
            let solid = PlacedSolid::new(&shape, pose);
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
    fn no_length_shrinks_or_grows_more_than_the_bounds_say() {
        let mut next = random(9);
        for _ in 0..200 {
            let matrix = DMat3::from_cols_array(&std::array::from_fn(|_| next()));
            let bound = shrinking(&matrix, &matrix.inverse());
            let most = stretching(&matrix);
            for _ in 0..50 {
                let v = DVec3::new(next(), next(), next());
                assert!(
                    (matrix * v).length() >= bound * v.length() * (1.0 - 1e-9),
                    "{v}"
                );
                assert!((matrix * v).length() <= most * v.length(), "{v}");
            }
        }
        let turned = DMat3::from_rotation_x(1.0) * 2.0;
        assert!(
            (shrinking(&turned, &turned.inverse()) - 2.0).abs() < 1e-7,
            "sharp for a similarity"
        );
        assert!((stretching(&turned) - 2.0).abs() < 1e-7, "as well");
    }
}
