//! Drawings: the outlines of planar bodies, from SVG and DXF files.
//!
//! A reader of a format gives [`Figure`]s: curves as they stand in the file, and for those that are filled, by which rule.
//! Curves become polylines within a stated distance; those whose ends meet become loops; and what the loops enclose is the body.

mod curve;
mod joining;
mod outline;
mod sketch;
mod spline;

pub(super) use curve::Curve;
pub(super) use outline::drawing;
pub(super) use sketch::{Figure, LeftOut, Path, Sketch};
pub(super) use spline::{Spline, SplineEnds, spline};

use super::units::{DeclaredUnit, Unit};
use crate::body::Polygon;

/// File formats of drawings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum DrawingFormat {
    /// Scalable Vector Graphics.
    Svg,
    /// Drawing Exchange Format, as text.
    Dxf,
}

/// How a drawing is to be read.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DrawingSettings {
    /// Distance allowed between a curve and the polyline in its place, in the unit of the result; `None`: 1e-4 of the diagonal of
    /// the drawing. The number of corners grows as 1 / sqrt of it.
    pub flattening: Option<f64>,
    /// Unit to which lengths are changed; `None`: lengths stay as the file has them.
    pub unit: Option<Unit>,
    /// Longest gap between open ends that is closed by a straight line, in the unit of the result; `None`: no gap is.
    pub close_gaps: Option<f64>,
}

/// A planar body from a drawing, and what reading did.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Drawing {
    /// The body: x and y as in the file.
    pub polygon: Polygon,
    /// Format of the file.
    pub format: DrawingFormat,
    /// The unit that the file declares; `None` when it does not.
    pub declared: Option<DeclaredUnit>,
    /// The unit of the lengths of `polygon`, where that is known and not a multiple of one.
    pub unit: Option<Unit>,
    /// Distance within which curves and the edges in their place are of each other; 0 when nothing in the drawing is curved.
    pub flattening: f64,
    /// Largest distance by which an end of a curve was moved to join another one.
    pub joined: f64,
    /// What the user should know: what was left out, joined, or not said in the file.
    pub notes: Vec<String>,
}
