//! The region swept by lines: closed forms, and the path of each point against the lines, step by
//! step, without any winding number.

use crate::support::command::{CUBE, Scratch};
use crate::support::planar::{depth, exponential, motion};
use crate::support::random::pseudo_random;
use glam::{DAffine2, DVec2};
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};
use steadysweep::motion::planar::{Generator, Motion};
use steadysweep::planar::{Polylines, Sweep, SweepError, SweepSettings, sweep_lines};

fn lines(corners: &[&[[f64; 2]]]) -> Polylines {
    let line = |line: &&[[f64; 2]]| line.iter().map(|&c| DVec2::from_array(c)).collect();
    Polylines::new(corners.iter().map(line).collect()).expect("lines")
}

fn swept(lines: &Polylines, motion: &Motion, tolerance: f64) -> Sweep {
    let settings = SweepSettings::default().with_tolerance(tolerance);
    let sweep = sweep_lines(lines, motion, &settings).expect("they sweep an area");
    let bound = sweep.error_bound;
    assert!(bound.inside.proven && bound.outside.proven, "{bound:?}");
    sweep
}

/// Checks an area against the exact one, with the error that the bounds allow along the border.
#[track_caller]
fn check_area(sweep: &Sweep, area: f64, pieces: usize, holes: usize) {
    let bound = sweep.error_bound;
    let error = bound.inside.length.max(bound.outside.length);
    let allowed = 1.1 * sweep.measures.perimeter * error + 1e-12;
    let found = sweep.measures.area;
    assert!(
        (found - area).abs() <= allowed,
        "{found} instead of {area} +- {allowed}"
    );
    let measures = (sweep.measures.pieces, sweep.measures.holes);
    assert_eq!(measures, (pieces, holes), "pieces and holes");
}

#[test]
fn a_segment_sweeps_parallelograms_and_sectors() {
    let segment = lines(&[&[[0.0, 0.0], [2.0, 0.0]]]);
    let across = motion(&[Generator::translation(DVec2::new(0.7, 1.5))]);
    check_area(&swept(&segment, &across, 1e-3), 3.0, 1, 0);
    // Forth and back: crossings in opposite senses must not cancel.
    let back = motion(&[
        Generator::translation(DVec2::new(0.7, 1.5)),
        Generator::translation(DVec2::new(-0.7, -1.5)),
    ]);
    check_area(&swept(&segment, &back, 1e-3), 3.0, 1, 0);
    // About a point on the segment: one part moves up, the other one down.
    let about = |x: f64, turn| motion(&[Generator::spiral(DVec2::new(x, 0.0), turn, 1.0)]);
    check_area(&swept(&segment, &about(1.0, PI), 1e-4), PI, 1, 0);
    let sectors = (0.25 + 2.25) * 0.4;
    check_area(&swept(&segment, &about(0.5, 0.8), 1e-4), sectors, 2, 0);
    // About a point beside it: an annulus from the foot of the centre, 0.5 away, to the far end.
    let beside = motion(&[Generator::spiral(DVec2::new(0.5, -0.5), TAU, 1.0)]);
    check_area(&swept(&segment, &beside, 1e-4), PI * (2.5 - 0.25), 1, 1);
}

#[test]
fn the_inside_of_a_closed_line_does_not_count() {
    let square = lines(&[&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.0]]]);
    assert_eq!(square.closed(), 1, "closed");
    // Each of the four sides sweeps a strip of width 1; at a corner outside two of them end in a
    // triangle, inside they overlap in a square.
    let way = motion(&[Generator::translation(DVec2::ONE)]);
    let sweep = swept(&square, &way, 1e-3);
    // The hull of both squares, without the square that stays inside.
    check_area(&sweep, (25.0 - 1.0) - 9.0, 1, 1);
}

#[test]
fn lines_that_only_move_along_themselves_sweep_no_area() {
    let segment = lines(&[&[[0.0, 0.0], [2.0, 1.0]]]);
    let along = motion(&[Generator::translation(DVec2::new(4.0, 2.0))]);
    let error = sweep_lines(&segment, &along, &SweepSettings::default()).expect_err("no area");
    assert_eq!(error, SweepError::NoArea, "{error}");
    // The horizontal arm of an L slides along itself and out of what the other arm sweeps.
    let angle = lines(&[&[[0.0, 1.0], [0.0, 0.0], [3.0, 0.0]]]);
    let slide = motion(&[Generator::translation(DVec2::new(1.0, 0.0))]);
    let sweep = swept(&angle, &slide, 1e-3);
    assert!(
        (sweep.measures.area - 1.0).abs() < 1e-9,
        "the other arm alone"
    );
    let lacks = sweep.error_bound.inside.length;
    assert!(
        (3.0..3.01).contains(&lacks),
        "up to (4, 0), 3 from the square: {lacks}"
    );
    assert_eq!(sweep.attempts, 1, "finer sampling would not help");
}

