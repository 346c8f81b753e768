//! Whether a fin fits in the body: a proof that it does not come out on the other side.

use crate::body::Mesh;
use crate::bounds::{SurfaceTree, are_apart};
use crate::grazing::spatial::Source;
use crate::numeric::exact::signs::{Side, side_of_plane};
use crate::numeric::tolerance::{POSE_ROUNDING, UNIT_ROUNDOFF};
use glam::DVec3;

/// The body at rest, prepared for these tests.
pub(crate) struct Room<'a> {
    mesh: &'a Mesh,
    tree: SurfaceTree,
    /// Largest distance of a computed point of a face from its plane.
    rounding: f64,
}

impl<'a> Room<'a> {
    /// O(#F log #F).
    pub(crate) fn new(mesh: &'a Mesh) -> Room<'a> {
        let [low, high] = mesh.bounds();
        let reach = low.abs().max(high.abs()).max_element();
        Room {
            mesh,
            tree: SurfaceTree::new(mesh.positions(), mesh.triangles()),
            rounding: POSE_ROUNDING * UNIT_ROUNDOFF * reach,
        }
    }

    /// Whether the fin `[b, a, a_copy, b_copy]` (two triangles along the diagonal b - a_copy),
    /// which is attached to the surface along the piece a - b of `source`, lies inside the body
    /// except for that piece.
    ///
    /// `true` is a proof, up to the rounding of points on faces; `false` may be cautious. The fin
    /// begins inside, and no face except those that carry the piece passes through it: each other
    /// face near it either has the whole fin on its inner side, or lies on one side of each of the
    /// fin's triangles, or misses them.
    pub(crate) fn holds(
        &self,
        source: Source,
        [a, b]: [DVec3; 2],
        [a_copy, b_copy]: [DVec3; 2],
    ) -> bool {
        let own: &[u32] = match source {
            Source::Edge(edge) => &self.mesh.edges()[edge as usize].faces,
            Source::Face(ref face) => std::slice::from_ref(face),
        };
        let is_below = |face: u32, p: DVec3| {
            let [u, v, w] = self.tree.corners(face);
            side_of_plane(u, v, w, p) == Side::Below
        };
        let corners = [a, b, a_copy, b_copy];
        // The inside is behind a face, or behind either face of a concave edge.
        if ![a_copy, b_copy]
            .iter()
            .all(|&copy| own.iter().any(|&face| is_below(face, copy)))
        {
            return false;
        }
        let fin = [[b, a, a_copy], [b, a_copy, b_copy]];
        let low = corners.iter().fold(a, |low, &p| low.min(p));
        let high = corners.iter().fold(a, |high, &p| high.max(p));
        let mut holds = true;
        self.tree.for_each_in_box([low, high], |face| {
            if holds && !own.contains(&face) {
                let face = self.tree.corners(face);
                let [u, v, w] = face;
                let normal = (v - u).cross(w - u).normalize_or_zero();
                // The ends of the piece may be points on this face's border, rounded to above it.
                let is_behind = [a, b].iter().all(|&p| normal.dot(p - u) <= self.rounding)
                    && [a_copy, b_copy]
                        .iter()
                        .all(|&p| side_of_plane(u, v, w, p) == Side::Below);
                holds = is_behind || fin.iter().all(|triangle| are_apart(triangle, &face));
            }
        });
        holds
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::cuboid;

    /// The box [0, 1]^2 x [0, height].
    fn slab(height: f64) -> Mesh {
        let (positions, triangles) = cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, height));
        Mesh::new(positions, triangles).expect("a slab is a body")
    }

    /// Whether a fin of some depth fits below a segment of the top of a slab of height 1 (triangle
    /// 2: x + y <= 1).
    fn fits(mesh: &Mesh, height: f64, depth: f64) -> bool {
        let segment = [DVec3::new(0.1, 0.2, height), DVec3::new(0.4, 0.3, height)];
        let top = mesh
            .triangles()
            .iter()
            .position(|t| t.map(|v| v as usize) == [4, 5, 6])
            .map(crate::numeric::index)
            .expect("the slab has this face");
        Room::new(mesh).holds(
            Source::Face(top),
            segment,
            segment.map(|p| p - DVec3::Z * depth),
        )
    }

    #[test]
    fn a_fin_in_a_thick_slab_has_room() {
        assert!(fits(&slab(1.0), 1.0, 0.5), "half way down");
    }

    #[test]
    fn a_fin_through_a_thin_slab_has_none() {
        assert!(!fits(&slab(0.1), 0.1, 0.5), "out at the bottom");
    }

    #[test]
    fn a_fin_on_the_outside_has_none() {
        assert!(!fits(&slab(1.0), 1.0, -0.1), "above the top");
    }
}
