//! The grazing points and segments of a mesh under a motion, exact, span by span.

use super::{Fold, GrazingSet, Simplification, Source, boundary, breaks_on, edge_line, on_line};
use crate::body::Mesh;
use crate::motion::{Generator, Motion};
use crate::numeric::index;
use crate::watch::Work;
use glam::{DAffine3, DVec3};

/// Where a body grazes during one span: points and segments that are fixed on it.
///
/// All coordinates are the body's own: there they hold for the whole span, and a pose of the motion
/// takes them to the world ([`Motion::trajectory`]).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SpanGrazing {
    /// The places on edges where the flux through one of the two faces changes sign: by edge, and
    /// for each its first face first.
    pub points: Vec<GrazingPoint>,
    /// The boundary of the egress part of the surface: closed loops of segments, first those of
    /// edges, then those across faces, by number.
    pub segments: Vec<GrazingSegment>,
}

/// A point of an edge at which the velocity is tangent to one of its faces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrazingPoint {
    /// The edge, index into [`Mesh::edges`].
    pub edge: u32,
    /// The face whose flux is zero there.
    pub face: u32,
    /// Position on the edge, from 0 at its first vertex to 1 at its second: s of SAM (8).
    pub at: f64,
    /// The point, in the body's own coordinates.
    pub point: DVec3,
}

/// A segment along which a body grazes: carried along, it sweeps a sheet of the envelope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrazingSegment {
    /// An edge between an egress and an ingress face, or a face through which the flux changes
    /// sign.
    pub source: Source,
    /// Whether its sheet may bound the swept region.
    pub fold: Fold,
    /// Its ends in the body's own coordinates, with the egress part on the left.
    pub ends: [DVec3; 2],
}

/// Where a mesh grazes in each span of a motion.
///
/// - `body`: given in its own frame.
/// - `motion`: carries that frame through the world.
///
/// Nothing is simplified and nothing is sampled: on the body these sets are fixed while a span
/// lasts, up to rounding (the sign rule of [`crate::grazing`]). A face along which the flux is zero
/// everywhere slides along itself; it counts as egress, so that it grazes at its border.
///
/// # Cost
/// O(#F) per span.
///
/// # Source
/// Rossignac & Vinacua, *Steady Affine Motions and Morphs*, 7.2.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use std::f64::consts::PI;
/// use steadysweep::body::Mesh;
/// use steadysweep::grazing;
/// use steadysweep::motion::{Generator, Motion, Span};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
/// let body = Mesh::new(corners.map(DVec3::from_array).to_vec(), triangles)?;
/// // About the vertical axis through (1/4, -1, 0): the face y = 0 grazes above x = 1/4.
/// let turn = Generator::screw(DVec3::Z, DVec3::new(0.25, -1.0, 0.0), PI, 0.0, 1.0);
/// let motion = Motion::from_spans(vec![Span::new(turn, 1.0)?])?;
///
/// let grazing = grazing::of(&body, &motion);
/// assert_eq!(grazing.len(), 1, "one span");
/// let of_front: Vec<DVec3> =
///     grazing[0].points.iter().filter(|p| p.face == 1).map(|p| p.point).collect();
/// assert_eq!(of_front, [DVec3::new(0.25, 0.0, 0.0), DVec3::new(0.25, 0.0, 0.75)]);
/// # Ok(())
/// # }
/// ```
pub fn of(body: &Mesh, motion: &Motion) -> Vec<SpanGrazing> {
    let start = motion.start_pose();
    let at_start = body.transformed(start);
    let spans = motion.spans().iter().zip(motion.joints());
    spans
        .map(|(span, frame)| {
            let generator = span.flow().generator();
            let set = GrazingSet::exact(&at_start, frame, generator);
            let intervals = boundary(body, &set, &(*frame * *start), generator);
            SpanGrazing {
                points: points(body, &set),
                segments: intervals
                    .into_iter()
                    .map(|interval| {
                        let mut ends = interval.ends.map(|t| interval.at(t));
                        if interval.reversed {
                            ends.reverse();
                        }
                        GrazingSegment {
                            source: interval.source,
                            fold: interval.fold,
                            ends,
                        }
                    })
                    .collect(),
            }
        })
        .collect()
}

