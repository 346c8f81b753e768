//! Random sweeps and those of real parts, read back from the files that they are written to: no
//! point breaks a bound.
//!
//! The ordinary run does a few sweeps at a few hundred points each;
//!
//! ```sh
//! RANDOM_CYCLES=500 CYCLE_POINTS=100000 cargo test --test it random_cycles
//! ```
//!
//! does five hundred, and the parts of `../shared/data` at four tolerances, in hours.
//! `RANDOM_CYCLES_FIRST=123 RANDOM_CYCLES=1` does number 123 alone and, with `-- --nocapture`, prints
//! it. All run before failures are reported.

use crate::random_scenes::space::any_scene;
use crate::real_parts::motions;
use crate::support::data;
use crate::support::random::Random;
use crate::support::scratch::Scratch;
use crate::support::sweep::agreement_at;
use glam::DVec3;
use std::path::{Path, PathBuf};
use steadysweep::body::Mesh;
use steadysweep::bounds::SurfaceTree;
use steadysweep::io::{read_body, write_mesh};
use steadysweep::membership::Membership;
use steadysweep::motion::Motion;
use steadysweep::{Precision, Sweep, SweepError, SweepSettings};

/// Number of random sweeps in the ordinary run: some seconds.
const ORDINARY: u64 = 12;

/// A number given in the environment.
fn setting(name: &str, default: u64) -> u64 {
    match std::env::var(name) {
        Ok(text) => text
            .parse()
            .unwrap_or_else(|_| panic!("{name}={text} is no number")),
        Err(_) => default,
    }
}

/// Number of points at which each solid is compared with the exact motion.
fn point_count() -> usize {
    usize::try_from(setting("CYCLE_POINTS", 300)).expect("points fit into memory")
}

/// A sweep at a tolerance relative to the size of the body, written to a file of one of the formats
/// and read again: what breaks a bound, or `None` where the tolerance is below rounding.
fn defects(body: &Mesh, motion: &Motion, tolerance: f64, file: &Path) -> Option<String> {
    let size = body.transformed(motion.start_pose()).diagonal();
    let is_single = file.extension().is_some_and(|extension| extension == "stl");
    let settings = SweepSettings::default()
        .with_tolerance(tolerance * size)
        .with_precision(if is_single {
            Precision::Single
        } else {
            Precision::Double
        });
    let sweep = match steadysweep::sweep(body, motion, &settings) {
        Ok(sweep) => sweep,
        Err(SweepError::BelowRounding { .. }) => return None,
        Err(error) => return Some(format!("refused: {error}")),
    };
    write_mesh(file, sweep.solid.positions(), sweep.solid.triangles()).expect("it can be written");
    let solid = match read_body(file) {
        Ok((solid, _)) => solid,
        Err(error) => return Some(format!("not a body: {error}")),
    };
    let tree = SurfaceTree::new(solid.positions(), solid.triangles());
    let membership = Membership::new(body, motion);
    let points = points(body, motion, &solid, &sweep, point_count());
    Some(agreement_at(&membership, &tree, &sweep, points).defects(&sweep))
}

/// Points at which an error would show: a third of them at about the bounds from the surface of the
/// solid, a third just inside corners, edges and faces of the moving body, the others anywhere.
fn points(body: &Mesh, motion: &Motion, solid: &Mesh, sweep: &Sweep, count: usize) -> Vec<DVec3> {
    let mut random = Random::new(count as u64);
    let bound = sweep.error_bound;
    let [low, high] = solid.bounds();
    let times = motion.joint_times();
    let [start, end] = [times[0], times[times.len() - 1]];
    let corners = |mesh: &Mesh, random: &mut Random| {
        let triangle = mesh.triangles()[random.below(mesh.triangles().len())];
        triangle.map(|corner| mesh.positions()[corner as usize])
    };
    // A point of a triangle, of one of its edges, or a corner.
    let on = |[a, b, c]: [DVec3; 3], random: &mut Random| match random.below(3) {
        0 => a,
        1 => a.lerp(b, random.unit()),
        _ => a.lerp(b, random.unit()).lerp(c, random.unit()),
    };
    (0..count)
        .map(|number| match number % 3 {
            0 => {
                let triangle = corners(solid, &mut random);
                let [a, b, c] = triangle;
                let normal = (b - a).cross(c - a).normalize_or_zero();
                let by = random.one_of(&[bound.inside.length, -bound.outside.length]);
                on(triangle, &mut random) + normal * by * random.between(0.9, 1.1)
            }
            1 => {
                let triangle = corners(body, &mut random);
                let [a, b, c] = triangle;
                let normal = (b - a).cross(c - a).normalize_or_zero();
                let depth = body.diagonal() * random.magnitude(1e-12, 1e-6);
                let time = random.between(start, end);
                let inside = on(triangle, &mut random) - normal * depth;
                motion.pose_at_time(time).transform_point3(inside)
            }
            _ => low + (high - low) * (random.point(0.55) + 0.5),
        })
        .collect()
}

