//! How far a motion is from steady, over a body.

use crate::motion::steadiness::Steadiness;
use crate::numeric::Readable;
use std::fmt;

/// The average relative acceleration of a motion (Rossignac & Vinacua, 2.4), as an estimate from
/// points inside a body.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct SteadinessReport {
    /// The average relative acceleration, a length per square of time; 0 for a steady motion.
    pub(crate) value: f64,
    /// The same times the duration over the mean speed.
    pub(crate) relative: f64,
    /// The largest of `jumps`.
    pub(crate) largest_jump: f64,
    /// How the velocity changes at the keyframes and joints between the first and the last.
    pub(crate) jumps: Vec<JumpReport>,
}

/// A jump of the velocity.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub(crate) struct JumpReport {
    /// On the clock of the motion.
    pub(crate) time: f64,
    /// Mean over the body of the change of the velocity relative to the body.
    pub(crate) speed: f64,
}

impl From<&Steadiness> for SteadinessReport {
    fn from(steadiness: &Steadiness) -> SteadinessReport {
        let jumps = steadiness.jumps.iter().map(|jump| JumpReport {
            time: jump.time,
            speed: jump.speed,
        });
        SteadinessReport {
            value: steadiness.average_relative_acceleration,
            relative: steadiness.relative,
            largest_jump: steadiness.largest_jump(),
            jumps: jumps.collect(),
        }
    }
}

impl fmt::Display for SteadinessReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "steadiness: average relative acceleration {} ({} of the mean speed in the whole time), largest jump {}",
            Readable(self.value),
            Readable(self.relative),
            Readable(self.largest_jump)
        )
    }
}
