//! The integer grid of space: coordinates for which planes, lengths and orientations can be
//! computed exactly, and the exact decisions on them.
//!
//! A point of the grid is a `DVec3` of integers, in units of the grid from the origin.

use super::double::{DOUBLE_ROUNDOFF, Double};
use super::signs::Sign;
use dashu_int::IBig;
use glam::{DVec3, Vec3Swizzles};

/// Bits of the largest coordinate on the grid. Differences of two coordinates are then exact in
/// `f64`, and the components of a plane's normal in `i128`.
const GRID_BITS: i32 = 52;

/// A cubic grid around the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Grid {
    /// Units of the grid per unit of length: a power of two.
    scale: f64,
}

impl Grid {
    /// The grid for finite points: its unit is 2^-52 of their largest coordinate, rounded up to a
    /// power of two.
    pub(crate) fn around(points: &[DVec3]) -> Grid {
        let largest = points
            .iter()
            .map(|p| p.abs().max_element())
            .fold(f64::MIN_POSITIVE, f64::max);
        // 2^-1000 .. 2^1000 keeps the unit and its inverse finite.
        let magnitude = largest.log2().ceil().clamp(-940.0, 1024.0);
        Grid {
            scale: (f64::from(GRID_BITS) - magnitude).exp2(),
        }
    }

    /// Length of a unit: a power of two.
    pub(crate) fn unit(&self) -> f64 {
        self.scale.recip()
    }

    /// The nearest point of the grid, without negative zeros.
    pub(crate) fn nearest(&self, point: DVec3) -> DVec3 {
        (point * self.scale).round() + DVec3::ZERO
    }
}

/// A coordinate axis along which the normal of a plane has a component.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Axis {
    /// 0, 1 or 2.
    pub(crate) number: usize,
    /// Whether the normal points along the axis, rather than against it.
    pub(crate) is_forward: bool,
}

impl Axis {
    /// The two other axes, in the order that makes them and this one right-handed.
    pub(crate) fn others(number: usize) -> [usize; 2] {
        [(number + 1) % 3, (number + 2) % 3]
    }
}

/// The grid coordinate as an integer.
#[expect(
    clippy::cast_possible_truncation,
    reason = "grid coordinates are integers of 56 bits at most"
)]
pub(crate) fn integer(x: f64) -> i128 {
    i128::from(x as i64)
}

/// Difference of two grid points, exactly.
pub(crate) fn difference(a: DVec3, b: DVec3) -> [i128; 3] {
    (a - b).to_array().map(integer)
}

pub(crate) fn cross(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
    [0, 1, 2].map(|i| {
        let [j, k] = Axis::others(i);
        a[j] * b[k] - a[k] * b[j]
    })
}

/// Sign of the scalar product of a normal and a difference of grid points.
fn sign_of_product(normal: [i128; 3], way: [i128; 3]) -> Sign {
    // The factors have 107 and 53 bits: the normal is split in two, with 47 bits in the upper part,
    // so that all sums fit.
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

/// Orientation of three grid points seen against an axis, exactly.
pub(crate) fn orientation(axis: usize, [a, b, c]: [DVec3; 3]) -> Sign {
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

/// Side of the plane of three grid points on which another lies, exactly: positive where the normal
/// points.
pub(crate) fn side_of_plane([a, b, c]: [DVec3; 3], point: DVec3) -> Sign {
    let (x, y, z) = (b - a, c - a, point - a);
    let normal = x.cross(y);
    let size = (x.yzx() * y.zxy()).abs() + (x.zxy() * y.yzx()).abs();
    let volume = normal.dot(z);
    // Two products and a difference per component, then a product and two sums.
    if volume.abs() > 8.0 * f64::EPSILON * size.dot(z.abs()) {
        return Sign::of_float(volume);
    }
    let normal = cross(x.to_array().map(integer), y.to_array().map(integer));
    sign_of_product(normal, z.to_array().map(integer))
}

/// Six times the signed volume of a tetrahedron, and a bound on its error for corners on the grid.
pub(crate) fn volume([a, b, c]: [DVec3; 3], p: DVec3) -> (Double, f64) {
    let (x, y, z) = (b - a, c - a, p - a);
    let mut sum = Double::from(0.0);
    let mut magnitude = 0.0;
    for i in 0..3 {
        let [j, k] = Axis::others(i);
        let minor = Double::product(x[j], y[k]) - Double::product(x[k], y[j]);
        sum = sum + minor * Double::from(z[i]);
        magnitude += ((x[j] * y[k]).abs() + (x[k] * y[j]).abs()) * z[i].abs();
    }
    (sum, 8.0 * DOUBLE_ROUNDOFF * magnitude)
}

/// Sign of one component of the product of two normals.
pub(crate) fn product_component(axis: usize, a: [i128; 3], b: [i128; 3]) -> Sign {
    let [u, v] = Axis::others(axis);
    let (left, right) = (a[u] as f64 * b[v] as f64, a[v] as f64 * b[u] as f64);
    let apart = left - right;
    if apart.abs() > 4.0 * f64::EPSILON * (left.abs() + right.abs()) {
        return Sign::of_float(apart);
    }
    Sign::of_long(&(IBig::from(a[u]) * IBig::from(b[v]) - IBig::from(a[v]) * IBig::from(b[u])))
}

/// Scalar product.
pub(crate) fn dot(a: [i128; 3], b: [i128; 3]) -> IBig {
    IBig::from(a[0]) * IBig::from(b[0])
        + IBig::from(a[1]) * IBig::from(b[1])
        + IBig::from(a[2]) * IBig::from(b[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Corners at the border of the grid, one unit off a plane or on it.
    #[test]
    fn sides_and_orientations_are_those_of_long_integers() {
        let far = 2f64.powi(GRID_BITS);
        let [a, b] = [
            DVec3::new(-far, 1.0 - far, 3.0),
            DVec3::new(far, far - 7.0, -far),
        ];
        let c = DVec3::new(5.0, far, far - 1.0);
        let mut seen = [0; 3];
        for shift in [-1.0, 0.0, 1.0] {
            for middle in [a.midpoint(b), b.midpoint(c), c, DVec3::ZERO] {
                let point = middle.floor() + DVec3::Z * shift;
                let normal = cross(difference(b, a), difference(c, a));
                let side = Sign::of_long(&dot(normal, difference(point, a)));
                assert_eq!(side_of_plane([a, b, c], point), side, "{point}");
                let [u, v] = Axis::others(2);
                let [p, q] = [difference(b, a), difference(point, a)];
                let minor =
                    IBig::from(p[u]) * IBig::from(q[v]) - IBig::from(p[v]) * IBig::from(q[u]);
                assert_eq!(
                    orientation(2, [a, b, point]),
                    Sign::of_long(&minor),
                    "{point}"
                );
                seen[side as usize] += 1;
            }
        }
        assert!(seen.iter().all(|&times| times > 0), "all three: {seen:?}");
    }

    #[test]
    fn the_largest_coordinate_takes_all_bits() {
        let grid = Grid::around(&[DVec3::new(0.0, -3.0, 1.0)]);
        assert_eq!(grid.unit(), 2f64.powi(2 - GRID_BITS), "4 is the next power");
        assert_eq!(grid.nearest(DVec3::NEG_Y * 3.0).y, -3.0 / grid.unit());
        assert!(grid.nearest(-DVec3::ZERO).x.is_sign_positive());
        let none = Grid::around(&[DVec3::ZERO]);
        assert!(none.unit().is_normal() && none.unit().recip().is_finite());
    }
}
