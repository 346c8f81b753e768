//! Bodies from mesh files.

use super::format::{MeshFormat, format_of, parse_triangles};
use super::list::TriangleList;
use super::numbers::FileNumbers;
use crate::body::{BodyError, Defect, Mesh};

use crate::io::error::{InputError, InputProblem};
use crate::io::file::read_bytes;
use crate::numeric::tolerance::{LARGEST_COORDINATE, WELD_DISTANCE};
use crate::surface::{Welded, weld};
use glam::DVec3;
use std::path::Path;

/// What the reader did to the mesh of a file.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ReadReport {
    /// Format of the file.
    pub format: MeshFormat,
    /// Number of faces in the file.
    pub faces: usize,
    /// Number of faces with more than three corners, which were cut into triangles.
    pub polygons: usize,
    /// Whether vertices that coincide were joined: always for STL, otherwise only when the mesh is
    /// not closed without it.
    pub joined: bool,
    /// Number of vertices that were joined to another one at a slightly different place.
    pub welded: usize,
    /// Largest distance between places that were joined, at most 1e-9 of the bounding-box diagonal.
    pub largest_move: f64,
    /// Number of triangles and whole faces left out because two of their corners are one vertex.
    pub collapsed: usize,
    /// The numbers of triangles and vertices in the file.
    pub numbers: FileNumbers,
}

/// Reads a closed body from an STL, OBJ or PLY file.
///
/// An STL has no vertices but three places per triangle: places within 1e-9 of the bounding-box
/// diagonal of each other are joined. OBJ and PLY say which corners are one vertex: the same is
/// done only when the mesh is not closed as it is indexed (some exporters split vertices for the
/// sake of normals). Triangles with a repeated vertex, before or after joining, are left out: a
/// closed mesh stays closed without them. Polygons become triangles.
///
/// # Errors
/// [`InputError`] with the file and the place in it. The defects of a body are those that remain
/// after joining. They name faces by their numbers in the file, from 0, and in OBJ and PLY vertices
/// too; in an STL, vertex 3 i + j is corner j of triangle i.
///
/// # Cost
/// O(n log n).
pub fn read_body(path: &Path) -> Result<(Mesh, ReadReport), InputError> {
    format_of(path)
        .and_then(|format| parse_body(format, read_bytes(path)?))
        .map_err(|problem| InputError::new(path, problem))
}

/// Reads a closed body from the bytes of a file; see [`read_body`].
///
/// # Errors
/// [`InputProblem`] with the place in the bytes.
///
/// # Example
/// ```
/// use steadysweep::io::{MeshFormat, parse_body};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
/// let (body, read) = parse_body(MeshFormat::Obj, text.into())?;
/// assert_eq!((body.triangles().len(), read.joined), (4, false));
/// # Ok(())
/// # }
/// ```
pub fn parse_body(format: MeshFormat, bytes: Vec<u8>) -> Result<(Mesh, ReadReport), InputProblem> {
    assemble(format, parse_triangles(format, bytes)?)
}

/// Makes a body from the triangles of a file.
fn assemble(format: MeshFormat, list: TriangleList) -> Result<(Mesh, ReadReport), InputProblem> {
    let TriangleList {
        positions,
        triangles,
        faces,
        face_count,
        polygons,
    } = list;
    let report =
        |joined: bool, welded: usize, largest_move: f64, numbers: FileNumbers, used: usize| {
            ReadReport {
                format,
                faces: face_count,
                polygons,
                joined,
                welded,
                largest_move,
                collapsed: triangles.len() - used,
                numbers,
            }
        };
    let distinct = |&f: &u32| {
        let [a, b, c] = triangles[f as usize];
        a != b && b != c && c != a
    };
    let kept: Vec<u32> = (0u32..).take(triangles.len()).filter(distinct).collect();
    let collapsed_whole = InputProblem::Collapsed { faces: face_count };
    if kept.is_empty() && face_count > 0 {
        return Err(collapsed_whole);
    }
    let mut unjoined = None;
    if format != MeshFormat::Stl {
        let used: Vec<[u32; 3]> = kept.iter().map(|&f| triangles[f as usize]).collect();
        let numbers = || {
            let faces = kept.iter().map(|&f| faces[f as usize]).collect();
            let vertices: Vec<u32> = (0u32..).take(positions.len()).collect();
            FileNumbers::of_used(faces, &used, &vertices)
        };
        match Mesh::new(positions.clone(), used.clone()) {
            Ok(mesh) => return Ok((mesh, report(false, 0, 0.0, numbers(), kept.len()))),
            Err(error) => {
                unjoined = Some(renumbered(
                    error,
                    |f| faces[kept[f as usize] as usize],
                    |v| v,
                ))
            }
        }
    }
    let is_open = |error: &BodyError| {
        error
            .defects()
            .iter()
            .any(|d| matches!(d, Defect::OpenEdge { .. }))
    };
    if let Some(error) = unjoined.take_if(|error| !is_open(error)) {
        return Err(InputProblem::Body(error));
    }
    let welded = weld_places(&positions, &triangles);
    let Welded {
        vertex_of,
        triangle_of,
        moved,
        largest_move,
        ..
    } = welded;
    let used = welded.triangles.len();
    if used == 0 && face_count > 0 {
        return Err(collapsed_whole);
    }
    let numbers = FileNumbers::of_used(
        triangle_of.iter().map(|&f| faces[f as usize]).collect(),
        &welded.triangles,
        &vertex_of,
    );
    match Mesh::new(welded.positions, welded.triangles) {
        Ok(mesh) => Ok((mesh, report(true, moved, largest_move, numbers, used))),
        Err(error) => {
            let joined = renumbered(
                error,
                |f| faces[triangle_of[f as usize] as usize],
                |v| vertex_of[v as usize],
            );
            // Of the two readings, the one with fewer defects is closer to what was meant.
            let plain = unjoined.filter(|error| error.defects().len() <= joined.defects().len());
            Err(InputProblem::Body(plain.unwrap_or(joined)))
        }
    }
}

/// The vertices of a file, those within 1e-9 of the diagonal joined.
pub(super) fn weld_places(positions: &[DVec3], triangles: &[[u32; 3]]) -> Welded {
    weld(
        positions,
        triangles,
        WELD_DISTANCE * weldable_diagonal(positions),
    )
}

/// The bounding-box diagonal; zero, with which only equal places are joined, when it is too large
/// for the computation.
fn weldable_diagonal(positions: &[DVec3]) -> f64 {
    let low = positions
        .iter()
        .copied()
        .reduce(DVec3::min)
        .unwrap_or_default();
    let high = positions
        .iter()
        .copied()
        .reduce(DVec3::max)
        .unwrap_or_default();
    if low.abs().max(high.abs()).max_element() > LARGEST_COORDINATE {
        0.0
    } else {
        low.distance(high)
    }
}

pub(super) fn renumbered(
    error: BodyError,
    triangle_of: impl Fn(u32) -> u32,
    vertex_of: impl Fn(u32) -> u32,
) -> BodyError {
    let defects = error.into_defects();
    let renumbered = defects
        .into_iter()
        .map(|defect| defect.renumbered(&triangle_of, &vertex_of))
        .collect();
    BodyError::new(renumbered).expect("as many defects as before")
}
