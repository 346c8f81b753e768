//! What a motion is: invariants of spans of any kind, the margin by which a steady motion exists,
//! and poses as a table that reads back.

use crate::support::command::{CUBE, Scratch};
use crate::support::random::Random;
use crate::support::taylor::naive_exponential;
use glam::{DAffine2, DAffine3, DMat2, DMat3, DVec2, DVec3};
use serde_json::Value;
use std::f64::consts::{FRAC_PI_2, PI};
use steadysweep::io;
use steadysweep::motion::{Generator, existence, invariants, planar, volume_change};

/// Three directions that are far from being in one plane.
fn frame(random: &mut Random) -> DMat3 {
    loop {
        let frame = random.matrix(1.0);
        if frame.determinant().abs() > 0.1 {
            return frame;
        }
    }
}

#[test]
fn a_motion_made_of_its_invariants_is_described_by_them() {
    let mut random = Random::new(21);
    for _ in 0..500 {
        let frame = frame(&mut random);
        let (rate, mean) = (random.signed(), random.signed());
        let turn = random.between(0.1, 20.0);
        // Along the first direction by `rate`; the other two span the plane in which it turns.
        let form = DMat3::from_cols(
            DVec3::new(rate, 0.0, 0.0),
            DVec3::new(0.0, mean, turn),
            DVec3::new(0.0, -turn, mean),
        );
        let fixed = random.point(3.0);
        let linear = frame * form * frame.inverse();
        let generator = Generator {
            linear,
            offset: -(linear * fixed),
        };
        let found = invariants(&generator);
        let expected = [[rate, 0.0], [mean, turn], [mean, -turn]];
        for (found, expected) in found.eigenvalues.iter().zip(expected) {
            let error = (found[0] - expected[0]).hypot(found[1] - expected[1]);
            assert!(error < 1e-11, "{:?}", found);
        }
        assert!((found.turn.expect("it turns") - turn).abs() < 1e-11);
        let point = found.fixed_point.expect("one point");
        let allowed = 1e-11 / rate.abs().min(1.0);
        assert!(point.distance(fixed) < allowed, "{point} is not {fixed}");
        // The normal is perpendicular to the plane, and the turn is right-handed about it.
        let normal = found.plane_normal.expect("it turns");
        assert!((normal.length() - 1.0).abs() < 1e-14);
        for direction in [frame.y_axis, frame.z_axis] {
            assert!(normal.dot(direction).abs() < 1e-12, "{normal}");
            assert!(normal.dot(direction.cross(linear * direction)) > 0.0);
        }
        let volume = naive_exponential(&generator, 1.0).matrix3.determinant();
        assert!((found.volume_factor / volume - 1.0).abs() < 1e-10);
    }
}

#[test]
fn a_planar_motion_made_of_its_invariants_is_described_by_them() {
    let mut random = Random::new(22);
    for _ in 0..500 {
        let frame = random.planar_matrix();
        if frame.determinant().abs() < 0.1 {
            continue;
        }
        let (mean, turn) = (random.signed(), random.between(0.1, 20.0));
        let form = DMat2::from_cols(DVec2::new(mean, turn), DVec2::new(-turn, mean));
        let fixed = random.planar_point();
        let linear = frame * form * frame.inverse();
        let generator = planar::Generator {
            linear,
            offset: -(linear * fixed),
        };
        let found = planar::invariants(&generator);
        let error = (found.eigenvalues[0][0] - mean).hypot(found.eigenvalues[0][1] - turn);
        assert!(error < 1e-11, "{found:?}");
        // In a mirrored frame it turns from y towards x.
        let expected = turn * frame.determinant().signum();
        assert!((found.turn.expect("it turns") - expected).abs() < 1e-11);
        assert!(found.fixed_point.expect("one").distance(fixed) < 1e-12);
        assert!((found.area_factor - (2.0 * mean).exp()).abs() < 1e-12 * found.area_factor);
    }
}

#[test]
fn shears_and_stretches_do_not_turn_in_any_frame() {
    let mut random = Random::new(23);
    for _ in 0..500 {
        let frame = frame(&mut random);
        for form in [
            DMat3::from_cols(DVec3::ZERO, DVec3::X, DVec3::Y),
            DMat3::from_cols(DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Z * -0.5),
            DMat3::from_diagonal(DVec3::new(0.5, 0.5, -1.0)),
        ] {
            let linear = frame * form * frame.inverse();
            let found = invariants(&Generator {
                linear,
                offset: DVec3::X,
            });
            assert_eq!((found.turn, found.plane_normal), (None, None), "{linear}");
        }
    }
    // A screw has no fixed point, a rotation a line of them.
    for advance in [0.0, 1.0] {
        let screw = Generator::screw(DVec3::Z, DVec3::X, 1.0, advance, 1.0);
        let found = invariants(&screw);
        assert_eq!(
            (found.fixed_point, found.plane_normal),
            (None, Some(DVec3::Z))
        );
    }
}

