//! A chain of steady spans.

use super::half_turn::Decisions;
use super::merging::{Chain, Merged, Pace};
use super::{Flow, Generator, HalfTurn, HalfTurns, Logarithm, MotionError, logarithm};
use crate::numeric::tolerance::{RELATIVE_POSE, UNIT_ROUNDOFF};
use glam::{DAffine3, DVec3};
use std::ops::Range;

/// One steady span of a motion: world generator of the whole span and its share of the clock.
#[derive(Debug, Clone)]
pub struct Span {
    flow: Flow,
    duration: f64,
    half_turn: Option<HalfTurn>,
}

/// A pose at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Keyframe {
    /// On the motion's clock.
    pub time: f64,
    /// Body to world.
    pub pose: DAffine3,
}

impl Span {
    /// A span that acts on world coordinates by exp(sG), s from 0 to 1 over `duration`.
    ///
    /// # Errors
    /// [`MotionError::NonFinite`], [`MotionError::DurationNotPositive`], and [`MotionError::Overflow`] when the span
    /// or its inverse leaves the range of f64.
    pub fn new(generator: Generator, duration: f64) -> Result<Span, MotionError> {
        if !generator.is_finite() {
            return Err(MotionError::NonFinite { what: "generator" });
        }
        Span::from_logarithm(
            Logarithm {
                flow: Flow::new(generator),
                half_turn: None,
            },
            duration,
        )
    }

    fn from_logarithm(logarithm: Logarithm, duration: f64) -> Result<Span, MotionError> {
        if !duration.is_finite() {
            return Err(MotionError::NonFinite { what: "duration" });
        }
        if duration <= 0.0 {
            return Err(MotionError::DurationNotPositive { duration });
        }
        let Logarithm { flow, half_turn } = logarithm;
        if is_usable(&flow.pose_at(1.0)) && is_usable(&flow.pose_at(-1.0)) {
            Ok(Span {
                flow,
                duration,
                half_turn,
            })
        } else {
            Err(MotionError::Overflow)
        }
    }

    /// exp(sG), s in [0, 1] over the span.
    pub fn flow(&self) -> &Flow {
        &self.flow
    }
    /// Length of the span on the motion's clock.
    pub fn duration(&self) -> f64 {
        self.duration
    }
    /// False when another motion of the same kind joins the same poses: a half turn between keyframes.
    pub fn unique(&self) -> bool {
        self.half_turn.is_none()
    }
    /// Axis and sense of a half turn between keyframes, as it was decided.
    pub fn half_turn(&self) -> Option<HalfTurn> {
        self.half_turn
    }
}

/// Finite and invertible in f64.
fn is_usable(pose: &DAffine3) -> bool {
    let determinant = pose.matrix3.determinant();
    pose.is_finite() && determinant.is_finite() && determinant > 0.0
}

/// A motion: start pose (body to world) and a chain of steady spans.
#[derive(Debug, Clone)]
pub struct Motion {
    spans: Vec<Span>,
    /// Body to world at the joints; one more than spans.
    poses: Vec<DAffine3>,
    joints: Vec<DAffine3>,
    times: Vec<f64>,
}

impl Motion {
    /// A body given in the world at the start, then `spans` one after the other; the clock starts at 0.
    ///
    /// # Errors
    /// [`MotionError::NoSpans`]; [`MotionError::InSpan`] around [`MotionError::Overflow`] when the spans together leave
    /// the range of f64, or around [`MotionError::DurationNotPositive`] when a span is too short for the clock to advance.
    pub fn from_spans(spans: Vec<Span>) -> Result<Motion, MotionError> {
        if spans.is_empty() {
            return Err(MotionError::NoSpans);
        }
        let mut joints = vec![DAffine3::IDENTITY];
        let mut times = vec![0.0];
        let (mut joint, mut time) = (DAffine3::IDENTITY, 0.0);
        for (index, span) in spans.iter().enumerate() {
            joint = span.flow.pose_at(1.0) * joint;
            if !is_usable(&joint) {
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
        })
    }

