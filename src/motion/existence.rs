//! Whether a steady motion leads from one pose to another, and by what margin.

use super::chain::Steady;
use super::deflation::largest_entry;
use super::{Flow, MotionError, logarithm};
use crate::numeric::tolerance::{HALF_TURN_ANGLE, LEAST_CHANGE};
use glam::{DAffine3, DMat3};
use std::f64::consts::{PI, TAU};

/// Whether a steady motion leads from one pose to another, and by what margin.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Existence {
    /// Whether there is one.
    pub exists: bool,
    /// Whether the one that turns least is the only one that turns so little: false for a half
    /// turn, and where there is none.
    pub unique: bool,
    /// By how much the eigenvalues miss the negative axis, as an angle in radians: pi minus the
    /// turn of the complex pair, pi where nothing turns. 0 for a half turn, and where there is no
    /// steady motion.
    pub angle: f64,
    /// A lower bound, within a hundredth or 1e-9, of the least change of the linear part that puts an
    /// eigenvalue on the closed negative axis, relative to its size (in the spectral norm). Poses
    /// that differ by less have a unique steady motion, too; a change of this size may leave none.
    /// 0 for a half turn, and where there is no steady motion.
    pub change: f64,
}

/// Whether a steady motion leads from one pose to another in space, and by what margin.
///
/// # Errors
/// Those of [`logarithm`](super::logarithm()), but for [`MotionError::NoRealLogarithm`], which is an
/// answer.
///
/// # Source
/// Rossignac & Vinacua, sections 5.1 and 5.2: a steady motion exists unless eigenvalues of L = C
/// B^-1 are negative, but for a half turn. The distance of L from the matrices with a negative
/// eigenvalue is the least of the smallest singular values of L + t I for t >= 0, found here by
/// bisection, since they change by no more than t does. In the plane L = R(a) diag(s, 1/s) is at
/// distance 0 where their condition (4) is an equality, |a| = pi/2 + 2 atan s.
///
/// # Example
/// ```
/// use glam::{DAffine3, DVec3};
/// use steadysweep::motion::existence;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let turned = |angle| DAffine3::from_axis_angle(DVec3::Z, angle);
/// // A turn by 2 of 3.14 radians, and one that also stretches along two axes of the plane.
/// let turn = existence(&DAffine3::IDENTITY, &turned(2.0))?;
/// assert!((turn.angle - 1.14159).abs() < 1e-5 && turn.change > 0.1);
/// let stretched = turned(2.0) * DAffine3::from_scale(DVec3::new(1.0, 0.01, 1.0));
/// assert!(!existence(&DAffine3::IDENTITY, &stretched)?.exists);
/// # Ok(())
/// # }
/// ```
pub fn existence(from: &DAffine3, to: &DAffine3) -> Result<Existence, MotionError> {
    Flow::check_pose(from)?;
    let relative = Flow::relative(from, to);
    let found = logarithm(&relative).map(|steady| (steady.unique(), steady.flow.turns()));
    answered(found, &relative.matrix3)
}

/// - `found`: whether the steady motion is unique, and how often it turns.
pub(super) fn answered(
    found: Result<(bool, f64), MotionError>,
    linear: &DMat3,
) -> Result<Existence, MotionError> {
    match found {
        Ok((unique, turns)) => Ok(Existence {
            exists: true,
            unique,
            angle: if unique {
                (PI - TAU * turns).max(0.0)
            } else {
                0.0
            },
            change: if unique { least_change(linear) } else { 0.0 },
        }),
        Err(MotionError::NoRealLogarithm { .. }) => Ok(Existence {
            exists: false,
            unique: false,
            angle: 0.0,
            change: 0.0,
        }),
        Err(other) => Err(other),
    }
}

/// A lower bound of the least spectral norm of a change that gives L an eigenvalue -t <= 0, over
/// the norm of L.
fn least_change(linear: &DMat3) -> f64 {
    let size = largest_entry(linear);
    let unit = *linear * size.recip();
    let norm = greatest_stretch(&unit);
    // For t beyond twice the norm, all singular values are above it.
    let at = |t: f64| (t, least_stretch(&(unit + DMat3::IDENTITY * t)));
    let mut open = vec![[at(0.0), at(2.0 * norm)]];
    let mut least = open[0][0].1.min(open[0][1].1);
    let mut bound = least;
    while let Some([(start, low), (end, high)]) = open.pop() {
        // The singular value changes by no more than t.
        let below = 0.5 * (low + high - (end - start));
        if below >= (1.0 - LEAST_CHANGE) * least || end - start <= HALF_TURN_ANGLE * norm {
            bound = bound.min(below.max(0.0));
        } else {
            let middle = at(0.5 * (start + end));
            least = least.min(middle.1);
            open.push([middle, (end, high)]);
            open.push([(start, low), middle]);
        }
    }
    bound / norm
}

/// The largest singular value.
fn greatest_stretch(matrix: &DMat3) -> f64 {
    greatest_eigenvalue(&(matrix.transpose() * *matrix))
        .max(0.0)
        .sqrt()
}

/// The smallest singular value: the determinant over the product of the others, which does not
/// cancel.
fn least_stretch(matrix: &DMat3) -> f64 {
    let square = matrix.transpose() * *matrix;
    let largest = greatest_eigenvalue(&square);
    let determinant = matrix.determinant();
    // Sum and product of the squares of the other two.
    let sum = square.x_axis.x + square.y_axis.y + square.z_axis.z - largest;
    let product = determinant * determinant / largest;
    let middle = 0.5 * (sum + (sum * sum - 4.0 * product).max(0.0).sqrt());
    if middle > 0.0 {
        determinant.abs() / (largest * middle).sqrt()
    } else {
        0.0
    }
}

/// The largest eigenvalue of a symmetric matrix, by the cosine of a third of an angle.
fn greatest_eigenvalue(matrix: &DMat3) -> f64 {
    let mean = (matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z) / 3.0;
    let centred = *matrix - DMat3::IDENTITY * mean;
    let square = centred * centred;
    let size = ((square.x_axis.x + square.y_axis.y + square.z_axis.z) / 6.0).sqrt();
    if size == 0.0 {
        return mean;
    }
    let cosine = 0.5 * (centred * size.recip()).determinant();
    mean + 2.0 * size * (cosine.clamp(-1.0, 1.0).acos() / 3.0).cos()
}
