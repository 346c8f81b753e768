//! Points of the arrangement: their definitions, their approximate places, and exact answers about
//! them.
//!
//! Every answer is first sought from the approximations and their error bounds; only if these leave
//! it open is it computed with integers of any length, from the definitions.

use super::surface::GridSurface;
use crate::numeric::exact::double::{DOUBLE_ROUNDOFF, Double};
use crate::numeric::exact::signs::Sign;
use crate::numeric::exact::spatial_grid::{self, Axis, difference, dot, integer, volume};
use dashu_int::IBig;
use glam::DVec3;
use std::cmp::Ordering;

/// The definition of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) enum Definition {
    /// A corner of the surface.
    Corner(u32),
    /// A corner, 0 to 2, of a triangle around everything, seen along a coordinate axis.
    Frame { corner: u8, axis: u8 },
    /// The point where an edge passes through the plane of a triangle.
    Pierce { edge: u32, triangle: u32 },
    /// The point where two edges of one plane cross, seen along a coordinate axis.
    Cross { edges: [u32; 2], axis: u8 },
    /// The point where the planes of three triangles meet.
    Meet([u32; 3]),
}

/// A point of the arrangement.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    pub(super) definition: Definition,
    /// Approximate coordinates on the grid of the surface, not rounded to integers.
    pub(super) approximate: DVec3,
    /// Bound on the error of every coordinate of `approximate`.
    pub(super) error: f64,
}

/// Error of a point, in grid units, above which its coordinates are computed exactly and rounded.
const LARGEST_ERROR: f64 = 2.0;

/// Half a unit in the last place of the largest grid coordinate, and the same for the sum that
/// leads to it.
const ROUNDING: f64 = 1.5;

impl Point {
    /// A corner of the surface.
    pub(super) fn corner(surface: &GridSurface, corner: u32) -> Point {
        Point {
            definition: Definition::Corner(corner),
            approximate: surface.corners[corner as usize],
            error: 0.0,
        }
    }

    pub(super) fn new(surface: &GridSurface, definition: Definition) -> Point {
        let (approximate, error) = match definition {
            Definition::Corner(corner) => return Point::corner(surface, corner),
            Definition::Frame { corner, axis } => (frame_corner(corner, axis), 0.0),
            Definition::Pierce { edge, triangle } => pierce(surface, edge, triangle),
            Definition::Cross { edges, axis } => crossing(surface, edges, axis),
            Definition::Meet(planes) => meet(surface, planes),
        };
        if error <= LARGEST_ERROR && approximate.is_finite() {
            Point {
                definition,
                approximate,
                error,
            }
        } else {
            Point {
                definition,
                approximate: rounded(&homogeneous(surface, &definition)),
                error: ROUNDING,
            }
        }
    }

    /// The position of the point in the coordinates of the input.
    pub(super) fn place(&self, surface: &GridSurface) -> DVec3 {
        match self.definition {
            Definition::Corner(v) => surface.originals[v as usize],
            _ => self.approximate * surface.unit,
        }
    }
}

/// The corners, counter-clockwise, of a triangle that contains the projection of every grid point
/// in its interior.
fn frame_corner(corner: u8, axis: u8) -> DVec3 {
    let [u, v] = Axis::others(usize::from(axis));
    let far = 2f64.powi(55);
    let mut place = DVec3::ZERO;
    // Not in line with anything parallel to an axis.
    [place[u], place[v]] = match corner {
        0 => [-far, -far],
        1 => [far, -0.875 * far],
        _ => [0.109_375 * far, far],
    };
    place
}

/// The point at `share` of a line, where the error of `share` is given; and the error of the point.
fn along(ends: [DVec3; 2], share: Double, share_error: f64) -> (DVec3, f64) {
    let way = ends[1] - ends[0];
    let place = DVec3::from_array(
        [0, 1, 2].map(|i| (Double::from(ends[0][i]) + share * Double::from(way[i])).value()),
    );
    (
        place,
        ROUNDING + way.abs().max_element() * (share_error + 4.0 * DOUBLE_ROUNDOFF),
    )
}

fn pierce(surface: &GridSurface, edge: u32, triangle: u32) -> (DVec3, f64) {
    let ends = surface.edge(edge);
    let plane = surface.triangle(triangle);
    let [(from, from_error), (to, to_error)] = ends.map(|p| volume(plane, p));
    let whole = from - to;
    let share_error = 2.0 * (from_error + to_error) / whole.value().abs();
    along(ends, from.over(whole), share_error)
}

fn crossing(surface: &GridSurface, edges: [u32; 2], axis: u8) -> (DVec3, f64) {
    let ends = surface.edge(edges[0]);
    let [num, den] = crossing_share(surface, edges, axis);
    along(
        ends,
        Double::from_integer(num).over(Double::from_integer(den)),
        8.0 * DOUBLE_ROUNDOFF,
    )
}

