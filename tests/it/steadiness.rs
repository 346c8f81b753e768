//! SAM's average relative acceleration: closed forms, and a reference by differences.

use crate::support::random::Random;
use glam::{DAffine2, DAffine3, DQuat, DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};
use steadysweep::motion::scheme::{Course, Keyed, Scheme};
use steadysweep::motion::steadiness::{self, Sample, Steadiness};
use steadysweep::motion::{Flow, HalfTurns, Keyframe, Motion, planar};

fn course(scheme: Scheme, keys: &[Keyframe]) -> Course<Flow> {
    Course::new(&Keyed::new(scheme, keys), &HalfTurns::Refused).expect("legal")
}

fn of(scheme: Scheme, pose: DAffine3, duration: f64, body: &[Sample<DVec3>]) -> Steadiness {
    let keys = [(1.0, DAffine3::IDENTITY), (1.0 + duration, pose)];
    let keys = keys.map(|(time, pose)| Keyframe { time, pose });
    steadiness::of_course(&course(scheme, &keys), body).expect("legal")
}

fn assert_close(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!(
        (found - expected).abs() <= tolerance * expected.abs(),
        "{what}: {found} instead of {expected}"
    );
}

/// The mean distance of a square of side 1 from one of its corners is (sqrt 2 + asinh 1) / 3.
#[test]
fn samples_fill_the_body() {
    let square = steadiness::in_rectangle(DVec2::ZERO, DVec2::ONE);
    let sum: f64 = square.iter().map(|sample| sample.point.length()).sum();
    let expected = (2.0_f64.sqrt() + 1.0_f64.asinh()) / 3.0;
    assert_close(sum / square.len() as f64, expected, 1e-6, "square");
    // Of a cube, |p|^2 has the mean 1.
    let cube = steadiness::in_box(DVec3::ZERO, DVec3::ONE);
    let sum: f64 = cube
        .iter()
        .map(|sample| sample.point.length_squared())
        .sum();
    assert_close(sum / cube.len() as f64, 1.0, 1e-14, "cube");
}

/// Along straight lines from I to a turn by theta the average is 2 theta tan(theta / 2) mean |p|,
/// with |p| the distance from the axis: pi times it at a quarter turn.
#[test]
fn a_turn_along_straight_lines_has_its_closed_form() {
    let body = steadiness::in_box(DVec3::new(-0.3, 0.2, 0.0), DVec3::new(1.0, 0.7, 2.0));
    let radii = body
        .iter()
        .map(|sample| sample.point.truncate().length())
        .sum::<f64>();
    let mean = radii / body.len() as f64;
    for angle in [1e-3_f64, 0.4, FRAC_PI_2, 2.5, 3.0] {
        for duration in [1.0, 2.5] {
            let found = of(
                Scheme::Linear,
                DAffine3::from_rotation_z(angle),
                duration,
                &body,
            );
            let expected = 2.0 * angle * (0.5 * angle).tan() * mean / (duration * duration);
            assert_close(
                found.average_relative_acceleration,
                expected,
                1e-6,
                &format!("turn by {angle} in {duration}"),
            );
        }
    }
}

/// A turn by theta whose centre goes along d: theta |d| for every body; relative to the speed of the
/// centre, theta.
#[test]
fn a_turn_with_a_straight_centre_has_its_closed_form() {
    let mut random = Random::new(1);
    for _ in 0..20 {
        let axis = random.direction();
        let across = random.direction().cross(axis);
        let (angle, duration) = (random.between(0.1, 3.0), random.magnitude(0.1, 10.0));
        let path = across * 3.0;
        let pose = DAffine3::from_rotation_translation(DQuat::from_axis_angle(axis, angle), path);
        for scheme in [Scheme::Polar, Scheme::Asap, Scheme::PolarLog] {
            let centre = [Sample {
                point: DVec3::ZERO,
                weight: 2.0,
            }];
            for body in [&centre[..], &steadiness::in_box(DVec3::X, 2.0 * DVec3::ONE)] {
                let found = of(scheme, pose, duration, body);
                let expected = angle * path.length() / (duration * duration);
                let average = found.average_relative_acceleration;
                assert_close(average, expected, 1e-6, &format!("{scheme:?} {angle}"));
                if body.len() == 1 {
                    assert_close(found.relative, angle, 1e-6, "relative");
                    assert_close(found.mean_speed, path.length() / duration, 1e-9, "speed");
                }
                assert!(found.jumps.is_empty(), "two keyframes have no jump");
            }
        }
    }
}

/// Steady motions: 0 to the last bit by SAM, and to rounding by whatever scheme is steady.
#[test]
fn a_steady_motion_has_none() {
    let mut random = Random::new(2);
    let body = steadiness::in_box(DVec3::ZERO, DVec3::ONE);
    for _ in 0..20 {
        let axis = random.direction();
        let turn = DQuat::from_axis_angle(axis, random.between(0.1, 3.0));
        let screw = DAffine3::from_rotation_translation(turn, axis * 2.0);
        let found = of(Scheme::Steady, screw, 1.0, &body);
        assert_eq!(found.average_relative_acceleration, 0.0, "steady");
        assert!(found.mean_speed > 0.0, "it moves");
        for scheme in [Scheme::Polar, Scheme::Asap, Scheme::PolarLog, Scheme::Log] {
            let found = of(scheme, screw, 1.0, &body);
            let average = found.average_relative_acceleration;
            assert!(average < 1e-12, "{scheme:?}: {average:e}");
        }
    }
    let at_rest = of(Scheme::Linear, DAffine3::IDENTITY, 1.0, &body);
    assert_eq!(at_rest.relative, 0.0, "at rest");
}

