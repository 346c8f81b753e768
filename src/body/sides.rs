//! How often closed loops wind around the points on either side of each of their edges, by one
//! exact sweep over the plane.
//!
//! The sweep line moves from left to right and, among points of one abscissa, upwards. The edges
//! that meet it are kept in order along it. They may share corners, end on each other and run along
//! each other; an edge is cut where another one ends on it, so that the pieces meet in corners only
//! and each lies between two regions of the plane. Two edges that cross are neighbours on the line
//! before the order becomes wrong, and are found there (Shamos & Hoey 1976).

use super::polygon_defect::{LoopPlace, PolygonError};
use crate::Fault;
use crate::numeric::exact::signs::{Side, side_of_line};
use crate::numeric::index;
use glam::DVec2;
use std::cmp::Ordering;
use std::collections::{BTreeSet, HashMap};

/// Most edges that share a piece, summed over all shared pieces: a few seconds and a hundred MB.
const MOST_OVERLAPS: usize = 20_000_000;

/// A piece of an edge, or of several that run along each other, and the winding numbers beside it.
#[derive(Debug, Clone)]
pub(super) struct EdgePiece {
    /// Places of the ends, left before right (lower before upper on a vertical).
    pub(super) ends: [u32; 2],
    /// The winding number below it.
    pub(super) below: i32,
    /// The winding number above it.
    pub(super) above: i32,
    /// The edges of which it is a part.
    pub(super) edges: Vec<u32>,
}

/// The pieces of all edges, no two of which have more than an end in common.
#[derive(Debug)]
pub(super) struct EdgePieces {
    /// The distinct corners, in the order of the sweep.
    pub(super) places: Vec<DVec2>,
    /// Place of each corner, loop after loop.
    pub(super) place_of: Vec<u32>,
    /// The pieces in the order of their left ends.
    pub(super) pieces: Vec<EdgePiece>,
    /// Per place, the piece right below it, among those that pass it.
    pub(super) under: Vec<Option<u32>>,
}

/// An edge on the sweep line, or the current point of the line, just below or above all edges
/// through it.
#[derive(Debug, Clone, Copy)]
enum Strand {
    Piece { ends: [DVec2; 2], number: u32 },
    Point { at: DVec2, order: Ordering },
}

impl Strand {
    fn ends(&self) -> [DVec2; 2] {
        match *self {
            Strand::Piece { ends, .. } => ends,
            Strand::Point { at, .. } => [at; 2],
        }
    }
}

/// From low to high, for strands that are both on the line.
impl Ord for Strand {
    fn cmp(&self, other: &Strand) -> Ordering {
        match (*self, *other) {
            (Strand::Point { at, order }, Strand::Piece { ends: [a, b], .. }) => {
                height(a, b, at).then(order)
            }
            (Strand::Piece { .. }, Strand::Point { .. }) => other.cmp(self).reverse(),
            (Strand::Point { order, .. }, Strand::Point { order: other, .. }) => order.cmp(&other),
            (Strand::Piece { ends: [a, b], .. }, Strand::Piece { ends: [c, d], .. }) => {
                if lexicographic(a, c).is_le() {
                    height(a, b, c).then_with(|| height(a, b, d)).reverse()
                } else {
                    height(c, d, a).then_with(|| height(c, d, b))
                }
            }
        }
    }
}

impl PartialOrd for Strand {
    fn partial_cmp(&self, other: &Strand) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Strand {
    fn eq(&self, other: &Strand) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Strand {}

/// Whether a point is above (`Greater`), on or below a line that runs to the right.
fn height(left: DVec2, right: DVec2, point: DVec2) -> Ordering {
    match side_of_line(left, right, point) {
        Side::Above => Ordering::Greater,
        Side::On => Ordering::Equal,
        Side::Below => Ordering::Less,
    }
}

/// The order in which the sweep meets finite points.
fn lexicographic(a: DVec2, b: DVec2) -> Ordering {
    a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y))
}

/// The rest of an edge beyond a place on it.
#[derive(Debug, Clone, Copy)]
struct Rest {
    edge: u32,
    /// Its right end.
    right: u32,
    /// What it adds to the winding number above it: the weight of its loop where the loop runs to
    /// the right there, otherwise minus the weight.
    weight: i32,
}

