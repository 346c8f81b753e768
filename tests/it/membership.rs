//! Membership of points in moving bodies: against dense sampling in time, and against closed forms.

#![allow(clippy::cast_possible_truncation, reason = "indices into small lists")]

use crate::support::membership::Sampled;
use crate::support::random::pseudo_random;
use crate::support::shapes::{self, Shape};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use std::slice;
use steadysweep::body::Mesh;
use steadysweep::membership::Membership;
use steadysweep::motion::{Generator, Keyframe, Motion, Span};

fn mesh(shape: &Shape) -> Mesh {
    Mesh::new(shape.0.clone(), shape.1.clone()).expect("the shapes are bodies")
}

fn motion(generators: &[Generator]) -> Motion {
    let spans = generators
        .iter()
        .map(|&generator| Span::new(generator, 1.0).expect("finite"))
        .collect();
    Motion::from_spans(spans).expect("a legal motion")
}

fn screw(axis: DVec3, through: DVec3, degrees: f64, advance: f64, scale: f64) -> Generator {
    Generator::screw(
        axis.normalize(),
        through,
        degrees.to_radians(),
        advance,
        scale,
    )
}

fn shear() -> Generator {
    Generator {
        linear: DMat3::from_cols(DVec3::ZERO, DVec3::new(1.5, 0.0, 0.0), DVec3::ZERO),
        offset: DVec3::new(0.0, 0.3, 0.2),
    }
}

/// No symmetry at all: rotation, strain and shear of comparable size.
fn general() -> Generator {
    let linear = DMat3::from_cols(
        DVec3::new(0.3, 2.0, -0.4),
        DVec3::new(-1.7, -0.5, 0.6),
        DVec3::new(0.2, -0.9, 0.1),
    );
    Generator {
        linear,
        offset: DVec3::new(0.4, -0.7, 0.5),
    }
}

fn in_box([min, max]: [DVec3; 2], numbers: &mut impl Iterator<Item = f64>) -> DVec3 {
    let mut number = || numbers.next().expect("endless");
    min + (max - min) * DVec3::new(number(), number(), number())
}

/// World points for a moving shape: anywhere near it, on paths of its interior, and on paths of its
/// vertices, edges and faces at round and random times.
fn points(shape: &Shape, motion: &Motion, count: usize) -> Vec<DVec3> {
    let mut numbers = pseudo_random(count as u64 + 17);
    let end = *motion.joint_times().last().expect("there is a clock");
    let poses: Vec<DAffine3> = (0..=20)
        .map(|i| motion.pose_at_time(end * f64::from(i) / 20.0))
        .collect();
    let empty = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let bounds = |[min, max]: [DVec3; 2], p: DVec3| [min.min(p), max.max(p)];
    let at_rest = shape.0.iter().copied().fold(empty, bounds);
    let moved = poses
        .iter()
        .flat_map(|pose| shape.0.iter().map(|&p| pose.transform_point3(p)))
        .fold(empty, bounds);
    let mut all = Vec::new();
    for k in 0..count {
        let pose = if k % 2 == 0 {
            poses[k / 2 % 21]
        } else {
            motion.pose_at_time(end * numbers.next().expect("endless"))
        };
        let triangle = shape.1[(numbers.next().expect("endless") * shape.1.len() as f64) as usize]
            .map(|corner| shape.0[corner as usize]);
        let (u, v) = (
            numbers.next().expect("endless"),
            numbers.next().expect("endless"),
        );
        all.extend([
            in_box(moved, &mut numbers),
            pose.transform_point3(in_box(at_rest, &mut numbers)),
            pose.transform_point3(triangle[0]),
            pose.transform_point3(triangle[0].lerp(triangle[1], u)),
            pose.transform_point3(triangle[0].lerp(triangle[1], u).lerp(triangle[2], v)),
        ]);
    }
    all
}

/// Dense sampling and `intervals` must agree wherever the point is not within 1e-9 of the size from
/// the surface.
fn compare(name: &str, shape: &Shape, motion: &Motion, count: usize) {
    compare_within(name, shape, motion, count, 1e-9);
}

