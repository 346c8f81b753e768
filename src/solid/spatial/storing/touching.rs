//! Where two parts of a boundary meet along an edge between two vertices that both have, a point is
//! inserted into the edge of one of them. Then no two edges of the boundary have the same ends, and
//! no vertex has moved. Where the edge is so short that the point would be stored at the place of
//! an existing vertex, the point moves into the solid next to the edge.

use super::joining::{Places, Precision};
use crate::numeric::index;
use crate::surface::{Sides, edges, pairs_around};
use crate::watch::{Interrupted, Work};
use glam::DVec3;
use std::collections::HashMap;

/// Most rounds of dividing edges. One round more than the boundary folds back on itself at an edge
/// is enough; more than a few folds at one place do not occur.
const ROUNDS: usize = 8;

/// The result of the separation.
#[derive(Debug, Default)]
pub(crate) struct Separated {
    /// Bound on the distance of a point of the surface from where it was: new points lie beside
    /// their edges, one round after the other.
    pub(crate) largest_move: f64,
    /// The dropped triangles.
    pub(crate) films: Vec<[DVec3; 3]>,
}

/// Drops pairs of triangles that lie back to back, and divides edges with more than two triangles.
///
/// - `positions`: as stored in `precision`, as are those of new points.
pub(crate) fn separate(
    positions: &mut Vec<DVec3>,
    triangles: &mut Vec<[u32; 3]>,
    precision: Precision,
    work: Work,
) -> Result<Separated, Interrupted> {
    let mut separated = Separated::default();
    let mut places = None;
    for _ in 0..ROUNDS {
        work.check()?;
        let mut farthest: f64 = 0.0;
        let films = drop_back_to_back(triangles);
        let at = films.iter().map(|film| film.map(|v| positions[v as usize]));
        separated.films.extend(at);
        let shared = shared_edges(triangles);
        if shared.is_empty() {
            break;
        }
        let places = places.get_or_insert_with(|| Places::taken_by(positions, precision));
        for edge in shared {
            work.check()?;
            let halves = halves_along(triangles, edge);
            let pairs = pairs_around(positions, triangles, edge, &halves);
            let count = pairs.len();
            for (number, pair) in pairs.into_iter().enumerate().skip(1) {
                let pair = pair.map(|half| half / 3);
                let [a, b] = edge.map(|v| positions[v as usize]);
                let middle = index(positions.len());
                // Of n pairs, number k gets its point at k / n: that of the second of two is in the
                // middle.
                let on_edge = a.lerp(b, number as f64 / count as f64);
                let area = |triangle: u32| {
                    let [a, b, c] = triangles[triangle as usize].map(|v| positions[v as usize]);
                    (b - a).cross(c - a)
                };
                let inwards = -(area(pair[0]) + area(pair[1]));
                let stored = places.take(on_edge, inwards, positions);
                farthest = farthest.max(stored.distance(on_edge));
                positions.push(stored);
                pair.into_iter()
                    .for_each(|triangle| divide(triangles, triangle as usize, edge, middle));
            }
        }
        separated.largest_move += farthest;
    }
    work.done();
    Ok(separated)
}

/// The edges with more than two triangles, ascending.
fn shared_edges(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let sides = Sides::new(triangles);
    let shared = sides.edges().filter(|edge| edge.len() > 2);
    shared.map(|edge| edge.ends).collect()
}

/// The half-edges along an edge, in either sense, ascending. They are searched for, since triangles
/// are divided all the time.
fn halves_along(triangles: &[[u32; 3]], [a, b]: [u32; 2]) -> Vec<u32> {
    (0..)
        .zip(triangles.iter().flat_map(edges))
        .filter(|&(_, ends)| ends == [a, b] || ends == [b, a])
        .map(|(half, _)| half)
        .collect()
}

/// Drops pairs of triangles with the same corners in opposite senses, which enclose nothing, and
/// returns the dropped triangles.
fn drop_back_to_back(triangles: &mut Vec<[u32; 3]>) -> Vec<[u32; 3]> {
    // The corners from the smallest on, and the sense in which the others follow.
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
    let mut dropped = Vec::new();
    triangles.retain(|triangle| {
        let (corners, sense) = key(triangle);
        let left = balance.entry(corners).or_default();
        let keeps = *left * sense > 0;
        *left -= if keeps { sense } else { 0 };
        if !keeps {
            dropped.push(*triangle);
        }
        keeps
    });
    dropped
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
    use crate::samples::wedges;

    fn assert_manifold(triangles: &[[u32; 3]]) {
        let mut count = HashMap::<[u32; 2], i32>::new();
        for [a, b] in triangles.iter().flat_map(edges) {
            *count.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { 100 };
        }
        assert!(
            count.values().all(|n| *n == 101),
            "every edge runs once each way: {count:?}"
        );
    }

    /// Between its ends there is no 32-bit number, or one that is taken.
    #[test]
    fn a_point_on_a_very_short_edge_is_stored_beside_it() {
        let unit = f64::from(f32::EPSILON);
        for (height, is_taken) in [(unit, false), (2.0 * unit, true)] {
            let mut positions = vec![
                DVec3::new(1.0, 1.0, 1.0),
                DVec3::new(1.0, 1.0, 1.0 + height),
                DVec3::new(2.0, 1.25, 1.5),
                DVec3::new(2.0, 0.75, 1.5),
                DVec3::new(0.0, 0.75, 1.5),
                DVec3::new(0.0, 1.25, 1.5),
            ];
            if is_taken {
                positions.push(DVec3::new(1.0, 1.0, 1.0 + unit));
            }
            let vertices = positions.len();
            let wedge = |p: u32, q: u32| [[0, 1, p], [1, 0, q], [0, p, q], [1, q, p]];
            let mut triangles: Vec<[u32; 3]> = wedge(2, 3).into_iter().chain(wedge(4, 5)).collect();
            let moved = separate(
                &mut positions,
                &mut triangles,
                Precision::Single,
                Work::UNWATCHED,
            )
            .expect("nobody stops it")
            .largest_move;
            assert_eq!(positions.len(), vertices + 1, "one new point");
            let place = positions[vertices];
            assert_eq!(
                Precision::Single.round(place),
                place,
                "it is stored as it is"
            );
            assert!(
                !positions[..vertices].contains(&place),
                "no vertex is there"
            );
            // One and a half times the weld distance (2e-9 of the diagonal) or the rounding, plus
            // the rounding itself.
            assert!(moved > 0.0 && moved < 3.0 * unit, "beside it: {moved:e}");
            assert_manifold(&triangles);
        }
    }

    #[test]
    fn two_wedges_on_one_edge_get_edges_of_their_own() {
        let (mut positions, mut triangles) = wedges();
        let moved = separate(
            &mut positions,
            &mut triangles,
            Precision::Double,
            Work::UNWATCHED,
        )
        .expect("nobody stops it")
        .largest_move;
        assert_eq!(positions.len(), 7, "one new point");
        assert_eq!(moved, 0.0, "in the middle of the edge");
        assert_manifold(&triangles);
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
