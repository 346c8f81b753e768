//! Queries of a surface at rest, compared with going through all triangles one by one.

#![allow(clippy::cast_possible_truncation, reason = "indices into small lists")]

use crate::support::membership::{distance, distance_to_triangle, winding_number};
use crate::support::random::pseudo_random;
use crate::support::shapes::{self, Shape};
use glam::DVec3;
use std::collections::BTreeSet;
use steadysweep::bounds::{Location, SurfaceTree};

fn tree(shape: &Shape) -> SurfaceTree {
    SurfaceTree::new(&shape.0, &shape.1)
}

fn bodies() -> Vec<(&'static str, Shape)> {
    vec![
        (
            "box",
            shapes::cuboid(DVec3::new(-1.0, -0.5, -0.25), DVec3::new(1.0, 0.75, 0.5)),
        ),
        ("ball", shapes::icosphere(2, 1.0, DVec3::new(0.1, 0.2, 0.3))),
        ("torus", shapes::torus(1.0, 0.4, 16, 8)),
        ("cone", shapes::cone(1.0, 1.0, 8)),
        ("l", shapes::l_prism(0.25, 0.5)),
        ("u", shapes::u_prism(0.25, 0.5)),
        ("c", shapes::c_prism(0.5, 1.0, 1.0, 12, 0.5)),
        (
            "hole",
            shapes::box_with_hole(DVec3::new(2.0, 1.5, 1.0), 0.25),
        ),
        ("hollow", shapes::hollow_box(DVec3::splat(2.0), DVec3::ONE)),
        ("bumpy", shapes::bumpy_sphere(600)),
        (
            "overlapping",
            shapes::united(&[
                shapes::cuboid(DVec3::splat(-1.0), DVec3::splat(0.5)),
                shapes::cuboid(DVec3::splat(-0.5), DVec3::ONE),
                shapes::cuboid(DVec3::splat(-0.25), DVec3::splat(0.25)),
            ]),
        ),
    ]
}

/// Random points, points of a lattice (in the planes of faces, on edges and vertices), and points
/// on triangles.
fn points(shape: &Shape) -> Vec<DVec3> {
    let mut numbers = pseudo_random(5);
    let mut number = || numbers.next().expect("endless");
    let mut all = Vec::new();
    for _ in 0..400 {
        all.push(DVec3::new(number(), number(), number()) * 3.0 - 1.5);
        let corners =
            shape.1[(number() * shape.1.len() as f64) as usize].map(|k| shape.0[k as usize]);
        let (u, v) = (number(), number());
        all.extend([
            corners[0],
            corners[0].midpoint(corners[1]),
            corners[0].lerp(corners[1], u).lerp(corners[2], v),
        ]);
    }
    for i in 0..13 * 13 * 13 {
        all.push(
            DVec3::new(
                f64::from(i % 13),
                f64::from(i / 13 % 13),
                f64::from(i / 169),
            ) * 0.25
                - 1.5,
        );
    }
    all
}

#[test]
fn the_inside_test_agrees_with_solid_angles_off_the_surface_and_says_so_on_it() {
    for (name, shape) in &bodies() {
        let tree = tree(shape);
        let mut on_surface = 0;
        for point in points(shape) {
            match tree.winding_number(point) {
                None => {
                    assert!(
                        distance(shape, point) < 1e-15,
                        "{name}: {point:?} is not on the surface"
                    );
                    assert_eq!(tree.locate(point), Location::On, "{name}: {point:?}");
                    on_surface += 1;
                }
                // Solid angles decide nothing within rounding of the surface.
                Some(winding) if distance(shape, point) > 1e-12 => {
                    assert_eq!(winding, winding_number(shape, point), "{name}: {point:?}");
                    let expected = if winding >= 1 {
                        Location::Inside
                    } else {
                        Location::Outside
                    };
                    assert_eq!(tree.locate(point), expected, "{name}: {point:?}");
                }
                Some(_) => assert!(
                    distance(shape, point) > 0.0 || name != &"box",
                    "{name}: {point:?} is on the surface"
                ),
            }
        }
        assert!(
            on_surface >= 400,
            "{name}: the vertices alone are 400, not {on_surface}"
        );
    }
}

#[test]
fn a_vertex_an_edge_and_a_face_of_a_box_are_on_it_and_the_next_number_is_not() {
    let tree = tree(&shapes::cuboid(DVec3::splat(-1.0), DVec3::ONE));
    for point in [
        DVec3::ONE,
        DVec3::new(1.0, -1.0, 0.3),
        DVec3::new(0.1, 0.2, -1.0),
        DVec3::new(0.5, 0.5, 1.0),
    ] {
        assert_eq!(tree.locate(point), Location::On, "{point}");
    }
    for (axis, sign) in [
        (0, 1.0),
        (0, -1.0),
        (1, 1.0),
        (1, -1.0),
        (2, 1.0),
        (2, -1.0),
    ] {
        let mut point = DVec3::splat(0.25);
        point[axis] = sign * 1.0_f64.next_up();
        assert_eq!(
            tree.locate(point),
            Location::Outside,
            "just beyond axis {axis}, {sign}"
        );
        point[axis] = sign * 1.0_f64.next_down();
        assert_eq!(
            tree.locate(point),
            Location::Inside,
            "just within axis {axis}, {sign}"
        );
    }
}