/// Whether segments cross, or touch.
fn cross([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let side = |from: DVec2, to: DVec2, p: DVec2| (to - from).perp_dot(p - from);
    side(a, b, c) * side(a, b, d) <= 0.0 && side(c, d, a) * side(c, d, b) <= 0.0
}

/// The world as seen from the lines, at equal steps of a chain of generators.
fn inverses(generators: &[Generator], steps: u32) -> Vec<DAffine2> {
    let mut start = DAffine2::IDENTITY;
    let mut inverses = Vec::new();
    for generator in generators {
        for step in 0..=steps {
            let pose = exponential(generator, f64::from(step) / f64::from(steps)) * start;
            inverses.push(pose.inverse());
        }
        start = exponential(generator, 1.0) * start;
    }
    inverses
}

#[test]
fn random_lines_cover_what_crosses_them() {
    let mut random = pseudo_random(77);
    let mut next = move || 2.0 * random.next().expect("endless") - 1.0;
    let (mut inside, mut outside) = (0, 0);
    for case in 0..24 {
        let mut line = |corners: u32| -> Vec<DVec2> {
            (0..corners).map(|_| DVec2::new(next(), next())).collect()
        };
        // A segment, a zigzag that crosses itself, two lines, a closed line.
        let given = match case % 4 {
            0 => vec![line(2)],
            1 => vec![line(6)],
            2 => vec![line(3), line(2)],
            _ => {
                let mut corners = line(4);
                corners.push(corners[0]);
                vec![corners]
            }
        };
        let mut generator = || {
            let rows = [
                [next(), 2.0 * next(), next()],
                [2.0 * next(), next(), next()],
            ];
            Generator::from_rows(rows).expect("finite")
        };
        let generators: Vec<Generator> = (0..1 + case % 3).map(|_| generator()).collect();
        let body = Polylines::new(given.clone()).expect("lines");
        let sweep = swept(&body, &motion(&generators), 2e-3);
        let seen = inverses(&generators, 1500);
        let loops: Vec<Vec<DVec2>> = sweep.loops().collect();
        let [low, high] = sweep.measures.bounds;
        let margin = 0.1 * (high - low);
        for _ in 0..150 {
            let share = DVec2::new(next(), next()) * 0.5 + 0.5;
            let point = low - margin + (high - low + 2.0 * margin) * share;
            let path: Vec<DVec2> = seen
                .iter()
                .map(|inverse| inverse.transform_point2(point))
                .collect();
            let is_crossed = path.windows(2).any(|step| {
                let edges = given.iter().flat_map(|corners| corners.windows(2));
                edges
                    .into_iter()
                    .any(|edge| cross([step[0], step[1]], [edge[0], edge[1]]))
            });
            let depth = depth(loops.iter(), point);
            // A step of the path is off its chord by 1e-5 at most, which the growth of the motion
            // multiplies by less than 100.
            let bound = sweep.error_bound;
            if depth > bound.outside.length + 1e-3 {
                assert!(
                    is_crossed,
                    "case {case}: {point}, {depth} inside, is never crossed"
                );
                inside += 1;
            } else if depth < -(bound.inside.length + 1e-3) {
                assert!(
                    !is_crossed,
                    "case {case}: {point}, {depth} outside, is crossed"
                );
                outside += 1;
            }
        }
    }
    assert!(inside > 500 && outside > 500, "{inside} {outside}");
}

const HOOK: &str = "<svg xmlns='http://www.w3.org/2000/svg' width='9mm' height='9mm' viewBox='0 0 9 9'>\
                    <path d='M0,0 L3,0 A1,1 0 0 1 3,2'/></svg>\n";

#[test]
fn the_command_sweeps_open_paths() {
    let scratch = Scratch::new("planar_lines");
    scratch.write("hook.svg", HOOK);
    let refused = scratch.run("sweep hook.svg --translate 0,-2");
    assert_eq!(
        refused.code,
        Some(2),
        "without --surface, an open outline is refused"
    );
    let run = scratch.run("sweep hook.svg --translate 0,-2 --surface --json -o out.svg");
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{}", run.out);
    let report: Value = serde_json::from_str(&run.out).expect("a report");
    let body = &report["body"];
    assert_eq!(
        (&body["lines"], &body["closed"]),
        (&json!(1), &json!(0)),
        "{body}"
    );
    assert_eq!(body["units"], "mm", "{body}");
    let number = |value: &Value| value.as_f64().expect("a number");
    assert!(
        (number(&body["length"]) - (3.0 + PI)).abs() < 1e-3,
        "{body}"
    );
    // The straight part sweeps 3 x 2; the half circle on its right moves along its own height: a
    // strip of 1 x 2 and, above and below it, half of the disc in all.
    let expected = 6.0 + 2.0 + PI / 2.0;
    let area = number(&report["sweep"]["area"]);
    assert!(
        (area - expected).abs() < 0.02,
        "{area} instead of {expected}"
    );
    let text = scratch.run("sweep hook.svg --translate 0,-2 --surface").out;
    assert!(text.starts_with("lines   1 line, 0 closed, "), "{text}");
    let picture = std::fs::read_to_string(scratch.path().join("out.svg")).expect("there");
    assert!(picture.contains("body at the start"), "{picture}");
}

#[test]
fn options_that_need_an_inside_or_a_drawing_are_refused() {
    let scratch = Scratch::new("planar_lines_refused");
    scratch.write("hook.svg", HOOK);
    scratch.write("cube.obj", CUBE);
    for (arguments, part) in [
        (
            "sweep cube.obj --translate 0,0,1 --surface --dump stages",
            "--dump is for a body, but --surface takes cube.obj without an inside",
        ),
        (
            "sweep hook.svg --translate 0,1 --surface --grazing out.csv",
            "--grazing is for a body, but --surface takes hook.svg without an inside",
        ),
        (
            "sweep hook.svg --translate 0,1 --surface --close-gaps 9",
            "--close-gaps is for a body",
        ),
        (
            "sweep hook.svg --translate 0,0 --surface -o out.svg",
            "the lines sweep no area: they rest, or move along themselves",
        ),
    ] {
        let before = scratch.files();
        let run = scratch.run(arguments);
        assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{arguments}");
        assert!(run.err.contains(part), "{part:?} in {}", run.err);
        assert_eq!(scratch.files(), before, "no file: {arguments}");
    }
}
