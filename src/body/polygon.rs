//! A planar body: outlines with the body on their left.

use super::outlines::outlines;
use super::polygon_defect::PolygonError;
use super::sides::{EdgePiece, EdgePieces, place_in, sides};
use crate::numeric::exact::signs::{Side, side_of_line};
use crate::numeric::index;
use crate::numeric::tolerance::LARGEST_COORDINATE;
use glam::{DAffine2, DVec2};

/// Most corners: each edge is cut at most where corners lie on it, and the pieces are numbered by
/// `u32`.
const MOST: usize = u32::MAX as usize / 4;

/// The rule that says which points closed loops enclose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FillRule {
    /// Points around which the loops wind an odd number of times: the sense of the loops does not
    /// matter, and a loop inside another one is a hole. The rule for DXF.
    #[default]
    EvenOdd,
    /// Points around which the loops wind at all: a hole runs against the loop around it. The
    /// default of SVG.
    NonZero,
}

impl FillRule {
    fn encloses(self, winding: i32) -> bool {
        match self {
            FillRule::EvenOdd => winding % 2 != 0,
            FillRule::NonZero => winding != 0,
        }
    }
}

/// A closed planar body: one or more pieces, with or without holes, bounded by straight edges.
///
/// By construction the body is on the left of every edge (with y up: outer loops run
/// counter-clockwise, holes clockwise), no edge has length zero, edges meet in corners only, and
/// the winding number of the loops is 1 in the body and 0 elsewhere. Loops may touch themselves and
/// each other in corners.
///
/// # Example
/// ```
/// use glam::DVec2;
/// use steadysweep::body::{FillRule, Polygon};
///
/// let square = |from: f64, to: f64| {
///     vec![[from, from], [to, from], [to, to], [from, to]].into_iter().map(DVec2::from_array)
/// };
/// let loops = vec![square(0.0, 3.0).collect(), square(1.0, 2.0).collect()];
/// let frame = Polygon::new(loops, FillRule::EvenOdd).expect("a square with a hole");
/// assert_eq!((frame.pieces(), frame.holes()), (1, 1));
/// assert_eq!((frame.area(), frame.perimeter()), (8.0, 16.0));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Polygon {
    positions: Vec<DVec2>,
    loops: Vec<Vec<u32>>,
    /// Per edge, the edge of the input of which it is a part, counted through all loops.
    given_edges: Vec<u32>,
    holes: usize,
    bounds: [DVec2; 2],
    redundant: Vec<u32>,
}

