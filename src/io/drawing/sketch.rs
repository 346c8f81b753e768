//! What a reader of a drawing format finds in a file.

use super::curve::Curve;
use super::error::FigurePlace;
use super::units::DeclaredUnit;
use crate::body::FillRule;

/// All figures of a file, in its order.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::io) struct Sketch {
    pub(in crate::io) figures: Vec<Figure>,
    pub(in crate::io) declared: Option<DeclaredUnit>,
    /// What was left out, and why.
    pub(in crate::io) notes: Vec<String>,
}

/// An element of an SVG or an entity of a DXF.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::io) struct Figure {
    pub(in crate::io) place: FigurePlace,
    pub(in crate::io) paths: Vec<Path>,
    /// The rule by which its closed paths are filled; `None`: they are outlines.
    pub(in crate::io) fill: Option<FillRule>,
}

/// Curves each of which begins where the one before ends.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::io) struct Path {
    pub(in crate::io) curves: Vec<Curve>,
    /// Whether the file says that it is closed: if need be, by a line from its end to its start.
    pub(in crate::io) closed: bool,
}
