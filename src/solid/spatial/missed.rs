//! How far the sampled cycle reaches out of the region that was made from it.
//!
//! Sampling moves no point of the cycle by more than its error e. So a point where the winding
//! number of the sampled cycle is wrong is within e of a point of that cycle. Where that point
//! bounds the region or is inside it, the region is at most e away. But where a body is thinner
//! than its sampling error, its sheets may pass through each other, and leave pieces of the cycle
//! with w < 1 on both sides: there the region may be farther away, by their distance from it.
//! Pieces that cancel each other exactly are among them only where the arrangement keeps them
//! (`Cancelled::Kept`).

use crate::bounds::{Location, SurfaceTree};
use crate::watch::{Interrupted, Work};
use glam::DVec3;
use rayon::prelude::*;

/// Most halvings of a piece; after them its bound is accepted.
const MOST_HALVINGS: u32 = 16;

/// Largest excess of a bound over the distance, relative to the error to which the distance is
/// added.
const PRECISION: f64 = 0.1;

/// Upper bound of the distance of `pieces` from the region inside a closed boundary.
///
/// - `error`: the error to which the distance is added.
///
/// # Cost
/// One nearest triangle for each piece, and more for those farther than all before.
pub(super) fn farthest(
    pieces: &[[DVec3; 3]],
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    error: f64,
    work: Work,
) -> Result<f64, Interrupted> {
    if pieces.is_empty() {
        return Ok(0.0);
    }
    let tree = SurfaceTree::during(work.uncounted(), positions, triangles)?;
    let precision = PRECISION * error;
    let items = work.items(pieces.len());
    pieces
        .par_chunks(64)
        .map(|pieces| {
            let mut farthest = 0.0;
            for piece in pieces {
                items.next()?;
                raise(&tree, piece, precision, MOST_HALVINGS, &mut farthest);
            }
            Ok(farthest)
        })
        .try_reduce(|| 0.0, |a, b| Ok(f64::max(a, b)))
}

/// Raises `farthest` to a bound on the distance of a piece. The distance from one triangle is
/// convex, and so is largest at a corner of the piece.
fn raise(
    tree: &SurfaceTree,
    piece: &[DVec3; 3],
    precision: f64,
    halvings: u32,
    farthest: &mut f64,
) {
    let [a, b, c] = *piece;
    let centre = (a + b + c) / 3.0;
    let Some((triangle, distance)) = tree.nearest(centre) else {
        *farthest = f64::INFINITY;
        return;
    };
    let corners = piece.map(|corner| tree.distance_to(triangle, corner));
    let bound = corners.into_iter().fold(distance, f64::max);
    // Filled pockets have their walls inside.
    if bound <= *farthest || tree.locate(centre) == Location::Inside {
        return;
    }
    if bound <= distance + precision || halvings == 0 {
        *farthest = bound;
        return;
    }
    let sides = [(a, b, c), (b, c, a), (c, a, b)];
    let longer = |x: &(DVec3, DVec3, DVec3), y: &(DVec3, DVec3, DVec3)| {
        (x.0.distance_squared(x.1)).total_cmp(&y.0.distance_squared(y.1))
    };
    let (from, to, apex) = sides.into_iter().max_by(longer).unwrap_or((a, b, c));
    let middle = from.midpoint(to);
    for half in [[from, middle, apex], [middle, to, apex]] {
        raise(tree, &half, precision, halvings - 1, farthest);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::cuboid;

    /// The bound on the distance of a triangle from a cube of size 1.
    fn farthest_from_a_cube(piece: [DVec3; 3]) -> f64 {
        let (positions, triangles) = cuboid(DVec3::ZERO, DVec3::ONE);
        farthest(&[piece], &positions, &triangles, 0.01, Work::UNWATCHED).expect("nobody stops it")
    }

    #[test]
    fn the_bound_is_the_distance_but_for_a_part_of_the_error() {
        let place = |z: f64| DVec3::new(0.25, 0.25, z);
        // Parallel to the top, half a unit above it.
        let above = [
            place(1.5),
            place(1.5) + 0.5 * DVec3::X,
            place(1.5) + 0.5 * DVec3::Y,
        ];
        let bound = farthest_from_a_cube(above);
        assert!((0.5..=0.501).contains(&bound), "{bound}");
        // Slanted: the highest corner is the farthest.
        let slanted = [place(1.0), place(2.0), place(1.0) + 0.5 * DVec3::Y];
        let bound = farthest_from_a_cube(slanted);
        assert!((0.99..=1.001).contains(&bound), "{bound}");
    }

    #[test]
    fn what_is_inside_is_not_missed() {
        let inside = [
            DVec3::splat(0.4),
            DVec3::new(0.6, 0.4, 0.4),
            DVec3::new(0.4, 0.6, 0.5),
        ];
        assert_eq!(farthest_from_a_cube(inside), 0.0);
        let (positions, triangles) = cuboid(DVec3::ZERO, DVec3::ONE);
        let missed = farthest(&[], &positions, &triangles, 0.01, Work::UNWATCHED);
        assert_eq!(missed, Ok(0.0), "nothing");
    }

    #[test]
    fn without_a_region_everything_is_missed() {
        let piece = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let missed = farthest(&[piece], &[], &[], 0.01, Work::UNWATCHED);
        assert_eq!(missed, Ok(f64::INFINITY));
    }
}
