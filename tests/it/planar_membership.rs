//! Membership of points in moving planar bodies: against dense sampling in time, and against closed
//! forms.

#![allow(clippy::cast_possible_truncation, reason = "indices into small lists")]

use crate::support::command;
use crate::support::exponential::exponential;
use crate::support::random::Random;
use glam::{DAffine2, DMat2, DVec2};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use steadysweep::body::{FillRule, Polygon};
use steadysweep::membership::planar::Membership;
use steadysweep::motion::planar::{Generator, Keyframe, Motion, Span};

// ---- bodies and motions
// -----------------------------------------------------------------------------------------------

fn rectangle([low, high]: [[f64; 2]; 2]) -> Vec<DVec2> {
    [[low[0], low[1]], [high[0], low[1]], high, [low[0], high[1]]]
        .map(DVec2::from_array)
        .to_vec()
}

fn polygon(loops: Vec<Vec<DVec2>>) -> Polygon {
    Polygon::new(loops, FillRule::EvenOdd).expect("the outlines are bodies")
}

/// A star with random radii about a centre that is off the origin.
fn star(random: &mut Random) -> Polygon {
    let corners = 3 + (random.unit() * 20.0).floor() as u32;
    let centre = DVec2::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0));
    let corner = |i: u32| {
        let angle = TAU * f64::from(i) / f64::from(corners);
        centre + DVec2::from_angle(angle) * random.between(0.2, 1.0)
    };
    polygon(vec![(0..corners).map(corner).collect()])
}

fn bodies(random: &mut Random) -> Vec<(&'static str, Polygon)> {
    let frame = vec![
        rectangle([[-1.0, -0.5], [1.0, 0.5]]),
        rectangle([[-0.75, -0.25], [0.75, 0.25]]),
        rectangle([[-0.25, -0.125], [0.25, 0.125]]),
    ];
    let comb: Vec<DVec2> = (0..10)
        .flat_map(|i| {
            let x = 0.2 * f64::from(i);
            [DVec2::new(x, 1.0), DVec2::new(x + 0.1, 0.05)]
        })
        .rev()
        .chain([DVec2::ZERO, DVec2::new(2.0, 0.0)])
        .collect();
    vec![
        ("star", star(random)),
        ("island in a hole", polygon(frame)),
        ("comb", polygon(vec![comb])),
        (
            "needle",
            polygon(vec![rectangle([[0.0, 0.0], [3.0, 1e-3]])]),
        ),
    ]
}

fn motions(random: &mut Random) -> Vec<(&'static str, Motion)> {
    let through = DVec2::new(random.between(-2.0, 2.0), random.between(-2.0, 2.0));
    let mut one = |generator: Generator| {
        let span = Span::new(generator, random.between(0.5, 2.0)).expect("legal");
        Motion::from_spans(vec![span]).expect("legal")
    };
    let rows = |rows| Generator::from_rows(rows).expect("finite");
    let chain = [
        DAffine2::IDENTITY,
        DAffine2::from_angle_translation(2.0, DVec2::new(1.0, 0.5)),
        DAffine2 {
            matrix2: DMat2::from_angle(2.6) * DMat2::from_diagonal(DVec2::new(1.5, 0.75)),
            translation: DVec2::new(-1.0, 0.5),
        },
        DAffine2::from_angle_translation(1.0, DVec2::new(0.5, -2.0)),
    ];
    let keys: Vec<Keyframe> = (0_u8..)
        .zip(chain)
        .map(|(time, pose)| Keyframe {
            time: f64::from(time),
            pose,
        })
        .collect();
    vec![
        ("rest", one(Generator::translation(DVec2::ZERO))),
        ("translation", one(Generator::translation(through))),
        ("turn", one(Generator::spiral(through, 2.5, 1.0))),
        (
            "three turns",
            one(Generator::spiral(through, 6.0 * PI, 1.0)),
        ),
        ("half turn", one(Generator::spiral(through, PI, 1.0))),
        ("spiral", one(Generator::spiral(through, -4.0, 0.3))),
        ("shear", one(rows([[0.0, 1.5, 0.2], [0.0, 0.0, -0.3]]))),
        (
            "no symmetry",
            one(rows([[0.3, -1.7, 0.4], [2.0, -0.5, -0.7]])),
        ),
        ("chain", Motion::from_keyframes(&keys).expect("legal")),
    ]
}

