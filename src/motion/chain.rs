//! Chains of steady spans, in space and in the plane.
//!
//! The types of this module are used under the names that fix their dimension:
//! [`Motion`](super::Motion), [`Span`](super::Span), [`Keyframe`](super::Keyframe) and
//! [`Logarithm`](super::Logarithm) in space, and those of [`super::planar`] in the plane.

use super::deviation::Deviation;
use super::half_turn::Decisions;
use super::merging::{Chain, Merged, Pace};
use super::{Generator, HalfTurns, MotionError, Sense};
use crate::numeric::tolerance::MOST_TURNS;
use glam::{DAffine3, DVec3};
use std::fmt::Debug;
use std::ops::{Mul, Range};

pub(super) mod sealed {
    /// Keeps [`Steady`](super::Steady) to the two flows of this crate.
    pub trait Sealed {}
}

/// The steady motions of which a chain is made: [`Flow`](super::Flow) in space,
/// [`planar::Flow`](super::planar::Flow) in the plane, and no others.
pub trait Steady: sealed::Sealed + Clone + Debug + Send + Sync {
    /// Velocity field.
    type Generator;
    /// A map of the world by a flow, or of a body into the world.
    type Pose: Copy + Debug + PartialEq + Mul<Output = Self::Pose> + Send + Sync;
    /// A point of space or of the plane.
    type Point: Copy + Debug + Mul<f64, Output = Self::Point>;
    /// The sense of a half turn between keyframes; in space with its axis.
    type HalfTurn: Copy + Debug + Send + Sync;

    /// The pose that moves nothing.
    const IDENTITY: Self::Pose;

    /// The flow of a velocity field; `None` where the field is not finite.
    fn of_generator(generator: Self::Generator) -> Option<Self>;

    /// exp(tG).
    fn pose_at(&self, t: f64) -> Self::Pose;

    /// Number of turns in a time of 1; 0 where nothing turns.
    fn turns(&self) -> f64;

    /// Whether a pose is finite and invertible in f64.
    fn is_usable(pose: &Self::Pose) -> bool;

    /// Checks that a pose is finite and preserves orientation, by the exact sign of its
    /// determinant.
    ///
    /// # Errors
    /// [`MotionError::NonFinite`], [`MotionError::Reflection`] or [`MotionError::Singular`].
    fn check_pose(pose: &Self::Pose) -> Result<(), MotionError>;

    /// C B^-1: maps the world at the pose B, `from`, to the world at the pose C, `to`.
    fn relative(from: &Self::Pose, to: &Self::Pose) -> Self::Pose;

    /// The steady motion from one pose to another.
    ///
    /// - `sense`: sense of a half turn; `None` for the shorter turn.
    /// - `turns`: whole turns to be added; other than 0, they decide the sense of a half turn.
    ///
    /// # Errors
    /// Those of [`logarithm_with_turns`](super::logarithm_with_turns).
    fn between(
        from: &Self::Pose,
        to: &Self::Pose,
        sense: Option<Sense>,
        turns: i32,
    ) -> Result<Logarithm<Self>, MotionError>;

    /// The axis about which whole turns of a motion are counted, from its own turn as a vector; `None`
    /// where nothing turns.
    fn sense_axis(turn: DVec3) -> Option<DVec3>;

    /// The axis of a half turn; `None` in the plane.
    fn axis_of(half_turn: &Self::HalfTurn) -> Option<DVec3>;

    /// G as a generator of space, where a plane is z = 0.
    fn generator_in_space(&self) -> Generator;

    /// The flow of a generator of the form of [`Steady::generator_in_space`].
    fn of_generator_in_space(generator: &Generator) -> Self;

    /// The pose of the form of [`Steady::pose_in_space`].
    fn pose_of_space(pose: &DAffine3) -> Self::Pose;

    /// The pose as one of space. For a pose of the plane, this increases no norm, nor that of the
    /// inverse.
    fn pose_in_space(pose: &Self::Pose) -> DAffine3;

    /// The point that a pose makes of a point.
    fn carried(pose: &Self::Pose, point: Self::Point) -> Self::Point;

    /// Velocity at a place, per span.
    fn velocity(&self, place: Self::Point) -> Self::Point;

