//! Joins vertices that are meant to be one: those of a file, and those to whose place several paths
//! lead.

use crate::numeric::SpatialHash;
use glam::DVec3;
use std::collections::HashMap;

/// Positions and triangles with joined vertices.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Welded {
    /// One position per place, in the order of first occurrence.
    pub(crate) positions: Vec<DVec3>,
    /// Triangles with three distinct vertices, in the order of the input.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// For each position, the input vertex whose place it is.
    pub(crate) vertex_of: Vec<u32>,
    /// For each triangle, its number in the input.
    pub(crate) triangle_of: Vec<u32>,
    /// For each input vertex, the place that it joined.
    pub(crate) place_of: Vec<u32>,
    /// Number of places that were joined to another one that is not exactly equal.
    pub(crate) moved: usize,
    /// Largest distance between places that were joined.
    pub(crate) largest_move: f64,
}

/// Joins vertices within `distance` of each other, and drops triangles that thereby lose a corner.
///
/// In the order of the input, each vertex joins the nearest place kept so far if that is within
/// `distance` (the earliest of equally near ones), and otherwise is kept as a new place. So no
/// vertex moves by more than `distance`, and the result depends only on the order. Expects finite
/// positions and indices in range.
///
/// # Cost
/// O(n) expected: places are more than `distance` apart, so a cell of the grid holds a bounded
/// number of them.
pub(crate) fn weld(positions: &[DVec3], triangles: &[[u32; 3]], distance: f64) -> Welded {
    let mut grid = PointGrid::new(positions, distance);
    let mut exact: HashMap<[u64; 3], u32> = HashMap::with_capacity(positions.len() / 4);
    let mut kept: Vec<DVec3> = Vec::new();
    let mut vertex_of = Vec::new();
    let (mut moved, mut largest_move) = (0, 0.0f64);
    let mut place_of = Vec::with_capacity(positions.len());
    for (v, &position) in (0u32..).zip(positions) {
        // Adding zero turns -0 into 0, so that equal places have equal bits.
        let place = *exact
            .entry((position + DVec3::ZERO).to_array().map(f64::to_bits))
            .or_insert_with(|| {
                if let Some((place, gap)) = grid.nearest(&kept, position) {
                    moved += 1;
                    largest_move = largest_move.max(gap);
                    return place;
                }
                #[expect(
                    clippy::cast_possible_truncation,
                    reason = "no more than there are vertices, and these have u32 indices"
                )]
                let place = kept.len() as u32;
                kept.push(position);
                vertex_of.push(v);
                grid.insert(position, place);
                place
            });
        place_of.push(place);
    }
    let mut joined = Welded {
        positions: kept,
        triangles: Vec::with_capacity(triangles.len()),
        vertex_of,
        triangle_of: Vec::with_capacity(triangles.len()),
        place_of,
        moved,
        largest_move,
    };
    for (f, triangle) in (0u32..).zip(triangles) {
        let [a, b, c] = triangle.map(|v| joined.place_of[v as usize]);
        if a != b && b != c && c != a {
            joined.triangles.push([a, b, c]);
            joined.triangle_of.push(f);
        }
    }
    joined
}

/// Places by position, in cubes four times as wide as the distance: a ball of that radius meets at
/// most two per axis.
pub(crate) struct PointGrid {
    hash: SpatialHash,
    origin: DVec3,
    distance: f64,
}

impl PointGrid {
    pub(crate) fn new(positions: &[DVec3], distance: f64) -> PointGrid {
        let origin = positions
            .iter()
            .copied()
            .reduce(DVec3::min)
            .unwrap_or_default();
        PointGrid {
            hash: SpatialHash::new(4.0 * distance),
            origin,
            distance,
        }
    }

    pub(crate) fn insert(&mut self, position: DVec3, place: u32) {
        if self.distance > 0.0 {
            self.hash.insert([position - self.origin; 2], place);
        }
    }

    /// The nearest place within the distance (the earliest of equally near ones), and its distance.
    fn nearest(&self, kept: &[DVec3], position: DVec3) -> Option<(u32, f64)> {
        let mut best: Option<(f64, u32)> = None;
        self.for_each_near(kept, position, |place, gap| {
            if best.is_none_or(|b| (gap, place) < b) {
                best = Some((gap, place));
            }
        });
        best.map(|(gap, place)| (place, gap))
    }

