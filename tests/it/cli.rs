//! The command line as scripts see it: exit codes, streams, files and the keys of the JSON reports.

use crate::support::command;
use crate::support::command::{CUBE, Scratch};
use serde_json::Value;
use std::process::Stdio;
use std::time::Duration;

fn json(text: &str) -> Value {
    assert_eq!(text.lines().count(), 1, "one object on one line: {text}");
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// Sorted keys of the object at `path`, such as `sweep/error_bound`.
fn keys(report: &Value, path: &str) -> Vec<String> {
    let object = report.pointer(path).and_then(Value::as_object);
    let mut keys: Vec<String> = object
        .unwrap_or_else(|| panic!("no object at {path:?}: {report}"))
        .keys()
        .cloned()
        .collect();
    keys.sort();
    keys
}

fn number(report: &Value, path: &str) -> f64 {
    report
        .pointer(path)
        .and_then(Value::as_f64)
        .unwrap_or_else(|| panic!("no number at {path:?}: {report}"))
}

#[test]
fn the_sweep_report_has_the_keys_of_the_contract() {
    let scratch = Scratch::new("sweep_keys");
    scratch.write("cube.obj", CUBE);
    let run = scratch.run("sweep cube.obj --translate 3,0,0 --json");
    assert_eq!(
        (run.code, run.err.as_str()),
        (Some(0), ""),
        "a clean run says nothing on stderr"
    );
    let report = json(&run.out);
    assert_eq!(keys(&report, ""), ["body", "motion", "seconds", "sweep"]);
    assert_eq!(
        keys(&report, "/body"),
        [
            "collapsed",
            "largest_move",
            "triangles",
            "turned",
            "volume",
            "watertight",
            "welded"
        ]
    );
    assert_eq!(keys(&report, "/motion"), ["half_turns", "spans"]);
    assert_eq!(
        keys(&report, "/sweep"),
        [
            "area",
            "attempts",
            "bounds",
            "components",
            "crossings",
            "error_bound",
            "genus",
            "manifold",
            "raw_triangles",
            "touching_edges",
            "triangles",
            "vertices",
            "voids",
            "volume",
            "watertight"
        ]
    );
    assert_eq!(
        keys(&report, "/sweep/error_bound"),
        ["inside", "inside_proven", "outside", "outside_proven"]
    );
    // A unit square swept over a length of 3, and the cube at its end.
    assert!(
        (number(&report, "/sweep/volume") - 4.0).abs() < 1e-9,
        "a prism: {report}"
    );
    assert_eq!(
        number(&report, "/body/triangles"),
        12.0,
        "six squares: {report}"
    );
    assert_eq!(report["sweep"]["components"], 1);
    assert_eq!(report["sweep"]["watertight"], true);
    assert!(
        number(&report, "/seconds/total") > 0.0,
        "the whole run takes time: {report}"
    );
    assert!(
        keys(&report, "/seconds").len() > 2,
        "the total and the stages: {report}"
    );
    assert_eq!(
        scratch.files(),
        ["cube.obj"],
        "without -o nothing is written"
    );
}

#[test]
fn the_text_report_has_the_same_numbers() {
    let scratch = Scratch::new("sweep_text");
    scratch.write("cube.obj", CUBE);
    let run = scratch.run("sweep cube.obj --translate 3,0,0 -o out.stl");
    assert_eq!(
        (run.code, run.err.as_str()),
        (Some(0), ""),
        "piped: no progress"
    );
    for part in [
        "12 triangles",
        "volume 1,",
        "volume 4,",
        "1 component",
        "watertight",
        "bounds",
        "time",
    ] {
        assert!(run.out.contains(part), "{part:?} is missing: {}", run.out);
    }
    assert_eq!(
        scratch.files(),
        ["cube.obj", "out.stl"],
        "the result and nothing else"
    );
}

/// Programs that watch logs would take such a line for a failure.
#[test]
fn no_line_of_a_success_begins_like_one_of_a_failure() {
    let scratch = Scratch::new("success_lines");
    scratch.write("cube.obj", CUBE);
    scratch.write(
        "square.svg",
        "<svg xmlns='http://www.w3.org/2000/svg'><rect width='2' height='2'/></svg>\n",
    );
    scratch.write("away.obj", "v 9 9 9\nv 9 8 9\nv 8 9 9\nf 1 2 3\n");
    scratch.write("points.csv", "0.5,0.5,0.5\n9,9,9\n");
    for arguments in [
        "sweep cube.obj --turn 90 --axis 0,0,1 --through 3,0,0",
        "sweep square.svg --turn 90 --through 3,0",
        "sweep square.svg --turn 20 --subtract-from square.svg",
        "check cube.obj --translate 1,0,0 --against away.obj --intervals",
        "probe cube.obj --translate 1,0,0 --points points.csv",
        "motion --turn 180 --axis 0,0,1",
    ] {
        let run = scratch.run(arguments);
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{arguments}");
        for line in run.out.lines() {
            let line = line.trim_start().to_lowercase();
            for word in [
                "error",
                "warning",
                "fail",
                "fatal",
                "critical",
                "panic",
                "exception",
            ] {
                assert!(!line.starts_with(word), "{arguments}: {line}");
            }
        }
    }
}

#[test]
fn the_motion_report_has_the_keys_of_the_contract() {
    let scratch = Scratch::new("motion_keys");
    let run = scratch.run("motion --turn -540 --axis 0,0,-2 --through 1,-2,0 --advance -3 --json");
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{}", run.err);
    let report = json(&run.out);
    assert_eq!(
        keys(&report, ""),
        [
            "fitted",
            "interpolation",
            "spans",
            "volume_factor",
            "volume_monotone"
        ]
    );
    assert_eq!(
        keys(&report, "/spans/0"),
        [
            "advance",
            "axis",
            "duration",
            "eigenvalues",
            "fixed_point",
            "generator",
            "half_turn",
            "kind",
            "margin",
            "plane_normal",
            "scale",
            "through",
            "turn_deg",
            "unique",
            "volume_factor"
        ]
    );
    // Turning by -540 about -z is turning by 540 about z; the sense of the axis is free, but the
    // product is not.
    let turn = number(&report, "/spans/0/turn_deg") * number(&report, "/spans/0/axis/2");
    assert!((turn - 540.0).abs() < 1e-9, "{report}");
    let advance = number(&report, "/spans/0/advance") * number(&report, "/spans/0/axis/2");
    assert!(
        (advance - 3.0).abs() < 1e-12,
        "-3 along -z is 3 along z: {report}"
    );
    assert!(
        (number(&report, "/spans/0/through/0") - 1.0).abs() < 1e-12,
        "{report}"
    );
    assert!(
        (number(&report, "/spans/0/generator/2/3") - 3.0).abs() < 1e-12,
        "{report}"
    );
    assert_eq!(number(&report, "/spans/0/duration"), 1.0);
    assert_eq!(
        report["spans"][0]["unique"], true,
        "given as a turn, not as two poses"
    );
}

#[test]
fn a_half_turn_between_keyframes_is_reported_as_not_unique() {
    let scratch = Scratch::new("half_turn");
    scratch.write(
        "half.json",
        r#"{"keyframes":[{"translation":[0,0,0],"rotation":[0,0,0,1],"scale":[1,1,1]},
                         {"translation":[0,0,0],"rotation":[0,0,1,0],"scale":[1,1,1]}]}"#,
    );
    let report = json(&scratch.run("motion --motion half.json --json").out);
    assert_eq!(report["spans"][0]["unique"], false, "{report}");
    let text = scratch.run("motion --motion half.json").out;
    assert!(text.contains("half turn"), "the text says it too: {text}");
}

