//! `steadysweep check` as scripts and readers see it: exit codes, the keys of its JSON, its text,
//! its refusals, its table.

use crate::support::command;
use crate::support::command::{CUBE, Run, Scratch};
use serde_json::{Value, json};
use std::fmt::Write;
#[cfg(unix)]
use std::process::Stdio;
#[cfg(unix)]
use std::time::Duration;

/// Largest error of a time: the bracket of a contact is no wider.
const TIME: f64 = 1e-9;

/// An open wall in the plane x = `x`, larger than the cube.
fn wall(x: f64) -> String {
    format!("v {x} -1 -1\nv {x} 2 -1\nv {x} 2 2\nv {x} -1 2\nf 1 2 3 4\n")
}

/// A box as OBJ.
fn a_box(low: [f64; 3], high: [f64; 3]) -> String {
    let mut text = String::new();
    for line in CUBE.lines() {
        match line.strip_prefix("v ") {
            Some(corner) => {
                let place = corner
                    .split(' ')
                    .zip(low.iter().zip(high))
                    .map(|(digit, (low, high))| if digit == "0" { *low } else { high });
                let place: Vec<String> = place.map(|x| x.to_string()).collect();
                writeln!(text, "v {}", place.join(" ")).expect("a string takes everything");
            }
            None => writeln!(text, "{line}").expect("a string takes everything"),
        }
    }
    text
}

/// A directory with a unit cube and walls at x = 3 and x = 5.
fn scene(name: &str) -> Scratch {
    let scratch = Scratch::new(name);
    scratch.write("cube.obj", CUBE);
    scratch.write("near.obj", wall(3.0));
    scratch.write("far.obj", wall(5.0));
    scratch
}

/// Runs a check of the cube with `--json`: the object, and the exit code.
fn checked(scratch: &Scratch, arguments: &str) -> (Value, Option<i32>) {
    let Run { code, out, err } = scratch.run(&format!("check cube.obj {arguments} --json"));
    assert_eq!(err, "", "{arguments}: nothing on stderr");
    assert_eq!(out.lines().count(), 1, "one object on one line: {out}");
    let report = serde_json::from_str(&out).unwrap_or_else(|error| panic!("{error}: {out}"));
    (report, code)
}

fn number(report: &Value, path: &str) -> f64 {
    report
        .pointer(path)
        .and_then(Value::as_f64)
        .unwrap_or_else(|| panic!("no number at {path:?}: {report}"))
}

fn assert_near(report: &Value, path: &str, expected: f64, error: f64) {
    let found = number(report, path);
    assert!(
        (found - expected).abs() <= error,
        "{path}: {found}, expected {expected} within {error:e}: {report}"
    );
}

/// The report has the keys of the contract, and values of the right types where they apply to the
/// verdict.
fn assert_contract(report: &Value) {
    let mut keys: Vec<&str> = report
        .as_object()
        .expect("an object")
        .keys()
        .map(String::as_str)
        .collect();
    keys.sort_unstable();
    assert_eq!(
        keys,
        [
            "body",
            "bracket",
            "clearance",
            "depth",
            "features",
            "interval_ends",
            "intervals",
            "motion",
            "normal",
            "obstacle",
            "obstacle_pose",
            "obstacles",
            "point",
            "pose",
            "progress",
            "seconds",
            "span",
            "time",
            "touch",
            "verdict"
        ],
        "the keys of the contract"
    );
    let verdict = report["verdict"].as_str().expect("a word");
    let is_met = matches!(verdict, "contact" | "closer");
    for key in [
        "time", "features", "touch", "point", "normal", "pose", "progress",
    ] {
        assert_eq!(
            report[key].is_null(),
            !is_met,
            "{key} of {verdict}: {report}"
        );
    }
    for key in ["bracket", "span", "obstacle"] {
        assert_eq!(
            report[key].is_null(),
            verdict == "clear",
            "{key} of {verdict}: {report}"
        );
    }
    if is_met {
        let [start, end] = [0, 1].map(|i| number(report, &format!("/bracket/{i}")));
        let time = number(report, "/time");
        assert!(
            start <= time && time <= end,
            "the time is in the bracket: {report}"
        );
        assert!(end - start <= TIME, "a narrow bracket: {report}");
        let squares = [0, 1, 2].map(|i| number(report, &format!("/normal/{i}")).powi(2));
        let length: f64 = squares.iter().sum();
        assert!((length - 1.0).abs() < 1e-12, "a unit normal: {report}");
        for side in ["body", "obstacle"] {
            let feature = report["features"][side].as_object().expect("an object");
            let (kind, value) = feature.iter().next().expect("one key");
            assert!(
                match kind.as_str() {
                    "vertex" | "face" => value.is_u64(),
                    "edge" => value.as_array().is_some_and(|ends| ends.len() == 2),
                    _ => false,
                } && feature.len() == 1,
                "{side}: {report}"
            );
        }
        assert!(
            report["obstacle"]["file"].is_string() && report["obstacle"]["index"].is_u64(),
            "name and number: {report}"
        );
        assert!(
            ["touch", "slide", "enter", "inside"]
                .contains(&report["touch"].as_str().expect("a word")),
            "{report}"
        );
    }
    for key in ["lower", "upper", "time"] {
        assert!(
            report["clearance"][key].is_number(),
            "clearance {key}: {report}"
        );
    }
    assert!(
        number(report, "/clearance/lower") <= number(report, "/clearance/upper"),
        "{report}"
    );
    assert!(number(report, "/seconds/total") > 0.0, "{report}");
    for place in [report, &report["clearance"]] {
        if !place["pose"].is_null() {
            assert_place(place);
        }
    }
    for listed in report["obstacles"]
        .as_array()
        .expect("a list")
        .iter()
        .chain([report])
    {
        assert_eq!(
            listed["interval_ends"].is_null(),
            listed["intervals"].is_null(),
            "{listed}"
        );
        let lists = ["interval_ends", "intervals"].map(|key| listed[key].as_array());
        let [Some(ends), Some(intervals)] = lists else {
            continue;
        };
        assert_eq!(ends.len(), intervals.len(), "parallel lists: {listed}");
        for (end, time) in ends
            .iter()
            .zip(intervals)
            .flat_map(|(ends, times)| [0, 1].map(|i| (&ends[i], &times[i])))
        {
            assert_eq!(&end["time"], time, "the time of the interval: {listed}");
            assert_place(end);
        }
    }
}

