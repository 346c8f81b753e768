//! Folds that rounding closes: parts thinner than the coordinates can resolve are removed from the
//! boundary.
//!
//! Points that rounding may make equal become one. A triangle that thereby loses its area, and two
//! triangles that come to lie back to back, are cut out of the surface, and their two sides are
//! sewn together. The surface stays a 2-manifold throughout; handles and shells without thickness
//! vanish.

use super::join::CELL;
use super::point::Point;
use crate::numeric::SpatialHash;
use crate::numeric::exact::double::Double;
use crate::numeric::exact::spatial_grid::volume;
use crate::numeric::{DisjointSets, index};
use crate::surface::{Mates, Shells, edges};
use crate::watch::{Interrupted, Work};
use std::collections::HashMap;

/// Distance, in grid units, below which two points become one: the sum of the errors of two rounded
/// points and of their rounding to `f64`.
pub(super) const SAME_PLACE: f64 = 8.0;

/// A closed surface of triangles whose half-edges know their mates.
pub(super) struct Sewn {
    /// The triangles, as triples of points.
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) mates: Mates,
    /// Whether a triangle is still part of the surface.
    pub(super) is_kept: Vec<bool>,
}

impl Sewn {
    /// Joins points that rounding may make equal, and removes parts that then have no thickness.
    pub(super) fn heal(&mut self, points: &[Point], work: Work) -> Result<(), Interrupted> {
        let [placing, folding] = work.parts([1, 1]);
        let place = self.places(points, placing)?;
        let items = folding.items(self.triangles.len());
        for triangle in &mut self.triangles {
            work.check()?;
            *triangle = triangle.map(|p| place[p as usize]);
        }
        for t in 0..self.triangles.len() {
            let [a, b, c] = self.triangles[t];
            if a == b || b == c || c == a {
                self.is_kept[t] = false;
                let halves: Vec<u32> = (0..3)
                    .filter(|&k| self.triangles[t][k] != self.triangles[t][(k + 1) % 3])
                    .map(|k| index(3 * t + k))
                    .collect();
                if let [there, back] = halves[..] {
                    self.mates.sew(there, back);
                }
            }
        }
        let mut same = HashMap::<[u32; 3], Vec<u32>>::new();
        for t in 0..self.triangles.len() {
            items.next()?;
            if !self.is_kept[t] {
                continue;
            }
            let mut key = self.triangles[t];
            key.sort_unstable();
            let waiting = same.entry(key).or_default();
            let opposite = waiting
                .iter()
                .position(|&other| self.is_turned(self.triangles[other as usize], t));
            if let Some(place) = opposite {
                let other = waiting.remove(place);
                self.cancel(index(t), other);
            } else {
                waiting.push(index(t));
            }
        }
        self.drop_thin_shells(points);
        work.check()
    }

    /// Removes shells whose volume is that of a layer of no thickness on their area.
    fn drop_thin_shells(&mut self, points: &[Point]) {
        let neighbours = self.mates.neighbours(|t| self.is_kept[t as usize]);
        let at = |p: u32| points[p as usize].approximate;
        for shell in Shells::joined(self.triangles.len(), neighbours).members {
            // Six times the volume and twice the area; the volume relative to the first corner of
            // the shell.
            let centre = at(self.triangles[shell[0] as usize][0]);
            let (mut size, mut area) = (Double::from(0.0), 0.0);
            for &t in &shell {
                let [a, b, c] = self.triangles[t as usize].map(at);
                // For a needle, every digit of the products cancels: twice the precision is needed.
                size = size + volume([a, b, c], centre).0;
                area += (b - a).cross(c - a).length();
            }
            let is_thick = size.value().abs() / 3.0 > SAME_PLACE * area;
            if !is_thick {
                shell.iter().for_each(|&t| self.is_kept[t as usize] = false);
            }
        }
    }

    /// Whether triangle `t` runs through the same three points in the opposite sense.
    fn is_turned(&self, [a, b, _]: [u32; 3], t: usize) -> bool {
        edges(&self.triangles[t]).contains(&[b, a])
    }

    /// Removes two triangles that lie back to back.
    fn cancel(&mut self, one: u32, two: u32) {
        let [here, other] = [one, two].map(|t| edges(&self.triangles[t as usize]));
        for (half, [from, to]) in (3 * one..).zip(here) {
            let place = (3 * two..).zip(other).find(|(_, ends)| *ends == [to, from]);
            if let Some((mate, _)) = place {
                self.mates.sew(half, mate);
            }
        }
        self.is_kept[one as usize] = false;
        self.is_kept[two as usize] = false;
    }

    /// For each point, the first of those at the same place.
    fn places(&self, points: &[Point], work: Work) -> Result<Vec<u32>, Interrupted> {
        let mut used: Vec<u32> = self.triangles.iter().flatten().copied().collect();
        work.sort(&mut used)?;
        used.dedup();
        let mut hash = SpatialHash::new(CELL);
        let mut places = DisjointSets::new(points.len());
        let items = work.items(used.len());
        for &p in &used {
            items.next()?;
            let here = points[p as usize].approximate;
            let around = [-SAME_PLACE, SAME_PLACE].map(|by| here + by);
            for q in hash.near(around) {
                let apart = points[q as usize].approximate - here;
                if apart.abs().max_element() <= SAME_PLACE {
                    places.join(p, q);
                }
            }
            hash.insert([here; 2], p);
        }
        Ok(places.firsts())
    }

    /// For each corner, the first corner, 3 t + k, of the same vertex.
    pub(super) fn vertices(&self) -> Vec<u32> {
        self.mates.vertices(|t| self.is_kept[t as usize])
    }
}
