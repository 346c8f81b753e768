//! `--dump`: the stages of a sweep as PLY files, for debugging.
//!
//! For each attempt, counted from 1, up to the stage that fails: `grazing-1.ply` has the grazing
//! segments as edges, `cycle-1-1.ply` the sampled surface of the first part, which crosses itself,
//! `arrangement-1-1.ply` its pieces with the winding numbers of both sides, and `region-1.ply` the
//! region. At the end, `sources.ply` has the result with what swept each triangle.

use super::elements::{coded, ply_head, write_position};
use crate::envelope::spatial::{Fold, Sheet};
use crate::io::{self, OutputError};
use crate::solid::spatial::{ArrangedFacet, Solid};
use crate::{Inspection, TriangleSource};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The files of one sweep.
pub(super) struct Dump {
    folder: PathBuf,
    progress: Mutex<Progress>,
}

#[derive(Default)]
struct Progress {
    attempt: usize,
    /// The first failure; nothing is written after it.
    failure: Option<OutputError>,
}

impl Dump {
    /// Files in the given folder, which is created when it is missing.
    pub(super) fn new(folder: &Path) -> Result<Dump, String> {
        std::fs::create_dir_all(folder).map_err(|error| {
            let folder = folder.display();
            format!("{folder}: no folder for the stages of the sweep: {error}")
        })?;
        Ok(Dump {
            folder: folder.to_path_buf(),
            progress: Mutex::default(),
        })
    }

    /// Writes a stage; a failure is kept for [`Dump::check`].
    pub(super) fn write(&self, stage: Inspection) {
        let mut progress = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        if progress.failure.is_some() {
            return;
        }
        if let Inspection::Grazing { .. } = stage {
            progress.attempt += 1;
        }
        let attempt = progress.attempt;
        let path = |name: &str| self.folder.join(format!("{name}-{attempt}.ply"));
        let path_of = |name: &str, part: usize| {
            let part = part + 1;
            self.folder.join(format!("{name}-{attempt}-{part}.ply"))
        };
        let written = match stage {
            Inspection::Grazing { sheets } => write_sheets(&path("grazing"), sheets),
            Inspection::Cycle { part, cycle } => {
                let path = path_of("cycle", part);
                io::write_mesh(&path, &cycle.positions, &cycle.triangles)
            }
            Inspection::Arrangement { part, facets } => {
                write_facets(&path_of("arrangement", part), facets)
            }
            Inspection::Region { solid } => {
                io::write_mesh(&path("region"), solid.positions(), solid.triangles())
            }
            Inspection::Sources { solid, sources } => {
                write_sources(&self.folder.join("sources.ply"), solid, sources)
            }
        };
        progress.failure = written.err();
    }

    /// An error if a stage could not be written.
    pub(super) fn check(&self) -> Result<(), OutputError> {
        let progress = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        progress.failure.clone().map_or(Ok(()), Err)
    }
}

/// Edges, with the source that swept each and the winding numbers that its sheet separates.
fn write_sheets(path: &Path, sheets: &[Sheet]) -> Result<(), OutputError> {
    let count = sheets.len();
    let edges = format!(
        "comment source: 0 an edge of the body, 1 a face, by its number; inner: 0 outer sheets, 1 inner ones\n\
         element edge {count}\nproperty int vertex1\nproperty int vertex2\nproperty int span\n\
         property uchar source\nproperty int number\nproperty uchar inner\n"
    );
    io::written(path, |out| {
        out.write_all(ply_head(2 * count, &edges).as_bytes())?;
        for end in sheets.iter().flat_map(|sheet| sheet.ends) {
            write_position(out, end)?;
        }
        for (i, sheet) in sheets.iter().enumerate() {
            let (source, number) = coded(sheet.source);
            let inner = u8::from(sheet.fold == Fold::Inner);
            let (a, b, span) = (2 * i, 2 * i + 1, sheet.span);
            writeln!(out, "{a} {b} {span} {source} {number} {inner}")?;
        }
        Ok(())
    })
}

/// Triangles with the winding numbers of both sides.
fn write_facets(path: &Path, facets: &[ArrangedFacet]) -> Result<(), OutputError> {
    let count = facets.len();
    let faces = format!(
        "element face {count}\nproperty list uchar int vertex_indices\n\
         property int in_front\nproperty int behind\n"
    );
    io::written(path, |out| {
        out.write_all(ply_head(3 * count, &faces).as_bytes())?;
        for corner in facets.iter().flat_map(|facet| facet.corners) {
            write_position(out, corner)?;
        }
        for (i, facet) in facets.iter().enumerate() {
            let [a, b, c] = [0, 1, 2].map(|corner| 3 * i + corner);
            writeln!(out, "3 {a} {b} {c} {} {}", facet.in_front, facet.behind)?;
        }
        Ok(())
    })
}

/// The triangles of the solid, with what swept each.
fn write_sources(
    path: &Path,
    solid: &Solid,
    sources: &[TriangleSource],
) -> Result<(), OutputError> {
    let faces = format!(
        "comment source: 0 an edge of the body, 1 a face that grazes, 2 a face at a time, by its number; 3 a repair\n\
         element face {}\nproperty list uchar int vertex_indices\nproperty uchar source\nproperty int number\n\
         property int span\nproperty double start\nproperty double end\n",
        sources.len()
    );
    io::written(path, |out| {
        out.write_all(ply_head(solid.positions().len(), &faces).as_bytes())?;
        for &position in solid.positions() {
            write_position(out, position)?;
        }
        for ([a, b, c], &source) in solid.triangles().iter().zip(sources) {
            write!(out, "3 {a} {b} {c} ")?;
            match source {
                TriangleSource::Sheet {
                    source,
                    span,
                    times: [start, end],
                } => {
                    let (kind, number) = coded(source);
                    writeln!(out, "{kind} {number} {span} {start} {end}")?;
                }
                TriangleSource::Cap { face, time } => writeln!(out, "2 {face} -1 {time} {time}")?,
                TriangleSource::Repair => writeln!(out, "3 -1 -1 0 0")?,
            }
        }
        Ok(())
    })
}