/// The pair 1 -> \[R(120 degrees) diag(1.6, .7) | (4, 1)\] of the unit square about its centre.
/// The first figures were found by a program that takes second differences of the plain formulas;
/// with the corner of the square at the origin it gave the second ones, to four digits.
#[test]
fn schemes_of_one_pair_compare_as_studied() {
    let turn = 2.0 * PI / 3.0;
    let scale = DVec2::new(1.6, 0.7);
    let pose = DAffine2::from_scale_angle_translation(scale, turn, DVec2::new(4.0, 1.0));
    let keys = [(0.0, DAffine2::IDENTITY), (1.0, pose)];
    let keys = keys.map(|(time, pose)| planar::Keyframe { time, pose });
    let about_centre = steadiness::in_rectangle(DVec2::splat(-0.5), DVec2::splat(0.5));
    let from_corner = steadiness::in_rectangle(DVec2::ZERO, DVec2::ONE);
    for (scheme, expected) in [
        (Scheme::Linear, [24.786, 17.835]),
        (Scheme::Polar, [8.718, 7.692]),
        (Scheme::Asap, [8.802, 7.720]),
        (Scheme::PolarLog, [8.802, 7.720]),
        (Scheme::Spiral, [2.240, 1.113]),
        (Scheme::Log, [0.0, 0.0]),
        (Scheme::Steady, [0.0, 0.0]),
    ] {
        let keyed = Keyed::new(scheme, &keys);
        let course: Course<planar::Flow> = Course::new(&keyed, &HalfTurns::Refused).expect("legal");
        for (body, expected) in [&about_centre, &from_corner].into_iter().zip(expected) {
            let found = steadiness::of_course(&course, body).expect("legal");
            let off = found.average_relative_acceleration - expected;
            // The sums of the study are good to a unit of the last digit.
            assert!(off.abs() < 1.1e-3, "{scheme:?}: {off:e} from {expected}");
        }
    }
}

/// A chain that follows a uniform turn with a straight path by m even spans has all but one m-th of
/// its average: the jumps are as large as the change over a span, and the ends have none.
#[test]
fn a_chain_has_nearly_the_average_of_the_motion_that_it_follows() {
    let (angle, path) = (1.2_f64, DVec3::new(3.0, 4.0, 0.0));
    let pose = DAffine3::from_rotation_translation(DQuat::from_rotation_z(angle), path);
    let keys = [(0.0, DAffine3::IDENTITY), (2.0, pose)];
    let keys = keys.map(|(time, pose)| Keyframe { time, pose });
    let polar = course(Scheme::Polar, &keys);
    let body = steadiness::in_box(DVec3::ZERO, DVec3::ONE);
    let smooth = steadiness::of_course(&polar, &body).expect("legal");
    for spans in [1_u32, 2, 7, 32] {
        let times = (0..=spans).map(|joint| 2.0 * f64::from(joint) / f64::from(spans));
        let keys: Vec<Keyframe> = times
            .map(|time| Keyframe {
                time,
                pose: polar.pose_at_time(time),
            })
            .collect();
        let chain = Motion::from_keyframes(&keys).expect("legal");
        let found = steadiness::of_chain(&chain, &body).expect("legal");
        let share = f64::from(spans - 1) / f64::from(spans);
        let expected = share * smooth.average_relative_acceleration;
        let average = found.average_relative_acceleration;
        assert!(
            (average - expected).abs() < 1e-8,
            "{spans}: {average} {expected}"
        );
        assert_eq!(found.jumps.len() + 1, spans as usize);
        // Per unit of time, theta |d| / m over a duration of 2.
        let jump = angle * path.length() / f64::from(spans) / 2.0;
        for found in &found.jumps {
            assert_close(found.speed, jump, 1e-10, "jump");
        }
    }
}

/// Along x at the speed 1, then along y at the speed 1/2, whatever the scheme.
#[test]
fn keyframes_are_jumps() {
    let places = [
        (0.0, DVec3::ZERO),
        (1.0, DVec3::X),
        (3.0, DVec3::ONE - DVec3::Z),
    ];
    let keys = places.map(|(time, place)| Keyframe {
        time,
        pose: DAffine3::from_translation(place),
    });
    let body = steadiness::in_box(DVec3::ZERO, DVec3::ONE);
    for scheme in Scheme::ALL {
        let found = steadiness::of_course(&course(scheme, &keys), &body).expect("legal");
        let jump = 1.25_f64.sqrt();
        assert_eq!(found.jumps.len(), 1, "{scheme:?}");
        assert_eq!(found.jumps[0].time, 1.0, "{scheme:?}");
        assert_close(found.largest_jump(), jump, 1e-12, scheme.name());
        let average = found.average_relative_acceleration;
        assert_close(average, jump / 3.0, 1e-9, scheme.name());
        assert_close(found.mean_speed, 2.0 / 3.0, 1e-12, scheme.name());
        assert_close(found.relative, 1.5 * jump, 1e-9, scheme.name());
    }
}

/// Along straight lines this body is a mirror image of itself from 1/3 to 1/2 of the time.
#[test]
fn what_flattens_the_body_is_refused() {
    let half = DAffine3::from_scale(DVec3::new(-1.0, -2.0, 1.0));
    let keys = [(0.0, DAffine3::IDENTITY), (1.0, half)];
    let keys = keys.map(|(time, pose)| Keyframe { time, pose });
    let body = steadiness::in_box(DVec3::ZERO, DVec3::ONE);
    let error = steadiness::of_course(&course(Scheme::Linear, &keys), &body).expect_err("flat");
    let error = error.to_string();
    assert!(error.contains("flattened near time 0.5"), "{error}");
}
