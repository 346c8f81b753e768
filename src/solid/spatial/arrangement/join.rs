//! Joins points that are equal though defined differently.
//!
//! Only points whose error boxes meet can be equal. For these a [`Fingerprint`] is computed, once
//! per point: equal points have equal fingerprints, and only points with equal ones are compared
//! exactly. So a crowd of points that are nearly but not quite equal, as where many sheets nearly
//! pass through one place, costs no more than its number.

use super::point::{Homogeneous, Point, are_equal, homogeneous, may_be_equal};
use super::surface::GridSurface;
use crate::numeric::cubes;
use crate::numeric::index;
use crate::watch::{Interrupted, Work};
use dashu_int::IBig;
use dashu_int::ops::Gcd;
use glam::DVec3;
use rayon::prelude::*;

/// Width of the cells in which points are compared, in grid units: far more than any error bound,
/// and far less than a surface.
pub(super) const CELL: f64 = 1024.0;

/// For each point, the first point that equals it.
pub(super) fn first_equal(
    surface: &GridSurface,
    points: &[Point],
    work: Work,
) -> Result<Vec<u32>, Interrupted> {
    let mut cells: Vec<([i64; 3], u32)> = points
        .par_iter()
        .enumerate()
        .flat_map_iter(|(number, point)| {
            let number = index(number);
            cubes(around(point), CELL).map(move |cube| (cube.to_array(), number))
        })
        .collect();
    work.sort(&mut cells)?;
    let mut unsure: Vec<u32> = cells
        .par_chunk_by(|a, b| a.0 == b.0)
        .filter(|cell| cell.len() > 1)
        .flat_map_iter(|cell| {
            cell.iter().enumerate().filter_map(|(place, &(_, a))| {
                let is_near = |&(_, b): &([i64; 3], u32)| {
                    let [a, b] = [a, b].map(|number| &points[number as usize]);
                    (a.error > 0.0 || b.error > 0.0) && may_be_equal(a, b)
                };
                let others = cell[..place].iter().chain(&cell[place + 1..]);
                others.into_iter().any(is_near).then_some(a)
            })
        })
        .collect();
    work.sort(&mut unsure)?;
    unsure.dedup();
    let items = work.items(unsure.len());
    let mut prints: Vec<(Fingerprint, u32)> = unsure
        .par_iter()
        .map(|&number| {
            items.next()?;
            Ok((fingerprint(surface, &points[number as usize]), number))
        })
        .collect::<Result<_, Interrupted>>()?;
    work.sort(&mut prints)?;
    let equal: Vec<[u32; 2]> = prints
        .par_chunk_by(|a, b| a.0 == b.0)
        .filter(|alike| alike.len() > 1)
        .flat_map_iter(|alike| {
            let mut firsts = Vec::<u32>::new();
            let mut equal = Vec::new();
            for &(_, number) in alike {
                let known = firsts.iter().find(|&&first| {
                    are_equal(surface, &points[first as usize], &points[number as usize])
                });
                match known {
                    Some(&known) => equal.push([known, number]),
                    None => firsts.push(number),
                }
            }
            equal
        })
        .collect();
    let mut first: Vec<u32> = (0..index(points.len())).collect();
    for [known, point] in equal {
        first[point as usize] = known;
    }
    Ok(first)
}

/// A box around a point that meets the boxes of all points that may equal it.
pub(super) fn around(point: &Point) -> [DVec3; 2] {
    [-2.0, 2.0].map(|by| point.approximate + by * point.error)
}

/// The coordinates of a point modulo a prime: the same for equal points however they are defined.
pub(super) type Fingerprint = [u64; 3];

/// A prime, 2^61 - 1, so that two different points have the same fingerprint once in 2^183.
const PRIME: u64 = (1 << 61) - 1;

/// The fingerprint of a point.
pub(super) fn fingerprint(surface: &GridSurface, point: &Point) -> Fingerprint {
    residues(homogeneous(surface, &point.definition))
}

fn residues(mut point: Homogeneous) -> Fingerprint {
    let mut denominator = residue(&point[3]);
    if denominator == 0 {
        // Whether the denominator in lowest terms is divisible depends only on the point.
        let common = (0..3).fold(point[3].clone(), |common, i| {
            IBig::from((&common).gcd(&point[i]))
        });
        point = point.map(|x| x / &common);
        denominator = residue(&point[3]);
        if denominator == 0 {
            return [PRIME; 3];
        }
    }
    let inverse = power(denominator, PRIME - 2);
    [0, 1, 2].map(|i| product(residue(&point[i]), inverse))
}

