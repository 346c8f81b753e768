//! Shallow folds of polygons: changes of sign that are given up, and the proof that nothing but a layer is lost by that.
//!
//! A first integral h of the flow (constant along its paths, growing to their left) makes an outline a function h(u) of
//! its arc length: egress where h grows, ingress where it falls. A finely divided outline that slides in itself
//! zigzags: h falls a little, grows again, and both changes of sign would sweep paths nearer to each other than their sampling.
//!
//! # What may be given up
//! Write the outline as (s, h), s along the paths. Along a stretch that is to count as egress let h'(u) be a function that grows, with
//! |h' - h| at most the depth d, below h where the outline runs along the motion (s grows: the body lies above) and above h
//! where it runs against it. The outline (s, h') encloses a body B' that contains the body B, since it was only moved outwards, and
//! whose exact signs are those that were chosen. So the sweep of B lies in that of B', which is {w >= 1} of the cycle of B', and that
//! cycle is the chosen one but for a homotopy that moves no point farther than d times the growth of lengths. Such h' exists
//! iff low(u) <= high(v) for all u <= v on the stretch, where
//!
//! > along the motion low = h - d, high = h; against it low = h, high = h + d;
//!
//! for ingress with u and v exchanged. In particular a needle that points along the motion is never given up, however
//! thin.
//!
//! # How
//! Runs of one sign are merged with their two neighbours, shallowest first, while the merged stretch keeps the condition. To first
//! order in the depth h is the integral of flux / |v|, with lengths across the paths scaled by their divergence; each
//! stretch that gave something up is then checked along exact paths, and gets its own signs back where it fails.

use super::planar::EdgeFlux;
use crate::motion::planar::{Flow, Generator};
use crate::numeric::tolerance::{FOLD_CURVATURE, FOLD_TURN, SAME_POSE};
use glam::DVec2;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Share of the depth that is used before the check along exact paths.
const FIRST_ORDER: f64 = 0.8;

/// Share of the depth that is used in that check: distances are measured straight, the outline moves along a curve that is at most this
/// much longer, see [`FOLD_CURVATURE`].
const STRAIGHT: f64 = 0.98;

/// A loop with the signs that it was given.
pub(super) struct Flattened {
    /// Per edge.
    pub(super) edges: Vec<EdgeFlux>,
    /// Largest distance to the outline of the larger body; 0 when nothing was given up.
    pub(super) depth: f64,
}

/// Gives up the folds of one loop that are shallower than `fold`.
///
/// - `corners`, `fluxes`: of the loop, edge i from corner i to the next one.
///
/// O(n log n).
pub(super) fn flattened(
    corners: &[DVec2],
    fluxes: &[EdgeFlux],
    generator: &Generator,
    fold: f64,
) -> Flattened {
    let kept = Flattened {
        edges: fluxes.to_vec(),
        depth: 0.0,
    };
    let pieces = pieces(corners, fluxes, generator, FIRST_ORDER * fold);
    let mut runs = Runs::of(&pieces);
    if runs.list.len() < 2 {
        return kept;
    }
    runs.merge(fold);
    let (is_egress, depth) = runs.signs(&pieces, fold, generator);
    let mut edges = kept.edges;
    if depth > 0.0 {
        let mut first_sign = vec![None; edges.len()];
        let mut last_sign = vec![false; edges.len()];
        for (piece, &egress) in pieces.iter().zip(&is_egress) {
            first_sign[piece.edge].get_or_insert(egress);
            last_sign[piece.edge] = egress;
        }
        for ((flux, first), last) in edges.iter_mut().zip(first_sign).zip(last_sign) {
            if first == Some(last) {
                *flux = if last {
                    EdgeFlux::Egress
                } else {
                    EdgeFlux::Ingress
                };
            }
        }
    }
    Flattened { edges, depth }
}

/// A part of an edge on which neither the flux nor the speed along the edge changes its sign.
#[derive(Debug, Clone, Copy)]
struct Piece {
    edge: usize,
    ends: [DVec2; 2],
    egress: bool,
    /// Whether the outline runs along the motion.
    along: bool,
    height: Heights,
}

