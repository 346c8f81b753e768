//! Obstacles that may be touched but not entered: closed forms, and random scenes against depths
//! found with many points.

use crate::support::contact::scene::{self as scenes, Obstacle, Scene};
use crate::support::random::Random;
use crate::support::shapes::{self, Shape};
use glam::{DAffine3, DMat3, DVec3};
use rayon::prelude::*;
use std::f64::consts::PI;
use steadysweep::collision::{Check, CheckError, CheckSettings, ContactRule, Touch, Verdict};
use steadysweep::motion::{Generator, Motion, Span};

fn deeper_than(depth: f64) -> CheckSettings<'static> {
    CheckSettings::default()
        .with_rules(vec![ContactRule::Enter { depth: Some(depth) }])
        .with_all_intervals()
}

fn by_rounding() -> CheckSettings<'static> {
    CheckSettings::default()
        .with_rules(vec![ContactRule::Enter { depth: None }])
        .with_all_intervals()
}

/// Spans of duration 1 that move by these vectors.
fn moves(ways: &[[f64; 3]]) -> Motion {
    motion(ways.iter().map(|&way| Generator::translation(way.into())))
}

fn motion(generators: impl Iterator<Item = Generator>) -> Motion {
    let span = |generator| Span::new(generator, 1.0).expect("finite");
    Motion::from_spans(generators.map(span).collect()).expect("a legal motion")
}

fn cuboid(low: [f64; 3], high: [f64; 3]) -> Shape {
    shapes::cuboid(low.into(), high.into())
}

/// The top of a floor, z = 0, from -9 to 9, in squares; each is a cell of the grid.
fn tiles(count: u32) -> Shape {
    let at = |k: u32| -9.0 + 18.0 * f64::from(k) / f64::from(count);
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..=count {
        for j in 0..=count {
            positions.push(DVec3::new(at(i), at(j), 0.0));
        }
    }
    for i in 0..count {
        for j in 0..count {
            let a = i * (count + 1) + j;
            let b = a + count + 1;
            triangles.extend([[a, b, a + 1], [b, b + 1, a + 1]]);
        }
    }
    (positions, triangles)
}

/// Checks that the motion is clear throughout.
fn is_clear(name: &str, check: &Check) {
    assert_eq!(check.verdict, Verdict::Clear, "{name}");
    assert_eq!(check.intervals.as_deref(), Some(&[][..]), "{name}");
}

/// Checks that the obstacle is first entered at this time, in a bracket no wider than `within`.
fn is_entered(name: &str, check: &Check, time: f64, within: f64) {
    let Verdict::Contact(found) = check.verdict else {
        panic!("{name}: {:?}", check.verdict)
    };
    let [from, to] = found.bracket;
    assert!(
        from <= time + within && time - within <= to && to - from <= within,
        "{name}: {found:?} for {time}"
    );
    assert!(from <= found.time && found.time <= to, "{name}: {found:?}");
    let intervals = check.intervals.as_deref().expect("they were asked for");
    assert!(
        intervals
            .first()
            .is_some_and(|first| (first.times[0] - found.time).abs() <= within),
        "{name}: {intervals:?}"
    );
}

const FINE: f64 = 1e-9;

#[test]
fn a_box_that_slides_on_a_floor_enters_it_when_it_digs_in() {
    let body = cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 1.0]);
    let slide = [3.0, 0.5, 0.0];
    let dig = [1.0, 0.0, -0.5];
    let floors = [
        ("a box", cuboid([-9.0, -9.0, -2.0], [9.0, 9.0, 0.0])),
        ("an open rectangle", scenes::sheet(18.0, 18.0)),
        ("open tiles", tiles(7)),
    ];
    for (name, floor) in floors {
        let scene = |ways: &[[f64; 3]]| Scene::new(body.clone(), moves(ways), floor.clone());
        is_clear(
            name,
            &scene(&[slide, [-1.0, 0.0, 0.0]]).check(&by_rounding()),
        );
        is_clear(
            name,
            &scene(&[slide, [1.0, 0.0, 0.5]]).check(&by_rounding()),
        );
        let digs = scene(&[slide, dig, [0.0, 0.0, 2.0]]);
        is_entered(name, &digs.check(&by_rounding()), 1.0, FINE);
        let check = digs.check(&deeper_than(0.1));
        // 0.1 of 0.5 in the second span, and back up at a speed of 2.
        is_entered(name, &check, 1.2, FINE);
        let intervals = check.intervals.expect("they were asked for");
        assert_eq!(intervals.len(), 1, "{name}: {intervals:?}");
        assert!(
            (intervals[0].times[1] - 2.2).abs() < FINE,
            "{name}: {intervals:?}"
        );
        is_clear(name, &digs.check(&deeper_than(0.51)));
        // The plain check reports the touch.
        let Verdict::Contact(touch) = digs.check(&CheckSettings::default()).verdict else {
            panic!("{name}: it touches")
        };
        assert_eq!(touch.time, 0.0, "{name}");
    }
}

