//! Triangles for the polygons of a file.

use crate::numeric::exact::signs::{Side, side_of_line};
use glam::{DVec2, DVec3};

/// Most containment tests per corner, and in all, before a polygon is given up. Drawn outlines of a
/// hundred thousand corners need far fewer, and a hostile one costs a few seconds at most.
const TESTS_PER_CORNER: usize = 20_000;
const TESTS: usize = 500_000_000;

/// Appends triangles that fill a polygon, with its orientation; false when the outline is too
/// intricate.
///
/// - `corners`: indices into `positions`; a corner that repeats the one before it is skipped. Fewer
///   than three corners give no triangle.
///
/// A convex polygon becomes a fan from its first corner. Others are cut into ears in the projection
/// along the axis that is closest to their normal, with exact signs. Whatever the shape, the
/// directed edges of the result are those of the polygon and diagonals in pairs of opposite sense:
/// closed meshes stay closed.
pub(super) fn triangulate(
    positions: &[DVec3],
    corners: &[u32],
    triangles: &mut Vec<[u32; 3]>,
) -> bool {
    let mut corners = corners.to_vec();
    corners.dedup();
    while corners.len() > 1 && corners.first() == corners.last() {
        corners.pop();
    }
    if corners.len() < 3 {
        return true;
    }
    if let [a, b, c] = corners[..] {
        triangles.push([a, b, c]);
        return true;
    }
    let mut outline = RemainingPolygon::new(projected(positions, &corners), corners);
    while outline.left > 3 {
        let Some(ear) = outline.next_ear() else {
            return false;
        };
        triangles.push(outline.cut(ear));
    }
    triangles.push(outline.triangle(outline.start));
    true
}

/// What a message says was found where [`triangulate`] fails.
pub(super) fn too_involved(corners: usize) -> String {
    format!(
        "one of {corners} corners that takes more than {} comparisons to cut into triangles",
        TESTS.min(TESTS_PER_CORNER * corners)
    )
}

/// The corners projected along the axis closest to the normal of the polygon, seen against it. The
/// coordinates are used as they are.
fn projected(positions: &[DVec3], corners: &[u32]) -> Vec<DVec2> {
    let points: Vec<DVec3> = corners.iter().map(|&v| positions[v as usize]).collect();
    let normal: DVec3 = (1..points.len() - 1)
        .map(|i| (points[i] - points[0]).cross(points[i + 1] - points[0]))
        .sum();
    let size = normal.abs();
    let axis = if size.x > size.y && size.x > size.z {
        0
    } else if size.y > size.z {
        1
    } else {
        2
    };
    let (first, second) = ((axis + 1) % 3, (axis + 2) % 3);
    let flat = |p: &DVec3| DVec2::new(p[first], p[second]);
    points
        .iter()
        .map(flat)
        .map(|p| {
            if normal[axis] < 0.0 {
                DVec2::new(p.y, p.x)
            } else {
                p
            }
        })
        .collect()
}

/// The remaining outline of a polygon, counter-clockwise.
struct RemainingPolygon {
    points: Vec<DVec2>,
    corners: Vec<u32>,
    next: Vec<usize>,
    previous: Vec<usize>,
    hollow: Hollow,
    left: usize,
    start: usize,
    tests: usize,
}

impl RemainingPolygon {
    fn new(points: Vec<DVec2>, corners: Vec<u32>) -> RemainingPolygon {
        let n = points.len();
        let mut outline = RemainingPolygon {
            next: (1..n).chain([0]).collect(),
            previous: std::iter::once(n - 1).chain(0..n - 1).collect(),
            hollow: Hollow::default(),
            left: n,
            start: 1,
            tests: TESTS.min(TESTS_PER_CORNER * n),
            points,
            corners,
        };
        let hollow: Vec<usize> = (0..n).filter(|&i| outline.turn(i) != Side::Above).collect();
        outline.hollow = Hollow::new(&outline.points, &hollow);
        outline
    }

    fn turn(&self, i: usize) -> Side {
        side_of_line(
            self.points[self.previous[i]],
            self.points[i],
            self.points[self.next[i]],
        )
    }

    fn triangle(&self, i: usize) -> [u32; 3] {
        [self.previous[i], i, self.next[i]].map(|j| self.corners[j])
    }

