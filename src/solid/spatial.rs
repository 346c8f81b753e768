//! The swept solid of a triangle mesh.

use super::arrangement::positive_region;
use super::measure::{Measures, measure};
use super::pockets::{Filled, fill};
use super::rounding::{Rounded, to_single};
use super::shells::Shells;
use super::touching::separate;
use crate::envelope::spatial::SweepCycle;
use crate::membership::Membership;
use glam::DVec3;

/// A closed oriented boundary in the world, outward, with its measures.
#[derive(Debug, Clone)]
pub struct Solid {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    measures: Measures,
}

impl Solid {
    fn new(mut positions: Vec<DVec3>, mut triangles: Vec<[u32; 3]>) -> Solid {
        let touching_edges = separate(&mut positions, &mut triangles);
        let measures = Measures {
            touching_edges,
            ..measure(&positions, &triangles, &Shells::new(&triangles))
        };
        Solid {
            positions,
            triangles,
            measures,
        }
    }

    /// #V positions; where the region touches itself, one position occurs more than once.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// #F index triples, counter-clockwise from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Volume, area, topology.
    pub fn measures(&self) -> &Measures {
        &self.measures
    }

    /// The solid with all coordinates representable as `f32`, for formats that store those, and how far a vertex moved
    /// at most.
    ///
    /// Vertices that fall together are joined by edge collapses that keep the surface a manifold; where that cannot be, one
    /// of them moves to the next free position.
    pub fn rounded_to_single(&self) -> (Solid, f64) {
        let Rounded {
            positions,
            triangles,
            largest_move,
        } = to_single(&self.positions, &self.triangles);
        let mut solid = Solid::new(positions, triangles);
        solid.measures.touching_edges += self.measures.touching_edges;
        (solid, largest_move)
    }
}

/// The swept solid with what was done to it.
pub(crate) struct SweptSolid {
    pub(crate) solid: Solid,
    /// Cavities that the sampling made and that were filled.
    pub(crate) filled: Filled,
}

/// A closed boundary before its pockets are looked at.
pub(crate) struct Region {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

/// The boundary of {w >= 1} of a sweep cycle, or the engine's refusal.
pub(crate) fn region(cycle: &SweepCycle) -> Result<Region, String> {
    let (positions, triangles) = positive_region(&cycle.positions, &cycle.triangles)?;
    Ok(Region {
        positions,
        triangles,
    })
}

/// Fills the pockets thinner than `error`, the bound of the cycle's sampling, that are inside the exact sweep.
pub(crate) fn fill_pockets(region: Region, error: f64, membership: &Membership) -> SweptSolid {
    let (triangles, filled) = fill(&region.positions, region.triangles, error, membership);
    let (positions, triangles) = without_unused(&region.positions, &triangles);
    SweptSolid {
        solid: Solid::new(positions, triangles),
        filled,
    }
}

fn without_unused(positions: &[DVec3], triangles: &[[u32; 3]]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut new_index = vec![None; positions.len()];
    let mut kept = Vec::new();
    let triangles = triangles
        .iter()
        .map(|t| {
            t.map(|v| {
                *new_index[v as usize].get_or_insert_with(|| {
                    kept.push(positions[v as usize]);
                    crate::numeric::index(kept.len() - 1)
                })
            })
        })
        .collect();
    (kept, triangles)
}
