//! The cells between pieces that do not cross, as triangles with winding numbers.

use super::ArrangementError;
use super::grid::{Node, local};
use super::strokes::Stroke;
use crate::numeric::index;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

/// Triangles that fill the convex hull of the pieces.
#[derive(Debug, Clone)]
pub(super) struct Cells {
    /// Counter-clockwise.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Triangle on the other side of the edge from corner k to the next; [`OUTSIDE`] beyond the hull.
    pub(super) neighbours: Vec<[u32; 3]>,
    /// Winding number of the curves about each triangle.
    pub(super) winding: Vec<i32>,
}

/// In place of a triangle: outside of the convex hull.
pub(super) const OUTSIDE: u32 = u32::MAX;

impl Cells {
    /// - `nodes`: all different.
    /// - `pieces`: ascending, meeting at ends only.
    pub(super) fn new(nodes: &[Node], pieces: &[Stroke]) -> Result<Cells, ArrangementError> {
        let vertices: Vec<Point2<f64>> = nodes
            .iter()
            .map(|&node| {
                let place = local(node);
                Point2::new(place.x, place.y)
            })
            .collect();
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
        .map_err(|error| ArrangementError::Triangulation {
            reason: error.to_string(),
        })?;
        if conflicts > 0 || triangulation.num_constraints() != pieces.len() {
            return Err(ArrangementError::Triangulation {
                reason: format!("{conflicts} pieces cross others"),
            });
        }
        // The outer face comes first.
        let number = |face: usize| face.checked_sub(1).map_or(OUTSIDE, index);
        let count = triangulation.num_inner_faces();
        let mut cells = Cells {
            triangles: Vec::with_capacity(count),
            neighbours: Vec::with_capacity(count),
            winding: vec![0; count],
        };
        for face in triangulation.inner_faces() {
            debug_assert_eq!(
                number(face.fix().index()) as usize,
                cells.triangles.len(),
                "faces are numbered in their order"
            );
            let edges = face.adjacent_edges();
            cells
                .triangles
                .push(edges.map(|edge| index(edge.from().fix().index())));
            cells
                .neighbours
                .push(edges.map(|edge| number(edge.rev().face().fix().index())));
        }
        cells.wind(nodes.len(), pieces)?;
        Ok(cells)
    }

    /// Winding numbers, by a walk from outside, where they are 0.
    fn wind(&mut self, nodes: usize, pieces: &[Stroke]) -> Result<(), ArrangementError> {
        let weights = Weights::new(nodes, pieces);
        let mut is_known = vec![false; self.triangles.len()];
        let mut open = Vec::new();
        for (triangle, neighbours) in self.neighbours.iter().enumerate() {
            for k in 0..3 {
                if neighbours[k] == OUTSIDE && !is_known[triangle] {
                    // The outside is on the right of the edge.
                    self.winding[triangle] = weights.across(edge(&self.triangles[triangle], k));
                    is_known[triangle] = true;
                    open.push(triangle);
                }
            }
        }
        while let Some(triangle) = open.pop() {
            for k in 0..3 {
                let there =
                    self.winding[triangle] - weights.across(edge(&self.triangles[triangle], k));
                let neighbour = self.neighbours[triangle][k];
                let is_consistent = if neighbour == OUTSIDE {
                    there == 0
                } else if is_known[neighbour as usize] {
                    self.winding[neighbour as usize] == there
                } else {
                    is_known[neighbour as usize] = true;
                    self.winding[neighbour as usize] = there;
                    open.push(neighbour as usize);
                    true
                };
                if !is_consistent {
                    return Err(ArrangementError::Triangulation {
                        reason: format!("the winding numbers beside triangle {triangle} differ"),
                    });
                }
            }
        }
        Ok(())
    }
}

/// Edge k of a triangle.
pub(super) fn edge(triangle: &[u32; 3], k: usize) -> [u32; 2] {
    [triangle[k], triangle[(k + 1) % 3]]
}

/// Weights of pieces by their ends.
struct Weights<'a> {
    pieces: &'a [Stroke],
    /// Per node, the first piece of which it is the lower end; one more at the end.
    first: Vec<u32>,
}

impl<'a> Weights<'a> {
    fn new(nodes: usize, pieces: &'a [Stroke]) -> Weights<'a> {
        let mut first = vec![0; nodes + 1];
        pieces
            .iter()
            .for_each(|piece| first[piece.ends[0] as usize + 1] += 1);
        (0..nodes).for_each(|node| first[node + 1] += first[node]);
        Weights { pieces, first }
    }

    /// Winding number on the left of a directed edge less that on its right.
    fn across(&self, [from, to]: [u32; 2]) -> i32 {
        let (low, high) = (from.min(to) as usize, from.max(to));
        let [start, end] = [self.first[low], self.first[low + 1]].map(|place| place as usize);
        let weight = self.pieces[start..end]
            .iter()
            .find(|piece| piece.ends[1] == high)
            .map_or(0, |piece| piece.weight);
        if from < to { weight } else { -weight }
    }
}
