//! Text files of points, lines and triangles with values of our own: PLY elements, OBJ groups.

use crate::grazing::{Fold, Source};
use glam::DVec3;
use std::io::{self, Write};

/// The head of a PLY: positions, and then other elements.
pub(super) fn ply_head(vertices: usize, elements: &str) -> String {
    format!(
        "ply\nformat ascii 1.0\ncomment steadysweep\nelement vertex {vertices}\n\
         property double x\nproperty double y\nproperty double z\n{elements}end_header\n"
    )
}

/// A line of a PLY with a position.
pub(super) fn write_position(out: &mut impl Write, p: DVec3) -> io::Result<()> {
    writeln!(out, "{} {} {}", p.x, p.y, p.z)
}

/// Whether it is an edge, 0, or a face, 1, and its number.
pub(super) fn coded(source: Source) -> (u8, u32) {
    match source {
        Source::Edge(edge) => (0, edge),
        Source::Face(face) => (1, face),
    }
}

/// A line of an OBJ with a position.
pub(super) fn write_obj_position(out: &mut impl Write, p: DVec3) -> io::Result<()> {
    writeln!(out, "v {:?} {:?} {:?}", p.x, p.y, p.z)
}

/// The word for a fold.
pub(super) fn word_for(fold: Fold) -> &'static str {
    match fold {
        Fold::Outer => "outer",
        Fold::Inner => "inner",
    }
}
