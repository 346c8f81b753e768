//! How far a motion may be from the one that it stands for.

use glam::DVec3;

/// How far a chain of steady spans may be from the motion that it stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Deviation {
    /// No point of the body is farther from its place than this, at any time.
    pub length: f64,
    /// The length that was asked for; at least `length`, if `proven`.
    pub asked: f64,
    /// Whether it is proven; otherwise it is an estimate.
    pub proven: bool,
    /// A time near which the deviation is that large, on the motion's clock.
    pub time: f64,
    /// Corners of a box around the points of the body for which it holds, in its frame.
    within: [DVec3; 2],
}

impl Deviation {
    /// No deviation at all so far.
    pub(super) fn none(asked: f64, proven: bool, time: f64, within: [DVec3; 2]) -> Deviation {
        Deviation {
            length: 0.0,
            asked,
            proven,
            time,
            within,
        }
    }

    /// Whether it may hold for a body: false if points of it lie outside the box around those for
    /// which the motion was followed.
    ///
    /// - `low`, `high`: corners of a box around the body, in its frame; in the plane with z = 0.
    pub fn covers(&self, low: DVec3, high: DVec3) -> bool {
        low.cmpge(self.within[0]).all() && high.cmple(self.within[1]).all()
    }
}
