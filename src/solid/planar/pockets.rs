//! The bounded parts of the outside of a region.

use super::Arrangement;
use super::cells::Cells;
use super::faces::{Faces, twin};
use super::strokes::Stroke;
use crate::numeric::closest::distance_in_plane;
use crate::numeric::index;
use crate::watch::{Stop, Work};
use glam::DVec2;
use std::collections::BTreeMap;

/// A bounded part of the outside, connected across edges.
#[derive(Debug, Clone, PartialEq)]
pub struct Pocket {
    /// Its face with the least number.
    pub(super) first_face: u32,
    /// Its area.
    pub area: f64,
    /// The incentres of its triangles of greatest inradius, the greatest first, at most five.
    pub witnesses: Vec<DVec2>,
    /// The inradius of the first of these triangles: a disc of that radius around its incentre lies
    /// in the pocket.
    pub depth: f64,
    /// A bound on the distance of its points from the region. It may be several times the depth, at
    /// worst in corners, and is near the depth where the pocket is long and thin.
    pub reach: f64,
}

/// Most witnesses of one pocket.
const WITNESSES: usize = 5;

/// All pockets, in the order of their first faces; each is examined when its turn comes.
pub(super) fn pockets(
    arrangement: &Arrangement,
    work: Work,
) -> impl Iterator<Item = Result<Pocket, Stop>> {
    let component = arrangement.components();
    let mut borders = BTreeMap::<u32, Vec<u32>>::new();
    for half in 0..index(2 * arrangement.pieces.len()) {
        let [here, there] = [half, twin(half)].map(|half| arrangement.faces.face_of(half) as usize);
        if !arrangement.is_inside[here] && arrangement.is_inside[there] && component[here] != 0 {
            borders.entry(component[here]).or_default().push(half);
        }
    }
    borders
        .into_iter()
        .map(move |(first_face, border)| pocket(arrangement, first_face, &border, work))
}

/// The pocket on the left of some half-edges.
fn pocket(
    arrangement: &Arrangement,
    first_face: u32,
    border: &[u32],
    work: Work,
) -> Result<Pocket, Stop> {
    let mut vertices: Vec<u32> = border
        .iter()
        .flat_map(|&half| arrangement.pieces[half as usize / 2].ends)
        .collect();
    vertices.sort_unstable();
    vertices.dedup();
    let number = |end: u32| index(vertices.binary_search(&end).unwrap_or_default());
    let pieces: Vec<Stroke> = border
        .iter()
        .map(|&half| Stroke {
            ends: arrangement.pieces[half as usize / 2].ends.map(number),
            weight: if half.is_multiple_of(2) { 1 } else { -1 },
        })
        .collect();
    let nodes: Vec<_> = vertices
        .iter()
        .map(|&vertex| arrangement.nodes[vertex as usize])
        .collect();
    let faces = Faces::new(&nodes, &pieces, work.uncounted())?;
    let cells = Cells::new(&nodes, &pieces, &faces)?;
    let mut edges = vec![Vec::new(); nodes.len()];
    let place = |node: u32| arrangement.grid.place(nodes[node as usize]);
    for piece in &pieces {
        let ends = piece.ends.map(place);
        piece
            .ends
            .iter()
            .for_each(|&end| edges[end as usize].push(ends));
    }
    let (mut area, mut reach) = (0.0, 0.0_f64);
    let mut centres = Vec::new();
    for (corners, face) in cells.triangles.iter().zip(&cells.face) {
        if faces.winding[*face as usize] < 1 {
            continue;
        }
        let [a, b, c] = corners.map(place);
        let doubled = (b - a).perp_dot(c - a);
        area += doubled / 2.0;
        let sides = [b.distance(c), c.distance(a), a.distance(b)];
        let around = sides[0] + sides[1] + sides[2];
        let centre = a + ((b - a) * sides[1] + (c - a) * sides[2]) / around;
        centres.push((doubled / around, centre));
        let near = corners.iter().flat_map(|&corner| &edges[corner as usize]);
        reach = reach.max(farthest([a, b, c], near));
    }
    centres.sort_by(|a, b| b.0.total_cmp(&a.0));
    centres.truncate(WITNESSES);
    Ok(Pocket {
        first_face,
        area,
        reach,
        depth: centres.first().map_or(0.0, |centre| centre.0),
        witnesses: centres.into_iter().map(|centre| centre.1).collect(),
    })
}

/// A bound on the distance of the points of a triangle from some segments through its corners.
///
/// The distance from one segment is convex, so it is largest in a corner. And no point is farther
/// from the nearest corner than the longest side divided by the square root of 3.
fn farthest<'a>(corners: [DVec2; 3], segments: impl Iterator<Item = &'a [DVec2; 2]>) -> f64 {
    let [a, b, c] = corners;
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    let to_segment = |segment: &[DVec2; 2]| {
        corners
            .iter()
            .map(|&corner| distance_in_plane(*segment, corner))
            .fold(0.0, f64::max)
    };
    segments
        .map(to_segment)
        .fold(longest / 3.0_f64.sqrt(), f64::min)
}

#[cfg(test)]
mod tests {
    use super::super::{Segment, arrange};
    use super::*;
    use crate::samples::loops_of_four;

    /// A square of size 4 with a hole from (1, 1) to `high`.
    fn holed(high: DVec2) -> Arrangement {
        let loops = [
            [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]],
            [[1.0, 1.0], [1.0, high.y], [high.x, high.y], [high.x, 1.0]],
        ];
        let (points, ends) = loops_of_four(&loops);
        let segments: Vec<Segment> = ends
            .into_iter()
            .map(|ends| Segment { ends, weight: 1 })
            .collect();
        arrange(&points, &segments).expect("two loops")
    }

    #[test]
    fn a_square_hole_is_measured_by_its_two_triangles() {
        let pockets = holed(DVec2::splat(2.0)).pockets().expect("a hole");
        let [pocket] = &pockets[..] else {
            panic!("{pockets:?}")
        };
        assert!((pocket.area - 1.0).abs() < 1e-9, "{}", pocket.area);
        // The inradius of half a square: (1 + 1 - sqrt 2) / 2.
        let inradius = 1.0 - 0.5_f64.sqrt();
        assert!((pocket.depth - inradius).abs() < 1e-9, "{}", pocket.depth);
        assert_eq!(pocket.witnesses.len(), 2);
        for witness in &pocket.witnesses {
            let from_sides = (*witness - 1.0).min(2.0 - *witness).min_element();
            assert!((from_sides - inradius).abs() < 1e-9, "{witness}");
        }
        // Each corner is at a distance of 1 from the opposite sides, so the bound is the one by the
        // diagonal: its length over sqrt 3.
        let reach = (2.0_f64 / 3.0).sqrt();
        assert!((pocket.reach - reach).abs() < 1e-9, "{}", pocket.reach);
    }

    #[test]
    fn a_long_thin_hole_reaches_as_far_as_it_is_wide() {
        let pockets = holed(DVec2::new(3.0, 1.01)).pockets().expect("a hole");
        assert_eq!(pockets.len(), 1);
        assert!(
            (pockets[0].reach - 0.01).abs() < 1e-9,
            "{}",
            pockets[0].reach
        );
        assert!(pockets[0].depth < 0.005, "half of the width");
    }

    #[test]
    fn a_region_without_holes_has_no_pockets() {
        // The hole has no width: its two long sides cancel.
        assert_eq!(holed(DVec2::new(3.0, 1.0)).pockets(), Ok(Vec::new()));
    }
}
