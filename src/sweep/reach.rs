//! How far from the origin a body comes on its way.

use crate::motion::{Generator, box_path_bounds};
use glam::{DAffine3, DVec3};

/// Bound on the largest coordinate of a body on its way: proven, rounding included.
///
/// - `points`: their hull holds the body at the start of the motion.
/// - `spans`: per span its generator, and the pose in which it starts relative to the start of the
///   motion.
///
/// Over each span the box of the points is followed: looser than the largest coordinate by what the
/// corners of the box stand out of the body.
pub(super) fn reach(
    points: impl Iterator<Item = DVec3> + Clone,
    spans: impl Iterator<Item = (Generator, DAffine3)>,
) -> f64 {
    let far = |(generator, pose): (Generator, DAffine3)| {
        let places = points.clone().map(|point| pose.transform_point3(point));
        let corners = places.fold(None, |corners: Option<[DVec3; 2]>, p| {
            let [low, high] = corners.unwrap_or([p; 2]);
            Some([low.min(p), high.max(p)])
        });
        let [low, high] = box_path_bounds(&generator, corners.unwrap_or_default(), [0.0, 1.0]);
        low.abs().max(high.abs()).max_element()
    };
    spans.map(far).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn what_lies_between_any_samples_is_within_reach() {
        // At all eighths of the time eight turns are back at the start.
        let turns = Generator::screw(DVec3::Z, DVec3::ZERO, 8.0 * TAU, 0.0, 1.0);
        let far = reach(
            [DVec3::new(0.6, 0.6, 0.0)].into_iter(),
            [(turns, DAffine3::IDENTITY)].into_iter(),
        );
        let expected = 0.6 * 2f64.sqrt();
        assert!(
            (expected..1.1 * expected).contains(&far),
            "{far} for {expected}"
        );
    }

    #[test]
    fn spans_start_where_the_ones_before_end() {
        let there = Generator::translation(DVec3::X * 5.0);
        let ahead = DAffine3::from_translation(DVec3::X * 5.0);
        let far = reach(
            [DVec3::ZERO, DVec3::ONE].into_iter(),
            [(there, DAffine3::IDENTITY), (there, ahead)].into_iter(),
        );
        assert!((11.0..11.0 + 1e-12).contains(&far), "{far}");
    }
}