    /// Removes a corner.
    fn cut(&mut self, i: usize) -> [u32; 3] {
        let triangle = self.triangle(i);
        let (before, after) = (self.previous[i], self.next[i]);
        self.next[before] = after;
        self.previous[after] = before;
        self.left -= 1;
        self.start = after;
        self.hollow.remove(i, self.points[i]);
        for other in [before, after] {
            if self.turn(other) == Side::Above {
                self.hollow.remove(other, self.points[other]);
            }
        }
        triangle
    }

    /// The next corner that can be cut: an ear or, where the outline crosses itself or runs over
    /// itself, the flattest choice. `None` when the tests are used up.
    fn next_ear(&mut self) -> Option<usize> {
        let mut i = self.start;
        let mut straight = None;
        for _ in 0..self.left {
            match self.turn(i) {
                Side::Above => {
                    let mut tests = 0;
                    let corners = [self.previous[i], i, self.next[i]].map(|k| self.points[k]);
                    let is_blocked = self.hollow.any_near(corners, |j| {
                        tests += 1;
                        self.covers(i, j)
                    });
                    self.tests = self.tests.checked_sub(tests)?;
                    if !is_blocked {
                        return Some(i);
                    }
                }
                Side::On => straight = straight.or(Some(i)),
                Side::Below => {}
            }
            self.tests = self.tests.checked_sub(1)?;
            i = self.next[i];
        }
        straight.or(Some(i))
    }

    /// Whether corner `j` lies in the closed triangle at corner `i`; corners at the same place as
    /// one of its own do not count.
    fn covers(&self, i: usize, j: usize) -> bool {
        let [a, b, c] = [self.previous[i], i, self.next[i]].map(|k| self.points[k]);
        let p = self.points[j];
        p != a
            && p != b
            && p != c
            && [(a, b), (b, c), (c, a)]
                .iter()
                .all(|&(s, t)| side_of_line(s, t, p) != Side::Below)
    }
}

/// Corners that are not strictly convex, by place: only they can lie in an ear.
#[derive(Default)]
struct Hollow {
    /// Rows of a grid over all these corners, with about as many cells as corners.
    rows: Vec<Vec<Vec<usize>>>,
    /// The smallest box around them.
    low: DVec2,
    high: DVec2,
    /// Cells per length; 0 along an axis on which the corners have no extent.
    density: DVec2,
}

/// Margin in the search for corners near a triangle, as a share of the largest coordinate: a
/// hundred times the rounding of the places where its sides meet the rows.
const MARGIN: f64 = 1e-13;

impl Hollow {
    fn new(points: &[DVec2], corners: &[usize]) -> Hollow {
        let side = corners.len().isqrt() + 1;
        let places = || corners.iter().map(|&corner| points[corner]);
        let low = places().reduce(DVec2::min).unwrap_or_default();
        let high = places().reduce(DVec2::max).unwrap_or_default();
        let size = high - low;
        let density = DVec2::select(size.cmpgt(DVec2::ZERO), side as f64 / size, DVec2::ZERO);
        let mut hollow = Hollow {
            rows: vec![vec![Vec::new(); side]; side],
            low,
            high,
            density,
        };
        for &corner in corners {
            let [x, y] = hollow.cell(points[corner]);
            hollow.rows[y][x].push(corner);
        }
        hollow
    }

