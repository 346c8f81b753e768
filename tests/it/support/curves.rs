//! Closed curves of the plane, their winding numbers by a slow plain count, and what an arrangement
//! of them must satisfy.

use super::random::Random;
use glam::DVec2;
use std::collections::{HashMap, HashSet};
use steadysweep::solid::planar::{Arrangement, Outlines, Segment, Triangulation, arrange};

/// Closed polygons, each without its first vertex at the end.
pub(crate) type Curves = Vec<Vec<DVec2>>;

/// 1 to the left of the line from `a` to `b`, -1 to the right of it, 0 on it, exactly.
fn side(a: DVec2, b: DVec2, point: DVec2) -> f64 {
    let [a, b, point] = [a, b, point].map(|p| robust::Coord { x: p.x, y: p.y });
    let twice_the_area = robust::orient2d(a, b, point);
    if twice_the_area == 0.0 {
        0.0
    } else {
        twice_the_area.signum()
    }
}

/// Points and segments of closed polygons, each run through once.
pub(crate) fn segments(curves: &Curves) -> (Vec<DVec2>, Vec<Segment>) {
    let mut points = Vec::new();
    let mut segments = Vec::new();
    for curve in curves {
        let first = points.len() as u32;
        let count = curve.len() as u32;
        points.extend_from_slice(curve);
        segments.extend((0..count).map(|k| Segment {
            ends: [first + k, first + (k + 1) % count],
            weight: 1,
        }));
    }
    (points, segments)
}

pub(crate) fn arranged(curves: &Curves) -> Arrangement {
    let (points, segments) = segments(curves);
    arrange(&points, &segments).unwrap_or_else(|error| panic!("{error}\n{curves:?}"))
}

/// The winding number of the curves around a point, by counting crossings of the half line to the
/// right.
pub(crate) fn winding_number(curves: &Curves, point: DVec2) -> i32 {
    let mut winding = 0;
    for curve in curves {
        for (k, &a) in curve.iter().enumerate() {
            let b = curve[(k + 1) % curve.len()];
            let left = (b - a).perp_dot(point - a);
            if a.y <= point.y && b.y > point.y && left > 0.0 {
                winding += 1;
            } else if b.y <= point.y && a.y > point.y && left < 0.0 {
                winding -= 1;
            }
        }
    }
    winding
}