#[test]
fn what_is_entered_says_where() {
    let body = cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 1.0]);
    let dig = moves(&[[0.0, 0.0, -0.5]]);
    let solid = Scene::new(
        body.clone(),
        dig.clone(),
        cuboid([-9.0, -9.0, -2.0], [9.0, 9.0, 0.0]),
    );
    let Verdict::Contact(found) = solid.check(&deeper_than(0.25)).verdict else {
        panic!("it digs in")
    };
    assert_eq!(found.touch, Touch::Enter);
    assert!(found.normal.distance(DVec3::Z) < 1e-9, "{found:?}");
    assert!(
        found.point.z.abs() < 1e-9 && found.point.x.abs() <= 1.0 + 1e-9,
        "{found:?}"
    );
    let sheet = Scene::new(body, dig, scenes::sheet(18.0, 18.0));
    let Verdict::Contact(found) = sheet.check(&deeper_than(0.25)).verdict else {
        panic!("it digs in")
    };
    assert!(found.normal.distance(DVec3::Z) < 1e-9, "{found:?}");
    assert!(found.point.z.abs() < 1e-9, "{found:?}");
}

#[test]
fn a_flap_that_lies_on_a_slab_jams_after_half_a_turn() {
    let flap = cuboid([-10.0, 0.0, 0.0], [10.0, 30.0, 2.0]);
    let slab = cuboid([-10.0, 0.0, -2.0], [10.0, 30.0, 0.0]);
    let turn = |angle: f64| Generator::screw(DVec3::X, DVec3::ZERO, angle, 0.0, 1.0);
    let scene = |angle: f64| {
        Scene::new(
            flap.clone(),
            motion([turn(angle)].into_iter()),
            slab.clone(),
        )
    };
    is_entered(
        "by rounding",
        &scene(1.5 * PI).check(&by_rounding()),
        2.0 / 3.0,
        FINE,
    );
    is_clear(
        "half a turn",
        &scene(PI * (1.0 - 1e-9)).check(&by_rounding()),
    );
    // A turn by e beyond half: the end face of the flap enters the side of the slab, deepest where
    // its bottom is as near: r sin e = 2 - r cos e.
    let depth: f64 = 0.01;
    let past = |e: f64| 2.0 * e.sin() / (e.sin() + e.cos());
    let (mut low, mut high) = (0.0, 0.1);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if past(middle) < depth {
            low = middle;
        } else {
            high = middle;
        }
    }
    let time = (PI + low) / (1.5 * PI);
    is_entered(
        "by 0.01",
        &scene(1.5 * PI).check(&deeper_than(depth)),
        time,
        FINE,
    );
}

#[test]
fn a_peg_in_a_fitting_hole_is_clear_until_it_meets_the_bottom() {
    let peg = cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 4.0]);
    let through = shapes::box_with_hole(DVec3::new(6.0, 6.0, 3.0), 1.0);
    let through = scenes::moved(through, DVec3::Z * -1.5);
    let down = |by: f64| moves(&[[0.0, 0.0, -by]]);
    let scene = Scene::new(peg.clone(), down(5.0), through.clone());
    is_clear("a hole", &scene.check(&by_rounding()));
    is_clear("a hole, deep", &scene.check(&deeper_than(0.3)));
    // When turned, a corner of the peg enters the wall by sqrt 2 cos(45 - a) - 1.
    let turned = Generator::screw(DVec3::Z, DVec3::ZERO, 0.5, 0.0, 1.0);
    let chain = motion([Generator::translation(DVec3::Z * -2.0), turned].into_iter());
    let check = Scene::new(peg.clone(), chain, through).check(&deeper_than(0.2));
    let angle = PI / 4.0 - (1.2 / 2.0_f64.sqrt()).acos();
    is_entered("turned", &check, 1.0 + angle / 0.5, FINE);
    // Four walls and a bottom at z = -3.
    let pocket = pocket();
    let scene = Scene::new(peg, down(4.0), pocket);
    is_entered("a pocket", &scene.check(&by_rounding()), 0.75, FINE);
    is_entered(
        "a pocket, deep",
        &scene.check(&deeper_than(0.4)),
        0.85,
        FINE,
    );
}