impl Polygon {
    /// Checks outlines and makes what they enclose a body.
    ///
    /// - `loops`: corners, any unit, finite, at most 1e18; each is joined to the next and the last
    ///   to the first. Equal neighbours are one corner.
    /// - `fill`: which points are enclosed.
    ///
    /// Loops that touch nowhere keep their order, their first corners and, unless they ran the
    /// other way round, the order of their corners. Where corners lie on other corners or edges, or
    /// edges run along each other, the border of the body is chained anew, with additional corners
    /// where corners lie on edges; a stretch with the body on both sides, or on neither,
    /// disappears. Loops that contribute nothing to the border are left out, see
    /// [`Polygon::redundant`].
    ///
    /// # Errors
    /// [`PolygonError`]: what is wrong, with loop and corner as given. Edges that cross are found
    /// by exact signs. With the even-odd rule, loops that overlap without such edges, because they
    /// pass each other in corners, are refused as well: what they enclose is hardly what was meant.
    ///
    /// # Cost
    /// O((n + k) log n), where k is the number of edges that share a piece, summed over all shared
    /// pieces; it is limited.
    pub fn new(loops: Vec<Vec<DVec2>>, fill: FillRule) -> Result<Polygon, PolygonError> {
        check_numbers(&loops)?;
        let EdgePieces {
            places,
            place_of,
            pieces,
            ..
        } = sides(&loops, &weights(&loops, fill))?;
        let forward = |piece: &EdgePiece| match [piece.above, piece.below].map(|w| fill.encloses(w))
        {
            [above, below] if above == below => None,
            [above, _] => Some(above),
        };
        let mut redundant = vec![true; loops.len()];
        let mut first_edge = Vec::with_capacity(loops.len());
        let mut corners = 0;
        for outline in &loops {
            first_edge.push(corners);
            corners += index(outline.len());
        }
        let loop_of = |edge: u32| first_edge.partition_point(|&first| first <= edge) - 1;
        if fill == FillRule::EvenOdd
            && let Some(piece) = overlap(&pieces, loops.len(), loop_of)
        {
            let (edge, at) = (
                place_in(&loops, piece.edges[0]),
                places[piece.ends[0] as usize],
            );
            return Err(PolygonError::Overlap { edge, at });
        }
        for piece in pieces.iter().filter(|piece| forward(piece).is_some()) {
            piece
                .edges
                .iter()
                .for_each(|&edge| redundant[loop_of(edge)] = false);
        }
        let mut polygon = Polygon {
            redundant: (0u32..)
                .zip(&redundant)
                .filter(|(_, r)| **r)
                .map(|(outline, _)| outline)
                .collect(),
            ..Polygon::empty()
        };
        if touches_nowhere(&pieces, places.len()) {
            let mut kept: Vec<Option<bool>> = vec![None; loops.len()];
            for piece in &pieces {
                let edge = piece.edges[0];
                let rightward = place_of[edge as usize] == piece.ends[0];
                kept[loop_of(edge)] =
                    forward(piece).map(|left_to_right| left_to_right == rightward);
            }
            for ((outline, first), same_sense) in loops.iter().zip(first_edge).zip(kept) {
                let Some(same_sense) = same_sense else {
                    continue;
                };
                let mut corners: Vec<(DVec2, u32)> = outline.iter().copied().zip(first..).collect();
                // The edge begins at the last of several equal neighbours.
                corners.dedup_by(|next, kept| {
                    let equal = next.0 == kept.0;
                    if equal {
                        kept.1 = next.1;
                    }
                    equal
                });
                while corners.len() > 1
                    && corners.first().map(|c| c.0) == corners.last().map(|c| c.0)
                {
                    corners.pop();
                }
                if !same_sense {
                    // The first corner stays first; the edge between two corners now belongs to the
                    // other one.
                    corners[1..].reverse();
                    let edges: Vec<u32> = corners.iter().map(|c| c.1).collect();
                    let next = edges.iter().cycle().skip(1);
                    corners
                        .iter_mut()
                        .zip(next)
                        .for_each(|(corner, &edge)| corner.1 = edge);
                }
                polygon.push_loop(corners.into_iter());
            }
        } else {
            let ordered = in_the_order_of_the_edges(&pieces);
            let border: Vec<([u32; 2], u32)> = ordered
                .into_iter()
                .filter_map(|piece| {
                    let [left, right] = piece.ends;
                    let ends = if forward(piece)? {
                        [left, right]
                    } else {
                        [right, left]
                    };
                    Some((ends, piece.edges.iter().copied().min()?))
                })
                .collect();
            let directed: Vec<[u32; 2]> = border.iter().map(|(ends, _)| *ends).collect();
            for outline in outlines(&places, &directed)? {
                let corner = |piece: u32| {
                    let ([from, _], edge) = border[piece as usize];
                    (places[from as usize], edge)
                };
                polygon.push_loop(outline.into_iter().map(corner));
            }
        }
        if polygon.loops.is_empty() {
            return Err(PolygonError::NoArea);
        }
        polygon.measure();
        Ok(polygon)
    }

    /// Loops that enclose nothing, such as both sides of a line. No body, and not validated: only the
    /// sweep cycle is made of it.
    pub(super) fn of_no_area(loops: Vec<Vec<DVec2>>) -> Polygon {
        let mut polygon = Polygon::empty();
        for corners in loops {
            let first = index(polygon.positions.len());
            polygon.push_loop(corners.into_iter().zip(first..));
        }
        polygon.bounds = bounds_of(polygon.positions.iter().copied());
        polygon
    }

