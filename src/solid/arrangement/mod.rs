//! The region where a self-crossing closed surface winds round at least once, by exact arrangement.
//!
//! [`surface`] puts the input on an integer grid. [`pairs`] finds what triangles have in common, [`network`] names and joins
//! the points, [`cut`] cuts every plane along them, [`cells`] finds the cells between the facets and their winding
//! numbers, [`boundary`] keeps the facets between winding numbers below and above 1, [`simplify`] removes what cuts left
//! behind. All decisions are exact ([`exact`]); only the coordinates of the result are rounded.

mod boundary;
mod cells;
mod cut;
mod double;
mod exact;
mod heal;
mod join;
mod network;
mod pairs;
mod simplify;
mod surface;
#[cfg(test)]
mod tests;
mod triangulation;

use crate::bounds::SurfaceTree;
use crate::numeric::index;
use cells::{Arrangement, Facet};
use cut::Cut;
use exact::Point;
use glam::DVec3;
use network::Network;
use rayon::prelude::*;
use surface::Surface;

/// The boundary of {w >= 1} of a closed oriented surface that may cross itself, or why there is none.
///
/// - `positions`: #V finite points.
/// - `triangles`: #F index triples; every edge is run through equally often both ways.
///
/// # Guarantee
/// A closed 2-manifold in its indices, outward; positions occur more than once where the region touches itself. It is the
/// boundary of the exact region of the surface on a grid of 2^-52 of its largest coordinate, with the corners that the
/// crossings make rounded. The same bits for any number of threads.
///
/// # Cost
/// O((n + k) log n) for `k` pairs of triangles that meet, some 10 microseconds per pair; parallel.
pub(super) fn positive_region(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
) -> Result<(Vec<DVec3>, Vec<[u32; 3]>), String> {
    let surface = Surface::new(positions, triangles)?;
    let tree = SurfaceTree::new(&surface.corners, &surface.triangles);
    let facts = pairs::facts(&surface, &tree);
    let network = Network::new(&surface, &facts);
    drop(facts);
    let (points, facets) = cut_all(&surface, &network)?;
    let arrangement = Arrangement {
        surface: &surface,
        tree: &tree,
        points: &points,
        facets: &facets,
        plane: &network.plane,
    };
    let uses = arrangement.uses()?;
    let front = arrangement.winding_numbers(&uses)?;
    let boundary = boundary::boundary(&points, &facets, &uses, &front)?;
    Ok(simplify::simplified(
        &surface,
        &points,
        &network.plane,
        boundary,
    ))
}

/// Cuts every plane; all points and facets of the arrangement.
fn cut_all(surface: &Surface, network: &Network) -> Result<(Vec<Point>, Vec<Facet>), String> {
    let mut sets: Vec<(u32, u32)> = (0..index(surface.triangles.len()))
        .map(|t| (network.cluster[t as usize], t))
        .collect();
    sets.sort_unstable();
    let members: Vec<Vec<u32>> = sets
        .chunk_by(|a, b| a.0 == b.0)
        .map(|set| set.iter().map(|&(_, t)| t).collect())
        .collect();
    let cuts: Vec<Cut> = members
        .par_iter()
        .map(|members| {
            let triangle = members[0];
            let is_whole = members.len() == 1
                && network.segments_of(triangle).is_empty()
                && surface.triangle_edges[triangle as usize]
                    .iter()
                    .all(|&edge| network.on_edge(edge).is_empty());
            if is_whole {
                let whole = surface.triangles[triangle as usize];
                return Ok(Cut {
                    points: Vec::new(),
                    triangles: vec![(whole, surface.multiplicity[triangle as usize])],
                });
            }
            cut::cut(surface, network, members)
        })
        .collect::<Result<_, String>>()?;
    let known = network.points.len();
    let mut points = network.points.clone();
    let mut facets = Vec::with_capacity(cuts.iter().map(|cut| cut.triangles.len()).sum());
    for (cut, members) in cuts.iter().zip(&members) {
        let shift = index(points.len() - known);
        points.extend(&cut.points);
        facets.extend(cut.triangles.iter().map(|(corners, multiplicity)| Facet {
            corners: corners.map(|v| if v as usize >= known { v + shift } else { v }),
            multiplicity: *multiplicity,
            plane: members[0],
        }));
    }
    let first = join::first_equal(surface, &points);
    facets
        .iter_mut()
        .for_each(|facet| facet.corners = facet.corners.map(|v| first[v as usize]));
    Ok((points, facets))
}
