//! The options that say how to read a drawing.

use std::path::{Path, PathBuf};

use crate::io::{DrawingSettings, Unit};
use clap::Args;

use super::positive;

/// Heading of the options for drawings.
pub(super) const DRAWINGS: &str = "Drawings (.svg, .dxf)";

#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct DrawingOptions {
    /// Unit to which lengths are converted from the one that the file declares: um, pt, mm, pc, cm,
    /// in, ft or m; default: lengths stay as they are in the file.
    #[arg(long, value_name = "UNIT", help_heading = DRAWINGS)]
    units: Option<Unit>,

    /// Longest gap in an outline that a straight line closes, in the body's units; default: open
    /// outlines are refused.
    #[arg(long, value_name = "LEN", help_heading = DRAWINGS, allow_hyphen_values = true, value_parser = gap)]
    close_gaps: Option<f64>,
}

/// An option for drawings was given with a body of another kind.
#[derive(Debug, PartialEq, thiserror::Error)]
#[error("{option} belongs to drawings (.svg, .dxf), but the body is {}: leave it out", .body.display())]
pub(crate) struct NoDrawing {
    option: &'static str,
    body: PathBuf,
}

impl NoDrawing {
    /// The error, unless the option is absent.
    pub(crate) fn unless(absent: bool, option: &'static str, body: &Path) -> Result<(), NoDrawing> {
        if absent {
            return Ok(());
        }
        let body = body.to_path_buf();
        Err(NoDrawing { option, body })
    }
}

impl DrawingOptions {
    /// The settings for the reader.
    pub(crate) fn settings(&self) -> DrawingSettings {
        DrawingSettings {
            unit: self.units,
            close_gaps: self.close_gaps,
            ..DrawingSettings::default()
        }
    }

    /// The unit that is asked for.
    pub(crate) fn unit(&self) -> Option<Unit> {
        self.units
    }

    /// Refuses the options when the body is no drawing.
    pub(crate) fn none_for(&self, body: &Path) -> Result<(), NoDrawing> {
        NoDrawing::unless(self.units.is_none(), "--units", body)?;
        NoDrawing::unless(self.close_gaps.is_none(), "--close-gaps", body)
    }
}

fn gap(text: &str) -> Result<f64, String> {
    positive(text, "leave it out to refuse open outlines")
}
