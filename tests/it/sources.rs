//! What swept each triangle of a solid, against dense sampling of the named times; in a slid box
//! against what is known.

use crate::random_scenes::space::{Scene, any_scene};
use crate::support::random::Random;
use crate::support::shapes::{bumpy_sphere, cuboid, icosphere, l_prism, mapped, prism, torus};
use crate::support::sweep::{
    corpus, four_keyframes, general_affine, mesh, motion, screw, translation,
};
use glam::{DAffine3, DQuat, DVec2, DVec3};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};
use steadysweep::body::Mesh;
use steadysweep::envelope::spatial::Source;
use steadysweep::motion::{Generator, Keyframe, Motion, Span};
use steadysweep::{Precision, Sweep, SweepSettings, TriangleSource, sweep};

/// Most triangles that are looked at, per case.
const TRIANGLES: usize = 2_000;

fn traced(body: &Mesh, motion: &Motion, tolerance: f64) -> Sweep {
    let settings = SweepSettings::default()
        .with_tolerance(tolerance)
        .with_sources();
    sweep(body, motion, &settings).expect("a legal sweep succeeds")
}

fn sources(swept: &Sweep) -> &[TriangleSource] {
    let sources = swept.sources.as_deref().expect("asked for");
    assert_eq!(sources.len(), swept.solid.triangles().len(), "one for each");
    sources
}

fn corners(swept: &Sweep, triangle: usize) -> [DVec3; 3] {
    swept.solid.triangles()[triangle].map(|v| swept.solid.positions()[v as usize])
}

/// Distance of a point from a segment or a triangle, by its corners.
fn distance(part: &[DVec3], point: DVec3) -> f64 {
    let to_segment = |a: DVec3, b: DVec3| {
        let along = b - a;
        let share = (point - a).dot(along) / along.length_squared();
        point.distance(a + along * share.clamp(0.0, 1.0))
    };
    let &[a, b, c] = part else {
        return to_segment(part[0], part[1]);
    };
    let normal = (b - a).cross(c - a).normalize();
    let sides = [[a, b], [b, c], [c, a]];
    let is_over = sides
        .iter()
        .all(|[from, to]| (to - from).cross(point - from).dot(normal) >= 0.0);
    if is_over {
        return (point - a).dot(normal).abs();
    }
    let to_sides = sides.map(|[from, to]| to_segment(from, to));
    to_sides.into_iter().fold(f64::INFINITY, f64::min)
}

/// Least distance of a point from what a source names, at the times that it names: by dense
/// sampling, and then by ever closer sampling of the best of the intervals.
fn nearest(body: &Mesh, motion: &Motion, source: TriangleSource, point: DVec3) -> f64 {
    let (part, [mut start, mut end]) = match source {
        TriangleSource::Sheet { source, times, .. } => match source {
            Source::Edge(edge) => (body.edges()[edge as usize].vertices.to_vec(), times),
            Source::Face(face) => (body.triangles()[face as usize].to_vec(), times),
        },
        TriangleSource::Cap { face, time } => (body.triangles()[face as usize].to_vec(), [time; 2]),
        _ => return f64::INFINITY,
    };
    let at = |time: f64| {
        let pose = motion.pose_at_time(time);
        let place = |&v: &u32| pose.transform_point3(body.positions()[v as usize]);
        distance(&part.iter().map(place).collect::<Vec<_>>(), point)
    };
    let mut least = f64::INFINITY;
    for _ in 0..20 {
        let time = |i: u32| start + (end - start) * f64::from(i) / 20.0;
        let sampled: Vec<f64> = (0..=20).map(|i| at(time(i))).collect();
        let best = (0..=20_u32)
            .min_by(|&i, &j| sampled[i as usize].total_cmp(&sampled[j as usize]))
            .expect("sampled");
        least = least.min(sampled[best as usize]);
        (start, end) = (time(best.saturating_sub(1)), time((best + 1).min(20)));
    }
    least
}

