//! Half-edges that know their mates: how the triangles of a closed surface are connected.
//!
//! Half-edge 3 t + k runs from corner k of triangle t to the next. Its mate is the half-edge on the
//! other side of the edge, which runs in the opposite sense. Where more than two triangles meet at
//! an edge, the mates determine which of them belong together, and so which corners are one vertex.
//! This module knows no vertices or positions.

use crate::numeric::{DisjointSets, index};

/// The mate of each half-edge.
pub(crate) struct Mates(Vec<u32>);

/// The entry of a half-edge that has no mate yet.
const ALONE: u32 = u32::MAX;

impl Mates {
    /// The mates of `triangles` triangles that are not yet connected.
    pub(crate) fn none(triangles: usize) -> Mates {
        Mates(vec![ALONE; 3 * triangles])
    }

    /// Adds a triangle that is not yet connected.
    pub(crate) fn push(&mut self) {
        self.0.extend([ALONE; 3]);
    }

    /// Number of half-edges.
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    pub(crate) fn of(&self, half: u32) -> u32 {
        self.0[half as usize]
    }

    /// Makes two half-edges mates.
    pub(crate) fn join(&mut self, one: u32, two: u32) {
        self.0[one as usize] = two;
        self.0[two as usize] = one;
    }

    /// Makes the mates of two half-edges, which are about to be removed, mates of each other.
    pub(crate) fn sew(&mut self, one: u32, two: u32) {
        let (a, b) = (self.of(one), self.of(two));
        if a != two {
            self.join(a, b);
        }
    }

    /// The half-edges that start where `half` does, counter-clockwise from it.
    pub(crate) fn fan(&self, half: u32) -> impl Iterator<Item = u32> {
        let turn = |h: u32| self.of(next_in(next_in(h)));
        std::iter::successors(Some(half), move |&h| Some(turn(h)).filter(|&t| t != half))
    }

    /// For each corner, 3 t + k, the first corner of the same vertex; `counts` tells which
    /// triangles are part of the surface.
    pub(crate) fn vertices(&self, counts: impl Fn(u32) -> bool) -> Vec<u32> {
        let mut corners = DisjointSets::new(self.len());
        for half in (0..index(self.len())).filter(|&half| counts(half / 3)) {
            let mate = self.of(half);
            corners.join(half, next_in(mate));
            corners.join(next_in(half), mate);
        }
        corners.firsts()
    }

    /// The pairs of triangles that meet at an edge; `counts` tells which triangles are part of the
    /// surface.
    pub(crate) fn neighbours(
        &self,
        counts: impl Fn(u32) -> bool,
    ) -> impl Iterator<Item = [u32; 2]> {
        let halves = (0..index(self.len())).filter(move |&half| counts(half / 3));
        halves.map(|half| [half / 3, self.of(half) / 3])
    }
}

/// The half-edge after another in its triangle; also the corner at which the other ends.
pub(crate) fn next_in(half: u32) -> u32 {
    half / 3 * 3 + (half % 3 + 1) % 3
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Sides;

    /// The mates of a tetrahedron, and a fifth triangle.
    fn tetrahedron() -> Mates {
        let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let mut mates = Mates::none(4);
        for edge in Sides::new(&triangles).edges() {
            let [there, back] = edge.pair().expect("closed");
            mates.join(there, back);
        }
        mates
    }

    #[test]
    fn the_corners_of_a_tetrahedron_are_four_vertices() {
        let mates = tetrahedron();
        let first = mates.vertices(|_| true);
        // Triangles [0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3], as numbers of corners.
        assert_eq!(first, [0, 1, 2, 0, 2, 5, 2, 1, 5, 1, 0, 5]);
        for half in 0..12 {
            let fan: Vec<u32> = mates.fan(half).collect();
            assert_eq!(fan.len(), 3, "three triangles at every vertex");
            let at = |corner: u32| first[corner as usize];
            assert!(fan.iter().all(|&h| at(h) == at(half)), "of one vertex");
        }
    }

    #[test]
    fn what_is_sewn_closes_over_what_goes() {
        // Triangle 0 is removed: its neighbours at two of its edges become neighbours of each
        // other.
        let mut mates = tetrahedron();
        let [a, b] = [mates.of(0), mates.of(1)];
        mates.sew(0, 1);
        assert_eq!([mates.of(a), mates.of(b)], [b, a]);
        // Removing two half-edges that are mates of each other leaves no half-edge without a mate.
        let mut mates = tetrahedron();
        let [a, b] = [0, mates.of(0)];
        mates.sew(a, b);
        assert_eq!([mates.of(a), mates.of(b)], [b, a]);
    }

    #[test]
    fn a_new_triangle_is_by_itself() {
        let mut mates = tetrahedron();
        mates.push();
        assert_eq!(mates.len(), 15);
        assert_eq!(mates.of(12), ALONE, "it has no neighbours");
        let whole = mates.neighbours(|triangle| triangle < 4).count();
        assert_eq!(whole, 12, "three of each of the others");
    }
}
