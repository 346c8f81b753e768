//! A moving body against surfaces that are at rest or move themselves: does it touch one, when
//! first, where, and how close does it come otherwise?
//!
//! # What counts as contact
//! Two surfaces are clear of each other while the distance of their triangles is *certified* above
//! the rounding of positions; what cannot be distinguished from touching is contact. A gap of 1e-9
//! of the size is clear, exact tangency is contact. Closed surfaces bound solids: one that contains
//! a part of the other is in contact with it, even at the start. Open ones are walls, and points may
//! be obstacles, too. A half-space is solid behind its plane.
//!
//! Rounding: the error of a position in a window of time is at most e = k u (1 + |M|) L. L is the
//! largest coordinate of the body, of its path up to that time and of the velocity field; k = 16
//! (`PATH_ROUNDING`): two products of affine maps (8), the exponential (4, growing with |M|), a
//! difference and a dot product (4). Distances are certified above the sum of the errors of both
//! sides; distances within three times that sum are contact (`CONTACT_ROUNDING`).
//!
//! An obstacle that may be touched ([`ContactRule::Enter`]) is in contact only where it is
//! *entered* deeper than a given depth (`entering`). The depth in a *closed* one is the greatest
//! distance from its surface of a point of the body inside it. An *open* one is entered where a
//! point of it lies inside the body; the depth is the distance of that point from the surface of
//! the body. The body then lies deeper than that on both sides of the sheet, which it does not
//! where it reaches over a rim or stands around the sheet. Nothing thinner than twice the depth is
//! entered, be it an obstacle or a needle that pierces a sheet.
//!
//! # How it is found
//! - Time is cut at the joints of all motions (`steady_stage`): in each piece everything moves
//!   steadily.
//! - Two trees of boxes descend together over windows of time, the earliest first (`search`,
//!   `window`). Boxes are aligned with the largest faces of their shape and move along tangents,
//!   with a bound on the deviation of paths from them.
//! - For two triangles, the planes of both trim the time first (`clip`).
//! - The rest is certified by moving planes (`separation`). In a short window every path is a
//!   polynomial to rounding (`chart`). So the height of every corner over a plane that follows the
//!   nearest features is one too, and is positive for a time that `roots` bounds from below. When
//!   this time ends, the nearest points are computed again: this is Newton's method from the safe
//!   side. Most pairs are already shown to be clear by paths of few terms, with the omitted terms
//!   added to rounding. There is no sampling, and no special case: parallel edges, sliding,
//!   tangency, triangles without area, clearances and two motions at once are all treated alike.
//! - Features that met certainly pass through each other, or only touch (`crossing`, `witness`);
//!   intervals follow what holds two triangles together (`presence`); the least distance is sought
//!   where boxes may come nearest (`least`).
//! - Where very many parts are always near each other, as in a bearing, the orbits of their points
//!   under a steady rigid motion are compared instead, for all times at once (`orbit`, `profile`).
//! - A body is certified to be nowhere deeper by pushing triangles out by the depth (`push`), and
//!   by one test at the start for the parts that the body contains (`engulfed`). It is certified to
//!   be deeper by the distance of a point that is inside (`sunk`, `depth`). Such points are
//!   followed until the depth is no longer exceeded (`following`, `dwelling`): both ends of these
//!   times are certified, and so are the times between two of them.
//! - Planes and half-spaces are met by vertices: the heights of vertices are polynomials in a short
//!   window as well (`heights`).
//!
//! A relative motion of two steady motions is not steady unless they commute. Nothing here requires
//! that: both paths are polynomials in every window.
//!
//! # Limits
//! - The work of one search is capped; beyond the cap the answer is undecided, and a least distance
//!   keeps a bound that is proven but not tight, and reports this.
//! - Contact that only touches or slides: its intervals are followed in steps, and an absence
//!   shorter than a step may be missed.
//! - At a tangency, rounding moves the time of contact by its square root.

