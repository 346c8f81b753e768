//! Crossings of vertices with planes against dense samples of heights, and cases that are known.

use crate::support::random::Random;
use crate::support::shapes::{cuboid, icosphere};
use crate::support::sweep::screw;
use glam::{DAffine3, DMat3, DQuat, DVec3};
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;
use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;
use steadysweep::body::Surface;
use steadysweep::collision::{
    Crossing, Plane, PlaneError, PlaneSettings, PlanesError, Sense, Side, planes,
};
use steadysweep::motion::following::{self, Follow};
use steadysweep::motion::scheme::{Keyed, Scheme};
use steadysweep::motion::{Generator, HalfTurns, Keyframe, Motion, MotionError, Span};

fn chain(spans: &[(Generator, f64)]) -> Motion {
    let spans = spans
        .iter()
        .map(|&(generator, duration)| Span::new(generator, duration).expect("a span"));
    Motion::from_spans(spans.collect()).expect("a motion")
}

/// A surface of one triangle for each point, which is all three of its corners.
fn points(points: &[DVec3]) -> Surface {
    let triangles = (0..).take(points.len()).map(|i| [i; 3]).collect();
    Surface::new(points.to_vec(), triangles).expect("a surface")
}

fn crossings(surface: &Surface, motion: &Motion, list: &[Plane]) -> Vec<Crossing> {
    planes(surface, motion, list, &PlaneSettings::default()).expect("crossings")
}

fn plane(point: [f64; 3], normal: [f64; 3]) -> Plane {
    Plane::new(DVec3::from_array(point), DVec3::from_array(normal)).expect("a plane")
}

/// The time at which a height samples must not be compared: it is rounding.
const ROUNDING: f64 = 1e-11;

/// Checks the crossings of each vertex with each plane against the signs of sampled heights.
/// Returns the number of changes of sign that were seen.
fn compare(
    surface: &Surface,
    motion: &Motion,
    list: &[Plane],
    found: &[Crossing],
    steps: u32,
) -> usize {
    let times = motion.joint_times();
    let [start, end] = [times[0], times[times.len() - 1]];
    let samples: Vec<_> = (0..=steps)
        .map(|i| start + (end - start) * f64::from(i) / f64::from(steps))
        .map(|time| (time, motion.pose_at_time(time)))
        .collect();
    let mut changes = 0;
    for (number, plane) in list.iter().enumerate() {
        for (vertex, &position) in (0..).zip(surface.positions()) {
            let own: Vec<&Crossing> = found
                .iter()
                .filter(|crossing| crossing.plane == number && crossing.vertex == vertex)
                .collect();
            let mut next = 0;
            let mut last: Option<bool> = None;
            for (time, pose) in &samples {
                let height = plane
                    .normal()
                    .dot(pose.transform_point3(position) - plane.point());
                while next < own.len() && own[next].bracket[1] < *time {
                    next += 1;
                }
                if own.get(next).is_some_and(|c| c.bracket[0] <= *time) {
                    continue;
                }
                let above = height > 0.0;
                if height.abs() > ROUNDING {
                    let before = next.checked_sub(1).map(|i| own[i].sides[1]);
                    let after = own.get(next).map(|c| c.sides[0]);
                    for side in [before, after].into_iter().flatten() {
                        let side =
                            side.expect("a side is known where there is time before or after");
                        let expected = side == Side::Front;
                        assert_eq!(
                            above, expected,
                            "vertex {vertex}, plane {number} at {time}: {height:e}"
                        );
                    }
                    if own.is_empty() {
                        assert!(
                            last.is_none_or(|last| last == above),
                            "vertex {vertex}, plane {number}: a crossing before {time} is missing"
                        );
                    }
                    changes += usize::from(last.is_some_and(|last| last != above));
                    last = Some(above);
                }
            }
            for crossing in own {
                let [from, to] = crossing.bracket;
                assert!(from <= crossing.time && crossing.time <= to, "{crossing:?}");
                assert!(start <= from && to <= end, "{crossing:?}");
                let place = motion
                    .pose_at_time(crossing.time)
                    .transform_point3(position);
                assert!(
                    plane.height(place).abs()
                        < ROUNDING * (1.0 + place.length() + plane.point().length()),
                    "{crossing:?}"
                );
            }
        }
    }
    changes
}

