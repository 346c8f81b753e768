//! The integer grid on which curves are arranged, with the exact decisions on it.

use crate::numeric::tolerance::{GRID_BITS, GRID_LEAST_BITS};
use glam::DVec2;

/// A point of the grid, in cells from its centre; coordinates are at most 2^40 + 1 in size.
pub(crate) type Node = [i64; 2];

/// A square grid around some points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Grid {
    /// A multiple of the cell.
    centre: DVec2,
    /// A power of two.
    cell: f64,
}

impl Grid {
    /// The grid for finite points: its cell is 2^-40 of half their extent, rounded up to a power of
    /// two, but not below 2^-52 of their largest coordinate, so that its points are exact in `f64`.
    pub(crate) fn around(points: &[DVec2]) -> Grid {
        let empty = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (low, high) = points
            .iter()
            .fold(empty, |(low, high), &p| (low.min(p), high.max(p)));
        if points.is_empty() {
            return Grid {
                centre: DVec2::ZERO,
                cell: 1.0,
            };
        }
        let half = (high * 0.5 - low * 0.5).max_element();
        let largest = low.abs().max(high.abs()).max_element();
        let cell = power(half, GRID_BITS).max(power(largest, GRID_LEAST_BITS));
        let middle = low * 0.5 + high * 0.5;
        Grid {
            centre: (middle / cell).round() * cell,
            cell,
        }
    }

    /// Side of a cell.
    pub(crate) fn cell(&self) -> f64 {
        self.cell
    }

    /// The nearest point of the grid.
    #[allow(
        clippy::cast_possible_truncation,
        reason = "rounded before, and at most 2^40 + 1 for the points that the grid is made for"
    )]
    pub(crate) fn nearest(&self, point: DVec2) -> Node {
        ((point - self.centre) / self.cell)
            .round()
            .to_array()
            .map(|x| x as i64)
    }

    /// Where a point of the grid lies: exact.
    pub(crate) fn place(&self, node: Node) -> DVec2 {
        self.centre + local(node) * self.cell
    }
}

/// The least power of two that is not below `length`, divided by 2^`bits`.
fn power(length: f64, bits: f64) -> f64 {
    // A cell must be a normal number: coordinates of 1e-300 count as zero.
    let exponent = length.log2().ceil().max(LEAST_EXPONENT);
    (exponent - bits).exp2()
}

/// Extents below 2^-900 are treated as 2^-900.
const LEAST_EXPONENT: f64 = -900.0;

/// Coordinates in cells, exact.
pub(crate) fn local(node: Node) -> DVec2 {
    DVec2::from_array(node.map(|x| x as f64))
}

/// (a - o) x (b - o): twice the signed area of the triangle o a b, exact.
pub(crate) fn cross(o: Node, a: Node, b: Node) -> i128 {
    product([a[0] - o[0], a[1] - o[1]], [b[0] - o[0], b[1] - o[1]])
}

fn product(a: [i64; 2], b: [i64; 2]) -> i128 {
    i128::from(a[0]) * i128::from(b[1]) - i128::from(a[1]) * i128::from(b[0])
}

/// Whether the closed segment, with `ends` in ascending order, meets the pixel of `node`: the
/// points that round to the node, including the lower and left sides.
pub(crate) fn meets_pixel(ends: [Node; 2], node: Node) -> bool {
    let [a, b] = ends;
    let way = [b[0] - a[0], b[1] - a[1]];
    // All corners of the pixel are on one side of the line as soon as the centre is this far from
    // it.
    if cross(a, b, node).abs() * 2 > i128::from(way[0].abs() + way[1].abs()) {
        return false;
    }
    // In half cells, the pixel is [x0, x1) x [y0, y1).
    let [a, b] = [a, b].map(|end| end.map(|x| 2 * x));
    let ([x0, y0], [x1, y1]) = (node.map(|x| 2 * x - 1), node.map(|x| 2 * x + 1));
    if way[0] == 0 {
        return x0 <= a[0] && a[0] < x1 && b[1] >= y0 && a[1] < y1;
    }
    // The part of the segment over [x0, x1): from `left`, included, to `right`, which may be
    // excluded.
    let left = a[0].max(x0);
    let (right, right_is_in) = if b[0] < x1 { (b[0], true) } else { (x1, false) };
    if left > right || (left == right && !right_is_in) {
        return false;
    }
    // Sign of the height of the line at x, minus y.
    let above = |x: i64, y: i64| -product(way, [x - a[0], y - a[1]]).signum();
    match way[1].signum() {
        1 => {
            let end = above(right, y0);
            above(left, y1) < 0 && (end > 0 || (end == 0 && right_is_in))
        }
        -1 => above(left, y0) >= 0 && above(right, y1) < 0,
        _ => y0 <= a[1] && a[1] < y1,
    }
}