    /// The point as one of space.
    fn point_in_space(point: Self::Point) -> DVec3;
}

/// log A: the steady motion that leads from the identity to A in one span.
#[derive(Debug, Clone)]
pub struct Logarithm<F: Steady> {
    /// exp(t log A), prepared.
    pub flow: F,
    /// For a half turn, scaled or not, within 1e-9 rad: the sense of `flow`, in space with its
    /// axis. The opposite sense leads to the same pose.
    pub half_turn: Option<F::HalfTurn>,
}

impl<F: Steady> Logarithm<F> {
    /// Whether it is the only one: false for a half turn.
    pub fn unique(&self) -> bool {
        self.half_turn.is_none()
    }
}

/// One steady span of a motion: the generator of the whole span, in world coordinates, and its
/// length on the clock.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use steadysweep::motion::{Generator, Span};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let span = Span::new(Generator::translation(DVec3::X), 2.0)?;
/// assert_eq!(span.flow().pose_at(0.5).translation, DVec3::X * 0.5);
/// assert_eq!(span.duration(), 2.0);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Span<F: Steady> {
    logarithm: Logarithm<F>,
    duration: f64,
}

/// A pose at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Keyframe<Pose> {
    /// Time on the motion's clock.
    pub time: f64,
    /// Body to world.
    pub pose: Pose,
}

impl<F: Steady> Span<F> {
    /// A span that acts on world coordinates by exp(sG), s from 0 to 1 over `duration`.
    ///
    /// # Errors
    /// [`MotionError::NonFinite`], [`MotionError::DurationNotPositive`],
    /// [`MotionError::Overflow`] when the span or its inverse leaves the range of f64, and
    /// [`MotionError::TooManyTurns`] beyond 25,000 turns.
    pub fn new(generator: F::Generator, duration: f64) -> Result<Span<F>, MotionError> {
        let flow =
            F::of_generator(generator).ok_or(MotionError::NonFinite { what: "generator" })?;
        Span::from_logarithm(flow.into(), duration)
    }

    fn from_logarithm(logarithm: Logarithm<F>, duration: f64) -> Result<Span<F>, MotionError> {
        if !duration.is_finite() {
            return Err(MotionError::NonFinite { what: "duration" });
        }
        if duration <= 0.0 {
            return Err(MotionError::DurationNotPositive { duration });
        }
        let turns = logarithm.flow.turns();
        if turns > MOST_TURNS {
            return Err(MotionError::TooManyTurns { turns });
        }
        let ends = [1.0, -1.0].map(|time| logarithm.flow.pose_at(time));
        if ends.iter().all(F::is_usable) {
            Ok(Span {
                logarithm,
                duration,
            })
        } else {
            Err(MotionError::Overflow)
        }
    }

    pub(super) fn logarithm(&self) -> &Logarithm<F> {
        &self.logarithm
    }

    /// exp(sG), s in [0, 1] over the span.
    pub fn flow(&self) -> &F {
        &self.logarithm.flow
    }
    /// Length of the span on the motion's clock.
    pub fn duration(&self) -> f64 {
        self.duration
    }
    /// Whether no other motion of the same kind joins the same poses: false for a half turn between
    /// keyframes.
    pub fn unique(&self) -> bool {
        self.logarithm.unique()
    }
    /// The chosen sense of a half turn between keyframes; in space with its axis.
    pub fn half_turn(&self) -> Option<F::HalfTurn> {
        self.logarithm.half_turn
    }
}

impl<F: Steady> From<F> for Logarithm<F> {
    /// A flow that is given, not found between poses.
    fn from(flow: F) -> Logarithm<F> {
        Logarithm {
            flow,
            half_turn: None,
        }
    }
}

