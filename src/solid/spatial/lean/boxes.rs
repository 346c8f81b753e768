//! A tree of boxes around triangles that change while they are asked for.

use glam::DVec3;

/// A complete binary tree of boxes over numbered things; those near each other in space are mostly
/// near each other in the tree. Boxes grow, but do not shrink.
pub(super) struct GrowingBoxes {
    /// The root first; the children of node n are 2 n + 1 and 2 n + 2. The last level holds the
    /// leaves, and nothing behind the last of them.
    nodes: Vec<[DVec3; 2]>,
    first_leaf: usize,
    /// The thing in each leaf.
    things: Vec<u32>,
    /// The leaf of each thing.
    leaves: Vec<u32>,
}

const NOTHING: [DVec3; 2] = [DVec3::INFINITY, DVec3::NEG_INFINITY];

impl GrowingBoxes {
    /// - `boxes`: the lowest and the highest corner of each thing.
    ///
    /// O(n log n), sequential.
    pub(super) fn new(boxes: &[[DVec3; 2]]) -> GrowingBoxes {
        let [low, high] = boxes.iter().fold(NOTHING, |all, &own| union(all, own));
        let width = (high - low).max_element().max(f64::MIN_POSITIVE);
        let mut order: Vec<(u64, u32)> = (0..)
            .zip(boxes)
            .map(|(thing, [a, b])| (place_on_curve((a.midpoint(*b) - low) / width), thing))
            .collect();
        order.sort_unstable();
        let things: Vec<u32> = order.into_iter().map(|(_, thing)| thing).collect();
        let first_leaf = things.len().next_power_of_two() - 1;
        let mut nodes = vec![NOTHING; 2 * first_leaf + 1];
        let mut leaves = vec![0; boxes.len()];
        for (leaf, &thing) in (0..).zip(&things) {
            leaves[thing as usize] = leaf;
            nodes[first_leaf + leaf as usize] = boxes[thing as usize];
        }
        for node in (0..first_leaf).rev() {
            nodes[node] = union(nodes[2 * node + 1], nodes[2 * node + 2]);
        }
        GrowingBoxes {
            nodes,
            first_leaf,
            things,
            leaves,
        }
    }

    /// Lets the box of a thing grow to contain another one.
    pub(super) fn grow(&mut self, thing: u32, to: [DVec3; 2]) {
        let mut node = self.first_leaf + self.leaves[thing as usize] as usize;
        loop {
            let grown = union(self.nodes[node], to);
            if grown == self.nodes[node] {
                return;
            }
            self.nodes[node] = grown;
            if node == 0 {
                return;
            }
            node = (node - 1) / 2;
        }
    }

    /// Whether `is_one` holds for a thing whose box meets a closed box and comes between two parallel
    /// planes.
    pub(super) fn any_near(&self, place: &Place, mut is_one: impl FnMut(u32) -> bool) -> bool {
        let mut open = vec![0];
        while let Some(node) = open.pop() {
            if !place.meets(self.nodes[node]) {
                continue;
            }
            if node < self.first_leaf {
                open.extend([2 * node + 2, 2 * node + 1]);
            } else if is_one(self.things[node - self.first_leaf]) {
                return true;
            }
        }
        false
    }
}

/// The part of a box between two parallel planes.
pub(super) struct Place {
    pub(super) bounds: [DVec3; 2],
    pub(super) axis: DVec3,
    /// Least and largest product of a point and the axis.
    pub(super) heights: [f64; 2],
}

impl Place {
    /// Whether a box meets the box of the place and the space between its planes.
    fn meets(&self, [low, high]: [DVec3; 2]) -> bool {
        let [own_low, own_high] = self.bounds;
        let overlaps = low.cmple(own_high).all() && high.cmpge(own_low).all();
        overlaps && {
            let middle = self.axis.dot(low.midpoint(high));
            let half = self.axis.abs().dot(high - low) * 0.5;
            middle - half <= self.heights[1] && middle + half >= self.heights[0]
        }
    }
}

fn union([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> [DVec3; 2] {
    [a.min(c), b.max(d)]
}

/// The place of a point of the unit cube on Morton's curve: the bits of its coordinates in turn.
fn place_on_curve(point: DVec3) -> u64 {
    const BITS: u32 = 21;
    let cells = f64::from(1 << BITS) - 1.0;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "from zero to the number of cells"
    )]
    let bits = |coordinate: f64| (coordinate * cells) as u64;
    let apart = |coordinate: f64| {
        (0..BITS).fold(0, |apart, bit| {
            apart | (bits(coordinate) >> bit & 1) << (3 * bit)
        })
    };
    apart(point.x) | apart(point.y) << 1 | apart(point.z) << 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_near_is_found_where_it_was_and_where_it_grew() {
        let cube = |x: f64, y: f64| [DVec3::new(x, y, 0.0), DVec3::new(x + 0.5, y + 0.5, 1.0)];
        let mut boxes: Vec<[DVec3; 2]> = (0..50)
            .map(|i| cube(f64::from(i % 10), f64::from(i / 10)))
            .collect();
        let mut tree = GrowingBoxes::new(&boxes);
        for (thing, to) in [(7_u32, cube(-3.0, 2.0)), (49, cube(20.0, 20.0))] {
            tree.grow(thing, to);
            boxes[thing as usize] = union(boxes[thing as usize], to);
        }
        for (x, y) in [
            (-2.7, 2.1),
            (3.2, 3.4),
            (20.0, 20.5),
            (0.7, 0.7),
            (30.0, 0.0),
        ] {
            let place = Place {
                bounds: [DVec3::new(x, y, 0.5), DVec3::new(x + 0.4, y, 2.0)],
                axis: DVec3::X,
                heights: [x, x + 0.4],
            };
            let mut found = Vec::new();
            let all = tree.any_near(&place, |thing| {
                found.push(thing);
                false
            });
            assert!(!all, "every one was refused");
            found.sort_unstable();
            let expected: Vec<u32> = (0..)
                .zip(&boxes)
                .filter(|(_, own)| place.meets(**own))
                .map(|(thing, _)| thing)
                .collect();
            assert_eq!(found, expected, "at {x}, {y}");
            let any = tree.any_near(&place, |_| true);
            assert_eq!(any, !expected.is_empty(), "at {x}, {y}");
        }
    }

    #[test]
    fn planes_leave_out_what_the_box_does_not() {
        let cube = [DVec3::ZERO, DVec3::ONE];
        let tree = GrowingBoxes::new(&[cube]);
        let above = |height: f64| Place {
            bounds: cube,
            axis: DVec3::new(0.6, 0.0, 0.8),
            heights: [height, height + 1.0],
        };
        assert!(
            tree.any_near(&above(1.39), |_| true),
            "the corner is at 1.4"
        );
        assert!(!tree.any_near(&above(1.41), |_| true), "beyond the corner");
    }

    #[test]
    fn one_thing_and_none() {
        let place = Place {
            bounds: [DVec3::ONE, DVec3::ONE * 2.0],
            axis: DVec3::Z,
            heights: [0.0, 3.0],
        };
        let tree = GrowingBoxes::new(&[[DVec3::ZERO, DVec3::ONE]]);
        assert!(tree.any_near(&place, |thing| thing == 0), "they touch");
        let none = GrowingBoxes::new(&[]);
        assert!(!none.any_near(&place, |_| true), "nothing");
    }
}
