//! All times at which obstacles are entered, in closed form: boxes along the axes, and corners that
//! turn through a wall.

use crate::support::contact::scene::{self as scenes, Scene};
use crate::support::random::Random;
use crate::support::shapes;
use glam::{DAffine3, DMat3, DVec3};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};
use steadysweep::collision::{Check, CheckSettings, ContactRule, Verdict};
use steadysweep::motion::{Generator, Motion, Span};

/// Largest error of times.
const FINE: f64 = 1e-9;

fn deeper_than(depth: Option<f64>) -> CheckSettings<'static> {
    CheckSettings::default()
        .with_rules(vec![ContactRule::Enter { depth }])
        .with_all_intervals()
}

/// The defects of an answer, given all times; empty when there are none.
fn defects(check: &Check, expected: &[[f64; 2]], within: f64) -> String {
    let found: Vec<[f64; 2]> = check
        .intervals
        .iter()
        .flatten()
        .map(|interval| interval.times)
        .collect();
    let is_near = |a: f64, b: f64| (a - b).abs() <= within;
    let fits = found.len() == expected.len()
        && (found.iter().flatten().zip(expected.iter().flatten())).all(|(&a, &b)| is_near(a, b));
    if !fits {
        return format!("{found:?} for {expected:?}, {:?}", check.verdict);
    }
    let is_right = match (check.verdict, expected.first()) {
        (Verdict::Clear, None) => true,
        (Verdict::Contact(first), Some(&[time, _])) => {
            let [from, to] = first.bracket;
            from <= time + within && to >= time - within && to - from <= within
        }
        _ => false,
    };
    if is_right {
        return String::new();
    }
    format!("{:?} for {expected:?}", check.verdict)
}

/// A box [low, high]. One of the axes may be flat: a rectangle.
type Extent = [DVec3; 2];

fn surface([low, high]: Extent) -> shapes::Shape {
    let size = high - low;
    match (0..3).find(|&axis| size[axis] == 0.0) {
        None => shapes::cuboid(low, high),
        Some(axis) => {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut corners = [low; 4];
            corners[1][u] = high[u];
            (corners[2][u], corners[2][v]) = (high[u], high[v]);
            corners[3][v] = high[v];
            (corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]])
        }
    }
}

/// The times at which some point of the first box, which moves by these vectors in spans of
/// duration 1, is deeper in the second one.
///
/// The greatest depth is the minimum, over the axes, of half the width and of how far each end is
/// past the opposite one: along each axis the point may be chosen independently. All of these are
/// linear in time.
fn times_in(first: Extent, second: Extent, ways: &[DVec3], depth: f64) -> Vec<[f64; 2]> {
    let mut times: Vec<[f64; 2]> = Vec::new();
    let mut shift = DVec3::ZERO;
    for (span, way) in ways.iter().enumerate() {
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        let mut above = |start: f64, slope: f64| {
            let excess = start - depth;
            // Equal depths, up to rounding, do not count as deeper.
            if slope == 0.0 || (slope < 0.0 && excess.abs() <= 1e-12) {
                if excess <= 1e-12 {
                    to = -1.0;
                }
            } else if slope > 0.0 {
                from = from.max(-excess / slope);
            } else {
                to = to.min(-excess / slope);
            }
        };
        for axis in 0..3 {
            let [low, high] = first.map(|end| end[axis] + shift[axis]);
            let [other_low, other_high] = second.map(|end| end[axis]);
            above(0.5 * (other_high - other_low), 0.0);
            above(high - other_low, way[axis]);
            above(other_high - low, -way[axis]);
        }
        shift += *way;
        if from < to {
            let [from, to] = [from, to].map(|time| time + span as f64);
            match times.last_mut() {
                Some(last) if from <= last[1] + 1e-12 => last[1] = to,
                _ => times.push([from, to]),
            }
        }
    }
    times
}

/// A multiple of a quarter: faces meet exactly, and depths are exact.
fn quarters(random: &mut Random, low: f64, high: f64) -> f64 {
    (4.0 * random.between(low, high)).round() / 4.0
}

struct Boxes {
    body: Extent,
    obstacle: Extent,
    ways: Vec<DVec3>,
    depth: Option<f64>,
    /// The frame in which it is given, with turned and rounded coordinates.
    frame: Option<DMat3>,
}

