//! Regions of the plane that are bounded by directed curves, which may cross; defined by their
//! winding numbers.
//!
//! Closed curves of straight segments wind around every point of the plane some number of times.
//! [`arrange`] finds the cells of constant winding number, and the region where it is at least 1.
//! The crossings are resolved first, on a grid and by exact decisions (`crossings`). The pieces
//! that then do not cross bound faces, which get their winding numbers by a walk from the outside
//! (`faces`). A triangulation of the faces is made on request (`cells`).

mod cells;
mod crossings;
mod faces;
pub(crate) mod missed;
mod outlines;
mod pockets;
mod proximity;
mod strokes;
mod subtract;
mod union;

pub use outlines::{Loop, Outlines};
pub use pockets::Pocket;
pub use proximity::Proximity;
pub use subtract::subtract;
pub(crate) use union::{Curves, unite};

use crate::Fault;
use crate::numeric::exact::planar_grid::{Grid, Node, cross};
use crate::watch::{Interrupted, Stop, Work};
use cells::Cells;
use faces::{Faces, twin};
use glam::DVec2;
use std::collections::HashSet;
use strokes::{Stroke, Strokes};

/// A straight piece of a directed curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Segment {
    /// Indices of the points at which it starts and ends.
    pub ends: [u32; 2],
    /// The winding number on its left minus that on its right: the number of curves that run along
    /// it, where those against it count negative.
    pub weight: i32,
}

/// Why curves have no arrangement.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ArrangementError {
    /// A coordinate is NaN or infinite.
    #[error("point {point} of the curves is {position}, expected finite coordinates")]
    NonFinite {
        /// Index of the point.
        point: usize,
        /// Its position, as given.
        position: DVec2,
    },
    /// A segment ends at a point that does not exist.
    #[error("segment {segment} of the curves ends at point {point}, but there are {count} points")]
    NoSuchPoint {
        /// Index of the segment.
        segment: usize,
        /// The point.
        point: u32,
        /// Number of points.
        count: usize,
    },
    /// The curves are not closed.
    #[error(
        "the curves are not closed: at {point} their segments start {excess} times more often than they end, counted with \
         their weights"
    )]
    Open {
        /// A place where they are not.
        point: DVec2,
        /// Number of starts minus number of ends.
        excess: i64,
    },
    /// The flag that stops a whole sweep was set; an arrangement alone has none.
    #[error("interrupted")]
    Interrupted,
    /// An invariant does not hold.
    #[error(transparent)]
    Fault(#[from] Fault),
}

impl From<Interrupted> for ArrangementError {
    fn from(_: Interrupted) -> ArrangementError {
        ArrangementError::Interrupted
    }
}

impl From<Stop> for ArrangementError {
    fn from(stop: Stop) -> ArrangementError {
        match stop {
            Stop::Interrupted => ArrangementError::Interrupted,
            Stop::Fault(fault) => ArrangementError::Fault(fault),
        }
    }
}

/// The faces of an arrangement as triangles, for display and meshing: a constrained Delaunay
/// triangulation of the convex hull.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Triangulation {
    /// #F triples of vertices of the arrangement, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// #F winding numbers of the curves around each triangle.
    pub winding: Vec<i32>,
    /// #F: whether the triangle belongs to the region, because its winding number is at least 1 or
    /// because it was filled.
    pub is_inside: Vec<bool>,
}

/// A region as triangles, for meshing and for programs that take nothing else.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionTriangles {
    /// #V corners of the boundary.
    pub positions: Vec<DVec2>,
    /// #F triples of corners, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
}

/// Measures of a region, in the units of its coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Measures {
    /// Area of the region.
    pub area: f64,
    /// Length of its boundary, including that of the holes.
    pub perimeter: f64,
    /// Number of pieces, connected across edges.
    pub pieces: usize,
    /// Number of holes, as [`Outlines`] defines them.
    pub holes: usize,
    /// The smallest box \[min, max\] around it; zero for an empty region.
    pub bounds: [DVec2; 2],
    /// Number of vertices of the boundary.
    pub vertices: usize,
}

