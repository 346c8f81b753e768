//! Triangulation of points in a triangle, with edges that it must contain.
//!
//! Approximate coordinates steer which triangles result (nearly Delaunay); whether they are valid
//! is decided by exact orientations only.

use crate::Fault;
use crate::numeric::exact::signs::Sign;
use crate::numeric::index;
use glam::DVec2;
use std::collections::VecDeque;

/// Stands for no triangle across an edge.
const NONE: u32 = u32::MAX;

/// Triangles of the plane, counter-clockwise, with their neighbours.
pub(super) struct Triangulation<'a, O: Fn(u32, u32, u32) -> Sign> {
    places: &'a [DVec2],
    orientation: O,
    pub(super) triangles: Vec<[u32; 3]>,
    /// The neighbour across the edge opposite each corner.
    pub(super) across: Vec<[u32; 3]>,
    /// One triangle at each point.
    at: Vec<u32>,
    last: u32,
}

/// The points are not distinct or not inside the outline; or edges cross, or pass through points.
const MISFIT: Fault = Fault::new("the segments in a plane do not fit together");

impl<'a, O: Fn(u32, u32, u32) -> Sign> Triangulation<'a, O> {
    /// The triangle of three points, counter-clockwise by `orientation`.
    pub(super) fn new(places: &'a [DVec2], outline: [u32; 3], orientation: O) -> Self {
        let mut at = vec![NONE; places.len()];
        outline.iter().for_each(|&v| at[v as usize] = 0);
        Triangulation {
            places,
            orientation,
            triangles: vec![outline],
            across: vec![[NONE; 3]],
            at,
            last: 0,
        }
    }

    fn positive(&self, a: u32, b: u32, c: u32) -> bool {
        (self.orientation)(a, b, c) == Sign::Positive
    }

    /// Adds a point inside or on the outline that differs from all points so far.
    pub(super) fn insert(&mut self, point: u32) -> Result<(), Fault> {
        let (triangle, on) = self.locate(point).ok_or(MISFIT)?;
        match on.count_ones() {
            0 => self.split_triangle(triangle, point),
            1 => self.split_edge(triangle, on.trailing_zeros() as usize, point),
            _ => return Err(MISFIT),
        }
        Ok(())
    }

    /// A triangle that contains a point, and the edges of it on which the point lies, as bits.
    fn locate(&self, point: u32) -> Option<(u32, u8)> {
        let sides = |triangle: u32| {
            let [a, b, c] = self.triangles[triangle as usize];
            [[b, c], [c, a], [a, b]].map(|[p, q]| (self.orientation)(p, q, point))
        };
        let on = |sides: [Sign; 3]| {
            (0..3).fold(0, |bits, k| bits | (u8::from(sides[k] == Sign::Zero) << k))
        };
        let mut triangle = self.last;
        // A walk towards the point can go in circles in a triangulation that is not Delaunay.
        for step in 0..self.triangles.len() {
            let sides = sides(triangle);
            let leave = (0..3)
                .map(|k| (k + step) % 3)
                .find(|&k| sides[k] == Sign::Negative);
            let Some(k) = leave else {
                return Some((triangle, on(sides)));
            };
            triangle = self.across[triangle as usize][k];
            if triangle == NONE {
                break;
            }
        }
        (0..index(self.triangles.len())).find_map(|triangle| {
            let sides = sides(triangle);
            (!sides.contains(&Sign::Negative)).then(|| (triangle, on(sides)))
        })
    }

    fn push(&mut self, triangle: [u32; 3], across: [u32; 3]) -> u32 {
        self.triangles.push(triangle);
        self.across.push(across);
        index(self.triangles.len() - 1)
    }

    /// Sets a triangle, and updates its corners and neighbours.
    fn set(&mut self, number: u32, triangle: [u32; 3], across: [u32; 3]) {
        self.triangles[number as usize] = triangle;
        self.across[number as usize] = across;
        self.announce(number);
    }

    fn announce(&mut self, number: u32) {
        let triangle = self.triangles[number as usize];
        for k in 0..3 {
            self.at[triangle[k] as usize] = number;
            let other = self.across[number as usize][k];
            if other != NONE {
                let from = triangle[(k + 1) % 3];
                // The neighbour runs through the common edge in the opposite sense; `from` is where
                // it ends there.
                let place = self.triangles[other as usize]
                    .iter()
                    .position(|&v| v == from);
                if let Some(place) = place {
                    self.across[other as usize][(place + 1) % 3] = number;
                }
            }
        }
    }