#[test]
fn the_probe_report_follows_the_order_of_the_points() {
    let scratch = Scratch::new("probe_keys");
    scratch.write("cube.obj", CUBE);
    scratch.write("points.csv", "x,y,z\n-1,0.5,0.5\n2.5,0.5,0.5\n");
    scratch.write(
        "slide.json",
        r#"{"spans":[{"generator":[[0,0,0,4],[0,0,0,0],[0,0,0,0]],"duration":2}]}"#,
    );
    let run = scratch.run("probe cube.obj --motion slide.json --points points.csv --json");
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{}", run.err);
    let report = json(&run.out);
    assert_eq!(keys(&report, ""), ["motion", "points", "seconds"]);
    assert_eq!(keys(&report, "/motion"), ["half_turns", "spans"]);
    assert_eq!(keys(&report, "/points/0"), ["inside", "intervals"]);
    assert_eq!(report["points"][0]["inside"], false);
    assert_eq!(report["points"][0]["intervals"], serde_json::json!([]));
    assert_eq!(report["points"][1]["inside"], true);
    // At 2 units per unit of time the cube covers x = 2.5 from 1.5 / 2 to 2.5 / 2.
    for (end, expected) in [(0, 0.75), (1, 1.25)] {
        let time = number(&report, &format!("/points/1/intervals/0/{end}"));
        // Issue: exact to 1e-9 of the span.
        assert!((time - expected).abs() < 2e-9, "{time} against {expected}");
    }
}

