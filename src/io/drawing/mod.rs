//! Drawings: the outlines of planar bodies, from SVG and DXF files.
//!
//! A reader of a format gives [`Figure`]s: curves as they stand in the file, and for those that are filled, by which rule.
//! Curves become polylines within a stated distance; those whose ends meet become loops; and what the loops enclose is the body.

mod curve;
mod error;
mod joining;
mod outline;
mod sketch;
mod spline;
mod units;

pub use error::{DrawingError, FigurePlace, OpenEnd, UnsupportedKind};
pub use units::{DeclaredUnit, Unit};

pub(super) use curve::Curve;
pub(super) use error::refuse_unsupported;
pub(super) use sketch::{Figure, LeftOut, Path, Sketch};
pub(super) use spline::{Spline, SplineEnds, spline};

use super::error::{InputError, InputProblem};
use super::mesh_file::{extension, read_bytes};
use super::{dxf, svg};
use crate::body::Polygon;
use std::path::Path as FilePath;

/// File formats of drawings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum DrawingFormat {
    /// Scalable Vector Graphics.
    Svg,
    /// Drawing Exchange Format, as text.
    Dxf,
}

/// Extensions of drawings that can be read.
const KNOWN: &[&str] = &[".svg", ".dxf"];

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

/// The format of a drawing by the extension of its name, in any case of letters; `None` for other files.
pub fn drawing_format(path: &FilePath) -> Option<DrawingFormat> {
    match extension(path).as_deref() {
        Some("svg") => Some(DrawingFormat::Svg),
        Some("dxf") => Some(DrawingFormat::Dxf),
        _ => None,
    }
}

/// Reads a planar body from an SVG or DXF file.
///
/// - **SVG**: lengths are user units inside the viewBox, y as in the file. Each filled element is what its fill rule says, and the body is the
///   union of them; elements without fill, and open paths, are outlines, with holes by nesting.
/// - **DXF**: lines, arcs and curves are outlines, with holes by nesting.
///
/// Ends of curves within 1e-5 of the diagonal are joined; curves that are drawn twice count once. What is not part of an outline
/// by its nature (texts, dimensions, metadata) is left out with a note.
///
/// # Errors
/// [`InputError`] with the place in the file: open or crossing outlines, an empty drawing, figures that cannot be read.
///
/// # Cost
/// O(n log n) for n corners.
pub fn read_drawing(path: &FilePath, settings: &DrawingSettings) -> Result<Drawing, InputError> {
    let read = || {
        let format = drawing_format(path).ok_or_else(|| InputProblem::UnknownExtension {
            found: extension(path),
            known: KNOWN,
        })?;
        parse_drawing(format, &read_bytes(path)?, settings)
    };
    read().map_err(|problem| InputError::new(path, problem))
}

/// Reads a planar body from the bytes of a drawing; see [`read_drawing`].
///
/// # Errors
/// [`InputProblem`] with the place in the bytes.
pub fn parse_drawing(
    format: DrawingFormat,
    bytes: &[u8],
    settings: &DrawingSettings,
) -> Result<Drawing, InputProblem> {
    let sketch = match format {
        DrawingFormat::Svg => svg::read(bytes)?,
        DrawingFormat::Dxf => dxf::read(bytes)?,
    };
    Ok(outline::drawing(format, sketch, settings)?)
}
