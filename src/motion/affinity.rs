//! The affine map that carries given points to given points, exactly or in least squares.

use super::MotionError;
use super::logarithm::check_pose;
use crate::numeric::tolerance::{FLAT_POINTS, FLAT_POINTS_ROUNDING};
use glam::{DAffine3, DMat3, DVec3};

/// An affine map fitted to pairs of points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointFit<Pose> {
    /// The map from sources to targets.
    pub pose: Pose,
    /// How well it fits.
    pub quality: FitQuality,
}

/// How well a map fits the pairs of points from which it was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitQuality {
    /// Number of pairs.
    pub pairs: usize,
    /// The largest distance between the image of a source and its target.
    pub largest: f64,
    /// The root mean square of these distances.
    pub root_mean_square: f64,
}

/// The affine map of space that carries points to points: through four pairs exactly, up to
/// rounding; of more it is the one with the least sum of squared distances.
///
/// - `pairs`: source and target, at least four; the order does not matter.
///
/// # Guarantee
/// An affine map, not a rigid one: pairs that were measured on a rigid body give a map that
/// stretches by their errors.
///
/// # Errors
/// [`MotionError::NonFinite`]; [`MotionError::TooFewPoints`]; [`MotionError::FlatSources`] or
/// [`MotionError::FlatTargets`] where they are in one plane up to 1e-9 of their size; and
/// [`MotionError::MirroredTargets`].
///
/// # Cost
/// Linear in the number of pairs.
///
/// # Source
/// Rossignac & Vinacua, section 2.1, name both cases. The least squares are solved by orthogonal
/// projection, modified Gram-Schmidt with the target as an augmented column (Bjorck), not by normal
/// equations, which would square the ratio of length to thickness.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use steadysweep::motion::from_points;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let fit = from_points(&corners.map(|corner| [corner, 2.0 * corner + DVec3::ONE]))?;
/// let image = fit.pose.transform_point3(DVec3::splat(0.5));
/// assert!(image.distance(DVec3::splat(2.0)) < 1e-15 && fit.quality.largest < 1e-15);
/// # Ok(())
/// # }
/// ```
pub fn from_points(pairs: &[[DVec3; 2]]) -> Result<PointFit<DAffine3>, MotionError> {
    let numbers: Vec<[[f64; 3]; 2]> = pairs
        .iter()
        .map(|pair| pair.map(|point| point.to_array()))
        .collect();
    let Fitted { columns, centres } = fitted(&numbers)?;
    let [source, target] = centres.map(DVec3::from_array);
    let matrix3 = DMat3::from_cols_array_2d(&columns);
    let pose = DAffine3 {
        matrix3,
        translation: target - matrix3 * source,
    };
    check_pose(&pose).map_err(MotionError::of_targets)?;
    let left = |pair: &[DVec3; 2]| pose.transform_point3(pair[0]).distance(pair[1]);
    Ok(PointFit::new(pose, pairs.iter().map(left)))
}

impl<Pose> PointFit<Pose> {
    /// - `left`: the distances between images and targets, at least one.
    pub(super) fn new(pose: Pose, left: impl Iterator<Item = f64>) -> PointFit<Pose> {
        let distances: Vec<f64> = left.collect();
        let largest = distances.iter().copied().fold(0.0, f64::max);
        // In units of the largest, so that no square leaves the range of numbers.
        let squares: f64 = distances
            .iter()
            .map(|d| (d / largest) * (d / largest))
            .sum();
        let mean = if largest > 0.0 {
            largest * (squares / distances.len() as f64).sqrt()
        } else {
            0.0
        };
        PointFit {
            pose,
            quality: FitQuality {
                pairs: distances.len(),
                largest,
                root_mean_square: mean,
            },
        }
    }
}

/// An affine map that fits best.
pub(super) struct Fitted<const N: usize> {
    /// The columns of its linear part.
    pub(super) columns: [[f64; N]; N],
    /// The centres of the sources and of the targets, which it maps to each other.
    pub(super) centres: [[f64; N]; 2],
}

/// The affine map that fits best.
///
/// # Errors
/// Those of [`from_points`], but for reflections.
pub(super) fn fitted<const N: usize>(pairs: &[[[f64; N]; 2]]) -> Result<Fitted<N>, MotionError> {
    if pairs
        .as_flattened()
        .iter()
        .flatten()
        .any(|x| !x.is_finite())
    {
        return Err(MotionError::NonFinite { what: "points" });
    }
    if pairs.len() <= N {
        return Err(MotionError::TooFewPoints {
            found: pairs.len(),
            needed: N + 1,
        });
    }
    let [sources, targets] = [0, 1].map(|side| {
        let points = pairs.iter().map(|pair| pair[side]).collect::<Vec<_>>();
        Centred::new(&points)
    });
    // The targets first onto their own directions, for their thickness alone.
    targets
        .triangular(&targets)
        .ok_or(MotionError::FlatTargets { dimension: N })?;
    let triangle = sources
        .triangular(&targets)
        .ok_or(MotionError::FlatSources { dimension: N })?;
    let mut columns = triangle.solved();
    for number in columns.as_flattened_mut() {
        *number *= targets.scale / sources.scale;
    }
    Ok(Fitted {
        columns,
        centres: [sources.centre, targets.centre],
    })
}