    /// Column and row; they do not fall where the coordinates rise.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the cast saturates, and what is no number becomes 0"
    )]
    fn cell(&self, place: DVec2) -> [usize; 2] {
        let cells = (place - self.low) * self.density;
        cells
            .to_array()
            .map(|x| (x as usize).min(self.rows.len().saturating_sub(1)))
    }

    /// Nothing happens when the corner is not there.
    fn remove(&mut self, corner: usize, place: DVec2) {
        let [x, y] = self.cell(place);
        self.rows[y][x].retain(|&other| other != corner);
    }

    /// Whether a test holds for any corner that may lie in a triangle: in each row, those between
    /// its sides.
    fn any_near(&self, triangle: [DVec2; 3], mut test: impl FnMut(usize) -> bool) -> bool {
        let [a, b, c] = triangle;
        let [bottom, top] = [a.min(b).min(c), a.max(b).max(c)];
        let corners = [bottom, top, self.low, self.high];
        let margin = corners
            .map(DVec2::abs)
            .into_iter()
            .fold(DVec2::ZERO, DVec2::max)
            * MARGIN;
        let [first, last] = [self.cell(bottom)[1], self.cell(top)[1]];
        (first..=last).any(|row| {
            let slab = self.slab(row);
            let slab = [slab[0] - margin.y, slab[1] + margin.y];
            let [mut left, mut right] = [f64::INFINITY, f64::NEG_INFINITY];
            let mut reach = |x: f64| (left, right) = (left.min(x), right.max(x));
            for (p, q) in [(a, b), (b, c), (c, a)] {
                if slab[0] <= p.y && p.y <= slab[1] {
                    reach(p.x);
                }
                for y in slab {
                    if (p.y < y) != (q.y < y) {
                        reach(p.x + (q.x - p.x) * ((y - p.y) / (q.y - p.y)));
                    }
                }
            }
            if left > right {
                return false;
            }
            let column = |x: f64| self.cell(DVec2::new(x, bottom.y))[0];
            let columns = column(left - margin.x)..=column(right + margin.x);
            self.rows[row][columns]
                .iter()
                .flatten()
                .any(|&corner| test(corner))
        })
    }

    /// The lowest and highest y of a row.
    fn slab(&self, row: usize) -> [f64; 2] {
        if self.density.y == 0.0 {
            return [self.low.y, self.high.y];
        }
        let at = |row: usize| self.low.y + row as f64 / self.density.y;
        [at(row), at(row + 1)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn filled(points: &[[f64; 3]]) -> Vec<[u32; 3]> {
        let positions: Vec<DVec3> = points.iter().map(|&p| DVec3::from_array(p)).collect();
        let corners: Vec<u32> = (0u32..).take(points.len()).collect();
        let mut triangles = Vec::new();
        assert!(
            triangulate(&positions, &corners, &mut triangles),
            "not too involved"
        );
        triangles
    }

    /// Signed areas of the triangles projected along the z axis.
    fn areas(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<f64> {
        let at = |v: u32| DVec3::from_array(points[v as usize]);
        triangles
            .iter()
            .map(|&[a, b, c]| (at(b) - at(a)).cross(at(c) - at(a)).z / 2.0)
            .collect()
    }

    #[test]
    fn a_convex_polygon_is_a_fan_from_its_first_corner() {
        let square = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ];
        assert_eq!(filled(&square), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn a_hollow_polygon_is_filled_without_overlap_in_either_sense() {
        // An L of area 3, and a comb of area 7 with a straight corner.
        let l = [[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]];
        let comb = [
            [0., 0.],
            [2., 0.],
            [5., 0.],
            [5., 2.],
            [4., 2.],
            [4., 1.],
            [3., 1.],
            [3., 2.],
            [2., 2.],
            [2., 1.],
            [1., 1.],
            [1., 2.],
            [0., 2.],
        ];
        for (outline, area) in [(&l[..], 3.0), (&comb[..], 8.0)] {
            let points: Vec<[f64; 3]> = outline.iter().map(|&[x, y]| [x, y, 0.25 * x]).collect();
            let found = areas(&points, &filled(&points));
            assert!(
                found.iter().all(|&a| a >= 0.0),
                "no triangle is turned over: {found:?}"
            );
            assert!(
                (found.iter().sum::<f64>() - area).abs() < 1e-12,
                "area {area}: {found:?}"
            );
            let reversed: Vec<[f64; 3]> = points.into_iter().rev().collect();
            let found = areas(&reversed, &filled(&reversed));
            assert!(found.iter().all(|&a| a <= 0.0), "clockwise: {found:?}");
            assert!(
                (found.iter().sum::<f64>() + area).abs() < 1e-12,
                "area {area}: {found:?}"
            );
        }
    }

    #[test]
    fn the_boundary_is_that_of_the_polygon_whatever_its_shape() {
        // A bow tie, a polygon on a line, one with coinciding corners: no sensible triangles exist,
        // but closed stays closed.
        let shapes: [&[[f64; 3]]; 3] = [
            &[[0., 0., 0.], [1., 1., 0.], [1., 0., 0.], [0., 1., 0.]],
            &[
                [0., 0., 0.],
                [1., 0., 0.],
                [2., 0., 0.],
                [3., 0., 0.],
                [1.5, 0., 0.],
            ],
            &[
                [0., 0., 0.],
                [1., 0., 0.],
                [1., 0., 0.],
                [1., 1., 0.],
                [0., 0., 0.],
            ],
        ];
        for points in shapes {
            let mut balance = std::collections::BTreeMap::new();
            for [a, b, c] in filled(points) {
                for [from, to] in [[a, b], [b, c], [c, a]] {
                    *balance.entry([from.min(to), from.max(to)]).or_insert(0) +=
                        if from < to { 1 } else { -1 };
                }
            }
            let n = u32::try_from(points.len()).expect("few corners");
            for i in 0..n {
                let (from, to) = (i, (i + 1) % n);
                *balance.entry([from.min(to), from.max(to)]).or_insert(0) -=
                    if from < to { 1 } else { -1 };
            }
            assert!(
                balance.values().all(|&sum| sum == 0),
                "{points:?}: {balance:?}"
            );
        }
    }

    #[test]
    fn repeated_corners_and_short_polygons_give_nothing_wrong() {
        let positions = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let mut triangles = Vec::new();
        for corners in [&[][..], &[0], &[0, 1], &[0, 0, 1, 1, 0]] {
            assert!(
                triangulate(&positions, corners, &mut triangles),
                "{corners:?}"
            );
        }
        assert_eq!(triangles, [[0u32; 3]; 0], "fewer than three corners");
        assert!(
            triangulate(&positions, &[0, 0, 1, 2, 2, 0], &mut triangles),
            "a triangle"
        );
        assert_eq!(triangles, [[0, 1, 2]], "repeated corners are one");
    }

    #[test]
    fn combs_of_a_hundred_thousand_corners_are_filled() {
        // Comparing every pair of the hollow corners between the teeth would take 2e9 tests.
        let teeth = 50_000;
        let tooth = |i: u32| {
            let x = f64::from(teeth - i);
            [[x - 0.4, 100.0, 0.0], [x - 0.7, 1.0, 0.0]]
        };
        let base = [[0.0, 0.0, 0.0], [f64::from(teeth), 0.0, 0.0]];
        let comb: Vec<[f64; 3]> = base.into_iter().chain((0..teeth).flat_map(tooth)).collect();
        let triangles = filled(&comb);
        assert_eq!(triangles.len(), comb.len() - 2, "all of it");
        let found = areas(&comb, &triangles);
        assert!(
            found.iter().all(|&a| a >= 0.0),
            "no triangle is turned over"
        );
        let shoelace = comb.iter().zip(comb.iter().cycle().skip(1));
        let area = shoelace
            .map(|(p, q)| p[0] * q[1] - p[1] * q[0])
            .sum::<f64>()
            / 2.0;
        assert!(
            (found.iter().sum::<f64>() / area - 1.0).abs() < 1e-9,
            "area {area}"
        );
    }

    #[test]
    fn outlines_of_ten_thousand_corners_are_filled() {
        // A gear of 2,500 teeth, with half of its corners hollow, and a spiral band.
        let polar = |radius: f64, angle: f64| [radius * angle.cos(), radius * angle.sin(), 0.0];
        let gear: Vec<[f64; 3]> = (0..10_000)
            .map(|i| {
                polar(
                    if i / 2 % 2 == 0 { 1.0 } else { 1.1 },
                    TAU * f64::from(i) / 1e4,
                )
            })
            .collect();
        let inner = (0..5_000)
            .map(|i| f64::from(i) * 5e-3)
            .map(|a| polar(1.0 + a, a));
        let outer = (0..5_000)
            .rev()
            .map(|i| f64::from(i) * 5e-3)
            .map(|a| polar(1.5 + a, a));
        let spiral: Vec<[f64; 3]> = outer.chain(inner).rev().collect();
        for points in [gear, spiral] {
            let shoelace = points.iter().zip(points.iter().cycle().skip(1));
            let area = shoelace
                .map(|(p, q)| p[0] * q[1] - p[1] * q[0])
                .sum::<f64>()
                / 2.0;
            let triangles = filled(&points);
            let found = areas(&points, &triangles);
            assert_eq!(triangles.len(), points.len() - 2, "all of it");
            assert!(
                found.iter().all(|a| a * area >= 0.0),
                "no triangle is turned over"
            );
            assert!(
                (found.iter().sum::<f64>() / area - 1.0).abs() < 1e-9,
                "area {area}"
            );
        }
    }
}
