//! For how many points per second can we find when they are inside a moving body?
//!
//! Ids: `membership/<points>/<method>/<triangles>`, in the plane
//! `membership/planar/<points>/<edges>`. Points are near (anywhere in the box of the sweep) or
//! grazing (on vertices of the body at random times, the hostile case), or queried at rest. The
//! naive method is dense sampling in time, far less exact.

#[path = "../tests/it/support/mod.rs"]
#[allow(dead_code, reason = "the tests use the rest")]
mod support;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec2, DVec3};
use std::hint::black_box;
use steadysweep::body::{FillRule, Mesh, Polygon};
use steadysweep::membership::{self, Membership};
use steadysweep::motion::{Generator, Motion, Span, planar};
use support::membership::Sampled;
use support::random::pseudo_random;
use support::shapes;

const TRIANGLES: u32 = 7_000;
/// Samples of the naive method: 1e-2 of the span, while the others are exact to 1e-9.
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

/// A wavy disc with various numbers of corners makes half a turn about a point beside it. The
/// points are in the box of the sweep, and on the paths of corners.
fn planar_membership(criterion: &mut Criterion) {
    for corners in [100, 1_000, 10_000] {
        let mut numbers = pseudo_random(2);
        let mut number = || numbers.next().expect("endless");
        let corner = |i: u32| {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(corners);
            DVec2::from_angle(angle) * (0.9 + 0.1 * (7.0 * angle).cos()) + DVec2::X * 1.5
        };
        let outline = (0..corners).map(corner).collect();
        let body = Polygon::new(vec![outline], FillRule::EvenOdd).expect("a body");
        let turn = planar::Generator::spiral(DVec2::ZERO, std::f64::consts::PI, 1.0);
        let span = planar::Span::new(turn, 1.0).expect("finite");
        let motion = planar::Motion::from_spans(vec![span]).expect("a motion");
        let membership = membership::planar::Membership::new(&body, &motion);
        let near: Vec<DVec2> = (0..2_000)
            .map(|_| DVec2::new(-2.7 + 5.4 * number(), -1.2 + 3.9 * number()))
            .collect();
        let grazing: Vec<DVec2> = (0..2_000)
            .map(|k| {
                motion
                    .pose_at_time(number())
                    .transform_point2(body.positions()[k % body.positions().len()])
            })
            .collect();
        // At radius 1.5 from the centre of the turn every point is met, within 0.4 none.
        assert!(
            membership.is_ever_inside(DVec2::new(0.0, 1.5))
                && !membership.is_ever_inside(DVec2::new(0.0, 0.4)),
            "the disc sweeps its own distance"
        );
        let mut group = criterion.benchmark_group("membership/planar");
        group.sample_size(10);
        for (name, points) in [("near", &near), ("grazing", &grazing)] {
            group.throughput(Throughput::Elements(points.len() as u64));
            group.bench_with_input(
                BenchmarkId::new(name, corners),
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
        }
        group.throughput(Throughput::Elements(1));
        group.bench_function(BenchmarkId::new("prepare", corners), |bencher| {
            bencher
                .iter(|| membership::planar::Membership::new(black_box(&body), black_box(&motion)));
        });
        group.finish();
    }
}

criterion_group!(benches, membership, planar_membership);
criterion_main!(benches);
