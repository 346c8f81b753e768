//! How deep a body is in an obstacle at one time, by a slow method: points of the one, all
//! triangles and the solid angles of the other.

use super::super::random::Random;
use super::distance::nearest;
use super::scene::{Scene, is_closed};
use crate::support::shapes::Shape;
use glam::DVec3;

/// Number of points that are tried along each side of a triangle, and of the box that both have in
/// common.
const GRID: usize = 10;

/// Number of best points near which a deeper one is sought.
const CLIMBERS: usize = 6;

/// A closed surface at one time.
struct Solid(Vec<[DVec3; 3]>);

impl Solid {
    fn new((positions, triangles): &Shape) -> Solid {
        Solid(
            triangles
                .iter()
                .map(|t| t.map(|v| positions[v as usize]))
                .collect(),
        )
    }

    /// The distance from the surface, negative outside.
    fn depth(&self, point: DVec3) -> f64 {
        let distance = self
            .0
            .iter()
            .map(|t| {
                let [a, b] = nearest(&[point; 3], t);
                a.distance(b)
            })
            .fold(f64::INFINITY, f64::min);
        if self.winding(point) > 0.5 {
            distance
        } else {
            -distance
        }
    }

    /// The sum of the solid angles of the triangles, divided by that of a ball (Van Oosterom and
    /// Strackee, 1983).
    fn winding(&self, point: DVec3) -> f64 {
        let angle = |t: &[DVec3; 3]| {
            let [a, b, c] = t.map(|corner| corner - point);
            let (x, y, z) = (a.length(), b.length(), c.length());
            let below = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
            2.0 * a.dot(b.cross(c)).atan2(below)
        };
        self.0.iter().map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
    }
}

impl Scene {
    /// The greatest depth at a time among many points: at most the true one, and near it where the
    /// deepest place is not tiny.
    ///
    /// For an open obstacle it is the other way round: how deep a point of the obstacle is in the
    /// body.
    pub(crate) fn slow_depth(&self, obstacle: usize, time: f64) -> f64 {
        let search = self.search(obstacle, 0.0);
        let [body, other] = search.shapes_at(time);
        if is_closed(&self.obstacles[obstacle].shape) {
            deepest(&body, &other, true)
        } else {
            deepest(&other, &body, false)
        }
    }
}

/// - `filled`: whether points inside the first shape count as well.
fn deepest(sinking: &Shape, solid: &Shape, filled: bool) -> f64 {
    let (own, solid) = (Solid::new(sinking), Solid::new(solid));
    let mut points: Vec<(f64, DVec3, Option<[DVec3; 3]>)> = Vec::new();
    for corners in &own.0 {
        for i in 0..=GRID {
            for j in 0..=GRID - i {
                let (a, b) = (i as f64 / GRID as f64, j as f64 / GRID as f64);
                let point = corners[0] * a + corners[1] * b + corners[2] * (1.0 - a - b);
                points.push((solid.depth(point), point, Some(*corners)));
            }
        }
    }
    if filled {
        let bounds = |solid: &Solid| {
            let corners = solid.0.iter().flatten();
            corners.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], &p| {
                [low.min(p), high.max(p)]
            })
        };
        let ([a, b], [c, d]) = (bounds(&own), bounds(&solid));
        let (low, high) = (a.max(c), b.min(d));
        if low.cmple(high).all() {
            for i in 0..GRID.pow(3) {
                let share = |k: usize| (k % GRID) as f64 / (GRID - 1) as f64;
                let at = DVec3::new(share(i), share(i / GRID), share(i / GRID / GRID));
                let point = low + (high - low) * at;
                if own.winding(point) > 0.5 {
                    points.push((solid.depth(point), point, None));
                }
            }
        }
    }
    points.sort_by(|x, y| y.0.total_cmp(&x.0));
    let mut random = Random::new(1);
    let mut best = points.first().map_or(f64::NEG_INFINITY, |p| p.0);
    for (mut depth, mut point, on) in points.into_iter().take(CLIMBERS) {
        let mut step = match on {
            Some([a, b, c]) => (a.distance(b) + a.distance(c)) / GRID as f64,
            None => 0.2,
        };
        while step > 1e-14 {
            let mut moved = false;
            for _ in 0..12 {
                let to = point + random.direction() * step;
                let to = match &on {
                    Some(corners) => nearest(&[to; 3], corners)[1],
                    None if own.winding(to) > 0.5 => to,
                    None => continue,
                };
                let next = solid.depth(to);
                if next > depth {
                    (depth, point, moved) = (next, to, true);
                }
            }
            if !moved {
                step *= 0.5;
            }
        }
        best = best.max(depth);
    }
    best
}
