//! Bodies thinner than the sampling error: their sampled sheets pass through each other. The bound
//! must include the resulting loss, and must be within the tolerance.

#![allow(clippy::cast_possible_truncation, reason = "indices into small lists")]

use crate::support::random::pseudo_random;
use crate::support::shapes::{self, Shape};
use glam::{DAffine3, DQuat, DVec3};
use rayon::prelude::*;
use steadysweep::body::{Mesh, defects};
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

/// Along its own sides, a frame passes over its hole twice: between the two sheets, and vertices
/// that were moved to be apart, was a cavity of a mean thickness of 6e-12, which no reader accepts.
#[test]
fn a_cavity_of_rounding_between_two_sheets_is_filled() {
    let positions = [
        [
            -0.4817622866621079,
            -0.5209137500629519,
            -0.24301021407638299,
        ],
        [
            0.5173486732704354,
            -0.48011927544232924,
            -0.2536450898678172,
        ],
        [0.4765169023512448, 0.5190412652330291, -0.2569587647052941],
        [
            -0.5225940575812985,
            0.4782467906124064,
            -0.24632388891385987,
        ],
        [-0.4765169023512448, -0.5190412652330291, 0.2569587647052941],
        [0.5225940575812985, -0.4782467906124064, 0.24632388891385987],
        [0.4817622866621079, 0.5209137500629519, 0.24301021407638299],
        [-0.5173486732704354, 0.48011927544232924, 0.2536450898678172],
        [
            -0.24219248940876972,
            -0.2609249962389567,
            -0.24649735173361076,
        ],
        [
            0.25736299055750195,
            -0.24052775892864534,
            -0.25181478962932785,
        ],
        [0.2369471050979066, 0.2590525114090338, -0.2534716270480663],
        [-0.262608374868365, 0.23865527409872248, -0.2481541891523492],
        [-0.2369471050979066, -0.2590525114090338, 0.2534716270480663],
        [0.262608374868365, -0.23865527409872248, 0.2481541891523492],
        [0.24219248940876972, 0.2609249962389567, 0.24649735173361076],
        [
            -0.25736299055750195,
            0.24052775892864534,
            0.25181478962932785,
        ],
    ]
    .map(DVec3::from_array);
    // Of each side of the frame: its corners outside, and those of the hole.
    let triangles = (0..4).flat_map(|i| {
        let j = (i + 1) % 4;
        let quads = [
            [i, j, j + 4, i + 4],
            [j + 8, i + 8, i + 12, j + 12],
            [i + 4, j + 4, j + 12, i + 12],
            [j, i, i + 8, j + 8],
        ];
        quads
            .into_iter()
            .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
    });
    let frame = Mesh::new(positions.to_vec(), triangles.collect()).expect("a frame is a body");
    let displacements = [
        [
            -0.9991109599325434,
            -0.04079447462062269,
            0.010634875791434212,
        ],
        [0.8983236237445745, 0.03816248868985877, 0.43767372719802644],
        [
            0.10078733618796887,
            0.0026319859307639207,
            -0.4483086029894606,
        ],
    ];
    let spans = displacements.map(|by| {
        let translation = Generator::translation(DVec3::from_array(by));
        Span::new(translation, 1.0).expect("a span")
    });
    let motion = Motion::from_spans(spans.to_vec()).expect("a motion");
    let settings = SweepSettings::default().with_tolerance(0.03 * frame.diagonal());
    let sweep = sweep(&frame, &motion, &settings).expect("a legal sweep succeeds");
    let found = defects(sweep.solid.positions(), sweep.solid.triangles());
    assert!(found.is_empty(), "{found:?}");
    assert_eq!(sweep.solid.measures().voids, 0);
    let bound = sweep.error_bound.outside.length;
    assert!(bound < 1e-8, "rounding, and distances of vertices: {bound}");
}
