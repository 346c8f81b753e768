//! The boundary of the egress region, drawn across the faces where it is free, instead of along
//! their edges.
//!
//! On a body that slides along itself, such as a ball that spins and rises slowly, any boundary
//! along edges zigzags, and the sheets of the zigzag lie on each other, closer than their sampling
//! error. A boundary that follows the motion sweeps next to nothing.

use super::following::Following;
use super::parting::{Side, positive_share};
use glam::DVec3;

/// Values at the corners of a face: positive in the egress region.
pub(super) type Levels = [f64; 3];

/// How often each vertex moves halfway to the mean of its neighbours: the boundary moves by a few
/// faces at most.
const SMOOTHINGS: usize = 24;

/// Largest share of the previously swept area that may remain for it to be worth cutting faces.
const WORTH: f64 = 0.5;

/// Values at the corners of the faces that take part, which are those with only free faces around:
/// 1 and -1 on the two sides, smoothed in between. `None` where a boundary along edges does as
/// well.
pub(super) fn smoothed(body: &Following, bound: &[Side], sides: &[Side]) -> Vec<Option<Levels>> {
    let triangles = body.mesh.triangles();
    let mut loose = vec![true; body.positions.len()];
    let mut sum = vec![(0.0, 0.0); body.positions.len()];
    for (face, triangle) in triangles.iter().enumerate() {
        let side = if sides[face] == Side::Egress {
            1.0
        } else {
            -1.0
        };
        for &vertex in triangle {
            loose[vertex as usize] &= bound[face] == Side::Free;
            sum[vertex as usize].0 += side;
            sum[vertex as usize].1 += 1.0;
        }
    }
    let mut level: Vec<f64> = sum.iter().map(|(sum, count)| sum / count).collect();
    for _ in 0..SMOOTHINGS {
        sum.iter_mut().for_each(|sum| *sum = (0.0, 0.0));
        for edge in body.mesh.edges() {
            let [a, b] = edge.vertices.map(|v| v as usize);
            for (here, there) in [(a, b), (b, a)] {
                sum[here].0 += level[there];
                sum[here].1 += 1.0;
            }
        }
        for ((level, (sum, count)), loose) in level.iter_mut().zip(&sum).zip(&loose) {
            if *loose {
                *level = 0.5 * *level + 0.5 * sum / count;
            }
        }
    }
    let levels: Vec<Option<Levels>> = triangles
        .iter()
        .map(|triangle| {
            let takes_part = triangle.iter().all(|&v| loose[v as usize]);
            takes_part.then(|| triangle.map(|v| level[v as usize]))
        })
        .collect();
    let straight = vec![None; triangles.len()];
    if area(body, sides, &levels) < WORTH * area(body, sides, &straight) {
        levels
    } else {
        straight
    }
}

/// The rate at which the boundary sweeps area, without that of faces cut by their flux, which does
/// not change.
fn area(body: &Following, sides: &[Side], levels: &[Option<Levels>]) -> f64 {
    let rate = |from: DVec3, to: DVec3| {
        let velocity = body.generator.velocity(from.midpoint(to));
        (to - from).cross(velocity).length()
    };
    let across = levels
        .iter()
        .zip(body.mesh.triangles())
        .map(|(levels, triangle)| {
            let Some(levels) = levels else { return 0.0 };
            let crossing = |i: usize| {
                let [a, b] = [i, (i + 1) % 3];
                ((levels[a] >= 0.0) != (levels[b] >= 0.0)).then(|| {
                    let [p, q] = [a, b].map(|corner| body.positions[triangle[corner] as usize]);
                    p.lerp(q, levels[a] / (levels[a] - levels[b]))
                })
            };
            let ends: Vec<DVec3> = (0..3).filter_map(crossing).collect();
            if let [from, to] = ends[..] {
                rate(from, to)
            } else {
                0.0
            }
        });
    let along = body.mesh.edges().iter().map(|edge| {
        let shares = edge.faces.map(|face| {
            let triangle = body.mesh.triangles()[face as usize];
            match (sides[face as usize], levels[face as usize]) {
                (_, Some(levels)) => Some(positive_share(levels, triangle, edge.vertices)),
                (Side::Egress, None) => Some(1.0),
                (Side::Ingress | Side::Free, None) => Some(0.0),
                (Side::Both, None) => None,
            }
        });
        let [from, to] = edge.vertices.map(|v| body.positions[v as usize]);
        if let [Some(first), Some(second)] = shares {
            (first - second).abs() * rate(from, to)
        } else {
            0.0
        }
    });
    across.chain(along).sum()
}
