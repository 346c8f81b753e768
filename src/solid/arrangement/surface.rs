//! The input on an integer grid: coordinates for which planes, lengths and orientations can be computed exactly.

use super::Cancelled;
use super::sign::Sign;
use crate::Fault;
use crate::numeric::index;
use glam::{DVec3, Vec3Swizzles};
use std::collections::HashMap;

/// Bits of the largest coordinate on the grid. Differences of two coordinates are then exact in `f64`, and the components
/// of a plane's normal in `i128`.
const GRID_BITS: i32 = 52;

/// A closed surface of triangles with area, corners on the integer grid, equal positions and equal triangles joined.
pub(super) struct Surface {
    /// Integers.
    pub(super) corners: Vec<DVec3>,
    /// Where the corners were before they were put on the grid.
    pub(super) originals: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// How often each triangle is covered, against its orientation when negative; 0 where that cancels.
    pub(super) multiplicity: Vec<i32>,
    pub(super) edges: Vec<[u32; 2]>,
    /// Edge i of a triangle runs from corner i to the next.
    pub(super) triangle_edges: Vec<[u32; 3]>,
    /// The coordinate axis along which a triangle is projected.
    pub(super) axis: Vec<Axis>,
    /// Length of a grid unit: a power of two.
    pub(super) unit: f64,
}

/// A coordinate axis that the normal of a plane has a component along.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Axis {
    /// 0, 1 or 2.
    pub(super) number: usize,
    /// Whether the normal points along the axis, rather than against it.
    pub(super) is_forward: bool,
}

impl Axis {
    /// The two other axes, so that they and this one are right-handed.
    pub(super) fn others(number: usize) -> [usize; 2] {
        [(number + 1) % 3, (number + 2) % 3]
    }
}

/// The grid coordinate as an integer.
#[expect(
    clippy::cast_possible_truncation,
    reason = "grid coordinates are integers of 56 bits at most"
)]
pub(super) fn integer(x: f64) -> i128 {
    i128::from(x as i64)
}

/// Difference of two grid points, exactly.
pub(super) fn difference(a: DVec3, b: DVec3) -> [i128; 3] {
    (a - b).to_array().map(integer)
}

pub(super) fn cross(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
    [0, 1, 2].map(|i| {
        let [j, k] = Axis::others(i);
        a[j] * b[k] - a[k] * b[j]
    })
}

/// Sign of the scalar product of a normal and a difference of grid points.
fn sign_of_product(normal: [i128; 3], way: [i128; 3]) -> Sign {
    // 107 and 53 bits: the normal in two parts, the upper of 47 bits, so that all sums fit.
    const LOW_BITS: u32 = 60;
    let (mut upper, mut lower) = (0, 0);
    for i in 0..3 {
        upper += (normal[i] >> LOW_BITS) * way[i];
        lower += (normal[i] & ((1 << LOW_BITS) - 1)) * way[i];
    }
    match upper + (lower >> LOW_BITS) {
        0 => Sign::of_integer(lower & ((1 << LOW_BITS) - 1)),
        carried => Sign::of_integer(carried),
    }
}

impl Surface {
    /// Puts a surface on the grid.
    ///
    /// No vertex moves by more than half a rounding unit of the largest coordinate.
    pub(super) fn new(
        positions: &[DVec3],
        triangles: &[[u32; 3]],
        cancelled: Cancelled,
    ) -> Result<Surface, Fault> {
        if positions.iter().any(|p| !p.is_finite()) {
            return Err(Fault::new("a vertex of the cycle is not finite"));
        }
        let largest = positions
            .iter()
            .map(|p| p.abs().max_element())
            .fold(f64::MIN_POSITIVE, f64::max);
        // 2^-1000 .. 2^1000 keeps the unit and its inverse finite.
        let magnitude = largest.log2().ceil().clamp(-940.0, 1024.0);
        let scale = (f64::from(GRID_BITS) - magnitude).exp2();
        let mut corners = Vec::new();
        let mut originals = Vec::new();
        let mut places = HashMap::<[u64; 3], u32>::with_capacity(positions.len());
        let corner_of: Vec<u32> = positions
            .iter()
            .map(|&p| {
                let place = (p * scale).round() + DVec3::ZERO;
                *places
                    .entry(place.to_array().map(f64::to_bits))
                    .or_insert_with(|| {
                        corners.push(place);
                        originals.push(p);
                        index(corners.len() - 1)
                    })
            })
            .collect();
        let mut surface = Surface {
            corners,
            originals,
            triangles: Vec::new(),
            multiplicity: Vec::new(),
            edges: Vec::new(),
            triangle_edges: Vec::new(),
            axis: Vec::new(),
            unit: scale.recip(),
        };
        surface.add_triangles(triangles, &corner_of, cancelled)?;
        surface.add_edges();
        Ok(surface)
    }