    /// The places within the distance, ascending.
    pub(crate) fn near(&self, positions: &[DVec3], position: DVec3) -> Vec<u32> {
        let mut near = Vec::new();
        self.for_each_near(positions, position, |place, _| near.push(place));
        near.sort_unstable();
        near
    }

    fn for_each_near(&self, positions: &[DVec3], position: DVec3, mut visit: impl FnMut(u32, f64)) {
        if self.distance <= 0.0 {
            return;
        }
        let around = [-self.distance, self.distance].map(|by| position + by - self.origin);
        for place in self.hash.near(around) {
            let gap = positions[place as usize].distance(position);
            if gap <= self.distance {
                visit(place, gap);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(coordinates: &[f64]) -> Vec<DVec3> {
        coordinates
            .iter()
            .map(|&x| DVec3::new(x, 2.0 * x, -x))
            .collect()
    }

    /// The rule as stated, by comparing all pairs.
    fn by_all_pairs(positions: &[DVec3], distance: f64) -> Vec<DVec3> {
        let mut kept: Vec<DVec3> = Vec::new();
        for &p in positions {
            if kept.iter().all(|q| q.distance(p) > distance) {
                kept.push(p);
            }
        }
        kept
    }

    #[test]
    fn equal_places_are_one_and_nothing_moves() {
        let welded = weld(
            &points(&[1.0, 0.0, 1.0, -0.0, 2.0]),
            &[[0, 1, 4], [2, 3, 4], [0, 2, 4]],
            1e-9,
        );
        assert_eq!(welded.positions, points(&[1.0, 0.0, 2.0]));
        assert_eq!(
            welded.triangles,
            [[0, 1, 2], [0, 1, 2]],
            "the third lost a corner"
        );
        assert_eq!(
            (welded.triangle_of, welded.vertex_of),
            (vec![0, 1], vec![0, 1, 4])
        );
        assert_eq!((welded.moved, welded.largest_move), (0, 0.0));
    }

    #[test]
    fn near_places_join_the_nearest_and_the_move_is_reported() {
        let along = |x: f64| DVec3::new(x, 0.0, 0.0);
        let positions = [along(0.0), along(1.5), along(0.9), along(10.0), along(10.5)];
        let welded = weld(&positions, &[], 1.0);
        assert_eq!(
            welded.positions,
            [along(0.0), along(1.5), along(10.0)],
            "0.9 is nearer to 1.5"
        );
        assert_eq!(welded.moved, 2);
        assert!(
            (welded.largest_move - 0.6).abs() < 1e-15,
            "{}",
            welded.largest_move
        );
    }

    #[test]
    fn the_grid_finds_what_all_pairs_find() {
        // A cloud on a lattice a little finer and a little coarser than the distance, in scattered
        // order.
        let mut seed = 1u64;
        let mut random = move || {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            f64::from(u32::try_from(seed >> 32).expect("32 bits")) / 4.3e9
        };
        let cloud: Vec<DVec3> = (0..2000)
            .map(|_| DVec3::new(random(), random(), random()))
            .collect();
        for distance in [0.02, 0.1, 0.9, 3.0] {
            let welded = weld(&cloud, &[], distance);
            assert_eq!(
                welded.positions,
                by_all_pairs(&cloud, distance),
                "distance {distance}"
            );
            assert!(
                welded.largest_move <= distance,
                "{} > {distance}",
                welded.largest_move
            );
        }
    }

    #[test]
    fn a_million_points_at_one_place_take_no_quadratic_time() {
        let crowd: Vec<DVec3> = (0..1_000_000)
            .map(|i| DVec3::splat(1e-15 * f64::from(i)))
            .collect();
        let welded = weld(&crowd, &[], 1.0);
        assert_eq!(welded.positions.len(), 1, "all within the distance");
    }

    #[test]
    fn far_from_the_origin_and_without_extent_nothing_breaks() {
        let far = [DVec3::splat(1e18), DVec3::splat(1e18), DVec3::splat(-1e18)];
        assert_eq!(
            weld(&far, &[[0, 1, 2]], 3.5e9).positions.len(),
            2,
            "two places"
        );
        let same = [DVec3::splat(5.0); 3];
        assert_eq!(
            weld(&same, &[[0, 1, 2]], 0.0).positions.len(),
            1,
            "exact equality only"
        );
    }
}
