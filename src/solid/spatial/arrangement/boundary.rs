//! The facets between a set of cells and the rest, as a surface that is a 2-manifold by its
//! indices.

use super::cells::{Facet, Use};
use super::heal::Sewn;
use super::point::Point;
use crate::Fault;
use crate::numeric::index;
use crate::surface::Mates;
use crate::watch::{Stop, Work};

/// A closed 2-manifold of facets.
pub(super) struct Boundary {
    /// The triangles, oriented outwards.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Per triangle, a triangle of the input in the same plane.
    pub(super) planes: Vec<u32>,
    /// The point of each vertex; several vertices can have the same point.
    pub(super) points: Vec<u32>,
}

/// The facets with winding numbers below 1 on both sides. `front`: the winding number in front of
/// each facet.
pub(super) fn outside<'a>(
    facets: &'a [Facet],
    front: &'a [i32],
) -> impl Iterator<Item = &'a Facet> {
    facets.iter().zip(front).filter_map(|(facet, &front)| {
        let is_outside = front < 1 && front + facet.multiplicity < 1;
        is_outside.then_some(facet)
    })
}

/// The boundary of the cells with winding number at least 1. `front`: the winding number in front
/// of each facet.
pub(super) fn boundary(
    points: &[Point],
    facets: &[Facet],
    uses: &[Use],
    front: &[i32],
    work: Work,
) -> Result<Boundary, Stop> {
    let [sewing, healing] = work.parts([1, 1]);
    let items = sewing.items(uses.len());
    // The side of a facet on which the solid is.
    #[derive(Clone, Copy, PartialEq)]
    enum SolidSide {
        Neither,
        Behind,
        InFront,
    }
    let solid: Vec<SolidSide> = facets
        .iter()
        .zip(front)
        .map(
            |(facet, &front)| match (front >= 1, front + facet.multiplicity >= 1) {
                (false, true) => SolidSide::Behind,
                (true, false) => SolidSide::InFront,
                _ => SolidSide::Neither,
            },
        )
        .collect();
    let mut number_of = vec![u32::MAX; facets.len()];
    let mut planes = Vec::new();
    let mut triangles = Vec::new();
    for (number, facet) in facets.iter().enumerate() {
        work.check()?;
        if solid[number] != SolidSide::Neither {
            number_of[number] = index(triangles.len());
            planes.push(facet.plane);
            let [a, b, c] = facet.corners;
            let is_behind = solid[number] == SolidSide::Behind;
            triangles.push(if is_behind { [a, b, c] } else { [a, c, b] });
        }
    }
    let mut sewn = Sewn {
        mates: Mates::none(triangles.len()),
        is_kept: vec![true; triangles.len()],
        triangles,
    };
    let mut kept = Vec::<Use>::new();
    for run in uses.chunk_by(|a, b| a.edge == b.edge) {
        items.advance(run.len())?;
        kept.clear();
        kept.extend(
            run.iter()
                .filter(|u| solid[u.facet() as usize] != SolidSide::Neither)
                .copied(),
        );
        // Around the edge, the solid follows a facet when it is behind one that runs backward, or
        // in front of one that runs forward.
        let is_followed =
            |u: &Use| (solid[u.facet() as usize] == SolidSide::InFront) == u.is_forward();
        if kept.len() % 2 == 1 {
            return Err(Fault::new("the boundary of the region is not closed").into());
        }
        let shift = usize::from(kept.first().is_some_and(|u| !is_followed(u)));
        for pair in 0..kept.len() / 2 {
            let (one, two) = (
                kept[2 * pair + shift],
                kept[(2 * pair + shift + 1) % kept.len()],
            );
            if !is_followed(&one) || is_followed(&two) {
                return Err(Fault::new("the boundary of the region is not closed").into());
            }
            let edge_of = |u: &Use| {
                let number = number_of[u.facet() as usize];
                let ring = sewn.triangles[number as usize];
                // The edge is opposite the corner that is not one of its ends.
                let opposite = ring.iter().position(|p| !u.edge.contains(p)).unwrap_or(0);
                3 * number + index((opposite + 1) % 3)
            };
            let (one, two) = (edge_of(&one), edge_of(&two));
            sewn.mates.join(one, two);
        }
    }
    sewn.heal(points, healing)?;
    work.check()?;
    let corner = sewn.vertices();
    work.check()?;
    let mut vertex_of = vec![u32::MAX; corner.len()];
    let mut boundary = Boundary {
        triangles: Vec::new(),
        planes: Vec::new(),
        points: Vec::new(),
    };
    for (t, ring) in sewn.triangles.iter().enumerate() {
        if !sewn.is_kept[t] {
            continue;
        }
        boundary.triangles.push([0, 1, 2].map(|k| {
            let first = corner[3 * t + k] as usize;
            if vertex_of[first] == u32::MAX {
                vertex_of[first] = index(boundary.points.len());
                boundary.points.push(ring[k]);
            }
            vertex_of[first]
        }));
        boundary.planes.push(planes[t]);
    }
    Ok(boundary)
}
