//! Loops around a planar region, from the pieces of its border.

use crate::Fault;
use crate::numeric::exact::signs::{Side, side_of_line};
use crate::numeric::index;
use glam::DVec2;
use std::cmp::Ordering;

/// Chains directed pieces of the border of a region into loops, as lists of numbers of pieces.
///
/// - `places`: positions of the ends.
/// - `pieces`: start and end, with the region on the left; at each place, as many pieces start as
///   end.
///
/// Where more than two pieces meet, a loop follows the part of the region beside which it arrives:
/// it continues with the next piece on the clockwise side. So no loop crosses itself or another,
/// and parts that meet in a point have loops of their own. The loops are in the order of their
/// first pieces, with which they begin.
///
/// # Errors
/// [`Fault`] when the pieces are not such a border.
pub(super) fn outlines(places: &[DVec2], pieces: &[[u32; 2]]) -> Result<Vec<Vec<u32>>, Fault> {
    let mut rays: Vec<Ray> = Vec::with_capacity(2 * pieces.len());
    for (piece, &[from, to]) in (0u32..).zip(pieces) {
        rays.push(Ray {
            at: from,
            towards: to,
            piece,
            out: true,
        });
        rays.push(Ray {
            at: to,
            towards: from,
            piece,
            out: false,
        });
    }
    rays.sort_unstable_by(|a, b| {
        let place = |number: u32| places[number as usize];
        a.at.cmp(&b.at)
            .then_with(|| counter_clockwise(place(a.at), place(a.towards), place(b.towards)))
    });
    let mut next = vec![0u32; pieces.len()];
    for star in rays.chunk_by(|a, b| a.at == b.at) {
        for (i, ray) in star.iter().enumerate().filter(|(_, ray)| !ray.out) {
            let clockwise = star[(i + star.len() - 1) % star.len()];
            if !clockwise.out {
                // The region lies between a piece that ends and one that begins.
                return Err(Fault::new("the border of a region is not closed"));
            }
            next[ray.piece as usize] = clockwise.piece;
        }
    }
    let mut used = vec![false; pieces.len()];
    let mut loops = Vec::new();
    for first in 0..index(pieces.len()) {
        let mut links = Vec::new();
        let mut piece = first;
        while !std::mem::replace(&mut used[piece as usize], true) {
            links.push(piece);
            piece = next[piece as usize];
        }
        if !links.is_empty() {
            loops.push(links);
        }
    }
    Ok(loops)
}

/// A piece, seen from one of its ends.
#[derive(Clone, Copy)]
struct Ray {
    at: u32,
    towards: u32,
    piece: u32,
    /// Whether the piece begins here.
    out: bool,
}

/// The order of directions from `centre`, counter-clockwise from the x axis, exact.
fn counter_clockwise(centre: DVec2, a: DVec2, b: DVec2) -> Ordering {
    let lower = |p: DVec2| p.y < centre.y || (p.y == centre.y && p.x < centre.x);
    lower(a)
        .cmp(&lower(b))
        .then_with(|| match side_of_line(centre, a, b) {
            Side::Above => Ordering::Less,
            Side::On => Ordering::Equal,
            Side::Below => Ordering::Greater,
        })
}
