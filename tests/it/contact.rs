//! First contact of bodies with surfaces: against a slow search over all pairs, and by laws that
//! every answer obeys.

use crate::support::contact::agreement::BRACKET;
use crate::support::contact::families::{FAMILIES, scene};
use crate::support::contact::reference::Slow;
use crate::support::contact::scene::{self as scenes, Known, Obstacle, Scene, is_closed};
use crate::support::random::Random;
use crate::support::shapes;
use glam::{DAffine3, DVec3};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fmt::Write;
use steadysweep::collision::{Check, CheckSettings, ContactRule, RelativeMotion, Touch, Verdict};
use steadysweep::motion::Generator;

/// Scenes of each family, 2,000 in all.
const SCENES: u64 = 80;

/// Runs `examine` on scenes of every family in parallel, and fails with its complaints.
fn all_scenes(seeds: std::ops::Range<u64>, examine: impl Fn(&Scene) -> String + Sync) {
    let cases: Vec<_> = FAMILIES
        .iter()
        .flat_map(|&family| seeds.clone().map(move |seed| (family, seed)))
        .collect();
    let complaints: Vec<(&str, u64, String)> = cases
        .into_par_iter()
        .map(|(family, seed)| (family.0, seed, examine(&scene(family, seed))))
        .filter(|(_, _, complaint)| !complaint.is_empty())
        .collect();
    let mut counts = BTreeMap::<&str, usize>::new();
    let mut text = String::new();
    for (family, seed, complaint) in &complaints {
        let count = counts.entry(*family).or_default();
        *count += 1;
        if *count <= 3 {
            writeln!(text, "{family} {seed}: {complaint}").expect("text");
        }
    }
    assert!(complaints.is_empty(), "{counts:?}\n{text}");
}

fn slow(scene: &Scene, offset: f64) -> Vec<Option<Slow>> {
    (0..scene.obstacles.len())
        .map(|k| Some(scene.slow(k, offset)))
        .collect()
}

#[test]
fn two_thousand_scenes_agree_with_the_slow_search() {
    all_scenes(0..SCENES, |scene| {
        let check = scene.check(&CheckSettings::default());
        let slow = slow(scene, 0.0);
        if slow.contains(&Some(Slow::GivenUp)) {
            return "the slow search gave up".into();
        }
        let mut defects = scene.verdict_defects(&check.verdict, &slow);
        match (&check.verdict, scene.known) {
            (Verdict::Clear, Known::Contact { .. }) | (Verdict::Contact(_), Known::Clear) => {
                defects += "known otherwise; ";
            }
            (Verdict::Contact(found), Known::Contact { time, early }) => {
                let slack = BRACKET * scene.duration();
                if found.time < time - early - slack || found.time > time + slack {
                    defects += &format!("known to be at {time}: {found:?}");
                }
            }
            _ => {}
        }
        if let Verdict::Contact(found) = &check.verdict {
            if found.touch != Touch::Inside {
                defects += &scene.witness_defects(found, 0.0);
            } else if found.time != scene.start() {
                defects += "inside, but not at the start; ";
            }
        }
        defects
    });
}

#[test]
fn the_distance_of_clear_scenes_lies_between_its_bounds() {
    all_scenes(0..24, |scene| {
        let check = scene.check(&CheckSettings::default());
        match check.verdict {
            Verdict::Clear => {
                let all: Vec<usize> = (0..scene.obstacles.len()).collect();
                scene.clearance_defects(&check.clearance, &all)
            }
            _ if check.clearance.lower != 0.0 => format!("contact, but {:?}", check.clearance),
            _ => String::new(),
        }
    });
}

