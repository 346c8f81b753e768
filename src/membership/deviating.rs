//! Whether a point is ever inside a body whose motion may deviate from the one that it stands for.
//!
//! The chain of steady spans is off by at most D at any time. So the point is certainly inside at
//! times at which it is deeper than D in the body as the chain moves it, and certainly outside as
//! long as it is farther than D from it. The distance from the surface changes at most as fast as
//! points of the body move: between two times it is bounded by that in the middle.

use crate::motion::chain::{Motion, Steady};
use crate::motion::{Deviation, least_stretch, stretch};
use crate::numeric::tolerance::{PATH_ROUNDING, UNIT_ROUNDOFF};
use glam::DVec3;

/// Times per interval at which the depth is looked at.
const LOOKS: u32 = 16;
/// Most halvings of a span in search of a proof.
const MOST_HALVINGS: u32 = 24;

/// A motion that stands for another one.
#[derive(Debug)]
pub(super) struct Deviating<F: Steady> {
    motion: Motion<F>,
    deviation: Deviation,
    /// Whether the deviation holds for the body.
    covers: bool,
    /// Per span, a bound on the displacement of points of the body by the whole of it.
    speeds: Vec<f64>,
    /// Bound on the rounding of positions.
    rounding: f64,
}

impl<F: Steady> Deviating<F> {
    /// `None` for a motion that stands for itself.
    ///
    /// - `corners`: of a box around the body, in its frame.
    pub(super) fn new(motion: &Motion<F>, corners: &[DVec3]) -> Option<Deviating<F>> {
        let deviation = *motion.deviation()?;
        let covers = {
            let low = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
            let high = corners
                .iter()
                .copied()
                .fold(DVec3::NEG_INFINITY, DVec3::max);
            deviation.covers(low, high)
        };
        let mut reach = 0.0_f64;
        let speeds = motion
            .spans()
            .iter()
            .zip(motion.poses())
            .map(|(span, pose)| {
                let (generator, pose) = (span.flow().generator_in_space(), F::pose_in_space(pose));
                let speeds = corners.iter().map(|&corner| {
                    let place = pose.transform_point3(corner);
                    reach = reach.max(place.length());
                    generator.velocity(place).length()
                });
                speeds.fold(0.0, f64::max) * stretch(&generator.linear, [0.0, 1.0])
            });
        let speeds: Vec<f64> = speeds.collect();
        let travel = speeds.iter().copied().fold(0.0, f64::max);
        Some(Deviating {
            motion: motion.clone(),
            deviation,
            covers,
            rounding: PATH_ROUNDING * UNIT_ROUNDOFF * (reach + travel),
            speeds,
        })
    }

    /// Whether a point is ever inside; `None` where the deviation decides.
    ///
    /// - `intervals`: the times at which the chain has it inside.
    /// - `distance`: from the surface of the body, of a point in the frame of the body.
    pub(super) fn is_ever_inside(
        &self,
        point: DVec3,
        intervals: &[[f64; 2]],
        distance: &dyn Fn(DVec3) -> f64,
    ) -> Option<bool> {
        if !(self.covers && self.deviation.proven && point.is_finite()) {
            return None;
        }
        // A lower bound of the distance in the world.
        let apart = |time: f64| {
            let pose = F::pose_in_space(&self.motion.pose_at_time(time));
            let inverse = pose.inverse();
            least_stretch(&pose.matrix3) * distance(inverse.transform_point3(point)) - self.rounding
        };
        if intervals.is_empty() {
            return self.is_outside(&apart).then_some(false);
        }
        let looks = |[start, end]: [f64; 2]| {
            (0..=LOOKS).map(move |look| start + (end - start) * f64::from(look) / f64::from(LOOKS))
        };
        let mut times = intervals.iter().copied().flat_map(looks);
        times
            .any(|time| apart(time) > self.deviation.length)
            .then_some(true)
    }

    /// Whether a point that the chain never has inside is always farther away than the deviation.
    fn is_outside(&self, apart: &dyn Fn(f64) -> f64) -> bool {
        let times = self.motion.joint_times();
        self.speeds
            .iter()
            .zip(times.windows(2))
            .all(|(speed, times)| {
                let mut open = vec![([times[0], times[1]], 0, *speed)];
                while let Some(([start, end], halvings, travel)) = open.pop() {
                    let middle = 0.5 * (start + end);
                    let distance = apart(middle);
                    if distance - 0.5 * travel > self.deviation.length {
                        continue;
                    }
                    // NaN is no proof.
                    let is_apart = distance > self.deviation.length;
                    if !is_apart || halvings == MOST_HALVINGS {
                        return false;
                    }
                    open.push(([start, middle], halvings + 1, 0.5 * travel));
                    open.push(([middle, end], halvings + 1, 0.5 * travel));
                }
                true
            })
    }
}
