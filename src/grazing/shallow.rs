//! Which sign the faces with shallow folds take: the one that keeps the boundary of the egress region short.
//!
//! Any sign loses at most the depth of the fold, so the choice is free. The sign of the mean flux would follow the exact set most
//! closely, but on a tessellated body that slides in itself (a ball about its own axis) it is noise, and the boundary
//! would run round every other face, in sheets closer to each other than their sampling.
//!
//! # Depth of a fold
//! A face of flux g moves outwards until its flux changes sign, by g^2 / (2 |n.Mv|) for as long as n.Mv keeps its own sign;
//! or until the points of space that meet it have passed over it, by |g| / |v| times its length. The smaller of the two
//! counts. Where several neighbours took the wrong sign, points pass over all of them: their common length
//! counts. Over a patch as large as the loops of the paths they may stay for the whole span, and lose all that it moves: a ball
//! that spins while it rises has shallow folds everywhere on its side, and yet its upper half rises. At a sharp edge the layer of that depth under a face reaches farther beyond the rest of the body, by 1 / sin of the
//! angle there, and counts as so deep. These are estimates: second-order terms are left out, as is what several patches do one after another.

use crate::body::Mesh;
use crate::numeric::index;
use glam::DVec3;
use std::collections::VecDeque;

/// How often faces may change sides to shorten the boundary. Each change shortens it; what is left after this many
/// rounds is long-range and rare.
const ROUNDS: usize = 16;

/// How a face of mixed flux folds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FaceFold {
    /// Bound of g^2 / (2 |n.Mv|) on the face; infinite where n.Mv changes sign.
    pub(super) by_turning: f64,
    /// Bound of |g| / |v| on the face.
    pub(super) slope: f64,
    /// Least box around the face.
    pub(super) extent: [DVec3; 2],
    /// Mean flux: how far the face as a whole moves outwards in the span (inwards below zero).
    pub(super) drift: f64,
    /// Lower bound of the speed on the face.
    pub(super) speed: f64,
}

impl FaceFold {
    /// Depth of the fold of this face alone.
    pub(super) fn depth(&self) -> f64 {
        self.by_turning
            .min(self.slope * self.extent[0].distance(self.extent[1]))
    }

    /// A fold this many times as deep.
    pub(super) fn times(&self, factor: f64) -> FaceFold {
        FaceFold {
            by_turning: self.by_turning * factor,
            slope: self.slope * factor,
            ..*self
        }
    }

    /// Depth to which faces that took the wrong sign together may cut into the swept region.
    ///
    /// A path with a radius of curvature of at least |v| / |M| cannot close a loop in a patch smaller than twice that: points
    /// pass over it. Over a larger one they may stay for the whole span, and miss all that it drifts.
    fn depth_of_patch(&self, turning: f64) -> f64 {
        let size = self.extent[0].distance(self.extent[1]);
        let drift = if size * turning <= 2.0 * self.speed {
            0.0
        } else {
            self.drift.abs()
        };
        self.depth() + drift
    }

    /// The fold of two faces that points pass over together.
    fn and(&self, other: &FaceFold) -> FaceFold {
        FaceFold {
            by_turning: self.by_turning.max(other.by_turning),
            slope: self.slope.max(other.slope),
            extent: [
                self.extent[0].min(other.extent[0]),
                self.extent[1].max(other.extent[1]),
            ],
            drift: self.drift.abs().max(other.drift.abs()),
            speed: self.speed.min(other.speed),
        }
    }
}

/// What is known of a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Sign {
    Ingress,
    Egress,
    /// Cut by the grazing set: either, depending on the side.
    Both,
    /// Shallow fold: to be chosen.
    Free(FaceFold),
}

