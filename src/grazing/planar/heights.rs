//! Heights of an outline across the paths of a flow, to first order: the pieces of a loop, and
//! which stretches of them may take one sign (see `flattening`).

use crate::grazing::flux::EdgeFlux;
use crate::motion::planar::Generator;
use crate::numeric::closest::distance_in_plane;
use crate::numeric::norms::frobenius;
use crate::numeric::tolerance::{FOLD_CURVATURE, FOLD_TURN};
use glam::{DMat3, DVec2, DVec3};

/// Share of the depth that is used before the check along exact paths.
pub(super) const FIRST_ORDER: f64 = 0.9;

/// A part of an edge on which neither the flux nor the speed along the edge changes its sign.
#[derive(Debug, Clone, Copy)]
pub(super) struct SignedPiece {
    pub(super) edge: usize,
    pub(super) ends: [DVec2; 2],
    pub(super) egress: bool,
    /// Whether the outline runs along the motion.
    pub(super) along: bool,
    /// Whether the outline must not move here.
    pub(super) is_fixed: bool,
    pub(super) height: Heights,
}

impl SignedPiece {
    /// The first-order heights along it, for a depth.
    pub(super) fn heights(&self, generator: &Generator, depth: f64) -> Heights {
        if self.is_fixed {
            return Heights::fixed(self.egress);
        }
        let [p, q] = self.ends;
        let way = q - p;
        let velocities = [p, q].map(|p| generator.velocity(p));
        // Simpson's rule for the height, and the mean of the ends for the divergence.
        let middle = 0.5 * (velocities[0] + velocities[1]);
        let slope = |v: DVec2| v.perp_dot(way) / v.length();
        let rise = (slope(velocities[0]) + 4.0 * slope(middle) + slope(velocities[1])) / 6.0;
        let rise = if self.egress {
            rise.max(0.0)
        } else {
            rise.min(0.0)
        };
        let speed = middle.length();
        let across = middle.perp() / speed;
        let rate = across.dot(generator.linear * across);
        let scale = (-rate * middle.dot(way) / (speed * speed)).exp();
        let [low, high] = if self.along {
            [-depth, 0.0]
        } else {
            [0.0, depth]
        };
        Heights {
            rise,
            scale,
            low: low.max(rise + scale * low),
            high: high.min(rise + scale * high),
            fall: low - (rise + scale * high),
            gain: rise + scale * low - high,
        }
    }
}

/// The heights along a stretch, relative to that of its start, in units of length there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Heights {
    /// Height of the end.
    pub(super) rise: f64,
    /// A unit of length at the start, per unit at the end.
    pub(super) scale: f64,
    /// Largest low.
    pub(super) low: f64,
    /// Least high.
    pub(super) high: f64,
    /// Largest low(u) - high(v) with u before v: above 0 it cannot be egress.
    pub(super) fall: f64,
    /// Largest low(v) - high(u) with u before v: above 0 it cannot be ingress.
    pub(super) gain: f64,
}

impl Heights {
    /// The heights of a stretch followed by another.
    pub(super) fn then(self, next: Heights) -> Heights {
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

    /// The heights of a piece that must not move. Its rise does not matter, since everything before
    /// and after it must meet it.
    fn fixed(egress: bool) -> Heights {
        let [fall, gain] = if egress {
            [0.0, f64::INFINITY]
        } else {
            [f64::INFINITY, 0.0]
        };
        Heights {
            rise: 0.0,
            scale: 1.0,
            low: 0.0,
            high: 0.0,
            fall,
            gain,
        }
    }

    pub(super) fn may_be(&self, egress: bool) -> bool {
        (if egress { self.fall } else { self.gain }) <= 0.0
    }
}

/// The pieces of a loop, in order.
pub(super) fn pieces(
    corners: &[DVec2],
    fluxes: &[EdgeFlux],
    generator: &Generator,
    fold: f64,
) -> Vec<SignedPiece> {
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
        stops.extend(divisions([p, q], generator));
        stops.sort_by(f64::total_cmp);
        stops.dedup();
        for pair in stops.windows(2) {
            let middle = 0.5 * (pair[0] + pair[1]);
            let at = |t: f64| if t == 1.0 { q } else { p.lerp(q, t) };
            let ends = [at(pair[0]), at(pair[1])];
            // The grazing point is one of the stops, so this holds for the whole piece.
            let egress = flux.is_egress_after(pair[0]);
            let along = first + (second - first) * middle >= 0.0;
            let mut piece = SignedPiece {
                edge,
                ends,
                egress,
                along,
                is_fixed: turns(ends, generator) || bends(ends, generator, fold),
                height: Heights::fixed(egress),
            };
            piece.height = piece.heights(generator, FIRST_ORDER * fold);
            pieces.push(piece);
        }
    }
    pieces
}

/// Most parts that are cut off an edge at either end.
const MOST_PARTS: usize = 16;

