//! The least distance of hinges, shafts, slides and gears, against closed forms.

mod support;

use rayon::prelude::*;
use std::fmt::Write;
use steadysweep::collision::{CheckSettings, Verdict};
use support::contact::gaps::{GAPS, Gap, gap, gears};

/// Scenes of each family.
const SCENES: u64 = 30;

/// What is wrong with the least distance that is found for a scene.
fn defects(Gap { scene, least }: &Gap) -> String {
    let check = scene.check(&CheckSettings::default());
    let clearance = check.clearance;
    let mut defects = String::new();
    // What is seen in frames of other units is off by some rounding.
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
    let at = scene
        .search(clearance.obstacle, 0.0)
        .closest_at(clearance.time)
        .0;
    if (at - clearance.upper).abs() > 1e-9 * clearance.upper {
        defects += &format!("{at} at that time; ");
    }
    if defects.is_empty() {
        return defects;
    }
    format!("{defects}least {least}, {clearance:?}")
}

fn all(family: fn(&mut support::contact::random::Random) -> Gap, name: &str) -> String {
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
