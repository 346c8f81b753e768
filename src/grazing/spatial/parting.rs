//! The boundary of the egress region, where it is free to lie: the one that sweeps the least area.
//!
//! Sheets of small area do not run to and fro along the paths of the motion, in layers closer to each other than their
//! sampling. The faces take sides in a minimum cut: the weight of an edge is the area that it sweeps, and a face on the side against its flux
//! costs the volume that its flux moves, as a layer of the depth that may be lost.

use crate::body::Mesh;
use crate::motion::Generator;
use glam::DVec3;
use petgraph::algo::dinics;
use petgraph::graph::{Graph, NodeIndex};
use petgraph::visit::EdgeRef;
use std::collections::VecDeque;

/// Share of its length times speed that every edge weighs at least, also if it moves along itself: such sheets
/// have no area, but triangles.
const LEAST_WEIGHT: f64 = 0.05;

/// Weight of the volume that wrong signs move, against the areas.
const VOLUME_WEIGHT: f64 = 4.0;

/// Steps in which the largest capacity is counted.
const RESOLUTION: f64 = 1e12;

/// What is settled about the side of a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Side {
    Ingress,
    Egress,
    /// Cut by the grazing set.
    Both,
    /// To be chosen.
    Free,
}

/// Gives every free face its side.
///
/// `flux`: at the corners of each face. `depth`: of the layer that may be lost.
pub(super) fn part(
    mesh: &Mesh,
    positions: &[DVec3],
    generator: &Generator,
    flux: &[[f64; 3]],
    depth: f64,
    sides: &mut [Side],
) {
    let mut network = Network::default();
    let nodes: Vec<Option<NodeIndex>> = sides
        .iter()
        .map(|side| (*side == Side::Free).then(|| network.graph.add_node(())))
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
        network.to_egress.push((*node, volume(1.0)));
        network.to_ingress.push((*node, volume(-1.0)));
    }
    for edge in mesh.edges() {
        let ends = edge.vertices.map(|v| positions[v as usize]);
        let velocity = generator.velocity(0.5 * (ends[0] + ends[1]));
        let direction = ends[1] - ends[0];
        let weight = direction.cross(velocity).length()
            + LEAST_WEIGHT * direction.length() * velocity.length();
        match edge.faces.map(|face| nodes[face as usize]) {
            [Some(first), Some(second)] => network.between.push((first, second, weight)),
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
            *side = if egress[node.index()] {
                Side::Egress
            } else {
                Side::Ingress
            };
        }
    }
}

/// How much of an edge borders on the egress part of a settled face.
fn egress_share(sides: &[Side], flux: &[[f64; 3]], mesh: &Mesh, face: u32, ends: [u32; 2]) -> f64 {
    match sides[face as usize] {
        Side::Egress => 1.0,
        Side::Ingress | Side::Free => 0.0,
        Side::Both => positive_share(flux[face as usize], mesh.triangles()[face as usize], ends),
    }
}

/// Share of a side, given by its ends, on which values at the corners of its triangle are not negative.
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

/// A cut problem between egress and ingress.
#[derive(Default)]
struct Network {
    graph: Graph<(), u64>,
    to_egress: Vec<(NodeIndex, f64)>,
    to_ingress: Vec<(NodeIndex, f64)>,
    between: Vec<(NodeIndex, NodeIndex, f64)>,
}

impl Network {
    fn beside(&mut self, node: NodeIndex, egress_share: f64, weight: f64) {
        self.to_egress.push((node, weight * egress_share));
        self.to_ingress.push((node, weight * (1.0 - egress_share)));
    }

    /// Which nodes lie on the side of egress of a minimum cut.
    fn egress(mut self) -> Vec<bool> {
        let count = self.graph.node_count();
        let mut ends = [vec![0.0; count], vec![0.0; count]];
        for (end, arcs) in ends.iter_mut().zip([&self.to_egress, &self.to_ingress]) {
            arcs.iter()
                .for_each(|(node, weight)| end[node.index()] += weight);
        }
        let largest = ends
            .iter()
            .flatten()
            .copied()
            .chain(self.between.iter().map(|arc| arc.2))
            .fold(f64::MIN_POSITIVE, f64::max);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "between 0 and the resolution"
        )]
        let capacity = |weight: f64| (weight / largest * RESOLUTION) as u64;
        let [source, sink] = [self.graph.add_node(()), self.graph.add_node(())];
        for node in 0..count {
            // What both ends could carry passes through and decides nothing.
            let [egress, ingress] = [&ends[0], &ends[1]].map(|end| capacity(end[node]));
            let common = egress.min(ingress);
            let node = NodeIndex::new(node);
            if egress > common {
                self.graph.add_edge(source, node, egress - common);
            } else if ingress > common {
                self.graph.add_edge(node, sink, ingress - common);
            }
        }
        for (first, second, weight) in &self.between {
            self.graph.add_edge(*first, *second, capacity(*weight));
            self.graph.add_edge(*second, *first, capacity(*weight));
        }
        let (_, flows) = dinics(&self.graph, source, sink);
        let mut reached = vec![false; self.graph.node_count()];
        reached[source.index()] = true;
        let mut queue = VecDeque::from([source]);
        while let Some(node) = queue.pop_front() {
            let leaving = self
                .graph
                .edges(node)
                .filter(|arc| flows[arc.id().index()] < *arc.weight())
                .map(|arc| arc.target());
            let entering = self
                .graph
                .edges_directed(node, petgraph::Direction::Incoming)
                .filter(|arc| flows[arc.id().index()] > 0)
                .map(|arc| arc.source());
            let next: Vec<NodeIndex> = leaving.chain(entering).collect();
            for node in next {
                if !reached[node.index()] {
                    reached[node.index()] = true;
                    queue.push_back(node);
                }
            }
        }
        reached.truncate(count);
        reached
    }
}
