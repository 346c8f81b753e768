//! Translations: both bounds are proven for every body, and hold to the last digits.

use crate::support::random::pseudo_random;
use crate::support::shapes::{self, Shape};
use crate::support::sweep::{agreement, mesh, motion, translation};
use glam::{DAffine3, DQuat, DVec3};
use steadysweep::motion::{Generator, Motion};
use steadysweep::{Precision, Sweep, SweepError, SweepSettings, sweep};

fn swept(shape: &Shape, motion: &Motion, precision: Precision) -> Sweep {
    let settings = SweepSettings::default().with_precision(precision);
    sweep(&mesh(shape), motion, &settings).expect("a legal sweep succeeds")
}

/// A prism over a regular polygon, from z = -1 to 1.
fn prism(sides: u32, radius: f64) -> Shape {
    let corner = |i: u32| {
        let angle = f64::from(i) / f64::from(sides) * std::f64::consts::TAU;
        radius * glam::DVec2::from_angle(angle)
    };
    let outline: Vec<_> = (0..sides).map(corner).collect();
    shapes::mapped(shapes::prism(&outline, 2.0), |p| p - DVec3::Z)
}

fn tilt() -> DQuat {
    DQuat::from_scaled_axis(DVec3::new(0.3, -0.8, 0.5))
}

fn tilted(shape: Shape, by: DVec3) -> Shape {
    let pose = DAffine3::from_rotation_translation(tilt(), by);
    shapes::mapped(shape, |p| pose.transform_point3(p))
}

/// Convex bodies, turned and displaced.
fn convex_bodies() -> Vec<Shape> {
    let bodies = [
        shapes::icosphere(0, 1.0, DVec3::ZERO),
        shapes::icosphere(2, 0.7, DVec3::new(0.1, 0.2, 0.3)),
        shapes::cuboid(DVec3::splat(-0.5), DVec3::new(0.5, 1.5, 2.5)),
        prism(3, 1.0),
        prism(64, 0.5),
        shapes::cone(0.5, 1.0, 24),
    ];
    let far = DVec3::new(1e4, -3e3, 7e3);
    bodies
        .into_iter()
        .flat_map(|shape| {
            [
                shape.clone(),
                tilted(shape.clone(), DVec3::ZERO),
                tilted(shape, far),
            ]
        })
        .collect()
}

/// Displacements along and across the bodies, straight and turned as they are, and others.
fn ways() -> Vec<DVec3> {
    let straight = [
        DVec3::new(0.0, 0.0, 3.0),
        DVec3::new(2.0, 0.0, 0.0),
        DVec3::new(1.0, 2.0, 3.0),
        DVec3::new(5.0, 0.0, 3.0),
    ];
    straight
        .into_iter()
        .flat_map(|way| [way, tilt() * way])
        .collect()
}

