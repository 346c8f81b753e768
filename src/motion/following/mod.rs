//! Any motion as a chain of steady spans, within a length over the body.
//!
//! A motion by a [`Scheme`](super::scheme::Scheme) other than the steady one, a recorded path of many poses, or a function
//! of time is not steady. It is *followed* by a chain that is: at every time, every point of the
//! body is within the [`Deviation`] of its place. The chain meets the given motion at its joints.
//!
//! # How many spans it takes
//! With W = A^-1 A', the velocity field of a motion A in the frame of the body, a point x of the
//! body is off the steady motion that joins the ends of a short span of time h by h^2 / 8 |A W' x|,
//! to first order: W' = 0 is a steady motion. So m even spans deviate by max |A W' x| / (8 m^2), and
//! the joints are placed where the integral of the root of |A W' x| is even. SAM measures
//! unsteadiness by the mean of |A W' x| (its "average relative acceleration", 2.4); here the largest
//! counts.
//!
//! # Proof and estimate
//! The deviation of a scheme and of a recorded path is proven, rounding included (`gap`). A path is
//! steady between its poses, as [`Motion::from_keyframes`](super::Motion::from_keyframes) has it.
//! Polar factors and logarithms are those that f64 finds, a few roundings from the exact ones. Of a
//! function only values are known. The deviation from it is an estimate: twice the largest distance
//! at 16 times in every span.

mod gap;

use super::Deviation;
use super::chain::{Keyframe, Logarithm, Motion, Steady};
use super::half_turn::Decisions;
use super::scheme::{Course, Keyed, rotation_vector};
use super::{Flow, Generator, HalfTurns, MotionError, Sense};
use crate::numeric::tolerance::FOLLOWED_ROUNDING;
use gap::{Chord, Gap, Part, gap};
use glam::{DAffine3, DVec3};
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::ops::Range;

/// Room that the plan of a chain leaves for what the law of short spans does not see.
const PLAN_MARGIN: f64 = 1.03;
/// Most halvings of a span that does not fit.
const MOST_HALVINGS: u32 = 40;
/// Times in every span at which a function is compared with the chain.
const SAMPLES: u32 = 16;
/// Most probes of a piece when the chain is planned.
const MOST_PROBES: u32 = 1 << 14;
/// Points up to which all count; of more, the corners of a box around them.
const FEW_POINTS: usize = 32;

/// A length within which a motion is followed, over a body.
#[derive(Debug, Clone, Copy)]
pub struct Follow<'a, Point> {
    /// Points of the body, in its frame: the deviation holds for their convex hull. Of more than 32,
    /// it holds for the box around them.
    pub body: &'a [Point],
    /// Largest deviation, a length above 0.
    pub deviation: f64,
}

/// The motion of a scheme through keyframes, followed by steady spans.
///
/// Where the scheme is steady, consecutive spans are joined where the deviation allows it; without
/// the need to join any, [`Motion::from_keyframes_with_turns`] gives the same motion, exactly.
///
/// # Errors
/// Those of [`Motion::from_keyframes_with_turns`], [`MotionError::Flattened`],
/// [`MotionError::HalfTurnOfPose`] and [`MotionError::DeviationTooSmall`].
///
/// # Example
/// ```
/// use glam::{DAffine3, DQuat, DVec3};
/// use steadysweep::motion::following::{Follow, keyframes};
/// use steadysweep::motion::scheme::{Keyed, Scheme};
/// use steadysweep::motion::{HalfTurns, Keyframe, Motion};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // A quarter turn while the origin moves along a straight line, as animation programs do it.
/// let pose = DAffine3::from_rotation_translation(DQuat::from_rotation_z(1.57), 4.0 * DVec3::X);
/// let keys = [(0.0, DAffine3::IDENTITY), (1.0, pose)].map(|(time, pose)| Keyframe { time, pose });
/// let body = [DVec3::ZERO, DVec3::X, DVec3::Y];
/// let follow = Follow { body: &body, deviation: 1e-3 };
/// let polar = Keyed::new(Scheme::Polar, &keys);
/// let motion: Motion = keyframes(&polar, &HalfTurns::Refused, &follow)?;
///
/// let deviation = motion.deviation().ok_or("it stands for another motion")?;
/// assert!(deviation.proven && deviation.length <= 1e-3);
/// let middle = motion.pose_at_time(0.5).transform_point3(DVec3::ZERO);
/// assert!(middle.distance(2.0 * DVec3::X) <= deviation.length);
/// # Ok(())
/// # }
/// ```
pub fn keyframes<F: Steady>(
    keyed: &Keyed<F::Pose>,
    half_turns: &HalfTurns,
    follow: &Follow<F::Point>,
) -> Result<Motion<F>, MotionError> {
    let course = Course::new(keyed, half_turns)?;
    followed(&course, &Body::new::<F>(follow.body), follow.deviation)
}

