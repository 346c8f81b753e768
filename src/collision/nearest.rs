//! The nearest points of two triangles, segments or points at rest.

use crate::numeric::area::area_vector;
use crate::numeric::closest::nearest_on_segment;
use glam::DVec3;

/// A part of a triangle, segment or point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    /// A corner, by its number.
    Corner(usize),
    /// The side from this corner to the next.
    Side(usize),
    /// The interior of the triangle.
    Inside,
}

/// The nearest points of two convex things.
#[derive(Debug, Clone, Copy)]
pub(super) struct Nearest {
    /// The point on the first, and the point on the second.
    pub(super) points: [DVec3; 2],
    /// The parts on which they lie.
    pub(super) parts: [Part; 2],
    /// The squared distance between them.
    pub(super) distance_squared: f64,
}

impl Nearest {
    pub(super) fn distance(&self) -> f64 {
        self.distance_squared.sqrt()
    }

    fn consider(&mut self, points: [DVec3; 2], parts: [Part; 2]) {
        let distance_squared = points[0].distance_squared(points[1]);
        if distance_squared < self.distance_squared {
            *self = Nearest {
                points,
                parts,
                distance_squared,
            };
        }
    }
}

/// The nearest points of the hulls of one, two or three corners each; the distance is 0 where they
/// meet.
///
/// The distance is that of one point of each, to rounding, so it is never too small. Triangles
/// without area count as their sides.
pub(super) fn nearest(a: &[DVec3], b: &[DVec3]) -> Nearest {
    match (a, b) {
        ([point], [_, _, _]) => return of_point(*point, b),
        ([_, _, _], [point]) => {
            let Nearest {
                points: [x, y],
                parts: [s, t],
                distance_squared,
            } = of_point(*point, a);
            return Nearest {
                points: [y, x],
                parts: [t, s],
                distance_squared,
            };
        }
        _ => {}
    }
    let mut best = Nearest {
        points: [a[0], b[0]],
        parts: [Part::Corner(0), Part::Corner(0)],
        distance_squared: a[0].distance_squared(b[0]),
    };
    if let [p, q, r] = *b {
        corners_to_inside(a, [p, q, r], |points, parts| best.consider(points, parts));
    }
    if let [p, q, r] = *a {
        corners_to_inside(b, [p, q, r], |[x, y], [s, t]| best.consider([y, x], [t, s]));
    }
    if best.distance_squared == 0.0 {
        return best;
    }
    let balls = |corners: &[DVec3]| {
        let mut balls = [(DVec3::ZERO, 0.0); 3];
        for (number, ball) in balls.iter_mut().enumerate().take(sides(corners)) {
            let [from, to] = side(corners, number);
            *ball = (from.midpoint(to), 0.5 * from.distance(to));
        }
        balls
    };
    let (around_a, around_b) = (balls(a), balls(b));
    let mut distance = best.distance();
    for (i, (middle, reach)) in around_a.iter().enumerate().take(sides(a)) {
        for (j, (other, other_reach)) in around_b.iter().enumerate().take(sides(b)) {
            // They are no nearer than the balls around them.
            let near = distance + reach + other_reach;
            if middle.distance_squared(*other) <= near * near {
                let counts = [a.len(), b.len()];
                side_to_side(side(a, i), side(b, j), [i, j], counts, &mut best);
                distance = best.distance();
            }
        }
    }
    best
}

/// The nearest points of a point and a triangle.
fn of_point(point: DVec3, triangle: &[DVec3]) -> Nearest {
    let mut best = Nearest {
        points: [point; 2],
        parts: [Part::Corner(0), Part::Inside],
        distance_squared: f64::INFINITY,
    };
    let [p, q, r] = [triangle[0], triangle[1], triangle[2]];
    corners_to_inside(&[point], [p, q, r], |points, parts| {
        best.consider(points, parts);
    });
    if best.distance_squared < f64::INFINITY {
        // Over the interior, nothing is nearer.
        return best;
    }
    for (number, [from, to]) in [[p, q], [q, r], [r, p]].into_iter().enumerate() {
        let (share, foot) = nearest_on_segment([from, to], point);
        best.consider(
            [point, foot],
            [Part::Corner(0), part_of_side(share, number, 3)],
        );
    }
    best
}

/// The number of sides; a point has one, from itself to itself.
fn sides(corners: &[DVec3]) -> usize {
    if corners.len() == 3 { 3 } else { 1 }
}

fn side(corners: &[DVec3], number: usize) -> [DVec3; 2] {
    [corners[number], corners[(number + 1) % corners.len()]]
}

/// The part on which a parameter lies, on a side that starts at corner `number` of `count`.
fn part_of_side(parameter: f64, number: usize, count: usize) -> Part {
    if parameter <= 0.0 || count == 1 {
        Part::Corner(number)
    } else if parameter >= 1.0 {
        Part::Corner((number + 1) % count)
    } else {
        Part::Side(number)
    }
}

