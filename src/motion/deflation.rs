//! Orthogonal deflation: one real eigenvalue is split off a 3 x 3 matrix, and the other two stay in
//! a 2 x 2 block.
//!
//! Derivation and choice of the eigenvalue: [`super`], "Splitting off one eigenvalue".

use super::pair::Traceless;
use crate::numeric::difference_of_products;
use glam::{DMat3, DVec2, DVec3};

/// Q^T A Q = [lambda coupling; 0 block] with Q orthogonal and symmetric.
#[derive(Debug, Clone, Copy)]
pub(super) struct Deflation {
    /// Q; equal to its own inverse.
    pub(super) basis: DMat3,
    pub(super) lambda: f64,
    pub(super) coupling: DVec2,
    /// Rows of B.
    pub(super) block: [[f64; 2]; 2],
}

impl Deflation {
    /// Half the trace of the block.
    pub(super) fn mean(&self) -> f64 {
        0.5 * (self.block[0][0] + self.block[1][1])
    }
    /// The block without its trace.
    pub(super) fn traceless(&self) -> Traceless {
        Traceless {
            z: 0.5 * (self.block[0][0] - self.block[1][1]),
            upper: self.block[0][1],
            lower: self.block[1][0],
        }
    }

    /// Splits one eigenvalue off any finite matrix.
    ///
    /// Backward error: a few units in the last place of max|A - tr A/3 I|; zero when a column of A
    /// is already an eigenvector or when A is a multiple of the identity plus a skew matrix.
    pub(super) fn new(matrix: &DMat3) -> Deflation {
        if let Some(exact) = by_permutation(matrix).or_else(|| by_rotation_axis(matrix)) {
            return exact;
        }
        Deflation::isolated(matrix)
    }

    /// Splits off the eigenvalue farthest from the mean; a (nearly) double one stays together in
    /// the block.
    pub(super) fn isolated(matrix: &DMat3) -> Deflation {
        let mean = (matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z) / 3.0;
        let centred = *matrix - DMat3::from_diagonal(DVec3::splat(mean));
        let size = largest_entry(&centred);
        if size == 0.0 {
            return read_blocks(DMat3::IDENTITY, matrix, 0.0, 1.0);
        }
        let unit = centred * (1.0 / size);
        let basis = reflection_to_first_axis(eigenvector(&unit, isolated_root(&unit)));
        // A wide or graded spectrum is read from the matrix itself: adding the mean back would blur
        // its small eigenvalues.
        if size > 0.5 * mean.abs() {
            read_blocks(basis, &(basis * *matrix * basis), 0.0, 1.0)
        } else {
            read_blocks(basis, &(basis * unit * basis), mean, size)
        }
    }
}

/// The largest absolute value of an entry.
pub(super) fn largest_entry(matrix: &DMat3) -> f64 {
    matrix
        .x_axis
        .abs()
        .max(matrix.y_axis.abs())
        .max(matrix.z_axis.abs())
        .max_element()
}

fn read_blocks(basis: DMat3, form: &DMat3, shift: f64, scale: f64) -> Deflation {
    Deflation {
        basis,
        lambda: shift + scale * form.x_axis.x,
        coupling: DVec2::new(form.y_axis.x, form.z_axis.x) * scale,
        block: [
            [shift + scale * form.y_axis.y, scale * form.z_axis.y],
            [scale * form.y_axis.z, shift + scale * form.z_axis.z],
        ],
    }
}

/// Moves a column that is an eigenvector to the front by a swap: exact for diagonal and (permuted)
/// triangular matrices, however large their shear. Among several such columns it takes the one with
/// the largest eigenvalue, because a logarithm needs it positive.
fn by_permutation(matrix: &DMat3) -> Option<Deflation> {
    let column = (0..3)
        .filter(|&j| (0..3).all(|i| i == j || matrix.col(j)[i] == 0.0))
        .max_by(|&i, &j| matrix.col(i)[i].total_cmp(&matrix.col(j)[j]))?;
    let mut basis = DMat3::IDENTITY;
    *basis.col_mut(0) = DVec3::AXES[column];
    *basis.col_mut(column) = DVec3::AXES[0];
    Some(read_blocks(basis, &(basis * *matrix * basis), 0.0, 1.0))
}