    /// A polygon without loops, to be filled.
    pub(super) fn empty() -> Polygon {
        Polygon {
            positions: Vec::new(),
            loops: Vec::new(),
            given_edges: Vec::new(),
            holes: 0,
            bounds: [DVec2::ZERO; 2],
            redundant: Vec::new(),
        }
    }

    /// Computes the box and the number of holes, once all loops are there.
    pub(super) fn measure(&mut self) {
        self.bounds = bounds_of(self.positions.iter().copied());
        let holes = self.loops.iter().filter(|outline| self.is_hole(outline));
        self.holes = holes.count();
    }

    /// Appends a loop of corners, each with the edge of the input that begins there.
    pub(super) fn push_loop(&mut self, corners: impl Iterator<Item = (DVec2, u32)>) {
        let first = index(self.positions.len());
        for (position, edge) in corners {
            self.positions.push(position);
            self.given_edges.push(edge);
        }
        self.loops
            .push((first..index(self.positions.len())).collect());
    }

    /// Whether a loop runs clockwise, judged by the turn at its leftmost corner (the lowest of
    /// several).
    pub(super) fn is_hole(&self, outline: &[u32]) -> bool {
        let at = |i: usize| self.positions[outline[i % outline.len()] as usize];
        let order = |i: &usize, k: &usize| {
            at(*i)
                .x
                .total_cmp(&at(*k).x)
                .then(at(*i).y.total_cmp(&at(*k).y))
        };
        let lowest = (0..outline.len())
            .min_by(order)
            .expect("a loop has corners");
        side_of_line(at(lowest + outline.len() - 1), at(lowest), at(lowest + 1)) == Side::Below
    }

    /// #V corners, loop after loop. Each corner belongs to one loop, so that places where loops
    /// touch occur repeatedly.
    pub fn positions(&self) -> &[DVec2] {
        &self.positions
    }
    /// Corners of each loop in order, as indices into the positions: consecutive numbers.
    pub fn loops(&self) -> &[Vec<u32>] {
        &self.loops
    }
    /// #V edges as start and end: edge i begins at corner i.
    pub fn edges(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.loops.iter().flat_map(|outline| {
            let next = outline.iter().cycle().skip(1);
            outline.iter().zip(next).map(|(&from, &to)| [from, to])
        })
    }
    /// Number of edges, and of corners.
    pub fn edge_count(&self) -> usize {
        self.positions.len()
    }
    /// The edge of the input of which an edge is a part, counted through all loops as they were
    /// given; the first one, where there are several.
    pub fn given_edge(&self, edge: u32) -> u32 {
        self.given_edges[edge as usize]
    }
    /// Number of pieces; two that meet only in points are separate.
    pub fn pieces(&self) -> usize {
        self.loops.len() - self.holes
    }
    /// Number of holes; a hole that touches the outline around it in a point is part of that
    /// outline instead.
    pub fn holes(&self) -> usize {
        self.holes
    }
    /// Loops of the input that bound nothing: those without area, and those inside the body.
    pub fn redundant(&self) -> &[u32] {
        &self.redundant
    }

    /// The image under an affine map of positive determinant.
    ///
    /// It is not validated again: rounding may make edges that are close to each other touch or
    /// cross.
    pub fn transformed(&self, pose: &DAffine2) -> Polygon {
        let determinant = pose.matrix2.determinant();
        debug_assert!(
            determinant > 0.0,
            "a pose of a body keeps orientation, determinant {determinant}"
        );
        let mut polygon = self.clone();
        polygon
            .positions
            .iter_mut()
            .for_each(|p| *p = pose.transform_point2(*p));
        polygon.bounds = bounds_of(polygon.positions.iter().copied());
        polygon
    }

    /// Area, above 0. O(n).
    pub fn area(&self) -> f64 {
        let middle = self.bounds[0].midpoint(self.bounds[1]);
        let place = |corner: u32| self.positions[corner as usize] - middle;
        self.edges()
            .map(|[from, to]| place(from).perp_dot(place(to)))
            .sum::<f64>()
            / 2.0
    }
    /// Length of all loops. O(n).
    pub fn perimeter(&self) -> f64 {
        let place = |corner: u32| self.positions[corner as usize];
        self.edges()
            .map(|[from, to]| place(from).distance(place(to)))
            .sum()
    }
    /// The smallest box [min, max] around it.
    pub fn bounds(&self) -> [DVec2; 2] {
        self.bounds
    }
    /// Length of the diagonal of the box.
    pub fn diagonal(&self) -> f64 {
        self.bounds[0].distance(self.bounds[1])
    }
}

