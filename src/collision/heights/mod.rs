//! The heights of a moving body over planes: when its vertices cross them.
//!
//! A half-space is convex, and the distance from it is linear where it is not 0. So the vertices of
//! a body decide all about it: the body meets the half-space when its first vertex does.
//!
//! # How it is found
//! - Time is cut at the joints of the motion, and further into windows in which every height is a
//!   polynomial to rounding (`window`).
//! - The tree of boxes of the body is descended (`timeline`). A box keeps those windows of the one
//!   above it in which the space that it sweeps meets the plane; boxes without any are not opened.
//! - For a vertex, the zeros of the polynomials are isolated by bounds, never by sampling
//!   (`numeric::roots`), and those of adjacent windows are joined.

mod half_space;
mod least;
mod lowest;
mod timeline;
mod window;

pub(super) use half_space::{intervals, or_met};
pub(super) use least::see_least;
pub(super) use lowest::lowest;

use super::mover::Mover;
use super::plane::Plane;
use super::shape::Shape;
use super::steady_stage;
use crate::body::Surface;
use crate::motion::{Motion, MotionError};
use crate::numeric::tolerance::LARGEST_COORDINATE;
use crate::watch::{Interrupted, Watch};
use glam::{DAffine3, DVec3};
use std::sync::atomic::AtomicBool;
use timeline::{Sided, Timeline};

/// The settings of [`planes`].
#[derive(Debug, Clone, Default)]
pub struct PlaneSettings<'a> {
    /// Which crossings are listed.
    pub which: Which,
    watch: Watch<'a, PlaneStage>,
}

impl<'a> PlaneSettings<'a> {
    /// The same, with only the first crossing of each plane.
    #[must_use]
    pub fn with_first_only(mut self) -> Self {
        self.which = Which::First;
        self
    }

    /// The same, with an observer of the stages and of the share of their work that is done; see
    /// [`CheckSettings::with_observer`](super::CheckSettings::with_observer).
    #[must_use]
    pub fn with_observer(mut self, observer: &'a (dyn Fn(PlaneStage, f64) + Sync)) -> Self {
        self.watch = self.watch.told_to(observer);
        self
    }

    /// The same, with a flag that stops the run: when another thread sets it to true, the run ends
    /// with [`PlanesError::Interrupted`].
    #[must_use]
    pub fn with_interrupt(mut self, flag: &'a AtomicBool) -> Self {
        self.watch = self.watch.stopped_by(flag);
        self
    }
}

/// Which crossings are listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Which {
    /// All of them.
    #[default]
    All,
    /// The first one of each plane.
    First,
}

/// A stage of [`planes`], in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PlaneStage {
    /// Building the tree of boxes over the surface.
    Prepare,
    /// Searching for crossings.
    Search,
}

/// A vertex in a plane: a time at which it crosses it, touches it, or during which it stays in it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Crossing {
    /// Number of the plane.
    pub plane: usize,
    /// The vertex.
    pub vertex: u32,
    /// Number of the span of the motion.
    pub span: usize,
    /// The time on the motion's clock at which it meets the plane, within the bracket.
    pub time: f64,
    /// The vertex is certainly not in the plane right before the first and right after the last of
    /// these times; between them it is, to rounding, or cannot be told from it. They are far apart
    /// only where the vertex stays in the plane, or nearly touches it.
    pub bracket: [f64; 2],
    /// The sides of the plane on which it certainly is before and after the bracket; `None` where
    /// the motion starts or ends in it.
    pub sides: [Option<Side>; 2],
    /// The place of the vertex in the world at that time.
    pub point: DVec3,
}

/// A side of a plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// That of the normal.
    Front,
    /// The solid one.
    Behind,
}

/// What a crossing means for the half-space behind the plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sense {
    /// The vertex enters the half-space, from the front or from the plane where it starts.
    Enter,
    /// The vertex leaves the half-space, or the plane where it starts, to the front.
    Leave,
    /// It comes back to its side, or is still in the plane at the end.
    Touch,
}

impl Crossing {
    /// What it means for the half-space behind the plane.
    pub fn sense(&self) -> Sense {
        match self.sides {
            [Some(before), Some(after)] if before == after => Sense::Touch,
            [_, Some(Side::Behind)] => Sense::Enter,
            [_, Some(Side::Front)] => Sense::Leave,
            [_, None] => Sense::Touch,
        }
    }
}

/// Why crossings of planes were not searched.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanesError {
    /// The motion takes the surface too far.
    #[error(
        "the motion takes the surface to coordinates of {reach:.1e}, beyond the limit of {LARGEST_COORDINATE:.0e}; \
         use a larger unit of length or a smaller motion"
    )]
    TooFar {
        /// Largest coordinate during the motion.
        reach: f64,
    },
    /// The motion does not fit the surface.
    #[error(transparent)]
    Motion(MotionError),
    /// The motion is followed by a chain whose deviation from it is only an estimate.
    #[error(
        "how far the chain of spans deviates from the motion is not proven, so that no crossing is certain"
    )]
    Estimated,
    /// The motion is too long to be searched as a whole.
    #[error(
        "the motion is too long to be searched at once, as one of some thousand turns is; cut it into several"
    )]
    TooLong,
    /// The flag of [`PlaneSettings::with_interrupt`] was set.
    #[error("interrupted")]
    Interrupted,
}

