//! The untrimmed envelope: beyond each of its sheets and curves, one time interval inside the body
//! fewer, as the times of membership tell.

use crate::support::planar::{self, star};
use crate::support::random::pseudo_random;
use crate::support::shapes;
use crate::support::sweep::{general_affine, mesh, motion, screw};
use glam::{DVec2, DVec3};
use steadysweep::envelope;
use steadysweep::envelope::spatial::Fold;
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
