//! When a body enters obstacles that it may touch.
//!
//! A *closed* obstacle is entered when a point of the body inside of it is farther from its surface than the depth: the surface of
//! the body sinks into the obstacle (`sinking`), or the body holds a part of it from the start (`engulfed`). An *open* one is entered
//! when a point of it lies in the body farther than the depth from the body's surface: the body then lies deeper than that on both of its
//! sides, and the sheet sinks into the body. A body that reaches over the rim of a sheet, or stands round it, holds no point of it.

use super::entry::Entry;
use super::piece::part;
use super::scene::Scene;
use super::sinking::Sinking;
use super::window::Encounter;
use super::witness::feature;
use super::{CheckError, ContactRule, FirstContact, Touch, Verdict};
use crate::numeric::tolerance::LEAST_DEPTH;
use glam::DVec3;
use std::cell::OnceCell;

impl Scene<'_> {
    /// Obstacles that may be touched but not entered, with the depth.
    pub(super) fn touchable(&self) -> impl Iterator<Item = (usize, f64)> {
        (0..self.obstacles.len()).filter_map(|number| Some((number, self.depth(number)?)))
    }

    /// How deep an obstacle may be entered; `None` where it must not be touched, or is left out.
    pub(super) fn depth(&self, obstacle: usize) -> Option<f64> {
        match self.rule(obstacle) {
            ContactRule::Enter { depth } => {
                Some(depth.unwrap_or_else(|| self.least_depth(obstacle)))
            }
            ContactRule::Touch | ContactRule::Allowed => None,
        }
    }

    /// The least depth that rounding allows to tell from touching.
    pub(super) fn least_depth(&self, obstacle: usize) -> f64 {
        let slack = |stage: usize| self.encounter(obstacle, stage).slack(1.0);
        let stages = 0..self.stages.len();
        LEAST_DEPTH * stages.map(slack).fold(0.0, f64::max)
    }

    /// The first of a verdict and of the times at which what may be touched is entered.
    pub(super) fn or_entered(&self, verdict: Verdict) -> Verdict {
        let mut first = verdict;
        for (number, depth) in self.touchable() {
            let found = self.entered(number, depth);
            if let Some(found) = found
                && is_before(&found, &first)
            {
                first = found;
            }
        }
        first
    }

    pub(super) fn refuse_depths(&self) -> Result<(), CheckError> {
        for (obstacle, depth) in self.touchable() {
            let least = self.least_depth(obstacle);
            if !(depth >= least && depth.is_finite()) {
                return Err(CheckError::Depth {
                    depth,
                    obstacle,
                    least: least * READABLE,
                });
            }
            let keeps_shape = |stage: usize| self.movers(obstacle, stage)[1].is_rigid();
            let closed = self.obstacles[obstacle].shape.closed();
            if closed && !(0..self.stages.len()).all(keeps_shape) {
                return Err(CheckError::Stretched { obstacle });
            }
        }
        Ok(())
    }

    fn entered(&self, obstacle: usize, depth: f64) -> Option<Verdict> {
        let thin = OnceCell::new();
        (0..self.stages.len()).find_map(|stage| {
            let encounter = self.encounter(obstacle, stage);
            let mut spare = Sinking::new(&encounter, depth).allowance();
            let entry = encounter.entry(stage == 0, 0.0, depth, &mut spare, &thin)?;
            Some(self.described(obstacle, stage, depth, &entry))
        })
    }

    fn described(&self, obstacle: usize, stage: usize, depth: f64, entry: &Entry) -> Verdict {
        let encounter = self.encounter(obstacle, stage);
        let at = &self.stages[stage];
        let clock = |time: f64| at.clock(time);
        let (bracket, deep) = match *entry {
            Entry::Unknown(time, limited) => {
                let end = self.stages[self.stages.len() - 1].times[1];
                return Verdict::Undecided {
                    window: [clock(time), end],
                    span: at.span,
                    obstacle,
                    limited,
                };
            }
            Entry::Held(point) => return Verdict::Contact(self.held(obstacle, &encounter, point)),
            Entry::Sunk { bracket, deep } => (bracket, deep),
        };
        let sinking = Sinking::new(&encounter, depth);
        let time = bracket[1];
        let sounding = sinking.sound(&deep, time);
        let out = sounding.outward().unwrap_or(DVec3::Z);
        let shapes = [self.body, self.obstacles[obstacle].shape];
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

    /// A body that holds a part of an obstacle from the start.
    fn held(&self, obstacle: usize, encounter: &Encounter, point: DVec3) -> FirstContact {
        let solids = [0, 1].map(|which: usize| encounter.solid(which, 0.0).sound(point));
        let shapes = [self.body, self.obstacles[obstacle].shape];
        let features = [0, 1].map(|which: usize| {
            let sounding = &solids[which];
            feature(shapes[which], sounding.triangle, sounding.nearest.parts[1])
        });
        let world = encounter.to_world(0.0);
        let [time, _] = self.stages[0].times;
        FirstContact {
            time,
            bracket: [time; 2],
            span: self.stages[0].span,
            obstacle,
            features,
            touch: Touch::Inside,
            point: world.transform_point3(solids[1].nearest.points[1]),
            normal: world.transform_vector3(solids[1].outward().unwrap_or(DVec3::Z)),
        }
    }
}

/// Room for the rounding of a number to two digits.
const READABLE: f64 = 1.1;

/// When a verdict says that something happens.
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
