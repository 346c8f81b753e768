//! How do time and memory of a sweep grow with the number of triangles of the body, of spans of the
//! motion, and of pieces of the body?
//!
//! Each case runs in its own process, so that its peak memory is measured separately. For each
//! case, a row is printed: seconds of the stages and in total, sizes, topology, error bound, memory
//! (Linux). These are the rows of `benches/record`. From row to row of a family, the size grows by
//! the factor that the ids show; no column of seconds should grow by much more.
//!
//! `cargo bench --bench growth` runs all cases, `cargo bench --bench growth -- path` those whose
//! ids contain the word. The bench fails if a case does.

#[path = "support/memory.rs"]
mod memory;
#[path = "../tests/it/support/mod.rs"]
#[allow(dead_code, reason = "the tests use the rest")]
mod support;

use glam::{DAffine3, DQuat, DVec2, DVec3};
use memory::peak_memory;
use std::f64::consts::{PI, TAU};
use std::path::Path;
use std::process::Command;
use std::time::Instant;
use steadysweep::body::Mesh;
use steadysweep::io::read_body;
use steadysweep::motion::{Generator, Keyframe, Motion};
use support::shapes::{self, Shape};
use support::sweep::{mesh, motion, screw, swept};

/// The environment variable with the case that a child process runs.
const CASE: &str = "GROWTH_CASE";

/// A body, its motion, and the tolerance as a share of the body's diagonal.
struct Case {
    id: String,
    body: fn(u32) -> Shape,
    motion: fn(u32) -> Motion,
    /// Size of the body and of the motion.
    sizes: [u32; 2],
    tolerance: f64,
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |id: String, body, motion, sizes, tolerance| {
        cases.push(Case {
            id,
            body,
            motion,
            sizes,
            tolerance,
        });
    };
    for tolerance in [1e-2, 1e-3] {
        for size in [1_000, 10_000, 100_000] {
            let id = format!("body/{tolerance:e}/{size}");
            add(id, bumpy, half_turn, [size, 1], tolerance);
        }
    }
    add(
        "body/1e-2/1000000".into(),
        bumpy,
        half_turn,
        [1_000_000, 1],
        1e-2,
    );
    add(
        "body/1e-3/1000000".into(),
        bumpy,
        half_turn,
        [1_000_000, 1],
        1e-3,
    );
    add("bracket".into(), bracket, half_turn_and_rise, [1, 1], 1e-3);
    add(
        "nearly-closed/cavity".into(),
        cavity,
        two_turns,
        [1, 1],
        1e-3,
    );
    add("nearly-closed/torus".into(), torus, spiral, [1, 1], 1e-3);
    for size in [10, 50, 200, 1_000] {
        add(format!("path/{size}"), bumpy, path, [2_000, size], 1e-3);
    }
    for size in [1, 2, 4, 8, 16] {
        add(
            format!("through-itself/{size}"),
            gear,
            turns,
            [24, size],
            2e-3,
        );
    }
    for size in [1_000, 2_000, 4_000, 8_000] {
        add(format!("stair/{size}"), stair, slide_up, [size, 1], 1e-3);
        add(format!("row/{size}"), row, slide_up, [size, 1], 1e-3);
    }
    for size in [50, 100, 200] {
        add(format!("comb/{size}"), comb, small_turn, [size, 1], 1e-3);
    }
    cases
}

/// A bumpy sphere next to the axis.
fn bumpy(triangles: u32) -> Shape {
    shapes::mapped(shapes::bumpy_sphere(triangles), |p| p + DVec3::X * 2.0)
}

/// The bracket of the guide.
fn bracket(_: u32) -> Shape {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/bracket.stl");
    let (bracket, _) = read_body(&file).expect("the bracket is a body");
    (bracket.positions().to_vec(), bracket.triangles().to_vec())
}

/// A box with a cavity, next to the axis.
fn cavity(_: u32) -> Shape {
    let hollow = shapes::hollow_box(DVec3::ONE, DVec3::splat(0.5));
    shapes::mapped(hollow, |p| p + DVec3::X * 2.0)
}

/// A ring next to the axis.
fn torus(_: u32) -> Shape {
    shapes::mapped(shapes::torus(0.6, 0.2, 24, 12), |p| p + DVec3::X * 2.0)
}

/// A wheel with the given number of teeth.
fn gear(teeth: u32) -> Shape {
    let corners: Vec<DVec2> = (0..4 * teeth)
        .map(|corner| {
            let radius = if corner % 4 < 2 { 1.0 } else { 0.85 };
            radius * DVec2::from_angle(TAU * f64::from(corner) / f64::from(4 * teeth))
        })
        .collect();
    shapes::prism(&corners, 0.3)
}

/// Cubes in a row, at equal steps.
fn cubes(count: u32, step: DVec3) -> Shape {
    let cube = |number| {
        let corner = step * f64::from(number);
        shapes::cuboid(corner, corner + DVec3::ONE)
    };
    shapes::united(&(0..count).map(cube).collect::<Vec<_>>())
}

fn stair(count: u32) -> Shape {
    cubes(count, DVec3::new(1.5, 0.5, 0.25))
}

fn row(count: u32) -> Shape {
    cubes(count, DVec3::new(1.5, 0.0, 0.0))
}

