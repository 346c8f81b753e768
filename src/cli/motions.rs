//! The motions that options give or name.

use std::error::Error;
use std::path::Path;

use super::options::{
    HalfTurnOption, MotionOptions, MotionSource, planar_single_span, single_span,
};
use crate::io::{self, AnyMotion, Dimension, OutputError, ReadMotion};
use crate::motion::{HalfTurns, Motion, Sense, planar};

/// The motion in the plane that the options give or name.
pub(crate) fn planar_motion_of(options: &MotionOptions) -> Result<planar::Motion, Box<dyn Error>> {
    let option = &options.half_turn;
    let motion = match options.planar_source()? {
        MotionSource::File(path) => io::read_planar_motion_turning(&path, &option.while_reading())?,
        MotionSource::Span(generator) => planar_single_span(generator)?,
    };
    let half_turns = option.of_one(motion.half_turns())?;
    Ok(motion.turning(&half_turns)?)
}

/// The motion that the options give or name.
pub(crate) fn motion_of(options: &MotionOptions) -> Result<Motion, Box<dyn Error>> {
    let motion = undecided_motion_of(options)?;
    let half_turns = options.half_turn.of_one(motion.half_turns())?;
    Ok(motion.turning(&half_turns)?)
}

/// The motion that the options give or name, before senses are assigned to its half turns and to
/// those of other motions.
pub(crate) fn undecided_motion_of(options: &MotionOptions) -> Result<Motion, Box<dyn Error>> {
    match options.source()? {
        MotionSource::File(path) => {
            let half_turns = options.half_turn.while_reading();
            Ok(io::read_motion_turning(&path, &half_turns)?)
        }
        MotionSource::Span(generator) => Ok(single_span(generator)?),
    }
}

/// The motion that the options of the command `motion` give or name: in the plane where the options
/// or the motion file say so.
pub(crate) fn any_motion_of(motion: &MotionOptions) -> Result<ReadMotion, Box<dyn Error>> {
    let given = |motion| ReadMotion {
        motion,
        fitted: Vec::new(),
    };
    match motion.dimension() {
        Dimension::Plane => Ok(given(AnyMotion::Plane(planar_motion_of(motion)?))),
        Dimension::Space => match motion.source()? {
            MotionSource::File(path) => {
                let read = io::read_any_motion(&path, &HalfTurns::All(Sense::Positive))?;
                Ok(ReadMotion {
                    motion: decided(read.motion, &motion.half_turn)?,
                    ..read
                })
            }
            MotionSource::Span(_) => Ok(given(AnyMotion::Space(motion_of(motion)?))),
        },
    }
}

/// The motion with the senses of the option; without the option, half turns go in the sense `+`.
fn decided(motion: AnyMotion, option: &HalfTurnOption) -> Result<AnyMotion, Box<dyn Error>> {
    if option.is_none() {
        return Ok(motion);
    }
    Ok(match motion {
        AnyMotion::Plane(motion) => {
            let half_turns = option.of_one(motion.half_turns())?;
            AnyMotion::Plane(motion.turning(&half_turns)?)
        }
        AnyMotion::Space(motion) => {
            let half_turns = option.of_one(motion.half_turns())?;
            AnyMotion::Space(motion.turning(&half_turns)?)
        }
    })
}

/// Writes poses, evenly spaced in time from the start to the end, as a table that can be read as a
/// log of poses.
///
/// - `count`: 2 or more.
pub(crate) fn write_poses(motion: &AnyMotion, count: u32, path: &Path) -> Result<(), OutputError> {
    match motion {
        AnyMotion::Space(motion) => {
            let columns = [
                "time", "m11", "m12", "m13", "m14", "m21", "m22", "m23", "m24", "m31", "m32",
                "m33", "m34",
            ];
            let rows = times(motion.joint_times(), count).map(|time| {
                let pose = motion.pose_at_time(time);
                let mut numbers = [time; 13];
                for row in 0..3 {
                    let [x, y, z] = pose.matrix3.row(row).to_array();
                    let place = pose.translation[row];
                    numbers[1 + 4 * row..5 + 4 * row].copy_from_slice(&[x, y, z, place]);
                }
                numbers.map(|number| format!("{number:?}"))
            });
            io::write_table(path, columns, rows)
        }
        AnyMotion::Plane(motion) => {
            let columns = ["time", "m11", "m12", "m13", "m21", "m22", "m23"];
            let rows = times(motion.joint_times(), count).map(|time| {
                let pose = motion.pose_at_time(time);
                let [first, second] = [0, 1].map(|row| pose.matrix2.row(row));
                let [x, y] = pose.translation.to_array();
                let numbers = [time, first.x, first.y, x, second.x, second.y, y];
                numbers.map(|number| format!("{number:?}"))
            });
            io::write_table(path, columns, rows)
        }
    }
}

/// Times evenly spaced from the first joint to the last, both exactly.
fn times(joints: &[f64], count: u32) -> impl Iterator<Item = f64> {
    let [start, end] = [joints[0], joints[joints.len() - 1]];
    let last = f64::from(count - 1);
    (0..count).map(move |k| match f64::from(k) / last {
        1.0 => end,
        share => start + (end - start) * share,
    })
}
