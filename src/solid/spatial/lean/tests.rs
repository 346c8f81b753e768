use super::*;
use crate::bounds::SurfaceTree;
use crate::samples::{cuboid, drum, random};
use crate::surface::{Sides, is_closed};
use crate::watch::unwatched;

/// [`super::lean`] without a watch.
fn lean(positions: &[DVec3], triangles: &[[u32; 3]], allowed: f64) -> Lean {
    unwatched(|work| super::lean(positions, triangles, allowed, work))
}

/// A drum with bumps, so that it is flat nowhere.
fn bumpy_drum() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let drum = drum(96, 24);
    let bumpy = |p: &DVec3| {
        let wave = |x: f64| (3.0 * x).sin();
        *p + 0.1 * DVec3::new(wave(p.y), wave(p.z), wave(p.x))
    };
    let positions = drum.positions().iter().map(bumpy).collect();
    (positions, drum.triangles().to_vec())
}

/// The largest distance of points spread over the triangles of a surface from another one.
fn farthest(positions: &[DVec3], from: &[[u32; 3]], to: &[[u32; 3]]) -> f64 {
    let tree = SurfaceTree::new(positions, to);
    let mut numbers = random(3);
    let mut number = move || numbers().abs();
    let mut farthest: f64 = 0.0;
    for corners in from {
        let [a, b, c] = corners.map(|v| positions[v as usize]);
        for _ in 0..10 {
            let point = a.lerp(b, number()).lerp(c, number());
            farthest = farthest.max(tree.distance_to_surface(point));
        }
    }
    farthest
}

/// Edges between faces that differ by more than 30 degrees.
fn sharp_edges(positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<[DVec3; 2]> {
    let normal = |half: u32| {
        let [a, b, c] = triangles[half as usize / 3].map(|v| positions[v as usize]);
        (b - a).cross(c - a).normalize_or_zero()
    };
    let sides = Sides::new(triangles);
    let is_sharp = |[there, back]: [u32; 2]| normal(there).dot(normal(back)) < 0.866;
    let sharp = sides
        .edges()
        .filter(|edge| edge.pair().is_some_and(is_sharp));
    sharp
        .map(|edge| edge.ends.map(|v| positions[v as usize]))
        .collect()
}

#[test]
fn both_surfaces_are_within_the_stated_error_of_each_other() {
    let (positions, triangles) = bumpy_drum();
    let mut fewest = triangles.len();
    for allowed in [1e-3, 3e-3, 1e-2, 3e-2] {
        let lean = lean(&positions, &triangles, allowed);
        assert!(lean.error <= allowed, "{} of {allowed}", lean.error);
        assert!(is_closed(&lean.triangles), "closed");
        let there = farthest(&positions, &triangles, &lean.triangles);
        let back = farthest(&positions, &lean.triangles, &triangles);
        assert!(
            there.max(back) <= lean.error,
            "{there} and {back}, stated {}",
            lean.error
        );
        let meetings = SurfaceTree::new(&positions, &lean.triangles).meetings();
        assert!(meetings.is_empty(), "{meetings:?}");
        assert!(lean.triangles.len() < fewest, "fewer at {allowed}");
        fewest = lean.triangles.len();
    }
    assert!(
        fewest < triangles.len() / 8,
        "{fewest} of {}",
        triangles.len()
    );
}

/// All rings of a drum but the first and the last lie on straight lines, and its ends are flat.
#[test]
fn what_is_flat_needs_no_vertices_inside() {
    let drum = drum(24, 10);
    let lean = lean(drum.positions(), drum.triangles(), 1e-9);
    assert!(lean.error < 1e-12, "{:e}", lean.error);
    assert_eq!(
        lean.triangles.len(),
        2 * 24 + 2 * 22,
        "the wall and the ends"
    );
}

#[test]
fn sharp_edges_stay_where_they_are() {
    let drum = drum(200, 4);
    let positions = drum.positions();
    let lean = lean(positions, drum.triangles(), 0.01);
    let sharp = sharp_edges(positions, &lean.triangles);
    assert!((20..100).contains(&sharp.len()), "{} edges", sharp.len());
    for [a, b] in sharp_edges(positions, drum.triangles()) {
        let middle = a.midpoint(b);
        let distances = sharp
            .iter()
            .map(|&ends| crate::numeric::closest::distance_to_segment(ends, middle));
        let nearest = distances.fold(f64::INFINITY, f64::min);
        assert!(nearest <= 1.5 * lean.error, "{nearest} at {middle}");
    }
}

/// The roof over a cube goes unless something is in its way.
#[test]
fn nothing_is_passed_over_or_met() {
    let (mut positions, mut triangles) = cuboid(DVec3::ZERO, DVec3::ONE);
    triangles.retain(|t| !t.iter().all(|&v| v >= 4));
    positions.push(DVec3::new(0.5, 0.5, 1.05));
    triangles.extend([[4, 5, 8], [5, 7, 8], [7, 6, 8], [6, 4, 8]]);
    assert_eq!(lean(&positions, &triangles, 0.1).triangles.len(), 12);
    assert_eq!(
        lean(&positions, &triangles, 0.04).triangles.len(),
        14,
        "too high"
    );
    // A cavity between the roof and the cube, one that reaches into the cube, and one below.
    for (height, size, left) in [(1.02, 0.005, 14), (1.0, 0.02, 14), (0.5, 0.1, 12)] {
        let first = index(positions.len());
        let (mut all, mut faces) = (positions.clone(), triangles.clone());
        let centre = DVec3::new(0.45, 0.52, height);
        let corners = [
            [1.0, 1.0, 1.0],
            [1.0, -1.0, -1.0],
            [-1.0, 1.0, -1.0],
            [-1.0, -1.0, 1.0],
        ];
        all.extend(corners.map(|corner| centre + size * DVec3::from_array(corner)));
        let inwards = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        faces.extend(inwards.map(|t| t.map(|v| first + v)));
        let lean = lean(&all, &faces, 0.1);
        assert_eq!(lean.triangles.len(), left + 4, "a cavity at {height}");
    }
}

#[test]
fn a_surface_of_nothing_stays_so() {
    let nothing = lean(&[], &[], 1.0);
    assert_eq!((nothing.triangles.len(), nothing.error), (0, 0.0));
}