/// The grazing points of the edges, in the coordinates of `body`.
fn points(body: &Mesh, set: &GrazingSet) -> Vec<GrazingPoint> {
    let mut points = Vec::new();
    for edge in 0..index(body.edges().len()) {
        let faces = body.edges()[edge as usize].faces;
        let line = edge_line(body, edge);
        for (face, at) in faces.into_iter().zip(breaks_on(body, set, edge)) {
            points.extend(at.map(|at| GrazingPoint {
                edge,
                face,
                at,
                point: on_line(&line, at),
            }));
        }
    }
    points
}

impl GrazingSet {
    /// The grazing set without any simplification.
    ///
    /// - `body`: in the world at the start of the motion.
    /// - `frame`: pose of the start of the span relative to that.
    pub(crate) fn exact(body: &Mesh, frame: &DAffine3, generator: &Generator) -> GrazingSet {
        let positions: Vec<DVec3> = body
            .positions()
            .iter()
            .map(|&p| frame.transform_point3(p))
            .collect();
        let nothing = Simplification {
            fold: 0.0,
            merge: 0.0,
        };
        GrazingSet::new(body, &positions, generator, nothing, Work::UNWATCHED)
            .expect("nobody stops it")
    }
}

/// SAM (8): where the velocity is tangent to a face along a line in it, such as one of its edges.
///
/// - `generator`: the velocity field v(p) = M p + tau.
/// - `origin`, `direction`: the line q + s t, in the same frame.
/// - `normal`: n, normal of the face, of any length.
///
/// The flux n . v(q + s t) is linear in s; its root s = -n . (M q + tau) / n . (M t) is returned, or
/// `None` where it is the same all along the line, or its root is beyond the range of `f64`. From 0
/// to 1 it is on the edge from q to q + t.
///
/// The root is the same at all times when line, normal and field are those of one pose of a span.
/// The paper prints it with the other sign, and for an origin at the fixed point.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use steadysweep::grazing;
/// use steadysweep::motion::Generator;
///
/// // Turning about z through (1, 2, 0), the wall y = 0 grazes below the axis.
/// let turn = Generator::screw(DVec3::Z, DVec3::new(1.0, 2.0, 0.0), 1.0, 0.0, 1.0);
/// assert_eq!(grazing::on_line_in_face(&turn, DVec3::ZERO, DVec3::X * 4.0, DVec3::Y), Some(0.25));
/// // Along the axis the flux does not change.
/// assert_eq!(grazing::on_line_in_face(&turn, DVec3::ZERO, DVec3::Z, DVec3::Y), None);
/// ```
pub fn on_line_in_face(
    generator: &Generator,
    origin: DVec3,
    direction: DVec3,
    normal: DVec3,
) -> Option<f64> {
    let s = -normal.dot(generator.velocity(origin)) / normal.dot(generator.linear * direction);
    s.is_finite().then_some(s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{Keyframe, Span};
    use glam::{DMat3, DQuat};

    /// A tetrahedron far from regular, and a chain of two general affine spans from a pose.
    fn case() -> (Mesh, Motion) {
        let corners = [
            DVec3::new(0.1, -0.4, 0.0),
            DVec3::new(1.3, 0.2, -0.3),
            DVec3::new(-0.2, 1.1, 0.2),
            DVec3::new(0.3, 0.2, 1.4),
        ];
        let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let body = Mesh::new(corners.to_vec(), triangles).expect("a tetrahedron");
        let key = |time, axis, angle, scale, way| Keyframe {
            time,
            pose: DAffine3::from_scale_rotation_translation(
                scale,
                DQuat::from_axis_angle(axis, angle),
                way,
            ),
        };
        let keys = [
            key(0.0, DVec3::X, 0.4, DVec3::new(1.0, 1.2, 0.9), DVec3::ONE),
            key(1.0, DVec3::Y, 1.1, DVec3::new(1.5, 0.8, 1.0), DVec3::ZERO),
            key(3.0, DVec3::Z, -0.7, DVec3::splat(0.7), DVec3::NEG_X),
        ];
        (body, Motion::from_keyframes(&keys).expect("a legal chain"))
    }

    /// The flux through a face of the body at a point of it, both carried to a time of a span.
    fn flux(body: &Mesh, motion: &Motion, span: usize, share: f64, face: u32, point: DVec3) -> f64 {
        let flow = motion.spans()[span].flow();
        let pose = flow.pose_at(share) * motion.joints()[span] * *motion.start_pose();
        let corners = body.triangles()[face as usize]
            .map(|v| pose.transform_point3(body.positions()[v as usize]));
        let normal = (corners[1] - corners[0])
            .cross(corners[2] - corners[0])
            .normalize();
        normal.dot(flow.generator().velocity(pose.transform_point3(point)))
    }

    #[test]
    fn points_graze_through_the_whole_span_and_are_those_of_the_paper() {
        let (body, motion) = case();
        let mut count = 0;
        for (span, grazing) in of(&body, &motion).iter().enumerate() {
            let generator = motion.spans()[span].flow().generator();
            let pose = motion.joints()[span] * *motion.start_pose();
            let in_body = generator.in_frame(&pose);
            for at in &grazing.points {
                for share in [0.0, 0.3, 1.0] {
                    let flux = flux(&body, &motion, span, share, at.face, at.point);
                    assert!(flux.abs() < 1e-14, "span {span}, {at:?}: flux {flux:e}");
                }
                let [from, to] = body.edges()[at.edge as usize]
                    .vertices
                    .map(|v| body.positions()[v as usize]);
                let triangle = body.triangles()[at.face as usize];
                let [a, b, c] = triangle.map(|v| body.positions()[v as usize]);
                let normal = (b - a).cross(c - a);
                let s = on_line_in_face(&in_body, from, to - from, normal).expect("it changes");
                assert!((s - at.at).abs() < 1e-14, "{s} against {at:?}");
                assert!(at.point.distance(from.lerp(to, s)) < 1e-14, "{at:?}");
                count += 1;
            }
        }
        assert!(count > 4, "{count} points");
    }

    /// Beside a segment the flux has the sign that the left of it, or its other side, promises.
    #[test]
    fn segments_separate_egress_from_ingress() {
        let (body, motion) = case();
        for (span, grazing) in of(&body, &motion).iter().enumerate() {
            assert!(!grazing.segments.is_empty(), "span {span} grazes");
            for segment in &grazing.segments {
                let [from, to] = segment.ends;
                let middle = from.midpoint(to);
                let faces = match segment.source {
                    Source::Edge(edge) => body.edges()[edge as usize].faces.to_vec(),
                    Source::Face(face) => vec![face],
                };
                for face in faces {
                    let triangle = body.triangles()[face as usize];
                    let [a, b, c] = triangle.map(|v| body.positions()[v as usize]);
                    let left = (b - a).cross(c - a).cross(to - from).normalize();
                    let side = left * 1e-6;
                    let into = match segment.source {
                        Source::Face(_) => [Some(side), Some(-side)],
                        // Only one of both sides of an edge is in the face.
                        Source::Edge(_) if ((a + b + c) / 3.0 - middle).dot(left) > 0.0 => {
                            [Some(side), None]
                        }
                        Source::Edge(_) => [None, Some(-side)],
                    };
                    let at = |side: DVec3| flux(&body, &motion, span, 0.4, face, middle + side);
                    assert!(into[0].is_none_or(|left| at(left) > 0.0), "{segment:?}");
                    assert!(into[1].is_none_or(|right| at(right) < 0.0), "{segment:?}");
                }
            }
        }
    }

    #[test]
    fn the_flux_of_a_translation_changes_along_no_line() {
        let field = Generator::translation(DVec3::ONE);
        assert_eq!(
            on_line_in_face(&field, DVec3::ZERO, DVec3::X, DVec3::X),
            None
        );
        let still = Generator {
            linear: DMat3::ZERO,
            offset: DVec3::ZERO,
        };
        assert_eq!(
            on_line_in_face(&still, DVec3::ZERO, DVec3::X, DVec3::X),
            None
        );
        let (body, _) = case();
        let span = Span::new(field, 1.0).expect("a span");
        let motion = Motion::from_spans(vec![span]).expect("a motion");
        let grazing = of(&body, &motion);
        assert!(grazing[0].points.is_empty(), "no flux changes on a face");
        assert!(!grazing[0].segments.is_empty(), "edges graze as a whole");
    }
}
