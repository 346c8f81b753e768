//! Parts of a triangle, and the deepest point of a part below planes.

use super::nearest::Part;
use glam::DVec3;

/// The weights of the corners of a triangle in a point of it.
pub(super) type Weights = [f64; 3];

/// A triangle within a triangle of a shape.
///
/// The corners of parts have a few roundings more than those of the triangle, by units in the last
/// place: a small part of the error of a position.
#[derive(Debug, Clone, Copy)]
pub(super) struct TrianglePiece {
    pub(super) triangle: u32,
    pub(super) weights: [Weights; 3],
}

/// A plane, given by its outward unit normal and its height over the origin.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    pub(super) normal: DVec3,
    pub(super) offset: f64,
}

/// Cosine of the angle between normals that count as one.
const SAME: f64 = 1.0 - 1e-9;

impl Plane {
    /// Whether another plane is the same up to a difference in height, and up to rounding.
    pub(super) fn is_same(&self, other: &Plane, height: f64) -> bool {
        self.normal.dot(other.normal) > SAME && (self.offset - other.offset).abs() <= height
    }

    pub(super) fn height(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.offset
    }
}

/// The lowest point of a triangle below several planes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lowest {
    pub(super) weights: Weights,
    /// The difference of the heights over the two planes that are nearest to it, at the corners;
    /// `None` for a single plane.
    pub(super) between: Option<[f64; 3]>,
}

pub(super) fn blend(corners: &[DVec3; 3], weights: Weights) -> DVec3 {
    corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2]
}

/// The part of the triangle on which the point with these weights lies.
pub(super) fn part(weights: Weights) -> Part {
    let [a, b, c] = weights.map(|weight| weight > 0.0);
    match (a, b, c) {
        (true, false, false) => Part::Corner(0),
        (false, true, false) => Part::Corner(1),
        (false, false, true) => Part::Corner(2),
        (true, true, false) => Part::Side(0),
        (false, true, true) => Part::Side(1),
        (true, false, true) => Part::Side(2),
        _ => Part::Inside,
    }
}

impl TrianglePiece {
    pub(super) fn whole(triangle: u32) -> TrianglePiece {
        TrianglePiece {
            triangle,
            weights: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        }
    }

    /// The corners of the piece, from those of the triangle.
    pub(super) fn corners(&self, of: &[DVec3; 3]) -> [DVec3; 3] {
        self.weights.map(|weights| blend(of, weights))
    }

    /// The weights in the triangle of a point with these weights in the piece.
    pub(super) fn of_triangle(&self, weights: Weights) -> Weights {
        std::array::from_fn(|k| (0..3).map(|i: usize| weights[i] * self.weights[i][k]).sum())
    }

    /// Halves the piece across its longest side.
    ///
    /// - `corners`: its own.
    pub(super) fn halves(&self, corners: &[DVec3; 3]) -> Vec<TrianglePiece> {
        let length = |k: usize| corners[k].distance_squared(corners[(k + 1) % 3]);
        let longest = (1..3).fold(0, |best, k| if length(k) > length(best) { k } else { best });
        let mut heights = [0.0; 3];
        (heights[longest], heights[(longest + 1) % 3]) = (1.0, -1.0);
        self.cut(heights)
    }

    /// Cuts the piece along the line on which a linear function with these values at the corners is
    /// 0; gives the piece itself where there is no such line.
    pub(super) fn cut(&self, heights: [f64; 3]) -> Vec<TrianglePiece> {
        let share = |from: usize, to: usize| heights[from] / (heights[from] - heights[to]);
        let point = |from: usize, to: usize| -> Weights {
            let s = share(from, to);
            std::array::from_fn(|k| self.weights[from][k] * (1.0 - s) + self.weights[to][k] * s)
        };
        let piece = |weights: [Weights; 3]| TrianglePiece {
            triangle: self.triangle,
            weights,
        };
        let w = self.weights;
        for k in 0..3 {
            let (next, last) = ((k + 1) % 3, (k + 2) % 3);
            if heights[k] == 0.0 && heights[next] * heights[last] < 0.0 {
                let p = point(next, last);
                return vec![piece([w[k], w[next], p]), piece([w[k], p, w[last]])];
            }
            if heights[k] * heights[next] < 0.0 && heights[k] * heights[last] < 0.0 {
                let (p, q) = (point(k, next), point(k, last));
                return vec![
                    piece([w[k], p, q]),
                    piece([p, w[next], w[last]]),
                    piece([p, w[last], q]),
                ];
            }
        }
        vec![*self]
    }
}

