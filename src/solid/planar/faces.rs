//! The faces between pieces that do not cross, found by walking around them.

use super::strokes::Stroke;
use crate::Fault;
use crate::numeric::exact::planar_grid::{Node, cross};
use crate::numeric::{DisjointSets, index};
use crate::watch::{Stop, Work};
use std::cmp::Ordering;

/// The faces of a plane graph. Piece p has the half-edges 2 p, from its lower end to its upper one,
/// and 2 p + 1, in the opposite sense; each has one face on its left.
#[derive(Debug, Clone)]
pub(super) struct Faces {
    /// The half-edge after each one along the border of its face.
    next: Vec<u32>,
    /// The face on the left of each half-edge.
    face: Vec<u32>,
    /// The winding number of each face; the first face is the unbounded one.
    pub(super) winding: Vec<i32>,
}

/// The other half-edge of a piece.
pub(super) fn twin(half: u32) -> u32 {
    half ^ 1
}

const NONE: u32 = u32::MAX;

impl Faces {
    /// - `nodes`: ascending and distinct.
    /// - `pieces`: ascending, closed, and meeting at ends only.
    pub(super) fn new(nodes: &[Node], pieces: &[Stroke], work: Work) -> Result<Faces, Stop> {
        let items = work.items(nodes.len());
        let around = Around::new(nodes, pieces);
        let mut faces = Faces {
            next: around.next(pieces.len()),
            face: vec![NONE; 2 * pieces.len()],
            winding: vec![0],
        };
        let mut below = Below::new(nodes, pieces);
        // The lowest node of each connected part comes before its other nodes: by then, everything
        // in which the part lies is known.
        for node in 0..index(nodes.len()) {
            items.next()?;
            // All half-edges lead right or straight up from it: the part lies in the face on the
            // left of the last one.
            if let Some(&last) = around.of(node).last()
                && faces.face[last as usize] == NONE
            {
                let outer = below
                    .nearest(node)
                    .map_or(0, |piece| faces.face[2 * piece as usize]);
                faces.walk(last, outer, pieces);
            }
        }
        faces.check(pieces)?;
        Ok(faces)
    }

    /// Assigns the faces of a connected part, starting from a half-edge with a known face on its
    /// left.
    fn walk(&mut self, start: u32, outer: u32, pieces: &[Stroke]) {
        let mut open = vec![start];
        self.name(start, outer);
        while let Some(first) = open.pop() {
            let winding = self.winding[self.face_of(first) as usize];
            let mut half = first;
            loop {
                let other = twin(half);
                if self.face[other as usize] == NONE {
                    self.winding.push(winding - weight(pieces, half));
                    self.name(other, index(self.winding.len() - 1));
                    open.push(other);
                }
                half = self.next[half as usize];
                if half == first {
                    break;
                }
            }
        }
    }

    /// Assigns a face to a half-edge and all that follow it.
    fn name(&mut self, first: u32, face: u32) {
        let mut half = first;
        while self.face[half as usize] == NONE {
            self.face[half as usize] = face;
            half = self.next[half as usize];
        }
    }

    fn check(&self, pieces: &[Stroke]) -> Result<(), Fault> {
        let winding = |half: u32| i64::from(self.winding[self.face_of(half) as usize]);
        let is_consistent = |(piece, first): (&Stroke, u32)| {
            winding(first) - winding(twin(first)) == i64::from(piece.weight)
        };
        if self.winding[0] == 0 && pieces.iter().zip((0..).step_by(2)).all(is_consistent) {
            Ok(())
        } else {
            Err(Fault::new("winding numbers contradict each other"))
        }
    }

    /// The face on the left of a half-edge.
    pub(super) fn face_of(&self, half: u32) -> u32 {
        self.face[half as usize]
    }

    /// The half-edge after another along the border of its face.
    pub(super) fn after(&self, half: u32) -> u32 {
        self.next[half as usize]
    }

    /// The connected sets of faces, where neighbours across a piece belong together if they are
    /// alike: per face, the least face of its set.
    pub(super) fn components(&self, is_alike: impl Fn(u32, u32) -> bool) -> Vec<u32> {
        let mut components = DisjointSets::new(self.winding.len());
        for sides in self.face.chunks_exact(2) {
            if is_alike(sides[0], sides[1]) {
                components.join(sides[0], sides[1]);
            }
        }
        components.firsts()
    }
}

/// The winding number on the left of a half-edge, minus that on its right.
fn weight(pieces: &[Stroke], half: u32) -> i32 {
    let weight = pieces[half as usize / 2].weight;
    if half.is_multiple_of(2) {
        weight
    } else {
        -weight
    }
}

/// The half-edges that leave each node, counter-clockwise from straight down, which comes last.
struct Around {
    first: Vec<u32>,
    halves: Vec<u32>,
}

