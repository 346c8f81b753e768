//! How finely a span is sampled in time and along straight pieces, and the resulting error.

use super::alignment::aligned_step;
use crate::grazing::spatial::Interval;
use crate::motion::{Flow, Generator, stretch};
use crate::numeric::tolerance::{Budget, STEP_LIMIT};
use glam::{DAffine3, DMat3, DVec3};

/// Sampling of one span: equal steps in time, the last of which may be shorter, with their error
/// bounds.
#[derive(Debug, Clone)]
pub(crate) struct Sampling {
    /// Number of steps.
    pub(crate) steps: usize,
    /// Length of a step, as a share of the span.
    step: f64,
    generator: Generator,
    /// The pose after the first step: every step is an image of the first, or of its beginning.
    first_step: DAffine3,
    /// Bound on the growth of lengths from the start of the span.
    growth: f64,
}

impl Sampling {
    /// The sampling for paths through `points` (world, start of the span).
    pub(crate) fn new(
        flow: &Flow,
        points: impl Iterator<Item = DVec3> + Clone,
        budget: &Budget,
    ) -> Sampling {
        let uniform = Sampling::uniform(flow, points.clone(), budget);
        let (generator, steps) = (flow.generator(), uniform.steps);
        let step = aligned_step(generator, points, steps, budget.merge);
        let (steps, step) = step.map_or((steps, 1.0 / steps as f64), |step| {
            // A last step below the rounding of the time does not count.
            let whole = 1.0 / step;
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "at most twice the number of steps before"
            )]
            let count = (whole - SHORTEST_STEP).ceil().max(1.0) as usize;
            (count, step)
        });
        Sampling {
            steps,
            step,
            first_step: flow.pose_at(step),
            ..uniform
        }
    }

    /// As [`Sampling::new`], with the fewest steps of equal length, whatever comes to the same
    /// places.
    pub(crate) fn uniform(
        flow: &Flow,
        points: impl Iterator<Item = DVec3>,
        budget: &Budget,
    ) -> Sampling {
        let generator = flow.generator();
        let growth = stretch(&generator.linear, [0.0, 1.0]);
        let steps = fewest_steps(generator, growth, points, budget);
        let step = 1.0 / steps as f64;
        Sampling {
            steps,
            step,
            generator: *generator,
            first_step: flow.pose_at(step),
            growth,
        }
    }

    /// The time, in \[0, 1\], after a number of steps.
    pub(crate) fn time(&self, step: usize) -> f64 {
        if step == self.steps {
            1.0
        } else {
            step as f64 * self.step
        }
    }

    /// Whether the diagonal on the low side of the quadrilaterals that the segment from `a` to `b`
    /// (world, start of the span) sweeps, with which twist only adds, runs forward: from the start
    /// of the earlier segment to the end of the later one. It is the same in every step, since steps
    /// are affine images.
    pub(crate) fn is_low_forward(&self, a: DVec3, b: DVec3) -> bool {
        let step = &self.first_step;
        let twist = (step.transform_point3(b) - step.transform_point3(a)) - (b - a);
        let low = (b - a).cross(self.generator.velocity(a.midpoint(b)));
        twist.dot(low) > 0.0
    }

    /// The generator of the span, in the world.
    pub(crate) fn generator(&self) -> &Generator {
        &self.generator
    }

    /// Bound on the growth of lengths over the span.
    pub(crate) fn growth(&self) -> f64 {
        self.growth
    }

    /// The part of [`Sampling::error`] that is due to the twist of the segment.
    pub(crate) fn twist(&self, a: DVec3, b: DVec3) -> f64 {
        self.twist_error(a, b).bound()
    }

    /// Bound on the distance between the sheet of the segment from `a` to `b` (world, start of the
    /// span) and its triangles.
    ///
    /// A translation sweeps parallelograms: the only error is rounding, which is counted elsewhere.
    pub(crate) fn error(&self, a: DVec3, b: DVec3) -> f64 {
        if self.generator.linear == DMat3::ZERO {
            return 0.0;
        }
        self.bend(a).max(self.bend(b)) + self.twist_error(a, b).bound()
    }

    /// Bound on the distance between the path of a point (world, start of the span) and its chords.
    ///
    /// It is convex: that of a straight piece, or of a triangle, is the largest at its corners.
    pub(crate) fn bend(&self, p: DVec3) -> f64 {
        let acceleration = self.generator.acceleration(p).length();
        self.growth * acceleration * self.step * self.step / 8.0
    }

    /// Divides a segment, given by its points at parameters in \[0, 1\] (world, start of the span),
    /// so that no part twists by more than `budget` in a step. Returns the parameters of the ends
    /// of all parts, ascending.
    ///
    /// A twist bounded by its normal part decreases with the length of the part: the segment is
    /// divided into as many equal parts as needed. Where the segment moves along itself, only
    /// halving helps, and only there.
    pub(crate) fn divide(&self, at: impl Fn(f64) -> DVec3, budget: f64) -> Vec<f64> {
        let mut stops = vec![0.0];
        let mut parts = vec![(0.0, 1.0, 0)];
        while let Some((from, to, depth)) = parts.pop() {
            let twist = self.twist_error(at(from), at(to));
            let error = twist.bound();
            if error <= budget || depth == MOST_DIVISIONS {
                stops.push(to);
                continue;
            }
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "positive and at most 1000"
            )]
            let count = match twist {
                Twist::Normal(error) => (error / budget).ceil().clamp(2.0, 1000.0) as usize,
                Twist::Whole(_) => 2,
            };
            let stop = |i: usize| {
                if i == count {
                    to
                } else {
                    from + (to - from) * (i as f64 / count as f64)
                }
            };
            parts.extend((0..count).rev().map(|i| (stop(i), stop(i + 1), depth + 1)));
        }
        stops
    }

    /// The parameters, on its line, of the ends of the parts of an interval, ascending, none of
    /// which twists by more than `budget` in a step.
    ///
    /// `frame`: pose of the start of the span relative to the start of the motion.
    pub(crate) fn divide_interval(
        &self,
        interval: &Interval,
        frame: &DAffine3,
        budget: f64,
    ) -> Vec<f64> {
        let [from, to] = interval.ends;
        let place = |share: f64| {
            if share == 1.0 {
                to
            } else {
                from + (to - from) * share
            }
        };
        let at = |share: f64| frame.transform_point3(interval.at(place(share)));
        let shares = self.divide(at, budget);
        shares.into_iter().map(place).collect()
    }

    /// Bound on the distance between the ruled patch that the segment from `a` to `b` (world, start
    /// of the span) sweeps in one step and its two triangles, for either diagonal, over the whole
    /// span.
    ///
    /// The patch lies in the tetrahedron of its corners. Seen along the common normal of its
    /// diagonals, where the quadrilateral is convex, each of its points stands above or below a
    /// triangle by at most a quarter of the twist's normal part; elsewhere a quarter of the whole
    /// twist bounds the distance.
    fn twist_error(&self, a: DVec3, b: DVec3) -> Twist {
        let [a_next, b_next] = [a, b].map(|p| self.first_step.transform_point3(p));
        let twist = (b_next - a_next) - (b - a);
        let whole = twist.length() / 4.0;
        let view = (b_next - a).cross(a_next - b).normalize_or_zero();
        let corners = [a, b, b_next, a_next];
        let normals = [0, 1, 2, 3].map(|i| {
            let [p, q, r] = [corners[i], corners[(i + 1) % 4], corners[(i + 2) % 4]];
            (q - p).cross(r - p)
        });
        let faces_view = |sign: f64| {
            normals
                .iter()
                .all(|n| sign * n.dot(view) * 2.0 > n.length())
        };
        if !faces_view(1.0) && !faces_view(-1.0) {
            return Twist::Whole(whole * self.growth);
        }
        let normal = normals
            .iter()
            .map(|n| (twist.dot(*n) / n.dot(view)).abs() / 4.0)
            .fold(0.0, f64::max);
        Twist::Normal(normal.min(whole) * self.growth)
    }
}

