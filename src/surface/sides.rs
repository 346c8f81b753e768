//! Which triangles meet at which edge: the sides of a list of triangles, sorted by their ends.

use crate::numeric::index;

/// The half-edges of a list of triangles, ordered by edge. Half-edge 3 t + k runs from corner k of
/// triangle t to the next.
pub(crate) struct Sides {
    /// For each vertex, where the half-edges of which it is the smaller end begin in `halves`; one
    /// entry more than there are vertices.
    starts: Vec<u32>,
    /// For each half-edge, from the highest bits down: the larger end, which is below 2^31, whether
    /// it runs to the smaller end, and its number.
    halves: Vec<u64>,
}

/// The bits of the number of a half-edge, and the bit above them.
const NUMBER: u64 = (1 << 32) - 1;
const BACK: u64 = 1 << 32;

/// The half-edges along one edge. At the edge of a closed surface, equally many run in each sense.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgeSides<'a> {
    /// The smaller end first. Both are the same for the side of a triangle with a repeated corner
    /// that joins the corner to itself.
    pub(crate) ends: [u32; 2],
    there: &'a [u64],
    back: &'a [u64],
}

impl Sides {
    /// All sides of a list of triangles.
    pub(crate) fn new(triangles: &[[u32; 3]]) -> Sides {
        Sides::of((0..).zip(triangles.iter().flat_map(edges)))
    }

    /// Half-edges given by number and ends, ascending.
    ///
    /// # Cost
    /// O(n log d) for vertices with at most d triangles: a counting sort distributes the half-edges
    /// to the vertices.
    pub(crate) fn of(sides: impl Iterator<Item = (u32, [u32; 2])> + Clone) -> Sides {
        let ends = sides.clone().flat_map(|(_, ends)| ends);
        let vertices = ends.max().map_or(0, |last| last as usize + 1);
        // Shifted by one entry at first: after filling, each entry is where its vertex begins.
        let mut starts = vec![0_u32; vertices + 2];
        for (_, [from, to]) in sides.clone() {
            starts[from.min(to) as usize + 2] += 1;
        }
        (0..vertices).for_each(|vertex| starts[vertex + 2] += starts[vertex + 1]);
        let mut halves = vec![0_u64; starts[vertices + 1] as usize];
        for (number, [from, to]) in sides {
            let place = &mut starts[from.min(to) as usize + 1];
            let back = if from > to { BACK } else { 0 };
            halves[*place as usize] = u64::from(from.max(to)) << 33 | back | u64::from(number);
            *place += 1;
        }
        starts.truncate(vertices + 1);
        for ends in starts.windows(2) {
            halves[ends[0] as usize..ends[1] as usize].sort_unstable();
        }
        Sides { starts, halves }
    }

    /// Every edge once, in the order of the ends.
    pub(crate) fn edges(&self) -> impl Iterator<Item = EdgeSides<'_>> {
        let at = |vertex: usize| {
            let halves =
                &self.halves[self.starts[vertex] as usize..self.starts[vertex + 1] as usize];
            let runs = halves.chunk_by(|a, b| a >> 33 == b >> 33);
            runs.map(move |run| EdgeSides::new(index(vertex), run))
        };
        (0..self.starts.len() - 1).flat_map(at)
    }
}

impl<'a> EdgeSides<'a> {
    fn new(end: u32, run: &'a [u64]) -> EdgeSides<'a> {
        let (there, back) = run.split_at(run.partition_point(|half| half & BACK == 0));
        let other = (run[0] >> 33) as u32;
        EdgeSides {
            ends: [end, other],
            there,
            back,
        }
    }

    /// Half-edges from the smaller end to the larger one, ascending.
    pub(crate) fn there(&self) -> impl ExactSizeIterator<Item = u32> + use<'a> {
        self.there.iter().map(number)
    }

