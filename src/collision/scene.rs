//! Everything that a check is about, and the searches over its stages and obstacles.

use super::chart::Mover;
use super::commuting::commute;
use super::course::{Stage, mover};
use super::descent::Search;
use super::dwelling::Dwelling;
use super::shape::Shape;
use super::window::Encounter;
use super::{
    CheckError, CheckSettings, Clearance, Closest, ContactInterval, ContactRule, Doubt, Limited,
    Measure, RelativeMotion, Verdict,
};
use crate::motion::{Merged, Motion};
use crate::numeric::tolerance::LARGEST_COORDINATE;
use glam::DVec3;
use rayon::prelude::*;
use std::cell::OnceCell;

/// Something that the body may hit, prepared.
#[derive(Debug, Clone, Copy)]
pub struct ShapeObstacle<'a> {
    /// Its surface, in the world or, if it moves, in its own frame.
    pub shape: &'a Shape,
    /// How it moves; `None`: it rests. Outside of the time of its motion it rests at the nearer end.
    pub motion: Option<&'a Motion>,
}

/// Everything that a check is about.
pub(super) struct Scene<'a> {
    pub(super) body: &'a Shape,
    pub(super) obstacles: &'a [ShapeObstacle<'a>],
    /// Per obstacle its motion.
    pub(super) motions: &'a [Option<Merged<'a, Motion>>],
    pub(super) settings: &'a CheckSettings<'a>,
    pub(super) stages: Vec<Stage>,
    /// Of the body, during each stage.
    pub(super) ways: Vec<Mover>,
}

