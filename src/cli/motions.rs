//! The motions that options give or name.

use std::error::Error;
use std::path::Path;

use super::options::{
    DescribeOptions, HalfTurnOption, MotionOptions, MotionSource, planar_single_span, single_span,
};
use crate::bounds::{OutlineTree, SurfaceTree};
use crate::io::{
    self, AnyMotion, Dimension, DrawingSettings, FittedKey, MotionFile, OutputError, ReadMotion,
};
use crate::motion::chain::{self, Steady};
use crate::motion::following::Follow;
use crate::motion::scheme::Scheme;
use crate::motion::steadiness::{self, Sample, Steadiness};
use crate::motion::{Flow, HalfTurns, Sense, planar};
use crate::numeric::tolerance::DEFAULT_TOLERANCE;
use glam::{DVec2, DVec3};

/// A motion as the options give or name it, before senses are assigned to its half turns and to
/// those of other motions, and before it is followed over a body.
pub(crate) enum GivenMotion<F: Steady> {
    /// One span.
    Span(Box<chain::Motion<F>>),
    /// From a file.
    File(Box<MotionFile<F>>),
}

impl<F: Steady> GivenMotion<F> {
    /// Number of its half turns.
    pub(crate) fn half_turns(&self) -> Result<usize, Box<dyn Error>> {
        Ok(match self {
            GivenMotion::Span(motion) => motion.half_turns(),
            GivenMotion::File(file) => file.half_turns()?,
        })
    }

    /// Whether it is followed over a body.
    pub(crate) fn is_followed(&self) -> bool {
        match self {
            GivenMotion::Span(_) => false,
            GivenMotion::File(file) => file.is_followed(),
        }
    }

    /// The motion of a body.
    ///
    /// - `follow`: points of the body, and the deviation where the file names none.
    pub(crate) fn over(
        self,
        half_turns: &HalfTurns,
        follow: &Follow<F::Point>,
    ) -> Result<chain::Motion<F>, Box<dyn Error>> {
        Ok(match self {
            GivenMotion::Span(motion) => motion.turning(half_turns)?,
            GivenMotion::File(file) => file.over(half_turns, follow)?,
        })
    }
}

/// The motion in the plane that the options give or name.
pub(crate) fn given_planar_motion_of(
    options: &MotionOptions,
) -> Result<GivenMotion<planar::Flow>, Box<dyn Error>> {
    Ok(match options.planar_source()? {
        MotionSource::File(path) => {
            let half_turns = options.half_turn.while_reading();
            GivenMotion::File(Box::new(io::read_planar_motion_file(&path, &half_turns)?))
        }
        MotionSource::Span(generator) => {
            GivenMotion::Span(Box::new(planar_single_span(generator)?))
        }
    })
}

/// The motion that the options give or name.
pub(crate) fn given_motion_of(
    options: &MotionOptions,
) -> Result<GivenMotion<Flow>, Box<dyn Error>> {
    Ok(match options.source()? {
        MotionSource::File(path) => {
            let half_turns = options.half_turn.while_reading();
            GivenMotion::File(Box::new(io::read_motion_file(&path, &half_turns)?))
        }
        MotionSource::Span(generator) => GivenMotion::Span(Box::new(single_span(generator)?)),
    })
}

/// A motion without others, with the senses of the option, of a body.
pub(crate) fn alone<F: Steady>(
    given: GivenMotion<F>,
    option: &HalfTurnOption,
    follow: &Follow<F::Point>,
) -> Result<chain::Motion<F>, Box<dyn Error>> {
    let half_turns = option.of_one(given.half_turns()?)?;
    given.over(&half_turns, follow)
}

/// A body to be followed within half of a tolerance.
///
/// - `tolerance`: `None` for the default.
pub(crate) fn follow<Point>(
    body: &[Point],
    diagonal: f64,
    tolerance: Option<f64>,
) -> Follow<'_, Point> {
    Follow {
        body,
        deviation: 0.5 * tolerance.unwrap_or(DEFAULT_TOLERANCE * diagonal),
    }
}

