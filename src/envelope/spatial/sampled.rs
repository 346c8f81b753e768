//! The untrimmed envelope as triangles, for display and meshing.

use super::carrying::check_size;
use super::sampling::Sampling;
use super::{CycleError, Sheet, envelope};
use crate::body::Mesh;
use crate::motion::Motion;
use crate::numeric::index;
use crate::numeric::tolerance::Budget;
use glam::DVec3;
use std::collections::HashMap;

/// The untrimmed envelope, sampled.
#[derive(Debug, Clone, Default)]
pub struct SampledEnvelope {
    /// #V points of the envelope.
    pub positions: Vec<DVec3>,
    /// #F triples of points, counter-clockwise seen from the side of the lower winding number.
    pub triangles: Vec<[u32; 3]>,
    /// #F numbers of sheets.
    pub sheet: Vec<u32>,
    /// The exact sheets, as [`envelope`] gives them.
    pub sheets: Vec<Sheet>,
    /// Bound on the distance between the triangles and their sheets. Proven, but for the rounding
    /// of `f64`.
    pub error: f64,
}

/// Samples the untrimmed envelope of a mesh under a motion.
///
/// - `body`: given in its own frame.
/// - `budget`: its chord and twist bound the error; nothing is simplified, dents are not filled.
///
/// Sheets of a span that meet on the body share their points, and sheets of neighbouring spans
/// meet where the same edge grazes in both.
///
/// # Errors
/// [`CycleError`] when there would be too many triangles.
///
/// # Cost
/// O(#F) per span, and O(grazing segments x time steps) triangles.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use std::f64::consts::PI;
/// use steadysweep::body::Mesh;
/// use steadysweep::envelope::spatial::{Budget, sampled_envelope};
/// use steadysweep::motion::{Generator, Motion, Span};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let body = Mesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let turn = Generator::screw(DVec3::Z, DVec3::X * 3.0, PI, 0.5, 1.0);
/// let motion = Motion::from_spans(vec![Span::new(turn, 1.0)?])?;
///
/// let sampled = sampled_envelope(&body, &motion, &Budget::of(1e-2))?;
/// assert!(sampled.error <= 1e-2);
/// assert_eq!(sampled.triangles.len(), sampled.sheet.len());
/// # Ok(())
/// # }
/// ```
pub fn sampled_envelope(
    body: &Mesh,
    motion: &Motion,
    budget: &Budget,
) -> Result<SampledEnvelope, CycleError> {
    let mut sampled = SampledEnvelope {
        sheets: envelope(body, motion),
        ..SampledEnvelope::default()
    };
    let sheets = std::mem::take(&mut sampled.sheets);
    let mut first = 0;
    for of_span in sheets.chunk_by(|a, b| a.span == b.span) {
        sampled.add_span(of_span, first, motion, budget)?;
        first += of_span.len();
    }
    sampled.sheets = sheets;
    Ok(sampled)
}

impl SampledEnvelope {
    /// Adds the sheets of one span, of which the first has the number `first`.
    fn add_span(
        &mut self,
        sheets: &[Sheet],
        first: usize,
        motion: &Motion,
        budget: &Budget,
    ) -> Result<(), CycleError> {
        let span = sheets[0].span;
        let (flow, joint) = (motion.spans()[span].flow(), motion.joints()[span]);
        let ends = sheets.iter().flat_map(|sheet| sheet.ends);
        let sampling = Sampling::uniform(flow, ends.map(|p| joint.transform_point3(p)), budget);
        let steps = sampling.steps;
        let mut parts = Vec::new();
        for (number, sheet) in (first..).zip(sheets) {
            let [from, to] = sheet.ends;
            let at = |share: f64| joint.transform_point3(from.lerp(to, share));
            let stops = sampling.divide(at, budget.twist);
            for pair in stops.windows(2) {
                let error = sampling.error(at(pair[0]), at(pair[1]));
                self.error = self.error.max(error);
                let place = |share: f64| match share {
                    0.0 => from,
                    1.0 => to,
                    _ => from.lerp(to, share),
                };
                parts.push((index(number), [pair[0], pair[1]].map(place)));
            }
            let triangles = self.triangles.len() as f64;
            check_size(triangles + 2.0 * steps as f64 * parts.len() as f64)?;
        }
        let poses: Vec<_> = (0..=steps)
            .map(|step| flow.pose_at(sampling.time(step)) * joint)
            .collect();
        // The first point of the path through each point of the body, at the start of the span.
        let mut paths: HashMap<[u64; 3], u32> = HashMap::new();
        for (number, ends) in parts {
            let [a, b] = ends.map(|end| {
                // Without the sign of a zero.
                let bits = (end + DVec3::ZERO).to_array().map(f64::to_bits);
                *paths.entry(bits).or_insert_with(|| {
                    let path = index(self.positions.len());
                    let points = poses.iter().map(|pose| pose.transform_point3(end));
                    self.positions.extend(points);
                    path
                })
            });
            for step in 0..index(steps) {
                let [a, b] = [a + step, b + step];
                self.triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
                self.sheet.extend([number; 2]);
            }
        }
        Ok(())
    }
}
