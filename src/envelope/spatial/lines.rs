//! The points of one span on the lines of the body, and the boundary of its egress region as pieces
//! between them.

use super::points::BodyPoints;
use super::sampling::Sampling;
use crate::body::{Edge, Mesh};
use crate::grazing::spatial::{Break, FaceFlux, GrazingSet};
use crate::motion::Generator;
use crate::numeric::index;
use crate::numeric::tolerance::Budget;
use crate::watch::{Interrupted, Work};
use glam::{DAffine3, DVec3};
use std::collections::BTreeMap;

/// The part of the body that swept a sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Source {
    /// An interval of an edge, index into [`Mesh::edges`].
    Edge(u32),
    /// The grazing segment of a face.
    Face(u32),
}

/// * The winding numbers that a sheet separates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fold {
    /// 0 and 1: a candidate for the boundary.
    Outer,
    /// 1 and 2: inside the swept region.
    Inner,
}

/// A point on a line of the body: an edge, or the grazing segment of a face.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LinePoint {
    /// Position, from 0 at the line's start to 1 at its end.
    pub(crate) t: f64,
    pub(crate) point: u32,
    /// On an edge: whether the flux of its first and of its second face changes sign here.
    pub(crate) breaks: [bool; 2],
}

/// A straight piece of the boundary of the egress region, which lies on its left.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BoundaryPiece {
    pub(crate) ends: [u32; 2],
    pub(crate) source: Source,
    /// Number of points before it on its line.
    pub(crate) place: usize,
    /// Whether the piece runs against its line.
    pub(crate) reversed: bool,
    pub(crate) fold: Fold,
}

/// Everything in one span that is fixed on the body.
#[derive(Debug)]
pub(crate) struct SpanLines {
    /// The points of each line, ascending, including its two ends; edges without any other point
    /// are absent. An edge runs from its smaller vertex to its larger one, and a segment from where
    /// the border of its face leaves the egress part to where it enters it again.
    pub(crate) lines: BTreeMap<Source, Vec<LinePoint>>,
    pub(crate) pieces: Vec<BoundaryPiece>,
    pub(crate) sampling: Sampling,
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

