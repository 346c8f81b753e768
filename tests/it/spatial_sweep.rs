//! Sweeps in three dimensions: topology, agreement with the exact motion of points, and volume,
//! case by case and at tolerances of 1e-2, 1e-3 and 1e-4 of the body's diagonal.

use crate::support::shapes;
use crate::support::sweep::{Case, Reference, case, mesh, motion, screw, swept};
use glam::DVec3;

/// Number of points at which each solid is compared with the exact motion.
const POINTS: usize = 10_000;

/// Checks everything that is known about a case at relative tolerances, and returns the defects.
fn defects(case: &Case, tolerances: &[f64]) -> Vec<String> {
    let reference = Reference::new(&case.mesh(), &case.motion, 100_000);
    let mut defects = Vec::new();
    for &relative in tolerances {
        let sweep = case.sweep(relative);
        let found = case.topology_defects(&sweep)
            + &case.agreement(&sweep, POINTS).defects(&sweep)
            + &reference.volume_defects(&sweep);
        if !found.is_empty() {
            defects.push(format!("{} at {relative:e}: {found}", case.name));
        }
    }
    defects
}

fn check(tolerances: &[f64], names: &[&str]) {
    let defects: Vec<String> = names
        .iter()
        .flat_map(|name| defects(&case(name), tolerances))
        .collect();
    assert!(defects.is_empty(), "{defects:#?}");
}

const COARSE: &[f64] = &[1e-2];
const TO_MEDIUM: &[f64] = &[1e-2, 1e-3];
const TO_FINE: &[f64] = &[1e-2, 1e-3, 1e-4];

#[test]
fn straight_motions_are_exact_at_every_tolerance() {
    check(
        TO_FINE,
        &[
            "cube_skew_translation",
            "cube_along_its_edge",
            "cube_at_rest",
            "cube_square_path",
            "torus_translated",
            "ball_growing",
        ],
    );
}

#[test]
fn holes_stay_or_are_swept_shut() {
    check(
        TO_FINE,
        &["hole_kept", "hole_swept_shut", "hole_swept_shut_by_a_screw"],
    );
    check(TO_MEDIUM, &["hole_becomes_a_void"]);
}

#[test]
fn cavities_stay_or_are_swept_shut() {
    check(
        TO_FINE,
        &["cavity_kept", "cavity_swept_shut", "cavity_kept_by_a_turn"],
    );
}

#[test]
fn open_bodies_close_round_a_cavity() {
    check(TO_MEDIUM, &["cup_closes_round_a_cavity"]);
}

#[test]
fn tubes_of_a_ball_have_no_handles_and_no_pockets() {
    check(
        TO_FINE,
        &["ball_helix", "ball_log_spiral", "ball_keyframes"],
    );
}

#[test]
fn whole_turns_give_rings() {
    check(TO_MEDIUM, &["ball_full_turn", "ball_two_turns"]);
    check(TO_MEDIUM, &["cube_off_axis_full_turn"]);
}

#[test]
fn a_cube_that_turns_on_the_spot_is_a_cylinder_in_topology() {
    check(TO_FINE, &["cube_quarter_turn"]);
    check(TO_MEDIUM, &["cube_five_radians", "tilted_cube_full_turn"]);
    check(TO_FINE, &["cube_full_turn", "cube_two_turns"]);
}

#[test]
fn bodies_that_slide_in_themselves_gain_no_handles() {
    check(TO_MEDIUM, &["ball_through_itself", "ring_closes"]);
    check(
        COARSE,
        &[
            "ball_own_axis",
            "ball_own_axis_advancing",
            "hollow_torus",
            "hollow_torus_screw",
        ],
    );
}

#[test]
fn cones_are_swept_round_their_tips() {
    check(COARSE, &["cone_on_its_axis"]);
    check(TO_MEDIUM, &["cone_on_a_tilted_axis"]);
    check(TO_FINE, &["cone_spiral"]);
}

#[test]
fn concave_bodies_are_swept_by_screws_and_shears() {
    check(
        TO_FINE,
        &[
            "u_tilted_screw",
            "l_shear",
            "torus_affine",
            "u_in_its_plane",
        ],
    );
}

#[test]
fn bumpy_bodies_have_no_spurious_pockets() {
    check(TO_MEDIUM, &["bumpy_screw", "bumpy_spiral", "bumpy_affine"]);
}

/// Sheets lie on or near one another, and points rest: there the result is connected by bridges,
/// and pierced by holes, that only sampling and rounding made.
#[test]
fn bodies_on_their_own_axes_have_no_spurious_handles() {
    check(TO_FINE, &["cube_on_its_edges", "l_on_a_tilted_axis"]);
    check(TO_MEDIUM, &["cube_on_its_corners", "l_on_its_corner"]);
    check(
        COARSE,
        &["cone_on_an_axis_through_its_base", "bumpy_on_the_spot"],
    );
}

#[test]
fn chains_meet_without_a_seam() {
    check(
        TO_FINE,
        &["box_keyframes", "l_keyframes", "cube_rest_in_the_middle"],
    );
    check(TO_MEDIUM, &["cube_there_and_back"]);
}

/// At the end the body is of the size of rounding: its shell may be turned inside out there, and is
/// no cavity then.
#[test]
fn a_body_that_shrinks_to_a_point_leaves_no_shell_inside_out() {
    let [low, high] = [DVec3::new(84.0, -44.0, 0.0), DVec3::new(96.0, -32.0, 70.0)];
    let body = mesh(&shapes::cuboid(low, high));
    for scale in [1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11] {
        let shrinking = motion(&[screw(DVec3::Z, DVec3::ZERO, 0.0, 0.0, scale)]);
        let measures = *swept(&body, &shrinking, 0.1).solid.measures();
        let topology = [measures.components, measures.voids, measures.genus];
        assert_eq!(topology, [1, 0, 0], "scale {scale:e}");
    }
}
