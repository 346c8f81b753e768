//! Shells: the parts of the boundary that are connected across edges, and how they lie in one
//! another.

use super::columns::Columns;
use crate::numeric::tolerance::{FLAT_ROUNDING, FLAT_THICKNESS};
use crate::surface::bounds_of;
use glam::DVec3;

/// How a shell bounds the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShellRole {
    /// Positive volume, outside the material of the other shells.
    Outer,
    /// Negative volume, inside the material of another shell.
    Cavity,
    /// Positive volume inside the material of another shell: legal, bounds nothing.
    Nested,
}

/// A part of the boundary that is connected across edges.
#[derive(Debug, Clone, PartialEq)]
pub struct Shell {
    /// Its triangles, ascending.
    pub triangles: Vec<u32>,
    /// The signed volume that it encloses, negative for a cavity.
    pub volume: f64,
    /// How it bounds the body.
    pub role: ShellRole,
}

/// How much a closed shell encloses, and how thick it is for its size.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Thickness {
    /// Signed volume, negative for a cavity.
    pub(crate) volume: f64,
    /// Mean thickness: twice the volume over the area.
    pub(crate) mean: f64,
    /// The mean thickness up to which a shell of this size and place is flat.
    pub(crate) limit: f64,
}

impl Thickness {
    /// That of a shell of some triangles.
    pub(crate) fn of(positions: &[DVec3], shell: impl Iterator<Item = [u32; 3]> + Clone) -> Self {
        let [low, high] = bounds_of(shell.clone().flatten().map(|v| positions[v as usize]));
        let (volume, area) = measure(positions, shell, low.midpoint(high));
        let largest = low.abs().max(high.abs()).max_element();
        Thickness {
            volume,
            mean: if area > 0.0 {
                2.0 * volume.abs() / area
            } else {
                0.0
            },
            limit: (FLAT_THICKNESS * (high - low).length()).max(FLAT_ROUNDING * largest),
        }
    }

    /// Whether no body may have the shell.
    pub(crate) fn is_flat(&self) -> bool {
        self.mean <= self.limit
    }
}

/// Signed volume and area of some triangles. The volume is taken relative to `reference`, which
/// must be near them.
pub(super) fn measure(
    positions: &[DVec3],
    triangles: impl Iterator<Item = [u32; 3]>,
    reference: DVec3,
) -> (f64, f64) {
    let (volume, area) = triangles.fold((0.0, 0.0), |(volume, area), triangle| {
        let [a, b, c] = triangle.map(|v| positions[v as usize] - reference);
        (
            volume + a.dot(b.cross(c)),
            area + (b - a).cross(c - a).length(),
        )
    });
    (volume / 6.0, area / 2.0)
}

/// How often the other shells wind around each shell, taken at the first of its vertices and
/// centroids that lies on none of them; 0 where all do.
///
/// Expects closed, oriented shells. O(n log n) when few candidates lie on other shells, as is
/// usual.
pub(super) fn depths(positions: &[DVec3], triangles: &[[u32; 3]], shells: &[Vec<u32>]) -> Vec<i32> {
    if shells.len() < 2 {
        return vec![0; shells.len()];
    }
    let mut shell_of = vec![0; triangles.len()];
    for (s, shell) in shells.iter().enumerate() {
        for &f in shell {
            shell_of[f as usize] = s;
        }
    }
    let columns = Columns::new(positions, triangles);
    let depth = |(s, shell): (usize, &Vec<u32>)| {
        let corners = || {
            shell
                .iter()
                .map(|&f| triangles[f as usize].map(|v| positions[v as usize]))
        };
        let centroids = corners().map(|[a, b, c]| (a + b + c) / 3.0);
        corners()
            .flatten()
            .chain(centroids)
            .find_map(|point| columns.winding_number(point, |f| shell_of[f as usize] != s))
            .unwrap_or(0)
    };
    shells.iter().enumerate().map(depth).collect()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Positions and triangles.
    pub(in super::super) type Soup = (Vec<DVec3>, Vec<[u32; 3]>);

    /// Appends the box from `low` with edges `size`, outward or inward.
    pub(in super::super) fn boxes(soup: &mut Soup, low: DVec3, size: DVec3, outward: bool) {
        let first = u32::try_from(soup.0.len()).expect("few vertices");
        soup.0.extend((0..8).map(|i| {
            low + size * DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2))
        }));
        let quads = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        for [a, b, c, d] in quads.map(|q: [u32; 4]| q.map(|v| v + first)) {
            soup.1.extend(
                [[a, b, c], [a, c, d]].map(|t| if outward { t } else { [t[0], t[2], t[1]] }),
            );
        }
    }

    /// A polyhedron of `n` bands inscribed in a ball of radius 1.
    pub(in super::super) fn sphere(n: u32) -> Soup {
        let (rows, columns) = (n, 2 * n);
        let point = |i: u32, j: u32| {
            let (u, v) = (
                f64::from(i) / f64::from(rows),
                f64::from(j) / f64::from(columns),
            );
            let (s, c) = (u * std::f64::consts::PI).sin_cos();
            let (y, x) = (v * std::f64::consts::TAU).sin_cos();
            DVec3::new(s * x, s * y, c)
        };
        let mut positions = vec![DVec3::Z];
        positions.extend((1..rows).flat_map(|i| (0..columns).map(move |j| point(i, j))));
        positions.push(-DVec3::Z);
        let bottom = 1 + (rows - 1) * columns;
        let at = |i: u32, j: u32| 1 + (i - 1) * columns + j % columns;
        let mut triangles = Vec::new();
        for j in 0..columns {
            triangles.push([0, at(1, j), at(1, j + 1)]);
            for i in 1..rows - 1 {
                triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
            triangles.push([at(rows - 1, j), bottom, at(rows - 1, j + 1)]);
        }
        (positions, triangles)
    }

    #[test]
    fn a_ball_has_its_volume_and_area() {
        let (positions, triangles) = sphere(100);
        let (volume, area) = measure(&positions, triangles.into_iter(), DVec3::ZERO);
        // An inscribed polyhedron of 100 bands falls short by less than 1e-3 of volume and area.
        let ball = std::f64::consts::PI * 4.0 / 3.0;
        assert!(volume < ball && volume > 0.999 * ball, "{volume}");
        assert!(area < 3.0 * ball && area > 2.997 * ball, "{area}");
    }

    #[test]
    fn shells_that_touch_everywhere_in_vertices_are_still_placed() {
        // A tetrahedron on four corners of a cube: each of its vertices lies on the cube, but no
        // centroid does.
        let mut soup = (Vec::new(), Vec::new());
        boxes(&mut soup, DVec3::ZERO, DVec3::ONE, true);
        let corners = [
            [0.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [1.0, 0.0, 1.0],
            [0.0, 1.0, 1.0],
        ]
        .map(DVec3::from_array);
        soup.0.extend(corners);
        soup.1
            .extend([[8, 10, 9], [8, 9, 11], [8, 11, 10], [9, 10, 11]]);
        let shells = vec![(0..12).collect(), (12..16).collect()];
        assert_eq!(
            depths(&soup.0, &soup.1, &shells),
            [0, 1],
            "the tetrahedron is in the cube, the cube in nothing"
        );
    }
}