#[test]
fn both_bounds_are_proven_and_hold_for_convex_bodies() {
    for (body, shape) in convex_bodies().iter().enumerate() {
        for way in ways() {
            for precision in [Precision::Double, Precision::Single] {
                let single = motion(&[Generator::translation(way)]);
                let swept = swept(shape, &single, precision);
                let bound = swept.error_bound;
                let case = format!("{body} by {way} {precision:?}: {bound:?}");
                assert!(bound.inside.proven && bound.outside.proven, "{case}");
                let reach = shape
                    .0
                    .iter()
                    .map(|p| p.abs().max_element())
                    .fold(0.0, f64::max)
                    + way.length();
                if precision == Precision::Double {
                    // The rounding of the coordinates, and of points that are joined in a file.
                    assert!(bound.inside.length < 1e-12 * reach, "{case}");
                }
                // Compares with the hull of the two ends, by its extent in many directions;
                // products are rounded by less than 8 u.
                let rounding = 4.0 * f64::EPSILON * reach;
                let mut random = pseudo_random(11);
                let mut next = || 2.0 * random.next().expect("endless") - 1.0;
                for _ in 0..200 {
                    let n = DVec3::new(next(), next(), next()).normalize();
                    let extent = |points: &[DVec3]| {
                        points
                            .iter()
                            .map(|p| n.dot(*p))
                            .fold(f64::NEG_INFINITY, f64::max)
                    };
                    let expected = extent(&shape.0) + n.dot(way).max(0.0);
                    let found = extent(swept.solid.positions());
                    assert!(
                        expected - found <= bound.inside.length + rounding
                            && found - expected <= bound.outside.length + rounding,
                        "{case}: {found} for {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn bodies_that_are_not_convex_and_chains_are_proven_too() {
    let bodies = [
        shapes::l_prism(0.3, 0.5),
        shapes::u_prism(0.3, 0.5),
        shapes::torus(1.0, 0.4, 16, 8),
        shapes::bumpy_sphere(600),
        shapes::box_with_hole(DVec3::ONE, 0.2),
        // Faces are parallel to the displacement only up to rounding.
        shapes::icosphere(0, 1.0, DVec3::ZERO),
        prism(24, 0.5),
        tilted(prism(7, 0.5), DVec3::ZERO),
    ];
    let along = |way: DVec3| Generator::translation(tilt() * way);
    let motions = [
        motion(&[translation(0.7, 0.4, 0.2)]),
        motion(&[translation(0.0, 0.0, 1.0)]),
        motion(&[translation(0.7, 0.4, 0.2), translation(-0.1, 0.5, 0.9)]),
        motion(&[
            translation(0.0, 0.0, 0.7),
            translation(0.3, 0.0, 0.0),
            translation(1.0, 2.0, 3.0),
            translation(0.0, 0.0, -3.0),
            along(DVec3::Z),
            along(DVec3::X),
        ]),
    ];
    for (body, shape) in bodies.iter().enumerate() {
        for motion in &motions {
            let swept = swept(shape, motion, Precision::Double);
            let bound = swept.error_bound;
            assert!(
                bound.inside.proven && bound.outside.proven,
                "{body}: {bound:?}"
            );
            let largest = 1e-12 * (1.0 + motion.spans().len() as f64);
            assert!(bound.inside.length < largest, "{body}: {bound:?}");
            let found = agreement(&mesh(shape), motion, &swept, 400).defects(&swept);
            assert!(found.is_empty(), "{body}: {found}");
        }
    }
}

#[test]
fn a_prism_that_grows_stays_within_its_bound_far_from_the_origin_too() {
    for (sides, centre) in [
        (3, DVec3::ZERO),
        (7, DVec3::splat(1e6)),
        (64, DVec3::new(3.0, 1e3, 0.1)),
    ] {
        let shape = shapes::mapped(prism(sides, 1.0), |p| p + centre);
        for (scale, through) in [
            (2.0, DVec3::ZERO),
            (100.0, centre),
            (0.3, centre + DVec3::X),
        ] {
            let grown = motion(&[Generator::screw(DVec3::Z, through, 0.0, 0.0, scale)]);
            let swept = swept(&shape, &grown, Precision::Double);
            let bound = swept.error_bound;
            let end = |p: &DVec3| through + (*p - through) * scale;
            let reach = shape
                .0
                .iter()
                .map(|p| p.abs().max(end(p).abs()).max_element());
            let rounding = 8.0 * f64::EPSILON * reach.fold(0.0, f64::max);
            let mut random = pseudo_random(5);
            let mut next = || 2.0 * random.next().expect("endless") - 1.0;
            for _ in 0..200 {
                let n = DVec3::new(next(), next(), next()).normalize();
                let extent = |points: &mut dyn Iterator<Item = DVec3>| {
                    points.map(|p| n.dot(p)).fold(f64::NEG_INFINITY, f64::max)
                };
                let both = shape.0.iter().copied().chain(shape.0.iter().map(end));
                let expected = extent(&mut both.into_iter());
                let found = extent(&mut swept.solid.positions().iter().copied());
                assert!(
                    found - expected <= bound.outside.length + rounding,
                    "{sides} at {centre} by {scale}: {:e}, {bound:?}",
                    found - expected
                );
            }
        }
    }
}

#[test]
fn a_body_that_rounding_leaves_nothing_of_is_refused() {
    for far in [3e11, 1e12, 1e13] {
        let ico = shapes::icosphere(0, 1.0, DVec3::new(far, 0.0, 0.0));
        let settings = SweepSettings::default();
        let refused = sweep(
            &mesh(&ico),
            &motion(&[translation(1.0, 2.0, 3.0)]),
            &settings,
        );
        assert!(
            matches!(refused, Err(SweepError::Vanished { .. })),
            "{far:e}: {:?}",
            refused.map(|swept| swept.error_bound)
        );
    }
}
