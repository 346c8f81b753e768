//! All times of contact with each obstacle, stage by stage.

use super::dwelling::{self, Dwelling};
use super::presence;
use super::scene::Scene;
use super::{ContactInterval, Doubt};
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
        let interval = |times| ContactInterval { obstacle, times };
        Ok((all.into_iter().map(interval).collect::<Vec<_>>(), doubts))
    };
    let each: Vec<_> = (0..scene.obstacles.len())
        .into_par_iter()
        .map(of)
        .collect::<Result<_, Interrupted>>()?;
    let (intervals, doubts): (Vec<_>, Vec<_>) = each.into_iter().unzip();
    Ok((intervals.concat(), doubts.concat()))
}
