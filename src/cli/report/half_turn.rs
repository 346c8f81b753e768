//! What reports say below the line of a motion: its deviation, and half turns between keyframes.

use super::quantities::Vector;
use super::{DeviationReport, MotionSummary};
use crate::motion::{Motion, planar};
use std::fmt;

/// A span that is a half turn between keyframes: the two poses leave its sense open, so that it was
/// chosen.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct HalfTurnReport {
    /// Number of the span, counted from 0.
    pub(crate) span: usize,
    /// `+`, by the right-hand rule about `axis`, in the plane from x towards y; or `-`.
    pub(crate) sense: &'static str,
    /// Unit vector; `None` in the plane.
    pub(crate) axis: Option<[f64; 3]>,
}

impl HalfTurnReport {
    /// The half turns of a motion.
    pub(super) fn all(motion: &Motion) -> Vec<HalfTurnReport> {
        let spans = motion.spans().iter().enumerate();
        let half_turns = spans.filter_map(|(span, steady)| Some((span, steady.half_turn()?)));
        half_turns
            .map(|(span, half_turn)| HalfTurnReport {
                span,
                sense: half_turn.sense.symbol(),
                axis: Some(half_turn.axis.to_array()),
            })
            .collect()
    }
}

impl From<&Motion> for MotionSummary {
    fn from(motion: &Motion) -> MotionSummary {
        MotionSummary {
            spans: motion.spans().len(),
            half_turns: HalfTurnReport::all(motion),
            deviation: DeviationReport::of(motion),
        }
    }
}

impl From<&planar::Motion> for MotionSummary {
    fn from(motion: &planar::Motion) -> MotionSummary {
        let spans = motion.spans().iter().enumerate();
        let half_turns = spans.filter_map(|(span, steady)| Some((span, steady.half_turn()?)));
        MotionSummary {
            spans: motion.spans().len(),
            half_turns: half_turns
                .map(|(span, sense)| HalfTurnReport {
                    span,
                    sense: sense.symbol(),
                    axis: None,
                })
                .collect(),
            deviation: DeviationReport::of(motion),
        }
    }
}

/// Most half turns that a text lists.
const LISTED: usize = 10;

/// Lines for the deviation and for each half turn, below the line of the motion.
pub(super) fn write_details(
    f: &mut fmt::Formatter<'_>,
    deviation: Option<&DeviationReport>,
    half_turns: &[HalfTurnReport],
) -> fmt::Result {
    if let Some(deviation) = deviation {
        write!(f, "{deviation}")?;
    }
    for half_turn in half_turns.iter().take(LISTED) {
        write!(f, "        span {} is a half turn", half_turn.span + 1)?;
        if let Some(axis) = half_turn.axis {
            write!(f, " about {}", Vector(axis))?;
        }
        writeln!(
            f,
            " in the sense {}, as chosen; the other sense leads to the same pose",
            half_turn.sense
        )?;
    }
    match half_turns.len().saturating_sub(LISTED) {
        0 => Ok(()),
        more => writeln!(f, "        and {more} more half turns"),
    }
}
