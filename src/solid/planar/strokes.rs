//! Segments on the grid: equal ones are summed, and those that cancel are set aside.

use super::{ArrangementError, Segment};
use crate::numeric::exact::planar_grid::{Grid, Node};
use crate::numeric::index;
use glam::DVec2;

/// A segment between two points of a list in ascending order, so that the smaller index is the
/// lower end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Stroke {
    pub(super) ends: [u32; 2],
    /// The winding number on the left, from the first end to the second, minus that on the right.
    pub(super) weight: i32,
}

/// The input on the grid.
pub(super) struct Strokes {
    /// Ascending and distinct.
    pub(super) nodes: Vec<Node>,
    /// Ascending and distinct, none of weight 0.
    pub(super) strokes: Vec<Stroke>,
    /// Distinct segments of the input that cancel on the grid.
    pub(super) cancelled: Vec<[u32; 2]>,
}

impl Strokes {
    /// Puts the segments on the grid.
    pub(super) fn new(
        grid: &Grid,
        points: &[DVec2],
        segments: &[Segment],
    ) -> Result<Strokes, ArrangementError> {
        let snapped: Vec<Node> = points.iter().map(|&p| grid.nearest(p)).collect();
        let (nodes, of_point) = numbered(&snapped);
        let mut strokes = Vec::with_capacity(segments.len());
        let mut balance = vec![0_i64; nodes.len()];
        for segment in segments {
            let [a, b] = segment.ends.map(|end| of_point[end as usize]);
            if a != b && segment.weight != 0 {
                strokes.push(Stroke {
                    ends: [a.min(b), a.max(b)],
                    weight: if a < b {
                        segment.weight
                    } else {
                        -segment.weight
                    },
                });
                balance[a as usize] += i64::from(segment.weight);
                balance[b as usize] -= i64::from(segment.weight);
            }
        }
        if let Some(open) = balance.iter().position(|&sum| sum != 0) {
            return Err(ArrangementError::Open {
                point: grid.place(nodes[open]),
                excess: balance[open],
            });
        }
        let (strokes, cancelled) = summed(strokes);
        Ok(Strokes {
            nodes,
            strokes,
            cancelled,
        })
    }
}

impl Strokes {
    /// The same strokes, without unused nodes and without the cancelled segments.
    pub(super) fn compacted(mut self) -> Strokes {
        let mut number = vec![0_u32; self.nodes.len()];
        for stroke in &self.strokes {
            stroke.ends.iter().for_each(|&end| number[end as usize] = 1);
        }
        let mut count = 0;
        let mut places = number.iter();
        self.nodes.retain(|_| places.next() == Some(&1));
        for number in &mut number {
            let is_used = *number;
            *number = count;
            count += is_used;
        }
        for stroke in &mut self.strokes {
            stroke.ends = stroke.ends.map(|end| number[end as usize]);
        }
        self.cancelled.clear();
        self
    }
}

/// The distinct nodes, ascending, and the number of each given one among them.
fn numbered(nodes: &[Node]) -> (Vec<Node>, Vec<u32>) {
    let mut order: Vec<(Node, u32)> = nodes.iter().copied().zip(0..).collect();
    order.sort_unstable();
    let mut different = Vec::with_capacity(nodes.len());
    let mut number = vec![0; nodes.len()];
    for (node, place) in order {
        if different.last() != Some(&node) {
            different.push(node);
        }
        number[place as usize] = index(different.len() - 1);
    }
    (different, number)
}

/// The sums of strokes with the same ends, ascending, and the ends of those whose sum is 0.
pub(super) fn summed(mut strokes: Vec<Stroke>) -> (Vec<Stroke>, Vec<[u32; 2]>) {
    strokes.sort_unstable();
    let mut cancelled = Vec::new();
    let mut sums = Vec::with_capacity(strokes.len());
    for same in strokes.chunk_by(|a, b| a.ends == b.ends) {
        let ends = same[0].ends;
        match same.iter().map(|stroke| stroke.weight).sum() {
            0 => cancelled.push(ends),
            weight => sums.push(Stroke { ends, weight }),
        }
    }
    (sums, cancelled)
}