#[test]
fn the_distance_is_that_to_the_nearest_triangle() {
    for (name, shape) in &bodies() {
        let tree = tree(shape);
        for point in points(shape)
            .into_iter()
            .step_by(3)
            .chain([DVec3::splat(1e3), DVec3::splat(-1e9)])
        {
            let (found, expected) = (tree.distance_to_surface(point), distance(shape, point));
            let error = (found - expected).abs();
            assert!(
                error <= 1e-15 * (10.0 + point.length()),
                "{name}: {found} for {expected} at {point:?}"
            );
        }
    }
    assert_eq!(
        SurfaceTree::new(&[], &[]).distance_to_surface(DVec3::ZERO),
        f64::INFINITY,
        "of nothing"
    );
}

#[test]
fn boxes_and_segments_find_every_triangle_near_and_few_others() {
    let shape = shapes::bumpy_sphere(2_000);
    let away = DVec3::new(1e6, -2e6, 3e6);
    for offset in [DVec3::ZERO, away] {
        let shape = shapes::mapped(shape.clone(), |p| p + offset);
        let tree = tree(&shape);
        let mut numbers = pseudo_random(7);
        let mut number = || numbers.next().expect("endless");
        let (mut near, mut visited) = (0, 0);
        for _ in 0..200 {
            let mut random =
                |size: f64| (DVec3::new(number(), number(), number()) * 2.0 - 1.0) * size;
            let (start, radius) = (offset + random(1.0), 0.1);
            let end = start + random(0.6);
            let mut in_box = BTreeSet::new();
            tree.for_each_in_box([start.min(end), start.max(end)], |triangle| {
                assert!(in_box.insert(triangle), "{triangle} came twice")
            });
            let mut by_segment = BTreeSet::new();
            tree.for_each_near_segment(start, end, radius, |triangle| {
                assert!(by_segment.insert(triangle), "{triangle} came twice")
            });
            for (index, triangle) in shape.1.iter().enumerate() {
                let corners = triangle.map(|corner| shape.0[corner as usize]);
                let [a, b, c] = corners;
                let meets = a.min(b).min(c).cmple(start.max(end)).all()
                    && a.max(b).max(c).cmpge(start.min(end)).all();
                assert!(
                    !meets || in_box.contains(&(index as u32)),
                    "triangle {index} meets the box"
                );
                let gap = (0..=10)
                    .map(|k| distance_to_triangle(corners, start.lerp(end, 0.1 * f64::from(k))));
                let is_near = gap.fold(f64::INFINITY, f64::min) <= radius;
                assert!(
                    !is_near || by_segment.contains(&(index as u32)),
                    "triangle {index} is near the segment"
                );
                near += usize::from(is_near);
            }
            visited += by_segment.len();
        }
        assert!(near > 1_000, "{near} are too few to mean anything");
        assert!(
            visited < 4 * near,
            "{visited} visited, {near} near, at {offset}"
        );
    }
}

#[test]
fn the_bounds_contain_the_surface_and_little_more() {
    for (name, shape) in &bodies() {
        let [min, max] = tree(shape).bounds().expect("there are triangles");
        for &point in &shape.0 {
            assert!(
                point.cmpge(min).all() && point.cmple(max).all(),
                "{name}: {point:?}"
            );
        }
        let least = shape
            .0
            .iter()
            .fold(DVec3::INFINITY, |least, &p| least.min(p));
        assert!(
            (least - min).max_element() < 1e-6,
            "{name}: {min} for {least}"
        );
    }
    assert_eq!(SurfaceTree::new(&[], &[]).bounds(), None, "of nothing");
}

#[test]
fn tiny_and_huge_bodies_are_resolved_alike() {
    for unit in [1e-80, 1e-40, 1e-3, 1e6, 1e30, 1e80] {
        let shape = shapes::mapped(shapes::torus(1.0, 0.4, 16, 8), |p| unit * p);
        let tree = tree(&shape);
        assert_eq!(
            tree.locate(DVec3::X * unit),
            Location::Inside,
            "unit {unit:e}"
        );
        assert_eq!(tree.locate(DVec3::ZERO), Location::Outside, "unit {unit:e}");
        let mut found = 0;
        tree.for_each_in_box([DVec3::splat(0.9 * unit), DVec3::splat(2.0 * unit)], |_| {
            found += 1
        });
        assert_eq!(
            found, 0,
            "the corner of the box around a torus is empty, unit {unit:e}"
        );
    }
}

#[test]
fn a_tree_that_is_built_in_parts_finds_each_triangle_once() {
    // 131,072 triangles: more than are built at once.
    let shape = shapes::torus(3.0, 1.0, 512, 128);
    let (tree, (positions, triangles)) = (tree(&shape), &shape);
    let everything = [DVec3::splat(-5.0), DVec3::splat(5.0)];
    let mut all = Vec::new();
    tree.for_each_in_box(everything, |triangle| all.push(triangle));
    all.sort_unstable();
    assert!(all.iter().copied().eq(0..triangles.len() as u32), "once");
    let mut numbers = pseudo_random(11);
    let mut number = || numbers.next().expect("endless");
    for _ in 0..20 {
        let low = DVec3::new(number(), number(), number()) * 8.0 - 4.5;
        let high = low + DVec3::new(number(), number(), number());
        let mut found = BTreeSet::new();
        tree.for_each_in_box([low, high], |triangle| assert!(found.insert(triangle)));
        for (triangle, corners) in (0..).zip(triangles) {
            let [a, b, c] = corners.map(|v| positions[v as usize]);
            let (least, most) = (a.min(b).min(c), a.max(b).max(c));
            if least.cmple(high).all() && most.cmpge(low).all() {
                assert!(found.contains(&triangle), "{triangle} is missing");
            }
        }
        let (found, expected) = (tree.distance_to_surface(low), distance(&shape, low));
        assert!(
            (found - expected).abs() < 1e-12,
            "{found}, not {expected}, from {low}"
        );
    }
}
