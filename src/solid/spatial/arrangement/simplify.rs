//! Fewer triangles for the same surface: vertices inside a plane or on a straight crease are
//! removed by exact edge collapses.

use super::boundary::Boundary;
use super::heal::SAME_PLACE;
use super::point::{Point, orientation};
use super::surface::GridSurface;
use crate::numeric::exact::signs::Sign;
use crate::numeric::exact::spatial_grid::Axis;
use crate::numeric::index;
use crate::surface::{Collapsing, Spoke};
use crate::watch::{Interrupted, Work};
use glam::DVec3;
use std::collections::HashMap;

/// The surface with positions in the coordinates of the input.
pub(super) fn simplified(
    surface: &GridSurface,
    points: &[Point],
    plane_of: &[u32],
    boundary: Boundary,
    work: Work,
) -> Result<(Vec<DVec3>, Vec<[u32; 3]>), Interrupted> {
    let [straightening, clearing] = work.parts([4, 1]);
    let places: Vec<DVec3> = boundary
        .points
        .iter()
        .map(|&p| points[p as usize].place(surface))
        .collect();
    let mut mesh = Simplified {
        surface,
        points,
        plane_of,
        triangles: Collapsing::new(boundary.triangles, places.len()),
        planes: boundary.planes,
        point_of: boundary.points,
        places,
    };
    mesh.straighten(straightening)?;
    mesh.remove_needles(clearing)?;
    Ok(mesh.finish())
}

struct Simplified<'a> {
    surface: &'a GridSurface,
    points: &'a [Point],
    plane_of: &'a [u32],
    triangles: Collapsing,
    /// As in [`Boundary`].
    planes: Vec<u32>,
    point_of: Vec<u32>,
    places: Vec<DVec3>,
}

/// Whether the height of a triangle on the grid is at most rounding.
fn is_thin([a, b, c]: [DVec3; 3]) -> bool {
    let longest = [b - a, c - b, a - c]
        .map(DVec3::length)
        .into_iter()
        .fold(0.0, f64::max);
    (b - a).cross(c - a).length() <= SAME_PLACE * longest
}

