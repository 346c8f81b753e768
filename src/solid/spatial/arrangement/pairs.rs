//! Which triangles meet, and where: points and segments, named by the features that define them.

use super::point::Definition;
use super::surface::GridSurface;
use crate::Fault;
use crate::bounds::SurfaceTree;
use crate::numeric::exact::signs::Sign;
use crate::numeric::exact::spatial_grid;
use crate::numeric::index;
use crate::watch::{Stop, Work};
use rayon::prelude::*;

/// A fact about two triangles that meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Fact {
    /// A point inside an edge.
    OnEdge(u32, Definition),
    /// The triangle is cut by the other along a segment through its interior.
    Segment {
        triangle: u32,
        other: u32,
        ends: [Definition; 2],
    },
    /// The other triangle meets the triangle in one point.
    Touch { triangle: u32, at: Definition },
    /// Two triangles of one plane that meet.
    Coplanar([u32; 2]),
    /// Two triangles of one plane with a common area.
    Overlap([u32; 2]),
}

/// Triangles per parallel task: a constant, so that the order does not depend on the number of
/// threads.
const PIECE: usize = 256;

/// All facts, in an order that depends only on the surface.
///
/// They come in lists, each sorted and without repetitions. An error reports a contradiction.
pub(super) fn facts(
    surface: &GridSurface,
    tree: &SurfaceTree,
    work: Work,
) -> Result<Vec<Vec<Fact>>, Stop> {
    let numbers: Vec<u32> = (0..index(surface.triangles.len())).collect();
    let items = work.items(numbers.len());
    numbers
        .par_chunks(PIECE)
        .map(|piece| {
            let mut facts = Vec::new();
            let mut near = Vec::new();
            for &a in piece {
                items.next()?;
                let [low, high] = surface.box_of(a);
                near.clear();
                tree.for_each_in_box([low, high], |b| {
                    if b > a {
                        let [other_low, other_high] = surface.box_of(b);
                        if other_low.cmple(high).all() && low.cmple(other_high).all() {
                            near.push(b);
                        }
                    }
                });
                near.iter()
                    .try_for_each(|&b| meet(surface, [a, b], &mut facts))?;
            }
            facts.sort_unstable();
            facts.dedup();
            facts.shrink_to_fit();
            Ok(facts)
        })
        .collect()
}

/// A point that two triangles share, with the edges of each on which it lies, as bits.
#[derive(Debug, Clone, Copy)]
struct Shared {
    definition: Definition,
    edges: [u8; 2],
}

/// The edges of a triangle on which one of its corners lies, as bits.
fn edges_at(corner: usize) -> u8 {
    (1 << corner) | (1 << ((corner + 2) % 3))
}

