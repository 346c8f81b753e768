//! Laws that every sweep obeys: change of frame, of units, of the sense of time, and of the time at
//! which a span is cut.

#![allow(clippy::cast_possible_truncation, reason = "indices into small lists")]

use crate::support::random::pseudo_random;
use crate::support::shapes;
use crate::support::sweep::{Case, case, general_affine, mesh, motion, screw, swept};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use manifold_rust::manifold::Manifold;
use manifold_rust::types::{Error, MeshGL64, OpType};
use steadysweep::Sweep;
use steadysweep::body::Mesh;
use steadysweep::bounds::{Location, SurfaceTree};
use steadysweep::motion::{Generator, Motion};
use steadysweep::solid::spatial::Solid;

const RELATIVE_TOLERANCE: f64 = 5e-3;

/// Cases with different outcomes: a plain tube, a hole that closes, a cavity that stays, chains,
/// sheets that meet.
fn cases() -> Vec<Case> {
    [
        "ball_helix",
        "cone_spiral",
        "hole_swept_shut_by_a_screw",
        "cavity_kept",
        "torus_affine",
        "l_shear",
        "l_keyframes",
        "u_tilted_screw",
        "ball_full_turn",
    ]
    .map(case)
    .into()
}

/// The spans' generators, each over its whole span.
fn generators(motion: &Motion) -> Vec<Generator> {
    let spans = motion.spans().iter();
    spans.map(|span| *span.flow().generator()).collect()
}

fn at_start(case: &Case) -> Mesh {
    case.mesh().transformed(case.motion.start_pose())
}

/// Checks that two sweeps are the same solid, where lengths in the second are `scale` times those
/// in the first.
fn assert_same(name: &str, one: &Sweep, other: &Sweep, scale: f64) {
    let [a, b] = [one, other].map(|sweep| *sweep.solid.measures());
    assert_eq!(
        [a.components, a.voids, a.genus],
        [b.components, b.voids, b.genus],
        "{name}: components, voids, genus"
    );
    assert!(
        b.watertight && b.manifold,
        "{name}: {} touching edges",
        b.touching_edges
    );
    let allowed = |sweep: &Sweep, area: f64| {
        let bound = sweep.error_bound;
        (bound.inside.length + bound.outside.length) * area
    };
    let allowed = allowed(one, a.area) * scale.powi(3) + allowed(other, b.area);
    let difference = (a.volume * scale.powi(3) - b.volume).abs();
    assert!(
        difference <= allowed,
        "{name}: volumes differ by {difference:e}, {allowed:e} is allowed"
    );
}

fn sweep_of(body: &Mesh, generators: &[Generator], relative: f64) -> Sweep {
    swept(body, &motion(generators), relative * body.diagonal())
}

#[test]
fn a_rigid_change_of_frame_carries_the_solid_along() {
    let frame = DAffine3::from_rotation_translation(
        DQuat::from_axis_angle(DVec3::new(0.4, -1.0, 0.3).normalize(), 2.3),
        DVec3::new(5.0, -3.0, 7.0),
    );
    for case in cases() {
        let body = at_start(&case);
        let tolerance = RELATIVE_TOLERANCE * body.diagonal();
        let plain = generators(&case.motion);
        let moved: Vec<Generator> = plain
            .iter()
            .map(|generator| generator.in_frame(&frame.inverse()))
            .collect();
        let here = swept(&body, &motion(&plain), tolerance);
        let there = swept(&body.transformed(&frame), &motion(&moved), tolerance);
        assert_same(case.name, &here, &there, 1.0);
    }
}

#[test]
fn other_units_scale_the_solid() {
    for case in cases() {
        let body = at_start(&case);
        let plain = generators(&case.motion);
        let here = sweep_of(&body, &plain, RELATIVE_TOLERANCE);
        for unit in [1e3, 1e-3] {
            let scaled: Vec<Generator> = plain
                .iter()
                .map(|generator| Generator {
                    linear: generator.linear,
                    offset: generator.offset * unit,
                })
                .collect();
            let scale = DAffine3::from_scale(DVec3::splat(unit));
            let there = sweep_of(&body.transformed(&scale), &scaled, RELATIVE_TOLERANCE);
            assert_same(&format!("{} x {unit}", case.name), &here, &there, unit);
        }
    }
}

#[test]
fn time_reversed_from_the_end_pose_gives_the_same_solid() {
    for case in cases() {
        let body = at_start(&case);
        let tolerance = RELATIVE_TOLERANCE * body.diagonal();
        let forward = generators(&case.motion);
        let backward: Vec<Generator> = forward.iter().rev().map(|g| g.scaled(-1.0)).collect();
        let end = case.motion.joints().last().expect("a motion has joints");
        let here = swept(&body, &motion(&forward), tolerance);
        let there = swept(&body.transformed(end), &motion(&backward), tolerance);
        assert_same(case.name, &here, &there, 1.0);
    }
}