/// A motion to be described.
pub(crate) struct Described {
    pub(crate) motion: AnyMotion,
    /// What lies between its keyframes.
    pub(crate) scheme: Scheme,
    pub(crate) fitted: Vec<FittedKey>,
    /// How far it is from steady, over a body.
    pub(crate) steadiness: Option<Steadiness>,
}

/// Points along each axis of the box around a body, at which its steadiness is looked at.
const STEADINESS_CELLS: u32 = 12;

impl Described {
    fn steady(motion: AnyMotion) -> Described {
        Described {
            motion,
            scheme: Scheme::Steady,
            fitted: Vec::new(),
            steadiness: None,
        }
    }
}

/// The motion that the options of the command `motion` give or name: in the plane where the options
/// or the motion file say so.
pub(crate) fn described(options: &DescribeOptions) -> Result<Described, Box<dyn Error>> {
    let (motion, body) = (&options.motion, options.body.as_deref());
    let positive = HalfTurns::All(Sense::Positive);
    let file = match motion.dimension() {
        Dimension::Plane => match motion.planar_source()? {
            MotionSource::File(path) => path,
            MotionSource::Span(generator) => {
                let span = AnyMotion::Plane(planar_single_span(generator)?);
                return Ok(Described::steady(decided(span, &motion.half_turn)?));
            }
        },
        Dimension::Space => match motion.source()? {
            MotionSource::File(path) => path,
            MotionSource::Span(generator) => {
                let span = AnyMotion::Space(single_span(generator)?);
                return Ok(Described::steady(decided(span, &motion.half_turn)?));
            }
        },
    };
    match body {
        None => {
            let ReadMotion {
                motion: read,
                fitted,
            } = io::read_any_motion(&file, &positive)?;
            Ok(Described {
                fitted,
                ..Described::steady(decided(read, &motion.half_turn)?)
            })
        }
        Some(path) if io::drawing_format(path).is_some() => {
            let file = io::read_planar_motion_file(&file, &positive)?;
            let drawing = io::read_drawing(path, &DrawingSettings::default())?;
            let body = &drawing.polygon;
            let follow = follow(body.positions(), body.diagonal(), None);
            let tree = OutlineTree::new(body.positions(), &body.edges().collect::<Vec<_>>());
            let [low, high] = body.bounds();
            let samples = cells([low.x, low.y], [high.x, high.y])
                .map(DVec2::from_array)
                .filter(|&point| {
                    tree.winding_number(point)
                        .is_none_or(|winding| winding != 0)
                });
            let samples = weighted(samples);
            let (scheme, fitted) = (file.scheme(), file.fitted().to_vec());
            let (followed, steadiness) =
                described_over(&file, &motion.half_turn, &follow, &samples)?;
            Ok(Described {
                motion: AnyMotion::Plane(followed),
                scheme,
                fitted,
                steadiness,
            })
        }
        Some(path) => {
            let file = io::read_motion_file(&file, &positive)?;
            let (body, _) = io::read_body(path)?;
            let follow = follow(body.positions(), body.diagonal(), None);
            let tree = SurfaceTree::new(body.positions(), body.triangles());
            let [low, high] = body.bounds();
            let samples = cells(low.to_array(), high.to_array())
                .map(DVec3::from_array)
                .filter(|&point| {
                    tree.winding_number(point)
                        .is_none_or(|winding| winding != 0)
                });
            let samples = weighted(samples);
            let (scheme, fitted) = (file.scheme(), file.fitted().to_vec());
            let (followed, steadiness) =
                described_over(&file, &motion.half_turn, &follow, &samples)?;
            Ok(Described {
                motion: AnyMotion::Space(followed),
                scheme,
                fitted,
                steadiness,
            })
        }
    }
}

