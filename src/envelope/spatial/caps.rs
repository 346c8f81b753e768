//! The caps: the parts of the body at the poses where spans start, meet and end.
//!
//! At a joint of two spans, every face that either of them cuts or touches carries the points of
//! both on its sides, and the grazing segments of both, so that what remains of the two egress sets
//! conforms. Two segments of a triangle cross exactly if their ends alternate around it:
//! connectivity is never decided by comparing coordinates.

use super::lines::{LinePoint, SpanLines};
use super::points::BodyPoints;
use crate::body::Mesh;
use crate::grazing::spatial::{FaceFlux, GrazingSet, Source};
use crate::numeric::index;
use crate::watch::{Interrupted, Work};
use glam::DVec3;
use std::collections::BTreeMap;

/// The one or two spans that meet at a pose.
pub(crate) struct Joint<'a> {
    pub(crate) mesh: &'a Mesh,
    /// The indices in [`BodyPoints`] of the vertices of the mesh.
    pub(crate) vertices: &'a [u32],
    /// One span (at the start or end of the motion) or two, in their order.
    pub(crate) spans: Vec<(&'a GrazingSet, &'a SpanLines)>,
}

/// The crossing of the segments of two spans on a face.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    point: u32,
    /// Per span, the number of points on its segment before the crossing, minus one.
    place: [usize; 2],
}

/// The triangles of a cap, and what its neighbours need to conform.
pub(crate) struct Cap {
    /// Triangles of [`BodyPoints`], some of them degenerate.
    pub(crate) triangles: Vec<[u32; 3]>,
    crossings: BTreeMap<u32, Crossing>,
}

/// A point on the border of a cell, with the line that the border follows from there.
#[derive(Debug, Clone, Copy)]
struct BorderCorner {
    point: u32,
    /// The line: 0, 1, 2 for the sides of the face, 3, 4 for the segments of the spans.
    line: usize,
    /// Per span, whether the border after this point is egress; `None` on segments.
    egress: [Option<bool>; 2],
    /// The span whose segment ends here.
    end_of: Option<usize>,
}

/// A convex part of a face, with its side (egress or ingress) in each span.
struct Cell {
    ring: Vec<BorderCorner>,
    egress: [bool; 2],
}