// ---- the slow method ----------------------------------------------------------------------------

/// How many times the outlines wind around a point: the sum of the angles of their edges.
fn winding_number(body: &Polygon, point: DVec2) -> f64 {
    let angles = body.edges().map(|edge| {
        let [from, to] = edge.map(|corner| body.positions()[corner as usize] - point);
        from.perp_dot(to).atan2(from.dot(to))
    });
    (angles.sum::<f64>() / TAU).round()
}

/// Distance to the nearest edge.
fn distance(body: &Polygon, point: DVec2) -> f64 {
    let each = body.edges().map(|edge| {
        let [from, to] = edge.map(|corner| body.positions()[corner as usize]);
        let along = to - from;
        let share = ((point - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        point.distance(from + along * share)
    });
    each.fold(f64::INFINITY, f64::min)
}

/// World to body at equal steps of time, with exact exponentials.
fn sampled(motion: &Motion, samples: u32) -> Vec<(f64, DAffine2)> {
    let times = motion.joint_times();
    let mut all = Vec::new();
    for (k, span) in motion.spans().iter().enumerate() {
        let begin = motion.joints()[k] * *motion.start_pose();
        for i in 0..=samples {
            let s = f64::from(i) / f64::from(samples);
            let pose = exponential(span.flow().generator(), s) * begin;
            all.push((times[k] + s * (times[k + 1] - times[k]), pose.inverse()));
        }
    }
    all
}

/// World points: anywhere near the body, and on paths of its interior, corners and edges, at round
/// and random times.
fn points(body: &Polygon, motion: &Motion, random: &mut Random, count: usize) -> Vec<DVec2> {
    let times = motion.joint_times();
    let [first, last] = [times[0], times[times.len() - 1]];
    let [low, high] = body.bounds();
    let edges: Vec<[u32; 2]> = body.edges().collect();
    let mut all = Vec::new();
    for k in 0..count {
        let share = if k % 2 == 0 {
            (k % 20) as f64 / 20.0
        } else {
            random.unit()
        };
        let pose = motion.pose_at_time(first + share * (last - first));
        let edge = edges[(random.unit() * edges.len() as f64).floor() as usize];
        let [from, to] = edge.map(|corner| body.positions()[corner as usize]);
        let anywhere = DVec2::new(random.between(low.x, high.x), random.between(low.y, high.y));
        all.extend(
            [anywhere * 3.0, anywhere, from, from.lerp(to, random.unit())]
                .map(|point| pose.transform_point2(point)),
        );
    }
    all
}

/// Dense sampling and `intervals` must agree wherever the point is not within `close` of an edge.
fn check(
    name: &str,
    body: &Polygon,
    motion: &Motion,
    points: &[DVec2],
    samples: u32,
    close: f64,
) -> usize {
    let membership = Membership::new(body, motion);
    let all = membership.intervals_of(points);
    let sampled = sampled(motion, samples);
    let mut visits = 0;
    for (&point, intervals) in points.iter().zip(&all) {
        assert!(
            intervals.windows(2).all(|pair| pair[0][1] < pair[1][0]),
            "{name}: {intervals:?} of {point} are not disjoint and ascending"
        );
        for &(time, inverse) in &sampled {
            let seen = inverse.transform_point2(point);
            let found = intervals
                .iter()
                .any(|&[start, end]| start <= time && time <= end);
            let expected = winding_number(body, seen) >= 1.0;
            assert!(
                found == expected || distance(body, seen) <= close,
                "{name}: {point} at {time}, inside = {found}, seen at {seen}; {intervals:?}"
            );
        }
        assert_eq!(
            membership.is_ever_inside(point),
            !intervals.is_empty(),
            "{name}: {point}"
        );
        visits += intervals.len();
    }
    visits
}

#[test]
fn intervals_agree_with_dense_sampling() {
    let mut random = Random::from_state(1);
    for round in 0..3 {
        for (body_name, body) in bodies(&mut random) {
            for (motion_name, motion) in motions(&mut random) {
                let name = format!("{body_name}, {motion_name}, round {round}");
                let points = points(&body, &motion, &mut random, 20);
                let visits = check(&name, &body, &motion, &points, 150, 1e-9);
                assert!(visits > 40, "{name}: {visits} visits mean nothing");
            }
        }
    }
}

#[test]
fn many_random_stars_agree_with_dense_sampling() {
    let mut random = Random::from_state(2);
    for case in 0..150 {
        let body = star(&mut random);
        let mut motions = motions(&mut random);
        let (name, motion) = motions.swap_remove(case % motions.len());
        let points = points(&body, &motion, &mut random, 10);
        check(
            &format!("star {case}, {name}"),
            &body,
            &motion,
            &points,
            100,
            1e-9,
        );
    }
}

#[test]
fn units_and_distances_do_not_matter() {
    let mut random = Random::from_state(3);
    let body = star(&mut random);
    let turn = |through: DVec2| {
        let span = Span::new(Generator::spiral(through, 3.0, 0.7), 1.0).expect("legal");
        Motion::from_spans(vec![span]).expect("legal")
    };
    let points = points(&body, &turn(DVec2::X), &mut random, 20);
    for unit in [1e-3, 1.0, 1e6] {
        for away in [DVec2::ZERO, DVec2::new(1e3, -2e3)] {
            let place = |p: DVec2| (p + away) * unit;
            let moved = body.transformed(&DAffine2::from_scale_angle_translation(
                DVec2::splat(unit),
                0.0,
                away * unit,
            ));
            let points: Vec<DVec2> = points.iter().map(|&p| place(p)).collect();
            let name = format!("unit {unit}, {away}");
            let motion = turn(place(DVec2::X));
            check(&name, &moved, &motion, &points, 100, 1e-9 * unit);
        }
    }
}

// ---- closed forms
// -------------------------------------------------------------------------------------------------

fn single(generator: Generator) -> Motion {
    Motion::from_spans(vec![Span::new(generator, 1.0).expect("legal")]).expect("legal")
}

fn assert_intervals(found: &[[f64; 2]], expected: &[[f64; 2]], within: f64) {
    assert_eq!(found.len(), expected.len(), "{found:?}, not {expected:?}");
    for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!(
            (found - expected).abs() <= within,
            "{found} instead of {expected}"
        );
    }
}

#[test]
fn a_translation_gives_the_times_of_a_division() {
    let body = polygon(vec![
        rectangle([[0.0, 0.0], [1.0, 1.0]]),
        rectangle([[0.25, 0.25], [0.5, 0.75]]),
    ]);
    let membership = Membership::new(&body, &single(Generator::translation(DVec2::X * 4.0)));
    // The hole passes between the two halves.
    assert_intervals(
        &membership.intervals(DVec2::new(3.0, 0.5)),
        &[[0.5, 0.625], [0.6875, 0.75]],
        1e-15,
    );
    // Along the lower side: inside while the side is there.
    assert_intervals(
        &membership.intervals(DVec2::new(3.0, 0.0)),
        &[[0.5, 0.75]],
        1e-13,
    );
    assert!(
        membership.intervals(DVec2::new(3.0, -1e-12)).is_empty(),
        "just beside it"
    );
    assert!(
        !membership.is_ever_inside(DVec2::new(f64::NAN, 0.0)),
        "no number, no place"
    );
}

#[test]
fn a_square_that_spins_about_its_centre_reaches_its_corners_four_times() {
    let body = polygon(vec![rectangle([[-1.0, -1.0], [1.0, 1.0]])]);
    let membership = Membership::new(&body, &single(Generator::spiral(DVec2::ZERO, TAU, 1.0)));
    // At distance r the point is inside while a corner direction is within acos(1/r) .. : cos(angle
    // to the nearest side) r <= 1.
    let r = 1.2;
    let half = FRAC_PI_2 / 2.0 - (1.0_f64 / r).acos();
    let expected: Vec<[f64; 2]> = (0..4)
        .map(|k| {
            let middle = FRAC_PI_2 / 2.0 + FRAC_PI_2 * f64::from(k);
            [(middle - half) / TAU, (middle + half) / TAU]
        })
        .collect();
    assert_intervals(&membership.intervals(DVec2::X * r), &expected, 1e-12);
    // On the circle of the corners it is touched; beyond it, it never is.
    let touched = membership.intervals(DVec2::X * 2.0_f64.sqrt());
    assert_eq!(touched.len(), 4, "{touched:?}");
    assert!(
        !membership.is_ever_inside(DVec2::X * (2.0_f64.sqrt() + 1e-9)),
        "beyond"
    );
    assert_eq!(
        membership.intervals(DVec2::new(0.3, 0.2)),
        [[0.0, 1.0]],
        "always inside"
    );
}

#[test]
fn intervals_are_merged_across_joints() {
    let body = polygon(vec![rectangle([[0.0, 0.0], [4.0, 1.0]])]);
    let spans = [1.0, 0.5, 2.0]
        .map(|duration| Span::new(Generator::translation(DVec2::X), duration).expect("legal"));
    let motion = Motion::from_spans(spans.to_vec()).expect("legal");
    let membership = Membership::new(&body, &motion);
    assert_intervals(
        &membership.intervals(DVec2::new(4.5, 0.5)),
        &[[0.5, 3.5]],
        1e-15,
    );
    assert_intervals(
        &membership.intervals(DVec2::new(0.5, 0.5)),
        &[[0.0, 0.5]],
        1e-15,
    );
}

// ---- the binary
// -------------------------------------------------------------------------------------------------

const SQUARE: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 10 10"><rect x="0" y="0" width="1" height="1"/></svg>"#;

#[test]
fn the_command_tells_the_times_of_points_in_the_plane() {
    let scratch = command::Scratch::new("planar_probe");
    scratch.write("square.svg", SQUARE);
    scratch.write("points.csv", "x,y\n2.5,0.5\n9,9\n");
    let run = scratch.run("probe square.svg --translate 4,0 --points points.csv --json");
    assert_eq!(run.code, Some(0), "{}", run.err);
    let report: serde_json::Value = serde_json::from_str(&run.out).expect("one JSON object");
    let points = &report["points"];
    assert_eq!(points[0]["inside"], true);
    assert_eq!(points[0]["intervals"], serde_json::json!([[0.375, 0.625]]));
    assert_eq!(points[1]["inside"], false);
    assert_eq!(report["flattening"], 0.0, "nothing is curved");
    let text = scratch
        .run("probe square.svg --turn 90 --points points.csv")
        .out;
    assert!(text.contains("0 of 2 points ever inside"), "{text}");
}

#[test]
fn what_belongs_to_space_does_not_fit_a_drawing() {
    let scratch = command::Scratch::new("space_for_drawing");
    scratch.write("square.svg", SQUARE);
    scratch.write("plane.csv", "0,0\n");
    scratch.write("space.csv", "0,0,0\n");
    scratch.write(
        "space.json",
        r#"{"spans": [{"turn_deg": 90, "axis": [0,0,1]}]}"#,
    );
    let cases = [
        (
            "--translate 1,0,0 --points plane.csv",
            "--translate has three numbers",
        ),
        (
            "--turn 90 --axis 0,0,1 --points plane.csv",
            "--axis belongs to a motion in space",
        ),
        (
            "--turn 90 --advance 1 --points plane.csv",
            "--advance belongs to a motion in space",
        ),
        (
            "--turn 90 --through 0,0,0 --points plane.csv",
            "--through has three numbers",
        ),
        (
            "--motion space.json --points plane.csv",
            "a drawing needs one in the plane",
        ),
        (
            "--turn 90 --points space.csv",
            "points of a drawing have two coordinates",
        ),
    ];
    for (options, expected) in cases {
        let run = scratch.run(&format!("probe square.svg {options}"));
        assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{options}");
        assert!(run.err.contains(expected), "{options}: {}", run.err);
    }
}
