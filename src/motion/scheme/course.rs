//! A whole motion by a scheme: one piece between each keyframe and the next.

use super::piece::{Piece, Shape, Turn};
use super::polar::Polar;
use super::{Keyed, Scheme, WithoutSteady};
use crate::motion::chain::{Keyframe, Logarithm, Motion, Steady, between, check_keys};
use crate::motion::half_turn::Decisions;
use crate::motion::{Flow, Generator, HalfTurns, MotionError, Sense};
use crate::numeric::tolerance::HALF_TURN_ANGLE;
use glam::{DAffine3, DMat3, DVec3};
use std::f64::consts::TAU;

/// A pose for every time, smooth between keyframes: the motion of a scheme itself, without the
/// deviation of a chain that follows it.
///
/// # Example
/// ```
/// use glam::{DAffine3, DVec3};
/// use std::f64::consts::FRAC_PI_2;
/// use steadysweep::motion::scheme::{Course, Keyed, Scheme};
/// use steadysweep::motion::{Flow, HalfTurns, Keyframe};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let key = |time, pose| Keyframe { time, pose };
/// let keys = [key(0.0, DAffine3::IDENTITY), key(2.0, DAffine3::from_rotation_z(FRAC_PI_2))];
/// let straight = Keyed::new(Scheme::Linear, &keys);
/// let course: Course<Flow> = Course::new(&straight, &HalfTurns::Refused)?;
/// let middle = course.pose_at_time(1.0).transform_point3(DVec3::X);
/// assert!(middle.distance(DVec3::new(0.5, 0.5, 0.0)) < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Course<F: Steady> {
    pub(in crate::motion) keys: Vec<Keyframe<F::Pose>>,
    /// One fewer than keys.
    pub(in crate::motion) pieces: Vec<Piece>,
    /// The steady motion of a piece that is one.
    pub(in crate::motion) steady: Vec<Option<Logarithm<F>>>,
}

impl<F: Steady> Course<F> {
    /// A chain of steady spans.
    pub fn of_chain(motion: &Motion<F>) -> Course<F> {
        let spans = motion.spans().iter();
        let pieces = spans.clone().zip(motion.poses());
        Course {
            keys: motion.keyframes(),
            pieces: pieces
                .map(|(span, pose)| {
                    let generator = span.flow().generator_in_space();
                    Piece::steady(Flow::new(generator), F::pose_in_space(pose))
                })
                .collect(),
            steady: spans.map(|span| Some(span.logarithm().clone())).collect(),
        }
    }

    /// The motion of a scheme through keyframes.
    ///
    /// # Errors
    /// Those of [`Motion::from_keyframes_with_turns`], and [`MotionError::HalfTurnOfPose`].
    pub fn new(keyed: &Keyed<F::Pose>, half_turns: &HalfTurns) -> Result<Course<F>, MotionError> {
        let mut decisions = Decisions::new(half_turns);
        let course = Course::deciding(keyed, &mut decisions)?;
        decisions.close()?;
        Ok(course)
    }

    /// Body to world at a time on the clock; before and after the motion the body rests. A keyframe
    /// is met to the last bit.
    pub fn pose_at_time(&self, clock: f64) -> F::Pose {
        let after = self.keys.partition_point(|key| key.time <= clock);
        let before = after.saturating_sub(1);
        let Some(end) = self.keys.get(after) else {
            return self.keys[before].pose;
        };
        let start = &self.keys[before];
        if clock.is_nan() || clock <= start.time {
            return start.pose;
        }
        let u = (clock - start.time) / (end.time - start.time);
        F::pose_of_space(&self.pieces[before].pose_at(u))
    }

    /// The same, with decisions that are still to be closed.
    pub(in crate::motion) fn deciding(
        keyed: &Keyed<F::Pose>,
        decisions: &mut Decisions,
    ) -> Result<Course<F>, MotionError> {
        let keys = keyed.keys;
        check_keys::<F>(keys)?;
        let spans = keys.len() - 1;
        if !(keyed.turns.is_empty() || keyed.turns.len() == spans) {
            return Err(MotionError::TurnsOfSpans {
                given: keyed.turns.len(),
                spans,
            });
        }
        let factors = Factors::of::<F>(keyed, decisions)?;
        let mut course = Course {
            keys: keys.to_vec(),
            pieces: Vec::with_capacity(spans),
            steady: Vec::with_capacity(spans),
        };
        for first in 0..spans {
            let (piece, steady) = factors
                .piece::<F>(keyed, first, decisions)
                .map_err(|cause| cause.between_keyframes(first))?;
            course.pieces.push(piece);
            course.steady.push(steady);
        }
        Ok(course)
    }
}

/// What the scheme takes from each keyframe alone.
struct Factors {
    poses: Vec<DAffine3>,
    polar: Vec<Polar>,
    /// log R, each next to the one before.
    rotations: Vec<DMat3>,
    /// log S.
    stretches: Vec<DMat3>,
    /// log of the whole pose.
    logarithms: Vec<Generator>,
}

