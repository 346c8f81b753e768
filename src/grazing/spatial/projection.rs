//! Signs of the flux of a translation. They are exact for the given body, or for a body nearby.
//!
//! Seen along the displacement d of a translation, every face is a triangle in a plane, and its
//! flux has the sign of the sense in which that triangle is run through. Exact orientations of the
//! projected triangles are therefore exact signs: for the body if the projections of its vertices
//! are exact, and otherwise for a body whose vertices are moved by the rounding of the projections.
//!
//! Rounding turns faces that are parallel to d to one side or the other at random, and every change
//! of sign between neighbours would sweep a strip without width. So such faces are flattened first.
//! Vertices that coincide up to rounding when seen along d become one (the sides of a prism along
//! its axis). And the vertices of a *wall*, neighbouring faces that lie on one straight line up to
//! rounding, are moved onto that line (a flat side along d). Faces without area in projection count
//! as egress.
//!
//! # Why the signs are right
//! Let B' be the body with its vertices moved in this manner, none by more than `distance`, square
//! to d.
//! - Faces with two corners in one place, and those of a flattened wall, have no area: either sign
//!   is right for them.
//! - A wall is flattened only if at most two of its places belong to other walls as well: its line
//!   passes through these, and they do not move. Other walls keep their places, and the exact
//!   orientations of their faces.
//! - The height of all other faces in projection is at least four times the largest move: their
//!   orientation is the same in B'.
//!
//! # What is lost
//! For B', all terms of the formula in [`crate::envelope`] are nonnegative, so its sweep is
//! {w >= 1} of its cycle. Every point of the body is within `distance` of B', and the same holds
//! for the sweeps. The cycle of the given body with these signs differs from that of B' by a
//! homotopy that moves no point farther than `distance`. So the shortfall is at most twice that,
//! plus the distance of the pieces of the cycle that are left outside the result. This is proven
//! for bodies whose surface is not made to cross itself by these moves, which are roundings of its
//! own coordinates.

use crate::body::Mesh;
use crate::numeric::exact::signs::{Side, side_of_line};
use crate::numeric::tolerance::{PROJECTION, PROJECTION_ROUNDING, UNIT_ROUNDOFF};
use crate::numeric::{DisjointSets, index};
use crate::surface::{Welded, weld};
use glam::{DVec2, DVec3};
use std::collections::BTreeMap;

/// The signs of all faces under a translation.
#[derive(Debug, Clone, Default)]
pub(super) struct TranslationSigns {
    /// Whether each face is egress.
    pub(super) is_egress: Vec<bool>,
    /// Faces with a vertex that moved, ascending.
    pub(super) moved: Vec<u32>,
    /// Bound on the distance by which vertices moved; 0 when none did.
    pub(super) distance: f64,
}

/// The signs of the faces of `mesh`, with vertices `positions` (#V), under a translation by `way`.
///
/// O(n) expected, and a sort of the walls.
pub(super) fn signs(mesh: &Mesh, positions: &[DVec3], way: DVec3) -> TranslationSigns {
    let faces = mesh.triangles().len();
    let Some(along) = way.try_normalize() else {
        return TranslationSigns {
            is_egress: vec![true; faces],
            ..TranslationSigns::default()
        };
    };
    let (first, second) = along.any_orthonormal_pair();
    // Counter-clockwise where the normal points along the displacement.
    let is_right_handed = first.cross(second).dot(along) > 0.0;
    let [first, second] = if is_right_handed {
        [first, second]
    } else {
        [second, first]
    };
    let seen: Vec<DVec3> = positions
        .iter()
        .map(|p| DVec3::new(first.dot(*p), second.dot(*p), 0.0))
        .collect();
    let reach = positions
        .iter()
        .map(|p| p.abs().max_element())
        .fold(0.0, f64::max);
    let limit = PROJECTION * UNIT_ROUNDOFF * reach;
    let Welded {
        positions: places,
        place_of,
        largest_move,
        ..
    } = weld(&seen, &[], limit);
    let view = View {
        mesh,
        places: places.iter().map(|p| p.truncate()).collect(),
        place_of,
        limit,
    };
    let mut walls = view.walls();
    let mut distance = largest_move;
    for wall in &mut walls.list {
        view.lay_flat(wall, &walls.is_shared);
        distance = distance.max(wall.distance.unwrap_or(0.0));
    }
    let mut is_moved = vec![false; view.places.len()];
    for wall in walls.list.iter().filter(|wall| wall.distance > Some(0.0)) {
        wall.places
            .iter()
            .for_each(|&place| is_moved[place as usize] = true);
    }
    let mut signs = TranslationSigns {
        is_egress: Vec::with_capacity(faces),
        moved: Vec::new(),
        distance,
    };
    let mut is_doubtful = false;
    for (face, triangle) in mesh.triangles().iter().enumerate() {
        let corners = triangle.map(|v| view.place_of[v as usize]);
        let wall = walls.of_face[face].map(|wall| &walls.list[wall as usize]);
        let is_flat = wall.is_some_and(|wall| wall.distance.is_some());
        let side = if is_flat {
            Side::On
        } else {
            view.side(corners)
        };
        signs.is_egress.push(side != Side::Below);
        is_doubtful |= side == Side::On || wall.is_some();
        let moves = |v: u32| {
            let place = view.place_of[v as usize] as usize;
            is_moved[place] || seen[v as usize] != places[place]
        };
        if triangle.iter().any(|&v| moves(v)) {
            signs.moved.push(index(face));
        }
    }
    let is_exact = (0..3).filter(|&i| way[i] != 0.0).count() == 1;
    if is_doubtful && !is_exact {
        signs.distance += PROJECTION_ROUNDING * UNIT_ROUNDOFF * reach;
    }
    signs
}

