//! The region that contains all points of a solid that are deeper than allowed.
//!
//! A path out of a solid along an axis of a box around it meets its surface before it leaves the
//! box. So a point that is farther from the surface than some depth is at least as far from the
//! sides of the box: it lies in the box that is smaller by the depth at each side. Whatever never
//! enters that box is never as deep, however many faces of the solid are about equally near to it.

use super::depth::stretching;
use super::encounter::Encounter;
use super::shape::ShapeNode;
use glam::DVec3;

/// A box, in the frame of the boxes of one of the shapes, that contains all points that are deeper
/// in it than `depth`, at any time; `None` when there are no such points.
pub(super) fn around(encounter: &Encounter, which: usize, depth: f64) -> Option<ShapeNode> {
    let mover = &encounter.movers[which];
    let largest = stretching(&mover.pose(0.0).matrix3) * mover.growth().exp();
    let root = encounter.shapes[which].nodes[0];
    let half = root.half - depth / largest;
    // NaN, for unbounded stretching, leaves the box as it is.
    let half = root.half.min(half);
    half.cmpge(DVec3::ZERO).all().then_some(ShapeNode {
        half,
        children: 0,
        triangle: 0,
        ..root
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::Surface;
    use crate::collision::mover::Mover;
    use crate::collision::shape::Shape;
    use crate::samples::{cuboid, random};
    use glam::{DAffine3, DMat3};

    #[test]
    fn no_point_outside_of_it_is_deeper() {
        // A corner is cut out of the box: the deep part is smaller than the box around the shape
        // says.
        let (mut positions, mut triangles) = cuboid(DVec3::ZERO, DVec3::new(4.0, 3.0, 2.0));
        let (more, others) = cuboid(DVec3::new(4.5, 0.0, 0.0), DVec3::new(5.0, 1.0, 1.0));
        let first = u32::try_from(positions.len()).expect("a few");
        triangles.extend(others.iter().map(|t| t.map(|v| v + first)));
        positions.extend(more);
        let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 2.0) / 3.0, 0.7);
        positions.iter_mut().for_each(|p| *p = turn * *p);
        let shape = Shape::new(&Surface::new(positions, triangles).expect("two boxes"));
        let mut next = random(11);
        for scale in [1.0, 0.5, 3.0] {
            let pose = DAffine3::from_mat3_translation(turn * scale, DVec3::new(5.0, -3.0, 2.0));
            let movers = [0; 2].map(|_| Mover::resting(pose, shape.bounds()));
            let encounter = Encounter::new([&shape; 2], movers);
            let solid = encounter.solid(0, 0.0);
            for share in [0.1, 0.5, 0.9] {
                let depth = share * scale;
                let node = around(&encounter, 0, depth).expect("deep enough");
                for _ in 0..500 {
                    let p = DVec3::new(next() * 3.0 + 2.5, next() * 2.0 + 1.5, next() + 1.0);
                    let sounding = solid.sound(pose.transform_point3(turn * p));
                    let own = shape.frame.transpose() * (turn * p);
                    let is_in = (own - node.centre).abs().cmple(node.half).all();
                    assert!(is_in || sounding.depth <= depth, "{p}: {sounding:?}");
                }
            }
            assert!(around(&encounter, 0, 1.01 * scale).is_none(), "half of 2");
        }
    }
}
