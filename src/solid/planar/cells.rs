//! Triangulates the faces between pieces that do not cross.

use super::faces::{Faces, twin};
use super::strokes::Stroke;
use crate::Fault;
use crate::numeric::exact::planar_grid::{Node, local};
use crate::numeric::index;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

/// Triangles that fill the convex hull of the pieces.
#[derive(Debug, Clone)]
pub(super) struct Cells {
    /// Triples of nodes, counter-clockwise.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The face of each triangle.
    pub(super) face: Vec<u32>,
}

/// Stands for a triangle outside the convex hull.
const OUTSIDE: usize = usize::MAX;

impl Cells {
    /// - `nodes`: distinct.
    /// - `pieces`: ascending, and meeting at ends only.
    /// - `faces`: the faces between the pieces.
    pub(super) fn new(nodes: &[Node], pieces: &[Stroke], faces: &Faces) -> Result<Cells, Fault> {
        let vertices: Vec<Point2<f64>> = nodes
            .iter()
            .map(|&node| {
                let place = local(node);
                Point2::new(place.x, place.y)
            })
            .collect();
        const FAILED: Fault = Fault::new("the triangulation of the curves failed");
        let edges = pieces
            .iter()
            .map(|piece| piece.ends.map(|end| end as usize))
            .collect();
        let mut conflicts = 0;
        let triangulation = ConstrainedDelaunayTriangulation::<Point2<f64>>::try_bulk_load_cdt(
            vertices,
            edges,
            |_| conflicts += 1,
        )
        .map_err(|_| FAILED)?;
        let is_whole = triangulation.num_vertices() == nodes.len()
            && triangulation.num_constraints() == pieces.len();
        if conflicts > 0 || !is_whole {
            return Err(FAILED);
        }
        // The outer face comes first in the triangulation.
        let number = |face: usize| face.checked_sub(1).unwrap_or(OUTSIDE);
        let mut triangles = Vec::with_capacity(triangulation.num_inner_faces());
        let mut neighbours = Vec::with_capacity(triangulation.num_inner_faces());
        for face in triangulation.inner_faces() {
            let edges = face.adjacent_edges();
            triangles.push(edges.map(|edge| index(edge.from().fix().index())));
            neighbours.push(edges.map(|edge| number(edge.rev().face().fix().index())));
        }
        let halves = PieceHalves::new(nodes.len(), pieces);
        let face = assign(&triangles, &neighbours, &halves, faces)?;
        Ok(Cells { triangles, face })
    }
}

/// The face of each triangle, by a walk from the outside.
fn assign(
    triangles: &[[u32; 3]],
    neighbours: &[[usize; 3]],
    halves: &PieceHalves,
    faces: &Faces,
) -> Result<Vec<u32>, Fault> {
    let mut found: Vec<Option<u32>> = vec![None; triangles.len()];
    let mut open = Vec::new();
    // The face on the other side of edge k of a triangle with a face, unless the two contradict
    // each other.
    let beyond = |triangle: usize, k: usize, face: u32| {
        let corners = &triangles[triangle];
        match halves.between(corners[k], corners[(k + 1) % 3]) {
            None => Some(face),
            Some(half) if faces.face_of(half) == face => Some(faces.face_of(twin(half))),
            Some(_) => None,
        }
    };
    let contradiction = || Fault::new("the faces of triangles contradict each other");
    for (triangle, corners) in triangles.iter().enumerate() {
        let at_hull = neighbours[triangle].iter().position(|&n| n == OUTSIDE);
        if let Some(k) = at_hull {
            let half = halves.between(corners[k], corners[(k + 1) % 3]);
            found[triangle] = Some(half.map_or(0, |half| faces.face_of(half)));
            open.push(triangle);
        }
    }
    while let Some(triangle) = open.pop() {
        let face = found[triangle].ok_or_else(contradiction)?;
        for (k, &neighbour) in neighbours[triangle].iter().enumerate() {
            let there = beyond(triangle, k, face).ok_or_else(contradiction)?;
            let known = if neighbour == OUTSIDE {
                Some(0)
            } else {
                found[neighbour]
            };
            if known.is_none() {
                found[neighbour] = Some(there);
                open.push(neighbour);
            } else if known != Some(there) {
                return Err(contradiction());
            }
        }
    }
    found
        .into_iter()
        .map(|face| face.ok_or_else(contradiction))
        .collect()
}

/// The half-edges of pieces, by their ends.
struct PieceHalves<'a> {
    pieces: &'a [Stroke],
    /// Per node, the first piece of which it is the lower end; and the number of pieces at the end.
    first: Vec<u32>,
}

impl<'a> PieceHalves<'a> {
    fn new(nodes: usize, pieces: &'a [Stroke]) -> PieceHalves<'a> {
        let mut first = vec![0; nodes + 1];
        pieces
            .iter()
            .for_each(|piece| first[piece.ends[0] as usize + 1] += 1);
        (0..nodes).for_each(|node| first[node + 1] += first[node]);
        PieceHalves { pieces, first }
    }

    fn between(&self, from: u32, to: u32) -> Option<u32> {
        let (low, high) = (from.min(to) as usize, from.max(to));
        let [start, end] = [self.first[low], self.first[low + 1]].map(|place| place as usize);
        let place = self.pieces[start..end]
            .iter()
            .position(|piece| piece.ends[1] == high)?;
        Some(2 * index(start + place) + u32::from(from > to))
    }
}
