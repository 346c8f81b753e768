//! Where two parts of a boundary meet along an edge between two vertices of both, a point is put on the edge of one of
//! them: then no two edges of the boundary have the same ends, and no point has moved.

use super::shells::edges;
use crate::numeric::index;
use glam::DVec3;
use std::collections::HashMap;

/// How often edges are divided. One that is divided once more than the boundary folds back on itself there is enough; more than
/// a few folds at one place do not occur.
const ROUNDS: usize = 8;

/// Drops pairs of triangles that lie back to back, and divides edges that have more than two triangles.
pub(super) fn separate(positions: &mut Vec<DVec3>, triangles: &mut Vec<[u32; 3]>) {
    for _ in 0..ROUNDS {
        drop_back_to_back(triangles);
        let shared = shared_edges(triangles);
        if shared.is_empty() {
            return;
        }
        for edge in shared {
            let pairs = pairs_around(positions, triangles, edge);
            let count = pairs.len();
            for (number, pair) in pairs.into_iter().enumerate().skip(1) {
                let [a, b] = edge.map(|v| positions[v as usize]);
                let middle = index(positions.len());
                // Of n pairs, the k-th gets its point at k / n: that of the second of two is in the middle.
                positions.push(a.lerp(b, number as f64 / count as f64));
                pair.into_iter()
                    .for_each(|triangle| divide(triangles, triangle as usize, edge, middle));
            }
        }
    }
}

/// Edges with more than two triangles, ascending.
fn shared_edges(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let mut count = HashMap::<[u32; 2], u32>::with_capacity(triangles.len() * 3 / 2);
    for [a, b] in triangles.iter().flat_map(edges) {
        *count.entry([a.min(b), a.max(b)]).or_default() += 1;
    }
    let mut shared: Vec<[u32; 2]> = count
        .into_iter()
        .filter(|(_, n)| *n > 2)
        .map(|(edge, _)| edge)
        .collect();
    shared.sort_unstable();
    shared
}

/// Two triangles with the same corners in opposite senses enclose nothing.
fn drop_back_to_back(triangles: &mut Vec<[u32; 3]>) {
    // Corners from the smallest on, and the sense in which the others follow.
    let key = |t: &[u32; 3]| {
        let first = (0..3).min_by_key(|&i| t[i]).unwrap_or(0);
        let [a, b, c] = [0, 1, 2].map(|i| t[(first + i) % 3]);
        ([a, b.min(c), b.max(c)], if b < c { 1 } else { -1 })
    };
    let mut balance = HashMap::<[u32; 3], i32>::with_capacity(triangles.len());
    for triangle in triangles.iter() {
        let (corners, sense) = key(triangle);
        *balance.entry(corners).or_default() += sense;
    }
    triangles.retain(|triangle| {
        let (corners, sense) = key(triangle);
        let left = balance.entry(corners).or_default();
        let keeps = *left * sense > 0;
        *left -= if keeps { sense } else { 0 };
        keeps
    });
}

/// The triangles round an edge in pairs that enclose solid, in a fixed order.
pub(super) fn pairs_around(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    [a, b]: [u32; 2],
) -> Vec<[u32; 2]> {
    let around: Vec<(u32, [u32; 3])> = (0..)
        .zip(triangles)
        .filter(|(_, t)| t.contains(&a) && t.contains(&b))
        .map(|(i, t)| (i, *t))
        .collect();
    let along = (positions[b as usize] - positions[a as usize]).normalize_or_zero();
    let across = |t: &[u32; 3]| {
        let apex = t
            .iter()
            .find(|&&v| v != a && v != b)
            .map_or(DVec3::ZERO, |&v| positions[v as usize]);
        (apex - positions[a as usize]).reject_from(along)
    };
    let start = across(&around[0].1);
    let side = along.cross(start);
    let mut sorted: Vec<(f64, u32, bool)> = around
        .iter()
        .map(|(number, t)| {
            let way = across(t);
            let runs_along = edges(t).contains(&[a, b]);
            (way.dot(side).atan2(way.dot(start)), *number, runs_along)
        })
        .collect();
    sorted.sort_by(|p, q| p.0.total_cmp(&q.0));
    // Seen along the edge the outside of a triangle that runs along it is counter-clockwise of it, so the solid ends at the
    // triangle clockwise of it.
    let n = sorted.len();
    let before = |i: usize| &sorted[(i + n - 1) % n];
    if (0..n).all(|i| sorted[i].2 != before(i).2) {
        return (0..n)
            .filter(|&i| sorted[i].2)
            .map(|i| [sorted[i].1, before(i).1])
            .collect();
    }
    // Triangles on each other: any pairs of opposite sense keep the surface closed.
    let of_sense = |sense: bool| sorted.iter().filter(move |t| t.2 == sense).map(|t| t.1);
    of_sense(true)
        .zip(of_sense(false))
        .map(|(there, back)| [there, back])
        .collect()
}

/// Divides a triangle at a new vertex on one of its edges.
fn divide(triangles: &mut Vec<[u32; 3]>, triangle: usize, [a, b]: [u32; 2], middle: u32) {
    let corners = triangles[triangle];
    let Some(side) = edges(&corners)
        .iter()
        .position(|e| *e == [a, b] || *e == [b, a])
    else {
        return;
    };
    let [from, to, apex] = [0, 1, 2].map(|i| corners[(side + i) % 3]);
    triangles[triangle] = [from, middle, apex];
    triangles.push([middle, to, apex]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_wedges_on_one_edge_get_edges_of_their_own() {
        // Two tetrahedra on the edge 0 1, opposite each other, outward.
        let mut positions = vec![
            DVec3::ZERO,
            DVec3::Z,
            DVec3::new(1.0, 0.2, 0.5),
            DVec3::new(1.0, -0.2, 0.5),
            DVec3::new(-1.0, -0.2, 0.5),
            DVec3::new(-1.0, 0.2, 0.5),
        ];
        let wedge = |p: u32, q: u32| [[0, 1, p], [1, 0, q], [0, p, q], [1, q, p]];
        let mut triangles: Vec<[u32; 3]> = wedge(2, 3).into_iter().chain(wedge(4, 5)).collect();
        separate(&mut positions, &mut triangles);
        assert_eq!(positions.len(), 7, "one new point");
        let mut count = HashMap::<[u32; 2], i32>::new();
        for [a, b] in triangles.iter().flat_map(edges) {
            *count.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { 100 };
        }
        assert!(
            count.values().all(|n| *n == 101),
            "every edge runs once each way: {count:?}"
        );
        let mates: Vec<&[u32; 3]> = triangles
            .iter()
            .filter(|t| t.contains(&0) && t.contains(&1))
            .collect();
        let apexes: Vec<bool> = mates
            .iter()
            .map(|t| t.iter().any(|&v| v == 2 || v == 3))
            .collect();
        assert!(
            apexes == [true, true] || apexes == [false, false],
            "a wedge keeps both its faces: {mates:?}"
        );
    }
}