/// The number of equal steps of a span for paths through `points` (world, start of the span),
/// before they are aligned.
///
/// - `growth`: bound on the growth of lengths over the span.
pub(super) fn fewest_steps(
    generator: &Generator,
    growth: f64,
    points: impl Iterator<Item = DVec3>,
    budget: &Budget,
) -> usize {
    // |d2/dt2 exp(tG) p| = |exp(tM) M v(p)|: convex in p, so the ends of straight pieces bound the
    // pieces.
    let bend = growth
        * points
            .map(|p| generator.acceleration(p).length())
            .fold(0.0, f64::max);
    if bend == 0.0 {
        return 1;
    }
    let by_chord = (bend / (8.0 * budget.chord)).sqrt();
    let count = by_chord.max(generator.size() / STEP_LIMIT).ceil().max(1.0);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positive; saturates"
    )]
    let count = count as usize;
    count
}

/// Shortest last step, as a share of the others.
const SHORTEST_STEP: f64 = 1e-6;

/// Most times that a segment is divided again before its twist is accepted (and counted in the
/// bound): parts of 2^-30 of a segment are at the rounding of their ends.
const MOST_DIVISIONS: usize = 30;

/// A bound on the error from a segment's twist in a step, and the part of the twist on which it
/// rests.
#[derive(Debug, Clone, Copy)]
enum Twist {
    /// The part that is normal to the patch.
    Normal(f64),
    /// The whole twist: the patch overlaps itself.
    Whole(f64),
}

