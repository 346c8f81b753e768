//! `--envelope`: the untrimmed envelope, sampled within the tolerance: triangles in space, curves in
//! the plane.

use super::elements::{coded, ply_head, word_for, write_obj_position, write_position};
use super::grazing_file::columns_of;
use crate::envelope::planar::SampledCurve;
use crate::envelope::spatial::SampledEnvelope;
use crate::grazing::Fold;
use crate::io::{self, OutputError, RegionPicture, RegionSubject};
use crate::motion::planar::Motion;
use std::io::Write;
use std::path::Path;

/// Extensions that can be written in space.
const SPATIAL: &[&str] = &[".obj", ".ply"];

/// Extensions that can be written in the plane.
const PLANAR: &[&str] = &[".svg", ".csv"];

/// The columns of a table: the points of each curve, with its source, its time on the clock, and
/// the normal towards the lower winding number; that of a point that rests is left empty.
const COLUMNS: [&str; 10] = [
    "curve", "span", "corner", "edge", "fold", "time", "x", "y", "normal_x", "normal_y",
];

/// Checks that an envelope in space can be written, before anything is computed.
pub(super) fn check(path: &Path) -> Result<(), OutputError> {
    io::check_kind(path, SPATIAL).map(drop)
}

/// Checks that an envelope in the plane can be written, before anything is computed.
pub(super) fn check_planar(path: &Path) -> Result<(), OutputError> {
    io::check_kind(path, PLANAR).map(drop)
}

/// Writes an envelope in space.
pub(super) fn write(path: &Path, envelope: &SampledEnvelope) -> Result<(), OutputError> {
    if io::check_kind(path, SPATIAL)? == "obj" {
        write_obj(path, envelope)
    } else {
        write_ply(path, envelope)
    }
}

/// A group of triangles per span and fold.
fn write_obj(path: &Path, envelope: &SampledEnvelope) -> Result<(), OutputError> {
    let sheet = |triangle: usize| &envelope.sheets[envelope.sheet[triangle] as usize];
    let group = |triangle: usize| {
        let sheet = sheet(triangle);
        (sheet.span, sheet.fold == Fold::Inner)
    };
    let mut order: Vec<usize> = (0..envelope.triangles.len()).collect();
    order.sort_by_key(|&triangle| group(triangle));
    io::written(path, |out| {
        writeln!(out, "# steadysweep: untrimmed envelope")?;
        for &position in &envelope.positions {
            write_obj_position(out, position)?;
        }
        for of_group in order.chunk_by(|&a, &b| group(a) == group(b)) {
            let sheet = sheet(of_group[0]);
            writeln!(out, "g span_{}_{}", sheet.span, word_for(sheet.fold))?;
            for &triangle in of_group {
                let [a, b, c] = envelope.triangles[triangle].map(|v| u64::from(v) + 1);
                writeln!(out, "f {a} {b} {c}")?;
            }
        }
        Ok(())
    })
}

fn write_ply(path: &Path, envelope: &SampledEnvelope) -> Result<(), OutputError> {
    let faces = format!(
        "comment source: 0 an edge of the body, 1 a face, by its number; inner: 0 outer sheets, 1 inner ones\n\
         element face {}\nproperty list uchar int vertex_indices\nproperty int span\n\
         property uchar source\nproperty int number\nproperty uchar inner\n",
        envelope.triangles.len()
    );
    io::written(path, |out| {
        out.write_all(ply_head(envelope.positions.len(), &faces).as_bytes())?;
        for &position in &envelope.positions {
            write_position(out, position)?;
        }
        for ([a, b, c], &sheet) in envelope.triangles.iter().zip(&envelope.sheet) {
            let sheet = &envelope.sheets[sheet as usize];
            let (source, number) = coded(sheet.source);
            let inner = u8::from(sheet.fold == Fold::Inner);
            writeln!(
                out,
                "3 {a} {b} {c} {} {source} {number} {inner}",
                sheet.span
            )?;
        }
        Ok(())
    })
}

/// Writes an envelope in the plane; the picture of an SVG is given but for its curves.
pub(super) fn write_planar(
    path: &Path,
    curves: &[SampledCurve],
    motion: &Motion,
    picture: RegionPicture,
) -> Result<(), OutputError> {
    if io::check_kind(path, PLANAR)? == "svg" {
        let paths = curves.iter().map(|curve| curve.points.clone()).collect();
        let picture = RegionPicture {
            region: Vec::new(),
            subject: RegionSubject::Envelope,
            paths,
            ..picture
        };
        return io::write_region(path, &picture);
    }
    let rows = curves.iter().enumerate().flat_map(|(number, sampled)| {
        let points = sampled.shares.iter().zip(&sampled.points);
        points.map(move |(&share, point)| {
            let curve = &sampled.curve;
            let (corner, edge) = columns_of(curve.source);
            let (start, span) = (
                motion.joint_times()[curve.span],
                &motion.spans()[curve.span],
            );
            let time = start + share * span.duration();
            let [x, y] = point.to_array().map(|x| x.to_string());
            let normal = curve.normal(motion, share);
            let [normal_x, normal_y] =
                normal.map_or_else(Default::default, |n| n.to_array().map(|x| x.to_string()));
            let fold = word_for(curve.fold).to_owned();
            let (number, span) = (number.to_string(), curve.span.to_string());
            let time = time.to_string();
            [
                number, span, corner, edge, fold, time, x, y, normal_x, normal_y,
            ]
        })
    });
    io::write_table(path, COLUMNS, rows)
}
