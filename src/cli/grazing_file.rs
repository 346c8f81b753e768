//! `--grazing`: where the body grazes, span by span, as a table or as an OBJ of points and lines.
//!
//! Coordinates are the body's own, so that the file lies on the body; spans, vertices and faces
//! count from 0, the latter two as the file of the body does.

use super::elements::{word_for, write_obj_position};
use crate::body::{Mesh, Polygon};
use crate::grazing::{self, Fold, SpanGrazing, planar};
use crate::io::{self, FileNumbers, OutputError};
use crate::motion::{self, Motion};
use glam::DVec3;
use std::io::Write;
use std::path::Path;

/// Extensions that can be written.
const KNOWN: &[&str] = &[".csv", ".obj"];

/// The columns of a table in space. A point has an edge and the face whose flux is zero there; a
/// segment has an edge or a face, and two ends.
const COLUMNS: [&str; 11] = [
    "span", "kind", "edge", "face", "fold", "x", "y", "z", "end_x", "end_y", "end_z",
];

/// The columns of a table in the plane: a point is a corner, or inside the edge that begins at the
/// corner of the same number.
const PLANAR_COLUMNS: [&str; 6] = ["span", "corner", "edge", "fold", "x", "y"];

/// Checks that such a file can be written, before anything is computed.
pub(super) fn check(path: &Path) -> Result<(), OutputError> {
    io::check_kind(path, KNOWN).map(drop)
}

/// Writes where a mesh grazes.
pub(super) fn write(
    path: &Path,
    body: &Mesh,
    numbers: &FileNumbers,
    motion: &Motion,
) -> Result<(), OutputError> {
    let spans = grazing::of(body, motion);
    if io::check_kind(path, KNOWN)? == "csv" {
        return io::write_table(path, COLUMNS, rows(&spans, body, numbers));
    }
    let of_span = |grazing: &SpanGrazing| Drawn {
        points: grazing.points.iter().map(|at| at.point).collect(),
        segments: grazing.segments.iter().map(|s| (s.fold, s.ends)).collect(),
    };
    let drawn: Vec<Drawn> = spans.iter().map(of_span).collect();
    write_obj(path, &drawn)
}

/// Writes where outlines graze.
pub(super) fn write_planar(
    path: &Path,
    body: &Polygon,
    motion: &motion::planar::Motion,
) -> Result<(), OutputError> {
    let spans = planar::of(body, motion);
    if io::check_kind(path, KNOWN)? == "csv" {
        let row = |(span, at): (usize, &planar::GrazingPoint)| {
            let (corner, edge) = columns_of(at.source);
            let [x, y] = at.point.to_array().map(|x| x.to_string());
            let fold = word_for(at.fold).to_owned();
            [span.to_string(), corner, edge, fold, x, y]
        };
        let points = spans.iter().enumerate();
        let points =
            points.flat_map(|(span, grazing)| grazing.points.iter().map(move |p| (span, p)));
        return io::write_table(path, PLANAR_COLUMNS, points.map(row));
    }
    let of_span = |grazing: &planar::SpanGrazing| Drawn {
        points: grazing.points.iter().map(|p| p.point.extend(0.0)).collect(),
        segments: Vec::new(),
    };
    let drawn: Vec<Drawn> = spans.iter().map(of_span).collect();
    write_obj(path, &drawn)
}

/// The columns `corner` and `edge` of a part of a polygon, one of which is empty.
pub(super) fn columns_of(source: planar::Source) -> (String, String) {
    match source {
        planar::Source::Corner(corner) => (corner.to_string(), String::new()),
        planar::Source::Edge(edge) => (String::new(), edge.to_string()),
    }
}

fn rows<'a>(
    spans: &'a [SpanGrazing],
    body: &'a Mesh,
    numbers: &'a FileNumbers,
) -> impl Iterator<Item = [String; 11]> + 'a {
    let edge = |edge: u32| {
        let [from, to] = body.edges()[edge as usize].vertices;
        format!("{}-{}", numbers.vertex(from), numbers.vertex(to))
    };
    let face = |face: u32| numbers.face(face).to_string();
    let row = |span: usize, kind: &str, parts: [String; 3], ends: [Option<DVec3>; 2]| {
        let [x, y, z, end_x, end_y, end_z] = numbers_of(ends);
        let [edge, face, fold] = parts;
        let (span, kind) = (span.to_string(), kind.to_owned());
        [span, kind, edge, face, fold, x, y, z, end_x, end_y, end_z]
    };
    spans.iter().enumerate().flat_map(move |(span, grazing)| {
        let points = grazing.points.iter().map(move |at| {
            let parts = [edge(at.edge), face(at.face), String::new()];
            row(span, "point", parts, [Some(at.point), None])
        });
        let segments = grazing.segments.iter().map(move |segment| {
            let fold = word_for(segment.fold).to_owned();
            let parts = match segment.source {
                grazing::Source::Edge(number) => [edge(number), String::new(), fold],
                grazing::Source::Face(number) => [String::new(), face(number), fold],
            };
            row(span, "segment", parts, segment.ends.map(Some))
        });
        points.chain(segments)
    })
}

fn numbers_of(ends: [Option<DVec3>; 2]) -> [String; 6] {
    let [a, b] =
        ends.map(|end| end.map_or_else(Default::default, |p| p.to_array().map(|x| x.to_string())));
    let ([x, y, z], [end_x, end_y, end_z]) = (a, b);
    [x, y, z, end_x, end_y, end_z]
}

/// What is drawn of a span.
struct Drawn {
    points: Vec<DVec3>,
    segments: Vec<(Fold, [DVec3; 2])>,
}

/// Groups of points and of lines, per span.
fn write_obj(path: &Path, spans: &[Drawn]) -> Result<(), OutputError> {
    io::written(path, |out| {
        writeln!(
            out,
            "# steadysweep: where the body grazes, in its own coordinates"
        )?;
        let mut first = 1;
        for (span, drawn) in spans.iter().enumerate() {
            if !drawn.points.is_empty() {
                writeln!(out, "g span_{span}_points")?;
            }
            for &point in &drawn.points {
                write_obj_position(out, point)?;
                writeln!(out, "p {first}")?;
                first += 1;
            }
            for fold in [Fold::Outer, Fold::Inner] {
                let segments = drawn.segments.iter().filter(|(of, _)| *of == fold);
                for (place, (_, ends)) in segments.enumerate() {
                    if place == 0 {
                        writeln!(out, "g span_{span}_{}", word_for(fold))?;
                    }
                    for &end in ends {
                        write_obj_position(out, end)?;
                    }
                    writeln!(out, "l {first} {}", first + 1)?;
                    first += 2;
                }
            }
        }
        Ok(())
    })
}