    /// The steady motions between consecutive poses, none of which are a half turn apart.
    ///
    /// Equal poses give a span that stands still, exactly; equal linear parts a translation, exactly. The pose at the
    /// start of a span is its keyframe to the last bit, at its end the next one to
    /// [`LOGARITHM_RESIDUAL`](crate::numeric::tolerance::LOGARITHM_RESIDUAL).
    ///
    /// # Errors
    /// [`MotionError::TooFewKeyframes`], [`MotionError::TimeNotIncreasing`]; [`MotionError::AtKeyframe`] around
    /// [`MotionError::NonFinite`], [`MotionError::Reflection`] or [`MotionError::Singular`]; and
    /// [`MotionError::BetweenKeyframes`] around those of [`logarithm()`] or around [`MotionError::HalfTurn`]: two poses half a turn
    /// apart do not say which way to go, see [`Motion::from_keyframes_turning`].
    pub fn from_keyframes(keys: &[Keyframe]) -> Result<Motion, MotionError> {
        Motion::from_keyframes_turning(keys, &HalfTurns::Refused)
    }

    /// [`Motion::from_keyframes`] with the senses of half turns chosen.
    ///
    /// # Errors
    /// As [`Motion::from_keyframes`]; and [`MotionError::HalfTurnSenses`] where there are more or fewer half turns than
    /// [`HalfTurns::Each`] has senses.
    pub fn from_keyframes_turning(
        keys: &[Keyframe],
        half_turns: &HalfTurns,
    ) -> Result<Motion, MotionError> {
        if keys.len() < 2 {
            return Err(MotionError::TooFewKeyframes { found: keys.len() });
        }
        for (index, key) in keys.iter().enumerate() {
            check_key(key).map_err(|cause| cause.at_keyframe(index))?;
        }
        let mut decisions = Decisions::new(half_turns);
        let mut spans = Vec::with_capacity(keys.len() - 1);
        for (first, pair) in keys.windows(2).enumerate() {
            let [from, to] = [pair[0], pair[1]];
            if to.time <= from.time {
                return Err(MotionError::TimeNotIncreasing {
                    key: first + 1,
                    time: to.time,
                    previous: from.time,
                });
            }
            let span = logarithm_between(&from.pose, &to.pose, first, &mut decisions)
                .and_then(|logarithm| Span::from_logarithm(logarithm, to.time - from.time))
                .map_err(|cause| cause.between_keyframes(first))?;
            spans.push(span);
        }
        decisions.close()?;
        Ok(Motion {
            spans,
            poses: keys.iter().map(|key| key.pose).collect(),
            joints: keys
                .iter()
                .map(|key| relative(&keys[0].pose, &key.pose))
                .collect(),
            times: keys.iter().map(|key| key.time).collect(),
        })
    }

    /// The same motion with the senses of its half turns chosen anew.
    ///
    /// # Errors
    /// [`MotionError::HalfTurn`] within [`MotionError::BetweenKeyframes`], and [`MotionError::HalfTurnSenses`], as
    /// [`Motion::from_keyframes_turning`].
    pub fn turning(mut self, half_turns: &HalfTurns) -> Result<Motion, MotionError> {
        let mut decisions = Decisions::new(half_turns);
        for (index, span) in self.spans.iter_mut().enumerate() {
            if span.half_turn.is_some() {
                let [from, to] = [&self.poses[index], &self.poses[index + 1]];
                *span = logarithm_between(from, to, index, &mut decisions)
                    .and_then(|logarithm| Span::from_logarithm(logarithm, span.duration))
                    .map_err(|cause| cause.between_keyframes(index))?;
            }
        }
        decisions.close()?;
        Ok(self)
    }

    /// Number of its half turns between keyframes.
    pub fn half_turns(&self) -> usize {
        self.spans.iter().filter(|span| !span.unique()).count()
    }

    /// Body to world at the start.
    pub fn start_pose(&self) -> &DAffine3 {
        &self.poses[0]
    }
    /// The spans in order, at least one.
    pub fn spans(&self) -> &[Span] {
        &self.spans
    }
    /// Poses of the joints relative to the start, P_0 = identity .. P_K: maps the world at the start to the world there.
    ///
    /// From spans, the products of their ends; from keyframes C_k C_0^-1, which does not drift and is the identity,
    /// exactly, where a key repeats the first one.
    pub fn joints(&self) -> &[DAffine3] {
        &self.joints
    }
    /// Clock times of the joints, K + 1 of them, increasing.
    pub fn joint_times(&self) -> &[f64] {
        &self.times
    }

