//! Half turns: poses to which both senses of rotation lead, and how the sense is chosen.
//!
//! A plane block -s I, s > 0, has no single logarithm, but one for every K with K^2 = -I, ln s I +
//! pi K: a family with two parameters. Of these, only K = J and K = -J, a quarter turn and its
//! opposite, move points along circles; the others turn along ellipses. So a half turn is made in
//! one of two *senses*, and the two poses do not say in which. The same holds for a block mean I +
//! w J that misses a half turn by an angle below the precision of poses ([`HALF_TURN_ANGLE`]): the
//! sign of w then says nothing about the sense. Both motions lead to it exactly, by turns of pi -
//! w/|mean| one way and pi + w/|mean| the other.
//!
//! `+` is the right-hand turn about the axis whose first non-zero component is positive; in the
//! plane it is the turn from x towards y.

use super::MotionError;
use super::pair::Traceless;
use crate::numeric::tolerance::{
    HALF_TURN, HALF_TURN_ANGLE, HALF_TURN_AXIS, MOST_TURNS, NEAR_HALF_TURN,
};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The sense of a half turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sense {
    /// `+`: by the right-hand rule about the axis of the [`HalfTurn`]; in the plane from x towards
    /// y.
    Positive,
    /// `-`: the other way round.
    Negative,
}

/// A half turn in space, and its sense.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfTurn {
    /// Unit vector whose first non-zero component is positive. Components below 1e-9 count as zero
    /// (`HALF_TURN_AXIS`).
    pub axis: DVec3,
    /// The sense about that axis.
    pub sense: Sense,
}

/// What to do between keyframes that are a half turn apart.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum HalfTurns {
    /// Refuse them: the two poses leave the sense open.
    #[default]
    Refused,
    /// Turn in this sense.
    All(Sense),
    /// Turn in these senses, one for each half turn in order of time.
    Each(Vec<Sense>),
}

impl Sense {
    /// `+` or `-`.
    pub fn symbol(self) -> &'static str {
        match self {
            Sense::Positive => "+",
            Sense::Negative => "-",
        }
    }

    /// The sense of a number's sign.
    pub(super) fn of(sign: f64) -> Sense {
        if sign < 0.0 {
            Sense::Negative
        } else {
            Sense::Positive
        }
    }

    /// The sense of whole turns; `None` where there are none.
    pub(super) fn of_turns(turns: i32) -> Option<Sense> {
        (turns != 0).then(|| Sense::of(f64::from(turns)))
    }

    /// The same sense, or the opposite one for a negative `sign`.
    pub(super) fn times(self, sign: f64) -> Sense {
        Sense::of(self.sign() * sign)
    }

    /// 1 or -1.
    fn sign(self) -> f64 {
        match self {
            Sense::Positive => 1.0,
            Sense::Negative => -1.0,
        }
    }
}

/// A unit vector or its opposite, whichever is the axis of [`Sense::Positive`].
pub(super) fn positive_axis(axis: DVec3) -> DVec3 {
    let first = axis
        .to_array()
        .into_iter()
        .find(|component| component.abs() > HALF_TURN_AXIS);
    if first.is_some_and(|component| component < 0.0) {
        -axis
    } else {
        axis
    }
}

/// A block B = mean I + C with mean < 0 that is a half turn to the precision of poses.
#[derive(Debug, Clone, Copy)]
pub(super) struct HalfTurnBlock {
    /// C.
    pub(super) rest: Traceless,
    /// K with K^2 = -I and C = tan(short) |mean| K; it turns from the first direction to the
    /// second.
    unit: Traceless,
    /// The angle by which the turn in the sense of K falls short of a half turn, of either sign.
    short: f64,
    /// ln|B|: half the logarithm of its determinant.
    pub(super) even: f64,
}

const QUARTER: Traceless = Traceless {
    z: 0.0,
    upper: -1.0,
    lower: 1.0,
};

/// The deviation of a block without trace from a turn, and the sine of the turn that remains.
fn stretch_and_turn(block: &Traceless) -> (f64, f64) {
    let skewed = 0.5 * (block.upper + block.lower);
    let turn = 0.5 * (block.lower - block.upper);
    (block.z.abs().max(skewed.abs()), turn)
}