#[test]
fn the_number_of_threads_does_not_change_the_result() {
    let scratch = Scratch::new("threads");
    scratch.write("cube.obj", CUBE);
    let mut files = Vec::new();
    for threads in [1, 2, 5] {
        let run = scratch.run(&format!(
            "sweep cube.obj --turn 100 --axis 1,2,3 --advance .5 --threads {threads} -o {threads}.ply --json"
        ));
        assert_eq!(run.code, Some(0), "{}", run.err);
        files.push(
            std::fs::read(scratch.path().join(format!("{threads}.ply")))
                .expect("the result is there"),
        );
    }
    assert!(
        files.iter().all(|file| *file == files[0]),
        "bit for bit the same file"
    );
}

#[test]
fn a_result_is_a_body_again_in_every_format() {
    let scratch = Scratch::new("formats");
    scratch.write("cube.obj", CUBE);
    for format in ["stl", "obj", "ply"] {
        let first = scratch.run(&format!(
            "sweep cube.obj --turn 60 --axis 1,2,3 -o once.{format} --json"
        ));
        assert_eq!(first.code, Some(0), "{format}: {}", first.err);
        let again = scratch.run(&format!("sweep once.{format} --translate 0,0,0 --json"));
        assert_eq!(again.code, Some(0), "{format}: {}", again.err);
        let [first, again] = [json(&first.out), json(&again.out)];
        let (written, read) = (
            number(&first, "/sweep/volume"),
            number(&again, "/body/volume"),
        );
        // The report describes the coordinates in the file, so that only the order of summation
        // differs.
        assert!(
            (written - read).abs() < 1e-12 * written,
            "{format}: {written} against {read}"
        );
        assert_eq!(
            first["sweep"]["triangles"], again["body"]["triangles"],
            "{format}"
        );
        // A body at rest is its own sweep, except where the rounding of the file made it cross
        // itself.
        let at_rest = number(&again, "/sweep/volume");
        let off = ["inside", "outside"]
            .map(|side| number(&again, &format!("/sweep/error_bound/{side}")))
            .iter()
            .sum::<f64>()
            * number(&again, "/sweep/area");
        assert!(
            off < 1e-6 * read,
            "{format}: the bound is that of rounding, {off}"
        );
        assert!(
            (at_rest - read).abs() < off,
            "{format}: {at_rest} against {read}, further apart than {off}"
        );
    }
}

