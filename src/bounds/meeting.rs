//! Whether two triangles of a surface meet elsewhere than in the corners and the edge that they have
//! in common. It is decided exactly, on the coordinates as they are.

use crate::numeric::exact::signs::{Side, side_of_line, side_of_plane};
use glam::{DVec2, DVec3};

/// How two triangles meet elsewhere than in what they have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Meeting {
    /// Corners and edges of one lie on the other, but no inner points of both coincide.
    Touch,
    /// An inner point of one is an inner point of the other: they pass through each other, or lie
    /// on each other.
    Cross,
}

/// How two triangles, which may have corners in common, meet elsewhere; `None` if they do not.
///
/// A triangle without area meets nothing here: in a closed surface, the neighbours at its sides do.
pub(crate) fn meeting(positions: &[DVec3], triangles: [[u32; 3]; 2]) -> Option<Meeting> {
    let places = triangles.map(|corners| corners.map(|corner| positions[corner as usize]));
    let is_common = [0, 1].map(|i| triangles[i].map(|v| triangles[1 - i].contains(&v)));
    let common = is_common[0].iter().filter(|&&is_common| is_common).count();
    let sides = |i: usize| sides_of_plane(places[1 - i], places[i], is_common[i]);
    let first = sides(0);
    if first == [Side::On; 3] {
        return in_one_plane(places, is_common);
    }
    // Different planes meet in the line of a common edge.
    if common == 2 || is_off(first, common) {
        return None;
    }
    let second = sides(1);
    // The second one may have no area.
    if second == [Side::On; 3] || is_off(second, common) {
        return None;
    }
    let sides = [first, second];
    if sides.iter().all(straddles) && overlap(places, sides) {
        return Some(Meeting::Cross);
    }
    let touches = |i: usize| {
        edges_apart(is_common[i]).any(|ends| {
            meets_segment(
                places[1 - i],
                ends.map(|k| places[i][k]),
                ends.map(|k| sides[i][k]),
            )
        })
    };
    (touches(0) || touches(1)).then_some(Meeting::Touch)
}

/// The sides of the plane of a triangle on which points lie.
fn sides_of_plane([a, b, c]: [DVec3; 3], points: [DVec3; 3], is_corner: [bool; 3]) -> [Side; 3] {
    [0, 1, 2].map(|k| {
        if is_corner[k] {
            Side::On
        } else {
            side_of_plane(a, b, c, points[k])
        }
    })
}

/// Whether a triangle with corners on these sides of a plane has no point in it but its common
/// corner, if there is one.
fn is_off(sides: [Side; 3], common: usize) -> bool {
    let on = sides.iter().filter(|&&side| side == Side::On).count();
    on == common && !straddles(&sides)
}

fn straddles(sides: &[Side; 3]) -> bool {
    sides.contains(&Side::Above) && sides.contains(&Side::Below)
}

/// The edges of a triangle that have no common corner, as pairs of places: all, or the one opposite
/// to the common corner.
fn edges_apart(is_common: [bool; 3]) -> impl Iterator<Item = [usize; 2]> {
    let edges = [[0, 1], [1, 2], [2, 0]];
    edges
        .into_iter()
        .filter(move |edge| !edge.iter().any(|&k| is_common[k]))
}

/// Whether the lines in which two triangles cross the plane of each other have a common point inside
/// both. Each has corners on both sides of that plane.
///
/// Source: Guigue, Devillers (2003), Fast and robust triangle-triangle overlap test using
/// orientation predicates; with open instead of closed intervals.
fn overlap(places: [[DVec3; 3]; 2], sides: [[Side; 3]; 2]) -> bool {
    // Each begins with the corner that is alone on its side; seen from there, the other one runs
    // counter-clockwise.
    let alone = |i: usize| {
        let is_alone = |k: &usize| {
            let side = sides[i][*k];
            side != Side::On && sides[i].iter().filter(|&&other| other == side).count() == 1
        };
        (0..3).find(is_alone).unwrap_or(0)
    };
    let starts = [alone(0), alone(1)];
    let ordered = |i: usize| {
        let [p, q, r] = [0, 1, 2].map(|k| places[i][(starts[i] + k) % 3]);
        if sides[1 - i][starts[1 - i]] == Side::Above {
            [p, q, r]
        } else {
            [p, r, q]
        }
    };
    let ([p, q, r], [s, t, u]) = (ordered(0), ordered(1));
    side_of_plane(q, s, p, t) == Side::Below && side_of_plane(p, s, r, u) == Side::Below
}