impl Factors {
    fn of<F: Steady>(
        keyed: &Keyed<F::Pose>,
        decisions: &mut Decisions,
    ) -> Result<Factors, MotionError> {
        let Keyed {
            scheme,
            without_steady,
            keys,
            turns,
        } = *keyed;
        let poses: Vec<DAffine3> = keys.iter().map(|key| F::pose_in_space(&key.pose)).collect();
        let replaced = scheme == Scheme::Steady && without_steady == WithoutSteady::PolarLog;
        let polar = if matches!(scheme, Scheme::Steady | Scheme::Linear | Scheme::Log) && !replaced
        {
            Vec::new()
        } else {
            poses.iter().map(|pose| Polar::of(&pose.matrix3)).collect()
        };
        let each = |wanted: bool, found: &dyn Fn(usize) -> Result<DMat3, MotionError>| {
            let keys = 0..if wanted { keys.len() } else { 0 };
            keys.map(|key| found(key).map_err(|cause| cause.at_keyframe(key)))
                .collect::<Result<Vec<DMat3>, MotionError>>()
        };
        let stretches = each(
            scheme == Scheme::Asap || scheme == Scheme::PolarLog || replaced,
            &|key| polar[key].stretch_logarithm(),
        )?;
        let mut rotations: Vec<DMat3> = Vec::new();
        if scheme == Scheme::PolarLog || replaced {
            for (key, factors) in polar.iter().enumerate() {
                let rotation = DAffine3::from_mat3(factors.rotation);
                let next = match rotations.last() {
                    Some(before) => next_turn::<F>(&rotation, before, key, decisions),
                    None => {
                        from_rest::<F>(&rotation, key, decisions).map(|found| skew(&found.linear))
                    }
                };
                let next = next.map_err(|cause| cause.at_keyframe(key))?;
                let whole = key.checked_sub(1).and_then(|span| turns.get(span));
                rotations.push(match whole {
                    Some(&whole) if whole != 0 => {
                        further(&next, whole).map_err(|cause| cause.between_keyframes(key - 1))?
                    }
                    _ => next,
                });
            }
        }
        let mut logarithms = Vec::new();
        if scheme == Scheme::Log {
            for (key, pose) in poses.iter().enumerate() {
                let found = from_rest::<F>(pose, key, decisions);
                logarithms.push(found.map_err(|cause| cause.at_keyframe(key))?);
            }
        }
        Ok(Factors {
            poses,
            polar,
            rotations,
            stretches,
            logarithms,
        })
    }

    /// The piece between two keyframes, and its steady motion if it is one.
    fn piece<F: Steady>(
        &self,
        keyed: &Keyed<F::Pose>,
        from: usize,
        decisions: &mut Decisions,
    ) -> Result<(Piece, Option<Logarithm<F>>), MotionError> {
        let Keyed {
            scheme,
            without_steady,
            keys,
            turns,
        } = *keyed;
        let to = from + 1;
        let ends = [from, to];
        let turns = turns.get(from).copied().unwrap_or(0);
        if turns != 0 && matches!(scheme, Scheme::Linear | Scheme::Log) {
            return Err(MotionError::NoTurns {
                scheme: scheme.name(),
            });
        }
        let poses = ends.map(|end| self.poses[end]);
        let offsets = poses.map(|pose| pose.translation);
        let line = [offsets[0], offsets[1] - offsets[0]];
        let mut turned = |ends: [&DAffine3; 2]| {
            let ends = ends.map(F::pose_of_space);
            let steady = between::<F>(&ends[0], &ends[1], from, turns, decisions)?;
            Ok(Flow::new(steady.flow.generator_in_space()))
        };
        let rotation = |end: usize| DAffine3::from_mat3(self.polar[end].rotation);
        let piece = match scheme {
            Scheme::Steady => {
                let found = between::<F>(&keys[from].pose, &keys[to].pose, from, turns, decisions);
                match found {
                    Ok(steady) => {
                        let flow = Flow::new(steady.flow.generator_in_space());
                        return Ok((Piece::steady(flow, poses[0]), Some(steady)));
                    }
                    Err(
                        MotionError::NoRealLogarithm { .. } | MotionError::IllConditioned { .. },
                    ) if without_steady == WithoutSteady::PolarLog => self.polar_log(ends, line),
                    Err(cause) => return Err(cause),
                }
            }
            Scheme::PolarLog => self.polar_log(ends, line),
            Scheme::Linear => Piece {
                turn: Turn::Still,
                shape: Shape::Blend(poses),
                line: [DVec3::ZERO; 2],
            },
            Scheme::Polar => {
                let [first, last] = ends.map(rotation);
                let shape = |end: usize| {
                    DAffine3::from_mat3(self.polar[from].rotation * self.polar[end].stretch)
                };
                Piece {
                    turn: Turn::Steady(Box::new(turned([&first, &last])?)),
                    shape: Shape::Blend([shape(from), shape(to)]),
                    line,
                }
            }
            Scheme::Asap => {
                let [first, last] = ends.map(rotation);
                Piece {
                    turn: Turn::Steady(Box::new(turned([&first, &last])?)),
                    shape: Shape::Stretch {
                        first: self.polar[from].rotation,
                        ends: ends.map(|end| self.stretches[end]),
                    },
                    line,
                }
            }
            Scheme::Log => Piece {
                turn: Turn::Between(ends.map(|end| self.logarithms[end])),
                shape: Shape::Blend([DAffine3::IDENTITY; 2]),
                line: [DVec3::ZERO; 2],
            },
            Scheme::Spiral => {
                let scale = |end: usize| self.poses[end].matrix3.determinant().cbrt();
                let similar = |end: usize| DAffine3 {
                    matrix3: self.polar[end].rotation * scale(end),
                    translation: self.poses[end].translation,
                };
                let [first, last] = ends.map(similar);
                let rest = self.polar[to].stretch * (1.0 / scale(to));
                Piece {
                    turn: Turn::Steady(Box::new(turned([&first, &last])?)),
                    shape: Shape::Blend([poses[0], first * DAffine3::from_mat3(rest)]),
                    line: [DVec3::ZERO; 2],
                }
            }
        };
        Ok((piece, None))
    }