/// Chooses the signs of all free faces: that of the nearest face (in steps across edges) that has one, ingress where there is
/// none; then faces change sides while that shortens the boundary. Patches of faces against their mean flux that fold
/// deeper than `limit` together get their own signs back; `turning` is a bound of |M|. Returns the signs and the depth of the deepest fold given up.
pub(super) fn settle(
    mesh: &Mesh,
    positions: &[DVec3],
    given: &[Sign],
    turning: f64,
    limit: f64,
) -> (Vec<Sign>, f64) {
    let mut signs = given.to_vec();
    let free: Vec<(u32, FaceFold)> = (0..)
        .zip(given)
        .filter_map(|(face, sign)| {
            if let Sign::Free(fold) = sign {
                Some((face, *fold))
            } else {
                None
            }
        })
        .collect();
    if free.is_empty() {
        return (signs, 0.0);
    }
    spread(mesh, &mut signs);
    shorten(mesh, positions, &free, &mut signs);
    // A body that is shallow everywhere drifts nowhere.
    let turning = if free.len() == given.len() {
        0.0
    } else {
        turning
    };
    let dropped_fold = restore_deep(mesh, given, &free, [turning, limit], &mut signs);
    (signs, dropped_fold)
}

fn of_flux(leaves: bool) -> Sign {
    if leaves { Sign::Egress } else { Sign::Ingress }
}

fn has_sign(sign: Sign) -> bool {
    matches!(sign, Sign::Ingress | Sign::Egress)
}

/// The faces across the sides of a face, with the edges between.
fn neighbours(mesh: &Mesh, face: u32) -> [(u32, u32); 3] {
    mesh.face_edges()[face as usize].map(|edge| {
        let [first, second] = mesh.edges()[edge as usize].faces;
        (if first == face { second } else { first }, edge)
    })
}

/// Free faces take the sign of the nearest face that has one.
fn spread(mesh: &Mesh, signs: &mut [Sign]) {
    let mut queue: VecDeque<u32> = (0..index(signs.len()))
        .filter(|&f| has_sign(signs[f as usize]))
        .collect();
    while let Some(face) = queue.pop_front() {
        for (other, _) in neighbours(mesh, face) {
            if matches!(signs[other as usize], Sign::Free(_)) {
                signs[other as usize] = signs[face as usize];
                queue.push_back(other);
            }
        }
    }
    signs
        .iter_mut()
        .filter(|sign| matches!(sign, Sign::Free(_)))
        .for_each(|sign| *sign = Sign::Ingress);
}

