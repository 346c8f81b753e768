//! Fewer triangles for the same surface: vertices inside a plane or on a straight crease go, by edge collapses that are exact.

use super::boundary::Boundary;
use super::heal::SAME_PLACE;
use super::point::{Point, orientation};
use super::surface::Surface;
use crate::numeric::exact::signs::Sign;
use crate::numeric::exact::spatial_grid::Axis;
use crate::numeric::index;
use glam::DVec3;
use std::collections::HashMap;

/// The surface with positions in the coordinates of the input.
pub(super) fn simplified(
    surface: &Surface,
    points: &[Point],
    plane_of: &[u32],
    boundary: Boundary,
) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let places: Vec<DVec3> = boundary
        .points
        .iter()
        .map(|&p| points[p as usize].place(surface))
        .collect();
    let mut around = vec![Vec::new(); places.len()];
    for (number, triangle) in boundary.triangles.iter().enumerate() {
        triangle
            .iter()
            .for_each(|&v| around[v as usize].push(index(number)));
    }
    let mut mesh = Mesh {
        surface,
        points,
        plane_of,
        places,
        boundary,
        around,
    };
    mesh.straighten();
    mesh.remove_needles();
    mesh.finish()
}

struct Mesh<'a> {
    surface: &'a Surface,
    points: &'a [Point],
    plane_of: &'a [u32],
    places: Vec<DVec3>,
    boundary: Boundary,
    /// Triangles at each vertex, ascending by age; exact.
    around: Vec<Vec<u32>>,
}

/// Whether the height of a triangle, on the grid, is no more than rounding.
fn is_thin([a, b, c]: [DVec3; 3]) -> bool {
    let longest = [b - a, c - b, a - c]
        .map(DVec3::length)
        .into_iter()
        .fold(0.0, f64::max);
    (b - a).cross(c - a).length() <= SAME_PLACE * longest
}

/// A triangle that is gone.
const GONE: [u32; 3] = [u32::MAX; 3];