fn side_to_side(
    [a, b]: [DVec3; 2],
    [c, d]: [DVec3; 2],
    numbers: [usize; 2],
    counts: [usize; 2],
    best: &mut Nearest,
) {
    let (u, v, r) = (b - a, d - c, a - c);
    let (uu, vv, uv, ur, vr) = (u.dot(u), v.dot(v), u.dot(v), u.dot(r), v.dot(r));
    let denominator = uu * vv - uv * uv;
    let mut s = if denominator > 0.0 {
        ((uv * vr - ur * vv) / denominator).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let mut t = if vv > 0.0 { (uv * s + vr) / vv } else { 0.0 };
    if !(0.0..=1.0).contains(&t) || vv == 0.0 {
        t = t.clamp(0.0, 1.0);
        s = if uu > 0.0 {
            ((uv * t - ur) / uu).clamp(0.0, 1.0)
        } else {
            0.0
        };
    }
    let points = [
        if s >= 1.0 { b } else { a + u * s },
        if t >= 1.0 { d } else { c + v * t },
    ];
    let parts = [
        part_of_side(s, numbers[0], counts[0]),
        part_of_side(t, numbers[1], counts[1]),
    ];
    best.consider(points, parts);
}

/// Offers corners over the interior of a triangle, and sides that pass through it.
fn corners_to_inside(
    corners: &[DVec3],
    triangle: [DVec3; 3],
    mut consider: impl FnMut([DVec3; 2], [Part; 2]),
) {
    let normal = area_vector(triangle);
    let square = normal.length_squared();
    if square == 0.0 {
        return;
    }
    let [p, q, r] = triangle;
    let inward = [
        normal.cross(q - p),
        normal.cross(r - q),
        normal.cross(p - r),
    ];
    let is_over = |point: DVec3| {
        inward[0].dot(point - p) > 0.0
            && inward[1].dot(point - q) > 0.0
            && inward[2].dot(point - r) > 0.0
    };
    let mut heights = [0.0; 3];
    for (k, &corner) in corners.iter().enumerate() {
        heights[k] = normal.dot(corner - p);
        if is_over(corner) {
            let foot = corner - normal * (heights[k] / square);
            consider([corner, foot], [Part::Corner(k), Part::Inside]);
        }
    }
    if corners.len() > 1 {
        for k in 0..sides(corners) {
            let next = (k + 1) % corners.len();
            if heights[k] * heights[next] < 0.0 {
                let share = heights[k] / (heights[k] - heights[next]);
                let crossing = corners[k] + (corners[next] - corners[k]) * share;
                if is_over(crossing) {
                    consider([crossing; 2], [Part::Side(k), Part::Inside]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::random;

    /// The distance by alternating projections from a grid of points: slow and obviously right.
    fn by_sampling(a: &[DVec3], b: &[DVec3]) -> f64 {
        let samples = |corners: &[DVec3]| {
            let mut points = Vec::new();
            const STEPS: usize = 24;
            for i in 0..=STEPS {
                for j in 0..=STEPS - i {
                    let (s, t) = (i as f64 / STEPS as f64, j as f64 / STEPS as f64);
                    let [p, q, r] = [0, 1, 2].map(|k: usize| corners[k.min(corners.len() - 1)]);
                    points.push(p + (q - p) * s + (r - p) * t);
                }
            }
            points
        };
        let (a, b) = (samples(a), samples(b));
        a.iter()
            .flat_map(|p| b.iter().map(|q| p.distance(*q)))
            .fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn the_distance_agrees_with_sampling() {
        let mut next = random(4);
        for case in 0..200 {
            let mut corners = |count: usize, away: f64| -> Vec<DVec3> {
                (0..count)
                    .map(|_| DVec3::new(next() + away, next(), next()))
                    .collect()
            };
            let (a, b) = (
                corners(1 + case % 3, 0.0),
                corners(1 + case / 3 % 3, f64::from(u32::from(case % 2 == 0))),
            );
            let found = nearest(&a, &b);
            let sampled = by_sampling(&a, &b);
            assert!(
                found.distance() <= sampled + 1e-12 && sampled <= found.distance() + 0.15,
                "case {case}: {} against {sampled}",
                found.distance()
            );
            let swapped = nearest(&b, &a);
            assert!(
                (swapped.distance() - found.distance()).abs() < 1e-12,
                "the same from the other side"
            );
        }
    }

    #[test]
    fn triangles_that_pass_through_each_other_have_no_distance() {
        let floor = [DVec3::ZERO, DVec3::X * 3.0, DVec3::Y * 3.0];
        let post = [
            DVec3::new(1.0, 1.0, -1.0),
            DVec3::new(1.0, 1.0, 1.0),
            DVec3::new(1.2, 1.0, 1.0),
        ];
        assert_eq!(
            nearest(&floor, &post).distance(),
            0.0,
            "a post in the floor"
        );
        let flat = [floor[0], floor[1], floor[1] * 0.5];
        assert_eq!(
            nearest(&flat, &[DVec3::Z]).distance(),
            1.0,
            "a triangle without area is a segment"
        );
    }
}
