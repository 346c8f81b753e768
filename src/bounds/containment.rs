//! Inside, on, or outside a closed surface, by the exact winding number.

use super::tree::SurfaceTree;
use crate::numeric::exact::signs::{Side, side_of_line, side_of_plane};
use glam::{DVec2, DVec3};
use std::collections::BTreeMap;

/// Where a point lies with respect to a closed oriented surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Location {
    /// Off the surface, winding number at least 1.
    Inside,
    /// On a triangle.
    On,
    /// Off the surface, winding number 0 or less.
    Outside,
}

impl SurfaceTree {
    /// Where `point` lies with respect to the closed surface; shells may nest (cavities) and
    /// overlap.
    ///
    /// # Guarantee
    /// Exact for the coordinates as given, even for points on edges, vertices and planes of faces.
    /// The surface must be closed; for an open one the answer is meaningless.
    ///
    /// # Cost
    /// One half line through the tree: some 0.3 microseconds for 7,000 triangles
    /// (`benches/membership.rs`).
    pub fn locate(&self, point: DVec3) -> Location {
        match self.winding_number(point) {
            None => Location::On,
            Some(winding) if winding >= 1 => Location::Inside,
            Some(_) => Location::Outside,
        }
    }

    /// How many times the closed surface winds around `point`, or `None` on the surface. Exact.
    pub fn winding_number(&self, point: DVec3) -> Option<i32> {
        let mut winding = Some(0);
        self.for_each_passage(point, |_, passage| count(&mut winding, passage));
        winding
    }

    /// [`SurfaceTree::winding_number`] of each part of the surface separately, where it is not 0.
    ///
    /// - `part`: the part to which each triangle belongs; every part is closed.
    ///
    /// The parts are in ascending order. The cost is that of one half line through all of them.
    pub(crate) fn winding_numbers(
        &self,
        point: DVec3,
        part: impl Fn(u32) -> u32,
    ) -> Vec<(u32, Option<i32>)> {
        let mut windings = BTreeMap::new();
        self.for_each_passage(point, |triangle, passage| {
            if !matches!(passage, Passage::Beside) {
                count(windings.entry(part(triangle)).or_insert(Some(0)), passage);
            }
        });
        windings.retain(|_, winding| *winding != Some(0));
        windings.into_iter().collect()
    }

    /// Visits the triangles near a half line from a point to the outside.
    fn for_each_passage(&self, point: DVec3, mut visit: impl FnMut(u32, Passage)) {
        let Some([min, max]) = self.bounds() else {
            return;
        };
        if point.cmplt(min).any() || point.cmpgt(max).any() {
            return;
        }
        // Any half line would do; the one that leaves the box first meets the fewest triangles.
        let [to_min, to_max] = [point - min, max - point];
        let forward = if to_max.min_element() <= to_min.min_element() {
            1
        } else {
            -1
        };
        let distances = if forward > 0 { to_max } else { to_min };
        let axis = distances
            .to_array()
            .iter()
            .position(|&distance| distance == distances.min_element())
            .unwrap_or(0);
        self.for_each_along_axis(point, axis, forward, |triangle| {
            visit(
                triangle,
                passage(self.corners(triangle), point, axis, forward),
            );
        });
    }
}

/// Adds a passage to a winding number. `None` means on the surface, whatever else is passed.
fn count(winding: &mut Option<i32>, passage: Passage) {
    *winding = match passage {
        Passage::On => None,
        Passage::Through(change) => winding.map(|winding| winding + change),
        Passage::Beside => *winding,
    };
}

/// How a half line along an axis meets a triangle.
enum Passage {
    /// It starts on the closed triangle.
    On,
    /// It passes through: 1 along the normal (leaving the body), -1 against it.
    Through(i32),
    /// It passes by.
    Beside,
}

/// The half line is moved sideways by (e, e^2) for an infinitely small e: it then never meets an
/// edge or a vertex, and triangles that share an edge agree about which of them is hit. Where the
/// start is off the surface, this changes no winding number.
fn passage(corners: [DVec3; 3], point: DVec3, axis: usize, forward: i32) -> Passage {
    let flat = corners.map(|corner| across(corner, axis));
    let target = across(point, axis);
    let sides: [(DVec2, DVec2); 3] = [(flat[0], flat[1]), (flat[1], flat[2]), (flat[2], flat[0])];
    let turns = sides.map(|(from, to)| turn(from, to, target));
    if turns.contains(&1) && turns.contains(&-1) {
        return Passage::Beside;
    }
    let [a, b, c] = corners;
    let height = sign(side_of_plane(a, b, c, point));
    if height == 0 && is_in_closed_triangle(corners, point) {
        return Passage::On;
    }
    let moved = |k: usize| match turns[k] {
        0 => turn_beside(sides[k]),
        sign => sign,
    };
    let orientation = moved(0);
    if orientation == 0 || moved(1) != orientation || moved(2) != orientation {
        return Passage::Beside;
    }
    // `orientation` is the sign of the normal along the axis.
    if orientation * height * forward < 0 {
        Passage::Through(orientation * forward)
    } else {
        Passage::Beside
    }
}

/// 1 when `a`, `b`, `c` run counter-clockwise, -1 when clockwise, 0 on a line. Exact.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> i32 {
    sign(side_of_line(a, b, c))
}

fn sign(side: Side) -> i32 {
    match side {
        Side::Above => 1,
        Side::On => 0,
        Side::Below => -1,
    }
}

/// Sign of `turn(from, to, p + (e, e^2))` where `turn(from, to, p)` is 0.
fn turn_beside((from, to): (DVec2, DVec2)) -> i32 {
    let along = |from: f64, to: f64| i32::from(to > from) - i32::from(to < from);
    match along(to.y, from.y) {
        0 => along(from.x, to.x),
        sign => sign,
    }
}

/// Whether a point in the plane of a triangle (any point, if the triangle has no area) lies on the
/// triangle.
///
/// It does if and only if it does in all three projections along the axes: otherwise one of them
/// separates it from the triangle.
fn is_in_closed_triangle(corners: [DVec3; 3], point: DVec3) -> bool {
    let [a, b, c] = corners;
    let in_box = point.cmpge(a.min(b).min(c)).all() && point.cmple(a.max(b).max(c)).all();
    in_box
        && (0..3).all(|axis| {
            let [a, b, c] = corners.map(|corner| across(corner, axis));
            let target = across(point, axis);
            let turns = [turn(a, b, target), turn(b, c, target), turn(c, a, target)];
            !(turns.contains(&1) && turns.contains(&-1))
        })
}

/// The two coordinates across an axis; they and the axis, in this order, are right-handed.
fn across(point: DVec3, axis: usize) -> DVec2 {
    DVec2::new(point[(axis + 1) % 3], point[(axis + 2) % 3])
}