/// A motion: start pose (body to world) and a chain of steady spans.
///
/// # Example
/// ```
/// use glam::{DAffine3, DVec3};
/// use std::f64::consts::FRAC_PI_2;
/// use steadysweep::motion::{Generator, Keyframe, Motion, Span};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // By spans: forwards for one unit of time, then a quarter turn about the z axis for two.
/// let forwards = Generator::translation(DVec3::X);
/// let turn = Generator::screw(DVec3::Z, DVec3::ZERO, FRAC_PI_2, 0.0, 1.0);
/// let motion = Motion::from_spans(vec![Span::new(forwards, 1.0)?, Span::new(turn, 2.0)?])?;
/// assert_eq!(motion.joint_times(), [0.0, 1.0, 3.0]);
/// let end = motion.pose_at_time(3.0).transform_point3(DVec3::ZERO);
/// assert!(end.distance(DVec3::Y) < 1e-15);
///
/// // By poses: a steady motion leads from each to the next.
/// let key = |time, pose| Keyframe { time, pose };
/// let pose = DAffine3::from_rotation_z(FRAC_PI_2);
/// let motion = Motion::from_keyframes(&[key(0.0, DAffine3::IDENTITY), key(1.0, pose)])?;
/// let half = motion.pose_at_time(0.5).transform_vector3(DVec3::X);
/// assert!((half.x - half.y).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Motion<F: Steady> {
    spans: Vec<Span<F>>,
    /// Body to world at the joints, one more than there are spans.
    poses: Vec<F::Pose>,
    joints: Vec<F::Pose>,
    times: Vec<f64>,
    deviation: Option<Deviation>,
}

impl<F: Steady> Motion<F> {
    /// The motion of a body that is given in world coordinates at the start, by `spans` one after
    /// the other; the clock starts at 0.
    ///
    /// # Errors
    /// [`MotionError::NoSpans`]; [`MotionError::InSpan`], which wraps [`MotionError::Overflow`]
    /// when the spans together leave the range of f64, or [`MotionError::DurationNotPositive`] when
    /// a span is too short for the clock to advance.
    pub fn from_spans(spans: Vec<Span<F>>) -> Result<Motion<F>, MotionError> {
        if spans.is_empty() {
            return Err(MotionError::NoSpans);
        }
        let mut joints = vec![F::IDENTITY];
        let mut times = vec![0.0];
        let (mut joint, mut time) = (F::IDENTITY, 0.0);
        for (index, span) in spans.iter().enumerate() {
            joint = span.flow().pose_at(1.0) * joint;
            if !F::is_usable(&joint) {
                return Err(MotionError::Overflow.in_span(index));
            }
            let next = time + span.duration;
            if !(next > time && next.is_finite()) {
                return Err(MotionError::DurationNotPositive {
                    duration: next - time,
                }
                .in_span(index));
            }
            time = next;
            joints.push(joint);
            times.push(time);
        }
        Ok(Motion {
            spans,
            poses: joints.clone(),
            joints,
            times,
            deviation: None,
        })
    }

    /// The steady motions between consecutive poses, none of which are a half turn apart.
    ///
    /// Equal poses give a span that stands still, exactly; equal linear parts give a translation,
    /// exactly. The pose at the start of a span is its keyframe to the last bit; the pose at the
    /// end is the next keyframe to within `LOGARITHM_RESIDUAL`.
    ///
    /// # Errors
    /// [`MotionError::TooFewKeyframes`], [`MotionError::TimeNotIncreasing`];
    /// [`MotionError::AtKeyframe`], which wraps [`MotionError::NonFinite`],
    /// [`MotionError::Reflection`] or [`MotionError::Singular`]; and
    /// [`MotionError::BetweenKeyframes`], which wraps those of [`logarithm()`](super::logarithm())
    /// or [`MotionError::HalfTurn`]: two poses half a turn apart leave the sense open, see
    /// [`Motion::from_keyframes_turning`].
    pub fn from_keyframes(keys: &[Keyframe<F::Pose>]) -> Result<Motion<F>, MotionError> {
        Motion::from_keyframes_turning(keys, &HalfTurns::Refused)
    }

    /// As [`Motion::from_keyframes`], with chosen senses for the half turns.
    ///
    /// # Errors
    /// As [`Motion::from_keyframes`]; and [`MotionError::HalfTurnSenses`] where there are more or
    /// fewer half turns than [`HalfTurns::Each`] has senses.
    pub fn from_keyframes_turning(
        keys: &[Keyframe<F::Pose>],
        half_turns: &HalfTurns,
    ) -> Result<Motion<F>, MotionError> {
        Motion::between_keys(keys, |_| 0, half_turns)
    }

