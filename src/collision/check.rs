//! A whole check, from surfaces and motions to the verdict.

use super::distance::Still;
use super::scene::{Scene, ShapeObstacle};
use super::shape::Shape;
use super::{
    Check, CheckError, CheckSettings, CheckStage, Closest, ContactRule, Measure, Obstacle, Verdict,
    clearance, deviating, entering, first, heights, intervals, steady_stage,
};
use crate::body::Mesh;
use crate::motion::{Merged, Motion};
use crate::watch::{Interrupted, Work};
use glam::{DAffine3, DVec3};
use std::time::Instant;

/// Checks a moving body against obstacles.
///
/// - `body`: in its own frame, carried by `motion`.
/// - `obstacles`: at least one.
/// - `settings`: what to compute, the observer of the stages, and the flag that stops the run.
///
/// # Guarantee
/// [`Verdict::Clear`] is a proof, and so is the start of every bracket. What cannot be decided is
/// [`Verdict::Undecided`]. Both hold for the motion that a chain stands for
/// ([`Motion::deviation`]). The answer does not depend on the number of threads. See the head of
/// [this module](super).
///
/// # Errors
/// [`CheckError`]: no obstacles, an invalid clearance, a motion beyond the range of numbers.
///
/// # Cost
/// O(n log n) for the trees. Without them, some 3 microseconds where nothing comes near, and 30 to
/// 300 for bodies of about a hundred triangles that do; the least distance (`Measure::Distance`)
/// takes longer, and its work is capped.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use steadysweep::body::{Mesh, Surface};
/// use steadysweep::collision::{CheckSettings, Obstacle, Verdict, check};
/// use steadysweep::motion::{Generator, Motion, Span};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let body = Mesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])?;
/// let along = Generator::translation(2.0 * DVec3::X);
/// let motion = Motion::from_spans(vec![Span::new(along, 1.0)?])?;
///
/// // A wall at x = 2, which the tip of the tetrahedron, at x = 1, meets half way.
/// let corners = [[2.0, -1.0, -1.0], [2.0, 2.0, -1.0], [2.0, -1.0, 2.0]].map(DVec3::from_array);
/// let wall = Surface::new(corners.to_vec(), vec![[0, 1, 2]])?;
/// let obstacle = Obstacle { surface: &wall, motion: None };
/// let found = check(&body, &motion, &[obstacle], &CheckSettings::default())?;
/// let Verdict::Contact(contact) = found.verdict else { panic!("contact") };
/// let [apart, touching] = contact.bracket;
/// assert!(apart <= 0.5 && 0.5 <= touching && touching - apart < 1e-9);
/// # Ok(())
/// # }
/// ```
pub fn check(
    body: &Mesh,
    motion: &Motion,
    obstacles: &[Obstacle],
    settings: &CheckSettings,
) -> Result<Check, CheckError> {
    let watched = settings.watch.start();
    let items = watched
        .begin(CheckStage::Prepare)?
        .items(1 + obstacles.len());
    let clock = Instant::now();
    let body = Shape::from(body);
    items.next()?;
    let shapes = obstacles
        .iter()
        .map(|obstacle| {
            let shape = Shape::new(obstacle.surface);
            items.next()?;
            Ok(shape)
        })
        .collect::<Result<Vec<Shape>, Interrupted>>()?;
    let prepared: Vec<ShapeObstacle> = obstacles
        .iter()
        .zip(&shapes)
        .map(|(obstacle, shape)| ShapeObstacle {
            shape,
            motion: obstacle.motion,
        })
        .collect();
    let seconds = clock.elapsed().as_secs_f64();
    let mut check = check_shapes(&body, motion, &prepared, settings)?;
    check.seconds[0].1 = seconds;
    Ok(check)
}

/// As [`check`], for shapes that were prepared before, to check them many times. Such a shape may
/// also be a half-space ([`Shape::half_space`]), which keeps its shape when it moves.
///
/// # Errors
/// As [`check`].
pub fn check_shapes(
    body: &Shape,
    motion: &Motion,
    obstacles: &[ShapeObstacle],
    settings: &CheckSettings,
) -> Result<Check, CheckError> {
    refuse(obstacles, settings)?;
    let chains = |obstacles: &[ShapeObstacle], settings: &CheckSettings| {
        check_chains(body, motion, obstacles, settings)
    };
    match deviating::check_deviating(body, motion, obstacles, settings, &chains)? {
        Some(check) => Ok(check),
        None => chains(obstacles, settings),
    }
}

