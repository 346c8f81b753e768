//! The slow search itself, where the answer is known; and what it costs.
mod support;

use rayon::prelude::*;
use std::time::Instant;
use support::contact::families::{FAMILIES, scene};
use support::contact::reference::Slow;
use support::contact::scene::Known;

#[test]
fn probe() {
    for family in FAMILIES {
        let clock = Instant::now();
        let found: Vec<_> = (0..80u64)
            .into_par_iter()
            .map(|seed| {
                let clock = Instant::now();
                let scene = scene(family, seed);
                let slow: Vec<Slow> = (0..scene.obstacles.len())
                    .map(|k| scene.slow(k, 0.0))
                    .collect();
                (
                    slow[scene.obstacles.len() - 1],
                    scene.known,
                    clock.elapsed().as_secs_f64(),
                )
            })
            .collect();
        let count = |f: &dyn Fn(&Slow) -> bool| found.iter().filter(|(s, ..)| f(s)).count();
        let mut times: Vec<f64> = found.iter().map(|f| f.2).collect();
        times.sort_by(f64::total_cmp);
        let start = count(&|s| matches!(s, Slow::Contact { by, .. } if *by == 0.0));
        println!(
            "{:25} clear {:3} contact {:3} at 0 {:3} doubt {:3} given up {:3}; {:.2} s, median {:.1} ms worst {:.0} ms",
            family.0,
            count(&|s| *s == Slow::Clear),
            count(&|s| matches!(s, Slow::Contact { .. })),
            start,
            count(&|s| matches!(s, Slow::Doubt { .. })),
            count(&|s| *s == Slow::GivenUp),
            clock.elapsed().as_secs_f64(),
            times[40] * 1e3,
            times[79] * 1e3
        );
        for (seed, (slow, known, _)) in found.iter().enumerate() {
            let ok = match (slow, known) {
                (_, Known::Nothing) => true,
                (Slow::Clear, Known::Clear) => true,
                (Slow::Contact { clear_until, by }, Known::Contact { time, early }) => {
                    *clear_until >= time - early - 1e-12
                        && *clear_until <= time + 1e-11
                        && *by >= time - early
                        && *by <= time + 1e-5
                }
                _ => false,
            };
            if !ok {
                println!("   {seed}: {slow:?} {known:?}");
            }
        }
    }
}
