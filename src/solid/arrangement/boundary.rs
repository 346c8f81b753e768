//! The facets between a set of cells and the rest, as a surface that is a 2-manifold in its indices.

use super::cells::{Facet, Use};
use super::network::{join, root};
use crate::numeric::index;

/// A closed 2-manifold of facets.
pub(super) struct Boundary {
    /// Outward.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Per triangle a triangle of the input in the same plane.
    pub(super) planes: Vec<u32>,
    /// Point of each vertex; more than one vertex can have the same.
    pub(super) points: Vec<u32>,
}

/// The boundary of the cells with winding number 1 and more. `front`: the winding number in front of every facet.
pub(super) fn boundary(facets: &[Facet], uses: &[Use], front: &[i32]) -> Result<Boundary, String> {
    // Whether the solid is behind the facet or in front.
    #[derive(Clone, Copy, PartialEq)]
    enum Solid {
        Neither,
        Behind,
        InFront,
    }
    let solid: Vec<Solid> = facets
        .iter()
        .zip(front)
        .map(
            |(facet, &front)| match (front >= 1, front + facet.multiplicity >= 1) {
                (false, true) => Solid::Behind,
                (true, false) => Solid::InFront,
                _ => Solid::Neither,
            },
        )
        .collect();
    // Three corners per facet; corners that meet across an edge of the boundary are one vertex.
    let mut corner: Vec<u32> = (0..3 * index(facets.len())).collect();
    let corner_at = |facet: u32, point: u32| {
        let corners = facets[facet as usize].corners;
        3 * facet + index(corners.iter().position(|&c| c == point).unwrap_or(0))
    };
    let mut kept = Vec::<Use>::new();
    for run in uses.chunk_by(|a, b| a.edge == b.edge) {
        kept.clear();
        kept.extend(
            run.iter()
                .filter(|u| solid[u.facet as usize] != Solid::Neither)
                .copied(),
        );
        // The solid follows a facet round the edge when it is behind one that runs backward or before one that runs forward.
        let is_followed = |u: &Use| (solid[u.facet as usize] == Solid::InFront) == u.is_forward;
        if kept.len() % 2 == 1 {
            return Err("the boundary of the region is not closed".to_owned());
        }
        let shift = usize::from(kept.first().is_some_and(|u| !is_followed(u)));
        for pair in 0..kept.len() / 2 {
            let (one, two) = (
                kept[2 * pair + shift],
                kept[(2 * pair + shift + 1) % kept.len()],
            );
            if !is_followed(&one) || is_followed(&two) {
                return Err("the boundary of the region is not closed".to_owned());
            }
            for end in one.edge {
                join(
                    &mut corner,
                    corner_at(one.facet, end),
                    corner_at(two.facet, end),
                );
            }
        }
    }
    let mut vertex_of = vec![u32::MAX; corner.len()];
    let mut boundary = Boundary {
        triangles: Vec::new(),
        planes: Vec::new(),
        points: Vec::new(),
    };
    for (number, facet) in facets.iter().enumerate() {
        if solid[number] == Solid::Neither {
            continue;
        }
        let mut triangle = [0, 1, 2].map(|k| {
            let first = root(&mut corner, 3 * index(number) + index(k)) as usize;
            if vertex_of[first] == u32::MAX {
                vertex_of[first] = index(boundary.points.len());
                boundary.points.push(facet.corners[k]);
            }
            vertex_of[first]
        });
        if solid[number] == Solid::InFront {
            triangle.swap(1, 2);
        }
        boundary.triangles.push(triangle);
        boundary.planes.push(facet.plane);
    }
    Ok(boundary)
}
