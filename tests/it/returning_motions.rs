//! Motions that return, in whole or in part: the cycle closes, and the result is the swept region.
//!
//! Poses that recur have the same grazing points up to rounding: two on one edge that are one, or
//! next to each other in `f64`, at one joint.

use crate::support;
use crate::support::planar::{disagreement, outline, polygon, star};
use crate::support::random::pseudo_random;
use crate::support::shapes;
use crate::support::sweep::{Reference, agreement, mesh};
use glam::{DAffine2, DAffine3, DMat2, DMat3, DQuat, DVec2, DVec3};
use rayon::prelude::*;
use steadysweep::body::{Mesh, Polygon};
use steadysweep::envelope::planar::PlanarBudget;
use steadysweep::envelope::spatial::Budget;
use steadysweep::envelope::{planar, spatial};
use steadysweep::motion::planar as in_plane;
use steadysweep::motion::{Generator, Keyframe, Motion};

/// Random numbers in an interval.
fn between(random: &mut impl Iterator<Item = f64>, low: f64, high: f64) -> f64 {
    low + (high - low) * random.next().expect("endless")
}

/// The orders in which poses follow each other: there and back, to and fro, around, standing still,
/// and turning back halfway.
const ORDERS: [&[usize]; 8] = [
    &[0, 1, 0],
    &[0, 1, 0, 1],
    &[0, 1, 2, 1, 0],
    &[0, 1, 2, 0],
    &[0, 0, 1, 1, 0],
    &[0, 1, 0, 2, 0, 1],
    &[0, 1, 2, 0, 1, 2],
    &[0, 3, 1, 3, 0],
];

/// The poses of an order. The last one lies on the steady motion between the first two.
fn keys<P: Copy>(order: &[usize], poses: [P; 4]) -> Vec<P> {
    order.iter().map(|&pose| poses[pose]).collect()
}

fn planar_poses(kind: usize, random: &mut impl Iterator<Item = f64>) -> [DAffine2; 4] {
    let mut pose = || {
        let mut next = |low, high| between(random, low, high);
        let turn = match kind % 4 {
            0 => 0.0,
            _ => next(-1.2, 1.2),
        };
        let strain = match kind % 4 {
            0 | 1 => DMat2::IDENTITY,
            2 => DMat2::from_diagonal(DVec2::splat(next(0.7, 1.4))),
            _ => DMat2::from_cols(
                DVec2::new(next(0.8, 1.2), next(-0.2, 0.2)),
                DVec2::new(next(-0.2, 0.2), next(0.8, 1.2)),
            ),
        };
        let at = DVec2::new(next(-1.0, 1.0), next(-1.0, 1.0));
        DAffine2::from_mat2_translation(DMat2::from_angle(turn) * strain, at)
    };
    let [first, second, third] = [pose(), pose(), pose()];
    let key = |time: f64, pose| in_plane::Keyframe { time, pose };
    let way = in_plane::Motion::from_keyframes(&[key(0.0, first), key(1.0, second)]);
    let middle = way.expect("near poses are joined").pose_at_time(0.4);
    [first, second, third, middle]
}

fn planar_case(seed: usize) -> (Polygon, in_plane::Motion) {
    let mut random = pseudo_random(seed as u64 * 7919 + 3);
    let body = match seed % 3 {
        0 => {
            let thin = 10f64.powf(between(&mut random, -4.0, -1.0));
            outline(&[[1.0, 0.0], [1.0, thin], [0.0, thin], [0.0, 0.0]])
        }
        1 => star([3, 5, 6, 9][seed % 4], 0.6, &mut random),
        _ => outline(&[
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, 0.3],
            [0.3, 0.3],
            [0.3, 1.0],
            [0.0, 1.0],
        ]),
    };
    let poses = planar_poses(seed / 3, &mut random);
    let keys: Vec<in_plane::Keyframe> = (0..)
        .zip(keys(ORDERS[seed % ORDERS.len()], poses))
        .map(|(time, pose)| in_plane::Keyframe {
            time: f64::from(time),
            pose,
        })
        .collect();
    let motion = in_plane::Motion::from_keyframes(&keys).expect("near poses are joined");
    (polygon(vec![body]), motion)
}