fn compare_within(name: &str, shape: &Shape, motion: &Motion, count: usize, relative: f64) {
    let membership = Membership::new(&mesh(shape), motion);
    let sampled = Sampled::new(shape, motion, 300);
    let size = shape.0.iter().map(|p| p.length()).fold(0.0, f64::max);
    let mut visits = 0;
    let points = points(shape, motion, count);
    let all = membership.intervals_of(&points);
    for (&point, intervals) in points.iter().zip(&all) {
        sampled.check(point, intervals, relative * size);
        assert_eq!(
            membership.is_ever_inside(point),
            !intervals.is_empty(),
            "{name}: {point:?}"
        );
        visits += intervals.len();
    }
    assert!(
        visits > count,
        "{name}: too few visits to mean anything, {visits}"
    );
}

fn bodies() -> Vec<(&'static str, Shape)> {
    let away = |shape: Shape| shapes::mapped(shape, |p| p + DVec3::new(0.8, 0.1, -0.2));
    vec![
        (
            "box",
            away(shapes::cuboid(
                DVec3::splat(-0.5),
                DVec3::new(0.5, 0.25, 0.75),
            )),
        ),
        ("ball", away(shapes::icosphere(1, 0.5, DVec3::ZERO))),
        ("torus", away(shapes::torus(0.6, 0.2, 12, 6))),
        ("u", away(shapes::u_prism(0.2, 0.5))),
        (
            "hole",
            away(shapes::box_with_hole(DVec3::new(1.0, 0.8, 0.3), 0.2)),
        ),
        (
            "hollow",
            away(shapes::hollow_box(DVec3::splat(1.0), DVec3::splat(0.6))),
        ),
    ]
}

fn motions() -> Vec<(&'static str, Motion)> {
    let axis = DVec3::new(1.0, 2.0, 3.0);
    let through = DVec3::new(0.1, -0.2, 0.3);
    vec![
        (
            "screw of 540 degrees",
            motion(&[screw(axis, through, 540.0, 1.5, 1.0)]),
        ),
        ("spiral", motion(&[screw(axis, through, 200.0, 0.5, 0.4)])),
        ("shear", motion(&[shear()])),
        ("general", motion(&[general()])),
        (
            "full turn",
            motion(&[screw(DVec3::Z, DVec3::ZERO, 360.0, 0.0, 1.0)]),
        ),
        (
            "spin through itself",
            motion(&[screw(DVec3::Z, DVec3::new(0.9, 0.2, 0.0), 290.0, 0.2, 1.0)]),
        ),
        ("identity", motion(&[Generator::translation(DVec3::ZERO)])),
        (
            "translation",
            motion(&[Generator::translation(DVec3::new(0.3, 0.7, -0.2))]),
        ),
        (
            "chain of three",
            motion(&[
                screw(DVec3::Z, DVec3::ZERO, 90.0, 0.3, 1.0),
                Generator::translation(DVec3::new(-0.5, 0.0, 0.5)),
                screw(axis, through, -150.0, 0.0, 0.7),
            ]),
        ),
    ]
}

#[test]
fn intervals_agree_with_dense_sampling_for_every_body_and_motion() {
    for (body_name, shape) in &bodies() {
        for (motion_name, motion) in &motions() {
            compare(&format!("{body_name}, {motion_name}"), shape, motion, 12);
        }
    }
}

#[test]
fn a_body_of_thousands_of_triangles_agrees_with_dense_sampling() {
    let shape = shapes::mapped(shapes::bumpy_sphere(2_000), |p| p + DVec3::X);
    let turn = motion(&[screw(DVec3::Z, DVec3::ZERO, 180.0, 2.0, 1.0)]);
    compare("bumpy sphere", &shape, &turn, 12);
}

#[test]
fn a_box_agrees_with_twenty_thousand_samples_per_span() {
    let (min, max) = (DVec3::new(0.4, -0.5, -0.3), DVec3::new(1.4, 0.25, 0.5));
    let shape = shapes::cuboid(min, max);
    for (name, motion) in &motions() {
        let membership = Membership::new(&mesh(&shape), motion);
        let sampled = Sampled::new(&shape, motion, 20_000);
        for point in points(&shape, motion, 40) {
            let is_inside = |seen: DVec3| seen.cmpge(min).all() && seen.cmple(max).all();
            let intervals = membership.intervals(point);
            sampled.check_with(point, &intervals, 1e-9, is_inside);
            assert!(
                intervals.iter().all(|[start, end]| start <= end),
                "{name}: {intervals:?}"
            );
        }
    }
}

