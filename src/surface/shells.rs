//! Connected shells of a closed triangle mesh, and their connectivity.

use super::sides::Sides;
use crate::numeric::DisjointSets;

/// A closed triangle mesh, divided into shells: triangles that share edges are in the same one.
pub(crate) struct Shells {
    /// Triangle indices per shell, ascending; shells are ordered by their first triangles.
    pub(crate) members: Vec<Vec<u32>>,
}

impl Shells {
    /// The shells of triangles that are connected where they have edges with the same ends.
    pub(crate) fn new(triangles: &[[u32; 3]]) -> Shells {
        let sides = Sides::new(triangles);
        let neighbours = sides.edges().flat_map(|edge| {
            let first = edge.halves().next().unwrap_or(0);
            edge.halves().map(move |half| [first / 3, half / 3])
        });
        Shells::joined(triangles.len(), neighbours)
    }

    /// The shells of `count` triangles, of which `neighbours` lists the connected pairs.
    pub(crate) fn joined(count: usize, neighbours: impl Iterator<Item = [u32; 2]>) -> Shells {
        let mut shells = DisjointSets::new(count);
        neighbours.for_each(|[one, other]| {
            shells.join(one, other);
        });
        Shells {
            members: shells.groups(),
        }
    }
}

/// The genus of a connected closed orientable shell, from its Euler number.
pub(crate) fn genus(triangles: &[[u32; 3]], members: &[u32]) -> usize {
    let mut vertices: Vec<u32> = members
        .iter()
        .flat_map(|&t| triangles[t as usize])
        .collect();
    vertices.sort_unstable();
    vertices.dedup();
    // Two triangles per edge: V - E + F = V - F / 2 = 2 - 2 genus.
    (members.len() / 2 + 2).saturating_sub(vertices.len()) / 2
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    #[test]
    fn two_tetrahedra_that_share_a_vertex_are_two_shells_of_genus_zero() {
        let second = TETRAHEDRON.map(|t| t.map(|v| if v == 0 { 0 } else { v + 3 }));
        let both: Vec<[u32; 3]> = TETRAHEDRON.into_iter().chain(second).collect();
        let shells = Shells::new(&both);
        assert_eq!(
            shells.members,
            [vec![0, 1, 2, 3], vec![4, 5, 6, 7]],
            "split at the vertex"
        );
        assert_eq!(genus(&both, &shells.members[1]), 0, "a ball");
    }

    #[test]
    fn a_grid_torus_has_genus_one() {
        let at = |i: u32, j: u32| (i % 5) * 4 + j % 4;
        let triangles: Vec<[u32; 3]> = (0..5)
            .flat_map(|i| (0..4).map(move |j| (i, j)))
            .flat_map(|(i, j)| {
                [
                    [at(i, j), at(i + 1, j), at(i + 1, j + 1)],
                    [at(i, j), at(i + 1, j + 1), at(i, j + 1)],
                ]
            })
            .collect();
        let shells = Shells::new(&triangles);
        assert_eq!(shells.members.len(), 1, "one shell");
        assert_eq!(
            genus(&triangles, &shells.members[0]),
            1,
            "V - E + F = 20 - 60 + 40"
        );
    }
}
