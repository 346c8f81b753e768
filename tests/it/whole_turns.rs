//! Whole turns added to the steady motion between two poses: log L + 2 pi k J.

use crate::support::command::{CUBE, Scratch};
use crate::support::exponential::exponential;
use crate::support::random::Random;
use crate::support::taylor::naive_exponential;
use glam::{DAffine2, DAffine3, DMat2, DMat3, DQuat, DVec2, DVec3};
use serde_json::Value;
use std::f64::consts::{PI, TAU};
use steadysweep::motion::{
    Generator, HalfTurns, Keyframe, Motion, MotionError, describe, logarithm, logarithm_with_turns,
    planar,
};

const TURNS: [i32; 6] = [-2, -1, 0, 1, 2, 3];

/// The eigenvalues lambda, mean +- i angle of a matrix with a complex pair, by Newton's method on
/// its characteristic polynomial.
fn complex_spectrum(m: &DMat3) -> Option<(f64, f64, f64)> {
    let trace = m.x_axis.x + m.y_axis.y + m.z_axis.z;
    let square = *m * *m;
    let minors = 0.5 * (trace * trace - (square.x_axis.x + square.y_axis.y + square.z_axis.z));
    let polynomial = |x: f64| ((x - trace) * x + minors) * x - m.determinant();
    let (mut low, mut high) = (-1e3, 1e3);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if polynomial(middle) > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    let mean = 0.5 * (trace - low);
    let angle_squared = minors - 2.0 * mean * low - mean * mean;
    (angle_squared > 0.01).then(|| (low, mean, angle_squared.sqrt()))
}

/// J: the generator of rotations in the invariant plane of the complex pair, as a polynomial of M.
fn rotation_generator(m: &DMat3, (lambda, mean, angle): (f64, f64, f64)) -> DMat3 {
    let rest = *m - DMat3::IDENTITY * mean;
    let apart = lambda - mean;
    // On the eigenvector this is 1, in the plane 0.
    let projector =
        (rest * rest + DMat3::IDENTITY * (angle * angle)) * (apart * apart + angle * angle).recip();
    (rest - projector * apart) * angle.recip()
}

fn largest(matrix: &DMat3) -> f64 {
    matrix
        .to_cols_array()
        .iter()
        .fold(0.0, |m, x| x.abs().max(m))
}

/// How far two affinities differ, entry by entry.
fn gap(a: &DAffine3, b: &DAffine3) -> f64 {
    let shift = (a.translation - b.translation).abs().max_element();
    largest(&(a.matrix3 - b.matrix3)).max(shift)
}

#[test]
fn whole_turns_lead_to_the_same_affinity() {
    let mut random = Random::new(12);
    let mut tried = 0;
    while tried < 400 {
        let pose = DAffine3 {
            matrix3: random.matrix(1.0),
            translation: random.point(1.0),
        };
        let Ok(principal) = logarithm(&pose) else {
            continue;
        };
        let linear = principal.flow.generator().linear;
        let Some(spectrum) = complex_spectrum(&linear) else {
            continue;
        };
        let turn = rotation_generator(&linear, spectrum);
        // J is larger than 1 where the axis leans on the plane or points turn along ellipses, and
        // rounding grows with it.
        if largest(&turn) > 3.0 {
            continue;
        }
        tried += 1;
        for k in TURNS {
            let steady = logarithm_with_turns(&pose, k).expect("a complex pair");
            assert!(steady.unique(), "the number of turns is said");
            let missed = gap(&steady.flow.pose_at(1.0), &pose);
            assert!(missed < 1e-13, "{k} turns of {pose:?}: {missed:e}");
            let generator = steady.flow.generator();
            let missed = gap(&naive_exponential(generator, 1.0), &pose);
            assert!(missed < 1e-12, "{k} turns of {pose:?}: {missed:e}");
            let expected = linear + turn * (TAU * f64::from(k));
            let error = largest(&(generator.linear - expected));
            assert!(error < 1e-11, "{k} turns of {pose:?}: {error:e}");
        }
    }
}

