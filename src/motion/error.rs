//! Why a motion was refused.

use crate::numeric::Readable;
use crate::numeric::tolerance::{HALF_TURN_AXIS, MOST_TURNS};
use glam::DVec3;
use std::fmt;

/// Why a motion was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// A number of the motion is NaN or infinite.
    #[error("the {what} of the motion has a number that is not finite")]
    NonFinite {
        /// The input: "matrix", "axis", ...
        what: &'static str,
    },
    /// The axis has length zero, although the motion turns about it or advances along it.
    #[error("the axis is (0, 0, 0), expected a direction to turn about or to advance along")]
    ZeroAxis,
    /// A scale that no real motion reaches.
    #[error("the scale is {scale}, expected a number above 0")]
    ScaleNotPositive {
        /// The value as given.
        scale: f64,
    },
    /// The motion leaves the range of f64 within one span.
    #[error(
        "the motion grows or shrinks beyond the range of numbers within one span; use a smaller generator"
    )]
    Overflow,
    /// A span turns too often for the times of its turns to be told apart.
    #[error(
        "the span turns {} times, more than {MOST_TURNS} times; use fewer turns, or several spans",
        Readable(*.turns)
    )]
    TooManyTurns {
        /// How often it turns, scaled or not.
        turns: f64,
    },
    /// A span has a length of zero or below.
    #[error("the duration is {duration}, expected a number above 0")]
    DurationNotPositive {
        /// The value as given.
        duration: f64,
    },
    /// The affine map reverses orientation.
    #[error(
        "a reflection (determinant {}) is not reached by a continuous motion without flattening",
        Readable(*.determinant)
    )]
    Reflection {
        /// Its determinant, below zero.
        determinant: f64,
    },
    /// The affine map flattens the body.
    #[error("the matrix is singular (determinant 0): it flattens the body")]
    Singular,
    /// Too few pairs of points for an affine map.
    #[error("{found} pairs of points are given, expected at least {needed}; add {}", .needed - .found)]
    TooFewPoints {
        /// Number of pairs.
        found: usize,
        /// Number of pairs that determine an affine map.
        needed: usize,
    },
    /// Source points that do not span space, or the plane.
    #[error(
        "the source points are on one {}, and leave the map open across it; add a pair away from it",
        flat(*.dimension)
    )]
    FlatSources {
        /// Number of coordinates.
        dimension: usize,
    },
    /// Target points that do not span space, or the plane.
    #[error(
        "the target points are on one {}: the map flattens the body; correct the targets",
        flat(*.dimension)
    )]
    FlatTargets {
        /// Number of coordinates.
        dimension: usize,
    },
    /// Target points that are a mirror image of the source points.
    #[error(
        "the target points mirror the source points (determinant {}), which no motion does; correct the order or the \
         signs of the points",
        Readable(*.determinant)
    )]
    MirroredTargets {
        /// That of the map, below zero.
        determinant: f64,
    },
    /// There are negative eigenvalues that do not form an equal, diagonalisable pair.
    #[error(
        "no steady motion leads there: the matrix has no real logarithm, its negative eigenvalues {} and {} are not \
         an equal pair; insert a keyframe between, or put another motion there (in a motion file \"without_steady\": \"polar-log\")",
        .eigenvalues[0], .eigenvalues[1]
    )]
    NoRealLogarithm {
        /// The two negative eigenvalues, ascending; equal ones belong to a Jordan block.
        eigenvalues: [f64; 2],
    },
    /// The logarithm exists, but f64 cannot represent the motion to it.
    #[error(
        "the motion between the poses is ill-conditioned: it misses the end pose by {residual:e} of its size, at \
         most {limit:e} is allowed; insert a keyframe between"
    )]
    IllConditioned {
        /// ||exp(log A) - A|| / ||A||.
        residual: f64,
        /// The largest residual that is allowed.
        limit: f64,
    },
    /// A half turn: both senses of rotation lead to the same pose.
    #[error(
        "they are half a turn apart{}, and both senses lead there; insert a keyframe between, give the motion as a span, or choose: \
         --half-turn + or -{}",
        HalfTurnAxis(*.axis),
        if *.count > 1 { format!(", one for each of the {count} half turns, separated by commas, or one for all") } else { String::new() }
    )]
    HalfTurn {
        /// The axis of the sense `+`, by the right-hand rule; `None` in the plane, where `+` is
        /// from x towards y.
        axis: Option<DVec3>,
        /// Number of half turns in the chain.
        count: usize,
    },
    /// Whole turns are asked for between poses that differ by no turn.
    #[error(
        "whole turns are asked for, but nothing turns from the one pose to the other: there is no axis for them; leave \
         them out, insert a keyframe between, or give the motion as a span"
    )]
    NothingTurns,
    /// Whole turns are asked for where the motion between keyframes has no axis for them.
    #[error(
        "the interpolation \"{scheme}\" takes no whole turns; leave them out, or use another one"
    )]
    NoTurns {
        /// Name of the scheme.
        scheme: &'static str,
    },
    /// There are more or fewer numbers of whole turns than spans.
    #[error("{given} numbers of whole turns are given, expected one for each of the {spans} spans")]
    TurnsOfSpans {
        /// Number of numbers that were given.
        given: usize,
        /// Number of spans.
        spans: usize,
    },
    /// A pose is half a turn from that of the body at rest, and the interpolation takes the
    /// logarithm of this turn.
    #[error(
        "the pose is half a turn from the orientation of the body{}, and the interpolation depends on the sense \
         of this turn; use another interpolation, such as \"polar\", or choose: --half-turn + or -",
        HalfTurnAxis(*.axis)
    )]
    HalfTurnOfPose {
        /// The axis of the sense `+`; `None` in the plane.
        axis: Option<DVec3>,
    },
    /// The body is flattened between two keyframes.
    #[error(
        "the body is flattened near time {time}: no steady motion leads through there; insert a keyframe between, \
         or use another interpolation, such as \"polar\""
    )]
    Flattened {
        /// On the clock.
        time: f64,
    },
    /// The deviation is not a length that rounding allows.
    #[error(
        "the deviation is {}, expected at least {}, which rounding allows at this distance from the origin",
        Readable(*.asked), Readable(*.smallest)
    )]
    DeviationTooSmall {
        /// As asked.
        asked: f64,
        /// The smallest one that can be had.
        smallest: f64,
    },
    /// A motion stands for another one only for a given body.
    #[error(
        "the motion is followed within a deviation for points that do not contain the body; follow it for this body"
    )]
    FollowedForAnother,
    /// There are more or fewer senses than half turns.
    #[error(
        "{given} senses of half turns are given, but {}; give one for each, or one for all",
        counted_spans(.spans)
    )]
    HalfTurnSenses {
        /// Number of senses that were given.
        given: usize,
        /// The spans that are half turns, counted from 0.
        spans: Vec<usize>,
    },
    /// The chain has no span.
    #[error("the motion has no span, expected at least one")]
    NoSpans,
    /// There are too few poses for a motion.
    #[error("the motion has {found} keyframe{}, expected at least two", if *.found == 1 { "" } else { "s" })]
    TooFewKeyframes {
        /// Number of poses, 0 or 1.
        found: usize,
    },
    /// The times of keyframes do not increase.
    #[error(
        "keyframe {key} is at time {time}, expected a time above {previous}, that of the keyframe before"
    )]
    TimeNotIncreasing {
        /// Its number, counted from 0.
        key: usize,
        /// Its time.
        time: f64,
        /// The time of the keyframe before.
        previous: f64,
    },
    /// One keyframe is at fault.
    #[error("keyframe {key}: {cause}")]
    AtKeyframe {
        /// Its number, counted from 0.
        key: usize,
        /// What is wrong with it.
        cause: Box<MotionError>,
    },
    /// No motion leads from one keyframe to the next.
    #[error("between keyframes {first} and {}: {cause}", .first + 1)]
    BetweenKeyframes {
        /// The earlier of the two, counted from 0; also the number of the span.
        first: usize,
        /// What is wrong between them.
        cause: Box<MotionError>,
    },
    /// One span is at fault.
    #[error("span {span}: {cause}")]
    InSpan {
        /// Its number, counted from 0.
        span: usize,
        /// What is wrong with it.
        cause: Box<MotionError>,
    },
}

