//! Finely tessellated bodies that slide along themselves, whose shallow folds are dropped; and
//! chains in which translations and turns alternate. What that loses must be within the bound, which
//! is proven. The points of the body itself are looked at, at many times: what is lost is swept by
//! its faces.

use crate::support::random::pseudo_random;
use crate::support::shapes::{Shape, bumpy_sphere, cone, icosphere, mapped, prism, torus};
use crate::support::sweep::{mesh, motion, screw, swept, translation};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::TAU;
use steadysweep::bounds::{Location, SurfaceTree};
use steadysweep::motion::Motion;

/// Number of points of the body, each at a time of its own, per case.
const POINTS: u32 = 10_000;

fn bodies() -> Vec<(&'static str, Shape)> {
    let corner = |i: u32| DVec2::from_angle(TAU * f64::from(i) / 40.0);
    let drum = prism(&(0..40).map(corner).collect::<Vec<_>>(), 0.8);
    let egg = icosphere(2, 1.0, DVec3::ZERO);
    vec![
        ("drum", drum),
        ("torus", torus(1.0, 0.4, 24, 12)),
        ("cone", cone(0.7, 1.5, 24)),
        ("bumpy", bumpy_sphere(600)),
        ("egg", mapped(egg, |p| p * DVec3::new(1.0, 0.8, 1.3))),
    ]
}

fn motions() -> Vec<(&'static str, Motion)> {
    let on_the_spot = |rise: f64| screw(DVec3::Z, DVec3::ZERO, 4.0, rise, 1.0);
    vec![
        ("spin", motion(&[on_the_spot(0.0)])),
        ("slow rise", motion(&[on_the_spot(0.05)])),
        (
            "growing",
            motion(&[screw(DVec3::Z, DVec3::ZERO, 3.0, 0.0, 1.3)]),
        ),
        (
            "round an axis",
            motion(&[screw(DVec3::Y, DVec3::X * 2.0, 2.0, 0.3, 1.0)]),
        ),
        (
            "chain",
            motion(&[
                translation(0.7, 0.0, 0.0),
                on_the_spot(0.1),
                translation(0.0, 0.0, -0.5),
                screw(DVec3::X, DVec3::Y, 1.0, 0.0, 0.8),
            ]),
        ),
    ]
}

#[test]
fn what_dropped_folds_lose_is_within_the_bound() {
    let mut cases = Vec::new();
    for body in bodies() {
        for motion in motions() {
            for tolerance in [3e-2, 1e-2] {
                cases.push((body.clone(), motion.clone(), tolerance));
            }
        }
    }
    let complaints: Vec<String> = cases
        .par_iter()
        .filter_map(|((name, shape), (course, motion), share)| {
            let body = mesh(shape);
            let tolerance = share * body.diagonal();
            let swept = swept(&body, motion, tolerance);
            let solid = &swept.solid;
            let tree = SurfaceTree::new(solid.positions(), solid.triangles());
            let times = motion.joint_times();
            let [start, end] = [times[0], times[times.len() - 1]];
            let mut numbers = pseudo_random(3);
            let mut number = || numbers.next().expect("endless");
            let mut lost = 0.0_f64;
            for point in 0..POINTS {
                let face = body.triangles()[point as usize % body.triangles().len()];
                let [a, b, c] = face.map(|v| body.positions()[v as usize]);
                let on = a.lerp(b, number()).lerp(c, number());
                let time = start + (end - start) * number();
                let at = motion.pose_at_time(time).transform_point3(on);
                if tree.locate(at) == Location::Outside {
                    lost = lost.max(tree.distance_to_surface(at));
                }
            }
            let bound = swept.error_bound.inside;
            let case = format!("{name}, {course}, {share}: lost {lost:.2e}, {bound:?}");
            println!("{case}");
            (lost > bound.length || !bound.proven).then_some(case)
        })
        .collect();
    assert!(complaints.is_empty(), "{complaints:#?}");
}