fn check_numbers(loops: &[Vec<DVec2>]) -> Result<(), PolygonError> {
    let corners = loops.iter().map(Vec::len).sum();
    if corners == 0 {
        return Err(PolygonError::Empty);
    }
    if corners > MOST {
        return Err(PolygonError::TooMany {
            corners,
            limit: MOST,
        });
    }
    for (corner, &position) in (0u32..).zip(loops.iter().flatten()) {
        if !position.is_finite() {
            return Err(PolygonError::NonFinite {
                place: place_in(loops, corner),
                position,
            });
        }
        if position.abs().max_element() > LARGEST_COORDINATE {
            return Err(PolygonError::TooFar {
                place: place_in(loops, corner),
                position,
            });
        }
    }
    Ok(())
}

/// The weight of each loop. With the even-odd rule it makes every loop count as counter-clockwise,
/// so that the winding number around a point is the number of loops that contain it; with the other
/// rule, loops count as they run.
fn weights(loops: &[Vec<DVec2>], fill: FillRule) -> Vec<i32> {
    let counter_clockwise = |corners: &Vec<DVec2>| {
        let base = corners.first().copied().unwrap_or_default();
        let next = corners.iter().cycle().skip(1);
        let products = corners
            .iter()
            .zip(next)
            .map(|(&p, &q)| (p - base).perp_dot(q - base));
        products.sum::<f64>() >= 0.0
    };
    let weight = |corners: &Vec<DVec2>| match fill {
        FillRule::EvenOdd if !counter_clockwise(corners) => -1,
        _ => 1,
    };
    loops.iter().map(weight).collect()
}

/// Finds a piece of a loop that lies inside more loops than another piece of the same loop; pieces
/// shared by several edges do not count.
///
/// In loops that are disjoint or nested, and at most touch, all such pieces have the same depth.
fn overlap(
    pieces: &[EdgePiece],
    loops: usize,
    loop_of: impl Fn(u32) -> usize,
) -> Option<&EdgePiece> {
    let mut first: Vec<Option<&EdgePiece>> = vec![None; loops];
    let depth = |piece: &EdgePiece| piece.below.min(piece.above);
    for piece in pieces.iter().filter(|piece| piece.edges.len() == 1) {
        let other = *first[loop_of(piece.edges[0])].get_or_insert(piece);
        if depth(other) != depth(piece) {
            return Some(if depth(other) > depth(piece) {
                other
            } else {
                piece
            });
        }
    }
    None
}

/// Whether every place is a corner of one loop only, and lies on no other edge.
fn touches_nowhere(pieces: &[EdgePiece], places: usize) -> bool {
    let mut ends = vec![0u8; places];
    for piece in pieces {
        for end in piece.ends {
            ends[end as usize] = ends[end as usize].saturating_add(1);
        }
    }
    ends.iter().all(|&count| count == 2 || count == 0)
        && pieces.iter().all(|piece| piece.edges.len() == 1)
}

/// The pieces in the order of the edges to which they belong, so that chains of them begin as the
/// loops did.
fn in_the_order_of_the_edges(pieces: &[EdgePiece]) -> Vec<&EdgePiece> {
    let mut ordered: Vec<&EdgePiece> = pieces.iter().collect();
    ordered.sort_by_key(|piece| piece.edges.iter().min().copied());
    ordered
}

/// The smallest box around points.
pub(super) fn bounds_of(mut positions: impl Iterator<Item = DVec2>) -> [DVec2; 2] {
    let first = positions.next().unwrap_or_default();
    positions.fold([first; 2], |[low, high], p| [low.min(p), high.max(p)])
}

#[cfg(test)]
mod tests;
