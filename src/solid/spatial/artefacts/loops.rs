//! Short closed paths on a surface that do not separate it: around its handles, or through them.
//!
//! The shortest paths from a vertex form a tree. The triangles, joined across the edges that are
//! not in it, longest first, form another. The edges in neither, two per handle, close loops, the
//! shortest of which is the shortest of all that start at the vertex and do not separate (Erickson
//! and Whittlesey, *Greedy optimal homotopy and homology generators*, 2005).

use crate::numeric::{DisjointSets, index};
use crate::surface::{Halves, next_in};
use crate::watch::{Interrupted, Work};
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

/// How often a loop is searched again from the place where it was found: it usually gets shorter
/// two or three times.
const TRIES: usize = 4;

/// Growth of the neighbourhoods in which loops are considered: the loop around a thin bridge is
/// much shorter than the one through the hole beside it.
const BEYOND: f64 = 8.0;

/// Number of loops that are considered at a place.
const CHOICE: usize = 12;

/// A closed path of half-edges through different vertices.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Loop {
    pub(crate) path: Vec<u32>,
    pub(crate) length: f64,
}

impl Loop {
    /// The vertex farthest along it.
    pub(crate) fn middle(&self, surface: &Halves) -> u32 {
        surface.from(self.path[self.path.len() / 2])
    }
}

/// Loops of a surface that do not separate it, two for each of its handles, not necessarily short.
/// O(n log n).
pub(crate) fn loops(surface: &Halves, work: Work) -> Result<Vec<Loop>, Interrupted> {
    let mut found = Vec::new();
    for root in roots(surface) {
        let tree = Tree::new(surface, root, f64::INFINITY, work)?;
        let closing = tree.closing_edges(surface);
        work.check()?;
        found.extend(
            closing
                .into_iter()
                .map(|half| tree.closed_by(surface, half)),
        );
    }
    Ok(found)
}

/// The shortest loops that do not separate the surface, near the farthest vertex of `first`: around
/// a handle and through it. Each item has those of a wider neighbourhood, by length. Loops longer
/// than `limit` are not searched for, and none is found once `work` is stopped.
///
/// O(m log m) for a neighbourhood of m triangles.
pub(crate) fn shortest_near(
    surface: &Halves,
    first: &Loop,
    limit: f64,
    work: Work,
) -> impl Iterator<Item = Vec<Loop>> {
    let around = move |vertex: u32, length: f64| {
        let Ok(tree) = Tree::new(surface, vertex, length.min(limit) / 2.0, work) else {
            return Vec::new();
        };
        let closing = tree.closing_edges(surface);
        let mut loops: Vec<Loop> = closing
            .into_iter()
            .map(|half| tree.closed_by(surface, half))
            .collect();
        loops.sort_by(|a, b| a.length.total_cmp(&b.length));
        loops
    };
    let (mut vertex, mut length) = (first.middle(surface), first.length);
    for _ in 0..TRIES {
        match around(vertex, length).first() {
            Some(shorter) if shorter.length < length => {
                (vertex, length) = (shorter.middle(surface), shorter.length);
            }
            _ => break,
        }
    }
    (1..)
        .map(move |times| length * BEYOND.powi(times))
        .take_while(move |wide| *wide < BEYOND * limit)
        .map(move |wide| {
            let mut loops = around(vertex, wide);
            loops.truncate(CHOICE);
            loops
        })
}

/// A vertex of every shell with handles.
fn roots(surface: &Halves) -> Vec<u32> {
    let mut seen = vec![false; surface.positions.len()];
    let mut roots = Vec::new();
    for root in 0..index(seen.len()) {
        if seen[root as usize] {
            continue;
        }
        seen[root as usize] = true;
        let mut shell = vec![root];
        let (mut next, mut halves) = (0, 0);
        while next < shell.len() {
            for half in surface.around(shell[next]) {
                halves += 1;
                let to = surface.to(half);
                if !seen[to as usize] {
                    seen[to as usize] = true;
                    shell.push(to);
                }
            }
            next += 1;
        }
        // V - E + F = 2 - 2 genus, with E = halves / 2 and F = halves / 3.
        if halves > 0 && shell.len() + halves / 3 < halves / 2 + 2 {
            roots.push(root);
        }
    }
    roots
}

/// Shortest paths from a vertex, up to a length.
struct Tree {
    /// Per vertex, its distance and the half-edge that leads to it.
    reached: HashMap<u32, (f64, Option<u32>)>,
}

impl Tree {
    fn new(surface: &Halves, root: u32, reach: f64, work: Work) -> Result<Tree, Interrupted> {
        let mut reached = HashMap::from([(root, (0.0, None))]);
        let mut queue = BinaryHeap::from([(Reverse(0_u64), root)]);
        while let Some((Reverse(bits), vertex)) = queue.pop() {
            work.check()?;
            let distance = f64::from_bits(bits);
            if distance > reached[&vertex].0 {
                continue;
            }
            for half in surface.around(vertex) {
                let (to, farther) = (surface.to(half), distance + surface.length(half));
                if farther <= reach && reached.get(&to).is_none_or(|known| farther < known.0) {
                    reached.insert(to, (farther, Some(half)));
                    // Nonnegative numbers are ordered like their bits.
                    queue.push((Reverse(farther.to_bits()), to));
                }
            }
        }
        Ok(Tree { reached })
    }

