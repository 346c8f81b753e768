//! The swept region of a polygon.

mod filling;
mod groups;
mod lines;

use super::clock::Clock;
use super::reach::{reach, rounded_reach};
use super::refine::{Attempt, refined};
use super::{Bound, ErrorBound, Stage, deviation_of, target};
use crate::Fault;
use crate::body::Polygon;
use crate::bounds::rectangle_corners;
use crate::envelope::planar::{CycleError, CycleErrors, SweepCycle, cycle_as};
use crate::motion::planar::Motion;
use crate::motion::{MotionError, Pace};
use crate::numeric::Readable;
use crate::numeric::tolerance::{
    DEFAULT_TOLERANCE, LARGEST_COORDINATE, MOST_SEGMENTS, PLANAR_RESOLUTION, POSE_ROUNDING,
    PlanarBudget, UNIT_ROUNDOFF,
};
use crate::solid::planar::missed::NearRegion;
use crate::solid::planar::{
    Arrangement, ArrangementError, Curves, Measures, Outlines, Segment, unite,
};
use crate::watch::{Interrupted, Stop, Watch, Work};
use filling::{Filled, fill};
use glam::DVec2;
use groups::groups;
pub use lines::sweep_lines;
use std::sync::atomic::AtomicBool;

/// The settings of a sweep.
#[derive(Debug, Clone, Copy, Default)]
pub struct SweepSettings<'a> {
    /// Length by which the result may differ from the exact sweep of the polygon; `None`: 1e-3 of
    /// the diagonal of the body's bounding box at the start, or the smallest usable value where
    /// that is larger. Time steps, and with them time and memory, grow as 1 / sqrt(tolerance).
    pub tolerance: Option<f64>,
    watch: Watch<'a, Stage>,
}

impl<'a> SweepSettings<'a> {
    /// The same, with a tolerance; `None` for the default.
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: impl Into<Option<f64>>) -> Self {
        self.tolerance = tolerance.into();
        self
    }

    /// The same, with an observer of the stages and of the share of their work that is done, as
    /// [`crate::SweepSettings::with_observer`] tells it.
    #[must_use]
    pub fn with_observer(mut self, observer: &'a (dyn Fn(Stage, f64) + Sync)) -> Self {
        self.watch = self.watch.told_to(observer);
        self
    }

    /// The same, with a flag that stops the run: when another thread sets it to true, the run ends
    /// with [`SweepError::Interrupted`].
    #[must_use]
    pub fn with_interrupt(mut self, flag: &'a AtomicBool) -> Self {
        self.watch = self.watch.stopped_by(flag);
        self
    }
}

/// A swept region with its error bound.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Sweep {
    /// The faces between the curves, among which the region is marked; triangles of the region are
    /// made on request ([`Arrangement::region_triangles`]). For a body with many pieces, its curves
    /// are the boundaries of the regions that parts of the body sweep.
    pub arrangement: Arrangement,
    /// The boundary of the region, as vertices of the arrangement.
    pub outlines: Outlines,
    /// Area, perimeter, pieces, holes.
    pub measures: Measures,
    /// Bounds on the error of the region.
    pub error_bound: ErrorBound,
    /// The tolerance that was used.
    pub tolerance: f64,
    /// The paths of the grazing points, forwards in time.
    pub paths: Vec<Vec<DVec2>>,
    /// Number of segments of the arranged sweep cycle.
    pub cycle_segments: usize,
    /// Number of filled holes that the sampling had made.
    pub filled_pockets: usize,
    /// Number of attempts, each sampled more finely than the one before; the best one counts.
    pub attempts: usize,
    /// The duration of each stage in seconds, over all attempts.
    pub seconds: [(Stage, f64); 3],
}

impl Sweep {
    /// The corners of each loop of the boundary, with the region on its left: first the loops
    /// around pieces, then those around holes.
    pub fn loops(&self) -> impl Iterator<Item = Vec<DVec2>> + '_ {
        let positions = self.arrangement.positions();
        self.outlines.loops().map(|outline| {
            let corners = outline.vertices.iter();
            corners.map(|&corner| positions[corner as usize]).collect()
        })
    }
}

