//! Norms of matrices.

use glam::DMat3;

/// Square of the Frobenius norm |M|_F.
pub(crate) fn frobenius_squared(matrix: &DMat3) -> f64 {
    matrix.x_axis.length_squared() + matrix.y_axis.length_squared() + matrix.z_axis.length_squared()
}

/// Frobenius norm |M|_F, up to rounding: at least the spectral norm, and at most sqrt(3) times it.
pub(crate) fn frobenius(matrix: &DMat3) -> f64 {
    frobenius_squared(matrix).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_entry_counts_once() {
        let matrix = DMat3::from_cols_array(&[1.0, -2.0, 3.0, 4.0, -5.0, 3.0, 0.0, 6.0, 0.0]);
        let expected = 1.0 + 4.0 + 9.0 + 16.0 + 25.0 + 9.0 + 36.0;
        assert_eq!(frobenius_squared(&matrix), expected);
        assert_eq!(frobenius(&matrix), 10.0);
    }
}
