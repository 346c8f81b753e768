//! The input on the integer grid, with equal positions and equal triangles joined.
//!
//! Edges are numbered in the order of the triangles, not by their ends as in `surface::Sides`: of
//! two edges that cross, the one with the smaller number defines the point (`pairs`), so that other
//! numbers would change the last digits of the result.

use super::Cancelled;
use crate::Fault;
use crate::bounds::triangle_box;
use crate::numeric::exact::spatial_grid::{Axis, Grid, cross, difference};
use crate::numeric::index;
use crate::watch::{Interrupted, Stop, Work};
use glam::DVec3;
use std::collections::HashMap;

/// A closed surface of triangles with area. Corners are on the integer grid, and equal positions
/// and equal triangles are joined.
pub(super) struct GridSurface {
    /// The corners, with integer coordinates.
    pub(super) corners: Vec<DVec3>,
    /// The positions of the corners before they were moved to the grid.
    pub(super) originals: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// How often each triangle is covered: negative against its orientation, and 0 where that
    /// cancels.
    pub(super) multiplicity: Vec<i32>,
    pub(super) edges: Vec<[u32; 2]>,
    /// The edges of each triangle; edge i runs from corner i to the next one.
    pub(super) triangle_edges: Vec<[u32; 3]>,
    /// The coordinate axis along which each triangle is projected.
    pub(super) axis: Vec<Axis>,
    /// Length of a grid unit: a power of two.
    pub(super) unit: f64,
}

impl GridSurface {
    /// Puts a surface on the grid.
    ///
    /// No vertex moves by more than half a rounding unit of the largest coordinate.
    pub(super) fn new(
        positions: &[DVec3],
        triangles: &[[u32; 3]],
        cancelled: Cancelled,
        work: Work,
    ) -> Result<GridSurface, Stop> {
        if positions.iter().any(|p| !p.is_finite()) {
            return Err(Fault::new("a vertex of the cycle is not finite").into());
        }
        let grid = Grid::around(positions);
        let [rounding, joining, listing] = work.parts([1, 2, 2]);
        let items = rounding.items(positions.len());
        let mut corners = Vec::new();
        let mut originals = Vec::new();
        let mut places = HashMap::<[u64; 3], u32>::with_capacity(positions.len());
        let corner_of: Vec<u32> = positions
            .iter()
            .map(|&p| {
                items.next()?;
                let place = grid.nearest(p);
                let corner = *places
                    .entry(place.to_array().map(f64::to_bits))
                    .or_insert_with(|| {
                        corners.push(place);
                        originals.push(p);
                        index(corners.len() - 1)
                    });
                Ok(corner)
            })
            .collect::<Result<_, Interrupted>>()?;
        let mut surface = GridSurface {
            corners,
            originals,
            triangles: Vec::new(),
            multiplicity: Vec::new(),
            edges: Vec::new(),
            triangle_edges: Vec::new(),
            axis: Vec::new(),
            unit: grid.unit(),
        };
        surface.add_triangles(triangles, &corner_of, cancelled, joining)?;
        surface.add_edges(listing)?;
        Ok(surface)
    }

    fn add_triangles(
        &mut self,
        triangles: &[[u32; 3]],
        corner_of: &[u32],
        cancelled: Cancelled,
        work: Work,
    ) -> Result<(), Stop> {
        let items = work.items(2 * triangles.len());
        let mut known = HashMap::<[u32; 3], usize>::with_capacity(triangles.len());
        let mut all = Vec::<([u32; 3], i32)>::new();
        for triangle in triangles {
            items.next()?;
            if triangle.iter().any(|&v| v as usize >= corner_of.len()) {
                return Err(Fault::new("a triangle of the cycle has no such vertex").into());
            }
            let [a, b, c] = triangle.map(|v| corner_of[v as usize]);
            if a == b || b == c || c == a {
                continue;
            }
            let mut key = [a, b, c];
            key.sort_unstable();
            let is_even = [[a, b, c], [b, c, a], [c, a, b]].contains(&key);
            let slot = *known.entry(key).or_insert_with(|| {
                all.push((key, 0));
                all.len() - 1
            });
            all[slot].1 += if is_even { 1 } else { -1 };
        }
        for (triangle, multiplicity) in all {
            items.next()?;
            if multiplicity == 0 && cancelled == Cancelled::Dropped {
                continue;
            }
            let normal = self.normal_of(triangle);
            let Some(number) = (0..3).max_by_key(|&i| normal[i].unsigned_abs()) else {
                continue;
            };
            if normal[number] == 0 {
                // A triangle without area bounds nothing; its neighbours meet in its place.
                continue;
            }
            self.triangles.push(triangle);
            self.multiplicity.push(multiplicity);
            self.axis.push(Axis {
                number,
                is_forward: normal[number] > 0,
            });
        }
        Ok(())
    }

    fn add_edges(&mut self, work: Work) -> Result<(), Interrupted> {
        let items = work.items(self.triangles.len());
        let mut known = HashMap::<[u32; 2], u32>::with_capacity(self.triangles.len() * 3 / 2);
        for &[a, b, c] in &self.triangles {
            items.next()?;
            self.triangle_edges
                .push([[a, b], [b, c], [c, a]].map(|[p, q]| {
                    let edge = [p.min(q), p.max(q)];
                    *known.entry(edge).or_insert_with(|| {
                        self.edges.push(edge);
                        index(self.edges.len() - 1)
                    })
                }));
        }
        Ok(())
    }

    /// The corners of a triangle on the grid.
    pub(super) fn triangle(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|v| self.corners[v as usize])
    }

    /// The ends of an edge on the grid.
    pub(super) fn edge(&self, edge: u32) -> [DVec3; 2] {
        self.edges[edge as usize].map(|v| self.corners[v as usize])
    }

    fn normal_of(&self, corners: [u32; 3]) -> [i128; 3] {
        let [a, b, c] = corners.map(|v| self.corners[v as usize]);
        cross(difference(b, a), difference(c, a))
    }

    /// The normal of a triangle, with twice its area as length. Exact.
    pub(super) fn normal(&self, triangle: u32) -> [i128; 3] {
        self.normal_of(self.triangles[triangle as usize])
    }

    /// The smallest box around a triangle.
    pub(super) fn box_of(&self, triangle: u32) -> [DVec3; 2] {
        triangle_box(self.triangle(triangle))
    }
}
