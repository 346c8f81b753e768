//! First contact against published scenes: rigid, fast, steady affine, and the links of a robot in
//! front of a shelf. The files lie beside the repository, if present, in `../shared/data`; without
//! them those tests say so and pass.

use crate::support::contact::data::{alike, scenes};
use crate::support::contact::panda::{Arm, JOINTS, problems};
use crate::support::contact::reference::Slow;
use crate::support::contact::scene::{Known, Scene, chain, steady};
use crate::support::data;
use crate::support::shapes;
use rayon::prelude::*;
use std::path::PathBuf;
use std::time::Instant;
use steadysweep::collision::{CheckSettings, Measure, Verdict};
use steadysweep::motion::{Keyframe, Motion};

/// Largest error of published times, on a clock from 0 to 1.
const PUBLISHED: f64 = 1e-5;

fn examine(scene: &Scene) -> String {
    let check = scene.check(&CheckSettings::default().with_measure(Measure::Verdict));
    let slow = scene.slow(0, 0.0);
    if slow == Slow::GivenUp {
        return "the slow search gave up".into();
    }
    let mut defects = scene.verdict_defects(&check.verdict, &[Some(slow)]);
    match (&check.verdict, scene.known) {
        (Verdict::Contact(found), Known::Contact { time, .. }) => {
            if (found.time - time).abs() > PUBLISHED * scene.duration() {
                defects += &format!("published: {time}, found {}", found.time);
            }
        }
        (Verdict::Clear, Known::Clear) | (_, Known::Nothing) => {}
        (verdict, known) => defects += &format!("published: {known:?}, found {verdict:?}"),
    }
    defects
}

fn examine_all(scenes: &[Scene]) {
    let clock = Instant::now();
    let defects: Vec<String> = scenes
        .par_iter()
        .map(|scene| (scene, examine(scene)))
        .filter(|(_, defects)| !defects.is_empty())
        .map(|(scene, defects)| format!("{} {}: {defects}\n", scene.family, scene.seed))
        .collect();
    println!(
        "{} scenes in {:.1} s",
        scenes.len(),
        clock.elapsed().as_secs_f64()
    );
    let some: String = defects.iter().take(5).cloned().collect();
    assert!(
        defects.is_empty(),
        "{} of {}\n{some}",
        defects.len(),
        scenes.len()
    );
}

fn examine_file(name: &str, count: usize) {
    let Some(folder) = data::folder("collision") else {
        return;
    };
    let scenes = scenes(&folder.join(name));
    assert_eq!(scenes.len(), count, "all are read");
    examine_all(&scenes);
}

#[test]
fn published_rigid_scenes_are_decided_as_published() {
    examine_file("rigid.json", 49);
}

#[test]
fn published_bullets_are_decided_as_published() {
    examine_file("bullet.json", 10);
}

#[test]
fn published_steady_affine_scenes_are_decided_as_published() {
    examine_file("steady_affine.json", 50);
}

#[test]
fn hundreds_of_scenes_of_the_same_families_agree_with_the_slow_search() {
    let scenes: Vec<Scene> = (0..300).map(alike).collect();
    examine_all(&scenes);
}

fn arm() -> Option<(Arm, PathBuf)> {
    let folder = data::folder("panda")?;
    Some((Arm::read(&folder), folder))
}

/// The joints move from the start to the goal one after the other; each link behind the moving
/// joint makes one steady motion.
#[test]
fn links_that_one_joint_turns_agree_with_the_slow_search() {
    let Some((arm, folder)) = arm() else { return };
    let mut scenes = Vec::new();
    for (number, problem) in (0..).zip(problems(&folder)) {
        let mut angles = problem.start.clone();
        for joint in 0..JOINTS {
            let turn = problem.goal[joint] - problem.start[joint];
            let motion = steady(arm.turn(joint, &angles, turn));
            for link in arm.links.iter().filter(|link| link.joints > joint) {
                let pose = arm.pose(link, &angles);
                let body = shapes::mapped(link.shape.clone(), |p| pose.transform_point3(p));
                for (name, shape) in problem
                    .boxes
                    .iter()
                    .filter(|(name, _)| name.starts_with("cube"))
                {
                    scenes.push(Scene {
                        family: format!("problem {number} joint {joint} {} {name}", link.name)
                            .leak(),
                        ..Scene::new(body.clone(), motion.clone(), shape.clone())
                    });
                }
            }
            angles[joint] = problem.goal[joint];
        }
    }
    let results: Vec<(bool, bool, String)> = scenes
        .par_iter()
        .enumerate()
        .map(|(index, scene)| {
            let measure = if index % 7 == 0 {
                Measure::Distance
            } else {
                Measure::Verdict
            };
            let check = scene.check(&CheckSettings::default().with_measure(measure));
            let contact = matches!(check.verdict, Verdict::Contact(_));
            // Distant ones are only sampled.
            let search = scene.search(0, 0.0);
            let times = (0..=20).map(|k| scene.start() + scene.duration() * f64::from(k) / 20.0);
            let seen = times
                .map(|time| search.closest_at(time).0)
                .fold(f64::INFINITY, f64::min);
            let (near, mut defects) = if seen < 0.03 || contact {
                let slow = scene.slow(0, 0.0);
                (true, scene.verdict_defects(&check.verdict, &[Some(slow)]))
            } else if check.verdict == Verdict::Clear {
                (false, String::new())
            } else {
                (false, format!("{seen} away, but {:?}", check.verdict))
            };
            if check.verdict == Verdict::Clear && check.clearance.lower > seen {
                defects += &format!("{seen} away, but {:?}", check.clearance);
            }
            (
                near,
                contact,
                format!(
                    "{defects}{}",
                    if defects.is_empty() { "" } else { scene.family }
                ),
            )
        })
        .collect();
    let count =
        |pick: fn(&(bool, bool, String)) -> bool| results.iter().filter(|r| pick(r)).count();
    println!(
        "{} motions, {} near, {} contacts",
        results.len(),
        count(|r| r.0),
        count(|r| r.1)
    );
    let defects: Vec<&String> = results
        .iter()
        .map(|r| &r.2)
        .filter(|d| !d.is_empty())
        .collect();
    assert!(
        defects.is_empty(),
        "{}: {:#?}",
        defects.len(),
        &defects[..defects.len().min(5)]
    );
    assert!(count(|r| r.1) > 10, "some touch the shelf");
}