#[test]
fn volumes_of_a_chain_are_multiplied() {
    let rate = |scale: f64| Generator::screw(DVec3::Z, DVec3::ONE, 2.0, 1.0, scale).volume_rate();
    let change = volume_change([rate(0.5), rate(1.0), rate(0.5)]);
    assert!((change.factor - 1.0 / 64.0).abs() < 1e-15 && change.monotone);
    let change = volume_change([rate(0.5), rate(4.0)]);
    assert!((change.factor - 8.0).abs() < 1e-13 && !change.monotone);
    assert!(volume_change([rate(1.0), 1e-16, -1e-16]).monotone);
}

/// The smallest singular value of [a b; c d].
fn smallest(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let squares = a * a + b * b + c * c + d * d;
    let determinant = (a * d - b * c).abs();
    let sum = (squares + 2.0 * determinant).sqrt();
    let difference = (squares - 2.0 * determinant).max(0.0).sqrt();
    0.5 * (sum - difference)
}

#[test]
fn in_the_plane_the_margin_ends_where_the_paper_says() {
    // SAM (4): R(a) diag(r, 1/r) has a steady motion as long as |a| < pi/2 + 2 atan r; here it is
    // scaled by r, and s = r^2.
    for s in [0.05_f64, 0.2, 0.5, 0.9] {
        let limit = FRAC_PI_2 + 2.0 * s.sqrt().atan();
        let mut before = f64::INFINITY;
        for step in 0..=60 {
            let a = PI * f64::from(step) / 60.0;
            let pose = DAffine2::from_angle(a) * DAffine2::from_scale(DVec2::new(1.0, s));
            let found = planar::existence(&DAffine2::IDENTITY, &pose).expect("a pose");
            assert_eq!(found.exists, a < limit, "{s}, {a}");
            assert_eq!(found.exists, found.unique);
            assert!(found.change <= before * 1.02, "it only shrinks: {s}, {a}");
            before = found.change;
            if found.exists {
                // L + t I for many t.
                let least = (0..=40_000)
                    .map(|k| {
                        let t = f64::from(k) * 5e-5;
                        smallest(a.cos() + t, -s * a.sin(), a.sin(), s * a.cos() + t)
                    })
                    .fold(f64::INFINITY, f64::min);
                assert!(found.change <= least + 1e-12, "{} of {least}", found.change);
                assert!(
                    found.change >= 0.98 * least - 1e-4,
                    "{} of {least}",
                    found.change
                );
                assert!(found.angle > 0.0);
            } else {
                assert_eq!((found.angle, found.change), (0.0, 0.0));
            }
        }
        let near = DAffine2::from_angle(limit - 1e-6) * DAffine2::from_scale(DVec2::new(1.0, s));
        let near = planar::existence(&DAffine2::IDENTITY, &near).expect("a pose");
        assert!(near.exists && near.change < 1e-5, "{}", near.change);
    }
}

#[test]
fn in_space_smaller_changes_leave_a_steady_motion() {
    // A rotation by an obtuse angle is sin(angle) away from a half turn.
    for angle in [0.5, 2.0, 2.5, 3.0, 3.13] {
        let pose = DAffine3::from_axis_angle(DVec3::new(0.36, 0.48, 0.8), angle);
        let found = existence(&DAffine3::IDENTITY, &pose).expect("a pose");
        let expected = if angle > FRAC_PI_2 { angle.sin() } else { 1.0 };
        assert!(
            found.change <= expected * (1.0 + 1e-9) && found.change > 0.98 * expected,
            "{} instead of {expected}",
            found.change
        );
        assert!((found.angle - (PI - angle)).abs() < 1e-12);
    }
    let mut random = Random::new(24);
    let mut tried = 0;
    while tried < 300 {
        let pose = DAffine3::from_mat3(random.matrix(1.0));
        let Ok(found) = existence(&DAffine3::IDENTITY, &pose) else {
            continue;
        };
        if !found.unique {
            continue;
        }
        tried += 1;
        let entries = pose.matrix3.to_cols_array();
        // The spectral norm is at least that of the Frobenius norm over sqrt 3.
        let norm = entries.iter().map(|x| x * x).sum::<f64>().sqrt() / 3.0_f64.sqrt();
        for _ in 0..20 {
            // Of rank one: its norm is the product of the lengths.
            let (u, v) = (random.direction(), random.direction());
            let change =
                DMat3::from_cols(u * v.x, u * v.y, u * v.z) * (0.999 * found.change * norm);
            let changed = DAffine3::from_mat3(pose.matrix3 + change);
            let after = existence(&DAffine3::IDENTITY, &changed).expect("a pose");
            assert!(after.exists && after.unique, "{pose:?} {changed:?}");
        }
    }
    let half = DAffine3::from_axis_angle(DVec3::Z, PI);
    let found = existence(&DAffine3::IDENTITY, &half).expect("a pose");
    assert_eq!(
        (found.exists, found.unique, found.angle, found.change),
        (true, false, 0.0, 0.0)
    );
    let mirrored = DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0));
    assert!(existence(&DAffine3::IDENTITY, &mirrored).is_err());
    assert!(existence(&mirrored, &DAffine3::IDENTITY).is_err());
}

