//! What a sketch is read with, whether as a body or as lines: unit, size, flattening.

use super::super::drawing_error::DrawingError;
use super::super::units::Unit;
use super::sketch::{Figure, Sketch};
use super::{DrawingFormat, DrawingSettings};
use crate::numeric::tolerance::{FLATTENING, LARGEST_COORDINATE};
use glam::{DAffine2, DVec2};

/// A sketch in the unit of the result.
pub(super) struct Prepared {
    /// The unit of all lengths, where it is known.
    pub(super) unit: Option<Unit>,
    /// Diagonal of a box around all curves.
    pub(super) diagonal: f64,
    /// Distance allowed between curves and polylines.
    pub(super) flattening: f64,
    /// The same, or 0 when nothing is curved.
    pub(super) flattened: f64,
}

impl Prepared {
    /// Converts the lengths of a sketch, and measures it.
    pub(super) fn new(
        format: DrawingFormat,
        sketch: &mut Sketch,
        settings: &DrawingSettings,
    ) -> Result<Prepared, DrawingError> {
        let unit = settings
            .unit
            .or(sketch.declared.filter(|d| d.factor == 1.0).map(|d| d.unit));
        if let Some(asked) = settings.unit {
            let declared = sketch.declared.ok_or(DrawingError::UnknownUnit { asked })?;
            scale(&mut sketch.figures, declared.factor_to(asked));
        }
        let diagonal = diagonal(&sketch.figures)?.ok_or_else(|| DrawingError::Empty {
            expected: match format {
                DrawingFormat::Svg => "a path, rect, circle, ellipse, polygon, polyline or line",
                DrawingFormat::Dxf => {
                    "a LINE, ARC, CIRCLE, ELLIPSE, SPLINE, LWPOLYLINE or POLYLINE"
                }
            },
            found: if sketch.notes.is_empty() {
                "nothing of the kind".to_owned()
            } else {
                sketch.notes.join("; ")
            },
        })?;
        let curved = |figure: &Figure| {
            figure
                .paths
                .iter()
                .flat_map(|path| &path.curves)
                .any(|curve| !curve.is_straight())
        };
        let flattening = settings.flattening.unwrap_or(FLATTENING * diagonal);
        Ok(Prepared {
            unit,
            diagonal,
            flattening,
            flattened: if sketch.figures.iter().any(curved) {
                flattening
            } else {
                0.0
            },
        })
    }
}

/// The last note of a drawing that declares no unit.
pub(super) fn note_of_unit(sketch: &Sketch) -> Option<String> {
    let note = || "the file does not say which unit its lengths are in".to_owned();
    sketch.declared.is_none().then(note)
}

fn scale(figures: &mut [Figure], factor: f64) {
    let map = DAffine2::from_scale(DVec2::splat(factor));
    let curves = figures
        .iter_mut()
        .flat_map(|figure| &mut figure.paths)
        .flat_map(|path| &mut path.curves);
    curves.for_each(|curve| *curve = curve.transformed(&map));
}

/// The diagonal of a box around all curves; `None` when there are none.
fn diagonal(figures: &[Figure]) -> Result<Option<f64>, DrawingError> {
    let mut around: Option<[DVec2; 2]> = None;
    for figure in figures {
        for curve in figure.paths.iter().flat_map(|path| &path.curves) {
            let [low, high] = curve.bounds();
            for at in [low, high] {
                if !at.is_finite() || at.abs().max_element() > LARGEST_COORDINATE {
                    return Err(DrawingError::Coordinate {
                        figure: figure.place.clone(),
                        at,
                    });
                }
            }
            let [least, most] = around.unwrap_or([low, high]);
            around = Some([least.min(low), most.max(high)]);
        }
    }
    Ok(around.map(|[low, high]| low.distance(high)))
}