/// Checks a time, with the pose and the progress of the motion at that time.
fn assert_place(place: &Value) {
    assert!(place["time"].is_number(), "{place}");
    let rows = place["pose"].as_array().expect("rows");
    assert_eq!(rows.len(), 3, "3 x 4: {place}");
    for row in rows {
        let row = row.as_array().expect("a row");
        assert!(
            row.len() == 4 && row.iter().all(Value::is_number),
            "3 x 4: {place}"
        );
    }
    let progress = &place["progress"];
    assert!(progress["span"].is_u64(), "{place}");
    assert!(
        (0.0..=1.0).contains(&number(progress, "/fraction")),
        "{place}"
    );
    for key in ["turn_deg", "advance", "scale"] {
        let [part, whole] = [&progress[key], &progress["of"][key]];
        assert!(
            part.is_number() && whole.is_number() || part.is_null() && whole.is_null(),
            "{key}: {place}"
        );
    }
}

#[test]
fn a_clear_way_has_exit_code_0_and_a_proven_distance() {
    let scratch = scene("check_clear");
    let (report, code) = checked(&scratch, "--translate 3,0,0 --against far.obj");
    assert_eq!(code, Some(0), "{report}");
    assert_contract(&report);
    assert_eq!(report["verdict"], "clear");
    assert!(report["intervals"].is_null(), "not asked for: {report}");
    // The front of the cube ends at x = 4, the wall is at 5.
    assert_near(&report, "/clearance/upper", 1.0, 1e-9);
    assert_near(&report, "/clearance/time", 1.0, 1e-6);
    // The search ends when the bound is within a thousandth of what was seen.
    assert_near(&report, "/clearance/lower", 1.0, 1.01e-3);
    assert!(
        number(&report, "/clearance/lower") <= 1.0 + 1e-12,
        "a lower bound: {report}"
    );
    assert_eq!(
        report["clearance"]["obstacle"],
        json!({"file": "far.obj", "plane": null, "index": 0})
    );
}

#[test]
fn contact_has_exit_code_1_and_says_when_where_and_what() {
    let scratch = scene("check_contact");
    let (report, code) = checked(&scratch, "--translate 3,0,0 --against far.obj near.obj");
    assert_eq!(code, Some(1), "{report}");
    assert_contract(&report);
    assert_eq!(report["verdict"], "contact");
    // From x = 1 to the wall at 3, at a speed of 3.
    assert_near(&report, "/time", 2.0 / 3.0, TIME);
    assert_eq!(
        report["obstacle"],
        json!({"file": "near.obj", "plane": null, "index": 1})
    );
    assert_eq!(
        (&report["span"], &report["touch"]),
        (&json!(0), &json!("enter"))
    );
    assert_near(&report, "/point/0", 3.0, 1e-9);
    for (axis, expected) in [-1.0, 0.0, 0.0].into_iter().enumerate() {
        assert_near(&report, &format!("/normal/{axis}"), expected, 1e-9);
    }
    assert_eq!(number(&report, "/clearance/lower"), 0.0, "{report}");
}

