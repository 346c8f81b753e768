//! How long does a sweep in the plane take, depending on the number of edges and of spans, and how
//! long does another library take for the union of the same sampled curves?
//!
//! Ids: `sweep/planar/<edges>/<spans>` and `union/planar/<edges>/<spans>`. The body is a wavy disc
//! beside the centre of half a turn that is divided into spans of slightly different shears. The
//! tolerance is 1e-4 of its diagonal.
//!
//! Besides criterion's own results, one line per id is printed: sizes, seconds of each stage, error
//! bound. These are the rows of `benches/record`.

use criterion::{Criterion, criterion_group, criterion_main};
use glam::{DMat2, DVec2};
use i_overlay::core::fill_rule::FillRule as OverlayRule;
use i_overlay::float::simplify::SimplifyShape;
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};
use std::hint::black_box;
use std::time::Duration;
use steadysweep::body::{FillRule, Polygon};
use steadysweep::envelope::planar::PlanarBudget;
use steadysweep::envelope::planar::{SweepCycle, sweep_cycle};
use steadysweep::motion::planar::{Generator, Motion, Span};
use steadysweep::planar::{SweepSettings, sweep};

const EDGES: [u32; 3] = [100, 1_000, 10_000];
const SPANS: [u32; 3] = [1, 10, 100];
const TOLERANCE: f64 = 1e-4;

fn body(edges: u32) -> Polygon {
    let corners = (0..edges)
        .map(|corner| {
            let angle = TAU * f64::from(corner) / f64::from(edges);
            let radius = 0.5 + 0.1 * (9.0 * angle).sin();
            DVec2::X * 2.0 + radius * DVec2::from_angle(angle)
        })
        .collect();
    Polygon::new(vec![corners], FillRule::NonZero).expect("a wavy disc is a body")
}

fn motion(spans: u32) -> Motion {
    let turn = PI / f64::from(spans);
    let spans = (0..spans).map(|span| {
        let shear = if span % 2 == 0 { 0.1 } else { -0.1 };
        let linear = DMat2::from_cols(DVec2::new(0.0, turn), DVec2::new(shear * turn - turn, 0.0));
        let generator = Generator {
            linear,
            offset: DVec2::ZERO,
        };
        Span::new(generator, 1.0).expect("a turn with a shear is a motion")
    });
    Motion::from_spans(spans.collect()).expect("a chain of spans is a motion")
}

/// The cycle as closed paths, with each segment as often as its weight says.
fn paths(cycle: &SweepCycle) -> Vec<Vec<[f64; 2]>> {
    let mut leaving = HashMap::<u32, Vec<u32>>::new();
    let mut starts = Vec::new();
    for (&[from, to], &weight) in cycle.segments.iter().zip(&cycle.weights) {
        let [from, to] = if weight > 0 { [from, to] } else { [to, from] };
        for _ in 0..weight.abs() {
            leaving.entry(from).or_default().push(to);
            starts.push(from);
        }
    }
    let mut paths = Vec::new();
    for start in starts {
        let mut path = Vec::new();
        let mut at = start;
        while let Some(next) = leaving.get_mut(&at).and_then(Vec::pop) {
            path.push(cycle.points[at as usize].to_array());
            at = next;
        }
        if !path.is_empty() {
            assert_eq!(at, start, "a cycle is closed");
            paths.push(path);
        }
    }
    paths
}

fn union_area(paths: &Vec<Vec<[f64; 2]>>) -> f64 {
    let shapes = paths.simplify_shape(OverlayRule::Positive);
    let doubled: f64 = shapes
        .iter()
        .flatten()
        .flat_map(|points| points.iter().zip(points.iter().cycle().skip(1)))
        .map(|(a, b)| a[0] * b[1] - a[1] * b[0])
        .sum();
    doubled / 2.0
}

fn planar(criterion: &mut Criterion) {
    println!(
        "id,segments,cycle_seconds,arrangement_seconds,boundary_seconds,vertices,area,pieces,holes,inside,outside"
    );
    let mut group = criterion.benchmark_group("planar");
    group.sample_size(10);
    group.warm_up_time(Duration::from_millis(1));
    for edges in EDGES {
        let body = body(edges);
        let tolerance = TOLERANCE * body.diagonal();
        let settings = SweepSettings::default().with_tolerance(tolerance);
        for spans in SPANS {
            let motion = motion(spans);
            let run = || sweep(&body, &motion, &settings).expect("sweeps");
            let swept = run();
            let measures = swept.measures;
            let cycle = sweep_cycle(&body, &motion, &PlanarBudget::of(tolerance)).expect("sweeps");
            let paths = paths(&cycle);
            // The answer first. The other library has a grid of 2^-30 of the size; pockets are not
            // filled there.
            let other = union_area(&paths);
            let allowed = swept.error_bound.outside.length * measures.perimeter + 1e-6;
            assert!(
                (measures.area - other).abs() < allowed,
                "{measures:?}, {other} elsewhere"
            );
            assert_eq!(measures.pieces, 1, "one piece");
            let [cycle_seconds, arrangement, boundary] = swept.seconds.map(|(_, seconds)| seconds);
            println!(
                "planar/{edges}/{spans},{},{cycle_seconds:.4},{arrangement:.4},{boundary:.4},{},{:.6},{},{},{:.2e},{:.2e}",
                swept.cycle_segments,
                measures.vertices,
                measures.area,
                measures.pieces,
                measures.holes,
                swept.error_bound.inside.length,
                swept.error_bound.outside.length,
            );
            group.bench_function(format!("sweep/{edges}/{spans}"), |bencher| {
                bencher.iter(|| black_box(run()));
            });
            group.bench_function(format!("union/{edges}/{spans}"), |bencher| {
                bencher.iter(|| black_box(union_area(&paths)));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, planar);
criterion_main!(benches);