    /// The parameters of the ends of its parts on the line, ascending, none of which twists by more
    /// than `twist` in a step.
    ///
    /// `frame`: pose of the start of the span relative to the start of the motion.
    pub(crate) fn divided(&self, frame: &DAffine3, sampling: &Sampling, twist: f64) -> Vec<f64> {
        let [from, to] = self.ends;
        let place = |share: f64| {
            if share == 1.0 {
                to
            } else {
                from + (to - from) * share
            }
        };
        let at = |share: f64| frame.transform_point3(self.at(place(share)));
        let shares = sampling.divide(at, twist);
        shares.into_iter().map(place).collect()
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

impl SpanLines {
    /// Divides `intervals`, the [`boundary`] of the span, so that no piece twists by more than the
    /// budget in a step.
    pub(crate) fn new(
        mesh: &Mesh,
        grazing: &GrazingSet,
        (frame, intervals): (&DAffine3, &[Interval]),
        sampling: Sampling,
        budget: &Budget,
        points: &mut BodyPoints,
        work: Work,
    ) -> Result<SpanLines, Interrupted> {
        let items = work.items(intervals.len());
        let mut lines = lines(mesh, grazing, points);
        for interval in intervals {
            items.next()?;
            let stops = interval.divided(frame, &sampling, budget.twist);
            // The last stop is already a point of the line, except for the cusp inside a segment.
            let new = if interval.ends[1] < 1.0 && matches!(interval.source, Source::Face(_)) {
                &stops[1..]
            } else {
                &stops[1..stops.len() - 1]
            };
            if !new.is_empty() {
                let line = lines
                    .entry(interval.source)
                    .or_insert_with(|| ends(&interval.line, points));
                line.extend(new.iter().map(|&t| LinePoint {
                    t,
                    point: points.intern(interval.at(t)),
                    breaks: [false; 2],
                }));
                // The sort is stable: break points at a corner stay between it and the rest.
                line.sort_by(|a, b| a.t.total_cmp(&b.t));
            }
        }
        let pieces = intervals
            .iter()
            .flat_map(|interval| pieces(interval, &lines, points))
            .collect();
        Ok(SpanLines {
            lines,
            pieces,
            sampling,
        })
    }
}

fn on_line(line: &[DVec3; 2], t: f64) -> DVec3 {
    if t == 1.0 {
        line[1]
    } else {
        line[0] + (line[1] - line[0]) * t
    }
}

fn edge_line(mesh: &Mesh, edge: u32) -> [DVec3; 2] {
    mesh.edges()[edge as usize]
        .vertices
        .map(|v| mesh.positions()[v as usize])
}

fn segment_line(mesh: &Mesh, leave: &Break, enter: &Break) -> [DVec3; 2] {
    [leave, enter].map(|at| on_line(&edge_line(mesh, at.edge), at.t))
}

fn ends(line: &[DVec3; 2], points: &mut BodyPoints) -> Vec<LinePoint> {
    let mut end = |t: f64| LinePoint {
        t,
        point: points.intern(on_line(line, t)),
        breaks: [false; 2],
    };
    vec![end(0.0), end(1.0)]
}

/// The break of `face` on `edge`, if its flux changes sign there.
fn break_of(flux: &FaceFlux, edge: u32) -> Option<&Break> {
    match flux {
        FaceFlux::Cut { leave, enter, .. } => [leave, enter].into_iter().find(|at| at.edge == edge),
        FaceFlux::Ingress | FaceFlux::Egress => None,
    }
}

/// The positions on `edge` of the breaks of its first and its second face.
fn breaks_on(mesh: &Mesh, grazing: &GrazingSet, edge: u32) -> [Option<f64>; 2] {
    mesh.edges()[edge as usize]
        .faces
        .map(|face| break_of(&grazing.faces[face as usize], edge).map(|at| at.t))
}

/// The lines of the cut faces: their segments, and the edges with their breaks.
fn lines(
    mesh: &Mesh,
    grazing: &GrazingSet,
    points: &mut BodyPoints,
) -> BTreeMap<Source, Vec<LinePoint>> {
    let mut lines = BTreeMap::new();
    for (face, flux) in grazing.faces.iter().enumerate() {
        let FaceFlux::Cut { leave, enter, .. } = flux else {
            continue;
        };
        lines.insert(
            Source::Face(index(face)),
            ends(&segment_line(mesh, leave, enter), points),
        );
        for edge in [leave.edge, enter.edge] {
            lines.entry(Source::Edge(edge)).or_insert_with(|| {
                let line = edge_line(mesh, edge);
                let mut list = ends(&line, points);
                let mut add = |t: f64, breaks| {
                    list.push(LinePoint {
                        t,
                        point: points.intern(on_line(&line, t)),
                        breaks,
                    });
                };
                match breaks_on(mesh, grazing, edge) {
                    [Some(a), Some(b)] if a == b => add(a, [true; 2]),
                    [a, b] => {
                        a.into_iter().for_each(|t| add(t, [true, false]));
                        b.into_iter().for_each(|t| add(t, [false, true]));
                    }
                }
                // The corners stay outermost when a break coincides with them.
                list.sort_by(|a, b| a.t.total_cmp(&b.t).then(rank(a).cmp(&rank(b))));
                list
            });
        }
    }
    lines
}

/// The order of points at the same place of an edge: its start, breaks, its end.
fn rank(at: &LinePoint) -> u8 {
    match (at.breaks, at.t == 0.0) {
        ([false, false], true) => 0,
        ([false, false], false) => 2,
        _ => 1,
    }
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

/// The pieces of an interval between consecutive points of its line.
fn pieces(
    interval: &Interval,
    lines: &BTreeMap<Source, Vec<LinePoint>>,
    points: &mut BodyPoints,
) -> Vec<BoundaryPiece> {
    let whole;
    let line = match lines.get(&interval.source) {
        Some(line) => line,
        None => {
            whole = ends(&interval.line, points);
            &whole
        }
    };
    let mut out: Vec<BoundaryPiece> = line
        .windows(2)
        .enumerate()
        .filter(|(_, pair)| {
            pair[0].t < pair[1].t && interval.ends[0] <= pair[0].t && pair[1].t <= interval.ends[1]
        })
        .map(|(place, pair)| {
            let (start, end) = if interval.reversed {
                (&pair[1], &pair[0])
            } else {
                (&pair[0], &pair[1])
            };
            BoundaryPiece {
                ends: [start.point, end.point],
                source: interval.source,
                place,
                reversed: interval.reversed,
                fold: interval.fold,
            }
        })
        .collect();
    if interval.reversed {
        out.reverse();
    }
    out
}
