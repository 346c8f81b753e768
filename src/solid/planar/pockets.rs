//! The bounded parts of the outside of a region.

use super::outlines::components;
use super::{Arrangement, OUTSIDE};
use glam::DVec2;

/// A bounded part of the outside that hangs together across edges.
#[derive(Debug, Clone, PartialEq)]
pub struct Pocket {
    /// Its triangles, ascending.
    pub triangles: Vec<u32>,
    /// Its area.
    pub area: f64,
    /// Incentres of its triangles of greatest inradius, the greatest first, at most [`Pocket::WITNESSES`] of them.
    pub witnesses: Vec<DVec2>,
    /// The inradius about the first of these: a disc of that radius about it lies in the pocket.
    pub depth: f64,
}

impl Pocket {
    /// Most witnesses of one pocket.
    pub const WITNESSES: usize = 5;
}

/// All pockets, in the order of their first triangles.
pub(super) fn pockets(arrangement: &Arrangement) -> Vec<Pocket> {
    let inside = |triangle: u32| arrangement.is_inside[triangle as usize];
    let (component, count) = components(&arrangement.cells, |a, b| inside(a) == inside(b));
    let mut members = vec![Vec::new(); count as usize];
    let mut is_bounded = vec![true; count as usize];
    for (triangle, number) in (0_u32..).zip(&component) {
        let number = *number as usize;
        if inside(triangle) {
            is_bounded[number] = false;
        } else {
            members[number].push(triangle);
        }
        is_bounded[number] &= !arrangement.cells.neighbours[triangle as usize].contains(&OUTSIDE);
    }
    members
        .into_iter()
        .zip(is_bounded)
        .filter(|(_, is_bounded)| *is_bounded)
        .map(|(triangles, _)| pocket(arrangement, triangles))
        .collect()
}

fn pocket(arrangement: &Arrangement, triangles: Vec<u32>) -> Pocket {
    let mut area = 0.0;
    let mut centres: Vec<(f64, DVec2)> = triangles
        .iter()
        .map(|&triangle| {
            let corners = arrangement.triangles()[triangle as usize];
            let [a, b, c] = corners.map(|corner| arrangement.positions[corner as usize]);
            let doubled = (b - a).perp_dot(c - a);
            area += doubled / 2.0;
            let sides = [b.distance(c), c.distance(a), a.distance(b)];
            let around = sides[0] + sides[1] + sides[2];
            let centre = a + ((b - a) * sides[1] + (c - a) * sides[2]) / around;
            (doubled / around, centre)
        })
        .collect();
    centres.sort_by(|a, b| b.0.total_cmp(&a.0));
    centres.truncate(Pocket::WITNESSES);
    Pocket {
        triangles,
        area,
        depth: centres.first().map_or(0.0, |centre| centre.0),
        witnesses: centres.into_iter().map(|centre| centre.1).collect(),
    }
}
