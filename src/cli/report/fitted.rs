//! How well keyframes fit the points from which they were found.

use super::quantities::counted;
use crate::io::FittedKey;
use crate::numeric::Readable;
use std::fmt;

/// How well one keyframe fits its pairs of points.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub(crate) struct FittedKeyReport {
    /// Its number, counted from 0.
    keyframe: usize,
    /// Number of pairs.
    pairs: usize,
    /// The largest distance between the image of a source and its target.
    largest: f64,
    /// The root mean square of these distances.
    root_mean_square: f64,
}

impl FittedKeyReport {
    pub(crate) fn list(fitted: &[FittedKey]) -> Vec<FittedKeyReport> {
        let report = |key: &FittedKey| FittedKeyReport {
            keyframe: key.keyframe,
            pairs: key.quality.pairs,
            largest: key.quality.largest,
            root_mean_square: key.quality.root_mean_square,
        };
        fitted.iter().map(report).collect()
    }
}

/// "keyframe 1: fitted to 5 pairs of points, off by up to 0.02, 0.01 as the root mean square".
impl fmt::Display for FittedKeyReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "keyframe {}: fitted to {} of points, off by up to {}, {} as the root mean square",
            self.keyframe,
            counted(self.pairs, "pair"),
            Readable(self.largest),
            Readable(self.root_mean_square)
        )
    }
}