#[test]
fn random_motions_agree_with_dense_samples_of_heights() {
    let counted: usize = (0..60_u64)
        .into_par_iter()
        .map(|seed| {
            let mut random = Random::new(7000 + seed);
            let size = random.one_of(&[1e-3, 1.0, 1e3]);
            let positions: Vec<DVec3> = (0..30).map(|_| random.point(size)).collect();
            let surface = points(&positions);
            let spans: Vec<(Generator, f64)> = (0..1 + random.below(3))
                .map(|_| {
                    let turn = random.matrix(3.0);
                    let linear = match random.below(3) {
                        0 => turn - turn.transpose(),
                        1 => turn * 0.3,
                        _ => DMat3::ZERO,
                    };
                    let offset = random.point(2.0 * size);
                    (Generator { linear, offset }, random.between(0.5, 2.0))
                })
                .collect();
            let motion = chain(&spans);
            let list: Vec<Plane> = (0..3)
                .map(|_| Plane::new(random.point(size), random.direction()).expect("a plane"))
                .collect();
            let found = crossings(&surface, &motion, &list);
            let changes = compare(&surface, &motion, &list, &found, 3000);
            let passes = found.iter().filter(|c| c.sense() != Sense::Touch).count();
            assert!(
                passes >= changes,
                "{passes} crossings for {changes} changes of sign"
            );
            for crossing in &found {
                let width = crossing.bracket[1] - crossing.bracket[0];
                assert!(width < 1e-6, "{crossing:?} of a random motion");
            }
            assert!(
                found.is_sorted_by(|a, b| a.time <= b.time),
                "in order of time"
            );
            changes
        })
        .sum();
    assert!(
        counted > 2000,
        "{counted} changes of sign are enough to compare"
    );
}

#[test]
fn only_the_first_of_each_plane_is_the_first_of_all() {
    let (positions, triangles) = icosphere(3, 1.0, DVec3::new(3.0, 0.0, 0.0));
    let surface = Surface::new(positions, triangles).expect("a surface");
    let motion = chain(&[
        (screw(DVec3::Z, DVec3::ZERO, 2.0, 0.5, 1.0), 1.0),
        (screw(DVec3::Y, DVec3::X, 3.0, 0.5, 1.2), 1.0),
    ]);
    let list = [
        plane([0.0; 3], [1.0, 0.2, 0.0]),
        plane([0.0, 2.0, 0.0], [0.0, 1.0, 0.3]),
        plane([0.0, 0.0, 1e3], [0.0, 0.0, 1.0]),
        plane([3.0, 0.0, 0.5], [0.0, 0.0, 1.0]),
    ];
    let all = crossings(&surface, &motion, &list);
    assert!(all.len() > 1000, "{}", all.len());
    let settings = PlaneSettings::default().with_first_only();
    let first = planes(&surface, &motion, &list, &settings).expect("crossings");
    let expected: Vec<Crossing> = {
        let firsts = (0..list.len()).filter_map(|number| all.iter().find(|c| c.plane == number));
        let mut firsts: Vec<Crossing> = firsts.copied().collect();
        firsts.sort_by(|a, b| a.time.total_cmp(&b.time));
        firsts
    };
    assert_eq!(first.len(), 3, "one plane is out of reach");
    let keys = |list: &[Crossing]| -> Vec<_> {
        list.iter()
            .map(|c| (c.plane, c.vertex, c.time.to_bits(), c.bracket, c.sides[0]))
            .collect()
    };
    assert_eq!(keys(&first), keys(&expected));
    for threads in [1, 2, 7] {
        let pool = ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads can be started");
        let again = pool.install(|| crossings(&surface, &motion, &list));
        assert_eq!(again, all, "{threads} threads");
    }
    compare(&surface, &motion, &list, &all, 300);
}