/// The faces between some closed curves with their winding numbers, and the region where these are
/// at least 1.
#[derive(Debug, Clone)]
pub struct Arrangement {
    grid: Grid,
    nodes: Vec<Node>,
    positions: Vec<DVec2>,
    pieces: Vec<Stroke>,
    faces: Faces,
    /// Whether each face belongs to the region.
    is_inside: Vec<bool>,
    cancelled: Vec<[DVec2; 2]>,
}

/// Arranges directed curves.
///
/// - `points`: finite, in any unit.
/// - `segments`: closed, with their ends among `points`: at each point as many start as end,
///   counted with their weights.
///
/// # Guarantee
/// The result is exact for the curves after snap rounding: every point moves by no more than
/// [`Arrangement::rounding`], and the moved curves meet at vertices only. The same input gives the
/// same bits for any number of threads, except for the diagonals of a [`Triangulation`] between
/// four or more vertices on one circle.
///
/// # Errors
/// [`ArrangementError::NonFinite`], [`ArrangementError::NoSuchPoint`] and
/// [`ArrangementError::Open`] for bad input; [`ArrangementError::Fault`].
///
/// # Cost
/// O((n + k) log n) for `k` pairs of segments near each other, plus the pieces below the lowest
/// point of each connected part. The search for crossings is parallel.
pub fn arrange(points: &[DVec2], segments: &[Segment]) -> Result<Arrangement, ArrangementError> {
    arrange_as(points, segments, Work::UNWATCHED)
}

/// [`arrange`] as a part of some work.
fn arrange_as(
    points: &[DVec2],
    segments: &[Segment],
    work: Work,
) -> Result<Arrangement, ArrangementError> {
    work.check()?;
    let [cutting, walking] = work.parts([4, 1]);
    check(points, segments)?;
    let grid = Grid::around(points);
    let strokes = crossings::cut(Strokes::new(&grid, points, segments)?, cutting)?;
    let cancelled = strokes
        .cancelled
        .iter()
        .map(|ends| ends.map(|end| grid.place(strokes.nodes[end as usize])))
        .collect();
    let Strokes {
        nodes,
        strokes: pieces,
        ..
    } = strokes.compacted();
    let faces = Faces::new(&nodes, &pieces, walking)?;
    Ok(Arrangement {
        grid,
        positions: nodes.iter().map(|&node| grid.place(node)).collect(),
        nodes,
        pieces,
        is_inside: faces.winding.iter().map(|&winding| winding >= 1).collect(),
        faces,
        cancelled,
    })
}

fn check(points: &[DVec2], segments: &[Segment]) -> Result<(), ArrangementError> {
    if let Some(point) = points.iter().position(|point| !point.is_finite()) {
        return Err(ArrangementError::NonFinite {
            point,
            position: points[point],
        });
    }
    let count = points.len();
    for (segment, curve) in segments.iter().enumerate() {
        if let Some(&point) = curve.ends.iter().find(|&&end| end as usize >= count) {
            return Err(ArrangementError::NoSuchPoint {
                segment,
                point,
                count,
            });
        }
    }
    Ok(())
}

impl Arrangement {
    /// #V distinct vertices: the ends and crossings of the curves that do not cancel.
    pub fn positions(&self) -> &[DVec2] {
        &self.positions
    }

    /// Triangles that fill the convex hull of the vertices, with the winding number of each.
    ///
    /// # Errors
    /// [`Fault`].
    ///
    /// # Cost
    /// O(n log n), several times that of [`arrange`].
    pub fn triangulation(&self) -> Result<Triangulation, Fault> {
        let cells = Cells::new(&self.nodes, &self.pieces, &self.faces)?;
        let of_face = |&face: &u32| face as usize;
        Ok(Triangulation {
            winding: cells
                .face
                .iter()
                .map(|face| self.faces.winding[of_face(face)])
                .collect(),
            is_inside: cells
                .face
                .iter()
                .map(|face| self.is_inside[of_face(face)])
                .collect(),
            triangles: cells.triangles,
        })
    }

