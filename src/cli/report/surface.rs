//! What moves in space as it was read: a body, or a surface without an inside.

use super::BodyReport;
use super::quantities::counted;
use crate::body::Surface;
use crate::io::ReadReport;
use crate::numeric::Readable;
use std::fmt;

/// What moved: a body, or a surface alone.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(untagged)]
pub(crate) enum SubjectReport {
    /// The body that the triangles enclose.
    Body(BodyReport),
    /// The surface, without an inside.
    Surface(SurfaceReport),
}

/// A surface as it was read from a file.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct SurfaceReport {
    /// Number of triangles.
    pub(crate) triangles: usize,
    /// Area.
    pub(crate) area: f64,
    /// Whether it has no border.
    pub(crate) closed: bool,
    /// Number of vertices in the file that were joined with another one, within 1e-9 of the
    /// diagonal.
    pub(crate) welded: usize,
    /// Largest distance between places that were joined.
    pub(crate) largest_move: f64,
}

impl SurfaceReport {
    /// - `read`: what the reader did to `surface`.
    pub(crate) fn new(surface: &Surface, read: &ReadReport) -> SurfaceReport {
        let area = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|v| surface.positions()[v as usize]);
            0.5 * (b - a).cross(c - a).length()
        };
        SurfaceReport {
            triangles: surface.triangles().len(),
            area: surface.triangles().iter().map(area).sum(),
            closed: surface.closed(),
            welded: read.welded,
            largest_move: read.largest_move,
        }
    }
}

impl fmt::Display for SubjectReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SubjectReport::Body(body) => write!(f, "{body}"),
            SubjectReport::Surface(surface) => write!(f, "{surface}"),
        }
    }
}

impl fmt::Display for SurfaceReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let closed = if self.closed { "closed" } else { "open" };
        writeln!(
            f,
            "surface {}, area {}, {closed}",
            counted(self.triangles, "triangle"),
            Readable(self.area)
        )
    }
}
