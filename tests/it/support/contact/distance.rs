//! Two triangles at one instant: their distance, and whether they certainly cross.
//!
//! A triangle may have equal corners: it is then a segment or a point.

use glam::DVec3;

pub(crate) type Triangle = [DVec3; 3];

/// The sides by their corners.
const SIDES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

/// The points of two triangles that are nearest to each other: the best of all nine pairs of sides
/// and six feet of corners, each a pair of points of the two triangles; equal points where a side
/// runs through the other triangle.
pub(crate) fn nearest(a: &Triangle, b: &Triangle) -> [DVec3; 2] {
    let mut best = (f64::INFINITY, [a[0], b[0]]);
    let mut offer = |pair: [DVec3; 2]| {
        let squared = pair[0].distance_squared(pair[1]);
        if squared < best.0 {
            best = (squared, pair);
        }
    };
    for [i, j] in SIDES {
        for [k, l] in SIDES {
            nearest_of_segments([a[i], a[j]], [b[k], b[l]], &mut offer);
        }
    }
    for corner in *a {
        if let Some(foot) = foot(corner, b) {
            offer([corner, foot]);
        }
    }
    for corner in *b {
        if let Some(foot) = foot(corner, a) {
            offer([foot, corner]);
        }
    }
    for [i, j] in SIDES {
        for point in [
            piercing([a[i], a[j]], b, 0.0),
            piercing([b[i], b[j]], a, 0.0),
        ] {
            point.into_iter().for_each(|point| offer([point, point]));
        }
    }
    best.1
}

pub(crate) fn distance(a: &Triangle, b: &Triangle) -> f64 {
    let [p, q] = nearest(a, b);
    p.distance(q)
}

/// Whether a side of one passes through the interior of the other, with a margin for errors of
/// `margin` in every position.
pub(crate) fn crosses(a: &Triangle, b: &Triangle, margin: f64) -> bool {
    SIDES.iter().any(|&[i, j]| {
        piercing([a[i], a[j]], b, margin).is_some() || piercing([b[i], b[j]], a, margin).is_some()
    })
}

/// The nearest point of a segment, which may be degenerate.
pub(crate) fn nearest_on_segment([from, to]: [DVec3; 2], point: DVec3) -> DVec3 {
    let way = to - from;
    let square = way.length_squared();
    if square == 0.0 {
        return from;
    }
    from + way * ((point - from).dot(way) / square).clamp(0.0, 1.0)
}

/// Offers each end with its foot on the other segment, and the common perpendicular where it meets
/// the interior of both.
fn nearest_of_segments([a, b]: [DVec3; 2], [c, d]: [DVec3; 2], offer: &mut impl FnMut([DVec3; 2])) {
    for end in [a, b] {
        offer([end, nearest_on_segment([c, d], end)]);
    }
    for end in [c, d] {
        offer([nearest_on_segment([a, b], end), end]);
    }
    let (p, q, r) = (b - a, d - c, c - a);
    let (pp, pq, qq) = (p.length_squared(), p.dot(q), q.length_squared());
    let determinant = pp * qq - pq * pq;
    if determinant > 0.0 {
        let (s, t) = (
            (r.dot(p) * qq - r.dot(q) * pq) / determinant,
            (r.dot(p) * pq - r.dot(q) * pp) / determinant,
        );
        if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
            offer([a + p * s, c + q * t]);
        }
    }
}

/// The unit normal; `None` where rounding could turn it, for a triangle without area.
fn normal([a, b, c]: &Triangle) -> Option<DVec3> {
    let (p, q) = (*b - *a, *c - *a);
    let normal = p.cross(q);
    (normal.length() > 1e-10 * p.length() * q.length())
        .then(|| normal.normalize())
        .filter(|normal| normal.is_finite())
}

/// Directions, one of which separates two triangles that touch without crossing: the normals, the
/// common perpendiculars of their sides, and perpendiculars to sides within the planes. Unit
/// vectors, or 0 where there is none.
pub(crate) fn touching_directions(a: &Triangle, b: &Triangle) -> Vec<DVec3> {
    let normals = [a, b].map(|triangle| normal(triangle).unwrap_or_default());
    let mut directions = normals.to_vec();
    for [i, j] in SIDES {
        for [k, l] in SIDES {
            let (first, second) = (a[j] - a[i], b[l] - b[k]);
            let across = first.cross(second);
            if across.length() > 1e-10 * first.length() * second.length() {
                let across = across.normalize();
                let within = [first, second].map(|side| side.cross(across).normalize());
                directions.extend([across, within[0], within[1]]);
            } else {
                // Parallel: from line to line.
                let apart = b[k] - a[i];
                let along = first.normalize_or(second.normalize_or_zero());
                let straight = (apart - along * apart.dot(along)).normalize_or_zero();
                directions.extend([straight, DVec3::ZERO, DVec3::ZERO]);
            }
        }
    }
    for triangle in [a, b] {
        for [i, j] in SIDES {
            let side = triangle[j] - triangle[i];
            directions.extend(normals.map(|normal| side.cross(normal).normalize_or_zero()));
        }
    }
    directions
}

/// How far `point`, in the plane, lies inside the nearest side; negative outside.
fn depth(point: DVec3, triangle: &Triangle, normal: DVec3) -> f64 {
    let depths = SIDES.map(|[i, j]| {
        let side = triangle[j] - triangle[i];
        normal.cross(side).dot(point - triangle[i]) / side.length()
    });
    depths.into_iter().fold(f64::INFINITY, f64::min)
}

/// The foot of the perpendicular on a triangle, where it falls inside.
fn foot(point: DVec3, triangle: &Triangle) -> Option<DVec3> {
    let normal = normal(triangle)?;
    let foot = point - normal * (point - triangle[0]).dot(normal);
    (depth(foot, triangle, normal) >= 0.0).then_some(foot)
}

/// The point in which a segment passes through a triangle, with a margin for errors of `margin` in
/// all positions.
fn piercing([p, q]: [DVec3; 2], triangle: &Triangle, margin: f64) -> Option<DVec3> {
    let normal = normal(triangle)?;
    let [above, below] = [p, q].map(|end| (end - triangle[0]).dot(normal));
    let opposite = (above > margin && below < -margin) || (above < -margin && below > margin);
    if !opposite {
        return None;
    }
    let point = p + (q - p) * (above / (above - below));
    // An error of the heights moves the point along the segment, by more the flatter it runs.
    let slip = 2.0 * margin * (1.0 + p.distance(q) / (above - below).abs());
    (depth(point, triangle, normal) > slip).then_some(point)
}
