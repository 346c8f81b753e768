//! Points as obstacles: against closed forms, the times that points spend inside the body, and the
//! command line.

use crate::support::command::{CUBE, Scratch};
use crate::support::random::Random;
use crate::support::shapes::{cuboid, torus};
use crate::support::sweep::{mesh, screw};
use glam::DVec3;
use serde_json::{Value, json};
use std::fmt::Write;
use steadysweep::body::{Mesh, Surface};
use steadysweep::collision::{
    Check, CheckSettings, ContactRule, Feature, Obstacle, Touch, Verdict, check,
};
use steadysweep::membership::Membership;
use steadysweep::motion::{Generator, Motion, Span};

fn chain(spans: &[Generator]) -> Motion {
    let spans = spans
        .iter()
        .map(|&generator| Span::new(generator, 1.0).expect("a span"));
    Motion::from_spans(spans.collect()).expect("a motion")
}

fn checked(body: &Mesh, motion: &Motion, points: &[DVec3], settings: &CheckSettings) -> Check {
    let cloud = Surface::of_points(points.to_vec()).expect("points");
    let obstacle = Obstacle {
        surface: &cloud,
        motion: None,
    };
    check(body, motion, &[obstacle], settings).expect("a check")
}

#[test]
fn a_cube_that_slides_meets_the_first_point_in_its_path() {
    let body = mesh(&cuboid(DVec3::ZERO, DVec3::ONE));
    let motion = chain(&[Generator::translation(DVec3::X * 4.0)]);
    let mut random = Random::new(5);
    for count in [1, 7, 300] {
        let points: Vec<DVec3> = (0..count)
            .map(|_| {
                let x = random.between(1.01, 6.0);
                DVec3::new(x, random.between(-3.0, 4.0), random.between(-3.0, 4.0))
            })
            .collect();
        // The time at which the front side gets to a point beside which it does not pass.
        let is_ahead = |p: &DVec3| (0.0..=1.0).contains(&p.y) && (0.0..=1.0).contains(&p.z);
        let expected = (0..)
            .zip(&points)
            .filter(|(_, p)| is_ahead(p))
            .map(|(i, p)| ((p.x - 1.0) / 4.0, i))
            .filter(|(time, _)| *time <= 1.0)
            .min_by(|a, b| a.0.total_cmp(&b.0));
        // The least distance from the box that the cube sweeps.
        let swept = DVec3::new(5.0, 1.0, 1.0);
        let distance = |p: &DVec3| (*p - p.clamp(DVec3::ZERO, swept)).length();
        let least = points.iter().map(distance).fold(f64::INFINITY, f64::min);
        let found = checked(&body, &motion, &points, &CheckSettings::default());
        match (found.verdict, expected) {
            (Verdict::Contact(first), Some((time, point))) => {
                assert_eq!(first.features[1], Feature::Vertex(point));
                assert!(matches!(first.features[0], Feature::Face(_)), "{first:?}");
                assert!((first.time - time).abs() < 1e-9, "{first:?} at {time}");
                assert!(
                    first.bracket[0] <= time && time <= first.bracket[1] + 1e-12,
                    "{first:?}"
                );
                assert!((first.normal + DVec3::X).length() < 1e-9, "{first:?}");
            }
            (Verdict::Clear, None) => {
                let clearance = found.clearance;
                assert!(
                    clearance.lower <= least && least <= clearance.upper + 1e-9,
                    "{clearance:?}"
                );
                assert!(clearance.lower >= 0.998 * least, "{clearance:?} of {least}");
            }
            other => panic!("{other:?}"),
        }
    }
    // Inside at the start, though no face is near.
    let points = [DVec3::splat(0.5), DVec3::splat(9.0)];
    let found = checked(&body, &motion, &points, &CheckSettings::default());
    let Verdict::Contact(first) = found.verdict else {
        panic!("{found:?}")
    };
    assert_eq!((first.time, first.touch), (0.0, Touch::Inside));
    assert_eq!(first.features[1], Feature::Vertex(0), "{first:?}");
    // The point may be touched, and lies in the body 0.5 deep at (0.5 - x) / 4 before.
    let points = [DVec3::new(3.0, 0.5, 0.5)];
    let rules = vec![ContactRule::Enter { depth: Some(0.25) }];
    let settings = CheckSettings::default().with_rules(rules);
    let found = checked(&body, &motion, &points, &settings);
    let Verdict::Contact(first) = found.verdict else {
        panic!("{found:?}")
    };
    assert!((first.time - 2.25 / 4.0).abs() < 1e-9, "{first:?}");
    assert_eq!(first.features[1], Feature::Vertex(0), "{first:?}");
}

