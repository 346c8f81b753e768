//! Poses that are half a turn apart: two senses lead from one to the other, and neither is taken
//! unless the user asks for it.

use crate::support::command;
use crate::support::command::{Run, Scratch};
use crate::support::random::Random;
use glam::{DAffine2, DAffine3, DMat2, DMat3, DQuat, DVec2, DVec3};
use serde_json::Value;
use std::f64::consts::PI;
use steadysweep::motion::{
    HalfTurns, Keyframe, Motion, MotionError, Sense, logarithm, logarithm_turning, planar,
};

fn box_of(low: [f64; 3], high: [f64; 3]) -> String {
    let corner = |i: usize| {
        let [x, y, z] = [0, 1, 2].map(|axis| {
            if i >> axis & 1 == 0 {
                low[axis]
            } else {
                high[axis]
            }
        });
        format!("v {x} {y} {z}\n")
    };
    let corners: String = (0..8).map(corner).collect();
    corners + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"
}

/// An arm at x = 5, and posts at y = 5 and y = -5 that it meets in one sense only.
fn scene(name: &str) -> Scratch {
    let scratch = Scratch::new(name);
    scratch.write("arm.obj", box_of([4.0, -0.5, -0.5], [6.0, 0.5, 0.5]));
    scratch.write("up.obj", box_of([-0.5, 4.5, -2.0], [0.5, 5.5, 2.0]));
    scratch.write("down.obj", box_of([-0.5, -5.5, -2.0], [0.5, -4.5, 2.0]));
    scratch.write("points.csv", "0,5,0\n0,-5,0\n");
    scratch.write("half.json", keys(&["0,0,0,1", "0,0,1,0"]));
    scratch
}

/// Keyframes with these quaternions.
fn keys(quaternions: &[&str]) -> String {
    let keys: Vec<String> = quaternions
        .iter()
        .map(|quaternion| format!("{{\"rotation\": [{quaternion}]}}"))
        .collect();
    format!("{{\"keyframes\": [{}]}}", keys.join(", "))
}

fn json(run: &Run) -> Value {
    serde_json::from_str(&run.out).unwrap_or_else(|_| panic!("no JSON: {} {}", run.out, run.err))
}

fn refused(run: &Run, parts: &[&str]) {
    assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{}", run.err);
    for part in parts {
        assert!(run.err.contains(part), "{part:?} is missing: {}", run.err);
    }
}

#[test]
fn check_sweep_and_probe_refuse_a_half_turn_by_name() {
    let scratch = scene("half_turn_refused");
    scratch.write("cube.obj", command::CUBE);
    for command in [
        "check arm.obj --motion half.json --against up.obj",
        "check arm.obj --motion half.json --against up.obj --json",
        "sweep arm.obj --motion half.json -o swept.obj",
        "sweep cube.obj --motion half.json",
        "probe arm.obj --motion half.json --points points.csv",
        "check arm.obj --translate 1,0,0 --against up.obj --against-motion half.json",
    ] {
        refused(
            &scratch.run(command),
            &[
                "half.json: between keyframes 0 and 1",
                "half a turn apart about the axis (0, 0, 1) (+: by the right-hand rule)",
                "both senses lead there",
                "insert a keyframe between, give the motion as a span, or choose: --half-turn + or -",
            ],
        );
    }
    assert!(
        !scratch.files().contains(&"swept.obj".to_owned()),
        "no file"
    );
}