/// A block from -3 to 3 and z from -6 to 0 with a square hole of 2 down to z = -3.
fn pocket() -> Shape {
    let ring = |half: f64, z: f64| -> Vec<DVec3> {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .iter()
            .map(|&(x, y)| DVec3::new(x * half, y * half, z))
            .collect()
    };
    let rings = [
        ring(3.0, -6.0),
        ring(3.0, 0.0),
        ring(1.0, 0.0),
        ring(1.0, -3.0),
    ];
    let positions = rings.concat();
    let mut triangles = vec![[0, 2, 1], [0, 3, 2], [12, 13, 14], [12, 14, 15]];
    for level in 0..3_u32 {
        for k in 0..4 {
            let (a, b) = (level * 4 + k, level * 4 + (k + 1) % 4);
            triangles.extend([[a, b, b + 4], [a, b + 4, a + 4]]);
        }
    }
    (positions, triangles)
}

#[test]
fn obstacles_that_move_are_entered_as_well() {
    let body = cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 1.0]);
    let floor = cuboid([-9.0, -9.0, -2.0], [9.0, 9.0, 0.0]);
    let screw =
        |angle: f64, advance: f64| Generator::screw(DVec3::Z, DVec3::X, angle, advance, 1.0);
    let scene = |own: Generator, other: Generator| {
        let mut scene = Scene::new(body.clone(), motion([own].into_iter()), floor.clone());
        scene.obstacles[0].motion = Some(motion([other].into_iter()));
        scene
    };
    is_clear(
        "together",
        &scene(screw(2.0, 1.0), screw(2.0, 1.0)).check(&by_rounding()),
    );
    is_clear(
        "on it",
        &scene(screw(2.0, 1.0), screw(-1.0, 1.0)).check(&by_rounding()),
    );
    is_clear(
        "leaving",
        &scene(screw(2.0, 1.0), screw(-1.0, 0.5)).check(&by_rounding()),
    );
    let meets = scene(screw(2.0, 0.0), screw(-1.0, 0.5));
    is_entered("risen", &meets.check(&deeper_than(0.1)), 0.2, FINE);
    // Motions that do not commute: the floor turns about the line x = 1, y = 0 and rises, while the
    // body slides in the plane.
    let slides = Generator::translation(DVec3::new(1.0, 0.3, 0.0));
    is_clear(
        "sliding",
        &scene(slides, screw(1.0, 0.0)).check(&by_rounding()),
    );
    is_entered(
        "dug in",
        &scene(slides, screw(1.0, 0.5)).check(&deeper_than(0.1)),
        0.2,
        FINE,
    );
}

#[test]
fn what_is_held_or_deep_from_the_start_is_entered_then() {
    let still = moves(&[[0.1, 0.0, 0.0]]);
    let ball = shapes::icosphere(2, 1.0, DVec3::new(0.1, 0.2, 0.3));
    let big = cuboid([-4.0; 3], [4.0; 3]);
    // Almost as big: its surface is nowhere deeper than 0.2, but the rest of it is inside.
    let almost = cuboid([-3.8; 3], [3.8; 3]);
    for (name, body, obstacle, depth) in [
        ("a ball in a box", &ball, &big, 0.1),
        ("a box round a ball", &big, &ball, 0.1),
        ("a box in a box", &almost, &big, 0.5),
        ("a box in itself", &big, &big, 0.5),
    ] {
        let scene = Scene::new(body.clone(), still.clone(), obstacle.clone());
        let check = scene.check(&deeper_than(depth));
        is_entered(name, &check, 0.0, FINE);
        let Verdict::Contact(found) = check.verdict else {
            unreachable!("seen before")
        };
        assert_eq!(found.touch, Touch::Inside, "{name}: {found:?}");
        is_entered(name, &scene.check(&by_rounding()), 0.0, FINE);
    }
    // Nothing in a plate is deeper than half of its thickness.
    let plate = cuboid([-2.0, -2.0, 0.0], [2.0, 2.0, 0.3]);
    let scene = Scene::new(big.clone(), still.clone(), plate);
    is_entered("a plate", &scene.check(&deeper_than(0.14)), 0.0, FINE);
    is_clear("a plate", &scene.check(&deeper_than(0.16)));
    // A hollow body around a ball contains no part of it.
    let hollow = shapes::hollow_box(DVec3::splat(8.0), DVec3::splat(4.0));
    let inner = shapes::icosphere(2, 0.5, DVec3::splat(0.0));
    let centre = hollow.0.iter().fold(DVec3::ZERO, |sum, &p| sum + p) / hollow.0.len() as f64;
    let scene = Scene::new(shapes::mapped(hollow, |p| p - centre), still, inner);
    is_clear("a hollow box", &scene.check(&by_rounding()));
}