/// A body seen along the displacement.
struct View<'a> {
    mesh: &'a Mesh,
    places: Vec<DVec2>,
    /// The place of each vertex.
    place_of: Vec<u32>,
    /// Largest distance by which a place may move.
    limit: f64,
}

/// Neighbouring faces with hardly any area in projection, though their corners are different
/// places.
#[derive(Debug, Default)]
struct Wall {
    places: Vec<u32>,
    /// For a flattened wall, the largest distance of a place from the line.
    distance: Option<f64>,
}

struct Walls {
    list: Vec<Wall>,
    /// Per face, the wall to which it belongs.
    of_face: Vec<Option<u32>>,
    /// Per place, whether it belongs to more than one wall.
    is_shared: Vec<bool>,
}

impl View<'_> {
    fn at(&self, place: u32) -> DVec2 {
        self.places[place as usize]
    }

    /// The sense in which three places are run through; `Above` is counter-clockwise.
    fn side(&self, corners: [u32; 3]) -> Side {
        let [a, b, c] = corners;
        if a == b || b == c || c == a {
            return Side::On;
        }
        side_of_line(self.at(a), self.at(b), self.at(c))
    }

    fn is_thin(&self, corners: [u32; 3]) -> bool {
        let [a, b, c] = corners;
        if a == b || b == c || c == a {
            return false;
        }
        let [a, b, c] = corners.map(|place| self.at(place));
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        (b - a).perp_dot(c - a).abs() <= 4.0 * self.limit * longest
    }

    fn walls(&self) -> Walls {
        let triangles = self.mesh.triangles();
        let corners = |face: u32| triangles[face as usize].map(|v| self.place_of[v as usize]);
        let is_thin: Vec<bool> = (0..index(triangles.len()))
            .map(|face| self.is_thin(corners(face)))
            .collect();
        let mut sets = DisjointSets::new(triangles.len());
        for edge in self.mesh.edges() {
            let [a, b] = edge.vertices.map(|v| self.place_of[v as usize]);
            let [f, g] = edge.faces;
            if a != b && is_thin[f as usize] && is_thin[g as usize] {
                sets.join(f, g);
            }
        }
        let mut number_of = BTreeMap::<u32, u32>::new();
        let mut walls = Walls {
            list: Vec::new(),
            of_face: vec![None; triangles.len()],
            is_shared: vec![false; self.places.len()],
        };
        for face in 0..index(triangles.len()) {
            if is_thin[face as usize] {
                let first = sets.first(face);
                let number = *number_of.entry(first).or_insert_with(|| {
                    walls.list.push(Wall::default());
                    index(walls.list.len() - 1)
                });
                walls.of_face[face as usize] = Some(number);
                walls.list[number as usize].places.extend(corners(face));
            }
        }
        let mut is_seen = vec![false; self.places.len()];
        for wall in &mut walls.list {
            wall.places.sort_unstable();
            wall.places.dedup();
            for &place in &wall.places {
                walls.is_shared[place as usize] |=
                    std::mem::replace(&mut is_seen[place as usize], true);
            }
        }
        walls
    }

    /// Flattens a wall onto a line through the places that it shares with others, if there are at
    /// most two of them and all others are near the line.
    fn lay_flat(&self, wall: &mut Wall, is_shared: &[bool]) {
        let shared: Vec<u32> = wall
            .places
            .iter()
            .copied()
            .filter(|&place| is_shared[place as usize])
            .collect();
        let farthest = |from: u32| {
            let gap = |&place: &u32| self.at(place).distance_squared(self.at(from));
            wall.places
                .iter()
                .copied()
                .max_by(|a, b| gap(a).total_cmp(&gap(b)))
        };
        let ends = match shared[..] {
            [] => farthest(wall.places[0]).and_then(|a| Some([a, farthest(a)?])),
            [a] => farthest(a).map(|b| [a, b]),
            [a, b] => Some([a, b]),
            _ => None,
        };
        let Some([from, to]) = ends.map(|ends| ends.map(|end| self.at(end))) else {
            return;
        };
        let line = (to - from).normalize_or_zero();
        let off = |&place: &u32| line.perp_dot(self.at(place) - from).abs();
        let distance = wall.places.iter().map(off).fold(0.0, f64::max);
        if line != DVec2::ZERO && distance <= self.limit {
            wall.distance = Some(distance);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DAffine3, DQuat};

    fn mesh(shape: (Vec<DVec3>, Vec<[u32; 3]>)) -> Mesh {
        Mesh::new(shape.0, shape.1).expect("a body")
    }

    fn box_of(size: DVec3) -> Mesh {
        mesh(crate::samples::cuboid(DVec3::ZERO, size))
    }

    fn tilt() -> DAffine3 {
        DAffine3::from_quat(DQuat::from_scaled_axis(DVec3::new(0.3, -0.8, 0.5)))
    }

    /// Number of pairs of neighbours with different signs.
    fn changes(mesh: &Mesh, signs: &TranslationSigns) -> usize {
        let differ = |faces: [u32; 2]| {
            signs.is_egress[faces[0] as usize] != signs.is_egress[faces[1] as usize]
        };
        mesh.edges()
            .iter()
            .filter(|edge| differ(edge.faces))
            .count()
    }

    #[test]
    fn a_box_along_an_axis_moves_nothing() {
        let body = box_of(DVec3::new(1.0, 2.0, 3.0));
        let found = signs(&body, body.positions(), DVec3::Z);
        assert_eq!((found.distance, found.moved.len()), (0.0, 0));
        assert_eq!(changes(&body, &found), 4, "round the lower side");
    }

    #[test]
    fn a_tilted_box_keeps_its_sides_whole_along_an_edge_and_along_a_side() {
        let body = box_of(DVec3::new(1.0, 2.0, 3.0)).transformed(&tilt());
        for (way, expected) in [(DVec3::Z, 4), (DVec3::new(0.4, 0.0, 1.0), 6)] {
            let found = signs(&body, body.positions(), tilt().transform_vector3(way));
            assert!(found.distance > 0.0 && found.distance < 1e-14, "{found:?}");
            assert_eq!(changes(&body, &found), expected, "{way}");
        }
    }

    #[test]
    fn faces_that_are_clear_have_the_sign_of_their_flux() {
        let body = box_of(DVec3::new(1.0, 2.0, 3.0)).transformed(&tilt());
        let way = DVec3::new(0.2, 0.9, -0.4);
        let found = signs(&body, body.positions(), way);
        assert_eq!(found.distance, 0.0, "nothing is in doubt");
        for (triangle, egress) in body.triangles().iter().zip(&found.is_egress) {
            let [a, b, c] = triangle.map(|v| body.positions()[v as usize]);
            assert_eq!((b - a).cross(c - a).dot(way) > 0.0, *egress);
        }
    }

    #[test]
    fn a_body_at_rest_leaves_everywhere() {
        let body = box_of(DVec3::ONE);
        let found = signs(&body, body.positions(), DVec3::ZERO);
        assert!(found.is_egress.iter().all(|&egress| egress) && found.distance == 0.0);
    }
}
