//! Everything that a check is about.

use super::commuting::commute;
use super::encounter::Encounter;
use super::mover::Mover;
use super::plane::Plane;
use super::shape::Shape;
use super::steady_stage::{self, SteadyStage};
use super::{CheckError, CheckSettings, ContactRule, RelativeMotion};
use crate::motion::{Merged, Motion};
use crate::numeric::tolerance::{LARGEST_COORDINATE, LEAST_DEPTH};
use crate::watch::Work;

/// An obstacle that the body may hit, prepared.
#[derive(Debug, Clone, Copy)]
pub struct ShapeObstacle<'a> {
    /// Its surface, in the world or, if it moves, in its own frame.
    pub shape: &'a Shape,
    /// Its motion; `None` when it rests. Outside the time of its motion, it rests at the nearer
    /// end.
    pub motion: Option<&'a Motion>,
}

/// Everything that a check is about.
pub(super) struct Scene<'a> {
    pub(super) body: &'a Shape,
    pub(super) obstacles: &'a [ShapeObstacle<'a>],
    /// The motion of each obstacle.
    pub(super) motions: &'a [Option<Merged<'a, Motion>>],
    pub(super) settings: &'a CheckSettings<'a>,
    pub(super) stages: Vec<SteadyStage>,
    /// The mover of the body during each stage.
    pub(super) body_movers: Vec<Mover>,
    /// The work of the current stage of the check.
    pub(super) work: Work<'a>,
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

    /// Body and obstacle during a stage, both moving; local time runs from 0 to 1 in the stage.
    pub(super) fn encounter(&self, obstacle: usize, stage: usize) -> Encounter<'_> {
        Encounter::new(
            [self.body, self.obstacles[obstacle].shape],
            self.movers(obstacle, stage),
        )
        .during(self.work.uncounted())
    }

    /// The movers of body and obstacle, in the world.
    pub(super) fn movers(&self, obstacle: usize, stage: usize) -> [Mover; 2] {
        let (shape, motion) = (self.obstacles[obstacle].shape, &self.motions[obstacle]);
        [
            self.body_movers[stage].clone(),
            self.stages[stage].mover(shape, motion.as_ref()),
        ]
    }

    /// Refuses motions that take the body or an obstacle beyond the coordinates for which the error
    /// bounds hold.
    ///
    /// # Errors
    /// [`CheckError::TooFar`] with the largest coordinate, infinite where it is not a number.
    pub(super) fn refuse_far(&self) -> Result<(), CheckError> {
        let moving = self
            .obstacles
            .iter()
            .zip(self.motions)
            .filter(|(_, motion)| motion.is_some());
        let theirs: Vec<Mover> = moving
            .flat_map(|(obstacle, motion)| {
                let stages = self.stages.iter();
                stages.map(|stage| stage.mover(obstacle.shape, motion.as_ref()))
            })
            .collect();
        let reach = steady_stage::reach(self.body_movers.iter().chain(&theirs));
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

    /// The plane of an obstacle that is a half-space.
    pub(super) fn plane(&self, obstacle: usize) -> Option<&Plane> {
        self.obstacles[obstacle].shape.plane()
    }

    /// The surfaces that must not be touched.
    pub(super) fn forbidden(&self) -> impl Iterator<Item = usize> {
        self.untouchable()
            .filter(|&number| self.plane(number).is_none())
    }

    /// The half-spaces that must not be touched.
    pub(super) fn forbidden_half_spaces(&self) -> impl Iterator<Item = usize> {
        self.untouchable()
            .filter(|&number| self.plane(number).is_some())
    }

    fn untouchable(&self) -> impl Iterator<Item = usize> {
        (0..self.obstacles.len()).filter(|&number| self.rule(number) == ContactRule::Touch)
    }

    /// The surfaces that may be touched but not entered, with their depths.
    pub(super) fn touchable(&self) -> impl Iterator<Item = (usize, f64)> {
        let surfaces = (0..self.obstacles.len()).filter(|&number| self.plane(number).is_none());
        surfaces.filter_map(|number| Some((number, self.depth(number)?)))
    }

    /// The depth to which an obstacle may be entered; `None` where it must not be touched, or is
    /// left out.
    pub(super) fn depth(&self, obstacle: usize) -> Option<f64> {
        match self.rule(obstacle) {
            ContactRule::Enter { depth } => {
                Some(depth.unwrap_or_else(|| self.least_depth(obstacle)))
            }
            ContactRule::Touch | ContactRule::Allowed => None,
        }
    }

    /// The least depth that rounding can tell from touching.
    pub(super) fn least_depth(&self, obstacle: usize) -> f64 {
        let slack = |stage: usize| self.encounter(obstacle, stage).slack(1.0);
        let stages = 0..self.stages.len();
        LEAST_DEPTH * stages.map(slack).fold(0.0, f64::max)
    }

    /// Refuses depths that cannot be compared, for the obstacles that may be touched.
    ///
    /// # Errors
    /// - [`CheckError::Depth`] for a depth that rounding cannot tell from touching, or that is not
    ///   finite.
    /// - [`CheckError::Stretched`] for a closed obstacle whose motion is not rigid: depths in it
    ///   change with time; [`CheckError::StretchedHalfSpace`] for such a half-space.
    pub(super) fn refuse_depths(&self) -> Result<(), CheckError> {
        for obstacle in 0..self.obstacles.len() {
            let keeps_shape = |stage: usize| self.movers(obstacle, stage)[1].is_rigid();
            let keeps_shape = || (0..self.stages.len()).all(keeps_shape);
            if self.plane(obstacle).is_some() && !keeps_shape() {
                return Err(CheckError::StretchedHalfSpace { obstacle });
            }
            let Some(depth) = self.depth(obstacle) else {
                continue;
            };
            let least = self.least_depth(obstacle);
            if !(depth >= least && depth.is_finite()) {
                return Err(CheckError::Depth {
                    depth,
                    obstacle,
                    least: least * READABLE,
                });
            }
            if self.obstacles[obstacle].shape.closed() && !keeps_shape() {
                return Err(CheckError::Stretched { obstacle });
            }
        }
        Ok(())
    }
}

/// Margin for the rounding of a number to two digits.
const READABLE: f64 = 1.1;
