//! When a body enters obstacles that it may touch.
//!
//! A *closed* obstacle is entered when a point of the body inside it is farther from its surface
//! than the depth: the surface of the body sinks into the obstacle (`sinking`, `sunk`), or the body
//! contains a part of it from the start (`engulfed`). An *open* one is entered when a point of it
//! lies in the body farther than the depth from the body's surface: the body then lies deeper than
//! that on both sides of it, and the sheet sinks into the body. A body that reaches over the rim of
//! a sheet, or stands around it, contains no point of it.

use super::encounter::Encounter;
use super::entry::{self, Entry};
use super::scene::Scene;
use super::sinking::Sinking;
use super::sunk;
use super::triangle_piece::part;
use super::witness::feature;
use super::{FirstContact, Touch, Verdict};
use crate::watch::Interrupted;
use glam::DVec3;
use std::cell::OnceCell;

/// The earliest of a verdict and of the times at which obstacles that may be touched are entered.
pub(super) fn or_entered(scene: &Scene, verdict: Verdict) -> Result<Verdict, Interrupted> {
    let mut first = verdict;
    for (number, depth) in scene.touchable() {
        let found = entered(scene, number, depth);
        scene.work.check()?;
        if let Some(found) = found
            && is_before(&found, &first)
        {
            first = found;
        }
    }
    Ok(first)
}

fn entered(scene: &Scene, obstacle: usize, depth: f64) -> Option<Verdict> {
    let thin = OnceCell::new();
    (0..scene.stages.len()).find_map(|stage| {
        let encounter = scene.encounter(obstacle, stage);
        let mut spare = sunk::allowance(&Sinking::new(&encounter, depth));
        let entry = entry::first(&encounter, stage == 0, 0.0, depth, &mut spare, &thin)?;
        Some(described(scene, obstacle, stage, depth, &entry))
    })
}

fn described(scene: &Scene, obstacle: usize, stage: usize, depth: f64, entry: &Entry) -> Verdict {
    let encounter = scene.encounter(obstacle, stage);
    let at = &scene.stages[stage];
    let clock = |time: f64| at.clock(time);
    let (bracket, deep) = match *entry {
        Entry::Unknown(time, limited) => {
            let end = scene.stages[scene.stages.len() - 1].times[1];
            return Verdict::Undecided {
                window: [clock(time), end],
                span: at.span,
                obstacle,
                limited,
            };
        }
        Entry::Held(point) => return Verdict::Contact(held(scene, obstacle, &encounter, point)),
        Entry::Sunk { bracket, deep } => (bracket, deep),
    };
    let sinking = Sinking::new(&encounter, depth);
    let time = bracket[1];
    let sounding = sinking.sound(&deep, time);
    let out = sounding.outward().unwrap_or(DVec3::Z);
    let shapes = [scene.body, scene.obstacles[obstacle].shape];
    let mut features = [
        feature(shapes[sinking.surface], deep.triangle, part(deep.weights)),
        feature(
            shapes[1 - sinking.surface],
            sounding.triangle,
            sounding.nearest.parts[1],
        ),
    ];
    let [sunk, surface] = sounding.nearest.points;
    let (mut point, mut normal) = (surface, out);
    if sinking.surface == 1 {
        features.swap(0, 1);
        (point, normal) = (sunk, -out);
    }
    let world = encounter.to_world(time);
    let at_start = stage == 0 && time <= 0.0;
    let bracket = bracket.map(clock);
    Verdict::Contact(FirstContact {
        time: bracket[1],
        bracket,
        span: at.span,
        obstacle,
        features,
        touch: if at_start {
            Touch::Inside
        } else {
            Touch::Enter
        },
        point: world.transform_point3(point),
        normal: world.transform_vector3(normal),
    })
}

/// The contact of a body that contains a part of an obstacle from the start.
fn held(scene: &Scene, obstacle: usize, encounter: &Encounter, point: DVec3) -> FirstContact {
    let solids = [0, 1].map(|which: usize| encounter.solid(which, 0.0).sound(point));
    let shapes = [scene.body, scene.obstacles[obstacle].shape];
    let features = [0, 1].map(|which: usize| {
        let sounding = &solids[which];
        feature(shapes[which], sounding.triangle, sounding.nearest.parts[1])
    });
    let world = encounter.to_world(0.0);
    let [time, _] = scene.stages[0].times;
    FirstContact {
        time,
        bracket: [time; 2],
        span: scene.stages[0].span,
        obstacle,
        features,
        touch: Touch::Inside,
        point: world.transform_point3(solids[1].nearest.points[1]),
        normal: world.transform_vector3(solids[1].outward().unwrap_or(DVec3::Z)),
    }
}

/// The time of the event of a verdict.
fn start_of(verdict: &Verdict) -> f64 {
    match verdict {
        Verdict::Clear => f64::INFINITY,
        Verdict::Contact(first) | Verdict::Closer(first) => first.time,
        Verdict::Undecided { window, .. } => window[0],
    }
}

fn is_before(a: &Verdict, b: &Verdict) -> bool {
    start_of(a) < start_of(b)
}