#[test]
fn near_the_middle_of_a_ball_all_faces_are_about_as_near() {
    let ball = shapes::icosphere(3, 1.0, DVec3::ZERO);
    let (positions, triangles) = &ball;
    // Twice the distance from the middle of an edge to the sphere, which exceeds that of any face.
    let lacking = triangles
        .iter()
        .map(|t| 2.0 - (positions[t[0] as usize] + positions[t[1] as usize]).length())
        .fold(0.0, f64::max);
    assert!(lacking < 0.008, "a fine one: {lacking}");
    let check = |[low, high]: [f64; 2], way: f64, depth: f64| {
        let body = cuboid([low, -0.05, -0.05], [high, 0.05, 0.05]);
        let scene = Scene::new(body, moves(&[[way, 0.0, 0.0]]), ball.clone());
        scene.check(&deeper_than(depth))
    };
    let depth = 0.99;
    // Points that deep are within 0.01 of the middle.
    let beside = check([0.02, 0.1], 0.3, depth);
    assert_eq!(beside.verdict, Verdict::Clear, "it goes away");
    is_entered("over it", &check([-0.05, 0.05], 0.03, depth), 0.0, FINE);
    let Verdict::Contact(found) = check([0.3, 0.4], -0.6, depth).verdict else {
        panic!("it passes through the middle")
    };
    let [early, late] = [0.3 - (1.0 - depth), 0.3 - (1.0 - depth) + lacking].map(|way| way / 0.6);
    assert!(
        early <= found.time + FINE && found.time <= late && found.bracket[0] <= late,
        "{found:?} within {early}, {late}"
    );
    let through = check([0.3, 0.4], -0.6, 1.0 + 1e-9);
    assert_eq!(through.verdict, Verdict::Clear, "as deep as the radius");
}

#[test]
fn a_body_that_starts_too_deep_and_leaves_is_entered_until_then() {
    let body = cuboid([-1.0, -1.0, -0.5], [1.0, 1.0, 1.0]);
    let floor = cuboid([-9.0, -9.0, -2.0], [9.0, 9.0, 0.0]);
    let scene = Scene::new(body, moves(&[[0.0, 0.0, 1.0]]), floor);
    let check = scene.check(&deeper_than(0.1));
    is_entered("leaving", &check, 0.0, FINE);
    let intervals = check.intervals.expect("they were asked for");
    assert!((intervals[0].times[1] - 0.4).abs() < FINE, "{intervals:?}");
}

#[test]
fn a_wedge_that_lies_in_a_groove_is_clear_until_it_is_pressed_in() {
    // An inside corner: two walls that meet at a right angle, as a solid with an L-shaped outline.
    let corner = shapes::mapped(shapes::l_prism(0.5, 2.0), |p| {
        p * 4.0 - DVec3::new(2.0, 2.0, 4.0)
    });
    let wedge = cuboid([0.0, 0.0, -1.0], [0.5, 0.5, 1.0]);
    let along = [0.0, 0.0, 1.0];
    let scene = |ways: &[[f64; 3]]| Scene::new(wedge.clone(), moves(ways), corner.clone());
    is_clear("along", &scene(&[along]).check(&by_rounding()));
    is_clear(
        "off",
        &scene(&[along, [0.2, 0.1, 0.0]]).check(&by_rounding()),
    );
    let pressed = scene(&[along, [-0.5, -0.5, 0.0]]);
    is_entered("pressed", &pressed.check(&by_rounding()), 1.0, FINE);
    // Its edge is nearest to that of the corner.
    let time = 1.0 + 0.2 / 0.5 / 2.0_f64.sqrt();
    is_entered(
        "pressed by 0.2",
        &pressed.check(&deeper_than(0.2)),
        time,
        FINE,
    );
}