fn meet(surface: &GridSurface, pair: [u32; 2], facts: &mut Vec<Fact>) -> Result<(), Fault> {
    let corners = pair.map(|t| surface.triangles[t as usize]);
    let places = pair.map(|t| surface.triangle(t));
    // Per triangle, the signs of its corners relative to the plane of the other.
    let mut signs = [[Sign::Zero; 3]; 2];
    for i in 0..2 {
        let [a, b, c] = places[1 - i];
        for k in 0..3 {
            if !corners[1 - i].contains(&corners[i][k]) {
                signs[i][k] = spatial_grid::side_of_plane([a, b, c], places[i][k]);
            }
        }
        if signs[i] == [Sign::Positive; 3] || signs[i] == [Sign::Negative; 3] {
            return Ok(());
        }
    }
    if signs[0] == [Sign::Zero; 3] {
        coplanar(surface, pair, facts);
        return Ok(());
    }
    let common = corners[0].iter().filter(|v| corners[1].contains(v)).count();
    if common == 2 {
        // The two planes meet in one line, that of the common edge.
        return Ok(());
    }
    let touches_only = |signs: &[Sign; 3]| {
        let on = signs.iter().filter(|&&s| s == Sign::Zero).count();
        let above = signs.iter().filter(|&&s| s == Sign::Positive).count();
        on == 1 && above != 1
    };
    if common == 1 && (touches_only(&signs[0]) || touches_only(&signs[1])) {
        return Ok(());
    }
    let mut shared = Vec::<Shared>::with_capacity(4);
    for i in 0..2 {
        for k in 0..3 {
            match (signs[i][k], signs[i][(k + 1) % 3]) {
                (Sign::Zero, _) => {
                    if let Some(edges) = locate(surface, pair[1 - i], corners[i][k]) {
                        let mut on = [0; 2];
                        on[i] = edges_at(k);
                        on[1 - i] = edges;
                        add(&mut shared, Definition::Corner(corners[i][k]), on);
                    }
                }
                (_, Sign::Zero) => {}
                (from, to) if from != to => {
                    pierce(surface, pair, i, k, &signs, &mut shared);
                }
                _ => {}
            }
        }
    }
    for point in &shared {
        for (triangle, edges) in pair.into_iter().zip(point.edges) {
            report_on_edge(surface, triangle, edges, point.definition, facts);
        }
    }
    match shared[..] {
        [p] => {
            for (triangle, edges) in pair.into_iter().zip(p.edges) {
                // A point on the outline is already known there.
                if edges == 0 {
                    facts.push(Fact::Touch {
                        triangle,
                        at: p.definition,
                    });
                }
            }
        }
        [p, q] => {
            for i in 0..2 {
                if p.edges[i] & q.edges[i] == 0 {
                    facts.push(Fact::Segment {
                        triangle: pair[i],
                        other: pair[1 - i],
                        ends: [p.definition, q.definition],
                    });
                }
            }
        }
        [] => {}
        _ => {
            return Err(Fault::new(
                "two triangles of different planes meet in more than a segment",
            ));
        }
    }
    Ok(())
}

fn add(shared: &mut Vec<Shared>, definition: Definition, edges: [u8; 2]) {
    if let Some(known) = shared.iter_mut().find(|s| s.definition == definition) {
        (0..2).for_each(|i| known.edges[i] |= edges[i]);
    } else {
        shared.push(Shared { definition, edges });
    }
}

/// Reports a point inside an edge. A point on two edges is a corner, which both edges have anyway.
fn report_on_edge(
    surface: &GridSurface,
    triangle: u32,
    edges: u8,
    definition: Definition,
    facts: &mut Vec<Fact>,
) {
    if edges.count_ones() == 1 {
        let edge = surface.triangle_edges[triangle as usize][edges.trailing_zeros() as usize];
        if !matches!(definition, Definition::Corner(v) if surface.edges[edge as usize].contains(&v))
        {
            facts.push(Fact::OnEdge(edge, definition));
        }
    }
}

/// The edges of a triangle on which a corner in its plane lies, as bits; `None` outside the
/// triangle.
fn locate(surface: &GridSurface, triangle: u32, corner: u32) -> Option<u8> {
    let ring = surface.triangles[triangle as usize];
    if let Some(k) = ring.iter().position(|&v| v == corner) {
        return Some(edges_at(k));
    }
    let axis = surface.axis[triangle as usize];
    let place = surface.corners[corner as usize];
    let mut edges = 0;
    for k in 0..3 {
        let [a, b] = [ring[k], ring[(k + 1) % 3]].map(|v| surface.corners[v as usize]);
        match spatial_grid::orientation(axis.number, [a, b, place]).flipped_unless(axis.is_forward)
        {
            Sign::Negative => return None,
            Sign::Zero => edges |= 1 << k,
            Sign::Positive => {}
        }
    }
    Some(edges)
}

