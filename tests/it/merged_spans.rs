//! Many spans of one generator are one motion: the same surface, the same times, and no more work.

use crate::support::shapes;
use crate::support::sweep::{agreement, mesh, swept};
use glam::{DAffine2, DAffine3, DMat3, DQuat, DVec2, DVec3};
use std::f64::consts::{PI, TAU};
use steadysweep::body::{FillRule, Mesh, Polygon, Surface};
use steadysweep::collision::{Check, CheckSettings, FirstContact, Obstacle, Verdict, check};
use steadysweep::membership::{Membership, planar as planar_membership};
use steadysweep::motion::{Flow, Generator, Keyframe, Motion, Span, planar};
use steadysweep::{SweepSettings, sweep};

/// A box of 2 x 1 x 1 next to the origin.
fn body() -> Mesh {
    let [low, high] = [DVec3::new(1.0, -0.5, 0.0), DVec3::new(3.0, 0.5, 1.0)];
    mesh(&shapes::cuboid(low, high))
}

fn one(generator: Generator, duration: f64) -> Motion {
    Motion::from_spans(vec![Span::new(generator, duration).expect("legal")]).expect("legal")
}

/// Keyframes of a generator, given by its shares and times.
fn keyed(generator: Generator, keys: impl Iterator<Item = [f64; 2]>) -> Motion {
    let flow = Flow::new(generator);
    let keys: Vec<Keyframe> = keys
        .map(|[share, time]| Keyframe {
            time,
            pose: flow.pose_at(share),
        })
        .collect();
    Motion::from_keyframes(&keys).expect("legal")
}

fn even(count: u32, duration: f64) -> impl Iterator<Item = [f64; 2]> {
    (0..=count).map(move |i| {
        let share = f64::from(i) / f64::from(count);
        [share, share * duration]
    })
}

fn screw(turn: f64) -> Generator {
    let axis = DVec3::new(0.1, 0.2, 1.0).normalize();
    Generator::screw(axis, DVec3::ZERO, turn, 0.6 * turn, 1.0)
}

/// Expected before the run: as many triangles as for one span, up to a few percent, and the volume
/// within both bounds. Before runs were merged there were four times as many.
#[test]
fn two_hundred_keyframes_of_a_screw_are_swept_as_one() {
    let (body, settings) = (body(), SweepSettings::default().with_tolerance(0.02));
    let turn = 1.5 * PI;
    let single = sweep(&body, &one(screw(turn), 1.0), &settings).expect("swept");
    let many = sweep(&body, &keyed(screw(turn), even(200, 7.0)), &settings).expect("swept");
    let counts = [&single, &many].map(|swept| swept.cycle_triangles);
    let ratio = counts[1] as f64 / counts[0] as f64;
    assert!((ratio - 1.0).abs() < 0.03, "{counts:?}");
    let [a, b] = [&single, &many].map(|swept| swept.solid.measures());
    let bound = |swept: &steadysweep::Sweep| {
        swept.error_bound.inside.length + swept.error_bound.outside.length
    };
    let allowed = a.area * (bound(&single) + bound(&many));
    assert!(
        (a.volume - b.volume).abs() < allowed,
        "{} and {}",
        a.volume,
        b.volume
    );
    assert!(
        bound(&many) < 1.01 * bound(&single),
        "the deviation is rounding"
    );
}

#[test]
fn two_turns_in_many_keyframes_are_swept_once() {
    let (body, settings) = (body(), SweepSettings::default().with_tolerance(0.05));
    let turn = |turns: f64| Generator::screw(DVec3::Z, DVec3::ZERO, turns * TAU, 0.0, 1.0);
    let single = sweep(&body, &one(turn(2.0), 1.0), &settings).expect("swept");
    let many = sweep(&body, &keyed(turn(2.0), even(90, 1.0)), &settings).expect("swept");
    assert_eq!(many.cycle_triangles, single.cycle_triangles, "once round");
    assert_eq!(many.solid.measures().genus, 1, "a ring");
}