impl Around {
    fn new(nodes: &[Node], pieces: &[Stroke]) -> Around {
        let mut first = vec![0; nodes.len() + 1];
        for end in pieces.iter().flat_map(|piece| piece.ends) {
            first[end as usize + 1] += 1;
        }
        (0..nodes.len()).for_each(|node| first[node + 1] += first[node]);
        let mut place = first.clone();
        let mut halves = vec![0; 2 * pieces.len()];
        for (piece, number) in pieces.iter().zip((0..).step_by(2)) {
            for (end, half) in piece.ends.into_iter().zip([number, number + 1]) {
                halves[place[end as usize] as usize] = half;
                place[end as usize] += 1;
            }
        }
        let head = |half: u32| pieces[half as usize / 2].ends[1 - half as usize % 2];
        let mut around = Around { first, halves };
        for node in 0..index(nodes.len()) {
            let [from, to] = around.range(node);
            around.halves[from..to].sort_unstable_by(|&one, &other| {
                let [one, other] = [one, other].map(head);
                // Nodes are in ascending order: the upper ones are to the right, or straight up.
                let is_left = |end: u32| end < node;
                is_left(one).cmp(&is_left(other)).then_with(|| {
                    let [origin, one, other] = [node, one, other].map(|node| nodes[node as usize]);
                    0.cmp(&cross(origin, one, other))
                })
            });
        }
        around
    }

    fn range(&self, node: u32) -> [usize; 2] {
        [node, node + 1].map(|node| self.first[node as usize] as usize)
    }

    fn of(&self, node: u32) -> &[u32] {
        let [from, to] = self.range(node);
        &self.halves[from..to]
    }

    /// The half-edge after each one along the border of the face on its left: the first one
    /// clockwise from its twin.
    fn next(&self, pieces: usize) -> Vec<u32> {
        let mut next = vec![NONE; 2 * pieces];
        for ends in self.first.windows(2) {
            let halves = &self.halves[ends[0] as usize..ends[1] as usize];
            let mut before = halves.last();
            for half in halves {
                next[twin(*half) as usize] = before.copied().unwrap_or(NONE);
                before = Some(half);
            }
        }
        next
    }
}

/// Finds the piece right below each of some nodes, in ascending order of the queries.
struct Below<'a> {
    nodes: &'a [Node],
    pieces: &'a [Stroke],
    /// Pieces that have begun so far, without those known to have ended.
    open: Vec<u32>,
    begun: usize,
}

impl<'a> Below<'a> {
    fn new(nodes: &'a [Node], pieces: &'a [Stroke]) -> Below<'a> {
        Below {
            nodes,
            pieces,
            open: Vec::new(),
            begun: 0,
        }
    }

    fn ends(&self, piece: u32) -> [Node; 2] {
        self.pieces[piece as usize]
            .ends
            .map(|end| self.nodes[end as usize])
    }

    fn nearest(&mut self, node: u32) -> Option<u32> {
        let place = self.nodes[node as usize];
        while self.begun < self.pieces.len() && self.pieces[self.begun].ends[0] < node {
            self.open.push(index(self.begun));
            self.begun += 1;
        }
        let mut open = std::mem::take(&mut self.open);
        // A piece counts from its lower end up to, but not including, its upper one, so that
        // vertical ones never do.
        open.retain(|&piece| self.ends(piece)[1][0] > place[0]);
        let is_below = |piece: u32| {
            let [a, b] = self.ends(piece);
            cross(a, b, place) > 0
        };
        let nearest = open
            .iter()
            .copied()
            .filter(|&piece| is_below(piece))
            .max_by(|&one, &other| self.order(one, other));
        self.open = open;
        nearest
    }

    /// The order by height of two pieces that do not cross and overlap in x.
    fn order(&self, one: u32, other: u32) -> Ordering {
        let ([a, b], [c, d]) = (self.ends(one), self.ends(other));
        // Whether the first point that is not on the line lies above it.
        let side = |[from, to]: [Node; 2], points: [Node; 2]| {
            let sides = points.map(|point| cross(from, to, point));
            sides[0].cmp(&0).then(sides[1].cmp(&0))
        };
        if a[0] <= c[0] {
            side([a, b], [c, d]).reverse()
        } else {
            side([c, d], [a, b])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squares of half width `size` about points of one line, as nodes and pieces,
    /// counter-clockwise.
    fn squares(given: &[(i64, i64)]) -> (Vec<Node>, Vec<Stroke>) {
        let corners = |&(at, size): &(i64, i64)| {
            [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(|[x, y]| [at + size * x, size * y])
        };
        let mut nodes: Vec<Node> = given.iter().flat_map(corners).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let mut pieces = Vec::new();
        for ring in given.iter().map(corners) {
            for k in 0..4 {
                let [a, b] = [ring[k], ring[(k + 1) % 4]]
                    .map(|node| index(nodes.binary_search(&node).unwrap_or_default()));
                pieces.push(Stroke {
                    ends: [a.min(b), a.max(b)],
                    weight: if a < b { 1 } else { -1 },
                });
            }
        }
        pieces.sort_unstable();
        (nodes, pieces)
    }

    #[test]
    fn parts_that_lie_in_others_know_their_faces() {
        // Three nested ones, one beside them, and one in the gap between the outer two.
        let (nodes, pieces) = squares(&[(0, 10), (0, 4), (0, 1), (30, 5), (7, 1)]);
        let faces = Faces::new(&nodes, &pieces, Work::UNWATCHED).expect("consistent");
        let mut winding = faces.winding.clone();
        winding.sort_unstable();
        assert_eq!(winding, [0, 1, 1, 2, 2, 3]);
    }

    #[test]
    fn unbalanced_pieces_are_noticed() {
        let (nodes, mut pieces) = squares(&[(0, 1)]);
        pieces[0].weight = 2;
        let found = Faces::new(&nodes, &pieces, Work::UNWATCHED).map(|faces| faces.winding);
        assert_eq!(
            found,
            Err(Fault::new("winding numbers contradict each other").into())
        );
    }
}