#[test]
fn a_plate_that_comes_down_on_an_edge_is_as_deep_as_the_faces_of_it_are_far() {
    // A roof with its ridge along y: below it, the faces are nearer than the plate.
    let beam = shapes::mapped(cuboid([-1.0, -3.0, -1.0], [1.0, 3.0, 1.0]), |p| {
        DMat3::from_rotation_y(PI / 4.0) * p
    });
    let top = 2.0_f64.sqrt();
    let plate = cuboid([-4.0, -4.0, top], [4.0, 4.0, top + 0.5]);
    let scene = Scene::new(plate, moves(&[[1.0, 0.0, 0.0], [0.3, 0.0, -1.0]]), beam);
    is_entered("by rounding", &scene.check(&by_rounding()), 1.0, FINE);
    // The plate cuts off a prism of height h under the ridge: deepest on its middle line.
    let depth = 0.1;
    is_entered(
        "by 0.1",
        &scene.check(&deeper_than(depth)),
        1.0 + depth * 2.0_f64.sqrt(),
        FINE,
    );
}

#[test]
fn a_sheet_is_entered_where_the_body_is_on_both_sides() {
    let wall = shapes::mapped(scenes::sheet(4.0, 4.0), |p| DVec3::new(p.z, p.x, p.y));
    // Over the rim at z = 2, on both sides of the wall, but not across it.
    let bridge = cuboid([-1.0, -1.0, 2.0], [1.0, 1.0, 3.0]);
    let over = Scene::new(bridge.clone(), moves(&[[0.3, 0.1, 0.0]]), wall.clone());
    is_clear("on the rim", &over.check(&by_rounding()));
    // Lowered, the rim is in the body.
    let lowered = Scene::new(bridge, moves(&[[0.0, 0.0, -0.4]]), wall.clone());
    is_entered("lowered", &lowered.check(&deeper_than(0.1)), 0.25, FINE);
    // Astride: the slot of a U is around the wall and touches neither side.
    let astride = scenes::moved(shapes::u_prism(0.3, 1.0), DVec3::X * -0.5);
    let thin = shapes::mapped(scenes::sheet(0.2, 0.2), |p| {
        DVec3::new(0.0, p.x + 0.6, p.y + 0.5)
    });
    let scene = Scene::new(astride, moves(&[[0.0, 0.0, 0.1]]), thin);
    is_clear("astride", &scene.check(&by_rounding()));
    // A needle is nowhere deeper than its own radius.
    let needle = cuboid([-1.5, -0.05, -0.05], [-0.5, 0.05, 0.05]);
    let scene = Scene::new(needle, moves(&[[2.0, 0.0, 0.0]]), wall);
    is_clear("a needle", &scene.check(&deeper_than(0.051)));
    is_entered("a needle", &scene.check(&deeper_than(0.02)), 0.26, FINE);
}

#[test]
fn the_answer_does_not_depend_on_the_unit_or_the_place() {
    let body = cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 1.0]);
    let scene = Scene::new(
        body,
        moves(&[[3.0, 0.5, 0.0], [1.0, 0.0, -0.5]]),
        cuboid([-9.0, -9.0, -2.0], [9.0, 9.0, 0.0]),
    );
    for (unit, shift) in [(1e-3, 0.0), (1e6, 0.0), (1.0, 1e4), (1e-3, 10.0)] {
        let turn = DMat3::from_axis_angle(DVec3::new(2.0, -1.0, 2.0) / 3.0, 0.4);
        let frame =
            DAffine3::from_mat3_translation(turn * unit, DVec3::new(0.3, -1.0, 0.7) * shift);
        let seen = scene.in_frame(&frame);
        let name = format!("unit {unit:e}, at {shift:e}");
        // Turned coordinates are rounded: a touch is off by that, which is less than the least
        // depth.
        let check = seen.check(&by_rounding());
        let least = check.depths[0].expect("a depth");
        is_entered(&name, &check, 1.0 + least / (0.5 * unit), 1e-6);
        is_entered(&name, &seen.check(&deeper_than(0.1 * unit)), 1.2, 1e-6);
    }
}

