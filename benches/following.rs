//! How long it takes to follow a motion by steady spans, within a proven deviation: keyframes joined
//! by SLERP and LERP, and a recorded path that becomes few spans.
//!
//! The rival is the plain way: even spans, twice as many until the largest distance at 16 times in
//! each is within the deviation. It proves nothing. Answers are checked first.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DAffine3, DQuat, DVec3};
use std::hint::black_box;
use steadysweep::motion::following::{Follow, keyframes, thinned};
use steadysweep::motion::scheme::{Keyed, Scheme};
use steadysweep::motion::{HalfTurns, Keyframe, Motion};

/// A unit cube.
fn body() -> Vec<DVec3> {
    let corner = |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
    (0..8).map(corner).collect()
}

/// A path that bends and turns all the time, of length 40.
fn pose(s: f64) -> DAffine3 {
    let axis = DVec3::new((2.0 * s).sin(), (1.3 * s).cos(), 0.5).normalize();
    let place = DVec3::new(s, (0.5 * s).sin() * 3.0, (0.3 * s).cos() * 5.0);
    DAffine3::from_rotation_translation(DQuat::from_axis_angle(axis, 0.4 * s), place)
}

fn keys(count: u32) -> Vec<Keyframe> {
    let times = (0..=count).map(|i| 40.0 * f64::from(i) / f64::from(count));
    times
        .map(|time| Keyframe {
            time,
            pose: pose(time),
        })
        .collect()
}

/// Largest distance of the corners from where a motion has them, at some times of each span.
fn seen(chain: &Motion, given: impl Fn(f64) -> DAffine3, body: &[DVec3]) -> f64 {
    let mut seen = 0.0_f64;
    for pair in chain.joint_times().windows(2) {
        for sample in 1..16 {
            let time = pair[0] + (pair[1] - pair[0]) * f64::from(sample) / 16.0;
            let (a, b) = (given(time), chain.pose_at_time(time));
            for &x in body {
                seen = seen.max(a.transform_point3(x).distance(b.transform_point3(x)));
            }
        }
    }
    seen
}

/// SLERP and LERP between keyframes.
fn polar_pose(keys: &[Keyframe], time: f64) -> DAffine3 {
    let key = keys
        .partition_point(|key| key.time <= time)
        .clamp(1, keys.len() - 1);
    let [from, to] = [&keys[key - 1], &keys[key]];
    let u = (time - from.time) / (to.time - from.time);
    let [a, b] = [from, to].map(|key| DQuat::from_mat3(&key.pose.matrix3));
    let place = from.pose.translation.lerp(to.pose.translation, u);
    DAffine3::from_rotation_translation(a.slerp(b, u), place)
}

fn plain(keys: &[Keyframe], body: &[DVec3], deviation: f64) -> Motion {
    let mut parts = 1;
    loop {
        let even = keys.windows(2).flat_map(|pair| {
            let [from, to] = [pair[0].time, pair[1].time];
            (0..parts).map(move |part| from + (to - from) * f64::from(part) / f64::from(parts))
        });
        let last = keys.last().map(|key| key.time);
        let times: Vec<f64> = even.chain(last).collect();
        let sampled: Vec<Keyframe> = times
            .iter()
            .map(|&time| Keyframe {
                time,
                pose: polar_pose(keys, time),
            })
            .collect();
        let chain = Motion::from_keyframes(&sampled).expect("legal");
        if seen(&chain, |time| polar_pose(keys, time), body) <= deviation {
            return chain;
        }
        parts *= 2;
    }
}

fn following(criterion: &mut Criterion) {
    let body = body();
    let mut group = criterion.benchmark_group("following");
    group.sample_size(10);
    let poses = keys(200);
    for deviation in [1e-2, 1e-3] {
        let follow = Follow {
            body: &body,
            deviation,
        };
        let keyed = Keyed::new(Scheme::Polar, &poses);
        let run = || -> Motion { keyframes(&keyed, &HalfTurns::Refused, &follow).expect("legal") };
        let chain = run();
        let off = seen(&chain, |time| polar_pose(&poses, time), &body);
        let plain_chain = plain(&poses, &body, deviation);
        println!(
            "200 keyframes within {deviation}: {} spans, {off:.2e} seen; plain {} spans",
            chain.spans().len(),
            plain_chain.spans().len()
        );
        assert!(off <= deviation, "{off} > {deviation}");
        group.bench_function(BenchmarkId::new("200 keyframes polar", deviation), |b| {
            b.iter(|| black_box(run()));
        });
        group.bench_function(BenchmarkId::new("200 keyframes plain", deviation), |b| {
            b.iter(|| black_box(plain(&poses, &body, deviation)));
        });
    }
    let recorded = Motion::from_keyframes(&keys(100_000)).expect("legal");
    let follow = Follow {
        body: &body,
        deviation: 1e-2,
    };
    let chain = thinned(&recorded, &follow).expect("legal");
    let off = seen(&chain, |time| recorded.pose_at_time(time), &body);
    println!(
        "100,000 poses within 0.01: {} spans, {off:.2e} seen",
        chain.spans().len()
    );
    assert!(off <= 1e-2, "{off}");
    group.bench_function("100,000 poses thinned", |b| {
        b.iter(|| black_box(thinned(&recorded, &follow).expect("legal")));
    });
    group.finish();
}

criterion_group!(benches, following);
criterion_main!(benches);