/// A block near a half turn, as an exact turn with a uniform scale when it is one up to rounding;
/// `None` otherwise. It need not be a half turn itself.
///
/// - `block`: B without its trace, `mean` half of that trace.
///
/// The logarithm magnifies the deviation of B from a turn by pi over the angle that is missing to a
/// half turn: rounded rotations would stretch bodies during the motion.
pub(super) fn near_half_turn(mean: f64, block: &Traceless) -> Option<Traceless> {
    let (stretch, turn) = stretch_and_turn(block);
    let is_near = mean < 0.0 && turn.abs() <= NEAR_HALF_TURN * mean.abs();
    (is_near && stretch <= HALF_TURN * mean.abs()).then(|| QUARTER.scaled(turn))
}

/// Checks that whole turns can be told apart.
///
/// # Errors
/// [`MotionError::TooManyTurns`].
pub(super) fn check_turns(turns: i32) -> Result<(), MotionError> {
    let turns = f64::from(turns).abs();
    if turns > MOST_TURNS {
        return Err(MotionError::TooManyTurns { turns });
    }
    Ok(())
}

/// sqrt(-disc) of a block B = mean I + C, C^2 = disc I, that turns by more than the precision of
/// poses, so that whole turns can be added.
///
/// - `uncertain`: bound on the error of `disc`.
/// - `rounding`: bound on the errors of the entries of B.
///
/// # Errors
/// [`MotionError::NothingTurns`].
pub(super) fn turning_root(
    mean: f64,
    disc: f64,
    uncertain: f64,
    rounding: f64,
) -> Result<f64, MotionError> {
    let root = (-disc).max(0.0).sqrt();
    let turns = -disc > uncertain && root > HALF_TURN_ANGLE * mean.abs() + rounding;
    turns.then_some(root).ok_or(MotionError::NothingTurns)
}

impl HalfTurnBlock {
    /// - `block`: B without its trace, `disc` its discriminant.
    /// - `uncertain`: bound on the error of `disc`.
    /// - `rounding`: bound on the errors of the entries of B.
    pub(super) fn new(
        mean: f64,
        block: &Traceless,
        [disc, uncertain]: [f64; 2],
        rounding: f64,
    ) -> Option<HalfTurnBlock> {
        if mean >= 0.0 {
            return None;
        }
        let (stretch, turn) = stretch_and_turn(block);
        let (rest, unit, turn) = if stretch <= HALF_TURN * mean.abs() {
            (QUARTER.scaled(turn), QUARTER, turn)
        } else if disc < 0.0 && -disc > uncertain {
            let turn = (-disc).sqrt().copysign(block.lower);
            (*block, block.scaled(1.0 / turn), turn)
        } else {
            return None;
        };
        (turn.abs() <= HALF_TURN_ANGLE * mean.abs() + rounding).then(|| HalfTurnBlock {
            rest,
            unit,
            short: turn.atan2(-mean),
            even: mean.hypot(turn).ln(),
        })
    }

    /// The sense in which the turn is shorter, positive from the first direction to the second;
    /// `None` where the difference is rounding.
    pub(super) fn shorter(&self) -> Option<Sense> {
        (self.short.abs() > HALF_TURN).then(|| Sense::of(self.short))
    }

    /// The angle, and angle K, of ln B = `even` I + angle K in a given sense, positive from the
    /// first direction to the second.
    ///
    /// - `whole`: number of whole turns in that sense before the half turn.
    pub(super) fn turning(&self, sense: Sense, whole: u32) -> (Traceless, f64) {
        let around = TAU.mul_add(f64::from(whole), PI);
        let angle = around.copysign(sense.sign()) - self.short;
        (self.unit.scaled(angle), angle)
    }
}

/// Decides the senses of the half turns of a chain, one after the other.
pub(super) struct Decisions<'a> {
    rule: &'a HalfTurns,
    /// Numbers of the spans that are half turns.
    spans: Vec<usize>,
    /// Axis of the first half turn; `None` in the plane.
    axis: Option<DVec3>,
    /// The first keyframe whose own pose is a half turn, where its logarithm is asked for.
    pose: Option<usize>,
}