#[test]
fn an_affine_span_is_told_by_what_it_leaves_alone() {
    let scratch = Scratch::new("motion_described");
    // Twice as long along (1, 0, 1), a quarter turn in the plane z = 0, about (1, 2, 3).
    let quarter = FRAC_PI_2;
    let double = std::f64::consts::LN_2;
    scratch.write(
        "affine.json",
        format!(
            "{{\"spans\": [{{\"generator\": [[0, {}, {double}, {}], [{quarter}, 0, {}, {}], [0, 0, {double}, {}]]}}, {{\"scale\": 0.5}}]}}",
            -quarter,
            2.0 * quarter - 3.0 * double,
            -quarter,
            2.0 * quarter,
            -3.0 * double,
        ),
    );
    let run = scratch.run("motion --motion affine.json --json");
    let report: Value = serde_json::from_str(&run.out).unwrap_or_else(|_| panic!("{}", run.err));
    let span = &report["spans"][0];
    assert_eq!(span["kind"], "affine");
    let near = |value: &Value, expected: f64| {
        let found = value.as_f64().unwrap_or(f64::NAN);
        assert!(
            (found - expected).abs() < 1e-12,
            "{found}, not {expected}: {report}"
        );
    };
    near(&span["eigenvalues"][0][0], double);
    near(&span["eigenvalues"][1][1], quarter);
    near(&span["volume_factor"], 2.0);
    near(&span["turn_deg"], 90.0);
    for (axis, fixed) in [1.0, 2.0, 3.0].into_iter().enumerate() {
        near(&span["fixed_point"][axis], fixed);
        near(&span["plane_normal"][axis], f64::from(u8::from(axis == 2)));
    }
    near(&span["margin"]["angle_deg"], 90.0);
    near(&report["volume_factor"], 0.25);
    assert_eq!(report["volume_monotone"], false);
    let text = scratch.run("motion --motion affine.json").out;
    for line in [
        "  turn      90 degrees\n",
        "  grows     2 times\n            1 times in the plane in which it turns\n",
        "  normal    (0, 0, 1)\n",
        "  fixed     (1, 2, 3)\n",
        "  margin    90 degrees, ",
        "the volume grows and shrinks, to 0.25 times that at the start\n",
    ] {
        assert!(text.contains(line), "{line:?} is missing: {text}");
    }
}

#[test]
fn poses_are_written_as_a_table_that_is_read_as_a_log() {
    let scratch = Scratch::new("motion_poses");
    scratch.write(
        "keys.json",
        "{\"keyframes\": [{\"time\": 2, \"translation\": [1, 0, 0]}, {\"time\": 3, \"rotation\": [0, 0, 0.6, 0.8]},
          {\"time\": 4.5, \"translation\": [0.1, 0, 7], \"scale\": 2}]}",
    );
    let run = scratch.run("motion --motion keys.json --poses 11 -o poses.csv");
    assert_eq!(run.code, Some(0), "{}", run.err);
    scratch.write("back.json", "{\"poses\": \"poses.csv\"}");
    let path = |name: &str| scratch.path().join(name);
    let motion = io::read_motion(&path("keys.json")).expect("a motion");
    let back = io::read_motion(&path("back.json")).expect("a motion");
    assert_eq!(back.joint_times().len(), 11);
    assert_eq!((back.joint_times()[0], back.joint_times()[10]), (2.0, 4.5));
    for &time in back.joint_times() {
        assert_eq!(
            back.pose_at_time(time),
            motion.pose_at_time(time),
            "at {time}"
        );
    }
    let run = scratch.run("motion --turn 90 --through 1,2 --poses 3 -o plane.csv");
    assert_eq!(run.code, Some(0), "{}", run.err);
    scratch.write("plane.json", "{\"poses\": \"plane.csv\"}");
    let back = io::read_planar_motion(&path("plane.json")).expect("a motion");
    let end = back.pose_at_time(1.0).transform_point2(DVec2::ZERO);
    // (0, 0) about (1, 2) by a quarter turn.
    assert!(end.distance(DVec2::new(3.0, 1.0)) < 1e-15, "{end}");
    let run = scratch.run("motion --motion plane.json");
    assert!(
        run.out.starts_with("span 1: rotation in the plane"),
        "{}",
        run.out
    );

    scratch.write("cube.obj", CUBE);
    for (arguments, expected) in [
        ("motion --motion keys.json --poses 11", "--output"),
        ("motion --motion keys.json -o out.csv", "--poses"),
        (
            "motion --motion keys.json --poses 1 -o out.csv",
            "1 is not in 2..",
        ),
        (
            "motion --motion keys.json --poses 5 -o out.txt",
            "unknown extension .txt, expected one of .csv",
        ),
        (
            "motion --motion none.json --poses 5 -o out.csv",
            "there is no such file",
        ),
    ] {
        let run = scratch.run(arguments);
        assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{}", run.err);
        assert!(run.err.contains(expected), "{}", run.err);
        assert!(!scratch.files().contains(&"out.csv".to_owned()), "no file");
    }
}
