//! Inner sheets moved into the body, away from the outer sheets that their sampling would cross.
//!
//! A fin is the quadrilateral Q between an inner piece of the egress boundary and a copy of it inside the body. Added to E
//! at the end of the span and taken from it at the start, it moves the strip of the piece to the copy and changes the
//! winding number by the crossings of Q, counted with the sign of n_Q . v. Flux is linear, so a triangle
//! with nonnegative flux at its corners lowers the winding number nowhere, whatever it crosses. Copies whose fins fail
//! that test come back by halves; a fin that still fails is left out.

use super::lines::{Fold, Piece};
use super::points::BodyPoints;
use crate::motion::Generator;
use glam::{DAffine3, DVec3};
use std::collections::BTreeMap;

/// How often the depth of a copy is halved before its fins are given up: below 1 % of the depth a fin no longer
/// keeps sheets apart.
const HALVINGS: usize = 6;

/// A segment of the body that the flow carries along, the egress region (with the fins) on its left.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Carried {
    pub(crate) ends: [u32; 2],
    /// The piece that it is, unless it bounds a fin.
    pub(crate) piece: Option<usize>,
}

/// An inner piece and its copy.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fin {
    pub(crate) piece: usize,
    pub(crate) copies: [u32; 2],
}

/// Boundary of the egress region after sinking.
#[derive(Debug)]
pub(crate) struct Sunk {
    pub(crate) carried: Vec<Carried>,
    pub(crate) fins: Vec<Fin>,
}

/// Sinks the inner ones of `pieces` by up to `depth` (world, at the start of the span).
///
/// - `frame`: pose of the start of the span relative to the start of the motion.
/// - `room`: how far one may go from a point in a direction (body frame, that direction of length one in the world)
///   before half of what is left of the body there is passed.
pub(crate) fn sink(
    pieces: &[Piece],
    frame: &DAffine3,
    generator: &Generator,
    depth: f64,
    room: impl Fn(DVec3, DVec3) -> f64,
    points: &mut BodyPoints,
) -> Sunk {
    let mut sinks: Vec<bool> = pieces
        .iter()
        .map(|piece| depth > 0.0 && piece.fold == Fold::Inner)
        .collect();
    let mut low_sides = BTreeMap::<u32, DVec3>::new();
    for (piece, sinks) in pieces.iter().zip(&mut sinks) {
        if *sinks {
            let [a, b] = piece.ends.map(|end| frame.transform_point3(points.at(end)));
            let low = (b - a)
                .normalize_or_zero()
                .cross(generator.velocity(a.midpoint(b)))
                .normalize_or_zero();
            *sinks = low != DVec3::ZERO;
            for end in piece.ends {
                *low_sides.entry(end).or_default() += low;
            }
        }
    }
    let inverse = frame.inverse();
    let mut moves: BTreeMap<u32, DVec3> = low_sides
        .into_iter()
        .map(|(point, low)| {
            let direction = low.normalize_or_zero();
            let room = room(points.at(point), inverse.transform_vector3(direction));
            (point, direction * depth.min(room))
        })
        .collect();
    for round in 0..=HALVINGS {
        let failing: Vec<usize> = (0..pieces.len())
            .filter(|&i| sinks[i] && !fits(&pieces[i], &moves, frame, generator, points))
            .collect();
        if round == HALVINGS {
            failing.iter().for_each(|&i| sinks[i] = false);
        } else {
            let mut ends: Vec<u32> = failing.iter().flat_map(|&i| pieces[i].ends).collect();
            ends.sort_unstable();
            ends.dedup();
            for end in ends {
                *moves.get_mut(&end).expect("the ends of inner pieces move") *= 0.5;
            }
        }
    }
    let copies: BTreeMap<u32, u32> = moves
        .iter()
        .map(|(&p, &by)| {
            (
                p,
                points.intern(points.at(p) + inverse.transform_vector3(by)),
            )
        })
        .collect();
    assemble(pieces, &sinks, &copies)
}

/// Whether no corner of the fin's two triangles has negative flux.
fn fits(
    piece: &Piece,
    moves: &BTreeMap<u32, DVec3>,
    frame: &DAffine3,
    generator: &Generator,
    points: &BodyPoints,
) -> bool {
    let [a, b] = piece.ends.map(|end| frame.transform_point3(points.at(end)));
    let [a_copy, b_copy] = [(a, piece.ends[0]), (b, piece.ends[1])].map(|(p, end)| p + moves[&end]);
    [[b, a, a_copy], [b, a_copy, b_copy]]
        .iter()
        .all(|[p, q, r]| {
            let normal = (*q - *p).cross(*r - *p);
            [p, q, r]
                .iter()
                .all(|corner| normal.dot(generator.velocity(**corner)) >= 0.0)
        })
}

fn assemble(pieces: &[Piece], sinks: &[bool], copies: &BTreeMap<u32, u32>) -> Sunk {
    let mut carried = Vec::with_capacity(pieces.len());
    let mut fins = Vec::new();
    // Neighbouring fins share the segment from a point to its copy, in opposite senses.
    let mut spokes = BTreeMap::<u32, i32>::new();
    for (index, piece) in pieces.iter().enumerate() {
        if !sinks[index] {
            carried.push(Carried {
                ends: piece.ends,
                piece: Some(index),
            });
            continue;
        }
        let fin = Fin {
            piece: index,
            copies: piece.ends.map(|end| copies[&end]),
        };
        carried.push(Carried {
            ends: fin.copies,
            piece: None,
        });
        fins.push(fin);
        *spokes.entry(piece.ends[0]).or_default() += 1;
        *spokes.entry(piece.ends[1]).or_default() -= 1;
    }
    for (point, count) in spokes {
        let copy = copies[&point];
        let ends = if count > 0 {
            [point, copy]
        } else {
            [copy, point]
        };
        carried.extend((0..count.abs()).map(|_| Carried { ends, piece: None }));
    }
    Sunk { carried, fins }
}