#[test]
fn the_first_time_below_a_clearance_agrees_with_the_slow_search() {
    all_scenes(100..124, |scene| {
        let size = scene.body.0.iter().map(|p| p.distance(scene.body.0[0]));
        let clearance =
            size.fold(0.0, f64::max) * Random::new(scene.seed).one_of(&[0.01, 0.1, 0.3]);
        let check = scene.check(&CheckSettings::default().with_clearance(clearance));
        let mut defects = scene.verdict_defects(&check.verdict, &slow(scene, clearance));
        match &check.verdict {
            Verdict::Closer(found) => defects += &scene.closer_defects(found, clearance),
            // The distance was larger before, unless the contact is there from the start.
            Verdict::Contact(found) if found.time > scene.start() => {
                defects += &format!("contact before closeness: {found:?}");
            }
            Verdict::Clear => {
                let all: Vec<usize> = (0..scene.obstacles.len()).collect();
                if check.clearance.lower < clearance {
                    defects += "clear, but the bound is below the clearance; ";
                }
                defects += &scene.clearance_defects(&check.clearance, &all);
            }
            _ => {}
        }
        defects
    });
}

#[test]
fn all_times_of_contact_are_listed() {
    all_scenes(200..216, |scene| {
        let check = scene.check(&CheckSettings::default().with_all_intervals());
        scene.interval_defects(&check)
    });
}

/// The difference between the verdicts of two checks of the same scene, which should be of the same
/// kind, with the same obstacle and times that differ by rounding.
fn difference(one: &Verdict, other: &Verdict, slack: f64) -> String {
    let same = match (one, other) {
        (Verdict::Clear, Verdict::Clear) => true,
        (Verdict::Contact(a), Verdict::Contact(b)) => (a.time - b.time).abs() <= slack,
        _ => false,
    };
    if same {
        String::new()
    } else {
        format!("{one:?}, but {other:?}")
    }
}

/// A bound on the error of both times: rounding moves contacts at small closing speeds. It comes
/// from the slow search, which allows for it.
fn slack_of(scene: &Scene) -> Option<f64> {
    let slow = slow(scene, 0.0);
    let mut slack = 2.0 * BRACKET * scene.duration();
    for slow in slow.into_iter().flatten() {
        match slow {
            Slow::Contact { clear_until, by } => slack = slack.max(by - clear_until),
            Slow::Clear => {}
            Slow::Doubt { .. } | Slow::GivenUp => return None,
        }
    }
    Some(slack)
}

#[test]
fn a_moves_and_b_rests_is_b_moves_back_and_a_rests() {
    all_scenes(300..316, |scene| {
        let obstacle = &scene.obstacles[0];
        let single = scene.motion.spans().len() == 1 && scene.obstacles.len() == 1;
        let slack = slack_of(scene);
        let (Some(slack), true) = (slack, single && is_closed(&obstacle.shape)) else {
            return String::new();
        };
        if obstacle.motion.is_some() || obstacle.shape.1.len() < 4 {
            return String::new();
        }
        let back = scene.motion.spans()[0].flow().generator().scaled(-1.0);
        let swapped = Scene {
            body: obstacle.shape.clone(),
            motion: scenes::steady(back),
            obstacles: vec![Obstacle {
                shape: scene.body.clone(),
                motion: None,
            }],
            ..scene.clone()
        };
        let settings = CheckSettings::default();
        let [one, other] = [scene, &swapped].map(|scene| scene.check(&settings).verdict);
        difference(&one, &other, slack)
    });
}

#[test]
fn frames_and_units_change_nothing() {
    all_scenes(400..416, |scene| {
        let Some(slack) = slack_of(scene) else {
            return String::new();
        };
        // A scene that depends on equal coordinates is another scene after rounding.
        if scene.known != Known::Nothing {
            return String::new();
        }
        let mut random = Random::new(scene.seed);
        let mut defects = String::new();
        for unit in [1e-3, 1.0, 1e6] {
            let frame = DAffine3::from_scale_rotation_translation(
                DVec3::splat(unit),
                random.rotation(),
                random.point(3.0 * unit),
            );
            let seen = scene.in_frame(&frame);
            let Some(other) = slack_of(&seen) else {
                continue;
            };
            let settings = CheckSettings::default();
            let [one, two] = [scene, &seen].map(|scene| scene.check(&settings));
            defects += &difference(&one.verdict, &two.verdict, slack.max(other));
        }
        defects
    });
}