    /// Half-edges that close loops, ordered by the length of these loops. No loop separates the
    /// surface, nor, each after the others, what they leave of it.
    fn closing_edges(&self, surface: &Halves) -> Vec<u32> {
        let mut triangles: Vec<u32> = self
            .reached
            .keys()
            .flat_map(|&v| surface.around(v))
            .map(|half| half / 3)
            .collect();
        triangles.sort_unstable();
        triangles.dedup();
        let slot = |triangle: u32| triangles.binary_search(&triangle).ok().map(index);
        let mut sets = DisjointSets::new(4 * triangles.len());
        let mut edges = Vec::new();
        for (place, &triangle) in (0u32..).zip(&triangles) {
            for half in 3 * triangle..3 * triangle + 3 {
                let mate = surface.mate(half);
                let Some(other) = slot(mate / 3) else {
                    // Beyond the border of the neighbourhood everything is joined along the border.
                    let node = |half: u32| {
                        slot(half / 3).map(|s| index(triangles.len()) + 3 * s + half % 3)
                    };
                    let mut follower = next_in(half);
                    while slot(surface.mate(follower) / 3).is_some() {
                        follower = next_in(surface.mate(follower));
                    }
                    if let Some((here, there)) = node(half).zip(node(follower)) {
                        sets.join(here, there);
                        sets.join(place, here);
                    }
                    continue;
                };
                if half > mate {
                    continue;
                }
                let ends = [surface.from(half), surface.to(half)].map(|v| self.reached.get(&v));
                let [Some((from, to_from)), Some((to, to_to))] = ends else {
                    sets.join(place, other);
                    continue;
                };
                let is_in_tree = [to_from, to_to]
                    .iter()
                    .any(|way| **way == Some(half) || **way == Some(mate));
                if !is_in_tree {
                    edges.push((from + to + surface.length(half), half, [place, other]));
                }
            }
        }
        edges.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.cmp(&a.1)));
        let mut closing: Vec<u32> = edges
            .into_iter()
            .filter(|&(_, _, [place, other])| !sets.join(place, other))
            .map(|(_, half, _)| half)
            .collect();
        closing.reverse();
        closing
    }

    /// The loop that an edge closes, starting where the paths to its two ends part.
    fn closed_by(&self, surface: &Halves, closing: u32) -> Loop {
        let path_to = |mut vertex: u32| {
            let mut path = Vec::new();
            while let Some(half) = self.reached[&vertex].1 {
                path.push(half);
                vertex = surface.from(half);
            }
            path.reverse();
            path
        };
        let there = path_to(surface.from(closing));
        let back = path_to(surface.to(closing));
        let common = there
            .iter()
            .zip(&back)
            .take_while(|(one, other)| one == other)
            .count();
        let mut path = there[common..].to_vec();
        path.push(closing);
        path.extend(back[common..].iter().rev().map(|&half| surface.mate(half)));
        let length = path.iter().map(|&half| surface.length(half)).sum();
        Loop { path, length }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use std::f64::consts::TAU;

    fn all_loops(surface: &Halves) -> Vec<Loop> {
        loops(surface, Work::UNWATCHED).expect("nobody stops it")
    }

    /// A torus of radii 3 and `thickness`.
    fn torus(thickness: f64) -> Halves {
        let (around, across) = (16, 8);
        let at = |i: u32, j: u32| (i % around) * across + j % across;
        let positions: Vec<DVec3> = (0..around * across)
            .map(|v| {
                let [u, w] = [f64::from(v / across) / 16.0, f64::from(v % across) / 8.0];
                let (radius, height) = (
                    3.0 + thickness * (w * TAU).cos(),
                    thickness * (w * TAU).sin(),
                );
                DVec3::new(radius * (u * TAU).cos(), radius * (u * TAU).sin(), height)
            })
            .collect();
        let triangles: Vec<[u32; 3]> = (0..around)
            .flat_map(|i| (0..across).map(move |j| (i, j)))
            .flat_map(|(i, j)| {
                [
                    [at(i, j), at(i + 1, j), at(i + 1, j + 1)],
                    [at(i, j), at(i + 1, j + 1), at(i, j + 1)],
                ]
            })
            .collect();
        Halves::new(&positions, &triangles).expect("closed")
    }

    #[test]
    fn a_torus_has_two_loops_and_the_shortest_goes_round_its_tube() {
        let surface = torus(0.5);
        let found = all_loops(&surface);
        assert_eq!(found.len(), 2, "two per handle");
        let best = shortest_near(&surface, &found[1], 100.0, Work::UNWATCHED)
            .flatten()
            .min_by(|a, b| a.length.total_cmp(&b.length))
            .expect("the torus has a handle");
        // A regular octagon of radius 0.5.
        let tube = 8.0 * 2.0 * 0.5 * (TAU / 16.0).sin();
        assert!(
            (best.length - tube).abs() < 1e-12,
            "{} against {tube}",
            best.length
        );
        assert!(surface.stays_connected(&best.path), "it does not separate");
        for (half, next) in best.path.iter().zip(best.path.iter().cycle().skip(1)) {
            assert_eq!(surface.to(*half), surface.from(*next), "a closed path");
        }
    }

    #[test]
    fn the_second_choice_goes_through_the_hole() {
        let surface = torus(0.5);
        let first = &all_loops(&surface)[0];
        let choices: Vec<Loop> = shortest_near(&surface, first, 100.0, Work::UNWATCHED)
            .flatten()
            .collect();
        // It is nowhere nearer to the axis than the inside of the tube, 2.5, up to its chords.
        let through = choices
            .iter()
            .find(|l| l.length > 10.0)
            .expect("a longer loop");
        assert!(
            through.length > TAU * 2.4,
            "round the axis: {}",
            through.length
        );
    }

    #[test]
    fn loops_beyond_the_limit_are_not_found() {
        let surface = torus(0.5);
        let first = &all_loops(&surface)[0];
        assert_eq!(
            shortest_near(&surface, first, 2.0, Work::UNWATCHED)
                .flatten()
                .count(),
            0,
            "the tube takes 3.06"
        );
    }
}
