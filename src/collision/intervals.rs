//! All times of contact with each obstacle, stage by stage.

use super::dwelling::{self, Dwelling};
use super::plane::Plane;
use super::presence;
use super::scene::Scene;
use super::{ContactInterval, Doubt, Limited, heights};
use crate::watch::Interrupted;
use rayon::prelude::*;
use std::cell::OnceCell;

/// All times of contact (below the clearance, or entered) with each obstacle, left out or not; and
/// the doubts about whether obstacles are entered.
pub(super) fn of(scene: &Scene) -> Result<(Vec<ContactInterval>, Vec<Doubt>), Interrupted> {
    let items = scene.work.items(scene.obstacles.len() * scene.stages.len());
    let of = |obstacle: usize| {
        let thin = OnceCell::new();
        let mut all: Vec<[f64; 2]> = Vec::new();
        let mut doubts: Vec<Doubt> = Vec::new();
        if let Some(plane) = scene.plane(obstacle) {
            return of_half_space(scene, obstacle, plane);
        }
        for (index, stage) in scene.stages.iter().enumerate() {
            let encounter = scene.encounter(obstacle, index);
            let Dwelling {
                times,
                doubts: unclear,
            } = match scene.depth(obstacle) {
                Some(depth) => dwelling::of(&encounter, depth, &thin),
                None => Dwelling {
                    times: presence::times(&encounter, scene.settings.clearance),
                    doubts: Vec::new(),
                },
            };
            items.next()?;
            doubts.extend(unclear.into_iter().map(|(times, limited)| Doubt {
                obstacle,
                times: times.map(|time| stage.clock(time)),
                limited,
            }));
            for interval in times.intervals() {
                let [start, end] = interval.map(|time| stage.clock(time));
                match all.last_mut() {
                    Some(last) if start <= last[1] + stage.gap => last[1] = last[1].max(end),
                    _ => all.push([start, end]),
                }
            }
        }
        Ok((listed(obstacle, all), doubts))
    };
    let each: Vec<_> = (0..scene.obstacles.len())
        .into_par_iter()
        .map(of)
        .collect::<Result<_, Interrupted>>()?;
    let (intervals, doubts): (Vec<_>, Vec<_>) = each.into_iter().unzip();
    Ok((intervals.concat(), doubts.concat()))
}

fn listed(obstacle: usize, all: Vec<[f64; 2]>) -> Vec<ContactInterval> {
    let interval = |times| ContactInterval { obstacle, times };
    all.into_iter().map(interval).collect()
}

/// The times of contact with a half-space; all of the motion, in doubt, where it is too long.
fn of_half_space(
    scene: &Scene,
    obstacle: usize,
    plane: &Plane,
) -> Result<(Vec<ContactInterval>, Vec<Doubt>), Interrupted> {
    if let Some(all) = heights::intervals(scene, obstacle, plane)? {
        return Ok((listed(obstacle, all), Vec::new()));
    }
    let stages = &scene.stages;
    let times = [stages[0].times[0], stages[stages.len() - 1].times[1]];
    let doubt = Doubt {
        obstacle,
        times,
        limited: Limited::Work,
    };
    Ok((listed(obstacle, vec![times]), vec![doubt]))
}