/// Positions that divide an edge into parts on which the field does not turn too much, except for
/// one part about the slowest point if it is nearly at rest.
fn divisions([p, q]: [DVec2; 2], generator: &Generator) -> Vec<f64> {
    let reach = size(generator) * p.distance(q);
    // The speed changes by at most `reach` times the distance: within this distance it stays above
    // a half.
    let half_way = |t: f64| 0.5 * FOLD_TURN * generator.velocity(p.lerp(q, t)).length() / reach;
    let mut divisions = Vec::new();
    let [mut low, mut high] = [0.0, 1.0];
    for _ in 0..MOST_PARTS {
        if !turns([low, high].map(|t| p.lerp(q, t)), generator) {
            break;
        }
        let [first, last] = [low + half_way(low), high - half_way(high)];
        if first >= last {
            divisions.push(0.5 * (first + last));
            break;
        }
        divisions.extend([first, last]);
        [low, high] = [first, last];
    }
    divisions
}

/// Whether the field turns too much along a segment.
fn turns([p, q]: [DVec2; 2], generator: &Generator) -> bool {
    size(generator) * p.distance(q) > FOLD_TURN * slowest([p, q], generator)
}

/// Whether the field turns too much across a depth.
fn bends(ends: [DVec2; 2], generator: &Generator, depth: f64) -> bool {
    size(generator) * depth > FOLD_CURVATURE * slowest(ends, generator)
}

/// Least speed on a segment.
fn slowest(ends: [DVec2; 2], generator: &Generator) -> f64 {
    distance_in_plane(ends.map(|p| generator.velocity(p)), DVec2::ZERO)
}

/// The largest change of the velocity over a distance, per unit of distance.
fn size(generator: &Generator) -> f64 {
    let [x, y] = [generator.linear.x_axis, generator.linear.y_axis];
    frobenius(&DMat3::from_cols(x.extend(0.0), y.extend(0.0), DVec3::ZERO))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The heights of a chain of points, for a motion by one along x.
    fn heights(points: &[[f64; 2]], depth: f64) -> Heights {
        let generator = Generator::translation(DVec2::X);
        let piece = |pair: &[[f64; 2]]| {
            let ends = [pair[0], pair[1]].map(DVec2::from_array);
            let egress = ends[1].y >= ends[0].y;
            let piece = SignedPiece {
                edge: 0,
                ends,
                egress,
                along: true,
                is_fixed: false,
                height: Heights::fixed(egress),
            };
            piece.heights(&generator, depth)
        };
        points
            .windows(2)
            .map(piece)
            .reduce(Heights::then)
            .expect("some pieces")
    }

    fn signs(heights: &Heights) -> [bool; 2] {
        [true, false].map(|egress| heights.may_be(egress))
    }

    #[test]
    fn a_dent_may_take_either_sign_if_it_is_shallower_than_the_depth() {
        // Lines along the motion have one height; what is between the lowest and the highest of
        // them is lost.
        let dent = [[0.0, 0.0], [1.0, 0.05], [2.0, 0.0]];
        assert_eq!(signs(&heights(&dent, 0.06)), [true, true]);
        assert_eq!(signs(&heights(&dent, 0.04)), [false, false]);
        assert_eq!(heights(&dent, 0.06).rise, 0.0);
        // An outline along the motion has no height at all.
        let flat = [[0.0, 0.0], [1.0, 0.0]];
        assert_eq!(signs(&heights(&flat, 0.0)), [true, true]);
    }

    #[test]
    fn what_rises_by_more_than_the_depth_in_all_keeps_its_sign() {
        // Each step rises by less than the depth, both together by more.
        let step = [[0.0, 0.0], [1.0, 0.03]];
        let steps = [[0.0, 0.0], [1.0, 0.03], [2.0, 0.03], [3.0, 0.06]];
        assert_eq!(signs(&heights(&step, 0.05)), [true, true]);
        assert_eq!(signs(&heights(&steps, 0.05)), [true, false]);
        assert!((heights(&steps, 0.05).rise - 0.06).abs() < 1e-15);
    }

    #[test]
    fn a_piece_that_is_fixed_keeps_its_sign_whatever_is_beside_it() {
        for egress in [true, false] {
            let fixed = Heights::fixed(egress);
            let flat = heights(&[[0.0, 0.0], [1.0, 0.0]], 0.1);
            for stretch in [fixed, fixed.then(flat), flat.then(fixed)] {
                assert_eq!(signs(&stretch), [egress, !egress]);
            }
        }
    }

    #[test]
    fn heights_are_measured_in_lengths_at_the_begin_where_paths_spread() {
        // Paths from the origin spread: at twice the distance two of them are twice as far apart.
        let growing = Generator {
            linear: glam::DMat2::IDENTITY,
            offset: DVec2::ZERO,
        };
        let piece = SignedPiece {
            edge: 0,
            ends: [DVec2::X, 1.01 * DVec2::X],
            egress: true,
            along: true,
            is_fixed: false,
            height: Heights::fixed(true),
        };
        let found = piece.heights(&growing, 0.1);
        // A length of 1.01 at the end is a length of 1 at the start; the mean speed gives this to
        // second order.
        assert!((found.scale - 1.0 / 1.01).abs() < 1e-6, "{}", found.scale);
        assert_eq!(found.rise, 0.0, "it lies on a path");
    }
}
