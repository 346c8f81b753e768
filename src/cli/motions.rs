//! The motions that options give or name.

use std::error::Error;

use super::options::{
    HalfTurnOption, MotionOptions, MotionSource, planar_single_span, single_span,
};
use crate::io::{self, AnyMotion, Dimension, ReadMotion};
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