/// Number of keys of a straight path in joint space; between them each link moves steadily.
const KEYS: u32 = 101;
/// Largest deviation of a chain through the keys from the straight path: h^2/8 of the
/// accelerations, with an allowance for slow closing speeds.
const CHAIN: f64 = 2e-3;

#[test]
fn the_straight_way_of_the_arm_touches_what_a_sampling_program_has_found() {
    let Some((arm, folder)) = arm() else { return };
    let mut wrong = Vec::new();
    let mut found_all = 0;
    for (number, problem) in problems(&folder).iter().enumerate() {
        for link in &arm.links {
            let keys: Vec<Keyframe> = (0..KEYS)
                .map(|k| {
                    let time = f64::from(k) / f64::from(KEYS - 1);
                    let angles: Vec<f64> = problem
                        .start
                        .iter()
                        .zip(&problem.goal)
                        .map(|(a, b)| a + (b - a) * time)
                        .collect();
                    Keyframe {
                        time,
                        pose: arm.pose(link, &angles),
                    }
                })
                .collect();
            let motion = Motion::from_keyframes(&keys).expect("a chain");
            for (name, shape) in &problem.boxes {
                let scene = Scene::new(link.shape.clone(), motion.clone(), shape.clone());
                let check = scene.check(&CheckSettings::default().with_measure(Measure::Verdict));
                let published = problem
                    .contacts
                    .iter()
                    .find(|contact| contact.0 == link.name && contact.1 == *name);
                let same = match (&check.verdict, published) {
                    (Verdict::Clear, None) => true,
                    (Verdict::Contact(found), Some((_, _, time))) => {
                        found_all += 1;
                        (found.time - time).abs() < CHAIN
                    }
                    _ => false,
                };
                if !same {
                    wrong.push(format!(
                        "{number} {} {name}: {published:?}, {:?}",
                        link.name, check.verdict
                    ));
                }
            }
        }
    }
    println!("{found_all} contacts as published");
    assert!(
        wrong.is_empty(),
        "{}: {:#?}",
        wrong.len(),
        &wrong[..wrong.len().min(5)]
    );
}

#[test]
fn a_link_that_all_joints_turn_in_turn_is_a_chain() {
    let Some((arm, folder)) = arm() else { return };
    let problem = &problems(&folder)[4];
    let link = arm
        .links
        .iter()
        .find(|link| link.name == "panda_hand")
        .expect("a hand");
    let mut angles = problem.start.clone();
    let start = arm.pose(link, &angles);
    let body = shapes::mapped(link.shape.clone(), |p| start.transform_point3(p));
    let generators: Vec<_> = (0..JOINTS)
        .map(|joint| {
            let turn = problem.goal[joint] - problem.start[joint];
            let generator = arm.turn(joint, &angles, turn);
            angles[joint] = problem.goal[joint];
            generator
        })
        .collect();
    let motion = chain(&generators);
    for (name, shape) in &problem.boxes {
        if !name.starts_with("cube") {
            continue;
        }
        let scene = Scene::new(body.clone(), motion.clone(), shape.clone());
        let check = scene.check(&CheckSettings::default());
        let slow = scene.slow(0, 0.0);
        let defects = scene.verdict_defects(&check.verdict, &[Some(slow)]);
        assert!(defects.is_empty(), "{name}: {defects}");
    }
}
