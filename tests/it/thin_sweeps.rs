//! Bodies thinner than the sampling error: their sampled sheets pass through each other. The bound
//! must include the resulting loss, and must be within the tolerance.

#![allow(clippy::cast_possible_truncation, reason = "indices into small lists")]

use crate::support::random::pseudo_random;
use crate::support::shapes::{self, Shape};
use glam::{DAffine3, DQuat, DVec3};
use rayon::prelude::*;
use steadysweep::body::Mesh;
use steadysweep::bounds::{Location, SurfaceTree};
use steadysweep::motion::{Generator, Keyframe, Motion, Span};
use steadysweep::{SweepSettings, sweep};

/// Number of points of the moving body per case.
const POINTS: usize = 20_000;

fn thin_bodies() -> Vec<(&'static str, Shape)> {
    let turn = DQuat::from_scaled_axis(DVec3::new(0.4, -1.1, 0.7));
    let thin = |x: f64, y: f64, z: f64| {
        let half = DVec3::new(x, y, z) / 2.0;
        shapes::mapped(shapes::cuboid(-half, half), |p| turn * p)
    };
    vec![
        ("needle", thin(1.0, 1e-4, 1e-4)),
        ("blade", thin(1.0, 0.1, 1e-5)),
        ("plate", thin(1.0, 0.8, 1e-3)),
        ("stick", thin(1.0, 5e-3, 5e-3)),
        (
            "spike",
            shapes::mapped(shapes::cone(1e-3, 1.0, 7), |p| turn * p),
        ),
    ]
}

fn motions() -> Vec<(&'static str, Motion)> {
    let axis = DVec3::new(0.2, -0.1, 1.0).normalize();
    let steady = |generator: Generator| {
        let span = Span::new(generator, 1.0).expect("a span");
        Motion::from_spans(vec![span]).expect("a motion")
    };
    let pose = |time: f64, turn: DVec3, way: DVec3| Keyframe {
        time,
        pose: DAffine3::from_rotation_translation(DQuat::from_scaled_axis(turn), way),
    };
    let keys = [
        pose(0.0, DVec3::ZERO, DVec3::ZERO),
        pose(1.0, DVec3::new(0.3, 1.2, -0.2), DVec3::new(0.6, 0.2, 0.1)),
        pose(2.0, DVec3::new(1.0, 0.5, 0.9), DVec3::new(0.9, 0.8, 0.3)),
        pose(3.0, DVec3::new(-0.4, 0.1, 1.6), DVec3::new(0.1, 1.1, 0.2)),
    ];
    vec![
        (
            "screw",
            steady(Generator::screw(axis, DVec3::X, 3.0, 0.5, 1.0)),
        ),
        (
            "on the spot",
            steady(Generator::screw(axis, DVec3::ZERO, 5.0, 0.1, 1.0)),
        ),
        (
            "spiral",
            steady(Generator::screw(axis, DVec3::Y * 0.7, 2.0, 0.0, 0.4)),
        ),
        ("chain", Motion::from_keyframes(&keys).expect("a motion")),
    ]
}

#[test]
fn what_a_thin_body_loses_is_within_the_bound() {
    let mut cases = Vec::new();
    for body in thin_bodies() {
        for motion in motions() {
            for tolerance in [1e-2, 1e-3] {
                cases.push((body.clone(), motion.clone(), tolerance));
            }
        }
    }
    let complaints: Vec<String> = cases
        .par_iter()
        .filter_map(|((name, shape), (way, motion), tolerance)| {
            let body = Mesh::new(shape.0.clone(), shape.1.clone()).expect("a body");
            let settings = SweepSettings::default().with_tolerance(*tolerance);
            let swept = sweep(&body, motion, &settings).expect("a sweep");
            let solid = &swept.solid;
            let tree = SurfaceTree::new(solid.positions(), solid.triangles());
            let [start, end] = [0, motion.spans().len()].map(|k| motion.joint_times()[k]);
            let mut numbers = pseudo_random(7);
            let mut number = || numbers.next().expect("endless");
            let mut lost = 0.0_f64;
            for _ in 0..POINTS {
                // All these bodies are convex: means of four corners are inside.
                let mut corner = || {
                    let k = (number() * body.positions().len() as f64) as usize;
                    body.positions()[k]
                };
                let [a, b, c, d] = [corner(), corner(), corner(), corner()];
                let (s, t, u) = (number(), number(), number());
                let inside = a.lerp(b, s).lerp(c.lerp(d, t), u);
                let time = start + (end - start) * number();
                let point = motion.pose_at_time(time).transform_point3(inside);
                if tree.locate(point) == Location::Outside {
                    lost = lost.max(tree.distance_to_surface(point));
                }
            }
            let bound = swept.error_bound.inside.length;
            let case = format!("{name}, {way}, {tolerance}: lost {lost:.2e}, bound {bound:.2e}");
            println!("{case}");
            (lost > bound || bound > *tolerance).then_some(case)
        })
        .collect();
    assert!(complaints.is_empty(), "{complaints:#?}");
}