impl Joint<'_> {
    /// The parts of the body for which `count(egress per span)` is +1, as oriented, and -1,
    /// reversed.
    pub(crate) fn cap(
        &self,
        count: impl Fn(&[bool]) -> i8,
        points: &mut BodyPoints,
        work: Work,
    ) -> Result<Cap, Interrupted> {
        let items = work.items(self.mesh.triangles().len());
        let mut cap = Cap {
            triangles: Vec::new(),
            crossings: BTreeMap::new(),
        };
        for face in 0..self.mesh.triangles().len() {
            items.next()?;
            let cells = self.cells(index(face), points, &mut cap.crossings);
            for cell in &cells {
                let sign = count(&cell.egress[..self.spans.len()]);
                if sign != 0 {
                    let from = cap.triangles.len();
                    triangulate(&cell.ring, points, &mut cap.triangles);
                    if sign < 0 {
                        cap.triangles[from..].iter_mut().for_each(|t| t.swap(1, 2));
                    }
                }
            }
        }
        Ok(cap)
    }

    /// The points of all spans between the neighbouring points `place` and `place + 1` of span
    /// `span` on a line, in the line's order.
    pub(crate) fn between(&self, cap: &Cap, span: usize, source: Source, place: usize) -> Vec<u32> {
        match source {
            Source::Edge(edge) => {
                let mut seen = 0;
                let mut out = Vec::new();
                for (owner, at) in self.edge_points(edge) {
                    if owner == span {
                        seen += 1;
                    } else if seen == place {
                        out.push(at.point);
                    }
                }
                out
            }
            Source::Face(face) => {
                let crossing = cap
                    .crossings
                    .get(&face)
                    .filter(|crossing| crossing.place[span] == place);
                crossing
                    .map(|crossing| crossing.point)
                    .into_iter()
                    .collect()
            }
        }
    }

    /// The points of all spans on an edge, without its ends, ascending.
    fn edge_points(&self, edge: u32) -> Vec<(usize, LinePoint)> {
        let mut out = Vec::new();
        for (span, (_, lines)) in self.spans.iter().enumerate() {
            if let Some(line) = lines.lines.get(&Source::Edge(edge)) {
                out.extend(line[1..line.len() - 1].iter().map(|at| (span, *at)));
            }
        }
        // The sort is stable: at the same place the earlier span comes first, for both faces of the
        // edge.
        out.sort_by(|a, b| a.1.t.total_cmp(&b.1.t));
        out
    }

    fn cells(
        &self,
        face: u32,
        points: &mut BodyPoints,
        crossings: &mut BTreeMap<u32, Crossing>,
    ) -> Vec<Cell> {
        let ring = self.ring(face);
        let mut cells = vec![ring];
        let mut segments = [None, None];
        for (span, (grazing, lines)) in self.spans.iter().enumerate() {
            if matches!(grazing.faces[face as usize], FaceFlux::Cut { .. }) {
                let segment: Vec<u32> = lines.lines[&Source::Face(face)]
                    .iter()
                    .map(|at| at.point)
                    .collect();
                segments[span] = Some(segment);
            }
        }
        for span in 0..self.spans.len() {
            let Some(segment) = &segments[span] else {
                continue;
            };
            let with_ends =
                |ring: &Vec<BorderCorner>| ring.iter().filter(|c| c.end_of == Some(span)).count();
            if let Some(whole) = cells.iter().position(|ring| with_ends(ring) == 2) {
                let ring = cells.remove(whole);
                cells.extend(divide(ring, span, &segment[1..segment.len() - 1]));
            } else {
                // The ends are in different cells: the segment crosses that of the first span.
                let first = segments[0]
                    .as_ref()
                    .expect("only a second segment finds its ends apart");
                let (at, place) = cross(first, segment, points);
                let point = points.intern(at);
                crossings.insert(face, Crossing { point, place });
                let halves = std::mem::take(&mut cells);
                for mut ring in halves {
                    insert_on_segment(&mut ring, first, place[0], point, span);
                    // The half in which the border leaves the egress part contains the start of the
                    // segment.
                    let is_start = leaves_egress(&ring, span);
                    let inner = if is_start {
                        &segment[1..=place[1]]
                    } else {
                        &segment[place[1] + 1..segment.len() - 1]
                    };
                    cells.extend(divide_half(ring, span, inner, is_start));
                }
            }
        }
        cells
            .into_iter()
            .map(|ring| {
                let egress = [0, 1].map(|span| {
                    ring.iter()
                        .find_map(|corner| corner.egress[span])
                        .unwrap_or(false)
                });
                Cell { ring, egress }
            })
            .collect()
    }

    /// The border of a face with the points of all spans on it.
    fn ring(&self, face: u32) -> Vec<BorderCorner> {
        let triangle = self.mesh.triangles()[face as usize];
        let mut egress = [None, None];
        for (span, (grazing, _)) in self.spans.iter().enumerate() {
            egress[span] = Some(grazing.faces[face as usize].is_egress_at(0));
        }
        let mut ring = Vec::new();
        for (side, &vertex) in triangle.iter().enumerate() {
            ring.push(BorderCorner {
                point: self.vertices[vertex as usize],
                line: side,
                egress,
                end_of: None,
            });
            let edge = self.mesh.face_edges()[face as usize][side];
            let which = usize::from(self.mesh.edges()[edge as usize].faces[0] != face);
            let mut on_side = self.edge_points(edge);
            if which == 1 {
                on_side.reverse();
            }
            for (span, at) in on_side {
                let end_of = at.breaks[which].then_some(span);
                if end_of.is_some() {
                    egress[span] = egress[span].map(|egress| !egress);
                }
                ring.push(BorderCorner {
                    point: at.point,
                    line: side,
                    egress,
                    end_of,
                });
            }
        }
        ring
    }
}

/// Whether the end of the span's segment on this ring is the one at which the border leaves the
/// egress part.
fn leaves_egress(ring: &[BorderCorner], span: usize) -> bool {
    ring.iter()
        .any(|corner| corner.end_of == Some(span) && corner.egress[span] == Some(false))
}

