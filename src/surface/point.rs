//! A point of a closed surface that knows where its inside is.

use glam::DVec3;

/// A point of a surface, with a direction inwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SurfacePoint {
    pub(crate) place: DVec3,
    /// A direction inwards, at most of length 1: against the mean normal of the faces there, or
    /// zero if it is not known.
    pub(crate) inwards: DVec3,
}

impl SurfacePoint {
    /// The point at a share of the line to another one.
    pub(crate) fn lerp(self, other: SurfacePoint, share: f64) -> SurfacePoint {
        SurfacePoint {
            place: self.place.lerp(other.place, share),
            inwards: self.inwards.lerp(other.inwards, share),
        }
    }
}