/// Number of half turns in a motion by a scheme, whose senses are to be chosen.
///
/// # Errors
/// Those of [`keyframes`] that no choice of senses changes.
pub fn half_turns<F: Steady>(keyed: &Keyed<F::Pose>) -> Result<usize, MotionError> {
    let positive = HalfTurns::All(Sense::Positive);
    let mut decisions = Decisions::new(&positive);
    Course::<F>::deciding(keyed, &mut decisions)?;
    Ok(decisions.count())
}

/// A chain of steady spans with as few of them as a deviation allows, such as a recorded path of
/// ten thousand poses. A recorded screw becomes one span.
///
/// # Errors
/// [`MotionError::DeviationTooSmall`].
///
/// # Cost
/// Some microseconds per span.
pub fn thinned<F: Steady>(
    motion: &Motion<F>,
    follow: &Follow<F::Point>,
) -> Result<Motion<F>, MotionError> {
    let course = Course::of_chain(motion);
    followed(&course, &Body::new::<F>(follow.body), follow.deviation)
}

/// A function of time, followed by steady spans. The deviation is an estimate, since nothing but
/// values of the function is known.
///
/// - `pose`: body to world at a time.
/// - `times`: start and end.
///
/// # Errors
/// Those of [`Motion::from_keyframes`], [`MotionError::Flattened`] and
/// [`MotionError::DeviationTooSmall`].
pub fn function<F: Steady>(
    pose: impl Fn(f64) -> F::Pose,
    times: [f64; 2],
    follow: &Follow<F::Point>,
) -> Result<Motion<F>, MotionError> {
    let ends = times.map(|time| Keyframe {
        time,
        pose: pose(time),
    });
    super::chain::check_keys::<F>(&ends)?;
    let body = Body::new::<F>(follow.body);
    let in_space = ends.map(|key| F::pose_in_space(&key.pose));
    check_deviation(follow.deviation, &body, &in_space)?;
    let [start, end] = times;
    let time_at = |u: f64| {
        if u == 1.0 {
            end
        } else {
            start + (end - start) * u
        }
    };
    let pose_at = |u: f64| F::pose_in_space(&pose(time_at(u)));
    let measure = |[from, to]: [f64; 2], chord: &Chord| {
        let mut found = Gap {
            length: 0.0,
            share: 0.0,
        };
        for sample in 1..SAMPLES {
            let share = f64::from(sample) / f64::from(SAMPLES);
            let given = pose_at(from + (to - from) * share);
            let length = 2.0 * chord.distance(&given, share, &body.points);
            if length > follow.deviation || length.is_nan() {
                return None;
            }
            if length > found.length {
                found = Gap { length, share };
            }
        }
        Some(found)
    };
    let spans = split::<F>(&pose_at, &measure, &body, follow.deviation, SAMPLES)
        .map_err(|u| MotionError::Flattened { time: time_at(u) }.between_keyframes(0))?;
    let keys = spans.iter().map(|span| span.u[0]).chain([1.0]);
    let keys: Vec<Keyframe<F::Pose>> = keys
        .map(|u| {
            let time = time_at(u);
            Keyframe {
                time,
                pose: pose(time),
            }
        })
        .collect();
    assemble(&keys, spans, &body, follow.deviation, false)
}

/// Points whose convex hull contains the body.
struct Body {
    points: Vec<DVec3>,
    within: [DVec3; 2],
}