/// Points about their centre, one list per coordinate.
struct Centred<const N: usize> {
    centre: [f64; N],
    /// In units of `scale`, so that no square leaves the range of numbers.
    coordinates: [Vec<f64>; N],
    scale: f64,
    /// The largest coordinate before.
    largest: f64,
}

/// An orthogonal basis of columns, pivot by pivot: the columns in it, and other columns as far as
/// they lie in it.
struct Triangle<const N: usize> {
    /// Number of the coordinate of each pivot.
    order: [usize; N],
    /// By direction, and by coordinate: the part of the column of that coordinate along it.
    upper: [[f64; N]; N],
    /// The same of the other columns.
    others: [[f64; N]; N],
}

impl<const N: usize> Centred<N> {
    fn new(points: &[[f64; N]]) -> Centred<N> {
        let largest_of = |numbers: &mut dyn Iterator<Item = f64>| {
            numbers.fold(0.0_f64, |largest, x| largest.max(x.abs()))
        };
        let count = points.len() as f64;
        // Divided first: the sum may not be finite.
        let centre = std::array::from_fn(|axis| points.iter().map(|p| p[axis] / count).sum());
        let centred = |axis: usize| {
            let centre: [f64; N] = centre;
            points.iter().map(move |p| p[axis] - centre[axis])
        };
        let scale = largest_of(&mut (0..N).flat_map(centred));
        let unit = if scale > 0.0 { scale } else { 1.0 };
        Centred {
            centre,
            coordinates: std::array::from_fn(|axis| centred(axis).map(|x| x / unit).collect()),
            scale: unit,
            largest: largest_of(&mut points.as_flattened().iter().copied()),
        }
    }

    /// The coordinates made orthogonal, and those of other points along the same directions; `None`
    /// where the points are flat.
    fn triangular(&self, others: &Centred<N>) -> Option<Triangle<N>> {
        let mut columns = self.coordinates.clone();
        let mut rest = others.coordinates.clone();
        let mut triangle = Triangle {
            order: std::array::from_fn(|k| k),
            upper: [[0.0; N]; N],
            others: [[0.0; N]; N],
        };
        let count = self.coordinates[0].len() as f64;
        let rounding = FLAT_POINTS_ROUNDING * count.sqrt() * self.largest / self.scale;
        let mut thickness = 0.0;
        for step in 0..N {
            let lengths = columns.each_ref().map(|column| dot(column, column).sqrt());
            let pivot = (step..N)
                .max_by(|&i, &j| lengths[triangle.order[i]].total_cmp(&lengths[triangle.order[j]]))
                .unwrap_or(step);
            triangle.order.swap(step, pivot);
            let pivot = triangle.order[step];
            let length = lengths[pivot];
            if step == 0 {
                thickness = FLAT_POINTS * length + rounding;
            }
            if length.is_nan() || length <= thickness {
                return None;
            }
            let direction: Vec<f64> = columns[pivot].iter().map(|x| x / length).collect();
            triangle.upper[step][pivot] = length;
            for &next in &triangle.order[step + 1..] {
                triangle.upper[step][next] = projected_out(&mut columns[next], &direction);
            }
            for (part, column) in triangle.others[step].iter_mut().zip(&mut rest) {
                *part = projected_out(column, &direction);
            }
        }
        Some(triangle)
    }
}

impl<const N: usize> Triangle<N> {
    /// For each coordinate, its factors in the other columns: column i of the linear part.
    fn solved(&self) -> [[f64; N]; N] {
        let mut columns = [[0.0; N]; N];
        for step in (0..N).rev() {
            let pivot = self.order[step];
            columns[pivot] = std::array::from_fn(|axis| {
                let known: f64 = self.order[step + 1..]
                    .iter()
                    .map(|&j| self.upper[step][j] * columns[j][axis])
                    .sum();
                (self.others[step][axis] - known) / self.upper[step][pivot]
            });
        }
        columns
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Takes away the part of a column along a unit direction, and returns its size.
fn projected_out(column: &mut [f64], direction: &[f64]) -> f64 {
    let part = dot(column, direction);
    for (x, d) in column.iter_mut().zip(direction) {
        *x -= part * d;
    }
    part
}