impl<'a> Decisions<'a> {
    pub(super) fn new(rule: &'a HalfTurns) -> Decisions<'a> {
        Decisions {
            rule,
            spans: Vec::new(),
            axis: None,
            pose: None,
        }
    }

    /// The sense of the next half turn, which is span number `span`; any sense, where half turns
    /// will be refused in the end.
    pub(super) fn next(&mut self, span: usize, axis: Option<DVec3>) -> Sense {
        self.axis = self.axis.or(axis);
        let number = self.spans.len();
        self.spans.push(span);
        match self.rule {
            HalfTurns::Refused => Sense::Positive,
            HalfTurns::All(sense) => *sense,
            HalfTurns::Each(senses) => senses.get(number).copied().unwrap_or(Sense::Positive),
        }
    }

    /// The sense of the next half turn, which leads from the body at rest to keyframe number `key`;
    /// any sense, where half turns will be refused in the end.
    pub(super) fn next_of_pose(&mut self, key: usize, axis: Option<DVec3>) -> Sense {
        self.pose = self.pose.or(Some(key));
        self.next(key, axis)
    }

    /// Number of half turns so far.
    pub(super) fn count(&self) -> usize {
        self.spans.len()
    }

    /// Refuses the half turns if they are not allowed, once all spans have been seen.
    pub(super) fn close(self) -> Result<(), MotionError> {
        let count = self.spans.len();
        if let (HalfTurns::Refused, Some(key)) = (self.rule, self.pose) {
            return Err(MotionError::HalfTurnOfPose { axis: self.axis }.at_keyframe(key));
        }
        match (self.rule, self.spans.first()) {
            (HalfTurns::Refused, Some(&first)) => Err(MotionError::BetweenKeyframes {
                first,
                cause: Box::new(MotionError::HalfTurn {
                    axis: self.axis,
                    count,
                }),
            }),
            (HalfTurns::Each(senses), _) if senses.len() != count => {
                Err(MotionError::HalfTurnSenses {
                    given: senses.len(),
                    spans: self.spans,
                })
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axis_points_along_its_first_component_that_is_not_zero() {
        let cases = [
            ([0.0, 0.0, -1.0], [0.0, 0.0, 1.0]),
            ([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]),
            ([0.0, -0.6, 0.8], [0.0, 0.6, -0.8]),
            ([0.6, 0.0, -0.8], [0.6, 0.0, -0.8]),
            // A rotation about y with rounding, and a component too large to be rounding.
            ([-1e-16, 1.0, 3e-17], [-1e-16, 1.0, 3e-17]),
            ([-2e-9, 1.0, 0.0], [2e-9, -1.0, 0.0]),
        ];
        for (axis, expected) in cases {
            assert_eq!(
                positive_axis(DVec3::from_array(axis)),
                DVec3::from_array(expected),
                "{axis:?}"
            );
        }
    }

    fn block(mean: f64, z: f64, upper: f64, lower: f64) -> Option<HalfTurnBlock> {
        let block = Traceless { z, upper, lower };
        HalfTurnBlock::new(mean, &block, [block.discriminant(), 0.0], 0.0)
    }

    #[test]
    fn a_block_within_a_billionth_of_a_half_turn_is_one() {
        for turn in [0.0, 6e-17, -3e-12, 9e-10, -9e-10] {
            let half = block(-2.0, 0.0, -2.0 * turn, 2.0 * turn).expect("a half turn");
            for (sense, around) in [(Sense::Positive, PI), (Sense::Negative, -PI)] {
                let (found, angle) = half.turning(sense, 0);
                assert!((angle - (around - turn)).abs() < 1e-15, "{turn:e}");
                assert_eq!(found.lower, angle, "a circle, although {turn:e} is noise");
            }
            let expected = (turn.abs() > 1e-13).then(|| Sense::of(turn));
            assert_eq!(half.shorter(), expected, "{turn:e}");
            assert!((half.even - 2.0_f64.ln()).abs() < 1e-15, "{turn:e}");
        }
        for turn in [1.1e-9, -1.1e-9, 1e-3] {
            assert!(
                block(-2.0, 0.0, -2.0 * turn, 2.0 * turn).is_none(),
                "{turn:e}"
            );
        }
        assert!(block(2.0, 0.0, 0.0, 0.0).is_none(), "no turn at all");
    }

    #[test]
    fn an_ellipse_turns_in_its_own_sense() {
        for sign in [1.0, -1.0] {
            // K = [0 -10; 0.1 0] and its opposite.
            let turn = 4e-10 * sign;
            let half = block(-1.0, 0.0, -10.0 * turn, 0.1 * turn).expect("a half turn");
            let (found, angle) = half.turning(Sense::Positive, 0);
            assert!((angle - (PI - turn)).abs() < 1e-15, "{angle}");
            assert!((found.upper + 10.0 * angle).abs() < 1e-8, "{found:?}");
            assert!((found.lower - 0.1 * angle).abs() < 1e-8, "{found:?}");
            assert_eq!(half.shorter(), Some(Sense::of(sign)), "{sign}");
        }
    }
}