/// The point where edge `k` of triangle `i` of the pair, whose ends lie on different sides, passes
/// through the other triangle.
fn pierce(
    surface: &GridSurface,
    pair: [u32; 2],
    i: usize,
    k: usize,
    signs: &[[Sign; 3]; 2],
    shared: &mut Vec<Shared>,
) {
    let edge = surface.triangle_edges[pair[i] as usize][k];
    let [p, q] = surface.edge(edge);
    let other = surface.triangle(pair[1 - i]);
    let sides =
        [0, 1, 2].map(|j| spatial_grid::side_of_plane([p, q, other[j]], other[(j + 1) % 3]));
    if sides.contains(&Sign::Positive) && sides.contains(&Sign::Negative) {
        return;
    }
    let mut touched = 0_u8;
    (0..3).for_each(|j| touched |= u8::from(sides[j] == Sign::Zero) << j);
    let mut on = [0; 2];
    on[i] = 1 << k;
    on[1 - i] = touched;
    let definition = match touched.count_ones() {
        0 => Definition::Pierce {
            edge,
            triangle: pair[1 - i],
        },
        1 => {
            // Two edges cross. If each passes through the plane of the other's triangle, the one
            // with the smaller number defines the point.
            let j = touched.trailing_zeros() as usize;
            let other_edge = surface.triangle_edges[pair[1 - i] as usize][j];
            let [from, to] = [signs[1 - i][j], signs[1 - i][(j + 1) % 3]];
            let goes_through = from != Sign::Zero && to != Sign::Zero && from != to;
            if goes_through && other_edge < edge {
                Definition::Pierce {
                    edge: other_edge,
                    triangle: pair[i],
                }
            } else {
                Definition::Pierce {
                    edge,
                    triangle: pair[1 - i],
                }
            }
        }
        _ => {
            let ring = surface.triangles[pair[1 - i] as usize];
            let Some(corner) = (0..3).find(|&c| edges_at(c) & touched == edges_at(c)) else {
                return;
            };
            on[1 - i] = edges_at(corner);
            Definition::Corner(ring[corner])
        }
    };
    add(shared, definition, on);
}

/// Two triangles of one plane.
fn coplanar(surface: &GridSurface, pair: [u32; 2], facts: &mut Vec<Fact>) {
    let axis = surface.axis[pair[0] as usize];
    let mut is_met = false;
    for i in 0..2 {
        for &corner in &surface.triangles[pair[i] as usize] {
            if let Some(edges) = locate(surface, pair[1 - i], corner) {
                is_met = true;
                report_on_edge(
                    surface,
                    pair[1 - i],
                    edges,
                    Definition::Corner(corner),
                    facts,
                );
            }
        }
    }
    for e in surface.triangle_edges[pair[0] as usize] {
        for f in surface.triangle_edges[pair[1] as usize] {
            let ([a, b], [c, d]) = (surface.edge(e), surface.edge(f));
            let side = |line, point| {
                let [p, q]: [glam::DVec3; 2] = line;
                spatial_grid::orientation(axis.number, [p, q, point])
            };
            let cross = |one: Sign, two: Sign| one != Sign::Zero && one == two.flipped();
            if e != f
                && cross(side([a, b], c), side([a, b], d))
                && cross(side([c, d], a), side([c, d], b))
            {
                is_met = true;
                let definition = Definition::Cross {
                    edges: [e.min(f), e.max(f)],
                    axis: u8::try_from(axis.number).unwrap_or_default(),
                };
                facts.push(Fact::OnEdge(e, definition));
                facts.push(Fact::OnEdge(f, definition));
            }
        }
    }
    if !is_met {
        return;
    }
    facts.push(Fact::Coplanar(pair));
    // Convex outlines have no common area if and only if the line of an edge separates them.
    let is_separated = (0..2).any(|i| {
        let ring = surface.triangle(pair[i]);
        let forward = surface.axis[pair[i] as usize];
        (0..3).any(|k| {
            surface.triangle(pair[1 - i]).iter().all(|&p| {
                let side =
                    spatial_grid::orientation(forward.number, [ring[k], ring[(k + 1) % 3], p]);
                side.flipped_unless(forward.is_forward) != Sign::Positive
            })
        })
    });
    if !is_separated {
        facts.push(Fact::Overlap(pair));
    }
}