/// Splits m I + K with K skew: the axis is known, and the block is a multiple of a quarter turn to
/// the last bit.
fn by_rotation_axis(matrix: &DMat3) -> Option<Deflation> {
    let (x, y, z) = (matrix.x_axis, matrix.y_axis, matrix.z_axis);
    let skew = x.x == y.y && y.y == z.z && x.y == -y.x && x.z == -z.x && y.z == -z.y;
    if !skew {
        return None;
    }
    let turn = DVec3::new(y.z, z.x, x.y);
    let length = turn.length();
    let axis = turn / length;
    // The reflection sends the axis to -e1 or +e1, and reverses the sense of rotation once more.
    let quarter = if axis.x >= 0.0 { -length } else { length };
    Some(Deflation {
        basis: reflection_to_first_axis(axis),
        lambda: x.x,
        coupling: DVec2::ZERO,
        block: [[x.x, quarter], [-quarter, x.x]],
    })
}

/// The root of largest magnitude of det(N - x I) = 0 for a matrix without trace and with entries up
/// to 1.
fn isolated_root(unit: &DMat3) -> f64 {
    let [n0, n1, n2] = [unit.x_axis, unit.y_axis, unit.z_axis];
    // x^3 + a x = b. The minors avoid cancellation: near a matrix of rank one, an error u in them
    // would leave u / gap in the null vector.
    let minors = [
        difference_of_products(n1.y, n2.z, n2.y, n1.z),
        difference_of_products(n0.y, n2.z, n2.y, n0.z),
        difference_of_products(n0.y, n1.z, n1.y, n0.z),
    ];
    let a = difference_of_products(n0.x, n1.y, n1.x, n0.y)
        + difference_of_products(n0.x, n2.z, n2.x, n0.z)
        + minors[0];
    let b = n0.x * minors[0] - n1.x * minors[1] + n2.x * minors[2];
    let size = b.abs();
    let mut x = if a < 0.0 {
        (-a).sqrt() + size.cbrt()
    } else {
        size.cbrt()
    };
    if a > 0.0 && size < a * x {
        x = size / a;
    }
    // Newton's method decreases monotonically from an upper bound of a convex function: it ends
    // when it no longer decreases. It converges quadratically from within a factor of 3, in at most
    // 7 steps; a double root (linear, factor 2) takes 55.
    for _ in 0..60 {
        let slope = 3.0 * x * x + a;
        if !(x > 0.0 && slope > 0.0) {
            break;
        }
        let next = x - ((x * x + a) * x - size) / slope;
        if !(next < x && next > 0.0) {
            break;
        }
        x = next;
    }
    x.copysign(b)
}

/// Rows whose cross product is at least this long give the null vector directly, for entries up to
/// 1: its rounding then matters as much as that of the eigenvalue. Shorter ones (rank near one) are
/// left to elimination, which is twice as slow.
const CROSS_PRODUCT: f64 = 0.25;

/// The unit null vector of N - x I.
fn eigenvector(unit: &DMat3, x: f64) -> DVec3 {
    let rows = (*unit - DMat3::from_diagonal(DVec3::splat(x))).transpose();
    let crosses = [
        rows.x_axis.cross(rows.y_axis),
        rows.y_axis.cross(rows.z_axis),
        rows.z_axis.cross(rows.x_axis),
    ];
    let mut longest = crosses[0];
    for cross in &crosses[1..] {
        if cross.length_squared() > longest.length_squared() {
            longest = *cross;
        }
    }
    if longest.length_squared() > CROSS_PRODUCT * CROSS_PRODUCT {
        longest.normalize()
    } else {
        eigenvector_by_elimination(rows.to_cols_array_2d())
    }
}