/// The parameter on the first edge at which the other crosses it: numerator and denominator.
fn crossing_share(surface: &GridSurface, edges: [u32; 2], axis: u8) -> [i128; 2] {
    let [p, q] = surface.edge(edges[0]);
    let [r, s] = surface.edge(edges[1]);
    let [u, v] = Axis::others(usize::from(axis));
    let (way, other, offset) = (difference(q, p), difference(s, r), difference(r, p));
    [offset, way].map(|x| x[u] * other[v] - x[v] * other[u])
}

fn meet(surface: &GridSurface, planes: [u32; 3]) -> (DVec3, f64) {
    let base = surface.triangle(planes[0])[0];
    let normals = planes.map(|t| surface.normal(t).map(Double::from_integer));
    let heights = planes.map(|t| {
        let normal = surface.normal(t);
        let offset = surface.triangle(t)[0] - base;
        let terms = [0, 1, 2].map(|i| Double::from_integer(normal[i]) * Double::from(offset[i]));
        let magnitude: f64 = terms.iter().map(|term| term.value().abs()).sum();
        (terms[0] + terms[1] + terms[2], magnitude)
    });
    let mut determinant = (Double::from(0.0), 0.0);
    let mut numerators = [(Double::from(0.0), 0.0); 3];
    for (i, height) in heights.into_iter().enumerate() {
        let [j, k] = Axis::others(i);
        for c in 0..3 {
            let [d, e] = Axis::others(c);
            let (p, q) = (normals[j][d] * normals[k][e], normals[j][e] * normals[k][d]);
            let minor = p - q;
            let magnitude = p.value().abs() + q.value().abs();
            numerators[c].0 = numerators[c].0 + height.0 * minor;
            numerators[c].1 += height.1 * magnitude;
            if i == 0 {
                determinant.0 = determinant.0 + normals[0][c] * minor;
                determinant.1 += normals[0][c].value().abs() * magnitude;
            }
        }
    }
    let (whole, whole_magnitude) = determinant;
    let mut error = ROUNDING;
    let place = DVec3::from_array([0, 1, 2].map(|c| {
        let (numerator, magnitude) = numerators[c];
        let offset = numerator.over(whole);
        let relative = 16.0 * DOUBLE_ROUNDOFF / whole.value().abs();
        let coordinate_error = relative * (magnitude + offset.value().abs() * whole_magnitude);
        error = f64::max(error, ROUNDING + 2.0 * coordinate_error);
        // An error above the determinant itself is useless.
        if relative * whole_magnitude > 0.25 {
            error = f64::INFINITY;
        }
        (Double::from(base[c]) + offset).value()
    }));
    (place, error)
}

/// The exact coordinates x, y, z over a common denominator w > 0.
pub(super) type Homogeneous = [IBig; 4];

fn long(x: i128) -> IBig {
    IBig::from(x)
}

/// The exact coordinates of a point.
pub(super) fn homogeneous(surface: &GridSurface, definition: &Definition) -> Homogeneous {
    let on_line = |[p, q]: [DVec3; 2], numerator: IBig, denominator: IBig| {
        let (start, way) = (p.to_array().map(integer), difference(q, p));
        let coordinate = |i: usize| long(start[i]) * &denominator + long(way[i]) * &numerator;
        positive([
            coordinate(0),
            coordinate(1),
            coordinate(2),
            denominator.clone(),
        ])
    };
    match *definition {
        Definition::Corner(corner) => {
            let [x, y, z] = surface.corners[corner as usize].to_array().map(integer);
            [long(x), long(y), long(z), IBig::ONE]
        }
        Definition::Frame { corner, axis } => {
            let [x, y, z] = frame_corner(corner, axis).to_array().map(integer);
            [long(x), long(y), long(z), IBig::ONE]
        }
        Definition::Pierce { edge, triangle } => {
            let ends = surface.edge(edge);
            let normal = surface.normal(triangle);
            let base = surface.triangle(triangle)[0];
            let (to_plane, way) = (difference(base, ends[0]), difference(ends[1], ends[0]));
            on_line(ends, dot(normal, to_plane), dot(normal, way))
        }
        Definition::Cross { edges, axis } => {
            let [numerator, denominator] = crossing_share(surface, edges, axis).map(long);
            on_line(surface.edge(edges[0]), numerator, denominator)
        }
        Definition::Meet(planes) => {
            let normals = planes.map(|t| surface.normal(t).map(long));
            let heights = planes.map(|t| {
                dot(
                    surface.normal(t),
                    surface.triangle(t)[0].to_array().map(integer),
                )
            });
            let minor = |i: usize, c: usize| {
                let ([j, k], [d, e]) = (Axis::others(i), Axis::others(c));
                &normals[j][d] * &normals[k][e] - &normals[j][e] * &normals[k][d]
            };
            let [x, y, z] = [0, 1, 2].map(|c| {
                &heights[0] * minor(0, c) + &heights[1] * minor(1, c) + &heights[2] * minor(2, c)
            });
            let w = &normals[0][0] * minor(0, 0)
                + &normals[0][1] * minor(0, 1)
                + &normals[0][2] * minor(0, 2);
            positive([x, y, z, w])
        }
    }
}

