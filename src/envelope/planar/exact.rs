//! The untrimmed envelope of a polygon, exact.

use super::{CycleError, PlanarBudget, Sampling};
use crate::body::Polygon;
use crate::grazing::Fold;
use crate::grazing::planar::{GrazingPoint, Source, SpanGrazing, of};
use crate::motion::planar::{Motion, stretch};
use crate::numeric::tolerance::MOST_SEGMENTS;
use glam::DVec2;

/// A curve of the untrimmed envelope: a grazing point, fixed on the body, carried along for one
/// span.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curve {
    /// The corner or edge that grazes there.
    pub source: Source,
    /// Number of the span, from 0.
    pub span: usize,
    /// The winding numbers that the curve separates.
    pub fold: Fold,
    /// Whether the lower winding number is on the right of the curve, run forwards in time.
    pub lower_on_right: bool,
    /// The point in the world at the start of the motion.
    pub start: DVec2,
}

impl Curve {
    /// The point of the curve in the world, at `share` in \[0, 1\] of the span.
    pub fn point(&self, motion: &Motion, share: f64) -> DVec2 {
        let start = motion.joints()[self.span].transform_point2(self.start);
        let flow = motion.spans()[self.span].flow();
        flow.pose_at(share).transform_point2(start)
    }

    /// The unit normal of the curve there, towards the lower of the winding numbers that it
    /// separates: out of the swept region where the curve bounds it. `None` where the point rests.
    pub fn normal(&self, motion: &Motion, share: f64) -> Option<DVec2> {
        let generator = motion.spans()[self.span].flow().generator();
        let velocity = generator.velocity(self.point(motion, share));
        let left = velocity.try_normalize()?.perp();
        Some(if self.lower_on_right { -left } else { left })
    }
}

/// The untrimmed envelope of a polygon under a motion: the curve of every grazing point, exact,
/// once per span.
///
/// `body` is given in its own frame. Curves come in the order of the spans, then along the
/// outlines. The boundary of the swept region is part of these curves and of the edges at the
/// start, at the joints and at the end. O(n) per span for n edges; nothing is sampled.
///
/// # Example
/// ```
/// use glam::DVec2;
/// use steadysweep::envelope::planar::envelope;
/// use steadysweep::planar::{FillRule, Generator, Motion, Polygon, Span};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(DVec2::from_array);
/// let square = Polygon::new(vec![corners.to_vec()], FillRule::EvenOdd)?;
/// let slide = Generator::translation(DVec2::new(1.0, 2.0));
/// let motion = Motion::from_spans(vec![Span::new(slide, 1.0)?])?;
///
/// // The corners at the lower right and the upper left run along the border of the swept strip.
/// let curves = envelope(&square, &motion);
/// assert_eq!(curves.len(), 2);
/// assert_eq!(curves[0].point(&motion, 0.5), DVec2::new(1.5, 1.0));
/// let normal = curves[0].normal(&motion, 0.5).ok_or("it moves")?;
/// assert!(normal.distance(DVec2::new(2.0, -1.0) / 5.0_f64.sqrt()) < 1e-15);
/// # Ok(())
/// # }
/// ```
pub fn envelope(body: &Polygon, motion: &Motion) -> Vec<Curve> {
    let curve = |span: usize, grazing: GrazingPoint| Curve {
        source: grazing.source,
        span,
        fold: grazing.fold,
        lower_on_right: grazing.to_egress,
        start: motion.start_pose().transform_point2(grazing.point),
    };
    let spans = of(body, motion).into_iter().enumerate();
    spans
        .flat_map(|(span, SpanGrazing { points })| {
            points.into_iter().map(move |point| curve(span, point))
        })
        .collect()
}

/// A curve of the untrimmed envelope, sampled.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledCurve {
    /// The exact curve.
    pub curve: Curve,
    /// The shares of the span at which it is sampled, from 0 to 1.
    pub shares: Vec<f64>,
    /// Its points at these shares.
    pub points: Vec<DVec2>,
    /// Bound on the distance between the curve and its chords. Proven, but for the rounding of
    /// `f64`.
    pub error: f64,
}

/// Samples the untrimmed envelope of a polygon under a motion: the curves of [`envelope`], those of
/// a span at common times.
///
/// - `budget`: its chord bounds the error; nothing is simplified.
///
/// # Errors
/// [`CycleError`] when there would be too many segments.
///
/// # Cost
/// O(n) per span for n edges, and O(grazing points x time steps) points.
pub fn sampled_envelope(
    body: &Polygon,
    motion: &Motion,
    budget: &PlanarBudget,
) -> Result<Vec<SampledCurve>, CycleError> {
    let mut sampled: Vec<SampledCurve> = Vec::new();
    let mut segments = 0.0;
    for curves in envelope(body, motion).chunk_by(|a, b| a.span == b.span) {
        let span = curves[0].span;
        let (flow, joint) = (motion.spans()[span].flow(), motion.joints()[span]);
        let places: Vec<DVec2> = curves
            .iter()
            .map(|curve| joint.transform_point2(curve.start))
            .collect();
        let growth = stretch(&flow.generator().linear, [0.0, 1.0]).max(1.0);
        let sampling = Sampling::new(flow, growth, &places, budget.chord);
        segments += sampling.steps as f64 * curves.len() as f64;
        if segments > MOST_SEGMENTS as f64 {
            return Err(CycleError::TooLarge { segments });
        }
        let shares: Vec<f64> = (0..=sampling.steps).map(|i| sampling.time(i)).collect();
        sampled.extend(curves.iter().map(|&curve| {
            SampledCurve {
                curve,
                points: shares
                    .iter()
                    .map(|&share| curve.point(motion, share))
                    .collect(),
                shares: shares.clone(),
                error: sampling.error,
            }
        }));
    }
    Ok(sampled)
}