fn boxes(seed: u64) -> Boxes {
    let mut random = Random::new(seed);
    let mut extent = |is_open: bool| -> Extent {
        let low = DVec3::from_array([0; 3].map(|_| quarters(&mut random, -1.5, 0.5)));
        let mut size = DVec3::from_array([0; 3].map(|_| quarters(&mut random, 0.25, 2.0)));
        if is_open {
            size[random.below(3)] = 0.0;
        }
        [low, low + size]
    };
    let is_open = seed % 4 == 3;
    let (body, obstacle) = (extent(false), extent(is_open));
    let mut body = body;
    // On one of the faces, in a corner of two, or elsewhere.
    for axis in 0..random.below(4) {
        let by = if random.chance(0.5) {
            obstacle[1][axis] - body[0][axis]
        } else {
            obstacle[0][axis] - body[1][axis]
        };
        body.iter_mut().for_each(|end| end[axis] += by);
    }
    let way = |random: &mut Random| {
        let mut way = DVec3::ZERO;
        for _ in 0..1 + random.below(3) {
            way[random.below(3)] = quarters(random, -2.0, 2.0);
        }
        way
    };
    let ways: Vec<DVec3> = (0..1 + random.below(4)).map(|_| way(&mut random)).collect();
    let depth = match random.below(5) {
        0 => None,
        1 => Some(random.magnitude(1e-9, 1e-3)),
        // Somewhere along its path it is exactly as deep as allowed.
        2 => Some(0.25),
        _ => Some(random.between(0.01, 0.6)),
    };
    let frame = random
        .chance(0.4)
        .then(|| DMat3::from_quat(random.rotation()));
    Boxes {
        body,
        obstacle,
        ways,
        depth,
        frame,
    }
}

