//! The boundary of the egress region, chosen to sweep the least area where it is free.
//!
//! Sheets of small area do not run to and fro along the paths of the motion, in layers closer to
//! each other than their sampling error. The faces take sides by a minimum cut: the weight of an
//! edge is the area that it sweeps, and a face on the side opposite to its flux costs the volume
//! that its flux moves, as a layer of the depth that may be lost.

use super::minimum_cut::MinimumCut;
use crate::body::Mesh;
use crate::motion::Generator;
use crate::numeric::index;
use crate::watch::{Interrupted, Work};
use glam::DVec3;

/// Least weight of an edge, as a share of its length times its speed, even if it moves along
/// itself: such sheets have no area, but they have triangles.
const LEAST_WEIGHT: f64 = 0.05;

/// Weight of the volume that wrong signs move, relative to the areas.
const VOLUME_WEIGHT: f64 = 4.0;

/// Number of integer steps in the largest capacity.
const RESOLUTION: f64 = 1e12;

/// The state of the choice of side for a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum FaceSide {
    Ingress,
    Egress,
    /// On both sides: it is cut by the grazing set.
    Both,
    /// Still to be chosen.
    Free,
}

/// Gives every free face its side.
///
/// - `flux`: the flux at the corners of each face. `depth`: depth of the layer that may be lost.
pub(super) fn part(
    mesh: &Mesh,
    positions: &[DVec3],
    generator: &Generator,
    flux: &[[f64; 3]],
    depth: f64,
    sides: &mut [FaceSide],
    work: Work,
) -> Result<(), Interrupted> {
    let mut network = CutNetwork::default();
    let nodes: Vec<Option<u32>> = sides
        .iter()
        .map(|side| (*side == FaceSide::Free).then(|| network.add_node()))
        .collect();
    for (face, node) in nodes.iter().enumerate() {
        let Some(node) = node else { continue };
        let corners = mesh.triangles()[face].map(|v| positions[v as usize]);
        let area = 0.5
            * (corners[1] - corners[0])
                .cross(corners[2] - corners[0])
                .length();
        let volume = |sense: f64| {
            let mean = flux[face].iter().map(|g| (sense * g).max(0.0)).sum::<f64>() / 3.0;
            VOLUME_WEIGHT * mean * area / depth
        };
        network.pull(*node, volume(1.0), volume(-1.0));
    }
    for edge in mesh.edges() {
        let ends = edge.vertices.map(|v| positions[v as usize]);
        let velocity = generator.velocity(0.5 * (ends[0] + ends[1]));
        let direction = ends[1] - ends[0];
        let weight = direction.cross(velocity).length()
            + LEAST_WEIGHT * direction.length() * velocity.length();
        match edge.faces.map(|face| nodes[face as usize]) {
            [Some(first), Some(second)] => network.between.push(([first, second], weight)),
            [Some(node), None] => network.beside(
                node,
                egress_share(sides, flux, mesh, edge.faces[1], edge.vertices),
                weight,
            ),
            [None, Some(node)] => network.beside(
                node,
                egress_share(sides, flux, mesh, edge.faces[0], edge.vertices),
                weight,
            ),
            [None, None] => {}
        }
    }
    let egress = network.egress(work)?;
    for (side, node) in sides.iter_mut().zip(&nodes) {
        if let Some(node) = node {
            *side = if egress[*node as usize] {
                FaceSide::Egress
            } else {
                FaceSide::Ingress
            };
        }
    }
    Ok(())
}

/// The share of an edge that borders on the egress part of a settled face.
fn egress_share(
    sides: &[FaceSide],
    flux: &[[f64; 3]],
    mesh: &Mesh,
    face: u32,
    ends: [u32; 2],
) -> f64 {
    match sides[face as usize] {
        FaceSide::Egress => 1.0,
        FaceSide::Ingress | FaceSide::Free => 0.0,
        FaceSide::Both => {
            positive_share(flux[face as usize], mesh.triangles()[face as usize], ends)
        }
    }
}

/// The share of a side, given by its ends, on which values at the corners of its triangle
/// interpolate to at least 0.
pub(super) fn positive_share(values: [f64; 3], triangle: [u32; 3], ends: [u32; 2]) -> f64 {
    let [first, second] = ends.map(|end| {
        (0..3)
            .filter(|&corner| triangle[corner] == end)
            .map(|corner| values[corner])
            .sum::<f64>()
    });
    match (first >= 0.0, second >= 0.0) {
        (true, true) => 1.0,
        (false, false) => 0.0,
        (true, false) => first / (first - second),
        (false, true) => second / (second - first),
    }
}

