//! The cells of space between the facets, and their winding numbers.
//!
//! The facets are not a closed surface yet: each counts several times or not at all, and any number
//! of them meet at an edge, in an exact order. Therefore their uses of edges are listed here, in
//! parallel, instead of by `surface::Sides`. The boundary of the region becomes a surface in
//! `boundary`.

use super::network::direction;
use super::point::{Point, order_of_heights};
use super::surface::GridSurface;
use crate::Fault;
use crate::bounds::SurfaceTree;
use crate::numeric::exact::signs::Sign;
use crate::numeric::exact::spatial_grid::{self, Axis, product_component};
use crate::numeric::{DisjointSets, index};
use crate::watch::{Interrupted, Stop, Work};
use glam::DVec3;
use rayon::prelude::*;
use std::cmp::Ordering;

/// A triangle of the arrangement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Facet {
    pub(super) corners: [u32; 3],
    /// The increase of the winding number from the side of the normal to the other side; 0 where
    /// the covering triangles cancel.
    pub(super) multiplicity: i32,
    /// A triangle of the surface in the same plane, with the same normal direction.
    pub(super) plane: u32,
}

/// A facet at an edge. There are many of these, so they take only 12 bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Use {
    /// The ends of the edge, ascending.
    pub(super) edge: [u32; 2],
    /// Twice the facet, plus one if it runs through the edge from its first end to its second.
    facet_and_way: u32,
}

impl Use {
    fn new(facet: usize, [from, to]: [u32; 2]) -> Use {
        Use {
            edge: [from.min(to), from.max(to)],
            facet_and_way: index(2 * facet) + u32::from(from < to),
        }
    }

    pub(super) fn facet(&self) -> u32 {
        self.facet_and_way >> 1
    }

    /// Whether the facet runs through the edge from its first end to its second.
    pub(super) fn is_forward(&self) -> bool {
        self.facet_and_way & 1 == 1
    }
}

/// The arrangement as a whole.
pub(super) struct Arrangement<'a> {
    pub(super) surface: &'a GridSurface,
    pub(super) tree: &'a SurfaceTree,
    pub(super) points: &'a [Point],
    pub(super) facets: &'a [Facet],
    /// Per triangle, the first triangle in the same plane.
    pub(super) plane: &'a [u32],
}