impl Body {
    fn new<F: Steady>(body: &[F::Point]) -> Body {
        let points: Vec<DVec3> = body.iter().map(|&p| F::point_in_space(p)).collect();
        let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let within = [low, high];
        if points.len() <= FEW_POINTS {
            return Body { points, within };
        }
        let corner = |i: usize| {
            let side = |axis: usize| within[i >> axis & 1][axis];
            DVec3::new(side(0), side(1), side(2))
        };
        let corners = if low.z == high.z { 4 } else { 8 };
        Body {
            points: (0..corners).map(corner).collect(),
            within,
        }
    }
}

/// One span of a chain that follows a piece.
struct Found<F: Steady> {
    u: [f64; 2],
    steady: Logarithm<F>,
    gap: Gap,
}

/// A course followed within a deviation.
fn followed<F: Steady>(
    course: &Course<F>,
    body: &Body,
    deviation: f64,
) -> Result<Motion<F>, MotionError> {
    let poses: Vec<DAffine3> = course
        .keys
        .iter()
        .map(|key| F::pose_in_space(&key.pose))
        .collect();
    check_deviation(deviation, body, &poses)?;
    let times = |piece: usize| [course.keys[piece].time, course.keys[piece + 1].time];
    let split_pieces = (0..course.pieces.len())
        .into_par_iter()
        .map(|number| {
            let piece = &course.pieces[number];
            if let Some(steady) = &course.steady[number] {
                let gap = Gap {
                    length: 0.0,
                    share: 0.0,
                };
                let steady = steady.clone();
                return Ok(vec![Found {
                    u: [0.0, 1.0],
                    steady,
                    gap,
                }]);
            }
            let pose_at = |u: f64| match u {
                0.0 => poses[number],
                1.0 => poses[number + 1],
                _ => piece.pose_at(u),
            };
            let measure = |u: [f64; 2], chord: &Chord| {
                let part = Part {
                    piece,
                    u,
                    share: [0.0, 1.0],
                };
                gap(std::iter::once(part), chord, &body.points, deviation)
            };
            split::<F>(&pose_at, &measure, body, deviation, 4).map_err(|u| {
                let [start, end] = times(number);
                let time = start + (end - start) * u;
                MotionError::Flattened { time }.between_keyframes(number)
            })
        })
        .collect::<Result<Vec<Vec<Found<F>>>, MotionError>>()?;
    let (mut keys, mut spans) = (Vec::new(), Vec::new());
    let mut first = 0;
    let mut pieces = split_pieces.into_iter();
    let counts: Vec<usize> = pieces.as_slice().iter().map(Vec::len).collect();
    // Where the pieces end that follow a piece without being split.
    let mut ends = vec![counts.len(); counts.len()];
    for piece in (0..counts.len()).rev() {
        ends[piece] = match counts[piece] {
            1 => *ends.get(piece + 1).unwrap_or(&counts.len()),
            _ => piece,
        };
    }
    while first < counts.len() {
        let (length, joined) = longest_run(course, &poses, first..ends[first], body, deviation);
        let found = pieces.next().unwrap_or_default();
        if let Some(joined) = joined {
            pieces.by_ref().take(length - 1).for_each(drop);
            keys.push(course.keys[first]);
            spans.push(joined);
            first += length;
            continue;
        }
        let [start, end] = times(first);
        for span in found {
            keys.push(if span.u[0] == 0.0 {
                course.keys[first]
            } else {
                Keyframe {
                    time: start + (end - start) * span.u[0],
                    pose: F::pose_of_space(&course.pieces[first].pose_at(span.u[0])),
                }
            });
            spans.push(span);
        }
        first += 1;
    }
    keys.extend(course.keys.last());
    assemble(&keys, spans, body, deviation, true)
}

/// The longest run of pieces from the first one on that one span follows, and this span; `None` for
/// a single piece.
fn longest_run<F: Steady>(
    course: &Course<F>,
    poses: &[DAffine3],
    pieces: Range<usize>,
    body: &Body,
    deviation: f64,
) -> (usize, Option<Found<F>>) {
    let (mut fits, mut joined) = (1, None);
    let mut too_long = pieces.len() + 1;
    let mut next = 2;
    while fits + 1 < too_long {
        let run = pieces.start..pieces.start + next;
        match as_one(course, poses, run, body, deviation) {
            Some(found) => (fits, joined) = (next, Some(found)),
            None => too_long = next,
        }
        next = (2 * fits).min((fits + too_long) / 2);
    }
    (fits, joined)
}

