//! The winding number of other shells around a point, from the crossings of the upward ray.
//!
//! The triangles are kept in a pyramid of square grids over the xy plane. Each is on the level
//! whose cells are just larger than it, so that it lies in at most 4 cells. A query examines one
//! cell per level.

use crate::numeric::exact::signs::{Side, side_of_line, side_of_plane};
use glam::{DVec2, DVec3, Vec3Swizzles};

/// Finest level: 2^15 cells per side.
const LEVELS: u32 = 16;

/// Triangles prepared for vertical rays.
pub(super) struct Columns<'a> {
    positions: &'a [DVec3],
    triangles: &'a [[u32; 3]],
    origin: DVec2,
    width: f64,
    /// Pairs of (level, column, row) and triangle, sorted.
    entries: Vec<([u32; 3], u32)>,
}

impl<'a> Columns<'a> {
    /// Sorts the triangles into cells; O(n log n).
    pub(super) fn new(positions: &'a [DVec3], triangles: &'a [[u32; 3]]) -> Columns<'a> {
        let corners = || {
            triangles
                .iter()
                .flatten()
                .map(|&v| positions[v as usize].xy())
        };
        let origin = corners().reduce(DVec2::min).unwrap_or_default();
        let top = corners().reduce(DVec2::max).unwrap_or_default();
        let width = (top - origin).max_element().max(f64::MIN_POSITIVE);
        let mut columns = Columns {
            positions,
            triangles,
            origin,
            width,
            entries: Vec::with_capacity(triangles.len()),
        };
        for (f, triangle) in (0u32..).zip(triangles) {
            let [a, b, c] = triangle.map(|v| positions[v as usize].xy());
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            let size = (high - low).max_element();
            let level = (0..LEVELS)
                .rev()
                .find(|&l| size <= width / f64::from(1u32 << l))
                .unwrap_or(0);
            let (low, high) = (columns.cell(level, low), columns.cell(level, high));
            for x in low[1]..=high[1] {
                for y in low[2]..=high[2] {
                    columns.entries.push(([level, x, y], f));
                }
            }
        }
        columns.entries.sort_unstable();
        columns
    }

    /// The cell of a point; monotone in each coordinate, so that a point between two others is in a
    /// cell between theirs.
    fn cell(&self, level: u32, point: DVec2) -> [u32; 3] {
        let count = f64::from(1u32 << level);
        let of = |offset: f64| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "clamped to the cells"
            )]
            let index = (offset / self.width * count)
                .floor()
                .clamp(0.0, count - 1.0) as u32;
            index
        };
        [
            level,
            of(point.x - self.origin.x),
            of(point.y - self.origin.y),
        ]
    }

    /// How often the triangles for which `counts` holds wind around `point`; `None` when the point
    /// may lie on one of them.
    ///
    /// The triangles that count must form closed surfaces. Signs are exact.
    pub(super) fn winding_number(&self, point: DVec3, counts: impl Fn(u32) -> bool) -> Option<i32> {
        let mut winding = 0;
        for level in 0..LEVELS {
            let cell = self.cell(level, point.xy());
            let start = self.entries.partition_point(|entry| entry.0 < cell);
            for &(_, f) in self.entries[start..]
                .iter()
                .take_while(|entry| entry.0 == cell)
            {
                if counts(f) {
                    winding += self.crossing(f, point)?;
                }
            }
        }
        Some(winding)
    }

    /// +1 where the upward ray leaves through triangle `f`, -1 where it enters, 0 where it misses;
    /// `None` when the point lies both in the plane and in the box of the triangle.
    fn crossing(&self, f: u32, point: DVec3) -> Option<i32> {
        let [a, b, c] = self.triangles[f as usize].map(|v| self.positions[v as usize]);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        if point.z > high.z || point.xy().cmplt(low.xy()).any() || point.xy().cmpgt(high.xy()).any()
        {
            return Some(0);
        }
        let side = side_of_plane(a, b, c, point);
        if side == Side::On && point.z >= low.z {
            return None;
        }
        let around: i32 = [(a, b), (b, c), (c, a)]
            .into_iter()
            .map(|(from, to)| step(from.xy(), to.xy(), point.xy()))
            .sum();
        // Seen from above, the corners run counter-clockwise when `around` is 1: the normal points
        // up.
        Some(match (around, side) {
            (1, Side::Below) => 1,
            (-1, Side::Above) => -1,
            _ => 0,
        })
    }
}

