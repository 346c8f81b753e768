//! Where a region touches itself along an edge, the two parts of its boundary are told apart for every reader.
//!
//! Such an edge has four triangles (or more) for a reader who joins equal positions, though the boundary is a manifold with
//! two edges that happen to lie on each other. All but one of these get a point in their middle: then no two edges of the
//! boundary have the same ends, and no point has moved.

use super::shells::edges;
use crate::numeric::index;
use glam::DVec3;
use std::collections::{BTreeMap, HashMap};

/// Divides edges that lie on each other, and tells how many there were.
///
/// Every edge has two triangles, by indices.
pub(super) fn separate(positions: &mut Vec<DVec3>, triangles: &mut Vec<[u32; 3]>) -> usize {
    let copies = coincident_edges(positions, triangles);
    for copies in &copies {
        let count = copies.len();
        for (number, edge) in copies.iter().enumerate().skip(1) {
            let [a, b] = edge.map(|v| positions[v as usize]);
            // Copies get different points: of n, the k-th at k / n (the second of two in the middle).
            let middle = index(positions.len());
            positions.push(a.lerp(b, number as f64 / count as f64));
            divide(triangles, *edge, middle);
        }
    }
    copies.len()
}

/// The edges (by indices, ascending) that have an edge of the same positions beside them, grouped by position, in a fixed order.
fn coincident_edges(positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<Vec<[u32; 2]>> {
    let mut first_at = HashMap::<[u64; 3], u32>::with_capacity(positions.len());
    let place: Vec<u32> = positions
        .iter()
        .zip(0..)
        .map(|(p, v)| {
            *first_at
                .entry((*p + DVec3::ZERO).to_array().map(f64::to_bits))
                .or_insert(v)
        })
        .collect();
    // Only edges between vertices that share their positions with others can lie on each other.
    let mut shared = vec![false; positions.len()];
    for (v, &p) in place.iter().enumerate() {
        if p as usize != v {
            shared[v] = true;
            shared[p as usize] = true;
        }
    }
    let mut groups = BTreeMap::<[u32; 2], Vec<[u32; 2]>>::new();
    for [a, b] in triangles.iter().flat_map(edges) {
        if a < b && (shared[a as usize] || shared[b as usize]) {
            let ends = [place[a as usize], place[b as usize]];
            groups
                .entry([ends[0].min(ends[1]), ends[0].max(ends[1])])
                .or_default()
                .push([a, b]);
        }
    }
    groups
        .into_values()
        .filter(|copies| copies.len() > 1)
        .collect()
}

/// Divides an edge and its two triangles at a new vertex.
fn divide(triangles: &mut Vec<[u32; 3]>, [a, b]: [u32; 2], middle: u32) {
    for number in 0..triangles.len() {
        let triangle = triangles[number];
        let Some(side) = edges(&triangle)
            .iter()
            .position(|e| *e == [a, b] || *e == [b, a])
        else {
            continue;
        };
        let [from, to, across] = [0, 1, 2].map(|i| triangle[(side + i) % 3]);
        triangles[number] = [from, middle, across];
        triangles.push([middle, to, across]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_boxes_that_share_an_edge_are_a_manifold_for_every_reader() {
        let corner = |i: u32, at: DVec3| {
            at + DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2))
        };
        let faces: [[u32; 3]; 12] = [
            [0, 2, 1],
            [1, 2, 3],
            [4, 5, 6],
            [5, 7, 6],
            [0, 1, 4],
            [1, 5, 4],
            [2, 6, 3],
            [3, 6, 7],
            [0, 4, 2],
            [2, 4, 6],
            [1, 3, 5],
            [3, 7, 5],
        ];
        let mut positions: Vec<DVec3> = (0..8).map(|i| corner(i, DVec3::ZERO)).collect();
        positions.extend((0..8).map(|i| corner(i, DVec3::new(1.0, 1.0, 0.0))));
        let mut triangles = faces.to_vec();
        triangles.extend(faces.map(|t| t.map(|v| v + 8)));
        assert_eq!(
            separate(&mut positions, &mut triangles),
            1,
            "the common vertical edge"
        );
        assert_eq!(triangles.len(), 26, "two triangles became four");
        assert_eq!(
            coincident_edges(&positions, &triangles).len(),
            0,
            "none is left"
        );
    }
}