    fn split_triangle(&mut self, t: u32, p: u32) {
        let [a, b, c] = self.triangles[t as usize];
        let [x, y, z] = self.across[t as usize];
        let second = self.push([p, c, a], [NONE; 3]);
        let third = self.push([p, a, b], [NONE; 3]);
        self.set(t, [p, b, c], [x, second, third]);
        self.set(second, [p, c, a], [y, third, t]);
        self.set(third, [p, a, b], [z, t, second]);
        self.last = t;
        self.improve(p, vec![t, second, third]);
    }

    /// Splits the edge opposite corner `k` of triangle `t`.
    fn split_edge(&mut self, t: u32, k: usize, p: u32) {
        let [a, b, c] = [0, 1, 2].map(|i| self.triangles[t as usize][(k + i) % 3]);
        let [other, y, z] = [0, 1, 2].map(|i| self.across[t as usize][(k + i) % 3]);
        // t = (a, b, c) becomes (p, a, b) and (p, c, a).
        let second = self.push([p, c, a], [NONE; 3]);
        let mut fresh = vec![t, second];
        if other == NONE {
            self.set(t, [p, a, b], [z, NONE, second]);
            self.set(second, [p, c, a], [y, t, NONE]);
        } else {
            let j = self.corner_opposite(other, c, b);
            let d = self.triangles[other as usize][j];
            // The other triangle is (d, c, b).
            let [_, across_c, across_b] =
                [0, 1, 2].map(|i| self.across[other as usize][(j + i) % 3]);
            let fourth = self.push([p, b, d], [NONE; 3]);
            // Edge d-b is opposite c, and edge c-d is opposite b.
            self.set(t, [p, a, b], [z, fourth, second]);
            self.set(second, [p, c, a], [y, t, other]);
            self.set(other, [p, d, c], [across_b, second, fourth]);
            self.set(fourth, [p, b, d], [across_c, other, t]);
            fresh.extend([other, fourth]);
        }
        self.last = t;
        self.improve(p, fresh);
    }

    /// The corner of a triangle opposite the edge from `a` to `b`.
    fn corner_opposite(&self, triangle: u32, a: u32, b: u32) -> usize {
        let corners = self.triangles[triangle as usize];
        (0..3)
            .find(|&k| corners[k] != a && corners[k] != b)
            .unwrap_or(0)
    }

    /// Flips edges opposite a new point while that makes the triangulation more Delaunay.
    fn improve(&mut self, p: u32, mut open: Vec<u32>) {
        // Every flip adds an edge at the point: there are fewer flips than triangles.
        let mut flips = self.triangles.len();
        while let Some(t) = open.pop() {
            let Some(k) = self.triangles[t as usize].iter().position(|&v| v == p) else {
                continue;
            };
            let other = self.across[t as usize][k];
            if other == NONE || flips == 0 {
                continue;
            }
            let [_, a, b] = [0, 1, 2].map(|i| self.triangles[t as usize][(k + i) % 3]);
            let q = self.triangles[other as usize][self.corner_opposite(other, a, b)];
            if in_circle(
                [p, a, b].map(|v| self.places[v as usize]),
                self.places[q as usize],
            ) && self.positive(p, a, q)
                && self.positive(q, b, p)
            {
                flips -= 1;
                self.flip(t, k);
                open.extend([t, other]);
            }
        }
    }

    /// Replaces the edge opposite corner `k` of `t` by the other diagonal.
    fn flip(&mut self, t: u32, k: usize) {
        let [p, a, b] = [0, 1, 2].map(|i| self.triangles[t as usize][(k + i) % 3]);
        let [other, across_a, across_b] = [0, 1, 2].map(|i| self.across[t as usize][(k + i) % 3]);
        let j = self.corner_opposite(other, a, b);
        // The other triangle is (q, b, a).
        let q = self.triangles[other as usize][j];
        let [_, beyond_b, beyond_a] = [0, 1, 2].map(|i| self.across[other as usize][(j + i) % 3]);
        // Now (p, a, q) and (q, b, p): edge a-q is opposite b in the old one, and likewise p-a.
        self.triangles[t as usize] = [p, a, q];
        self.triangles[other as usize] = [q, b, p];
        self.across[t as usize] = [beyond_b, other, across_b];
        self.across[other as usize] = [across_a, t, beyond_a];
        self.announce(t);
        self.announce(other);
    }

