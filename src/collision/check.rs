//! A whole check, from surfaces and motions to the verdict.

use super::chart::Mover;
use super::course::{Stage, commute, mover, stages};
use super::descent::{Encounter, Found, Search};
use super::distance::Closest as ClosestTriangles;
use super::distance::Still;
use super::nearest::Part;
use super::separation::Meeting;
use super::shape::Shape;
use super::{
    Check, CheckError, CheckSettings, CheckStage, Clearance, ContactInterval, Feature,
    FirstContact, Measure, Obstacle, RelativeMotion, Touch, Verdict,
};
use crate::body::Mesh;
use crate::motion::Motion;
use crate::numeric::area::area_vector;
use crate::numeric::tolerance::{JOINT_GAP, LARGEST_COORDINATE};
use glam::{DAffine3, DVec3};
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
    refuse(obstacles, settings)?;
    on_stage(CheckStage::Contact);
    let clock = Instant::now();
    let stages = stages(
        motion,
        obstacles.iter().filter_map(|obstacle| obstacle.motion),
    );
    let scene = Scene {
        body,
        obstacles,
        settings,
        ways: stages
            .iter()
            .map(|stage| mover(body, Some(motion), stage))
            .collect(),
        stages,
    };
    scene.refuse_far()?;
    let verdict = scene.verdict();
    let contact_seconds = clock.elapsed().as_secs_f64();
    let clock = Instant::now();
    if settings.measure == Measure::Distance {
        on_stage(CheckStage::Clearance);
    }
    let clearance = scene.clearance(&verdict);
    let clearance_seconds = clock.elapsed().as_secs_f64();
    let clock = Instant::now();
    let intervals = settings.all_intervals.then(|| {
        on_stage(CheckStage::Intervals);
        scene.intervals()
    });
    let interval_seconds = clock.elapsed().as_secs_f64();
    Ok(Check {
        verdict,
        intervals,
        clearance,
        relative: scene.relative(),
        seconds: [
            (CheckStage::Prepare, 0.0),
            (CheckStage::Contact, contact_seconds),
            (CheckStage::Clearance, clearance_seconds),
            (CheckStage::Intervals, interval_seconds),
        ],
    })
}

/// How far a body is from the nearest obstacle at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closest {
    /// Distance; 0 in contact, and where one contains a part of the other. Infinite when all obstacles are allowed.
    pub distance: f64,
    /// Number of the nearest obstacle.
    pub obstacle: usize,
    /// The nearest points of body and obstacle, in the world; of surfaces, where one is inside the other.
    pub points: [DVec3; 2],
}

/// The distance of a body from the obstacles that are not `allowed` (empty: none is) at a `time` on the motion's clock.
///
/// # Cost
/// Some 10 microseconds for a thousand triangles; prepare the shapes once for many times.
pub fn distance_at(
    body: &Shape,
    motion: &Motion,
    obstacles: &[ShapeObstacle],
    allowed: &[bool],
    time: f64,
) -> Closest {
    let mut best = Closest {
        distance: f64::INFINITY,
        obstacle: 0,
        points: [DVec3::ZERO; 2],
    };
    for (number, obstacle) in obstacles.iter().enumerate() {
        if allowed.get(number).copied().unwrap_or(false) {
            continue;
        }
        let still = Still {
            shapes: [body, obstacle.shape],
            poses: [
                motion.pose_at_time(time),
                obstacle
                    .motion
                    .map_or(DAffine3::IDENTITY, |motion| motion.pose_at_time(time)),
            ],
        };
        let contained = still.contained().is_some();
        let limit = if contained {
            f64::INFINITY
        } else {
            best.distance
        };
        if let Some(closest) = still.closest(limit) {
            best = Closest {
                distance: if contained {
                    0.0
                } else {
                    closest.nearest.distance()
                },
                obstacle: number,
                points: closest.nearest.points,
            };
        }
        if best.distance == 0.0 {
            break;
        }
    }
    best
}

fn refuse(obstacles: &[ShapeObstacle], settings: &CheckSettings) -> Result<(), CheckError> {
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
    Ok(())
}

/// Everything that a check is about.
struct Scene<'a> {
    body: &'a Shape,
    obstacles: &'a [ShapeObstacle<'a>],
    settings: &'a CheckSettings,
    stages: Vec<Stage>,
    /// Of the body, during each stage.
    ways: Vec<Mover>,
}

