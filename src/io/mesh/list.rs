//! The triangles of a file, before they become a body or a surface.

use glam::DVec3;

/// The mesh as it stands in a file, with faces cut into triangles. Positions are finite, and
/// indices are in range.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct TriangleList {
    pub(super) positions: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Face of the file to which each triangle belongs.
    pub(super) faces: Vec<u32>,
    pub(super) face_count: usize,
    /// Number of faces with more than three corners.
    pub(super) polygons: usize,
}

impl TriangleList {
    /// Appends a face with three corners of its own.
    pub(super) fn push_triangle(&mut self, corners: [DVec3; 3]) {
        let first = number(self.positions.len());
        self.positions.extend(corners);
        self.triangles
            .push([first, first.wrapping_add(1), first.wrapping_add(2)]);
        self.count_face();
    }

    /// Appends a face over given vertices by `triangulate`; false when that fails. A face whose
    /// corners are fewer than three distinct vertices has no area: it becomes a triangle that
    /// repeats them.
    pub(super) fn push_polygon(
        &mut self,
        corners: &[u32],
        triangulate: impl Fn(&[DVec3], &[u32], &mut Vec<[u32; 3]>) -> bool,
    ) -> bool {
        let before = self.triangles.len();
        let done = triangulate(&self.positions, corners, &mut self.triangles);
        if let ([first, ..], true) = (corners, self.triangles.len() == before) {
            let other = corners.iter().find(|&v| v != first).unwrap_or(first);
            self.triangles.push([*first, *other, *first]);
        }
        self.polygons += usize::from(corners.len() > 3);
        self.count_face();
        done
    }

    fn count_face(&mut self) {
        self.faces
            .resize(self.triangles.len(), number(self.face_count));
        self.face_count += 1;
    }
}

/// An index as `u32`. It is wrong beyond 4 billion, where [`crate::body::Mesh::new`] refuses the
/// list for its length.
#[expect(clippy::cast_possible_truncation, reason = "see above")]
pub(super) fn number(index: usize) -> u32 {
    index as u32
}
