//! Whether two triangles miss each other.

use crate::numeric::exact::signs::{Side, side_of_plane};
use glam::DVec3;

/// Whether two triangles do not cross: one lies on one side of the other's plane, or no edge of
/// either passes through the other. Triangles that merely touch may count as crossing.
pub(crate) fn are_apart(one: &[DVec3; 3], other: &[DVec3; 3]) -> bool {
    let sides = |plane: &[DVec3; 3], points: &[DVec3; 3]| {
        points.map(|p| side_of_plane(plane[0], plane[1], plane[2], p))
    };
    let one_sided =
        |sides: [Side; 3]| !(sides.contains(&Side::Above) && sides.contains(&Side::Below));
    let is_off = |sides: [Side; 3]| one_sided(sides) && !sides.contains(&Side::On);
    let (here, there) = (sides(one, other), sides(other, one));
    if is_off(here) || is_off(there) {
        return true;
    }
    if one_sided(here) || one_sided(there) {
        // They touch at most. Touching in more than a point counts as crossing, to be on the safe
        // side.
        return here.iter().filter(|s| **s == Side::On).count()
            + there.iter().filter(|s| **s == Side::On).count()
            <= 2;
    }
    let passes = |from: &[DVec3; 3], through: &[DVec3; 3]| {
        (0..3).any(|i| {
            let (p, q) = (from[i], from[(i + 1) % 3]);
            let plane = [p, q].map(|p| side_of_plane(through[0], through[1], through[2], p));
            let straddles = plane[0] != plane[1] || plane[0] == Side::On;
            let turns = [0, 1, 2].map(|k| side_of_plane(p, q, through[k], through[(k + 1) % 3]));
            straddles && one_sided(turns)
        })
    };
    !passes(one, other) && !passes(other, one)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    /// An upright triangle through the middle of the floor, displaced.
    fn upright(by: DVec3) -> [DVec3; 3] {
        [
            DVec3::new(0.2, 0.2, -1.0),
            DVec3::new(0.3, 0.2, -1.0),
            DVec3::new(0.25, 0.25, 1.0),
        ]
        .map(|p| p + by)
    }

    #[test]
    fn triangles_through_each_other_are_not_apart() {
        assert!(
            !are_apart(&FLOOR, &upright(DVec3::ZERO)),
            "through the middle"
        );
        assert!(!are_apart(&upright(DVec3::ZERO), &FLOOR), "either way");
    }

    #[test]
    fn triangles_beside_or_above_each_other_are_apart() {
        for by in [
            DVec3::X,
            DVec3::new(0.0, 0.0, 1.5),
            DVec3::new(-1.0, 0.0, 0.0),
        ] {
            assert!(are_apart(&FLOOR, &upright(by)), "moved by {by}");
        }
    }
}
