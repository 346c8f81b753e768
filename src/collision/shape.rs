//! A surface prepared for checks.

use super::plane::Plane;
use crate::body::{Mesh, Surface};
use crate::bounds::{Content, SurfaceTree};
use crate::numeric::area::area_vector;
use crate::numeric::{DisjointSets, index};
use glam::{DMat3, DVec3};

/// A surface under a tree of boxes, prepared for many checks.
#[derive(Debug, Clone)]
pub struct Shape {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    closed: bool,
    /// The rotation from the frame of the boxes, which is aligned with the largest faces, to that
    /// of the surface.
    pub(super) frame: DMat3,
    /// The nodes, root first, with boxes in their frame.
    pub(super) nodes: Vec<ShapeNode>,
    /// A tree of the surface in the frame of the boxes.
    tree: SurfaceTree,
    bounds: [DVec3; 2],
    /// One vertex of each connected part.
    parts: Vec<u32>,
    /// The leaf of each triangle.
    leaves: Vec<u32>,
    /// The plane of a half-space, which is the point of the plane otherwise.
    plane: Option<Plane>,
}

/// A box and what is below it.
#[derive(Debug, Clone, Copy)]
pub(super) struct ShapeNode {
    pub(super) centre: DVec3,
    /// Half the extent along each axis.
    pub(super) half: DVec3,
    /// The children are this node and the next; a leaf has none.
    pub(super) children: u32,
    /// The triangle of a leaf.
    pub(super) triangle: u32,
}

impl ShapeNode {
    pub(super) fn is_leaf(&self) -> bool {
        self.children == 0
    }
}

impl Shape {
    /// Prepares a surface.
    ///
    /// # Cost
    /// O(#F log #F), about a microsecond per triangle.
    pub fn new(surface: &Surface) -> Shape {
        Shape::of(surface.positions(), surface.triangles(), surface.closed())
    }

    /// The solid half-space behind a plane.
    pub fn half_space(plane: &Plane) -> Shape {
        Shape {
            closed: true,
            plane: Some(*plane),
            ..Shape::point(plane.point())
        }
    }

    /// The plane of a half-space; `None` for other shapes.
    pub fn plane(&self) -> Option<&Plane> {
        self.plane.as_ref()
    }

    /// A shape that is a single point.
    pub(super) fn point(point: DVec3) -> Shape {
        Shape::of(&[point], &[[0; 3]], false)
    }

    fn of(positions: &[DVec3], triangles: &[[u32; 3]], closed: bool) -> Shape {
        let frame = frame(positions, triangles);
        let turned: Vec<DVec3> = positions.iter().map(|&p| frame.transpose() * p).collect();
        let tree = SurfaceTree::with_leaves(&turned, triangles, 1);
        let far = turned.iter().map(|p| p.abs().max_element());
        let rounding = FRAME_ROUNDING * far.fold(0.0, f64::max);
        let mut nodes: Vec<ShapeNode> = Vec::with_capacity(2 * triangles.len());
        // Leaves with several triangles (which the tree cannot separate) get nodes of their own
        // below them.
        let mut crowded: Vec<(usize, Vec<u32>)> = Vec::new();
        for node in tree.nodes() {
            let [low, high] = tree.node_bounds(node);
            let (children, triangle) = match tree.content(node) {
                Content::Children([first, _]) => (first, 0),
                Content::Triangles(several) => {
                    crowded.push((nodes.len(), several.to_vec()));
                    (0, 0)
                }
            };
            let pad = DVec3::splat(rounding);
            nodes.push(boxed(low - pad, high + pad, children, triangle));
        }
        for (at, several) in crowded {
            split(&mut nodes, at, &several);
        }
        let mut leaves = vec![0; triangles.len()];
        for (number, node) in (0..).zip(&nodes) {
            if node.is_leaf() {
                leaves[node.triangle as usize] = number;
            }
        }
        Shape {
            leaves,
            bounds: bounds(positions, triangles),
            parts: connected_parts(positions.len(), triangles),
            positions: positions.to_vec(),
            triangles: triangles.to_vec(),
            closed,
            frame,
            nodes,
            tree,
            plane: None,
        }
    }

    /// Whether the surface bounds a solid.
    pub fn closed(&self) -> bool {
        self.closed
    }

    /// Number of triangles; 1 for a half-space.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Whether there are no triangles: never, by construction.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// The node that contains only this triangle.
    pub(super) fn leaf(&self, triangle: u32) -> u32 {
        self.leaves[triangle as usize]
    }

    /// Whether the triangle with the number of a vertex is just this vertex, as in a cloud.
    pub(super) fn is_point(&self, vertex: u32) -> bool {
        self.triangles.get(vertex as usize) == Some(&[vertex; 3])
    }

    /// The position of a vertex.
    pub(super) fn vertex(&self, vertex: u32) -> DVec3 {
        self.positions[vertex as usize]
    }

    /// Number of vertices, used or not.
    pub(super) fn vertices(&self) -> usize {
        self.positions.len()
    }

