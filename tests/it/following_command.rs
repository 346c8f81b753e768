//! Motions by other schemes than the steady one, from the command line.

use crate::support::command::{Run, Scratch};
use serde_json::Value;

fn json(run: &Run) -> Value {
    serde_json::from_str(&run.out).unwrap_or_else(|_| panic!("no JSON: {} {}", run.out, run.err))
}

/// A block of 2 x 1 x 1 that turns by a quarter while its corner goes straight to x = 8; a wall at
/// x = 6, and one beyond the end.
fn scene(name: &str) -> Scratch {
    let scratch = Scratch::new(name);
    let corner = |i: usize| format!("v {} {} {}\n", 2 * (i & 1), i >> 1 & 1, i >> 2);
    let corners: String = (0..8).map(corner).collect();
    let faces = "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    scratch.write("block.obj", corners + faces);
    for (name, x) in [("wall.obj", 6.0), ("far.obj", 11.0)] {
        let corners = format!("v {x} -9 -9\nv {x} 19 -9\nv {x} -9 19\nf 1 2 3\n");
        scratch.write(name, corners);
    }
    scratch.write("points.csv", "1,0.5,0.5\n8,20,0.5\n");
    let half = 0.5_f64.sqrt();
    let keys = format!(
        "\"keyframes\": [{{}}, {{\"translation\": [8,0,0], \"rotation\": [0,0,{half},{half}]}}]"
    );
    for (name, fields) in [
        ("polar.json", "\"interpolation\": \"polar\", "),
        (
            "fine.json",
            "\"interpolation\": \"polar\", \"deviation\": 1e-4, ",
        ),
        ("steady.json", ""),
        ("wrong.json", "\"interpolation\": \"slerp\", "),
        (
            "zero.json",
            "\"interpolation\": \"linear\", \"deviation\": 0, ",
        ),
    ] {
        scratch.write(name, format!("{{{fields}{keys}}}"));
    }
    scratch
}

/// The corner (2, 0, 0) is at x = 8 t + 2 cos(t pi/2) by SLERP and LERP: it meets the wall at x = 6
/// when 8 t + 2 cos(t pi/2) = 6, t = .6045.
#[test]
fn all_commands_follow_a_motion() {
    let scratch = scene("following");
    let run = scratch.run("check block.obj --motion polar.json --against wall.obj --json");
    let found = json(&run);
    assert_eq!(
        (run.code, &found["verdict"]),
        (Some(1), &"contact".into()),
        "{found}"
    );
    let root = {
        let reach = |t: f64| 8.0 * t + 2.0 * (t * std::f64::consts::FRAC_PI_2).cos();
        let mut sides = [0.0, 1.0];
        for _ in 0..60 {
            let middle = 0.5 * (sides[0] + sides[1]);
            sides[usize::from(reach(middle) > 6.0)] = middle;
        }
        sides[0]
    };
    let bracket =
        [&found["bracket"][0], &found["bracket"][1]].map(|time| time.as_f64().expect("a time"));
    assert!(
        bracket[0] <= root && root <= bracket[1],
        "{root} in {bracket:?}"
    );
    // A deviation of 1.2e-3 on either side, at a speed of 8 - pi sin(..) > 5; behind the corner, the
    // wall is as deep in the block as the deviation only after the corner has passed by more.
    assert!(bracket[1] - bracket[0] < 4.0 * 1.3e-3 / 5.0, "{bracket:?}");
    let deviation = &found["motion"]["deviation"];
    assert_eq!(deviation["proven"], true, "{found}");
    let size = 6.0_f64.sqrt();
    let [length, asked] =
        ["length", "asked"].map(|name| deviation[name].as_f64().expect("a length"));
    assert!(
        (asked - 0.5e-3 * size).abs() < 1e-12 && length <= asked,
        "{deviation}"
    );
    assert!(found["motion"]["spans"].as_u64() > Some(5), "{found}");

    let run = scratch.run("check block.obj --motion polar.json --against far.obj");
    assert_eq!(run.code, Some(0), "{} {}", run.out, run.err);
    assert!(
        run.out.contains("stands for the given one within"),
        "{}",
        run.out
    );

    let run = scratch.run("probe block.obj --motion polar.json --points points.csv --json");
    let found = json(&run);
    assert_eq!(found["points"][0]["inside"], true, "{found}");
    assert_eq!(found["points"][1]["inside"], false, "{found}");

    let spans = |motion: &str| {
        let run = scratch.run(&format!(
            "sweep block.obj --motion {motion} --tolerance 0.02 --json"
        ));
        assert_eq!(run.code, Some(0), "{}", run.err);
        let found = json(&run);
        let bound = |side: &str| {
            found["sweep"]["error_bound"][side]
                .as_f64()
                .expect("a bound")
        };
        let deviation = found["motion"]["deviation"]["length"]
            .as_f64()
            .unwrap_or(0.0);
        assert!(
            bound("inside") >= deviation && bound("outside") >= deviation,
            "{found}"
        );
        assert_eq!(
            found["sweep"]["error_bound"]["inside_proven"], true,
            "{found}"
        );
        found["motion"]["spans"].as_u64().expect("a number")
    };
    let [steady, coarse, fine] = ["steady.json", "polar.json", "fine.json"].map(spans);
    assert!(
        steady == 1 && coarse > 2 && fine > 5 * coarse,
        "{steady}, {coarse}, {fine}"
    );
}