    fn add_triangles(
        &mut self,
        triangles: &[[u32; 3]],
        corner_of: &[u32],
        cancelled: Cancelled,
    ) -> Result<(), Fault> {
        let mut known = HashMap::<[u32; 3], usize>::with_capacity(triangles.len());
        let mut all = Vec::<([u32; 3], i32)>::new();
        for triangle in triangles {
            if triangle.iter().any(|&v| v as usize >= corner_of.len()) {
                return Err(Fault::new("a triangle of the cycle has no such vertex"));
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
            if multiplicity == 0 && cancelled == Cancelled::Dropped {
                continue;
            }
            let normal = self.normal_of(triangle);
            let Some(number) = (0..3).max_by_key(|&i| normal[i].unsigned_abs()) else {
                continue;
            };
            if normal[number] == 0 {
                // A triangle without area bounds nothing; its neighbours meet where it was.
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

    fn add_edges(&mut self) {
        let mut known = HashMap::<[u32; 2], u32>::with_capacity(self.triangles.len() * 3 / 2);
        for &[a, b, c] in &self.triangles {
            self.triangle_edges
                .push([[a, b], [b, c], [c, a]].map(|[p, q]| {
                    let edge = [p.min(q), p.max(q)];
                    *known.entry(edge).or_insert_with(|| {
                        self.edges.push(edge);
                        index(self.edges.len() - 1)
                    })
                }));
        }
    }

    /// Corners of a triangle on the grid.
    pub(super) fn triangle(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|v| self.corners[v as usize])
    }

    /// Ends of an edge on the grid.
    pub(super) fn edge(&self, edge: u32) -> [DVec3; 2] {
        self.edges[edge as usize].map(|v| self.corners[v as usize])
    }

    fn normal_of(&self, corners: [u32; 3]) -> [i128; 3] {
        let [a, b, c] = corners.map(|v| self.corners[v as usize]);
        cross(difference(b, a), difference(c, a))
    }

    /// Normal of a triangle, of twice its area, exactly.
    pub(super) fn normal(&self, triangle: u32) -> [i128; 3] {
        self.normal_of(self.triangles[triangle as usize])
    }

    /// Orientation of three grid points seen against an axis, exactly.
    pub(super) fn orientation_of_corners(axis: usize, [a, b, c]: [DVec3; 3]) -> Sign {
        let [u, v] = Axis::others(axis);
        let (p, q) = (b - a, c - a);
        let (left, right) = (p[u] * q[v], p[v] * q[u]);
        let determinant = left - right;
        // Three roundings of half a unit each.
        if determinant.abs() > 4.0 * f64::EPSILON * (left.abs() + right.abs()) {
            return Sign::of_float(determinant);
        }
        // The corners of a frame are so far out that differences of floats are not exact.
        let [a, b, c] = [a, b, c].map(|p| p.to_array().map(integer));
        let minor = (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
        Sign::of_integer(minor)
    }

    /// Side of the plane of three grid points on which another lies, exactly: positive where the normal points.
    pub(super) fn side_of_plane([a, b, c]: [DVec3; 3], point: DVec3) -> Sign {
        let (x, y, z) = (b - a, c - a, point - a);
        let normal = x.cross(y);
        let size = (x.yzx() * y.zxy()).abs() + (x.zxy() * y.yzx()).abs();
        let volume = normal.dot(z);
        // Two products and a difference per component, a product and two sums after that.
        if volume.abs() > 8.0 * f64::EPSILON * size.dot(z.abs()) {
            return Sign::of_float(volume);
        }
        let normal = cross(x.to_array().map(integer), y.to_array().map(integer));
        sign_of_product(normal, z.to_array().map(integer))
    }

    /// Least box around a triangle.
    pub(super) fn box_of(&self, triangle: u32) -> [DVec3; 2] {
        let [a, b, c] = self.triangle(triangle);
        [a.min(b).min(c), a.max(b).max(c)]
    }
}
