//! The minimum cut of a graph whose nodes are attached to a source, to a sink, or to neither.
//!
//! Two trees of unsaturated arcs grow towards each other, one from the source and one from the
//! sink. Where they meet, flow is pushed along the path through both. Nodes that a saturated arc
//! cuts off look for another parent in their tree; where there is none, they become free again. The
//! trees are kept from path to path. This is much faster than a new search each time on the wide
//! and shallow graphs of a surface, where nearly every node is attached to a terminal.
//!
//! Source: Boykov & Kolmogorov, *An Experimental Comparison of Min-Cut/Max-Flow Algorithms for
//! Energy Minimization in Vision* (2004), section 3. The marks that save walks to the root are
//! those of the implementation in their section 3.2.3: a distance, and the time at which it was
//! valid.

use crate::numeric::index;
use crate::watch::{Interrupted, Work};
use std::collections::VecDeque;

/// A graph to be cut. Capacities are integers, so that the cut is exact, and the same whatever
/// paths the flow takes.
pub(super) struct MinimumCut {
    /// The end of each arc. The reverse arc has the number with the last bit flipped.
    heads: Vec<u32>,
    /// The residual capacity of each arc.
    rests: Vec<u64>,
    /// Per node, the residual capacity of the arc from the source; when negative, that of the arc
    /// to the sink.
    terminals: Vec<i64>,
}

/// How a node is attached to its tree.
#[derive(Clone, Copy, PartialEq)]
enum Parent {
    /// It is in no tree.
    None,
    /// It was cut off, and looks for a parent.
    Orphan,
    /// To the source or the sink.
    Terminal,
    /// By this arc from the node to its parent.
    Arc(u32),
}

#[derive(Clone, Copy, PartialEq)]
enum Tree {
    Source,
    Sink,
}

/// A node of the growing trees.
#[derive(Clone, Copy)]
struct CutNode {
    parent: Parent,
    tree: Tree,
    is_active: bool,
    /// Number of arcs to the root, valid at `time`.
    distance: u32,
    time: u32,
}

impl MinimumCut {
    /// A graph of nodes without arcs.
    pub(super) fn new(nodes: usize) -> MinimumCut {
        MinimumCut {
            heads: Vec::new(),
            rests: Vec::new(),
            terminals: vec![0; nodes],
        }
    }

    /// Attaches a node to source and sink; calls for one node add up.
    pub(super) fn add_terminal(&mut self, node: u32, from_source: i64, to_sink: i64) {
        // Flow that both arcs can carry passes through and decides nothing.
        self.terminals[node as usize] += from_source - to_sink;
    }

    /// Joins two nodes by arcs in both directions.
    pub(super) fn add_edge(&mut self, ends: [u32; 2], capacity: u64) {
        let [from, to] = ends;
        self.heads.extend([to, from]);
        self.rests.extend([capacity; 2]);
    }

    /// Which nodes lie on the side of the source, in the minimum cut with the fewest such nodes.
    ///
    /// # Cost
    /// In the worst case O(n^2 m c) for the capacity c of the cut; about linear on the graphs of
    /// surfaces.
    pub(super) fn source_side(self, work: Work) -> Result<Vec<bool>, Interrupted> {
        let mut trees = Trees::new(self);
        trees.grow(work)?;
        let is_of_source =
            |node: &CutNode| node.parent != Parent::None && node.tree == Tree::Source;
        Ok(trees.nodes.iter().map(is_of_source).collect())
    }
}

struct Trees {
    graph: MinimumCut,
    /// The arcs that leave each node: those of node i are `leaving[first[i]..first[i + 1]]`.
    first: Vec<u32>,
    leaving: Vec<u32>,
    nodes: Vec<CutNode>,
    active: VecDeque<u32>,
    orphans: VecDeque<u32>,
    time: u32,
}

impl Trees {
    fn new(graph: MinimumCut) -> Trees {
        let count = graph.terminals.len();
        let mut first = vec![0; count + 1];
        let tail = |arc: usize| graph.heads[arc ^ 1] as usize;
        (0..graph.heads.len()).for_each(|arc| first[tail(arc) + 1] += 1);
        for node in 0..count {
            first[node + 1] += first[node];
        }
        let mut next = first.clone();
        let mut leaving = vec![0; graph.heads.len()];
        for arc in 0..graph.heads.len() {
            let slot = &mut next[tail(arc)];
            leaving[*slot as usize] = index(arc);
            *slot += 1;
        }
        let nodes: Vec<CutNode> = graph
            .terminals
            .iter()
            .map(|&rest| CutNode {
                parent: match rest {
                    0 => Parent::None,
                    _ => Parent::Terminal,
                },
                tree: if rest < 0 { Tree::Sink } else { Tree::Source },
                is_active: rest != 0,
                distance: 1,
                time: 0,
            })
            .collect();
        let active = (0..index(count))
            .filter(|&node| nodes[node as usize].is_active)
            .collect();
        Trees {
            graph,
            first,
            leaving,
            nodes,
            active,
            orphans: VecDeque::new(),
            time: 0,
        }
    }

