//! The region around which a self-crossing closed surface winds at least once, by exact
//! arrangement.
//!
//! [`surface`] puts the input on an integer grid. [`pairs`] finds what triangles have in common,
//! [`network`] numbers and joins the points, [`cut`] cuts every plane along them, [`cells`] finds
//! the cells between the facets and their winding numbers, [`boundary`] keeps the facets between
//! winding numbers below and above 1, [`simplify`] removes what cuts left behind. All decisions are
//! exact ([`point`]); only the coordinates of the result are rounded.

mod boundary;
mod cells;
mod cut;
#[cfg(test)]
mod fuzz;
mod heal;
mod join;
mod network;
mod pairs;
mod point;
mod simplify;
mod surface;
#[cfg(test)]
mod tests;
mod triangulation;

use crate::Fault;
use crate::bounds::SurfaceTree;
use crate::numeric::index;
use crate::watch::{Interrupted, Stop, Work};
use cells::{Arrangement, Facet};
use glam::DVec3;
use network::Network;
use point::Point;
use rayon::prelude::*;
use surface::GridSurface;

/// How to treat the parts of a surface that lie on each other and cancel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Cancelled {
    /// They bound nothing, and are left out.
    Dropped,
    /// They are kept with multiplicity 0, so that it is known whether they are outside the region.
    Kept,
}

/// The region around which a closed surface winds at least once.
pub(super) struct PositiveRegion {
    /// Its boundary: positions, and triangles oriented outwards.
    pub(super) boundary: (Vec<DVec3>, Vec<[u32; 3]>),
    /// The parts of the surface that neither bound the region nor are inside it: w < 1 on both of
    /// their sides. If cancelling parts were kept, those outside are among them.
    pub(super) outside: Vec<[DVec3; 3]>,
}

/// A triangle of the arrangement: nothing crosses it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ArrangedFacet {
    /// In world coordinates, rounded.
    pub corners: [DVec3; 3],
    /// Winding number on the side of the normal.
    pub in_front: i32,
    /// Winding number on the other side.
    pub behind: i32,
}

/// The function that is shown the arrangement, if any.
pub(crate) type ShowFacets<'a> = Option<&'a dyn Fn(&[ArrangedFacet])>;

/// The region {w >= 1} of a closed oriented surface that may cross itself, or why there is none.
///
/// - `positions`: #V finite points.
/// - `triangles`: #F index triples; every edge is run through equally often in both senses.
/// - `cancelled`: how to treat parts that cancel; if kept, they are cut like all others.
/// - `show`: is shown the arrangement with its winding numbers.
/// - `work`: the work of all this.
///
/// # Guarantee
/// The boundary is a closed 2-manifold, oriented outwards; positions occur more than once where the
/// region touches itself, and there two edges may have the same two ends. It is the boundary of the exact region of the surface on a
/// grid of 2^-52 of its largest coordinate, except that corners at crossings are rounded. The
/// result has the same bits for any number of threads.
///
/// # Cost
/// O((n + k) log n) for `k` pairs of triangles that meet, some 10 microseconds per pair; parallel.
pub(super) fn positive_region(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    cancelled: Cancelled,
    show: ShowFacets,
    work: Work,
) -> Result<PositiveRegion, Stop> {
    let parts = work.parts([5, 5, 30, 10, 35, 5, 5, 5]);
    let [
        gridding,
        boxing,
        pairing,
        linking,
        cutting,
        joining,
        turning,
        rest,
    ] = parts;
    let [numbering, sewing, simplifying] = rest.parts([2, 1, 2]);
    let surface = GridSurface::new(positions, triangles, cancelled, gridding)?;
    let tree = SurfaceTree::during(boxing, &surface.corners, &surface.triangles)?;
    let facts = pairs::facts(&surface, &tree, pairing)?;
    let network = Network::new(&surface, facts, linking)?;
    let pieces = cut_all(&surface, &network, cancelled, cutting)?;
    let Network { points, plane, .. } = network;
    let Pieces { points, facets } = joined(&surface, points, pieces, joining)?;
    let arrangement = Arrangement {
        surface: &surface,
        tree: &tree,
        points: &points,
        facets: &facets,
        plane: &plane,
    };
    let uses = arrangement.uses(turning)?;
    let front = arrangement.winding_numbers(&uses, numbering)?;
    let place = |corner: u32| points[corner as usize].place(&surface);
    if let Some(show) = show {
        let arranged = |(facet, &in_front): (&Facet, &i32)| ArrangedFacet {
            corners: facet.corners.map(place),
            in_front,
            behind: in_front + facet.multiplicity,
        };
        let arranged: Vec<ArrangedFacet> = facets.iter().zip(&front).map(arranged).collect();
        show(&arranged);
    }
    let boundary = boundary::boundary(&points, &facets, &uses, &front, sewing)?;
    let outside = boundary::outside(&facets, &front)
        .map(|facet| facet.corners.map(place))
        .collect();
    drop((front, uses));
    Ok(PositiveRegion {
        boundary: simplify::simplified(&surface, &points, &plane, boundary, simplifying)?,
        outside,
    })
}

