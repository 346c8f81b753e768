//! Numbers and bodies that unit tests share.

use crate::body::Mesh;
use crate::bounds::box_corners;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Random numbers in [-1, 1), always the same for a seed.
pub(crate) fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut next = random_bits(seed);
    move || (next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// Random whole numbers below a limit, which is at most 2^31; always the same for a seed.
pub(crate) fn random_below(seed: u64) -> impl FnMut(u64) -> u64 {
    let mut next = random_bits(seed);
    move |limit| (next() >> 33) % limit
}

/// Knuth's linear congruential generator; the upper bits are the better ones.
fn random_bits(seed: u64) -> impl FnMut() -> u64 {
    let mut state = seed;
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        state
    }
}

/// The box between two corners. Vertex i has the coordinates of `high` where the bits of i are
/// set, x first.
pub(crate) fn cuboid(low: DVec3, high: DVec3) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let triangles = vec![
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
    (box_corners([low, high]).to_vec(), triangles)
}

/// A drum of radius 1 about the z axis, from -1 to 1, made of `rings` rings of triangles. The first
/// and the last vertex are the centres of its ends.
pub(crate) fn drum(sides: u32, rings: u32) -> Mesh {
    let mut positions = vec![DVec3::NEG_Z];
    for ring in 0..=rings {
        let z = f64::from(ring) / f64::from(rings) * 2.0 - 1.0;
        positions.extend((0..sides).map(|side| {
            let (sin, cos) = (f64::from(side) / f64::from(sides) * TAU).sin_cos();
            DVec3::new(cos, sin, z)
        }));
    }
    positions.push(DVec3::Z);
    let at = |ring: u32, side: u32| 1 + ring * sides + side % sides;
    let last = 1 + (rings + 1) * sides;
    let mut triangles = Vec::new();
    for side in 0..sides {
        triangles.push([0, at(0, side + 1), at(0, side)]);
        triangles.push([at(rings, side), at(rings, side + 1), last]);
        for ring in 0..rings {
            let [a, b] = [at(ring, side), at(ring, side + 1)];
            let [c, d] = [at(ring + 1, side), at(ring + 1, side + 1)];
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    Mesh::new(positions, triangles).expect("a drum is a body")
}

/// Two tetrahedra opposite each other on the edge 0 1, oriented outwards: faces 0 and 1, and 4
/// and 5, have this edge.
pub(crate) fn wedges() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let positions = vec![
        DVec3::ZERO,
        DVec3::Z,
        DVec3::new(1.0, 0.2, 0.5),
        DVec3::new(1.0, -0.2, 0.5),
        DVec3::new(-1.0, -0.2, 0.5),
        DVec3::new(-1.0, 0.2, 0.5),
    ];
    let wedge = |p: u32, q: u32| [[0, 1, p], [1, 0, q], [0, p, q], [1, q, p]];
    (positions, [wedge(2, 3), wedge(4, 5)].concat())
}

/// Closed loops of four corners in the plane: the corners, and the ends of the segments.
pub(crate) fn loops_of_four(loops: &[[[f64; 2]; 4]]) -> (Vec<DVec2>, Vec<[u32; 2]>) {
    let points: Vec<DVec2> = loops.concat().into_iter().map(DVec2::from_array).collect();
    let count = u32::try_from(points.len()).expect("few");
    let ends = (0..count).map(|i| [i, i / 4 * 4 + (i + 1) % 4]);
    (points, ends.collect())
}