/// Complaints about the sources of a sweep, looked at in some of its triangles.
fn complaints(name: &str, body: &Mesh, motion: &Motion, swept: &Sweep) -> Vec<String> {
    let sources = sources(swept);
    let bounds = swept.error_bound;
    let bound = bounds.inside.length.max(bounds.outside.length);
    let clock = motion.joint_times();
    let chosen: Vec<usize> = if sources.len() <= TRIANGLES {
        (0..sources.len()).collect()
    } else {
        let mut random = Random::new(5);
        let choose = |_| random.below(sources.len());
        (0..TRIANGLES).map(choose).collect()
    };
    let repairs = sources
        .iter()
        .filter(|source| **source == TriangleSource::Repair)
        .count();
    let count = sources.len();
    println!("{name}: {count} triangles, {repairs} of repairs, bound {bound:.2e}");
    let too_many =
        (100 * repairs > count).then(|| format!("{name}: {repairs} of {count} are repairs"));
    chosen
        .par_iter()
        .filter_map(|&triangle| {
            let source = sources[triangle];
            let [a, b, c] = corners(swept, triangle);
            let gap = nearest(body, motion, source, (a + b + c) / 3.0);
            let in_span = match source {
                TriangleSource::Sheet { span, times, .. } => {
                    clock[span] <= times[0] && times[0] < times[1] && times[1] <= clock[span + 1]
                }
                TriangleSource::Cap { time, .. } => {
                    clock[0] <= time && time <= clock[clock.len() - 1]
                }
                _ => true,
            };
            // A millionth for the search of the reference.
            let is_right = source == TriangleSource::Repair || gap <= bound * (1.0 + 1e-6);
            let complaint = || format!("{name}, {triangle}: {source:?} passes {gap:.2e} away");
            (!is_right || !in_span).then(complaint)
        })
        .chain(too_many)
        .collect()
}

#[test]
fn the_part_that_is_named_passes_the_triangle_at_a_time_that_is_named() {
    let bar = || {
        mesh(&cuboid(
            DVec3::new(1.0, -0.5, 0.0),
            DVec3::new(3.0, 0.5, 1.0),
        ))
    };
    let turn = screw(DVec3::new(0.1, 0.2, 1.0), DVec3::ZERO, 1.5 * PI, 2.0, 1.0);
    let on_the_spot = screw(DVec3::Z, DVec3::ZERO, 4.0, 0.05, 1.0);
    let drum = (0..40).map(|i| DVec2::from_angle(TAU * f64::from(i) / 40.0));
    let drum = mesh(&prism(&drum.collect::<Vec<_>>(), 0.8));
    let egg = mapped(icosphere(2, 1.0, DVec3::ZERO), |p| {
        p * DVec3::new(1.0, 0.8, 1.3)
    });
    let chain = motion(&[
        translation(0.7, 0.0, 0.0),
        screw(DVec3::X, DVec3::Y, 1.0, 0.3, 0.8),
        translation(0.0, 0.4, -0.5),
    ]);
    let cases = [
        ("slid box", bar(), motion(&[translation(2.0, 1.0, 0.5)])),
        ("screwed box", bar(), motion(&[turn])),
        (
            "box under an affine motion",
            bar(),
            motion(&[general_affine()]),
        ),
        ("three spans", bar(), chain.clone()),
        ("bumps on three spans", mesh(&bumpy_sphere(600)), chain),
        ("keyframes", mesh(&l_prism(0.3, 0.5)), four_keyframes()),
        (
            "torus on the spot",
            mesh(&torus(1.0, 0.4, 24, 12)),
            motion(&[on_the_spot]),
        ),
        ("drum with dropped folds", drum, motion(&[on_the_spot])),
        (
            "egg",
            mesh(&egg),
            motion(&[screw(DVec3::Y, 2.0 * DVec3::X, 2.0, 0.3, 1.0)]),
        ),
    ];
    let complaints: Vec<String> = cases
        .iter()
        .flat_map(|(name, body, motion)| {
            let swept = traced(body, motion, 1e-2 * body.diagonal());
            complaints(name, body, motion, &swept)
        })
        .collect();
    assert!(complaints.is_empty(), "{complaints:#?}");
}