/// A run of pieces as one span, if that deviates little enough.
fn as_one<F: Steady>(
    course: &Course<F>,
    poses: &[DAffine3],
    run: Range<usize>,
    body: &Body,
    deviation: f64,
) -> Option<Found<F>> {
    let ends = [run.start, run.end].map(|key| &course.keys[key]);
    let steady = joining(course, &run)?;
    let flow = Flow::new(steady.flow.generator_in_space());
    let chord = Chord {
        flow: &flow,
        start: &poses[run.start],
    };
    let share = |key: usize| {
        let [start, end] = ends.map(|key| key.time);
        (course.keys[key].time - start) / (end - start)
    };
    // Keyframes alone refuse most of the runs that are too long.
    let step = (run.len() / 8).max(1);
    for key in run.clone().skip(1).step_by(step) {
        if chord.distance(&poses[key], share(key), &body.points) > deviation {
            return None;
        }
    }
    let parts = run.map(|piece| Part {
        piece: &course.pieces[piece],
        u: [0.0, 1.0],
        share: [share(piece), share(piece + 1)],
    });
    let gap = gap(parts, &chord, &body.points, deviation)?;
    Some(Found {
        u: [0.0, 1.0],
        steady,
        gap,
    })
}

/// The steady motion from the start of a run to its end that turns as often as the run does; `None`
/// where there is none.
fn joining<F: Steady>(course: &Course<F>, run: &Range<usize>) -> Option<Logarithm<F>> {
    let [from, to] = [run.start, run.end].map(|key| &course.keys[key].pose);
    let shorter = F::between(from, to, None, 0).ok();
    // A recorded screw is the sum of its spans.
    let mut sum = Generator::translation(DVec3::ZERO);
    for steady in &course.steady[run.clone()] {
        let Some(steady) = steady else {
            return shorter.filter(Logarithm::unique);
        };
        let generator = steady.flow.generator_in_space();
        sum.linear += generator.linear;
        sum.offset += generator.offset;
    }
    let turns = |shorter: &Logarithm<F>| {
        let [found, whole] = [shorter.flow.generator_in_space(), sum]
            .map(|generator| rotation_vector(&generator.linear));
        F::sense_axis(found).map_or(0.0, |axis| ((whole - found).dot(axis) / TAU).round())
    };
    #[expect(clippy::cast_possible_truncation, reason = "a whole number of turns")]
    let exact = shorter.and_then(|shorter| match turns(&shorter) as i32 {
        0 => Some(shorter).filter(Logarithm::unique),
        turns => F::between(from, to, None, turns).ok(),
    });
    exact.or_else(|| Some(F::of_generator_in_space(&sum).into()))
}

/// Spans that follow a smooth motion within a deviation; or a place where none does.
///
/// - `pose_at`: for u in [0, 1]. `measure`: the gap of a span; `None` where it is too large.
/// - `probes`: the least number of probes.
fn split<F: Steady>(
    pose_at: &dyn Fn(f64) -> DAffine3,
    measure: &dyn Fn([f64; 2], &Chord) -> Option<Gap>,
    body: &Body,
    deviation: f64,
    probes: u32,
) -> Result<Vec<Found<F>>, f64> {
    let mut spans = Vec::new();
    let joints = plan::<F>(pose_at, body, deviation, probes);
    for pair in joints.windows(2) {
        // Halves that are still to be done, the first one last.
        let mut open = vec![([pair[0], pair[1]], 0)];
        while let Some(([from, to], halvings)) = open.pop() {
            let (start, end) = (pose_at(from), pose_at(to));
            let found = chord_between::<F>(&start, &end).and_then(|steady| {
                let flow = Flow::new(steady.flow.generator_in_space());
                let chord = Chord {
                    flow: &flow,
                    start: &start,
                };
                let gap = measure([from, to], &chord)?;
                Some(Found {
                    u: [from, to],
                    steady,
                    gap,
                })
            });
            match found {
                Some(span) => spans.push(span),
                None if halvings == MOST_HALVINGS => return Err(0.5 * (from + to)),
                None => {
                    let middle = 0.5 * (from + to);
                    open.push(([middle, to], halvings + 1));
                    open.push(([from, middle], halvings + 1));
                }
            }
        }
    }
    Ok(spans)
}

