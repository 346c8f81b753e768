//! The points, edges, segments and planes of the whole arrangement, before any triangle is cut.

use super::join::first_equal;
use super::pairs::Fact;
use super::point::{Definition, Point, order};
use super::surface::GridSurface;
use crate::numeric::exact::signs::Sign;
use crate::numeric::{DisjointSets, index};
use crate::watch::{Interrupted, Work};
use rayon::prelude::*;
use std::cmp::Ordering;

/// A segment along which a triangle is cut by another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Segment {
    pub(super) triangle: u32,
    pub(super) other: u32,
    pub(super) ends: [u32; 2],
}

/// Everything that cuts the triangles.
pub(super) struct Network {
    /// The points, starting with the corners of the surface.
    pub(super) points: Vec<Point>,
    /// Where the points inside each edge, from its first end to its last, start in `edge_points`,
    /// and the end of the last.
    edge_starts: Vec<u32>,
    edge_points: Vec<u32>,
    /// The segments, sorted by triangle.
    segments: Vec<Segment>,
    /// Sorted pairs of a triangle and a point inside it at which another one touches it.
    touches: Vec<(u32, u32)>,
    /// Per triangle, the first one in the same plane that is connected with it.
    pub(super) plane: Vec<u32>,
    /// Per triangle, the first one of the same set of overlapping triangles in one plane.
    pub(super) cluster: Vec<u32>,
}

impl Network {
    /// - `facts`: in any number of lists.
    pub(super) fn new(
        surface: &GridSurface,
        facts: Vec<Vec<Fact>>,
        work: Work,
    ) -> Result<Network, Interrupted> {
        let [placing, joining] = work.parts([1, 1]);
        let mut definitions: Vec<Definition> = facts
            .par_iter()
            .flatten_iter()
            .flat_map_iter(|fact| match *fact {
                Fact::OnEdge(_, at) | Fact::Touch { at, .. } => [Some(at), None],
                Fact::Segment { ends, .. } => ends.map(Some),
                Fact::Coplanar(_) | Fact::Overlap(_) => [None, None],
            })
            .flatten_iter()
            .filter(|definition| !matches!(definition, Definition::Corner(_)))
            .collect();
        work.sort(&mut definitions)?;
        definitions.dedup();
        let corners = index(surface.corners.len());
        let mut points: Vec<Point> = (0..corners).map(|v| Point::corner(surface, v)).collect();
        let items = placing.items(definitions.len());
        let crossings = definitions.par_iter().map(|&definition| {
            items.next()?;
            Ok(Point::new(surface, definition))
        });
        points.par_extend(crossings.collect::<Result<Vec<Point>, Interrupted>>()?);
        let first = first_equal(surface, &points, joining)?;
        let number = |definition: Definition| match definition {
            Definition::Corner(v) => v,
            _ => {
                let place = definitions.binary_search(&definition).unwrap_or_default();
                first[corners as usize + place]
            }
        };
        let mut network = Network {
            points: Vec::new(),
            edge_starts: Vec::new(),
            edge_points: Vec::new(),
            segments: Vec::new(),
            touches: Vec::new(),
            plane: Vec::new(),
            cluster: Vec::new(),
        };
        let mut planes = DisjointSets::new(surface.triangles.len());
        let mut clusters = planes.clone();
        let mut on_edges = Vec::new();
        for list in facts {
            work.check()?;
            for fact in list {
                match fact {
                    Fact::OnEdge(edge, at) => on_edges.push((edge, number(at))),
                    Fact::Touch { triangle, at } => network.touches.push((triangle, number(at))),
                    Fact::Segment {
                        triangle,
                        other,
                        ends,
                    } => network.segments.push(Segment {
                        triangle,
                        other,
                        ends: ends.map(number),
                    }),
                    Fact::Coplanar([a, b]) => {
                        planes.join(a, b);
                    }
                    Fact::Overlap([a, b]) => {
                        clusters.join(a, b);
                    }
                }
            }
        }
        network.points = points;
        network.segments.retain(|s| s.ends[0] != s.ends[1]);
        work.sort(&mut network.segments)?;
        work.sort(&mut network.touches)?;
        network.touches.dedup();
        network.plane = planes.firsts();
        network.cluster = clusters.firsts();
        network.sort_edges(surface, on_edges, work.uncounted())?;
        Ok(network)
    }

    fn sort_edges(
        &mut self,
        surface: &GridSurface,
        mut on_edges: Vec<(u32, u32)>,
        work: Work,
    ) -> Result<(), Interrupted> {
        on_edges.retain(|(edge, point)| !surface.edges[*edge as usize].contains(point));
        work.sort(&mut on_edges)?;
        on_edges.dedup();
        let points = &self.points;
        on_edges
            .par_chunk_by_mut(|a, b| a.0 == b.0)
            .try_for_each(|run| {
                work.check()?;
                let ends = surface.edges[run[0].0 as usize].map(|v| &points[v as usize]);
                run.sort_by(|a, b| {
                    order_along(surface, ends, &points[a.1 as usize], &points[b.1 as usize])
                });
                Ok(())
            })?;
        let mut starts = vec![0; surface.edges.len() + 1];
        on_edges
            .iter()
            .for_each(|(edge, _)| starts[*edge as usize + 1] += 1);
        (0..surface.edges.len()).for_each(|e| starts[e + 1] += starts[e]);
        self.edge_starts = starts;
        self.edge_points = on_edges.into_iter().map(|(_, point)| point).collect();
        Ok(())
    }

    /// The points inside an edge, from its first end to its last.
    pub(super) fn on_edge(&self, edge: u32) -> &[u32] {
        let [from, to] = [edge, edge + 1].map(|e| self.edge_starts[e as usize] as usize);
        &self.edge_points[from..to]
    }

    /// The segments inside a triangle.
    pub(super) fn segments_of(&self, triangle: u32) -> &[Segment] {
        let from = self.segments.partition_point(|s| s.triangle < triangle);
        let count = self.segments[from..].partition_point(|s| s.triangle == triangle);
        &self.segments[from..from + count]
    }

    /// The points inside a triangle at which it is only touched.
    pub(super) fn touches_of(&self, triangle: u32) -> impl Iterator<Item = u32> {
        let from = self.touches.partition_point(|t| t.0 < triangle);
        self.touches[from..]
            .iter()
            .take_while(move |t| t.0 == triangle)
            .map(|t| t.1)
    }
}

/// The order of two points of a line, from one end to the other.
pub(super) fn order_along(
    surface: &GridSurface,
    ends: [&Point; 2],
    a: &Point,
    b: &Point,
) -> Ordering {
    let way = ends[1].approximate - ends[0].approximate;
    let mut axes = [0, 1, 2];
    axes.sort_by(|&i, &j| way[j].abs().total_cmp(&way[i].abs()));
    for axis in axes {
        let order_here = order(surface, axis, a, b);
        if order_here != Ordering::Equal {
            // Ends and points are on one line: a coordinate in which the points differ has the same
            // sense for the ends.
            return if order(surface, axis, ends[0], ends[1]) == Ordering::Less {
                order_here
            } else {
                order_here.reverse()
            };
        }
    }
    Ordering::Equal
}

/// The sign of the direction of a line along an axis.
pub(super) fn direction(surface: &GridSurface, axis: usize, ends: [&Point; 2]) -> Sign {
    match order(surface, axis, ends[1], ends[0]) {
        Ordering::Less => Sign::Negative,
        Ordering::Equal => Sign::Zero,
        Ordering::Greater => Sign::Positive,
    }
}