#[test]
fn thread_counts_that_make_no_sense_are_refused() {
    let scratch = Scratch::new("thread_counts");
    for threads in ["0", "-1", "513", "1e9", "many"] {
        let run = scratch.run(&format!("motion --translate 1,0,0 --threads {threads}"));
        assert_eq!(
            (run.code, run.out.as_str()),
            (Some(2), ""),
            "--threads {threads}"
        );
        assert!(run.err.contains("--threads"), "{}", run.err);
    }
}

#[test]
fn a_smaller_tolerance_gives_a_smaller_error_bound() {
    let scratch = Scratch::new("tolerance");
    scratch.write("cube.obj", CUBE);
    let bound = |tolerance: &str| {
        let run = scratch.run(&format!(
            "sweep cube.obj --turn 90 --axis 0,0,1 --tolerance {tolerance} --json"
        ));
        let report = json(&run.out);
        ["inside", "outside"].map(|side| number(&report, &format!("/sweep/error_bound/{side}")))
    };
    let (coarse, fine) = (bound("0.05"), bound("0.005"));
    assert!(
        fine[0] < coarse[0],
        "shortfall {} against {}",
        fine[0],
        coarse[0]
    );
    assert!(
        fine[1] <= coarse[1],
        "overshoot {} against {}",
        fine[1],
        coarse[1]
    );
}

#[cfg(unix)]
#[test]
fn an_existing_result_is_replaced_by_rename() {
    use std::os::unix::fs::MetadataExt;
    let scratch = Scratch::new("replace");
    scratch.write("cube.obj", CUBE);
    scratch.write("out.stl", "old");
    // Whoever holds the old file open keeps it: the new one is another file with the same name.
    std::fs::hard_link(scratch.path().join("out.stl"), scratch.path().join("held"))
        .expect("links work here");
    let old = std::fs::metadata(scratch.path().join("out.stl"))
        .expect("the old file is there")
        .ino();
    let run = scratch.run("sweep cube.obj --translate 0,0,1 -o out.stl");
    assert_eq!(run.code, Some(0), "{}", run.err);
    let new = std::fs::metadata(scratch.path().join("out.stl")).expect("the new file is there");
    assert_ne!(new.ino(), old, "replaced, not overwritten");
    assert!(new.len() > 84, "a binary STL with triangles");
    let held = std::fs::read(scratch.path().join("held")).expect("the held file is there");
    assert_eq!(held, b"old", "the old contents were not touched");
    assert_eq!(
        scratch.files(),
        ["cube.obj", "held", "out.stl"],
        "no temporary file is left"
    );
}

#[test]
fn an_error_leaves_an_existing_result_alone() {
    let scratch = Scratch::new("keep");
    scratch.write("cube.obj", CUBE.replace("f 4 1 5 8\n", ""));
    scratch.write("out.stl", "old");
    let run = scratch.run("sweep cube.obj --translate 0,0,1 -o out.stl");
    assert_eq!(
        (run.code, run.out.as_str()),
        (Some(2), ""),
        "an open body is refused"
    );
    let kept = std::fs::read(scratch.path().join("out.stl")).expect("the file is there");
    assert_eq!(kept, b"old", "nothing was written");
    assert_eq!(
        scratch.files(),
        ["cube.obj", "out.stl"],
        "no temporary file is left"
    );
}

#[test]
fn the_help_shows_an_example_and_only_commands_that_exist() {
    let scratch = Scratch::new("help");
    for arguments in [
        "--help",
        "sweep --help",
        "check --help",
        "probe --help",
        "motion --help",
    ] {
        let run = scratch.run(arguments);
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{arguments}");
        assert!(run.out.contains("Example"), "{arguments}: {}", run.out);
        assert!(
            run.out.contains("  steadysweep "),
            "{arguments}: {}",
            run.out
        );
    }
    let all = scratch.run("--help").out;
    for (command, exists) in [
        ("sweep", true),
        ("probe", true),
        ("motion", true),
        ("check", true),
    ] {
        let is_listed = all
            .lines()
            .any(|line| line.trim_start().starts_with(&format!("{command} ")));
        assert_eq!(is_listed, exists, "{command}: {all}");
    }
}

