//! How long the logarithm of an affine map and one pose of a steady motion take, compared with a
//! naive exponential.
//!
//! Classes: friendly (general, screw, similarity; in the plane general, spiral) and hostile
//! (eigenvalues 1e-9 apart). Answers are checked first.

#[path = "../tests/it/support/random.rs"]
#[allow(
    dead_code,
    clippy::cast_possible_truncation,
    reason = "the tests use the rest, for small counts"
)]
mod random;

use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DAffine2, DAffine3, DMat2, DMat3, DVec2, DVec3};
use random::Random;
use std::hint::black_box;
use steadysweep::motion::{Flow, Generator, logarithm, path_bounds, planar, stretch};

/// The rival: the Taylor sum of the 3 x 4 generator, scaled and squared; no preparation, no
/// spectral data.
fn naive_exponential(generator: &Generator, t: f64) -> DAffine3 {
    let whole = generator.linear * t;
    let size = whole
        .to_cols_array()
        .iter()
        .fold(0.0_f64, |m, x| m.max(x.abs()));
    let halvings = (6.0 * size).max(1.0).log2().ceil();
    let x = whole * (-halvings).exp2();
    let mut coefficient = 1.0 / 87_178_291_200.0; // 14!
    let mut integral = DMat3::IDENTITY * coefficient;
    for j in (1..=13).rev() {
        coefficient *= f64::from(j + 1);
        integral = x * integral + DMat3::IDENTITY * coefficient;
    }
    let mut change = x * integral;
    let mut done = 0.0;
    while done < halvings {
        integral += change * integral * 0.5;
        change = change * 2.0 + change * change;
        done += 1.0;
    }
    DAffine3 {
        matrix3: change + DMat3::IDENTITY,
        translation: integral * generator.offset * t,
    }
}

/// 64 generators of one class: enough that branch prediction learns nothing.
fn generators(class: &str) -> Vec<Generator> {
    let mut random = Random::from_state(1);
    let mut one = || match class {
        "general" => Generator {
            linear: random.matrix(1.0),
            offset: random.point(1.0),
        },
        "screw" => Generator::screw(
            random.point(1.0).normalize(),
            random.point(1.0),
            3.0 * random.signed(),
            1.0,
            1.0,
        ),
        "similarity" => {
            let scale = random.signed().exp();
            Generator::screw(
                random.point(1.0).normalize(),
                random.point(1.0),
                3.0 * random.signed(),
                1.0,
                scale,
            )
        }
        _ => Generator {
            linear: DMat3::IDENTITY * random.signed() + random.matrix(1.0) * 1e-9,
            offset: random.point(1.0),
        },
    };
    (0..64).map(|_| one()).collect()
}

fn missed(found: &DAffine3, expected: &DAffine3) -> f64 {
    let linear = (found.matrix3 - expected.matrix3)
        .to_cols_array()
        .iter()
        .fold(0.0_f64, |m, x| m.max(x.abs()));
    linear.max((found.translation - expected.translation).length())
}

