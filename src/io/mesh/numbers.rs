//! The numbers of faces and vertices in their file.

/// Maps the triangles and vertices in memory to those of the file, which may have more (polygons,
/// joined corners, faces that were left out).
///
/// Faces and vertices are counted from 0 in the order of the file; in an STL, which has no
/// vertices, number 3 i + j is corner j of triangle i. Where several vertices of the file were
/// joined, the first stands for all of them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FileNumbers {
    faces: Vec<u32>,
    vertices: Vec<u32>,
}

impl FileNumbers {
    /// - `faces`: per triangle, the face of the file.
    /// - `vertices`: per vertex, the vertex of the file.
    pub(super) fn new(faces: Vec<u32>, vertices: Vec<u32>) -> FileNumbers {
        FileNumbers { faces, vertices }
    }

    /// As [`FileNumbers::new`], for a list whose unused vertices are about to be dropped.
    pub(super) fn of_used(
        faces: Vec<u32>,
        triangles: &[[u32; 3]],
        vertices: &[u32],
    ) -> FileNumbers {
        let mut used = vec![false; vertices.len()];
        for &v in triangles.iter().flatten() {
            // An index out of range is left to the mesh, which refuses it.
            if let Some(slot) = used.get_mut(v as usize) {
                *slot = true;
            }
        }
        let vertices = vertices
            .iter()
            .zip(used)
            .filter_map(|(&v, used)| used.then_some(v))
            .collect();
        FileNumbers { faces, vertices }
    }

    /// The face of the file to which a triangle belongs. Panics when there is no such triangle.
    pub fn face(&self, triangle: u32) -> u32 {
        self.faces[triangle as usize]
    }

    /// The vertex of the file that stands for a vertex. Panics when there is no such vertex.
    pub fn vertex(&self, vertex: u32) -> u32 {
        self.vertices[vertex as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_that_are_dropped_have_no_number() {
        let numbers = FileNumbers::of_used(
            vec![4, 4],
            &[[0, 2, 3], [0, 3, 5]],
            &[10, 11, 12, 13, 14, 15],
        );
        let vertices: Vec<u32> = (0..4).map(|v| numbers.vertex(v)).collect();
        assert_eq!(vertices, [10, 12, 13, 15], "11 and 14 are used by nothing");
        assert_eq!([0, 1].map(|f| numbers.face(f)), [4, 4], "one polygon");
    }
}
