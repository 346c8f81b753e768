//! A closed oriented triangle mesh.

use super::BodyError;
use glam::{DAffine3, DVec3};

/// An edge of a closed mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    /// Smaller index first.
    pub vertices: [u32; 2],
    /// Face that runs through the edge from `vertices[0]` to `vertices[1]`, then the one that runs back.
    pub faces: [u32; 2],
}

/// A closed, oriented, finite triangle mesh.
#[derive(Debug, Clone)]
pub struct Mesh {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    edges: Vec<Edge>,
    turned: bool,
}

impl Mesh {
    /// Checks the triangle list.
    pub fn new(_positions: Vec<DVec3>, _triangles: Vec<[u32; 3]>) -> Result<Mesh, BodyError> {
        todo!()
    }
    /// #V positions.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }
    /// #F index triples, counter-clockwise from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }
    /// Every edge once, sorted by `vertices`.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }
    /// Whether the input was inside out as a whole and all triangles were reversed.
    pub fn turned(&self) -> bool {
        self.turned
    }
    /// Image under an affinity of positive determinant.
    pub fn transformed(&self, _pose: &DAffine3) -> Mesh {
        todo!()
    }
    /// Signed volume.
    pub fn volume(&self) -> f64 {
        todo!()
    }
    /// Least box [min, max].
    pub fn bounds(&self) -> [DVec3; 2] {
        todo!()
    }
    /// Length of the diagonal of the box.
    pub fn diagonal(&self) -> f64 {
        todo!()
    }
}
