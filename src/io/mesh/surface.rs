//! Surfaces from files: obstacles, which may be open and may hold triangles without area.

use super::body::{ReadReport, renumbered, weld_places};
use super::format::{MeshFormat, format_of, parse_triangles};
use super::list::TriangleList;
use super::numbers::FileNumbers;
use super::ply;
use crate::body::Surface;
use crate::io::error::{InputError, InputProblem};
use crate::io::file::read_bytes;
use glam::DVec3;
use std::path::Path;

/// Reads a surface, open or closed, from an STL, OBJ or PLY file.
///
/// Vertices are joined as in [`read_body`](crate::io::read_body): in an STL, those within 1e-9 of
/// the bounding-box diagonal; in OBJ and PLY, only when that closes a surface that is not closed as
/// it is indexed. No triangle is left out: one with only one or two distinct vertices is kept as
/// the point or segment that it is. Polygons become triangles. A PLY file without faces is a cloud
/// of points ([`Surface::of_points`]); the report then counts no faces.
///
/// # Errors
/// [`InputError`] with the file and the place in it.
///
/// # Cost
/// O(n log n).
pub fn read_surface(path: &Path) -> Result<(Surface, ReadReport), InputError> {
    format_of(path)
        .and_then(|format| parse_surface(format, read_bytes(path)?))
        .map_err(|problem| InputError::new(path, problem))
}

/// Reads a surface from the bytes of a file; see [`read_surface`].
///
/// # Errors
/// [`InputProblem`] with the place in the bytes.
///
/// # Example
/// ```
/// use steadysweep::io::{MeshFormat, parse_surface};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
/// let (wall, read) = parse_surface(MeshFormat::Obj, text.into())?;
/// assert_eq!((wall.triangles().len(), wall.closed(), read.polygons), (2, false, 1));
/// # Ok(())
/// # }
/// ```
pub fn parse_surface(
    format: MeshFormat,
    bytes: Vec<u8>,
) -> Result<(Surface, ReadReport), InputProblem> {
    let list = match format {
        MeshFormat::Ply => ply::read_with_clouds(&bytes)?,
        MeshFormat::Stl | MeshFormat::Obj => parse_triangles(format, bytes)?,
    };
    if format == MeshFormat::Ply && list.face_count == 0 && !list.positions.is_empty() {
        return cloud(list.positions);
    }
    if list.triangles.is_empty() {
        return Err(InputProblem::NoTriangles);
    }
    let TriangleList {
        positions,
        triangles,
        faces,
        face_count,
        polygons,
    } = list;
    let report = |joined: bool, welded: usize, largest_move: f64, vertices: Vec<u32>| ReadReport {
        format,
        faces: face_count,
        polygons,
        joined,
        welded,
        largest_move,
        collapsed: 0,
        numbers: FileNumbers::new(faces.clone(), vertices),
    };
    let mut plain = None;
    if format != MeshFormat::Stl {
        let surface =
            Surface::new(positions.clone(), triangles.clone()).map_err(InputProblem::Surface)?;
        let vertices = (0u32..).take(positions.len()).collect();
        let read = (surface, report(false, 0, 0.0, vertices));
        if read.0.closed() {
            return Ok(read);
        }
        plain = Some(read);
    }
    let welded = weld_places(&positions, &triangles);
    let joined = triangles
        .iter()
        .map(|triangle| triangle.map(|v| welded.place_of[v as usize]))
        .collect();
    let surface = Surface::new(welded.positions, joined).map_err(|error| {
        let faces = |f: u32| faces[f as usize];
        let vertices = |v: u32| welded.vertex_of[v as usize];
        InputProblem::Surface(renumbered(error, faces, vertices))
    })?;
    match plain {
        // Joining did not close the surface: the vertices stay as they are in the file.
        Some(plain) if !surface.closed() => Ok(plain),
        _ => Ok((
            surface,
            report(true, welded.moved, welded.largest_move, welded.vertex_of),
        )),
    }
}