#[track_caller]
fn assert_intervals(found: &[[f64; 2]], expected: &[[f64; 2]], tolerance: f64) {
    let near = found.len() == expected.len()
        && found
            .iter()
            .flatten()
            .zip(expected.iter().flatten())
            .all(|(a, b)| (a - b).abs() <= tolerance);
    assert!(
        near,
        "found {found:?}, expected {expected:?} to {tolerance:e}"
    );
}

#[test]
fn a_translated_box_is_entered_and_left_at_the_times_of_its_planes() {
    let shape = shapes::cuboid(DVec3::ZERO, DVec3::ONE);
    let path = motion(&[Generator::translation(DVec3::new(4.0, 1.0, 0.0))]);
    let membership = Membership::new(&mesh(&shape), &path);
    // Relative to the box, the point moves by -(4, 1, 0) t.
    let cases = [
        (DVec3::new(3.0, 0.75, 0.5), vec![[0.5, 0.75]]),
        (DVec3::new(0.5, 0.5, 0.5), vec![[0.0, 0.125]]),
        (DVec3::new(4.5, 1.5, 0.5), vec![[0.875, 1.0]]),
        (DVec3::new(3.0, 0.4, 0.5), vec![]),
        (DVec3::new(4.0, 1.5, 0.5), vec![[0.75, 1.0]]),
        (DVec3::new(3.0, 0.75, 1.1), vec![]),
    ];
    for (point, expected) in &cases {
        assert_intervals(&membership.intervals(*point), expected, 1e-14);
        assert_eq!(
            membership.is_ever_inside(*point),
            !expected.is_empty(),
            "{point}"
        );
    }
}

#[test]
fn sliding_and_touching_count_as_inside() {
    let shape = shapes::cuboid(DVec3::ZERO, DVec3::ONE);
    let path = motion(&[Generator::translation(DVec3::new(2.0, 0.0, 0.0))]);
    let membership = Membership::new(&mesh(&shape), &path);
    let cases = [
        ("along a face", DVec3::new(1.0, 0.25, 1.0), [0.0, 0.5]),
        ("along an edge", DVec3::new(2.0, 1.0, 1.0), [0.5, 1.0]),
        (
            "across the diagonals of the faces",
            DVec3::new(2.0, 0.5, 0.5),
            [0.5, 1.0],
        ),
        (
            "from the first moment on only",
            DVec3::new(0.0, 0.5, 0.5),
            [0.0, 0.0],
        ),
        (
            "from the last moment on only",
            DVec3::new(3.0, 0.5, 0.5),
            [1.0, 1.0],
        ),
    ];
    for (name, point, expected) in cases {
        println!("{name}");
        assert_intervals(&membership.intervals(point), &[expected], 1e-13);
    }
    // An edge is touched in passing: the body moves along a diagonal, with the corner edge in
    // front.
    let path = motion(&[Generator::translation(DVec3::new(2.0, -2.0, 0.0))]);
    let membership = Membership::new(&mesh(&shape), &path);
    assert_intervals(
        &membership.intervals(DVec3::new(2.0, 0.0, 0.5)),
        &[[0.5, 0.5]],
        1e-13,
    );
    assert_intervals(
        &membership.intervals(DVec3::new(2.0, 0.0, 1.0)),
        &[[0.5, 0.5]],
        1e-13,
    );
    assert_intervals(
        &membership.intervals(DVec3::new(2.0 + 1e-9, 1e-9, 0.5)),
        &[],
        0.0,
    );
}

#[test]
fn a_tangency_within_rounding_is_a_touch_and_beyond_it_is_none() {
    // Relative to the box, the point turns about the z axis with radius 1; the box begins at x = 1.
    let shape = shapes::cuboid(DVec3::new(1.0, -0.5, -0.5), DVec3::new(2.0, 0.5, 0.5));
    let turn = motion(&[screw(DVec3::Z, DVec3::ZERO, 180.0, 0.0, 1.0)]);
    let membership = Membership::new(&mesh(&shape), &turn);
    let touching = membership.intervals(DVec3::new(0.0, 1.0, 0.2));
    assert_eq!(touching.len(), 1, "{touching:?}");
    assert!(
        (touching[0][0] - 0.5).abs() < 1e-6 && (touching[0][1] - 0.5).abs() < 1e-6,
        "{touching:?}"
    );
    assert!(
        membership
            .intervals(DVec3::new(0.0, 1.0 - 1e-11, 0.2))
            .is_empty(),
        "1e-11 short of the face"
    );
    // 1e-8 deep: the half chord is acos(1 / (1 + 1e-8)) = 1.4142e-4 of pi.
    let half = (1.0 / (1.0 + 1e-8_f64)).acos() / std::f64::consts::PI;
    let inside = membership.intervals(DVec3::new(0.0, 1.0 + 1e-8, 0.2));
    assert_intervals(&inside, &[[0.5 - half, 0.5 + half]], 1e-9);
}

