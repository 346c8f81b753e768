//! A hash of boxes by place, to find those near another box.

use glam::{DVec3, I64Vec3};
use std::collections::HashMap;

/// Numbers of boxes, listed under the cubes of a grid that the boxes meet.
///
/// Boxes should not be much wider than the cubes: each takes one entry per cube that it meets.
#[derive(Debug)]
pub(crate) struct SpatialHash {
    width: f64,
    cubes: HashMap<I64Vec3, Vec<u32>>,
}

impl SpatialHash {
    /// - `width`: width of the cubes, above zero.
    pub(crate) fn new(width: f64) -> SpatialHash {
        SpatialHash {
            width,
            cubes: HashMap::new(),
        }
    }

    /// Adds a number of a box \[low, high\].
    pub(crate) fn insert(&mut self, bounds: [DVec3; 2], number: u32) {
        for cube in cubes(bounds, self.width) {
            self.cubes.entry(cube).or_default().push(number);
        }
    }

    /// The numbers of all boxes that meet a box, and of others near it; a number may occur more
    /// than once.
    pub(crate) fn near(&self, bounds: [DVec3; 2]) -> impl Iterator<Item = u32> {
        cubes(bounds, self.width)
            .filter_map(|cube| self.cubes.get(&cube))
            .flatten()
            .copied()
    }
}

/// The cubes of a grid that a box meets.
pub(crate) fn cubes([low, high]: [DVec3; 2], width: f64) -> impl Iterator<Item = I64Vec3> {
    let [low, high] = [low, high].map(|corner| (corner / width).floor().as_i64vec3());
    (low.x..=high.x).flat_map(move |x| {
        let row = move |y| (low.z..=high.z).map(move |z| I64Vec3::new(x, y, z));
        (low.y..=high.y).flat_map(row)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_that_meet_are_found_and_those_far_off_are_not() {
        let corner = |i: u32| {
            let share = |k: u32| f64::from((i * k) % 101) / 101.0;
            DVec3::new(share(7), share(31), share(53)) * 10.0 - 5.0
        };
        let boxes: Vec<[DVec3; 2]> = (0..200)
            .map(|i| [corner(i), corner(i) + DVec3::splat(0.4)])
            .collect();
        let mut hash = SpatialHash::new(1.0);
        for (number, &bounds) in (0u32..).zip(&boxes) {
            hash.insert(bounds, number);
        }
        let mut pairs = 0;
        for &[low, high] in &boxes {
            let found: Vec<u32> = hash.near([low, high]).collect();
            for (number, &[other_low, other_high]) in (0u32..).zip(&boxes) {
                let gap = (other_low - high).max(low - other_high).max_element();
                assert!(gap > 0.0 || found.contains(&number), "{number} meets {low}");
                assert!(gap < 2.0 || !found.contains(&number), "{number} from {low}");
                pairs += usize::from(gap <= 0.0);
            }
        }
        assert!(pairs > boxes.len(), "some meet others, {pairs}");
    }
}