#[test]
fn the_chosen_sense_is_the_turn_that_the_span_of_that_sign_makes() {
    let scratch = scene("half_turn_chosen");
    for (sense, other, post) in [("+", "-", "up"), ("-", "+", "down")] {
        let check = |sense: &str| {
            let run = scratch.run(&format!(
                "check arm.obj --motion half.json --half-turn {sense} --against {post}.obj --json"
            ));
            (json(&run), run.code)
        };
        let (report, code) = check(sense);
        assert_eq!(code, Some(1), "{report}");
        let turn = scratch.run(&format!(
            "check arm.obj --turn {sense}180 --axis 0,0,1 --against {post}.obj --json"
        ));
        let span = json(&turn);
        let time = |report: &Value| report["time"].as_f64().expect("a time");
        assert!((time(&report) - time(&span)).abs() < 1e-12, "{report}");
        assert_eq!(
            report["motion"]["half_turns"],
            serde_json::json!([{"span": 0, "sense": sense, "axis": [0.0, 0.0, 1.0]}])
        );
        assert_eq!(span["motion"]["half_turns"], serde_json::json!([]));
        let (report, code) = check(other);
        assert_eq!((code, &report["verdict"]), (Some(0), &"clear".into()));

        let run = scratch.run(&format!(
            "probe arm.obj --motion half.json --half-turn {sense} --points points.csv --json"
        ));
        let report = json(&run);
        for (point, inside) in [sense == "+", sense == "-"].into_iter().enumerate() {
            assert_eq!(report["points"][point]["inside"], inside, "{report}");
        }
        assert_eq!(report["motion"]["half_turns"][0]["sense"], sense);

        let run = scratch.run(&format!(
            "sweep arm.obj --motion half.json --half-turn {sense} --tolerance 0.1 --json"
        ));
        let report = json(&run);
        assert_eq!(report["motion"]["half_turns"][0]["sense"], sense);
        let low = report["sweep"]["bounds"][0][1].as_f64().expect("a number");
        assert_eq!(low < -5.0, sense == "-", "{report}");
        let text = scratch
            .run(&format!(
                "sweep arm.obj --motion half.json --half-turn {sense} --tolerance 0.1"
            ))
            .out;
        let line = format!("span 1 is a half turn about (0, 0, 1) in the sense {sense}");
        assert!(text.contains(&line), "{text}");
    }
}

#[test]
fn what_is_within_a_billionth_of_a_half_turn_is_one() {
    let scratch = scene("half_turn_nearly");
    // The angle misses pi by twice the last number.
    for w in ["6e-17", "-6e-17", "4e-10", "-4e-10"] {
        scratch.write("near.json", keys(&["0,0,0,1", &format!("0,0,1,{w}")]));
        let check = |options: &str| {
            scratch.run(&format!(
                "check arm.obj --motion near.json --against {options}"
            ))
        };
        refused(
            &check("up.obj"),
            &["half a turn apart about the axis (0, 0, 1)"],
        );
        for (options, code) in [
            ("up.obj --half-turn +", 1),
            ("down.obj --half-turn +", 0),
            ("up.obj --half-turn -", 0),
            ("down.obj --half-turn -", 1),
        ] {
            assert_eq!(check(options).code, Some(code), "{w}: {options}");
        }
        let run = scratch.run("motion --motion near.json --json");
        assert_eq!(json(&run)["spans"][0]["unique"], false, "{w}");
    }
    for (w, post) in [("6e-10", "up"), ("-6e-10", "down")] {
        scratch.write("far.json", keys(&["0,0,0,1", &format!("0,0,1,{w}")]));
        let run = scratch.run(&format!(
            "check arm.obj --motion far.json --against {post}.obj"
        ));
        assert_eq!(run.code, Some(1), "{w}: {}", run.err);
    }
}

#[test]
fn motion_shows_either_sense_and_never_refuses() {
    let scratch = scene("half_turn_shown");
    for (option, sense, axis) in [
        ("", "+", 1.0),
        (" --half-turn +", "+", 1.0),
        (" --half-turn -", "-", -1.0),
    ] {
        let run = scratch.run(&format!("motion --motion half.json --json{option}"));
        assert_eq!(run.code, Some(0), "{}", run.err);
        let span = &json(&run)["spans"][0];
        assert_eq!(span["unique"], false, "{span}");
        assert_eq!(span["half_turn"], sense, "{span}");
        assert_eq!(span["axis"], serde_json::json!([0.0, 0.0, axis]), "{span}");
        let text = scratch
            .run(&format!("motion --motion half.json{option}"))
            .out;
        assert!(
            text.contains(&format!("a half turn in the sense {sense}")),
            "{text}"
        );
    }
}