mod chart;
mod check;
mod clearance;
mod clip;
mod commuting;
mod crossing;
mod deepest;
mod depth;
mod deviating;
mod distance;
mod dwelling;
mod encounter;
mod engulfed;
mod entering;
mod entry;
mod first;
mod following;
mod halfspace;
mod heights;
mod innermost;
mod intervals;
mod least;
mod mover;
mod moving_pair;
mod nearest;
mod orbit;
pub mod pair;
mod plane;
mod presence;
mod profile;
mod push;
mod ranked;
mod scene;
mod search;
mod separation;
mod shape;
mod sinking;
mod steady_stage;
mod sunk;
mod times;
mod triangle_piece;
mod window;
mod witness;

pub use check::{check, check_shapes, distance_at};
pub use heights::{Crossing, PlaneSettings, PlaneStage, PlanesError, Sense, Side, Which, planes};
pub use plane::{Plane, PlaneError};
pub use scene::ShapeObstacle;
pub use shape::Shape;

use crate::body::Surface;
use crate::motion::{Motion, MotionError};
use crate::numeric::tolerance::{CLEARANCE_PRECISION, LARGEST_COORDINATE};
use crate::watch::{Interrupted, Watch};
use glam::DVec3;
use std::sync::atomic::AtomicBool;

/// The settings of a check.
#[derive(Debug, Clone, Default)]
pub struct CheckSettings<'a> {
    /// Distance below which bodies are too close, in their unit; 0 for contact. It applies to the
    /// obstacles that must not be touched.
    pub clearance: f64,
    /// Whether to list all times of contact, not only the first.
    pub all_intervals: bool,
    /// Per obstacle, what counts as contact; empty when touching counts for all of them.
    pub rules: Vec<ContactRule>,
    /// Whether to measure the least distance over the whole motion when nothing is touched.
    pub measure: Measure,
    watch: Watch<'a, CheckStage>,
}

impl<'a> CheckSettings<'a> {
    /// The same, with a clearance to keep.
    #[must_use]
    pub fn with_clearance(mut self, clearance: f64) -> Self {
        self.clearance = clearance;
        self
    }

    /// The same, with all times of contact listed.
    #[must_use]
    pub fn with_all_intervals(mut self) -> Self {
        self.all_intervals = true;
        self
    }

    /// The same, with a rule for each obstacle.
    #[must_use]
    pub fn with_rules(mut self, rules: Vec<ContactRule>) -> Self {
        self.rules = rules;
        self
    }

    /// The same, with a choice of what to measure.
    #[must_use]
    pub fn with_measure(mut self, measure: Measure) -> Self {
        self.measure = measure;
        self
    }

    /// The same, with an observer of the stages and of the share of their work that is done, as
    /// [`SweepSettings::with_observer`](crate::SweepSettings::with_observer) tells it. A search
    /// that finds an answer early leaves the rest of its work undone.
    #[must_use]
    pub fn with_observer(mut self, observer: &'a (dyn Fn(CheckStage, f64) + Sync)) -> Self {
        self.watch = self.watch.told_to(observer);
        self
    }

    /// The same, with a flag that stops the run: when another thread sets it to true, the run ends
    /// with [`CheckError::Interrupted`].
    #[must_use]
    pub fn with_interrupt(mut self, flag: &'a AtomicBool) -> Self {
        self.watch = self.watch.stopped_by(flag);
        self
    }
}

/// What counts as contact with an obstacle.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum ContactRule {
    /// Touching counts.
    #[default]
    Touch,
    /// Entering it deeper than `depth` counts, a length; `None`: deeper than the least depth that
    /// rounding can tell from touching (`LEAST_DEPTH`). See the head of [this module](self).
    Enter {
        /// The greatest depth that does not count.
        depth: Option<f64>,
    },
    /// Nothing counts: the obstacle is left out.
    Allowed,
}

/// What is determined about the distance when nothing is touched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Measure {
    /// The least distance over the motion, and its place.
    #[default]
    Distance,
    /// Only the verdict, as fast as possible.
    Verdict,
}

/// An obstacle that the body may hit.
#[derive(Debug, Clone, Copy)]
pub struct Obstacle<'a> {
    /// Its surface, in the world or, if it moves, in its own frame.
    pub surface: &'a Surface,
    /// Its motion; `None` when it rests. Outside the time of its motion, it rests at the nearer
    /// end.
    pub motion: Option<&'a Motion>,
}