#[test]
fn a_turning_box_contains_a_point_between_known_angles() {
    // At radius 1 the box covers the angles with |sin| <= 1/2 and cos > 0: 30 degrees to either
    // side.
    let shape = shapes::cuboid(DVec3::new(0.5, -0.5, -1.0), DVec3::new(1.5, 0.5, 1.0));
    let turn = motion(&[screw(DVec3::Z, DVec3::ZERO, 540.0, 0.0, 1.0)]);
    let membership = Membership::new(&mesh(&shape), &turn);
    for degrees in [40.0, 90.0, 123.0, 149.0] {
        let point = DQuat::from_rotation_z(f64::to_radians(degrees)) * DVec3::new(1.0, 0.0, 0.3);
        let expected =
            [0.0, 360.0].map(|turn| [-30.0, 30.0].map(|side| (degrees + turn + side) / 540.0));
        assert_intervals(&membership.intervals(point), &expected, 1e-13);
    }
}

#[test]
fn ten_thousand_turns_in_one_span_are_all_told_apart() {
    // Beyond the largest number of windows, the slack grows to some 1e-7 of the size, and the
    // answer stays right.
    let shape = shapes::cuboid(DVec3::new(0.5, -0.5, -1.0), DVec3::new(1.5, 0.5, 1.0));
    let turns = 10_000.0;
    let path = motion(&[screw(DVec3::Z, DVec3::ZERO, 360.0 * turns, 0.0, 1.0)]);
    let found = Membership::new(&mesh(&shape), &path).intervals(DVec3::new(-1.0, 0.0, 0.3));
    let expected: Vec<_> = (0..10_000)
        .map(|k| [150.0, 210.0].map(|degrees| (degrees / 360.0 + f64::from(k)) / turns))
        .collect();
    assert_eq!(found.len(), expected.len(), "one visit in each turn");
    assert_intervals(&found, &expected, 1e-10);
}

/// Expected before the run: a point in the ring that the box passes is inside once in each turn,
/// one beside the ring never. With more than 25,000 turns the span is refused, as the times could
/// not be told apart.
#[test]
fn the_most_turns_are_told_apart_and_more_are_refused() {
    let body = mesh(&shapes::cuboid(
        DVec3::new(2.0, -0.5, -0.5),
        DVec3::new(3.0, 0.5, 0.5),
    ));
    let spun = |turns: f64| screw(DVec3::Z, DVec3::ZERO, 360.0 * turns, 0.0, 1.0);
    let membership = Membership::new(&body, &motion(&[spun(24_999.0)]));
    for angle in [0.3_f64, 2.0, 4.0] {
        let direction = DVec3::new(angle.cos(), angle.sin(), 0.0);
        let found = membership.intervals(2.5 * direction);
        assert_eq!(found.len(), 24_999, "in the ring, at {angle}");
        for beside in [1.9, 3.1] {
            let found = membership.intervals(beside * direction);
            assert_eq!(found, Vec::<[f64; 2]>::new(), "at {beside}");
        }
    }
    let refused = Span::new(spun(25_001.0), 1.0).expect_err("too many turns");
    assert_eq!(
        refused.to_string(),
        "the span turns 25001 times, more than 25000 times; use fewer turns, or several spans"
    );
}

#[test]
fn a_screw_advances_while_it_turns() {
    // In the frame of the body, the point (1, 0, z) sinks by 4 t while it turns by -4 pi t: it must
    // be within 30 degrees and 0 <= z <= 1.
    let shape = shapes::cuboid(DVec3::new(0.5, -0.5, 0.0), DVec3::new(1.5, 0.5, 1.0));
    let path = motion(&[screw(DVec3::Z, DVec3::ZERO, 720.0, 4.0, 1.0)]);
    let membership = Membership::new(&mesh(&shape), &path);
    let point = DVec3::new(1.0, 0.0, 2.0 + 1.0 / 12.0);
    // z - 4 t in [0, 1]: t in [13/48, 25/48]; angle -720 t within 30 degrees: t in [11/24, 13/24]
    // or [0, 1/24] or [23/24, 1].
    assert_intervals(
        &membership.intervals(point),
        &[[11.0 / 24.0, 25.0 / 48.0]],
        1e-13,
    );
}

