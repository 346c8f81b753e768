//! What moves in the plane as it was read: a body, or lines without an inside.

use super::quantities::counted;
use crate::body::Polygon;
use crate::io::{Drawing, LineDrawing};
use crate::numeric::Readable;
use std::fmt;

/// What moved: a body, or lines alone.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(untagged)]
pub(crate) enum PlanarSubjectReport {
    /// The body that the outlines enclose.
    Body(PlanarBodyReport),
    /// The lines, without an inside.
    Lines(LinesReport),
}

/// A body in the plane as it was read from a drawing.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct PlanarBodyReport {
    /// Number of vertices, and of edges.
    pub(crate) vertices: usize,
    /// Area, above 0.
    pub(crate) area: f64,
    /// Length of all outlines.
    pub(crate) perimeter: f64,
    /// Number of pieces.
    pub(crate) pieces: usize,
    /// Number of holes.
    pub(crate) holes: usize,
    /// Largest distance between the curves of the drawing and the edges that replace them; 0
    /// without curves.
    pub(crate) flattening: f64,
    /// Largest distance by which an end of a curve was moved to join another one.
    pub(crate) joined: f64,
    /// The unit that the file declares, such as `mm` or `0.1 mm`.
    pub(crate) declared_units: Option<String>,
    /// The unit of all lengths of the report, where it is known.
    pub(crate) units: Option<String>,
    /// What was left out or joined, and what the file does not say.
    pub(crate) notes: Vec<String>,
}

/// Lines as they were read from a drawing.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct LinesReport {
    /// Number of lines, each of them one run of edges.
    pub(crate) lines: usize,
    /// How many of them end where they begin.
    pub(crate) closed: usize,
    /// Number of straight edges.
    pub(crate) edges: usize,
    /// Length of all lines.
    pub(crate) length: f64,
    /// Largest distance between the curves of the drawing and the edges that replace them; 0
    /// without curves.
    pub(crate) flattening: f64,
    /// Largest distance by which an end of a curve was moved onto another one.
    pub(crate) joined: f64,
    /// The unit that the file declares, such as `mm` or `0.1 mm`.
    pub(crate) declared_units: Option<String>,
    /// The unit of all lengths of the report, where it is known.
    pub(crate) units: Option<String>,
    /// What was left out or joined, and what the file does not say.
    pub(crate) notes: Vec<String>,
}

impl PlanarBodyReport {
    /// The body of a drawing.
    pub(crate) fn new(drawing: &Drawing) -> PlanarBodyReport {
        let polygon: &Polygon = &drawing.polygon;
        PlanarBodyReport {
            vertices: polygon.edge_count(),
            area: polygon.area(),
            perimeter: polygon.perimeter(),
            pieces: polygon.pieces(),
            holes: polygon.holes(),
            flattening: drawing.flattening,
            joined: drawing.joined,
            declared_units: drawing.declared.map(|declared| declared.to_string()),
            units: drawing.unit.map(|unit| unit.to_string()),
            notes: drawing.notes.clone(),
        }
    }
}

impl LinesReport {
    /// The lines of a drawing.
    pub(crate) fn new(drawing: &LineDrawing) -> LinesReport {
        LinesReport {
            lines: drawing.lines.lines().len(),
            closed: drawing.lines.closed(),
            edges: drawing.lines.edge_count(),
            length: drawing.lines.length(),
            flattening: drawing.flattening,
            joined: drawing.joined,
            declared_units: drawing.declared.map(|declared| declared.to_string()),
            units: drawing.unit.map(|unit| unit.to_string()),
            notes: drawing.notes.clone(),
        }
    }
}

impl PlanarSubjectReport {
    pub(super) fn write(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PlanarSubjectReport::Body(body) => body.write(f, "body"),
            PlanarSubjectReport::Lines(lines) => lines.write(f),
        }
    }
}

impl PlanarBodyReport {
    pub(super) fn write(&self, f: &mut fmt::Formatter<'_>, name: &str) -> fmt::Result {
        writeln!(
            f,
            "{name:<7} {}, area {}, {}, {}",
            counted(self.vertices, "vertex"),
            Readable(self.area),
            counted(self.pieces, "piece"),
            counted(self.holes, "hole")
        )?;
        write_units(f, &self.units, &self.declared_units)?;
        self.notes
            .iter()
            .try_for_each(|note| writeln!(f, "        note: {note}"))
    }
}

impl LinesReport {
    fn write(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "lines   {}, {} closed, {}, length {}",
            counted(self.lines, "line"),
            self.closed,
            counted(self.edges, "edge"),
            Readable(self.length)
        )?;
        write_units(f, &self.units, &self.declared_units)?;
        self.notes
            .iter()
            .try_for_each(|note| writeln!(f, "        note: {note}"))
    }
}

/// Writes the unit of all lengths, as far as it is known.
fn write_units(
    f: &mut fmt::Formatter<'_>,
    units: &Option<String>,
    declared: &Option<String>,
) -> fmt::Result {
    match (units, declared) {
        (Some(units), Some(declared)) if units == declared => {
            writeln!(f, "        lengths in {units}")
        }
        (Some(units), Some(declared)) => {
            writeln!(
                f,
                "        lengths in {units}, changed from those of the file ({declared})"
            )
        }
        (None, Some(declared)) => writeln!(f, "        one length of the file is {declared}"),
        (_, None) => Ok(()),
    }
}