/// With a power of two as unit nothing is rounded: the answer is exactly the same.
#[test]
fn a_unit_of_a_power_of_two_changes_no_bit_of_the_time() {
    all_scenes(420..428, |scene| {
        let frame = DAffine3::from_scale(DVec3::splat(1024.0));
        let settings = CheckSettings::default();
        let [one, two] =
            [scene, &scene.in_frame(&frame)].map(|scene| scene.check(&settings).verdict);
        difference(&one, &two, 0.0)
    });
}

fn without_seconds(check: &Check) -> String {
    let Check {
        verdict,
        intervals,
        clearance,
        relative,
        ..
    } = check;
    format!("{verdict:?} {intervals:?} {clearance:?} {relative:?}")
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let pools = [1, 2, 5].map(|threads| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool")
    });
    let settings = CheckSettings::default().with_all_intervals();
    let mut scenes: Vec<Scene> = FAMILIES
        .iter()
        .flat_map(|&family| (500..504).map(move |seed| scene(family, seed)))
        .collect();
    scenes.extend((0..3).map(larger));
    scenes.push(ball_in_a_shell());
    for scene in scenes {
        let [one, two, five] =
            [0, 1, 2].map(|k| pools[k].install(|| without_seconds(&scene.check(&settings))));
        assert_eq!(one, two, "{} {}: two threads", scene.family, scene.seed);
        assert_eq!(one, five, "{} {}: five threads", scene.family, scene.seed);
    }
}

/// A ball that turns in an open shell slightly larger than itself: so many pairs of boxes are near
/// each other all the time that threads share the search.
fn ball_in_a_shell() -> Scene {
    let mut shell = shapes::icosphere(4, 0.52, DVec3::ZERO);
    shell.1.truncate(shell.1.len() - 1);
    let axis = DVec3::new(1.0, 2.0, 3.0).normalize();
    let motion = scenes::steady(Generator::screw(axis, DVec3::ZERO, 6.0, 0.0, 1.0));
    Scene::new(shapes::icosphere(4, 0.5, DVec3::ZERO), motion, shell)
}

#[test]
fn a_ball_turns_in_its_shell_without_touching_it() {
    let check = ball_in_a_shell().check(&CheckSettings::default());
    assert_eq!(check.verdict, Verdict::Clear);
    // The corners are at 0.5, the faces at 0.52 minus their sagitta, which is at most some 1.3e-3:
    // the edges of the coarse icosahedron are 1.05 radii long, and these a sixteenth of that. At
    // least half of the distance is certified, however much is nearby.
    let (lower, upper) = (check.clearance.lower, check.clearance.upper);
    assert!(
        lower > 0.5 * 0.0185 && lower <= upper && upper > 0.0185 && upper < 0.02,
        "{check:?}"
    );
}

/// Thousands of triangles, and several obstacles, some of them met at the same time.
fn larger(seed: u64) -> Scene {
    let mut random = Random::new(seed);
    let ball = shapes::icosphere(3, 0.5, DVec3::ZERO);
    let generator = Generator::screw(DVec3::Z, DVec3::X * 2.0, 4.0, 1.0, 1.0);
    let motion = scenes::steady(generator);
    let middle = motion.pose_at_time(1.0).transform_point3(DVec3::ZERO);
    let obstacles = (0..3).map(|k| {
        // The last two are the same.
        let off = DVec3::new(0.4, 0.1, 0.8) * f64::from((k + 1) / 2);
        Obstacle {
            shape: scenes::moved(shapes::torus(0.6, 0.2, 40, 20), middle + off),
            motion: None,
        }
    });
    Scene {
        family: "larger",
        seed,
        obstacles: obstacles.collect(),
        ..Scene::new(
            scenes::turned(&mut random, ball),
            motion,
            shapes::cone(1.0, 1.0, 3),
        )
    }
}

