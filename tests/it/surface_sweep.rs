//! The region swept by a sheet of space: closed forms, and the path of each point against the
//! sheet, step by step, without any winding number.

use crate::support::command::Scratch;
use crate::support::membership::exponential;
use crate::support::random::pseudo_random;
use crate::support::sweep::{motion, screw, translation};
use glam::{DAffine3, DVec3};
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_2, PI};
use steadysweep::body::Surface;
use steadysweep::bounds::SurfaceTree;
use steadysweep::motion::{Generator, Motion};
use steadysweep::{SurfaceSweepError, Sweep, SweepSettings, sweep_surface};

/// A sheet over [0, size] x [0, 1] of so many cells, at the given heights.
fn sheet(size: f64, cells: [u32; 2], height: impl Fn(f64, f64) -> f64) -> Surface {
    let [across, along] = cells;
    let mut positions = Vec::new();
    for y in 0..=along {
        for x in 0..=across {
            let [x, y] = [
                size * f64::from(x) / f64::from(across),
                f64::from(y) / f64::from(along),
            ];
            positions.push(DVec3::new(x, y, height(x, y)));
        }
    }
    let mut triangles = Vec::new();
    let row = across + 1;
    for corner in (0..along).flat_map(|y| (0..across).map(move |x| y * row + x)) {
        triangles.push([corner, corner + 1, corner + row + 1]);
        triangles.push([corner, corner + row + 1, corner + row]);
    }
    Surface::new(positions, triangles).expect("a sheet")
}

fn swept(surface: &Surface, motion: &Motion, tolerance: f64) -> Sweep {
    let settings = SweepSettings::default().with_tolerance(tolerance);
    let sweep = sweep_surface(surface, motion, &settings).expect("it sweeps a solid");
    let (bound, measures) = (sweep.error_bound, sweep.solid.measures());
    assert!(bound.inside.proven && bound.outside.proven, "{bound:?}");
    assert!(measures.watertight && measures.manifold, "{measures:?}");
    sweep
}

/// Checks a volume against the exact one, with the error that the bounds allow along the border.
#[track_caller]
fn check_volume(sweep: &Sweep, volume: f64) {
    let (bound, measures) = (sweep.error_bound, sweep.solid.measures());
    let error = bound.inside.length.max(bound.outside.length);
    let allowed = 1.2 * measures.area * error;
    let found = measures.volume;
    assert!(
        (found - volume).abs() <= allowed,
        "{found} instead of {volume} +- {allowed}"
    );
    assert_eq!((measures.components, measures.voids), (1, 0), "one piece");
}

#[test]
fn a_square_sweeps_a_box_and_a_sector() {
    let square = sheet(2.0, [1, 1], |_, _| 0.0);
    check_volume(
        &swept(&square, &motion(&[translation(0.3, 0.2, 1.5)]), 1e-3),
        3.0,
    );
    // Forth and back: crossings in opposite senses must not cancel.
    let back = motion(&[translation(0.3, 0.2, 1.5), translation(-0.3, -0.2, -1.5)]);
    check_volume(&swept(&square, &back, 1e-3), 3.0);
    // About one of its sides, and about its middle line, where one half moves up and one down.
    let side = screw(DVec3::Y, DVec3::ZERO, FRAC_PI_2, 0.0, 1.0);
    check_volume(&swept(&square, &motion(&[side]), 2e-3), PI);
    let middle = screw(DVec3::Y, DVec3::X, PI, 0.0, 1.0);
    check_volume(&swept(&square, &motion(&[middle]), 2e-3), PI);
}

#[test]
fn a_sheet_that_moves_along_itself_stays_a_plate() {
    let square = sheet(1.0, [2, 2], |_, _| 0.0);
    let sweep = swept(&square, &motion(&[translation(1.0, 0.0, 0.0)]), 1e-2);
    let measures = sweep.solid.measures();
    // 2 x 1, half of the tolerance thick.
    assert!((measures.volume - 2.0 * 5e-3).abs() < 1e-6, "{measures:?}");
    assert!(
        sweep.error_bound.outside.length <= 1e-2,
        "{:?}",
        sweep.error_bound
    );
}

/// Whether the segment from a to b crosses a triangle.
fn crosses([a, b]: [DVec3; 2], [p, q, r]: [DVec3; 3]) -> bool {
    let volume = |a: DVec3, b: DVec3, c: DVec3, d: DVec3| (b - a).cross(c - a).dot(d - a);
    if volume(p, q, r, a) * volume(p, q, r, b) > 0.0 {
        return false;
    }
    let sides = [volume(a, b, p, q), volume(a, b, q, r), volume(a, b, r, p)];
    sides.iter().all(|&v| v >= 0.0) || sides.iter().all(|&v| v <= 0.0)
}

/// The world as seen from the sheet, at equal steps of a chain of generators.
fn inverses(generators: &[Generator], steps: u32) -> Vec<DAffine3> {
    let mut start = DAffine3::IDENTITY;
    let mut inverses = Vec::new();
    let pose = |g: &Generator, s: f64| exponential(&g.linear, g.offset, s);
    for generator in generators {
        for step in 0..=steps {
            let share = f64::from(step) / f64::from(steps);
            inverses.push((pose(generator, share) * start).inverse());
        }
        start = pose(generator, 1.0) * start;
    }
    inverses
}

