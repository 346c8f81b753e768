//! A closed triangle mesh whose half-edges know their mates, and surgery on it along loops.

use super::mates::{Mates, next_in};
use super::pairing::pairs_around;
use super::sides::Sides;
use crate::Fault;
use crate::numeric::index;
use glam::DVec3;
use std::collections::{BTreeSet, HashMap, VecDeque};

/// A closed oriented surface, a 2-manifold by its indices. Half-edge 3 t + k runs from corner k of
/// triangle t to the next.
pub(crate) struct Halves {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    mates: Mates,
    /// For each vertex, a half-edge that starts there.
    starts: Vec<u32>,
}

impl Halves {
    /// The half-edges of a surface. Where more than two triangles share an edge, they are paired so
    /// that each pair encloses solid; a vertex with more than one fan of triangles becomes several
    /// vertices at one position.
    ///
    /// # Errors
    /// [`Fault`] when the surface is not closed.
    pub(crate) fn new(positions: &[DVec3], triangles: &[[u32; 3]]) -> Result<Halves, Fault> {
        let mut mates = Mates::none(triangles.len());
        for edge in Sides::new(triangles).edges() {
            if !edge.is_closed() {
                return Err(Fault::new("an edge of the boundary has one side only"));
            }
            if let Some([there, back]) = edge.pair() {
                mates.join(there, back);
                continue;
            }
            let mut halves: Vec<u32> = edge.halves().collect();
            halves.sort_unstable();
            // Seen in the sense of the first triangle.
            let [a, b] = edge.ends;
            let along = if edge.there().next() == Some(halves[0]) {
                [a, b]
            } else {
                [b, a]
            };
            for [there, back] in pairs_around(positions, triangles, along, &halves) {
                mates.join(there, back);
            }
        }
        let mut halves = Halves {
            positions: positions.to_vec(),
            triangles: triangles.to_vec(),
            mates,
            starts: vec![u32::MAX; positions.len()],
        };
        halves.divide_fans();
        Ok(halves)
    }

    /// Gives every fan of triangles around a vertex a vertex of its own.
    fn divide_fans(&mut self) {
        let mut seen = vec![false; self.mates.len()];
        for half in 0..index(self.mates.len()) {
            if seen[half as usize] {
                continue;
            }
            let vertex = self.from(half);
            let fan: Vec<u32> = self.fan(half).collect();
            let own = if self.starts[vertex as usize] == u32::MAX {
                vertex
            } else {
                self.positions.push(self.positions[vertex as usize]);
                self.starts.push(half);
                index(self.positions.len() - 1)
            };
            self.starts[own as usize] = half;
            for spoke in fan {
                seen[spoke as usize] = true;
                self.triangles[spoke as usize / 3][spoke as usize % 3] = own;
            }
        }
    }

    pub(crate) fn mate(&self, half: u32) -> u32 {
        self.mates.of(half)
    }

    pub(crate) fn from(&self, half: u32) -> u32 {
        self.triangles[half as usize / 3][half as usize % 3]
    }

    pub(crate) fn to(&self, half: u32) -> u32 {
        self.from(next_in(half))
    }

    pub(crate) fn length(&self, half: u32) -> f64 {
        self.at(self.from(half)).distance(self.at(self.to(half)))
    }

    pub(crate) fn at(&self, vertex: u32) -> DVec3 {
        self.positions[vertex as usize]
    }

    /// The half-edges that start where `half` does, counter-clockwise from it.
    pub(crate) fn fan(&self, half: u32) -> impl Iterator<Item = u32> {
        self.mates.fan(half)
    }

    /// The half-edges that start at a vertex; none for a vertex without triangles.
    pub(crate) fn around(&self, vertex: u32) -> impl Iterator<Item = u32> {
        let start = self.starts[vertex as usize];
        (start != u32::MAX)
            .then_some(start)
            .into_iter()
            .flat_map(|start| self.fan(start))
    }

    /// Cuts the surface along a closed path of half-edges through distinct vertices, and closes
    /// both borders with the same triangles, given by the places of their corners on the path,
    /// ascending. The vertices on the right of the path are new; they are returned.
    pub(crate) fn operate(&mut self, path: &[u32], disk: &[[usize; 3]]) -> Vec<u32> {
        let count = path.len();
        let left: Vec<u32> = path.iter().map(|&h| self.from(h)).collect();
        let right_halves: Vec<u32> = path.iter().map(|&h| self.mate(h)).collect();
        let right: Vec<u32> = left
            .iter()
            .map(|&v| {
                self.positions.push(self.positions[v as usize]);
                index(self.positions.len() - 1)
            })
            .collect();
        for i in 0..count {
            // The right of the path is counter-clockwise from the half-edge back to the half-edge
            // forward.
            let back = right_halves[(i + count - 1) % count];
            let spokes: Vec<u32> = self.fan(back).take_while(|&h| h != path[i]).collect();
            for spoke in spokes {
                self.triangles[spoke as usize / 3][spoke as usize % 3] = right[i];
            }
            self.starts[left[i] as usize] = path[i];
            self.starts.push(back);
        }
        let turned: Vec<[usize; 3]> = disk.iter().map(|&[a, b, c]| [c, b, a]).collect();
        self.close(path, &left, &turned);
        self.close(&right_halves, &right, disk);
        right
    }