#[test]
fn senses_that_do_not_fit_the_half_turns_are_refused_with_the_count() {
    let scratch = scene("half_turn_counts");
    // Half turns about x, y and z and back: four spans, the third one a third of a turn.
    let turns = keys(&[
        "0,0,0,1",
        "1,0,0,0",
        "0,0,1,0",
        "0.5,0.5,0.5,0.5",
        "0.5,0.5,-0.5,-0.5",
    ]);
    scratch.write("path.json", turns);
    let run = |option: &str| {
        scratch.run(&format!(
            "check arm.obj --motion path.json --against up.obj --json{option}"
        ))
    };
    refused(
        &run(""),
        &[
            "between keyframes 0 and 1",
            "one for each of the 3 half turns",
        ],
    );
    for option in [" --half-turn +,-", " --half-turn +,-,+,+"] {
        let given = if option.len() == 16 { 2 } else { 4 };
        refused(
            &run(option),
            &[&format!(
                "--half-turn has {given} senses for 3 half turns; give one for each, or one for all"
            )],
        );
    }
    for (option, senses) in [
        (" --half-turn -", ["-", "-", "-"]),
        (" --half-turn +,-,+", ["+", "-", "+"]),
        (" --half-turn -,-,+", ["-", "-", "+"]),
    ] {
        let report = json(&run(option));
        let half_turns = report["motion"]["half_turns"]
            .as_array()
            .expect("a list")
            .clone();
        let found: Vec<_> = half_turns
            .iter()
            .map(|half_turn| (&half_turn["span"], &half_turn["sense"]))
            .collect();
        let [a, b, c] = senses.map(Value::from);
        assert_eq!(
            found,
            [(&0.into(), &a), (&1.into(), &b), (&3.into(), &c)],
            "{report}"
        );
    }
    // First those of the body's motion, then those of the obstacles, each file once.
    let with = |option: &str| {
        scratch.run(&format!(
            "check arm.obj --motion half.json --against up.obj down.obj --against-motion path.json --json{option}"
        ))
    };
    refused(
        &with(" --half-turn +,-,-"),
        &["has 3 senses for 4 half turns"],
    );
    let report = json(&with(" --half-turn -,+,-,+"));
    assert_eq!(report["motion"]["half_turns"][0]["sense"], "-");
    for obstacle in [0, 1] {
        let half_turns = &report["obstacles"][obstacle]["half_turns"];
        let senses: Vec<&Value> = (0..3).map(|i| &half_turns[i]["sense"]).collect();
        assert_eq!(senses, ["+", "-", "+"], "{report}");
    }
    // An option without effect is refused.
    for motion in ["--turn 180 --axis 0,0,1", "--motion straight.json"] {
        scratch.write("straight.json", keys(&["0,0,0,1", "0,0,0.6,0.8"]));
        let command = format!("check arm.obj {motion} --half-turn + --against up.obj");
        refused(
            &scratch.run(&command),
            &["has no half turn between keyframes"],
        );
        let command = format!("motion {motion} --half-turn +,-");
        refused(
            &scratch.run(&command),
            &["has no half turn between keyframes"],
        );
    }
    refused(
        &scratch.run("motion --motion half.json --half-turn x"),
        &["expected + or -"],
    );
}

