//! Procedural bodies: closed, oriented counter-clockwise from outside, as plain positions and
//! triangles.

use glam::{DVec2, DVec3};
use std::collections::HashMap;

/// #V positions and #F triples of indices.
pub(crate) type Shape = (Vec<DVec3>, Vec<[u32; 3]>);

/// The box [min, max]: 8 vertices, 12 triangles.
pub(crate) fn cuboid(min: DVec3, max: DVec3) -> Shape {
    let pick = |corner: u32, axis: usize| {
        if corner >> axis & 1 == 0 {
            min[axis]
        } else {
            max[axis]
        }
    };
    let positions = (0..8)
        .map(|corner| DVec3::new(pick(corner, 0), pick(corner, 1), pick(corner, 2)))
        .collect();
    // Corner k has the bits of k as x, y, z; each row runs counter-clockwise from outside.
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    (positions, faces.iter().flat_map(quad).collect())
}

/// A regular icosahedron, subdivided `subdivisions` times and pushed out to the sphere:
/// 20 * 4^subdivisions triangles.
pub(crate) fn icosphere(subdivisions: u32, radius: f64, centre: DVec3) -> Shape {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut positions = Vec::new();
    for (a, b) in [
        (1.0, golden),
        (-1.0, golden),
        (1.0, -golden),
        (-1.0, -golden),
    ] {
        positions.push(DVec3::new(a, b, 0.0));
        positions.push(DVec3::new(0.0, a, b));
        positions.push(DVec3::new(b, 0.0, a));
    }
    let mut triangles = Vec::new();
    for a in 0..12u32 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                let [p, q, r] = [a, b, c].map(|corner| positions[corner as usize]);
                let is_edge = |from: DVec3, to: DVec3| (from.distance(to) - 2.0).abs() < 1e-9;
                if is_edge(p, q) && is_edge(q, r) && is_edge(r, p) {
                    let outward = (q - p).cross(r - p).dot(p + q + r) > 0.0;
                    triangles.push(if outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    for _ in 0..subdivisions {
        let mut middles = HashMap::new();
        let mut finer = Vec::with_capacity(4 * triangles.len());
        for &[a, b, c] in &triangles {
            let mut middle = |from: u32, to: u32| {
                *middles
                    .entry((from.min(to), from.max(to)))
                    .or_insert_with(|| {
                        positions.push((positions[from as usize] + positions[to as usize]) / 2.0);
                        positions.len() as u32 - 1
                    })
            };
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        triangles = finer;
        for position in &mut positions {
            *position = position.normalize();
        }
    }
    let positions = positions
        .into_iter()
        .map(|position| centre + radius * position.normalize())
        .collect();
    (positions, triangles)
}

/// A torus about the z axis: `around` by `across` quads, `major` and `minor` radius.
pub(crate) fn torus(major: f64, minor: f64, around: u32, across: u32) -> Shape {
    let angle = |k: u32, n: u32| std::f64::consts::TAU * f64::from(k) / f64::from(n);
    let mut positions = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let (u, v) = (angle(i, around), angle(j, across));
            let ring = major + minor * v.cos();
            positions.push(DVec3::new(ring * u.cos(), ring * u.sin(), minor * v.sin()));
        }
    }
    let index = |i: u32, j: u32| i % around * across + j % across;
    let cells = (0..around).flat_map(|i| (0..across).map(move |j| (i, j)));
    let faces = cells.map(|(i, j)| {
        [
            index(i, j),
            index(i + 1, j),
            index(i + 1, j + 1),
            index(i, j + 1),
        ]
    });
    (positions, faces.flat_map(|face| quad(&face)).collect())
}

/// A simple counter-clockwise polygon in the plane, extruded from z = 0 to `height`.
pub(crate) fn prism(outline: &[DVec2], height: f64) -> Shape {
    let n = outline.len() as u32;
    let positions = [0.0, height]
        .iter()
        .flat_map(|&z| outline.iter().map(move |p| p.extend(z)))
        .collect();
    let mut triangles = Vec::new();
    for [a, b, c] in clip_ears(outline) {
        triangles.extend([[a, c, b], [a + n, b + n, c + n]]);
    }
    for i in 0..n {
        let j = (i + 1) % n;
        triangles.extend(quad(&[i, j, j + n, i + n]));
    }
    (positions, triangles)
}

/// An L of outer size 1 x 1 and arms of `thickness`, extruded by `height`.
pub(crate) fn l_prism(thickness: f64, height: f64) -> Shape {
    let t = thickness;
    prism(
        &outline(&[
            (0.0, 0.0),
            (1.0, 0.0),
            (1.0, t),
            (t, t),
            (t, 1.0),
            (0.0, 1.0),
        ]),
        height,
    )
}

/// A U of outer size 1 x 1, open towards +y, with walls of `thickness`, extruded by `height`.
pub(crate) fn u_prism(thickness: f64, height: f64) -> Shape {
    let (t, s) = (thickness, 1.0 - thickness);
    let points = [
        (0.0, 0.0),
        (1.0, 0.0),
        (1.0, 1.0),
        (s, 1.0),
        (s, t),
        (t, t),
        (t, 1.0),
        (0.0, 1.0),
    ];
    prism(&outline(&points), height)
}

/// An open ring about the z axis: radii `inner` and `outer`, open over `gap` radians about +x,
/// extruded by `height`.
pub(crate) fn c_prism(inner: f64, outer: f64, gap: f64, steps: u32, height: f64) -> Shape {
    let angle =
        |k: u32| gap / 2.0 + (std::f64::consts::TAU - gap) * f64::from(k) / f64::from(steps);
    let arc = |radius: f64| (0..=steps).map(move |k| radius * DVec2::from_angle(angle(k)));
    let mut points: Vec<DVec2> = arc(outer).collect();
    points.extend(arc(inner).collect::<Vec<_>>().into_iter().rev());
    prism(&points, height)
}

/// The box [-size/2, size/2] with a square hole of half width `hole` through it along z.
pub(crate) fn box_with_hole(size: DVec3, hole: f64) -> Shape {
    let h = size / 2.0;
    let square = |x: f64, y: f64, z: f64| {
        [(-x, -y), (x, -y), (x, y), (-x, y)].map(|(x, y)| DVec3::new(x, y, z))
    };
    // Rings of four: outer below, outer above, inner below, inner above.
    let rings = [
        square(h.x, h.y, -h.z),
        square(h.x, h.y, h.z),
        square(hole, hole, -h.z),
        square(hole, hole, h.z),
    ];
    let mut triangles = Vec::new();
    for i in 0..4 {
        let j = (i + 1) % 4;
        triangles.extend(quad(&[i, j, j + 4, i + 4]));
        triangles.extend(quad(&[j + 8, i + 8, i + 12, j + 12]));
        triangles.extend(quad(&[i + 4, j + 4, j + 12, i + 12]));
        triangles.extend(quad(&[j, i, i + 8, j + 8]));
    }
    (rings.concat(), triangles)
}

/// The box [-size/2, size/2] with the cavity [-cavity/2, cavity/2].
pub(crate) fn hollow_box(size: DVec3, cavity: DVec3) -> Shape {
    let inner = reversed(cuboid(-cavity / 2.0, cavity / 2.0));
    united(&[cuboid(-size / 2.0, size / 2.0), inner])
}

/// A sphere about the origin with smooth bumps, radius 0.8 to 1.2, of about `triangles` triangles
/// (at least 8).
pub(crate) fn bumpy_sphere(triangles: u32) -> Shape {
    // Two triangles per cell of a grid twice as wide as high, and one at the poles.
    let rows = ((f64::from(triangles) / 4.0).sqrt().round() as u32).max(2);
    let columns = 2 * rows;
    let place = |theta: f64, phi: f64| {
        let way = DVec3::new(
            theta.sin() * phi.cos(),
            theta.sin() * phi.sin(),
            theta.cos(),
        );
        way * (1.0
            + 0.1 * (7.0 * way.x).sin() * (5.0 * way.y).cos()
            + 0.1 * (9.0 * way.z + 2.0 * way.x).sin())
    };
    let mut positions = vec![place(0.0, 0.0)];
    for i in 1..rows {
        for j in 0..columns {
            let (theta, phi) = (
                f64::from(i) / f64::from(rows),
                f64::from(j) / f64::from(columns),
            );
            positions.push(place(
                std::f64::consts::PI * theta,
                std::f64::consts::TAU * phi,
            ));
        }
    }
    positions.push(place(std::f64::consts::PI, 0.0));
    let last = positions.len() as u32 - 1;
    let index = |i: u32, j: u32| 1 + (i - 1) * columns + j % columns;
    let mut faces = Vec::new();
    for j in 0..columns {
        faces.push([0, index(1, j), index(1, j + 1)]);
        faces.push([last, index(rows - 1, j + 1), index(rows - 1, j)]);
        for i in 1..rows - 1 {
            faces.extend(quad(&[
                index(i, j),
                index(i + 1, j),
                index(i + 1, j + 1),
                index(i, j + 1),
            ]));
        }
    }
    (positions, faces)
}

/// A cone with its base in the plane z = 0 and its tip at `height` on the z axis; `sides` facets
/// around.
pub(crate) fn cone(radius: f64, height: f64, sides: u32) -> Shape {
    let angle = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(sides);
    let mut positions: Vec<DVec3> = (0..sides)
        .map(|k| (radius * DVec2::from_angle(angle(k))).extend(0.0))
        .collect();
    positions.extend([DVec3::ZERO, DVec3::Z * height]);
    let triangles = (0..sides).flat_map(|i| {
        let j = (i + 1) % sides;
        [[sides, j, i], [i, j, sides + 1]]
    });
    (positions, triangles.collect())
}

/// The box [-1/2, 1/2]^3 with a pocket that is open towards +x: walls of `wall`.
pub(crate) fn cup(wall: f64) -> Shape {
    let (outer, inner) = (0.5, 0.5 - wall);
    let square = |x: f64, half: f64| {
        [(-half, -half), (half, -half), (half, half), (-half, half)]
            .map(|(y, z)| DVec3::new(x, y, z))
    };
    // Rings of four, counter-clockwise seen from +x: back, front, mouth, floor of the pocket.
    let rings = [
        square(-outer, outer),
        square(outer, outer),
        square(outer, inner),
        square(-inner, inner),
    ];
    let mut triangles = Vec::new();
    triangles.extend(quad(&[3, 2, 1, 0]));
    triangles.extend(quad(&[12, 13, 14, 15]));
    for i in 0..4 {
        let j = (i + 1) % 4;
        for ring in [0, 4, 8] {
            triangles.extend(quad(&[ring + i, ring + j, ring + j + 4, ring + i + 4]));
        }
    }
    (rings.concat(), triangles)
}

/// Several shapes as one.
pub(crate) fn united(shapes: &[Shape]) -> Shape {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for (more, faces) in shapes {
        let offset = positions.len() as u32;
        positions.extend(more);
        triangles.extend(faces.iter().map(|face| face.map(|corner| corner + offset)));
    }
    (positions, triangles)
}

/// The same surface with every triangle turned over.
pub(crate) fn reversed((positions, triangles): Shape) -> Shape {
    (
        positions,
        triangles.into_iter().map(|[a, b, c]| [a, c, b]).collect(),
    )
}

/// The shape with every position mapped.
pub(crate) fn mapped((positions, triangles): Shape, map: impl Fn(DVec3) -> DVec3) -> Shape {
    (positions.into_iter().map(map).collect(), triangles)
}

fn quad(&[a, b, c, d]: &[u32; 4]) -> [[u32; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

fn outline(points: &[(f64, f64)]) -> Vec<DVec2> {
    points.iter().map(|&(x, y)| DVec2::new(x, y)).collect()
}

/// Triangles of a simple counter-clockwise polygon, by ear clipping; quadratic at best, for small
/// outlines.
fn clip_ears(outline: &[DVec2]) -> Vec<[u32; 3]> {
    let mut ring: Vec<u32> = (0..outline.len() as u32).collect();
    let mut triangles = Vec::new();
    let at = |corner: u32| outline[corner as usize];
    let turn = |a: u32, b: u32, c: u32| (at(b) - at(a)).perp_dot(at(c) - at(a));
    while ring.len() > 3 {
        let n = ring.len();
        let ear = (0..n).find(|&k| {
            let (a, b, c) = (ring[(k + n - 1) % n], ring[k], ring[(k + 1) % n]);
            let covers =
                |p: u32| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
            turn(a, b, c) > 0.0
                && !ring
                    .iter()
                    .any(|&p| p != a && p != b && p != c && covers(p))
        });
        let k = ear.expect("a simple polygon has an ear");
        triangles.push([ring[(k + n - 1) % n], ring[k], ring[(k + 1) % n]]);
        ring.remove(k);
    }
    triangles.push([ring[0], ring[1], ring[2]]);
    triangles
}