fn steady_motion(criterion: &mut Criterion) {
    for class in ["general", "screw", "similarity", "near_triple"] {
        let generators = generators(class);
        let flows: Vec<Flow> = generators
            .iter()
            .map(|&generator| Flow::new(generator))
            .collect();
        let affinities: Vec<DAffine3> = flows.iter().map(|flow| flow.pose_at(1.0)).collect();
        for ((generator, flow), a) in generators.iter().zip(&flows).zip(&affinities) {
            let half = flow.pose_at(0.3);
            assert!(
                missed(&half, &naive_exponential(generator, 0.3)) < 1e-13,
                "{class}: the two exponentials differ"
            );
            let log = logarithm(a).expect("turns below pi");
            assert!(
                missed(&log.flow.pose_at(0.3), &half) < 1e-12,
                "{class}: the logarithm leads elsewhere"
            );
        }
        let mut index = 0;
        let mut turn = move || {
            index = (index + 1) % 64;
            index
        };

        let mut group = criterion.benchmark_group("steady_motion/spatial");
        group.bench_function(BenchmarkId::new("logarithm", class), |bencher| {
            bencher.iter(|| logarithm(black_box(&affinities[turn()])));
        });
        group.bench_function(BenchmarkId::new("pose", class), |bencher| {
            bencher.iter(|| flows[turn()].pose_at(black_box(0.3)));
        });
        group.bench_function(BenchmarkId::new("pose_naive", class), |bencher| {
            bencher.iter(|| naive_exponential(&generators[turn()], black_box(0.3)));
        });
        group.bench_function(BenchmarkId::new("prepare", class), |bencher| {
            bencher.iter_batched(|| generators[turn()], Flow::new, BatchSize::SmallInput);
        });
        group.bench_function(BenchmarkId::new("path_bounds", class), |bencher| {
            bencher.iter(|| path_bounds(&generators[turn()], DVec3::ONE, black_box([0.5, 0.51])));
        });
        group.bench_function(BenchmarkId::new("stretch", class), |bencher| {
            bencher.iter(|| stretch(&generators[turn()].linear, black_box([0.0, 1.0])));
        });
        group.finish();
    }
}

fn planar_generators(class: &str) -> Vec<planar::Generator> {
    let mut random = Random::from_state(2);
    let mut one = || {
        let offset = random.point(1.0).truncate();
        let matrix = DMat2::from_cols(random.point(1.0).truncate(), random.point(1.0).truncate());
        match class {
            "general" => planar::Generator {
                linear: matrix,
                offset,
            },
            "spiral" => {
                planar::Generator::spiral(offset, 3.0 * random.signed(), random.signed().exp())
            }
            _ => planar::Generator {
                linear: DMat2::IDENTITY * random.signed() + matrix * 1e-9,
                offset,
            },
        }
    };
    (0..64).map(|_| one()).collect()
}

fn planar_steady_motion(criterion: &mut Criterion) {
    for class in ["general", "spiral", "near_double"] {
        let generators = planar_generators(class);
        let flows: Vec<planar::Flow> = generators
            .iter()
            .map(|&generator| planar::Flow::new(generator))
            .collect();
        let affinities: Vec<DAffine2> = flows.iter().map(|flow| flow.pose_at(1.0)).collect();
        for ((generator, flow), a) in generators.iter().zip(&flows).zip(&affinities) {
            let (point, half) = (DVec2::new(0.3, -0.8), flow.pose_at(0.3));
            let found = half.transform_point2(point);
            let naive = naive_exponential(&generator.in_space(), 0.3);
            let expected = naive.transform_point3(point.extend(0.0)).truncate();
            assert!(
                found.distance(expected) < 1e-13,
                "{class}: the two exponentials differ"
            );
            let log = planar::logarithm(a).expect("turns below pi");
            let again = log.flow.pose_at(0.3).transform_point2(point);
            assert!(
                again.distance(found) < 1e-12,
                "{class}: the logarithm leads elsewhere"
            );
        }
        let mut index = 0;
        let mut turn = move || {
            index = (index + 1) % 64;
            index
        };
        let mut group = criterion.benchmark_group("steady_motion/planar");
        group.bench_function(BenchmarkId::new("logarithm", class), |bencher| {
            bencher.iter(|| planar::logarithm(black_box(&affinities[turn()])));
        });
        group.bench_function(BenchmarkId::new("pose", class), |bencher| {
            bencher.iter(|| flows[turn()].pose_at(black_box(0.3)));
        });
        group.bench_function(BenchmarkId::new("prepare", class), |bencher| {
            bencher.iter_batched(
                || generators[turn()],
                planar::Flow::new,
                BatchSize::SmallInput,
            );
        });
        group.finish();
    }
}

criterion_group!(benches, steady_motion, planar_steady_motion);
criterion_main!(benches);