    /// The end of an arc.
    fn head(&self, arc: u32) -> u32 {
        self.graph.heads[arc as usize]
    }

    /// The residual capacity of an arc away from the source: along the arc in the tree of the
    /// source, against it in the tree of the sink.
    fn rest_outward(&self, arc: u32, tree: Tree) -> u64 {
        let arc = match tree {
            Tree::Source => arc,
            Tree::Sink => arc ^ 1,
        };
        self.graph.rests[arc as usize]
    }

    fn activate(&mut self, node: u32) {
        let known = &mut self.nodes[node as usize];
        if !known.is_active {
            known.is_active = true;
            self.active.push_back(node);
        }
    }

    /// Grows the trees until saturated arcs separate them.
    fn grow(&mut self, work: Work) -> Result<(), Interrupted> {
        while let Some(&node) = self.active.front() {
            work.check()?;
            let met = match self.nodes[node as usize].parent {
                Parent::None => None,
                _ => self.grow_from(node),
            };
            match met {
                // The node is tried again: it may touch the other tree elsewhere.
                Some(arc) => {
                    self.time += 1;
                    self.augment(arc);
                    while let Some(orphan) = self.orphans.pop_front() {
                        self.adopt(orphan);
                    }
                }
                None => {
                    self.active.pop_front();
                    self.nodes[node as usize].is_active = false;
                }
            }
        }
        Ok(())
    }

    /// Takes the free neighbours of a node into its tree. Returns the arc from the tree of the
    /// source to that of the sink, if the node touches the other tree.
    fn grow_from(&mut self, node: u32) -> Option<u32> {
        let own = self.nodes[node as usize];
        for slot in self.first[node as usize]..self.first[node as usize + 1] {
            let arc = self.leaving[slot as usize];
            if self.rest_outward(arc, own.tree) == 0 {
                continue;
            }
            let head = self.head(arc);
            let other = self.nodes[head as usize];
            let child = CutNode {
                parent: Parent::Arc(arc ^ 1),
                tree: own.tree,
                distance: own.distance + 1,
                time: own.time,
                ..other
            };
            if other.parent == Parent::None {
                self.nodes[head as usize] = child;
                self.activate(head);
            } else if other.tree != own.tree {
                return Some(match own.tree {
                    Tree::Source => arc,
                    Tree::Sink => arc ^ 1,
                });
            } else if other.time <= own.time && other.distance > own.distance {
                // A shorter path to the root.
                self.nodes[head as usize] = child;
            }
        }
        None
    }

    /// Pushes as much flow as fits along the path from the source through `arc` to the sink.
    fn augment(&mut self, arc: u32) {
        let ends = [
            (self.head(arc ^ 1), Tree::Source),
            (self.head(arc), Tree::Sink),
        ];
        let mut least = self.graph.rests[arc as usize];
        for (end, tree) in ends {
            let mut node = end;
            while let Parent::Arc(up) = self.nodes[node as usize].parent {
                least = least.min(self.rest_outward(up ^ 1, tree));
                node = self.head(up);
            }
            least = least.min(self.graph.terminals[node as usize].unsigned_abs());
        }
        self.push(arc, least);
        for (end, tree) in ends {
            let mut node = end;
            while let Parent::Arc(up) = self.nodes[node as usize].parent {
                match tree {
                    Tree::Source => self.push(up ^ 1, least),
                    Tree::Sink => self.push(up, least),
                }
                if self.rest_outward(up ^ 1, tree) == 0 {
                    self.nodes[node as usize].parent = Parent::Orphan;
                    self.orphans.push_front(node);
                }
                node = self.head(up);
            }
            let rest = &mut self.graph.terminals[node as usize];
            *rest = match tree {
                Tree::Source => rest.saturating_sub_unsigned(least),
                Tree::Sink => rest.saturating_add_unsigned(least),
            };
            if *rest == 0 {
                self.nodes[node as usize].parent = Parent::Orphan;
                self.orphans.push_front(node);
            }
        }
    }

    fn push(&mut self, arc: u32, amount: u64) {
        self.graph.rests[arc as usize] -= amount;
        self.graph.rests[arc as usize ^ 1] += amount;
    }

    /// Finds a parent for an orphan, the one nearest to the root, or sets the orphan free.
    fn adopt(&mut self, orphan: u32) {
        let tree = self.nodes[orphan as usize].tree;
        let slots = self.first[orphan as usize]..self.first[orphan as usize + 1];
        let mut best: Option<(u32, u32)> = None;
        for slot in slots.clone() {
            let up = self.leaving[slot as usize];
            if self.rest_outward(up ^ 1, tree) == 0 {
                continue;
            }
            if self.nodes[self.head(up) as usize].tree != tree {
                continue;
            }
            if let Some(distance) = self.distance_to_root(self.head(up))
                && best.is_none_or(|(_, least)| distance < least)
            {
                best = Some((up, distance));
            }
        }
        if let Some((up, distance)) = best {
            let known = &mut self.nodes[orphan as usize];
            known.parent = Parent::Arc(up);
            known.distance = distance + 1;
            known.time = self.time;
            return;
        }
        self.nodes[orphan as usize].parent = Parent::None;
        for slot in slots {
            let up = self.leaving[slot as usize];
            let head = self.head(up);
            let other = self.nodes[head as usize];
            if other.parent == Parent::None || other.tree != tree {
                continue;
            }
            if self.rest_outward(up ^ 1, tree) > 0 {
                self.activate(head);
            }
            if other.parent == Parent::Arc(up ^ 1) {
                self.nodes[head as usize].parent = Parent::Orphan;
                self.orphans.push_back(head);
            }
        }
    }