/// A minimum cut problem between egress and ingress.
#[derive(Default)]
struct CutNetwork {
    /// Per node, the weights that pull it to egress and to ingress.
    ends: Vec<[f64; 2]>,
    between: Vec<([u32; 2], f64)>,
}

impl CutNetwork {
    fn add_node(&mut self) -> u32 {
        self.ends.push([0.0; 2]);
        index(self.ends.len() - 1)
    }

    fn pull(&mut self, node: u32, to_egress: f64, to_ingress: f64) {
        let [egress, ingress] = &mut self.ends[node as usize];
        *egress += to_egress;
        *ingress += to_ingress;
    }

    fn beside(&mut self, node: u32, egress_share: f64, weight: f64) {
        self.pull(node, weight * egress_share, weight * (1.0 - egress_share));
    }

    /// Which nodes lie on the egress side of a minimum cut.
    fn egress(self, work: Work) -> Result<Vec<bool>, Interrupted> {
        let largest = self
            .ends
            .iter()
            .flatten()
            .copied()
            .chain(self.between.iter().map(|(_, weight)| *weight))
            .fold(f64::MIN_POSITIVE, f64::max);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "between 0 and the resolution"
        )]
        let capacity = |weight: f64| (weight / largest * RESOLUTION) as u64;
        let mut cut = MinimumCut::new(self.ends.len());
        for (node, ends) in (0..).zip(&self.ends) {
            let [egress, ingress] = ends.map(|weight| capacity(weight).cast_signed());
            cut.add_terminal(node, egress, ingress);
        }
        for &(ends, weight) in &self.between {
            cut.add_edge(ends, capacity(weight));
        }
        cut.source_side(work)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::cuboid;

    #[test]
    fn the_share_of_a_side_ends_where_the_value_is_zero() {
        let share = |values, ends| positive_share(values, [7, 8, 9], ends);
        // From 3 to -1, the value is 0 after three quarters of the side, from either end.
        assert_eq!(share([3.0, -1.0, 5.0], [7, 8]), 0.75);
        assert_eq!(share([3.0, -1.0, 5.0], [8, 7]), 0.75);
        assert_eq!(share([0.0, 2.0, -1.0], [7, 8]), 1.0, "zero is not negative");
        assert_eq!(share([-1.0, -2.0, 9.0], [7, 8]), 0.0);
        // The value is 0 at one end only, and this point has no length.
        assert_eq!(share([0.0, -2.0, 9.0], [7, 8]), 0.0);
    }

    /// The sides that the faces of a cube of size 1 take when all are free and it moves by one
    /// along x.
    fn sides_of_a_cube(depth: f64) -> (Mesh, Vec<FaceSide>) {
        let (positions, triangles) = cuboid(DVec3::ZERO, DVec3::ONE);
        let mesh = Mesh::new(positions, triangles).expect("a cube is a body");
        let flux: Vec<[f64; 3]> = mesh
            .triangles()
            .iter()
            .map(|triangle| {
                let [a, b, c] = triangle.map(|v| mesh.positions()[v as usize]);
                [(b - a).cross(c - a).normalize().x; 3]
            })
            .collect();
        let mut sides = vec![FaceSide::Free; 12];
        let generator = Generator::translation(DVec3::X);
        part(
            &mesh,
            mesh.positions(),
            &generator,
            &flux,
            depth,
            &mut sides,
            Work::UNWATCHED,
        )
        .expect("nobody stops it");
        (mesh, sides)
    }

    #[test]
    fn faces_along_the_motion_take_sides_round_the_shortest_loop() {
        let (mesh, sides) = sides_of_a_cube(1e-3);
        // Faces 8 and 9 are at x = 0, 10 and 11 at x = 1: a layer of them weighs far more than any
        // boundary.
        assert_eq!(sides[8..10], [FaceSide::Ingress; 2]);
        assert_eq!(sides[10..], [FaceSide::Egress; 2]);
        // Any loop between them sweeps at least the four sides of the square that is its projection
        // along x.
        let swept: f64 = mesh
            .edges()
            .iter()
            .filter(|edge| sides[edge.faces[0] as usize] != sides[edge.faces[1] as usize])
            .map(|edge| {
                let [a, b] = edge.vertices.map(|v| mesh.positions()[v as usize]);
                (b - a).cross(DVec3::X).length()
            })
            .sum();
        assert_eq!(swept, 4.0);
    }

    #[test]
    fn nothing_is_swept_where_all_may_be_lost() {
        // A layer of this depth makes the volume of either end cheaper than any loop.
        let (_, sides) = sides_of_a_cube(1e6);
        assert!(sides.iter().all(|side| *side == sides[0]), "{sides:?}");
    }
}