#[test]
fn the_sources_of_every_case_of_the_corpus_pass_by() {
    let complaints: Vec<String> = corpus()
        .iter()
        .zip([Precision::Double, Precision::Single].into_iter().cycle())
        .flat_map(|(case, precision)| {
            let settings = SweepSettings::default()
                .with_precision(precision)
                .with_sources();
            let swept = case.sweep_with(settings, 1e-2);
            let body = case.mesh();
            complaints(case.name, &body, &case.motion, &swept)
        })
        .collect();
    assert!(complaints.is_empty(), "{complaints:#?}");
}

#[test]
fn the_sources_of_random_sweeps_pass_by() {
    let complaints: Vec<String> = (0..30)
        .flat_map(|seed| {
            let Scene { mesh, motion, .. } = any_scene(&mut Random::new(seed));
            let size = mesh.transformed(motion.start_pose()).diagonal();
            let settings = SweepSettings::default()
                .with_tolerance(3e-3 * size)
                .with_sources();
            let swept = sweep(&mesh, &motion, &settings).expect("a legal sweep succeeds");
            complaints(&format!("scene {seed}"), &mesh, &motion, &swept)
        })
        .collect();
    assert!(complaints.is_empty(), "{complaints:#?}");
}

/// Expected before the run: the three pairs of faces that look back stay where they began, those
/// that look ahead where they came to, and the six edges between them sweep the rest, without a
/// sampling error: all three corners of a triangle lie on what swept it.
#[test]
fn the_sources_of_a_slid_box_are_known() {
    let body = mesh(&cuboid(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)));
    let motion = motion(&[translation(2.0, 1.0, 0.5)]);
    let swept = traced(&body, &motion, 1e-3);
    let (mut caps, mut edges) = (BTreeSet::new(), BTreeSet::new());
    for (triangle, &source) in sources(&swept).iter().enumerate() {
        match source {
            TriangleSource::Cap { face, time } => {
                caps.insert((face, time.to_bits()));
            }
            TriangleSource::Sheet {
                source,
                span,
                times,
            } => {
                assert_eq!((span, times), (0, [0.0, 1.0]), "a single step");
                edges.insert(source);
            }
            _ => panic!("nothing is repaired"),
        }
        for corner in corners(&swept, triangle) {
            let gap = nearest(&body, &motion, source, corner);
            assert!(gap < 1e-12, "{source:?} misses {corner} by {gap:.2e}");
        }
    }
    // Of the faces of the box, two after each other, those at the lower end of an axis come first.
    let expected = (0..12).map(|face| (face, f64::from(face / 2 % 2).to_bits()));
    assert_eq!(
        caps,
        expected.collect(),
        "back at the start, ahead at the end"
    );
    let between = body.edges().iter().zip(0..).filter_map(|(edge, number)| {
        let [first, second] = edge.faces.map(|face| face / 2 % 2);
        (first != second).then_some(Source::Edge(number))
    });
    assert_eq!(edges, between.collect(), "six edges");
}

