//! The path of a point that a motion carries, as positions and velocities at times.

use super::chain::{Motion, Steady};

/// The path of a point that is fixed on a body, as the motion carries it through the world.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use std::f64::consts::PI;
/// use steadysweep::motion::{Generator, Motion, Span};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // Half a turn about the z axis in two units of time, then up in one.
/// let turn = Generator::screw(DVec3::Z, DVec3::ZERO, PI, 0.0, 1.0);
/// let rise = Generator::translation(DVec3::Z);
/// let motion = Motion::from_spans(vec![Span::new(turn, 2.0)?, Span::new(rise, 1.0)?])?;
///
/// let path = motion.trajectory(DVec3::X);
/// assert!(path.position(1.0).distance(DVec3::Y) < 1e-15);
/// assert!(path.velocity(1.0).distance(DVec3::NEG_X * PI / 2.0) < 1e-15);
/// assert_eq!(path.velocity(2.5), DVec3::Z);
/// assert!(path.joints().last().is_some_and(|end| end.distance(DVec3::new(-1.0, 0.0, 1.0)) < 1e-15));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Trajectory<'a, F: Steady> {
    motion: &'a Motion<F>,
    point: F::Point,
}

impl<F: Steady> Motion<F> {
    /// The path of a point of the body, given in the body's own frame.
    pub fn trajectory(&self, point: F::Point) -> Trajectory<'_, F> {
        Trajectory {
            motion: self,
            point,
        }
    }
}

impl<F: Steady> Trajectory<'_, F> {
    /// Position in the world at a time on the clock; before and after the motion the point rests.
    pub fn position(&self, clock: f64) -> F::Point {
        F::carried(&self.motion.pose_at_time(clock), self.point)
    }

    /// Velocity in the world at a time on the clock, per unit of the clock; zero before and after
    /// the motion. At a joint it jumps: it is that of the span that begins there, and at the end
    /// that of the last one.
    pub fn velocity(&self, clock: f64) -> F::Point {
        let times = self.motion.joint_times();
        let span = &self.motion.spans()[self.motion.span_at_time(clock)];
        let rate = if clock < times[0] || clock > times[times.len() - 1] {
            0.0
        } else {
            1.0 / span.duration()
        };
        span.flow().velocity(self.position(clock)) * rate
    }

    /// The positions at the start of the motion, at the joints and at the end: at
    /// [`Motion::joint_times`].
    pub fn joints(&self) -> impl Iterator<Item = F::Point> + '_ {
        let times = self.motion.joint_times().iter();
        times.map(|&time| self.position(time))
    }
}

#[cfg(test)]
mod tests {
    use crate::motion::planar;
    use crate::motion::{Keyframe, Motion};
    use glam::{DAffine2, DAffine3, DQuat, DVec2, DVec3};

    #[test]
    fn the_velocity_is_the_derivative_of_the_position() {
        let pose = |angle: f64, scale: f64| {
            DAffine3::from_scale_rotation_translation(
                DVec3::new(scale, 1.0, 0.8),
                DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), angle),
                DVec3::new(angle, scale, 1.0),
            )
        };
        let key = |time, pose| Keyframe { time, pose };
        let keys = [
            key(-1.0, pose(0.3, 1.0)),
            key(0.5, pose(1.4, 2.0)),
            key(4.0, pose(-0.2, 0.7)),
        ];
        let motion = Motion::from_keyframes(&keys).expect("a legal chain");
        let path = motion.trajectory(DVec3::new(2.0, -1.0, 0.5));
        let step = 1e-5;
        for clock in [-0.9, -0.1, 0.4, 0.6, 2.0, 3.9] {
            let difference = path.position(clock + step) - path.position(clock - step);
            let error = path.velocity(clock).distance(difference / (2.0 * step));
            // The third derivative times a sixth of the square of the step, and rounding.
            assert!(error < 1e-8, "{error:e} at {clock}");
        }
        assert_eq!(path.velocity(-1.1), DVec3::ZERO, "rests before");
        assert_eq!(path.velocity(4.1), DVec3::ZERO, "rests after");
        for (place, key) in path.joints().zip(&keys) {
            assert_eq!(place, key.pose.transform_point3(DVec3::new(2.0, -1.0, 0.5)));
        }
    }

    #[test]
    fn points_of_the_plane_move_likewise() {
        let turn = planar::Generator::spiral(DVec2::X, 2.0, 1.0);
        let span = planar::Span::new(turn, 4.0).expect("a span");
        let motion = planar::Motion::from_spans(vec![span]).expect("a motion");
        let path = motion.trajectory(DVec2::new(3.0, 0.0));
        let expected = DVec2::X + 2.0 * DVec2::from_angle(0.5);
        assert!(path.position(1.0).distance(expected) < 1e-15);
        let expected = DVec2::from_angle(0.5).perp();
        assert!(path.velocity(1.0).distance(expected) < 1e-15);
        assert_eq!(
            path.joints().count(),
            motion.joint_times().len(),
            "start and end"
        );
        assert_eq!(*motion.start_pose(), DAffine2::IDENTITY, "as it was given");
    }
}