#[test]
fn a_scaled_box_is_entered_and_left_at_logarithmic_times() {
    let shape = shapes::cuboid(DVec3::ONE, DVec3::splat(2.0));
    let path = motion(&[screw(DVec3::Z, DVec3::ZERO, 0.0, 0.0, 0.4)]);
    let membership = Membership::new(&mesh(&shape), &path);
    for x in [0.45, 0.6, 0.75] {
        // In the frame of the body it is at 0.4^-t times (x, 1.2 x, 0.9 x), which grows: inside
        // from when the last is 1 until the second is 2.
        let time = |growth: f64| -growth.ln() / 0.4_f64.ln();
        let expected = [time(1.0 / (0.9 * x)), time(2.0 / (1.2 * x)).min(1.0)];
        let found = membership.intervals(DVec3::new(x, 1.2 * x, 0.9 * x));
        assert_intervals(
            &found,
            if expected[0] < 1.0 {
                slice::from_ref(&expected)
            } else {
                &[]
            },
            1e-13,
        );
    }
}

#[test]
fn points_that_do_not_move_are_inside_always_or_never() {
    let shape = shapes::cuboid(DVec3::splat(-1.0), DVec3::ONE);
    let turn = motion(&[
        screw(DVec3::Z, DVec3::ZERO, 500.0, 0.0, 1.0),
        screw(DVec3::Z, DVec3::ZERO, 77.0, 0.0, 1.0),
    ]);
    let rest = motion(&[Generator::translation(DVec3::ZERO); 2]);
    for (name, motion) in [("on the axis", &turn), ("at rest", &rest)] {
        let membership = Membership::new(&mesh(&shape), motion);
        for (z, expected) in [
            (0.0, true),
            (0.3, true),
            (1.0, true),
            (-1.0, true),
            (1.0 + 1e-12, false),
            (-7.0, false),
        ] {
            println!("{name}, z = {z}");
            let found = membership.intervals(DVec3::new(0.0, 0.0, z));
            assert_intervals(&found, if expected { &[[0.0, 2.0]] } else { &[] }, 0.0);
        }
    }
    let membership = Membership::new(&mesh(&shape), &rest);
    for (point, name) in [
        (DVec3::ONE, "vertex"),
        (DVec3::new(1.0, 0.3, -1.0), "edge"),
        (DVec3::new(0.2, 0.3, 1.0), "face"),
    ] {
        assert_eq!(membership.intervals(point), [[0.0, 2.0]], "on a {name}");
    }
}

#[test]
fn a_cavity_is_outside_and_overlapping_shells_are_inside_throughout() {
    let path = motion(&[Generator::translation(DVec3::new(-4.0, 0.0, 0.0))]);
    let hollow = shapes::hollow_box(DVec3::splat(2.0), DVec3::ONE);
    let membership = Membership::new(&mesh(&hollow), &path);
    // In the frame of the body it is at x = -2 + 4 t; the walls are at -1, -1/2, 1/2, 1.
    let found = membership.intervals(DVec3::new(-2.0, 0.1, 0.2));
    assert_intervals(&found, &[[0.25, 0.375], [0.625, 0.75]], 1e-14);
    // Three boxes in a row: the first two overlap, with faces in common planes; the third touches
    // the second.
    let row = shapes::united(&[
        shapes::cuboid(DVec3::new(-1.0, 0.0, 0.0), DVec3::new(0.0, 1.0, 1.0)),
        shapes::cuboid(DVec3::new(-0.5, 0.0, 0.0), DVec3::new(0.5, 1.0, 1.0)),
        shapes::cuboid(DVec3::new(0.5, 0.0, 0.0), DVec3::new(1.0, 1.0, 1.0)),
    ]);
    let membership = Membership::new(&mesh(&row), &path);
    for (y, z) in [(0.5, 0.5), (0.3, 0.8), (1.0, 0.4), (0.0, 1.0)] {
        assert_intervals(
            &membership.intervals(DVec3::new(-2.0, y, z)),
            &[[0.25, 0.75]],
            1e-14,
        );
    }
}