impl From<Interrupted> for PlanesError {
    fn from(_: Interrupted) -> PlanesError {
        PlanesError::Interrupted
    }
}

/// What the motion may be off by, proven.
fn deviation_of(motion: &Motion, shape: &Shape) -> Result<f64, PlanesError> {
    let deviation = motion.deviation_over(shape.bounds());
    match deviation.map_err(PlanesError::Motion)? {
        None => Ok(0.0),
        Some(deviation) if deviation.proven => Ok(deviation.length),
        Some(_) => Err(PlanesError::Estimated),
    }
}

/// All times at which vertices of a moving surface are in planes at rest, in the order of time.
///
/// - `surface`: in its own frame, carried by `motion`; vertices that no triangle has do not count.
/// - `settings`: which crossings are listed, the observer, and the flag that stops the run.
///
/// # Guarantee
/// Proven, rounding included: every vertex is certainly on one side of a plane between its
/// brackets, on the one that they name. Crossings that rounding cannot tell apart have one bracket
/// together, and so have those that the deviation of a followed motion ([`Motion::deviation`]) may
/// join. In order of time, then of plane, then of vertex; the same for any number of threads.
///
/// # Errors
/// [`PlanesError`]: a motion beyond the range of coordinates, or of more than two thousand turns.
///
/// # Cost
/// Some microseconds for each vertex in each window in which it meets a plane; a turn has 45
/// windows, and boxes of many vertices that do not meet the plane in a window are left out
/// together.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use steadysweep::body::Surface;
/// use steadysweep::collision::{Plane, PlaneSettings, Sense, planes};
/// use steadysweep::motion::{Generator, Motion, Span};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let corners = [[0.0, 0.0, 1.0], [1.0, 0.0, 2.0], [0.0, 1.0, 3.0]].map(DVec3::from_array);
/// let surface = Surface::new(corners.to_vec(), vec![[0, 1, 2]])?;
/// let down = Generator::translation(-4.0 * DVec3::Z);
/// let motion = Motion::from_spans(vec![Span::new(down, 1.0)?])?;
///
/// let floor = Plane::new(DVec3::ZERO, DVec3::Z)?;
/// let found = planes(&surface, &motion, &[floor], &PlaneSettings::default())?;
/// let vertices: Vec<u32> = found.iter().map(|crossing| crossing.vertex).collect();
/// assert_eq!(vertices, [0, 1, 2]);
/// assert_eq!(found[1].sense(), Sense::Enter);
/// let [before, after] = found[1].bracket;
/// assert!(before <= 0.5 && 0.5 <= after && after - before < 1e-13);
/// # Ok(())
/// # }
/// ```
pub fn planes(
    surface: &Surface,
    motion: &Motion,
    planes: &[Plane],
    settings: &PlaneSettings,
) -> Result<Vec<Crossing>, PlanesError> {
    let watched = settings.watch.start();
    watched.begin(PlaneStage::Prepare)?;
    let shape = Shape::new(surface);
    let items = watched.begin(PlaneStage::Search)?.items(planes.len());
    let merged = steady_stage::merged(motion, &shape);
    let stages = steady_stage::cut(&merged, motion.joint_times(), std::iter::empty());
    let deviation = deviation_of(motion, &shape)?;
    let movers: Vec<_> = stages
        .iter()
        .map(|stage| stage.mover(&shape, Some(&merged)))
        .map(|mover| mover.deviating(merged.deviation + deviation))
        .collect();
    let reach = steady_stage::reach(movers.iter());
    if reach > LARGEST_COORDINATE {
        return Err(PlanesError::TooFar { reach });
    }
    let mut all = Vec::new();
    for (number, plane) in planes.iter().enumerate() {
        let movers = |stage: usize| {
            [
                movers[stage].clone(),
                Mover::resting(DAffine3::IDENTITY, [plane.point(); 2]),
            ]
        };
        let timeline =
            Timeline::new(&shape, &stages, movers, plane, 0.0).ok_or(PlanesError::TooLong)?;
        let work = watched.more();
        let found = match settings.which {
            Which::All => timeline.sided(timeline.windows.len(), work)?,
            Which::First => {
                let first = timeline.first(|sided| Some(sided.stay.times[0]), work)?;
                first.into_iter().map(|(sided, _)| sided).collect()
            }
        };
        all.extend(found.into_iter().map(|Sided { stay, sides }| {
            let [time, _] = stay.times;
            let pose = motion.pose_at_time(time);
            Crossing {
                plane: number,
                vertex: stay.vertex,
                span: steady_stage::given_span(&merged, motion, stages[stay.stage].span, time),
                time,
                bracket: stay.bracket,
                sides,
                point: pose.transform_point3(stay.position),
            }
        }));
        items.next()?;
    }
    all.sort_by(|a, b| {
        let places = (a.plane, a.vertex).cmp(&(b.plane, b.vertex));
        a.time.total_cmp(&b.time).then(places)
    });
    Ok(all)
}
