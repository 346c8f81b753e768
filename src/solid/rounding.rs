//! Rounding a closed surface to `f32` coordinates so that it stays a manifold for a reader who joins equal positions.

use crate::numeric::index;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// A surface with coordinates that `f32` represents.
pub(super) struct Rounded {
    pub(super) positions: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Largest distance of a vertex from where it was.
    pub(super) largest_move: f64,
}

/// Rounds every coordinate to the nearest `f32`.
pub(super) fn to_single(positions: &[DVec3], triangles: &[[u32; 3]]) -> Rounded {
    let mut rounded: Vec<DVec3> = positions.iter().map(|&p| rounded_to_single(p)).collect();
    let mut surface = Surface::new(triangles, positions.len());
    let mut groups = BTreeMap::<[u64; 3], Vec<u32>>::new();
    for (vertex, p) in rounded.iter().enumerate() {
        groups.entry(key(*p)).or_default().push(index(vertex));
    }
    groups.retain(|_, group| group.len() > 1);
    for group in groups.values_mut() {
        while let Some(gone) = surface.collapse_within(group) {
            group.retain(|&v| v != gone);
        }
    }
    // Vertices that were apart and cannot be joined go to the nearest free positions.
    let mut taken: BTreeSet<[u64; 3]> = rounded.iter().map(|p| key(*p)).collect();
    for group in groups.values() {
        let mut places = BTreeSet::from([key(positions[group[0] as usize])]);
        for &vertex in &group[1..] {
            // At one position already before rounding: the region touches itself there.
            if places.insert(key(positions[vertex as usize])) {
                rounded[vertex as usize] = free_neighbour(rounded[vertex as usize], &mut taken);
            }
        }
    }
    let largest_move = positions
        .iter()
        .zip(&rounded)
        .map(|(p, q)| p.distance(*q))
        .fold(0.0, f64::max);
    Rounded {
        positions: rounded,
        triangles: surface.triangles(),
        largest_move,
    }
}

/// The `f32` nearest to `x`.
#[expect(
    clippy::cast_possible_truncation,
    reason = "the rounding is what is wanted"
)]
fn single(x: f64) -> f32 {
    x as f32
}

fn rounded_to_single(p: DVec3) -> DVec3 {
    p.map(|x| f64::from(single(x)))
}