/// Keyframes of a path whose generator changes all the time, so that no two spans are exactly one.
fn smooth(count: u32) -> Motion {
    let pose = |s: f64| {
        let axis = DVec3::new(s.sin(), (1.3 * s).cos(), 0.5).normalize();
        let turn = DQuat::from_axis_angle(axis, 1.8 * s);
        let place = DVec3::new(4.0 * s, (3.0 * s).sin(), (2.0 * s).cos());
        DAffine3::from_rotation_translation(turn, place)
    };
    let keys: Vec<Keyframe> = (0..=count)
        .map(|key| f64::from(key) / f64::from(count))
        .map(|time| Keyframe {
            time,
            pose: pose(time),
        })
        .collect();
    Motion::from_keyframes(&keys).expect("legal")
}

/// The expectation, stated before the test ran: spans that differ by less than a tenth of the
/// tolerance are merged, so that 1,600 keyframes give about as many triangles as 400, and the
/// bounds hold for the motion as given.
#[test]
fn a_smooth_path_of_many_keyframes_is_swept_as_the_path() {
    let (body, tolerance) = (body(), 0.02);
    let sweeps = [400, 1_600].map(|count| swept(&body, &smooth(count), tolerance));
    let counts = sweeps.each_ref().map(|swept| swept.cycle_triangles);
    let ratio = counts[1] as f64 / counts[0] as f64;
    assert!((0.7..1.3).contains(&ratio), "{counts:?}");
    for (count, swept) in [400, 1_600].into_iter().zip(&sweeps) {
        let measures = swept.solid.measures();
        let topology = [measures.components, measures.voids, measures.genus];
        assert_eq!(topology, [1, 0, 0], "{count} keyframes");
        assert!(swept.error_bound.inside.length <= tolerance, "{count}");
        let differing = agreement(&body, &smooth(count), swept, 20_000).defects(swept);
        assert!(differing.is_empty(), "{count} keyframes: {differing}");
    }
}

#[test]
fn many_keyframes_in_the_plane_are_swept_as_one() {
    let corners = [(1.0, -0.5), (3.0, -0.5), (3.0, 0.5), (1.0, 0.5)].map(DVec2::from);
    let square = Polygon::new(vec![corners.to_vec()], FillRule::NonZero).expect("a rectangle");
    let key = |i: u32| planar::Keyframe {
        time: f64::from(i),
        pose: DAffine2::from_angle(1.5 * PI * f64::from(i) / 200.0),
    };
    let keys: Vec<planar::Keyframe> = (0..=200).map(key).collect();
    let many = planar::Motion::from_keyframes(&keys).expect("legal");
    let spiral = planar::Generator::spiral(DVec2::ZERO, 1.5 * PI, 1.0);
    let span = planar::Span::new(spiral, 200.0).expect("legal");
    let single = planar::Motion::from_spans(vec![span]).expect("legal");
    let settings = steadysweep::planar::SweepSettings::default().with_tolerance(1e-3);
    let [a, b] = [&single, &many]
        .map(|motion| steadysweep::planar::sweep(&square, motion, &settings).expect("swept"));
    let ratio = b.cycle_segments as f64 / a.cycle_segments as f64;
    assert!(
        (ratio - 1.0).abs() < 0.03,
        "{} and {}",
        a.cycle_segments,
        b.cycle_segments
    );
    assert!(
        (a.measures.area - b.measures.area).abs() < 1e-9,
        "the same curves"
    );

    let memberships =
        [&single, &many].map(|motion| planar_membership::Membership::new(&square, motion));
    for i in 0..50 {
        // No path only touches a side, as it would at a distance of 1 or 3: at a tangency, rounding
        // moves the time by its root.
        let point = DVec2::from_angle(0.1 * f64::from(i)) * (0.93 + 0.05 * f64::from(i % 40));
        let [a, b] = memberships
            .each_ref()
            .map(|membership| membership.intervals(point));
        near(&a, &b, 1e-12 * 200.0, &point);
    }
}

