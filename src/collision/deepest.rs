//! A point of a surface that is about the deepest one in a solid at one time: parts with the
//! greatest bound on their depth come first.
//!
//! This is a search, not a proof of maximality: the depth of the point that is found is certain,
//! but the work is limited.

use super::ranked::Ranked;
use super::sinking::{Deep, Sinking};
use super::triangle_piece::{TrianglePiece, blend};
use crate::numeric::Ordered;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Most parts of the surface that are examined.
const MOST_LOOKED: usize = 10_000;

/// Most boxes and triangles of the solid that are examined for them, plus one more per triangle.
const MOST_LOOKED_AT: usize = 1_000_000;
const MOST_LOOKED_AT_EACH: usize = 32;

/// Most cuts of triangles.
const MOST_CUT: usize = 64;

/// Fraction of the greatest possible excess that is good enough.
const GOOD: f64 = 0.5;

/// Parts of the surface that may be deep: nodes of its tree, then pieces of triangles.
enum MaybeDeep {
    Node(u32),
    Piece(TrianglePiece),
}

/// A point of the surface that is certainly too deep at a time; `None` if none is found.
pub(super) fn point(sinking: &Sinking, time: f64) -> Option<Deep> {
    let shape = sinking.encounter.shapes[sinking.surface];
    let pose = sinking.encounter.movers[sinking.surface].pose(time);
    let solid = sinking.encounter.solid(1 - sinking.surface, time);
    let frame = pose.matrix3 * shape.frame;
    let mut best: Option<(f64, Deep)> = None;
    // Bounds the depth of a part, after a search for its deepest point.
    let bound = |part: &MaybeDeep, best: &mut Option<(f64, Deep)>| -> f64 {
        let (middle, reach) = match part {
            MaybeDeep::Node(node) => {
                let node = &shape.nodes[*node as usize];
                let half = frame.abs() * node.half;
                (frame * node.centre + pose.translation, half.length())
            }
            MaybeDeep::Piece(piece) => {
                let corners = piece.corners(&shape.corners(piece.triangle));
                let corners = corners.map(|corner| pose.transform_point3(corner));
                let found = solid.climb(&corners, [1.0 / 3.0; 3]);
                let depth = found.sounding.depth;
                let known = best.map_or(f64::NEG_INFINITY, |(known, _)| known);
                if depth > known && sinking.is_deep(depth, time) {
                    let deep = Deep {
                        triangle: piece.triangle,
                        weights: piece.of_triangle(found.weights),
                    };
                    *best = Some((depth, deep));
                }
                let middle = blend(&corners, [1.0 / 3.0; 3]);
                let reach = corners.map(|corner| corner.distance(middle));
                (middle, reach.into_iter().fold(0.0, f64::max))
            }
        };
        solid.sound(middle).depth + reach
    };
    let most = MOST_LOOKED_AT + MOST_LOOKED_AT_EACH * sinking.encounter.triangles();
    let mut open = BinaryHeap::new();
    let mut number = 0;
    let mut cut = 0;
    let mut parts = vec![MaybeDeep::Node(0)];
    loop {
        for part in parts {
            number += 1;
            let bound = bound(&part, &mut best);
            // The greatest bound comes first, and of equal ones the first.
            open.push(Ranked {
                key: (Ordered(bound), Reverse(number)),
                item: part,
            });
        }
        let Ranked { key, item } = open.pop()?;
        let (Ordered(bound), _) = key;
        let found = best.map_or(sinking.depth, |(found, _)| found);
        let is_good = found - sinking.depth > GOOD * (bound - sinking.depth);
        let is_exhausted = number > MOST_LOOKED
            || cut > MOST_CUT
            || solid.looked_at() > most
            || sinking.encounter.work.check().is_err();
        if bound <= found || is_good || is_exhausted {
            return best.map(|(_, deep)| deep);
        }
        parts = match item {
            MaybeDeep::Node(node) => {
                let node = &shape.nodes[node as usize];
                if node.is_leaf() {
                    vec![MaybeDeep::Piece(TrianglePiece::whole(node.triangle))]
                } else {
                    vec![
                        MaybeDeep::Node(node.children),
                        MaybeDeep::Node(node.children + 1),
                    ]
                }
            }
            MaybeDeep::Piece(piece) => {
                cut += 1;
                let corners = piece.corners(&shape.corners(piece.triangle));
                piece
                    .halves(&corners)
                    .into_iter()
                    .map(MaybeDeep::Piece)
                    .collect()
            }
        };
    }
}
