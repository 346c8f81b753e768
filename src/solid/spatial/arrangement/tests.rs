//! The region against an independent engine and against solid angles.

use super::{Cancelled, positive_region};
use crate::Fault;
use crate::numeric::index;
use crate::samples::cuboid;
use crate::surface::{Measures, Shells, measure};
use crate::watch::{Stop, Work};
use glam::{DMat3, DVec3};
use manifold_rust::manifold::Manifold;
use manifold_rust::types::{Error, MeshGL64, WindingRule};

type Soup = (Vec<DVec3>, Vec<[u32; 3]>);

/// The same region by another engine.
fn oracle((positions, triangles): &Soup) -> Soup {
    let surface = MeshGL64 {
        num_prop: 3,
        vert_properties: positions.iter().flat_map(DVec3::to_array).collect(),
        tri_verts: triangles.iter().flatten().map(|&v| u64::from(v)).collect(),
        ..MeshGL64::default()
    };
    let region = Manifold::from_mesh_gl64_robust(&surface).rebuild_solid(WindingRule::Positive);
    assert_eq!(region.status(), Error::NoError, "the other engine's state");
    let mesh = region.get_mesh_gl64(-1);
    let stride = usize::try_from(mesh.num_prop).expect("small").max(3);
    let positions = mesh
        .vert_properties
        .chunks_exact(stride)
        .map(|p| DVec3::new(p[0], p[1], p[2]))
        .collect();
    let vertices: Vec<u32> = mesh
        .tri_verts
        .iter()
        .map(|&v| u32::try_from(v).expect("small"))
        .collect();
    (
        positions,
        vertices
            .chunks_exact(3)
            .map(|t| [t[0], t[1], t[2]])
            .collect(),
    )
}

fn measured((positions, triangles): &Soup) -> Measures {
    measure(positions, triangles, &Shells::new(triangles))
}

/// The winding number of a closed surface around a point, by solid angles.
fn winding((positions, triangles): &Soup, point: DVec3) -> f64 {
    let total: f64 = triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| positions[v as usize] - point);
            let (l, m, n) = (a.length(), b.length(), c.length());
            let denominator = l * m * n + a.dot(b) * n + b.dot(c) * l + c.dot(a) * m;
            2.0 * f64::atan2(a.dot(b.cross(c)), denominator)
        })
        .sum();
    total / (4.0 * std::f64::consts::PI)
}

struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % n
    }

    fn unit(&mut self) -> f64 {
        self.below(1 << 40) as f64 / (1_u64 << 40) as f64
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }
}

fn torus(n: u32, m: u32, major: f64, minor: f64) -> Soup {
    let angle = |i: u32, n: u32| std::f64::consts::TAU * f64::from(i) / f64::from(n);
    let positions = (0..n * m)
        .map(|k| {
            let (a, b) = (angle(k / m, n), angle(k % m, m));
            let r = major + minor * b.cos();
            DVec3::new(r * a.cos(), r * a.sin(), minor * b.sin())
        })
        .collect();
    let at = |i: u32, j: u32| (i % n) * m + j % m;
    let triangles = (0..n * m)
        .map(|k| (k / m, k % m))
        .flat_map(|(i, j)| {
            [
                [at(i, j), at(i + 1, j), at(i + 1, j + 1)],
                [at(i, j), at(i + 1, j + 1), at(i, j + 1)],
            ]
        })
        .collect();
    (positions, triangles)
}

fn ball(n: u32, m: u32, centre: DVec3, radius: f64) -> Soup {
    let mut positions = vec![centre - DVec3::Z * radius, centre + DVec3::Z * radius];
    for i in 1..n {
        let polar = std::f64::consts::PI * f64::from(i) / f64::from(n);
        for j in 0..m {
            let a = std::f64::consts::TAU * f64::from(j) / f64::from(m);
            positions.push(
                centre
                    + radius
                        * DVec3::new(polar.sin() * a.cos(), polar.sin() * a.sin(), -polar.cos()),
            );
        }
    }
    let at = |i: u32, j: u32| 2 + (i - 1) * m + j % m;
    let mut triangles = Vec::new();
    for j in 0..m {
        triangles.push([0, at(1, j + 1), at(1, j)]);
        triangles.push([1, at(n - 1, j), at(n - 1, j + 1)]);
        for i in 1..n - 1 {
            triangles.push([at(i, j), at(i, j + 1), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i + 1, j)]);
        }
    }
    (positions, triangles)
}

