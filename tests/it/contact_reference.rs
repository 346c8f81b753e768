//! The slow search for first contact, where the answer is known without it.

use crate::support::contact::distance::{crosses, distance, nearest};
use crate::support::contact::families::{FAMILIES, scene};
use crate::support::contact::reference::Slow;
use crate::support::contact::scene::{self as scenes, Known, Scene, chain, is_closed, steady};
use crate::support::random::Random;
use crate::support::shapes;
use glam::{DAffine3, DVec3};
use rayon::prelude::*;
use steadysweep::motion::Generator;

#[test]
fn the_slow_search_finds_what_is_known() {
    let cases: Vec<_> = FAMILIES
        .iter()
        .flat_map(|&family| (0..30).map(move |seed| (family, seed)))
        .collect();
    let wrong: Vec<String> = cases
        .into_par_iter()
        .filter_map(|(family, seed)| {
            let scene = scene(family, seed);
            // Where a second obstacle is far away, the last one counts.
            let slow = scene.slow(scene.obstacles.len() - 1, 0.0);
            let fits = match (slow, scene.known) {
                (Slow::GivenUp, _) => false,
                (_, Known::Nothing) | (Slow::Clear, Known::Clear) => true,
                (Slow::Contact { clear_until, by }, Known::Contact { time, early }) => {
                    let earliest = time - early - 1e-12;
                    (earliest..=time + 1e-11).contains(&clear_until)
                        && (earliest..=time + 1e-5).contains(&by)
                }
                _ => false,
            };
            (!fits).then(|| format!("{} {seed}: {slow:?}, {:?}", family.0, scene.known))
        })
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn most_families_meet_and_miss() {
    for family in FAMILIES {
        let found: Vec<Slow> = (0..24_u64)
            .into_par_iter()
            .map(|seed| scene(family, seed).slow(0, 0.0))
            .collect();
        let clear = found.iter().filter(|&&slow| slow == Slow::Clear).count();
        let doubt = found
            .iter()
            .filter(|slow| matches!(slow, Slow::Doubt { .. }))
            .count();
        assert!(doubt <= 2, "{}: {doubt} of 24 in doubt", family.0);
        assert!(clear < 24, "{}: something must meet", family.0);
        let always = ["touching at the start", "contact at a joint"].contains(&family.0);
        assert!(clear > 0 || always, "{}: something must miss", family.0);
    }
}

/// A ball that falls at a constant speed: contact when its height reaches 0.
#[test]
fn a_falling_point_meets_the_ground_when_the_formula_says() {
    let drop = scenes::moved(scenes::octahedron(), DVec3::Z * 1.3);
    let fall = steady(Generator::translation(DVec3::Z * -1.0));
    let scene = Scene::new(drop, fall, scenes::sheet(4.0, 4.0));
    match scene.slow(0, 0.0) {
        Slow::Contact { clear_until, by } => {
            // The motion takes 2.
            assert!((clear_until - 0.6).abs() < 1e-11, "{clear_until}");
            assert!((by - 0.6).abs() < 1e-11 && by >= clear_until, "{by}");
        }
        slow => panic!("{slow:?}"),
    }
    // Half a unit above the ground after 0.1 ... : 1.3 - 1 - 0.1 = 0.2 is left, and the distance
    // 0.1 is reached at 0.4.
    match scene.slow(0, 0.1) {
        Slow::Contact { clear_until, by } => {
            assert!((clear_until - 0.4).abs() < 1e-11, "{clear_until}");
            assert!((by - 0.4).abs() < 1e-11, "{by}");
        }
        slow => panic!("{slow:?}"),
    }
}

#[test]
fn an_obstacle_that_moves_away_in_time_is_not_met() {
    let body = scenes::moved(scenes::octahedron(), DVec3::X * -3.0);
    let way = Generator::translation(DVec3::X * 4.0);
    let mut scene = Scene::new(body, steady(way), scenes::octahedron());
    assert!(
        matches!(scene.slow(0, 0.0), Slow::Contact { .. }),
        "it is in the way"
    );
    // At the same speed, in a chain whose joint lies elsewhere; then it rests and is hit.
    scene.obstacles[0].motion = Some(chain(&[way, way]));
    assert_eq!(
        scene.slow(0, 0.0),
        Slow::Clear,
        "the same distance all the time"
    );
    scene.obstacles[0].motion = Some(chain(&[way.scaled(0.25)]));
    match scene.slow(0, 0.0) {
        // Speeds 2 and 1/2, a gap of 1 between the corners.
        Slow::Contact { clear_until, .. } => assert!((clear_until - 1.0 / 1.5).abs() < 1e-10),
        slow => panic!("{slow:?}"),
    }
}

/// Compares the distance of two triangles with that of fine grids of points on both.
#[test]
fn the_distance_of_triangles_is_that_of_their_points() {
    let mut random = Random::new(11);
    let grid = 24;
    for case in 0..300 {
        let mut triangle = || [0; 3].map(|_| random.point(1.0));
        let (mut a, b) = (triangle(), triangle());
        match case % 4 {
            1 => a[2] = a[1],
            2 => a = [a[0]; 3],
            _ => {}
        }
        let points = |[p, q, r]: [DVec3; 3]| -> Vec<DVec3> {
            let share = |k: i32| f64::from(k) / f64::from(grid);
            let pairs = (0..=grid).flat_map(|i| (0..=grid - i).map(move |j| (i, j)));
            pairs
                .map(|(i, j)| p + (q - p) * share(i) + (r - p) * share(j))
                .collect()
        };
        let size = 3.5;
        let mut least = f64::INFINITY;
        for p in points(a) {
            for q in points(b) {
                least = least.min(p.distance(q));
            }
        }
        let found = distance(&a, &b);
        assert!(found <= least + 1e-12, "case {case}: {found} above {least}");
        let coarse = 2.0 * size / f64::from(grid);
        assert!(least - found < coarse, "case {case}: {found}, {least}");
        let [p, q] = nearest(&a, &b);
        assert!((p.distance(q) - found).abs() < 1e-15, "case {case}");
        if crosses(&a, &b, 1e-12) {
            assert!(found == 0.0, "case {case}: they cross");
        }
    }
}

#[test]
fn closed_surfaces_are_told_from_open_ones() {
    assert!(is_closed(&scenes::comb(3)), "an extruded comb");
    assert!(
        is_closed(&shapes::hollow_box(DVec3::ONE, DVec3::ONE / 2.0)),
        "a cavity"
    );
    assert!(!is_closed(&scenes::sheet(1.0, 1.0)), "a sheet");
}

#[test]
fn a_scene_in_another_frame_is_the_same_scene() {
    let frame = DAffine3::from_scale_rotation_translation(
        DVec3::splat(1e3),
        glam::DQuat::from_rotation_x(1.0),
        DVec3::new(500.0, -200.0, 100.0),
    );
    for seed in 0..20 {
        let one = scene(FAMILIES[0], seed);
        let [a, b] = [one.slow(0, 0.0), one.in_frame(&frame).slow(0, 0.0)];
        match (a, b) {
            (Slow::Clear, Slow::Clear) => {}
            (Slow::Contact { by: a, .. }, Slow::Contact { by: b, .. }) => {
                assert!((a - b).abs() < 1e-8, "{seed}: {a} {b}");
            }
            _ => panic!("{seed}: {a:?} {b:?}"),
        }
    }
}