impl Scene<'_> {
    /// What counts as contact with an obstacle.
    pub(super) fn rule(&self, obstacle: usize) -> ContactRule {
        self.settings
            .rules
            .get(obstacle)
            .copied()
            .unwrap_or_default()
    }

    pub(super) fn encounter(&self, obstacle: usize, stage: usize) -> Encounter<'_> {
        Encounter::new(
            [self.body, self.obstacles[obstacle].shape],
            self.movers(obstacle, stage),
        )
    }

    /// Of body and obstacle, in the world.
    pub(super) fn movers(&self, obstacle: usize, stage: usize) -> [Mover; 2] {
        let (shape, motion) = (self.obstacles[obstacle].shape, &self.motions[obstacle]);
        [
            self.ways[stage].clone(),
            mover(shape, motion.as_ref(), &self.stages[stage]),
        ]
    }

    pub(super) fn refuse_far(&self) -> Result<(), CheckError> {
        let moving = self
            .obstacles
            .iter()
            .zip(self.motions)
            .filter(|(_, motion)| motion.is_some());
        let theirs = moving.flat_map(|(obstacle, motion)| {
            self.stages
                .iter()
                .map(|stage| mover(obstacle.shape, motion.as_ref(), stage).reach())
        });
        let own = self.ways.iter().map(Mover::reach);
        let reach = own.chain(theirs).fold(0.0, |far: f64, next| {
            if next.is_nan() {
                f64::INFINITY
            } else {
                far.max(next)
            }
        });
        if reach > LARGEST_COORDINATE {
            return Err(CheckError::TooFar { reach });
        }
        Ok(())
    }

    pub(super) fn relative(&self) -> Vec<RelativeMotion> {
        let of = |(number, obstacle): (usize, &ShapeObstacle)| {
            if obstacle.motion.is_none() {
                return RelativeMotion::AtRest;
            }
            let steady = (0..self.stages.len()).all(|stage| {
                let [a, b] = self.movers(number, stage);
                commute(&a.generator, &b.generator)
            });
            if steady {
                RelativeMotion::Steady
            } else {
                RelativeMotion::Bounded
            }
        };
        self.obstacles.iter().enumerate().map(of).collect()
    }

    /// Obstacles that must not be touched.
    pub(super) fn forbidden(&self) -> impl Iterator<Item = usize> {
        (0..self.obstacles.len()).filter(|&number| self.rule(number) == ContactRule::Touch)
    }

    /// All times of contact (below the clearance, or entered) with each obstacle, left out or not; and what of being entered is in doubt.
    pub(super) fn intervals(&self) -> (Vec<ContactInterval>, Vec<Doubt>) {
        let of = |obstacle: usize| {
            let thin = OnceCell::new();
            let mut all: Vec<[f64; 2]> = Vec::new();
            let mut doubts: Vec<Doubt> = Vec::new();
            for (index, stage) in self.stages.iter().enumerate() {
                let encounter = self.encounter(obstacle, index);
                let Dwelling {
                    times,
                    doubts: unclear,
                } = match self.depth(obstacle) {
                    Some(depth) => encounter.deep_times(depth, &thin),
                    None => Dwelling {
                        times: encounter.presences(self.settings.clearance),
                        doubts: Vec::new(),
                    },
                };
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
            (all.into_iter().map(interval).collect::<Vec<_>>(), doubts)
        };
        let each: Vec<_> = (0..self.obstacles.len()).into_par_iter().map(of).collect();
        let (intervals, doubts): (Vec<_>, Vec<_>) = each.into_iter().unzip();
        (intervals.concat(), doubts.concat())
    }

    /// How close the body comes to what it must not touch.
    pub(super) fn clearance(&self, verdict: &Verdict) -> Clearance {
        let mut clearance = Clearance {
            lower: 0.0,
            upper: f64::INFINITY,
            time: self.stages[0].times[0],
            obstacle: 0,
            points: [DVec3::ZERO; 2],
            limited: None,
        };
        match *verdict {
            Verdict::Contact(contact) => {
                return Clearance {
                    upper: 0.0,
                    time: contact.time,
                    obstacle: contact.obstacle,
                    points: [contact.point; 2],
                    ..clearance
                };
            }
            Verdict::Clear if self.settings.measure == Measure::Verdict => {
                clearance.lower = self.settings.clearance;
                return clearance;
            }
            Verdict::Closer(_) if self.settings.measure == Measure::Verdict => return clearance,
            Verdict::Clear => {}
            Verdict::Closer(found) => self.look(found.time, &mut clearance),
            Verdict::Undecided { limited, .. } => {
                clearance.limited = Some(limited);
                return clearance;
            }
        }
        // First distances that are soon found, so that most of the rest need not be looked at closely.
        let [start, end] = [
            self.stages[0].times[0],
            self.stages[self.stages.len() - 1].times[1],
        ];
        self.look(start, &mut clearance);
        self.look(end, &mut clearance);
        for stage in &self.stages {
            self.look(stage.clock(0.5), &mut clearance);
        }
        let mut lower = clearance.upper;
        let mut is_limited = false;
        let triangles = |number: usize| self.obstacles[number].shape.len() + self.body.len();
        let all = self.forbidden().map(triangles).sum::<usize>();
        let mut spare = MEASURING_WORK + MEASURING_WORK_EACH * all;
        for (number, stage) in self.stages.iter().enumerate() {
            for obstacle in self.forbidden() {
                let encounter = self.encounter(obstacle, number);
                let hint = encounter.between_centres();
                let upper = clearance.upper;
                let least = Search::new(&encounter, 0.0).least(upper, hint, &mut spare);
                lower = lower.min(least.lower.max(0.0));
                is_limited |= least.is_limited;
                if let Some(time) = least.seen {
                    // All that is near then counts, not only the pair that was followed.
                    self.look(stage.clock(time), &mut clearance);
                }
            }
        }
        clearance.lower = lower.min(clearance.upper);
        let roughly = ROUGHLY * clearance.upper;
        if *verdict == Verdict::Clear && clearance.lower < roughly && self.keeps(roughly) {
            // The measurement ran out of work: surfaces that are near each other all the way.
            clearance.lower = roughly;
        }
        if *verdict == Verdict::Clear {
            // Certified already, whatever became of the measurement.
            clearance.lower = clearance
                .lower
                .max(self.settings.clearance)
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
        clearance
    }

    /// Looks at what must not be touched at a time of the clock.
    fn look(&self, time: f64, clearance: &mut Clearance) {
        let before = self.stages.partition_point(|stage| stage.times[1] < time);
        let stage = before.min(self.stages.len() - 1);
        let local = self.stages[stage].local(time);
        for obstacle in self.forbidden() {
            let encounter = self.encounter(obstacle, stage);
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
}

/// Part of the distance that was seen that is certified in a way that takes less work, where the measurement itself gets no farther.
const ROUGHLY: f64 = 0.5;

/// Pairs of boxes that the measurement of the least distance may look at, some 50 ms of work, and for each triangle: then its lower bound
/// is as it is, proven but not tight.
const MEASURING_WORK: usize = 200_000;
const MEASURING_WORK_EACH: usize = 16;
