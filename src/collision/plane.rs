//! A plane, and the half-space behind it.

use crate::numeric::tolerance::LARGEST_COORDINATE;
use glam::{DAffine3, DVec3};

/// A plane through a point; the half-space behind it is solid, its normal points out of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    point: DVec3,
    normal: DVec3,
}

/// Why a point and a normal are no plane.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlaneError {
    /// The normal has no direction, or is not finite.
    #[error("the normal {normal} of a plane has no direction; give a vector other than 0")]
    Normal {
        /// The normal as given.
        normal: DVec3,
    },
    /// The point is too far away, or not finite.
    #[error(
        "the point {point} of a plane is not within the limit of {LARGEST_COORDINATE:.0e} for coordinates; use a nearer point of it, \
         or a larger unit of length"
    )]
    Point {
        /// The point as given.
        point: DVec3,
    },
}

impl Plane {
    /// The plane through a `point` with a `normal` of any length but 0.
    ///
    /// # Errors
    /// [`PlaneError`]: a normal without direction, a point that is not finite or too far away.
    pub fn new(point: DVec3, normal: DVec3) -> Result<Plane, PlaneError> {
        let within = point.abs().cmple(DVec3::splat(LARGEST_COORDINATE));
        if !within.all() {
            return Err(PlaneError::Point { point });
        }
        // Divided by its largest entry first, so that no square overflows or vanishes.
        let size = normal.abs().max_element();
        let unit = (normal / size).try_normalize();
        match unit.filter(|_| size.is_finite()) {
            Some(normal) => Ok(Plane { point, normal }),
            None => Err(PlaneError::Normal { normal }),
        }
    }

    /// The point through which it was laid.
    pub fn point(&self) -> DVec3 {
        self.point
    }

    /// The unit normal, out of the solid.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    /// The height of a position above it: the distance from the half-space, negative behind the
    /// plane.
    pub fn height(&self, position: DVec3) -> f64 {
        self.normal.dot(position - self.point)
    }

    /// The same plane in a pose that is not singular.
    pub(super) fn placed(&self, pose: &DAffine3) -> Plane {
        if *pose == DAffine3::IDENTITY {
            return *self;
        }
        // A normal is carried by the inverse transpose.
        let carry = pose.matrix3.inverse().transpose();
        Plane {
            point: pose.transform_point3(self.point),
            normal: (carry * self.normal).normalize(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_of_any_length_are_taken_and_those_without_direction_refused() {
        for length in [1e-300, 1.0, 1e300] {
            let plane = Plane::new(DVec3::Z, DVec3::Z * length).expect("a plane");
            assert_eq!(plane.height(DVec3::new(5.0, 6.0, 3.0)), 2.0);
        }
        for normal in [DVec3::ZERO, DVec3::NAN, DVec3::X / 0.0] {
            let refused = Plane::new(DVec3::ZERO, normal);
            assert!(
                matches!(refused, Err(PlaneError::Normal { .. })),
                "{refused:?}"
            );
        }
        for far in [f64::NAN, f64::INFINITY, 1e19] {
            let refused = Plane::new(DVec3::X * far, DVec3::X);
            assert!(
                matches!(refused, Err(PlaneError::Point { .. })),
                "{refused:?}"
            );
        }
    }
}
