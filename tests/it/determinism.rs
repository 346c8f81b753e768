//! The same input gives the same bits, whatever the number of threads.

use crate::support::sweep::case;
use rayon::ThreadPoolBuilder;
use steadysweep::{Sweep, SweepSettings};

fn bits(sweep: &Sweep) -> (Vec<[u64; 3]>, Vec<[u32; 3]>) {
    let positions = sweep.solid.positions().iter();
    (
        positions.map(|p| p.to_array().map(f64::to_bits)).collect(),
        sweep.solid.triangles().to_vec(),
    )
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let cases = [
        ("bumpy_spiral", 1e-2),
        ("ball_helix", 1e-3),
        ("l_keyframes", 3e-3),
        ("hole_swept_shut_by_a_screw", 3e-3),
        ("ball_through_itself", 1e-2),
        ("cube_quarter_turn", 3e-3),
        ("bumpy_on_the_spot", 1e-2),
    ];
    let settings = SweepSettings::default().with_sources();
    for (name, relative) in cases {
        let case = case(name);
        let mut first = None;
        for threads in [1, 2, 4, 16, 1] {
            let pool = ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("threads can be started");
            let sweep = pool.install(|| case.sweep_with(settings, relative));
            let stated = (
                bits(&sweep),
                sweep.sources,
                *sweep.solid.measures(),
                sweep.error_bound,
                sweep.filled_pockets,
                sweep.removed_handles,
            );
            let first = first.get_or_insert_with(|| stated.clone());
            assert!(
                *first == stated,
                "{name}: other bytes with {threads} threads"
            );
        }
    }
}