impl Mesh<'_> {
    fn plane(&self, triangle: u32) -> u32 {
        self.plane_of[self.boundary.planes[triangle as usize] as usize]
    }

    /// Other vertices of the triangles at a vertex, each with the triangle that has it after the vertex.
    fn ring(&self, vertex: u32) -> Vec<(u32, u32)> {
        self.around[vertex as usize]
            .iter()
            .map(|&t| {
                let triangle = self.boundary.triangles[t as usize];
                let k = triangle.iter().position(|&v| v == vertex).unwrap_or(0);
                (triangle[(k + 1) % 3], t)
            })
            .collect()
    }

    /// Removes vertices that lie inside a plane or a straight crease, until none is left that can go.
    fn straighten(&mut self) {
        // Where the region touches itself every copy of a point stays, so that what touches fits together.
        let mut copies = vec![0_u32; self.points.len()];
        self.boundary
            .points
            .iter()
            .for_each(|&p| copies[p as usize] += 1);
        let mut open: Vec<u32> = (0..index(self.places.len())).rev().collect();
        let mut is_open = vec![true; self.places.len()];
        while let Some(vertex) = open.pop() {
            is_open[vertex as usize] = false;
            if copies[self.boundary.points[vertex as usize] as usize] > 1 {
                continue;
            }
            let ring = self.ring(vertex);
            let mut planes: Vec<u32> = ring.iter().map(|&(_, t)| self.plane(t)).collect();
            planes.sort_unstable();
            planes.dedup();
            if planes.len() > 2 || ring.len() < 3 {
                continue;
            }
            let mut targets: Vec<u32> = ring.iter().map(|&(other, _)| other).collect();
            if planes.len() == 2 {
                // Only along the crease: where the triangles on the two sides are of different planes.
                let before: HashMap<u32, u32> = self.around[vertex as usize]
                    .iter()
                    .map(|&t| {
                        let triangle = self.boundary.triangles[t as usize];
                        let k = triangle.iter().position(|&v| v == vertex).unwrap_or(0);
                        (triangle[(k + 2) % 3], t)
                    })
                    .collect();
                targets = ring
                    .iter()
                    .filter(|(other, t)| {
                        before
                            .get(other)
                            .is_some_and(|&b| self.plane(b) != self.plane(*t))
                    })
                    .map(|&(other, _)| other)
                    .collect();
                if targets.len() != 2 {
                    continue;
                }
            }
            // Few triangles at the target keep the rest fast, and the triangles fat.
            targets.sort_unstable_by_key(|&v| (self.around[v as usize].len(), v));
            let Some(&target) = targets
                .iter()
                .find(|&&target| self.keeps_sides(target, vertex) && self.is_legal(target, vertex))
            else {
                continue;
            };
            self.collapse(target, vertex);
            for (other, _) in ring {
                if !is_open[other as usize] {
                    is_open[other as usize] = true;
                    open.push(other);
                }
            }
        }
    }

    /// Whether no triangle turns over, or loses its area, when `gone` moves to `kept`: seen in the triangles' planes.
    fn keeps_sides(&self, kept: u32, gone: u32) -> bool {
        self.around[gone as usize].iter().all(|&t| {
            let triangle = self.boundary.triangles[t as usize];
            if triangle.contains(&kept) {
                return true;
            }
            let Axis { number, .. } = self.surface.axis[self.boundary.planes[t as usize] as usize];
            let side = |triangle: [u32; 3]| {
                let points =
                    triangle.map(|v| &self.points[self.boundary.points[v as usize] as usize]);
                orientation(self.surface, number, points)
            };
            let moved = side(triangle.map(|v| if v == gone { kept } else { v }));
            moved != Sign::Zero && moved == side(triangle)
        })
    }

    /// Whether the surface stays a manifold of the same kind when the edge is collapsed: its ends have exactly the two
    /// neighbours opposite it in common, and no two triangles fall together.
    fn is_legal(&self, kept: u32, gone: u32) -> bool {
        let ring = self.ring(gone);
        let common = ring
            .iter()
            .filter(|&&(other, _)| self.is_edge(other, kept))
            .count();
        // Of a tetrahedron two triangles would remain, one on the other.
        common == 2
            && ring.iter().any(|&(other, _)| other == kept)
            && !(ring.len() == 3 && self.around[kept as usize].len() == 3)
    }

    fn is_edge(&self, a: u32, b: u32) -> bool {
        let (few, other) = if self.around[a as usize].len() < self.around[b as usize].len() {
            (a, b)
        } else {
            (b, a)
        };
        a != b
            && self.around[few as usize]
                .iter()
                .any(|&t| self.boundary.triangles[t as usize].contains(&other))
    }

    fn collapse(&mut self, kept: u32, gone: u32) {
        for t in std::mem::take(&mut self.around[gone as usize]) {
            let triangle = self.boundary.triangles[t as usize];
            if triangle.contains(&kept) {
                for v in triangle {
                    self.around[v as usize].retain(|&other| other != t);
                }
                self.boundary.triangles[t as usize] = GONE;
            } else {
                self.boundary.triangles[t as usize] =
                    triangle.map(|v| if v == gone { kept } else { v });
                self.around[kept as usize].push(t);
            }
        }
    }

    /// Collapses edges at triangles without height, where that moves the surface by no more than rounding does.
    fn remove_needles(&mut self) {
        for t in 0..self.boundary.triangles.len() {
            let triangle = self.boundary.triangles[t];
            if triangle == GONE || !is_thin(self.corners(triangle)) {
                continue;
            }
            let edge = [[0, 1], [1, 2], [2, 0], [1, 0], [2, 1], [0, 2]]
                .map(|pair| pair.map(|k| triangle[k]))
                .into_iter()
                .find(|&[kept, gone]| self.stays_in_place(kept, gone) && self.is_legal(kept, gone));
            if let Some([kept, gone]) = edge {
                self.collapse(kept, gone);
            }
        }
    }

    /// Corners of a triangle on the grid.
    fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|v| self.points[self.boundary.points[v as usize] as usize].approximate)
    }

    /// Whether every triangle stays in its plane and does not turn over when `gone` moves to `kept`, up to rounding.
    fn stays_in_place(&self, kept: u32, gone: u32) -> bool {
        self.around[gone as usize].iter().all(|&t| {
            let triangle = self.boundary.triangles[t as usize];
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
            .boundary
            .triangles
            .iter()
            .filter(|&&triangle| triangle != GONE)
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