impl Arrangement<'_> {
    /// The facets by edge; where there are more than two, in order around the edge,
    /// counter-clockwise as seen against its direction.
    pub(super) fn uses(&self, work: Work) -> Result<Vec<Use>, Stop> {
        let mut uses = Vec::with_capacity(3 * self.facets.len());
        for (number, facet) in self.facets.iter().enumerate() {
            work.check()?;
            let [a, b, c] = facet.corners;
            uses.extend([[a, b], [b, c], [c, a]].map(|way| Use::new(number, way)));
        }
        work.sort(&mut uses)?;
        let items = work.items(uses.len());
        uses.par_chunk_by_mut(|a, b| a.edge == b.edge)
            .map(|run| -> Result<(), Stop> {
                items.advance(run.len())?;
                let balance: i32 = run.iter().map(|u| self.signed(u)).sum();
                if balance != 0 {
                    return Err(Fault::new("the cut surface is not closed").into());
                }
                if run.len() > 2 {
                    let turned = self.turn(run)?;
                    run.copy_from_slice(&turned);
                }
                Ok(())
            })
            // A fault is the same for any number of threads.
            .reduce(|| Ok(()), Result::and)?;
        Ok(uses)
    }

    fn signed(&self, u: &Use) -> i32 {
        let m = self.facets[u.facet() as usize].multiplicity;
        if u.is_forward() { m } else { -m }
    }

    /// Sorts the facets at one edge by angle.
    fn turn(&self, run: &[Use]) -> Result<Vec<Use>, Fault> {
        let ends = run[0].edge.map(|v| &self.points[v as usize]);
        let way = ends[1].approximate - ends[0].approximate;
        let mut axes = [0, 1, 2];
        axes.sort_by(|&i, &j| way[j].abs().total_cmp(&way[i].abs()));
        let (axis, sign) = axes
            .iter()
            .map(|&axis| (axis, direction(self.surface, axis, ends)))
            .find(|(_, sign)| *sign != Sign::Zero)
            .ok_or(Fault::new("an edge without length"))?;
        // The normal of a facet, reversed when the facet runs backward, is the direction into the
        // facet turned by 90 degrees about the edge: both have the same order.
        let normals: Vec<[i128; 3]> = run
            .iter()
            .map(|u| {
                let normal = self.surface.normal(self.facets[u.facet() as usize].plane);
                if u.is_forward() {
                    normal
                } else {
                    normal.map(|x| -x)
                }
            })
            .collect();
        // Whether b is within the half turn after a: then the product of the two normals points
        // along the edge.
        let after = |a: usize, b: usize| {
            product_component(axis, normals[a], normals[b]).flipped_unless(sign == Sign::Positive)
        };
        let mut halves = [Vec::new(), Vec::new(), Vec::new()];
        for i in 1..run.len() {
            match after(0, i) {
                Sign::Positive => halves[0].push(i),
                Sign::Zero => halves[1].push(i),
                Sign::Negative => halves[2].push(i),
            }
        }
        if halves[1].len() > 1 {
            return Err(Fault::new("two facets of one plane overlap"));
        }
        for half in [0, 2] {
            halves[half].sort_by(|&a, &b| match after(a, b) {
                Sign::Positive => Ordering::Less,
                Sign::Zero => Ordering::Equal,
                Sign::Negative => Ordering::Greater,
            });
            if halves[half]
                .windows(2)
                .any(|pair| after(pair[0], pair[1]) != Sign::Positive)
            {
                return Err(Fault::new("two facets of one plane overlap"));
            }
        }
        Ok(std::iter::once(0)
            .chain(halves.into_iter().flatten())
            .map(|i| run[i])
            .collect())
    }

    /// The winding number in front of each facet.
    pub(super) fn winding_numbers(&self, uses: &[Use], work: Work) -> Result<Vec<i32>, Stop> {
        let [joining, spreading] = work.parts([1, 1]);
        let items = joining.items(uses.len());
        // The two sides of facet f are numbered 2 f in front and 2 f + 1 behind.
        let mut cells = DisjointSets::new(2 * self.facets.len());
        for run in uses.chunk_by(|a, b| a.edge == b.edge) {
            items.advance(run.len())?;
            for (i, here) in run.iter().enumerate() {
                let next = &run[(i + 1) % run.len()];
                cells.join(side_after(here), side_before(next));
            }
        }
        let cells = Cells::new(cells, work)?;
        let items = spreading.items(2 * self.facets.len());
        let mut numbers = vec![None::<i32>; cells.len()];
        let mut is_seen = vec![false; cells.len()];
        for start in 0..self.facets.len() {
            let front = cells.of_side[2 * start];
            if numbers[front as usize].is_some() {
                continue;
            }
            // A new component: one ray from one of its facets determines its winding number.
            let component = cells.component(front, &mut is_seen, work)?;
            let (facet, winding) = self.seed(&component)?;
            let seed = cells.of_side[2 * facet as usize];
            numbers[seed as usize] = Some(winding);
            let mut open = vec![(seed, winding)];
            while let Some((here, winding)) = open.pop() {
                items.advance(cells.sides(here).len())?;
                for &side in cells.sides(here) {
                    let m = self.facets[side as usize / 2].multiplicity;
                    let beyond = if side % 2 == 0 {
                        winding + m
                    } else {
                        winding - m
                    };
                    let other = cells.of_side[(side ^ 1) as usize];
                    match numbers[other as usize] {
                        None => {
                            numbers[other as usize] = Some(beyond);
                            open.push((other, beyond));
                        }
                        Some(known) if known == beyond => {}
                        Some(_) => {
                            return Err(Fault::new("winding numbers contradict each other").into());
                        }
                    }
                }
            }
        }
        Ok((0..self.facets.len())
            .map(|f| numbers[cells.of_side[2 * f] as usize].unwrap_or(0))
            .collect())
    }

    /// A facet of a component and the winding number in front of it.
    fn seed(&self, component: &[u32]) -> Result<(u32, i32), Fault> {
        let area = |facet: &u32| {
            let [a, b, c] = self.facets[*facet as usize]
                .corners
                .map(|v| self.points[v as usize].approximate);
            (b - a).cross(c - a).length_squared()
        };
        let try_all = |facet: u32| {
            let cast = |shares: &[f64; 3]| self.cast(facet, *shares).map(|w| (facet, w));
            SHARES.iter().find_map(cast)
        };
        let larger = |a: &u32, b: &u32| area(b).total_cmp(&area(a)).then(a.cmp(b));
        let largest = component.iter().copied().min_by(larger);
        largest
            .and_then(try_all)
            .or_else(|| {
                let mut by_area = component.to_vec();
                by_area.sort_by(larger);
                by_area.into_iter().find_map(try_all)
            })
            .ok_or(Fault::new("a component is too small to tell where it is"))
    }

    /// The winding number in front of a facet, by a ray along its axis from the point with the
    /// given barycentric shares; `None` when the ray meets an edge, or another surface where it
    /// starts, or when the facet is too small to contain a grid point.
    fn cast(&self, facet: u32, shares: [f64; 3]) -> Option<i32> {
        let Facet { corners, plane, .. } = self.facets[facet as usize];
        let Axis {
            number: axis,
            is_forward,
        } = self.surface.axis[plane as usize];
        let corners = corners.map(|v| &self.points[v as usize]);
        let place: DVec3 = corners
            .iter()
            .zip(shares)
            .map(|(p, share)| p.approximate * share)
            .sum::<DVec3>()
            .round();
        let start = Point {
            definition: super::point::Definition::Corner(0),
            approximate: place,
            error: 0.0,
        };
        for k in 0..3 {
            let side = super::point::approximate_orientation(
                axis,
                [corners[k], corners[(k + 1) % 3], &start],
            )?;
            if side.flipped_unless(is_forward) != Sign::Positive {
                return None;
            }
        }
        let (mut low, mut high) = (place, place);
        low[axis] = f64::NEG_INFINITY;
        high[axis] = f64::INFINITY;
        let mut winding = Some(0);
        self.tree.for_each_in_box([low, high], |other| {
            winding = winding.and_then(|w| {
                self.crossing(plane, axis, place, other)
                    .map(|gain| w + gain)
            });
        });
        let above = winding?;
        // The ray starts above the facet, which is in front of it or behind it.
        if is_forward {
            Some(above)
        } else {
            Some(above - self.facets[facet as usize].multiplicity)
        }
    }

    /// The contribution of one triangle to the winding number above a point of a plane, if it lies
    /// above the point; `None` when the answer is degenerate.
    fn crossing(&self, plane: u32, axis: usize, place: DVec3, other: u32) -> Option<i32> {
        let corners = self.surface.triangle(other);
        let sides = [0, 1, 2]
            .map(|k| spatial_grid::orientation(axis, [corners[k], corners[(k + 1) % 3], place]));
        if sides.contains(&Sign::Positive) && sides.contains(&Sign::Negative) {
            return Some(0);
        }
        if sides.contains(&Sign::Zero) {
            return None;
        }
        if self.plane[plane as usize] == self.plane[other as usize] {
            return Some(0);
        }
        match order_of_heights(self.surface, axis, place, [plane, other]) {
            Ordering::Equal => None,
            Ordering::Greater => Some(0),
            Ordering::Less => {
                let m = self.surface.multiplicity[other as usize];
                Some(if sides[0] == Sign::Positive { m } else { -m })
            }
        }
    }
}