/// A stage of a check, in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum CheckStage {
    /// Building trees of boxes over the surfaces.
    Prepare,
    /// Searching for the first contact.
    Contact,
    /// Measuring the least distance.
    Clearance,
    /// Finding all times of contact.
    Intervals,
}

/// The answer to a check.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Check {
    /// The verdict.
    pub verdict: Verdict,
    /// All times of contact (or below the clearance), if they were asked for: by obstacle, then by
    /// time.
    pub intervals: Option<Vec<ContactInterval>>,
    /// The parts of intervals of entering that could not be decided: by obstacle, then by time.
    /// Empty where intervals were not asked for.
    pub doubts: Vec<Doubt>,
    /// How close the body comes to the obstacles that it must not touch.
    pub clearance: Clearance,
    /// Per obstacle, how the motion relative to it was treated.
    pub relative: Vec<RelativeMotion>,
    /// Per obstacle, the depth that does not count as contact; `None` where touching counts, or
    /// nothing does.
    pub depths: Vec<Option<f64>>,
    /// The duration of each stage in seconds.
    pub seconds: [(CheckStage, f64); 4],
}

/// The verdict of a check.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Verdict {
    /// Certainly no contact at any time.
    Clear,
    /// Contact.
    Contact(FirstContact),
    /// Certainly no contact before the distance falls below the clearance; this is the first time
    /// that it does.
    Closer(FirstContact),
    /// The limit on work was reached, or rounding decides. Certainly clear before the start of the
    /// window.
    Undecided {
        /// The window on the motion's clock.
        window: [f64; 2],
        /// Number of the span in which the window starts.
        span: usize,
        /// Number of the obstacle.
        obstacle: usize,
        /// What kept it from being decided.
        limited: Limited,
    },
}

/// The first time at which a body meets an obstacle, or comes too close to it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct FirstContact {
    /// The time on the motion's clock, within the bracket.
    pub time: f64,
    /// Certainly apart before the first of these times, and in contact, within rounding, at the
    /// second one.
    pub bracket: [f64; 2],
    /// Number of the span of the body's motion.
    pub span: usize,
    /// Number of the obstacle.
    pub obstacle: usize,
    /// The features of the body and of the obstacle; a half-space has one face, the plane.
    pub features: [Feature; 2],
    /// The kind of contact.
    pub touch: Touch,
    /// The place, in the world at that time, on the obstacle.
    pub point: DVec3,
    /// Unit vector from the obstacle to the body.
    pub normal: DVec3,
}

/// A part of a surface, by indices of vertices or of the triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Feature {
    /// A vertex.
    Vertex(u32),
    /// The open segment between two vertices, smaller index first.
    Edge([u32; 2]),
    /// The open triangle.
    Face(u32),
}

/// The kind of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Touch {
    /// They meet and part.
    Touch,
    /// They stay in contact without penetrating.
    Slide,
    /// They penetrate.
    Enter,
    /// They overlap at the start.
    Inside,
}

/// How close a body comes.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Clearance {
    /// Certain lower bound of the distance at all times; 0 on contact.
    pub lower: f64,
    /// The least distance seen; infinite when there is no obstacle to keep clear of, or no distance
    /// was measured.
    pub upper: f64,
    /// The time at which it was seen, on the motion's clock.
    pub time: f64,
    /// The obstacle to which it was seen.
    pub obstacle: usize,
    /// The nearest points of body and obstacle at that time.
    pub points: [DVec3; 2],
    /// Why `lower` is below `upper` by more than a thousandth of it; with [`Verdict::Undecided`],
    /// why nothing could be proven. `None` where `lower` is within that, and with other verdicts
    /// where no distance was measured.
    pub limited: Option<Limited>,
}

/// What kept a least distance from being proven to a thousandth of itself, or a depth from being
/// compared with the allowed one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Limited {
    /// The limit on work was reached: too many parts are about equally near, or the motion is too
    /// long.
    Work,
    /// The distance is so small that rounding exceeds a thousandth of it; or the depth equals the
    /// allowed one up to rounding.
    Rounding,
    /// The chain of steady spans may deviate from the motion that it stands for by more than that.
    Deviation,
}

impl Clearance {
    /// Whether `lower` is within a thousandth of `upper`, up to rounding.
    fn is_sharp(&self) -> bool {
        self.lower >= (1.0 - 1.1 * CLEARANCE_PRECISION) * self.upper
    }

