//! The least distance of hinges, shafts, slides and gears, against closed forms.

use crate::support::contact::gaps::{Family, GAPS, Gap, gap, gears, tube};
use crate::support::contact::scene::{Scene, steady};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use steadysweep::collision::{CheckSettings, Closest, Verdict};
use steadysweep::motion::Generator;

/// Number of scenes of each family.
const SCENES: u64 = 30;

/// The defects of the least distance that is found for a scene.
fn defects(Gap { scene, least }: &Gap) -> String {
    let check = scene.check(&CheckSettings::default());
    let clearance = check.clearance;
    let mut defects = String::new();
    // Distances in frames with other units are off by some rounding.
    let rounding = 1e-9 * least;
    if check.verdict != Verdict::Clear {
        defects += "not clear; ";
    }
    if !(clearance.upper >= least - rounding && clearance.upper <= least * 1.001) {
        defects += "seen is not the least; ";
    }
    if !(clearance.lower <= least + rounding && clearance.lower >= 0.998 * least) {
        defects += "proven is not near the least; ";
    }
    if !(clearance.lower <= clearance.upper && clearance.lower >= 0.9989 * clearance.upper) {
        defects += "the bounds are not near each other; ";
    }
    if clearance.limited.is_some() {
        defects += "limited; ";
    }
    // Every pair of triangles is slow.
    if scene.body.1.len() <= 1_000 {
        let at = scene
            .search(clearance.obstacle, 0.0)
            .closest_at(clearance.time)
            .0;
        if (at - clearance.upper).abs() > 1e-9 * clearance.upper {
            defects += &format!("{at} at that time; ");
        }
    }
    if defects.is_empty() {
        return defects;
    }
    format!("{defects}least {least}, {clearance:?}")
}

fn all(family: Family, name: &str) -> String {
    let complaints: Vec<String> = (0..SCENES)
        .into_par_iter()
        .map(|seed| (seed, defects(&gap(family, seed))))
        .filter(|(_, complaint)| !complaint.is_empty())
        .map(|(seed, complaint)| format!("{name} {seed}: {complaint}\n"))
        .collect();
    complaints.concat()
}

#[test]
fn bounds_of_closed_forms_are_within_a_thousandth() {
    let mut text = String::new();
    for (name, family) in GAPS {
        write!(text, "{}", all(family, name)).expect("text");
    }
    assert!(text.is_empty(), "\n{text}");
}

#[test]
fn wheels_side_by_side_are_as_near_as_dense_samples_say() {
    let text = all(gears, "gears");
    assert!(text.is_empty(), "\n{text}");
}

/// Regular prisms with the same number of sides, one turning once round inside the other.
fn bore(sides: u32, radius: f64) -> Gap {
    let bore = tube([4.0, 10.0], [-2.0, 2.0], sides, 0.0);
    let shaft = tube([0.5, radius], [-3.0, 3.0], sides, 0.0);
    let turn = Generator::screw(DVec3::Z, DVec3::ZERO, TAU, 0.0, 1.0);
    Gap {
        scene: Scene::new(bore, steady(turn), shaft),
        least: 4.0 * (PI / f64::from(sides)).cos() - radius,
    }
}

#[test]
fn a_corner_of_a_shaft_faces_the_middle_of_a_side_of_its_bore_however_many_there_are() {
    for (sides, radius) in [(8, 3.6), (40, 3.8), (160, 3.8), (640, 3.8)] {
        let complaint = defects(&bore(sides, radius));
        assert!(complaint.is_empty(), "{sides} sides: {complaint}");
    }
}

#[test]
fn what_is_seen_never_contradicts_the_verdict() {
    let Gap { scene, least } = bore(40, 3.8);
    for (clearance, is_kept) in [(0.1876, true), (0.1877, false), (0.19, false), (0.5, false)] {
        let settings = CheckSettings::default().with_clearance(clearance);
        let check = scene.check(&settings);
        let found = check.clearance;
        assert_eq!(check.verdict == Verdict::Clear, is_kept, "{clearance}");
        assert!(
            found.lower <= least && found.upper >= least * (1.0 - 1e-9),
            "{clearance}: {found:?}"
        );
        assert!(found.upper <= least * 1.001, "{clearance}: {found:?}");
        assert!(
            is_kept == (found.lower >= clearance),
            "{clearance}: {found:?}"
        );
        assert!(
            is_kept || found.upper <= clearance * (1.0 + 1e-9),
            "{clearance}: {found:?}"
        );
    }
}

#[test]
fn a_distance_that_is_seen_elsewhere_counts_if_it_is_less() {
    let mut clearance = bore(8, 3.6)
        .scene
        .check(&CheckSettings::default())
        .clearance;
    let before = clearance;
    let mut seen = Closest {
        distance: 2.0 * before.upper,
        obstacle: 0,
        points: [DVec3::ZERO, DVec3::X],
    };
    clearance.see(0.25, &seen);
    assert_eq!(clearance, before, "more than the least");
    seen.distance = 0.5 * before.upper;
    clearance.see(0.25, &seen);
    assert_eq!(
        (
            clearance.upper,
            clearance.lower,
            clearance.time,
            clearance.points
        ),
        (seen.distance, seen.distance, 0.25, seen.points)
    );
}