/// The only crossing, with its sides.
fn only(point: DVec3, motion: &Motion, plane: Plane) -> Crossing {
    let found = crossings(&points(&[point]), motion, &[plane]);
    assert_eq!(found.len(), 1, "{found:?}");
    found[0]
}

#[test]
fn vertices_that_rest_start_end_touch_and_slide_in_the_plane() {
    let floor = plane([0.0; 3], [0.0, 0.0, 1.0]);
    let (front, behind) = (Some(Side::Front), Some(Side::Behind));
    let along = Generator::translation(DVec3::X);
    let up = Generator::translation(DVec3::Z);
    let down = Generator::translation(-DVec3::Z);
    let still = Generator::translation(DVec3::ZERO);
    let roll = screw(DVec3::Y, DVec3::Z, 2.0, 0.0, 1.0);
    let spin = screw(DVec3::Z, DVec3::X, 20.0, 0.0, 1.0);
    let shrink = screw(DVec3::Z, DVec3::X, 2.0, 0.0, 0.5);
    let lowest = DVec3::new(1.0_f64.sin(), 0.0, 1.0 - 1.0_f64.cos());
    // Spans, start, expected time, ends of the bracket, sides, sense.
    let cases = [
        (
            vec![along],
            DVec3::Y,
            0.0,
            [0.0, 1.0],
            [None, None],
            Sense::Touch,
        ),
        (
            vec![still, along],
            DVec3::Y,
            0.0,
            [0.0, 2.0],
            [None, None],
            Sense::Touch,
        ),
        (
            vec![spin],
            DVec3::Y,
            0.0,
            [0.0, 1.0],
            [None, None],
            Sense::Touch,
        ),
        (
            vec![shrink],
            DVec3::Y,
            0.0,
            [0.0, 1.0],
            [None, None],
            Sense::Touch,
        ),
        (
            vec![up],
            DVec3::Y,
            0.0,
            [0.0, 0.0],
            [None, front],
            Sense::Leave,
        ),
        (
            vec![down],
            DVec3::Y,
            0.0,
            [0.0, 0.0],
            [None, behind],
            Sense::Enter,
        ),
        (
            vec![down],
            DVec3::Z,
            1.0,
            [1.0, 1.0],
            [front, None],
            Sense::Touch,
        ),
        (
            vec![up, along],
            -DVec3::Z,
            1.0,
            [1.0, 2.0],
            [behind, None],
            Sense::Touch,
        ),
        (
            vec![down, up],
            DVec3::Z,
            1.0,
            [1.0, 1.0],
            [front, front],
            Sense::Touch,
        ),
        (
            vec![up, down],
            -DVec3::Z,
            1.0,
            [1.0, 1.0],
            [behind, behind],
            Sense::Touch,
        ),
        (
            vec![down, along, still, down],
            DVec3::Z,
            1.0,
            [1.0, 3.0],
            [front, behind],
            Sense::Enter,
        ),
        (
            vec![down, spin, up],
            DVec3::Z,
            1.0,
            [1.0, 2.0],
            [front, front],
            Sense::Touch,
        ),
        (
            vec![down, down],
            DVec3::Z,
            1.0,
            [1.0, 1.0],
            [front, behind],
            Sense::Enter,
        ),
        (
            vec![roll],
            lowest,
            0.5,
            [0.5, 0.5],
            [front, front],
            Sense::Touch,
        ),
    ];
    for (number, (spans, start, time, bracket, sides, sense)) in cases.into_iter().enumerate() {
        let spans: Vec<_> = spans.into_iter().map(|span| (span, 1.0)).collect();
        let found = only(start, &chain(&spans), floor);
        // At the tangency, rounding counts by its square root.
        let close = if number == 13 { 1e-6 } else { 1e-13 };
        assert!(
            (found.time - time).abs() <= close,
            "case {number}: {found:?}"
        );
        for (found, expected) in found.bracket.iter().zip(bracket) {
            assert!((found - expected).abs() <= close, "case {number}: {found}");
        }
        assert!(
            found.bracket[0] <= bracket[0] && bracket[1] <= found.bracket[1],
            "case {number}"
        );
        assert_eq!(
            (found.sides, found.sense()),
            (sides, sense),
            "case {number}"
        );
    }
    // Just above, and just below the lowest point.
    let motion = chain(&[(roll, 1.0)]);
    let lower = |by: f64| {
        let floor = plane([0.0, 0.0, by], [0.0, 0.0, 1.0]);
        crossings(&points(&[lowest]), &motion, &[floor])
    };
    assert_eq!(lower(-1e-10), [], "clear by 1e-10");
    let both = lower(1e-6);
    assert_eq!(both.len(), 2, "{both:?}");
    let expected = 0.5 * (1.0_f64 - 1e-6).acos();
    for (crossing, time) in both.iter().zip([0.5 - expected, 0.5 + expected]) {
        let [from, to] = crossing.bracket;
        assert!(
            from <= time && time <= to && to - from < 1e-10,
            "{crossing:?} for {time}"
        );
    }
}

