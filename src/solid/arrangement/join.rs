//! Points that are equal though defined differently become one, by exact comparison of those that lie close.

use super::exact::{Point, are_equal, may_be_equal};
use super::surface::Surface;
use crate::numeric::index;
use rayon::prelude::*;

/// Width of the cells, in grid units, in which points are compared: far more than any error bound, far less than a surface.
const CELL: f64 = 1024.0;

/// For every point the first point that equals it.
pub(super) fn first_equal(surface: &Surface, points: &[Point]) -> Vec<u32> {
    // A point is listed in every cell that its error box meets.
    let mut cells: Vec<([i64; 3], u32)> = points
        .iter()
        .enumerate()
        .flat_map(|(number, point)| {
            let cell = |offset: f64| ((point.approximate + offset) / CELL).floor();
            let (low, high) = (cell(-2.0 * point.error), cell(2.0 * point.error));
            (0..8).filter_map(move |bits| {
                let mut key = [0; 3];
                for i in 0..3 {
                    let is_high = bits >> i & 1 == 1;
                    if is_high && low[i] == high[i] {
                        return None;
                    }
                    key[i] = whole(if is_high { high[i] } else { low[i] });
                }
                Some((key, index(number)))
            })
        })
        .collect();
    cells.par_sort_unstable();
    let mut candidates: Vec<[u32; 2]> = cells
        .chunk_by(|a, b| a.0 == b.0)
        .filter(|cell| cell.len() > 1)
        .flat_map(|cell| {
            cell.iter().enumerate().flat_map(|(i, &(_, a))| {
                cell[i + 1..].iter().filter_map(move |&(_, b)| {
                    may_be_equal(&points[a as usize], &points[b as usize]).then_some([a, b])
                })
            })
        })
        .collect();
    candidates.sort_unstable();
    candidates.dedup();
    let equal: Vec<bool> = candidates
        .par_iter()
        .map(|[a, b]| are_equal(surface, &points[*a as usize], &points[*b as usize]))
        .collect();
    let mut first: Vec<u32> = (0..index(points.len())).collect();
    for ([a, b], _) in candidates.iter().zip(equal).filter(|(_, equal)| *equal) {
        // Equality is exact, so that all pairs of a set of equal points are here and the smallest comes first.
        first[*b as usize] = first[*b as usize].min(*a);
    }
    first
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "grid coordinates over the cell width are below 2^47"
)]
fn whole(x: f64) -> i64 {
    x as i64
}
