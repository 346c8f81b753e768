//! Poses of the plane that are the same up to rounding.

use crate::bounds::rectangle_corners;
use crate::numeric::Ordered;
use crate::numeric::tolerance::{SAME_POSE, UNIT_ROUNDOFF};
use glam::{DAffine2, DVec2};
use std::collections::BTreeMap;

/// The poses, where each one that repeats an earlier one up to rounding is replaced by that one, to
/// the same bits.
///
/// Two poses are the same if no point of the body, given by its box [min, max], differs by more
/// than [`SAME_POSE`] of the largest coordinate of its corner there. O(n log n) for n poses, unless
/// many different ones have the same number (below).
pub(super) fn shared(poses: &[DAffine2], bounds: [DVec2; 2]) -> Vec<DAffine2> {
    let corners = rectangle_corners(bounds);
    let mut known: BTreeMap<(Ordered, usize), DAffine2> = BTreeMap::new();
    let mut shared = Vec::with_capacity(poses.len());
    for (index, pose) in poses.iter().enumerate() {
        let places = corners.map(|corner| pose.transform_point2(corner));
        let (number, near) = number(&places);
        let is_same = |other: &DAffine2| {
            corners.iter().zip(&places).all(|(&corner, here)| {
                here.distance(other.transform_point2(corner))
                    <= SAME_POSE * here.abs().max_element()
            })
        };
        let range = (Ordered(number - near), 0)..=(Ordered(number + near), usize::MAX);
        let same = known
            .range(range)
            .filter(|(_, other)| is_same(other))
            .min_by_key(|((_, index), _)| *index)
            .map(|(_, other)| *other);
        shared.push(same.unwrap_or_else(|| {
            known.insert((Ordered(number), index), *pose);
            *pose
        }));
    }
    shared
}

/// The largest distance, pose by pose, by which a point of the body, given by its box [min, max],
/// moves when one pose is taken for another. Both are affine, so that it is attained at a corner of
/// the box.
pub(super) fn moves(poses: &[DAffine2], taken: &[DAffine2], bounds: [DVec2; 2]) -> Vec<f64> {
    let farthest = |(pose, taken): (&DAffine2, &DAffine2)| {
        let distances = rectangle_corners(bounds).map(|corner| {
            pose.transform_point2(corner)
                .distance(taken.transform_point2(corner))
        });
        distances.into_iter().fold(0.0, f64::max)
    };
    poses.iter().zip(taken).map(farthest).collect()
}

/// A number that is the same for equal poses, and hardly ever for different ones: a sum of
/// coordinates with weights that no drawing has. With it comes the largest difference for two poses
/// that count as the same, rounding included.
fn number(places: &[DVec2; 4]) -> (f64, f64) {
    const WEIGHTS: [f64; 8] = [
        1.0,
        0.754_877_666_246_692_8,
        0.569_840_290_998_053_3,
        0.430_159_709_001_946_7,
        0.324_717_957_244_746_1,
        0.245_122_333_753_307_2,
        0.185_037_375_248_639_5,
        0.139_680_581_996_106_8,
    ];
    let coordinates = places.iter().flat_map(|place| place.to_array());
    let sum = |coordinates: &mut dyn Iterator<Item = f64>| -> f64 {
        coordinates.zip(WEIGHTS).map(|(x, weight)| x * weight).sum()
    };
    let number = sum(&mut coordinates.clone());
    let largest = places
        .iter()
        .flat_map(|place| [place.abs().max_element(); 2]);
    let size = sum(&mut { largest });
    // Products and sums of eight terms, for both poses.
    (number, (SAME_POSE + 32.0 * UNIT_ROUNDOFF) * size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const BOX: [DVec2; 2] = [DVec2::new(-1.0, -0.5), DVec2::new(2.0, 0.75)];

    /// Compares each pose with all before it.
    fn naive(poses: &[DAffine2]) -> Vec<DAffine2> {
        let corners = rectangle_corners(BOX);
        let mut shared: Vec<DAffine2> = Vec::new();
        for pose in poses {
            let same = shared.iter().find(|other| {
                corners.iter().all(|&corner| {
                    let [here, there] = [pose, *other].map(|p| p.transform_point2(corner));
                    here.distance(there) <= SAME_POSE * here.abs().max_element()
                })
            });
            let same = same.copied().unwrap_or(*pose);
            shared.push(same);
        }
        shared
    }

    #[test]
    fn poses_are_shared_as_if_each_were_compared_with_all() {
        // Poses around a star, there and back, each time with different rounding; and poses about a
        // corner of the box.
        let poses: Vec<DAffine2> = (0..400)
            .map(|i: u32| {
                let turn = TAU * f64::from(i % 7) / 7.0 + TAU * f64::from(i / 50);
                let way = DVec2::new(f64::from(i % 3), 0.1 * f64::from(i % 2));
                DAffine2::from_angle_translation(turn, way)
            })
            .chain((0..100).map(|i| {
                let turn = DAffine2::from_angle(TAU * f64::from(i) / 60.0);
                DAffine2::from_translation(BOX[0]) * turn * DAffine2::from_translation(-BOX[0])
            }))
            .collect();
        let shared = shared(&poses, BOX);
        assert_eq!(shared, naive(&poses), "the same bits");
        let mut distinct: Vec<String> = shared.iter().map(|pose| format!("{pose:?}")).collect();
        distinct.sort();
        distinct.dedup();
        assert_eq!(
            distinct.len(),
            7 * 6 + 59,
            "42 of the star, and 60 of which one is the identity"
        );
    }

    /// Comparing each pose with all before it would take a minute.
    #[test]
    fn two_hundred_thousand_poses_are_soon_shared() {
        let poses: Vec<DAffine2> = (0..200_000)
            .map(|i: u32| DAffine2::from_translation(DVec2::new(0.0, f64::from(i % 190_000))))
            .collect();
        let shared = shared(&poses, BOX);
        assert_eq!(shared[..190_000], poses[..190_000], "all different");
        assert_eq!(shared[190_000..], poses[..10_000], "and again");
    }
}