/// The motion of a file over a body, with the senses of the option; without it, half turns go in
/// the sense `+`. And how far it is from steady, where the body holds any of the samples.
fn described_over<F: Steady>(
    file: &MotionFile<F>,
    option: &HalfTurnOption,
    follow: &Follow<F::Point>,
    samples: &[Sample<F::Point>],
) -> Result<(chain::Motion<F>, Option<Steadiness>), Box<dyn Error>> {
    let half_turns = if option.is_none() {
        HalfTurns::All(Sense::Positive)
    } else {
        option.of_one(file.half_turns()?)?
    };
    let motion = file.over(&half_turns, follow)?;
    if samples.is_empty() {
        return Ok((motion, None));
    }
    let steadiness = steadiness::of_course(&file.course(&half_turns)?, samples)?;
    Ok((motion, Some(steadiness)))
}

/// The centres of equal cells of a box.
fn cells<const N: usize>(low: [f64; N], high: [f64; N]) -> impl Iterator<Item = [f64; N]> {
    let dimension = u32::try_from(N).unwrap_or(0);
    (0..STEADINESS_CELLS.pow(dimension)).map(move |cell| {
        let mut rest = cell;
        std::array::from_fn(|axis| {
            let share = (f64::from(rest % STEADINESS_CELLS) + 0.5) / f64::from(STEADINESS_CELLS);
            rest /= STEADINESS_CELLS;
            low[axis] + (high[axis] - low[axis]) * share
        })
    })
}

/// Points that count alike.
fn weighted<Point>(points: impl Iterator<Item = Point>) -> Vec<Sample<Point>> {
    points.map(|point| Sample { point, weight: 1.0 }).collect()
}

/// The motion with the senses of the option; without the option, half turns go in the sense `+`.
fn decided(motion: AnyMotion, option: &HalfTurnOption) -> Result<AnyMotion, Box<dyn Error>> {
    if option.is_none() {
        return Ok(motion);
    }
    Ok(match motion {
        AnyMotion::Plane(motion) => {
            let half_turns = option.of_one(motion.half_turns())?;
            AnyMotion::Plane(motion.turning(&half_turns)?)
        }
        AnyMotion::Space(motion) => {
            let half_turns = option.of_one(motion.half_turns())?;
            AnyMotion::Space(motion.turning(&half_turns)?)
        }
    })
}

/// Writes poses, evenly spaced in time from the start to the end, as a table that can be read as a
/// log of poses.
///
/// - `count`: 2 or more.
pub(crate) fn write_poses(motion: &AnyMotion, count: u32, path: &Path) -> Result<(), OutputError> {
    match motion {
        AnyMotion::Space(motion) => {
            let columns = [
                "time", "m11", "m12", "m13", "m14", "m21", "m22", "m23", "m24", "m31", "m32",
                "m33", "m34",
            ];
            let rows = times(motion.joint_times(), count).map(|time| {
                let pose = motion.pose_at_time(time);
                let mut numbers = [time; 13];
                for row in 0..3 {
                    let [x, y, z] = pose.matrix3.row(row).to_array();
                    let place = pose.translation[row];
                    numbers[1 + 4 * row..5 + 4 * row].copy_from_slice(&[x, y, z, place]);
                }
                numbers.map(|number| format!("{number:?}"))
            });
            io::write_table(path, columns, rows)
        }
        AnyMotion::Plane(motion) => {
            let columns = ["time", "m11", "m12", "m13", "m21", "m22", "m23"];
            let rows = times(motion.joint_times(), count).map(|time| {
                let pose = motion.pose_at_time(time);
                let [first, second] = [0, 1].map(|row| pose.matrix2.row(row));
                let [x, y] = pose.translation.to_array();
                let numbers = [time, first.x, first.y, x, second.x, second.y, y];
                numbers.map(|number| format!("{number:?}"))
            });
            io::write_table(path, columns, rows)
        }
    }
}

/// Times evenly spaced from the first joint to the last, both exactly.
fn times(joints: &[f64], count: u32) -> impl Iterator<Item = f64> {
    let [start, end] = [joints[0], joints[joints.len() - 1]];
    let last = f64::from(count - 1);
    (0..count).map(move |k| match f64::from(k) / last {
        1.0 => end,
        share => start + (end - start) * share,
    })
}