/// Cuts the edges of closed loops into pieces and finds the winding numbers beside them.
///
/// - `loops`: finite corners; each is joined to the next and the last to the first. Equal
///   neighbours give no edge. The number of all corners fits in `u32`.
/// - `weights`: how often each loop counts, negative when it counts in the opposite sense.
///
/// # Errors
/// [`PolygonError::Crossing`] when two edges cross inside both of them; none is missed.
/// [`PolygonError::TooMuchOverlap`] and [`PolygonError::Fault`].
///
/// # Cost
/// O((n + k) log n), where k is the number of edges that share a piece, summed over all shared
/// pieces. Of edges that all begin at one place and run along each other, the longest lies in as
/// many pieces as there are edges.
pub(super) fn sides(loops: &[Vec<DVec2>], weights: &[i32]) -> Result<EdgePieces, PolygonError> {
    let Corners {
        places,
        place_of,
        next,
    } = corners(loops);
    let mut starting: Vec<Vec<Rest>> = vec![Vec::new(); places.len()];
    let weight_of = loops
        .iter()
        .zip(weights)
        .flat_map(|(corners, &weight)| std::iter::repeat_n(weight, corners.len()));
    for (edge, ((&from, &next), weight)) in (0u32..).zip(place_of.iter().zip(&next).zip(weight_of))
    {
        let to = place_of[next as usize];
        if from != to {
            let (left, right) = (from.min(to), from.max(to));
            let weight = if from < to { weight } else { -weight };
            starting[left as usize].push(Rest {
                edge,
                right,
                weight,
            });
        }
    }
    let mut sweep = SweepLine {
        places: &places,
        line: BTreeSet::new(),
        pieces: Vec::new(),
        rests: Vec::new(),
        under: Vec::with_capacity(places.len()),
        overlaps: 0,
    };
    for (place, starts) in (0u32..).zip(starting) {
        let winding_fits = sweep
            .advance(place, starts)
            .map_err(|(edges, at)| crossing(loops, edges, at))?;
        if !winding_fits {
            return Err(
                Fault::new("the winding numbers of an outline contradict each other").into(),
            );
        }
        if sweep.overlaps > MOST_OVERLAPS {
            return Err(PolygonError::TooMuchOverlap {
                limit: MOST_OVERLAPS,
            });
        }
    }
    if !sweep.line.is_empty() {
        return Err(Fault::new("an edge of an outline goes on beyond its end").into());
    }
    Ok(EdgePieces {
        pieces: sweep.pieces,
        under: sweep.under,
        places,
        place_of,
    })
}

struct Corners {
    places: Vec<DVec2>,
    place_of: Vec<u32>,
    /// The corner that follows each one in its loop.
    next: Vec<u32>,
}

fn corners(loops: &[Vec<DVec2>]) -> Corners {
    // Adding zero turns -0 into 0, so that equal corners have equal bits.
    let all: Vec<DVec2> = loops.iter().flatten().map(|&p| p + DVec2::ZERO).collect();
    let mut places = all.clone();
    places.sort_unstable_by(|a, b| lexicographic(*a, *b));
    places.dedup();
    let bits = |p: DVec2| p.to_array().map(f64::to_bits);
    let numbers: HashMap<[u64; 2], u32> = places.iter().map(|&p| bits(p)).zip(0u32..).collect();
    let place_of = all.iter().map(|&p| numbers[&bits(p)]).collect();
    let mut next = Vec::with_capacity(all.len());
    for corners in loops {
        let first = index(next.len());
        next.extend((1..index(corners.len())).map(|i| first + i));
        if !corners.is_empty() {
            next.push(first);
        }
    }
    Corners {
        places,
        place_of,
        next,
    }
}

struct SweepLine<'a> {
    places: &'a [DVec2],
    line: BTreeSet<Strand>,
    pieces: Vec<EdgePiece>,
    /// The edges of each piece, which may continue beyond it.
    rests: Vec<Vec<Rest>>,
    under: Vec<Option<u32>>,
    /// Number of edges that share a piece, summed over all shared pieces so far.
    overlaps: usize,
}

/// Two edges that cross, and where.
type EdgeCrossing = ([u32; 2], DVec2);

