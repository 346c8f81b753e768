//! The lowest vertex of a shape over a plane, at one instant.

use crate::collision::plane::Plane;
use crate::collision::shape::Shape;
use glam::{DAffine3, DVec3};

/// A vertex that is the lowest one over a plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::collision) struct Lowest {
    pub(in crate::collision) height: f64,
    pub(in crate::collision) vertex: u32,
    /// Its place in the world.
    pub(in crate::collision) place: DVec3,
}

/// The lowest vertex of a shape in a pose over a plane in the world; of several, that with the
/// least number.
///
/// # Cost
/// O(log n) for most shapes: boxes that are higher are not opened.
pub(in crate::collision) fn lowest(shape: &Shape, pose: &DAffine3, plane: &Plane) -> Lowest {
    let turned = pose.matrix3 * shape.frame;
    let across = turned.transpose() * plane.normal();
    let mut best: Option<Lowest> = None;
    let mut open = vec![0];
    while let Some(node) = open.pop() {
        let node = &shape.nodes[node as usize];
        let bottom = |node: &crate::collision::shape::ShapeNode| {
            let centre = turned * node.centre + pose.translation;
            plane.height(centre) - across.abs().dot(node.half)
        };
        let rounding = BOX_ROUNDING * (plane.point() - pose.translation).length();
        if best.is_some_and(|best| bottom(node) > best.height + rounding) {
            continue;
        }
        if !node.is_leaf() {
            let [left, right] = [node.children, node.children + 1];
            let [a, b] = [left, right].map(|child| bottom(&shape.nodes[child as usize]));
            // The lower one comes on top of the stack.
            open.extend(if a < b { [right, left] } else { [left, right] });
            continue;
        }
        let corners = shape.corners(node.triangle);
        for (vertex, position) in shape.indices(node.triangle).into_iter().zip(corners) {
            let place = pose.transform_point3(position);
            let height = plane.height(place);
            let is_lower = best.is_none_or(|best| {
                height < best.height || height == best.height && vertex < best.vertex
            });
            if is_lower {
                best = Some(Lowest {
                    height,
                    vertex,
                    place,
                });
            }
        }
    }
    best.expect("a shape has a vertex")
}

/// Relative rounding of the height of a box: some 10 u, with a margin.
const BOX_ROUNDING: f64 = 1e-14;
