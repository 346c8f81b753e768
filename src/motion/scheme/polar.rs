//! The polar decomposition, and the logarithms of its factors.

use crate::motion::{MotionError, logarithm};
use crate::numeric::norms::frobenius;
use glam::{DAffine3, DMat3};

/// Most steps of Newton's iteration: it takes ten for the worst conditioned matrices (Higham).
const MOST_STEPS: u32 = 60;
/// Largest change in the last step.
const CONVERGED: f64 = 1e-14;

/// L = R S: the rotation R nearest to a matrix, and a symmetric positive definite stretch S.
#[derive(Debug, Clone, Copy)]
pub(super) struct Polar {
    pub(super) rotation: DMat3,
    pub(super) stretch: DMat3,
}

impl Polar {
    /// The factors of a matrix with a positive determinant.
    ///
    /// Newton's iteration for the sign of a matrix, R' = (g R + R^-T / g) / 2, scaled by the norms
    /// (Higham, *Computing the polar decomposition*, 1986): quadratic in the end, and backward
    /// stable.
    pub(super) fn of(linear: &DMat3) -> Polar {
        let mut rotation = *linear;
        for _ in 0..MOST_STEPS {
            let inverse = rotation.inverse().transpose();
            let scale = (frobenius(&inverse) / frobenius(&rotation)).sqrt();
            let next = (rotation * scale + inverse * (1.0 / scale)) * 0.5;
            let change = frobenius(&(next - rotation));
            rotation = next;
            if change <= CONVERGED * frobenius(&rotation) {
                break;
            }
        }
        let stretch = rotation.transpose() * *linear;
        Polar {
            rotation,
            stretch: (stretch + stretch.transpose()) * 0.5,
        }
    }

    /// log S: symmetric.
    ///
    /// # Errors
    /// [`MotionError::IllConditioned`] where f64 cannot represent it.
    pub(super) fn stretch_logarithm(&self) -> Result<DMat3, MotionError> {
        let found = logarithm(&DAffine3::from_mat3(self.stretch))?;
        let linear = found.flow.generator().linear;
        Ok((linear + linear.transpose()) * 0.5)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::random;
    use glam::DVec3;

    #[test]
    fn the_factors_multiply_to_the_matrix() {
        let mut random = random(3);
        for spread in [1.0, 1e3, 1e6] {
            for _ in 0..100 {
                let any = DMat3::from_cols_array(&std::array::from_fn(|_| random()));
                let mut linear = any * DMat3::from_diagonal(DVec3::new(1.0, spread, 1.0 / spread));
                if linear.determinant() < 0.0 {
                    linear.z_axis = -linear.z_axis;
                }
                let size = frobenius(&linear);
                let Polar { rotation, stretch } = Polar::of(&linear);
                let off = frobenius(&(rotation * stretch - linear));
                assert!(off <= 1e-13 * size, "{off:e} of {size}");
                let off = frobenius(&(rotation.transpose() * rotation - DMat3::IDENTITY));
                assert!(off <= 1e-14 * 10.0, "no rotation: {off:e}");
                assert!(rotation.determinant() > 0.0, "a mirror image");
                let along = DVec3::new(random(), random(), random());
                assert!(along.dot(stretch * along) >= -1e-13 * size, "no stretch");
            }
        }
    }

    #[test]
    fn a_rotation_is_its_own_first_factor() {
        let rotation = DMat3::from_axis_angle(DVec3::new(0.36, 0.48, 0.8), 3.1);
        let found = Polar::of(&rotation);
        assert!(frobenius(&(found.rotation - rotation)) < 1e-15 * 4.0);
        assert!(frobenius(&(found.stretch - DMat3::IDENTITY)) < 1e-15 * 4.0);
    }
}