fn together(parts: impl IntoIterator<Item = Soup>) -> Soup {
    let mut all = Soup::default();
    for (positions, triangles) in parts {
        let shift = index(all.0.len());
        all.0.extend(positions);
        all.1.extend(triangles.iter().map(|t| t.map(|v| v + shift)));
    }
    all
}

fn inverse((positions, triangles): Soup) -> Soup {
    let turned = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    (positions, turned)
}

fn moved((positions, triangles): Soup, place: impl Fn(DVec3) -> DVec3) -> Soup {
    (positions.into_iter().map(place).collect(), triangles)
}

fn boundary_of(positions: &[DVec3], triangles: &[[u32; 3]]) -> Result<Soup, Fault> {
    positive_region(
        positions,
        triangles,
        Cancelled::Dropped,
        None,
        Work::UNWATCHED,
    )
    .map(|region| region.boundary)
    .map_err(Stop::unwatched)
}

/// Compares with the other engine and with solid angles at random points.
fn check(name: &str, soup: &Soup) {
    let region = boundary_of(&soup.0, &soup.1).unwrap_or_else(|e| panic!("{name}: {e}"));
    let mut uses = std::collections::HashMap::<[u32; 2], [u32; 2]>::new();
    for t in &region.1 {
        for [a, b] in [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]] {
            uses.entry([a.min(b), a.max(b)]).or_default()[usize::from(a > b)] += 1;
        }
    }
    assert!(
        uses.values().all(|u| *u == [1, 1]),
        "{name}: a 2-manifold in its indices"
    );
    let ours = measured(&region);
    let theirs = measured(&oracle(soup));
    let size = (theirs.bounds[1] - theirs.bounds[0]).length().max(1e-300);
    assert!(
        (ours.volume - theirs.volume).abs() <= 1e-9 * theirs.volume + 1e-14 * size.powi(3),
        "{name}: volume {} against {}",
        ours.volume,
        theirs.volume
    );
    assert!(
        (ours.area - theirs.area).abs() <= 1e-9 * theirs.area + 1e-13 * size.powi(2),
        "{name}: area {} against {}",
        ours.area,
        theirs.area
    );
    assert!(ours.watertight, "{name}: closed");
    let (low, high) = (theirs.bounds[0], theirs.bounds[1]);
    let mut random = Random(88_172_645_463_325_252);
    for _ in 0..200 {
        let point = low + (random.vector() * 0.55 + 0.5) * (high - low);
        let (before, after) = (winding(soup, point), winding(&region, point));
        let expected = if before.round() >= 1.0 { 1.0 } else { 0.0 };
        // At a point on the surface, the sum of the solid angles is no integer.
        if (before - before.round()).abs() < 1e-6 {
            assert!(
                (after - expected).abs() < 1e-6,
                "{name}: {after} of {before} at {point}"
            );
        }
    }
    assert_eq!(
        (ours.components, ours.voids, ours.genus),
        (theirs.components, theirs.voids, theirs.genus),
        "{name}: components, voids, genus"
    );
    // The other engine drops corners of touching edges on one side, and then no longer sees that
    // they touch.
    assert!(
        ours.touching_edges > 0 || theirs.touching_edges == 0,
        "{name}: touches itself"
    );
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let soup = together((0..5).map(|i| {
        let turn = DMat3::from_axis_angle(DVec3::Z, f64::from(i) * 0.3);
        moved(torus(48, 24, 1.0, 0.4), |p| turn * p)
    }));
    let with_threads = |threads: usize| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads start")
            .install(|| boundary_of(&soup.0, &soup.1))
            .expect("a region")
    };
    let (positions, triangles) = with_threads(1);
    assert!(triangles.len() > 1000, "{} triangles", triangles.len());
    for threads in [2, 3, 8] {
        let (again, same) = with_threads(threads);
        assert_eq!(triangles, same, "triangles with {threads} threads");
        assert!(
            positions
                .iter()
                .zip(&again)
                .all(|(p, q)| { p.to_array().map(f64::to_bits) == q.to_array().map(f64::to_bits) }),
            "positions with {threads} threads"
        );
    }
}