/// Why a sweep was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SweepError {
    /// The tolerance is no positive number.
    #[error(
        "tolerance {tolerance} is not a positive length; leave it out for 1e-3 of the body's size"
    )]
    Tolerance {
        /// The value as given.
        tolerance: f64,
    },
    /// The tolerance is lost in the rounding of coordinates.
    #[error(
        "tolerance {tolerance:e} is below what coordinates up to {} allow; move the part nearer to the origin; the smallest \
         usable value is {smallest:e}",
        Readable(*.reach)
    )]
    BelowRounding {
        /// The value as given.
        tolerance: f64,
        /// Largest coordinate during the motion.
        reach: f64,
        /// Smallest tolerance that is accepted.
        smallest: f64,
    },
    /// The motion takes the body too far.
    #[error(
        "the motion takes the body to coordinates of {reach:.1e}, beyond the limit of {LARGEST_COORDINATE:.0e}; \
         use a larger unit of length or a smaller motion"
    )]
    TooFar {
        /// Largest coordinate during the motion.
        reach: f64,
    },
    /// The motion does not fit the body.
    #[error(transparent)]
    Motion(MotionError),
    /// There are too many sampled paths.
    #[error(transparent)]
    Cycle(CycleError),
    /// Nothing is left of the body.
    #[error(
        "nothing is left of a body of size {} at a tolerance of {} and coordinates up to {}; \
         use a smaller tolerance, or move body and motion towards the origin",
        Readable(*.diagonal),
        Readable(*.tolerance),
        Readable(*.reach)
    )]
    Vanished {
        /// Diagonal of the body's box at the start.
        diagonal: f64,
        /// The tolerance that was used.
        tolerance: f64,
        /// Largest coordinate during the motion.
        reach: f64,
    },
    /// Lines sweep no area.
    #[error(
        "the lines sweep no area: they rest, or move along themselves; a region needs a motion across them"
    )]
    NoArea,
    /// The flag of [`SweepSettings::with_interrupt`] was set.
    #[error("interrupted")]
    Interrupted,
    /// An invariant does not hold.
    #[error(transparent)]
    Fault(#[from] Fault),
}

impl From<CycleError> for SweepError {
    fn from(error: CycleError) -> SweepError {
        match error {
            CycleError::Interrupted => SweepError::Interrupted,
            CycleError::TooLarge { .. } => SweepError::Cycle(error),
        }
    }
}

impl From<ArrangementError> for SweepError {
    fn from(error: ArrangementError) -> SweepError {
        match error {
            ArrangementError::Interrupted => SweepError::Interrupted,
            ArrangementError::Fault(fault) => SweepError::Fault(fault),
            _ => Fault::new("a closed cycle of finite points has no arrangement").into(),
        }
    }
}

impl From<Stop> for SweepError {
    fn from(stop: Stop) -> SweepError {
        match stop {
            Stop::Interrupted => SweepError::Interrupted,
            Stop::Fault(fault) => SweepError::Fault(fault),
        }
    }
}

impl From<Interrupted> for SweepError {
    fn from(_: Interrupted) -> SweepError {
        SweepError::Interrupted
    }
}

/// The region that `body` sweeps under `motion`.
///
/// - `body`: closed, in its own frame.
/// - `motion`: carries the frame of the body through the plane.
/// - `settings`: the tolerance, the observer of the stages, and the flag that stops the run.
///
/// # Guarantee
/// Both bounds are proven, up to the rounding of `f64`: no point of the exact sweep of the polygon
/// is farther than `error_bound.inside` from the result, and no point of the result is farther than
/// `error_bound.outside` from the exact sweep. The first bound is found afterwards, from the pieces
/// of curves that bound nothing in the result (see [`crate::envelope`]); where it exceeds the
/// tolerance, the curves are sampled more finely, up to sixteen times. The same input gives the
/// same bits for any number of threads.
///
/// # Errors
/// [`SweepError`]: a tolerance that cannot be used, a motion beyond the range of numbers, too many
/// segments, an interrupt, a fault.
///
/// # Cost
/// O(n log n) for the n = (changes of sign x time steps) segments of the sampled cycle, plus the
/// pairs of them that cross. The pieces of a body with many pieces are swept in groups of
/// neighbours, and the regions are united: crossings inside these regions are not searched for.
///
/// # Example
/// ```
/// use glam::DVec2;
/// use std::f64::consts::{FRAC_PI_2, PI};
/// use steadysweep::planar::{FillRule, Generator, Motion, Polygon, Span, SweepSettings, sweep};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1e-3]].map(DVec2::from_array);
/// let hand = Polygon::new(vec![corners.to_vec()], FillRule::EvenOdd)?;
/// let turn = Generator::spiral(DVec2::ZERO, FRAC_PI_2, 1.0);
/// let motion = Motion::from_spans(vec![Span::new(turn, 1.0)?])?;
///
/// let swept = sweep(&hand, &motion, &SweepSettings::default())?;
/// assert!((swept.measures.area - PI / 4.0).abs() < 1e-2, "a quarter of the disc");
/// assert!(swept.error_bound.inside.proven && swept.error_bound.inside.length < 1e-2);
/// # Ok(())
/// # }
/// ```
pub fn sweep(
    body: &Polygon,
    motion: &Motion,
    settings: &SweepSettings,
) -> Result<Sweep, SweepError> {
    let at_start = body.transformed(motion.start_pose());
    let subject = Subject {
        groups: groups(body, &at_start),
        body: Some(body),
        bounds: body.bounds(),
        twins: Vec::new(),
    };
    swept(&at_start, subject, motion, settings)
}

