//! Chooses the signs of the faces with shallow folds.
//!
//! A face may take one sign, against its flux, where only a thin layer is lost by that. The sign of
//! the mean flux would follow the exact set most closely. But on a tessellated body that slides
//! along itself (a ball that turns about its own axis) this sign is noise, and the boundary would
//! run around every other face, in sheets closer to each other than their sampling error. So the
//! free faces first take the sides of least swept area (`parting`). Then every wrong sign is
//! followed to the place where it is made good (`following`). Faces that lose more than the limit
//! are bound to their own sign, and the rest choose again.

use super::following::Following;
use super::parting::{FaceSide, part};
use super::smoothing::{Levels, smoothed};
use crate::grazing::flux::is_mixed;
use crate::numeric::index;
use crate::watch::{Interrupted, Work};
use glam::DVec3;
use rayon::prelude::*;

/// Number of times that the faces choose again; after that, faces that lose too much are only bound
/// to their signs.
const ROUNDS: usize = 12;

/// Start of the paths that are followed: this share of the distance from the middle of a face to
/// its corner. At the corner itself a path has no face.
const NEAR_CORNER: f64 = 0.9;

/// Factor by which the layers at the corners are deeper than at those places: 1 / 0.9 where the
/// flux is linear, and some more for curved paths.
const AT_CORNER: f64 = 1.15;

/// The sides that the faces took.
#[derive(Debug, Clone)]
pub(super) struct ChosenSides {
    /// The side of each face.
    pub(super) sides: Vec<FaceSide>,
    /// Per face that the smoothed boundary cuts, a value at each corner, whose sign counts instead.
    pub(super) levels: Vec<Option<Levels>>,
}

impl ChosenSides {
    /// Whether the flux counts with the given sign at a point of a face.
    fn counts(&self, body: &Following, face: u32, point: DVec3, entering: bool) -> bool {
        match (self.sides[face as usize], self.levels[face as usize]) {
            (FaceSide::Both, _) => true,
            (_, Some(levels)) => (body.interpolated(face, levels, point) >= 0.0) == entering,
            (FaceSide::Egress, None) => entering,
            (FaceSide::Ingress | FaceSide::Free, None) => !entering,
        }
    }
}

/// Lets all free faces choose, and binds those that lose a layer deeper than `limit` to their flux.
/// Returns the signs, and an estimate of the depth of the deepest layer that is lost.
///
/// - `flux`: the flux at the corners of each face. `thinness`: per face, the distance by which a
///   layer reaches beyond the rest of the body, relative to its depth.
pub(super) fn settle(
    body: &Following,
    flux: &[[f64; 3]],
    thinness: &[f64],
    limit: f64,
    mut sides: Vec<FaceSide>,
    work: Work,
) -> Result<(ChosenSides, f64), Interrupted> {
    bind_plain_patches(body, flux, &mut sides);
    let free: Vec<u32> = (0..index(sides.len()))
        .filter(|&face| sides[face as usize] == FaceSide::Free)
        .collect();
    let mut bound = sides.clone();
    let mut signs = ChosenSides {
        levels: vec![None; sides.len()],
        sides,
    };
    if free.is_empty() {
        return Ok((signs, 0.0));
    }
    for round in 0.. {
        if round < ROUNDS {
            signs.sides.copy_from_slice(&bound);
            part(
                body.mesh,
                body.positions,
                body.generator,
                flux,
                limit,
                &mut signs.sides,
                work,
            )?;
            signs.levels = smoothed(body, &bound, &signs.sides);
        } else {
            for (face, bound) in bound.iter().enumerate() {
                if *bound != FaceSide::Free {
                    signs.sides[face] = *bound;
                    signs.levels[face] = None;
                }
            }
        }
        let losses: Vec<[f64; 2]> = free
            .par_iter()
            .map(|&face| {
                work.check()?;
                Ok(losses(body, flux, thinness, limit, &signs, face))
            })
            .collect::<Result<_, Interrupted>>()?;
        let mut deepest = 0.0_f64;
        let mut settled = true;
        for (&face, losses) in free.iter().zip(losses) {
            let bound = &mut bound[face as usize];
            for (loss, own) in losses
                .into_iter()
                .zip([FaceSide::Egress, FaceSide::Ingress])
            {
                if loss > limit {
                    settled = false;
                    *bound = if *bound == FaceSide::Free || *bound == own {
                        own
                    } else {
                        FaceSide::Both
                    };
                } else {
                    deepest = deepest.max(loss);
                }
            }
        }
        if settled {
            return Ok((signs, deepest));
        }
    }
    unreachable!("every round binds a face, and none more than twice")
}

