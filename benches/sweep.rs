//! How long does a sweep take, stage by stage, depending on the number of triangles, the tolerance
//! and the kind of motion?
//!
//! Ids: `sweep/spatial/<motion>/<triangles>/<tolerance>`, with the tolerance as a share of the
//! diagonal. Bodies are bumpy spheres beside the axis of a half turn with an advance, or of a
//! spiral that shrinks.
//!
//! Besides criterion's own results, one line per id is printed: seconds of each stage, sizes, error
//! bound, and the largest memory that the process has had so far (Linux). These are the rows of
//! `benches/record`.

#[path = "support/memory.rs"]
mod memory;
#[path = "../tests/it/support/mod.rs"]
#[allow(dead_code, reason = "the tests use the rest")]
mod support;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::DVec3;
use memory::peak_memory;
use std::f64::consts::PI;
use std::hint::black_box;
use std::time::Duration;
use steadysweep::motion::Motion;
use support::shapes::{self, Shape};
use support::sweep::{agreement, mesh, motion, screw, swept};

/// Number of points at which an answer is checked before it is timed.
const POINTS: usize = 2_000;

/// Numbers of triangles, and for each the tolerances at which it is swept: those that finish in
/// reasonable time on two cores.
const SIZES: [(u32, &[f64]); 4] = [
    (1_000, &[1e-2, 1e-3, 1e-4]),
    (7_000, &[1e-2, 1e-3]),
    (10_000, &[1e-2, 1e-3]),
    (50_000, &[1e-3]),
];

fn beside(triangles: u32) -> Shape {
    shapes::mapped(shapes::bumpy_sphere(triangles), |p| p + DVec3::X * 2.0)
}

fn motions() -> [(&'static str, Motion); 2] {
    let half_turn = screw(DVec3::Z, DVec3::ZERO, PI, 1.0, 1.0);
    let spiral = screw(DVec3::Z, DVec3::ZERO, 2.0, 0.0, 0.6);
    [
        ("screw", motion(&[half_turn])),
        ("spiral", motion(&[spiral])),
    ]
}

fn sweep(criterion: &mut Criterion) {
    println!(
        "id,triangles,tolerance,cycle_seconds,arrangement_seconds,boundary_seconds,cycle_triangles,result_triangles,voids,genus,inside,outside,peak_mb"
    );
    let mut group = criterion.benchmark_group("sweep/spatial");
    group.sample_size(10);
    group.warm_up_time(Duration::from_millis(1));
    for (triangles, tolerances) in SIZES {
        let body = mesh(&beside(triangles));
        for (name, motion) in motions() {
            for &relative in tolerances {
                let run = || swept(&body, &motion, relative * body.diagonal());
                // The answer first: a fast wrong one is worth nothing.
                let first = run();
                let measures = first.solid.measures();
                assert!(
                    measures.watertight && measures.components == 1,
                    "{measures:?}"
                );
                let differing = agreement(&body, &motion, &first, POINTS).defects(&first);
                assert!(differing.is_empty(), "{differing}");
                let [cycle, arrangement, boundary] = first.seconds.map(|(_, seconds)| seconds);
                println!(
                    "sweep/spatial/{name}/{triangles}/{relative:e},{},{:.3e},{cycle:.3},{arrangement:.3},{boundary:.3},{},{},{},{},{:.2e},{:.2e},{:.0}",
                    body.triangles().len(),
                    first.tolerance,
                    first.cycle_triangles,
                    first.solid.triangles().len(),
                    measures.voids,
                    measures.genus,
                    first.error_bound.inside.length,
                    first.error_bound.outside.length,
                    peak_memory().unwrap_or(f64::NAN)
                );
                let id = BenchmarkId::new(format!("{name}/{triangles}"), format!("{relative:e}"));
                group.bench_function(id, |bencher| bencher.iter(|| black_box(run())));
            }
        }
    }
    group.finish();
}

criterion_group!(benches, sweep);
criterion_main!(benches);
