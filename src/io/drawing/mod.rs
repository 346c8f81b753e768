//! Drawings: the outlines of planar bodies, from SVG and DXF files.
//!
//! A reader of a format gives [`Figure`]s: curves as they stand in the file, and the rule by which
//! they are filled, if they are. Curves become polylines within a stated distance; those whose ends
//! meet become loops; and the loops enclose the body.

mod curve;
mod joining;
mod lines;
mod outline;
mod prepared;
mod sketch;
mod spline;

pub(super) use curve::Curve;
pub(super) use lines::line_drawing;
pub(super) use outline::drawing;
pub(super) use sketch::{Figure, LeftOut, Path, Sketch};
pub(super) use spline::{Spline, SplineEnds, spline};

use super::units::{DeclaredUnit, Unit};
use crate::body::{Polygon, Polylines};

/// File formats of drawings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum DrawingFormat {
    /// Scalable Vector Graphics.
    Svg,
    /// Drawing Exchange Format, as text.
    Dxf,
}

/// How to read a drawing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DrawingSettings {
    /// Distance allowed between a curve and the polyline that replaces it, in the unit of the
    /// result; `None`: 1e-4 of the diagonal of the drawing. The number of corners grows as one over
    /// its square root.
    pub flattening: Option<f64>,
    /// Unit to which lengths are converted; `None`: lengths stay as they are in the file.
    pub unit: Option<Unit>,
    /// Longest gap between open ends that a straight line closes, in the unit of the result;
    /// `None`: none is closed.
    pub close_gaps: Option<f64>,
}

/// A planar body from a drawing, and how it was read.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Drawing {
    /// The body: x and y as in the file.
    pub polygon: Polygon,
    /// Format of the file.
    pub format: DrawingFormat,
    /// The unit that the file declares; `None` when it declares none.
    pub declared: Option<DeclaredUnit>,
    /// The unit of the lengths of `polygon`, where it is known and one length is one unit.
    pub unit: Option<Unit>,
    /// Largest distance between curves and the edges that replace them; 0 when nothing in the
    /// drawing is curved.
    pub flattening: f64,
    /// Largest distance by which an end of a curve was moved to join another one.
    pub joined: f64,
    /// What the user should know: what was left out or joined, or what the file does not say.
    pub notes: Vec<String>,
}

/// The lines of a drawing, without an inside, and how they were read.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct LineDrawing {
    /// The lines: x and y as in the file.
    pub lines: Polylines,
    /// Format of the file.
    pub format: DrawingFormat,
    /// The unit that the file declares; `None` when it declares none.
    pub declared: Option<DeclaredUnit>,
    /// The unit of the lengths of `lines`, where it is known and one length is one unit.
    pub unit: Option<Unit>,
    /// Largest distance between curves and the edges that replace them; 0 when nothing in the
    /// drawing is curved.
    pub flattening: f64,
    /// Largest distance by which an end of a curve was moved onto another one.
    pub joined: f64,
    /// What the user should know: what was left out or joined, or what the file does not say.
    pub notes: Vec<String>,
}
