//! Cuts the overlapping triangles of one plane, or a single triangle, along everything that meets
//! them.

use super::Cancelled;
use super::join::{CELL, Fingerprint, around, fingerprint};
use super::network::{Network, order_along};
use super::point::{
    Definition, Homogeneous, Point, approximate_orientation, are_equal, exact_orientation,
    homogeneous, may_be_equal,
};
use super::surface::GridSurface;
use super::triangulation::Triangulation;
use crate::Fault;
use crate::numeric::SpatialHash;
use crate::numeric::exact::signs::Sign;
use crate::numeric::exact::spatial_grid::{self, Axis};
use crate::numeric::index;
use glam::DVec2;
use std::cell::OnceCell;
use std::cmp::Ordering;
use std::collections::{BTreeMap, HashMap};

/// A cut plane.
#[derive(Debug, Default)]
pub(super) struct Cut {
    /// Points that occur only in this plane.
    pub(super) points: Vec<Point>,
    /// Corners and multiplicities; the triangles are oriented like the first one of the set.
    /// Corners from the number of points of the network on are in `points`.
    pub(super) triangles: Vec<([u32; 3], i32)>,
}

/// A straight line in the plane.
struct Line {
    kind: LineKind,
    ends: [u32; 2],
    /// All points on it known so far, unordered.
    points: Vec<u32>,
    /// The multiplicity on the left, from the first end to the second, minus that on the right.
    weight: i32,
    /// The number of triangles that cover the left, whatever their sense, minus that for the right.
    cover: i32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum LineKind {
    Edge(u32),
    /// The common line with the plane of another triangle.
    With(u32),
}

impl LineKind {
    /// A number for the line: sides with equal numbers are on the same line.
    fn carrier(self) -> u32 {
        match self {
            LineKind::Edge(edge) => edge << 1,
            LineKind::With(triangle) => triangle << 1 | 1,
        }
    }
}

struct Plane<'a> {
    surface: &'a GridSurface,
    first: u32,
    axis: Axis,
    points: Vec<Point>,
    /// The numbers of points in the network; those of new points follow.
    numbers: Vec<u32>,
    local: HashMap<u32, u32>,
    /// Per point, the lines on which it is known to lie.
    carriers: Vec<Vec<u32>>,
    /// The exact coordinates of the points for which they were needed.
    exact: Vec<OnceCell<Box<Homogeneous>>>,
    lines: Vec<Line>,
    new_points: u32,
    known: u32,
}

/// Cuts the triangles `members`, all of one plane, in ascending order: a single one, or a set that
/// overlaps.
pub(super) fn cut(
    surface: &GridSurface,
    network: &Network,
    members: &[u32],
    cancelled: Cancelled,
) -> Result<Cut, Fault> {
    let first = members[0];
    let mut plane = Plane {
        surface,
        first,
        axis: surface.axis[first as usize],
        points: Vec::new(),
        numbers: Vec::new(),
        local: HashMap::new(),
        carriers: Vec::new(),
        exact: Vec::new(),
        lines: Vec::new(),
        new_points: 0,
        known: index(network.points.len()),
    };
    let outline = plane.outline(members, network);
    plane.add_lines(members, network);
    let loose: Vec<u32> = members
        .iter()
        .flat_map(|&t| network.touches_of(t))
        .map(|point| plane.point(network, point))
        .collect();
    plane.cross_lines(members.len() > 1, &loose);
    plane.triangulate(outline, members.len() > 1, cancelled)
}

