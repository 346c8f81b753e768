//! The boundary of a region of triangles as closed loops.

use super::faces::{Faces, twin};
use super::strokes::Stroke;
use crate::numeric::index;
use std::collections::HashMap;

/// A closed polygon without self-crossings that bounds a region on its left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Loop {
    /// Indices of its vertices, each once, the least first: counter-clockwise around a piece,
    /// clockwise around a hole.
    pub vertices: Vec<u32>,
    /// Number of the piece that it bounds.
    pub piece: u32,
}

/// The boundary of a region.
///
/// A *piece* is a part of the region that is connected across edges; a *hole* of a piece is a
/// bounded part of the plane outside the piece that is connected across edges. So pieces that meet
/// only in a vertex are separate, a hole that touches the outside in a vertex is a hole, and an
/// area surrounded by several pieces that meet in vertices is none.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Outlines {
    /// The outer loop of each piece, in the order of their numbers.
    pub pieces: Vec<Loop>,
    /// The loops of the holes, in the order of their pieces.
    pub holes: Vec<Loop>,
}

impl Outlines {
    /// All loops: first those around pieces, then those around holes.
    pub fn loops(&self) -> impl Iterator<Item = &Loop> {
        self.pieces.iter().chain(&self.holes)
    }
}

/// The loops around the faces that are inside.
///
/// - `is_straight`: whether a vertex between two others can be left out.
/// - `is_outer`: whether a loop runs counter-clockwise.
pub(super) fn outlines(
    faces: &Faces,
    pieces: &[Stroke],
    is_inside: &[bool],
    is_straight: impl Fn([u32; 3]) -> bool,
    is_outer: impl Fn(&[u32]) -> bool,
) -> Outlines {
    let inside = |half: u32| is_inside[faces.face_of(half) as usize];
    let is_boundary = |half: u32| inside(half) && !inside(twin(half));
    let component = faces.components(|a, b| is_inside[a as usize] == is_inside[b as usize]);
    let mut is_used = vec![false; 2 * pieces.len()];
    let mut degree = HashMap::<u32, u32>::new();
    let mut loops = Vec::new();
    for start in 0..index(2 * pieces.len()) {
        if !is_boundary(start) || is_used[start as usize] {
            continue;
        }
        // Around the region, staying in the same sector of it at each vertex.
        let mut half = start;
        let mut way = Vec::new();
        loop {
            is_used[half as usize] = true;
            let from = pieces[half as usize / 2].ends[half as usize % 2];
            way.push(from);
            *degree.entry(from).or_default() += 1;
            half = faces.after(half);
            while !is_boundary(half) {
                half = faces.after(twin(half));
            }
            if half == start {
                break;
            }
        }
        split(&way, component[faces.face_of(start) as usize], &mut loops);
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

/// Adds the simple loops that make up a closed walk, which may pass vertices more than once.
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

/// Removes the vertices that are not needed.
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
