//! Moves inner sheets into the body, away from the outer sheets that their sampling would cross.
//!
//! A fin is the quadrilateral Q between an inner piece of the egress boundary and a copy of the
//! piece inside the body. When it is added to E at the end of the span and removed from it at the
//! start, it moves the strip of the piece to the copy, and changes the winding number by the
//! crossings of Q, counted with the sign of n_Q . v. Flux is linear, so a triangle with nonnegative
//! flux at its corners lowers the winding number nowhere, whatever it crosses; and it raises it
//! only in the swept region if the fin lies in the body. Copies whose fins fail either test are
//! moved back by halves; a fin that still fails is left out.

use super::lines::BoundaryPiece;
use super::points::BodyPoints;
use super::room::Room;
use super::sampling::Sampling;
use crate::grazing::spatial::Fold;
use crate::motion::Generator;
use crate::numeric::tolerance::SINK_DEPTH;
use crate::watch::{Interrupted, Work};
use glam::{DAffine3, DVec3};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Number of times that the depth of a copy is halved before its fins are left out: below 1 % of
/// the depth, a fin no longer separates sheets.
const HALVINGS: usize = 6;

/// A segment of the body that the flow carries along, with the egress region (including the fins)
/// on its left.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Carried {
    pub(crate) ends: [u32; 2],
    /// The piece that the segment is, unless it bounds a fin.
    pub(crate) piece: Option<usize>,
}

/// A triangle that is part of the egress region of the span, though not of the body's surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fin {
    pub(crate) corners: [u32; 3],
    /// Per side, from corner i to corner i + 1, the piece that the side is, in either sense. The
    /// first side is none.
    pub(crate) pieces: [Option<usize>; 3],
}

/// The boundary of the egress region after sinking.
#[derive(Debug)]
pub(crate) struct SunkBoundary {
    pub(crate) carried: Vec<Carried>,
    pub(crate) fins: Vec<Fin>,
}

/// Sinks the inner ones of `pieces`, except those that are `absorbed`, each by [`SINK_DEPTH`] times
/// its own sampling error.
///
/// `frame`: pose of the start of the span relative to the start of the motion.
pub(crate) fn sink(
    pieces: &[BoundaryPiece],
    absorbed: &[bool],
    frame: &DAffine3,
    sampling: &Sampling,
    room: &Room,
    points: &mut BodyPoints,
    work: Work,
) -> Result<SunkBoundary, Interrupted> {
    let items = work.items((HALVINGS + 1) * pieces.len());
    let generator = sampling.generator();
    let mut sinks: Vec<bool> = pieces
        .iter()
        .zip(absorbed)
        .map(|(piece, absorbed)| piece.fold == Fold::Inner && !absorbed)
        .collect();
    let mut moves = BTreeMap::<u32, Move>::new();
    for (piece, sinks) in pieces.iter().zip(&mut sinks) {
        if *sinks {
            let [a, b] = piece.ends.map(|end| frame.transform_point3(points.at(end)));
            let low = (b - a)
                .normalize_or_zero()
                .cross(generator.velocity(a.midpoint(b)))
                .normalize_or_zero();
            let depth = SINK_DEPTH * sampling.error(a, b);
            *sinks = low != DVec3::ZERO && depth > 0.0;
            if *sinks {
                for end in piece.ends {
                    let at_end = moves.entry(end).or_default();
                    at_end.low += low;
                    at_end.depth = at_end.depth.max(depth);
                }
            }
        }
    }
    let inverse = frame.inverse();
    let is_bad = |piece: &BoundaryPiece, moves: &BTreeMap<u32, Move>| {
        !fits(piece, moves, frame, generator, points)
            || !has_room(piece, moves, &inverse, room, points)
    };
    for round in 0..=HALVINGS {
        let failing: Vec<usize> = (0..pieces.len())
            .into_par_iter()
            .filter_map(|i| match items.next() {
                Ok(()) => (sinks[i] && is_bad(&pieces[i], &moves)).then_some(Ok(i)),
                Err(interrupted) => Some(Err(interrupted)),
            })
            .collect::<Result<_, Interrupted>>()?;
        if round == HALVINGS {
            failing.iter().for_each(|&i| sinks[i] = false);
        } else {
            let ends: BTreeSet<u32> = failing.iter().flat_map(|&i| pieces[i].ends).collect();
            for end in ends {
                moves
                    .get_mut(&end)
                    .expect("the ends of inner pieces move")
                    .depth *= 0.5;
            }
        }
    }
    let copies: BTreeMap<u32, u32> = moves
        .iter()
        .map(|(&p, by)| {
            (
                p,
                points.intern(points.at(p) + inverse.transform_vector3(by.vector())),
            )
        })
        .collect();
    Ok(assemble(pieces, absorbed, &sinks, &copies))
}

/// The intended move of a point (world, start of the span).
#[derive(Debug, Clone, Copy, Default)]
struct Move {
    /// Sum of the unit normals to the low sides of the inner pieces that end at the point.
    low: DVec3,
    depth: f64,
}

impl Move {
    fn vector(&self) -> DVec3 {
        self.low.normalize_or_zero() * self.depth
    }
}

