//! Schemes: what a pose between two keyframes is, other than the steady motion between them.
//!
//! With the keyframes B = \[L_B | b\] and C = \[L_C | c\], polar factors L = R S (R a rotation, S
//! symmetric and positive definite) and u from 0 to 1:
//!
//! | scheme | pose at u | source |
//! |---|---|---|
//! | [`Linear`](Scheme::Linear) | (1 - u) B + u C | |
//! | [`Polar`](Scheme::Polar) | (R_C R_B^-1)^u R_B ((1 - u) S_B + u S_C), straight offset | Shoemake & Duff; glTF, FreeCAD |
//! | [`Asap`](Scheme::Asap) | the same with exp((1 - u) log S_B + u log S_C) | SAM 3.3.2 |
//! | [`PolarLog`](Scheme::PolarLog) | exp((1 - u) log R_B + u log R_C) exp((1 - u) log S_B + u log S_C), straight offset | Kaji & Ochiai 3 |
//! | [`Log`](Scheme::Log) | exp((1 - u) log B + u log C) | Alexa 5 |
//! | [`Spiral`](Scheme::Spiral) | (Q_C Q_B^-1)^u Q_B ((1 - u) E_B + u E_C), Q = det(L)^(1/n) R and its offset, B = Q_B E_B | SAM 2.4 |
//!
//! SAM calls ARAP's stretch "analogous to (but different from)" the polar one; they are the same,
//! so ARAP with a straight offset is [`Polar`](Scheme::Polar) between the identity and a pose.
//!
//! # Which laws hold
//! | | left or right affine | conjugate affine | left rigid | conjugate rotation | reversible | volume monotone | rigid stays rigid |
//! |---|---|---|---|---|---|---|---|
//! | steady | yes | yes | yes | yes | yes | yes | yes |
//! | log | no | yes | no | yes | yes | yes | yes |
//! | linear | yes | yes | yes | yes | yes | no | no |
//! | polar | no | no | yes | yes | yes | no | yes |
//! | asap | no | no | yes | yes | yes | yes | yes |
//! | polar-log | no | no | no | yes | yes | yes | yes |
//! | spiral | no | no | yes | yes | yes | no | yes |
//!
//! Only the first is steady, and so swept exactly; the others are followed by steady motions within
//! a deviation ([`following`](super::following)).

mod course;
mod piece;
mod polar;

pub use course::Course;
pub(in crate::motion) use course::rotation_vector;
pub(in crate::motion) use piece::{Piece, Rates};

use super::chain::Keyframe;

/// How the poses between keyframes are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Scheme {
    /// The steady motion from one to the next.
    #[default]
    Steady,
    /// Every point moves along a straight line. The body may be flattened on the way; then the
    /// scheme is refused.
    Linear,
    /// The rotation turns evenly (SLERP), the stretch and the offset change along straight lines
    /// (LERP).
    Polar,
    /// As [`Scheme::Polar`], with a stretch that changes exponentially.
    Asap,
    /// Rotation vector, logarithm of the stretch, and offset change along straight lines. It exists
    /// for all poses.
    PolarLog,
    /// The logarithm of the pose changes along a straight line.
    Log,
    /// Turn, uniform scale and position follow a logarithmic spiral; the rest of the pose changes
    /// along a straight line.
    Spiral,
}

/// What stands in for a steady motion between two keyframes that none joins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum WithoutSteady {
    /// Nothing: the motion is refused.
    #[default]
    Refuse,
    /// The motion of [`Scheme::PolarLog`].
    PolarLog,
}

/// Keyframes, and how the poses between them are found.
#[derive(Debug, Clone, Copy)]
pub struct Keyed<'a, Pose> {
    /// The scheme.
    pub scheme: Scheme,
    /// What stands in where there is no steady motion; only [`Scheme::Steady`] asks.
    pub without_steady: WithoutSteady,
    /// At least two, in the order of time.
    pub keys: &'a [Keyframe<Pose>],
    /// For each span, the whole turns to be added, as in
    /// [`Motion::from_keyframes_with_turns`](super::Motion::from_keyframes_with_turns); empty for
    /// none. [`Scheme::Linear`] and [`Scheme::Log`] have no axis for them.
    pub turns: &'a [i32],
}

impl<'a, Pose> Keyed<'a, Pose> {
    /// A scheme through keyframes without whole turns.
    pub fn new(scheme: Scheme, keys: &'a [Keyframe<Pose>]) -> Keyed<'a, Pose> {
        Keyed {
            scheme,
            without_steady: WithoutSteady::Refuse,
            keys,
            turns: &[],
        }
    }
}

impl Scheme {
    /// All schemes.
    pub const ALL: [Scheme; 7] = [
        Scheme::Steady,
        Scheme::Linear,
        Scheme::Polar,
        Scheme::Asap,
        Scheme::PolarLog,
        Scheme::Log,
        Scheme::Spiral,
    ];

    /// Its name in motion files.
    pub fn name(self) -> &'static str {
        match self {
            Scheme::Steady => "steady",
            Scheme::Linear => "linear",
            Scheme::Polar => "polar",
            Scheme::Asap => "asap",
            Scheme::PolarLog => "polar-log",
            Scheme::Log => "log",
            Scheme::Spiral => "spiral",
        }
    }
}