fn near(a: &[[f64; 2]], b: &[[f64; 2]], limit: f64, of: &impl std::fmt::Debug) {
    assert_eq!(a.len(), b.len(), "{of:?}: {a:?} and {b:?}");
    for (time, other) in a.as_flattened().iter().zip(b.as_flattened()) {
        assert!((time - other).abs() <= limit, "{of:?}: {time} and {other}");
    }
}

fn wall() -> Surface {
    let corners = [(0.0, 2.0, -9.0), (0.3, 2.5, 9.0), (-0.2, 9.0, 0.0)].map(DVec3::from);
    Surface::new(corners.to_vec(), vec![[0, 1, 2]]).expect("a triangle")
}

fn checked(body: &Mesh, motion: &Motion, surface: &Surface, other: Option<&Motion>) -> Check {
    let obstacle = Obstacle {
        surface,
        motion: other,
    };
    let settings = CheckSettings::default().with_all_intervals();
    check(body, motion, &[obstacle], &settings).expect("checked")
}

fn contact(check: &Check) -> FirstContact {
    match check.verdict {
        Verdict::Contact(first) => first,
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn times_of_many_keyframes_are_those_of_one_span() {
    let (body, surface) = (body(), wall());
    let generators = [
        screw(1.2 * PI),
        Generator::translation(DVec3::new(-6.0, 5.0, 0.5)),
        Generator::screw(DVec3::Z, DVec3::new(0.5, 0.0, 0.0), 0.9 * PI, 0.5, 1.4),
    ];
    for generator in generators {
        let [single, many] = [one(generator, 50.0), keyed(generator, even(200, 50.0))];
        let [a, b] = [&single, &many].map(|motion| checked(&body, motion, &surface, None));
        let [first, second] = [&a, &b].map(contact);
        assert!(
            (first.time - second.time).abs() < 1e-12 * 50.0,
            "{} and {}",
            first.time,
            second.time
        );
        assert_eq!(
            second.span,
            many.span_at_time(second.time),
            "as the keyframes count"
        );
        assert_eq!(first.features, second.features);
        let [a, b] = [a, b].map(|check| {
            let intervals = check.intervals.expect("asked for");
            intervals
                .iter()
                .map(|interval| interval.times)
                .collect::<Vec<_>>()
        });
        near(&a, &b, 1e-12 * 50.0, &generator);
        // The same where the wall moves, and the body rests.
        let rest = one(Generator::translation(DVec3::ZERO), 50.0);
        let back = Generator {
            linear: -generator.linear,
            offset: -generator.offset,
        };
        let [c, d] = [one(back, 50.0), keyed(back, even(200, 50.0))]
            .map(|other| contact(&checked(&body, &rest, &surface, Some(&other))));
        assert!(
            (c.time - d.time).abs() < 1e-12 * 50.0,
            "{} and {}",
            c.time,
            d.time
        );

        let memberships = [&single, &many].map(|motion| Membership::new(&body, motion));
        for i in 0..40 {
            let place = DVec3::new(2.0, 0.3 * f64::from(i % 3) - 0.3, 0.1 + 0.02 * f64::from(i));
            let point = Flow::new(generator)
                .pose_at(f64::from(i) / 40.0)
                .transform_point3(place);
            let [a, b] = memberships
                .each_ref()
                .map(|membership| membership.intervals(point));
            near(&a, &b, 1e-12 * 50.0, &point);
        }
    }
}

/// Time runs unevenly over the keyframes: a rest, a rush, and even pieces in between.
#[test]
fn times_of_uneven_keyframes_are_those_of_their_clock() {
    let (body, surface) = (body(), wall());
    let clock = |share: f64| match share {
        s if s <= 0.3 => 10.0 * s,
        s if s <= 0.5 => 5.0 + 2.0 * (s - 0.3),
        s => 5.4 + 8.0 * (s - 0.5),
    };
    let shares = (0..=100).map(|i| f64::from(i) / 100.0);
    let keys = shares.flat_map(|share| {
        let rest = (share == 0.3).then_some([share, 5.0]);
        std::iter::once([share, clock(share)]).chain(rest)
    });
    let generator = screw(1.2 * PI);
    let (many, single) = (keyed(generator, keys), one(generator, 1.0));
    let share = contact(&checked(&body, &single, &surface, None)).time;
    let first = contact(&checked(&body, &many, &surface, None));
    assert!(
        (first.time - clock(share)).abs() < 1e-11,
        "{} for {}",
        first.time,
        clock(share)
    );
    assert_eq!(
        first.span,
        many.span_at_time(first.time),
        "as the keyframes count"
    );
    let memberships = [&single, &many].map(|motion| Membership::new(&body, motion));
    for i in 0..40 {
        let place = DVec3::new(2.0, 0.0, 0.1 + 0.02 * f64::from(i));
        let point = Flow::new(generator)
            .pose_at(f64::from(i) / 40.0)
            .transform_point3(place);
        let [a, b] = memberships
            .each_ref()
            .map(|membership| membership.intervals(point));
        let a: Vec<[f64; 2]> = a.iter().map(|times| times.map(clock)).collect();
        near(&a, &b, 1e-11, &point);
    }
}

/// With each span on its own this took more than a minute.
#[test]
fn two_hundred_thousand_keyframes_at_rest_cost_next_to_nothing() {
    let body = body();
    let key = |i: u32| Keyframe {
        time: f64::from(i),
        pose: DAffine3::IDENTITY,
    };
    let keys: Vec<Keyframe> = (0..200_000).map(key).collect();
    let rest = Motion::from_keyframes(&keys).expect("legal");
    let found = checked(&body, &rest, &wall(), None);
    assert_eq!(found.verdict, Verdict::Clear);
    let found = checked(&body, &rest, &wall(), Some(&rest));
    assert_eq!(found.verdict, Verdict::Clear);
    let intervals = Membership::new(&body, &rest).intervals(DVec3::new(2.0, 0.0, 0.5));
    assert_eq!(intervals, [[0.0, 199_999.0]]);
    let swept = sweep(&body, &rest, &SweepSettings::default()).expect("swept");
    assert!(
        (swept.solid.measures().volume - 2.0).abs() < 1e-12,
        "the body itself"
    );
}

/// Keyframes in general position: nothing can be merged, and each span of the body has its own span
/// of the obstacle.
#[test]
fn thirty_thousand_keyframes_of_obstacle_and_body_are_checked_span_by_span() {
    let body = body();
    let key = |i: u32, speed: f64| {
        let turn = DQuat::from_rotation_z((0.01 * speed * f64::from(i)).sin());
        let way = DVec3::new((0.013 * speed * f64::from(i)).sin(), 0.0, 0.0);
        Keyframe {
            time: f64::from(i),
            pose: DAffine3 {
                matrix3: DMat3::from_quat(turn),
                translation: way,
            },
        }
    };
    let motion = |speed: f64| {
        let keys: Vec<Keyframe> = (0..30_000).map(|i| key(i, speed)).collect();
        Motion::from_keyframes(&keys).expect("legal")
    };
    let far = DAffine3::from_translation(DVec3::Z * 40.0);
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|corner| far.transform_point3(corner));
    let surface = Surface::new(corners.to_vec(), vec![[0, 1, 2]]).expect("a triangle");
    let found = checked(&body, &motion(1.0), &surface, Some(&motion(0.7)));
    assert_eq!(found.verdict, Verdict::Clear);
    assert!(
        found.clearance.lower > 38.9 && found.clearance.upper < 39.1,
        "{:?}",
        found.clearance
    );
}