/// Whether no corner of the fin's two triangles has negative flux.
fn fits(
    piece: &BoundaryPiece,
    moves: &BTreeMap<u32, Move>,
    frame: &DAffine3,
    generator: &Generator,
    points: &BodyPoints,
) -> bool {
    let [a, b] = piece.ends.map(|end| frame.transform_point3(points.at(end)));
    let [a_copy, b_copy] =
        [(a, piece.ends[0]), (b, piece.ends[1])].map(|(p, end)| p + moves[&end].vector());
    [[b, a, a_copy], [b, a_copy, b_copy]]
        .iter()
        .all(|[p, q, r]| {
            let normal = (*q - *p).cross(*r - *p);
            [p, q, r]
                .iter()
                .all(|corner| normal.dot(generator.velocity(**corner)) >= 0.0)
        })
}

/// Whether a fin of twice the depth stays in the body: then as much of the body is left on the
/// other side of the copy.
fn has_room(
    piece: &BoundaryPiece,
    moves: &BTreeMap<u32, Move>,
    inverse: &DAffine3,
    room: &Room,
    points: &BodyPoints,
) -> bool {
    let ends = piece.ends.map(|end| points.at(end));
    let copies = piece
        .ends
        .map(|end| points.at(end) + inverse.transform_vector3(moves[&end].vector()) * 2.0);
    room.holds(piece.source, ends, copies)
}

fn assemble(
    pieces: &[BoundaryPiece],
    absorbed: &[bool],
    sinks: &[bool],
    copies: &BTreeMap<u32, u32>,
) -> SunkBoundary {
    let mut carried = Vec::with_capacity(pieces.len());
    let mut fins = Vec::new();
    // Neighbouring fins share the segment from a point to its copy, in opposite senses.
    let mut spokes = BTreeMap::<u32, i32>::new();
    for (index, piece) in pieces.iter().enumerate() {
        if absorbed[index] {
            continue;
        }
        if !sinks[index] {
            carried.push(Carried {
                ends: piece.ends,
                piece: Some(index),
            });
            continue;
        }
        let [a, b] = piece.ends;
        let [a_copy, b_copy] = [copies[&a], copies[&b]];
        carried.push(Carried {
            ends: [a_copy, b_copy],
            piece: None,
        });
        fins.push(Fin {
            corners: [a_copy, b, a],
            pieces: [None, Some(index), None],
        });
        fins.push(Fin {
            corners: [b, a_copy, b_copy],
            pieces: [None; 3],
        });
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
    SunkBoundary { carried, fins }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grazing::spatial::Source;

    fn piece(ends: [u32; 2]) -> BoundaryPiece {
        BoundaryPiece {
            ends,
            source: Source::Edge(0),
            place: 0,
            reversed: false,
            fold: Fold::Inner,
        }
    }

    #[test]
    fn neighbouring_fins_share_the_segment_between_them() {
        let pieces = [[0, 1], [1, 2], [2, 3], [3, 4]].map(piece);
        // The first two sink, the third stays, the last is absorbed.
        let copies = BTreeMap::from([(0, 10), (1, 11), (2, 12)]);
        let sunk = assemble(
            &pieces,
            &[false, false, false, true],
            &[true, true, false, false],
            &copies,
        );
        let mut ends: Vec<[u32; 2]> = sunk.carried.iter().map(|carried| carried.ends).collect();
        ends.sort_unstable();
        // One chain: down at 0, along the copies, up at 2, and on along the third piece. Nothing is
        // left at 1.
        assert_eq!(ends, [[0, 10], [2, 3], [10, 11], [11, 12], [12, 2]]);
        let kept = sunk.carried.iter().filter_map(|carried| carried.piece);
        assert_eq!(kept.collect::<Vec<_>>(), [2]);
        assert_eq!(sunk.fins.len(), 4, "two triangles for each");
    }

    #[test]
    fn fins_fit_on_the_low_side_only() {
        let mut points = BodyPoints::default();
        let ends = [DVec3::ZERO, DVec3::X].map(|p| points.intern(p));
        let upwards = Generator::translation(DVec3::Z);
        // For a piece along x and a motion along z, the low side is -y, since x cross z = -y. There
        // the fin faces upwards.
        for (low, expected) in [
            (DVec3::NEG_Y, true),
            (DVec3::Y, false),
            // A fin along the motion has no flux, which is not negative.
            (DVec3::NEG_Z, true),
            // A fin without width has no area.
            (DVec3::ZERO, true),
        ] {
            let moves = BTreeMap::from(ends.map(|end| (end, Move { low, depth: 0.5 })));
            let found = fits(&piece(ends), &moves, &DAffine3::IDENTITY, &upwards, &points);
            assert_eq!(found, expected, "towards {low}");
        }
    }

    #[test]
    fn a_point_between_opposite_pieces_stays() {
        let between = Move {
            low: DVec3::Y + DVec3::NEG_Y,
            depth: 1.0,
        };
        assert_eq!(between.vector(), DVec3::ZERO);
        // The mean direction counts, not its length.
        let at_a_corner = Move {
            low: DVec3::X + DVec3::Y,
            depth: 2.0,
        };
        assert!((at_a_corner.vector().length() - 2.0).abs() < 1e-15);
    }
}
