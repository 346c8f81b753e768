//! Everything that a check is about, and the searches over its stages and obstacles.

use super::chart::Mover;
use super::check::ShapeObstacle;
use super::course::{Stage, commute, mover};
use super::descent::Search;
use super::distance::Closest as ClosestTriangles;
use super::shape::Shape;
use super::window::Encounter;
use super::{
    CheckError, CheckSettings, Clearance, ContactInterval, ContactRule, Measure, RelativeMotion,
    Verdict,
};
use crate::numeric::tolerance::{JOINT_GAP, LARGEST_COORDINATE};
use glam::DVec3;
use rayon::prelude::*;

/// Everything that a check is about.
pub(super) struct Scene<'a> {
    pub(super) body: &'a Shape,
    pub(super) obstacles: &'a [ShapeObstacle<'a>],
    pub(super) settings: &'a CheckSettings,
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
        let ShapeObstacle { shape, motion } = self.obstacles[obstacle];
        [
            self.ways[stage].clone(),
            mover(shape, motion, &self.stages[stage]),
        ]
    }

    pub(super) fn refuse_far(&self) -> Result<(), CheckError> {
        let moving = self
            .obstacles
            .iter()
            .filter(|obstacle| obstacle.motion.is_some());
        let theirs = moving.flat_map(|obstacle| {
            self.stages
                .iter()
                .map(|stage| mover(obstacle.shape, obstacle.motion, stage).reach())
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

    /// All times of contact (below the clearance, or entered) with each obstacle, left out or not.
    pub(super) fn intervals(&self) -> Vec<ContactInterval> {
        let of = |obstacle: usize| {
            let mut all: Vec<[f64; 2]> = Vec::new();
            for (index, stage) in self.stages.iter().enumerate() {
                let encounter = self.encounter(obstacle, index);
                let times = match self.depth(obstacle) {
                    Some(depth) => encounter.deep_times(depth),
                    None => encounter.presences(self.settings.clearance),
                };
                let gap = JOINT_GAP * (stage.times[1] - stage.times[0]);
                for interval in times.intervals() {
                    let [start, end] = interval.map(|time| stage.clock(time));
                    match all.last_mut() {
                        Some(last) if start <= last[1] + gap => last[1] = last[1].max(end),
                        _ => all.push([start, end]),
                    }
                }
            }
            let interval = |times| ContactInterval { obstacle, times };
            all.into_iter().map(interval).collect::<Vec<_>>()
        };
        let each: Vec<_> = (0..self.obstacles.len()).into_par_iter().map(of).collect();
        each.concat()
    }

    /// How close the body comes to what it must not touch.
    pub(super) fn clearance(&self, verdict: &Verdict) -> Clearance {
        let mut clearance = Clearance {
            lower: f64::INFINITY,
            upper: f64::INFINITY,
            time: self.stages[0].times[0],
            obstacle: 0,
            points: [DVec3::ZERO; 2],
        };
        match *verdict {
            Verdict::Contact(contact) => {
                return Clearance {
                    lower: 0.0,
                    upper: 0.0,
                    time: contact.time,
                    obstacle: contact.obstacle,
                    points: [contact.point; 2],
                };
            }
            Verdict::Clear if self.settings.measure == Measure::Verdict => {
                return Clearance {
                    lower: self.settings.clearance,
                    ..clearance
                };
            }
            Verdict::Closer(_) if self.settings.measure == Measure::Verdict => {
                clearance.lower = 0.0;
                return clearance;
            }
            Verdict::Clear | Verdict::Closer(_) => {}
            Verdict::Undecided { .. } => {
                clearance.lower = 0.0;
                return clearance;
            }
        }
        let mut take = |obstacle: usize,
                        stage: usize,
                        encounter: &Encounter,
                        time: f64,
                        closest: &ClosestTriangles| {
            (clearance.upper, clearance.obstacle) = (closest.nearest.distance(), obstacle);
            clearance.time = self.stages[stage].clock(time);
            clearance.points = encounter.in_world(closest.nearest.points, time);
            clearance.upper
        };
        // First a distance that is soon found, so that most of the rest need not be looked at closely.
        let mut upper = f64::INFINITY;
        for stage in 0..self.stages.len() {
            for obstacle in self.forbidden() {
                let encounter = self.encounter(obstacle, stage);
                if let Some(closest) = encounter.still(0.5).closest(upper) {
                    upper = take(obstacle, stage, &encounter, 0.5, &closest);
                }
            }
        }
        let mut lower = upper;
        let mut budget = MEASURING_WORK;
        for stage in 0..self.stages.len() {
            for obstacle in self.forbidden() {
                let encounter = self.encounter(obstacle, stage);
                let hint = encounter.between_centres();
                let least = Search::new(&encounter, 0.0).least(upper, hint, &mut budget);
                lower = lower.min(least.lower.max(0.0));
                if let Some((time, closest)) = least.seen {
                    upper = take(obstacle, stage, &encounter, time, &closest);
                }
            }
        }
        // What is seen at that time is all that is near then, not only the pair that was followed.
        let seen = clearance.time;
        let last = self.stages.len() - 1;
        let index = self.stages.iter().position(|stage| seen <= stage.times[1]);
        let stage = index.unwrap_or(last);
        for obstacle in self.forbidden() {
            let encounter = self.encounter(obstacle, stage);
            let time = self.stages[stage].local(seen);
            if let Some(closest) = encounter.still(time).closest(clearance.upper) {
                clearance.upper = closest.nearest.distance();
                clearance.obstacle = obstacle;
                clearance.points = encounter.in_world(closest.nearest.points, time);
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
            clearance.lower = clearance.lower.max(self.settings.clearance);
        }
        clearance
    }
}

/// Part of the distance that was seen that is certified in a way that takes less work, where the measurement itself gets no farther.
const ROUGHLY: f64 = 0.5;

/// Pairs of boxes that the measurement of the least distance may look at, some 50 ms of work: then its lower bound is as it is, proven
/// but not tight.
const MEASURING_WORK: usize = 200_000;