#[test]
fn whole_turns_of_the_plane_lead_to_the_same_affinity() {
    let mut random = Random::new(13);
    let mut tried = 0;
    while tried < 400 {
        let pose = DAffine2 {
            matrix2: random.planar_matrix(),
            translation: random.planar_point(),
        };
        let Ok(principal) = planar::logarithm(&pose) else {
            continue;
        };
        let [x, y] = [pose.matrix2.x_axis, pose.matrix2.y_axis];
        let disc = 0.25 * (x.x - y.y) * (x.x - y.y) + x.y * y.x;
        if disc > -0.01 {
            continue;
        }
        tried += 1;
        // J of L, which is similar to the quarter turn from x towards y where L turns that way.
        let rest = pose.matrix2 - DMat2::IDENTITY * (0.5 * (x.x + y.y));
        let turn = rest * (-disc).sqrt().copysign(x.y).recip();
        for k in TURNS {
            let steady = planar::logarithm_with_turns(&pose, k).expect("a complex pair");
            let end = exponential(steady.flow.generator(), 1.0);
            let end = [end, steady.flow.pose_at(1.0)];
            for (end, allowed) in end.iter().zip([1e-12, 1e-13]) {
                assert!(
                    end.abs_diff_eq(pose, allowed),
                    "{k} turns of {pose:?}: {end:?}"
                );
            }
            let expected = principal.flow.generator().linear + turn * (TAU * f64::from(k));
            assert!(
                steady
                    .flow
                    .generator()
                    .linear
                    .abs_diff_eq(expected, 1e-11 * f64::from(1 + k.abs())),
                "{k} turns of {pose:?}"
            );
        }
    }
}

#[test]
fn a_screw_is_turned_further_about_its_own_axis() {
    let axis = DVec3::new(0.48, 0.6, 0.64);
    for angle in [1e-6, 0.3, 2.0, 3.1, PI - 1e-7] {
        for k in TURNS {
            let through = DVec3::new(1.0, -2.0, 0.5);
            let screw = |turn| Generator::screw(axis, through, turn, 0.7, 1.0);
            let pose = naive_exponential(&screw(angle), 1.0);
            let steady = logarithm_with_turns(&pose, k).expect("it turns");
            let expected = screw(angle + TAU * f64::from(k));
            let error = largest(&(steady.flow.generator().linear - expected.linear));
            // The axis is known to 1e-16 over the angle, or over what is missing to a half turn.
            let allowed = 1e-13 / angle.min(PI - angle).min(1.0);
            assert!(error < allowed, "{k} turns and {angle}: {error:e}");
            let turned = describe(steady.flow.generator()).turn_deg;
            let turned = turned.expect("it turns").to_radians();
            let expected = (angle + TAU * f64::from(k)).abs();
            assert!((turned - expected).abs() < 1e-9, "{turned}, not {expected}");
        }
    }
}

#[test]
fn a_half_turn_goes_in_the_sense_of_its_whole_turns() {
    let half = DAffine3::from_quat(DQuat::from_rotation_z(PI));
    for (k, expected) in [
        (1, 3.0 * PI),
        (2, 5.0 * PI),
        (-1, -3.0 * PI),
        (-2, -5.0 * PI),
    ] {
        let steady = logarithm_with_turns(&half, k).expect("a half turn");
        assert!(steady.unique(), "the sense is said");
        let linear = steady.flow.generator().linear;
        assert!((linear.x_axis.y - expected).abs() < 1e-14, "{linear}");
        let flat = DAffine2::from_angle(PI);
        let steady = planar::logarithm_with_turns(&flat, k).expect("a half turn");
        let linear = steady.flow.generator().linear;
        assert!((linear.x_axis.y - expected).abs() < 1e-14, "{linear}");
    }
}

#[test]
fn where_nothing_turns_whole_turns_are_refused() {
    let stretched = DAffine3 {
        matrix3: DMat3::from_diagonal(DVec3::new(2.0, 2.0, 0.5)),
        translation: DVec3::X,
    };
    let sheared = DAffine3::from_mat3(DMat3::from_cols(
        DVec3::X,
        DVec3::new(1.0, 1.0, 0.0),
        DVec3::Z,
    ));
    let barely = DAffine3::from_rotation_z(5e-10);
    for pose in [DAffine3::IDENTITY, stretched, sheared, barely] {
        assert_eq!(
            logarithm_with_turns(&pose, 1).expect_err("nothing turns"),
            MotionError::NothingTurns,
            "{pose:?}"
        );
    }
    let key = |time, pose| Keyframe { time, pose };
    let keys = [key(0.0, DAffine3::IDENTITY), key(1.0, barely)];
    let refused = |turns: &[i32]| {
        Motion::from_keyframes_with_turns(&keys, turns, &HalfTurns::Refused)
            .expect_err("must be refused")
            .to_string()
    };
    assert!(
        refused(&[-1]).starts_with("between keyframes 0 and 1: whole turns are asked for"),
        "{}",
        refused(&[-1])
    );
    assert!(refused(&[1, 0]).contains("one for each of the 1 span"));
    let keys = [
        key(0.0, DAffine3::IDENTITY),
        key(1.0, DAffine3::from_rotation_z(1.0)),
    ];
    let error = Motion::from_keyframes_with_turns(&keys, &[i32::MIN], &HalfTurns::Refused)
        .expect_err("too many");
    assert!(error.to_string().contains("more than 25000"), "{error}");
}