/// The only steady motion between two poses, if there is one.
fn chord_between<F: Steady>(start: &DAffine3, end: &DAffine3) -> Option<Logarithm<F>> {
    let steady = F::between(&F::pose_of_space(start), &F::pose_of_space(end), None, 0).ok()?;
    steady.half_turn.is_none().then_some(steady)
}

/// Joints at which a chain follows a smooth motion, by the law of short spans: an estimate.
fn plan<F: Steady>(
    pose_at: &dyn Fn(f64) -> DAffine3,
    body: &Body,
    deviation: f64,
    least: u32,
) -> Vec<f64> {
    let mut probes = least;
    loop {
        // How many spans each probe needs: the root of the deviation of its chord.
        let mut start = pose_at(0.0);
        let wanted: Vec<f64> = (0..probes)
            .map(|probe| {
                let at = |part: f64| (f64::from(probe) + part) / f64::from(probes);
                let (middle, end) = (pose_at(at(0.5)), pose_at(at(1.0)));
                let off = chord_between::<F>(&start, &end).map(|steady| {
                    let flow = Flow::new(steady.flow.generator_in_space());
                    let chord = Chord {
                        flow: &flow,
                        start: &start,
                    };
                    chord.distance(&middle, 0.5, &body.points)
                });
                start = end;
                // Without a chord, at least a few.
                (off.unwrap_or(16.0 * deviation) / deviation).sqrt()
            })
            .collect();
        let sum: f64 = wanted.iter().sum();
        let count = (sum * PLAN_MARGIN).ceil().max(1.0);
        if count > 2.0 * f64::from(probes) && probes < MOST_PROBES {
            probes *= 4;
            continue;
        }
        let mut joints = vec![0.0];
        let (mut probe, mut before) = (0, 0.0);
        let mut joint = 1.0;
        while joint < count {
            let target = sum * joint / count;
            while probe + 1 < wanted.len() && before + wanted[probe] <= target {
                before += wanted[probe];
                probe += 1;
            }
            let part = ((target - before) / wanted[probe]).clamp(0.0, 1.0);
            let u = (probe as f64 + part) / f64::from(probes);
            if u > joints[joints.len() - 1] && u < 1.0 {
                joints.push(u);
            }
            joint += 1.0;
        }
        joints.push(1.0);
        return joints;
    }
}

/// The chain of spans that were found.
fn assemble<F: Steady>(
    keys: &[Keyframe<F::Pose>],
    spans: Vec<Found<F>>,
    body: &Body,
    asked: f64,
    proven: bool,
) -> Result<Motion<F>, MotionError> {
    let mut deviation = Deviation::none(asked, proven, keys[0].time, body.within);
    for (span, pair) in spans.iter().zip(keys.windows(2)) {
        if span.gap.length > deviation.length {
            let [start, end] = [pair[0].time, pair[1].time];
            deviation.length = span.gap.length;
            deviation.time = start + (end - start) * span.gap.share;
        }
    }
    let steady = spans.into_iter().map(|span| span.steady).collect();
    Motion::standing_for(keys, steady, deviation)
}

/// Refuses a deviation that rounding does not allow.
fn check_deviation(asked: f64, body: &Body, poses: &[DAffine3]) -> Result<(), MotionError> {
    let reach = |pose: &DAffine3| {
        let sizes = body
            .points
            .iter()
            .map(|&x| pose.transform_point3(x).length() + pose.translation.length());
        sizes.fold(0.0, f64::max)
    };
    let smallest = FOLLOWED_ROUNDING * poses.iter().map(reach).fold(0.0, f64::max);
    if asked > 0.0 && asked >= smallest && asked.is_finite() {
        Ok(())
    } else {
        Err(MotionError::DeviationTooSmall { asked, smallest })
    }
}
