//! PLY, text and binary in either byte order, through `ply-rs-bw`.
//!
//! The header is compared with the size of the file before any element is read: nothing else
//! vouches for its counts.

use super::list::TriangleList;
use super::ply_elements::{CORNERS, ElementPlace, PlyBody, PlyElement};
use super::polygon::{too_involved, triangulate};
use crate::io::error::{EXPORT_AGAIN, InputProblem, Place, quote};
use glam::DVec3;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{
    Addable, ElementDef, Encoding, Header, PropertyAccess, PropertyDef, PropertyType, ScalarType,
};
use ply_rs_bw::writer::Writer;
use std::io::{self, Cursor};

/// The vertices in the order of the file, and the faces as triangles.
pub(super) fn read(bytes: &[u8]) -> Result<TriangleList, InputProblem> {
    read_kind(bytes, PlyKind::Mesh)
}

/// As [`read`]; without faces where the file is a cloud of points.
pub(super) fn read_with_clouds(bytes: &[u8]) -> Result<TriangleList, InputProblem> {
    read_kind(bytes, PlyKind::MeshOrCloud)
}

fn read_kind(bytes: &[u8], kind: PlyKind) -> Result<TriangleList, InputProblem> {
    let header_line = |line: usize| {
        let found = bytes
            .split(|&b| b == b'\n')
            .nth(line - 1)
            .unwrap_or_default();
        quote(&String::from_utf8_lossy(found))
    };
    let parser = Parser::<PlyElement>::new();
    let mut reader = Reader::new(Cursor::new(bytes));
    let header = parser.read_header(&mut reader).map_err(|_| {
        let line = reader.line().max(1);
        InputProblem::Malformed {
            place: Place::Line(line),
            expected: if line == 1 {
                "\"ply\", as a PLY file begins"
            } else {
                "a line of a PLY header"
            }
            .to_owned(),
            found: header_line(line),
            remedy: if line == 1 {
                "this is no PLY file"
            } else {
                EXPORT_AGAIN
            },
        }
    })?;
    check_header(&header, kind)?;
    let line = reader.line();
    let mut source = PlyBody {
        parser,
        line,
        encoding: header.encoding,
        bytes: reader.into_inner(),
    };
    let mut list = TriangleList::default();
    let mut faces = PlyFaces::default();
    let vertices = header.elements["vertex"].count;
    for definition in header.elements.values() {
        source.check_claim(definition)?;
        match definition.name.as_str() {
            "vertex" => source.each(definition, |spot, vertex| {
                if !vertex.position.is_finite() {
                    return Err(InputProblem::Malformed {
                        place: spot.place(),
                        expected: "finite coordinates".to_owned(),
                        found: vertex.position.to_string(),
                        remedy: EXPORT_AGAIN,
                    });
                }
                list.positions.push(vertex.position);
                Ok(())
            })?,
            "face" => source.each(definition, |spot, face| {
                if let Some(index) = face.corners.iter().find(|&&v| v as usize >= vertices) {
                    return Err(InputProblem::Malformed {
                        place: spot.place(),
                        expected: format!("vertex indices below {vertices}"),
                        found: index.to_string(),
                        remedy: EXPORT_AGAIN,
                    });
                }
                faces.push(spot, &face.corners);
                Ok(())
            })?,
            _ => source.each(definition, |_, _| Ok(()))?,
        }
    }
    let mut start = 0;
    for &(spot, end) in &faces.ends {
        list.face_count = spot.index;
        let corners = &faces.corners[start..end];
        start = end;
        if !list.push_polygon(corners, triangulate) {
            return Err(InputProblem::Malformed {
                place: spot.place(),
                expected: "a simple polygon".to_owned(),
                found: too_involved(corners.len()),
                remedy: "export triangles",
            });
        }
    }
    list.face_count = faces.count;
    Ok(list)
}

/// The faces of a file with at least three corners, kept because they may stand before the
/// vertices.
#[derive(Default)]
struct PlyFaces<'a> {
    corners: Vec<u32>,
    /// Per face its place in the file, and where its corners end in the list.
    ends: Vec<(ElementPlace<'a>, usize)>,
    /// Number of all faces, including those with fewer than three corners, which are not kept.
    count: usize,
}

impl<'a> PlyFaces<'a> {
    fn push(&mut self, spot: ElementPlace<'a>, corners: &[u32]) {
        if corners.len() >= 3 {
            self.corners.extend_from_slice(corners);
            self.ends.push((spot, self.corners.len()));
        }
        self.count += 1;
    }
}

/// What a file may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum PlyKind {
    /// It is a mesh.
    Mesh,
    /// It is a mesh or a cloud of points, which has no faces.
    MeshOrCloud,
}

