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
pub(super) enum Side {
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
    sides: &mut [Side],
) {
    let mut network = Network::default();
    let nodes: Vec<Option<u32>> = sides
        .iter()
        .map(|side| (*side == Side::Free).then(|| network.add_node()))
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
    let egress = network.egress();
    for (side, node) in sides.iter_mut().zip(&nodes) {
        if let Some(node) = node {
            *side = if egress[*node as usize] {
                Side::Egress
            } else {
                Side::Ingress
            };
        }
    }
}

/// The share of an edge that borders on the egress part of a settled face.
fn egress_share(sides: &[Side], flux: &[[f64; 3]], mesh: &Mesh, face: u32, ends: [u32; 2]) -> f64 {
    match sides[face as usize] {
        Side::Egress => 1.0,
        Side::Ingress | Side::Free => 0.0,
        Side::Both => positive_share(flux[face as usize], mesh.triangles()[face as usize], ends),
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
struct Network {
    /// Per node, the weights that pull it to egress and to ingress.
    ends: Vec<[f64; 2]>,
    between: Vec<([u32; 2], f64)>,
}

impl Network {
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
    fn egress(self) -> Vec<bool> {
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
        cut.source_side()
    }
}