impl MotionError {
    /// This error of a map that was found from points.
    pub(super) fn of_targets(self) -> MotionError {
        match self {
            MotionError::Reflection { determinant } => MotionError::MirroredTargets { determinant },
            other => other,
        }
    }
    /// The number of the keyframe at which it is, or at which the span ends where it is.
    #[cfg(feature = "files")]
    pub(crate) fn keyframe(&self) -> Option<usize> {
        match self {
            MotionError::TimeNotIncreasing { key, .. } | MotionError::AtKeyframe { key, .. } => {
                Some(*key)
            }
            MotionError::BetweenKeyframes { first, .. } => Some(first + 1),
            _ => None,
        }
    }

    /// This error, with the number of the keyframe before (from 0).
    pub(super) fn between_keyframes(self, first: usize) -> MotionError {
        MotionError::BetweenKeyframes {
            first,
            cause: Box::new(self),
        }
    }
    /// This error, with the number of its span (from 0).
    pub(crate) fn in_span(self, span: usize) -> MotionError {
        MotionError::InSpan {
            span,
            cause: Box::new(self),
        }
    }
    /// This error, with the number of its keyframe (from 0).
    pub(crate) fn at_keyframe(self, key: usize) -> MotionError {
        MotionError::AtKeyframe {
            key,
            cause: Box::new(self),
        }
    }
}