#[test]
fn the_plane_has_the_same_rule() {
    let scratch = Scratch::new("half_turn_plane");
    scratch.write(
        "bar.svg",
        r#"<svg xmlns="http://www.w3.org/2000/svg"><path d="M4 -.5H6V.5H4Z"/></svg>"#,
    );
    scratch.write("points.csv", "0,5\n0,-5\n");
    for (name, pose) in [
        ("degrees", "\"rotation_deg\": 180"),
        ("negative", "\"rotation_deg\": -180"),
        ("odd", "\"rotation_deg\": 540"),
        ("rounded", "\"rotation_deg\": 180.00000004"),
        ("matrix", "\"matrix\": [[-1,0,0],[0,-1,0]]"),
        ("scaled", "\"rotation_deg\": 180, \"scale\": 1.25"),
    ] {
        let file = format!("{name}.json");
        scratch.write(
            &file,
            format!("{{\"keyframes\": [{{\"matrix\": [[1,0,0],[0,1,0]]}}, {{{pose}}}]}}"),
        );
        let probe = |option: &str| {
            scratch.run(&format!(
                "probe bar.svg --motion {file} --points points.csv --json{option}"
            ))
        };
        let named = [
            "between keyframes 0 and 1",
            "half a turn apart (+: from x towards y)",
            "--half-turn + or -",
        ];
        refused(&probe(""), &named);
        refused(
            &scratch.run(&format!("sweep bar.svg --motion {file}")),
            &named,
        );
        for (sense, inside) in [("+", [true, false]), ("-", [false, true])] {
            let report = json(&probe(&format!(" --half-turn {sense}")));
            for point in [0, 1] {
                assert_eq!(
                    report["points"][point]["inside"], inside[point],
                    "{name} {sense}"
                );
            }
            assert_eq!(report["motion"]["half_turns"][0]["axis"], Value::Null);
            let run = scratch.run(&format!(
                "sweep bar.svg --motion {file} --half-turn {sense}"
            ));
            assert!(
                run.out.contains(&format!("half turn in the sense {sense}")),
                "{}",
                run.out
            );
        }
        let run = scratch.run(&format!("motion --motion {file} --json"));
        assert_eq!(json(&run)["spans"][0]["half_turn"], "+", "{name}");
    }
}

// ---- the library
// -------------------------------------------------------------------------------------------------

fn key(time: f64, pose: DAffine3) -> Keyframe {
    Keyframe { time, pose }
}

fn size(matrix: &DMat3) -> f64 {
    matrix
        .to_cols_array()
        .iter()
        .fold(0.0, |m, x| m.max(x.abs()))
}

#[test]
fn keyframes_half_a_turn_apart_make_no_motion_until_the_sense_is_chosen() {
    let mut random = Random::from_state(1);
    for trial in 0..300 {
        let axis = random.point(1.0).normalize();
        let missing = if trial % 2 == 0 {
            0.0
        } else {
            0.9e-9 * random.signed()
        };
        let start = DAffine3::from_rotation_translation(
            DQuat::from_axis_angle(random.point(1.0).normalize(), 3.0 * random.signed()),
            random.point(1.0),
        );
        let turn = DQuat::from_axis_angle(axis, PI - missing);
        let scale = (2.0 * random.signed()).exp();
        let step =
            DAffine3::from_scale_rotation_translation(DVec3::splat(scale), turn, random.point(1.0));
        let keys = [key(0.0, start), key(2.0, step * start)];
        let error = Motion::from_keyframes(&keys).expect_err("must be refused");
        let MotionError::BetweenKeyframes { first: 0, cause } = &error else {
            panic!("{error:?}");
        };
        let MotionError::HalfTurn {
            axis: Some(named),
            count: 1,
        } = **cause
        else {
            panic!("{error:?}");
        };
        let positive = if axis.x < 0.0 { -axis } else { axis };
        assert!((named - positive).length() < 1e-8, "{named} for {positive}");

        let mut middles = Vec::new();
        for (sense, sign) in [(Sense::Positive, 1.0), (Sense::Negative, -1.0)] {
            let motion =
                Motion::from_keyframes_turning(&keys, &HalfTurns::All(sense)).expect("chosen");
            let span = &motion.spans()[0];
            assert!(!span.unique(), "the other sense is there, too");
            assert_eq!(
                span.half_turn().map(|half_turn| half_turn.sense),
                Some(sense)
            );
            // The end is reached exactly, not half a turn away.
            let end = span.flow().pose_at(1.0);
            assert!(
                size(&(end.matrix3 - step.matrix3)) < 4e-15 * scale.max(1.0),
                "trial {trial}"
            );
            assert!(
                (end.translation - step.translation).length() < 1e-13 * scale.max(1.0),
                "trial {trial}"
            );
            // Halfway it is a quarter turn in that sense, without shear.
            let middle = span.flow().pose_at(0.5).matrix3 * (1.0 / scale.sqrt());
            let quarter = DMat3::from_axis_angle(positive * sign, PI / 2.0);
            assert!(
                size(&(middle - quarter)) < 2e-8,
                "trial {trial}: {middle} for {quarter}"
            );
            let rigid = size(&(middle.transpose() * middle - DMat3::IDENTITY));
            assert!(rigid < 1e-14, "trial {trial}: sheared by {rigid:e}");
            middles.push(motion);
        }
        let turned = middles
            .pop()
            .expect("two")
            .turning(&HalfTurns::All(Sense::Positive))
            .expect("chosen");
        assert_eq!(
            turned.spans()[0].flow().generator(),
            middles[0].spans()[0].flow().generator(),
            "chosen anew, to the same bits"
        );
        let error = turned
            .turning(&HalfTurns::Each(vec![Sense::Positive; 2]))
            .expect_err("one too many");
        assert_eq!(
            error,
            MotionError::HalfTurnSenses {
                given: 2,
                spans: vec![0]
            }
        );
    }
}

