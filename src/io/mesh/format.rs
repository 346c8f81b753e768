//! File formats of meshes, by the extension of the name.

use super::list::TriangleList;
use super::{obj, ply, stl};
use crate::io::error::{InputProblem, OutputError, OutputProblem};
use crate::io::file::{extension, written};
use crate::io::replace;
use glam::DVec3;
use std::path::Path;

/// File formats of meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshFormat {
    /// Text or binary; written as binary, in which coordinates are `f32`.
    Stl,
    /// Text; written in full precision.
    Obj,
    /// Text or binary; written as binary, in full precision.
    Ply,
}

/// Extensions that can be read and written.
const KNOWN: &[&str] = &[".stl", ".obj", ".ply"];

/// Extensions of bodies that cannot be read yet.
const NOT_READ_YET: &[&str] = &["glb", "gltf", "3mf", "step", "stp"];

/// Extensions of drawings.
const PLANAR: &[&str] = &["svg", "dxf"];

/// Extensions that cannot be written yet.
const NOT_WRITTEN_YET: &[&str] = &["glb", "3mf", "html", "png"];

/// The format of an input file, by the extension of its name.
pub(super) fn format_of(path: &Path) -> Result<MeshFormat, InputProblem> {
    let extension = extension(path);
    match extension.as_deref() {
        Some("stl") => Ok(MeshFormat::Stl),
        Some("obj") => Ok(MeshFormat::Obj),
        Some("ply") => Ok(MeshFormat::Ply),
        Some(drawing) if PLANAR.contains(&drawing) => Err(InputProblem::Planar {
            found: format!(".{drawing}"),
            known: KNOWN,
        }),
        Some(later) if NOT_READ_YET.contains(&later) => Err(InputProblem::NotYet {
            found: format!(".{later}"),
            known: KNOWN,
        }),
        _ => Err(InputProblem::UnknownExtension {
            found: extension,
            known: KNOWN,
        }),
    }
}

/// The mesh as it stands in the bytes of a file.
pub(super) fn parse_triangles(
    format: MeshFormat,
    bytes: Vec<u8>,
) -> Result<TriangleList, InputProblem> {
    match format {
        MeshFormat::Stl => stl::read(bytes),
        MeshFormat::Obj => obj::read(&bytes),
        MeshFormat::Ply => ply::read(&bytes),
    }
}

/// Checks that a mesh can be written to `path`, before anything is computed: the format is known
/// and a file can be created in the directory. Leaves no trace.
///
/// # Errors
/// [`OutputError`] with what is wrong.
pub fn check_output(path: &Path) -> Result<MeshFormat, OutputError> {
    let refuse = |problem| Err(OutputError::new(path, problem));
    let extension = extension(path);
    let format = match extension.as_deref() {
        Some("stl") => MeshFormat::Stl,
        Some("obj") => MeshFormat::Obj,
        Some("ply") => MeshFormat::Ply,
        Some(drawing) if PLANAR.contains(&drawing) => {
            return refuse(OutputProblem::OtherKind {
                found: format!(".{drawing}"),
                what: "solids",
                known: KNOWN,
            });
        }
        Some(later) if NOT_WRITTEN_YET.contains(&later) => {
            return refuse(OutputProblem::NotYet {
                found: format!(".{later}"),
                known: KNOWN,
            });
        }
        _ => {
            return refuse(OutputProblem::UnknownExtension {
                found: extension,
                known: KNOWN,
            });
        }
    };
    replace::check_place(path).map_err(|problem| OutputError::new(path, problem))?;
    Ok(format)
}

/// Writes a mesh as STL, OBJ or PLY, as the extension says; the file appears once it is complete.
///
/// OBJ and PLY keep every bit of the coordinates; STL (always binary) rounds them to `f32`.
///
/// # Errors
/// [`OutputError`]; a file that was there before is then unharmed.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use steadysweep::io::{read_body, write_mesh};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let path = std::env::temp_dir().join(format!("steadysweep-{}.ply", std::process::id()));
/// let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// write_mesh(&path, &corners, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])?;
/// let (body, _) = read_body(&path)?;
/// assert_eq!(body.positions(), corners);
/// # std::fs::remove_file(&path)?;
/// # Ok(())
/// # }
/// ```
pub fn write_mesh(
    path: &Path,
    positions: &[DVec3],
    triangles: &[[u32; 3]],
) -> Result<(), OutputError> {
    let format = check_output(path)?;
    written(path, |out| match format {
        MeshFormat::Stl => stl::write(out, positions, triangles),
        MeshFormat::Obj => obj::write(out, positions, triangles),
        MeshFormat::Ply => ply::write(out, positions, triangles),
    })
}