#[test]
fn planar_cycles_of_motions_that_return_are_closed() {
    let open: Vec<usize> = (0..4000_usize)
        .into_par_iter()
        .filter(|&seed| {
            let (body, motion) = planar_case(seed);
            let at_start = body.transformed(motion.start_pose());
            let budget = PlanarBudget::of(1e-2 * at_start.diagonal());
            let cycle = planar::sweep_cycle(&at_start, &motion, &budget).expect("small");
            cycle.check().is_err()
        })
        .collect();
    assert!(open.is_empty(), "{} are open: {open:?}", open.len());
}

#[test]
fn planar_regions_of_motions_that_return_agree_with_the_motion_of_points() {
    let defects: Vec<String> = (0..160_usize)
        .into_par_iter()
        .flat_map_iter(|seed| {
            let (body, motion) = planar_case(seed);
            let swept = support::planar::swept(&body, &motion, 5e-3);
            let mut defects = disagreement(&body, &motion, &swept, 150);
            let bound = &swept.error_bound;
            if !(bound.inside.proven && bound.outside.proven) {
                defects.push(format!("{bound:?}"));
            }
            defects
                .into_iter()
                .map(move |defect| format!("{seed}: {defect}"))
        })
        .collect();
    assert!(defects.is_empty(), "{defects:#?}");
}

#[test]
fn a_needle_goes_there_and_back() {
    // From a report: two neighbouring grazing points on one edge left the cycle open.
    let needle = outline(&[
        [1.0, 0.0],
        [1.0, 0.006196978433389098],
        [0.0, 0.006196978433389098],
        [0.0, 0.0],
    ]);
    let pose = |rows: [[f64; 3]; 2]| {
        let [x, y, z] = [0, 1, 2].map(|column| DVec2::new(rows[0][column], rows[1][column]));
        DAffine2::from_mat2_translation(DMat2::from_cols(x, y), z)
    };
    let here = pose([
        [0.8449198614275207, 0.11546740031495083, 0.2745101537229896],
        [0.3558034057568783, 1.0263449000175682, -0.36575931629601577],
    ]);
    let there = pose([
        [0.7882312733936434, -0.0166717808429154, 0.21145565944570965],
        [
            0.020837521759299774,
            1.228206858756128,
            -0.14408268282673692,
        ],
    ]);
    let keys = [here, there, here].map(|pose| in_plane::Keyframe { time: 0.0, pose });
    let keys: Vec<_> = (0..)
        .zip(keys)
        .map(|(time, key)| in_plane::Keyframe {
            time: f64::from(time),
            ..key
        })
        .collect();
    let motion = in_plane::Motion::from_keyframes(&keys).expect("near poses");
    let body = polygon(vec![needle]);
    let at_start = body.transformed(motion.start_pose());
    let budget = PlanarBudget::of(0.015329520078678237);
    let cycle = planar::sweep_cycle(&at_start, &motion, &budget).expect("small");
    assert_eq!(cycle.check(), Ok(()));
    let once = in_plane::Motion::from_keyframes(&keys[..2]).expect("near poses");
    let [once, twice] =
        [once, motion].map(|motion| support::planar::swept(&body, &motion, 1e-3).measures);
    // Both are within 1e-3 of the diagonal of the same region.
    assert!(
        (once.area - twice.area).abs() < 4e-3 * once.perimeter,
        "{once:?} {twice:?}"
    );
}

fn spatial_poses(kind: usize, random: &mut impl Iterator<Item = f64>) -> [DAffine3; 4] {
    let mut pose = || {
        let mut vector = |size: f64| {
            let mut next = || between(random, -size, size);
            DVec3::new(next(), next(), next())
        };
        let turn = match kind % 4 {
            0 => DQuat::IDENTITY,
            _ => DQuat::from_scaled_axis(vector(0.7)),
        };
        let strain = match kind % 4 {
            0 | 1 => DMat3::IDENTITY,
            2 => DMat3::from_diagonal(DVec3::splat(1.0 + vector(0.3).x)),
            _ => DMat3::from_cols(
                DVec3::X + vector(0.15),
                DVec3::Y + vector(0.15),
                DVec3::Z + vector(0.15),
            ),
        };
        DAffine3::from_mat3_translation(DMat3::from_quat(turn) * strain, vector(1.0))
    };
    let [first, second, third] = [pose(), pose(), pose()];
    let key = |time: f64, pose| Keyframe { time, pose };
    let way = Motion::from_keyframes(&[key(0.0, first), key(1.0, second)]);
    let middle = way.expect("near poses are joined").pose_at_time(0.4);
    [first, second, third, middle]
}