/// The point of a triangle at which the highest of its heights over some planes is lowest: the
/// deepest one in the convex solid that they bound.
///
/// - `planes`: at least one, and few: the work grows with the fourth power of their number.
pub(super) fn lowest(corners: &[DVec3; 3], planes: &[Plane]) -> Lowest {
    let heights: Vec<[f64; 3]> = planes
        .iter()
        .map(|plane| corners.map(|corner| plane.height(corner)))
        .collect();
    let at = |h: &[f64; 3], w: Weights| h[0] * w[0] + h[1] * w[1] + h[2] * w[2];
    let mut best = ([1.0, 0.0, 0.0], f64::INFINITY);
    let mut consider = |weights: Weights| {
        let highest = heights
            .iter()
            .map(|h| at(h, weights))
            .fold(f64::NEG_INFINITY, f64::max);
        if highest < best.1 {
            best = (weights, highest);
        }
    };
    for k in 0..3 {
        let mut corner = [0.0; 3];
        corner[k] = 1.0;
        consider(corner);
    }
    let difference =
        |i: usize, j: usize| -> [f64; 3] { std::array::from_fn(|k| heights[i][k] - heights[j][k]) };
    for i in 0..planes.len() {
        for j in 0..i {
            let d = difference(i, j);
            for k in 0..3 {
                let next = (k + 1) % 3;
                if d[k] * d[next] < 0.0 {
                    let share = d[k] / (d[k] - d[next]);
                    let mut weights = [0.0; 3];
                    (weights[k], weights[next]) = (1.0 - share, share);
                    consider(weights);
                }
            }
            for l in 0..j {
                // Where both differences are 0: the direction across both of them.
                let e = difference(i, l);
                let weights = DVec3::from_array(d).cross(DVec3::from_array(e));
                let sum = weights.element_sum();
                let weights = (weights / sum).to_array();
                if weights.iter().all(|&w| w > 0.0 && w < 1.0) {
                    consider(weights);
                }
            }
        }
    }
    let weights = best.0;
    let mut ranked: Vec<usize> = (0..planes.len()).collect();
    ranked.sort_by(|&a, &b| at(&heights[b], weights).total_cmp(&at(&heights[a], weights)));
    Lowest {
        weights,
        between: (ranked.len() > 1).then(|| difference(ranked[0], ranked[1])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::area::area_vector;
    use crate::samples::random;

    const SAMPLE: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    #[test]
    fn parts_cover_the_triangle_and_keep_its_sense() {
        let mut next = random(3);
        for case in 0..200 {
            let mut heights = [next(), next(), next()];
            if case % 5 == 0 {
                heights[case % 3] = 0.0;
            }
            let pieces = TrianglePiece::whole(7).cut(heights);
            let areas = pieces.iter().map(|piece| {
                let area = area_vector(piece.corners(&SAMPLE)).z;
                assert!(area >= 0.0, "case {case}");
                let at = |w: Weights| w[0] * heights[0] + w[1] * heights[1] + w[2] * heights[2];
                let sides = piece.weights.map(at);
                assert!(
                    sides.iter().all(|&h| h >= -1e-12) || sides.iter().all(|&h| h <= 1e-12),
                    "on one side"
                );
                area
            });
            assert!((areas.sum::<f64>() - 1.0).abs() < 1e-12, "case {case}");
        }
        assert_eq!(TrianglePiece::whole(0).halves(&SAMPLE).len(), 2, "halves");
    }

    #[test]
    fn the_deepest_point_under_planes_is_not_beaten_by_a_grid() {
        let mut next = random(8);
        for case in 0..200 {
            let corners = [0, 1, 2].map(|_| DVec3::new(next(), next(), next()));
            let planes: Vec<Plane> = (0..1 + case % 6)
                .map(|_| Plane {
                    normal: DVec3::new(next(), next(), next()).normalize(),
                    offset: next(),
                })
                .collect();
            let height = |weights: Weights| {
                let point = blend(&corners, weights);
                planes
                    .iter()
                    .map(|plane| plane.height(point))
                    .fold(f64::NEG_INFINITY, f64::max)
            };
            let found = height(lowest(&corners, &planes).weights);
            for i in 0..=40 {
                for j in 0..=40 - i {
                    let (a, b) = (f64::from(i) / 40.0, f64::from(j) / 40.0);
                    assert!(
                        found <= height([a, b, 1.0 - a - b]) + 1e-12,
                        "case {case} at {a}, {b}"
                    );
                }
            }
        }
    }
}
