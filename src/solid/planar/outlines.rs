//! The boundary of a region of triangles as closed loops.

use super::cells::{Cells, OUTSIDE, edge};
use crate::numeric::index;
use std::collections::HashMap;

/// A closed polygon without self-crossings that bounds a region on its left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Loop {
    /// Indices of its vertices, each once, the least first: counter-clockwise round a piece, clockwise round a hole.
    pub vertices: Vec<u32>,
    /// Number of the piece that it bounds.
    pub piece: u32,
}

/// The boundary of a region.
///
/// A *piece* is a part of the region that hangs together across edges; a *hole* of a piece is a bounded part of the plane without it that
/// hangs together across edges. So pieces that meet in a vertex only are apart, a hole that touches the outside in a vertex is
/// a hole, and what several pieces surround that meet in vertices is not.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Outlines {
    /// The outer loop of each piece, in the order of their numbers.
    pub pieces: Vec<Loop>,
    /// The loops of the holes, in the order of their pieces.
    pub holes: Vec<Loop>,
}

impl Outlines {
    /// All loops: first those round pieces, then those round holes.
    pub fn loops(&self) -> impl Iterator<Item = &Loop> {
        self.pieces.iter().chain(&self.holes)
    }
}

/// Numbers the sets of triangles that hang together across edges and are alike; per triangle, and the count.
pub(super) fn components(cells: &Cells, is_alike: impl Fn(u32, u32) -> bool) -> (Vec<u32>, u32) {
    let mut number = vec![OUTSIDE; cells.triangles.len()];
    let mut count = 0;
    let mut open = Vec::new();
    for start in 0..index(cells.triangles.len()) {
        if number[start as usize] != OUTSIDE {
            continue;
        }
        number[start as usize] = count;
        open.push(start);
        while let Some(triangle) = open.pop() {
            for neighbour in cells.neighbours[triangle as usize] {
                if neighbour != OUTSIDE
                    && number[neighbour as usize] == OUTSIDE
                    && is_alike(triangle, neighbour)
                {
                    number[neighbour as usize] = count;
                    open.push(neighbour);
                }
            }
        }
        count += 1;
    }
    (number, count)
}

/// The loops round the triangles that are inside.
///
/// - `is_straight`: whether a vertex between two others can be left out.
pub(super) fn outlines(
    cells: &Cells,
    is_inside: &[bool],
    is_straight: impl Fn([u32; 3]) -> bool,
    is_outer: impl Fn(&[u32]) -> bool,
) -> Outlines {
    let inside = |triangle: u32| triangle != OUTSIDE && is_inside[triangle as usize];
    let (component, _) = components(cells, |a, b| inside(a) == inside(b));
    let is_boundary = |triangle: u32, k: usize| {
        inside(triangle) && !inside(cells.neighbours[triangle as usize][k])
    };
    let mut is_used = vec![[false; 3]; cells.triangles.len()];
    let mut degree = HashMap::<u32, u32>::new();
    let mut loops = Vec::new();
    for start in 0..index(cells.triangles.len()) {
        for first in 0..3 {
            if !is_boundary(start, first) || is_used[start as usize][first] {
                continue;
            }
            // Round the region, within the fan of its triangles at each vertex.
            let (mut triangle, mut k) = (start, first);
            let mut way = Vec::new();
            loop {
                is_used[triangle as usize][k] = true;
                let [from, to] = edge(&cells.triangles[triangle as usize], k);
                way.push(from);
                *degree.entry(from).or_default() += 1;
                k = (k + 1) % 3;
                while !is_boundary(triangle, k) {
                    let next = cells.neighbours[triangle as usize][k];
                    let corners = &cells.triangles[next as usize];
                    // Its edge from the same vertex.
                    k = (0..3).find(|&k| corners[k] == to).unwrap_or_default();
                    triangle = next;
                }
                if (triangle, k) == (start, first) {
                    break;
                }
            }
            split(&way, component[start as usize], &mut loops);
        }
    }
    for (vertices, _) in &mut loops {
        straighten(vertices, |corner| {
            degree[&corner[1]] == 1 && is_straight(corner)
        });
        let least = (0..vertices.len())
            .min_by_key(|&place| vertices[place])
            .unwrap_or_default();
        vertices.rotate_left(least);
    }
    loops.sort_unstable();
    number_pieces(loops, is_outer)
}

/// Adds the simple loops that a closed way through some vertices more than once consists of.
fn split(way: &[u32], component: u32, loops: &mut Vec<(Vec<u32>, u32)>) {
    let mut place = HashMap::<u32, usize>::with_capacity(way.len());
    let mut open: Vec<u32> = Vec::with_capacity(way.len());
    for &vertex in way {
        if let Some(&start) = place.get(&vertex) {
            let closed = open.split_off(start);
            closed.iter().for_each(|vertex| {
                place.remove(vertex);
            });
            loops.push((closed, component));
        }
        place.insert(vertex, open.len());
        open.push(vertex);
    }
    loops.push((open, component));
}

/// Leaves out the vertices that are not needed.
fn straighten(vertices: &mut Vec<u32>, is_straight: impl Fn([u32; 3]) -> bool) {
    let count = vertices.len();
    // The outermost vertex in any direction is a corner, so corners remain.
    let Some(corner) = (0..count).find(|&place| {
        let around = [place + count - 1, place, place + 1].map(|place| vertices[place % count]);
        !is_straight(around)
    }) else {
        return;
    };
    vertices.rotate_left(corner);
    let mut kept: Vec<u32> = Vec::with_capacity(count);
    for place in 0..count {
        let next = vertices[(place + 1) % count];
        let vertex = vertices[place];
        if kept
            .last()
            .is_none_or(|&last| !is_straight([last, vertex, next]))
        {
            kept.push(vertex);
        }
    }
    *vertices = kept;
}

fn number_pieces(loops: Vec<(Vec<u32>, u32)>, is_outer: impl Fn(&[u32]) -> bool) -> Outlines {
    let (outer, holes): (Vec<_>, Vec<_>) = loops
        .into_iter()
        .partition(|(vertices, _)| is_outer(vertices));
    let number: HashMap<u32, u32> = outer
        .iter()
        .zip(0..)
        .map(|((_, component), piece)| (*component, piece))
        .collect();
    let numbered = |(vertices, component): (Vec<u32>, u32)| Loop {
        vertices,
        piece: number.get(&component).copied().unwrap_or_default(),
    };
    let mut holes: Vec<Loop> = holes.into_iter().map(numbered).collect();
    holes.sort_by_key(|hole| hole.piece);
    Outlines {
        pieces: outer.into_iter().map(numbered).collect(),
        holes,
    }
}