/// The cells and the sides of facets that face them.
struct Cells {
    /// The cell of each side.
    of_side: Vec<u32>,
    /// Start of the sides of each cell in `by_cell`, and the end of the last.
    starts: Vec<u32>,
    /// The sides by cell, ascending within each cell.
    by_cell: Vec<u32>,
}

impl Cells {
    /// Numbers the sets of sides.
    fn new(sets: DisjointSets, work: Work) -> Result<Cells, Interrupted> {
        let mut of_side = sets.firsts();
        let mut starts = vec![0];
        for side in 0..of_side.len() {
            work.check()?;
            let first = of_side[side] as usize;
            // The first side of a set comes before the others: by then its entry holds the number
            // of the set.
            let number = if first == side {
                starts.push(0);
                index(starts.len() - 2)
            } else {
                of_side[first]
            };
            of_side[side] = number;
            starts[number as usize + 1] += 1;
        }
        (1..starts.len()).for_each(|i| starts[i] += starts[i - 1]);
        let mut next = starts.clone();
        let mut by_cell = vec![0; of_side.len()];
        for (side, &number) in of_side.iter().enumerate() {
            work.check()?;
            let place = &mut next[number as usize];
            by_cell[*place as usize] = index(side);
            *place += 1;
        }
        Ok(Cells {
            of_side,
            starts,
            by_cell,
        })
    }

    fn len(&self) -> usize {
        self.starts.len() - 1
    }

    fn sides(&self, cell: u32) -> &[u32] {
        let [from, to] = [cell, cell + 1].map(|i| self.starts[i as usize] as usize);
        &self.by_cell[from..to]
    }

    /// All facets that are connected with a cell; their cells are marked as seen.
    fn component(
        &self,
        start: u32,
        is_seen: &mut [bool],
        work: Work,
    ) -> Result<Vec<u32>, Interrupted> {
        is_seen[start as usize] = true;
        let mut open = vec![start];
        let mut facets = Vec::new();
        while let Some(here) = open.pop() {
            work.check()?;
            for &side in self.sides(here) {
                // Each facet is taken once, from its front.
                if side % 2 == 0 {
                    facets.push(side / 2);
                }
                let other = self.of_side[(side ^ 1) as usize];
                if !std::mem::replace(&mut is_seen[other as usize], true) {
                    open.push(other);
                }
            }
        }
        work.sort(&mut facets)?;
        Ok(facets)
    }
}

/// Points of a facet from which a ray is tried, as barycentric shares: the centre first, and then
/// points on no line of symmetry.
const SHARES: [[f64; 3]; 4] = [
    [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0],
    [0.41, 0.23, 0.36],
    [0.17, 0.52, 0.31],
    [0.29, 0.13, 0.58],
];

/// The side of a facet that faces the next one around the edge.
pub(super) fn side_after(here: &Use) -> u32 {
    2 * here.facet() + u32::from(!here.is_forward())
}

/// The side of a facet that faces the previous one around the edge.
pub(super) fn side_before(here: &Use) -> u32 {
    2 * here.facet() + u32::from(here.is_forward())
}
