//! How finely a span is sampled in time and along straight pieces, and what that misses.

use crate::motion::{Generator, stretch};
use crate::numeric::tolerance::{Budget, STEP_LIMIT};
use glam::{DAffine3, DVec3};

/// Sampling of one span: equal steps in time, with their error bounds.
#[derive(Debug, Clone)]
pub(crate) struct Sampling {
    /// Number of steps.
    pub(crate) steps: usize,
    /// Bound on the distance between a path and its chords, over the whole span.
    pub(crate) chord_error: f64,
    /// The first step, exp(G / steps): every step is an image of it.
    first_step: DAffine3,
    /// Bound on the growth of lengths from the start of the span.
    growth: f64,
}

impl Sampling {
    /// Steps for paths through `points` (world, start of the span).
    pub(crate) fn new(
        generator: &Generator,
        flow_at: impl Fn(f64) -> DAffine3,
        points: impl Iterator<Item = DVec3>,
        budget: &Budget,
    ) -> Sampling {
        let growth = stretch(&generator.linear, [0.0, 1.0]);
        // |d2/dt2 exp(tG) p| = |exp(tM) M v(p)|: convex in p, so the ends of straight pieces bound the pieces.
        let bend = growth
            * points
                .map(|p| generator.acceleration(p).length())
                .fold(0.0, f64::max);
        let steps = if bend == 0.0 {
            1
        } else {
            let linear = generator
                .linear
                .to_cols_array()
                .iter()
                .map(|m| m * m)
                .sum::<f64>()
                .sqrt();
            let by_chord = (bend / (8.0 * budget.chord)).sqrt();
            let count = by_chord.max(linear / STEP_LIMIT).ceil().max(1.0);
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "positive; saturates"
            )]
            let count = count as usize;
            count
        };
        let step = 1.0 / steps as f64;
        Sampling {
            steps,
            chord_error: bend * step * step / 8.0,
            first_step: flow_at(step),
            growth,
        }
    }

    /// Bound on the distance between the ruled patch that the segment from `a` to `b` (world, start of the span)
    /// sweeps in one step and its two triangles, in whichever way it is divided; over the whole span.
    ///
    /// The patch lies in the tetrahedron of its corners. Seen along the common normal of its diagonals, where the
    /// quadrilateral is convex, each of its points stands above or below a triangle by at most a quarter of the
    /// twist's normal part; elsewhere a quarter of the whole twist bounds the distance.
    pub(crate) fn twist_error(&self, a: DVec3, b: DVec3) -> f64 {
        let [a_next, b_next] = [a, b].map(|p| self.first_step.transform_point3(p));
        let twist = (b_next - a_next) - (b - a);
        let whole = twist.length() / 4.0;
        let view = (b_next - a).cross(a_next - b).normalize_or_zero();
        let corners = [a, b, b_next, a_next];
        let mut error: f64 = 0.0;
        for i in 0..4 {
            let [p, q, r] = [corners[i], corners[(i + 1) % 4], corners[(i + 2) % 4]];
            let normal = (q - p).cross(r - p);
            let facing = normal.dot(view);
            if facing.abs() * 2.0 < normal.length()
                || facing.signum() != first_facing(&corners, view)
            {
                return whole * self.growth;
            }
            error = error.max((twist.dot(normal) / facing).abs() / 4.0);
        }
        error.min(whole) * self.growth
    }
}

fn first_facing(corners: &[DVec3; 4], view: DVec3) -> f64 {
    (corners[1] - corners[0])
        .cross(corners[2] - corners[0])
        .dot(view)
        .signum()
}
