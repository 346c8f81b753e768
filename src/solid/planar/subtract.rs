//! What a tool leaves of a blank.
//!
//! It uses the arrangement of this module, not another library: so the result is exact on the same
//! grid, with the same outlines and measures.

use super::{Arrangement, ArrangementError, Segment, arrange};
use crate::body::Polygon;
use crate::numeric::index;
use glam::DVec2;

/// The part of `blank` that lies in none of the regions bounded by some loops.
///
/// - `removed`: closed polygons with the removed region on their left, such as the loops of a swept
///   region; they may overlap.
///
/// # Guarantee
/// As for [`arrange`]: the winding number of the blank minus those of the loops is 1 exactly in
/// what is left.
///
/// # Errors
/// [`ArrangementError::NonFinite`] for loops with such coordinates.
///
/// # Example
/// ```
/// use glam::DVec2;
/// use steadysweep::planar::{FillRule, Polygon, subtract};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let square = |from: f64, to: f64| {
///     [[from, from], [to, from], [to, to], [from, to]].map(DVec2::from_array).to_vec()
/// };
/// let blank = Polygon::new(vec![square(0.0, 3.0)], FillRule::EvenOdd)?;
/// let left = subtract(&blank, &[square(1.0, 2.0)])?;
/// let measures = left.measures(&left.outlines());
/// assert_eq!(measures.holes, 1);
/// assert!((measures.area - 8.0).abs() < 1e-9);
/// # Ok(())
/// # }
/// ```
pub fn subtract(blank: &Polygon, removed: &[Vec<DVec2>]) -> Result<Arrangement, ArrangementError> {
    let mut points = blank.positions().to_vec();
    let mut segments: Vec<Segment> = blank
        .edges()
        .map(|ends| Segment { ends, weight: 1 })
        .collect();
    for corners in removed {
        let first = index(points.len());
        let count = index(corners.len());
        points.extend_from_slice(corners);
        segments.extend((0..count).map(|corner| Segment {
            ends: [first + corner, first + (corner + 1) % count],
            weight: -1,
        }));
    }
    arrange(&points, &segments)
}