/// The heights of a stretch, from that of its begin on, in units of length there.
#[derive(Debug, Clone, Copy)]
struct Heights {
    /// Height of the end.
    rise: f64,
    /// A unit of length at the begin, per unit at the end.
    scale: f64,
    /// Largest low.
    low: f64,
    /// Least high.
    high: f64,
    /// Largest low(u) - high(v) with u before v: above 0 it cannot be egress.
    fall: f64,
    /// Largest low(v) - high(u) with u before v: above 0 it cannot be ingress.
    gain: f64,
}

impl Heights {
    /// Of a stretch followed by another.
    fn then(self, next: Heights) -> Heights {
        let [low, high] = [next.low, next.high].map(|h| self.rise + self.scale * h);
        Heights {
            rise: self.rise + self.scale * next.rise,
            scale: self.scale * next.scale,
            low: self.low.max(low),
            high: self.high.min(high),
            fall: self.fall.max(self.scale * next.fall).max(self.low - high),
            gain: self.gain.max(self.scale * next.gain).max(low - self.high),
        }
    }

    fn may_be(&self, egress: bool) -> bool {
        (if egress { self.fall } else { self.gain }) <= 0.0
    }
}

/// The pieces of a loop, in order.
fn pieces(corners: &[DVec2], fluxes: &[EdgeFlux], generator: &Generator, depth: f64) -> Vec<Piece> {
    let mut pieces = Vec::with_capacity(2 * corners.len());
    for (edge, flux) in fluxes.iter().enumerate() {
        let [p, q] = [corners[edge], corners[(edge + 1) % corners.len()]];
        let way = q - p;
        let [first, second] = [p, q].map(|p| generator.velocity(p).dot(way));
        let mut stops = vec![0.0];
        if let EdgeFlux::Cut { at, .. } = *flux {
            stops.push(at);
        }
        let turn = first / (first - second);
        if turn > 0.0 && turn < 1.0 {
            stops.push(turn);
        }
        stops.push(1.0);
        stops.sort_by(f64::total_cmp);
        for pair in stops.windows(2) {
            let middle = 0.5 * (pair[0] + pair[1]);
            let at = |t: f64| if t == 1.0 { q } else { p.lerp(q, t) };
            let ends = [at(pair[0]), at(pair[1])];
            let egress = flux.is_egress_at(middle);
            let along = first + (second - first) * middle >= 0.0;
            let height = heights(ends, along, generator, depth);
            pieces.push(Piece {
                edge,
                ends,
                egress,
                along,
                height,
            });
        }
    }
    pieces
}

/// First-order heights over a piece; never to be merged where the field turns too much on it.
fn heights(ends: [DVec2; 2], along: bool, generator: &Generator, depth: f64) -> Heights {
    let [p, q] = ends;
    let way = q - p;
    let velocities = [p, q].map(|p| generator.velocity(p));
    let slowest = distance_from_origin(velocities);
    let size = frobenius(generator);
    if size * way.length() > FOLD_TURN * slowest || size * depth > FOLD_CURVATURE * slowest {
        return Heights {
            rise: 0.0,
            scale: 1.0,
            low: 0.0,
            high: 0.0,
            fall: f64::INFINITY,
            gain: f64::INFINITY,
        };
    }
    // Simpson's rule for the height, and the mean of the ends for the divergence.
    let middle = 0.5 * (velocities[0] + velocities[1]);
    let slope = |v: DVec2| v.perp_dot(way) / v.length();
    let rise = (slope(velocities[0]) + 4.0 * slope(middle) + slope(velocities[1])) / 6.0;
    let speed = middle.length();
    let across = middle.perp() / speed;
    let rate = across.dot(generator.linear * across);
    let scale = (-rate * middle.dot(way) / (speed * speed)).exp();
    let [low, high] = if along { [-depth, 0.0] } else { [0.0, depth] };
    Heights {
        rise,
        scale,
        low: low.max(rise + scale * low),
        high: high.min(rise + scale * high),
        fall: low - (rise + scale * high),
        gain: rise + scale * low - high,
    }
}