    /// Whether the surface stays connected after a cut along a closed path.
    pub(crate) fn stays_connected(&self, path: &[u32]) -> bool {
        let is_cut: BTreeSet<u32> = path.iter().flat_map(|&h| [h, self.mate(h)]).collect();
        let goal = self.mate(path[0]) / 3;
        let mut seen = BTreeSet::from([path[0] / 3]);
        let mut queue = VecDeque::from([path[0] / 3]);
        while let Some(triangle) = queue.pop_front() {
            if triangle == goal {
                return true;
            }
            for half in 3 * triangle..3 * triangle + 3 {
                let other = self.mate(half) / 3;
                if !is_cut.contains(&half) && seen.insert(other) {
                    queue.push_back(other);
                }
            }
        }
        false
    }

    /// Closes a border with triangles of `vertices`; half-edge i of the border has the ends i and
    /// i + 1.
    fn close(&mut self, border: &[u32], vertices: &[u32], disk: &[[usize; 3]]) {
        let count = vertices.len();
        if disk.is_empty() {
            self.mates.join(border[0], border[1]);
            return;
        }
        let mut open = HashMap::<[usize; 2], u32>::new();
        for (i, &half) in border.iter().enumerate() {
            open.insert([i, (i + 1) % count], half);
        }
        for corners in disk {
            let first = index(self.mates.len());
            self.triangles.push(corners.map(|i| vertices[i]));
            self.mates.push();
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                let found = open.remove(&[b, a]).or_else(|| open.remove(&[a, b]));
                match found {
                    Some(mate) => self.mates.join(first + index(k), mate),
                    None => {
                        open.insert([a, b], first + index(k));
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{Shells, genus, is_closed};

    /// An octahedron as triangles of the vertices 0 to 5: +-x, +-y, +-z.
    fn octahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z];
        let triangles = vec![
            [0, 2, 4],
            [2, 1, 4],
            [1, 3, 4],
            [3, 0, 4],
            [2, 0, 5],
            [1, 2, 5],
            [3, 1, 5],
            [0, 3, 5],
        ];
        (vec![x, -x, y, -y, z, -z], triangles)
    }

    fn half(surface: &Halves, from: u32, to: u32) -> u32 {
        (0..index(3 * surface.triangles.len()))
            .find(|&h| surface.from(h) == from && surface.to(h) == to)
            .expect("the edge is there")
    }

    #[test]
    fn a_cut_round_the_middle_makes_two_pieces() {
        let (positions, triangles) = octahedron();
        let mut surface = Halves::new(&positions, &triangles).expect("closed");
        let path = [[0, 2], [2, 1], [1, 3], [3, 0]].map(|[a, b]| half(&surface, a, b));
        assert!(!surface.stays_connected(&path), "the equator separates");
        let copies = surface.operate(&path, &[[0, 1, 2], [0, 2, 3]]);
        assert_eq!(copies.len(), 4, "a copy of each vertex of the path");
        assert!(is_closed(&surface.triangles), "both borders are closed");
        let shells = Shells::new(&surface.triangles);
        assert_eq!(shells.members.len(), 2, "the halves of an octahedron");
        for members in shells.members {
            assert_eq!(members.len(), 6, "four faces and two of the disk");
            assert_eq!(genus(&surface.triangles, &members), 0, "a pyramid");
        }
        let half_turn = surface.fan(half(&surface, copies[0], copies[1])).count();
        assert_eq!(half_turn, 3 + usize::from(half_turn == 4), "fans are whole");
    }

    #[test]
    fn a_vertex_of_two_pieces_becomes_two() {
        let (mut positions, mut triangles) = octahedron();
        positions.extend(
            positions
                .clone()
                .iter()
                .skip(1)
                .map(|p| *p + 2.0 * DVec3::X),
        );
        // The second one has the first one's vertex 0 as its -x.
        let number = [10, 0, 6, 7, 8, 9];
        positions[10] = DVec3::X * 3.0;
        let second: Vec<[u32; 3]> = triangles
            .iter()
            .map(|t| t.map(|v| number[v as usize]))
            .collect();
        triangles.extend(second);
        let surface = Halves::new(&positions, &triangles).expect("closed");
        assert_eq!(surface.positions.len(), 12, "six vertices each");
        assert_eq!(surface.at(11), DVec3::X, "one position, two vertices");
        assert_eq!(surface.around(0).count(), 4, "each with its own triangles");
    }
}
