//! Bodies that turn about their own axis, where the sheets of all facets lie on each other; and
//! bodies whose corners nearly lie on the axis.

use crate::support::shapes::{Shape, cone, l_prism, mapped, prism, torus};
use crate::support::sweep::{mesh, motion, screw, swept};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;
use steadysweep::Sweep;

/// Tolerance as a share of the diagonal.
const TOLERANCE: f64 = 1e-3;

fn turned(shape: &Shape, turn: f64) -> Sweep {
    let mesh = mesh(shape);
    let turn = motion(&[screw(DVec3::Z, DVec3::ZERO, turn, 0.0, 1.0)]);
    swept(&mesh, &turn, TOLERANCE * mesh.diagonal())
}

/// The shape as stored with 32-bit coordinates: corners are no longer images of each other.
fn stored(shape: Shape) -> Shape {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the rounding is what is wanted"
    )]
    mapped(shape, |p| p.map(|x| f64::from(x as f32)))
}

/// A round bar about the z axis.
fn bar(sides: u32, radius: f64, height: f64) -> Shape {
    let corner = |i: u32| radius * DVec2::from_angle(TAU * f64::from(i) / f64::from(sides));
    prism(&(0..sides).map(corner).collect::<Vec<_>>(), height)
}

#[test]
fn round_bars_about_their_own_axis_are_cylinders_of_few_triangles() {
    // A full turn covers the circumscribed cylinder; the chords of the result lose at most the
    // tolerance on its side. The result has the steps of one sheet, at most 100 for this tolerance,
    // not those of all sheets in all their phases: the limit of a hundred triangles per step is far
    // above the one and far below the other.
    for sides in [8, 24, 48] {
        let (radius, height) = (0.5, 1.0);
        let sweep = turned(&stored(bar(sides, radius, height)), TAU);
        let measures = sweep.solid.measures();
        let full = 0.5 * TAU * radius * radius * height;
        let loss = TAU * radius * height * sweep.error_bound.inside.length;
        assert!(
            measures.volume <= full * (1.0 + 1e-6) && measures.volume >= full - loss,
            "{sides} sides: {} against {full} less {loss}",
            measures.volume
        );
        assert_eq!(
            [measures.components, measures.voids, measures.genus],
            [1, 0, 0],
            "{sides} sides"
        );
        let triangles = sweep.solid.triangles().len();
        assert!(triangles < 10_000, "{sides} sides: {triangles} triangles");
    }
}

#[test]
fn cones_and_tori_about_their_own_axis_take_no_more_than_their_size() {
    // These took minutes and gigabytes when all sheets crossed each other.
    for (shape, genus) in [(cone(0.5, 1.0, 24), 0), (torus(1.0, 0.3, 48, 20), 1)] {
        for turn in [TAU, TAU / 3.0, 5.0] {
            let sweep = turned(&stored(shape.clone()), turn);
            let measures = sweep.solid.measures();
            assert_eq!(
                [measures.components, measures.voids, measures.genus],
                [1, 0, genus],
                "turn by {turn}"
            );
            assert!(measures.watertight, "turn by {turn}");
            let triangles = sweep.solid.triangles().len();
            assert!(triangles < 20_000, "turn by {turn}: {triangles} triangles");
        }
    }
}

#[test]
fn a_unit_that_rounds_a_corner_off_the_axis_changes_nothing() {
    // The axis passes exactly through a corner of the L; the units 25.4 and 0.001 move the corner
    // off it by a rounding.
    let volume = |unit: f64| {
        let body = mesh(&stored(mapped(l_prism(1.0 / 3.0, 1.0 / 3.0), |p| {
            3.0 * p * unit
        })));
        let axis = DVec3::new(1.0, 2.0, 3.0);
        let turn = motion(&[screw(
            axis,
            3.0 * unit * DVec3::X,
            100_f64.to_radians(),
            0.0,
            1.0,
        )]);
        let sweep = swept(&body, &turn, TOLERANCE * body.diagonal());
        assert!(sweep.solid.measures().watertight, "unit {unit}");
        sweep.solid.measures().volume / unit.powi(3)
    };
    let plain = volume(1.0);
    for unit in [25.4, 0.001, 3.0] {
        let other = volume(unit);
        // Coordinates are off by 2^-24 of the size, 3; the area is below 100.
        assert!(
            (other - plain).abs() < 1e-4 * plain,
            "unit {unit}: {other} against {plain}"
        );
    }
}