/// Whether the header describes vertices and faces.
fn check_header(header: &Header, kind: PlyKind) -> Result<(), InputProblem> {
    let missing = |expected: &str| {
        Err(InputProblem::Malformed {
            place: Place::File,
            expected: format!("{expected} in the PLY header"),
            found: "none".to_owned(),
            remedy: "export a triangle mesh",
        })
    };
    let property = |element: &str, names: &[&str]| -> Option<&PropertyDef> {
        let properties = &header.elements.get(element)?.properties;
        names.iter().find_map(|&name| properties.get(name))
    };
    for axis in ["x", "y", "z"] {
        match property("vertex", &[axis]).map(|p| &p.data_type) {
            Some(PropertyType::Scalar(_)) => {}
            _ => return missing(&format!("a property {axis} of element vertex")),
        }
    }
    let faces = header.elements.get("face").map_or(0, |face| face.count);
    if kind == PlyKind::MeshOrCloud && faces == 0 {
        return Ok(());
    }
    let Some(corners) = property("face", &CORNERS) else {
        return missing("a list property vertex_indices of element face");
    };
    match &corners.data_type {
        PropertyType::List(count, index) => {
            for (scalar, what) in [(count, "the count"), (index, "the indices")] {
                if matches!(scalar, ScalarType::Float | ScalarType::Double) {
                    return Err(InputProblem::Malformed {
                        place: Place::File,
                        expected: format!(
                            "an integer type such as int for {what} of the list {} of element face",
                            corners.name
                        ),
                        found: "a floating-point type in the PLY header".to_owned(),
                        remedy: "export the mesh with integer indices",
                    });
                }
            }
            Ok(())
        }
        PropertyType::Scalar(_) => missing("a list property vertex_indices of element face"),
    }
}

