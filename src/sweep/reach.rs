//! How far from the origin a moving body gets.

use crate::motion::{Generator, box_path_bounds, path_bounds};
use glam::{DAffine3, DVec3};

/// A proven bound on the largest coordinate of a moving body, rounding included.
///
/// - `points`: their hull contains the body at the start of the motion.
/// - `spans`: per span, its generator and the pose at its start, relative to the start of the
///   motion.
///
/// Over each span, the box of the points is followed: the bound exceeds the largest coordinate by
/// as much as the corners of the box stand out of the body.
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

/// A bound on the largest number that is rounded in the computation of a coordinate of a point that
/// a span carries; summed over the spans, since each adds its own rounding. Proven, as [`reach`]
/// is.
///
/// It counts products and sums, which are larger than the result where the parts of a pose cancel.
pub(super) fn rounded_reach(
    points: impl Iterator<Item = DVec3> + Clone,
    spans: impl Iterator<Item = (Generator, DAffine3)>,
) -> f64 {
    let farthest = |generator: &Generator, point: DVec3| {
        let [low, high] = path_bounds(generator, point, [0.0, 1.0]);
        low.abs().max(high.abs())
    };
    let largest = |(generator, pose): (Generator, DAffine3)| {
        let places = points.clone().map(|point| pose.transform_point3(point));
        let corner = places.fold(DVec3::ZERO, |corner, p| corner.max(p.abs()));
        let about_origin = Generator {
            offset: DVec3::ZERO,
            ..generator
        };
        // A product is an entry of the linear part times a coordinate: the path of a point on an
        // axis.
        let products: DVec3 = [DVec3::X, DVec3::Y, DVec3::Z]
            .map(|axis| farthest(&about_origin, axis * corner.dot(axis)))
            .iter()
            .sum();
        (products + farthest(&generator, DVec3::ZERO)).max_element()
    };
    spans.map(largest).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn what_lies_between_any_samples_is_within_reach() {
        // At every eighth of the time, eight turns are back at the start.
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

    #[test]
    fn parts_of_a_pose_that_cancel_count() {
        // At every eighth of the time, eight turns about a far axis are the identity; in between,
        // two translations by up to 2e6 cancel.
        let far = Generator::screw(DVec3::Z, DVec3::X * 1e6, 8.0 * TAU, 0.0, 1.0);
        let largest = rounded_reach(
            [DVec3::ONE].into_iter(),
            [(far, DAffine3::IDENTITY)].into_iter(),
        );
        assert!((2e6..2.1e6).contains(&largest), "{largest}");
        // 1e3 times the scale is a product of 1e9, though nothing leaves the unit ball about 1e3.
        let grown = Generator::screw(DVec3::Z, DVec3::X * 1e3, 0.0, 0.0, 1e6);
        let largest = rounded_reach(
            [DVec3::X * 1e3].into_iter(),
            [(grown, DAffine3::IDENTITY)].into_iter(),
        );
        assert!((2e9..2.1e9).contains(&largest), "{largest}");
    }
}