    /// The region within its outlines as triangles: the constrained Delaunay triangulation of their
    /// corners alone, without those of curves inside the region.
    ///
    /// Every corner is used, none is added, and two triangles that are neighbours share an edge.
    ///
    /// # Errors
    /// [`Fault`].
    ///
    /// # Cost
    /// O(n log n) for n corners.
    ///
    /// # Example
    /// ```
    /// use glam::DVec2;
    /// use steadysweep::planar::{FillRule, Generator, Motion, Polygon, Span, SweepSettings, sweep};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(DVec2::from_array);
    /// let square = Polygon::new(vec![corners.to_vec()], FillRule::EvenOdd)?;
    /// let slide = Generator::translation(DVec2::new(1.0, 2.0));
    /// let motion = Motion::from_spans(vec![Span::new(slide, 1.0)?])?;
    /// let swept = sweep(&square, &motion, &SweepSettings::default())?;
    ///
    /// // A hexagon.
    /// let found = swept.arrangement.region_triangles(&swept.outlines)?;
    /// assert_eq!((found.positions.len(), found.triangles.len()), (6, 4));
    /// # Ok(())
    /// # }
    /// ```
    pub fn region_triangles(&self, outlines: &Outlines) -> Result<RegionTriangles, Fault> {
        let mut strokes: Vec<Stroke> = Vec::new();
        for outline in outlines.loops() {
            let next = outline.vertices.iter().cycle().skip(1);
            strokes.extend(
                outline
                    .vertices
                    .iter()
                    .zip(next)
                    .map(|(&from, &to)| Stroke {
                        ends: [from.min(to), from.max(to)],
                        weight: if from < to { 1 } else { -1 },
                    }),
            );
        }
        strokes.sort_unstable();
        let Strokes { nodes, strokes, .. } = Strokes {
            nodes: self.nodes.clone(),
            strokes,
            cancelled: Vec::new(),
        }
        .compacted();
        if strokes.is_empty() {
            return Ok(RegionTriangles {
                positions: Vec::new(),
                triangles: Vec::new(),
            });
        }
        let faces = Faces::new(&nodes, &strokes, Work::UNWATCHED).map_err(Stop::unwatched)?;
        let cells = Cells::new(&nodes, &strokes, &faces)?;
        let is_inside = |face: &u32| faces.winding[*face as usize] >= 1;
        let kept = cells.triangles.into_iter().zip(&cells.face);
        Ok(RegionTriangles {
            positions: nodes.iter().map(|&node| self.grid.place(node)).collect(),
            triangles: kept
                .filter(|(_, face)| is_inside(face))
                .map(|(triangle, _)| triangle)
                .collect(),
        })
    }

    /// Largest distance by which a point of the curves may have been moved: a cell for its own
    /// place, and one for the pixel in which its segment is bent.
    pub fn rounding(&self) -> f64 {
        2.0 * self.grid.cell()
    }

    /// The pieces of the curves with the region on neither side, and those that cancelled each
    /// other.
    ///
    /// Some of the latter may lie in the region; their distance from it shows which. Pieces of the
    /// input that cancel by their indices count as never present.
    pub fn idle(&self) -> Vec<[DVec2; 2]> {
        let is_inside = |half: u32| self.is_inside[self.faces.face_of(half) as usize];
        let idle = self.pieces.iter().zip((0..).step_by(2));
        idle.filter(|(_, half)| !is_inside(*half) && !is_inside(twin(*half)))
            .map(|(piece, _)| piece.ends.map(|end| self.positions[end as usize]))
            .chain(self.cancelled.iter().copied())
            .collect()
    }