/// Rotates the ring so that it starts at the corner for which `is_first` holds.
fn start_at(ring: &mut [BorderCorner], is_first: impl Fn(&BorderCorner) -> bool) {
    let first = ring
        .iter()
        .position(is_first)
        .expect("the corner is on the ring");
    ring.rotate_left(first);
}

fn on_segment(point: u32, span: usize) -> BorderCorner {
    BorderCorner {
        point,
        line: 3 + span,
        egress: [None, None],
        end_of: None,
    }
}

/// Divides a ring that contains both ends of a span's segment, starting where the border leaves the
/// egress part; `inner` are the segment's points between the ends.
fn divide(mut ring: Vec<BorderCorner>, span: usize, inner: &[u32]) -> [Vec<BorderCorner>; 2] {
    start_at(&mut ring, |c| {
        c.end_of == Some(span) && c.egress[span] == Some(false)
    });
    let enter = ring
        .iter()
        .rposition(|c| c.end_of == Some(span))
        .expect("the segment has two ends");
    let mut ingress = ring[..=enter].to_vec();
    let mut egress = ring[enter..].to_vec();
    egress.push(ring[0]);
    turn_to_segment(&mut ingress, span);
    turn_to_segment(&mut egress, span);
    ingress.extend(inner.iter().rev().map(|&p| on_segment(p, span)));
    egress.extend(inner.iter().map(|&p| on_segment(p, span)));
    [ingress, egress]
}

/// Divides a ring that contains one end of the second span's segment and the crossing, which is
/// marked as an end too; `inner` are the points between them in the segment's order.
fn divide_half(
    mut ring: Vec<BorderCorner>,
    span: usize,
    inner: &[u32],
    is_start: bool,
) -> [Vec<BorderCorner>; 2] {
    start_at(&mut ring, |c| c.end_of == Some(span) && c.line < 3);
    let crossing = ring
        .iter()
        .rposition(|c| c.end_of == Some(span))
        .expect("the crossing is on the ring");
    let mut after_end = ring[..=crossing].to_vec();
    let mut after_crossing = ring[crossing..].to_vec();
    after_crossing.push(ring[0]);
    turn_to_segment(&mut after_end, span);
    turn_to_segment(&mut after_crossing, span);
    // The first half closes from the crossing to the end, the second from the end to the crossing.
    let forward: Vec<BorderCorner> = inner.iter().map(|&p| on_segment(p, span)).collect();
    let backward: Vec<BorderCorner> = forward.iter().rev().copied().collect();
    let (to_end, to_crossing) = if is_start {
        (backward, forward)
    } else {
        (forward, backward)
    };
    after_end.extend(to_end);
    after_crossing.extend(to_crossing);
    [after_end, after_crossing]
}

/// From its last corner, the ring continues along the span's segment.
fn turn_to_segment(ring: &mut [BorderCorner], span: usize) {
    let last = ring.last_mut().expect("a ring has corners");
    *last = on_segment(last.point, span);
}

/// Inserts the crossing into the ring's part of the first span's segment.
fn insert_on_segment(
    ring: &mut Vec<BorderCorner>,
    first: &[u32],
    place: usize,
    point: u32,
    span: usize,
) {
    let [before, after] = [first[place], first[place + 1]];
    let next = |i: usize| ring[(i + 1) % ring.len()].point;
    let at = (0..ring.len())
        .find(|&i| {
            ring[i].line == 3
                && ((ring[i].point == before && next(i) == after)
                    || (ring[i].point == after && next(i) == before))
        })
        .expect("both halves run along the first segment");
    ring.insert(
        at + 1,
        BorderCorner {
            end_of: Some(span),
            ..on_segment(point, 0)
        },
    );
}