    /// As [`Motion::from_keyframes_turning`], with whole turns added to the spans.
    ///
    /// - `turns`: for each span, by how many whole turns it turns more than the steady motion
    ///   between its keyframes would, as in [`logarithm_with_turns`](super::logarithm_with_turns);
    ///   in the plane, positive from x towards y. A half turn with whole turns goes in the sense
    ///   of their sign, so that `half_turns` does not count it.
    ///
    /// # Errors
    /// As [`Motion::from_keyframes_turning`]; [`MotionError::TurnsOfSpans`], and
    /// [`MotionError::NothingTurns`] within [`MotionError::BetweenKeyframes`].
    pub fn from_keyframes_with_turns(
        keys: &[Keyframe<F::Pose>],
        turns: &[i32],
        half_turns: &HalfTurns,
    ) -> Result<Motion<F>, MotionError> {
        let spans = keys.len().saturating_sub(1);
        if turns.len() != spans {
            return Err(MotionError::TurnsOfSpans {
                given: turns.len(),
                spans,
            });
        }
        Motion::between_keys(keys, |span| turns[span], half_turns)
    }

    fn between_keys(
        keys: &[Keyframe<F::Pose>],
        turns: impl Fn(usize) -> i32,
        half_turns: &HalfTurns,
    ) -> Result<Motion<F>, MotionError> {
        check_keys::<F>(keys)?;
        let mut decisions = Decisions::new(half_turns);
        let mut spans = Vec::with_capacity(keys.len() - 1);
        for (first, pair) in keys.windows(2).enumerate() {
            let [from, to] = [&pair[0], &pair[1]];
            let span = between::<F>(&from.pose, &to.pose, first, turns(first), &mut decisions)
                .and_then(|logarithm| Span::from_logarithm(logarithm, to.time - from.time))
                .map_err(|cause| cause.between_keyframes(first))?;
            spans.push(span);
        }
        decisions.close()?;
        Ok(Motion::through(keys, spans))
    }

    /// The motion by spans between keyframes, one fewer than those.
    fn through(keys: &[Keyframe<F::Pose>], spans: Vec<Span<F>>) -> Motion<F> {
        Motion {
            spans,
            poses: keys.iter().map(|key| key.pose).collect(),
            joints: keys
                .iter()
                .map(|key| F::relative(&keys[0].pose, &key.pose))
                .collect(),
            times: keys.iter().map(|key| key.time).collect(),
            deviation: None,
        }
    }

    /// A chain that stands for another motion.
    ///
    /// - `steady`: what leads from each keyframe to the next, one fewer than those.
    pub(super) fn standing_for(
        keys: &[Keyframe<F::Pose>],
        steady: Vec<Logarithm<F>>,
        deviation: Deviation,
    ) -> Result<Motion<F>, MotionError> {
        let durations = keys.windows(2).map(|pair| pair[1].time - pair[0].time);
        let spans = steady
            .into_iter()
            .zip(durations)
            .map(|(logarithm, duration)| Span::from_logarithm(logarithm, duration))
            .collect::<Result<Vec<Span<F>>, MotionError>>()?;
        Ok(Motion {
            deviation: Some(deviation),
            ..Motion::through(keys, spans)
        })
    }

    /// How far the motion may be from the one that it stands for; `None` where it stands for
    /// itself. See [`following`](super::following).
    pub fn deviation(&self) -> Option<&Deviation> {
        self.deviation.as_ref()
    }

    /// The deviation over a body; `None` where the motion stands for itself.
    ///
    /// - `low`, `high`: corners of a box around the body, in its frame; in the plane with z = 0.
    ///
    /// # Errors
    /// [`MotionError::FollowedForAnother`].
    pub(crate) fn deviation_over(
        &self,
        [low, high]: [DVec3; 2],
    ) -> Result<Option<&Deviation>, MotionError> {
        match self.deviation() {
            Some(deviation) if !deviation.covers(low, high) => Err(MotionError::FollowedForAnother),
            deviation => Ok(deviation),
        }
    }

    /// The poses at the joints, with their times.
    pub fn keyframes(&self) -> Vec<Keyframe<F::Pose>> {
        let times = self.times.iter();
        times
            .zip(&self.poses)
            .map(|(&time, &pose)| Keyframe { time, pose })
            .collect()
    }

