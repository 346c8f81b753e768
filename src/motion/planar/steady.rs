//! The flows of the plane as links of a chain.

use super::logarithm::{check_pose, logarithm_of};
use super::{Flow, Generator, Logarithm, in_space};
use crate::motion::chain::{Steady, sealed::Sealed};
use crate::motion::{self, MotionError, Sense};
use crate::numeric::tolerance::{RELATIVE_POSE, UNIT_ROUNDOFF};
use glam::{DAffine2, DAffine3, DMat2, DVec2, DVec3};

impl Sealed for Flow {}

impl Steady for Flow {
    type Generator = Generator;
    type Pose = DAffine2;
    type Point = DVec2;
    type HalfTurn = Sense;

    const IDENTITY: DAffine2 = DAffine2::IDENTITY;

    fn of_generator(generator: Generator) -> Option<Flow> {
        generator.is_finite().then(|| Flow::new(generator))
    }

    fn pose_at(&self, t: f64) -> DAffine2 {
        self.pose_at(t)
    }

    fn turns(&self) -> f64 {
        Flow::turns(self)
    }

    fn is_usable(pose: &DAffine2) -> bool {
        let determinant = pose.matrix2.determinant();
        pose.is_finite() && determinant.is_finite() && determinant > 0.0
    }

    fn check_pose(pose: &DAffine2) -> Result<(), MotionError> {
        check_pose(pose)
    }

    fn relative(from: &DAffine2, to: &DAffine2) -> DAffine2 {
        if from.matrix2 == to.matrix2 {
            return DAffine2::from_translation(to.translation - from.translation);
        }
        let matrix2 = to.matrix2 * from.matrix2.inverse();
        DAffine2 {
            matrix2,
            translation: to.translation - matrix2 * from.translation,
        }
    }