fn positive(point: Homogeneous) -> Homogeneous {
    if Sign::of_long(&point[3]) == Sign::Negative {
        point.map(|x| -x)
    } else {
        point
    }
}

fn rounded(point: &Homogeneous) -> DVec3 {
    // Eleven bits more than the grid has: the quotient is then rounded once, to a float.
    let coordinate = |i: usize| {
        let quotient = (&point[i] << 11) / &point[3];
        quotient.to_f64().value() / 2048.0
    };
    DVec3::new(coordinate(0), coordinate(1), coordinate(2))
}

/// The orientation of three points seen against a coordinate axis from their approximations, if
/// these are accurate enough.
pub(super) fn approximate_orientation(axis: usize, [a, b, c]: [&Point; 3]) -> Option<Sign> {
    let [u, v] = Axis::others(axis);
    let (p, q) = (b.approximate - a.approximate, c.approximate - a.approximate);
    let (p_error, q_error) = (a.error + b.error, a.error + c.error);
    let (left, right) = (p[u] * q[v], p[v] * q[u]);
    let bound = p_error * (q[u].abs() + q[v].abs())
        + q_error * (p[u].abs() + p[v].abs())
        + 2.0 * p_error * q_error
        + 4.0 * f64::EPSILON * (left.abs() + right.abs());
    let determinant = left - right;
    // The bound itself is rounded too.
    (determinant.abs() > bound * (1.0 + 16.0 * f64::EPSILON)).then(|| Sign::of_float(determinant))
}

/// The orientation of three points seen against a coordinate axis.
pub(super) fn orientation(surface: &GridSurface, axis: usize, points: [&Point; 3]) -> Sign {
    if let Some(sign) = approximate_orientation(axis, points) {
        return sign;
    }
    if points.iter().all(|p| p.error == 0.0) {
        return spatial_grid::orientation(axis, points.map(|p| p.approximate));
    }
    let [a, b, c] = points.map(|p| homogeneous(surface, &p.definition));
    exact_orientation(axis, [&a, &b, &c])
}

/// The orientation of three points by their exact coordinates.
pub(super) fn exact_orientation(axis: usize, [a, b, c]: [&Homogeneous; 3]) -> Sign {
    let [u, v] = Axis::others(axis);
    let difference = |p: &Homogeneous, i: usize| &p[i] * &a[3] - &a[i] * &p[3];
    Sign::of_long(&(difference(b, u) * difference(c, v) - difference(b, v) * difference(c, u)))
}

/// The order of two points by one coordinate.
pub(super) fn order(surface: &GridSurface, axis: usize, a: &Point, b: &Point) -> Ordering {
    let apart = a.approximate[axis] - b.approximate[axis];
    if apart.abs() > (a.error + b.error) * (1.0 + 4.0 * f64::EPSILON) {
        return apart.total_cmp(&0.0);
    }
    if a.definition == b.definition || (a.error == 0.0 && b.error == 0.0) {
        return Ordering::Equal;
    }
    let [p, q] = [a, b].map(|point| homogeneous(surface, &point.definition));
    (&p[axis] * &q[3]).cmp(&(&q[axis] * &p[3]))
}

/// Whether the error bounds allow two points to be equal.
pub(super) fn may_be_equal(a: &Point, b: &Point) -> bool {
    (a.approximate - b.approximate).abs().max_element()
        <= (a.error + b.error) * (1.0 + 4.0 * f64::EPSILON)
}

/// Whether two points are equal.
pub(super) fn are_equal(surface: &GridSurface, a: &Point, b: &Point) -> bool {
    if a.definition == b.definition {
        return true;
    }
    if !may_be_equal(a, b) || (a.error == 0.0 && b.error == 0.0) {
        return false;
    }
    let [p, q] = [a, b].map(|point| homogeneous(surface, &point.definition));
    (0..3).all(|i| &p[i] * &q[3] == &q[i] * &p[3])
}

/// The order of the heights of the planes of two triangles along an axis, at a grid point; neither
/// plane is parallel to the axis.
pub(super) fn order_of_heights(
    surface: &GridSurface,
    axis: usize,
    place: DVec3,
    planes: [u32; 2],
) -> Ordering {
    let [(p, p_below), (q, q_below)] = planes.map(|t| {
        let (normal, base) = (surface.normal(t), surface.triangle(t)[0]);
        let mut to_base = difference(base, place);
        to_base[axis] = integer(base[axis]);
        // The height times the component along the axis.
        let height = dot(normal, to_base);
        let sign = Sign::of_integer(normal[axis]) == Sign::Positive;
        if sign {
            (height, long(normal[axis]))
        } else {
            (-height, long(-normal[axis]))
        }
    });
    (p * q_below).cmp(&(q * p_below))
}