#[test]
fn times_are_on_the_clock_of_the_motion_and_spans_are_counted() {
    let scratch = scene("check_clock");
    let step = r#"{"generator":[[0,0,0,1],[0,0,0,0],[0,0,0,0]],"duration":10}"#;
    scratch.write(
        "steps.json",
        format!(r#"{{"spans":[{step},{step},{step}]}}"#),
    );
    let (report, code) = checked(&scratch, "--motion steps.json --against near.obj");
    assert_eq!((code, &report["verdict"]), (Some(1), &json!("contact")));
    assert_near(&report, "/time", 20.0, 10.0 * TIME);
    let span = number(&report, "/span");
    assert!(span == 1.0 || span == 2.0, "at the joint of both: {report}");
    scratch.write(
        "keys.json",
        r#"{"keyframes":[{"time":100},{"time":104,"translation":[4,0,0]}]}"#,
    );
    let (report, _) = checked(&scratch, "--motion keys.json --against near.obj");
    assert_near(&report, "/time", 102.0, 4.0 * TIME);
}

#[test]
fn a_clearance_is_kept_or_the_first_time_below_it_is_told() {
    let scratch = scene("check_clearance");
    let against = "--translate 3,0,0 --against far.obj --clearance";
    let (report, code) = checked(&scratch, &format!("{against} 1.5"));
    assert_eq!(
        (code, &report["verdict"]),
        (Some(1), &json!("closer")),
        "{report}"
    );
    assert_contract(&report);
    // 5 - (1 + 3 t) = 1.5.
    assert_near(&report, "/time", 2.5 / 3.0, TIME);
    for (clearance, verdict) in [("0.5", "clear"), ("0", "clear"), ("0.999", "clear")] {
        let (report, code) = checked(&scratch, &format!("{against} {clearance}"));
        assert_eq!(
            (code, &report["verdict"]),
            (Some(0), &json!(verdict)),
            "{clearance}"
        );
        assert_contract(&report);
        assert!(
            number(&report, "/clearance/lower") >= clearance.parse().expect("a number"),
            "{clearance}: {report}"
        );
    }
    let (report, _) = checked(
        &scratch,
        "--translate 3,0,0 --against near.obj --clearance 0.1",
    );
    assert_eq!(report["verdict"], "closer", "before it touches: {report}");
    assert_near(&report, "/time", 1.9 / 3.0, TIME);
}

#[test]
fn a_body_inside_a_closed_obstacle_or_around_one_is_in_contact_from_the_start() {
    let scratch = scene("check_inside");
    scratch.write("room.obj", a_box([-5.0; 3], [5.0; 3]));
    scratch.write("seed.obj", a_box([0.4; 3], [0.6; 3]));
    for obstacle in ["room.obj", "seed.obj"] {
        let (report, code) = checked(
            &scratch,
            &format!("--translate .1,0,0 --against {obstacle}"),
        );
        assert_eq!(
            (code, &report["touch"]),
            (Some(1), &json!("inside")),
            "{report}"
        );
        assert_contract(&report);
        assert_eq!(number(&report, "/time"), 0.0, "{report}");
        assert_eq!(report["obstacles"][0]["closed"], true, "{report}");
    }
    // Without a lid the room has no interior.
    let open = a_box([-5.0; 3], [5.0; 3]).replace("f 5 6 7 8\n", "");
    scratch.write("open.obj", open);
    let (report, code) = checked(&scratch, "--translate .1,0,0 --against open.obj");
    assert_eq!(
        (code, &report["verdict"]),
        (Some(0), &json!("clear")),
        "{report}"
    );
    assert_eq!(report["obstacles"][0]["closed"], false, "{report}");
    assert_near(&report, "/clearance/upper", 3.9, 1e-9);
}

#[test]
fn all_times_of_contact_are_listed_on_request() {
    let scratch = scene("check_intervals");
    let (report, code) = checked(
        &scratch,
        "--translate 10,0,0 --against far.obj near.obj --intervals",
    );
    assert_eq!(code, Some(1), "{report}");
    assert_contract(&report);
    // The cube covers x from t * 10 to t * 10 + 1.
    let expected = [[0.2, 0.3], [0.4, 0.5]];
    assert_eq!(
        report["intervals"].as_array().map(Vec::len),
        Some(2),
        "{report}"
    );
    for (i, interval) in expected.iter().enumerate() {
        for (j, time) in interval.iter().enumerate() {
            assert_near(&report, &format!("/intervals/{i}/{j}"), *time, TIME);
            let own = format!("/obstacles/{}/intervals/0/{j}", 1 - i);
            assert_near(&report, &own, *time, TIME);
        }
    }
    let (report, code) = checked(&scratch, "--translate 1,0,0 --against far.obj --intervals");
    assert_eq!(
        (code, &report["intervals"]),
        (Some(0), &json!([])),
        "{report}"
    );
}

/// A plate 0.2 thick extends from the hinge along y, and a stop blocks it.
///
/// Its leading face has turned by 240 degrees when it meets the edge of the stop.
#[test]
fn a_hinge_that_jams_tells_at_which_angle() {
    let scratch = scene("check_jam");
    scratch.write("flap.obj", a_box([0.0, 0.5, -0.2], [1.0, 3.0, 0.0]));
    // In the plane x = 0.5 a triangle that points at the axis, with its tip on the ray of 240
    // degrees at a distance of 2.
    let (sin, cos) = 240_f64.to_radians().sin_cos();
    let tip = [2.0 * cos, 2.0 * sin];
    let stop = format!(
        "v 0.5 {} {}\nv 0.5 {} {}\nv 0.5 {} {}\nf 1 2 3\n",
        tip[0],
        tip[1],
        tip[0] + 0.3,
        tip[1] - 3.0,
        tip[0] + 0.6,
        tip[1] - 3.0
    );
    scratch.write("stop.obj", stop);
    let scene = "check flap.obj --turn 270 --axis 1,0,0 --against stop.obj";
    let Run { code, out, err } = scratch.run(&format!("{scene} --json"));
    assert_eq!((code, err.as_str()), (Some(1), ""), "{out}");
    let report: Value = serde_json::from_str(&out).unwrap_or_else(|error| panic!("{error}: {out}"));
    assert_contract(&report);
    assert_near(&report, "/time", 240.0 / 270.0, TIME);
    assert_near(&report, "/progress/turn_deg", 240.0, 270.0 * TIME);
    assert_near(&report, "/progress/of/turn_deg", 270.0, 1e-12);
    for (i, row) in [
        [1.0, 0.0, 0.0, 0.0],
        [0.0, cos, -sin, 0.0],
        [0.0, sin, cos, 0.0],
    ]
    .iter()
    .enumerate()
    {
        for (j, expected) in row.iter().enumerate() {
            assert_near(&report, &format!("/pose/{i}/{j}"), *expected, 5.0 * TIME);
        }
    }
    assert!(report["obstacle_pose"].is_null(), "it rests: {report}");
    let text = scratch.run(scene).out;
    for part in [
        "CONTACT",
        "turned 240 of 270 degrees\n",
        "pose [[1, 0, 0, 0], [0, -0.5, ",
    ] {
        assert!(text.contains(part), "{part:?}: {text}");
    }
}

/// The cube slides by 3 in each of three spans, past a wall that rises to let it pass, or that
/// approaches it.
#[test]
fn the_poses_of_both_are_told_at_the_closest_place_and_at_the_ends_of_intervals() {
    let scratch = scene("check_poses");
    let slide = r#"{"generator":[[0,0,0,3],[0,0,0,0],[0,0,0,0]],"duration":2}"#;
    scratch.write(
        "slide.json",
        format!(r#"{{"spans":[{slide},{slide},{slide}]}}"#),
    );
    scratch.write(
        "back.json",
        r#"{"keyframes":[{"time":0,"translation":[8,0,0]},{"time":6,"translation":[6.5,0,0]}]}"#,
    );
    let moving = "--motion slide.json --against near.obj --against-motion back.json";
    // The wall is at 11 - t/4 and the front of the cube at 1 + 3 t/2: they are 5 apart at 20/7, in
    // the second span.
    let (report, _) = checked(&scratch, &format!("{moving} --clearance 5"));
    assert_contract(&report);
    let time = 20.0 / 7.0;
    assert_near(&report, "/time", time, 10.0 * TIME);
    assert_near(&report, "/pose/0/3", 1.5 * time, 20.0 * TIME);
    assert_near(
        &report,
        "/obstacle_pose/0/3",
        8.0 - 0.25 * time,
        20.0 * TIME,
    );
    assert_eq!(report["progress"]["span"], 1, "{report}");
    assert_near(&report, "/progress/advance", 1.5 * time - 3.0, 20.0 * TIME);
    assert!(report["progress"]["turn_deg"].is_null(), "{report}");
    // It comes to rest 0.5 into the wall: the closest place is the first contact, at 40/7.
    let (report, _) = checked(&scratch, &format!("{moving} --intervals"));
    assert_contract(&report);
    let time = 40.0 / 7.0;
    for place in ["/interval_ends/0/0", "/obstacles/0/interval_ends/0/0"] {
        assert_near(&report, &format!("{place}/time"), time, 10.0 * TIME);
        assert_near(
            &report,
            &format!("{place}/pose/0/3"),
            1.5 * time,
            20.0 * TIME,
        );
        assert_near(&report, &format!("{place}/progress/span"), 2.0, 0.0);
    }
    // At the end of the motion it is one away from the wall at x = 5.
    let (report, _) = checked(&scratch, "--translate 3,0,0 --against far.obj");
    assert_contract(&report);
    assert_near(&report, "/clearance/pose/0/3", 3.0, 3e-6);
    assert_near(&report, "/clearance/progress/advance", 3.0, 3e-6);
    assert!(report["clearance"]["obstacle_pose"].is_null(), "{report}");
    assert!(report["pose"].is_null(), "never met: {report}");
}

#[test]
fn obstacles_that_may_touch_are_left_out() {
    let scratch = scene("check_allow");
    scratch.write("stand.obj", a_box([-1.0, -1.0, -1.0], [2.0, 2.0, 0.0]));
    let lift = "--translate 0,0,1 --against stand.obj far.obj";
    let (report, code) = checked(&scratch, lift);
    assert_eq!(
        (code, &report["obstacle"]["file"]),
        (Some(1), &json!("stand.obj"))
    );
    assert_eq!(number(&report, "/time"), 0.0, "it stands on it: {report}");
    let text = scratch.run(&format!("check cube.obj {lift}")).out;
    assert!(
        text.contains("--allow stand"),
        "the text says how to go on: {text}"
    );
    let (report, code) = checked(&scratch, &format!("{lift} --allow stand"));
    assert_eq!(
        (code, &report["verdict"]),
        (Some(0), &json!("clear")),
        "{report}"
    );
    assert_eq!(report["obstacles"][0]["allowed"], true, "{report}");
    assert_near(&report, "/clearance/upper", 4.0, 1e-9);
}

#[test]
fn obstacles_that_may_be_touched_are_asked_about_by_depth() {
    let scratch = scene("check_touching");
    scratch.write("flap.obj", a_box([-10.0, 0.0, 0.0], [10.0, 30.0, 2.0]));
    scratch.write("slab.obj", a_box([-10.0, 0.0, -2.0], [10.0, 30.0, 0.0]));
    let run = |arguments: &str| {
        let run = scratch.run(&format!(
            "check flap.obj --turn 270 --axis 1,0,0 {arguments}"
        ));
        (run.code, run.out + &run.err)
    };
    let json = |arguments: &str| -> Value {
        let (_, out) = run(&format!("{arguments} --json"));
        serde_json::from_str(&out).unwrap_or_else(|error| panic!("{error}: {out}"))
    };
    // It lies on the slab and turns about the edge of both: touching from the start, and it jams
    // after half a turn.
    let report = json("--against slab.obj --touching slab --intervals");
    assert_contract(&report);
    assert_near(&report, "/time", 2.0 / 3.0, TIME);
    assert_eq!(report["touch"], "enter", "{report}");
    assert_eq!(report["obstacles"][0]["contact"], "enter", "{report}");
    let depth = number(&report, "/depth");
    assert!(depth > 0.0 && depth < 1e-9, "{report}");
    assert_eq!(report["obstacles"][0]["depth"], report["depth"], "{report}");
    assert_near(&report, "/obstacles/0/intervals/0/0", 2.0 / 3.0, TIME);
    let report = json("--against slab.obj");
    assert_eq!(
        (
            &report["time"],
            &report["depth"],
            &report["obstacles"][0]["contact"]
        ),
        (&json!(0.0), &json!(null), &json!("touch")),
        "{report}"
    );
    let (code, text) = run("--against slab.obj");
    assert!(
        code == Some(1) && text.contains("--touching slab asks"),
        "{text}"
    );
    let (code, text) = run("--against slab.obj far.obj --touching slab --depth 3");
    assert_eq!(code, Some(1), "the flap passes the wall: {text}");
    let (code, text) = run("--against slab.obj --contact enter --depth 3");
    assert!(
        code == Some(0)
            && text.contains("CLEAR   slab.obj is never entered deeper than 3 (proven)"),
        "nothing in it is as deep: {text}"
    );
    let report = json("--against slab.obj --contact enter --depth 3");
    assert!(
        report["clearance"]["lower"].is_null(),
        "no distance: {report}"
    );
    for (arguments, expected) in [
        ("--against slab.obj --depth 1", "name one by --touching"),
        ("--against slab.obj --touching slap", "known is slab"),
        (
            "--against slab.obj --contact enter --clearance 1",
            "none is left",
        ),
        (
            "--against slab.obj far.obj --touching slab --allow slab",
            "--touching alone",
        ),
        (
            "--against slab.obj --touching slab --depth 1e-20",
            "slab.obj: a depth of",
        ),
        (
            "--against slab.obj --touching slab --depth 0",
            "must be above 0",
        ),
    ] {
        let (code, text) = run(arguments);
        assert!(
            code == Some(2) && text.contains(expected),
            "{arguments}: {text}"
        );
    }
}

#[test]
fn obstacles_may_move_too() {
    let scratch = scene("check_moving");
    let slide =
        |x: f64| format!(r#"{{"spans":[{{"generator":[[0,0,0,{x}],[0,0,0,0],[0,0,0,0]]}}]}}"#);
    scratch.write("along.json", slide(3.0));
    scratch.write("against.json", slide(-1.0));
    let (report, code) = checked(
        &scratch,
        "--translate 3,0,0 --against near.obj --against-motion along.json",
    );
    assert_eq!(
        (code, &report["verdict"]),
        (Some(0), &json!("clear")),
        "{report}"
    );
    assert_near(&report, "/clearance/upper", 2.0, 1e-9);
    assert_eq!(
        report["obstacles"][0]["relative_motion"], "steady",
        "{report}"
    );
    assert_eq!(report["obstacles"][0]["motion"], "along.json", "{report}");
    let (report, code) = checked(
        &scratch,
        "--translate 3,0,0 --against near.obj --against-motion against.json --against far.obj",
    );
    assert_eq!(
        (code, &report["verdict"]),
        (Some(1), &json!("contact")),
        "{report}"
    );
    // A gap of 2, closed at a speed of 4.
    assert_near(&report, "/time", 0.5, TIME);
    assert_near(&report, "/point/0", 2.5, 1e-9);
    assert_eq!(
        report["obstacles"][1]["relative_motion"], "at_rest",
        "{report}"
    );
    scratch.write(
        "turn.json",
        r#"{"spans":[{"turn_deg":90,"axis":[0,0,1],"through":[3,2,0]}]}"#,
    );
    let (report, _) = checked(
        &scratch,
        "--translate 3,0,0 --against far.obj --against-motion turn.json",
    );
    assert_eq!(
        report["obstacles"][0]["relative_motion"], "bounded",
        "{report}"
    );
    assert_contract(&report);
}

#[test]
fn a_body_at_rest_is_checked_where_it_is() {
    let scratch = scene("check_rest");
    let (report, code) = checked(&scratch, "--turn 0 --against near.obj");
    assert_eq!(
        (code, &report["verdict"]),
        (Some(0), &json!("clear")),
        "{report}"
    );
    assert_near(&report, "/clearance/upper", 2.0, 1e-12);
    scratch.write("half.obj", wall(0.5));
    let (report, code) = checked(&scratch, "--turn 0 --against half.obj");
    assert_eq!(
        (code, &report["verdict"]),
        (Some(1), &json!("contact")),
        "{report}"
    );
    assert_eq!(number(&report, "/time"), 0.0, "{report}");
}

#[test]
fn triangles_without_area_are_hit_as_segments_and_points() {
    let scratch = scene("check_degenerate");
    let facet = |corners: [[f64; 3]; 3]| {
        let vertices = corners.map(|[x, y, z]| format!("vertex {x} {y} {z}\n"));
        format!(
            "solid\nfacet normal 0 0 0\nouter loop\n{}endloop\nendfacet\nendsolid\n",
            vertices.concat()
        )
    };
    let (below, above) = ([3.0, 0.5, -1.0], [3.0, 0.5, 2.0]);
    scratch.write("segment.stl", facet([below, [3.0, 0.5, 1.5], above]));
    scratch.write("fold.stl", facet([below, above, below]));
    scratch.write("point.stl", facet([[3.0, 0.5, 0.5]; 3]));
    scratch.write("point.obj", "v 3 0.5 0.5\nv 0 0 0\nf 1 1 1\n");
    for obstacle in ["segment.stl", "fold.stl", "point.stl", "point.obj"] {
        let (report, code) = checked(&scratch, &format!("--translate 3,0,0 --against {obstacle}"));
        assert_eq!(code, Some(1), "{obstacle}: {report}");
        assert_contract(&report);
        assert_near(&report, "/time", 2.0 / 3.0, TIME);
        assert_eq!(
            report["obstacles"][0]["triangles"], 1,
            "{obstacle}: {report}"
        );
    }
}

#[test]
fn features_have_the_numbers_of_the_files() {
    let scratch = scene("check_features");
    // A tip at vertex 5 (from 0), after an unused one, above face 1 of a wall whose face 0 is
    // elsewhere.
    scratch.write(
        "tip.obj",
        "v 9 9 9\nv 0 0 0\nv 0 1 0\nv 0 0 1\nv 7 7 7\nv 1 .2 .2\nf 2 4 3\nf 2 3 6\nf 3 4 6\nf 4 2 6\n",
    );
    scratch.write(
        "two.obj",
        "v 0 0 0\nv 20 0 0\nv 20 1 0\nv 20 0 1\nv 3 -9 -9\nv 3 9 -9\nv 3 0 9\nf 2 3 4\nf 5 6 7\n",
    );
    let run = scratch.run("check tip.obj --translate 4,0,0 --against two.obj --json");
    let report: Value = serde_json::from_str(&run.out).expect("JSON");
    assert_eq!(
        report["features"],
        json!({"body": {"vertex": 5}, "obstacle": {"face": 1}}),
        "{report}"
    );
    assert_near(&report, "/time", 0.5, TIME);
    let text = scratch
        .run("check tip.obj --translate 4,0,0 --against two.obj")
        .out;
    assert!(
        text.contains("vertex 5") && text.contains("face 1"),
        "{text}"
    );
}

#[test]
fn the_text_says_what_the_json_says() {
    let scratch = scene("check_text");
    let cases: [(&str, i32, &[&str]); 4] = [
        (
            "--against near.obj",
            1,
            &[
                "CONTACT with near.obj at time 0.6666666667",
                "normal (-1, 0, 0)",
                "open",
            ],
        ),
        (
            "--against far.obj",
            0,
            &["CLEAR", "(proven)", "closest seen: 1 at time 1", "far.obj"],
        ),
        (
            "--against far.obj --clearance 1.5",
            1,
            &["CLOSER", "far.obj", "1.5", "0.8333333333"],
        ),
        (
            "--against near.obj far.obj --intervals",
            1,
            &["[0.6666666667, 1] with near.obj", "no time with far.obj"],
        ),
    ];
    for (arguments, code, parts) in cases {
        let run = scratch.run(&format!("check cube.obj --translate 3,0,0 {arguments}"));
        assert_eq!(
            (run.code, run.err.as_str()),
            (Some(code), ""),
            "{arguments}"
        );
        for part in parts {
            assert!(
                run.out.contains(part),
                "{arguments}: {part:?} is missing: {}",
                run.out
            );
        }
    }
}

#[test]
fn what_is_proven_of_the_distance_is_in_the_text_of_every_verdict_that_measures_it() {
    let scratch = scene("check_proven");
    for (clearance, word) in [("0", "CLEAR"), ("1.5", "CLOSER")] {
        let arguments = format!("--translate 3,0,0 --against far.obj --clearance {clearance}");
        let (report, _) = checked(&scratch, &arguments);
        let lower = number(&report, "/clearance/lower");
        // The least distance is 1, at the end.
        assert!((0.999..=1.0).contains(&lower), "{report}");
        let text = scratch.run(&format!("check cube.obj {arguments}")).out;
        assert!(text.contains(word), "{text}");
        assert_proven(&text, lower);
    }
}

/// Checks that a text has one line with this bound of the distance, in full precision.
fn assert_proven(text: &str, lower: f64) {
    let told: Vec<f64> = text
        .lines()
        .filter_map(|line| line.split_once("the distance is never below "))
        .filter_map(|(_, rest)| rest.strip_suffix(" (proven)")?.parse().ok())
        .collect();
    assert!(
        matches!(told[..], [told] if (told - lower).abs() <= 1e-6 * lower),
        "{told:?} for {lower}: {text}"
    );
}

#[test]
fn a_least_distance_that_only_the_table_sees_is_the_same_everywhere() {
    let scratch = scene("check_least_of_all");
    let arguments = "--turn 340 --axis .3,1,.2 --through 1,0,.4 --against far.obj";
    let upper = |report: &Value| number(report, "/clearance/upper");
    let (alone, _) = checked(&scratch, arguments);
    let arguments = format!("{arguments} --csv distance.csv");
    let (report, _) = checked(&scratch, &arguments);
    assert!(
        upper(&report) < upper(&alone),
        "a row is nearer than the measurement came: {report}"
    );
    let (_, rows) = table(&scratch, "distance.csv");
    let least = rows
        .iter()
        .map(|row| (row[1].parse::<f64>().expect("a distance"), &row[0]))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .expect("rows");
    assert_eq!(least.0, upper(&report), "in the table and in the object");
    let time: f64 = least.1.parse().expect("a time");
    assert_eq!(time, number(&report, "/clearance/time"), "then");
    let text = scratch.run(&format!("check cube.obj {arguments}")).out;
    let (_, rest) = text.split_once("closest seen: ").expect("a line of it");
    let told: Vec<f64> = rest
        .split([' ', ','])
        .filter_map(|word| word.parse().ok())
        .take(2)
        .collect();
    let [distance, at] = told[..] else {
        panic!("distance and time: {text}")
    };
    assert!(
        (distance - least.0).abs() <= 1e-6 && (at - time).abs() <= 1e-9,
        "in the text: {text}"
    );
}

#[test]
fn what_limited_a_proof_is_told() {
    let scratch = scene("check_limited");
    // So near that rounding exceeds a thousandth of the gap.
    scratch.write("close.obj", wall(1.0 + 1e-12));
    let arguments = "--translate 0,1,0 --against close.obj";
    let (report, code) = checked(&scratch, arguments);
    assert_eq!(
        (code, &report["verdict"], &report["clearance"]["limited"]),
        (Some(0), &json!("clear"), &json!("rounding")),
        "{report}"
    );
    let text = scratch.run(&format!("check cube.obj {arguments}")).out;
    assert_proven(&text, number(&report, "/clearance/lower"));
    assert!(text.contains("near the rounding of positions"), "{text}");
    // In each of very many turns the corner comes as deep as sqrt(2) - 1 = 0.41421356237..., which is
    // nearly what is allowed: more than the search can prove. Nothing is measured.
    scratch.write("block.obj", a_box([2.0, -3.0, -1.0], [9.0, 3.0, 2.0]));
    let arguments = "--turn 9e6 --axis 0,0,1 --through 1,1,0 --against block.obj --contact enter --depth 0.414213563";
    let (report, code) = checked(&scratch, arguments);
    assert_eq!(
        (code, &report["verdict"], &report["clearance"]["limited"]),
        (Some(2), &json!("undecided"), &json!("work")),
        "{report}"
    );
    assert!(report["clearance"]["upper"].is_null(), "{report}");
    let (report, _) = checked(&scratch, "--translate 3,0,0 --against far.obj");
    assert!(report["clearance"]["limited"].is_null(), "{report}");
}

#[test]
fn the_number_of_threads_does_not_change_the_report() {
    let scratch = scene("check_threads");
    scratch.write("post.obj", a_box([2.0, -3.0, -1.0], [2.5, -2.0, 2.0]));
    let reports: Vec<Value> = [1, 2, 5]
        .map(|threads| {
            let (mut report, _) = checked(
                &scratch,
                &format!(
                    "--turn 400 --axis 0,.1,1 --through 2,0,0 --against post.obj far.obj --intervals --threads {threads}"
                ),
            );
            report["seconds"] = Value::Null;
            report
        })
        .into();
    assert!(
        reports.iter().all(|report| *report == reports[0]),
        "the same bits: {reports:?}"
    );
}

/// Rows of a table after its header.
fn table(scratch: &Scratch, name: &str) -> (String, Vec<Vec<String>>) {
    let text = std::fs::read_to_string(scratch.path().join(name)).expect("the table is there");
    let mut lines = text.lines().map(str::to_owned);
    let header = lines.next().expect("a header");
    let rows = lines.map(|line| line.split(',').map(str::to_owned).collect());
    (header, rows.collect())
}

#[test]
fn the_table_has_the_distance_over_time() {
    let scratch = scene("check_table");
    let (report, _) = checked(
        &scratch,
        "--translate 3,0,0 --against near.obj far.obj --csv distance.csv",
    );
    let (header, rows) = table(&scratch, "distance.csv");
    assert_eq!(
        header,
        "time,distance,obstacle,body_x,body_y,body_z,obstacle_x,obstacle_y,obstacle_z"
    );
    assert!(rows.len() > 100, "a smooth curve: {}", rows.len());
    let numbers: Vec<[f64; 2]> = rows
        .iter()
        .map(|row| [0, 1].map(|column| row[column].parse().expect("a number")))
        .collect();
    assert_eq!((numbers[0][0], numbers[numbers.len() - 1][0]), (0.0, 1.0));
    assert!(numbers.is_sorted_by(|a, b| a[0] < b[0]), "times increase");
    for [time, distance] in &numbers {
        let front = 1.0 + 3.0 * time;
        // Once past the near wall the cube, one unit long, moves away from it from x = 4 on, which
        // is where it ends.
        let expected = if front < 3.0 { 3.0 - front } else { 0.0 };
        assert!(
            (distance - expected).abs() < 1e-9,
            "{distance} at {time}, not {expected}"
        );
    }
    assert!(
        numbers
            .iter()
            .any(|[time, _]| *time == number(&report, "/time")),
        "the time of the first contact is a row"
    );
    assert!(
        rows.iter().all(|row| row[2] == "near.obj"),
        "the nearest one is named"
    );
    assert_eq!(
        scratch.files(),
        ["cube.obj", "distance.csv", "far.obj", "near.obj"],
        "nothing else is left"
    );
    // An undecided or clear check writes it as well; a refused one does not.
    scratch.write("distance.csv", "old");
    let run = scratch.run("check cube.obj --translate 3,0,0 --against none.obj --csv distance.csv");
    assert_eq!(run.code, Some(2), "{}", run.out);
    assert_eq!(
        std::fs::read(scratch.path().join("distance.csv")).expect("there"),
        b"old",
        "left as it was"
    );
}

/// Runs the binary, which must refuse with one message that contains all of `parts`.
fn refused(scratch: &Scratch, arguments: &str, parts: &[&str]) {
    let before = scratch.files();
    let run = scratch.run(&format!("check {arguments}"));
    assert_eq!(
        (run.code, run.out.as_str()),
        (Some(2), ""),
        "{arguments}: {}",
        run.err
    );
    assert_eq!(
        (
            run.err.starts_with("error: "),
            run.err.matches("error: ").count()
        ),
        (true, 1),
        "{arguments}: one message: {}",
        run.err
    );
    for part in parts {
        assert!(
            run.err.contains(part),
            "{arguments}: {part:?} is missing: {}",
            run.err
        );
    }
    assert_eq!(scratch.files(), before, "{arguments}: no file appears");
}

#[test]
fn obstacles_that_cannot_be_read_are_refused_by_name() {
    let scratch = scene("check_obstacles");
    scratch.write("empty.stl", "");
    scratch.write("nothing.stl", "solid a\nendsolid a\n");
    scratch.write("points.obj", "v 0 0 0\n");
    scratch.write("nan.obj", wall(3.0).replace("v 3 2 2", "v 3 NaN 2"));
    scratch.write("cut.stl", vec![7; 120]);
    scratch.write("wall.xyz", wall(3.0));
    scratch.write("wall.step", wall(3.0));
    scratch.write("huge.obj", wall(1e30));
    std::fs::create_dir(scratch.path().join("folder.stl")).expect("the scratch directory is ours");
    let cases: [(&str, &[&str]); 10] = [
        ("missing.stl", &["no such file"]),
        ("empty.stl", &["empty"]),
        ("nothing.stl", &["no triangles"]),
        ("points.obj", &["f i j k"]),
        ("nan.obj", &["line 3"]),
        ("cut.stl", &["cut off"]),
        ("wall.xyz", &[".stl .obj .ply"]),
        ("wall.step", &["yet", ".stl .obj .ply"]),
        ("folder.stl", &["directory"]),
        ("huge.obj", &["not an obstacle", "vertex 0"]),
    ];
    for (obstacle, parts) in cases {
        let named = [&[obstacle], parts].concat();
        refused(
            &scratch,
            &format!("cube.obj --translate 1,0,0 --against near.obj {obstacle} --csv out.csv"),
            &named,
        );
    }
}

#[test]
fn the_body_has_to_be_closed_and_the_motion_to_be_one() {
    let scratch = scene("check_body");
    refused(
        &scratch,
        "near.obj --translate 1,0,0 --against far.obj",
        &["near.obj", "not closed"],
    );
    refused(
        &scratch,
        "cube.obj --against far.obj",
        &["--motion", "--turn"],
    );
    refused(&scratch, "cube.obj --translate 1,0,0", &["--against"]);
    refused(
        &scratch,
        "cube.obj --translate 1,0,0 --against",
        &["--against"],
    );
}

#[test]
fn options_that_make_no_sense_are_refused() {
    let scratch = scene("check_options");
    scratch.write("copy.stl", "solid\nendsolid\n");
    scratch.write("rest.json", r#"{"spans":[{}]}"#);
    scratch.write("bad.json", "{");
    let cases: [(&str, &[&str]); 13] = [
        (
            "--against near.obj --clearance -1",
            &["--clearance", "below 0"],
        ),
        (
            "--against near.obj --clearance NaN",
            &["--clearance", "finite"],
        ),
        (
            "--against near.obj --clearance inf",
            &["--clearance", "finite"],
        ),
        (
            "--against near.obj --clearance wide",
            &["--clearance", "number"],
        ),
        (
            "--against near.obj far.obj --allow stand",
            &["--allow stand", "known are near, far"],
        ),
        ("--against near.obj --allow near.obj", &["known is near"]),
        (
            "--against near.obj ./near.obj far.obj --allow near",
            &["--allow near", "near.obj and ./near.obj"],
        ),
        (
            "--against near.obj --allow near",
            &["nothing is left to check"],
        ),
        (
            "--against near.obj --against-motion rest.json rest.json",
            &["--against-motion", "one for all", "one for each"],
        ),
        (
            "--against near.obj --against-motion none.json",
            &["none.json", "no such file"],
        ),
        (
            "--against near.obj --against-motion bad.json",
            &["bad.json", "line 1"],
        ),
        (
            "--against near.obj --csv distance.txt",
            &["distance.txt", ".csv"],
        ),
        (
            "--against near.obj --csv nowhere/distance.csv",
            &["nowhere", "create it"],
        ),
    ];
    for (options, parts) in cases {
        refused(
            &scratch,
            &format!("cube.obj --translate 3,0,0 {options}"),
            parts,
        );
    }
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_a_check_at_once_and_leaves_the_old_table() {
    let scratch = scene("check_interrupt");
    scratch.write("distance.csv", "old");
    // Reading it waits until somebody writes to it, which nobody does.
    let pipe = std::process::Command::new("mkfifo")
        .arg(scratch.path().join("pipe.obj"))
        .status();
    assert!(pipe.expect("mkfifo must start").success(), "a pipe is made");
    let mut child = scratch
        .command("check cube.obj --translate 3,0,0 --against near.obj pipe.obj --csv distance.csv")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary must start");
    std::thread::sleep(Duration::from_millis(500));
    assert!(
        child.try_wait().expect("the binary can be asked").is_none(),
        "still waiting"
    );
    command::interrupt(child);
    assert_eq!(
        scratch.files(),
        [
            "cube.obj",
            "distance.csv",
            "far.obj",
            "near.obj",
            "pipe.obj"
        ],
        "no other file, whole or not"
    );
    let table = std::fs::read(scratch.path().join("distance.csv")).expect("still there");
    assert_eq!(table, b"old", "the old table");
}