fn spatial_case(seed: usize) -> (Mesh, Motion) {
    let mut random = pseudo_random(seed as u64 * 104_729 + 5);
    let body = match seed % 5 {
        0 => {
            let thin = 10f64.powf(between(&mut random, -3.0, -0.5));
            shapes::cuboid(DVec3::ZERO, DVec3::new(1.0, thin, thin))
        }
        1 => shapes::l_prism(0.3, 0.5),
        2 => shapes::icosphere(1, 0.5, DVec3::new(0.2, 0.0, 0.1)),
        3 => shapes::cone(0.4, 1.0, 7),
        _ => shapes::u_prism(0.3, 0.5),
    };
    let poses = spatial_poses(seed / 5, &mut random);
    let keys: Vec<Keyframe> = (0..)
        .zip(keys(ORDERS[seed % ORDERS.len()], poses))
        .map(|(time, pose)| Keyframe {
            time: f64::from(time),
            pose,
        })
        .collect();
    let motion = Motion::from_keyframes(&keys).expect("near poses are joined");
    (mesh(&body), motion)
}

#[test]
fn spatial_cycles_of_motions_that_return_are_closed() {
    let open: Vec<usize> = (0..600_usize)
        .into_par_iter()
        .filter(|&seed| {
            let (body, motion) = spatial_case(seed);
            let at_start = body.transformed(motion.start_pose());
            let budget = Budget::of(2e-2 * at_start.diagonal());
            let cycle = spatial::sweep_cycle(&at_start, &motion, &budget).expect("small");
            cycle.check().is_err()
        })
        .collect();
    assert!(open.is_empty(), "{} are open: {open:?}", open.len());
}

#[test]
fn spatial_solids_of_motions_that_return_agree_with_the_motion_of_points() {
    let defects: Vec<String> = (0..40_usize)
        .into_par_iter()
        .filter_map(|seed| {
            let (body, motion) = spatial_case(seed);
            let diagonal = body.transformed(motion.start_pose()).diagonal();
            let swept = support::sweep::swept(&body, &motion, 2e-2 * diagonal);
            let mut defects = agreement(&body, &motion, &swept, 300).defects(&swept);
            defects += &Reference::new(&body, &motion, 20_000).volume_defects(&swept);
            (!defects.is_empty()).then(|| format!("{seed}: {defects}"))
        })
        .collect();
    assert!(defects.is_empty(), "{defects:#?}");
}

#[test]
fn a_translation_there_and_back_is_the_translation() {
    let way = DVec3::new(0.7, 0.4, 0.2);
    for shape in [
        shapes::l_prism(0.3, 0.5),
        shapes::icosphere(1, 0.5, DVec3::ZERO),
    ] {
        let volume = |ways: &[DVec3]| {
            let spans: Vec<Generator> = ways
                .iter()
                .map(|&way| Generator::translation(way))
                .collect();
            let motion = support::sweep::motion(&spans);
            *support::sweep::swept(&mesh(&shape), &motion, 1e-3)
                .solid
                .measures()
        };
        let once = volume(&[way]);
        for ways in [
            &[way, -way][..],
            &[way, -way, way],
            &[0.3 * way, -0.3 * way, way, -0.5 * way],
            &[way, DVec3::ZERO, -way],
        ] {
            let found = volume(ways);
            // Nothing is sampled, so the difference is rounding.
            assert!(
                (found.volume - once.volume).abs() < 1e-12 * once.volume,
                "{ways:?}: {} for {}",
                found.volume,
                once.volume
            );
            assert_eq!(
                [found.components, found.voids, found.genus],
                [1, 0, 0],
                "{ways:?}"
            );
        }
    }
}