    /// Half-edges from the larger end to the smaller one, ascending.
    pub(crate) fn back(&self) -> impl ExactSizeIterator<Item = u32> + use<'a> {
        self.back.iter().map(number)
    }

    /// All half-edges: first those of `there`, then those of `back`.
    pub(crate) fn halves(&self) -> impl Iterator<Item = u32> + use<'a> {
        self.there().chain(self.back())
    }

    /// The two half-edges along an ordinary edge, first the one from the smaller end; `None` if
    /// there are more or fewer.
    pub(crate) fn pair(&self) -> Option<[u32; 2]> {
        match (self.there, self.back) {
            ([there], [back]) => Some([number(there), number(back)]),
            _ => None,
        }
    }

    /// Number of triangles.
    pub(crate) fn len(&self) -> usize {
        self.there.len() + self.back.len()
    }

    /// Whether the edge is run through equally often in both senses.
    pub(crate) fn is_closed(&self) -> bool {
        self.there.len() == self.back.len()
    }
}

fn number(half: &u64) -> u32 {
    (half & NUMBER) as u32
}

/// Whether every edge is run through equally often in both senses. Every stage of a sweep preserves
/// this, and every build checks it. A triangle with a repeated corner is not closed.
pub(crate) fn is_closed(triangles: &[[u32; 3]]) -> bool {
    Sides::new(triangles).edges().all(|edge| edge.is_closed())
}

/// The directed edges of a triangle.
pub(crate) fn edges(triangle: &[u32; 3]) -> [[u32; 2]; 3] {
    let [a, b, c] = *triangle;
    [[a, b], [b, c], [c, a]]
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    #[test]
    fn edges_come_by_their_ends_with_the_half_edges_of_each_sense() {
        let sides = Sides::new(&TETRAHEDRON);
        let found: Vec<_> = sides
            .edges()
            .map(|edge| (edge.ends, edge.there().collect(), edge.back().collect()))
            .collect::<Vec<([u32; 2], Vec<u32>, Vec<u32>)>>();
        let expected = [
            ([0, 1], vec![3], vec![2]),
            ([0, 2], vec![0], vec![9]),
            ([0, 3], vec![10], vec![5]),
            ([1, 2], vec![6], vec![1]),
            ([1, 3], vec![4], vec![8]),
            ([2, 3], vec![7], vec![11]),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn an_edge_of_four_triangles_has_all_of_them() {
        let wedge = |p: u32, q: u32| [[0, 1, p], [1, 0, q], [0, p, q], [1, q, p]];
        let both = [wedge(2, 3), wedge(4, 5)].concat();
        let sides = Sides::new(&both);
        let shared = sides.edges().find(|edge| edge.len() > 2).expect("one");
        assert_eq!(shared.ends, [0, 1]);
        assert_eq!(shared.there().collect::<Vec<_>>(), [0, 12], "ascending");
        assert_eq!(shared.back().collect::<Vec<_>>(), [3, 15]);
    }

    #[test]
    fn a_surface_is_closed_when_every_edge_has_its_opposite() {
        assert!(is_closed(&TETRAHEDRON), "closed");
        assert!(is_closed(&[]), "nothing is open");
        assert!(!is_closed(&TETRAHEDRON[..3]), "a face is missing");
        assert!(
            !is_closed(&[[0, 1, 2], [0, 1, 2]]),
            "twice the same is not there and back"
        );
        let twice = [&TETRAHEDRON[..], &TETRAHEDRON[..]].concat();
        assert!(is_closed(&twice), "edges of four triangles");
        assert!(!is_closed(&[[0, 1, 1]]), "a side from 1 to 1");
    }

    #[test]
    fn one_turned_triangle_among_many_is_noticed() {
        // A double cone over a ring of many corners: two vertices with very many triangles.
        let ring = 1000;
        let mut triangles: Vec<[u32; 3]> = (0..ring)
            .flat_map(|i| {
                let [a, b] = [2 + i, 2 + (i + 1) % ring];
                [[a, b, 0], [b, a, 1]]
            })
            .collect();
        assert!(is_closed(&triangles), "closed");
        triangles[700].swap(0, 1);
        assert!(!is_closed(&triangles), "one is turned");
    }
}
