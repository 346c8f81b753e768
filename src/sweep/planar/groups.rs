//! The pieces of a planar body in groups of neighbours: the body sweeps the union of the regions
//! that the groups sweep.

use crate::body::Polygon;
use glam::DVec2;

/// Most pieces of a body whose curves are arranged at once: few enough that their crossings are
/// few, and enough that a drawing of a few pieces is arranged as a whole.
const TOGETHER: usize = 16;

/// The pieces of a body in groups. Neighbours are in one group, or in groups that are near each
/// other in the list.
///
/// - `body`: as it was given; `at_start`: the same where the motion starts.
///
/// # Cost
/// O(n log n) for n corners.
pub(super) fn groups(body: &Polygon, at_start: &Polygon) -> Vec<Polygon> {
    if body.pieces() <= TOGETHER {
        return vec![at_start.clone()];
    }
    let mut pieces: Vec<BodyPiece> = body
        .loops_of_pieces()
        .into_iter()
        .map(|loops| {
            let [low, high] = at_start.box_of_loops(&loops);
            BodyPiece {
                middle: low.midpoint(high),
                loops,
            }
        })
        .collect();
    let mut groups = Vec::new();
    split(&mut pieces, &mut |group: &[BodyPiece]| {
        let loops = group.iter().flat_map(|piece| piece.loops.iter().copied());
        groups.push(at_start.of_loops(loops));
    });
    groups
}

struct BodyPiece {
    middle: DVec2,
    /// Its loops, the outer one first.
    loops: Vec<u32>,
}

/// Halves a list of pieces across its longer side until the parts are small.
fn split(pieces: &mut [BodyPiece], visit: &mut impl FnMut(&[BodyPiece])) {
    if pieces.len() <= TOGETHER {
        visit(pieces);
        return;
    }
    let empty = [DVec2::INFINITY, DVec2::NEG_INFINITY];
    let [low, high] = pieces.iter().fold(empty, |[low, high], piece| {
        [low.min(piece.middle), high.max(piece.middle)]
    });
    let size = high - low;
    let axis = usize::from(size.y > size.x);
    let half = pieces.len() / 2;
    pieces.select_nth_unstable_by(half, |a, b| {
        let order = a.middle[axis].total_cmp(&b.middle[axis]);
        order.then_with(|| a.loops.cmp(&b.loops))
    });
    let (first, second) = pieces.split_at_mut(half);
    split(first, visit);
    split(second, visit);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::FillRule;

    #[test]
    fn every_piece_is_in_one_group_with_its_neighbours() {
        let square = |x: f64, y: f64, size: f64| {
            [[0.0, 0.0], [size, 0.0], [size, size], [0.0, size]]
                .map(|corner| DVec2::new(x, y) + DVec2::from_array(corner))
                .to_vec()
        };
        // Squares with holes on a grid of 20 x 20.
        let loops = (0..400).flat_map(|i| {
            let (x, y) = (f64::from(i % 20) * 4.0, f64::from(i / 20) * 4.0);
            [square(x, y, 3.0), square(x + 1.0, y + 1.0, 1.0)]
        });
        let body = Polygon::new(loops.collect(), FillRule::EvenOdd).expect("400 pieces");
        let found = groups(&body, &body);
        assert!(found.len() >= 25, "{} groups", found.len());
        let total: f64 = found.iter().map(Polygon::area).sum();
        assert_eq!(total, body.area());
        for group in &found {
            assert!(group.pieces() <= TOGETHER);
            assert_eq!(group.holes(), group.pieces(), "each with its hole");
            assert!(group.diagonal() < 30.0, "neighbours: {}", group.diagonal());
        }
    }
}