#[test]
fn an_interval_goes_on_through_the_joints_of_a_chain() {
    let shape = shapes::cuboid(DVec3::splat(-1.0), DVec3::ONE);
    let key = |time: f64, x: f64, degrees: f64| Keyframe {
        time,
        pose: DAffine3::from_rotation_translation(
            DQuat::from_rotation_z(degrees.to_radians()),
            DVec3::new(x, 0.0, 0.0),
        ),
    };
    let keys = [
        key(1.0, 0.0, 0.0),
        key(3.0, 0.1, 40.0),
        key(3.5, 0.3, 100.0),
        key(7.0, 0.0, -20.0),
        key(8.0, 9.0, 0.0),
    ];
    let path = Motion::from_keyframes(&keys).expect("a legal motion");
    let membership = Membership::new(&mesh(&shape), &path);
    for point in [
        DVec3::new(0.1, 0.2, 0.3),
        DVec3::new(0.0, 0.0, 1.0),
        DVec3::new(-0.3, 0.1, -1.0),
    ] {
        let found = membership.intervals(point);
        assert_eq!(found.len(), 1, "{point}: {found:?}");
        assert!(
            found[0][0] == 1.0 && found[0][1] > 7.0 && found[0][1] < 8.0,
            "{found:?}"
        );
    }
    let shape = shapes::mapped(shapes::u_prism(0.3, 1.0), |p| p - DVec3::splat(0.5));
    compare("keyframes", &shape, &path, 40);
}

/// The motion run backwards, and the body in the pose in which it ends.
fn backwards(shape: &Shape, generator: Generator) -> (Shape, Motion) {
    let forwards = motion(&[generator]);
    let end = forwards.pose_at_time(1.0);
    let negative = Generator {
        linear: -generator.linear,
        offset: -generator.offset,
    };
    (
        shapes::mapped(shape.clone(), |p| end.transform_point3(p)),
        motion(&[negative]),
    )
}

#[test]
fn reversed_time_mirrors_the_intervals() {
    let shape = shapes::mapped(shapes::u_prism(0.2, 0.5), |p| {
        p + DVec3::new(0.4, 0.1, -0.2)
    });
    let axis = DVec3::new(1.0, 2.0, 3.0);
    for generator in [screw(axis, DVec3::X, 300.0, 1.0, 0.7), general(), shear()] {
        let forwards = motion(&[generator]);
        let (end, reverse) = backwards(&shape, generator);
        let [there, back] = [(&shape, &forwards), (&end, &reverse)]
            .map(|(shape, motion)| Membership::new(&mesh(shape), motion));
        let mut crossed = 0;
        for point in points(&shape, &forwards, 60)
            .chunks(5)
            .flat_map(|kinds| &kinds[..2])
        {
            let mirrored: Vec<_> = back
                .intervals(*point)
                .iter()
                .rev()
                .map(|[start, end]| [1.0 - end, 1.0 - start])
                .collect();
            assert_intervals(&there.intervals(*point), &mirrored, 1e-10);
            crossed += mirrored.len();
        }
        assert!(crossed > 60, "too few visits to mean anything: {crossed}");
    }
}

#[test]
fn units_change_nothing() {
    let shape = shapes::mapped(shapes::l_prism(0.3, 0.5), |p| {
        p + DVec3::new(0.4, 0.1, -0.2)
    });
    let generator = screw(DVec3::new(1.0, 2.0, 3.0), DVec3::X, 400.0, 1.0, 0.7);
    let forwards = motion(&[generator]);
    let membership = Membership::new(&mesh(&shape), &forwards);
    for unit in [1e-3, 1e6] {
        let scaled = motion(&[Generator {
            offset: unit * generator.offset,
            ..generator
        }]);
        let other = Membership::new(&mesh(&shapes::mapped(shape.clone(), |p| unit * p)), &scaled);
        for point in points(&shape, &forwards, 60)
            .chunks(5)
            .flat_map(|kinds| &kinds[..2])
        {
            assert_intervals(
                &other.intervals(unit * *point),
                &membership.intervals(*point),
                1e-11,
            );
        }
    }
}

#[test]
fn a_body_a_million_units_away_agrees_with_dense_sampling() {
    let away = DVec3::new(1e6, -2e6, 3e6);
    let shape = shapes::mapped(shapes::box_with_hole(DVec3::new(1.0, 0.8, 0.3), 0.2), |p| {
        p + away
    });
    for (name, generator) in [
        (
            "screw",
            screw(DVec3::new(1.0, 2.0, 3.0), away + DVec3::X, 200.0, 1.0, 1.0),
        ),
        (
            "translation",
            Generator::translation(DVec3::new(0.3, 0.7, -0.2)),
        ),
    ] {
        // A coordinate of 3e6 alone has a rounding of 2e-10; the reference has a dozen of these.
        compare_within(name, &shape, &motion(&[generator]), 20, 1e-8 / 3e6);
    }
}

