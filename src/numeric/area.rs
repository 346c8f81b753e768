//! Area vectors of triangles, accurate for slivers too.

use super::difference_of_products;
use glam::DVec3;

/// Sine of the angle at a corner below which a plain cross product loses more than two digits.
pub(crate) const THIN: f64 = 0.01;

/// (b - a) x (c - a): the normal of the triangle, as long as twice its area.
///
/// The error is a few unit roundoffs of the product of the two lengths where the sine of the angle
/// at `a` is above [`THIN`]. Below, it is a few unit roundoffs of the result's own length, unless
/// that sine is near the unit roundoff itself.
pub(crate) fn area_vector([a, b, c]: [DVec3; 3]) -> DVec3 {
    let (along, back) = (b - a, c - a);
    let plain = along.cross(back);
    if plain.length_squared() >= THIN * THIN * along.length_squared() * back.length_squared() {
        return plain;
    }
    // The differences with their rounding errors, and products whose difference is accurate.
    let (along_tail, back_tail) = (tail(b, a, along), tail(c, a, back));
    let leading = DVec3::new(
        difference_of_products(along.y, back.z, along.z, back.y),
        difference_of_products(along.z, back.x, along.x, back.z),
        difference_of_products(along.x, back.y, along.y, back.x),
    );
    leading + (along.cross(back_tail) + along_tail.cross(back))
}

/// Rounding error of a difference (Knuth): to - from = rounded + tail, exactly.
fn tail(to: DVec3, from: DVec3, rounded: DVec3) -> DVec3 {
    let virtual_from = to - rounded;
    let virtual_to = rounded + virtual_from;
    (to - virtual_to) + (virtual_from - from)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with exact integers, for corners with integer coordinates below 2^55.
    fn check(corners: [[i64; 3]; 3]) {
        let exact = {
            let [a, b, c] = corners.map(|corner| corner.map(i128::from));
            let (p, q): ([i128; 3], [i128; 3]) = (
                std::array::from_fn(|k| b[k] - a[k]),
                std::array::from_fn(|k| c[k] - a[k]),
            );
            [0, 1, 2].map(|k| {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                (p[i] * q[j] - p[j] * q[i]) as f64
            })
        };
        let found = area_vector(corners.map(|corner| DVec3::from_array(corner.map(|x| x as f64))));
        let error = found.distance(DVec3::from_array(exact));
        let limit = 1e-15 * DVec3::from_array(exact).length();
        assert!(error <= limit, "{corners:?}: {found} for {exact:?}");
    }

    #[test]
    fn slivers_of_any_height_have_a_sharp_area_vector() {
        let (b, step) = ([1 << 50, (1 << 50) / 3, -(1 << 49)], [7, -11, 5]);
        for height in [0, 2, 10, 20, 30, 40] {
            let c = [0, 1, 2].map(|k| b[k] / 2 + (step[k] << height));
            check([[0; 3], b, c]);
            // Away from the origin, with the corners in every order; 2^52 keeps the coordinates
            // integers.
            let away = [1 << 52, -(1 << 52), 12345];
            let moved = [[0; 3], b, c].map(|corner| [0, 1, 2].map(|k| corner[k] + away[k]));
            check([moved[2], moved[0], moved[1]]);
        }
    }

    #[test]
    fn an_ordinary_triangle_has_its_plain_cross_product() {
        let found = area_vector([DVec3::Z, DVec3::X + DVec3::Z, 2.0 * DVec3::Y + DVec3::Z]);
        assert_eq!(
            found,
            2.0 * DVec3::Z,
            "an area of 1, counter-clockwise from above"
        );
    }
}