#[test]
fn bad_input_is_an_error_and_not_a_panic() {
    let (mut positions, mut triangles) = unit_cube();
    triangles.pop();
    let refusal = boundary_of(&positions, &triangles).expect_err("an open surface");
    assert!(refusal.broken.contains("not closed"), "{refusal}");
    triangles.push([3, 7, 99]);
    let refusal = boundary_of(&positions, &triangles).expect_err("no vertex 99");
    assert!(refusal.broken.contains("no such vertex"), "{refusal}");
    positions[3].x = f64::NAN;
    let refusal = boundary_of(&positions, &triangles).expect_err("not a number");
    assert!(refusal.broken.contains("not finite"), "{refusal}");
    let nothing = boundary_of(&[], &[]).expect("nothing encloses nothing");
    assert!(nothing.1.is_empty(), "{nothing:?}");
}

#[test]
fn units_and_offsets_do_not_matter() {
    for scale in [1e-12, 1e-3, 1e6, 1e100] {
        let pair = together([
            unit_cube(),
            moved(unit_cube(), |p| p + DVec3::new(0.3, 0.4, 0.5)),
        ]);
        let (positions, triangles) = moved(pair, |p| (p + DVec3::new(100.0, 0.0, -7.0)) * scale);
        let region = boundary_of(&positions, &triangles).expect("a region");
        let volume = measured(&region).volume / scale / scale / scale;
        // 2 - 0.7 0.6 0.5; coordinates of 100 have a rounding of 1e-14, on areas of 6.
        assert!((volume - 1.79).abs() < 1e-12, "{volume} at {scale}");
    }
}

#[test]
fn flat_and_needle_triangles_bound_nothing() {
    // A box whose top has a needle triangle, with a corner on the diagonal of its face.
    let (mut positions, mut triangles) = unit_cube();
    positions.push(DVec3::new(0.5, 0.5, 1.0));
    triangles.retain(|t| *t != [4, 5, 6] && *t != [5, 7, 6]);
    triangles.extend([[4, 5, 6], [5, 7, 8], [7, 6, 8], [5, 8, 6]]);
    let soup = together([
        (positions, triangles),
        moved(unit_cube(), |p| p * 0.5 + 0.75),
    ]);
    check("needle", &soup);
    let flat = (
        vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X + DVec3::Y],
        vec![[0, 1, 2], [2, 1, 3], [0, 2, 1], [1, 2, 3]],
    );
    let nothing = boundary_of(&flat.0, &flat.1).expect("nothing");
    assert!(nothing.1.is_empty(), "{nothing:?}");
}

fn unit_cube() -> Soup {
    cuboid(DVec3::ZERO, DVec3::ONE)
}

#[test]
fn single_and_repeated_boxes() {
    check("box", &unit_cube());
    check("twice", &together([unit_cube(), unit_cube()]));
    check(
        "with its inverse and again",
        &together([unit_cube(), inverse(unit_cube()), unit_cube()]),
    );
    let (positions, triangles) = boundary_of(
        &together([unit_cube(), inverse(unit_cube())]).0,
        &together([unit_cube(), inverse(unit_cube())]).1,
    )
    .expect("nothing is a region");
    assert!(positions.is_empty() && triangles.is_empty(), "nothing");
}

#[test]
fn what_lies_outside_is_told() {
    // An inside-out box, half of it in another box: w is 0 where both are, and -1 in its other
    // half, whose walls all lie outside.
    let hole = inverse(moved(unit_cube(), |p| p + DVec3::X * 0.5));
    let (positions, triangles) = together([unit_cube(), hole]);
    let outside = positive_region(
        &positions,
        &triangles,
        Cancelled::Dropped,
        None,
        Work::UNWATCHED,
    )
    .expect("a region")
    .outside;
    let area = |[a, b, c]: &[DVec3; 3]| (*b - *a).cross(*c - *a).length() / 2.0;
    // Four half sides, the end, and the side of the other box that lies in it.
    let total: f64 = outside.iter().map(area).sum();
    assert!((total - 4.0).abs() < 1e-12, "{total}");
    assert!(outside.iter().flatten().all(|p| p.x >= 1.0), "{outside:?}");
}