/// A cloud of points, which keep their places and numbers.
fn cloud(points: Vec<DVec3>) -> Result<(Surface, ReadReport), InputProblem> {
    let vertices = (0u32..).take(points.len()).collect();
    let read = ReadReport {
        format: MeshFormat::Ply,
        faces: 0,
        polygons: 0,
        joined: false,
        welded: 0,
        largest_move: 0.0,
        collapsed: 0,
        numbers: FileNumbers::new(Vec::new(), vertices),
    };
    let surface = Surface::of_points(points).map_err(InputProblem::Surface)?;
    Ok((surface, read))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    fn obj(text: &str) -> (Surface, ReadReport) {
        parse_surface(MeshFormat::Obj, text.as_bytes().to_vec()).expect("a surface")
    }

    /// An STL text of triangles.
    fn stl(triangles: &[[DVec3; 3]]) -> Vec<u8> {
        let facet = |corners: &[DVec3; 3]| {
            let vertices = corners.map(|p| format!("vertex {:?} {:?} {:?}\n", p.x, p.y, p.z));
            format!(
                "facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n",
                vertices.concat()
            )
        };
        let facets: String = triangles.iter().map(facet).collect();
        format!("solid a\n{facets}endsolid a\n").into_bytes()
    }

    #[test]
    fn an_open_surface_is_read_as_it_is_indexed() {
        let (wall, read) = obj(&format!("v 9 9 9\n{SQUARE}f 2 3 4 5\n"));
        assert!(!wall.closed(), "a wall");
        assert_eq!(wall.triangles(), [[1, 2, 3], [1, 3, 4]]);
        assert_eq!((read.faces, read.polygons, read.joined), (1, 1, false));
        assert_eq!(
            read.numbers.vertex(4),
            4,
            "an unused vertex changes no number"
        );
        assert_eq!(read.numbers.face(1), 0, "two triangles of one face");
    }

    #[test]
    fn triangles_without_area_are_kept() {
        let (surface, read) = obj(&format!(
            "{SQUARE}f 1 2 1\nf 3 3 3 3\nf 1 2 2 4 4\nf 1 3 1 3\n"
        ));
        let without_area = surface
            .triangles()
            .iter()
            .filter(|[a, b, c]| a == b || b == c || c == a)
            .count();
        assert_eq!(
            (without_area, surface.triangles().len()),
            (4, 5),
            "a segment, a point, a triangle, and a segment to and fro: {:?}",
            surface.triangles()
        );
        assert_eq!((read.faces, read.collapsed), (4, 0), "nothing is left out");
        let needle = [DVec3::ZERO, DVec3::X, DVec3::X];
        let flat = [DVec3::ZERO, DVec3::X, 2.0 * DVec3::X];
        let (surface, _) =
            parse_surface(MeshFormat::Stl, stl(&[needle, flat, [DVec3::Y; 3]])).expect("a surface");
        assert_eq!(surface.triangles(), [[0, 1, 1], [0, 1, 2], [3, 3, 3]]);
        assert!(!surface.closed(), "segments enclose nothing");
    }

    #[test]
    fn an_stl_is_joined_and_closed() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let mut triangles = faces.map(|face| face.map(|v: usize| corners[v])).to_vec();
        // Off by less than 1e-9 of the diagonal.
        triangles[3][0].x += 1e-10;
        triangles.push([DVec3::X, DVec3::Y, DVec3::X]);
        let (surface, read) = parse_surface(MeshFormat::Stl, stl(&triangles)).expect("a surface");
        assert_eq!((surface.positions().len(), read.welded), (4, 1));
        assert_eq!(surface.triangles().len(), 5, "that without area too");
        assert!(surface.closed(), "it does not open a closed surface");
        assert_eq!(
            read.numbers.vertex(3),
            5,
            "the fourth place is corner 2 of triangle 1"
        );
    }

    #[test]
    fn vertices_that_an_exporter_has_split_are_joined_where_that_closes_the_surface() {
        let split = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 0 0\nv 0 1 0\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 5 6 4\n";
        let (surface, read) = obj(split);
        assert_eq!((surface.closed(), read.joined), (true, true));
        let (_, read) = obj(&split.replace("f 1 4 3\n", ""));
        assert!(!read.joined, "open either way: as the file says");
    }

    #[test]
    fn a_ply_without_faces_is_a_cloud_of_points() {
        let header = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n";
        for faces in [
            "",
            "element face 0\nproperty list uchar int vertex_indices\n",
        ] {
            let text = format!("{header}{faces}end_header\n1 2 3\n4 5 6\n");
            let (cloud, read) = parse_surface(MeshFormat::Ply, text.into_bytes()).expect("a cloud");
            assert_eq!(cloud.triangles(), [[0; 3], [1; 3]]);
            assert_eq!(cloud.positions()[1], DVec3::new(4.0, 5.0, 6.0));
            assert_eq!((read.faces, read.numbers.vertex(1)), (0, 1));
            assert!(!cloud.closed(), "points enclose nothing");
        }
        let none = header.replace("vertex 2", "vertex 0") + "end_header\n";
        let refused = parse_surface(MeshFormat::Ply, none.into_bytes()).expect_err("nothing");
        assert!(refused.to_string().contains("no triangles"), "{refused}");
    }

    #[test]
    fn a_file_without_triangles_is_no_obstacle() {
        let refused = |format, bytes| {
            parse_surface(format, bytes)
                .expect_err("nothing there")
                .to_string()
        };
        for bytes in [stl(&[]), vec![0; 84]] {
            assert!(
                refused(MeshFormat::Stl, bytes).starts_with("there are no triangles in the file"),
                "no facets"
            );
        }
        let points = format!("{SQUARE}f\n").into_bytes();
        assert!(
            refused(MeshFormat::Obj, points).starts_with("there are no triangles in the file"),
            "a face without corners"
        );
    }
}
