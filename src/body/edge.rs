//! An edge of a closed mesh, between the two faces that share it.

/// An edge of a closed mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    /// Its ends, smaller index first.
    pub vertices: [u32; 2],
    /// Face that runs through the edge from `vertices[0]` to `vertices[1]`, then the one that runs
    /// back.
    pub faces: [u32; 2],
}
