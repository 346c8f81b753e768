//! The untrimmed envelope: samples lie as near as they say, and beyond each of its sheets and curves, one time interval inside the body
//! fewer, as the times of membership tell.

use crate::support::planar::{self, star};
use crate::support::random::pseudo_random;
use crate::support::shapes;
use crate::support::sweep::{general_affine, mesh, motion, screw};
use glam::{DVec2, DVec3};
use steadysweep::bounds::SurfaceTree;
use steadysweep::envelope;
use steadysweep::envelope::planar::PlanarBudget;
use steadysweep::envelope::spatial::{Budget, Fold};
use steadysweep::membership;
use steadysweep::planar::Generator;

/// Distance from a sheet, on both sides, at which membership is asked.
const BESIDE: f64 = 1e-6;

#[test]
fn beyond_a_sheet_there_is_one_interval_fewer() {
    let body = mesh(&shapes::u_prism(0.3, 0.5));
    let turn = screw(DVec3::Z, DVec3::new(-1.0, 0.2, 0.0), 2.0, 0.4, 0.7);
    let mut folds = [0; 2];
    for generator in [turn, general_affine()] {
        let motion = motion(&[generator]);
        let membership = membership::Membership::new(&body, &motion);
        for sheet in envelope::spatial::envelope(&body, &motion) {
            for (along, share) in [(0.31, 0.42), (0.57, 0.83)] {
                let Some(normal) = sheet.normal(&motion, along, share) else {
                    continue;
                };
                let point = sheet.point(&motion, along, share);
                let [within, beyond] =
                    [-BESIDE, BESIDE].map(|step| membership.intervals(point + step * normal).len());
                assert_eq!(within, beyond + 1, "{sheet:?} at {along}, {share}");
                folds[usize::from(sheet.fold == Fold::Inner)] += 1;
            }
        }
    }
    assert!(folds[0] > 40 && folds[1] > 4, "{folds:?}");
}

/// Random places of the exact sheets and curves against the sampled ones.
#[test]
fn sampled_envelopes_are_as_near_as_they_say() {
    let body = mesh(&shapes::u_prism(0.3, 0.5));
    let turn = screw(DVec3::Z, DVec3::new(-1.0, 0.2, 0.0), 2.0, 0.4, 0.7);
    let motion = motion(&[turn, general_affine()]);
    let mut random = pseudo_random(11);
    let mut next = || random.next().expect("endless");
    let sampled = envelope::spatial::sampled_envelope(&body, &motion, &Budget::of(0.01))
        .expect("few triangles");
    assert!(sampled.error <= 0.01, "{}", sampled.error);
    assert!(sampled.sheets == envelope::spatial::envelope(&body, &motion));
    for (number, sheet) in (0..).zip(&sampled.sheets) {
        let of_sheet = sampled.triangles.iter().zip(&sampled.sheet);
        let triangles: Vec<[u32; 3]> = of_sheet
            .filter(|(_, of)| **of == number)
            .map(|(t, _)| *t)
            .collect();
        let tree = SurfaceTree::new(&sampled.positions, &triangles);
        for _ in 0..50 {
            let point = sheet.point(&motion, next(), next());
            let distance = tree.distance_to_surface(point);
            assert!(
                distance <= sampled.error + 1e-12,
                "{distance:e} off {sheet:?}"
            );
        }
    }

    let body = planar::polygon(vec![star(15, 0.6, &mut pseudo_random(5))]);
    let spiral = Generator::spiral(DVec2::new(-0.6, 0.2), 2.5, 1.7);
    let motion = planar::motion(&[spiral, spiral.scaled(-0.3)]);
    let budget = PlanarBudget::of(0.01);
    let curves = envelope::planar::sampled_envelope(&body, &motion, &budget).expect("few segments");
    assert!(curves.len() > 8, "{}", curves.len());
    for sampled in curves {
        assert!(sampled.error <= 0.01, "{}", sampled.error);
        for _ in 0..50 {
            let point = sampled.curve.point(&motion, next());
            let distance = |ends: &[DVec2]| {
                let along = ends[1] - ends[0];
                let share = (point - ends[0]).dot(along) / along.length_squared();
                point.distance(ends[0].lerp(ends[1], share.clamp(0.0, 1.0)))
            };
            let nearest = sampled.points.windows(2).map(distance);
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            assert!(nearest <= sampled.error + 1e-12, "{nearest:e} off");
        }
    }
}

#[test]
fn beyond_a_curve_there_is_one_interval_fewer() {
    let body = planar::polygon(vec![star(15, 0.6, &mut pseudo_random(5))]);
    let spiral = Generator::spiral(DVec2::new(-0.6, 0.2), 2.5, 1.7);
    let shear = Generator::from_rows([[0.3, 1.1, 0.4], [-0.2, -0.5, 1.3]]).expect("finite");
    let mut folds = [0; 2];
    for generator in [spiral, shear] {
        let motion = planar::motion(&[generator]);
        let membership = membership::planar::Membership::new(&body, &motion);
        for curve in envelope::planar::envelope(&body, &motion) {
            for share in [0.21, 0.5, 0.83] {
                let normal = curve.normal(&motion, share).expect("it moves");
                let point = curve.point(&motion, share);
                let [within, beyond] =
                    [-BESIDE, BESIDE].map(|step| membership.intervals(point + step * normal).len());
                assert_eq!(within, beyond + 1, "{curve:?} at {share}");
                folds[usize::from(curve.fold == Fold::Inner)] += 1;
            }
        }
    }
    assert!(folds[0] > 12 && folds[1] > 3, "{folds:?}");
}