    fn polar_log(&self, ends: [usize; 2], line: [DVec3; 2]) -> Piece {
        Piece {
            turn: Turn::Between(ends.map(|end| Generator {
                linear: self.rotations[end],
                offset: DVec3::ZERO,
            })),
            shape: Shape::Stretch {
                first: DMat3::IDENTITY,
                ends: ends.map(|end| self.stretches[end]),
            },
            line,
        }
    }
}

/// The logarithm of the pose of a keyframe itself. A half turn has two.
fn from_rest<F: Steady>(
    pose: &DAffine3,
    key: usize,
    decisions: &mut Decisions,
) -> Result<Generator, MotionError> {
    let pose = F::pose_of_space(pose);
    let mut steady = F::between(&F::IDENTITY, &pose, None, 0)?;
    if let Some(half_turn) = &steady.half_turn {
        let sense = decisions.next_of_pose(key, F::axis_of(half_turn));
        steady = F::between(&F::IDENTITY, &pose, Some(sense), 0)?;
    }
    Ok(steady.flow.generator_in_space())
}

/// The skew part.
fn skew(matrix: &DMat3) -> DMat3 {
    (*matrix - matrix.transpose()) * 0.5
}

/// The logarithm of a rotation that is nearest to that of the rotation before, with whole turns
/// added (Kaji & Ochiai 4.3). After a rest, a half turn has two.
fn next_turn<F: Steady>(
    rotation: &DAffine3,
    before: &DMat3,
    key: usize,
    decisions: &mut Decisions,
) -> Result<DMat3, MotionError> {
    let found = F::between(&F::IDENTITY, &F::pose_of_space(rotation), None, 0)?;
    let linear = found.flow.generator_in_space().linear;
    let [vector, before] = [linear, *before].map(|matrix| rotation_vector(&matrix));
    let angle = vector.length();
    let axis = if angle > 0.0 {
        vector / angle
    } else {
        before.normalize_or_zero()
    };
    let turns = (before.dot(axis) - angle) / TAU;
    let is_open = ((turns - turns.floor()) - 0.5).abs() < HALF_TURN_ANGLE;
    let turns = if is_open {
        let axis = found.half_turn.as_ref().and_then(F::axis_of);
        match decisions.next_of_pose(key, axis) {
            Sense::Positive => turns.ceil(),
            Sense::Negative => turns.floor(),
        }
    } else {
        turns.round()
    };
    Ok(cross_product(axis * (angle + turns * TAU)))
}

/// The logarithm of the same rotation with whole turns added, in the sense in which it turns
/// further.
fn further(logarithm: &DMat3, turns: i32) -> Result<DMat3, MotionError> {
    let vector = rotation_vector(logarithm);
    let axis = vector.try_normalize().ok_or(MotionError::NothingTurns)?;
    Ok(cross_product(vector + axis * (f64::from(turns) * TAU)))
}

/// The vector w of the skew part, x -> w x x.
pub(in crate::motion) fn rotation_vector(matrix: &DMat3) -> DVec3 {
    let skew = skew(matrix);
    DVec3::new(skew.y_axis.z, skew.z_axis.x, skew.x_axis.y)
}

/// x -> w x x.
fn cross_product(w: DVec3) -> DMat3 {
    DMat3::from_cols(
        DVec3::new(0.0, w.z, -w.y),
        DVec3::new(-w.z, 0.0, w.x),
        DVec3::new(w.y, -w.x, 0.0),
    )
}