#[test]
fn depths_that_cannot_be_answered_are_refused() {
    let scene = Scene::new(
        cuboid([0.0; 3], [1.0; 3]),
        moves(&[[1.0, 0.0, 0.0]]),
        cuboid([0.0, 0.0, -1.0], [1.0, 1.0, 0.0]),
    );
    let refused = |scene: &Scene, depth: f64| {
        let surfaces = scene.surfaces();
        let obstacle = steadysweep::collision::Obstacle {
            surface: &surfaces[0],
            motion: scene.obstacles[0].motion.as_ref(),
        };
        let (mesh, settings) = (scene.mesh(), deeper_than(depth));
        steadysweep::collision::check(&mesh, &scene.motion, &[obstacle], &settings)
            .expect_err("must be refused")
    };
    for depth in [0.0, 1e-17, f64::NAN, f64::INFINITY] {
        let CheckError::Depth { least, .. } = refused(&scene, depth) else {
            panic!("{depth}")
        };
        assert!((1e-14..1e-10).contains(&least), "{least}");
        scene.check(&deeper_than(least));
    }
    let mut grown = scene;
    let growing = Generator::screw(DVec3::Z, DVec3::ZERO, 0.0, 0.0, 1.5);
    grown.obstacles = vec![Obstacle {
        motion: Some(motion([growing].into_iter())),
        ..grown.obstacles[0].clone()
    }];
    assert_eq!(refused(&grown, 0.1), CheckError::Stretched { obstacle: 0 });
}

/// A scene in which something small approaches or enters something, with a depth of some percent.
fn any_scene(seed: u64) -> (Scene, f64) {
    let mut random = Random::new(seed);
    let body = scenes::any_body(&mut random);
    let obstacle = scenes::any_obstacle(&mut random);
    let way = random.direction() * random.between(0.5, 2.0);
    let generator = match random.below(3) {
        0 => Generator::translation(way),
        1 => Generator::screw(
            random.direction(),
            random.point(1.0),
            random.between(0.5, 4.0),
            random.between(-1.0, 1.0),
            1.0,
        ),
        _ => Generator::screw(
            random.direction(),
            random.point(1.0),
            random.between(0.2, 2.0),
            0.3,
            random.between(0.7, 1.3),
        ),
    };
    let start = random.direction() * random.between(0.0, 2.0);
    let body = shapes::mapped(body, |p| p + start);
    let mut scene = Scene::new(body, scenes::steady(generator), obstacle);
    if random.chance(0.3) {
        let other = Generator::screw(random.direction(), random.point(1.0), 1.0, 0.2, 1.0);
        scene.obstacles[0].motion = Some(scenes::steady(other));
    }
    (scene, random.magnitude(1e-3, 0.3))
}

#[test]
fn random_scenes_are_as_deep_as_many_points_say() {
    let complaints: Vec<String> = (0..30_u64)
        .into_par_iter()
        .filter_map(|seed| {
            let (scene, depth) = any_scene(seed);
            let mut settings = deeper_than(depth);
            settings.all_intervals = false;
            let check = scene.check(&settings);
            let at = |time: f64| scene.slow_depth(0, time);
            let start = scene.start();
            // Before `shallow` the depth is certainly not exceeded.
            let (shallow, is_sharp) = match check.verdict {
                Verdict::Clear => (scene.end(), true),
                Verdict::Contact(found) => {
                    let [from, to] = found.bracket;
                    let seen = at(to);
                    if seen < depth - 1e-4 {
                        return Some(format!("{seed}: only {seen} of {depth} at {to}"));
                    }
                    (from, to - from <= 1e-6 * scene.duration())
                }
                Verdict::Undecided { window, .. } => (window[0], false),
                other => return Some(format!("{seed}: {other:?}")),
            };
            if !is_sharp {
                return Some(format!("{seed}: not sharp, {:?}", check.verdict));
            }
            // Where it is deep from the start, there is no time before.
            (0..4).find_map(|k| {
                let time = start + (shallow - start) * f64::from(k) / 4.0;
                let seen = if shallow > start { at(time) } else { 0.0 };
                (seen > depth + 1e-9)
                    .then(|| format!("{seed}: {seen} of {depth} at {time}, {:?}", check.verdict))
            })
        })
        .collect();
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}