    fn between(
        from: &DAffine2,
        to: &DAffine2,
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

    fn sense_axis(_: DVec3) -> Option<DVec3> {
        Some(DVec3::Z)
    }

    fn axis_of(_: &Sense) -> Option<DVec3> {
        None
    }

    fn generator_in_space(&self) -> motion::Generator {
        self.generator().in_space()
    }

    fn of_generator_in_space(generator: &motion::Generator) -> Flow {
        Flow::new(Generator::in_plane(generator))
    }

    fn pose_of_space(pose: &DAffine3) -> DAffine2 {
        DAffine2 {
            matrix2: DMat2::from_mat3(pose.matrix3),
            translation: pose.translation.truncate(),
        }
    }

    fn pose_in_space(pose: &DAffine2) -> DAffine3 {
        in_space(pose)
    }

    fn carried(pose: &DAffine2, point: DVec2) -> DVec2 {
        pose.transform_point2(point)
    }

    fn velocity(&self, place: DVec2) -> DVec2 {
        self.generator().velocity(place)
    }

    fn point_in_space(point: DVec2) -> DVec3 {
        point.extend(0.0)
    }
}

/// Bound on the rounding of the entries of the linear part of [`Steady::relative`].
fn relative_rounding(from: &DAffine2, to: &DAffine2) -> f64 {
    if from.matrix2 == to.matrix2 {
        return 0.0;
    }
    let inverse = from.matrix2.inverse();
    let sizes = [to.matrix2, inverse, from.matrix2, inverse].map(|matrix| matrix.abs());
    let product = sizes[0] * sizes[1] * (sizes[2] * sizes[3]);
    let largest = product.to_cols_array().into_iter().fold(0.0, f64::max);
    RELATIVE_POSE * UNIT_ROUNDOFF * largest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::HalfTurns;
    use crate::motion::planar::{Keyframe, Motion, Span};
    use std::f64::consts::PI;

    fn key(time: f64, pose: DAffine2) -> Keyframe {
        Keyframe { time, pose }
    }
    fn turned(angle: f64) -> DAffine2 {
        DAffine2::from_angle_translation(angle, DVec2::new(1.0, 2.0))
    }
    fn difference(a: &DAffine2, b: &DAffine2) -> f64 {
        (a.matrix2 - b.matrix2)
            .to_cols_array()
            .iter()
            .fold((a.translation - b.translation).length(), |m, x| {
                m.max(x.abs())
            })
    }

    #[test]
    fn keyframes_are_met_at_their_times() {
        let stretched = DAffine2 {
            matrix2: turned(1.5).matrix2 * DMat2::from_diagonal(DVec2::new(2.0, 0.5)),
            translation: DVec2::Y,
        };
        let keys = [
            key(-1.0, turned(0.3)),
            key(0.5, stretched),
            key(2.0, turned(-0.4)),
            key(7.0, turned(0.3)),
        ];
        let motion = Motion::from_keyframes(&keys).expect("a legal chain");
        assert_eq!(
            motion.joint_times(),
            [-1.0, 0.5, 2.0, 7.0],
            "the clock of the keys"
        );
        for (index, key) in keys.iter().enumerate() {
            assert_eq!(
                motion.pose_at_time(key.time),
                key.pose,
                "key {index} is met exactly"
            );
            let before = motion.pose_at_time(key.time.next_down());
            assert!(
                difference(&before, &key.pose) < 1e-13,
                "and reached continuously: {before:?}"
            );
            let through_start = motion.joints()[index] * *motion.start_pose();
            assert!(
                difference(&through_start, &key.pose) < 1e-14,
                "joint {index}"
            );
        }
        assert_eq!(
            motion.joints()[3],
            DAffine2::IDENTITY,
            "a closed chain closes exactly"
        );
        assert_eq!(motion.pose_at_time(-100.0), keys[0].pose, "rests before");
        assert_eq!(motion.pose_at_time(100.0), keys[3].pose, "rests after");
    }

    #[test]
    fn standing_still_and_translating_are_exact() {
        let pose = turned(0.7);
        let way = DVec2::new(1.0, 0.5);
        let moved = DAffine2 {
            translation: pose.translation + way,
            ..pose
        };
        let motion = Motion::from_keyframes(&[key(0.0, pose), key(1.0, pose), key(2.0, moved)])
            .expect("legal");
        assert_eq!(
            motion.spans()[0].flow().generator(),
            &Generator::translation(DVec2::ZERO),
            "stands still"
        );
        assert_eq!(
            motion.spans()[1].flow().generator(),
            &Generator::translation(way),
            "translates"
        );
    }

    #[test]
    fn a_half_turn_between_keys_is_refused_or_flagged() {
        let keys = |angle| [key(0.0, DAffine2::IDENTITY), key(1.0, turned(angle))];
        let error = Motion::from_keyframes(&keys(PI)).expect_err("either sense leads there");
        let axis = None;
        assert_eq!(
            error,
            MotionError::HalfTurn { axis, count: 1 }.between_keyframes(0),
            "{error}"
        );
        let half = Motion::from_keyframes_turning(&keys(PI), &HalfTurns::All(Sense::Negative))
            .expect("chosen");
        assert!(!half.spans()[0].unique(), "either sense leads there");
        let less = Motion::from_keyframes(&keys(3.0)).expect("legal");
        assert!(
            less.spans()[0].unique(),
            "3 radians is less than half a turn"
        );
    }

    #[test]
    fn bad_keyframes_are_refused_with_their_number() {
        let refused =
            |keys: &[Keyframe]| Motion::from_keyframes(keys).expect_err("must be refused");
        let identity = DAffine2::IDENTITY;
        let scaled = |x, y| DAffine2::from_scale(DVec2::new(x, y));
        assert_eq!(
            refused(&[key(0.0, identity), key(1.0, scaled(1.0, -1.0))]),
            MotionError::Reflection { determinant: -1.0 }.at_keyframe(1),
            "mirror"
        );
        assert_eq!(
            refused(&[key(0.0, scaled(1.0, 0.0)), key(1.0, identity)]),
            MotionError::Singular.at_keyframe(0),
            "flat"
        );
        let error = refused(&[
            key(0.0, identity),
            key(1.0, identity),
            key(2.0, scaled(-1.0, -2.0)),
        ]);
        let cause = MotionError::NoRealLogarithm {
            eigenvalues: [-2.0, -1.0],
        };
        assert_eq!(
            error,
            MotionError::BetweenKeyframes {
                first: 1,
                cause: Box::new(cause)
            },
            "unequal negatives"
        );
    }

    #[test]
    fn velocities_out_of_range_are_refused() {
        let refused = |generator| Span::new(generator, 1.0).expect_err("must be refused");
        let infinite = Generator::translation(DVec2::new(f64::INFINITY, 0.0));
        assert_eq!(
            refused(infinite),
            MotionError::NonFinite { what: "generator" },
            "no velocity"
        );
        let explosive = Generator {
            linear: DMat2::IDENTITY * 1e4,
            offset: DVec2::ZERO,
        };
        assert_eq!(refused(explosive), MotionError::Overflow, "e^10000");
    }
}