/// L = P diag(-s, -s, lambda) P^-1: a double negative eigenvalue, in any frame and with shear.
#[test]
fn no_affinity_with_a_double_negative_eigenvalue_is_taken_for_unique() {
    let mut random = Random::from_state(2);
    let mut found = [0, 0];
    for trial in 0..2000 {
        let frame = DMat3::from_cols(random.point(1.0), random.point(1.0), random.point(1.0));
        let inverse = frame.inverse();
        if size(&frame) * size(&inverse) > 30.0 {
            continue;
        }
        let (s, lambda) = ((2.0 * random.signed()).exp(), (2.0 * random.signed()).exp());
        let matrix3 = frame * DMat3::from_diagonal(DVec3::new(-s, -s, lambda)) * inverse;
        let a = DAffine3 {
            matrix3,
            translation: random.point(1.0),
        };
        for sense in [Sense::Positive, Sense::Negative] {
            match logarithm_turning(&a, sense) {
                Ok(log) => {
                    let half_turn = log.half_turn.unwrap_or_else(|| panic!("trial {trial}"));
                    assert_eq!(half_turn.sense, sense, "trial {trial}");
                    let error = size(&(log.flow.pose_at(1.0).matrix3 - matrix3)) / size(&matrix3);
                    assert!(error < 1e-10, "trial {trial}: {error:e}");
                    found[0] += 1;
                }
                // Rounding has split it into two eigenvalues.
                Err(MotionError::NoRealLogarithm { .. }) => found[1] += 1,
                Err(error) => panic!("trial {trial}: {error}"),
            }
        }
    }
    assert!(
        found[0] > 20 * found[1],
        "rounding seldom matters: {found:?}"
    );
}

#[test]
fn a_block_that_is_exactly_double_turns_both_ways() {
    for (lambda, shear) in [(0.5, [1.0, 3.0]), (2.0, [0.0, 0.0]), (7.0, [-4.0, 1.0])] {
        let matrix3 = DMat3::from_cols(
            DVec3::new(-2.0, 0.0, 0.0),
            DVec3::new(0.0, -2.0, 0.0),
            DVec3::new(shear[0], shear[1], lambda),
        );
        let a = DAffine3 {
            matrix3,
            translation: DVec3::new(1.0, 2.0, 3.0),
        };
        let opposite = [Sense::Positive, Sense::Negative].map(|sense| {
            let log = logarithm_turning(&a, sense).expect("a logarithm");
            let end = log.flow.pose_at(1.0);
            assert!(size(&(end.matrix3 - matrix3)) < 1e-14, "{sense:?}: {end}");
            assert!(
                (end.translation - a.translation).length() < 1e-14,
                "{sense:?}: {end}"
            );
            log
        });
        let trace =
            |generator: &DMat3| generator.x_axis.x + generator.y_axis.y + generator.z_axis.z;
        let [plus, minus] = opposite.each_ref().map(|log| log.flow.generator().linear);
        assert!(
            (trace(&plus) - trace(&minus)).abs() < 1e-14,
            "both grow alike"
        );
        assert!(size(&(plus - minus)) > 3.0, "and turn differently");
        assert_eq!(
            logarithm(&a).expect("a logarithm").half_turn,
            opposite[0].half_turn,
            "+ unless asked"
        );
    }
}

