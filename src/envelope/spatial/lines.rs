//! The points of one span on the lines of the body, and the boundary of its egress region as pieces
//! between them.

use super::points::BodyPoints;
use super::sampling::Sampling;
use crate::body::Mesh;
use crate::grazing::spatial::{
    FaceFlux, Fold, GrazingSet, Interval, Source, breaks_on, edge_line, on_line, segment_line,
};
use crate::numeric::index;
use crate::numeric::tolerance::Budget;
use crate::watch::{Interrupted, Work};
use glam::{DAffine3, DVec3};
use std::collections::BTreeMap;

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

impl SpanLines {
    /// Divides `intervals`, the boundary of the egress region, so that no piece twists by more than the
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
            let stops = sampling.divide_interval(interval, frame, budget.twist);
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

fn ends(line: &[DVec3; 2], points: &mut BodyPoints) -> Vec<LinePoint> {
    let mut end = |t: f64| LinePoint {
        t,
        point: points.intern(on_line(line, t)),
        breaks: [false; 2],
    };
    vec![end(0.0), end(1.0)]
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