/// Binds the faces of patches without a face of mixed flux to their signs: such patches do not
/// fold, and under a motion along straight lines their result is exact.
fn bind_plain_patches(body: &Following, flux: &[[f64; 3]], sides: &mut [FaceSide]) {
    let mut seen = vec![false; sides.len()];
    for start in 0..sides.len() {
        if seen[start] || sides[start] != FaceSide::Free {
            continue;
        }
        seen[start] = true;
        let mut patch = vec![index(start)];
        let mut next = 0;
        while next < patch.len() {
            for edge in body.mesh.face_edges()[patch[next] as usize] {
                for face in body.mesh.edges()[edge as usize].faces {
                    if !seen[face as usize] && sides[face as usize] == FaceSide::Free {
                        seen[face as usize] = true;
                        patch.push(face);
                    }
                }
            }
            next += 1;
        }
        if !patch.iter().any(|&face| is_mixed(&flux[face as usize])) {
            for face in patch {
                let leaves = flux[face as usize].iter().all(|&g| g >= 0.0);
                sides[face as usize] = if leaves {
                    FaceSide::Egress
                } else {
                    FaceSide::Ingress
                };
            }
        }
    }
}

/// The depths of the layers that are lost because entering places of a face, and leaving ones, have
/// the wrong sign.
fn losses(
    body: &Following,
    flux: &[[f64; 3]],
    thinness: &[f64],
    limit: f64,
    signs: &ChosenSides,
    face: u32,
) -> [f64; 2] {
    let triangle = body.mesh.triangles()[face as usize];
    let factor = thinness[face as usize] * AT_CORNER;
    let corners = triangle.map(|v| body.positions[v as usize]);
    [true, false].map(|entering| {
        samples(&corners, &flux[face as usize], entering)
            .into_iter()
            .flatten()
            .filter(|&point| !signs.counts(body, face, point, entering))
            .map(|point| {
                let right = |face: u32, at: DVec3| signs.counts(body, face, at, entering);
                factor * body.height(face, point, entering, limit / factor, right)
            })
            .fold(0.0, f64::max)
    })
}

/// Points in the part of a face where the flux has one sign: near its corners, and in the middle.
fn samples(corners: &[DVec3; 3], flux: &[f64; 3], positive: bool) -> [Option<DVec3>; 4] {
    let flux = if positive { *flux } else { flux.map(|g| -g) };
    let (mut sum, mut count) = (DVec3::ZERO, 0.0);
    for i in 0..3 {
        let j = (i + 1) % 3;
        if flux[i] > 0.0 {
            sum += corners[i];
            count += 1.0;
        }
        if (flux[i] > 0.0) != (flux[j] > 0.0) {
            sum += corners[i].lerp(corners[j], flux[i] / (flux[i] - flux[j]));
            count += 1.0;
        }
    }
    if flux.iter().all(|&g| g <= 0.0) {
        return [None; 4];
    }
    let middle = sum / count;
    let near = |i: usize| (flux[i] > 0.0).then(|| middle.lerp(corners[i], NEAR_CORNER));
    [near(0), near(1), near(2), Some(middle)]
}

#[cfg(test)]
mod tests {
    use super::super::{GrazingSet, Simplification};
    use super::{NEAR_CORNER, samples};
    use crate::body::Mesh;
    use crate::grazing::flux::FaceFlux;
    use crate::motion::Generator;
    use crate::samples::drum;
    use crate::watch::Work;
    use glam::DVec3;
    use std::f64::consts::TAU;

    fn grazing(mesh: &Mesh, generator: &Generator, fold: f64) -> GrazingSet {
        let simplification = Simplification { fold, merge: 0.0 };
        GrazingSet::new(
            mesh,
            mesh.positions(),
            generator,
            simplification,
            Work::UNWATCHED,
        )
        .expect("nobody stops it")
    }

