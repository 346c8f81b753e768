//! The triangles of a solid meet only in common corners and edges, on the coordinates as they are
//! read back from its file.

use crate::support::data;
use crate::support::scratch::Scratch;
use crate::support::shapes;
use crate::support::sweep::{mesh, motion, screw};
use glam::DVec3;
use std::f64::consts::TAU;
use std::path::Path;
use steadysweep::body::Mesh;
use steadysweep::bounds::SurfaceTree;
use steadysweep::io::{read_body, read_motion, write_mesh};
use steadysweep::motion::Motion;
use steadysweep::{Precision, SweepSettings};

/// The files that are written, by the precision of their coordinates.
type Files<'a> = &'a [(Precision, &'a [&'a str])];

const STL: (Precision, &[&str]) = (Precision::Single, &["swept.stl"]);
const OTHERS: (Precision, &[&str]) = (Precision::Double, &["swept.obj", "swept.ply"]);

/// Sweeps, writes files, and returns the number of pairs of triangles that meet elsewhere in one of
/// them.
fn crossings(
    body: &Mesh,
    motion: &Motion,
    tolerance: Option<f64>,
    files: Files,
    folder: &Path,
) -> usize {
    let mut found = 0;
    for &(precision, names) in files {
        let settings = SweepSettings::default()
            .with_tolerance(tolerance)
            .with_precision(precision);
        let sweep = steadysweep::sweep(body, motion, &settings).expect("a legal sweep succeeds");
        assert_eq!(sweep.crossings, 0, "{precision:?}");
        for name in names {
            let file = folder.join(name);
            let (positions, triangles) = (sweep.solid.positions(), sweep.solid.triangles());
            write_mesh(&file, positions, triangles).expect("it can be written");
            let (read, _) = read_body(&file).expect("a solid is a body");
            let tree = SurfaceTree::new(read.positions(), read.triangles());
            found += tree.meetings().len();
        }
    }
    found
}

/// Two turns of a ring about an axis in its plane, each over a tenth of its section: sheets run
/// along each other all the way round.
#[test]
fn a_ring_that_nearly_returns_does_not_cross_itself() {
    let ring = mesh(&shapes::torus(0.6, 0.2, 6, 4));
    let twice = motion(&[screw(DVec3::X, DVec3::ZERO, 2.0 * TAU, 0.05, 1.0)]);
    let scratch = Scratch::new("crossings_of_a_ring");
    assert_eq!(
        crossings(&ring, &twice, None, &[STL, OTHERS], scratch.path()),
        0
    );
}

/// Before, pairs of triangles crossed: 887, 898, 1,069 and 46 of them.
#[test]
fn sweeps_that_once_crossed_themselves_no_longer_do() {
    let Some(data) = data::folder("cases/result_crosses_itself") else {
        return;
    };
    let cases: [(_, _, Files); 4] = [
        ("torus", None, &[STL, OTHERS]),
        ("boxes", None, &[STL, OTHERS]),
        ("ball", Some(0.0406), &[OTHERS]),
        ("prism", Some(0.0072), &[STL, OTHERS]),
    ];
    let scratch = Scratch::new("crossings_of_cases");
    for (name, tolerance, files) in cases {
        let (body, _) = read_body(&data.join(format!("{name}.obj"))).expect("a body");
        let motion = read_motion(&data.join(format!("{name}.json"))).expect("a motion");
        let found = crossings(&body, &motion, tolerance, files, scratch.path());
        assert_eq!(found, 0, "{name}");
    }
}
