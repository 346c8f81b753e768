//! Lines of the plane without an inside.

use super::Polygon;
use crate::numeric::index;
use crate::numeric::tolerance::LARGEST_COORDINATE;
use glam::{DAffine2, DVec2};

/// Most corners: both sides of each line are numbered by `u32`.
const MOST: usize = u32::MAX as usize / 8;

/// Polylines of the plane, open or closed, which may meet and cross each other: an outline that has
/// no inside.
///
/// # Example
/// ```
/// use glam::DVec2;
/// use steadysweep::body::Polylines;
///
/// let corners = [[0.0, 0.0], [3.0, 0.0], [3.0, 4.0]].map(DVec2::from_array);
/// let hook = Polylines::new(vec![corners.to_vec()]).expect("a polyline");
/// assert_eq!((hook.lines().len(), hook.edge_count(), hook.length()), (1, 2, 7.0));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Polylines {
    lines: Vec<Vec<DVec2>>,
}

/// Why polylines were refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PolylineError {
    /// There are no lines.
    #[error("there are no lines; give at least one with two corners")]
    Empty,
    /// There are more corners than 32-bit numbers can count.
    #[error("{corners} corners are too many, at most {limit} can be numbered; use coarser lines")]
    TooMany {
        /// Number of corners found.
        corners: usize,
        /// Largest number.
        limit: usize,
    },
    /// A coordinate is NaN, infinite or too large.
    #[error(
        "corner {corner} of line {line} is at {position}, expected finite numbers up to {LARGEST_COORDINATE:.0e}"
    )]
    Coordinate {
        /// The line, counted from 0.
        line: u32,
        /// Its corner.
        corner: u32,
        /// Where it is.
        position: DVec2,
    },
    /// All corners of a line are at one place.
    #[error("line {line} has no length: all its corners are at {position}; leave it out")]
    NoLength {
        /// The line, counted from 0.
        line: u32,
        /// The place.
        position: DVec2,
    },
}

impl Polylines {
    /// Checks lines.
    ///
    /// - `lines`: corners in any unit, finite, at most 1e18; each is joined to the next. A line that
    ///   ends where it begins is closed. Equal neighbours are one corner.
    ///
    /// # Errors
    /// [`PolylineError`]: what is wrong, with line and corner as given.
    pub fn new(mut lines: Vec<Vec<DVec2>>) -> Result<Polylines, PolylineError> {
        if lines.iter().all(Vec::is_empty) {
            return Err(PolylineError::Empty);
        }
        let corners = lines.iter().map(Vec::len).sum();
        if corners > MOST {
            return Err(PolylineError::TooMany {
                corners,
                limit: MOST,
            });
        }
        for (line, corners) in (0u32..).zip(&mut lines) {
            for (corner, &position) in (0u32..).zip(corners.iter()) {
                // Also false for a NaN.
                let is_usable = position.abs().max_element() <= LARGEST_COORDINATE;
                if !(is_usable && position.is_finite()) {
                    return Err(PolylineError::Coordinate {
                        line,
                        corner,
                        position,
                    });
                }
            }
            corners.dedup();
            if let [position] = corners[..] {
                return Err(PolylineError::NoLength { line, position });
            }
        }
        lines.retain(|corners| !corners.is_empty());
        Ok(Polylines { lines })
    }

    /// The corners of each line, at least two.
    pub fn lines(&self) -> &[Vec<DVec2>] {
        &self.lines
    }

    /// Number of straight edges.
    pub fn edge_count(&self) -> usize {
        self.lines.iter().map(|corners| corners.len() - 1).sum()
    }

    /// Length of all lines. O(n).
    pub fn length(&self) -> f64 {
        let pairs = self.lines.iter().flat_map(|corners| corners.windows(2));
        pairs.map(|pair| pair[0].distance(pair[1])).sum()
    }

    /// The smallest box [min, max] around all lines. O(n).
    pub fn bounds(&self) -> [DVec2; 2] {
        let empty = [DVec2::INFINITY, DVec2::NEG_INFINITY];
        let around = |[low, high]: [DVec2; 2], &p: &DVec2| [low.min(p), high.max(p)];
        self.lines.iter().flatten().fold(empty, around)
    }

    /// Number of lines that end where they begin.
    pub fn closed(&self) -> usize {
        let is_closed = |corners: &&Vec<DVec2>| corners.first() == corners.last();
        self.lines.iter().filter(is_closed).count()
    }

    /// The image under an affine map. O(n).
    pub fn transformed(&self, pose: &DAffine2) -> Polylines {
        let moved = |corners: &Vec<DVec2>| {
            let corners = corners.iter();
            corners.map(|&p| pose.transform_point2(p)).collect()
        };
        Polylines {
            lines: self.lines.iter().map(moved).collect(),
        }
    }

    /// Both sides of the lines: along each line and back. The polygon encloses nothing.
    pub(crate) fn both_sides(&self) -> BothSides {
        let mut loops: Vec<Vec<DVec2>> = Vec::new();
        let mut twins = Vec::new();
        for corners in &self.lines {
            let first = index(twins.len());
            let edges = index(corners.len() - 1);
            // Edge i of the first side lies on the edge with which the second side comes back.
            twins.extend((0..2 * edges).rev().map(|edge| first + edge));
            let there = &corners[..corners.len() - 1];
            let back = corners[1..].iter().rev().copied();
            if corners.first() == corners.last() {
                loops.push(there.to_vec());
                loops.push(back.collect());
            } else {
                loops.push(there.iter().copied().chain(back).collect());
            }
        }
        BothSides {
            polygon: Polygon::of_no_area(loops),
            twins,
        }
    }
}

/// Both sides of some lines.
pub(crate) struct BothSides {
    /// The sides as loops, in which edge i begins at corner i.
    pub(crate) polygon: Polygon,
    /// For each edge, the one that runs back along it.
    pub(crate) twins: Vec<u32>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_edge_lies_on_its_twin() {
        let line = |corners: &[[f64; 2]]| corners.iter().map(|&c| DVec2::from_array(c)).collect();
        let open = line(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [2.0, 1.0]]);
        let closed = line(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]);
        let lines = Polylines::new(vec![open, closed]).expect("two lines");
        assert_eq!((lines.edge_count(), lines.closed()), (5, 1), "{lines:?}");
        let BothSides { polygon, twins } = lines.both_sides();
        let edges: Vec<[DVec2; 2]> = polygon
            .edges()
            .map(|ends| ends.map(|end| polygon.positions()[end as usize]))
            .collect();
        assert_eq!((edges.len(), twins.len()), (10, 10), "both sides of five");
        for (edge, &twin) in edges.iter().zip(&twins) {
            let [from, to] = edges[twin as usize];
            assert_eq!(*edge, [to, from], "edge and twin");
        }
        assert_eq!(polygon.area(), 0.0, "nothing is enclosed");
    }

    #[test]
    fn lines_that_are_none_are_refused() {
        let refused = |lines| Polylines::new(lines).expect_err("refused").to_string();
        assert!(refused(vec![]).contains("no lines"), "empty");
        let point = vec![DVec2::ONE; 3];
        assert!(
            refused(vec![point]).starts_with("line 0 has no length"),
            "a point"
        );
        let damaged = vec![DVec2::ZERO, DVec2::new(f64::NAN, 0.0)];
        assert!(
            refused(vec![damaged]).starts_with("corner 1 of line 0"),
            "damaged"
        );
    }
}
