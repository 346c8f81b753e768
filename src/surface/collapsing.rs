//! A closed surface whose edges can be collapsed: the triangles around each vertex are kept up to
//! date.

use crate::numeric::index;

/// A closed oriented surface.
pub(crate) struct Collapsing {
    /// [`GONE`] in place of a removed triangle.
    triangles: Vec<[u32; 3]>,
    /// The triangles at each vertex, in the order in which they arrived there.
    around: Vec<Vec<u32>>,
}

const GONE: [u32; 3] = [u32::MAX; 3];

/// A triangle at a vertex, and its two other corners, in its sense.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Spoke {
    pub(crate) triangle: u32,
    pub(crate) next: u32,
    pub(crate) last: u32,
}

impl Collapsing {
    pub(crate) fn new(triangles: Vec<[u32; 3]>, vertices: usize) -> Collapsing {
        let mut around = vec![Vec::new(); vertices];
        for (number, triangle) in triangles.iter().enumerate() {
            for &vertex in triangle {
                around[vertex as usize].push(index(number));
            }
        }
        Collapsing { triangles, around }
    }

    /// The corners of a triangle; `None` if it was removed.
    pub(crate) fn triangle(&self, number: u32) -> Option<[u32; 3]> {
        Some(self.triangles[number as usize]).filter(|corners| *corners != GONE)
    }

    /// The remaining triangles.
    pub(crate) fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        self.triangles
            .iter()
            .copied()
            .filter(|&corners| corners != GONE)
    }

    /// The triangles at a vertex: number and corners of each.
    pub(crate) fn around(&self, vertex: u32) -> impl ExactSizeIterator<Item = (u32, [u32; 3])> {
        let numbers = self.around[vertex as usize].iter();
        numbers.map(|&number| (number, self.triangles[number as usize]))
    }

    /// The triangles at a vertex; `next` takes each neighbour of the vertex once per edge.
    pub(crate) fn spokes(&self, vertex: u32) -> impl ExactSizeIterator<Item = Spoke> {
        self.around(vertex).map(move |(triangle, corners)| {
            let [a, b, c] = corners;
            let (next, last) = if a == vertex {
                (b, c)
            } else if b == vertex {
                (c, a)
            } else {
                (a, b)
            };
            Spoke {
                triangle,
                next,
                last,
            }
        })
    }

    /// Whether an edge joins two vertices.
    fn are_joined(&self, a: u32, b: u32) -> bool {
        let [few, many] = if self.around(a).len() < self.around(b).len() {
            [a, b]
        } else {
            [b, a]
        };
        a != b && self.around(few).any(|(_, corners)| corners.contains(&many))
    }

    /// Whether `gone` can move into `kept` along an edge so that the surface stays a manifold of
    /// the same topology: the two vertices opposite that edge are the only neighbours that they
    /// have in common, and no two triangles coincide. It is not possible where more than two
    /// triangles meet at an edge to one of these two vertices.
    pub(crate) fn may_collapse(&self, kept: u32, gone: u32) -> bool {
        let neighbours = || self.spokes(gone).map(|spoke| spoke.next);
        let common = neighbours().filter(|&other| self.are_joined(other, kept));
        if common.take(3).count() != 2 || !neighbours().any(|other| other == kept) {
            return false;
        }
        // Of a tetrahedron, two coinciding triangles would remain.
        let falls_on = |spoke: &Spoke| {
            self.around(kept)
                .any(|(_, corners)| corners.contains(&spoke.next) && corners.contains(&spoke.last))
        };
        self.around(gone).len() > 3
            || !self
                .spokes(gone)
                .filter(|spoke| spoke.next != kept && spoke.last != kept)
                .any(|spoke| falls_on(&spoke))
    }

    /// Moves `gone` into `kept`, and removes the triangles at the edge between them.
    pub(crate) fn collapse(&mut self, kept: u32, gone: u32) {
        for number in std::mem::take(&mut self.around[gone as usize]) {
            let corners = self.triangles[number as usize];
            if corners.contains(&kept) {
                for vertex in corners {
                    self.around[vertex as usize].retain(|&other| other != number);
                }
                self.triangles[number as usize] = GONE;
            } else {
                self.triangles[number as usize] = corners.map(|v| if v == gone { kept } else { v });
                self.around[kept as usize].push(number);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::is_closed;

    /// An octahedron: the ring 0 to 3, counter-clockwise seen from the north, the north pole 4 and
    /// the south pole 5.
    fn octahedron() -> Collapsing {
        let caps = (0..4).flat_map(|i| [[i, (i + 1) % 4, 4], [(i + 1) % 4, i, 5]]);
        Collapsing::new(caps.collect(), 6)
    }

    #[test]
    fn the_spokes_of_a_vertex_are_its_triangles_from_there() {
        let found: Vec<Spoke> = octahedron().spokes(0).collect();
        let spoke = |triangle, next, last| Spoke {
            triangle,
            next,
            last,
        };
        let expected = [
            spoke(0, 1, 4),
            spoke(1, 5, 1),
            spoke(6, 4, 3),
            spoke(7, 3, 5),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn an_edge_takes_its_two_triangles_along() {
        let mut surface = octahedron();
        assert!(surface.may_collapse(4, 0), "they have 1 and 3 in common");
        surface.collapse(4, 0);
        let left: Vec<[u32; 3]> = surface.triangles().collect();
        assert_eq!(left.len(), 6);
        assert!(is_closed(&left), "without a gap");
        assert!(left.iter().flatten().all(|&v| v != 0), "it is gone");
        assert_eq!(surface.triangle(0), None, "it was between 0 and 4");
        assert_eq!(surface.around(0).len(), 0);
        assert_eq!(surface.spokes(4).len(), 4, "two of its own and two of 0");
    }

    #[test]
    fn what_would_change_the_surface_is_not_collapsed() {
        let mut surface = octahedron();
        assert!(!surface.may_collapse(4, 5), "no edge joins north and south");
        surface.collapse(4, 0);
        // Now it is a double pyramid with the apices 1 and 3 over the triangle of 2, 4 and 5.
        assert!(!surface.may_collapse(4, 5), "1, 2 and 3 are common");
        assert!(surface.may_collapse(4, 3), "2 and 5 are common");
        surface.collapse(4, 3);
        let left: Vec<[u32; 3]> = surface.triangles().collect();
        assert_eq!(left.len(), 4, "a tetrahedron");
        assert!(is_closed(&left), "without a gap");
        assert!(!surface.may_collapse(1, 4), "nothing would be left");
    }
}