fn frobenius(generator: &Generator) -> f64 {
    generator
        .linear
        .x_axis
        .length()
        .hypot(generator.linear.y_axis.length())
}

/// Distance of a segment from the origin.
fn distance_from_origin([a, b]: [DVec2; 2]) -> f64 {
    let way = b - a;
    let length_squared = way.length_squared();
    let t = if length_squared > 0.0 {
        (-a.dot(way) / length_squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    a.lerp(b, t).length()
}

/// A maximal row of pieces of one sign.
#[derive(Debug, Clone, Copy)]
struct Run {
    egress: bool,
    height: Heights,
    /// First piece, and one past the last; taken round the loop.
    pieces: [usize; 2],
    /// Neighbours.
    before: usize,
    after: usize,
    /// How often it has changed; none once it is part of another.
    version: Option<u32>,
    /// Whether it holds pieces of the other sign.
    merged: bool,
}

/// The runs of a loop.
struct Runs {
    list: Vec<Run>,
    alive: usize,
}

impl Runs {
    fn of(pieces: &[Piece]) -> Runs {
        let count = pieces.len();
        let starts: Vec<usize> = (0..count)
            .filter(|&i| pieces[i].egress != pieces[(i + count - 1) % count].egress)
            .collect();
        let alive = starts.len();
        let list = starts
            .iter()
            .enumerate()
            .map(|(run, &start)| {
                let end = starts.get(run + 1).copied().unwrap_or(starts[0] + count);
                let heights = (start..end).map(|i| pieces[i % count].height);
                Run {
                    egress: pieces[start].egress,
                    height: heights.reduce(Heights::then).expect("a run has pieces"),
                    pieces: [start, end],
                    before: (run + alive - 1) % alive,
                    after: (run + 1) % alive,
                    version: Some(0),
                    merged: false,
                }
            })
            .collect();
        Runs { list, alive }
    }

    /// Merges runs that rise or fall by at most `fold` with their neighbours, shallowest first.
    fn merge(&mut self, fold: f64) {
        let mut queue: BinaryHeap<Reverse<(u64, usize, u32)>> = BinaryHeap::new();
        let depth = |run: &Run| run.height.rise.abs();
        // Positive numbers are ordered as their bits.
        let entry = |number: usize, run: &Run, version: u32| {
            (depth(run) <= fold).then(|| Reverse((depth(run).to_bits(), number, version)))
        };
        queue.extend(
            self.list
                .iter()
                .enumerate()
                .filter_map(|(number, run)| entry(number, run, 0)),
        );
        while let Some(Reverse((_, number, version))) = queue.pop() {
            let run = self.list[number];
            if run.version != Some(version) || self.alive < 2 {
                continue;
            }
            let [before, after] = [run.before, run.after];
            let egress = !run.egress;
            let through = self.list[before].height.then(run.height);
            if before == after {
                // The whole loop: twice round, for all pairs.
                if through.then(through).may_be(egress) {
                    let [start, _] = self.list[before].pieces;
                    let length =
                        run.pieces[1] - run.pieces[0] + self.list[before].pieces[1] - start;
                    let whole = &mut self.list[before];
                    whole.height = through.then(through);
                    whole.pieces = [start, start + length];
                    whole.merged = true;
                    whole.version = Some(u32::MAX);
                    self.list[number].version = None;
                    self.alive = 1;
                }
                continue;
            }
            let height = through.then(self.list[after].height);
            if !height.may_be(egress) {
                continue;
            }
            let next = self.list[after];
            self.list[number].version = None;
            self.list[after].version = None;
            self.list[next.after].before = before;
            let length = run.pieces[1] - run.pieces[0] + next.pieces[1] - next.pieces[0];
            let grown = &mut self.list[before];
            grown.height = height;
            grown.after = next.after;
            grown.pieces[1] += length;
            grown.merged = true;
            let version = grown.version.map_or(0, |version| version + 1);
            grown.version = Some(version);
            self.alive -= 2;
            queue.extend(entry(before, &self.list[before], version));
        }
    }

    /// Whether each piece is egress, and the depth that is given up for it.
    fn signs(&self, pieces: &[Piece], fold: f64, generator: &Generator) -> (Vec<bool>, f64) {
        let mut signs: Vec<bool> = pieces.iter().map(|piece| piece.egress).collect();
        let mut depth: f64 = 0.0;
        for run in self.list.iter().filter(|r| r.version.is_some() && r.merged) {
            let [start, end] = run.pieces;
            let twice = if end - start == pieces.len() { 2 } else { 1 };
            let stretch: Vec<Piece> = (start..start + twice * (end - start))
                .map(|i| pieces[i % pieces.len()])
                .collect();
            // As a rule little more than the depth of the deepest fold of the stretch is needed, and nothing keeps less than it.
            let height = &run.height;
            let deepest = FIRST_ORDER * fold + if run.egress { height.fall } else { height.gain };
            let enough = [SPARE * deepest, fold].into_iter().find(|&depth| {
                depth <= fold && keeps_condition(&stretch, run.egress, generator, depth)
            });
            if let Some(enough) = enough {
                depth = depth.max(enough);
                (start..end).for_each(|i| signs[i % pieces.len()] = run.egress);
            }
        }
        (signs, depth)
    }
}

/// How much deeper than to first order the condition is tried first.
const SPARE: f64 = 1.1;

/// Whether the stretch may count as egress, or ingress, by the exact paths: low(u) <= high(v) for all u before v.
///
/// The path of the largest low so far (for ingress the least high) runs along with the outline; all that is compared is on
/// which side of it a point lies.
fn keeps_condition(stretch: &[Piece], egress: bool, generator: &Generator, fold: f64) -> bool {
    let flow = Flow::new(*generator);
    let fold = STRAIGHT * fold;
    let sense = if egress { 1.0 } else { -1.0 };
    let mut path: Option<DVec2> = None;
    for piece in stretch {
        for point in piece.ends {
            let velocity = generator.velocity(point);
            let left = velocity.perp().normalize_or_zero();
            // Of the two, the one that later points have to keep to, and the one that has to keep to earlier points.
            let [low, high] = if piece.along {
                [-fold, 0.0]
            } else {
                [0.0, fold]
            };
            let [leading, following] = if egress { [low, high] } else { [high, low] };
            let Some(earlier) = path else {
                path = Some(point + left * leading);
                continue;
            };
            let Some(foot) = beside(point, earlier, generator, &flow) else {
                return false;
            };
            let left = generator.velocity(foot).perp().normalize_or_zero();
            let height = left.dot(point - foot);
            let slack = SAME_POSE * point.abs().max_element();
            if sense * (height + following) < -slack {
                return false;
            }
            path = Some(if sense * (height + leading) > 0.0 {
                point + left * leading
            } else {
                foot
            });
        }
    }
    true
}

/// The point of the path through `from` beside `point`: the line between them is square to the path. None where it is not found.
fn beside(point: DVec2, from: DVec2, generator: &Generator, flow: &Flow) -> Option<DVec2> {
    let mut foot = from;
    for _ in 0..MOST_STEPS {
        let velocity = generator.velocity(foot);
        let speed_squared = velocity.length_squared();
        let time = velocity.dot(point - foot) / speed_squared;
        if !time.is_finite() {
            return None;
        }
        foot = flow.pose_at(time).transform_point2(foot);
        if time.abs() * speed_squared.sqrt() <= SAME_POSE * point.abs().max_element() {
            return Some(foot);
        }
    }
    None
}

/// Newton's method converges by a factor of at least four per step, since a fold is at most a quarter of the distance over which the
/// field changes (see [`FOLD_CURVATURE`]); the first steps may turn by [`FOLD_TURN`].
const MOST_STEPS: usize = 40;
