//! The clock of a check: stretches of time during which every motion is one steady span.

use super::mover::Mover;
use super::shape::Shape;
use crate::bounds::box_corners;
use crate::motion::{Merged, Motion, Pace};
use crate::numeric::tolerance::JOINT_GAP;
use glam::DAffine3;

/// A stretch of the clock.
#[derive(Debug, Clone, Copy)]
pub(super) struct SteadyStage {
    pub(super) times: [f64; 2],
    /// Number of the span of the body's motion.
    pub(super) span: usize,
    /// Longest absence across its ends that is ignored.
    pub(super) gap: f64,
}

impl SteadyStage {
    /// The clock time at a local time in [0, 1]; exact at the ends.
    pub(super) fn clock(&self, local: f64) -> f64 {
        let [start, end] = self.times;
        if local >= 1.0 {
            end
        } else {
            (start + local * (end - start)).clamp(start, end)
        }
    }

    /// The local time of a time on the clock.
    pub(super) fn local(&self, clock: f64) -> f64 {
        let [start, end] = self.times;
        ((clock - start) / (end - start)).clamp(0.0, 1.0)
    }

    /// The mover of a shape during the stage; without a motion it rests in its place.
    pub(super) fn mover(&self, shape: &Shape, merged: Option<&Merged<Motion>>) -> Mover {
        let Some(Merged {
            motion, deviation, ..
        }) = merged
        else {
            return Mover::resting(DAffine3::IDENTITY, shape.bounds());
        };
        let times = motion.joint_times();
        let (first, last) = (times[0], times[times.len() - 1]);
        if self.times[1] <= first || self.times[0] >= last {
            return Mover::resting(motion.pose_at_time(self.times[0]), shape.bounds());
        }
        let span = motion.span_at_time(self.times[0]);
        let [start, end] = [times[span], times[span + 1]];
        let fraction = |time: f64| {
            if time >= end {
                1.0
            } else {
                (time - start) / (end - start)
            }
        };
        let base = motion.joints()[span] * *motion.start_pose();
        Mover::moving(
            motion.spans()[span].flow(),
            self.times.map(fraction),
            base,
            shape.bounds(),
        )
        .deviating(*deviation)
    }
}

/// Cuts the time of the body's motion at its own joints and at those of the others.
///
/// - `times`: clock times of the given joints, before merging.
pub(super) fn cut<'a>(
    body: &Merged<Motion>,
    times: &[f64],
    others: impl Iterator<Item = &'a Motion>,
) -> Vec<SteadyStage> {
    let motion = &body.motion;
    let own = motion.joint_times();
    let (first, last) = (own[0], own[own.len() - 1]);
    let mut cuts = own.to_vec();
    cuts.extend(others.flat_map(|other| other.joint_times()));
    cuts.retain(|time| (first..=last).contains(time));
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    let stage = |pair: &[f64]| {
        let span = motion.span_at_time(pair[0]);
        let given = body.spans_of(span).start;
        let shortest = (pair[1] - pair[0]).min(times[given + 1] - times[given]);
        SteadyStage {
            times: [pair[0], pair[1]],
            span,
            gap: JOINT_GAP * shortest,
        }
    };
    cuts.windows(2).map(stage).collect()
}

/// A motion with its runs merged, where this moves no point of the shape that it carries by more
/// than rounding.
pub(super) fn merged<'a>(motion: &'a Motion, shape: &Shape) -> Merged<'a, Motion> {
    let start = motion.start_pose();
    let corners = box_corners(shape.bounds()).map(|corner| start.transform_point3(corner));
    motion.merged(&corners, Pace::Even)
}

/// The span of `motion` at a time that lies in a span of the merged one.
pub(super) fn given_span(merged: &Merged<Motion>, motion: &Motion, run: usize, time: f64) -> usize {
    let spans = merged.spans_of(run);
    motion.span_at_time(time).clamp(spans.start, spans.end - 1)
}

/// The largest coordinate that movers reach; infinite where one is not a number.
pub(super) fn reach<'a>(movers: impl Iterator<Item = &'a Mover>) -> f64 {
    movers.map(Mover::reach).fold(0.0, |far: f64, next| {
        if next.is_nan() {
            f64::INFINITY
        } else {
            far.max(next)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{Generator, Span};
    use glam::DVec3;

    fn turn(axis: DVec3, through: DVec3) -> Generator {
        Generator::screw(axis, through, 1.0, 0.0, 1.0)
    }

    #[test]
    fn stages_end_at_every_joint_of_either_motion() {
        let motion = |durations: &[f64]| {
            let spans = durations
                .iter()
                .map(|&d| Span::new(turn(DVec3::Z, DVec3::X), d).expect("a span"));
            Motion::from_spans(spans.collect()).expect("a motion")
        };
        let (own, other) = (motion(&[1.0, 2.0]), motion(&[0.5, 1.0, 9.0]));
        let corners = [DVec3::ZERO, DVec3::ONE];
        let merged = own.merged(&corners, Pace::Any);
        assert_eq!(merged.spans_of(0), 0..2, "one turn");
        let merged = own.merged(&corners, Pace::Even);
        let found: Vec<_> = cut(&merged, own.joint_times(), [&other].into_iter())
            .iter()
            .map(|stage| (stage.times, stage.span))
            .collect();
        assert_eq!(
            found,
            [
                ([0.0, 0.5], 0),
                ([0.5, 1.0], 0),
                ([1.0, 1.5], 1),
                ([1.5, 3.0], 1)
            ]
        );
    }
}