impl Twist {
    fn bound(self) -> f64 {
        match self {
            Twist::Normal(error) | Twist::Whole(error) => error,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn budget(chord: f64) -> Budget {
        Budget {
            chord,
            twist: 1.0,
            fold: 0.0,
            merge: 0.0,
            dent: 0.0,
        }
    }

    #[test]
    fn steps_follow_from_the_acceleration() {
        // A point on the unit circle that turns by 1: the acceleration is 1, and chords of n steps
        // are off by 1 / (8 n^2).
        let turn = Generator::screw(DVec3::Z, DVec3::ZERO, 1.0, 0.0, 1.0);
        let steps = |chord: f64| fewest_steps(&turn, 1.0, [DVec3::X].into_iter(), &budget(chord));
        assert_eq!(steps(1.01 / (8.0 * 20.0 * 20.0)), 20);
        assert_eq!(steps(0.99 / (8.0 * 20.0 * 20.0)), 21);
        // However coarse the sampling, no step turns by more than the limit.
        let fewest = (turn.size() / STEP_LIMIT).ceil();
        assert_eq!(steps(1.0) as f64, fewest);
    }

    #[test]
    fn a_translation_is_one_step_without_error() {
        let flow = Flow::new(Generator::translation(DVec3::new(3.0, 2.0, 1.0)));
        let ends = [DVec3::ZERO, DVec3::new(0.0, 0.0, 5.0)];
        let sampling = Sampling::new(&flow, ends.into_iter(), &budget(1e-9));
        assert_eq!(sampling.steps, 1);
        assert_eq!([0, 1].map(|step| sampling.time(step)), [0.0, 1.0]);
        assert_eq!(sampling.error(ends[0], ends[1]), 0.0);
        let along = |t: f64| ends[0].lerp(ends[1], t);
        assert_eq!(sampling.divide(along, 1e-9), [0.0, 1.0], "nothing twists");
    }

    #[test]
    fn a_segment_that_twists_is_divided_until_each_part_twists_little() {
        // A segment across the axis of a screw: its ends move against each other.
        let flow = Flow::new(Generator::screw(DVec3::X, DVec3::ZERO, 1.0, 1.0, 1.0));
        let along = |t: f64| DVec3::new(0.0, 1.0, 0.0).lerp(DVec3::new(0.5, 0.0, 2.0), t);
        let sampling = Sampling::new(&flow, [0.0, 1.0].map(along).into_iter(), &budget(1e-2));
        let whole = sampling.twist(along(0.0), along(1.0));
        let stops = sampling.divide(along, whole / 8.0);
        assert!(stops.len() > 2, "{stops:?}");
        assert!(stops.is_sorted() && stops[0] == 0.0 && stops[stops.len() - 1] == 1.0);
        for pair in stops.windows(2) {
            assert!(sampling.twist(along(pair[0]), along(pair[1])) <= whole / 8.0);
        }
    }
}
