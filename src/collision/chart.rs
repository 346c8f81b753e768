//! The motion of a mover over a short window of time: the pose in its middle, and paths as
//! polynomials of the time from the middle.
//!
//! Key: m the middle of the window, h half its width, x0 = pose(m) p, from which the path of p is
//! expanded (`motion::expansion`). A product of two paths grows at twice the rate. For |M|
//! h <= [`LONGEST`], even such a product leaves a remainder below rounding after s^10; shorter
//! windows need fewer terms.

use crate::motion::Generator;
use crate::motion::expansion::{Curve, remainder};
use glam::{DAffine3, DVec3};

/// Largest sum of |M| times half the width of a window, over both movers, for which products of
/// paths are polynomials to rounding: (2 0.07)^10 / 11! < u.
pub(super) const LONGEST: f64 = 0.07;

/// The motion of a mover over one window.
#[derive(Debug, Clone)]
pub(super) struct Chart {
    /// The map from its own frame to the world, in the middle of the window.
    pub(super) pose: DAffine3,
    /// The velocity field.
    pub(super) generator: Generator,
    /// Number of coefficients of a path, 1 for a mover at rest.
    pub(super) terms: usize,
    /// Bound on the error of a position.
    pub(super) slack: f64,
    /// Bound on the acceleration of the box of the mover, and on its velocity.
    pub(super) acceleration: f64,
    pub(super) speed: f64,
    /// Bound on the norms of exp(sM) within the window.
    pub(super) stretch: f64,
    /// Half the width of the window, and |M| times that.
    pub(super) half: f64,
    pub(super) reduced_half: f64,
}

impl Chart {
    /// Bound on the acceleration of the box of the mover along a unit vector.
    ///
    /// n . x'' = n . M v = (M^T n) . v: a turn does not bend a path along its axis.
    pub(super) fn bend(&self, direction: DVec3) -> f64 {
        let rate = (self.generator.linear.transpose() * direction).length();
        self.acceleration.min(rate * self.speed)
    }

    /// Limits paths to this many terms, at least 2, and adds what they leave out to the slack.
    pub(super) fn shorten(&mut self, terms: usize) {
        let term = 0.5 * self.acceleration * self.half * self.half;
        self.terms = self.terms.min(terms);
        self.slack += remainder(term, 2, terms, self.reduced_half);
    }

    /// The path of a point of the mover's own frame.
    pub(super) fn curve(&self, point: DVec3) -> Curve {
        let mut curve = Curve::ORIGIN;
        self.draw(point, &mut curve);
        curve
    }

    /// Writes the path of a point of the mover's own frame into `curve`; coefficients that do not
    /// count are left unchanged.
    pub(super) fn draw(&self, point: DVec3, curve: &mut Curve) {
        let place = self.pose.transform_point3(point);
        curve.draw(&self.generator, place, self.terms);
    }
}

#[cfg(test)]
mod tests {
    use super::super::mover::Mover;
    use super::*;
    use crate::motion::{Flow, path_bounds};
    use glam::DMat3;

    #[test]
    fn paths_are_within_the_slack_of_the_exact_flow() {
        let bounds = [DVec3::splat(-1.0), DVec3::new(2.0, 1.0, 0.5)];
        let generators = [
            Generator::screw(DVec3::Z, DVec3::X, 18.0, 2.0, 1.0),
            Generator::screw(DVec3::Y, DVec3::new(30.0, 0.0, 0.0), 1.0, 0.0, 0.3),
            Generator::translation(DVec3::new(1.0, 2.0, 3.0)),
            Generator {
                linear: DMat3::from_cols(DVec3::ZERO, DVec3::X * 3.0, DVec3::ZERO),
                offset: DVec3::Z,
            },
            Generator {
                linear: DMat3::from_cols_array(&[0.3, 2.0, -0.4, -1.7, -0.5, 0.6, 0.2, -0.9, 0.1]),
                offset: DVec3::new(0.4, -0.7, 0.5),
            },
        ];
        for (number, generator) in generators.into_iter().enumerate() {
            let flow = Flow::new(generator);
            let mover = Mover::moving(&flow, [0.0, 1.0], DAffine3::IDENTITY, bounds);
            let half = (LONGEST / mover.size).min(0.1);
            for i in 0..20 {
                let middle = 0.5 * f64::from(i) / 19.0 + 0.25;
                let chart = mover.chart(middle, half, half * mover.size);
                for point in bounds {
                    let curve = chart.curve(point);
                    for share in [-1.0, -0.3, 0.0, 0.6, 1.0] {
                        let time = middle + share * half;
                        // A proven box around the place at that time, some 60 u wide.
                        let [low, high] = path_bounds(&generator, point, [time, time]);
                        let found = curve.at(chart.terms, time - middle);
                        let miss = (low - found).max(found - high).max(DVec3::ZERO).length();
                        assert!(
                            miss <= chart.slack,
                            "motion {number}: {miss:e} beyond {:e}",
                            chart.slack
                        );
                        assert!(
                            found.distance(low.midpoint(high))
                                <= chart.slack + (high - low).length(),
                            "motion {number} at {time}"
                        );
                    }
                }
            }
        }
    }
}