impl Plane<'_> {
    /// The local number of a point of the network.
    fn point(&mut self, network: &Network, number: u32) -> u32 {
        if let Some(&local) = self.local.get(&number) {
            return local;
        }
        let local = self.push(network.points[number as usize], number);
        self.local.insert(number, local);
        local
    }

    fn push(&mut self, point: Point, number: u32) -> u32 {
        self.points.push(point);
        self.numbers.push(number);
        self.carriers.push(Vec::new());
        self.exact.push(OnceCell::new());
        index(self.points.len() - 1)
    }

    /// The triangle in which the triangulation starts: the only member, or a frame around all.
    fn outline(&mut self, members: &[u32], network: &Network) -> [u32; 3] {
        if members.len() > 1 {
            let axis = u8::try_from(self.axis.number).unwrap_or_default();
            return [0, 1, 2].map(|corner| {
                let definition = Definition::Frame { corner, axis };
                self.push(Point::new(self.surface, definition), u32::MAX)
            });
        }
        let mut ring = self.surface.triangles[self.first as usize];
        if !self.axis.is_forward {
            ring.swap(1, 2);
        }
        ring.map(|v| self.point(network, v))
    }

    fn put_on(&mut self, line: usize, point: u32) {
        let carrier = self.lines[line].kind.carrier();
        self.lines[line].points.push(point);
        if !self.carriers[point as usize].contains(&carrier) {
            self.carriers[point as usize].push(carrier);
        }
    }

    fn add_lines(&mut self, members: &[u32], network: &Network) {
        let mut line_of = HashMap::<u32, usize>::new();
        for &member in members {
            let ring = self.surface.triangles[member as usize];
            let edges = self.surface.triangle_edges[member as usize];
            for (start, edge) in ring.into_iter().zip(edges) {
                let ends = self.surface.edges[edge as usize];
                let sign = if start == ends[0] { 1 } else { -1 };
                let line = *line_of.entry(edge).or_insert_with(|| {
                    let ends = ends.map(|v| self.point(network, v));
                    self.lines.push(Line {
                        kind: LineKind::Edge(edge),
                        ends,
                        points: Vec::new(),
                        weight: 0,
                        cover: 0,
                    });
                    let line = self.lines.len() - 1;
                    ends.iter().for_each(|&p| self.put_on(line, p));
                    for &number in network.on_edge(edge) {
                        let point = self.point(network, number);
                        self.put_on(line, point);
                    }
                    line
                });
                let line = &mut self.lines[line];
                line.weight += sign * self.surface.multiplicity[member as usize];
                let is_forward = self.surface.axis[member as usize].is_forward;
                line.cover += if is_forward { sign } else { -sign };
            }
        }
        self.add_segments(members, network);
    }

    /// Adds the segments along which other triangles cut the members.
    ///
    /// Overlapping members are cut along the same piece of a line by one triangle. The piece is
    /// added once, with the ends of all segments on it. Added once per member, the pieces would
    /// cross each other, and the number of crossings would grow with the fourth power of the number
    /// of overlapping members.
    fn add_segments(&mut self, members: &[u32], network: &Network) {
        let mut by_other = BTreeMap::<u32, Vec<[u32; 2]>>::new();
        for &member in members {
            for segment in network.segments_of(member) {
                let ends = segment.ends.map(|number| self.point(network, number));
                by_other.entry(segment.other).or_default().push(ends);
            }
        }
        for (other, mut segments) in by_other {
            let line = segments[0].map(|p| self.points[p as usize]);
            let order = |plane: &Self, a: u32, b: u32| {
                let [a, b] = [a, b].map(|p| &plane.points[p as usize]);
                order_along(plane.surface, [&line[0], &line[1]], a, b)
            };
            for ends in &mut segments {
                if order(self, ends[0], ends[1]) == Ordering::Greater {
                    ends.reverse();
                }
            }
            segments.sort_by(|a, b| order(self, a[0], b[0]));
            let mut segments = segments.into_iter().peekable();
            while let Some([start, mut end]) = segments.next() {
                let mut points = vec![start, end];
                while let Some([from, to]) =
                    segments.next_if(|next| order(self, next[0], end) != Ordering::Greater)
                {
                    points.extend([from, to]);
                    if order(self, to, end) == Ordering::Greater {
                        end = to;
                    }
                }
                self.lines.push(Line {
                    kind: LineKind::With(other),
                    ends: [start, end],
                    points: Vec::new(),
                    weight: 0,
                    cover: 0,
                });
                let line = self.lines.len() - 1;
                points.into_iter().for_each(|p| self.put_on(line, p));
            }
        }
    }

    fn orientation(&self, a: u32, b: u32, c: u32) -> Sign {
        if a == b || b == c || c == a {
            return Sign::Zero;
        }
        let points = [a, b, c].map(|p| &self.points[p as usize]);
        if let Some(sign) = approximate_orientation(self.axis.number, points) {
            return sign;
        }
        let [of_a, of_b, of_c] = [a, b, c].map(|p| &self.carriers[p as usize]);
        if of_a
            .iter()
            .any(|line| of_b.contains(line) && of_c.contains(line))
        {
            return Sign::Zero;
        }
        if points.iter().all(|p| p.error == 0.0) {
            return spatial_grid::orientation(self.axis.number, points.map(|p| p.approximate));
        }
        let exact = [a, b, c].map(|p| {
            self.exact[p as usize]
                .get_or_init(|| {
                    Box::new(homogeneous(
                        self.surface,
                        &self.points[p as usize].definition,
                    ))
                })
                .as_ref()
        });
        exact_orientation(self.axis.number, exact)
    }

    /// Finds all points that lie on two lines, and adds loose points to the lines on which they
    /// lie.
    fn cross_lines(&mut self, is_set: bool, loose: &[u32]) {
        let boxes: Vec<[DVec2; 2]> = self
            .lines
            .iter()
            .map(|line| {
                let [(p, p_error), (q, q_error)] = line.ends.map(|p| self.place_and_error(p));
                let error = 2.0 * f64::max(p_error, q_error);
                [p.min(q) - error, p.max(q) + error]
            })
            .collect();
        let mut sorted: Vec<usize> = (0..self.lines.len())
            // The edges of a single triangle are cut where the network says, and nowhere else.
            .filter(|&line| is_set || matches!(self.lines[line].kind, LineKind::With(_)))
            .collect();
        // Along the longer side of all lines: a row of lines across it meets few at a time.
        let [low, high] = boxes
            .iter()
            .copied()
            .reduce(|[low, high], [min, max]| [low.min(min), high.max(max)])
            .unwrap_or_default();
        let along = usize::from((high - low).y > (high - low).x);
        let across = 1 - along;
        let start = |line: usize| boxes[line][0][along];
        sorted.sort_by(|&i, &j| start(i).total_cmp(&start(j)).then(i.cmp(&j)));
        let mut crossings = Vec::new();
        let mut incidences = Vec::new();
        for (place, &i) in sorted.iter().enumerate() {
            for &j in &sorted[place + 1..] {
                if start(j) > boxes[i][1][along] {
                    break;
                }
                if boxes[j][0][across] <= boxes[i][1][across]
                    && boxes[i][0][across] <= boxes[j][1][across]
                {
                    self.compare(i.min(j), i.max(j), &mut crossings, &mut incidences);
                }
            }
            for &point in loose {
                let (place, error) = self.place_and_error(point);
                let is_near = (place + error).cmpge(boxes[i][0]).all()
                    && (place - error).cmple(boxes[i][1]).all();
                let [a, b] = self.lines[i].ends;
                if is_near
                    && !self.lines[i].ends.contains(&point)
                    && self.orientation(a, b, point) == Sign::Zero
                    && self.is_between(i, point)
                {
                    incidences.push((i, point));
                }
            }
        }
        for (line, point) in incidences {
            self.put_on(line, point);
        }
        self.add_crossings(crossings);
    }

    fn place_and_error(&self, point: u32) -> (DVec2, f64) {
        let point = &self.points[point as usize];
        let [u, v] = Axis::others(self.axis.number);
        (
            DVec2::new(point.approximate[u], point.approximate[v]),
            point.error,
        )
    }

    /// Whether a point of the line of a segment lies inside the segment.
    fn is_between(&self, line: usize, point: u32) -> bool {
        let [a, b] = self.lines[line].ends.map(|p| &self.points[p as usize]);
        let point = &self.points[point as usize];
        order_along(self.surface, [a, b], a, point) == Ordering::Less
            && order_along(self.surface, [a, b], point, b) == Ordering::Less
    }

    /// What two lines have in common: a crossing, or an end of one inside the other.
    fn compare(
        &self,
        i: usize,
        j: usize,
        crossings: &mut Vec<[usize; 2]>,
        incidences: &mut Vec<(usize, u32)>,
    ) {
        let (one, two) = (&self.lines[i], &self.lines[j]);
        if matches!((one.kind, two.kind), (LineKind::Edge(_), LineKind::Edge(_))) {
            // These are known from the pairs of triangles.
            return;
        }
        let ([a, b], [c, d]) = (one.ends, two.ends);
        let of_one = [c, d].map(|p| self.orientation(a, b, p));
        if of_one[0] == of_one[1] && of_one[0] != Sign::Zero {
            return;
        }
        let of_two = [a, b].map(|p| self.orientation(c, d, p));
        if of_two[0] == of_two[1] && of_two[0] != Sign::Zero {
            return;
        }
        if !of_one.contains(&Sign::Zero) && !of_two.contains(&Sign::Zero) {
            crossings.push([i, j]);
            return;
        }
        for (line, ends, signs) in [(i, [c, d], of_one), (j, [a, b], of_two)] {
            for (point, sign) in ends.into_iter().zip(signs) {
                if sign == Sign::Zero
                    && !self.lines[line].ends.contains(&point)
                    && self.is_between(line, point)
                {
                    incidences.push((line, point));
                }
            }
        }
    }

    /// Adds the points in which lines cross, unless they are known already.
    fn add_crossings(&mut self, crossings: Vec<[usize; 2]>) {
        if crossings.is_empty() {
            return;
        }
        let mut known = Nearby::new();
        (0..index(self.points.len())).for_each(|p| known.add(&self.points, p));
        for [i, j] in crossings {
            let definition = match (self.lines[i].kind, self.lines[j].kind) {
                (LineKind::Edge(edge), LineKind::With(triangle))
                | (LineKind::With(triangle), LineKind::Edge(edge)) => {
                    Definition::Pierce { edge, triangle }
                }
                (LineKind::With(s), LineKind::With(t)) => {
                    let mut planes = [self.first, s, t];
                    planes.sort_unstable();
                    Definition::Meet(planes)
                }
                (LineKind::Edge(_), LineKind::Edge(_)) => continue,
            };
            let point = Point::new(self.surface, definition);
            let number = known
                .find(self.surface, &self.points, &point)
                .unwrap_or_else(|| {
                    let fresh = self.push(point, self.known + self.new_points);
                    self.new_points += 1;
                    known.add(&self.points, fresh);
                    fresh
                });
            self.put_on(i, number);
            self.put_on(j, number);
        }
    }

    fn triangulate(
        mut self,
        outline: [u32; 3],
        is_set: bool,
        cancelled: Cancelled,
    ) -> Result<Cut, Fault> {
        let mut lines = std::mem::take(&mut self.lines);
        let mut is_used = vec![false; self.points.len()];
        for line in &mut lines {
            let ends = line.ends.map(|p| &self.points[p as usize]);
            line.points.sort_by(|&a, &b| {
                if a == b {
                    return Ordering::Equal;
                }
                let [a, b] = [a, b].map(|p| &self.points[p as usize]);
                order_along(self.surface, ends, a, b)
            });
            line.points.dedup();
            line.points.iter().for_each(|&p| is_used[p as usize] = true);
        }
        outline.iter().for_each(|&p| is_used[p as usize] = false);
        let places: Vec<DVec2> = (0..index(self.points.len()))
            .map(|p| self.place_and_error(p).0)
            .collect();
        let mut order: Vec<u32> = (0..index(self.points.len()))
            .filter(|&p| is_used[p as usize])
            .collect();
        order.sort_by(|&a, &b| {
            let [p, q] = [a, b].map(|p| places[p as usize]);
            p.x.total_cmp(&q.x)
                .then(p.y.total_cmp(&q.y))
                .then(a.cmp(&b))
        });
        let mut mesh = Triangulation::new(&places, outline, |a, b, c| self.orientation(a, b, c));
        order.iter().try_for_each(|&p| mesh.insert(p))?;
        let mut weights = HashMap::<[u32; 2], i32>::new();
        let mut covers = HashMap::<[u32; 2], i32>::new();
        for line in &lines {
            for pair in line.points.windows(2) {
                mesh.demand(pair[0], pair[1])?;
                let (a, b) = (pair[0], pair[1]);
                let gains = [(&mut weights, line.weight), (&mut covers, line.cover)];
                for (gained, gain) in gains {
                    if is_set && gain != 0 {
                        *gained.entry([a.min(b), a.max(b)]).or_default() +=
                            if a < b { gain } else { -gain };
                    }
                }
            }
        }
        let multiplicities = if is_set {
            winding(&mesh.triangles, &mesh.across, &weights)
        } else {
            let sign = if self.axis.is_forward { 1 } else { -1 };
            vec![sign * self.surface.multiplicity[self.first as usize]; mesh.triangles.len()]
        };
        let covered = if is_set && cancelled == Cancelled::Kept {
            winding(&mesh.triangles, &mesh.across, &covers)
        } else {
            multiplicities.clone()
        };
        let is_single = !is_set && cancelled == Cancelled::Kept;
        let triangles = mesh
            .triangles
            .iter()
            .zip(multiplicities)
            .zip(covered)
            .filter(|((_, m), covered)| *m != 0 || *covered != 0 || is_single)
            .map(|(triangle, _)| triangle)
            .map(|(triangle, m)| {
                let [a, b, c] = triangle.map(|p| self.numbers[p as usize]);
                if self.axis.is_forward {
                    ([a, b, c], m)
                } else {
                    ([a, c, b], -m)
                }
            })
            .collect();
        let first_new = self.points.len() - self.new_points as usize;
        Ok(Cut {
            points: self.points.split_off(first_new),
            triangles,
        })
    }
}