/// Whether a segment, whose ends lie on these sides of the plane of a triangle, meets the triangle.
fn meets_segment(triangle: [DVec3; 3], [p, q]: [DVec3; 2], sides: [Side; 2]) -> bool {
    let view = View::of(triangle);
    match sides {
        [Side::On, Side::On] => view.is_some_and(|view| view.meets([p, q])),
        [Side::On, _] => view.is_some_and(|view| !view.is_beyond(&[p], STRICTLY)),
        [_, Side::On] => view.is_some_and(|view| !view.is_beyond(&[q], STRICTLY)),
        [of_p, of_q] => {
            let [a, b, c] = triangle;
            let edges = [[a, b], [b, c], [c, a]];
            of_p != of_q && !straddles(&edges.map(|[a, b]| side_of_plane(p, q, a, b)))
        }
    }
}

/// How two triangles of one plane meet.
fn in_one_plane(places: [[DVec3; 3]; 2], is_common: [[bool; 3]; 2]) -> Option<Meeting> {
    let views = [View::of(places[0])?, View::of(places[1])?];
    let is_beyond = |sides| (0..2).any(|i| views[i].is_beyond(&places[1 - i], sides));
    if !is_beyond(OR_ON) {
        return Some(Meeting::Cross);
    }
    // Beside a common edge, nothing else is in common.
    let touches = |i: usize| {
        edges_apart(is_common[i]).any(|ends| views[1 - i].meets(ends.map(|k| places[i][k])))
    };
    (!is_beyond(STRICTLY) && (touches(0) || touches(1))).then_some(Meeting::Touch)
}

/// A triangle with area and points of its plane, seen along a coordinate axis such that the
/// triangle runs counter-clockwise.
struct View {
    axes: [usize; 2],
    corners: [DVec2; 3],
}

/// Beyond an edge.
const STRICTLY: &[Side] = &[Side::Below];

/// Beyond an edge or on its line.
const OR_ON: &[Side] = &[Side::Below, Side::On];

impl View {
    /// `None` for a triangle without area.
    fn of(triangle: [DVec3; 3]) -> Option<View> {
        [[0, 1], [1, 2], [2, 0]].into_iter().find_map(|[x, y]| {
            let corners = |axes: [usize; 2]| triangle.map(|p| seen(p, axes));
            let [a, b, c] = corners([x, y]);
            let axes = match side_of_line(a, b, c) {
                Side::On => return None,
                Side::Above => [x, y],
                Side::Below => [y, x],
            };
            Some(View {
                axes,
                corners: corners(axes),
            })
        })
    }

    /// Whether all points are on these sides of one of the edges.
    fn is_beyond(&self, points: &[DVec3], sides: &[Side]) -> bool {
        (0..3).any(|k| {
            let [a, b] = [self.corners[k], self.corners[(k + 1) % 3]];
            let side = |&p: &DVec3| side_of_line(a, b, seen(p, self.axes));
            points.iter().all(|p| sides.contains(&side(p)))
        })
    }

    /// Whether a segment meets the triangle: otherwise its line or one of an edge separates them.
    fn meets(&self, ends: [DVec3; 2]) -> bool {
        let [p, q] = ends.map(|end| seen(end, self.axes));
        let [a, b, c] = self.corners.map(|corner| side_of_line(p, q, corner));
        let is_beside = a == b && b == c && a != Side::On;
        !is_beside && !self.is_beyond(&ends, STRICTLY)
    }
}