/// The pose between keys is computed: the rounding of the keys that remains in it decides nothing
/// either.
#[test]
fn keys_of_bad_condition_do_not_decide_by_their_rounding() {
    let mut random = Random::from_state(3);
    let mut refused = 0;
    for trial in 0..500 {
        let condition = 10.0_f64.powf(3.0 + 3.0 * random.signed());
        let squeeze = DMat3::from_diagonal(DVec3::new(1.0, 1.0 / condition, 1.0));
        let turn = |random: &mut Random| {
            DMat3::from_axis_angle(random.point(1.0).normalize(), 3.0 * random.signed())
        };
        let start = turn(&mut random) * squeeze * turn(&mut random);
        let half = DMat3::from_axis_angle(random.point(1.0).normalize(), PI);
        let keys = [start, half * start].map(DAffine3::from_mat3);
        match Motion::from_keyframes(&[key(0.0, keys[0]), key(1.0, keys[1])]) {
            Ok(_) => panic!("trial {trial}: decided at a condition of {condition:e}"),
            Err(MotionError::BetweenKeyframes { cause, .. }) => {
                refused += usize::from(matches!(*cause, MotionError::HalfTurn { .. }));
            }
            Err(error) => panic!("trial {trial}: {error}"),
        }
    }
    assert!(
        refused > 100,
        "{refused} as half turns, the others without a real logarithm"
    );
}

#[test]
fn planar_keyframes_half_a_turn_apart_are_refused_until_the_sense_is_chosen() {
    let mut random = Random::from_state(4);
    for trial in 0..300 {
        let missing = if trial % 2 == 0 {
            0.0
        } else {
            0.9e-9 * random.signed()
        };
        let start = DAffine2::from_angle_translation(
            3.0 * random.signed(),
            DVec2::new(random.signed(), random.signed()),
        );
        let scale = (2.0 * random.signed()).exp();
        let step = DAffine2 {
            matrix2: DMat2::from_angle(PI - missing) * scale,
            translation: DVec2::new(random.signed(), random.signed()),
        };
        let keys =
            [(0.0, start), (1.0, step * start)].map(|(time, pose)| planar::Keyframe { time, pose });
        let error = planar::Motion::from_keyframes(&keys).expect_err("must be refused");
        assert!(
            error
                .to_string()
                .contains("half a turn apart (+: from x towards y)"),
            "{error}"
        );
        for (sense, angle) in [
            (Sense::Positive, PI - missing),
            (Sense::Negative, -PI - missing),
        ] {
            let motion =
                planar::Motion::from_keyframes_turning(&keys, &HalfTurns::Each(vec![sense]))
                    .expect("chosen");
            let span = &motion.spans()[0];
            assert_eq!(span.half_turn(), Some(sense));
            let linear = span.flow().generator().linear;
            assert!((linear.x_axis.y - angle).abs() < 2e-15, "trial {trial}");
            assert_eq!(
                linear.x_axis.y, -linear.y_axis.x,
                "trial {trial}: along a circle"
            );
            let end = span.flow().pose_at(1.0);
            let error = (end.matrix2 - step.matrix2)
                .to_cols_array()
                .iter()
                .fold(0.0, |m: f64, x| m.max(x.abs()));
            assert!(error < 4e-15 * scale.max(1.0), "trial {trial}: {error:e}");
        }
    }
}
