//! The border to the arrangement engine: the only file that knows it.
//!
//! The engine (`manifold-rust`) cuts the surface along its self-intersections with exact predicates, labels the cells by
//! winding number and rounds the corners of the result to `f64`. It drops collinear points of straight edges.

use crate::numeric::index;
use glam::DVec3;
use manifold_rust::manifold::Manifold;
use manifold_rust::types::{Error, MeshGL64, WindingRule};

/// The boundary of {w >= 1} of a closed oriented surface that may cross itself, or the engine's refusal.
pub(super) fn positive_region(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
) -> Result<(Vec<DVec3>, Vec<[u32; 3]>), String> {
    let surface = MeshGL64 {
        num_prop: 3,
        vert_properties: positions.iter().flat_map(DVec3::to_array).collect(),
        tri_verts: triangles.iter().flatten().map(|&v| u64::from(v)).collect(),
        ..MeshGL64::default()
    };
    let region = Manifold::from_mesh_gl64_robust(&surface).rebuild_solid(WindingRule::Positive);
    match region.status() {
        Error::NoError => {}
        refusal => return Err(format!("{refusal:?}")),
    }
    let mesh = region.get_mesh_gl64(-1);
    let stride = usize::try_from(mesh.num_prop).unwrap_or(3).max(3);
    let positions = mesh
        .vert_properties
        .chunks_exact(stride)
        .map(|p| DVec3::new(p[0], p[1], p[2]))
        .collect();
    let vertices: Vec<u32> = mesh
        .tri_verts
        .iter()
        .map(|&v| index(usize::try_from(v).expect("the engine numbers vertices with 32 bits")))
        .collect();
    let triangles = vertices
        .chunks_exact(3)
        .map(|t| [t[0], t[1], t[2]])
        .collect();
    Ok((positions, triangles))
}