fn seen(point: DVec3, [x, y]: [usize; 2]) -> DVec2 {
    DVec2::new(point[x], point[y])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::random_below;

    /// The corners of the common part of two triangles, by cutting one with the planes of the other
    /// and with those that stand on its edges; none for triangles without area. Exact up to
    /// rounding.
    fn common_part([one, other]: [[DVec3; 3]; 2]) -> Vec<DVec3> {
        let [a, b, c] = other;
        let normal = (b - a).cross(c - a);
        let mut part = one.to_vec();
        let upright = [[a, b], [b, c], [c, a]].map(|[p, q]| (p, normal.cross(q - p)));
        for (origin, inwards) in upright.into_iter().chain([(a, normal), (a, -normal)]) {
            let height = |p: DVec3| inwards.normalize().dot(p - origin);
            let mut cut = Vec::new();
            for (k, &p) in part.iter().enumerate() {
                let q = part[(k + 1) % part.len()];
                let [of_p, of_q] = [height(p), height(q)];
                if of_p > -NEAR {
                    cut.push(p);
                }
                if of_p.min(of_q) < -NEAR && of_p.max(of_q) > NEAR {
                    cut.push(p.lerp(q, of_p / (of_p - of_q)));
                }
            }
            part = cut;
        }
        part
    }

    /// Below this, numbers that come from small integers are zero.
    const NEAR: f64 = 1e-9;

    /// What [`meeting`] says, from the common part.
    fn plain(positions: &[DVec3], triangles: [[u32; 3]; 2]) -> Option<Meeting> {
        let places = triangles.map(|corners| corners.map(|corner| positions[corner as usize]));
        let normals = places.map(|[a, b, c]| (b - a).cross(c - a));
        if normals.contains(&DVec3::ZERO) {
            return None;
        }
        let part = common_part(places);
        let common: Vec<DVec3> = triangles[0]
            .iter()
            .filter(|corner| triangles[1].contains(corner))
            .map(|&corner| positions[corner as usize])
            .collect();
        let is_common = |p: DVec3| match common[..] {
            [] => false,
            [a] => p.distance(a) < NEAR,
            [a, b] => (p - a).cross(b - a).length() < NEAR,
            _ => false,
        };
        if part.iter().all(|&p| is_common(p)) {
            return None;
        }
        let centre = part.iter().sum::<DVec3>() / part.len() as f64;
        let is_inner = (0..2).all(|i| {
            let [a, b, c] = places[i];
            let height = |p: DVec3, q: DVec3| normals[i].cross(q - p).dot(centre - p);
            [height(a, b), height(b, c), height(c, a)]
                .iter()
                .all(|&height| height > NEAR)
        });
        Some(if is_inner {
            Meeting::Cross
        } else {
            Meeting::Touch
        })
    }

    /// Two triangles with corners of small coordinates, which have up to three corners in common.
    fn pair(below: &mut impl FnMut(u64) -> u64, width: u64) -> (Vec<DVec3>, [[u32; 3]; 2]) {
        let mut coordinate = || f64::from(u32::try_from(below(width)).expect("small"));
        let positions = (0..6)
            .map(|_| DVec3::new(coordinate(), coordinate(), coordinate()))
            .collect();
        let common = u32::try_from(below(4)).expect("small");
        let mut other = [3 - common, 4 - common, 5 - common];
        other.rotate_left(usize::try_from(below(3)).expect("small"));
        if below(2) == 0 {
            other.swap(0, 1);
        }
        (positions, [[0, 1, 2], other])
    }

    #[test]
    fn pairs_on_a_small_grid_meet_where_cutting_says() {
        let mut below = random_below(7);
        let mut found = [0; 3];
        for round in 0..60_000 {
            let (positions, triangles) = pair(&mut below, 2 + round % 4);
            let expected = plain(&positions, triangles);
            let corners = triangles.map(|t| t.map(|v| positions[v as usize]));
            assert_eq!(
                meeting(&positions, triangles),
                expected,
                "{triangles:?} {corners:?}"
            );
            let turned = [triangles[1], triangles[0]];
            assert_eq!(meeting(&positions, turned), expected, "turned: {corners:?}");
            found[expected.map_or(0, |meeting| 1 + meeting as usize)] += 1;
        }
        assert!(
            found.iter().all(|&count| count > 3000),
            "none, touch, cross: {found:?}"
        );
    }

    #[test]
    fn pairs_of_slivers_far_away_meet_as_those_on_the_grid_do() {
        // A map of integers: the images are exact, and nearly on one line.
        let (along, across) = (
            DVec3::new(3e12, 5e12, 7e12),
            DVec3::new(3e12, 5e12, 7e12 + 1.0),
        );
        let third = DVec3::new(3e12, 5e12 - 1.0, 7e12);
        let far = |p: DVec3| DVec3::splat(1e15) + along * p.x + across * p.y + third * p.z;
        let mut below = random_below(8);
        for _ in 0..20_000 {
            let (positions, triangles) = pair(&mut below, 4);
            let mapped: Vec<DVec3> = positions.iter().map(|&p| far(p)).collect();
            let (near, far) = (meeting(&positions, triangles), meeting(&mapped, triangles));
            assert_eq!(near, far, "{triangles:?} {positions:?}");
        }
    }
}
