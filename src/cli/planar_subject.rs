//! What moves in the plane: the body of a drawing, or with `--surface` its lines alone.

use super::options::SweepOptions;
use super::report::{LinesReport, PlanarBodyReport, PlanarSubjectReport};
use crate::bounds::rectangle_corners;
use crate::io::{self, DeclaredUnit, DrawingFormat, DrawingSettings, InputError, Unit};
use crate::motion::planar::Motion;
use crate::numeric::tolerance::DEFAULT_TOLERANCE;
use crate::planar::{Sweep, SweepError, SweepSettings, sweep, sweep_lines};
use glam::DVec2;

pub(super) enum PlanarSubject {
    Body(io::Drawing),
    Lines(io::LineDrawing),
}

impl PlanarSubject {
    pub(super) fn read(
        options: &SweepOptions,
        settings: &DrawingSettings,
    ) -> Result<PlanarSubject, InputError> {
        if options.surface {
            io::read_lines(&options.body, settings).map(PlanarSubject::Lines)
        } else {
            io::read_drawing(&options.body, settings).map(PlanarSubject::Body)
        }
    }

    /// Corners of a rectangle that contains it however finely its curves are replaced by edges; the
    /// first two are opposite.
    pub(super) fn room(&self) -> Vec<DVec2> {
        let [low, high] = match self {
            PlanarSubject::Body(drawing) => drawing.polygon.bounds(),
            PlanarSubject::Lines(drawing) => drawing.lines.bounds(),
        };
        let room = DVec2::splat(DEFAULT_TOLERANCE * low.distance(high));
        let [low, high] = [low - room, high + room];
        rectangle_corners([low, high]).to_vec()
    }

    pub(super) fn sweep(
        &self,
        motion: &Motion,
        settings: &SweepSettings,
    ) -> Result<Sweep, SweepError> {
        match self {
            PlanarSubject::Body(drawing) => sweep(&drawing.polygon, motion, settings),
            PlanarSubject::Lines(drawing) => sweep_lines(&drawing.lines, motion, settings),
        }
    }

    pub(super) fn format(&self) -> DrawingFormat {
        match self {
            PlanarSubject::Body(drawing) => drawing.format,
            PlanarSubject::Lines(drawing) => drawing.format,
        }
    }

    pub(super) fn unit(&self) -> Option<Unit> {
        match self {
            PlanarSubject::Body(drawing) => drawing.unit,
            PlanarSubject::Lines(drawing) => drawing.unit,
        }
    }

    pub(super) fn declared(&self) -> Option<DeclaredUnit> {
        match self {
            PlanarSubject::Body(drawing) => drawing.declared,
            PlanarSubject::Lines(drawing) => drawing.declared,
        }
    }

    /// Largest distance between curves and the edges that replace them.
    pub(super) fn flattening(&self) -> f64 {
        match self {
            PlanarSubject::Body(drawing) => drawing.flattening,
            PlanarSubject::Lines(drawing) => drawing.flattening,
        }
    }

    /// Closed loops that show it, in its own frame: for lines, along each of them and back.
    pub(super) fn loops(&self) -> Vec<Vec<DVec2>> {
        let polygon = match self {
            PlanarSubject::Body(drawing) => &drawing.polygon,
            PlanarSubject::Lines(drawing) => &drawing.lines.both_sides().polygon,
        };
        let place = |&corner: &u32| polygon.positions()[corner as usize];
        let loops = polygon.loops().iter();
        loops
            .map(|outline| outline.iter().map(place).collect())
            .collect()
    }

    pub(super) fn report(&self) -> PlanarSubjectReport {
        match self {
            PlanarSubject::Body(drawing) => {
                PlanarSubjectReport::Body(PlanarBodyReport::new(drawing))
            }
            PlanarSubject::Lines(drawing) => PlanarSubjectReport::Lines(LinesReport::new(drawing)),
        }
    }
}