#[test]
fn a_motion_file_gives_whole_turns_to_the_key_at_their_end() {
    let scratch = Scratch::new("whole_turns");
    scratch.write(
        "screw.json",
        "{\"keyframes\": [{}, {\"translation\": [0, 0, 3], \"rotation\": [0, 0, 0.6, 0.8], \"turns\": 2},
          {\"turns\": 0, \"rotation\": [0, 0, 1, 0], \"translation\": [0, 0, 3]}]}",
    );
    let json = |arguments: &str| -> Value {
        let run = scratch.run(arguments);
        serde_json::from_str(&run.out).unwrap_or_else(|_| panic!("{}{}", run.out, run.err))
    };
    let report = json("motion --motion screw.json --json");
    let turn = |span: usize| report["spans"][span]["turn_deg"].as_f64().expect("a turn");
    let short = 2.0 * 0.6_f64.atan2(0.8).to_degrees();
    assert!((turn(0) - (720.0 + short)).abs() < 1e-11, "{report}");
    assert!((turn(1) - (180.0 - short)).abs() < 1e-11, "{report}");
    assert_eq!(
        report["spans"][0]["axis"],
        serde_json::json!([0.0, 0.0, 1.0])
    );

    scratch.write(
        "back.json",
        "{\"keyframes\": [{}, {\"rotation_deg\": 90, \"turns\": -1}, {\"rotation_deg\": -90, \"turns\": 1}]}",
    );
    let report = json("motion --motion back.json --json");
    for (span, expected) in [(0, -270.0), (1, 540.0)] {
        let turn = report["spans"][span]["turn_deg"].as_f64().expect("a turn");
        assert!((turn - expected).abs() < 1e-11, "{report}");
        assert_eq!(report["spans"][span]["unique"], true);
    }

    // A point above the cube's rim is inside once per turn.
    scratch.write("cube.obj", CUBE);
    scratch.write("points.csv", "0.5,0.5,0.5\n");
    scratch.write(
        "turns.json",
        "{\"keyframes\": [{\"translation\": [3, 0, 0]}, {\"translation\": [0, 3, 0], \"rotation\": [0, 0, 0.7071067811865476, 0.7071067811865476], \"turns\": 3}]}",
    );
    scratch.write("points.csv", "-3.5,-0.5,0.5\n");
    let report = json("probe cube.obj --motion turns.json --points points.csv --json");
    let times = report["points"][0]["intervals"].as_array().expect("a list");
    assert_eq!(times.len(), 3, "{report}");
}

#[test]
fn misplaced_turns_are_refused_with_their_key() {
    let scratch = Scratch::new("whole_turns_refused");
    scratch.write("cube.obj", CUBE);
    for (keys, expected) in [
        (
            "{\"turns\": 1}, {}",
            "keyframe 0: expected no \"turns\" in the first keyframe",
        ),
        (
            "{}, {\"turns\": 1}",
            "between keyframes 0 and 1: whole turns are asked for, but nothing turns",
        ),
        (
            "{}, {\"turns\": 0.5}",
            "keyframe 1: expected a whole number, found floating point `0.5`",
        ),
        (
            "{}, {\"turns\": true}",
            "keyframe 1: expected a whole number, found boolean `true`",
        ),
    ] {
        scratch.write("bad.json", format!("{{\"keyframes\": [{keys}]}}"));
        let before = scratch.files();
        let run = scratch.run("sweep cube.obj --motion bad.json -o out.stl");
        assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{}", run.err);
        assert!(
            run.err.contains("bad.json") && run.err.contains(expected),
            "{}",
            run.err
        );
        assert_eq!(scratch.files(), before, "no file");
    }
}

#[test]
fn a_planar_chain_takes_whole_turns_too() {
    let key = |time, pose| planar::Keyframe { time, pose };
    let quarter = DAffine2::from_angle_translation(PI / 2.0, DVec2::new(2.0, 0.0));
    let keys = [key(0.0, DAffine2::IDENTITY), key(2.0, quarter)];
    let motion = planar::Motion::from_keyframes_with_turns(&keys, &[-1], &HalfTurns::Refused)
        .expect("it turns");
    let halfway = motion.pose_at_time(1.0);
    // Minus 270 degrees about (1, 1): halfway minus 135.
    let expected = DVec2::ONE + DVec2::from_angle(-0.75 * PI).rotate(-DVec2::ONE);
    assert!(
        halfway.translation.distance(expected) < 1e-14,
        "{halfway:?}"
    );
}