#[test]
fn obstacles_that_are_allowed_do_not_count() {
    let body = scenes::brick(DVec3::ONE);
    // It stands on the first, meets the second halfway, and the third at three quarters.
    let stand = scenes::moved(scenes::sheet(8.0, 8.0), DVec3::Z * -0.5);
    let wall = |x: f64| scenes::moved(scenes::brick(DVec3::ONE), DVec3::X * x);
    let motion = scenes::steady(Generator::translation(DVec3::X * 4.0));
    let mut scene = Scene::new(body, motion, stand);
    for x in [3.0, 4.0] {
        let shape = wall(x);
        scene.obstacles.push(Obstacle {
            shape,
            motion: None,
        });
    }
    // The expected time for each list of allowed obstacles; the motion takes 2.
    let (no, yes) = (ContactRule::Touch, ContactRule::Allowed);
    for (allowed, expected) in [
        (vec![], Some((0.0, 0))),
        (vec![no; 3], Some((0.0, 0))),
        (vec![yes, no, no], Some((1.0, 1))),
        (vec![yes, yes, no], Some((1.5, 2))),
        (vec![yes, yes, yes], None),
    ] {
        let check = scene.check(&CheckSettings::default().with_rules(allowed.clone()));
        match (check.verdict, expected) {
            (Verdict::Clear, None) => {}
            (Verdict::Contact(found), Some((time, obstacle))) => {
                assert_eq!(found.obstacle, obstacle, "{allowed:?}");
                assert!((found.time - time).abs() < 1e-9, "{allowed:?}: {found:?}");
            }
            (verdict, _) => panic!("{allowed:?}: {verdict:?}"),
        }
    }
}

#[test]
fn two_moving_bodies_say_how_their_motion_was_treated() {
    for seed in 0..20 {
        let relative = |name: &str| {
            let family = FAMILIES
                .into_iter()
                .find(|family| family.0 == name)
                .expect("a family");
            scene(family, 600 + seed)
                .check(&CheckSettings::default())
                .relative
        };
        assert_eq!(relative("slow screw"), [RelativeMotion::AtRest], "{seed}");
        assert_eq!(relative("two moving"), [RelativeMotion::Bounded], "{seed}");
        assert_eq!(
            relative("two moving on one axis"),
            [RelativeMotion::Steady],
            "{seed}"
        );
    }
}

#[test]
fn a_body_that_moves_with_its_obstacle_is_at_rest_to_it() {
    let turn = Generator::screw(DVec3::Z, DVec3::new(1.0, 2.0, 0.0), 15.0, 1.0, 0.5);
    for (gap, clear) in [(1e-6, true), (0.0, false)] {
        let body = scenes::moved(scenes::brick(DVec3::ONE), DVec3::X * (1.0 + gap));
        let mut scene = Scene::new(body, scenes::steady(turn), scenes::brick(DVec3::ONE));
        scene.obstacles[0].motion = Some(scenes::steady(turn));
        let verdict = scene.check(&CheckSettings::default()).verdict;
        match verdict {
            Verdict::Clear => assert!(clear, "they touch"),
            Verdict::Contact(found) => assert!(!clear && found.time == 0.0, "{found:?}"),
            _ => panic!("{verdict:?}"),
        }
    }
}