/// The region that a subject sweeps, whose outlines are `at_start` where the motion starts.
fn swept(
    at_start: &Polygon,
    subject: Subject,
    motion: &Motion,
    settings: &SweepSettings,
) -> Result<Sweep, SweepError> {
    let merged = motion.merged(&rectangle_corners(at_start.bounds()), Pace::Any);
    let places = at_start.positions().iter().map(|p| p.extend(0.0));
    let reach = reach(places.clone(), merged.motion.spans_in_space());
    if reach > LARGEST_COORDINATE {
        return Err(SweepError::TooFar { reach });
    }
    let [low, high] = subject.bounds.map(|corner| corner.extend(0.0));
    let followed = deviation_of(motion, [low, high]).map_err(SweepError::Motion)?;
    let smallest = PLANAR_RESOLUTION * reach;
    let diagonal = at_start.diagonal();
    let tolerance = usable_tolerance(settings, diagonal, reach, smallest)?;
    let is_body = subject.body.is_some();
    let prepared = Prepared {
        sliding: lines::sliding(at_start, &subject.twins, &merged.motion),
        subject,
        given: motion,
        motion: &merged.motion,
        deviation: merged.deviation + followed.length,
        reach: rounded_reach(places, merged.motion.spans_in_space()),
    };
    let mut clock = Clock::new(settings.watch);
    let at = |tolerance| attempt(&prepared, tolerance, &mut clock);
    let target = target(tolerance, &followed);
    let mut best = refined(tolerance, target, smallest, at, is_final)?;
    best.error_bound.as_proven_as(&followed);
    let found = best.found;
    if found.outlines.pieces.is_empty() && !is_body {
        return Err(SweepError::NoArea);
    }
    if found.outlines.pieces.is_empty() {
        return Err(SweepError::Vanished {
            diagonal,
            tolerance,
            reach,
        });
    }
    Ok(Sweep {
        arrangement: found.arrangement,
        outlines: found.outlines,
        measures: found.measures,
        error_bound: best.error_bound,
        tolerance,
        paths: found.paths,
        cycle_segments: found.cycle_segments,
        filled_pockets: found.filled_pockets,
        attempts: best.attempts,
        seconds: clock.seconds(),
    })
}

/// Whether an error of a finer attempt is one of the sweep.
fn is_final(error: &SweepError) -> bool {
    matches!(error, SweepError::Interrupted | SweepError::Fault(_))
}

/// What is swept.
struct Subject<'a> {
    /// Its outlines at the start of the motion, in groups.
    groups: Vec<Polygon>,
    /// The body; `None` for lines, of which no folds are dropped and no holes filled.
    body: Option<&'a Polygon>,
    /// The smallest box [min, max] around it in its own frame.
    bounds: [DVec2; 2],
    /// Of lines, for each edge the one that runs back along it.
    twins: Vec<u32>,
}

/// What all attempts at a sweep share.
struct Prepared<'a> {
    subject: Subject<'a>,
    /// Segments that are covered by edges that slide along themselves.
    sliding: Vec<[DVec2; 2]>,
    given: &'a Motion,
    /// The motion with merged spans, by which points may be off by `deviation`.
    motion: &'a Motion,
    deviation: f64,
    /// Largest number in the computation of a coordinate of the result.
    reach: f64,
}

/// The result at one tolerance.
struct Found {
    arrangement: Arrangement,
    outlines: Outlines,
    measures: Measures,
    paths: Vec<Vec<DVec2>>,
    cycle_segments: usize,
    filled_pockets: usize,
}

