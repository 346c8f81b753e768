//! The flows of space as links of a chain.

use super::chain::{Steady, sealed::Sealed};
use super::logarithm::{check_pose, logarithm_of};
use super::{Flow, Generator, HalfTurn, Logarithm, MotionError, Sense};
use crate::numeric::tolerance::{RELATIVE_POSE, UNIT_ROUNDOFF};
use glam::{DAffine3, DVec3};

impl Sealed for Flow {}

impl Steady for Flow {
    type Generator = Generator;
    type Pose = DAffine3;
    type Point = DVec3;
    type HalfTurn = HalfTurn;

    const IDENTITY: DAffine3 = DAffine3::IDENTITY;

    fn of_generator(generator: Generator) -> Option<Flow> {
        generator.is_finite().then(|| Flow::new(generator))
    }

    fn pose_at(&self, t: f64) -> DAffine3 {
        self.pose_at(t)
    }

    fn turns(&self) -> f64 {
        Flow::turns(self)
    }

    fn is_usable(pose: &DAffine3) -> bool {
        let determinant = pose.matrix3.determinant();
        pose.is_finite() && determinant.is_finite() && determinant > 0.0
    }

    fn check_pose(pose: &DAffine3) -> Result<(), MotionError> {
        check_pose(pose)
    }

    fn relative(from: &DAffine3, to: &DAffine3) -> DAffine3 {
        if from.matrix3 == to.matrix3 {
            return DAffine3::from_translation(to.translation - from.translation);
        }
        let matrix3 = to.matrix3 * from.matrix3.inverse();
        DAffine3 {
            matrix3,
            translation: to.translation - matrix3 * from.translation,
        }
    }

    fn between(
        from: &DAffine3,
        to: &DAffine3,
        sense: Option<Sense>,
        turns: i32,
    ) -> Result<Logarithm, MotionError> {
        logarithm_of(
            &Flow::relative(from, to),
            relative_rounding(from, to),
            sense,
            turns,
        )
    }

    fn sense_axis(turn: DVec3) -> Option<DVec3> {
        turn.try_normalize()
    }

    fn axis_of(half_turn: &HalfTurn) -> Option<DVec3> {
        Some(half_turn.axis)
    }

    fn generator_in_space(&self) -> Generator {
        *self.generator()
    }

    fn of_generator_in_space(generator: &Generator) -> Flow {
        Flow::new(*generator)
    }

    fn pose_of_space(pose: &DAffine3) -> DAffine3 {
        *pose
    }

    fn pose_in_space(pose: &DAffine3) -> DAffine3 {
        *pose
    }

    fn carried(pose: &DAffine3, point: DVec3) -> DVec3 {
        pose.transform_point3(point)
    }

    fn velocity(&self, place: DVec3) -> DVec3 {
        self.generator().velocity(place)
    }

    fn point_in_space(point: DVec3) -> DVec3 {
        point
    }
}

/// Bound on the rounding of the entries of the linear part of [`Steady::relative`].
fn relative_rounding(from: &DAffine3, to: &DAffine3) -> f64 {
    if from.matrix3 == to.matrix3 {
        return 0.0;
    }
    let inverse = from.matrix3.inverse();
    let sizes = [to.matrix3, inverse, from.matrix3, inverse].map(|matrix| matrix.abs());
    let product = sizes[0] * sizes[1] * (sizes[2] * sizes[3]);
    let largest = product.to_cols_array().into_iter().fold(0.0, f64::max);
    RELATIVE_POSE * UNIT_ROUNDOFF * largest
}
