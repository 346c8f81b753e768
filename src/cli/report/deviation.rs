//! How far a motion may be from the one that it stands for.

use crate::motion::Deviation;
use crate::motion::chain::{Motion, Steady};
use crate::numeric::Readable;
use std::fmt;

/// How far a motion may be from the one that it stands for.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub(crate) struct DeviationReport {
    /// No point of the body is farther from its place than this, at any time.
    pub(crate) length: f64,
    /// The length that was asked for.
    pub(crate) asked: f64,
    /// Whether it is proven; otherwise it is an estimate.
    pub(crate) proven: bool,
    /// A time near which it is largest.
    pub(crate) time: f64,
}

impl DeviationReport {
    /// `None` for a motion that stands for itself.
    pub(super) fn of<F: Steady>(motion: &Motion<F>) -> Option<DeviationReport> {
        let report = |deviation: &Deviation| DeviationReport {
            length: deviation.length,
            asked: deviation.asked,
            proven: deviation.proven,
            time: deviation.time,
        };
        motion.deviation().map(report)
    }
}

impl fmt::Display for DeviationReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let how = if self.proven { "proven" } else { "estimate" };
        writeln!(
            f,
            "        stands for the given one within {} over the body ({how}), asked {}",
            Readable(self.length),
            Readable(self.asked)
        )
    }
}