    /// Body to world at the joints, one more than there are spans.
    pub(crate) fn poses(&self) -> &[F::Pose] {
        &self.poses
    }

    /// The same motion with newly chosen senses for its half turns.
    ///
    /// # Errors
    /// [`MotionError::HalfTurn`] within [`MotionError::BetweenKeyframes`], and
    /// [`MotionError::HalfTurnSenses`], as [`Motion::from_keyframes_turning`].
    pub fn turning(mut self, half_turns: &HalfTurns) -> Result<Motion<F>, MotionError> {
        let mut decisions = Decisions::new(half_turns);
        for (index, span) in self.spans.iter_mut().enumerate() {
            if !span.unique() {
                let [from, to] = [&self.poses[index], &self.poses[index + 1]];
                *span = between::<F>(from, to, index, 0, &mut decisions)
                    .and_then(|logarithm| Span::from_logarithm(logarithm, span.duration))
                    .map_err(|cause| cause.between_keyframes(index))?;
            }
        }
        decisions.close()?;
        Ok(self)
    }

    /// Number of half turns between keyframes.
    pub fn half_turns(&self) -> usize {
        self.spans.iter().filter(|span| !span.unique()).count()
    }

    /// Body to world at the start.
    pub fn start_pose(&self) -> &F::Pose {
        &self.poses[0]
    }
    /// The spans in order, at least one.
    pub fn spans(&self) -> &[Span<F>] {
        &self.spans
    }
    /// Poses of the joints relative to the start, P_0 = identity .. P_K: each maps the world at the
    /// start to the world at the joint.
    ///
    /// From spans, these are the products of their ends. From keyframes they are C_k C_0^-1, which
    /// does not drift, and is exactly the identity where a key repeats the first one.
    pub fn joints(&self) -> &[F::Pose] {
        &self.joints
    }
    /// Clock times of the joints, K + 1 of them, increasing.
    pub fn joint_times(&self) -> &[f64] {
        &self.times
    }

    /// Per span, its generator and the pose at its start, relative to the start of the motion. A
    /// motion in the plane is given as one of the plane z = 0 of space.
    pub(crate) fn spans_in_space(&self) -> impl Iterator<Item = (Generator, DAffine3)> {
        let spans = self.spans.iter().zip(&self.joints);
        spans.map(|(span, joint)| (span.flow().generator_in_space(), F::pose_in_space(joint)))
    }