/// The point of the grid whose pixel holds the proper crossing of two segments.
pub(crate) fn crossing([a, b]: [Node; 2], [c, d]: [Node; 2]) -> Node {
    let way = [b[0] - a[0], b[1] - a[1]];
    let other = [d[0] - c[0], d[1] - c[1]];
    let mut part = product([c[0] - a[0], c[1] - a[1]], other);
    let mut whole = product(way, other);
    if whole < 0 {
        (part, whole) = (-part, -whole);
    }
    let fraction = part as f64 / whole as f64;
    [0, 1].map(|k| {
        let guess = way[k] as f64 * fraction;
        let rounded = (guess + 0.5).floor();
        // The guess is off by less than 2^41 * 4 u, far less than this margin.
        if (guess + 0.5 - rounded - 0.5).abs() < 0.5 - ROUNDING_MARGIN {
            #[allow(
                clippy::cast_possible_truncation,
                reason = "an integer between the coordinates of the ends"
            )]
            let steps = rounded as i64;
            return a[k] + steps;
        }
        // Exact: floor(way part / whole + 1/2). Products stay below 2^126.
        let steps = (2 * i128::from(way[k]) * part + whole).div_euclid(2 * whole);
        a[k] + i64::try_from(steps).unwrap_or_default()
    })
}

/// Distance from the border of a pixel within which exact arithmetic decides on a crossing, in
/// cells.
const ROUNDING_MARGIN: f64 = 1.0 / 128.0;

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether the segment meets the pixel, by exact clipping with fractions over the denominators
    /// 2 dx and 2 dy of the parameter along the segment: slow and plain.
    fn meets_by_clipping([a, b]: [Node; 2], node: Node) -> bool {
        // Bounds on the parameter t in [0, 1], as fractions (numerator, positive denominator,
        // whether included).
        let mut lower = vec![(0_i128, 1_i128, true)];
        let mut upper = vec![(1_i128, 1_i128, true)];
        for k in 0..2 {
            let way = i128::from(2 * (b[k] - a[k]));
            let from_low = i128::from(2 * node[k] - 1 - 2 * a[k]);
            let from_high = i128::from(2 * node[k] + 1 - 2 * a[k]);
            match way.signum() {
                1 => {
                    lower.push((from_low, way, true));
                    upper.push((from_high, way, false));
                }
                -1 => {
                    lower.push((-from_high, -way, false));
                    upper.push((-from_low, -way, true));
                }
                _ if from_low <= 0 && from_high > 0 => {}
                _ => return false,
            }
        }
        lower.iter().all(|low| {
            upper.iter().all(|high| {
                let (left, right) = (low.0 * high.1, high.0 * low.1);
                left < right || (left == right && low.2 && high.2)
            })
        })
    }

    #[test]
    fn pixels_are_met_as_by_plain_clipping() {
        let mut met = 0;
        for bx in 0..=4 {
            for by in -4..=4 {
                for x in -2..=6 {
                    for y in -6..=6 {
                        let ends = [[0, 0], [bx, by]];
                        if ends[0] >= ends[1] {
                            continue;
                        }
                        let expected = meets_by_clipping(ends, [x, y]);
                        assert_eq!(meets_pixel(ends, [x, y]), expected, "{ends:?} [{x}, {y}]");
                        met += usize::from(expected);
                    }
                }
            }
        }
        assert!(met > 200, "{met} pixels were met");
    }

    #[test]
    fn crossings_round_to_the_pixel_that_holds_them() {
        let far = 1_i64 << 40;
        // The first two cross at (0.5, 0.5), the next two at (-0.5, 0.5): halves round up and to
        // the right.
        assert_eq!(crossing([[0, 0], [1, 1]], [[0, 1], [1, 0]]), [1, 1]);
        assert_eq!(crossing([[-1, 0], [0, 1]], [[-1, 1], [0, 0]]), [0, 1]);
        // Almost parallel, through (0, 0) exactly.
        let found = crossing(
            [[-far, -far + 1], [far, far - 1]],
            [[-far + 1, -far], [far - 1, far]],
        );
        assert_eq!(found, [0, 0]);
        // Both segments meet the pixel of every crossing.
        for k in 1..200 {
            let ends = [[-far, 3 * k], [far - k, k * k]];
            let other = [[k - far, -far], [7 * k, far - k]];
            let node = crossing(ends, other);
            assert!(meets_pixel(ends, node) && meets_pixel(other, node), "{k}");
        }
    }

    #[test]
    fn the_grid_is_fine_about_a_small_drawing_far_away() {
        let points = [DVec2::splat(1e6), DVec2::splat(1e6 + 1.0)];
        let grid = Grid::around(&points);
        assert_eq!(grid.cell(), (-32.0_f64).exp2(), "2^-52 of 2^20");
        for point in points {
            assert_eq!(grid.place(grid.nearest(point)), point);
        }
        let grid = Grid::around(&[DVec2::ZERO, DVec2::ONE]);
        assert_eq!(grid.cell(), (-41.0_f64).exp2(), "2^-40 of one half");
    }

    #[test]
    fn points_in_one_place_and_denormal_ones_have_a_grid() {
        for points in [
            vec![],
            vec![DVec2::ZERO],
            vec![DVec2::splat(3.0); 2],
            vec![DVec2::ZERO, DVec2::splat(f64::MIN_POSITIVE)],
        ] {
            let grid = Grid::around(&points);
            assert!(grid.cell() > 0.0);
            for &point in &points {
                assert!(grid.place(grid.nearest(point)).distance(point) <= grid.cell());
            }
        }
    }
}
