//! Sweeps a cube that turns about its own axis, and writes the solid as OBJ.
//!
//! You learn how to make a body from vertices and triangles, how to give a motion as a screw, and
//! how to read the measures and the error bound of the result.
//!
//! Run: `cargo run --example sweep_solid [OUT.obj]` (default: a file in the directory for temporary
//! files).
//!
//! You should see a volume near 1.5708: in a quarter turn the unit cube sweeps the cylinder about
//! it, pi / 2.

use std::error::Error;
use std::path::PathBuf;

use glam::DVec3;
use steadysweep::body::Mesh;
use steadysweep::io::write_mesh;
use steadysweep::motion::{Motion, Screw, Span};
use steadysweep::{Stage, SweepSettings, sweep};

fn main() -> Result<(), Box<dyn Error>> {
    // Corner i has the binary digits of i as coordinates; triangles run counter-clockwise seen from
    // outside.
    let corners =
        (0..8).map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)));
    let squares = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles = squares
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    let cube = Mesh::new(corners.collect(), triangles)?;

    let quarter = Screw {
        axis: DVec3::Z,
        through: DVec3::new(0.5, 0.5, 0.0),
        turn: 90_f64.to_radians(),
        ..Screw::default()
    };
    let motion = Motion::from_spans(vec![Span::new(quarter.generator()?, 1.0)?])?;
    let tell = |stage: Stage, share: f64| eprint!("\r{stage:?} {:.0} %   ", 100.0 * share);
    let settings = SweepSettings::default()
        .with_tolerance(5e-3)
        .with_observer(&tell);
    let swept = sweep(&cube, &motion, &settings)?;

    let measures = swept.solid.measures();
    let bound = swept.error_bound;
    println!("volume    {:.5}", measures.volume);
    println!(
        "genus     {}, {} component, {} voids",
        measures.genus, measures.components, measures.voids
    );
    println!(
        "outside   {:.5} at most, proven: {}",
        bound.outside.length, bound.outside.proven
    );
    println!(
        "inside    {:.5} at most, proven: {}",
        bound.inside.length, bound.inside.proven
    );

    let path = std::env::args()
        .nth(1)
        .map_or_else(|| std::env::temp_dir().join("swept.obj"), PathBuf::from);
    write_mesh(&path, swept.solid.positions(), swept.solid.triangles())?;
    println!("written to {}", path.display());
    Ok(())
}