    /// Takes into account a distance seen at a `time` on the motion's clock: `upper` is the least
    /// of all.
    pub fn see(&mut self, time: f64, seen: &Closest) {
        if seen.distance < self.upper {
            self.upper = seen.distance;
            self.time = time;
            self.obstacle = seen.obstacle;
            self.points = seen.points;
            self.lower = self.lower.min(self.upper);
            self.limited = self.limited.filter(|_| !self.is_sharp());
        }
    }
}

/// The distance of a body from the nearest obstacle at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closest {
    /// The distance; 0 in contact, and where one contains a part of the other. Infinite when all
    /// obstacles are left out.
    pub distance: f64,
    /// Number of the nearest obstacle.
    pub obstacle: usize,
    /// The nearest points of body and obstacle, in the world; where one is inside the other, those
    /// of their surfaces.
    pub points: [DVec3; 2],
}

/// A time of contact with an obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactInterval {
    /// Number of the obstacle.
    pub obstacle: usize,
    /// First and last time, on the motion's clock.
    pub times: [f64; 2],
}

/// A part of an interval during which it is undecided whether an obstacle is entered deeper than
/// allowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Doubt {
    /// Number of the obstacle.
    pub obstacle: usize,
    /// First and last time, on the motion's clock.
    pub times: [f64; 2],
    /// What kept it from being decided.
    pub limited: Limited,
}

/// How the motion of the body relative to an obstacle was treated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RelativeMotion {
    /// The obstacle rests: the body's motion is the relative one.
    AtRest,
    /// The two motions commute: their relative motion is exactly steady.
    Steady,
    /// The relative motion is not steady; the paths of both are bounded.
    Bounded,
}

/// Why a check was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CheckError {
    /// The clearance is not a valid distance.
    #[error("clearance {clearance} is not a length; use 0 for contact, or a positive length")]
    Clearance {
        /// The value as given.
        clearance: f64,
    },
    /// There is no obstacle to check against.
    #[error("there is no obstacle to check against; name at least one")]
    NoObstacles,
    /// The list of rules does not fit the obstacles.
    #[error(
        "{found} rules say what counts as contact, expected one for each of {expected} obstacles"
    )]
    Rules {
        /// Number of rules given.
        found: usize,
        /// Number of obstacles.
        expected: usize,
    },
    /// A depth is invalid, or below what rounding allows.
    #[error("a depth of {depth} cannot be told from touching; use {least:.1e} or more")]
    Depth {
        /// The value as given.
        depth: f64,
        /// Number of the obstacle.
        obstacle: usize,
        /// The smallest usable depth, with some margin for rounding it.
        least: f64,
    },
    /// A closed obstacle has a depth rule, but its motion does not preserve its shape.
    #[error(
        "the motion stretches it, and no depth in it can be certified; use a motion that only turns and moves it, or ask for \
         touching"
    )]
    Stretched {
        /// Number of the obstacle.
        obstacle: usize,
    },
    /// The motion of a half-space does not preserve distances.
    #[error(
        "the motion stretches it, and a half-space must keep its shape; use a motion that only turns and moves it"
    )]
    StretchedHalfSpace {
        /// Number of the obstacle.
        obstacle: usize,
    },
    /// The motion of a half-space is followed by a chain that deviates from it.
    #[error(
        "a half-space has no end, so that the deviation of its motion has no bound; give its motion by steady spans"
    )]
    DeviatingHalfSpace,
    /// The motion takes the body or an obstacle too far.
    #[error(
        "the motion takes a body to coordinates of {reach:.1e}, beyond the limit of {LARGEST_COORDINATE:.0e}; \
         use a larger unit of length or a smaller motion"
    )]
    TooFar {
        /// Largest coordinate during the motion.
        reach: f64,
    },
    /// The motion does not fit the body.
    #[error(transparent)]
    Motion(MotionError),
    /// The flag of [`CheckSettings::with_interrupt`] was set.
    #[error("interrupted")]
    Interrupted,
}

impl From<Interrupted> for CheckError {
    fn from(_: Interrupted) -> CheckError {
        CheckError::Interrupted
    }
}
