//! The table of laws at the head of `motion::scheme`: each `yes` holds to rounding for random pairs
//! of poses, each `no` has a counterexample among them.

use crate::support::random::Random;
use glam::{DAffine3, DMat3, DQuat, DVec3};
use steadysweep::motion::scheme::{Course, Keyed, Scheme};
use steadysweep::motion::{Flow, HalfTurns, Keyframe};

const PAIRS: u64 = 200;
/// What rounding explains; measured 6e-14.
const ROUNDING: f64 = 1e-12;
/// What it does not.
const BROKEN: f64 = 1e-3;

const SCHEMES: [Scheme; 7] = Scheme::ALL;

fn any_linear(random: &mut Random) -> DMat3 {
    let turn = DQuat::from_axis_angle(random.direction(), random.between(0.0, 1.4));
    let along = DMat3::from_quat(DQuat::from_axis_angle(random.direction(), 1.0));
    let sizes = DVec3::from_array([0, 1, 2].map(|_| random.magnitude(0.6, 1.7)));
    DMat3::from_quat(turn) * along * DMat3::from_diagonal(sizes) * along.transpose()
}

fn any_pose(random: &mut Random) -> DAffine3 {
    DAffine3 {
        matrix3: any_linear(random),
        translation: random.point(3.0),
    }
}

fn any_rigid(random: &mut Random) -> DAffine3 {
    let turn = DQuat::from_axis_angle(random.direction(), random.between(0.0, 1.4));
    DAffine3::from_rotation_translation(turn, random.point(3.0))
}

/// Poses of a scheme between two, at five times in between; `None` where it refuses the pair.
fn poses(scheme: Scheme, ends: [DAffine3; 2]) -> Option<Vec<DAffine3>> {
    let keys = [0, 1].map(|i| Keyframe {
        time: i as f64,
        pose: ends[i],
    });
    let course: Course<Flow> = Course::new(&Keyed::new(scheme, &keys), &HalfTurns::Refused).ok()?;
    let times = [0.1, 0.3, 0.5, 0.7, 0.9];
    Some(times.map(|time| course.pose_at_time(time)).to_vec())
}

fn difference(a: &DAffine3, b: &DAffine3) -> f64 {
    let [a, b] = [a, b].map(DAffine3::to_cols_array);
    let off = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    off.fold(0.0, f64::max)
}

/// By how much the law fails for one pair; `None` where there is no motion.
type Law = fn(Scheme, &mut Random) -> Option<f64>;

fn largest_difference(a: Vec<DAffine3>, b: Vec<DAffine3>) -> f64 {
    let pairs = a.iter().zip(&b).map(|(a, b)| difference(a, b));
    pairs.fold(0.0, f64::max)
}

/// The motion of (F B, F C) is F times that of (B, C), and that of (B F, C F) is it times F.
fn left_or_right(scheme: Scheme, random: &mut Random, frame: DAffine3) -> Option<f64> {
    let ends = [any_pose(random), any_pose(random)];
    let given = poses(scheme, ends)?;
    let left = poses(scheme, ends.map(|end| frame * end))?;
    let right = poses(scheme, ends.map(|end| end * frame))?;
    let [from_left, from_right] = [
        given.iter().map(|pose| frame * *pose).collect(),
        given.iter().map(|pose| *pose * frame).collect(),
    ];
    Some(largest_difference(left, from_left).max(largest_difference(right, from_right)))
}

fn left_or_right_affine(scheme: Scheme, random: &mut Random) -> Option<f64> {
    let frame = any_pose(random);
    left_or_right(scheme, random, frame)
}

fn left_rigid(scheme: Scheme, random: &mut Random) -> Option<f64> {
    let frame = any_rigid(random);
    let ends = [any_pose(random), any_pose(random)];
    let given = poses(scheme, ends)?;
    let left = poses(scheme, ends.map(|end| frame * end))?;
    let expected = given.iter().map(|pose| frame * *pose).collect();
    Some(largest_difference(left, expected))
}

fn conjugate(scheme: Scheme, random: &mut Random, frame: DAffine3) -> Option<f64> {
    let ends = [any_pose(random), any_pose(random)];
    let back = frame.inverse();
    let given = poses(scheme, ends)?;
    let seen = poses(scheme, ends.map(|end| frame * end * back))?;
    let expected = given.iter().map(|pose| frame * *pose * back).collect();
    Some(largest_difference(seen, expected))
}

fn conjugate_affine(scheme: Scheme, random: &mut Random) -> Option<f64> {
    let frame = any_pose(random);
    conjugate(scheme, random, frame)
}