#[test]
fn random_sweeps_keep_their_bounds_in_the_file() {
    let scratch = Scratch::new("random_cycles");
    let first = setting("RANDOM_CYCLES_FIRST", 0);
    let count = setting("RANDOM_CYCLES", ORDINARY);
    let (mut failures, mut refused) = (Vec::new(), 0);
    for number in first..first + count {
        let mut random = Random::new(number.wrapping_mul(0x0010_0000_0001).wrapping_add(17));
        let scene = any_scene(&mut random);
        let tolerance = random.one_of(&[1e-1, 3e-2, 1e-2, 1e-3, 1e-4]);
        // The finer ones take seconds.
        let tolerance: f64 = if count > ORDINARY {
            tolerance
        } else {
            tolerance.max(1e-2)
        };
        let extension = random.one_of(&["stl", "obj", "ply"]);
        let file = scratch.path().join(format!("swept.{extension}"));
        if count == 1 {
            scene.tell();
            println!("tolerance {tolerance}, {extension}");
        }
        match defects(&scene.mesh, &scene.motion, tolerance, &file) {
            None => refused += 1,
            Some(found) if found.is_empty() => {}
            Some(found) => {
                let failure = format!("{number} at {tolerance} as {extension}: {found}");
                println!("{failure}");
                failures.push(failure);
            }
        }
    }
    println!("{count} cycles, {refused} refused");
    assert!(
        failures.is_empty(),
        "{} fail:\n{}",
        failures.len(),
        failures.join("\n")
    );
    assert!(refused <= 2 + count / 5, "{refused} of {count} refused");
}

/// The parts of some folders of the data.
fn parts(data: &Path) -> Vec<PathBuf> {
    let folders = ["cad", "fanuc/meshes", "panda/meshes", "ur5e/meshes"];
    let files = folders.iter().flat_map(|folder| {
        let folder = std::fs::read_dir(data.join(folder)).expect("a folder of the data");
        folder.map(|file| file.expect("a file of the data").path())
    });
    let is_mesh = |file: &PathBuf| {
        let extension = file.extension().unwrap_or_default().to_ascii_lowercase();
        extension == "stl" || extension == "obj"
    };
    let mut parts: Vec<PathBuf> = files.filter(is_mesh).collect();
    parts.sort();
    parts
}

/// One part at one tolerance in the ordinary run; all when many cycles are asked for.
#[test]
fn sweeps_of_real_parts_keep_their_bounds_in_the_file() {
    let Some(data) = data::folder("") else { return };
    let (mut parts, mut tolerances) = (parts(&data), vec![1e-1, 1e-2, 1e-3, 1e-4]);
    if setting("RANDOM_CYCLES", ORDINARY) <= ORDINARY {
        parts.truncate(1);
        tolerances.truncate(1);
    }
    let scratch = Scratch::new("random_cycles_of_parts");
    let mut failures = Vec::new();
    for part in parts {
        let (body, _) = read_body(&part).expect("the parts are bodies");
        for (kind, motion) in motions(&body) {
            for (&tolerance, extension) in tolerances.iter().zip(["stl", "obj", "ply", "stl"]) {
                let file = scratch.path().join(format!("swept.{extension}"));
                let found = defects(&body, &motion, tolerance, &file);
                let found = found.unwrap_or_else(|| "the tolerance is below rounding".to_owned());
                if !found.is_empty() {
                    let failure = format!("{} {kind} at {tolerance}: {found}", part.display());
                    println!("{failure}");
                    failures.push(failure);
                }
            }
        }
    }
    assert!(
        failures.is_empty(),
        "{} fail:\n{}",
        failures.len(),
        failures.join("\n")
    );
}