/// A bar with the given number of teeth on one side; the time to triangulate it is proportional to
/// the number.
fn comb(teeth: u32) -> Shape {
    let width = 1.0 / f64::from(teeth);
    // The bottom of the bar, then four corners of each tooth, from right to left.
    let mut outline = vec![DVec2::new(0.0, -0.2), DVec2::new(1.0, -0.2)];
    for tooth in (0..teeth).rev() {
        let left = f64::from(tooth) * width;
        let corners = [(0.9, 0.0), (0.7, 0.1), (0.4, 0.1), (0.2, 0.0)];
        outline.extend(corners.map(|(share, height)| DVec2::new(left + share * width, height)));
    }
    let count = 2 + 4 * teeth;
    // A fan over the bases of the teeth, and two triangles for each tooth.
    let mut flat = vec![[0, 1, 2]];
    for first in (2..count).step_by(4) {
        flat.push([0, first, first + 3]);
        flat.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        if first + 4 < count {
            flat.push([0, first + 3, first + 4]);
        }
    }
    let positions = [0.0, 0.1]
        .iter()
        .flat_map(|&z| outline.iter().map(move |p| p.extend(z)))
        .collect();
    let mut triangles = Vec::new();
    for [a, b, c] in flat {
        triangles.extend([[a, c, b], [a + count, b + count, c + count]]);
    }
    for i in 0..count {
        let j = (i + 1) % count;
        triangles.extend([[i, j, j + count], [i, j + count, i + count]]);
    }
    (positions, triangles)
}

fn half_turn(_: u32) -> Motion {
    motion(&[screw(DVec3::Z, DVec3::ZERO, PI, 1.0, 1.0)])
}

fn half_turn_and_rise(_: u32) -> Motion {
    motion(&[screw(DVec3::Z, DVec3::new(90.0, 20.0, 0.0), PI, 60.0, 1.0)])
}

/// The sheets of the second turn are within 1e-4 of those of the first.
fn two_turns(_: u32) -> Motion {
    motion(&[screw(DVec3::Z, DVec3::ZERO, 2.0 * TAU, 0.0, 1.00008)])
}

fn spiral(_: u32) -> Motion {
    motion(&[screw(DVec3::Z, DVec3::ZERO, 1.5 * TAU, 0.0, 1.3)])
}

fn small_turn(_: u32) -> Motion {
    motion(&[screw(DVec3::Z, DVec3::new(0.5, -2.0, 0.0), 0.2, 0.0, 1.0)])
}

fn slide_up(_: u32) -> Motion {
    motion(&[Generator::translation(DVec3::new(0.0, 0.0, 2.0))])
}

/// Turns about slightly tilted axes, one after another, so that the spans do not merge: nearly
/// every sheet lies in the body.
fn turns(spans: u32) -> Motion {
    let turn = |span: u32| {
        let tilt = if span.is_multiple_of(2) { 0.02 } else { -0.02 };
        screw(DVec3::new(tilt, 0.01, 1.0), DVec3::ZERO, 0.5, 0.05, 1.0)
    };
    motion(&(0..spans).map(turn).collect::<Vec<_>>())
}

/// Keyframes along one smooth path.
fn path(keys: u32) -> Motion {
    let pose = |s: f64| {
        let axis = DVec3::new(s.sin(), (1.3 * s).cos(), 0.5).normalize();
        let turn = DQuat::from_axis_angle(axis, 1.8 * s + 0.3 * (4.0 * s).sin());
        let place = DVec3::new(4.0 * s, 1.5 * (3.0 * s).sin(), 0.8 * (2.0 * s).cos());
        DAffine3::from_rotation_translation(turn, place)
    };
    let keys: Vec<Keyframe> = (0..keys)
        .map(|key| f64::from(key) / f64::from(keys - 1))
        .map(|time| Keyframe {
            time,
            pose: pose(time),
        })
        .collect();
    Motion::from_keyframes(&keys).expect("a smooth path is a motion")
}

fn run(case: &Case) {
    let [size, spans] = case.sizes;
    let body: Mesh = mesh(&(case.body)(size));
    let motion = (case.motion)(spans);
    let clock = Instant::now();
    let sweep = swept(&body, &motion, case.tolerance * body.diagonal());
    let total = clock.elapsed().as_secs_f64();
    let measures = sweep.solid.measures();
    assert!(measures.watertight, "{}: {measures:?}", case.id);
    let [cycle, arrangement, boundary] = sweep.seconds.map(|(_, seconds)| seconds);
    println!(
        "{},{},{spans},{:e},{cycle:.3},{arrangement:.3},{boundary:.3},{total:.3},{},{},{},{},{},{},{:.2e},{:.2e},{:.0}",
        case.id,
        body.triangles().len(),
        case.tolerance,
        sweep.attempts,
        sweep.cycle_triangles,
        sweep.solid.triangles().len(),
        measures.components,
        measures.voids,
        measures.genus,
        sweep.error_bound.inside.length,
        sweep.error_bound.outside.length,
        peak_memory().unwrap_or(f64::NAN)
    );
}

fn main() {
    let cases = cases();
    if let Ok(id) = std::env::var(CASE) {
        let case = cases.iter().find(|case| case.id == id);
        run(case.expect("the parent names a case"));
        return;
    }
    let word = std::env::args().skip(1).find(|word| !word.starts_with('-'));
    println!(
        "id,triangles,spans,tolerance,cycle_seconds,arrangement_seconds,boundary_seconds,seconds,attempts,cycle_triangles,result_triangles,components,voids,genus,inside,outside,peak_mb"
    );
    let program = std::env::current_exe().expect("this program has a path");
    let mut failed = false;
    for case in cases {
        if word.as_ref().is_some_and(|word| !case.id.contains(word)) {
            continue;
        }
        let status = Command::new(&program).env(CASE, &case.id).status();
        if !status.is_ok_and(|status| status.success()) {
            println!("{},failed", case.id);
            failed = true;
        }
    }
    assert!(!failed, "some cases failed");
}