#[test]
fn every_command_knows_the_version() {
    let scratch = Scratch::new("version");
    for arguments in [
        "--version",
        "sweep --version",
        "check --version",
        "probe --version",
        "motion --version",
    ] {
        let run = scratch.run(arguments);
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{arguments}");
        assert_eq!(
            run.out,
            format!("steadysweep {}\n", env!("CARGO_PKG_VERSION")),
            "{arguments}"
        );
    }
}

#[test]
fn common_options_may_stand_before_or_after_the_command() {
    let scratch = Scratch::new("common");
    let before = scratch.run("--quiet --threads 2 motion --translate 1,0,0 --json");
    let after = scratch.run("motion --translate 1,0,0 --json --quiet --threads 2");
    assert_eq!(
        (before.code, after.code),
        (Some(0), Some(0)),
        "{}{}",
        before.err,
        after.err
    );
    assert_eq!(before.out, after.out, "the same run");
}

#[test]
fn a_reader_that_stops_early_is_no_error() {
    let scratch = Scratch::new("pipe");
    let mut child = scratch
        .command("motion --translate 1,0,0")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary must start");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("the binary must end");
    assert_eq!(
        String::from_utf8_lossy(&output.stderr),
        "",
        "no complaint about a closed pipe"
    );
    assert_eq!(output.status.code(), Some(0), "the work was done");
}

#[cfg(target_os = "linux")]
#[test]
fn a_report_that_cannot_be_written_is_an_error_that_names_the_solid() {
    let scratch = Scratch::new("full");
    scratch.write("cube.obj", CUBE);
    let full = || {
        std::fs::File::options()
            .write(true)
            .open("/dev/full")
            .expect("the device that is always full")
    };
    for (arguments, kept) in [
        ("sweep cube.obj --translate 0,0,1 -o out.obj", true),
        ("motion --translate 0,0,1", false),
    ] {
        let run = scratch.command(arguments).stdout(full()).output();
        let run: command::Run = run.expect("the binary must start").into();
        assert_eq!(run.code, Some(2), "{arguments}: {}", run.err);
        assert!(
            run.err.contains("standard output: "),
            "{arguments}: {}",
            run.err
        );
        assert_eq!(
            run.err.contains("the solid is complete in out.obj"),
            kept,
            "{arguments}: {}",
            run.err
        );
    }
    let again = scratch.run("sweep out.obj --translate 0,0,0");
    assert_eq!(
        again.code,
        Some(0),
        "the solid is complete, as the message says: {}",
        again.err
    );
}

#[cfg(unix)]
#[test]
fn an_interrupt_stops_within_a_second_and_leaves_no_file() {
    let scratch = Scratch::new("interrupt");
    let bracket = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/bracket.stl");
    // At a hundredth of a millimetre this sweep takes far longer than the test waits.
    let mut child = scratch
        .command(&format!(
            "sweep {bracket} --turn 300 --axis 1,2,3 --advance 20 --tolerance 1e-2 -o out.obj"
        ))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary must start");
    std::thread::sleep(Duration::from_millis(700));
    assert!(
        child.try_wait().expect("the binary can be asked").is_none(),
        "still at work"
    );
    command::interrupt(child);
    assert_eq!(
        scratch.files(),
        Vec::<String>::new(),
        "no file, whole or not"
    );
}

#[test]
fn a_process_can_run_the_tool_several_times() {
    let run = |threads: &str| {
        let command = ["steadysweep", "motion", "--translate", "1,2,3"];
        steadysweep::cli::run(command.into_iter().chain(["--threads", threads]))
    };
    assert_eq!(run("1"), std::process::ExitCode::SUCCESS);
    assert_eq!(run("2"), std::process::ExitCode::SUCCESS, "the second run");
}