#[test]
fn boxes_that_touch() {
    for (name, shift) in [
        ("face", DVec3::X),
        ("part of a face", DVec3::new(1.0, 0.5, 0.25)),
        ("edge", DVec3::new(1.0, 1.0, 0.0)),
        ("part of an edge", DVec3::new(1.0, 1.0, 0.5)),
        ("corner", DVec3::ONE),
        ("half", DVec3::X * 0.5),
        ("half twice", DVec3::new(0.5, 0.5, 0.0)),
        ("generic", DVec3::new(0.3, 0.4, 0.5)),
    ] {
        check(
            name,
            &together([unit_cube(), moved(unit_cube(), |p| p + shift)]),
        );
        check(
            name,
            &together([unit_cube(), inverse(moved(unit_cube(), |p| p + shift))]),
        );
    }
}

#[test]
fn boxes_on_integer_coordinates() {
    let mut random = Random(0x1234_5678_9abc_def1);
    for round in 0..60 {
        let number = 2 + random.below(if round % 6 == 0 { 29 } else { 8 });
        let size = 3 + random.below(5);
        let soup = together((0..number).map(|_| {
            let low = [0, 1, 2].map(|_| random.below(size));
            let high = low.map(|l| l + 1 + random.below(3));
            let [low, high] = [low, high].map(|p| DVec3::from_array(p.map(|x| x as f64)));
            let solid = cuboid(low, high);
            if random.below(5) == 0 {
                inverse(solid)
            } else {
                solid
            }
        }));
        check(&format!("integer boxes {round}"), &soup);
    }
}

#[test]
fn boxes_turned_at_random() {
    let mut random = Random(0xfeed_5678_9abc_def1);
    for round in 0..20 {
        let number = 2 + random.below(8);
        let soup = together((0..number).map(|_| {
            let turn = DMat3::from_axis_angle(random.vector().normalize(), random.unit() * 6.0);
            let shift = random.vector();
            moved(unit_cube(), |p| turn * p + shift)
        }));
        check(&format!("turned boxes {round}"), &soup);
    }
}

#[test]
fn balls_and_tori() {
    check("ball", &ball(8, 12, DVec3::ZERO, 1.0));
    check(
        "balls",
        &together([
            ball(8, 12, DVec3::ZERO, 1.0),
            ball(8, 12, DVec3::new(0.7, 0.2, 0.1), 1.0),
        ]),
    );
    check(
        "balls on an axis",
        &together([
            ball(8, 12, DVec3::ZERO, 1.0),
            ball(8, 12, DVec3::X * 0.5, 1.0),
        ]),
    );
    check("torus", &torus(24, 12, 1.0, 0.4));
    check(
        "crossed tori",
        &together([
            torus(24, 12, 1.0, 0.4),
            moved(torus(24, 12, 1.0, 0.4), |p| {
                DVec3::new(p.x + 0.9, p.z, -p.y)
            }),
        ]),
    );
    check(
        "inside",
        &together([
            ball(8, 12, DVec3::ZERO, 1.0),
            inverse(ball(6, 7, DVec3::ZERO, 0.5)),
            ball(5, 5, DVec3::ZERO, 0.2),
        ]),
    );
    check(
        "turned torus",
        &together((0..5).map(|i| {
            let turn = DMat3::from_axis_angle(DVec3::Z, f64::from(i) * 0.3);
            moved(torus(16, 8, 1.0, 0.4), |p| turn * p)
        })),
    );
}

#[test]
fn slivers_that_rounding_closes_leave_no_shells() {
    use crate::motion::{Generator, Motion, Span};
    let (positions, triangles) = unit_cube();
    let body = crate::body::Mesh::new(positions, triangles).expect("a body");
    let axis = DVec3::new(1.0, 2.0, 3.0).normalize();
    let turn = Generator::screw(axis, DVec3::ZERO, 60_f64.to_radians(), 0.0, 1.0);
    let motion = Motion::from_spans(vec![Span::new(turn, 1.0).expect("a span")]).expect("a motion");
    let settings = crate::SweepSettings::default().with_precision(crate::Precision::Double);
    let sweep = crate::sweep(&body, &motion, &settings).expect("a sweep");
    let measures = sweep.solid.measures();
    // The cube turns about an axis through its corner: sheets meet in needles along it. Handles
    // without thickness along these needles can remain (three here): only shells are removed.
    assert_eq!(
        (measures.components, measures.voids, measures.manifold),
        (1, 0, true),
        "one solid"
    );
}