    /// The motion with each run of spans as one span, where this moves no point of a body by more
    /// than rounding.
    ///
    /// - `corners`: corners of a box around the body, in the world at the start.
    pub(crate) fn merged(&self, corners: &[F::Point], pace: Pace) -> Merged<'_, Motion<F>> {
        self.merged_by(corners, pace, 0.0)
    }

    /// [`Motion::merged`] at any pace, as long as this moves points by no more than an allowance.
    ///
    /// - `allowance`: a length; the reported deviation stays within it, or within rounding.
    pub(crate) fn merged_within(
        &self,
        corners: &[F::Point],
        allowance: f64,
    ) -> Merged<'_, Motion<F>> {
        self.merged_by(corners, Pace::Any, allowance)
    }

    fn merged_by(&self, corners: &[F::Point], pace: Pace, allowance: f64) -> Merged<'_, Motion<F>> {
        if self.spans.len() == 1 {
            return Merged::unchanged(self);
        }
        let corners = in_space::<F>(corners);
        let chain = self.chain(&corners, pace, allowance);
        let runs = chain.runs();
        if runs.firsts.len() > self.spans.len() {
            return Merged::unchanged(self);
        }
        let span_of = |spans: Range<usize>| {
            if spans.len() == 1 {
                return self.spans[spans.start].clone();
            }
            Span {
                logarithm: F::of_generator_in_space(&chain.sum(&spans)).into(),
                duration: self.times[spans.end] - self.times[spans.start],
            }
        };
        let pairs = runs.firsts.windows(2);
        let motion = Motion {
            spans: pairs.map(|pair| span_of(pair[0]..pair[1])).collect(),
            poses: runs.firsts.iter().map(|&joint| self.poses[joint]).collect(),
            joints: runs
                .firsts
                .iter()
                .map(|&joint| self.joints[joint])
                .collect(),
            times: runs.firsts.iter().map(|&joint| self.times[joint]).collect(),
            deviation: self.deviation,
        };
        Merged::new(motion, runs)
    }

    /// The shares of a span that was merged at any pace at which the spans in it begin, ascending,
    /// and 1. Where the same share of such a span is over in both motions, their poses differ by no
    /// more than the deviation.
    ///
    /// - `corners`: those with which it was merged; `spans`: those in it.
    pub(crate) fn shares_of_spans(&self, corners: &[F::Point], spans: Range<usize>) -> Vec<f64> {
        let corners = in_space::<F>(corners);
        let chain = self.chain(&corners, Pace::Any, 0.0);
        let mut before = 0.0;
        let mut starts: Vec<f64> = chain
            .shares(&spans, &chain.sum(&spans))
            .into_iter()
            .map(|share| {
                let start = before;
                before += share;
                start
            })
            .collect();
        starts.push(1.0);
        starts
    }

    fn chain<'a>(&'a self, corners: &'a [DVec3], pace: Pace, allowance: f64) -> Chain<'a> {
        Chain {
            times: &self.times,
            generator: Box::new(|span| self.spans[span].flow().generator_in_space()),
            joint: Box::new(|joint| F::pose_in_space(&self.joints[joint])),
            corners,
            pace,
            allowance,
        }
    }

    /// Body to world at a time on the clock; before and after the motion the body rests.
    pub fn pose_at_time(&self, clock: f64) -> F::Pose {
        if let Some(last) = self.poses.last().filter(|_| clock >= self.end_time()) {
            return *last;
        }
        let index = self.span_at_time(clock);
        let fraction = self.fraction_of_span(index, clock);
        self.spans[index].flow().pose_at(fraction) * self.poses[index]
    }

    /// Number of the span at a time on the clock, from 0: at a joint, the one that begins there;
    /// outside the motion's time, the nearer one.
    pub fn span_at_time(&self, clock: f64) -> usize {
        self.times
            .partition_point(|&time| time <= clock)
            .saturating_sub(1)
            .min(self.spans.len() - 1)
    }

    /// Fraction of span number `index` that is over at a time on the clock, in [0, 1].
    pub(super) fn fraction_of_span(&self, index: usize, clock: f64) -> f64 {
        ((clock - self.times[index]) / self.spans[index].duration).clamp(0.0, 1.0)
    }

    fn end_time(&self) -> f64 {
        self.times[self.spans.len()]
    }
}

fn in_space<F: Steady>(points: &[F::Point]) -> Vec<DVec3> {
    points.iter().map(|&p| F::point_in_space(p)).collect()
}

/// Checks poses and times: at least two, all legal, one after the other.
pub(super) fn check_keys<F: Steady>(keys: &[Keyframe<F::Pose>]) -> Result<(), MotionError> {
    if keys.len() < 2 {
        return Err(MotionError::TooFewKeyframes { found: keys.len() });
    }
    for (index, key) in keys.iter().enumerate() {
        check_key::<F>(key).map_err(|cause| cause.at_keyframe(index))?;
    }
    match keys
        .windows(2)
        .position(|pair| pair[1].time <= pair[0].time)
    {
        None => Ok(()),
        Some(first) => Err(MotionError::TimeNotIncreasing {
            key: first + 1,
            time: keys[first + 1].time,
            previous: keys[first].time,
        }),
    }
}

fn check_key<F: Steady>(key: &Keyframe<F::Pose>) -> Result<(), MotionError> {
    if !key.time.is_finite() {
        return Err(MotionError::NonFinite { what: "time" });
    }
    F::check_pose(&key.pose)
}