#[test]
fn boxes_along_the_axes_are_entered_when_their_faces_say() {
    let wrong: Vec<String> = (0..240_u64)
        .into_par_iter()
        .filter_map(|seed| {
            let Boxes {
                body,
                obstacle,
                ways,
                depth,
                frame,
            } = boxes(seed);
            let spans = ways
                .iter()
                .map(|&way| Span::new(Generator::translation(way), 1.0).expect("finite"));
            let motion = Motion::from_spans(spans.collect()).expect("a motion");
            let mut scene = Scene::new(surface(body), motion, surface(obstacle));
            if let Some(turn) = frame {
                scene = scene.in_frame(&DAffine3::from_mat3(turn));
            }
            let check = scene.check(&deeper_than(depth));
            let depth = check.depths[0].expect("a depth");
            let (sinking, solid) = if scenes::is_closed(&surface(obstacle)) {
                (body, obstacle)
            } else {
                // A point of the rectangle in the body: relative to the body, it moves in the
                // opposite direction.
                (obstacle, body)
            };
            let sign = if sinking == body { 1.0 } else { -1.0 };
            let ways: Vec<DVec3> = ways.iter().map(|&way| sign * way).collect();
            let expected = times_in(sinking, solid, &ways, depth);
            let defects = defects(&check, &expected, FINE);
            (!defects.is_empty()).then(|| format!("{seed}: {defects}"))
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The times of up to three turns within a time of 1, from the angle 0 on, at which the cosine of
/// the angle plus a phase exceeds a level, in order.
fn above(level: f64, phases: &[f64], turns: f64) -> Vec<[f64; 2]> {
    let half = level.acos();
    let mut times: Vec<[f64; 2]> = Vec::new();
    for phase in phases {
        for turn in -1..=4 {
            let middle = f64::from(turn) - phase / TAU;
            let [from, to] = [-half, half].map(|by| ((middle + by / TAU) / turns).clamp(0.0, 1.0));
            if from < to {
                times.push([from, to]);
            }
        }
    }
    times.sort_by(|a, b| a[0].total_cmp(&b[0]));
    times
}

#[test]
fn corners_that_turn_through_a_wall_are_in_it_as_often_as_they_pass() {
    // A square bar about the z axis, its edges at a distance of 1, and a wall from x = 0.9 on.
    let half = 0.5_f64.sqrt();
    let bar = shapes::cuboid(DVec3::new(-half, -half, -1.0), DVec3::new(half, half, 1.0));
    let wall = shapes::cuboid(DVec3::new(0.9, -3.0, -2.0), DVec3::new(2.9, 3.0, 2.0));
    let phases = [0.25, 0.75, 1.25, 1.75].map(|part| part * PI);
    for (turns, passages) in [(1.0, 4), (2.5, 10)] {
        let generator = Generator::screw(DVec3::Z, DVec3::ZERO, turns * TAU, 0.0, 1.0);
        let span = Span::new(generator, 1.0).expect("finite");
        let motion = Motion::from_spans(vec![span]).expect("a motion");
        let scene = Scene::new(bar.clone(), motion, wall.clone());
        for depth in [1e-6, 0.03, 0.0999] {
            let expected = above(0.9 + depth, &phases, turns);
            assert_eq!(expected.len(), passages, "so often");
            let check = scene.check(&deeper_than(Some(depth)));
            assert_eq!(defects(&check, &expected, FINE), "", "{turns}, {depth}");
        }
        let check = scene.check(&deeper_than(Some(0.1 + 1e-9)));
        assert_eq!(defects(&check, &[], FINE), "", "never as deep");
    }
}

#[test]
fn an_absence_of_a_millionth_is_found() {
    // The corner of a square bar comes out of a wall briefly, and goes back in: its depth is a
    // cosine, from half a turn before its minimum to half a turn after.
    let bar = shapes::cuboid(DVec3::new(-0.1, -0.1, -1.0), DVec3::new(0.1, 0.1, 1.0));
    let bar = scenes::moved(bar, DVec3::X);
    let (angle, gap) = (2.0, 1e-6);
    let turn = Generator::screw(DVec3::Z, DVec3::ZERO, angle, 0.0, 1.0);
    let start = DMat3::from_rotation_z(PI - 0.5 * angle);
    let body = shapes::mapped(bar, |p| start * p);
    // The deepest corner is the farther one of those at the outer radius; or of those at the inner
    // one, while it is about x = -1.
    let corners = [(1.1, 0.1), (1.1, -0.1), (0.9, 0.1), (0.9, -0.1)];
    let highest = |time: f64| {
        let angle = PI - 0.5 * angle + angle * time;
        let x = |&(x, y): &(f64, f64)| x * angle.cos() - y * angle.sin();
        corners.iter().map(x).fold(f64::NEG_INFINITY, f64::max)
    };
    // The wall is where x >= level; it leaves for `gap` about half time.
    let depth = 0.1;
    let level = highest(0.5 - 0.5 * gap) - depth;
    let wall = shapes::cuboid(
        DVec3::new(level, -4.0, -2.0),
        DVec3::new(level + 9.0, 4.0, 2.0),
    );
    let span = Span::new(turn, 1.0).expect("finite");
    let motion = Motion::from_spans(vec![span]).expect("a motion");
    let check = Scene::new(body, motion, wall).check(&deeper_than(Some(depth)));
    let expected = [[0.0, 0.5 - 0.5 * gap], [0.5 + 0.5 * gap, 1.0]];
    assert_eq!(defects(&check, &expected, FINE), "");
}

#[test]
fn what_slides_barely_too_deep_is_followed_all_the_way() {
    // Under a ridge that passes along the body, no point of the body is deep for long; in a plate,
    // no point of the obstacle is.
    let plate = shapes::cuboid(DVec3::new(-4.0, -1.0, 0.0), DVec3::new(4.0, 1.0, 1.0));
    let roof = shapes::mapped(shapes::cuboid(DVec3::splat(-1.0), DVec3::splat(1.0)), |p| {
        DMat3::from_rotation_y(PI / 4.0) * p
    });
    let top = 2.0_f64.sqrt();
    for excess in [1e-3, 1e-9] {
        let depth = 0.1;
        // As deep as the faces of the roof are below its ridge.
        let sunk = top - (depth + excess) * top;
        let start = DVec3::new(-2.0, 0.0, sunk);
        let ways = [DVec3::X * 4.0, DVec3::Z * top * excess, DVec3::Z];
        let spans = ways.map(|way| Span::new(Generator::translation(way), 1.0).expect("finite"));
        let motion = Motion::from_spans(spans.to_vec()).expect("a motion");
        let body = scenes::moved(plate.clone(), start);
        let check = Scene::new(body, motion, roof.clone()).check(&deeper_than(Some(depth)));
        // It comes out slowly: rounding of positions decides for some time.
        let within = FINE.max(1e-13 / excess);
        assert_eq!(defects(&check, &[[0.0, 2.0]], within), "", "{excess}");
    }
}
