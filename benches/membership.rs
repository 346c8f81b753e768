//! How many points per second can be asked when they are inside a moving body?
//!
//! Ids: `membership/<points>/<way>/<triangles>`. Points are near (anywhere in the box of the sweep) or grazing (on
//! vertices of the body at random times, the hostile case), or asked at rest. The naive way is dense sampling in time, far less exact.

#[path = "../tests/support/mod.rs"]
mod support;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use std::hint::black_box;
use steadysweep::body::Mesh;
use steadysweep::membership::Membership;
use steadysweep::motion::{Generator, Motion, Span};
use support::membership::{Sampled, pseudo_random};
use support::shapes;

const TRIANGLES: u32 = 7_000;
/// Samples of the naive way: 1e-2 of the span, when the others are exact to 1e-9.
const SAMPLES: usize = 100;

fn membership(criterion: &mut Criterion) {
    let shape = shapes::mapped(shapes::bumpy_sphere(TRIANGLES), |p| p + DVec3::X * 1.5);
    let turn = Generator::screw(DVec3::Z, DVec3::ZERO, std::f64::consts::PI, 2.0, 1.0);
    let motion = Motion::from_spans(vec![Span::new(turn, 1.0).expect("finite")]).expect("a motion");
    let mesh = Mesh::new(shape.0.clone(), shape.1.clone()).expect("a body");
    let membership = Membership::new(&mesh, &motion);
    let sampled = Sampled::new(&shape, &motion, SAMPLES);

    let mut numbers = pseudo_random(1);
    let mut number = || numbers.next().expect("endless");
    let near: Vec<DVec3> = (0..2_000)
        .map(|_| {
            DVec3::new(
                -2.7 + 5.4 * number(),
                -1.2 + 3.9 * number(),
                -1.2 + 4.4 * number(),
            )
        })
        .collect();
    let grazing: Vec<DVec3> = (0..2_000)
        .map(|k| {
            motion
                .pose_at_time(number())
                .transform_point3(shape.0[k % shape.0.len()])
        })
        .collect();

    // The answers first: a fast wrong one is worth nothing.
    for point in near.iter().take(40).chain(grazing.iter().take(20)) {
        sampled.check(*point, &membership.intervals(*point), 1e-9);
    }

    let mut group = criterion.benchmark_group("membership");
    group.sample_size(10);
    for (name, points) in [("near", &near), ("grazing", &grazing)] {
        group.throughput(Throughput::Elements(points.len() as u64));
        group.bench_with_input(
            BenchmarkId::new(format!("{name}/intervals"), TRIANGLES),
            points,
            |bencher, points| {
                bencher.iter(|| {
                    points
                        .iter()
                        .map(|&point| membership.intervals(point).len())
                        .sum::<usize>()
                });
            },
        );
        group.bench_with_input(
            BenchmarkId::new(format!("{name}/ever"), TRIANGLES),
            points,
            |bencher, points| {
                bencher.iter(|| {
                    points
                        .iter()
                        .filter(|&&point| membership.is_ever_inside(point))
                        .count()
                });
            },
        );
    }
    group.throughput(Throughput::Elements(1));
    group.bench_with_input(
        BenchmarkId::new("near/naive", TRIANGLES),
        &near[0],
        |bencher, &point| {
            bencher.iter(|| sampled.check(black_box(point), &membership.intervals(point), 1e-9));
        },
    );
    // At rest, in the box of the body.
    let [min, max] = mesh.bounds();
    let near: Vec<DVec3> = (0..2_000)
        .map(|_| min + (max - min) * DVec3::new(number(), number(), number()))
        .collect();
    group.throughput(Throughput::Elements(near.len() as u64));
    group.bench_with_input(
        BenchmarkId::new("at_rest/winding_number", TRIANGLES),
        &near,
        |bencher, points| {
            let tree = steadysweep::bounds::SurfaceTree::new(mesh.positions(), mesh.triangles());
            bencher.iter(|| {
                points
                    .iter()
                    .filter_map(|&point| tree.winding_number(point))
                    .sum::<i32>()
            });
        },
    );
    group.bench_with_input(
        BenchmarkId::new("at_rest/distance", TRIANGLES),
        &near,
        |bencher, points| {
            let tree = steadysweep::bounds::SurfaceTree::new(mesh.positions(), mesh.triangles());
            bencher.iter(|| {
                points
                    .iter()
                    .map(|&point| tree.distance_to_surface(point))
                    .sum::<f64>()
            });
        },
    );
    group.bench_function(BenchmarkId::new("prepare", TRIANGLES), |bencher| {
        bencher.iter(|| Membership::new(black_box(&mesh), black_box(&motion)));
    });
    group.finish();
}

criterion_group!(benches, membership);
criterion_main!(benches);