#[test]
fn far_planes_long_turns_and_late_clocks_have_certain_brackets() {
    // A plane at 1e6, through which a point passes at a quarter.
    let motion = chain(&[(Generator::translation(DVec3::new(4e6, 1.0, 0.0)), 1.0)]);
    let wall = plane([1e6, 3e5, -2e6], [-1.0, 0.0, 0.0]);
    let found = only(DVec3::ZERO, &motion, wall);
    let [from, to] = found.bracket;
    assert!(from <= 0.25 && 0.25 <= to && to - from < 1e-13, "{found:?}");
    assert_eq!(found.sense(), Sense::Enter, "{found:?}");
    // A body of size 1 before a plane that is near it, given by a point that is far away.
    let motion = chain(&[(Generator::translation(DVec3::X), 1.0)]);
    let wall = plane([0.5, 1e6, -1e6], [1.0, 0.0, 0.0]);
    let found = only(DVec3::ZERO, &motion, wall);
    let [from, to] = found.bracket;
    assert!(from <= 0.5 && 0.5 <= to && to - from < 1e-13, "{found:?}");
    // A thousand turns: two crossings each, at sin a = 0.3.
    let motion = chain(&[(screw(DVec3::Z, DVec3::ZERO, 2000.0 * PI, 0.0, 1.0), 3.0)]);
    let wall = plane([0.0, 0.3, 0.0], [0.0, 1.0, 0.0]);
    let found = crossings(&points(&[DVec3::X]), &motion, &[wall]);
    assert_eq!(found.len(), 2000);
    let angle = 0.3_f64.asin();
    for (number, crossing) in found.iter().enumerate() {
        let turn = (number / 2) as f64;
        let within = if number % 2 == 0 { angle } else { PI - angle };
        let expected = 3.0 * (turn + within / (2.0 * PI)) / 1000.0;
        let [from, to] = crossing.bracket;
        assert!(
            from <= expected && expected <= to && to - from < 1e-13,
            "{crossing:?} for {expected}"
        );
    }
    // Too many turns are refused, and so is a motion out of range.
    let motion = chain(&[(screw(DVec3::Z, DVec3::ZERO, 1e5, 0.0, 1.0), 1.0)]);
    let surface = points(&[DVec3::X]);
    let settings = PlaneSettings::default();
    assert_eq!(
        planes(&surface, &motion, &[wall], &settings),
        Err(PlanesError::TooLong)
    );
    let motion = chain(&[(Generator::translation(DVec3::X * 1e19), 1.0)]);
    let refused = planes(&surface, &motion, &[wall], &settings);
    assert!(
        matches!(refused, Err(PlanesError::TooFar { .. })),
        "{refused:?}"
    );
    let up = AtomicBool::new(true);
    let settings = PlaneSettings::default().with_interrupt(&up);
    let refused = planes(&surface, &motion, &[wall], &settings);
    assert_eq!(refused, Err(PlanesError::Interrupted));
    let refused = Plane::new(DVec3::ZERO, DVec3::ZERO);
    assert!(
        matches!(refused, Err(PlaneError::Normal { .. })),
        "{refused:?}"
    );
}