/// How often the triangles of a plane are covered, propagated across weighted edges from the first
/// one, which is not.
fn winding(
    triangles: &[[u32; 3]],
    across: &[[u32; 3]],
    weights: &HashMap<[u32; 2], i32>,
) -> Vec<i32> {
    let mut multiplicity = vec![None; triangles.len()];
    // Some triangle has an edge of the frame, with nothing beyond it.
    let Some(start) = across.iter().position(|a| a.contains(&u32::MAX)) else {
        return Vec::new();
    };
    multiplicity[start] = Some(0);
    let mut open = vec![start];
    while let Some(t) = open.pop() {
        for k in 0..3 {
            let other = across[t][k] as usize;
            if across[t][k] == u32::MAX || multiplicity[other].is_some() {
                continue;
            }
            let (a, b) = (triangles[t][(k + 1) % 3], triangles[t][(k + 2) % 3]);
            let weight = weights.get(&[a.min(b), a.max(b)]).copied().unwrap_or(0);
            // This triangle is on the left of the edge.
            let gain = if a < b { weight } else { -weight };
            multiplicity[other] = multiplicity[t].map(|m: i32| m - gain);
            open.push(other);
        }
    }
    multiplicity.into_iter().map(|m| m.unwrap_or(0)).collect()
}

/// Points hashed by place, to find those equal to another.
struct Nearby {
    hash: SpatialHash,
    /// The fingerprints of the points for which they were needed.
    prints: HashMap<u32, Fingerprint>,
}

impl Nearby {
    fn new() -> Nearby {
        Nearby {
            hash: SpatialHash::new(CELL),
            prints: HashMap::new(),
        }
    }

    fn add(&mut self, points: &[Point], number: u32) {
        self.hash.insert(around(&points[number as usize]), number);
    }

    fn find(&mut self, surface: &GridSurface, points: &[Point], point: &Point) -> Option<u32> {
        let mut own = None;
        let is_equal = |&number: &u32| {
            let known = &points[number as usize];
            known.definition == point.definition
                || may_be_equal(known, point)
                    && *own.get_or_insert_with(|| fingerprint(surface, point))
                        == *self
                            .prints
                            .entry(number)
                            .or_insert_with(|| fingerprint(surface, known))
                    && are_equal(surface, known, point)
        };
        self.hash.near(around(point)).find(is_equal)
    }
}
