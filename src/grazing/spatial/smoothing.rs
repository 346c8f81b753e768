//! The boundary of the egress region, drawn across the faces where it is free, instead of along
//! their edges.
//!
//! On a body that slides along itself, such as a ball that spins and rises slowly, any boundary
//! along edges zigzags, and the sheets of the zigzag lie on each other, closer than their sampling
//! error. A boundary that follows the motion sweeps next to nothing.

use super::following::Following;
use super::parting::{FaceSide, positive_share};
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
pub(super) fn smoothed(
    body: &Following,
    bound: &[FaceSide],
    sides: &[FaceSide],
) -> Vec<Option<Levels>> {
    let triangles = body.mesh.triangles();
    let mut loose = vec![true; body.positions.len()];
    let mut sum = vec![(0.0, 0.0); body.positions.len()];
    for (face, triangle) in triangles.iter().enumerate() {
        let side = if sides[face] == FaceSide::Egress {
            1.0
        } else {
            -1.0
        };
        for &vertex in triangle {
            loose[vertex as usize] &= bound[face] == FaceSide::Free;
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
fn area(body: &Following, sides: &[FaceSide], levels: &[Option<Levels>]) -> f64 {
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
                (FaceSide::Egress, None) => Some(1.0),
                (FaceSide::Ingress | FaceSide::Free, None) => Some(0.0),
                (FaceSide::Both, None) => None,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::Mesh;
    use crate::motion::Generator;
    use crate::samples::{cuboid, drum};

    fn normals(mesh: &Mesh) -> Vec<DVec3> {
        let normal = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|v| mesh.positions()[v as usize]);
            (b - a).cross(c - a).normalize()
        };
        mesh.triangles().iter().map(normal).collect()
    }

    fn following<'a>(
        mesh: &'a Mesh,
        normals: &'a [DVec3],
        generator: &'a Generator,
    ) -> Following<'a> {
        Following {
            mesh,
            positions: mesh.positions(),
            normals,
            generator,
        }
    }

    #[test]
    fn a_boundary_sweeps_its_length_times_the_speed_across_it() {
        let (positions, triangles) = cuboid(DVec3::ZERO, DVec3::ONE);
        let mesh = Mesh::new(positions, triangles).expect("a cube is a body");
        let normals = normals(&mesh);
        let sides: Vec<FaceSide> = normals
            .iter()
            .map(|normal| {
                if normal.x > 0.5 {
                    FaceSide::Egress
                } else {
                    FaceSide::Ingress
                }
            })
            .collect();
        let half_way =
            |triangle: &[u32; 3]| Some(triangle.map(|v| mesh.positions()[v as usize].x - 0.5));
        let levels: Vec<Option<Levels>> = mesh.triangles().iter().map(half_way).collect();
        for (velocity, expected) in [
            // All four sides of the square are perpendicular to x, two of them to y or z.
            (DVec3::X, 4.0),
            (DVec3::Y, 2.0),
            (DVec3::Z, 2.0),
            (DVec3::ZERO, 0.0),
        ] {
            let generator = Generator::translation(velocity);
            let body = following(&mesh, &normals, &generator);
            // Along the edges of the face at x = 1, and across the faces at x = 1/2.
            let along_edges = area(&body, &sides, &[None; 12]);
            let across_faces = area(&body, &sides, &levels);
            assert!((along_edges - expected).abs() < 1e-14, "{along_edges}");
            assert!((across_faces - expected).abs() < 1e-14, "{across_faces}");
        }
    }

    #[test]
    fn a_zigzag_round_a_spinning_body_becomes_a_circle() {
        // In the middle one of five rings, the facets alternate; above it all leave, below it all
        // enter.
        let (facets, rings) = (8, 5);
        let mesh = drum(facets, rings);
        let normals = normals(&mesh);
        let height = |triangle: &[u32; 3]| -> f64 {
            let sum: f64 = triangle
                .map(|v| mesh.positions()[v as usize].z)
                .iter()
                .sum();
            sum / 3.0
        };
        let facet = |triangle: &[u32; 3]| {
            let sum: DVec3 = triangle.map(|v| mesh.positions()[v as usize]).iter().sum();
            let turn = sum.y.atan2(sum.x).rem_euclid(std::f64::consts::TAU);
            (turn / std::f64::consts::TAU * f64::from(facets)).floor() % 2.0 == 0.0
        };
        let sides: Vec<FaceSide> = mesh
            .triangles()
            .iter()
            .map(|triangle| {
                let height = height(triangle);
                let leaves = if height.abs() < 0.2 {
                    facet(triangle)
                } else {
                    height > 0.0
                };
                if leaves {
                    FaceSide::Egress
                } else {
                    FaceSide::Ingress
                }
            })
            .collect();
        let generator = Generator::screw(DVec3::Z, DVec3::ZERO, 1.0, 0.0, 1.0);
        let body = following(&mesh, &normals, &generator);
        let free = vec![FaceSide::Free; sides.len()];
        let levels = smoothed(&body, &free, &sides);
        // The zigzag runs along each of the upright edges of its ring. A circle would move along
        // itself.
        let zigzag = area(&body, &sides, &vec![None; sides.len()]);
        assert!(zigzag > 2.0, "{zigzag}");
        assert!(area(&body, &sides, &levels) < WORTH * zigzag);
        for (triangle, levels) in mesh.triangles().iter().zip(&levels) {
            let levels = levels.expect("all faces are free");
            for (&vertex, level) in triangle.iter().zip(levels) {
                let z = mesh.positions()[vertex as usize].z;
                assert!(
                    z.abs() < 0.3 || level * z > 0.0,
                    "{level} at a height of {z}"
                );
            }
        }
    }

    #[test]
    fn faces_beside_bound_ones_keep_their_edges() {
        let (positions, triangles) = cuboid(DVec3::ZERO, DVec3::ONE);
        let mesh = Mesh::new(positions, triangles).expect("a cube is a body");
        let normals = normals(&mesh);
        let generator = Generator::screw(DVec3::Z, DVec3::ZERO, 1.0, 0.0, 1.0);
        let body = following(&mesh, &normals, &generator);
        // These three faces have all corners but one, so every face has a corner of a bound face.
        let mut bound = vec![FaceSide::Free; 12];
        bound[0] = FaceSide::Egress;
        bound[2] = FaceSide::Egress;
        bound[3] = FaceSide::Egress;
        let sides: Vec<FaceSide> = (0..12)
            .map(|face| {
                if face % 2 == 0 {
                    FaceSide::Egress
                } else {
                    FaceSide::Ingress
                }
            })
            .collect();
        assert_eq!(smoothed(&body, &bound, &sides), vec![None; 12]);
    }
}