fn residue(x: &IBig) -> u64 {
    let rest = x % PRIME.cast_signed();
    rest.rem_euclid(PRIME.cast_signed()).cast_unsigned()
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "what is left of a division by a prime of 61 bits"
)]
fn product(a: u64, b: u64) -> u64 {
    (u128::from(a) * u128::from(b) % u128::from(PRIME)) as u64
}

fn power(base: u64, exponent: u64) -> u64 {
    (0..61).rev().fold(1, |power, bit| {
        let square = product(power, power);
        if exponent >> bit & 1 == 1 {
            product(square, base)
        } else {
            square
        }
    })
}

#[cfg(test)]
mod tests {
    use super::super::Cancelled;
    use super::super::point::Definition;
    use super::*;
    use glam::DVec3;

    /// Triangles in different planes through the origin, or past it by less than a grid unit, and
    /// the points in which three of them meet.
    fn crowd(planes: u32, is_exact: bool) -> (GridSurface, Vec<Point>) {
        let mut positions = vec![DVec3::splat(1.0)];
        let mut triangles = Vec::new();
        for i in 0..planes {
            let [x, y] = [1.1, 2.3].map(|factor| (factor * f64::from(i + 1)).sin() * 0.3);
            let (p, q) = if is_exact {
                // With few bits, the plane through these and the origin is spanned by grid points.
                let [x, y] = [x, y].map(|x| (x * 1024.0).round() / 1024.0);
                (DVec3::new(0.5, x, y), DVec3::new(y, 0.5, x))
            } else {
                (DVec3::new(0.5, x, y), DVec3::new(y, 0.5, x))
            };
            let first = index(positions.len());
            positions.extend([p, q, -p - q]);
            triangles.push([first, first + 1, first + 2]);
        }
        let surface = GridSurface::new(&positions, &triangles, Cancelled::Dropped, Work::UNWATCHED)
            .expect("finite");
        let mut points = Vec::new();
        for c in 0..planes {
            for b in 0..c {
                for a in 0..b {
                    points.push(Point::new(&surface, Definition::Meet([a, b, c])));
                }
            }
        }
        (surface, points)
    }

    #[test]
    fn a_crowd_of_points_that_differ_stays_apart() {
        // All 4,060 points lie within a few grid units: comparing all pairs would take minutes.
        let (surface, points) = crowd(30, false);
        let spread = points.iter().map(|p| p.approximate.abs().max_element());
        assert!(spread.fold(0.0, f64::max) < 1e4, "a crowd");
        let first = first_equal(&surface, &points, Work::UNWATCHED).expect("nobody stops it");
        for (number, &first) in first.iter().enumerate() {
            let is_first = first as usize == number;
            let same = are_equal(&surface, &points[number], &points[first as usize]);
            assert!(is_first || same, "{number} is not {first}");
        }
        // Compares with all pairs among some of them.
        for a in (0..points.len()).step_by(97) {
            for b in (0..a).step_by(89) {
                assert_eq!(
                    first[a] == first[b],
                    are_equal(&surface, &points[a], &points[b]),
                    "{a} and {b}"
                );
            }
        }
    }

    #[test]
    fn a_crowd_of_one_point_under_many_names_is_one() {
        let (surface, points) = crowd(20, true);
        let first = first_equal(&surface, &points, Work::UNWATCHED).expect("nobody stops it");
        assert!(first.iter().all(|&first| first == 0), "all are the origin");
    }

    #[test]
    fn the_fingerprint_depends_on_the_point_only() {
        let point = |coordinates: [i64; 4], factor: u128| {
            coordinates.map(|x| IBig::from(x) * IBig::from(factor))
        };
        let plain = residues(point([3, -5, 7, 11], 1));
        for factor in [2, 1 << 90, u128::from(PRIME), u128::from(PRIME) << 40] {
            assert_eq!(residues(point([3, -5, 7, 11], factor)), plain, "{factor}");
        }
        assert_ne!(residues(point([3, -5, 7, 12], 1)), plain, "another point");
    }

    #[test]
    fn a_denominator_divisible_by_the_prime_is_a_class_of_its_own() {
        let prime = i64::try_from(PRIME).unwrap();
        let at = |x: i64| {
            [
                IBig::from(x),
                IBig::from(1),
                IBig::from(1),
                IBig::from(prime),
            ]
        };
        assert_eq!(residues(at(4)), residues(at(5)), "left to exact comparison");
        assert_ne!(
            residues(at(4)),
            residues([1, 1, 1, 1].map(IBig::from)),
            "not divisible"
        );
    }
}
