//! Sweeps in the plane: areas against closed forms, holes and pieces, and agreement with the exact motion of points.

use glam::DVec2;
use std::f64::consts::{PI, TAU};
use steadysweep::body::{FillRule, Polygon};
use steadysweep::motion::planar::{Generator, Motion, Span};
use steadysweep::planar::{Sweep, SweepSettings, sweep};

fn polygon(loops: &[&[[f64; 2]]]) -> Polygon {
    let loops = loops
        .iter()
        .map(|outline| outline.iter().map(|&p| DVec2::from_array(p)).collect())
        .collect();
    Polygon::new(loops, FillRule::EvenOdd).expect("the shapes are bodies")
}

fn disc(corners: u32, centre: DVec2, radius: f64) -> Polygon {
    let outline = (0..corners)
        .map(|i| centre + radius * DVec2::from_angle(f64::from(i) / f64::from(corners) * TAU))
        .collect();
    Polygon::new(vec![outline], FillRule::EvenOdd).expect("a disc is a body")
}

fn motion(generators: &[Generator]) -> Motion {
    let spans = generators
        .iter()
        .map(|&generator| Span::new(generator, 1.0).expect("finite"))
        .collect();
    Motion::from_spans(spans).expect("a legal motion")
}

fn turn(angle: f64, through: [f64; 2]) -> Motion {
    motion(&[Generator::spiral(DVec2::from_array(through), angle, 1.0)])
}

fn swept(body: &Polygon, motion: &Motion, relative: f64) -> Sweep {
    let settings = SweepSettings {
        tolerance: Some(relative * body.diagonal()),
    };
    sweep(body, motion, &settings, &|_| {}).expect("a legal sweep succeeds")
}

/// Checks area, pieces and holes at three tolerances, against bounds of the exact area.
fn check(body: &Polygon, motion: &Motion, area: [f64; 2], pieces: usize, holes: usize) {
    for relative in [1e-2, 1e-3, 1e-4] {
        let swept = swept(body, motion, relative);
        let found = &swept.measures;
        let bound = &swept.error_bound;
        println!(
            "{relative:e}: area {} of {area:?}, inside {:e} outside {:e} of {:e}, {} segments, {:?}",
            found.area,
            bound.inside.length,
            bound.outside.length,
            swept.tolerance,
            swept.cycle_segments,
            swept.seconds
        );
        // A layer along the boundary, round its corners too, and holes of that size.
        let layer = |width: f64| found.perimeter * width + PI * width * width;
        assert!(
            found.area >= area[0] - layer(bound.inside.length)
                && found.area <= area[1] + layer(bound.outside.length),
            "{relative:e}: area {} instead of {area:?}",
            found.area
        );
        assert!(
            bound.inside.proven && bound.outside.proven,
            "both bounds are proven"
        );
        assert!(
            bound.inside.length <= swept.tolerance && bound.outside.length <= swept.tolerance,
            "{relative:e}: {bound:?}"
        );
        assert_eq!(
            (found.pieces, found.holes),
            (pieces, holes),
            "{relative:e}: pieces and holes"
        );
    }
}

const SQUARE: &[[f64; 2]] = &[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

#[test]
fn a_translated_square_is_exact() {
    let across = motion(&[Generator::translation(DVec2::new(3.0, 1.0))]);
    // Area plus length of the way times the width across it: 4 + |(3, 1)| w, w = 2 (3 + 1) / |(3, 1)|.
    check(&polygon(&[SQUARE]), &across, [12.0; 2], 1, 0);
}

#[test]
fn a_square_that_turns_about_its_centre_sweeps_a_disc() {
    for turns in [0.25, 1.0, 3.0] {
        check(
            &polygon(&[SQUARE]),
            &turn(turns * TAU, [0.0; 2]),
            [TAU; 2],
            1,
            0,
        );
    }
}

#[test]
fn a_needle_that_turns_about_its_end_sweeps_a_sector() {
    // Both long sides through the centre's neighbourhood: width w, the sector of angle a and the needle itself.
    let needle = polygon(&[&[[0.0, 0.0], [1.0, -1e-5], [1.0, 1e-5]]]);
    let area = 0.5 * (1.0 + 1e-10);
    check(&needle, &turn(1.0, [0.0; 2]), [area, area + 2e-5], 1, 0);
}

#[test]
fn a_fine_disc_that_turns_about_its_centre_stays_a_disc() {
    for corners in [100, 1000] {
        check(
            &disc(corners, DVec2::ZERO, 1.0),
            &turn(1.0, [0.0; 2]),
            [disc(corners, DVec2::ZERO, 1.0).area(), PI],
            1,
            0,
        );
        check(
            &disc(corners, DVec2::ZERO, 1.0),
            &turn(3.0 * TAU, [0.0; 2]),
            [PI; 2],
            1,
            0,
        );
    }
}
