//! Directions that lead away from several planes at once.

use glam::DVec3;

/// Most steps of the search: the error of the sine of the angle is then about the inverse of their
/// number.
const STEPS: usize = 64;

/// A unit vector whose smallest product with any of `directions` is approximately as large as
/// possible, and that product. It is not positive when the directions lie in no open half space; it
/// may be too small, but never too large.
///
/// It points to the point of their convex hull nearest to the origin, by Gilbert's algorithm
/// (1966).
pub(super) fn away(directions: &[DVec3]) -> Option<(DVec3, f64)> {
    let mut point = directions.iter().copied().reduce(|a, b| a + b)? / directions.len() as f64;
    let mut best: Option<(DVec3, f64)> = None;
    for _ in 0..STEPS {
        let Some(unit) = point.try_normalize() else {
            break;
        };
        let farthest = directions
            .iter()
            .copied()
            .reduce(|a, b| if b.dot(unit) < a.dot(unit) { b } else { a })?;
        let product = farthest.dot(unit);
        if best.is_none_or(|(_, known)| product > known) {
            best = Some((unit, product));
        }
        let step = farthest - point;
        let share = -point.dot(step) / step.length_squared();
        // The share is NaN where the farthest direction is the point itself.
        if share.is_nan() || share <= CLOSE {
            break;
        }
        point += step * share.min(1.0);
    }
    best
}

/// Share of a step below which nothing changes any more.
const CLOSE: f64 = 1e-9;

/// The vector w of the given length for which the least n . w - s over all `planes` (n, s) is
/// largest; `None` where rounding finds none, or for no planes.
///
/// - `planes`: unit normals, and heights below `length`. There should be few: the work grows with
///   the fourth power of their number.
///
/// With the largest value m, n . w = s + m holds for at most three planes with independent normals,
/// and w is a combination of these (Kuhn and Tucker). Each choice of such planes gives w linear in
/// m, and m from the length of w.
pub(super) fn farthest_out(planes: &[(DVec3, f64)], length: f64) -> Option<DVec3> {
    let mut best: Option<(DVec3, f64)> = None;
    let mut consider = |chosen: &[(DVec3, f64)]| {
        let Some((base, slope)) = combination(chosen) else {
            return;
        };
        // |base + m slope| = length.
        let (square, half, rest) = (
            slope.length_squared(),
            base.dot(slope),
            base.length_squared() - length * length,
        );
        let root = half * half - square * rest;
        if root.is_nan() || root < 0.0 {
            return;
        }
        let vector = base + slope * ((root.sqrt() - half) / square);
        let room = planes
            .iter()
            .map(|(normal, height)| normal.dot(vector) - height)
            .fold(f64::INFINITY, f64::min);
        if best.is_none_or(|(_, known)| room > known) {
            best = Some((vector, room));
        }
    };
    for i in 0..planes.len() {
        consider(&[planes[i]]);
        for j in 0..i {
            consider(&[planes[i], planes[j]]);
            for k in 0..j {
                consider(&[planes[i], planes[j], planes[k]]);
            }
        }
    }
    let (vector, _) = best?;
    Some(vector * (length / vector.length()))
}

/// Vectors a and b such that w = a + m b is the combination of the normals with n . w = s + m for
/// each of them.
fn combination(planes: &[(DVec3, f64)]) -> Option<(DVec3, DVec3)> {
    match *planes {
        [(n, s)] => Some((n * s, n)),
        [(n, s), (o, t)] => {
            let across = n.cross(o);
            let square = across.length_squared();
            // The dual basis in the plane of both normals.
            let (dual, other) = (o.cross(across) / square, across.cross(n) / square);
            (square > 0.0).then_some((dual * s + other * t, dual + other))
        }
        [(n, s), (o, t), (p, u)] => {
            let volume = n.dot(o.cross(p));
            let duals = [o.cross(p), p.cross(n), n.cross(o)].map(|dual| dual / volume);
            let base = duals[0] * s + duals[1] * t + duals[2] * u;
            (volume != 0.0).then_some((base, duals[0] + duals[1] + duals[2]))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::random;

    #[test]
    fn the_way_out_of_a_fitting_hole_leads_along_it() {
        // Pressed by 0.9 into the bottom, between walls that it touches: little length is left for
        // these.
        let planes = [(DVec3::X, 0.9), (DVec3::Y, 0.0), (DVec3::Z, 0.0)];
        let out = farthest_out(&planes, 1.0).expect("a way out");
        let room = |w: DVec3| (w.x - 0.9).min(w.y).min(w.z);
        assert!((out.length() - 1.0).abs() < 1e-12, "{out}");
        // (0.9 + m)^2 + 2 m^2 = 1.
        let expected = (-1.8 + (1.8_f64 * 1.8 + 12.0 * 0.19).sqrt()) / 6.0;
        assert!((room(out) - expected).abs() < 1e-12, "{}", room(out));
    }

    #[test]
    fn no_sampled_vector_has_more_room() {
        let mut next = random(6);
        for case in 0..200 {
            let planes: Vec<(DVec3, f64)> = (0..1 + case % 6)
                .map(|_| {
                    let normal = DVec3::new(next(), next(), next() + 1.0).normalize();
                    (normal, 0.8 * next())
                })
                .collect();
            let room = |w: DVec3| {
                planes
                    .iter()
                    .map(|(n, s)| n.dot(w) - s)
                    .fold(f64::INFINITY, f64::min)
            };
            let found = room(farthest_out(&planes, 1.0).expect("a way out"));
            for _ in 0..500 {
                let vector = DVec3::new(next(), next(), next()).normalize();
                assert!(room(vector) <= found + 1e-9, "case {case}");
            }
        }
    }

    #[test]
    fn the_direction_out_of_a_corner_is_even_to_its_faces() {
        let (_, product) = away(&[DVec3::X, DVec3::Y, DVec3::Z]).expect("a direction");
        assert!((product - 1.0 / 3.0_f64.sqrt()).abs() < 1e-9, "{product}");
        let (_, product) = away(&[DVec3::X, -DVec3::X]).unwrap_or((DVec3::ZERO, 0.0));
        assert!(product <= 0.0, "opposite ones have none");
        assert!(away(&[]).is_none(), "no direction");
    }

    #[test]
    fn no_sampled_direction_is_much_better() {
        let mut next = random(2);
        let mut unit = || DVec3::new(next(), next(), next()).normalize_or(DVec3::X);
        for case in 0..100 {
            let directions: Vec<DVec3> = (0..2 + case % 5).map(|_| unit()).collect();
            let least = |u: DVec3| {
                directions
                    .iter()
                    .map(|d| d.dot(u))
                    .fold(f64::INFINITY, f64::min)
            };
            let sampled = (0..3000).map(|_| least(unit())).fold(-1.0, f64::max);
            let found = away(&directions).map_or(-1.0, |(u, product)| {
                assert!((least(u) - product).abs() < 1e-12, "what it says");
                product
            });
            assert!(
                found > sampled - 0.05 || sampled <= 0.05,
                "case {case}: {found} for {sampled}"
            );
        }
    }
}