/// What has one dimension less.
fn flat(dimension: usize) -> &'static str {
    if dimension == 3 { "plane" } else { "line" }
}

/// The axis of a half turn in words: "about the axis (0, 0, 1)", and what `+` means there.
struct HalfTurnAxis(Option<DVec3>);

impl fmt::Display for HalfTurnAxis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(axis) = self.0 else {
            return write!(f, " (+: from x towards y)");
        };
        let [x, y, z] = axis.to_array().map(|component| {
            let is_zero = component.abs() <= HALF_TURN_AXIS;
            Readable(if is_zero { 0.0 } else { component })
        });
        write!(
            f,
            " about the axis ({x}, {y}, {z}) (+: by the right-hand rule)"
        )
    }
}

/// "2 of the spans are: 0, 3".
fn counted_spans(spans: &[usize]) -> String {
    /// Most spans that a message lists.
    const LISTED: usize = 10;
    if spans.is_empty() {
        return "no two consecutive keyframes are a half turn apart".to_owned();
    }
    let mut numbers: Vec<String> = spans.iter().take(LISTED).map(usize::to_string).collect();
    if spans.len() > LISTED {
        numbers.push("..".to_owned());
    }
    let verb = if spans.len() == 1 {
        "span is"
    } else {
        "spans are"
    };
    format!(
        "{} {verb} a half turn: {} (from 0)",
        spans.len(),
        numbers.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_says_where_it_happened() {
        let error = MotionError::ScaleNotPositive { scale: -2.0 }.in_span(3);
        assert_eq!(
            error.to_string(),
            "span 3: the scale is -2, expected a number above 0",
            "place, then reason"
        );
        let between = MotionError::BetweenKeyframes {
            first: 1,
            cause: Box::new(MotionError::Singular),
        };
        assert!(
            between
                .to_string()
                .starts_with("between keyframes 1 and 2: the matrix is singular"),
            "{between}"
        );
    }
}