/// Planes per parallel task: a constant, so that the order does not depend on the number of
/// threads.
const PIECE: usize = 256;

/// The result of cutting some planes, or all.
struct Pieces {
    points: Vec<Point>,
    facets: Vec<Facet>,
}

/// Cuts every plane. Corners beyond the points of the network are the points of the task.
fn cut_all(
    surface: &GridSurface,
    network: &Network,
    cancelled: Cancelled,
    work: Work,
) -> Result<Vec<Pieces>, Stop> {
    let mut sets: Vec<(u32, u32)> = (0..index(surface.triangles.len()))
        .map(|t| (network.cluster[t as usize], t))
        .collect();
    work.sort(&mut sets)?;
    let planes: Vec<&[(u32, u32)]> = sets.chunk_by(|a, b| a.0 == b.0).collect();
    let items = work.items(planes.len());
    planes
        .par_chunks(PIECE)
        .map(|planes| {
            let mut piece = Pieces {
                points: Vec::new(),
                facets: Vec::new(),
            };
            for plane in planes {
                items.next()?;
                cut_plane(surface, network, plane, cancelled, &mut piece)?;
            }
            piece.points.shrink_to_fit();
            piece.facets.shrink_to_fit();
            Ok(piece)
        })
        .collect()
}

/// Adds the cut triangles of a plane, given with its number, to a result.
fn cut_plane(
    surface: &GridSurface,
    network: &Network,
    plane: &[(u32, u32)],
    cancelled: Cancelled,
    piece: &mut Pieces,
) -> Result<(), Fault> {
    let first = plane[0].1;
    let is_whole = plane.len() == 1
        && network.segments_of(first).is_empty()
        && surface.triangle_edges[first as usize]
            .iter()
            .all(|&edge| network.on_edge(edge).is_empty());
    if is_whole {
        piece.facets.push(Facet {
            corners: surface.triangles[first as usize],
            multiplicity: surface.multiplicity[first as usize],
            plane: first,
        });
        return Ok(());
    }
    let members: Vec<u32> = plane.iter().map(|&(_, t)| t).collect();
    let cut = cut::cut(surface, network, &members, cancelled)?;
    let known = network.points.len();
    let shift = index(piece.points.len());
    piece.points.extend(cut.points);
    piece
        .facets
        .extend(cut.triangles.iter().map(|(corners, multiplicity)| Facet {
            corners: corners.map(|v| if v as usize >= known { v + shift } else { v }),
            multiplicity: *multiplicity,
            plane: first,
        }));
    Ok(())
}

/// All points and facets, equal points joined.
fn joined(
    surface: &GridSurface,
    mut points: Vec<Point>,
    pieces: Vec<Pieces>,
    work: Work,
) -> Result<Pieces, Interrupted> {
    let known = points.len();
    points.reserve_exact(pieces.iter().map(|piece| piece.points.len()).sum());
    let mut facets = Vec::with_capacity(pieces.iter().map(|piece| piece.facets.len()).sum());
    for piece in pieces {
        work.check()?;
        let shift = index(points.len() - known);
        points.extend(piece.points);
        facets.extend(piece.facets.into_iter().map(|facet| {
            Facet {
                corners: facet
                    .corners
                    .map(|v| if v as usize >= known { v + shift } else { v }),
                ..facet
            }
        }));
    }
    let first = join::first_equal(surface, &points, work)?;
    facets
        .iter_mut()
        .for_each(|facet| facet.corners = facet.corners.map(|v| first[v as usize]));
    Ok(Pieces { points, facets })
}