/// Writes a binary little-endian PLY file with coordinates in full precision.
pub(super) fn write(
    out: &mut impl io::Write,
    positions: &[DVec3],
    triangles: &[[u32; 3]],
) -> io::Result<()> {
    let mut vertex = ElementDef::new("vertex".to_owned());
    vertex.count = positions.len();
    for axis in ["x", "y", "z"] {
        vertex.properties.add(PropertyDef::new(
            axis.to_owned(),
            PropertyType::Scalar(ScalarType::Double),
        ));
    }
    let mut face = ElementDef::new("face".to_owned());
    face.count = triangles.len();
    let corners = PropertyType::List(ScalarType::UChar, ScalarType::UInt);
    face.properties
        .add(PropertyDef::new(CORNERS[0].to_owned(), corners));
    let mut header = Header::new();
    header.encoding = Encoding::BinaryLittleEndian;
    header.comments.push("steadysweep".to_owned());
    header.elements.add(vertex.clone());
    header.elements.add(face.clone());
    let writer = Writer::<PlyElement>::new();
    writer.write_header(out, &header)?;
    let mut element = PlyElement::new();
    for &position in positions {
        element.position = position;
        writer.write_little_endian_element(out, &element, &vertex)?;
    }
    for triangle in triangles {
        element.corners.clear();
        element.corners.extend(triangle);
        writer.write_little_endian_element(out, &element, &face)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::tests::tetrahedron;

    const TEXT: &str = "ply\nformat ascii 1.0\ncomment a\nelement vertex 4\nproperty float x\nproperty float y\n\
        property double z\nproperty uchar red\nelement edge 1\nproperty int vertex1\nelement face 2\n\
        property list uchar int vertex_index\nend_header\n0 0 0 255\n1 0 0.1 0\n1 1 0 0\n0 1 0 7\n9\n3 0 1 2\n4 0 1 2 3\n";

    fn message(bytes: impl AsRef<[u8]>) -> String {
        read(bytes.as_ref()).expect_err("refused").to_string()
    }

    fn binary() -> Vec<u8> {
        let (positions, triangles) = tetrahedron();
        let mut bytes = Vec::new();
        write(&mut bytes, &positions, &triangles).expect("a vector takes everything");
        bytes
    }

    #[test]
    fn text_files_with_polygons_and_other_elements_are_read() {
        let list = read(TEXT.as_bytes()).expect("a PLY");
        assert_eq!(
            list.positions[1],
            DVec3::new(1.0, 0.0, 0.1),
            "z is a double"
        );
        assert_eq!(list.triangles, [[0, 1, 2], [0, 1, 2], [0, 2, 3]]);
        assert_eq!(list.faces, [0, 1, 1], "the square is face 1");
        let windows = TEXT.replace('\n', "\r\n");
        let short = TEXT.replace("1 0 0.1 0", "1. -0 .1e0 0");
        let list = read(short.as_bytes()).expect("a PLY");
        assert_eq!(
            list.positions[1],
            DVec3::new(1.0, 0.0, 0.1),
            "numbers without digits on one side"
        );
        assert_eq!(
            read(windows.as_bytes()).expect("a PLY").triangles.len(),
            3,
            "CRLF"
        );
    }

    #[test]
    fn binary_files_come_back_bit_by_bit() {
        let (mut positions, triangles) = tetrahedron();
        positions[1] = DVec3::new(0.1 + 0.2, -1.0 / 3.0, 1e-300);
        let mut bytes = Vec::new();
        write(&mut bytes, &positions, &triangles).expect("a vector takes everything");
        let list = read(&bytes).expect("a PLY");
        assert_eq!((list.positions, list.triangles), (positions, triangles));
    }

    #[test]
    fn big_endian_files_are_read() {
        let mut bytes = b"ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty short y\n\
            property double z\nelement face 1\nproperty list int short vertex_indices\nend_header\n"
            .to_vec();
        for (x, y, z) in [(1.5f32, -2i16, 0.1f64), (0.0, 1, 0.0), (0.0, 0, 3.0)] {
            bytes.extend(
                x.to_be_bytes()
                    .iter()
                    .chain(&y.to_be_bytes())
                    .chain(&z.to_be_bytes()),
            );
        }
        bytes.extend([0, 0, 0, 3, 0, 2, 0, 1, 0, 0]);
        let list = read(&bytes).expect("a PLY");
        assert_eq!(list.positions[0], DVec3::new(1.5, -2.0, 0.1));
        assert_eq!(list.triangles, [[2, 1, 0]]);
    }

    #[test]
    fn a_header_that_claims_too_much_is_refused_before_reading() {
        let huge = TEXT.replace("vertex 4", "vertex 4000000000000");
        assert!(message(huge).starts_with(
            "the header claims 4000000000000 elements \"vertex\" (32000000000000 bytes)"
        ));
        let bytes = binary();
        let text = message(&bytes[..bytes.len() - 60]);
        assert!(text.starts_with("the header claims 4 elements \"vertex\" (96 bytes), but the file holds 3 (88 bytes)"), "{text}");
        let text = message(&bytes[..bytes.len() - 6]);
        assert!(
            text.starts_with("face 3 (counted from 0, at byte "),
            "{text}"
        );
        assert!(
            text.contains("expected element \"face\" 3 of 4, found the end of the file"),
            "{text}"
        );
        // Elements without properties take no bytes: neither time nor memory may grow with their
        // number.
        let extra = b"element nothing 18446744073709551615\n";
        let place = bytes
            .windows(12)
            .position(|w| w == b"element face")
            .expect("in the header");
        let bytes = [&bytes[..place], extra, &bytes[place..]].concat();
        assert_eq!(read(&bytes).expect("a PLY").triangles.len(), 4, "binary");
        let text = message(TEXT.replace(
            "element face",
            "element nothing 18446744073709551615\nelement face",
        ));
        assert!(text.contains("expected element \"nothing\""), "{text}");
        let endless = TEXT.replace("element face 2", "element face 18446744073709551615");
        assert!(
            message(endless).contains("18446744073709551615 elements \"face\""),
            "largest count"
        );
        assert!(
            message(TEXT.replace("vertex 4", "vertex 99999999999999999999")).starts_with("line 4"),
            "no number at all"
        );
    }

    #[test]
    fn wrong_numbers_are_named_with_their_place() {
        let text = message(TEXT.replace("1 0 0.1 0", "1 0 nan 0"));
        assert!(
            text.starts_with("line 15: expected element \"vertex\" 1 of 4, found \"1 0 nan 0\""),
            "{text}"
        );
        let text = message(TEXT.replace("4 0 1 2 3", "4 0 1 2 4"));
        assert!(
            text.starts_with("line 20: expected vertex indices below 4, found 4"),
            "{text}"
        );
        let text = message(TEXT.replace("4 0 1 2 3", "4 0 1 2 -1"));
        assert!(
            text.starts_with("line 20: expected element \"face\" 1 of 2, found \"4 0 1 2 -1\""),
            "{text}"
        );
        let mut bytes = binary();
        let body = bytes
            .windows(11)
            .position(|w| w == b"end_header\n")
            .expect("a header")
            + 11;
        bytes[body + 24 + 8..][..8].copy_from_slice(&f64::INFINITY.to_le_bytes());
        let text = message(&bytes);
        let place = format!("vertex 1 (counted from 0, at byte {})", body + 24);
        assert!(
            text.starts_with(&format!(
                "{place}: expected finite coordinates, found [1, inf, 0]"
            )),
            "{text}"
        );
        let mut bytes = binary();
        let end = bytes.len();
        bytes[end - 4..].fill(0xff);
        assert!(
            message(&bytes).contains("expected vertex indices below 4, found 4294967295"),
            "{}",
            message(&bytes)
        );
    }

    #[test]
    fn what_is_no_ply_mesh_is_refused() {
        assert!(
            message("hello")
                .starts_with("line 1: expected \"ply\", as a PLY file begins, found \"hello\"")
        );
        assert!(
            message("ply\nformat ascii 1.0\nfoo\n")
                .starts_with("line 3: expected a line of a PLY header, found \"foo\"")
        );
        assert!(
            message("ply\nformat ascii 1.0\nelement vertex 1\n").starts_with("line 4"),
            "no end of the header"
        );
        assert!(
            message(TEXT.replace("double z", "double w"))
                .contains("a property z of element vertex")
        );
        assert!(
            message(TEXT.replace("vertex_index", "corners"))
                .contains("a list property vertex_indices")
        );
        for (types, what) in [("uchar float", "the indices"), ("double int", "the count")] {
            let text = message(TEXT.replace("list uchar int", &format!("list {types}")));
            assert!(
                text.starts_with(&format!(
                    "expected an integer type such as int for {what} of the list vertex_index of element face, found a floating"
                )),
                "{text}"
            );
        }
    }
}