/// The check of the chains of steady spans themselves.
fn check_chains(
    body: &Shape,
    motion: &Motion,
    obstacles: &[ShapeObstacle],
    settings: &CheckSettings,
) -> Result<Check, CheckError> {
    let watched = settings.watch.start();
    let work = watched.begin(CheckStage::Contact)?;
    let clock = Instant::now();
    let own = steady_stage::merged(motion, body);
    let theirs: Vec<Option<Merged<Motion>>> = obstacles
        .iter()
        .map(|obstacle| Some(steady_stage::merged(obstacle.motion?, obstacle.shape)))
        .collect();
    let stages = steady_stage::cut(
        &own,
        motion.joint_times(),
        theirs.iter().flatten().map(|their| &*their.motion),
    );
    let mut scene = Scene {
        body,
        obstacles,
        motions: &theirs,
        settings,
        body_movers: stages
            .iter()
            .map(|stage| stage.mover(body, Some(&own)))
            .collect(),
        stages,
        work,
    };
    scene.refuse_far()?;
    scene.refuse_depths()?;
    let verdict = entering::or_entered(&scene, first::verdict(&scene)?)?;
    let verdict = heights::or_met(&scene, verdict)?;
    let verdict = with_given_spans(verdict, &own, motion);
    let contact_seconds = clock.elapsed().as_secs_f64();
    let clock = Instant::now();
    if settings.measure == Measure::Distance {
        scene.work = watched.begin(CheckStage::Clearance)?;
    }
    let clearance = clearance::of(&scene, &verdict)?;
    let clearance_seconds = clock.elapsed().as_secs_f64();
    let clock = Instant::now();
    let (intervals, doubts) = if settings.all_intervals {
        scene.work = watched.begin(CheckStage::Intervals)?;
        let (intervals, doubts) = intervals::of(&scene)?;
        (Some(intervals), doubts)
    } else {
        (None, Vec::new())
    };
    let interval_seconds = clock.elapsed().as_secs_f64();
    // A search that was stopped has no answer.
    scene.work.check()?;
    Ok(Check {
        verdict,
        intervals,
        doubts,
        clearance,
        relative: scene.relative(),
        depths: (0..obstacles.len())
            .map(|number| scene.depth(number))
            .collect(),
        seconds: [
            (CheckStage::Prepare, 0.0),
            (CheckStage::Contact, contact_seconds),
            (CheckStage::Clearance, clearance_seconds),
            (CheckStage::Intervals, interval_seconds),
        ],
    })
}

/// The distance of a body from the obstacles at a `time` on the motion's clock, without those that
/// `rules` leaves out (empty: none).
///
/// # Cost
/// Some 10 microseconds for a thousand triangles. Prepare the shapes once for many times.
pub fn distance_at(
    body: &Shape,
    motion: &Motion,
    obstacles: &[ShapeObstacle],
    rules: &[ContactRule],
    time: f64,
) -> Closest {
    let mut best = Closest {
        distance: f64::INFINITY,
        obstacle: 0,
        points: [DVec3::ZERO; 2],
    };
    for (number, obstacle) in obstacles.iter().enumerate() {
        if rules.get(number) == Some(&ContactRule::Allowed) {
            continue;
        }
        let pose = obstacle
            .motion
            .map_or(DAffine3::IDENTITY, |motion| motion.pose_at_time(time));
        if let Some(plane) = obstacle.shape.plane() {
            let plane = plane.placed(&pose);
            let low = heights::lowest(body, &motion.pose_at_time(time), &plane);
            let distance = low.height.max(0.0);
            if distance < best.distance {
                best = Closest {
                    distance,
                    obstacle: number,
                    points: [low.place, low.place - low.height * plane.normal()],
                };
            }
            continue;
        }
        let still = Still {
            shapes: [body, obstacle.shape],
            poses: [motion.pose_at_time(time), pose],
            work: Work::UNWATCHED,
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

/// The same verdict, with the numbers of the spans of `motion` instead of those of its runs.
fn with_given_spans(mut verdict: Verdict, merged: &Merged<Motion>, motion: &Motion) -> Verdict {
    let (span, time) = match &mut verdict {
        Verdict::Clear => return verdict,
        Verdict::Contact(first) | Verdict::Closer(first) => (&mut first.span, first.time),
        Verdict::Undecided { span, window, .. } => (span, window[0]),
    };
    *span = steady_stage::given_span(merged, motion, *span, time);
    verdict
}

fn refuse(obstacles: &[ShapeObstacle], settings: &CheckSettings) -> Result<(), CheckError> {
    let clearance = settings.clearance;
    if !(clearance >= 0.0 && clearance.is_finite()) {
        return Err(CheckError::Clearance { clearance });
    }
    if obstacles.is_empty() {
        return Err(CheckError::NoObstacles);
    }
    let (found, expected) = (settings.rules.len(), obstacles.len());
    if found != 0 && found != expected {
        return Err(CheckError::Rules { found, expected });
    }
    Ok(())
}