    fn screw(turn: f64, advance: f64) -> Generator {
        Generator::screw(DVec3::Z, DVec3::ZERO, turn, advance, 1.0)
    }

    /// Depth of the facets of a drum below its circle.
    fn sagitta(sides: u32) -> f64 {
        1.0 - (TAU / f64::from(2 * sides)).cos()
    }

    #[test]
    fn the_facets_of_a_drum_that_turns_on_the_spot_take_one_side() {
        let mesh = drum(32, 4);
        let set = grazing(&mesh, &screw(5.0, 0.0), 2.0 * sagitta(32));
        assert!(
            set.faces.iter().all(|face| *face == set.faces[0]),
            "one side for the wall and the ends, which slide in themselves"
        );
        assert!(
            set.dropped_fold >= sagitta(32) && set.dropped_fold <= 1.2 * sagitta(32),
            "a layer of a sagitta: {}",
            set.dropped_fold
        );
    }

    #[test]
    fn folds_deeper_than_the_limit_are_kept() {
        let mesh = drum(32, 4);
        let set = grazing(&mesh, &screw(5.0, 0.0), 0.5 * sagitta(32));
        let cut = set
            .faces
            .iter()
            .filter(|face| matches!(face, FaceFlux::Cut { .. }))
            .count();
        assert_eq!(cut, 32 * 4 * 2, "every facet of the wall");
        assert_eq!(set.dropped_fold, 0.0, "nothing is lost");
    }

    /// A drum whose wall tapers: it moves outwards on the lower half and inwards on the upper one.
    fn spindle(sides: u32, rings: u32) -> Mesh {
        let drum = drum(sides, rings);
        let positions = drum
            .positions()
            .iter()
            .map(|p| {
                DVec3::new(
                    p.x * (1.0 - 0.3 * p.z * p.z),
                    p.y * (1.0 - 0.3 * p.z * p.z),
                    p.z,
                )
            })
            .collect();
        Mesh::new(positions, drum.triangles().to_vec()).expect("a spindle is a body")
    }

    #[test]
    fn a_spinning_body_that_rises_keeps_its_upper_side() {
        let mesh = spindle(32, 8);
        let set = grazing(&mesh, &screw(5.0, 0.5), 2.0 * sagitta(32));
        for (face, (flux, normal)) in set.faces.iter().zip(&set.normals).enumerate() {
            // With the rise, the noise of the spin is gone: the sign is that of n.z, except next to
            // the widest ring.
            if normal.z > 0.1 {
                assert!(
                    flux.is_egress_at(0),
                    "face {face} with n.z {} rises",
                    normal.z
                );
            } else if normal.z < -0.1 {
                assert!(
                    !flux.is_egress_at(0),
                    "face {face} with n.z {} follows",
                    normal.z
                );
            }
        }
    }

    #[test]
    fn bodies_that_move_along_straight_lines_keep_all_signs() {
        let mesh = spindle(32, 8);
        for generator in [
            Generator::translation(DVec3::new(0.1, 0.02, 3.0)),
            Generator::screw(DVec3::Z, DVec3::new(0.1, 0.2, -3.0), 0.0, 0.0, 1.5),
        ] {
            assert_eq!(
                grazing(&mesh, &generator, 0.1).dropped_fold,
                0.0,
                "nothing to drop"
            );
        }
    }

    #[test]
    fn places_are_looked_at_where_the_flux_has_their_sign() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
        // The flux is 0 halfway along both sides at the first corner. The part that remains is a
        // triangle of half the size.
        let [first, second, third, middle] = samples(&corners, &[1.0, -1.0, -1.0], true);
        let expected = DVec3::new(1.0, 1.0, 0.0) / 6.0;
        assert!(middle.expect("a part").distance(expected) < 1e-15);
        let near = first.expect("the corner has the sign");
        assert!(near.distance(expected * (1.0 - NEAR_CORNER)) < 1e-15);
        assert_eq!([second, third], [None; 2], "these have the other sign");
        // The same places, found with the opposite sign.
        let turned = samples(&corners, &[-1.0, 1.0, 1.0], false);
        assert_eq!(turned, [first, second, third, middle]);
        assert_eq!(samples(&corners, &[0.0, -1.0, 0.0], true), [None; 4]);
    }
}