/// The motion from one pose to another in a span, with whole turns added; if it is a half turn
/// without them, the next decision gives its sense.
pub(super) fn between<F: Steady>(
    from: &F::Pose,
    to: &F::Pose,
    span: usize,
    turns: i32,
    decisions: &mut Decisions,
) -> Result<Logarithm<F>, MotionError> {
    if turns != 0 {
        return F::between(from, to, None, turns);
    }
    let shorter = F::between(from, to, None, 0)?;
    let Some(half_turn) = shorter.half_turn else {
        return Ok(shorter);
    };
    let sense = decisions.next(span, F::axis_of(&half_turn));
    F::between(from, to, Some(sense), 0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{Keyframe, Motion, Span};
    use glam::{DMat3, DQuat};
    use std::f64::consts::{FRAC_PI_2, PI};

    fn key(time: f64, pose: DAffine3) -> Keyframe {
        Keyframe { time, pose }
    }
    fn turned(angle: f64) -> DAffine3 {
        DAffine3::from_rotation_translation(
            DQuat::from_axis_angle(DVec3::Z, angle),
            DVec3::new(1.0, 2.0, 3.0),
        )
    }
    fn difference(a: &DAffine3, b: &DAffine3) -> f64 {
        (a.matrix3 - b.matrix3)
            .to_cols_array()
            .iter()
            .fold((a.translation - b.translation).length(), |m, x| {
                m.max(x.abs())
            })
    }

    #[test]
    fn keyframes_are_met_at_their_times() {
        let keys = [
            key(-1.0, turned(0.3)),
            key(
                0.5,
                DAffine3 {
                    matrix3: turned(1.5).matrix3 * DMat3::from_diagonal(DVec3::new(1.0, 2.0, 0.5)),
                    translation: DVec3::Y,
                },
            ),
            key(2.0, turned(-1.0)),
            key(7.0, turned(0.3)),
        ];
        let motion = Motion::from_keyframes(&keys).expect("a legal chain");
        assert_eq!(
            motion.joint_times(),
            [-1.0, 0.5, 2.0, 7.0],
            "the clock of the keys"
        );
        for (index, key) in keys.iter().enumerate() {
            assert_eq!(
                motion.pose_at_time(key.time),
                key.pose,
                "key {index} is met exactly"
            );
            let before = motion.pose_at_time(key.time.next_down());
            assert!(
                difference(&before, &key.pose) < 1e-13,
                "and reached continuously: {before:?}"
            );
            let through_start = motion.joints()[index] * *motion.start_pose();
            assert!(
                difference(&through_start, &key.pose) < 1e-14,
                "joint {index}"
            );
        }
        assert_eq!(
            motion.joints()[3],
            DAffine3::IDENTITY,
            "a closed chain closes exactly"
        );
        assert_eq!(motion.pose_at_time(-100.0), keys[0].pose, "rests before");
        assert_eq!(motion.pose_at_time(100.0), keys[3].pose, "rests after");
    }

    #[test]
    fn spans_run_one_after_the_other_from_zero() {
        let quarter = Generator::screw(DVec3::Z, DVec3::ZERO, FRAC_PI_2, 0.0, 1.0);
        let step = Generator::translation(DVec3::X);
        let spans = vec![
            Span::new(quarter, 2.0).expect("a quarter turn"),
            Span::new(step, 0.5).expect("a step"),
        ];
        let motion = Motion::from_spans(spans).expect("a chain");
        assert_eq!(motion.joint_times(), [0.0, 2.0, 2.5], "durations add up");
        assert_eq!(
            *motion.start_pose(),
            DAffine3::IDENTITY,
            "the body is given in the world"
        );
        let middle = motion.pose_at_time(1.0).transform_point3(DVec3::X);
        let diagonal = 0.5_f64.sqrt();
        assert!(
            (middle - DVec3::new(diagonal, diagonal, 0.0)).length() < 1e-15,
            "an eighth of a turn: {middle}"
        );
        let end = motion.pose_at_time(2.5).transform_point3(DVec3::X);
        assert!(
            (end - DVec3::new(1.0, 1.0, 0.0)).length() < 1e-15,
            "turned, then moved: {end}"
        );
    }

    #[test]
    fn standing_still_and_translating_are_exact() {
        let pose = turned(0.7);
        let moved = DAffine3 {
            translation: pose.translation + DVec3::new(1.0, 0.5, 0.25),
            ..pose
        };
        let motion = Motion::from_keyframes(&[key(0.0, pose), key(1.0, pose), key(2.0, moved)])
            .expect("legal");
        assert_eq!(
            motion.spans()[0].flow().generator(),
            &Generator::translation(DVec3::ZERO),
            "stands still"
        );
        assert_eq!(
            motion.spans()[1].flow().generator(),
            &Generator::translation(DVec3::new(1.0, 0.5, 0.25)),
            "translates"
        );
    }

    #[test]
    fn a_half_turn_between_keys_is_refused_or_flagged() {
        let keys = |angle| [key(0.0, DAffine3::IDENTITY), key(1.0, turned(angle))];
        let error = Motion::from_keyframes(&keys(PI)).expect_err("either sense leads there");
        let axis = Some(DVec3::Z);
        assert_eq!(
            error,
            MotionError::HalfTurn { axis, count: 1 }.between_keyframes(0),
            "{error}"
        );
        let half = Motion::from_keyframes_turning(&keys(PI), &HalfTurns::All(Sense::Negative))
            .expect("chosen");
        assert!(!half.spans()[0].unique(), "either sense leads there");
        let less = Motion::from_keyframes(&keys(3.0)).expect("legal");
        assert!(
            less.spans()[0].unique(),
            "3 radians is less than half a turn"
        );
    }

    #[test]
    fn bad_keyframes_are_refused_with_their_number() {
        let refused =
            |keys: &[Keyframe]| Motion::from_keyframes(keys).expect_err("must be refused");
        let identity = DAffine3::IDENTITY;
        assert_eq!(
            refused(&[]),
            MotionError::TooFewKeyframes { found: 0 },
            "no key"
        );
        assert_eq!(
            refused(&[key(0.0, identity)]),
            MotionError::TooFewKeyframes { found: 1 },
            "one key"
        );
        assert_eq!(
            refused(&[key(0.0, identity), key(1.0, identity), key(1.0, identity)]),
            MotionError::TimeNotIncreasing {
                key: 2,
                time: 1.0,
                previous: 1.0
            },
            "time stands still"
        );
        assert_eq!(
            refused(&[key(0.0, identity), key(f64::NAN, identity)]),
            MotionError::NonFinite { what: "time" }.at_keyframe(1),
            "no time"
        );
        let scaled = |x, y, z| DAffine3::from_scale(DVec3::new(x, y, z));
        assert_eq!(
            refused(&[key(0.0, identity), key(1.0, scaled(1.0, 1.0, -1.0))]),
            MotionError::Reflection { determinant: -1.0 }.at_keyframe(1),
            "mirror"
        );
        assert_eq!(
            refused(&[key(0.0, scaled(1.0, 0.0, 1.0)), key(1.0, identity)]),
            MotionError::Singular.at_keyframe(0),
            "flat"
        );
        let error = refused(&[
            key(0.0, identity),
            key(1.0, identity),
            key(2.0, scaled(-1.0, -2.0, 1.0)),
        ]);
        let cause = MotionError::NoRealLogarithm {
            eigenvalues: [-2.0, -1.0],
        };
        assert_eq!(
            error,
            MotionError::BetweenKeyframes {
                first: 1,
                cause: Box::new(cause)
            },
            "unequal negatives"
        );
    }

    #[test]
    fn bad_spans_are_refused() {
        let refused =
            |generator, duration| Span::new(generator, duration).expect_err("must be refused");
        let still = Generator::translation(DVec3::ZERO);
        assert_eq!(
            refused(still, 0.0),
            MotionError::DurationNotPositive { duration: 0.0 },
            "no time"
        );
        assert_eq!(
            refused(still, f64::NAN),
            MotionError::NonFinite { what: "duration" },
            "no number"
        );
        let infinite = Generator::translation(DVec3::new(f64::INFINITY, 0.0, 0.0));
        assert_eq!(
            refused(infinite, 1.0),
            MotionError::NonFinite { what: "generator" },
            "no velocity"
        );
        let explosive = Generator {
            linear: DMat3::IDENTITY * 1e4,
            offset: DVec3::ZERO,
        };
        assert_eq!(refused(explosive, 1.0), MotionError::Overflow, "e^10000");
        assert_eq!(
            Motion::from_spans(Vec::new()).expect_err("must be refused"),
            MotionError::NoSpans,
            "no span"
        );
    }
}