fn attempt(
    prepared: &Prepared,
    tolerance: f64,
    clock: &mut Clock,
) -> Result<Attempt<Found>, SweepError> {
    let Prepared {
        ref subject,
        ref sliding,
        given,
        motion,
        deviation,
        reach,
    } = *prepared;
    let work = clock.begin(Stage::Cycle)?;
    // At least half of the tolerance is left for sampling.
    let mut budget = PlanarBudget::of((tolerance - deviation).max(0.5 * tolerance));
    if subject.body.is_none() {
        budget.fold = 0.0;
    }
    let cycles = cycles(&subject.groups, motion, &budget, work)?;

    let work = clock.begin(Stage::Arrangement)?;
    let curves: Vec<Curves> = cycles.iter().map(curves_of).collect();
    let union = unite(&curves, work)?;
    let mut arrangement = union.arrangement;

    let work = clock.begin(Stage::Boundary)?;
    let [filling, measuring] = work.parts([1, 1]);
    let filled = match subject.body {
        Some(body) => fill(&mut arrangement, body, given, tolerance, filling)?,
        None => Filled::default(),
    };
    let outlines = arrangement.outlines();
    let measures = arrangement.measures(&outlines);
    let rounding = POSE_ROUNDING * UNIT_ROUNDOFF * reach + deviation + union.rounding;
    let slack = DISTANCE_SHARE * tolerance;
    let [idle, sliding] = [union.idle, sliding.clone()];
    let [of_curves, of_slides] = measuring.parts([1, 1]);
    let of_slides = gap(&arrangement, sliding, slack, of_slides)?;
    let gap = gap(&arrangement, idle, slack, of_curves)?.max(of_slides);
    Ok(Attempt {
        error_bound: error_bound(&worst_errors(&cycles), gap, filled.depth, rounding),
        // What slides out of the region stays as far from it.
        reducible: of_slides <= tolerance,
        found: Found {
            arrangement,
            outlines,
            measures,
            paths: cycles.iter().flat_map(places).collect(),
            cycle_segments: cycles.iter().map(|cycle| cycle.segments.len()).sum(),
            filled_pockets: filled.pockets,
        },
    })
}

/// The sweep cycle of each group.
fn cycles(
    groups: &[Polygon],
    motion: &Motion,
    budget: &PlanarBudget,
    work: Work,
) -> Result<Vec<SweepCycle>, SweepError> {
    let part = work.part(1, groups.len() as u64);
    let mut segments = 0;
    let mut cycles = Vec::with_capacity(groups.len());
    for group in groups {
        let cycle = cycle_as(group, motion, budget, part)?;
        cycle.check()?;
        segments += cycle.segments.len();
        if segments > MOST_SEGMENTS {
            let segments = segments as f64;
            return Err(CycleError::TooLarge { segments }.into());
        }
        cycles.push(cycle);
    }
    Ok(cycles)
}

fn curves_of(cycle: &SweepCycle) -> Curves {
    let segments = cycle.segments.iter().zip(&cycle.weights);
    Curves {
        points: cycle.points.clone(),
        segments: segments
            .map(|(&ends, &weight)| Segment { ends, weight })
            .collect(),
    }
}

/// The largest errors of each kind among some cycles: each group is off by no more, and so is their
/// union.
fn worst_errors(cycles: &[SweepCycle]) -> CycleErrors {
    let mut worst = CycleErrors::default();
    for errors in cycles.iter().map(|cycle| &cycle.errors) {
        worst.sampling = worst.sampling.max(errors.sampling);
        worst.dropped_fold = worst.dropped_fold.max(errors.dropped_fold);
        worst.shared = worst.shared.max(errors.shared);
        worst.steps = worst.steps.max(errors.steps);
    }
    worst
}

fn usable_tolerance(
    settings: &SweepSettings,
    diagonal: f64,
    reach: f64,
    smallest: f64,
) -> Result<f64, SweepError> {
    let Some(tolerance) = settings.tolerance else {
        let usual = DEFAULT_TOLERANCE * diagonal;
        if smallest > diagonal {
            // Nothing is left of a body that is smaller than the rounding.
            return Err(SweepError::BelowRounding {
                tolerance: usual,
                reach,
                smallest,
            });
        }
        return Ok(smallest.max(usual));
    };
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(SweepError::Tolerance { tolerance });
    }
    if tolerance < smallest {
        return Err(SweepError::BelowRounding {
            tolerance,
            reach,
            smallest,
        });
    }
    Ok(tolerance)
}

/// Accuracy of the distances in the error bounds, as a share of the tolerance.
const DISTANCE_SHARE: f64 = 0.05;

/// Bound on the distance from the region of the curves that bound nothing of it.
fn gap(
    arrangement: &Arrangement,
    idle: Vec<[DVec2; 2]>,
    slack: f64,
    work: Work,
) -> Result<f64, Interrupted> {
    if idle.is_empty() {
        return Ok(0.0);
    }
    let items = work.items(idle.len());
    let region = NearRegion::new(arrangement);
    idle.into_iter().try_fold(0.0, |known, ends| {
        items.next()?;
        Ok(region.farthest_of_segment(ends, known, slack))
    })
}

fn error_bound(errors: &CycleErrors, gap: f64, filled: f64, rounding: f64) -> ErrorBound {
    let proven = |length| Bound {
        length,
        proven: true,
    };
    ErrorBound {
        inside: proven(errors.sampling + errors.dropped_fold + gap + errors.shared + rounding),
        outside: proven(errors.sampling + filled + errors.shared + rounding),
    }
}

fn places(cycle: &SweepCycle) -> impl Iterator<Item = Vec<DVec2>> + '_ {
    let place = |path: &Vec<u32>| path.iter().map(|&p| cycle.points[p as usize]).collect();
    cycle.paths.iter().map(place)
}