#[test]
fn brackets_hold_for_the_motion_that_a_chain_stands_for() {
    // Between two poses every point moves along a straight line at constant speed.
    let turned = DAffine3::from_rotation_translation(DQuat::from_rotation_y(1.2), -6.0 * DVec3::Z);
    let keys =
        [(0.0, DAffine3::IDENTITY), (1.0, turned)].map(|(time, pose)| Keyframe { time, pose });
    let (positions, triangles) = icosphere(2, 1.0, DVec3::Z * 3.0);
    let follow = Follow {
        body: &positions,
        deviation: 1e-3,
    };
    let linear = Keyed::new(Scheme::Linear, &keys);
    let motion: Motion =
        following::keyframes(&linear, &HalfTurns::Refused, &follow).expect("a motion");
    let off = motion.deviation().expect("it deviates").length;
    assert!(off > 1e-5, "{off}");
    let surface = Surface::new(positions.clone(), triangles).expect("a surface");
    let found = crossings(&surface, &motion, &[plane([0.0; 3], [0.0, 0.0, 1.0])]);
    assert_eq!(found.len(), positions.len());
    for crossing in found {
        let position = positions[crossing.vertex as usize];
        let [from, to] = [position.z, turned.transform_point3(position).z];
        let expected = from / (from - to);
        let [start, end] = crossing.bracket;
        assert!(
            start <= expected && expected <= end,
            "{crossing:?} for {expected}"
        );
        let width = 2.0 * off / (from - to);
        assert!(
            end - start < 3.0 * width,
            "{crossing:?} is wider than {width}"
        );
        assert_eq!(crossing.sense(), Sense::Enter);
    }
    let larger = Surface::new(vec![DVec3::splat(9.0)], vec![[0; 3]]).expect("a surface");
    let settings = PlaneSettings::default();
    let refused = planes(
        &larger,
        &motion,
        &[plane([0.0; 3], [0.0, 0.0, 1.0])],
        &settings,
    );
    let expected = PlanesError::Motion(MotionError::FollowedForAnother);
    assert_eq!(refused, Err(expected));
    // Nothing but values is known of a function.
    let pose = |time: f64| DAffine3::from_translation(-DVec3::Z * (6.0 * time * time));
    let motion: Motion = following::function(pose, [0.0, 1.0], &follow).expect("a motion");
    let refused = planes(
        &surface,
        &motion,
        &[plane([0.0; 3], [0.0, 0.0, 1.0])],
        &settings,
    );
    assert_eq!(refused, Err(PlanesError::Estimated));
}

#[test]
fn a_cube_that_turns_over_its_edge_puts_the_next_side_down() {
    let (positions, triangles) = cuboid(DVec3::ZERO, DVec3::ONE);
    let surface = Surface::new(positions, triangles).expect("a surface");
    let motion = chain(&[(screw(DVec3::Y, DVec3::X, PI / 2.0, 0.0, 1.0), 1.0)]);
    let found = crossings(&surface, &motion, &[plane([0.0; 3], [0.0, 0.0, 1.0])]);
    let mut kinds: Vec<(Sense, bool, bool)> = found
        .iter()
        .map(|c| (c.sense(), c.time == 0.0, c.bracket[1] == 1.0))
        .collect();
    kinds.sort_by_key(|kind| (kind.1, kind.2));
    // The side that comes down at the end, the one that leaves, and the edge that stays.
    let expected = [
        (Sense::Touch, false, true),
        (Sense::Touch, false, true),
        (Sense::Leave, true, false),
        (Sense::Leave, true, false),
        (Sense::Touch, true, true),
        (Sense::Touch, true, true),
    ];
    assert_eq!(kinds, expected, "{found:?}");
}