#[test]
fn clouds_are_met_when_their_points_get_inside_the_body() {
    let body = mesh(&torus(2.0, 0.5, 24, 12));
    let motion = chain(&[
        screw(DVec3::X, DVec3::ZERO, 2.0, 1.0, 1.0),
        screw(DVec3::Y, DVec3::X * 3.0, 1.5, 0.5, 0.8),
    ]);
    let membership = Membership::new(&body, &motion);
    let mut random = Random::new(77);
    let (mut met, mut clear) = (0, 0);
    for case in 0..120 {
        let size = if case % 2 == 0 { 3 } else { 30 };
        let centre = random.point(4.0);
        let points: Vec<DVec3> = (0..size).map(|_| centre + random.point(0.8)).collect();
        let times = |point: &DVec3| membership.intervals(*point);
        let expected = points
            .iter()
            .flat_map(times)
            .map(|interval| interval[0])
            .fold(f64::INFINITY, f64::min);
        let settings = CheckSettings::default().with_all_intervals();
        let found = checked(&body, &motion, &points, &settings);
        match found.verdict {
            Verdict::Contact(first) => {
                met += 1;
                assert!(
                    (first.time - expected).abs() < 1e-8,
                    "{first:?} at {expected}"
                );
                let Feature::Vertex(point) = first.features[1] else {
                    panic!("{first:?}")
                };
                let own = times(&points[point as usize]);
                assert!((own[0][0] - expected).abs() < 1e-8, "{first:?}: {own:?}");
                let intervals = found.intervals.expect("asked for");
                for (point, [start, end]) in points
                    .iter()
                    .flat_map(|p| times(p).into_iter().map(move |interval| (p, interval)))
                {
                    let middle = start.midpoint(end);
                    let covers = |i: &[f64; 2]| i[0] <= middle && middle <= i[1];
                    assert!(
                        intervals.iter().any(|interval| covers(&interval.times)),
                        "{point} is inside at {middle}: {intervals:?}"
                    );
                }
            }
            Verdict::Clear => {
                clear += 1;
                assert_eq!(expected, f64::INFINITY, "case {case}");
            }
            other => panic!("{other:?}"),
        }
    }
    assert!(met > 15 && clear > 10, "{met} met, {clear} clear");
}

#[test]
fn clouds_are_read_from_ply_and_csv() {
    let scratch = Scratch::new("point_clouds");
    scratch.write("cube.obj", CUBE);
    let points = [[9.0, 9.0, 9.0], [3.0, 0.5, 0.5], [2.0, 0.25, 0.5]];
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\nend_header\n";
    let (mut ply, mut csv) = (header.to_owned(), "x,y,z\n".to_owned());
    for [x, y, z] in points {
        writeln!(ply, "{x} {y} {z}").expect("a string takes everything");
        writeln!(csv, "{x},{y},{z}").expect("a string takes everything");
    }
    scratch.write("cloud.ply", ply);
    scratch.write("cloud.csv", csv);
    scratch.write("far.csv", "9,9,9\n");
    scratch.write("none.csv", "x,y,z\n");
    scratch.write("torn.csv", "1,2,3\n4,5\n");
    for file in ["cloud.ply", "cloud.csv"] {
        let run = scratch.run(&format!(
            "check cube.obj --translate 4,0,0 --against {file} far.csv --json"
        ));
        assert_eq!((run.code, run.err.as_str()), (Some(1), ""), "{file}");
        let report: Value = serde_json::from_str(&run.out).expect("JSON");
        assert_eq!(report["features"]["obstacle"], json!({"vertex": 2}));
        assert_eq!(
            report["obstacle"],
            json!({"file": file, "plane": null, "index": 0})
        );
        let time = report["time"].as_f64().expect("a time");
        assert!((time - 0.25).abs() < 1e-9, "{report}");
        let obstacle = &report["obstacles"][0];
        assert_eq!(
            (&obstacle["points"], &obstacle["triangles"]),
            (&json!(3), &json!(0))
        );
        assert_eq!(obstacle["closed"], json!(false));
        let text = scratch
            .run(&format!(
                "check cube.obj --translate 4,0,0 --against {file}"
            ))
            .out;
        for part in [
            format!("against {file}: 3 points\n"),
            format!("meets vertex 2 of {file}"),
        ] {
            assert!(text.contains(&part), "{part:?} is missing: {text}");
        }
        let stem = "check cube.obj --translate 1,0,0 --against";
        let text = scratch.run(&format!("{stem} {file} --touching cloud")).out;
        assert!(text.contains("CLEAR"), "{text}");
    }
    for (file, expected) in [
        ("none.csv", "none.csv: "),
        ("torn.csv", "line 2"),
        ("missing.csv", "missing.csv"),
    ] {
        let run = scratch.run(&format!(
            "check cube.obj --translate 4,0,0 --against {file}"
        ));
        assert_eq!(run.code, Some(2), "{file}: {}", run.out);
        assert!(run.err.contains(expected), "{file}: {}", run.err);
    }
}