    /// The triangles at a point, each with the position of the point in it.
    fn around(&self, point: u32) -> Vec<(u32, usize)> {
        let first = self.at[point as usize];
        let mut ring = Vec::new();
        // Counter-clockwise to the outline or once round; in the first case, also clockwise.
        for step in [1, 2] {
            let mut t = first;
            while t != NONE {
                let Some(k) = self.triangles[t as usize].iter().position(|&v| v == point) else {
                    break;
                };
                if t != first || step == 1 {
                    ring.push((t, k));
                }
                t = self.across[t as usize][(k + step) % 3];
                if t == first {
                    return ring;
                }
            }
        }
        ring
    }

    /// The triangle on the left of the edge from `a` to `b`, and the corner opposite.
    fn left_of(&self, a: u32, b: u32) -> Option<(u32, usize)> {
        self.around(a)
            .into_iter()
            .find(|&(t, k)| self.triangles[t as usize][(k + 1) % 3] == b)
            .map(|(t, k)| (t, (k + 2) % 3))
    }

    /// Makes the segment between two points an edge. No point may lie inside it, and no previously
    /// demanded edge may cross it.
    pub(super) fn demand(&mut self, a: u32, b: u32) -> Result<(), Fault> {
        let mut crossed = VecDeque::new();
        let mut start = None;
        for (t, k) in self.around(a) {
            let [_, x, y] = [0, 1, 2].map(|i| self.triangles[t as usize][(k + i) % 3]);
            if x == b || y == b {
                return Ok(());
            }
            if start.is_none() && self.positive(a, x, b) && self.positive(a, b, y) {
                start = Some((t, k, x, y));
            }
        }
        let (mut t, mut k, mut right, mut left) = start.ok_or(MISFIT)?;
        loop {
            crossed.push_back([right, left]);
            let next = self.across[t as usize][k];
            if next == NONE {
                return Err(MISFIT);
            }
            let apex = self.corner_opposite(next, right, left);
            let z = self.triangles[next as usize][apex];
            if z == b {
                break;
            }
            t = next;
            match (self.orientation)(a, b, z) {
                Sign::Positive => {
                    k = self.corner_opposite(next, right, z);
                    left = z;
                }
                Sign::Negative => {
                    k = self.corner_opposite(next, z, left);
                    right = z;
                }
                Sign::Zero => return Err(MISFIT),
            }
        }
        // Flips until none is left. Every round frees at least one edge.
        let mut rounds = crossed.len() * crossed.len() * 4 + 16;
        while let Some([x, y]) = crossed.pop_front() {
            rounds = rounds.checked_sub(1).ok_or(MISFIT)?;
            let (t, k) = self.left_of(x, y).ok_or(MISFIT)?;
            let other = self.across[t as usize][k];
            if other == NONE {
                return Err(MISFIT);
            }
            let p = self.triangles[t as usize][k];
            let q = self.triangles[other as usize][self.corner_opposite(other, x, y)];
            if !(self.positive(p, x, q) && self.positive(q, y, p)) {
                crossed.push_back([x, y]);
                continue;
            }
            self.flip(t, k);
            if [p, q].iter().all(|v| *v != a && *v != b) {
                let (one, two) = ((self.orientation)(a, b, p), (self.orientation)(a, b, q));
                if one == two.flipped() && one != Sign::Zero {
                    crossed.push_back([p, q]);
                }
            }
        }
        Ok(())
    }
}

/// Whether a point lies clearly inside the circle through three points, counter-clockwise.
fn in_circle([a, b, c]: [DVec2; 3], p: DVec2) -> bool {
    let [a, b, c] = [a - p, b - p, c - p];
    let [u, v, w] = [a, b, c].map(DVec2::length_squared);
    let terms = [u * b.perp_dot(c), v * c.perp_dot(a), w * a.perp_dot(b)];
    let size: f64 = terms.iter().map(|t| t.abs()).sum();
    terms[0] + terms[1] + terms[2] > 1e-9 * size
}
