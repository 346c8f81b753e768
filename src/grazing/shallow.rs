//! Which sign the faces with shallow folds take: the one that keeps the boundary of the egress region short.
//!
//! Any sign loses at most the depth of the fold, so the choice is free. The sign of the centroid would follow the exact
//! set most closely, but on a tessellated body that slides in itself (a ball about its own axis) it is noise, and the boundary would run
//! round every other face, in sheets closer to each other than their sampling.

use crate::body::Mesh;
use crate::numeric::index;
use glam::DVec3;
use std::collections::VecDeque;

/// How often faces may change sides to shorten the boundary. Each change shortens it; what is left after this many
/// rounds is long-range and rare.
const ROUNDS: usize = 16;

/// What is known of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sign {
    Ingress,
    Egress,
    /// Cut by the grazing set: either, depending on the side.
    Both,
    /// Shallow fold: to be chosen.
    Free,
}

/// Chooses the signs of all free faces: that of the nearest face (in steps across edges) that has one, ingress where there is
/// none; then faces change sides while that shortens the boundary.
pub(super) fn settle(mesh: &Mesh, positions: &[DVec3], signs: &mut [Sign]) {
    let free: Vec<u32> = (0..signs.len())
        .filter(|&f| signs[f] == Sign::Free)
        .map(index)
        .collect();
    if free.is_empty() {
        return;
    }
    let neighbours = |face: u32| {
        mesh.face_edges()[face as usize].map(|edge| {
            let edge = &mesh.edges()[edge as usize];
            let [a, b] = edge.vertices.map(|v| positions[v as usize]);
            let other = if edge.faces[0] == face {
                edge.faces[1]
            } else {
                edge.faces[0]
            };
            (other as usize, a.distance(b))
        })
    };
    let has_sign = |sign: Sign| sign == Sign::Ingress || sign == Sign::Egress;
    let mut queue: VecDeque<usize> = VecDeque::new();
    for face in 0..signs.len() {
        if has_sign(signs[face])
            && neighbours(index(face))
                .iter()
                .any(|&(other, _)| signs[other] == Sign::Free)
        {
            queue.push_back(face);
        }
    }
    while let Some(face) = queue.pop_front() {
        for (other, _) in neighbours(index(face)) {
            if signs[other] == Sign::Free {
                signs[other] = signs[face];
                queue.push_back(other);
            }
        }
    }
    for &face in &free {
        if signs[face as usize] == Sign::Free {
            signs[face as usize] = Sign::Ingress;
        }
    }
    for _ in 0..ROUNDS {
        let mut changed = false;
        for &face in &free {
            // Boundary saved by changing sides.
            let saved: f64 = neighbours(face)
                .iter()
                .filter(|(other, _)| has_sign(signs[*other]))
                .map(|(other, length)| {
                    if signs[*other] == signs[face as usize] {
                        -length
                    } else {
                        *length
                    }
                })
                .sum();
            if saved > 0.0 {
                let sign = &mut signs[face as usize];
                *sign = if *sign == Sign::Egress {
                    Sign::Ingress
                } else {
                    Sign::Egress
                };
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
}
