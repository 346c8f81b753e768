//! The motion in runs: spans that follow each other without a gap, with no span longer than one
//! period.
//!
//! A rotation by more than one full turn covers nothing new after its first turn, but its sheets
//! would lie on themselves, separated only by their sampling errors. So it is cut off after one
//! period, and the run ends there; what follows begins another run. Winding numbers of runs add up,
//! and each is positive where its spans sweep.

use crate::motion::{Flow, Motion, MotionKind, Span};
use glam::DAffine3;
use std::ops::Range;

/// Consecutive spans, each of which begins where the one before ends.
#[derive(Debug)]
pub(crate) struct Run {
    /// Poses relative to the start of the motion, one more than there are spans.
    pub(crate) frames: Vec<DAffine3>,
    /// Flows of the spans, in the world, each over a time of 1.
    pub(crate) flows: Vec<Flow>,
    /// The shares of the spans that the flows cover: 1, or one period.
    pub(crate) covered: Vec<f64>,
}

impl Run {
    /// The run of some of its spans, by their numbers.
    pub(crate) fn part(&self, spans: Range<usize>) -> Run {
        Run {
            frames: self.frames[spans.start..=spans.end].to_vec(),
            flows: self.flows[spans.clone()].to_vec(),
            covered: self.covered[spans].to_vec(),
        }
    }
}

/// The runs of a motion, in order.
pub(crate) fn runs(motion: &Motion) -> Vec<Run> {
    let mut runs = Vec::new();
    let mut current: Option<Run> = None;
    for (span, frames) in motion.spans().iter().zip(motion.joints().windows(2)) {
        let run = current.get_or_insert_with(|| Run {
            frames: vec![frames[0]],
            flows: Vec::new(),
            covered: Vec::new(),
        });
        match first_period(span) {
            None => {
                run.flows.push(span.flow().clone());
                run.covered.push(1.0);
                run.frames.push(frames[1]);
            }
            Some((turn, covered)) => {
                run.flows.push(turn);
                run.covered.push(covered);
                run.frames.push(frames[0]);
                runs.extend(current.take());
            }
        }
    }
    runs.extend(current);
    runs
}

/// One turn of a rotation by more than one turn, and its share of the span.
fn first_period(span: &Span) -> Option<(Flow, f64)> {
    let description = span.describe();
    let turns = description.turn_deg? / 360.0;
    (description.kind == MotionKind::Rotation && turns > 1.0).then(|| {
        (
            Flow::new(span.flow().generator().scaled(1.0 / turns)),
            1.0 / turns,
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Generator;
    use glam::DVec3;
    use std::f64::consts::TAU;

    fn motion(turns: &[f64]) -> Motion {
        let span = |turn: &f64| {
            Span::new(
                Generator::screw(DVec3::Z, DVec3::X, turn * TAU, 0.0, 1.0),
                1.0,
            )
        };
        let spans: Result<Vec<Span>, _> = turns.iter().map(span).collect();
        Motion::from_spans(spans.expect("turns are spans")).expect("spans are a motion")
    }

    #[test]
    fn two_and_a_half_turns_are_one_run_of_one_turn() {
        let runs = runs(&motion(&[2.5]));
        assert_eq!(runs.len(), 1, "one span");
        assert_eq!(
            runs[0].frames,
            [DAffine3::IDENTITY; 2],
            "back where it began"
        );
        assert!((runs[0].covered[0] - 0.4).abs() < 1e-12, "of the span");
        let end = runs[0].flows[0].pose_at(1.0);
        assert!(
            end.abs_diff_eq(DAffine3::IDENTITY, 1e-14),
            "one whole turn, not {end:?}"
        );
    }

    #[test]
    fn the_span_after_a_long_turn_begins_where_the_turn_ends() {
        let motion = motion(&[0.25, 1.5, 0.25]);
        let runs = runs(&motion);
        assert_eq!(runs.len(), 2, "cut after the long turn");
        assert_eq!(
            runs[0].flows.len(),
            2,
            "the quarter turn and one whole turn"
        );
        assert_eq!(runs[1].frames[0], motion.joints()[2], "half a turn later");
    }

    #[test]
    fn a_whole_turn_is_not_cut() {
        assert_eq!(runs(&motion(&[1.0, 0.5])).len(), 1, "nothing to cut off");
    }
}
