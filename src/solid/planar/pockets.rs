//! The bounded parts of the outside of a region.

use super::Arrangement;
use super::cells::Cells;
use super::faces::{Faces, twin};
use super::strokes::Stroke;
use crate::Fault;
use crate::numeric::closest::distance_in_plane;
use crate::numeric::index;
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

/// All pockets, in the order of their first faces.
pub(super) fn pockets(arrangement: &Arrangement) -> Result<Vec<Pocket>, Fault> {
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
        .map(|(first_face, border)| pocket(arrangement, first_face, &border))
        .collect()
}

/// The pocket on the left of some half-edges.
fn pocket(arrangement: &Arrangement, first_face: u32, border: &[u32]) -> Result<Pocket, Fault> {
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
    let faces = Faces::new(&nodes, &pieces)?;
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
