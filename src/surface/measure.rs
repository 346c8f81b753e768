//! Measures of a closed boundary: what it encloses, and what a reader finds.

use super::shells::{Shells, genus};
use super::sides::Sides;
use glam::DVec3;
use std::collections::HashMap;

/// Measures of a solid, in the units of its coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Measures {
    /// Enclosed volume.
    pub volume: f64,
    /// Area of the boundary, including voids.
    pub area: f64,
    /// Number of connected solid pieces.
    pub components: usize,
    /// Number of bounded cavities.
    pub voids: usize,
    /// Number of handles, summed over the shells of the boundary.
    pub genus: usize,
    /// The smallest box \[min, max\] around it; zero for an empty solid.
    pub bounds: [DVec3; 2],
    /// Whether every edge is run through equally often in both senses, where equal positions count
    /// as one vertex.
    pub watertight: bool,
    /// Whether every edge has two triangles, where equal positions count as one vertex.
    pub manifold: bool,
    /// Number of edges along which the region touches itself. The parts of the boundary that met
    /// there have been moved apart, by no more than the error bound accounts for.
    pub touching_edges: usize,
}

/// Signed volume of the cones from `centre` over some triangles, and their area.
pub(crate) fn volume_and_area(
    positions: &[DVec3],
    triangles: impl Iterator<Item = [u32; 3]>,
    centre: DVec3,
) -> (f64, f64) {
    let (mut volume, mut area) = (0.0, 0.0);
    for triangle in triangles {
        let [a, b, c] = triangle.map(|v| positions[v as usize] - centre);
        let normal = (b - a).cross(c - a);
        volume += a.dot(normal) / 6.0;
        area += normal.length() / 2.0;
    }
    (volume, area)
}

/// The measures of the boundary of a solid. O(n).
pub(crate) fn measure(positions: &[DVec3], triangles: &[[u32; 3]], shells: &Shells) -> Measures {
    let bounds = bounds_of(triangles.iter().flatten().map(|&v| positions[v as usize]));
    let centre = bounds[0].midpoint(bounds[1]);
    let mut measures = Measures {
        volume: 0.0,
        area: 0.0,
        components: 0,
        voids: 0,
        genus: 0,
        bounds,
        watertight: true,
        manifold: true,
        touching_edges: 0,
    };
    for members in &shells.members {
        let (volume, area) = volume_and_area(
            positions,
            members.iter().map(|&t| triangles[t as usize]),
            centre,
        );
        measures.volume += volume;
        measures.area += area;
        measures.genus += genus(triangles, members);
        if volume > 0.0 {
            measures.components += 1;
        } else {
            measures.voids += 1;
        }
    }
    for edge in sides_by_position(positions, triangles).edges() {
        measures.watertight &= edge.is_closed();
        measures.manifold &= edge.pair().is_some();
    }
    measures
}

/// The number of edges with more than two triangles, where equal positions count as one vertex.
pub(crate) fn touching_edges(positions: &[DVec3], triangles: &[[u32; 3]]) -> usize {
    let sides = sides_by_position(positions, triangles);
    sides.edges().filter(|edge| edge.len() > 2).count()
}

/// The smallest box around points; zero when there are none.
pub(crate) fn bounds_of(mut points: impl Iterator<Item = DVec3>) -> [DVec3; 2] {
    let first = points.next().unwrap_or_default();
    points.fold([first; 2], |[low, high], p| [low.min(p), high.max(p)])
}

/// The sides of triangles, where equal positions count as one vertex.
fn sides_by_position(positions: &[DVec3], triangles: &[[u32; 3]]) -> Sides {
    let mut first_at = HashMap::<[u64; 3], u32>::with_capacity(positions.len());
    let vertex: Vec<u32> = positions
        .iter()
        .zip(0..)
        .map(|(p, v)| {
            *first_at
                .entry((*p + DVec3::ZERO).to_array().map(f64::to_bits))
                .or_insert(v)
        })
        .collect();
    let joined: Vec<[u32; 3]> = triangles
        .iter()
        .map(|corners| corners.map(|v| vertex[v as usize]))
        .collect();
    Sides::new(&joined)
}