impl SweepLine<'_> {
    /// Moves the line to a place at which `starts` begin. Returns whether the winding numbers below
    /// and above it are consistent, as those of closed loops are.
    fn advance(&mut self, place: u32, mut starts: Vec<Rest>) -> Result<bool, EdgeCrossing> {
        let at = self.places[place as usize];
        let bound = |order| Strand::Point { at, order };
        let (low, high) = (bound(Ordering::Less), bound(Ordering::Greater));
        let through: Vec<Strand> = self.line.range(low..high).copied().collect();
        let mut passing = None;
        for strand in &through {
            self.line.remove(strand);
            let Strand::Piece { number, .. } = *strand else {
                continue;
            };
            let piece = &mut self.pieces[number as usize];
            let rests = std::mem::take(&mut self.rests[number as usize]);
            // A piece also ends where some other edge begins or ends on it.
            piece.ends[1] = place;
            if let Some(rest) = rests.iter().find(|rest| rest.right != place)
                && let Some(other) = passing.replace(rest.edge)
            {
                return Err(([other, rest.edge], at));
            }
            starts.extend(rests.into_iter().filter(|rest| rest.right != place));
        }
        let under = self.line.range(..low).next_back().copied();
        let over = self.line.range(high..).next().copied();
        let below = match under {
            Some(Strand::Piece { number, .. }) => Some(number),
            _ => None,
        };
        self.under.push(below);
        let mut winding = below.map_or(0, |number| self.pieces[number as usize].above);
        let right = |rest: &Rest| self.places[rest.right as usize];
        starts.sort_by(|a, b| {
            let slopes = height(at, right(b), right(a));
            slopes.then(a.right.cmp(&b.right)).then(a.edge.cmp(&b.edge))
        });
        let (mut lowest, mut highest) = (None, None);
        for bundle in starts.chunk_by(|a, b| height(at, right(b), right(a)).is_eq()) {
            // The shortest edge ends the piece; the others continue from there.
            let end = bundle[0].right;
            let below = winding;
            winding += bundle.iter().map(|rest| rest.weight).sum::<i32>();
            if bundle.len() > 1 {
                self.overlaps += bundle.len();
            }
            let number = index(self.pieces.len());
            self.pieces.push(EdgePiece {
                ends: [place, end],
                below,
                above: winding,
                edges: bundle.iter().map(|rest| rest.edge).collect(),
            });
            self.rests.push(bundle.to_vec());
            let strand = Strand::Piece {
                ends: [at, self.places[end as usize]],
                number,
            };
            lowest = lowest.or(Some(strand));
            highest = Some(strand);
            self.line.insert(strand);
        }
        // Nothing winds around points above all edges.
        let expected = match over {
            Some(Strand::Piece { number, .. }) => self.pieces[number as usize].below,
            _ => 0,
        };
        self.part(under, lowest.or(over))?;
        self.part(highest, over)?;
        Ok(winding == expected)
    }

    /// Refuses two neighbours on the line if they cross.
    fn part(&self, low: Option<Strand>, high: Option<Strand>) -> Result<(), EdgeCrossing> {
        let (Some(low), Some(high)) = (low, high) else {
            return Ok(());
        };
        let (Strand::Piece { number: i, .. }, Strand::Piece { number: k, .. }) = (low, high) else {
            return Ok(());
        };
        let ([a, b], [c, d]) = (low.ends(), high.ends());
        let opposite = |one: Ordering, other: Ordering| one.is_ne() && one == other.reverse();
        if opposite(height(a, b, c), height(a, b, d)) && opposite(height(c, d, a), height(c, d, b))
        {
            let edge = |number: u32| self.pieces[number as usize].edges[0];
            return Err(([edge(i), edge(k)], crossing_point([a, b], [c, d])));
        }
        Ok(())
    }
}

/// The point in which two segments cross, rounded.
fn crossing_point([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> DVec2 {
    let (along, across) = (b - a, d - c);
    let share = (c - a).perp_dot(across) / along.perp_dot(across);
    // The point is not finite, or beyond the segment, where the two are nearly parallel.
    a + along
        * if share.is_finite() {
            share.clamp(0.0, 1.0)
        } else {
            0.5
        }
}

/// The error that names the edges by loop and corner.
fn crossing(loops: &[Vec<DVec2>], edges: [u32; 2], at: DVec2) -> PolygonError {
    let mut edges = edges.map(|edge| place_in(loops, edge));
    edges.sort_unstable();
    PolygonError::Crossing { edges, at }
}

/// Loop and corner of a corner that is counted through all loops.
pub(super) fn place_in(loops: &[Vec<DVec2>], corner: u32) -> LoopPlace {
    let mut before = 0;
    let outline = loops
        .iter()
        .position(|corners| {
            let here = corner as usize - before < corners.len();
            before += if here { 0 } else { corners.len() };
            here
        })
        .expect("a corner is in a loop");
    LoopPlace {
        outline: index(outline),
        corner: corner - index(before),
    }
}