/// The unit null vector of a singular matrix, by elimination with complete pivoting, stable for any
/// rank.
fn eigenvector_by_elimination(mut rows: [[f64; 3]; 3]) -> DVec3 {
    let mut order = [0, 1, 2];
    for step in 0..2 {
        let (mut row, mut column) = (step, step);
        for i in step..3 {
            for j in step..3 {
                if rows[i][j].abs() > rows[row][column].abs() {
                    (row, column) = (i, j);
                }
            }
        }
        rows.swap(step, row);
        for entries in &mut rows {
            entries.swap(step, column);
        }
        order.swap(step, column);
        let pivot = rows[step];
        if pivot[step] == 0.0 {
            continue;
        }
        for entries in rows.iter_mut().skip(step + 1) {
            let factor = entries[step] / pivot[step];
            for j in step..3 {
                entries[j] -= factor * pivot[j];
            }
        }
    }
    let second = if rows[1][1] == 0.0 {
        0.0
    } else {
        -rows[1][2] / rows[1][1]
    };
    let first = if rows[0][0] == 0.0 {
        0.0
    } else {
        -(rows[0][1] * second + rows[0][2]) / rows[0][0]
    };
    let mut vector = DVec3::ZERO;
    vector[order[0]] = first;
    vector[order[1]] = second;
    vector[order[2]] = 1.0;
    vector.normalize()
}

/// The Householder reflection that maps a unit vector to -e1 or e1, whichever is farther away.
fn reflection_to_first_axis(unit: DVec3) -> DMat3 {
    let target = if unit.x >= 0.0 { -1.0 } else { 1.0 };
    let normal = DVec3::new(unit.x - target, unit.y, unit.z);
    // Formed from the rounded normal: a reflection to the last bit even when `unit` is not quite a
    // unit vector.
    let weight = 2.0 / normal.length_squared();
    DMat3::IDENTITY
        - DMat3::from_cols(
            normal * (weight * normal.x),
            normal * (weight * normal.y),
            normal * (weight * normal.z),
        )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::random;

    /// Checks that Q^T A Q has the claimed shape: rebuilds A and compares.
    fn check(matrix: DMat3) {
        let form = Deflation::new(&matrix);
        let upper = DMat3::from_cols(
            DVec3::new(form.lambda, 0.0, 0.0),
            DVec3::new(form.coupling.x, form.block[0][0], form.block[1][0]),
            DVec3::new(form.coupling.y, form.block[0][1], form.block[1][1]),
        );
        let back = form.basis * upper * form.basis;
        let size = largest_entry(&matrix);
        let error = largest_entry(&(back - matrix));
        assert!(
            error <= 16.0 * f64::EPSILON * size,
            "error {error:e} of {size:e} for {matrix:?}"
        );
        let square = largest_entry(&(form.basis * form.basis - DMat3::IDENTITY));
        assert!(
            square <= 8.0 * f64::EPSILON,
            "the basis is not its own inverse: {square:e}"
        );
    }

    #[test]
    fn the_form_reproduces_the_matrix() {
        let mut next = random(1);
        for _ in 0..2000 {
            let matrix = DMat3::from_cols_array(&std::array::from_fn(|_| next()));
            check(matrix);
            check(matrix * 1e-9 + DMat3::IDENTITY);
            check(matrix * 1e150);
            check(matrix * 1e-150);
            check(matrix - matrix.transpose() + DMat3::IDENTITY * next());
            check(matrix + matrix.transpose());
        }
    }

    #[test]
    fn degenerate_matrices_are_split_too() {
        check(DMat3::ZERO);
        check(DMat3::IDENTITY * 3.0);
        check(DMat3::from_cols_array(&[
            0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0,
        ]));
        check(DMat3::from_cols_array(&[1.0; 9]));
        check(DMat3::from_cols_array(&[
            1.0, 1.0, 1.0, 2.0, 2.0, 2.0, -3.0, -3.0, -3.0,
        ]));
        check(DMat3::from_cols_array(&[
            0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0,
        ]));
    }

    #[test]
    fn a_permuted_triangular_matrix_is_split_without_rounding() {
        let matrix = DMat3::from_cols_array(&[0.3, 0.0, 1e8, 5e7, 0.7, 3e7, 0.0, 0.0, 1.1]);
        let form = Deflation::new(&matrix);
        assert_eq!(form.lambda, 1.1, "the eigenvalue of the third axis");
        assert_eq!(
            form.basis,
            DMat3::from_cols(DVec3::Z, DVec3::Y, DVec3::X),
            "a swap of axes"
        );
    }
}