impl Simplified<'_> {
    fn plane(&self, triangle: u32) -> u32 {
        self.plane_of[self.planes[triangle as usize] as usize]
    }

    fn point(&self, vertex: u32) -> &Point {
        &self.points[self.point_of[vertex as usize] as usize]
    }

    /// Removes vertices that lie inside a plane or a straight crease, until no more can be removed.
    fn straighten(&mut self, work: Work) -> Result<(), Interrupted> {
        // Some vertices come up more than once.
        let items = work.items(self.places.len());
        // Where the region touches itself, every copy of a point stays, so that the parts that
        // touch fit together.
        let mut copies = vec![0_u32; self.points.len()];
        self.point_of.iter().for_each(|&p| copies[p as usize] += 1);
        let mut open: Vec<u32> = (0..index(self.places.len())).rev().collect();
        let mut is_open = vec![true; self.places.len()];
        while let Some(vertex) = open.pop() {
            items.next()?;
            is_open[vertex as usize] = false;
            if copies[self.point_of[vertex as usize] as usize] > 1 {
                continue;
            }
            let spokes: Vec<Spoke> = self.triangles.spokes(vertex).collect();
            let mut planes: Vec<u32> = spokes.iter().map(|s| self.plane(s.triangle)).collect();
            planes.sort_unstable();
            planes.dedup();
            if planes.len() > 2 || spokes.len() < 3 {
                continue;
            }
            let mut targets: Vec<u32> = spokes.iter().map(|spoke| spoke.next).collect();
            if planes.len() == 2 {
                // Only along the crease, where the triangles on the two sides are in different
                // planes.
                let before: HashMap<u32, u32> = spokes
                    .iter()
                    .map(|spoke| (spoke.last, spoke.triangle))
                    .collect();
                targets = spokes
                    .iter()
                    .filter(|spoke| {
                        before
                            .get(&spoke.next)
                            .is_some_and(|&b| self.plane(b) != self.plane(spoke.triangle))
                    })
                    .map(|spoke| spoke.next)
                    .collect();
                if targets.len() != 2 {
                    continue;
                }
            }
            // Targets with few triangles keep the rest fast, and avoid thin triangles.
            targets.sort_unstable_by_key(|&v| (self.triangles.around(v).len(), v));
            let Some(&target) = targets.iter().find(|&&target| {
                self.keeps_sides(target, vertex) && self.triangles.may_collapse(target, vertex)
            }) else {
                continue;
            };
            self.triangles.collapse(target, vertex);
            for Spoke { next, .. } in spokes {
                if !is_open[next as usize] {
                    is_open[next as usize] = true;
                    open.push(next);
                }
            }
        }
        Ok(())
    }

    /// Whether no triangle turns over or loses its area, seen in its plane, when `gone` moves to
    /// `kept`.
    fn keeps_sides(&self, kept: u32, gone: u32) -> bool {
        self.triangles.around(gone).all(|(t, triangle)| {
            if triangle.contains(&kept) {
                return true;
            }
            let Axis { number, .. } = self.surface.axis[self.planes[t as usize] as usize];
            let side = |triangle: [u32; 3]| {
                let points = triangle.map(|v| self.point(v));
                orientation(self.surface, number, points)
            };
            let moved = side(triangle.map(|v| if v == gone { kept } else { v }));
            moved != Sign::Zero && moved == side(triangle)
        })
    }

    /// Collapses edges of triangles without height, where that moves the surface by no more than
    /// rounding does.
    fn remove_needles(&mut self, work: Work) -> Result<(), Interrupted> {
        let items = work.items(self.planes.len());
        for t in 0..index(self.planes.len()) {
            items.next()?;
            let Some(triangle) = self.triangles.triangle(t) else {
                continue;
            };
            if !is_thin(self.corners(triangle)) {
                continue;
            }
            let edge = [[0, 1], [1, 2], [2, 0], [1, 0], [2, 1], [0, 2]]
                .map(|pair| pair.map(|k| triangle[k]))
                .into_iter()
                .find(|&[kept, gone]| {
                    self.stays_in_place(kept, gone) && self.triangles.may_collapse(kept, gone)
                });
            if let Some([kept, gone]) = edge {
                self.triangles.collapse(kept, gone);
            }
        }
        Ok(())
    }

    /// The corners of a triangle on the grid.
    fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|v| self.point(v).approximate)
    }

    /// Whether every triangle stays in its plane and does not turn over when `gone` moves to
    /// `kept`, up to rounding.
    fn stays_in_place(&self, kept: u32, gone: u32) -> bool {
        self.triangles.around(gone).all(|(_, triangle)| {
            if triangle.contains(&kept) {
                return true;
            }
            let before = self.corners(triangle);
            let after = self.corners(triangle.map(|v| if v == gone { kept } else { v }));
            match (is_thin(before), is_thin(after)) {
                (true, true) => true,
                (false, false) => {
                    let [old, new] = [before, after].map(|[a, b, c]| (b - a).cross(c - a));
                    let way = (0..3).map(|k| after[k] - before[k]).sum::<DVec3>();
                    old.dot(new) > 0.0 && old.normalize_or_zero().dot(way).abs() <= SAME_PLACE
                }
                _ => false,
            }
        })
    }

    fn finish(self) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let mut number = vec![u32::MAX; self.places.len()];
        let mut positions = Vec::new();
        let triangles = self
            .triangles
            .triangles()
            .map(|triangle| {
                triangle.map(|v| {
                    let slot = &mut number[v as usize];
                    if *slot == u32::MAX {
                        *slot = index(positions.len());
                        positions.push(self.places[v as usize]);
                    }
                    *slot
                })
            })
            .collect();
        (positions, triangles)
    }
}