/// A rotation about the origin, at which these schemes place the body.
fn conjugate_rotation(scheme: Scheme, random: &mut Random) -> Option<f64> {
    let mut frame = any_rigid(random);
    frame.translation = DVec3::ZERO;
    conjugate(scheme, random, frame)
}

fn reversible(scheme: Scheme, random: &mut Random) -> Option<f64> {
    let ends = [any_pose(random), any_pose(random)];
    let forth = poses(scheme, ends)?;
    let mut back = poses(scheme, [ends[1], ends[0]])?;
    back.reverse();
    Some(largest_difference(forth, back))
}

/// The volume changes by equal factors in equal times.
fn volume_geometric(scheme: Scheme, random: &mut Random) -> Option<f64> {
    let ends = [any_pose(random), any_pose(random)];
    let volumes = ends.map(|end| end.matrix3.determinant().ln());
    let off = [0.1, 0.3, 0.5, 0.7, 0.9].iter().zip(poses(scheme, ends)?);
    let off = off.map(|(u, pose)| {
        let expected = volumes[0] * (1.0 - u) + volumes[1] * u;
        (pose.matrix3.determinant() / expected.exp() - 1.0).abs()
    });
    Some(off.fold(0.0, f64::max))
}

fn rigid_stays_rigid(scheme: Scheme, random: &mut Random) -> Option<f64> {
    let ends = [any_rigid(random), any_rigid(random)];
    let off = poses(scheme, ends)?.into_iter().map(|pose| {
        let product = pose.matrix3.transpose() * pose.matrix3;
        let off = (product - DMat3::IDENTITY).to_cols_array();
        off.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
    });
    Some(off.fold(0.0, f64::max))
}

/// The largest failure over all pairs.
fn failure(law: Law, scheme: Scheme) -> f64 {
    let (mut largest, mut seen) = (0.0_f64, 0);
    for number in 0.. {
        if let Some(off) = law(scheme, &mut Random::new(number)) {
            (largest, seen) = (largest.max(off), seen + 1);
        }
        if seen == PAIRS {
            return largest;
        }
        assert!(number < 10 * PAIRS, "{scheme:?}: most pairs are refused");
    }
    largest
}

#[test]
fn schemes_keep_the_laws_of_their_table_and_no_others() {
    // In the order of the columns.
    let laws: [(&str, Law); 7] = [
        ("left or right affine", left_or_right_affine),
        ("conjugate affine", conjugate_affine),
        ("left rigid", left_rigid),
        ("conjugate rotation", conjugate_rotation),
        ("reversible", reversible),
        ("volume", volume_geometric),
        ("rigid", rigid_stays_rigid),
    ];
    let mut wrong = Vec::new();
    for scheme in SCHEMES {
        let (yes, no) = (true, false);
        let expected = match scheme {
            Scheme::Steady => [yes, yes, yes, yes, yes, yes, yes],
            Scheme::Log => [no, yes, no, yes, yes, yes, yes],
            Scheme::Linear => [yes, yes, yes, yes, yes, no, no],
            Scheme::Polar => [no, no, yes, yes, yes, no, yes],
            Scheme::Asap => [no, no, yes, yes, yes, yes, yes],
            Scheme::PolarLog => [no, no, no, yes, yes, yes, yes],
            Scheme::Spiral => [no, no, yes, yes, yes, no, yes],
            _ => panic!("{scheme:?} has no row"),
        };
        for ((name, law), holds) in laws.iter().zip(expected) {
            let off = failure(*law, scheme);
            let as_expected = if holds { off < ROUNDING } else { off > BROKEN };
            println!("{scheme:?}, {name}: {off:e}");
            if !as_expected {
                wrong.push(format!(
                    "{scheme:?}, {name}: off by {off:e}, holds: {holds}"
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A keyframe is met to the last bit, and before and after the motion the body rests.
#[test]
fn a_course_meets_its_keyframes() {
    let mut random = Random::new(3);
    let keys = [1.0, 2.5, 3.0].map(|time| Keyframe {
        time,
        pose: any_pose(&mut random),
    });
    for scheme in SCHEMES {
        let course: Course<Flow> =
            Course::new(&Keyed::new(scheme, &keys), &HalfTurns::Refused).expect("legal");
        for key in &keys {
            assert_eq!(course.pose_at_time(key.time), key.pose, "{scheme:?}");
            for off in [-1e-9, 1e-9] {
                let near = course.pose_at_time(key.time + off);
                assert!(difference(&near, &key.pose) < 1e-6, "{scheme:?}");
            }
        }
        assert_eq!(course.pose_at_time(-7.0), keys[0].pose, "before");
        assert_eq!(course.pose_at_time(9.0), keys[2].pose, "after");
    }
}
