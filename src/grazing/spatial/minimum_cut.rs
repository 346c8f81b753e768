//! The minimum cut of a graph whose nodes hang on a source, on a sink, or on neither.
//!
//! Two trees of arcs that are not full grow towards each other, one from the source, one from the
//! sink. Where they meet, flow is pushed along the path through both; nodes that a full arc cuts
//! off look for another parent in their tree, and where there is none they are free again. The
//! trees are kept from path to path, which is why this is much faster than searching anew on the
//! wide and shallow graphs of a surface, where nearly every node hangs on an end.
//!
//! Source: Boykov & Kolmogorov, *An Experimental Comparison of Min-Cut/Max-Flow Algorithms for
//! Energy Minimization in Vision* (2004), section 3. The marks that save walks to the root are
//! those of their section 3.2.3's implementation: a distance and the time at which it was right.

use crate::numeric::index;
use std::collections::VecDeque;

/// A graph to be cut. Capacities are integers: the cut is exact, and it is the same whatever paths
/// the flow takes.
pub(super) struct MinimumCut {
    /// Where each arc leads. The arc back has the number with the last bit flipped.
    heads: Vec<u32>,
    /// What each arc can still carry.
    rests: Vec<u64>,
    /// Per node, what the arc from the source can still carry, or, negative, the arc to the sink.
    terminals: Vec<i64>,
}

/// How a node hangs in a tree.
#[derive(Clone, Copy, PartialEq)]
enum Parent {
    /// In no tree.
    None,
    /// It was cut off and looks for a parent.
    Orphan,
    /// On the source or the sink.
    Terminal,
    /// By the arc from this node to its parent.
    Arc(u32),
}

#[derive(Clone, Copy, PartialEq)]
enum Tree {
    Source,
    Sink,
}

/// A node of the growing trees.
#[derive(Clone, Copy)]
struct Node {
    parent: Parent,
    tree: Tree,
    is_active: bool,
    /// Arcs to the root, right at `time`.
    distance: u32,
    time: u32,
}

impl MinimumCut {
    /// Nodes without arcs.
    pub(super) fn new(nodes: usize) -> MinimumCut {
        MinimumCut {
            heads: Vec::new(),
            rests: Vec::new(),
            terminals: vec![0; nodes],
        }
    }

    /// Hangs a node on both ends; calls for one node add up.
    pub(super) fn add_terminal(&mut self, node: u32, from_source: i64, to_sink: i64) {
        // What both could carry passes through and decides nothing.
        self.terminals[node as usize] += from_source - to_sink;
    }

    /// Joins two nodes by an arc either way.
    pub(super) fn add_edge(&mut self, ends: [u32; 2], capacity: u64) {
        let [from, to] = ends;
        self.heads.extend([to, from]);
        self.rests.extend([capacity; 2]);
    }

    /// Which nodes lie on the side of the source: of all minimum cuts, the one with the fewest.
    ///
    /// # Cost
    /// Worst case O(n^2 m c) for the capacity c of the cut; on the graphs of surfaces about linear.
    pub(super) fn source_side(self) -> Vec<bool> {
        let mut trees = Trees::new(self);
        trees.grow();
        trees
            .nodes
            .iter()
            .map(|node| node.parent != Parent::None && node.tree == Tree::Source)
            .collect()
    }
}

struct Trees {
    graph: MinimumCut,
    /// Arcs that leave each node: those of node i are `leaving[first[i]..first[i + 1]]`.
    first: Vec<u32>,
    leaving: Vec<u32>,
    nodes: Vec<Node>,
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
        let nodes: Vec<Node> = graph
            .terminals
            .iter()
            .map(|&rest| Node {
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

    /// What an arc can still carry away from the source: along the arc in the tree of the source,
    /// against it in the tree of the sink.
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

    /// Until the trees are parted by full arcs.
    fn grow(&mut self) {
        while let Some(&node) = self.active.front() {
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
            let child = Node {
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

    /// Pushes what fits along the path from the source through `arc` to the sink.
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

    /// Finds a parent for an orphan, the nearest to the root, or sets it free.
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

    /// Arcs from a node to the root of its tree; none where its tree has been cut off. Marks the
    /// nodes on the path.
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

    /// Capacity of the cut that a side of the source, given as bits, makes.
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

    /// All cuts of small random graphs: chains, stars and meshes, with equal capacities and none.
    #[test]
    fn the_cut_is_the_least_of_all_and_the_smallest_of_those() {
        let mut state = 7_u64;
        let mut below = |count: u64| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % count
        };
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
                .zip(cut.source_side())
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
        let side = cut.source_side();
        assert!(
            (0..count).all(|node| side[node] == (node <= 12_345)),
            "cut behind 12345"
        );
    }
}