/// Keyframes of one generator, at uneven times and paces, are swept as one span. The numbers of the
/// spans and the times are still those of the keyframes.
#[test]
fn the_spans_of_merged_keyframes_are_those_that_were_given() {
    let body = mesh(&cuboid(
        DVec3::new(1.0, -0.5, 0.0),
        DVec3::new(3.0, 0.5, 1.0),
    ));
    let screw = screw(DVec3::Z, DVec3::ZERO, PI, 1.0, 1.0);
    let exact = Motion::from_spans(vec![Span::new(screw, 1.0).expect("legal")]).expect("legal");
    let key = |time: f64, share: f64| Keyframe {
        time,
        pose: exact.pose_at_time(share),
    };
    // It waits in the middle.
    let keys = [
        (-1.0, 0.0),
        (0.0, 0.1),
        (3.0, 0.5),
        (5.0, 0.5),
        (5.5, 0.9),
        (9.0, 1.0),
    ];
    let keys = keys.map(|(time, share)| key(time, share));
    let keyed = Motion::from_keyframes(&keys).expect("legal");
    let swept = traced(&body, &keyed, 0.02);
    assert_eq!(complaints("paces", &body, &keyed, &swept), [""; 0]);
    let single = traced(&body, &exact, 0.02);
    let times = |swept: &Sweep| -> BTreeSet<u64> {
        let sources = sources(swept).iter();
        let times = sources.filter_map(|source| match source {
            TriangleSource::Cap { time, .. } => Some(time.to_bits()),
            _ => None,
        });
        times.collect()
    };
    assert_eq!(
        times(&swept),
        [-1.0, 9.0].map(f64::to_bits).into(),
        "merged"
    );
    assert_eq!(times(&single), [0.0, 1.0].map(f64::to_bits).into());
    let spans: BTreeSet<usize> = sources(&swept)
        .iter()
        .filter_map(|source| match source {
            TriangleSource::Sheet { span, .. } => Some(*span),
            _ => None,
        })
        .collect();
    assert_eq!(spans, [0, 1, 3, 4].into(), "all but the one that waits");
}

/// A smooth path of a thousand poses, swept as few spans that differ from it: the part is measured
/// under the given motion.
#[test]
fn the_sources_along_a_smooth_path_are_those_of_the_given_motion() {
    let key = |i: u32| {
        let s = f64::from(i) / 1000.0;
        let at = DVec3::new(4.0 * s, (3.0 * s).sin(), s * s);
        let turn = DQuat::from_rotation_z(s) * DQuat::from_rotation_x(0.4 * s * s);
        let pose = DAffine3::from_rotation_translation(turn, at);
        Keyframe {
            time: s * s + s,
            pose,
        }
    };
    let keys: Vec<Keyframe> = (0..=1000).map(key).collect();
    let path = Motion::from_keyframes(&keys).expect("legal");
    for body in [cuboid(DVec3::ZERO, DVec3::ONE), bumpy_sphere(300)] {
        let body = mesh(&body);
        let swept = traced(&body, &path, 0.01);
        assert_eq!(complaints("path", &body, &path, &swept), [""; 0]);
    }
}

/// Only the first turn is swept, in times of the whole.
#[test]
fn the_times_of_several_turns_are_those_of_the_first() {
    let body = mesh(&cuboid(
        DVec3::new(1.0, -0.5, 0.0),
        DVec3::new(3.0, 0.5, 1.0),
    ));
    let turns = |number: f64| Generator::screw(DVec3::Z, DVec3::ZERO, number * TAU, 0.0, 1.0);
    let span = Span::new(turns(2.5), 5.0).expect("legal");
    let motion = Motion::from_spans(vec![span]).expect("legal");
    let swept = traced(&body, &motion, 0.02);
    assert_eq!(complaints("turns", &body, &motion, &swept), [""; 0]);
    let last = sources(&swept).iter().map(|source| match source {
        TriangleSource::Sheet { times, .. } => times[1],
        _ => 0.0,
    });
    let last = last.fold(0.0, f64::max);
    assert!((1.8..=2.0 + 1e-12).contains(&last), "{last}");
}

#[test]
fn a_sweep_has_no_sources_unless_asked_and_the_same_solid() {
    let body = mesh(&bumpy_sphere(300));
    let motion = motion(&[screw(DVec3::Z, 2.0 * DVec3::X, 1.0, 0.3, 1.0)]);
    let with = traced(&body, &motion, 0.02);
    let settings = SweepSettings::default().with_tolerance(0.02);
    let without = sweep(&body, &motion, &settings).expect("swept");
    assert_eq!(without.sources, None);
    assert_eq!(with.solid.positions(), without.solid.positions());
    assert_eq!(with.error_bound, without.error_bound);
}