#[test]
fn what_a_motion_file_says_of_schemes_is_checked() {
    let scratch = scene("following_refused");
    for (arguments, parts) in [
        (
            "probe block.obj --motion wrong.json --points points.csv",
            vec![
                "wrong.json",
                "\"interpolation\": expected one of \"steady\", \"linear\"",
                "found \"slerp\"",
            ],
        ),
        (
            "probe block.obj --motion zero.json --points points.csv",
            vec!["zero.json", "the deviation is 0, expected at least"],
        ),
        (
            "motion --motion polar.json",
            vec!["polar.json", "over a body", "--body FILE"],
        ),
    ] {
        let run = scratch.run(arguments);
        assert_eq!(
            (run.code, run.out.as_str()),
            (Some(2), ""),
            "{arguments}: {}",
            run.err
        );
        for part in parts {
            assert!(run.err.contains(part), "{part:?} is missing: {}", run.err);
        }
    }
}

/// With a body, `motion` tells what a motion is followed by.
#[test]
fn a_followed_motion_is_described_over_a_body() {
    let scratch = scene("following_described");
    let run = scratch.run("motion --motion polar.json --body block.obj --json");
    assert_eq!(run.code, Some(0), "{}", run.err);
    let found = json(&run);
    assert_eq!(found["interpolation"], "polar", "{found}");
    assert_eq!(found["deviation"]["proven"], true, "{found}");
    let spans = found["spans"].as_array().expect("a list").len();
    assert!(spans > 5, "{spans}");
    // A turn by a quarter while the origin goes straight by 8: theta |d|, for every point.
    let ara = found["ara"]["value"].as_f64().expect("a number");
    let expected = 4.0 * std::f64::consts::PI;
    assert!(
        (ara - expected).abs() < 1e-5 * expected,
        "{ara}, not {expected}"
    );
    assert_eq!(
        found["ara"]["jumps"].as_array().map(Vec::len),
        Some(0),
        "{found}"
    );
    let run = scratch.run("motion --motion polar.json --body block.obj");
    let text =
        "interpolation polar, followed by steady spans\n        stands for the given one within ";
    assert!(run.out.starts_with(text), "{}", run.out);
    let run = scratch.run("motion --motion steady.json --body block.obj --json");
    let found = json(&run);
    assert_eq!(found["interpolation"], "steady", "{found}");
    assert!(found.get("deviation").is_none(), "{found}");
    let ara = found["ara"]["value"].as_f64().expect("a number");
    assert!(ara < 1e-9, "a steady motion: {ara}");
    let run = scratch.run("motion --motion polar.json --body no.obj");
    assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{}", run.err);
}
