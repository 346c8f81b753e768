//! Connected shells of a closed triangle mesh, and their connectivity.

use crate::numeric::{DisjointSets, index};
use std::collections::HashMap;

/// A closed triangle mesh in shells: triangles that share edges are in the same one.
pub(crate) struct Shells {
    /// Triangle indices per shell, ascending; shells by their first triangle.
    pub(crate) members: Vec<Vec<u32>>,
}

impl Shells {
    pub(crate) fn new(triangles: &[[u32; 3]]) -> Shells {
        let mut by_edge = HashMap::<(u32, u32), u32>::with_capacity(triangles.len() * 3 / 2);
        let mut shells = DisjointSets::new(triangles.len());
        for (number, triangle) in triangles.iter().enumerate() {
            let number = index(number);
            for edge in edges(triangle) {
                let other = *by_edge
                    .entry((edge[0].min(edge[1]), edge[0].max(edge[1])))
                    .or_insert(number);
                shells.join(number, other);
            }
        }
        Shells {
            members: shells.groups(),
        }
    }
}

/// The directed edges of a triangle.
pub(crate) fn edges(triangle: &[u32; 3]) -> [[u32; 2]; 3] {
    [
        [triangle[0], triangle[1]],
        [triangle[1], triangle[2]],
        [triangle[2], triangle[0]],
    ]
}

/// Genus of a connected closed orientable shell, from its Euler number.
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
