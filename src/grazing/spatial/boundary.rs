//! The boundary of the egress region of a mesh as intervals of lines that are fixed on it.

use super::{Break, FaceFlux, GrazingSet};
use crate::body::{Edge, Mesh};
use crate::motion::Generator;
use crate::numeric::index;
use glam::{DAffine3, DVec3};

/// The part of a body that grazes, and so sweeps a sheet of the envelope.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Source {
    /// An interval of an edge, index into [`Mesh::edges`].
    Edge(u32),
    /// The grazing segment of a face.
    Face(u32),
}

/// The winding numbers of the sweep cycle that a sheet of the envelope separates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fold {
    /// 0 and 1: a candidate for the boundary.
    Outer,
    /// 1 and 2: inside the swept region.
    Inner,
}

/// A part of a line that bounds the egress region.
pub(crate) struct Interval {
    pub(crate) source: Source,
    /// Positions of the line's start and end, in the body frame.
    pub(crate) line: [DVec3; 2],
    /// Its ends on the line, ascending in [0, 1].
    pub(crate) ends: [f64; 2],
    /// Whether the egress region is on the right of the line.
    pub(crate) reversed: bool,
    pub(crate) fold: Fold,
}

impl Interval {
    pub(crate) fn at(&self, t: f64) -> DVec3 {
        on_line(&self.line, t)
    }
}

/// The boundary of the egress region of one span, as intervals of lines, in a fixed order.
///
/// - `frame`: pose of the start of the span relative to the start of the motion.
/// - `generator`: that of the span, in the world.
pub(crate) fn boundary(
    mesh: &Mesh,
    grazing: &GrazingSet,
    frame: &DAffine3,
    generator: &Generator,
) -> Vec<Interval> {
    let mut intervals = edge_intervals(mesh, grazing, frame);
    intervals.extend(segment_intervals(mesh, grazing, frame, generator));
    intervals
}

pub(crate) fn on_line(line: &[DVec3; 2], t: f64) -> DVec3 {
    if t == 1.0 {
        line[1]
    } else {
        line[0] + (line[1] - line[0]) * t
    }
}

pub(crate) fn edge_line(mesh: &Mesh, edge: u32) -> [DVec3; 2] {
    mesh.edges()[edge as usize]
        .vertices
        .map(|v| mesh.positions()[v as usize])
}

pub(crate) fn segment_line(mesh: &Mesh, leave: &Break, enter: &Break) -> [DVec3; 2] {
    [leave, enter].map(|at| on_line(&edge_line(mesh, at.edge), at.t))
}

/// The break of `face` on `edge`, if its flux changes sign there.
fn break_of(flux: &FaceFlux, edge: u32) -> Option<&Break> {
    match flux {
        FaceFlux::Cut { leave, enter, .. } => [leave, enter].into_iter().find(|at| at.edge == edge),
        FaceFlux::Ingress | FaceFlux::Egress => None,
    }
}

/// The positions on `edge` of the breaks of its first and its second face.
pub(crate) fn breaks_on(mesh: &Mesh, grazing: &GrazingSet, edge: u32) -> [Option<f64>; 2] {
    mesh.edges()[edge as usize]
        .faces
        .map(|face| break_of(&grazing.faces[face as usize], edge).map(|at| at.t))
}

/// The parts of edges where exactly one of the two faces is egress.
fn edge_intervals(mesh: &Mesh, grazing: &GrazingSet, frame: &DAffine3) -> Vec<Interval> {
    let mut out = Vec::new();
    for (edge, Edge { vertices, faces }) in mesh.edges().iter().enumerate() {
        let edge = index(edge);
        let starts = faces.map(|face| {
            let corner = mesh.triangles()[face as usize]
                .iter()
                .position(|v| *v == vertices[0]);
            grazing.faces[face as usize]
                .is_egress_at(corner.expect("an edge's vertex is a corner of its faces"))
        });
        let breaks = breaks_on(mesh, grazing, edge);
        if breaks == [None, None] && starts[0] == starts[1] {
            continue;
        }
        let mut stops = vec![0.0, 1.0];
        stops.extend(breaks.iter().flatten());
        stops.sort_by(f64::total_cmp);
        let line = edge_line(mesh, edge);
        let [first, second] = faces.map(|face| grazing.normals[face as usize]);
        let convex = first
            .cross(second)
            .dot(frame.transform_vector3(line[1] - line[0]))
            > 0.0;
        let fold = if convex { Fold::Outer } else { Fold::Inner };
        for stop in stops.windows(2) {
            let is_egress =
                [0, 1].map(|which| starts[which] != breaks[which].is_some_and(|t| t <= stop[0]));
            if stop[0] < stop[1] && is_egress[0] != is_egress[1] {
                let ends = [stop[0], stop[1]];
                out.push(Interval {
                    source: Source::Edge(edge),
                    line,
                    ends,
                    reversed: is_egress[1],
                    fold,
                });
            }
        }
    }
    out
}

/// The grazing segments of the cut faces, divided at the cusp of the sheet, where n . M v changes
/// sign.
fn segment_intervals(
    mesh: &Mesh,
    grazing: &GrazingSet,
    frame: &DAffine3,
    generator: &Generator,
) -> Vec<Interval> {
    let mut out = Vec::new();
    for (face, flux) in grazing.faces.iter().enumerate() {
        let FaceFlux::Cut { leave, enter, .. } = flux else {
            continue;
        };
        let line = segment_line(mesh, leave, enter);
        let turning = line
            .map(|p| grazing.normals[face].dot(generator.acceleration(frame.transform_point3(p))));
        let cusp = (turning[0] > 0.0) != (turning[1] > 0.0);
        let stops = if cusp {
            vec![0.0, turning[0] / (turning[0] - turning[1]), 1.0]
        } else {
            vec![0.0, 1.0]
        };
        for (ends, turning) in stops.windows(2).zip(turning) {
            if ends[0] < ends[1] {
                let fold = if turning > 0.0 {
                    Fold::Outer
                } else {
                    Fold::Inner
                };
                let source = Source::Face(index(face));
                out.push(Interval {
                    source,
                    line,
                    ends: [ends[0], ends[1]],
                    reversed: false,
                    fold,
                });
            }
        }
    }
    out
}