    pub(super) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|v| self.positions[v as usize])
    }

    pub(super) fn indices(&self, triangle: u32) -> [u32; 3] {
        self.triangles[triangle as usize]
    }

    /// A box around some points, as a leaf of no triangle.
    pub(super) fn around(&self, points: &[DVec3; 3]) -> ShapeNode {
        let turned = points.map(|p| self.frame.transpose() * p);
        let far = turned.iter().map(|p| p.abs().max_element());
        let pad = DVec3::splat(FRAME_ROUNDING * far.fold(0.0, f64::max));
        let [a, b, c] = turned;
        boxed(a.min(b).min(c) - pad, a.max(b).max(c) + pad, 0, 0)
    }

    pub(super) fn bounds(&self) -> [DVec3; 2] {
        self.bounds
    }

    /// Whether a point, in the frame of the surface, is inside it; never for an open surface.
    pub(super) fn contains(&self, point: DVec3) -> bool {
        self.closed
            && self
                .tree
                .winding_number(self.frame.transpose() * point)
                .is_some_and(|winding| winding >= 1)
    }

    /// A point of each connected part, with its vertex.
    pub(super) fn parts(&self) -> impl Iterator<Item = (u32, DVec3)> {
        self.parts.iter().map(|&v| (v, self.positions[v as usize]))
    }
}

impl From<&Mesh> for Shape {
    fn from(mesh: &Mesh) -> Shape {
        Shape::of(mesh.positions(), mesh.triangles(), true)
    }
}

/// Rounding of a rotated position relative to the largest coordinate: three products, and entries
/// that are off by 2 u.
const FRAME_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Most directions of faces that are distinguished when a frame is chosen.
const DIRECTIONS: usize = 24;

/// A rotation whose axes are the directions that most of the area faces: boxes around such faces
/// have no thickness. Any rotation would be correct.
fn frame(positions: &[DVec3], triangles: &[[u32; 3]]) -> DMat3 {
    let mut faces: Vec<(f64, DVec3)> = Vec::with_capacity(DIRECTIONS);
    for t in triangles {
        let area = area_vector(t.map(|v| positions[v as usize]));
        let Some(normal) = area.try_normalize() else {
            continue;
        };
        let known = faces
            .iter()
            .position(|(_, n)| n.dot(normal).abs() > PARALLEL);
        match known {
            Some(face) => faces[face].0 += area.length(),
            None if faces.len() < DIRECTIONS => faces.push((area.length(), normal)),
            None => {}
        }
    }
    let largest = |across: DVec3| {
        let eligible = faces.iter().filter(|(_, n)| n.dot(across).abs() < 0.5);
        eligible
            .copied()
            .reduce(|best, next| if next.0 > best.0 { next } else { best })
            .map(|(_, normal)| normal)
    };
    let Some(first) = largest(DVec3::ZERO) else {
        return DMat3::IDENTITY;
    };
    let second = largest(first).unwrap_or(first.any_orthonormal_vector());
    let third = first.cross(second).normalize();
    DMat3::from_cols(first, third.cross(first), third)
}

/// Cosine of the angle between directions that count as one.
const PARALLEL: f64 = 0.999;

fn boxed(low: DVec3, high: DVec3, children: u32, triangle: u32) -> ShapeNode {
    let centre = low * 0.5 + high * 0.5;
    // Rounded up, since the centre may be off by a unit in the last place.
    let half = (high - centre).max(centre - low).map(f64::next_up);
    ShapeNode {
        centre,
        half,
        children,
        triangle,
    }
}

/// Places several triangles below the node at `at`, each with the box of that node.
fn split(nodes: &mut Vec<ShapeNode>, at: usize, several: &[u32]) {
    if let [triangle] = *several {
        nodes[at].triangle = triangle;
        return;
    }
    let children = nodes.len();
    nodes[at].children = index(children);
    let copy = ShapeNode {
        children: 0,
        ..nodes[at]
    };
    nodes.extend([copy; 2]);
    let (left, right) = several.split_at(several.len() / 2);
    split(nodes, children, left);
    split(nodes, children + 1, right);
}

fn bounds(positions: &[DVec3], triangles: &[[u32; 3]]) -> [DVec3; 2] {
    let empty = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    triangles.iter().flatten().fold(empty, |[low, high], &v| {
        let p = positions[v as usize];
        [low.min(p), high.max(p)]
    })
}

/// The first vertex of each part that triangles connect.
fn connected_parts(count: usize, triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut sets = DisjointSets::new(count);
    for &[a, b, c] in triangles {
        sets.join(a, b);
        sets.join(a, c);
    }
    let mut parts: Vec<u32> = triangles.iter().map(|t| sets.first(t[0])).collect();
    parts.sort_unstable();
    parts.dedup();
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_triangle_is_in_one_leaf_and_within_its_boxes() {
        // Two crowds, each at one place, which no tree can separate, and a strip.
        let mut positions: Vec<DVec3> = (0..40)
            .map(|i| DVec3::new(f64::from(i % 7), f64::from(i / 7), f64::from(i % 3)))
            .collect();
        let mut triangles: Vec<[u32; 3]> = (0..38).map(|i| [i, i + 1, i + 2]).collect();
        positions.push(DVec3::splat(9.0));
        triangles.extend([[40; 3]; 9]);
        let surface = Surface::new(positions, triangles.clone()).expect("a surface");
        let shape = Shape::new(&surface);
        let mut seen = vec![0; triangles.len()];
        let mut open = vec![0];
        while let Some(at) = open.pop() {
            let node = shape.nodes[at as usize];
            if node.is_leaf() {
                seen[node.triangle as usize] += 1;
                for corner in shape.corners(node.triangle) {
                    let corner = shape.frame.transpose() * corner;
                    assert!(
                        (corner - node.centre).abs().cmple(node.half).all(),
                        "{corner} in the box"
                    );
                }
            } else {
                open.extend([node.children, node.children + 1]);
            }
        }
        assert_eq!(seen, vec![1; triangles.len()], "each once");
        assert_eq!(
            shape.parts().map(|(v, _)| v).collect::<Vec<_>>(),
            [0, 40],
            "the strip and the crowd"
        );
    }
}