#[test]
fn slivers_and_triangles_without_area_are_passed_like_any_other() {
    // The box [0, 1]^3 with an edge of its top split on one side only: the gap is closed by the
    // triangle (4, 8, 5).
    let (mut positions, mut triangles) = shapes::cuboid(DVec3::ZERO, DVec3::ONE);
    let split = triangles.iter().position(|triangle| {
        triangle.contains(&4) && triangle.contains(&5) && triangle.contains(&7)
    });
    let split = split.expect("the top has a triangle at the edge from 4 to 5");
    positions.push(DVec3::new(0.5, 0.0, 1.0));
    triangles[split] = [4, 8, 7];
    triangles.extend([[8, 5, 7], [4, 5, 8]]);
    for lift in [0.0, 1e-16, 1e-13, 1e-9, 1e-5] {
        let mut positions = positions.clone();
        positions[8].y -= lift;
        positions[8].z += lift / 2.0;
        let shape = (positions, triangles.clone());
        for generator in [
            screw(DVec3::X, DVec3::new(0.0, 0.5, 0.5), 360.0, 0.0, 1.0),
            Generator::translation(DVec3::new(0.0, -2.0, -2.0)),
        ] {
            let motion = motion(&[generator]);
            compare(&format!("lift {lift:e}"), &shape, &motion, 40);
            // The point passes straight through the edge, where the sliver is.
            let membership = Membership::new(&mesh(&shape), &motion);
            let sampled = Sampled::new(&shape, &motion, 500);
            for k in 0..20 {
                let seen = DVec3::new(0.05 + 0.045 * f64::from(k), 0.0, 1.0);
                for i in 0..=4 {
                    let point = motion
                        .pose_at_time(0.25 * f64::from(i))
                        .transform_point3(seen);
                    sampled.check(point, &membership.intervals(point), 1e-9);
                }
            }
        }
    }
}

#[test]
fn the_number_of_threads_does_not_change_a_bit() {
    let shape = shapes::mapped(shapes::torus(0.6, 0.2, 12, 6), |p| p + DVec3::X);
    let path = motion(&[
        screw(DVec3::new(1.0, 2.0, 3.0), DVec3::X, 400.0, 1.0, 0.7),
        general(),
    ]);
    let points = points(&shape, &path, 100);
    let with_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        pool.install(|| Membership::new(&mesh(&shape), &path).intervals_of(&points))
    };
    let one = with_threads(1);
    assert!(
        one.iter().flatten().count() > 100,
        "too few visits to mean anything"
    );
    for threads in [2, 3, 8] {
        let bits = |all: &[Vec<[f64; 2]>]| {
            all.iter()
                .map(|each| {
                    each.iter()
                        .flatten()
                        .map(|t| t.to_bits())
                        .collect::<Vec<_>>()
                })
                .collect::<Vec<_>>()
        };
        assert_eq!(
            bits(&with_threads(threads)),
            bits(&one),
            "{threads} threads"
        );
    }
}

#[test]
fn points_that_are_not_finite_or_huge_are_never_inside() {
    let shape = shapes::cuboid(DVec3::splat(-1.0), DVec3::ONE);
    let path = motion(&[general()]);
    let membership = Membership::new(&mesh(&shape), &path);
    for x in [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::MAX,
        1e200,
        -1e20,
    ] {
        assert!(
            membership.intervals(DVec3::new(0.1, x, 0.2)).is_empty(),
            "{x}"
        );
        assert!(!membership.is_ever_inside(DVec3::new(0.1, x, 0.2)), "{x}");
    }
}