/// Equal for equal positions; -0 and 0 are equal.
fn key(p: DVec3) -> [u64; 3] {
    (p + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// A position next to `p` among the `f32` ones that is not taken yet, nearest first.
fn free_neighbour(p: DVec3, taken: &mut BTreeSet<[u64; 3]>) -> DVec3 {
    for reach in 1_i32.. {
        let mut shell: Vec<[i32; 3]> = (0..(2 * reach + 1).pow(3))
            .map(|i| {
                [i, i / (2 * reach + 1), i / (2 * reach + 1).pow(2)]
                    .map(|i| i % (2 * reach + 1) - reach)
            })
            .filter(|steps| steps.iter().any(|s| s.abs() == reach))
            .collect();
        shell.sort_by_key(|steps| steps.iter().map(|s| s.abs()).sum::<i32>());
        for steps in shell {
            let [x, y, z] = [0, 1, 2].map(|i| f64::from(stepped(single(p[i]), steps[i])));
            let place = DVec3::new(x, y, z);
            if taken.insert(key(place)) {
                return place;
            }
        }
    }
    unreachable!("a mesh has fewer vertices than there are positions")
}

/// The `f32` that is `steps` representable numbers above `x`.
fn stepped(x: f32, steps: i32) -> f32 {
    (0..steps.abs()).fold(x, |x, _| {
        if steps > 0 {
            x.next_up()
        } else {
            x.next_down()
        }
    })
}

/// A closed surface whose edges can be collapsed.
struct Surface {
    /// `None` where a triangle is gone.
    faces: Vec<Option<[u32; 3]>>,
    /// Triangles round each vertex, those gone included.
    around: Vec<Vec<u32>>,
}

impl Surface {
    fn new(triangles: &[[u32; 3]], vertices: usize) -> Surface {
        let mut around = vec![Vec::new(); vertices];
        for (number, triangle) in triangles.iter().enumerate() {
            triangle
                .iter()
                .for_each(|&v| around[v as usize].push(index(number)));
        }
        Surface {
            faces: triangles.iter().copied().map(Some).collect(),
            around,
        }
    }

    fn faces_of(&self, vertex: u32) -> impl Iterator<Item = (u32, [u32; 3])> {
        self.around[vertex as usize].iter().filter_map(move |&f| {
            self.faces[f as usize]
                .filter(|face| face.contains(&vertex))
                .map(|face| (f, face))
        })
    }

    fn neighbours(&self, vertex: u32) -> BTreeSet<u32> {
        self.faces_of(vertex)
            .flat_map(|(_, face)| face)
            .filter(|&v| v != vertex)
            .collect()
    }

    /// Collapses one edge between two vertices of the group, if that is legal for any, and tells which vertex went.
    fn collapse_within(&mut self, group: &[u32]) -> Option<u32> {
        for (i, &kept) in group.iter().enumerate() {
            for &gone in &group[i + 1..] {
                if self.collapse(kept, gone) {
                    return Some(gone);
                }
            }
        }
        None
    }

    /// Moves `gone` into `kept` along their edge if the surface stays a manifold of the same kind: the two vertices share
    /// exactly the two neighbours opposite their edge, and no two triangles fall together.
    fn collapse(&mut self, kept: u32, gone: u32) -> bool {
        let (of_kept, of_gone) = (self.neighbours(kept), self.neighbours(gone));
        if !of_kept.contains(&gone) || of_kept.intersection(&of_gone).count() != 2 {
            return false;
        }
        let moved: Vec<(u32, [u32; 3])> = self
            .faces_of(gone)
            .map(|(f, face)| (f, face.map(|v| if v == gone { kept } else { v })))
            .collect();
        let is_degenerate = |face: &[u32; 3]| face.iter().filter(|&&v| v == kept).count() > 1;
        let corners = |face: &[u32; 3]| {
            let mut corners = *face;
            corners.sort_unstable();
            corners
        };
        let mut seen: BTreeSet<[u32; 3]> = self
            .faces_of(kept)
            .filter(|(_, face)| !face.contains(&gone))
            .map(|(_, face)| corners(&face))
            .collect();
        if !moved
            .iter()
            .filter(|(_, face)| !is_degenerate(face))
            .all(|(_, face)| seen.insert(corners(face)))
        {
            return false;
        }
        for (f, face) in moved {
            if is_degenerate(&face) {
                self.faces[f as usize] = None;
            } else {
                self.faces[f as usize] = Some(face);
                self.around[kept as usize].push(f);
            }
        }
        true
    }

    fn triangles(&self) -> Vec<[u32; 3]> {
        self.faces.iter().copied().flatten().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An octahedron with the given north pole.
    fn octahedron(north: DVec3) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let ring = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y];
        let positions = ring.into_iter().chain([north, DVec3::NEG_Z]).collect();
        let triangles = (0..4)
            .flat_map(|i| [[i, (i + 1) % 4, 4], [(i + 1) % 4, i, 5]])
            .collect();
        (positions, triangles)
    }

    #[test]
    fn vertices_that_round_together_are_joined_along_their_edge() {
        let (positions, triangles) = octahedron(DVec3::X * (1.0 + 1e-12));
        let rounded = to_single(&positions, &triangles);
        assert_eq!(
            rounded.triangles.len(),
            6,
            "the edge takes its two triangles along"
        );
        assert!(
            rounded.largest_move <= 1e-12 + f64::EPSILON,
            "moved by {}",
            rounded.largest_move
        );
    }

    #[test]
    fn vertices_that_round_together_without_an_edge_stay_apart() {
        let (mut positions, triangles) = octahedron(DVec3::Z);
        let (again, more) = octahedron(DVec3::Z);
        positions.extend(again.iter().map(|p| *p * (1.0 + 1e-12)));
        let both: Vec<[u32; 3]> = triangles
            .iter()
            .copied()
            .chain(more.iter().map(|t| t.map(|v| v + 6)))
            .collect();
        let rounded = to_single(&positions, &both);
        assert_eq!(rounded.triangles.len(), 16, "nothing is lost");
        let places: BTreeSet<[u64; 3]> = rounded.positions.iter().map(|p| key(*p)).collect();
        assert_eq!(places.len(), 12, "every vertex has its own position");
        assert!(
            rounded.largest_move < 2.0 * f64::from(f32::EPSILON),
            "moved by {}",
            rounded.largest_move
        );
    }

    #[test]
    fn representable_coordinates_stay_exactly() {
        let (positions, triangles) = octahedron(DVec3::Z * 0.5);
        let rounded = to_single(&positions, &triangles);
        assert_eq!(rounded.positions, positions, "all are representable");
        assert_eq!(rounded.largest_move, 0.0, "nothing moved");
    }
}