    /// The bounded parts of the outside, each with the deepest place found in it.
    ///
    /// # Errors
    /// As [`Arrangement::triangulation`].
    pub fn pockets(&self) -> Result<Vec<Pocket>, Fault> {
        self.each_pocket(Work::UNWATCHED)
            .map(|pocket| pocket.map_err(Stop::unwatched))
            .collect()
    }

    /// [`Arrangement::pockets`], one after the other.
    pub(crate) fn each_pocket(&self, work: Work) -> impl Iterator<Item = Result<Pocket, Stop>> {
        pockets::pockets(self, work)
    }

    /// Adds pockets of this region to it.
    pub fn fill(&mut self, pockets: &[Pocket]) {
        let filled: HashSet<u32> = pockets.iter().map(|pocket| pocket.first_face).collect();
        let component = self.components();
        for (is_inside, component) in self.is_inside.iter_mut().zip(component) {
            *is_inside |= filled.contains(&component);
        }
    }

    /// The region, prepared for distances of points. O(n log n).
    pub fn proximity(&self) -> Proximity {
        let is_inside = |half: u32| self.is_inside[self.faces.face_of(half) as usize];
        let place = |end: u32| self.positions[end as usize];
        let mut edges = Vec::new();
        for (piece, half) in self.pieces.iter().zip((0..).step_by(2)) {
            let [from, to] = piece.ends.map(place);
            match [half, twin(half)].map(is_inside) {
                [true, false] => edges.push([from, to]),
                [false, true] => edges.push([to, from]),
                _ => {}
            }
        }
        Proximity::new(edges)
    }

    /// Per face, the least face of the part of the region, or of the outside, to which it belongs.
    fn components(&self) -> Vec<u32> {
        self.faces
            .components(|a, b| self.is_inside[a as usize] == self.is_inside[b as usize])
    }

    /// The boundary of the region, with the region on its left.
    ///
    /// Vertices between two collinear pieces are left out, unless other loops pass there. O(n) and
    /// a sort of the loops.
    pub fn outlines(&self) -> Outlines {
        let node = |vertex: u32| self.nodes[vertex as usize];
        outlines::outlines(
            &self.faces,
            &self.pieces,
            &self.is_inside,
            |[a, b, c]| cross(node(a), node(b), node(c)) == 0,
            |vertices| self.doubled_area(vertices) > 0,
        )
    }

    /// The measures of the region, from its outlines.
    pub fn measures(&self, outlines: &Outlines) -> Measures {
        let mut measures = Measures {
            area: 0.0,
            perimeter: 0.0,
            pieces: outlines.pieces.len(),
            holes: outlines.holes.len(),
            bounds: [DVec2::ZERO; 2],
            vertices: 0,
        };
        let cell = self.grid.cell();
        let doubled: i128 = outlines
            .loops()
            .map(|outline| self.doubled_area(&outline.vertices))
            .sum();
        measures.area = doubled as f64 * cell * cell / 2.0;
        let mut first = true;
        for outline in outlines.loops() {
            let places = outline.vertices.iter().map(|&v| self.positions[v as usize]);
            let next = places.clone().cycle().skip(1);
            measures.vertices += outline.vertices.len();
            for (place, next) in places.zip(next) {
                measures.perimeter += place.distance(next);
                let [low, high] = measures.bounds;
                measures.bounds = if first {
                    [place; 2]
                } else {
                    [low.min(place), high.max(place)]
                };
                first = false;
            }
        }
        measures
    }

    /// Twice the signed area inside a loop, in cells. Exact.
    fn doubled_area(&self, vertices: &[u32]) -> i128 {
        let Some((&first, rest)) = vertices.split_first() else {
            return 0;
        };
        let node = |vertex: u32| self.nodes[vertex as usize];
        rest.windows(2)
            .map(|pair| cross(node(first), node(pair[0]), node(pair[1])))
            .sum()
    }
}
