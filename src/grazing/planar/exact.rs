//! The grazing points of a polygon under a motion, exact, span by span.

use super::GrazingSet;
use crate::body::Polygon;
use crate::grazing::Fold;
use crate::motion::planar::{Generator, Motion};
use glam::{DAffine2, DVec2};

/// The part of a polygon that grazes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Source {
    /// A corner between an egress and an ingress edge, index into [`Polygon::positions`].
    Corner(u32),
    /// A point inside an edge, which begins at the corner of the same number.
    Edge(u32),
}

/// Where a polygon grazes during one span: points that are fixed on it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SpanGrazing {
    /// The points at which the outlines change between egress and ingress, along each outline.
    pub points: Vec<GrazingPoint>,
}

/// A point at which a polygon grazes: carried along, it runs along a curve of the envelope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrazingPoint {
    /// A corner, or an edge inside which the flux changes sign.
    pub source: Source,
    /// Position on the edge, from 0 at its first corner to 1 at its second: s of SAM (8); 0 for a
    /// corner.
    pub at: f64,
    /// The point, in the body's own coordinates.
    pub point: DVec2,
    /// Whether the outline is egress after it, along the direction that has the body on its left.
    pub to_egress: bool,
    /// Whether its curve may bound the swept region.
    pub fold: Fold,
}

/// Where a polygon grazes in each span of a motion.
///
/// - `body`: given in its own frame.
/// - `motion`: carries that frame through the plane.
///
/// Nothing is simplified and nothing is sampled: on the body these points are fixed while a span
/// lasts, up to rounding. An edge that slides along itself counts as egress.
///
/// # Cost
/// O(n) per span for n edges.
///
/// # Source
/// Rossignac & Vinacua, *Steady Affine Motions and Morphs*, 7.2.
///
/// # Example
/// ```
/// use glam::DVec2;
/// use std::f64::consts::PI;
/// use steadysweep::grazing::planar;
/// use steadysweep::planar::{FillRule, Generator, Motion, Polygon, Span};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(DVec2::from_array);
/// let square = Polygon::new(vec![corners.to_vec()], FillRule::EvenOdd)?;
/// let turn = Generator::spiral(DVec2::new(0.5, 0.0), PI, 1.0);
/// let motion = Motion::from_spans(vec![Span::new(turn, 1.0)?])?;
///
/// // Each side grazes at the foot of the centre, and each corner between two sides.
/// let grazing = planar::of(&square, &motion);
/// assert_eq!(grazing[0].points.len(), 8);
/// let below = grazing[0].points.iter().find(|p| p.source == planar::Source::Edge(0));
/// assert_eq!(below.map(|p| p.point), Some(DVec2::new(0.5, -1.0)));
/// # Ok(())
/// # }
/// ```
pub fn of(body: &Polygon, motion: &Motion) -> Vec<SpanGrazing> {
    let edges: Vec<[u32; 2]> = body.edges().collect();
    let mut before: Vec<u32> = (0..).take(edges.len()).collect();
    for [from, to] in &edges {
        before[*to as usize] = *from;
    }
    let own = body.positions();
    let spans = motion.spans().iter().zip(motion.joints());
    spans
        .map(|(span, joint)| {
            let generator = span.flow().generator();
            let pose = *joint * *motion.start_pose();
            let positions: Vec<DVec2> = own.iter().map(|&p| pose.transform_point2(p)).collect();
            let set = GrazingSet::new(body, &positions, generator, 0.0);
            let points = set.changes(body).into_iter().map(|change| {
                let corner = change.edge as usize;
                let [from, to] = edges[corner].map(|end| end as usize);
                let source = if change.at == 0.0 {
                    Source::Corner(change.edge)
                } else {
                    Source::Edge(change.edge)
                };
                let fold = match source {
                    Source::Corner(_) => {
                        let last = own[before[corner] as usize];
                        corner_fold((own[from] - last).perp_dot(own[to] - own[from]))
                    }
                    Source::Edge(_) => edge_fold(
                        &pose,
                        own[to] - own[from],
                        own[from].lerp(own[to], change.at),
                        generator,
                    ),
                };
                GrazingPoint {
                    source,
                    at: change.at,
                    point: if change.at == 0.0 {
                        own[from]
                    } else {
                        own[from].lerp(own[to], change.at)
                    },
                    to_egress: change.to_egress,
                    fold,
                }
            });
            SpanGrazing {
                points: points.collect(),
            }
        })
        .collect()
}

/// A convex corner, which turns to the left, is outside of what its neighbourhood sweeps.
fn corner_fold(turn: f64) -> Fold {
    if turn > 0.0 { Fold::Outer } else { Fold::Inner }
}

/// A point inside an edge is outside of what its neighbourhood sweeps where n . M v > 0: its path
/// bends away from the body.
fn edge_fold(pose: &DAffine2, edge: DVec2, point: DVec2, generator: &Generator) -> Fold {
    let outward = -pose.transform_vector2(edge).perp();
    if outward.dot(generator.acceleration(pose.transform_point2(point))) > 0.0 {
        Fold::Outer
    } else {
        Fold::Inner
    }
}

/// SAM (8) in the plane: where the velocity runs along an edge.
///
/// - `generator`: the velocity field v(p) = M p + tau.
/// - `origin`, `direction`: the edge q + s t, in the same frame.
///
/// The root s = -n . (M q + tau) / n . (M t) of the flux, where n is square to t; `None` where the
/// flux is the same all along the line, or the root is beyond the range of `f64`. From 0 to 1 it is
/// on the edge from q to q + t. See [`crate::grazing::on_line_in_face`].
///
/// # Example
/// ```
/// use glam::DVec2;
/// use steadysweep::grazing::planar;
/// use steadysweep::planar::Generator;
///
/// let turn = Generator::spiral(DVec2::new(1.0, 2.0), 1.0, 1.0);
/// assert_eq!(planar::on_line(&turn, DVec2::ZERO, DVec2::X * 4.0), Some(0.25));
/// ```
pub fn on_line(generator: &Generator, origin: DVec2, direction: DVec2) -> Option<f64> {
    let normal = direction.perp();
    let s = -normal.dot(generator.velocity(origin)) / normal.dot(generator.linear * direction);
    s.is_finite().then_some(s)
}