fn as_manifold(solid: &Solid) -> Manifold {
    let surface = MeshGL64 {
        num_prop: 3,
        vert_properties: solid.positions().iter().flat_map(DVec3::to_array).collect(),
        tri_verts: solid
            .triangles()
            .iter()
            .flatten()
            .map(|&v| u64::from(v))
            .collect(),
        ..MeshGL64::default()
    };
    Manifold::from_mesh_gl64_robust(&surface)
}

#[test]
fn two_sweeps_one_after_the_other_are_the_sweep_of_the_whole_time() {
    let l = shapes::l_prism(0.3, 0.5);
    let beside = screw(DVec3::Z, DVec3::new(-1.5, 0.2, 0.0), 1.8, 0.6, 0.8);
    for (name, generator, share) in [("spiral", beside, 0.37), ("affine", general_affine(), 0.61)] {
        let body = mesh(&l);
        let tolerance = RELATIVE_TOLERANCE * body.diagonal();
        let whole = swept(&body, &motion(&[generator]), tolerance);
        let first = generator.scaled(share);
        let middle = *motion(&[first]).joints().last().expect("there is an end");
        let before = swept(&body, &motion(&[first]), tolerance);
        let rest = motion(&[generator.scaled(1.0 - share)]);
        let after = swept(&body.transformed(&middle), &rest, tolerance);
        let union = as_manifold(&before.solid).boolean(&as_manifold(&after.solid), OpType::Add);
        assert!(union.status() == Error::NoError, "the union must succeed");
        let allowed: f64 = [&whole, &before, &after]
            .iter()
            .map(|sweep| {
                let bound = sweep.error_bound;
                (bound.inside.length + bound.outside.length) * sweep.solid.measures().area
            })
            .sum();
        let whole = whole.solid.measures();
        let difference = (union.volume() - whole.volume).abs();
        assert!(
            difference <= allowed,
            "{name}: {difference:e}, {allowed:e} allowed"
        );
        assert!(
            union.volume() > before.solid.measures().volume,
            "{name}: a longer time sweeps more"
        );

        // The same time in two spans.
        let chain = motion(&[first, generator.scaled(1.0 - share)]);
        let chain = swept(&body, &chain, tolerance);
        let difference = (chain.solid.measures().volume - whole.volume).abs();
        assert!(
            difference <= allowed,
            "{name} in two spans: {difference:e}, {allowed:e} allowed"
        );
    }
}

#[test]
fn the_sweep_contains_the_body_at_every_time() {
    for case in cases() {
        let sweep = case.sweep(RELATIVE_TOLERANCE);
        let tree = SurfaceTree::new(sweep.solid.positions(), sweep.solid.triangles());
        let end = *case.motion.joint_times().last().expect("there is a clock");
        let mut numbers = pseudo_random(5);
        let mut number = || numbers.next().expect("endless");
        for k in 0..2000 {
            // Round times first: joints and ends.
            let time = if k < 500 {
                end * f64::from(k % 13) / 12.0
            } else {
                end * number()
            };
            let triangle = case.shape.1[(number() * case.shape.1.len() as f64) as usize]
                .map(|corner| case.shape.0[corner as usize]);
            let on_body = triangle[0]
                .lerp(triangle[1], number())
                .lerp(triangle[2], number());
            let point = case.motion.pose_at_time(time).transform_point3(on_body);
            if tree.locate(point) == Location::Outside {
                let out = tree.distance_to_surface(point);
                let bound = sweep.error_bound.inside.length;
                assert!(
                    out <= bound,
                    "{}: the body at {time} reaches out by {out:e}, stated {bound:e}",
                    case.name
                );
            }
        }
    }
}

#[test]
fn a_body_that_turns_about_its_axis_of_symmetry_by_a_symmetry_is_swept_as_by_any_other_start() {
    // The cube may start at any of its four positions.
    let cube = case("cube_quarter_turn");
    let quarter = DMat3::from_rotation_z(std::f64::consts::FRAC_PI_2);
    let start = DAffine3::from_mat3(quarter);
    let here = cube.sweep(RELATIVE_TOLERANCE);
    let there = sweep_of(
        &cube.mesh().transformed(&start),
        &generators(&cube.motion),
        RELATIVE_TOLERANCE,
    );
    assert_same("cube", &here, &there, 1.0);
}
