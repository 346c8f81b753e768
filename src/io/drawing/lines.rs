//! From figures to their lines, whatever these enclose.

use super::super::drawing_error::DrawingError;
use super::curve::Curve;
use super::prepared::{Prepared, note_of_unit};
use super::sketch::{Path, Sketch};
use super::{DrawingFormat, DrawingSettings, LineDrawing};
use crate::body::Polylines;
use crate::numeric::Readable;
use crate::numeric::tolerance::{JOIN_DISTANCE, WELD_DISTANCE};
use crate::surface::weld;
use glam::DVec2;

/// Most corners of all polylines together: the work on them takes a few GB of memory.
const MOST_CORNERS: usize = 10_000_000;

/// The lines of all figures of a file, filled or not.
///
/// Ends within [`JOIN_DISTANCE`] of the diagonal of each other become one place, so that no gap is
/// left open between what their lines sweep.
pub(in crate::io) fn line_drawing(
    format: DrawingFormat,
    mut sketch: Sketch,
    settings: &DrawingSettings,
) -> Result<LineDrawing, DrawingError> {
    let prepared = Prepared::new(format, &mut sketch, settings)?;
    let mut notes = std::mem::take(&mut sketch.notes);
    let distance = JOIN_DISTANCE * prepared.diagonal;
    let mut corners = 0;
    let mut lines: Vec<Vec<DVec2>> = Vec::new();
    for figure in &sketch.figures {
        for path in &figure.paths {
            let mut line = Vec::new();
            for curve in curves(path) {
                if line.is_empty() {
                    line.push(curve.ends()[0]);
                }
                if !curve.flatten(prepared.flattening, MOST_CORNERS - corners, &mut line) {
                    return Err(DrawingError::TooFine {
                        figure: figure.place.clone(),
                        flattening: prepared.flattening,
                        limit: MOST_CORNERS,
                    });
                }
            }
            corners += line.len();
            lines.push(line);
        }
    }
    lines.retain(|line| line.len() > 1);
    let largest_move = join_ends(&mut lines, distance);
    // A move that is only rounding in the file needs no note.
    if largest_move > WELD_DISTANCE * prepared.diagonal {
        notes.push(format!(
            "ends of curves up to {} apart have been joined",
            Readable(largest_move)
        ));
    }
    // Short lines end where they begin now, and have no length.
    let found = lines.len();
    lines.retain(|line| line.iter().any(|&corner| corner != line[0]));
    if lines.len() < found {
        let (tiny, short) = (found - lines.len(), Readable(distance));
        let curves = if tiny == 1 { "curve" } else { "curves" };
        notes.push(format!("left out: {tiny} {curves} shorter than {short}"));
    }
    notes.extend(note_of_unit(&sketch));
    Ok(LineDrawing {
        lines: Polylines::new(lines)?,
        format,
        declared: sketch.declared,
        unit: prepared.unit,
        flattening: prepared.flattened,
        joined: largest_move,
        notes,
    })
}

/// The curves of a path, with the line that closes it.
fn curves(path: &Path) -> Vec<Curve> {
    let mut curves = path.curves.clone();
    if let (true, Some(first), Some(last)) = (path.closed, curves.first(), curves.last()) {
        let [start, end] = [first.ends()[0], last.ends()[1]];
        if start != end {
            curves.push(Curve::Line([end, start]));
        }
    }
    curves
}

/// Moves ends of lines that are near each other to one place; the largest move.
fn join_ends(lines: &mut [Vec<DVec2>], distance: f64) -> f64 {
    let ends = |line: &Vec<DVec2>| [line[0], line[line.len() - 1]];
    let points: Vec<_> = lines.iter().flat_map(ends).map(|p| p.extend(0.0)).collect();
    let welded = weld(&points, &[], distance);
    for (line, places) in lines.iter_mut().zip(welded.place_of.chunks(2)) {
        let last = line.len() - 1;
        for (corner, &place) in [0, last].into_iter().zip(places) {
            line[corner] = welded.positions[place as usize].truncate();
        }
    }
    welded.largest_move
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::{DrawingFormat, DrawingSettings, parse_lines};

    fn read(elements: &str) -> LineDrawing {
        let text = format!("<svg xmlns='http://www.w3.org/2000/svg'>{elements}</svg>");
        parse_lines(
            DrawingFormat::Svg,
            text.as_bytes(),
            &DrawingSettings::default(),
        )
        .expect("lines")
    }

    #[test]
    fn open_paths_filled_figures_and_crossings_are_lines() {
        let drawing = read("<path d='M0,0 L4,0 L4,3 M0,1 L4,1'/><rect width='2' height='2'/>");
        let lines = &drawing.lines;
        assert_eq!((lines.lines().len(), lines.closed()), (3, 1), "{lines:?}");
        assert_eq!(lines.length(), 7.0 + 4.0 + 8.0, "{lines:?}");
        assert_eq!(drawing.flattening, 0.0, "nothing is curved");
    }

    #[test]
    fn ends_near_each_other_become_one() {
        let drawing =
            read("<path d='M0,0 L4,0'/><path d='M4.00001,0 L4,3'/><path d='M9,9 L9,9.00001'/>");
        let lines = drawing.lines.lines();
        assert_eq!(lines.len(), 2, "the tiny one is left out: {lines:?}");
        assert_eq!(lines[0][1], lines[1][0], "one place");
        let notes = drawing.notes.join("; ");
        assert!(
            notes.contains("joined") && notes.contains("left out: 1 curve"),
            "{notes}"
        );
    }
}
