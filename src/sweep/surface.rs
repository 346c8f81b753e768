//! The region swept by a surface of space, which has no inside.
//!
//! What a sheet covers is not what one sense of crossing gives: added with their signs, crossings in
//! opposite senses cancel (`planar/lines`, where both sides of a line are taken instead). In space a
//! sheet is swept as a *plate*: it is given a thickness of a share of the tolerance, and becomes a
//! body like any other. The plate contains the sheet, so that the region of the plate contains
//! that of the sheet, and what its sweep lacks bounds what the result lacks. No point of the plate
//! is farther from the sheet than half its thickness, so that the result sticks out by no more than
//! that, where the motion magnifies it most, besides the error of the sweep. Both bounds stay
//! proven, and parts of a sheet that move along themselves, which sweep no volume, stay as plates.

use super::spatial::{Sweep, SweepError, SweepSettings, sweep};
use crate::body::{Surface, ThickenError};
use crate::motion::{Motion, stretch};
use crate::numeric::tolerance::DEFAULT_TOLERANCE;
use glam::{DMat3, DVec3};

/// Half the thickness of the plate where the motion magnifies it most, as a share of the tolerance.
/// The sampling of the sheets of the envelope takes [`SWEEP_SHARE`], of which it is half: sheets of
/// both sides are kept apart.
const PLATE_SHARE: f64 = 0.25;

/// Share of the tolerance for the sweep of the plate.
const SWEEP_SHARE: f64 = 0.5;

/// Why the sweep of a surface was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceSweepError {
    /// The surface cannot be given a thickness.
    #[error(transparent)]
    Thicken(#[from] ThickenError),
    /// The sweep was refused.
    #[error(transparent)]
    Sweep(SweepError),
}

/// The region that a surface, open or closed, sweeps under `motion`, as a solid: all points that it
/// passes over.
///
/// - `surface`: in its own frame; each edge has one triangle or two, with the same side up. A closed
///   surface is a shell: what it encloses counts only where it passes.
/// - `motion`: carries that frame through the world. A chain that follows another motion within a
///   deviation must do so for a box that holds the plate, a tolerance larger than the surface.
/// - `settings`: as for [`sweep`](crate::sweep()), but nothing tells what swept a triangle.
///
/// # Guarantee
/// As for [`sweep`](crate::sweep()): both bounds are proven. The result contains a plate of about
/// half the tolerance around the surface at all times, even where it moves along itself.
///
/// # Errors
/// [`SurfaceSweepError`].
///
/// # Cost
/// That of a body with twice as many triangles at half the tolerance.
///
/// # Source
/// Hyun, Juettler & Kim (18), for a surface in place of a curve.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use steadysweep::body::Surface;
/// use steadysweep::motion::{Generator, Motion, Span};
/// use steadysweep::{SweepSettings, sweep_surface};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let corners = corners.map(DVec3::from_array).to_vec();
/// let square = Surface::new(corners, vec![[0, 1, 2], [0, 2, 3]])?;
/// let rise = Generator::translation(DVec3::new(0.5, 0.0, 2.0));
/// let motion = Motion::from_spans(vec![Span::new(rise, 1.0)?])?;
///
/// let swept = sweep_surface(&square, &motion, &SweepSettings::default())?;
/// let measures = swept.solid.measures();
/// assert!((measures.volume - 2.0).abs() < measures.area * swept.error_bound.outside.length);
/// # Ok(())
/// # }
/// ```
pub fn sweep_surface(
    surface: &Surface,
    motion: &Motion,
    settings: &SweepSettings,
) -> Result<Sweep, SurfaceSweepError> {
    let start = motion.start_pose();
    let corners = surface.triangles().iter().flatten();
    let [low, high] = corners.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], &v| {
        let p = start.transform_point3(surface.positions()[v as usize]);
        [low.min(p), high.max(p)]
    });
    let diagonal = low.distance(high);
    let tolerance = settings.tolerance.unwrap_or(DEFAULT_TOLERANCE * diagonal);
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(SurfaceSweepError::Sweep(SweepError::Tolerance {
            tolerance,
        }));
    }
    // As for bodies, coarser than the surface is no simpler.
    let tolerance = tolerance.min(diagonal);
    let thickness = 2.0 * PLATE_SHARE * tolerance / magnification(motion);
    let plate = surface.thickened(thickness)?;
    let of_plate = settings.with_tolerance(SWEEP_SHARE * tolerance);
    let mut swept = sweep(&plate, motion, &of_plate)
        .map_err(|error| SurfaceSweepError::Sweep(for_surface(error)))?;
    swept.error_bound.outside.length += PLATE_SHARE * tolerance;
    swept.tolerance = tolerance;
    swept.sources = None;
    Ok(swept)
}

/// The error of the sweep of a plate, in terms of the tolerance that was given for the surface.
fn for_surface(error: SweepError) -> SweepError {
    match error {
        SweepError::BelowRounding {
            tolerance,
            reach,
            precision,
            smallest,
        } => SweepError::BelowRounding {
            tolerance: tolerance / SWEEP_SHARE,
            reach,
            precision,
            smallest: smallest / SWEEP_SHARE,
        },
        other => other,
    }
}

/// Upper bound of the factor by which the motion stretches lengths on the body.
fn magnification(motion: &Motion) -> f64 {
    let start = motion.start_pose().matrix3;
    let spans = motion.spans().iter().zip(motion.joints());
    spans
        .map(|(span, joint)| {
            let linear = span.flow().generator().linear;
            norm(joint.matrix3 * start) * stretch(&linear, [0.0, 1.0])
        })
        .fold(0.0, f64::max)
}

/// Upper bound of the largest singular value, exact for multiples of rotations: the square root of
/// the largest sum of a row of M^T M.
fn norm(matrix: DMat3) -> f64 {
    let product = matrix.transpose() * matrix;
    let sums = [product.x_axis, product.y_axis, product.z_axis].map(|row| row.abs().element_sum());
    sums.into_iter().fold(0.0, f64::max).sqrt()
}
