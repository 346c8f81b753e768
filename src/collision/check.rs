//! A whole check, from surfaces and motions to the verdict.

use super::course::{Stage, commute, mover, stages};
use super::descent::{Earliest, Encounter, Found, Search};
use super::nearest::Part;
use super::shape::Shape;
use super::{
    Check, CheckError, CheckSettings, CheckStage, Clearance, Feature, FirstContact, Obstacle,
    RelativeMotion, Touch, Verdict,
};
use crate::body::Mesh;
use crate::motion::{Motion, box_path_bounds};
use crate::numeric::tolerance::LARGEST_COORDINATE;
use glam::DVec3;
use std::time::Instant;

/// Something that the body may hit, prepared.
#[derive(Debug, Clone, Copy)]
pub struct ShapeObstacle<'a> {
    /// Its surface, in the world or, if it moves, in its own frame.
    pub shape: &'a Shape,
    /// How it moves; `None`: it rests. Outside of the time of its motion it rests at the nearer end.
    pub motion: Option<&'a Motion>,
}

/// Checks a moving body against obstacles.
///
/// - `body`: in its own frame, carried by `motion`.
/// - `obstacles`: at least one.
/// - `on_stage`: told when a stage begins.
///
/// # Guarantee
/// [`Verdict::Clear`] is a proof. What cannot be decided is [`Verdict::Undecided`].
///
/// # Errors
/// [`CheckError`]: no obstacles, a clearance that is none, a motion beyond the range of numbers.
pub fn check(
    body: &Mesh,
    motion: &Motion,
    obstacles: &[Obstacle],
    settings: &CheckSettings,
    on_stage: &(dyn Fn(CheckStage) + Sync),
) -> Result<Check, CheckError> {
    on_stage(CheckStage::Prepare);
    let clock = Instant::now();
    let body = Shape::from(body);
    let shapes: Vec<Shape> = obstacles
        .iter()
        .map(|obstacle| Shape::new(obstacle.surface))
        .collect();
    let prepared: Vec<ShapeObstacle> = obstacles
        .iter()
        .zip(&shapes)
        .map(|(obstacle, shape)| ShapeObstacle {
            shape,
            motion: obstacle.motion,
        })
        .collect();
    let seconds = clock.elapsed().as_secs_f64();
    let mut check = check_shapes(&body, motion, &prepared, settings, on_stage)?;
    check.seconds[0].1 = seconds;
    Ok(check)
}

/// [`check`] of shapes that were prepared before, for many checks of the same ones.
///
/// # Errors
/// As [`check`].
pub fn check_shapes(
    body: &Shape,
    motion: &Motion,
    obstacles: &[ShapeObstacle],
    settings: &CheckSettings,
    on_stage: &(dyn Fn(CheckStage) + Sync),
) -> Result<Check, CheckError> {
    refuse(body, motion, obstacles, settings)?;
    on_stage(CheckStage::Contact);
    let clock = Instant::now();
    let stages = stages(
        motion,
        obstacles.iter().filter_map(|obstacle| obstacle.motion),
    );
    let scene = Scene {
        body,
        motion,
        obstacles,
        settings,
        stages,
    };
    let verdict = scene.verdict();
    let seconds = clock.elapsed().as_secs_f64();
    let clearance = Clearance {
        lower: 0.0,
        upper: f64::INFINITY,
        time: motion.joint_times()[0],
        obstacle: 0,
        points: [DVec3::ZERO; 2],
    };
    Ok(Check {
        verdict,
        intervals: None,
        clearance,
        relative: scene.relative(),
        seconds: [
            (CheckStage::Prepare, 0.0),
            (CheckStage::Contact, seconds),
            (CheckStage::Clearance, 0.0),
            (CheckStage::Intervals, 0.0),
        ],
    })
}

fn refuse(
    body: &Shape,
    motion: &Motion,
    obstacles: &[ShapeObstacle],
    settings: &CheckSettings,
) -> Result<(), CheckError> {
    let clearance = settings.clearance;
    if !(clearance >= 0.0 && clearance.is_finite()) {
        return Err(CheckError::Clearance { clearance });
    }
    if obstacles.is_empty() {
        return Err(CheckError::NoObstacles);
    }
    let (found, expected) = (settings.allowed.len(), obstacles.len());
    if found != 0 && found != expected {
        return Err(CheckError::Allowed { found, expected });
    }
    let moving = obstacles
        .iter()
        .filter_map(|obstacle| Some((obstacle.shape, obstacle.motion?)));
    for (shape, motion) in [(body, motion)].into_iter().chain(moving) {
        let reach = reach(shape, motion);
        if reach.is_nan() || reach > LARGEST_COORDINATE {
            return Err(CheckError::TooFar { reach });
        }
    }
    Ok(())
}

/// Largest coordinate on the way.
fn reach(shape: &Shape, motion: &Motion) -> f64 {
    let spans = motion.spans().iter().zip(motion.joints());
    let mut reach: f64 = 0.0;
    for (span, joint) in spans {
        let pose = *joint * *motion.start_pose();
        let [low, high] = shape.bounds();
        let (centre, half) = (low.midpoint(high), (high - low) * 0.5);
        let placed = pose.transform_point3(centre);
        let extent = pose.matrix3.abs() * half;
        let [low, high] = box_path_bounds(
            span.flow().generator(),
            [placed - extent, placed + extent],
            [0.0, 1.0],
        );
        reach = reach.max(low.abs().max(high.abs()).max_element());
    }
    reach
}