    /// The number of arcs from a node to the root of its tree; `None` where its tree has been cut
    /// off. Marks the nodes on the path.
    fn distance_to_root(&mut self, start: u32) -> Option<u32> {
        let mut node = start;
        let mut steps = 0;
        let distance = loop {
            let known = &mut self.nodes[node as usize];
            if known.parent != Parent::None && known.time == self.time {
                break steps + known.distance;
            }
            match known.parent {
                Parent::Arc(up) => node = self.head(up),
                Parent::Terminal => {
                    known.time = self.time;
                    known.distance = 1;
                    break steps + 1;
                }
                Parent::None | Parent::Orphan => return None,
            }
            steps += 1;
        };
        let mut node = start;
        let mut left = distance;
        loop {
            let known = &mut self.nodes[node as usize];
            if known.time == self.time {
                return Some(distance);
            }
            known.time = self.time;
            known.distance = left;
            let Parent::Arc(up) = known.parent else {
                return Some(distance);
            };
            node = self.head(up);
            left -= 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::random_below;

    /// The capacity of the cut with a given side of the source, in bits.
    fn capacity(terminals: &[[i64; 2]], edges: &[([u32; 2], u64)], side: u32) -> i64 {
        let is_source = |node: u32| side >> node & 1 == 1;
        let ends: i64 = (0..)
            .zip(terminals)
            .map(|(node, [from_source, to_sink])| {
                if is_source(node) {
                    *to_sink
                } else {
                    *from_source
                }
            })
            .sum();
        let between: u64 = edges
            .iter()
            .filter(|([a, b], _)| is_source(*a) != is_source(*b))
            .map(|(_, capacity)| capacity)
            .sum();
        ends + i64::try_from(between).expect("small")
    }

    /// Compares with all cuts of small random graphs: chains, stars and meshes, also with equal and
    /// with zero capacities.
    #[test]
    fn the_cut_is_the_least_of_all_and_the_smallest_of_those() {
        let mut below = random_below(7);
        for trial in 0..3_000 {
            let nodes = u32::try_from(1 + below(8)).expect("small");
            let most = 1 + below(if trial % 2 == 0 { 2 } else { 20 });
            let mut terminals = Vec::new();
            for _ in 0..nodes {
                let [a, b] = [below(most + 1), below(most + 1)].map(|c| c.cast_signed());
                terminals.push(if below(3) == 0 { [0, 0] } else { [a, b] });
            }
            let edges: Vec<([u32; 2], u64)> = (0..below(u64::from(3 * nodes)))
                .map(|_| {
                    let [a, b] =
                        [0; 2].map(|_: u32| u32::try_from(below(u64::from(nodes))).expect("small"));
                    ([a, b], below(most + 1))
                })
                .filter(|([a, b], _)| a != b)
                .collect();
            let mut cut = MinimumCut::new(nodes as usize);
            for (node, [from_source, to_sink]) in (0..).zip(&terminals) {
                cut.add_terminal(node, *from_source, *to_sink);
            }
            for &(ends, capacity) in &edges {
                cut.add_edge(ends, capacity);
            }
            let found: u32 = (0..)
                .zip(cut.source_side(Work::UNWATCHED).expect("nobody stops it"))
                .map(|(node, is_source)| u32::from(is_source) << node)
                .sum();
            let all = || (0..1_u32 << nodes).map(|side| capacity(&terminals, &edges, side));
            let least = all().min().expect("some cut");
            // The least cuts are closed under intersection.
            let smallest = (0..)
                .zip(all())
                .filter(|(_, capacity)| *capacity == least)
                .fold(u32::MAX, |common, (side, _)| common & side);
            assert_eq!(found, smallest, "{terminals:?} {edges:?}");
        }
    }

    #[test]
    fn a_long_chain_is_cut_at_its_weakest_link() {
        let count = 20_000;
        let mut cut = MinimumCut::new(count);
        cut.add_terminal(0, 1_000, 0);
        cut.add_terminal(index(count) - 1, 0, 1_000);
        for node in 0..index(count) - 1 {
            cut.add_edge([node, node + 1], if node == 12_345 { 3 } else { 5 });
        }
        let side = cut.source_side(Work::UNWATCHED).expect("nobody stops it");
        assert!(
            (0..count).all(|node| side[node] == (node <= 12_345)),
            "cut behind 12345"
        );
    }
}