    /// The motion with its runs of spans as one span each, where no point of a body can tell.
    ///
    /// `corners`: of a box round the body, in the world at the start.
    pub(crate) fn merged(&self, corners: &[DVec3], pace: Pace) -> Merged<'_, Motion> {
        if self.spans.len() == 1 {
            return Merged::unchanged(self);
        }
        let chain = Chain {
            times: &self.times,
            generator: &|span| *self.spans[span].flow.generator(),
            joint: &|joint| self.joints[joint],
            corners,
            pace,
        };
        let runs = chain.runs();
        if runs.firsts.len() > self.spans.len() {
            return Merged::unchanged(self);
        }
        let span_of = |spans: Range<usize>| {
            if spans.len() == 1 {
                return self.spans[spans.start].clone();
            }
            Span {
                flow: Flow::new(chain.sum(&spans)),
                duration: self.times[spans.end] - self.times[spans.start],
                half_turn: None,
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
        };
        Merged::new(motion, runs)
    }

    /// Body to world at a time of the clock; outside the motion's time the body rests at the nearer end.
    pub fn pose_at_time(&self, clock: f64) -> DAffine3 {
        if let Some(last) = self.poses.last().filter(|_| clock >= self.end_time()) {
            return *last;
        }
        let index = self.span_at_time(clock);
        let fraction = self.fraction_of_span(index, clock);
        self.spans[index].flow.pose_at(fraction) * self.poses[index]
    }

    /// Number of the span at a time of the clock, from 0: at a joint the one that begins there; outside the motion's time the nearer one.
    pub fn span_at_time(&self, clock: f64) -> usize {
        self.times
            .partition_point(|&time| time <= clock)
            .saturating_sub(1)
            .min(self.spans.len() - 1)
    }

    /// Share of span number `index` that is over at a time of the clock, in [0, 1].
    pub(super) fn fraction_of_span(&self, index: usize, clock: f64) -> f64 {
        ((clock - self.times[index]) / self.spans[index].duration).clamp(0.0, 1.0)
    }

    fn end_time(&self) -> f64 {
        self.times[self.spans.len()]
    }
}

fn check_key(key: &Keyframe) -> Result<(), MotionError> {
    if !key.time.is_finite() {
        return Err(MotionError::NonFinite { what: "time" });
    }
    if !key.pose.is_finite() {
        return Err(MotionError::NonFinite { what: "matrix" });
    }
    logarithm::check_determinant(&key.pose.matrix3)
}

/// The motion from one pose to another, during a span; the next half turn is decided.
fn logarithm_between(
    from: &DAffine3,
    to: &DAffine3,
    span: usize,
    decisions: &mut Decisions,
) -> Result<Logarithm, MotionError> {
    let (relative, rounding) = (relative(from, to), relative_rounding(from, to));
    let shorter = logarithm::logarithm_of(&relative, rounding, None)?;
    let Some(half_turn) = shorter.half_turn else {
        return Ok(shorter);
    };
    let sense = decisions.next(span, Some(half_turn.axis));
    logarithm::logarithm_of(&relative, rounding, Some(sense))
}

/// Bound on the rounding of the entries of the linear part of [`relative`].
fn relative_rounding(from: &DAffine3, to: &DAffine3) -> f64 {
    if from.matrix3 == to.matrix3 {
        return 0.0;
    }
    let inverse = from.matrix3.inverse();
    let sizes = [to.matrix3, inverse, from.matrix3, inverse].map(|matrix| matrix.abs());
    let product = sizes[0] * sizes[1] * (sizes[2] * sizes[3]);
    let largest = product.to_cols_array().into_iter().fold(0.0, f64::max);
    RELATIVE_POSE * UNIT_ROUNDOFF * largest
}

/// C B^-1.
fn relative(from: &DAffine3, to: &DAffine3) -> DAffine3 {
    if from.matrix3 == to.matrix3 {
        return DAffine3::from_translation(to.translation - from.translation);
    }
    let matrix3 = to.matrix3 * from.matrix3.inverse();
    DAffine3 {
        matrix3,
        translation: to.translation - matrix3 * from.translation,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Sense;
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
