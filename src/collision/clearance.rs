//! How close the body comes to the obstacles that it must not touch, over the whole motion.

use super::scene::Scene;
use super::search::Search;
use super::{Clearance, Closest, Limited, Measure, Verdict, first, heights, least};
use crate::watch::Interrupted;
use glam::DVec3;

/// How close the body comes to the obstacles that it must not touch.
pub(super) fn of(scene: &Scene, verdict: &Verdict) -> Result<Clearance, Interrupted> {
    let mut clearance = Clearance {
        lower: 0.0,
        upper: f64::INFINITY,
        time: scene.stages[0].times[0],
        obstacle: 0,
        points: [DVec3::ZERO; 2],
        limited: None,
    };
    match *verdict {
        Verdict::Contact(contact) => {
            return Ok(Clearance {
                upper: 0.0,
                time: contact.time,
                obstacle: contact.obstacle,
                points: [contact.point; 2],
                ..clearance
            });
        }
        Verdict::Clear if scene.settings.measure == Measure::Verdict => {
            clearance.lower = scene.settings.clearance;
            return Ok(clearance);
        }
        Verdict::Closer(_) if scene.settings.measure == Measure::Verdict => return Ok(clearance),
        Verdict::Clear => {}
        Verdict::Closer(found) => look(scene, found.time, &mut clearance),
        Verdict::Undecided { limited, .. } => {
            clearance.limited = Some(limited);
            return Ok(clearance);
        }
    }
    // First distances that are quickly found, so that most of the rest need not be examined
    // closely.
    let [start, end] = [
        scene.stages[0].times[0],
        scene.stages[scene.stages.len() - 1].times[1],
    ];
    look(scene, start, &mut clearance);
    look(scene, end, &mut clearance);
    for stage in &scene.stages {
        scene.work.check()?;
        look(scene, stage.clock(0.5), &mut clearance);
    }
    let mut lower = clearance.upper;
    let mut is_limited = false;
    let triangles = |number: usize| scene.obstacles[number].shape.len() + scene.body.len();
    let all = scene.forbidden().map(triangles).sum::<usize>();
    let mut spare = MEASURING_WORK + MEASURING_WORK_EACH * all;
    let searches = scene.stages.len() * scene.forbidden().count();
    let part = scene.work.part(1, searches as u64);
    for (number, stage) in scene.stages.iter().enumerate() {
        for obstacle in scene.forbidden() {
            let encounter = scene.encounter(obstacle, number);
            let hint = encounter.between_centres();
            let upper = clearance.upper;
            let mut search = Search::new(&encounter, 0.0);
            let found = least::of(&mut search, upper, hint, &mut spare, part)?;
            lower = lower.min(found.lower.max(0.0));
            is_limited |= found.is_limited;
            if let Some(time) = found.seen {
                // Everything near at that time counts, not only the pair that was followed.
                look(scene, stage.clock(time), &mut clearance);
            }
        }
    }
    let mut over_planes = f64::INFINITY;
    for obstacle in scene.forbidden_half_spaces() {
        let found = heights::see_least(scene, obstacle, &mut clearance)?;
        over_planes = over_planes.min(found.lower);
        is_limited |= found.is_limited;
    }
    lower = lower.min(over_planes);
    clearance.lower = lower.min(clearance.upper);
    let roughly = ROUGHLY * clearance.upper;
    if *verdict == Verdict::Clear && clearance.lower < roughly && first::keeps(scene, roughly)? {
        // The measurement ran out of work: the surfaces are near each other all the time.
        clearance.lower = roughly.min(over_planes);
    }
    if *verdict == Verdict::Clear {
        // This is certified already, whatever the outcome of the measurement.
        clearance.lower = clearance
            .lower
            .max(scene.settings.clearance)
            .min(clearance.upper);
    }
    if !clearance.is_sharp() {
        let why = if is_limited {
            Limited::Work
        } else {
            Limited::Rounding
        };
        clearance.limited = Some(why);
    }
    Ok(clearance)
}

/// Examines the obstacles that must not be touched at a time on the clock.
fn look(scene: &Scene, time: f64, clearance: &mut Clearance) {
    let before = scene.stages.partition_point(|stage| stage.times[1] < time);
    let stage = before.min(scene.stages.len() - 1);
    let local = scene.stages[stage].local(time);
    for obstacle in scene.forbidden() {
        let encounter = scene.encounter(obstacle, stage);
        if let Some(closest) = encounter.still(local).closest(clearance.upper) {
            let seen = Closest {
                distance: closest.nearest.distance(),
                obstacle,
                points: encounter.in_world(closest.nearest.points, local),
            };
            clearance.see(time, &seen);
        }
    }
}

/// Fraction of the smallest distance seen that is certified with less work, where the measurement
/// itself gets no farther.
const ROUGHLY: f64 = 0.5;

/// Pairs of boxes that the measurement of the least distance may examine: this many, some 50 ms of
/// work, and more for each triangle. Beyond, its lower bound is left as it is, proven but not
/// tight.
const MEASURING_WORK: usize = 200_000;
const MEASURING_WORK_EACH: usize = 16;