/// Distance of a point from the curves.
pub(crate) fn distance(curves: &Curves, point: DVec2) -> f64 {
    let to_segment = |a: DVec2, b: DVec2| {
        let along = b - a;
        let fraction = ((point - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        let foot = if fraction.is_finite() {
            a + along * fraction
        } else {
            a
        };
        foot.distance(point)
    };
    curves
        .iter()
        .flat_map(|curve| {
            (0..curve.len()).map(|k| to_segment(curve[k], curve[(k + 1) % curve.len()]))
        })
        .fold(f64::INFINITY, f64::min)
}

/// Asserts what must hold for every arrangement: winding numbers as counted, outlines closed,
/// simple, oriented, nested as the triangles say, and meeting at vertices only.
pub(crate) fn check(curves: &Curves, arrangement: &Arrangement) -> Outlines {
    let positions = arrangement.positions();
    let triangulation = arrangement
        .triangulation()
        .unwrap_or_else(|error| panic!("{error}\n{curves:?}"));
    let proximity = arrangement.proximity();
    let mut area = 0.0;
    for ((corners, &winding), &is_inside) in triangulation
        .triangles
        .iter()
        .zip(&triangulation.winding)
        .zip(&triangulation.is_inside)
    {
        assert_eq!(is_inside, winding >= 1, "nothing was filled");
        let [a, b, c] = corners.map(|corner| positions[corner as usize]);
        assert_eq!(side(a, b, c), 1.0, "counter-clockwise");
        if is_inside {
            area += (b - a).perp_dot(c - a) / 2.0;
        }
        let centre = (a + b + c) / 3.0;
        if distance(curves, centre) > 4.0 * arrangement.rounding() {
            let counted = winding_number(curves, centre);
            assert_eq!(winding, counted, "at {centre} of {curves:?}");
            assert_eq!(
                proximity.contains(centre),
                is_inside,
                "at {centre} of {curves:?}"
            );
        }
    }
    let outlines = arrangement.outlines();
    let measures = arrangement.measures(&outlines);
    assert!(
        (measures.area - area).abs() <= 1e-12 * area + 1e-15,
        "outlines enclose {} and triangles {area}",
        measures.area
    );
    assert_eq!(
        [measures.pieces, measures.holes],
        counted(&triangulation),
        "pieces and holes by their loops and by flood fill: {curves:?}"
    );
    check_loops(arrangement, &outlines);
    outlines
}

/// Checks that every loop passes a vertex once, pieces are counter-clockwise, and holes clockwise.
fn check_loops(arrangement: &Arrangement, outlines: &Outlines) {
    let positions = arrangement.positions();
    let places = |vertices: &[u32]| -> Vec<DVec2> {
        vertices.iter().map(|&v| positions[v as usize]).collect()
    };
    let mut edges = HashSet::new();
    for (number, outline) in outlines.loops().enumerate() {
        let different: HashSet<u32> = outline.vertices.iter().copied().collect();
        assert_eq!(different.len(), outline.vertices.len(), "no vertex twice");
        assert!(different.len() >= 3, "a loop has an area");
        let ring = places(&outline.vertices);
        let origin = ring[0];
        let doubled: f64 = (1..ring.len() - 1)
            .map(|k| (ring[k] - origin).perp_dot(ring[k + 1] - origin))
            .sum();
        let is_outer = number < outlines.pieces.len();
        assert!(
            if is_outer {
                doubled > 0.0
            } else {
                doubled < 0.0
            },
            "loop {number} encloses {doubled}"
        );
        assert!(
            (outline.piece as usize) < outlines.pieces.len(),
            "its piece"
        );
        if is_outer {
            assert_eq!(outline.piece as usize, number, "numbered in order");
        } else {
            // Some vertex of a hole is strictly inside its piece, or all are on the piece's own
            // loop.
            let ring = vec![places(&outlines.pieces[outline.piece as usize].vertices)];
            let middle = positions[outline.vertices[0] as usize]
                .midpoint(positions[outline.vertices[1] as usize]);
            assert!(
                winding_number(&ring, middle) == 1
                    || distance(&ring, middle) < 4.0 * arrangement.rounding(),
                "a hole lies in its piece"
            );
        }
        for k in 0..outline.vertices.len() {
            let next = outline.vertices[(k + 1) % outline.vertices.len()];
            assert!(edges.insert([outline.vertices[k], next]), "no edge twice");
        }
    }
    let edges: Vec<[u32; 2]> = edges.into_iter().collect();
    if edges.len() > 400 {
        return;
    }
    for (k, one) in edges.iter().enumerate() {
        for other in &edges[..k] {
            let [[a, b], [c, d]] = [one, other].map(|ends| ends.map(|v| positions[v as usize]));
            let apart = |a, b, c, d| side(a, b, c) * side(a, b, d) != -1.0;
            assert!(
                apart(a, b, c, d) || apart(c, d, a, b),
                "{a} {b} crosses {c} {d}"
            );
        }
    }
}

/// The numbers of pieces, and of bounded parts of the plane outside each of them, connected across
/// edges: by flood fill over the triangles.
fn counted(triangulation: &Triangulation) -> [usize; 2] {
    let triangles = &triangulation.triangles;
    let mut by_edge = HashMap::new();
    for (triangle, corners) in triangles.iter().enumerate() {
        for k in 0..3 {
            by_edge.insert([corners[k], corners[(k + 1) % 3]], triangle);
        }
    }
    // The part that is connected with a triangle through accepted triangles, and whether it ends
    // before the hull.
    let part = |start: usize, accept: &dyn Fn(usize) -> bool| {
        let mut members = HashSet::from([start]);
        let mut open = vec![start];
        let mut is_bounded = true;
        while let Some(triangle) = open.pop() {
            let corners = triangles[triangle];
            for k in 0..3 {
                match by_edge.get(&[corners[(k + 1) % 3], corners[k]]) {
                    None => is_bounded = false,
                    Some(&next) => {
                        if accept(next) && members.insert(next) {
                            open.push(next);
                        }
                    }
                }
            }
        }
        (members, is_bounded)
    };
    let mut counts = [0, 0];
    let mut is_seen = HashSet::new();
    for start in 0..triangles.len() {
        if triangulation.is_inside[start] && !is_seen.contains(&start) {
            counts[0] += 1;
            let (piece, _) = part(start, &|next| triangulation.is_inside[next]);
            let mut rest: HashSet<usize> = (0..triangles.len())
                .filter(|t| !piece.contains(t))
                .collect();
            while let Some(&start) = rest.iter().next() {
                let (hole, is_bounded) = part(start, &|next| !piece.contains(&next));
                rest.retain(|triangle| !hole.contains(triangle));
                counts[1] += usize::from(is_bounded);
            }
            is_seen.extend(piece);
        }
    }
    counts
}

/// Families of curves that are hard to arrange.
pub(crate) const FAMILIES: usize = 12;

/// Curves of one of the [`FAMILIES`].
pub(crate) fn hard(family: usize, random: &mut Random) -> Curves {
    let count = 1 + random.below(4);
    (0..count)
        .map(|_| {
            let corners = 3 + random.below(14);
            (0..corners)
                .map(|k| corner(family, k, corners, random))
                .collect()
        })
        .collect()
}

fn corner(family: usize, k: usize, corners: usize, random: &mut Random) -> DVec2 {
    let mut integer = |size: i32| f64::from(random.below(2 * size as usize + 1) as i32 - size);
    // On a grid with 2^40 cells from the centre to the farthest point, where the farthest are the
    // corners at +-1.
    let cell = (-40.0_f64).exp2();
    match family {
        // Anywhere.
        0 => DVec2::new(integer(1 << 20), integer(1 << 20)) / f64::from(1 << 20),
        // On a coarse grid: touching, overlapping, collinear.
        1 => DVec2::new(integer(3), integer(3)),
        2 => DVec2::new(integer(8), integer(8)),
        // Nearly so.
        3 => DVec2::new(integer(3), integer(3)) + 1e-9 * DVec2::new(integer(9), integer(9)),
        // Nearly so, by a few cells.
        4 => DVec2::new(integer(1), integer(1)) + cell * DVec2::new(integer(3), integer(3)),
        // A star of lines through one point.
        5 => {
            let way = DVec2::new(integer(5), integer(5));
            if k.is_multiple_of(2) {
                way
            } else {
                -way * integer(2)
            }
        }
        // On one line, and nearly so.
        6 => DVec2::splat(integer(9)),
        7 => DVec2::new(integer(9), 0.0) + 1e-12 * DVec2::new(integer(3), integer(3)),
        // All within a few cells, except for a corner far away.
        8 if k == 0 => DVec2::ONE,
        8 => cell * DVec2::new(integer(4), integer(4)),
        // Long segments that leave a few cells.
        9 if k.is_multiple_of(2) => DVec2::new(integer(1), integer(1)),
        9 => cell * DVec2::new(integer(3), integer(3)),
        // Regular polygons about a few centres: equal angles, common circles.
        10 => {
            let angle = std::f64::consts::TAU * k as f64 / corners as f64;
            DVec2::from_angle(angle) + DVec2::new(integer(1), 0.0)
        }
        // Steep and flat bundles of nearly parallel lines.
        _ => {
            let side = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
            DVec2::new(side, cell * integer(6) + 1e-3 * side * integer(1))
        }
    }
}