#[test]
fn lattice_points_in_lattice_bodies_on_lattice_motions_agree_with_dense_sampling() {
    // Everything coincides with something: points move in faces, through edges and vertices, and
    // turn back on them.
    let quarter = |p: DVec3| (p * 4.0).round() / 4.0;
    let bodies = [
        shapes::cuboid(DVec3::new(0.0, -0.5, -0.5), DVec3::new(1.0, 0.5, 0.5)),
        shapes::l_prism(0.5, 0.5),
        shapes::box_with_hole(DVec3::new(2.0, 1.5, 1.0), 0.25),
        shapes::united(&[
            shapes::cuboid(DVec3::ZERO, DVec3::ONE),
            shapes::cuboid(DVec3::splat(0.5), DVec3::splat(1.5)),
            shapes::cuboid(DVec3::new(1.0, 0.0, 0.0), DVec3::new(1.5, 1.0, 0.5)),
        ]),
    ];
    let motions = [
        motion(&[screw(DVec3::Z, DVec3::ZERO, 360.0, 0.0, 1.0)]),
        motion(&[
            screw(DVec3::X, DVec3::new(0.0, 0.5, 0.25), -90.0, 1.0, 1.0),
            Generator::translation(DVec3::X),
        ]),
        motion(&[
            Generator::translation(DVec3::new(1.0, 1.0, 0.0)),
            Generator::translation(DVec3::new(-1.0, -1.0, 0.0)),
        ]),
        motion(&[screw(DVec3::Z, DVec3::ZERO, 0.0, 0.0, 0.5)]),
        motion(&[Generator {
            linear: DMat3::from_cols(DVec3::ZERO, DVec3::X, DVec3::ZERO),
            offset: DVec3::ZERO,
        }]),
        motion(&[screw(DVec3::ONE, DVec3::ZERO, 120.0, 0.0, 1.0); 3]),
    ];
    for shape in &bodies {
        for motion in &motions {
            let membership = Membership::new(&mesh(shape), motion);
            let sampled = Sampled::new(shape, motion, 144);
            let mut numbers = pseudo_random(3);
            for _ in 0..150 {
                let point = quarter(in_box(
                    [DVec3::splat(-1.5), DVec3::splat(1.75)],
                    &mut numbers,
                ));
                sampled.check(point, &membership.intervals(point), 1e-9);
            }
        }
    }
}

#[test]
fn a_point_of_the_closed_body_counts_at_the_time_it_gets_there() {
    for (body_name, shape) in &bodies() {
        for (motion_name, motion) in &motions() {
            let membership = Membership::new(&mesh(shape), motion);
            let mut numbers = pseudo_random(9);
            let mut number = || numbers.next().expect("endless");
            let end = *motion.joint_times().last().expect("there is a clock");
            for k in 0..60 {
                let corners = shape.1[k % shape.1.len()].map(|corner| shape.0[corner as usize]);
                let on_edge = corners[0].lerp(corners[1], number());
                let on_surface = [corners[0], on_edge, on_edge.lerp(corners[2], number())][k % 3];
                // The start, the end, round times, and any time.
                let time = end * [0.0, 1.0, 0.5, number()][k % 4];
                let point = motion.pose_at_time(time).transform_point3(on_surface);
                let intervals = membership.intervals(point);
                let counts = intervals
                    .iter()
                    .any(|&[start, end]| start - 1e-9 <= time && time <= end + 1e-9);
                assert!(
                    counts,
                    "{body_name}, {motion_name}: {point:?} at {time}, {intervals:?}"
                );
            }
        }
    }
}

#[test]
fn random_motions_from_mild_to_wild_agree_with_dense_sampling() {
    let shape = shapes::mapped(shapes::u_prism(0.2, 0.5), |p| {
        p + DVec3::new(0.4, 0.1, -0.2)
    });
    let mut numbers = pseudo_random(21);
    let mut entry = || 2.0 * numbers.next().expect("endless") - 1.0;
    let mut visits = 0;
    for k in 0..60 {
        // Up to some ten turns, or a stretch by a few thousand.
        let size = [0.01, 1.0, 4.0, 30.0][k % 4];
        let any = DMat3::from_cols_array(&std::array::from_fn(|_| entry()));
        let skew = (any - any.transpose()) * size;
        let linear = skew + any * size.min(4.0);
        let offset = DVec3::new(entry(), entry(), entry()) * size;
        let motion = motion(&[Generator { linear, offset }]);
        let membership = Membership::new(&mesh(&shape), &motion);
        let sampled = Sampled::new(&shape, &motion, 2_000);
        for _ in 0..12 {
            // A point that is in or near the body at some time.
            let seen = DVec3::new(entry(), entry(), entry()) * 0.6 + DVec3::new(0.9, 0.6, 0.0);
            let point = motion.pose_at_time(entry().abs()).transform_point3(seen);
            let intervals = membership.intervals(point);
            sampled.check(point, &intervals, 1e-8);
            visits += intervals.len();
        }
    }
    assert!(visits > 200, "too few visits to mean anything: {visits}");
}
