//! Drawings from files; the extension of the name chooses the reader.

use super::drawing::{
    Drawing, DrawingFormat, DrawingSettings, LineDrawing, Sketch, drawing, line_drawing,
};
use super::error::{InputError, InputProblem};
use super::file::{extension, read_bytes};
use super::{dxf, svg};
use std::path::Path;

/// Extensions of the drawings that can be read.
const KNOWN: &[&str] = &[".svg", ".dxf"];

/// The format of a drawing by the extension of its name, in upper or lower case; `None` for other
/// files.
pub fn drawing_format(path: &Path) -> Option<DrawingFormat> {
    match extension(path).as_deref() {
        Some("svg") => Some(DrawingFormat::Svg),
        Some("dxf") => Some(DrawingFormat::Dxf),
        _ => None,
    }
}

/// Reads a planar body from an SVG or DXF file.
///
/// - **SVG**: lengths are user units inside the viewBox, y as in the file. Each filled element is
///   what its fill rule says, and the body is the union of them; elements without fill, and open
///   paths, are outlines, with holes by nesting.
/// - **DXF**: lines, arcs and curves are outlines, with holes by nesting.
///
/// Ends of curves within 1e-5 of the diagonal of each other are joined; curves that are drawn twice
/// count once. What is by its nature no part of an outline (texts, dimensions, metadata) is left
/// out with a note.
///
/// # Errors
/// [`InputError`] with the place in the file: open or crossing outlines, an empty drawing, figures
/// that cannot be read.
///
/// # Cost
/// O(n log n) for n corners.
pub fn read_drawing(path: &Path, settings: &DrawingSettings) -> Result<Drawing, InputError> {
    let read = || parse_drawing(format_of(path)?, &read_bytes(path)?, settings);
    read().map_err(|problem| InputError::new(path, problem))
}

/// Reads a planar body from the bytes of a drawing; see [`read_drawing`].
///
/// # Errors
/// [`InputProblem`] with the place in the bytes.
///
/// # Example
/// ```
/// use std::f64::consts::PI;
/// use steadysweep::io::{DrawingFormat, DrawingSettings, parse_drawing};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let text = "<svg xmlns='http://www.w3.org/2000/svg'><circle r='5'/></svg>";
/// let settings = DrawingSettings { flattening: Some(1e-3), ..Default::default() };
/// let drawing = parse_drawing(DrawingFormat::Svg, text.as_bytes(), &settings)?;
/// assert!((drawing.polygon.area() - 25.0 * PI).abs() < drawing.polygon.perimeter() * 1e-3);
/// # Ok(())
/// # }
/// ```
pub fn parse_drawing(
    format: DrawingFormat,
    bytes: &[u8],
    settings: &DrawingSettings,
) -> Result<Drawing, InputProblem> {
    Ok(drawing(format, sketch(format, bytes)?, settings)?)
}

/// Reads the lines of an SVG or DXF file, whatever they enclose: paths may be open and may cross,
/// and of filled elements the outlines count.
///
/// Ends of curves within 1e-5 of the diagonal of each other become one; `close_gaps` of the settings
/// does not apply.
///
/// # Errors
/// [`InputError`] with the place in the file: an empty drawing, figures that cannot be read.
///
/// # Cost
/// O(n) expected, for n corners.
pub fn read_lines(path: &Path, settings: &DrawingSettings) -> Result<LineDrawing, InputError> {
    let read = || parse_lines(format_of(path)?, &read_bytes(path)?, settings);
    read().map_err(|problem| InputError::new(path, problem))
}

/// Reads the lines of a drawing from its bytes; see [`read_lines`].
///
/// # Errors
/// [`InputProblem`] with the place in the bytes.
pub fn parse_lines(
    format: DrawingFormat,
    bytes: &[u8],
    settings: &DrawingSettings,
) -> Result<LineDrawing, InputProblem> {
    Ok(line_drawing(format, sketch(format, bytes)?, settings)?)
}

fn sketch(format: DrawingFormat, bytes: &[u8]) -> Result<Sketch, InputProblem> {
    match format {
        DrawingFormat::Svg => svg::read(bytes),
        DrawingFormat::Dxf => dxf::read(bytes),
    }
}

fn format_of(path: &Path) -> Result<DrawingFormat, InputProblem> {
    drawing_format(path).ok_or_else(|| InputProblem::UnknownExtension {
        found: extension(path),
        known: KNOWN,
    })
}