/// Free faces change sides while that shortens the boundary.
fn shorten(mesh: &Mesh, positions: &[DVec3], free: &[(u32, FaceFold)], signs: &mut [Sign]) {
    let length = |edge: u32| {
        let [a, b] = mesh.edges()[edge as usize]
            .vertices
            .map(|v| positions[v as usize]);
        a.distance(b)
    };
    for _ in 0..ROUNDS {
        let mut changed = false;
        for &(face, _) in free {
            let own = signs[face as usize];
            let saved: f64 = neighbours(mesh, face)
                .iter()
                .filter(|(other, _)| has_sign(signs[*other as usize]))
                .map(|(other, edge)| {
                    if signs[*other as usize] == own {
                        -length(*edge)
                    } else {
                        length(*edge)
                    }
                })
                .sum();
            if saved > 0.0 {
                signs[face as usize] = of_flux(own == Sign::Ingress);
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
}

/// Gives the faces of patches that fold deeper than `limit` together the signs of their mean flux, and tells how deep the others
/// fold.
fn restore_deep(
    mesh: &Mesh,
    given: &[Sign],
    free: &[(u32, FaceFold)],
    [turning, limit]: [f64; 2],
    signs: &mut [Sign],
) -> f64 {
    let against = |face: u32, signs: &[Sign]| match given[face as usize] {
        Sign::Free(fold) if of_flux(fold.drift >= 0.0) != signs[face as usize] => Some(fold),
        _ => None,
    };
    let mut dropped = free
        .iter()
        .map(|(_, fold)| fold.depth())
        .fold(0.0, f64::max);
    let mut seen = vec![false; signs.len()];
    for &(start, fold) in free {
        if seen[start as usize] || against(start, signs).is_none() {
            continue;
        }
        let mut patch = vec![start];
        let mut together = fold;
        seen[start as usize] = true;
        let mut next = 0;
        while next < patch.len() {
            for (other, _) in neighbours(mesh, patch[next]) {
                if !seen[other as usize]
                    && let Some(fold) = against(other, signs)
                {
                    seen[other as usize] = true;
                    together = together.and(&fold);
                    patch.push(other);
                }
            }
            next += 1;
        }
        if together.depth_of_patch(turning) > limit {
            for &face in &patch {
                if let Sign::Free(fold) = given[face as usize] {
                    signs[face as usize] = of_flux(fold.drift >= 0.0);
                }
            }
        } else {
            dropped = dropped.max(together.depth_of_patch(turning));
        }
    }
    dropped
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of squares round a square tube, closed by its ends: faces 0 to 7 are the tube.
    fn tube() -> Mesh {
        let positions = (0..8_u8)
            .map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)))
            .collect();
        let triangles = vec![
            [0, 1, 4],
            [1, 5, 4],
            [1, 3, 5],
            [3, 7, 5],
            [3, 2, 7],
            [2, 6, 7],
            [2, 0, 6],
            [0, 4, 6],
            [0, 2, 1],
            [1, 2, 3],
            [4, 5, 6],
            [5, 7, 6],
        ];
        Mesh::new(positions, triangles).expect("a cube is a body")
    }

    fn fold(by_turning: f64, leaves: bool) -> Sign {
        Sign::Free(FaceFold {
            by_turning,
            slope: f64::INFINITY,
            extent: [DVec3::ZERO, DVec3::ONE],
            drift: if leaves { 0.01 } else { -0.01 },
            speed: 100.0,
        })
    }

    #[test]
    fn a_body_that_is_shallow_everywhere_takes_one_sign() {
        let given: Vec<Sign> = (0..12).map(|face| fold(0.1, face % 2 == 0)).collect();
        let mesh = tube();
        let (signs, dropped) = settle(&mesh, mesh.positions(), &given, 1.0, 0.2);
        assert!(
            signs.iter().all(|s| *s == Sign::Ingress),
            "noise of the flux plays no part: {signs:?}"
        );
        assert_eq!(dropped, 0.1, "what it may cost");
    }

    #[test]
    fn free_faces_follow_their_neighbours() {
        let mut given = vec![fold(0.1, true); 12];
        given[10] = Sign::Egress;
        given[11] = Sign::Egress;
        given[8] = Sign::Ingress;
        given[9] = Sign::Ingress;
        let mesh = tube();
        let (signs, _) = settle(&mesh, mesh.positions(), &given, 1.0, 0.2);
        let leaving = signs.iter().filter(|s| **s == Sign::Egress).count();
        assert!(
            signs[10] == Sign::Egress && signs[8] == Sign::Ingress,
            "given signs stay"
        );
        assert!((2..=10).contains(&leaving), "{leaving} faces leave");
    }

    #[test]
    fn a_patch_that_folds_too_deep_together_keeps_its_own_signs() {
        let slope = |leaves| {
            Sign::Free(FaceFold {
                by_turning: f64::INFINITY,
                slope: 0.1,
                extent: [DVec3::ZERO, DVec3::new(1.0, 0.0, 0.0)],
                drift: if leaves { 0.01 } else { -0.01 },
                speed: 100.0,
            })
        };
        let wide = Sign::Free(FaceFold {
            by_turning: f64::INFINITY,
            slope: 0.1,
            extent: [DVec3::ZERO, DVec3::new(5.0, 0.0, 0.0)],
            drift: 0.01,
            speed: 100.0,
        });
        let mut given = vec![slope(true); 12];
        given[3] = wide;
        let mesh = tube();
        let (signs, dropped) = settle(&mesh, mesh.positions(), &given, 1.0, 0.2);
        assert!(
            signs.iter().all(|s| *s == Sign::Egress),
            "0.1 x 5 is over the limit: back to the flux"
        );
        assert_eq!(dropped, 0.5, "the wide face alone is as deep as that");
    }
}
