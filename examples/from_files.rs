//! Reads a body and a motion from files, sweeps and writes: the work of the command line, as a
//! program.
//!
//! You learn where errors come from (each names the file, the place and the remedy) and how to
//! follow the stages.
//!
//! Run: `cargo run --example from_files [OUT.stl]` (default: a file in the directory for temporary
//! files).
//!
//! You should see the three spans of `examples/path.json`, the stages, and the measures of one
//! solid piece.

use std::error::Error;
use std::path::{Path, PathBuf};

use steadysweep::io::{read_body, read_motion, write_mesh};
use steadysweep::{Precision, Stage, SweepSettings, sweep};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let (body, read) = read_body(&folder.join("bracket.stl"))?;
    println!(
        "body      {} triangles, {} vertices joined",
        body.triangles().len(),
        read.welded
    );
    let motion = read_motion(&folder.join("path.json"))?;
    for (number, span) in (1..).zip(motion.spans()) {
        let described = span.describe();
        println!(
            "span {number}    {}, turn {:.1} degrees, advance {:.1}",
            described.kind.name(),
            described.turn_deg.unwrap_or(0.0),
            described.advance.unwrap_or(0.0)
        );
    }

    // A coarse tolerance, and rounding to the 32-bit coordinates of the format that is written
    // below.
    let tell = |stage: Stage, share: f64| eprint!("\r{stage:?} {:.0} %   ", 100.0 * share);
    let settings = SweepSettings::default()
        .with_tolerance(1.0)
        .with_precision(Precision::Single)
        .with_observer(&tell);
    let swept = sweep(&body, &motion, &settings)?;

    let measures = swept.solid.measures();
    println!("volume    {:.1}", measures.volume);
    println!(
        "closed    {}, manifold {}",
        measures.watertight, measures.manifold
    );
    println!(
        "pieces    {} component, {} voids, genus {}",
        measures.components, measures.voids, measures.genus
    );
    for (stage, seconds) in swept.seconds {
        println!("{stage:<10?} {seconds:.3} s");
    }

    let path = std::env::args()
        .nth(1)
        .map_or_else(|| std::env::temp_dir().join("swept.stl"), PathBuf::from);
    write_mesh(&path, swept.solid.positions(), swept.solid.triangles())?;
    println!("written to {}", path.display());
    Ok(())
}