/// Both turn twenty times about one axis, with half a radian against each other: one hand of a
/// clock catches up with another.
#[test]
fn a_hand_catches_up_with_another_that_turns_as_fast() {
    let turn = |angle: f64| Generator::screw(DVec3::Z, DVec3::ZERO, angle, 3.0, 1.0);
    let (fast, slow, ahead) = (120.5, 120.0, 0.3_f64);
    let body = scenes::moved(scenes::brick(DVec3::new(0.5, 0.1, 0.2)), DVec3::X * 2.0);
    // A wall in the half plane at the angle 0.3.
    let wall = |p: DVec3| DVec3::new((p.x + 2.0) * ahead.cos(), (p.x + 2.0) * ahead.sin(), p.y);
    let obstacle = shapes::mapped(scenes::sheet(2.0, 2.0), wall);
    let leading = (body.0.iter()).max_by(|p, q| (p.y / p.x).total_cmp(&(q.y / q.x)));
    let leading = *leading.expect("corners");
    // The share of the whole motion, which lasts two units of time.
    let share = (ahead - leading.y.atan2(leading.x)) / (fast - slow);
    let mut scene = Scene::new(body, scenes::steady(turn(fast)), obstacle);
    scene.obstacles[0].motion = Some(scenes::steady(turn(slow)));
    let check = scene.check(&CheckSettings::default());
    assert_eq!(check.relative, [RelativeMotion::Steady]);
    let Verdict::Contact(found) = check.verdict else {
        panic!("{:?}", check.verdict)
    };
    let expected = share * scene.duration();
    assert!(
        (found.time - expected).abs() < 1e-11,
        "{} expected: {found:?}",
        expected
    );
    let width = found.bracket[1] - found.bracket[0];
    assert!(width < 1e-9 * scene.duration(), "{found:?}");
    // In the world, where both have turned by then: the whole side meets the wall at once.
    let pose = scene.motion.pose_at_time(found.time);
    let [r, z] = [leading.truncate().length(), found.point.z - 3.0 * share];
    let place = pose.transform_point3(DVec3::new(leading.x, leading.y, z));
    assert!(
        found.point.distance(place) < 1e-9 * r,
        "{place} expected: {found:?}"
    );
    let forwards = pose
        .transform_vector3(DVec3::Z.cross(leading.with_z(0.0)))
        .normalize();
    assert!(
        found.normal.distance(-forwards) < 1e-9,
        "{forwards} expected: {found:?}"
    );

    // Half the angle: the least distance is at the end, and is that of the leading corner from the
    // wall.
    scene.motion = scenes::steady(turn(slow + 0.5 * share * (fast - slow)));
    let check = scene.check(&CheckSettings::default());
    let left = ahead - leading.y.atan2(leading.x) - 0.5 * share * (fast - slow);
    let distance = r * left.sin();
    assert!(check.verdict == Verdict::Clear, "{:?}", check.verdict);
    let [on_body, on_wall] = check.clearance.points;
    assert!(
        (check.clearance.upper - distance).abs() < 1e-9,
        "{distance} expected: {check:?}"
    );
    assert!(
        (on_body.distance(on_wall) - distance).abs() < 1e-9,
        "{check:?}"
    );
    let place = scene.motion.pose_at_time(check.clearance.time);
    let place = place.transform_point3(DVec3::new(
        leading.x,
        leading.y,
        on_body.z - 3.0 * check.clearance.time / scene.duration(),
    ));
    assert!(
        on_body.distance(place) < 1e-9,
        "{place} expected: {check:?}"
    );
}

/// Checks the kind of contact, where there is no doubt.
#[test]
fn contacts_are_told_apart_by_what_happens() {
    let brick = |at: DVec3| scenes::moved(scenes::brick(DVec3::ONE), at);
    let still = scenes::sheet(4.0, 4.0);
    let fall = |speed: f64| Generator::translation(DVec3::Z * -speed);
    let parabola = Generator {
        linear: glam::DMat3::from_cols(DVec3::Z * 2.0, DVec3::ZERO, DVec3::ZERO),
        offset: DVec3::X,
    };
    let drop = shapes::mapped(scenes::octahedron(), |p| {
        p * DVec3::new(0.125, 0.125, 0.5) + DVec3::new(-0.5, 0.0, 0.75)
    });
    let octahedron = |at: DVec3| scenes::moved(scenes::octahedron(), at);
    let falling = |body, obstacle| Scene::new(body, scenes::steady(fall(1.0)), obstacle);
    let along = |way: DVec3| {
        let motion = scenes::steady(Generator::translation(way));
        Scene::new(brick(DVec3::Z * 0.5), motion, still.clone())
    };
    let small = shapes::mapped(brick(DVec3::ZERO), |p| p * 0.1);
    for (scene, touch) in [
        (
            falling(octahedron(DVec3::Z * 1.5), still.clone()),
            Touch::Enter,
        ),
        (falling(brick(DVec3::Z), still.clone()), Touch::Enter),
        (
            Scene::new(drop, scenes::steady(parabola), still.clone()),
            Touch::Touch,
        ),
        (along(DVec3::X), Touch::Slide),
        (along(DVec3::Z), Touch::Touch),
        (falling(brick(DVec3::ZERO), still.clone()), Touch::Inside),
        (falling(small, brick(DVec3::ZERO)), Touch::Inside),
    ] {
        match scene.check(&CheckSettings::default()).verdict {
            Verdict::Contact(found) => assert_eq!(found.touch, touch, "{found:?}"),
            verdict => panic!("{touch:?} expected: {verdict:?}"),
        }
    }
}