/// The point where two segments of a triangle cross, and the pieces of them that contain it. Since
/// the ends alternate, the segments do cross, up to rounding, which the clamps absorb.
fn cross(first: &[u32], second: &[u32], points: &BodyPoints) -> (DVec3, [usize; 2]) {
    let [a, b] = [first[0], first[first.len() - 1]].map(|p| points.at(p));
    let [c, d] = [second[0], second[second.len() - 1]].map(|p| points.at(p));
    let normal = (b - a).cross(d - c);
    let square = normal.length_squared();
    let share = |along: DVec3| {
        let t = (c - a).cross(along).dot(normal) / square;
        if t.is_finite() {
            t.clamp(0.0, 1.0)
        } else {
            0.5
        }
    };
    let (s, t) = (share(d - c), share(b - a));
    let place = |list: &[u32], start: DVec3, way: DVec3, share: f64| {
        let is_before = |p: u32| (points.at(p) - start).dot(way) < share * way.length_squared();
        list[1..list.len() - 1]
            .iter()
            .filter(|&&p| is_before(p))
            .count()
    };
    (
        a + (b - a) * s,
        [place(first, a, b - a, s), place(second, c, d - c, t)],
    )
}

/// Triangulates a convex ring whose corners lie on at least three lines, in one run of corners on
/// each.
///
/// The line with the most corners is zipped to the rest of the ring, so that no triangle has all
/// its corners on one line. A break at a corner of the face makes a line of no length, which comes
/// first: otherwise its far end would be zipped to the line on which it lies.
fn triangulate(ring: &[BorderCorner], points: &BodyPoints, out: &mut Vec<[u32; 3]>) {
    let next = |i: usize| ring[(i + 1) % ring.len()].point;
    let ring: Vec<BorderCorner> = (0..ring.len())
        .filter(|&i| ring[i].point != next(i))
        .map(|i| ring[i])
        .collect();
    let n = ring.len();
    if n < 3 {
        return;
    }
    let starts: Vec<usize> = (0..n)
        .filter(|&i| ring[i].line != ring[(i + n - 1) % n].line)
        .collect();
    let run = |k: usize| (starts[(k + 1) % starts.len()] + n - starts[k] - 1) % n + 1;
    let longest = (0..starts.len())
        .rev()
        .max_by_key(|&k| run(k))
        .expect("a ring follows lines");
    let (first, length) = (starts[longest], run(longest));
    let at = |i: usize| ring[(first + i) % n].point;
    if length == 1 {
        out.extend((1..n - 1).map(|i| [at(0), at(i), at(i + 1)]));
        return;
    }
    let distance = |i: usize, j: usize| points.at(at(i)).distance_squared(points.at(at(j)));
    // The line has the corners 0..=length; the rest of the ring, from its end to its start, has
    // length..=n.
    let (mut near, mut far) = (1, n - 1);
    out.push([at(0), at(near), at(far)]);
    while near < length - 1 || far > length + 1 {
        let near_is_due = far == length + 1 || distance(near + 1, far) <= distance(near, far - 1);
        if near < length - 1 && near_is_due {
            out.push([at(near), at(near + 1), at(far)]);
            near += 1;
        } else {
            out.push([at(near), at(far - 1), at(far)]);
            far -= 1;
        }
    }
    out.push([at(near), at(length), at(far)]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_without_length_leaves_no_needles() {
        let mut points = BodyPoints::default();
        let mut corner = |x: f64, y: f64, line: usize| BorderCorner {
            line,
            ..on_segment(points.intern(DVec3::new(x, y, 0.0)), 0)
        };
        // A side in quarters, the end of a segment at the end of the side, and the apex, nearer to
        // that end than to the side's start.
        let mut ring: Vec<BorderCorner> =
            (0..4).map(|i| corner(f64::from(i) / 4.0, 0.0, 0)).collect();
        ring.extend([
            corner(1.0, 0.0, 1),
            corner(1.0, 0.0, 3),
            corner(1.1, 0.9, 2),
        ]);
        let mut triangles = Vec::new();
        triangulate(&ring, &points, &mut triangles);
        assert_eq!(triangles.len(), 4, "one on each quarter");
        for triangle in triangles {
            let [a, b, c] = triangle.map(|p| points.at(p));
            let area = (b - a).cross(c - a).z;
            assert!(area > 0.1, "{a} {b} {c} has an area of {area}");
        }
    }
}