impl Scene<'_> {
    fn is_allowed(&self, obstacle: usize) -> bool {
        self.settings
            .allowed
            .get(obstacle)
            .copied()
            .unwrap_or(false)
    }

    fn encounter(&self, obstacle: usize, stage: usize) -> Encounter<'_> {
        let ShapeObstacle { shape, motion } = self.obstacles[obstacle];
        Encounter {
            shapes: [self.body, shape],
            movers: [
                self.ways[stage].clone(),
                mover(shape, motion, &self.stages[stage]),
            ],
        }
    }

    fn refuse_far(&self) -> Result<(), CheckError> {
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

    fn relative(&self) -> Vec<RelativeMotion> {
        let of = |(number, obstacle): (usize, &ShapeObstacle)| {
            if obstacle.motion.is_none() {
                return RelativeMotion::AtRest;
            }
            let steady = (0..self.stages.len()).all(|stage| {
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

    /// Obstacles that must not be touched.
    fn forbidden(&self) -> impl Iterator<Item = usize> {
        (0..self.obstacles.len()).filter(|&number| !self.is_allowed(number))
    }

    fn verdict(&self) -> Verdict {
        if let Some(inside) = self.forbidden().find_map(|number| self.inside(number)) {
            return Verdict::Contact(inside);
        }
        for (index, stage) in self.stages.iter().enumerate() {
            let mut best: Option<(usize, Found)> = None;
            let mut bracket = [f64::INFINITY, 1.0];
            let mut unknown = (f64::INFINITY, 0);
            for number in self.forbidden() {
                let encounter = self.encounter(number, index);
                let earliest = Search::new(&encounter, self.settings.clearance).first(bracket[1]);
                if earliest.unknown < unknown.0 {
                    unknown = (earliest.unknown, number);
                }
                bracket[0] = bracket[0].min(earliest.bracket[0]);
                bracket[1] = bracket[1].min(earliest.bracket[1]);
                if let Some(found) = earliest.found
                    && best.is_none_or(|(_, best)| found.meeting.time < best.meeting.time)
                {
                    best = Some((number, found));
                }
            }
            if unknown.0 <= best.map_or(1.0, |_| bracket[1]) {
                let end = best.map_or(self.end(), |_| stage.clock(bracket[1]));
                return Verdict::Undecided {
                    window: [stage.clock(unknown.0), end],
                    span: stage.span,
                    obstacle: unknown.1,
                };
            }
            if let Some((number, found)) = best {
                return self.met(index, number, &found, bracket);
            }
        }
        Verdict::Clear
    }

    fn end(&self) -> f64 {
        self.stages[self.stages.len() - 1].times[1]
    }

    fn met(&self, stage: usize, obstacle: usize, found: &Found, bracket: [f64; 2]) -> Verdict {
        let meeting = &found.meeting;
        let closest = ClosestTriangles {
            nearest: meeting.nearest,
            triangles: found.triangles,
        };
        let at_start = stage == 0 && meeting.after <= 0.0;
        let touch = if at_start
            && (self.overlap(0, 0.0, obstacle) || self.coincides(obstacle, found.triangles))
        {
            Touch::Inside
        } else if meeting.crosses {
            Touch::Enter
        } else {
            self.touch(stage, meeting, obstacle)
        };
        let stage = &self.stages[stage];
        let bracket = bracket.map(|time| stage.clock(time));
        let contact = FirstContact {
            time: stage.clock(meeting.time).clamp(bracket[0], bracket[1]),
            bracket,
            span: stage.span,
            obstacle,
            features: self.features(obstacle, &closest),
            touch,
            point: meeting.nearest.points[1],
            normal: meeting.normal,
        };
        // Too close from the start, down to contact: that is what it is.
        let touches = meeting.nearest.distance() == 0.0;
        if self.settings.clearance > 0.0 && !touches {
            Verdict::Closer(contact)
        } else {
            Verdict::Contact(contact)
        }
    }

    fn features(&self, obstacle: usize, closest: &ClosestTriangles) -> [Feature; 2] {
        let shapes = [self.body, self.obstacles[obstacle].shape];
        [0, 1].map(|which: usize| {
            let number = closest.triangles[which];
            let corners = shapes[which].indices(number);
            match closest.nearest.parts[which] {
                Part::Corner(k) => Feature::Vertex(corners[k]),
                Part::Side(k) => {
                    let [a, b] = [corners[k], corners[(k + 1) % 3]];
                    Feature::Edge([a.min(b), a.max(b)])
                }
                Part::Inside => Feature::Face(number),
            }
        })
    }

    /// Whether two are closer than the threshold, or overlap, for certain, at a local time of a stage.
    fn overlap(&self, stage: usize, time: f64, obstacle: usize) -> bool {
        let encounter = self.encounter(obstacle, stage);
        let still = encounter.still(time);
        let slack = encounter.slack(time);
        let threshold = self.settings.clearance;
        if threshold > 0.0 {
            still.closest(threshold - PROBE_MARGIN * slack).is_some()
        } else {
            still.overlap(PROBE_MARGIN * slack)
        }
    }

    /// Whether, at the start, the inner side of a triangle of the body is inside of an obstacle, though nothing passes through
    /// anything: surfaces that lie on each other.
    fn coincides(&self, obstacle: usize, triangles: [u32; 2]) -> bool {
        let shape = self.obstacles[obstacle].shape;
        let poses = self.encounter(obstacle, 0).still(0.0).poses;
        let corners = self
            .body
            .corners(triangles[0])
            .map(|corner| poses[0].transform_point3(corner));
        let inward = -area_vector(corners).normalize_or_zero();
        let [low, high] = self.body.bounds();
        let depth = PROBE_WAY * low.distance(high);
        let inner = (corners[0] + corners[1] + corners[2]) / 3.0 + inward * depth;
        inward != DVec3::ZERO
            && self.settings.clearance == 0.0
            && shape.contains(poses[1].inverse().transform_point3(inner))
    }

    /// What becomes of a contact in a stage, by looking a little later.
    fn touch(&self, stage: usize, meeting: &Meeting, obstacle: usize) -> Touch {
        let time = meeting.by;
        let (stage, time) = if time >= 1.0 && stage + 1 < self.stages.len() {
            (stage + 1, 0.0)
        } else {
            (stage, time)
        };
        let encounter = self.encounter(obstacle, stage);
        let speed = encounter.speed(time);
        let size = encounter
            .shapes
            .map(|shape| shape.bounds()[0].distance(shape.bounds()[1]));
        let step = if speed > 0.0 {
            PROBE_WAY * size[0].min(size[1]) / speed
        } else {
            0.0
        };
        let later = time + step;
        if step == 0.0 || later > 1.0 {
            // Nothing follows, or nothing moves.
            return Touch::Touch;
        }
        if self.overlap(stage, later, obstacle) {
            return Touch::Enter;
        }
        let limit = self.settings.clearance + PROBE_MARGIN * encounter.slack(later);
        if encounter.still(later).closest(limit).is_none() {
            Touch::Touch
        } else if meeting.closing > SLIDING * speed {
            // Faces that meet flush: nothing passes through anything.
            Touch::Enter
        } else {
            Touch::Slide
        }
    }

    /// Whether one of the two contains a part of the other at the start.
    fn inside(&self, obstacle: usize) -> Option<FirstContact> {
        let stage = &self.stages[0];
        let encounter = self.encounter(obstacle, 0);
        let still = encounter.still(0.0);
        still.contained()?;
        let closest = still.closest(f64::INFINITY)?;
        let time = stage.times[0];
        let [a, b] = closest.nearest.points;
        Some(FirstContact {
            time,
            bracket: [time; 2],
            span: stage.span,
            obstacle,
            features: self.features(obstacle, &closest),
            touch: Touch::Inside,
            point: b,
            normal: (a - b).normalize_or(DVec3::Z),
        })
    }

    /// All times of contact (below the clearance), with each obstacle, allowed or not.
    fn intervals(&self) -> Vec<ContactInterval> {
        let of = |obstacle: usize| {
            let mut all: Vec<[f64; 2]> = Vec::new();
            for (index, stage) in self.stages.iter().enumerate() {
                let encounter = self.encounter(obstacle, index);
                let times = Search::new(&encounter, self.settings.clearance).presences();
                let gap = JOINT_GAP * (stage.times[1] - stage.times[0]);
                for interval in times.intervals() {
                    let [start, end] = interval.map(|time| stage.clock(time));
                    match all.last_mut() {
                        Some(last) if start <= last[1] + gap => last[1] = last[1].max(end),
                        _ => all.push([start, end]),
                    }
                }
            }
            all.into_iter()
                .map(move |times| ContactInterval { obstacle, times })
        };
        (0..self.obstacles.len()).flat_map(of).collect()
    }

    /// How close the body comes to what it must not touch.
    fn clearance(&self, verdict: &Verdict) -> Clearance {
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
        let mut take = |obstacle: usize, stage: usize, time: f64, closest: &ClosestTriangles| {
            (clearance.upper, clearance.obstacle) = (closest.nearest.distance(), obstacle);
            clearance.time = self.stages[stage].clock(time);
            clearance.points = closest.nearest.points;
            clearance.upper
        };
        // First a distance that is soon found, so that most of the rest need not be looked at closely.
        let mut upper = f64::INFINITY;
        for stage in 0..self.stages.len() {
            for obstacle in self.forbidden() {
                let encounter = self.encounter(obstacle, stage);
                if let Some(closest) = encounter.still(0.5).closest(upper) {
                    upper = take(obstacle, stage, 0.5, &closest);
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
                    upper = take(obstacle, stage, time, &closest);
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
                clearance.points = closest.nearest.points;
            }
        }
        clearance.lower = lower.min(clearance.upper);
        if *verdict == Verdict::Clear {
            // Certified already, whatever became of the measurement.
            clearance.lower = clearance.lower.max(self.settings.clearance);
        }
        clearance
    }
}

/// Pairs of boxes that the measurement of the least distance may look at, some 50 ms of work: then its lower bound is as it is, proven
/// but not tight.
const MEASURING_WORK: usize = 200_000;

/// Way that the fastest point of a contact goes until it is looked at again, as a part of the size of the smaller body: what is
/// tangential has parted by some 1e-10 of the size then, far more than rounding.
const PROBE_WAY: f64 = 1e-5;

/// Speed along the normal, as a part of the largest one, below which a contact that stays one slides.
const SLIDING: f64 = 1e-6;

/// Errors of position by which things have to be apart, or to overlap, to count as such when a contact is looked at again.
const PROBE_MARGIN: f64 = 8.0;