/// Everything that a check is about.
struct Scene<'a> {
    body: &'a Shape,
    motion: &'a Motion,
    obstacles: &'a [ShapeObstacle<'a>],
    settings: &'a CheckSettings,
    stages: Vec<Stage>,
}

impl Scene<'_> {
    fn is_allowed(&self, obstacle: usize) -> bool {
        self.settings
            .allowed
            .get(obstacle)
            .copied()
            .unwrap_or(false)
    }

    fn encounter(&self, obstacle: usize, stage: &Stage) -> Encounter<'_> {
        let ShapeObstacle { shape, motion } = self.obstacles[obstacle];
        Encounter {
            shapes: [self.body, shape],
            movers: [
                mover(self.body, Some(self.motion), stage),
                mover(shape, motion, stage),
            ],
        }
    }

    fn relative(&self) -> Vec<RelativeMotion> {
        let of = |(number, obstacle): (usize, &ShapeObstacle)| {
            if obstacle.motion.is_none() {
                return RelativeMotion::AtRest;
            }
            let steady = self.stages.iter().all(|stage| {
                let [a, b] = self.encounter(number, stage).movers;
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

    fn verdict(&self) -> Verdict {
        let concerned = |&number: &usize| !self.is_allowed(number);
        let numbers: Vec<usize> = (0..self.obstacles.len()).filter(concerned).collect();
        if let Some(inside) = numbers
            .iter()
            .find_map(|&number| self.inside_at_start(number))
        {
            return Verdict::Contact(inside);
        }
        for stage in &self.stages {
            let mut best: Option<(usize, Earliest)> = None;
            let mut bracket = [f64::INFINITY, 1.0];
            let mut unknown = (f64::INFINITY, 0);
            for &number in &numbers {
                let encounter = self.encounter(number, stage);
                let earliest = Search::new(&encounter, self.settings.clearance).first(bracket[1]);
                if earliest.unknown < unknown.0 {
                    unknown = (earliest.unknown, number);
                }
                bracket[0] = bracket[0].min(earliest.bracket[0]);
                bracket[1] = bracket[1].min(earliest.bracket[1]);
                if let Some(found) = earliest.found
                    && best
                        .as_ref()
                        .and_then(|(_, best)| best.found)
                        .is_none_or(|best| found.meeting.time < best.meeting.time)
                {
                    best = Some((number, earliest));
                }
            }
            let found = best.and_then(|(number, earliest)| Some((number, earliest.found?)));
            if unknown.0 <= found.map_or(1.0, |_| bracket[1]) {
                let end = found.map_or(self.end(), |_| stage.clock(bracket[1]));
                return Verdict::Undecided {
                    window: [stage.clock(unknown.0), end],
                    span: stage.span,
                    obstacle: unknown.1,
                };
            }
            if let Some((number, found)) = found {
                let contact = self.contact(stage, number, &found, bracket);
                return if self.settings.clearance > 0.0 {
                    Verdict::Closer(contact)
                } else {
                    Verdict::Contact(contact)
                };
            }
        }
        Verdict::Clear
    }

    fn end(&self) -> f64 {
        self.stages[self.stages.len() - 1].times[1]
    }

    fn contact(
        &self,
        stage: &Stage,
        obstacle: usize,
        found: &Found,
        bracket: [f64; 2],
    ) -> FirstContact {
        let meeting = &found.meeting;
        let bracket = bracket.map(|time| stage.clock(time));
        let shapes = [self.body, self.obstacles[obstacle].shape];
        let feature = |which: usize| {
            let number = found.triangles[which];
            let corners = shapes[which].indices(number);
            match meeting.nearest.parts[which] {
                Part::Corner(k) => Feature::Vertex(corners[k]),
                Part::Side(k) => {
                    let [a, b] = [corners[k], corners[(k + 1) % 3]];
                    Feature::Edge([a.min(b), a.max(b)])
                }
                Part::Inside => Feature::Face(number),
            }
        };
        FirstContact {
            time: stage.clock(meeting.time).clamp(bracket[0], bracket[1]),
            bracket,
            span: stage.span,
            obstacle,
            features: [feature(0), feature(1)],
            touch: if meeting.crosses {
                Touch::Enter
            } else {
                Touch::Touch
            },
            point: meeting.nearest.points[1],
            normal: meeting.normal,
        }
    }

    /// Whether one of the two contains a part of the other at the start.
    fn inside_at_start(&self, obstacle: usize) -> Option<FirstContact> {
        let stage = &self.stages[0];
        let encounter = self.encounter(obstacle, stage);
        let poses = [0, 1].map(|which: usize| encounter.movers[which].pose(0.0));
        let shapes = encounter.shapes;
        let contained = |inner: usize| {
            let outer = 1 - inner;
            let from = poses[outer].inverse() * poses[inner];
            shapes[outer].closed()
                && shapes[inner]
                    .parts()
                    .any(|(_, point)| shapes[outer].contains(from.transform_point3(point)))
        };
        if !(contained(0) || contained(1)) {
            return None;
        }
        let time = stage.times[0];
        Some(FirstContact {
            time,
            bracket: [time; 2],
            span: stage.span,
            obstacle,
            features: [Feature::Vertex(0); 2],
            touch: Touch::Inside,
            point: DVec3::ZERO,
            normal: DVec3::Z,
        })
    }
}
