//! The defects of the outlines of a planar body, with loop, index and place.

use crate::Fault;
use crate::numeric::Readable;
use crate::numeric::tolerance::LARGEST_COORDINATE;
use glam::DVec2;
use std::fmt;

/// A corner or an edge of the outlines as they were given. Counts start at 0; edge i of a loop
/// begins at its corner i.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LoopPlace {
    /// The loop.
    pub outline: u32,
    /// The corner, or the edge that begins there.
    pub corner: u32,
}

/// Why outlines were refused as a planar body.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PolygonError {
    /// There are no loops, or none with a corner.
    #[error("there are no outlines; give at least one closed loop")]
    Empty,
    /// There are more corners than 32-bit numbers can count.
    #[error(
        "{corners} corners are too many, at most {limit} can be numbered; use a coarser outline"
    )]
    TooMany {
        /// Number of corners found.
        corners: usize,
        /// Largest number.
        limit: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error(
        "{place} is at {position}, which is not finite; the outline is damaged: export it again"
    )]
    NonFinite {
        /// The corner.
        place: LoopPlace,
        /// Its position.
        position: DVec2,
    },
    /// A coordinate is too large for the computation.
    #[error(
        "{place} is at {position}, coordinates must not exceed {LARGEST_COORDINATE:e}; choose a larger unit of length or \
         move the outline to the origin"
    )]
    TooFar {
        /// The corner.
        place: LoopPlace,
        /// Its position.
        position: DVec2,
    },
    /// Two edges cross inside both of them.
    #[error(
        "the outline crosses itself at {}: {} crosses {}; separate the two, or unite the areas that overlap",
        AtPoint(*.at), EdgeName(.edges[0]), EdgeName(.edges[1])
    )]
    Crossing {
        /// The edges, in the order of the input.
        edges: [LoopPlace; 2],
        /// Where they cross.
        at: DVec2,
    },
    /// A loop lies partly inside another one, and passes the border of that one at corners or along
    /// edges.
    #[error(
        "the outlines overlap: {} begins at {} inside of another loop, other parts of its own are outside of that; separate the \
         two, or unite the areas that overlap",
        EdgeName(*.edge), AtPoint(*.at)
    )]
    Overlap {
        /// An edge of the loop that lies inside the other one.
        edge: LoopPlace,
        /// The start of that edge.
        at: DVec2,
    },
    /// Too many edges run along each other.
    #[error(
        "edges run along each other more than {limit} times; unite the areas that overlap, or draw the border of their union"
    )]
    TooMuchOverlap {
        /// Largest number of edges that share a piece, summed over all shared pieces.
        limit: usize,
    },
    /// The loops enclose no area.
    #[error(
        "the outlines enclose no area: every edge is run through there and back, or lies inside the body; draw the border \
         of an area"
    )]
    NoArea,
    /// An invariant does not hold.
    #[error(transparent)]
    Fault(#[from] Fault),
}

impl fmt::Display for LoopPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "corner {} of loop {} (counted from 0)",
            self.corner, self.outline
        )
    }
}

/// An edge in a message.
struct EdgeName(LoopPlace);

impl fmt::Display for EdgeName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "edge {} of loop {}", self.0.corner, self.0.outline)
    }
}

/// A point in a message.
struct AtPoint(DVec2);

impl fmt::Display for AtPoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({}, {})", Readable(self.0.x), Readable(self.0.y))
    }
}
