//! Folds that rounding closes: what is thinner than the coordinates can tell is taken out of the boundary.
//!
//! Points that rounding may make equal become one. A triangle that loses its area by that, and two triangles that come to lie on
//! each other back to back, are cut out of the surface, and what was on their two sides is sewn together. The surface stays a
//! 2-manifold throughout; handles and shells without thickness vanish.

use super::join::CELL;
use super::point::Point;
use crate::numeric::SpatialHash;
use crate::numeric::exact::double::Double;
use crate::numeric::exact::spatial_grid::volume;
use crate::numeric::{DisjointSets, index};
use std::collections::HashMap;

/// Distance, in grid units, below which two points become one: what the errors of two rounded points and their rounding to
/// `f64` add up to.
pub(super) const SAME_PLACE: f64 = 8.0;

/// A closed surface as triangles whose edges know their partners.
pub(super) struct Sewn {
    /// Points.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Of edge k of triangle t, number 3 t + k, the edge of the neighbour.
    pub(super) mates: Vec<u32>,
    /// Whether a triangle is still part of the surface.
    pub(super) is_kept: Vec<bool>,
}

impl Sewn {
    /// Joins points that rounding may make equal, and removes what has no thickness after that.
    pub(super) fn heal(&mut self, points: &[Point]) {
        let place = self.places(points);
        for triangle in &mut self.triangles {
            *triangle = triangle.map(|p| place[p as usize]);
        }
        for t in 0..self.triangles.len() {
            let [a, b, c] = self.triangles[t];
            if a == b || b == c || c == a {
                self.is_kept[t] = false;
                let edges: Vec<u32> = (0..3)
                    .filter(|&k| self.triangles[t][k] != self.triangles[t][(k + 1) % 3])
                    .map(|k| index(3 * t + k))
                    .collect();
                if let [there, back] = edges[..] {
                    self.sew(there, back);
                }
            }
        }
        let mut same = HashMap::<[u32; 3], Vec<u32>>::new();
        for t in 0..self.triangles.len() {
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
    }

    /// Removes shells whose volume is that of a layer of no thickness on their area.
    fn drop_thin_shells(&mut self, points: &[Point]) {
        let mut shells = DisjointSets::new(self.triangles.len());
        for (edge, &mate) in (0..).zip(&self.mates) {
            if self.is_kept[edge as usize / 3] {
                shells.join(edge / 3, mate / 3);
            }
        }
        let shell = shells.firsts();
        // Volume and area, six and two times, seen from the first corner of the shell.
        let mut sizes = vec![(Double::from(0.0), 0.0); self.triangles.len()];
        let at = |p: u32| points[p as usize].approximate;
        for (t, &first) in shell.iter().enumerate() {
            if !self.is_kept[t] {
                continue;
            }
            let first = first as usize;
            let centre = at(self.triangles[first][0]);
            let [a, b, c] = self.triangles[t].map(at);
            // Of a needle every digit of the products cancels: twice the precision is needed.
            sizes[first].0 = sizes[first].0 + volume([a, b, c], centre).0;
            sizes[first].1 += (b - a).cross(c - a).length();
        }
        for (is_kept, &first) in self.is_kept.iter_mut().zip(&shell) {
            let (volume, area) = sizes[first as usize];
            *is_kept &= volume.value().abs() / 3.0 > SAME_PLACE * area;
        }
    }

    /// Whether triangle `t` runs through the same three points the other way.
    fn is_turned(&self, [a, b, _]: [u32; 3], t: usize) -> bool {
        let ring = self.triangles[t];
        (0..3).any(|k| [ring[k], ring[(k + 1) % 3]] == [b, a])
    }

    /// Takes out two triangles back to back.
    fn cancel(&mut self, one: u32, two: u32) {
        let (ring, other) = (self.triangles[one as usize], self.triangles[two as usize]);
        for k in 0..3 {
            let turned = [ring[(k + 1) % 3], ring[k]];
            let place = (0..3).find(|&j| [other[j], other[(j + 1) % 3]] == turned);
            if let Some(j) = place {
                self.sew(3 * one + index(k), 3 * two + index(j));
            }
        }
        self.is_kept[one as usize] = false;
        self.is_kept[two as usize] = false;
    }

    /// Makes the partners of two edges that go partners of each other.
    fn sew(&mut self, one: u32, two: u32) {
        let (a, b) = (self.mates[one as usize], self.mates[two as usize]);
        if a != two {
            self.mates[a as usize] = b;
            self.mates[b as usize] = a;
        }
    }

    /// For every point the first of those at the same place.
    fn places(&self, points: &[Point]) -> Vec<u32> {
        let mut used: Vec<u32> = self.triangles.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let mut hash = SpatialHash::new(CELL);
        let mut places = DisjointSets::new(points.len());
        for &p in &used {
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
        places.firsts()
    }

    /// First corner, 3 t + k, of those that are one vertex.
    pub(super) fn vertices(&self) -> Vec<u32> {
        let mut corners = DisjointSets::new(self.mates.len());
        for (edge, &mate) in (0..).zip(&self.mates) {
            if self.is_kept[edge as usize / 3] {
                corners.join(edge, next_in(mate));
                corners.join(next_in(edge), mate);
            }
        }
        corners.firsts()
    }
}

/// The edge after another in its triangle; also the corner where it ends.
fn next_in(edge: u32) -> u32 {
    edge / 3 * 3 + (edge % 3 + 1) % 3
}