#[test]
fn bent_sheets_cover_what_crosses_them() {
    let mut random = pseudo_random(5);
    let mut next = move || 2.0 * random.next().expect("endless") - 1.0;
    let (mut inside, mut outside) = (0, 0);
    let bent = |x: f64, y: f64| 0.3 * (3.0 * x).sin() + 0.2 * x * y;
    let surface = sheet(1.5, [4, 3], bent);
    let turn = screw(
        DVec3::new(0.2, 1.0, 0.3),
        DVec3::new(0.7, 0.0, 0.1),
        1.9,
        0.4,
        1.2,
    );
    let shear = Generator::from_rows([
        [0.2, 0.3, -0.4, 0.3],
        [0.1, -0.3, 0.2, -0.2],
        [0.5, 0.1, 0.1, 0.9],
    ]);
    let shear = shear.expect("finite");
    for generators in [
        vec![turn],
        vec![shear],
        vec![translation(0.0, 0.1, 0.9), turn],
    ] {
        let sweep = swept(&surface, &motion(&generators), 1e-2);
        let tree = SurfaceTree::new(sweep.solid.positions(), sweep.solid.triangles());
        let seen = inverses(&generators, 1000);
        let triangles: Vec<[DVec3; 3]> = surface
            .triangles()
            .iter()
            .map(|t| t.map(|v| surface.positions()[v as usize]))
            .collect();
        let [low, high] = tree.bounds().expect("a solid");
        for _ in 0..400 {
            let share = DVec3::new(next(), next(), next()) * 0.55 + 0.5;
            let point = low + (high - low) * share;
            let path: Vec<DVec3> = seen.iter().map(|i| i.transform_point3(point)).collect();
            let is_crossed = path.windows(2).any(|step| {
                triangles
                    .iter()
                    .any(|&triangle| crosses([step[0], step[1]], triangle))
            });
            // A step of the path is off its chord by 1e-5 at most, times the growth of the motion.
            let (bound, distance) = (sweep.error_bound, tree.distance_to_surface(point));
            let is_inside = tree.winding_number(point).is_some_and(|w| w >= 1);
            if is_inside && distance > bound.outside.length + 1e-3 {
                assert!(is_crossed, "{point}, {distance} inside, is never crossed");
                inside += 1;
            } else if !is_inside && distance > bound.inside.length + 1e-3 {
                assert!(!is_crossed, "{point}, {distance} outside, is crossed");
                outside += 1;
            }
        }
    }
    assert!(inside > 150 && outside > 150, "{inside} {outside}");
}

#[test]
fn surfaces_and_tolerances_that_cannot_be_used_are_refused() {
    let square = sheet(1.0, [1, 1], |_, _| 0.0);
    let motion = motion(&[translation(0.0, 0.0, 1.0)]);
    let refused = |surface: &Surface, tolerance: f64| {
        let settings = SweepSettings::default().with_tolerance(tolerance);
        let error = sweep_surface(surface, &motion, &settings).expect_err("refused");
        (
            matches!(error, SurfaceSweepError::Thicken(_)),
            error.to_string(),
        )
    };
    assert!(
        refused(&square, -1.0).1.contains("not a positive length"),
        "negative"
    );
    let (_, rounding) = refused(&square, 1e-30);
    assert!(
        rounding.contains("1e-30") || rounding.contains("flat"),
        "{rounding}"
    );
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let twisted =
        Surface::new(corners.to_vec(), vec![[0, 1, 2], [0, 1, 3]]).expect("two triangles");
    let (is_surface, message) = refused(&twisted, 1e-3);
    assert!(is_surface && message.contains("edge 0-1"), "{message}");
}

#[test]
fn the_command_sweeps_open_meshes() {
    let scratch = Scratch::new("surface_sweep");
    scratch.write(
        "sheet.obj",
        "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 3 4\n",
    );
    let refused = scratch.run("sweep sheet.obj --translate 0,0,1");
    assert_eq!(
        refused.code,
        Some(2),
        "without --surface, an open mesh is refused"
    );
    let run = scratch.run("sweep sheet.obj --translate 0,0,1 --surface --json -o out.stl");
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{}", run.out);
    let report: Value = serde_json::from_str(&run.out).expect("a report");
    let body = &report["body"];
    assert_eq!(
        (&body["triangles"], &body["closed"]),
        (&json!(2), &json!(false)),
        "{body}"
    );
    assert_eq!(body["area"], 2.0, "{body}");
    let volume = report["sweep"]["volume"].as_f64().expect("a volume");
    assert!((volume - 2.0).abs() < 0.02, "{volume}");
    let text = scratch
        .run("sweep sheet.obj --translate 0,0,1 --surface")
        .out;
    assert!(
        text.starts_with("surface 2 triangles, area 2, open\n"),
        "{text}"
    );
    scratch.write(
        "bad.obj",
        "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n",
    );
    let run = scratch.run("sweep bad.obj --translate 0,0,1 --surface -o bad.stl");
    assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{}", run.err);
    let expected = "bad.obj: triangles 0 and 1 run through edge 0-1 in the same sense";
    assert!(run.err.contains(expected), "{}", run.err);
    assert!(!scratch.path().join("bad.stl").exists(), "no file");
}