/// Contribution of an edge to the winding number of a polygon at `point`: +1 when it crosses the
/// ray in direction x upwards. Edges are half open, so that a point on a shared edge or vertex
/// belongs to one of the triangles there.
fn step(from: DVec2, to: DVec2, point: DVec2) -> i32 {
    if from.y <= point.y && point.y < to.y {
        i32::from(side_of_line(from, to, point) == Side::Above)
    } else if to.y <= point.y && point.y < from.y {
        -i32::from(side_of_line(from, to, point) == Side::Below)
    } else {
        0
    }
}

#[cfg(test)]
mod tests {
    use super::super::shell::tests::{boxes, sphere};
    use super::*;
    use std::f64::consts::TAU;

    /// The winding number by solid angles (van Oosterom and Strackee), slow and independent of any
    /// ray.
    fn by_solid_angle(positions: &[DVec3], triangles: &[[u32; 3]], point: DVec3) -> f64 {
        let angle = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| positions[v as usize] - point);
            let (la, lb, lc) = (a.length(), b.length(), c.length());
            2.0 * a
                .dot(b.cross(c))
                .atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
        };
        triangles.iter().map(angle).sum::<f64>() / (2.0 * TAU)
    }

    #[test]
    fn the_winding_number_agrees_with_solid_angles() {
        let mut mesh = sphere(20);
        boxes(&mut mesh, DVec3::splat(-0.25), DVec3::splat(1.5), true);
        boxes(
            &mut mesh,
            DVec3::splat(0.25),
            DVec3::new(0.375, 0.25, 0.5),
            false,
        );
        let (positions, triangles) = mesh;
        let columns = Columns::new(&positions, &triangles);
        // The grid points lie exactly on planes, edges and vertices of the boxes, in space and in
        // projection.
        let mut decided = 0;
        for i in 0..4096 {
            let point = DVec3::new(
                f64::from(i % 16),
                f64::from(i / 16 % 16),
                f64::from(i / 256),
            ) * 0.125
                - 0.5;
            let expected = by_solid_angle(&positions, &triangles, point);
            if let Some(found) = columns.winding_number(point, |_| true) {
                decided += 1;
                assert!(
                    (f64::from(found) - expected).abs() < 1e-6,
                    "{point}: {found} against {expected}"
                );
            }
        }
        assert!(decided > 3000, "most points lie on no triangle: {decided}");
    }

    #[test]
    fn a_point_on_a_triangle_is_not_decided() {
        let mut mesh = (Vec::new(), Vec::new());
        boxes(&mut mesh, DVec3::ZERO, DVec3::ONE, true);
        let columns = Columns::new(&mesh.0, &mesh.1);
        for place in [
            DVec3::ZERO,
            DVec3::new(0.5, 0.5, 1.0),
            DVec3::new(0.0, 0.5, 0.5),
            DVec3::new(1.0, 0.25, 1.0),
        ] {
            assert_eq!(
                columns.winding_number(place, |_| true),
                None,
                "{place} is on the box"
            );
        }
        assert_eq!(
            columns.winding_number(DVec3::splat(0.5), |_| true),
            Some(1),
            "the centre"
        );
        assert_eq!(
            columns.winding_number(DVec3::new(0.5, 0.5, -1.0), |_| true),
            Some(0),
            "below"
        );
    }
}
