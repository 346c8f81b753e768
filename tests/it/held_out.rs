//! Volumes known in closed form, or from references that share nothing with the sweep. None was
//! used for tuning.

#![allow(clippy::cast_possible_truncation, reason = "indices into small lists")]

use crate::support::shapes::{self, Shape};
use crate::support::sweep::{case, mesh, motion, screw, swept};
use glam::{DMat3, DVec3};
use manifold_rust::linalg::Vec3;
use manifold_rust::manifold::Manifold;
use manifold_rust::types::{Error, OpType};
use std::f64::consts::{PI, TAU};
use steadysweep::motion::Generator;
use steadysweep::{Simplify, Sweep, SweepSettings};

fn tilted(shape: Shape, angle: f64) -> Shape {
    let rotation = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 0.5).normalize(), angle);
    shapes::mapped(shape, |p| rotation * p)
}

/// With all triangles of the sampling, which may be exact where its bound is not zero.
fn sweep_at_default_tolerance(shape: &Shape, generator: Generator) -> Sweep {
    steadysweep::sweep(
        &mesh(shape),
        &motion(&[generator]),
        &SweepSettings::default().with_simplify(Simplify::Off),
    )
    .expect("a legal sweep succeeds")
}

/// Checks that the volume of a sweep lies in `[low, high]`, widened by the stated bounds, and
/// returns it.
fn volume_within(sweep: &Sweep, [low, high]: [f64; 2]) -> f64 {
    let (measures, bound) = (sweep.solid.measures(), sweep.error_bound);
    let low = low - bound.inside.length * measures.area;
    let high = high + bound.outside.length * measures.area;
    assert!(
        low <= measures.volume && measures.volume <= high,
        "{} not in [{low}, {high}] at {}",
        measures.volume,
        sweep.tolerance
    );
    measures.volume
}

/// Checks that the error at the finer of two tolerances, a tenth of the other, is at most a quarter
/// of the other error, unless lost in rounding.
fn assert_falling(name: &str, coarse: f64, fine: f64, exact: f64) {
    let (coarse, fine) = ((coarse - exact).abs(), (fine - exact).abs());
    assert!(
        fine <= coarse / 4.0 || fine < 1e-12 * exact,
        "{name}: error {coarse:e}, then {fine:e} at a tenth of the tolerance"
    );
}

#[test]
fn a_translated_convex_body_gains_its_shadow_times_the_way() {
    let bodies = [
        (
            "cube",
            shapes::cuboid(DVec3::splat(-0.5), DVec3::splat(0.5)),
        ),
        (
            "tilted box",
            tilted(shapes::cuboid(DVec3::ZERO, DVec3::new(1.0, 0.2, 3.0)), 0.7),
        ),
        ("ball", shapes::icosphere(3, 0.7, DVec3::new(0.3, 0.0, 0.1))),
        ("cone", shapes::cone(0.5, 1.3, 31)),
    ];
    let ways = [
        DVec3::new(1.5, 0.6, 0.3),
        DVec3::new(0.0, 0.0, -2.0),
        DVec3::new(-0.01, 0.02, 0.005),
        DVec3::new(3.0, -7.0, 11.0),
    ];
    for (name, shape) in &bodies {
        for unit in [1e-3, 1.0, 1e6] {
            let shape = shapes::mapped(shape.clone(), |p| p * unit);
            for way in ways.map(|way| way * unit) {
                let body = mesh(&shape);
                // Half the total: each line through a convex body enters once and leaves once.
                let gained: f64 = shape
                    .1
                    .iter()
                    .map(|t| t.map(|v| shape.0[v as usize]))
                    .map(|[a, b, c]| (b - a).cross(c - a).dot(way).abs() / 4.0)
                    .sum();
                let expected = body.volume() + gained;
                let solid = sweep_at_default_tolerance(&shape, Generator::translation(way)).solid;
                let measures = solid.measures();
                assert!(
                    (measures.volume / expected - 1.0).abs() < 1e-12,
                    "{name} by {way}: {} instead of {expected}",
                    measures.volume
                );
                assert_eq!(
                    [measures.components, measures.voids, measures.genus],
                    [1, 0, 0],
                    "{name} by {way} is a ball in topology"
                );
            }
        }
    }
}

/// The union of the body and the prisms over all its triangles, one by one, by another library.
fn union_of_prisms(shape: &Shape, way: DVec3) -> f64 {
    let to_vec3 = |p: DVec3| Vec3::new(p.x, p.y, p.z);
    let prisms = shape.1.iter().filter_map(|t| {
        let corners = t.map(|v| shape.0[v as usize]);
        let rise = (corners[1] - corners[0])
            .cross(corners[2] - corners[0])
            .dot(way);
        let points: Vec<Vec3> = corners
            .iter()
            .flat_map(|&p| [to_vec3(p), to_vec3(p + way)])
            .collect();
        // A point that leaves the body leaves it through a face that faces along the displacement.
        (rise > 1e-12).then(|| Manifold::hull(&points))
    });
    let body = manifold_rust::types::MeshGL64 {
        num_prop: 3,
        vert_properties: shape.0.iter().flat_map(DVec3::to_array).collect(),
        tri_verts: shape.1.iter().flatten().map(|&v| u64::from(v)).collect(),
        ..Default::default()
    };
    let mut parts = vec![Manifold::from_mesh_gl64_robust(&body)];
    parts.extend(prisms);
    let union = Manifold::batch_boolean(&parts, OpType::Add);
    assert!(
        union.status() == Error::NoError,
        "the reference must succeed"
    );
    union.volume()
}

#[test]
fn any_translated_body_is_the_union_of_its_triangle_prisms() {
    let bodies = [
        ("u", shapes::u_prism(0.25, 0.5)),
        ("l", tilted(shapes::l_prism(0.3, 0.5), 0.4)),
        ("torus", shapes::torus(1.0, 0.3, 12, 8)),
        (
            "hollow box",
            shapes::hollow_box(DVec3::ONE, DVec3::new(0.5, 0.6, 0.4)),
        ),
        ("c", tilted(shapes::c_prism(0.4, 0.8, 0.9, 10, 0.5), 0.2)),
        ("cup", shapes::cup(0.2)),
    ];
    for (name, shape) in &bodies {
        for way in [DVec3::new(0.3, 0.17, 0.22), DVec3::new(-0.4, 0.9, 1.7)] {
            let sweep = sweep_at_default_tolerance(shape, Generator::translation(way));
            let (found, expected) = (sweep.solid.measures().volume, union_of_prisms(shape, way));
            // The other library joins points nearer than some 1e-12 of the size.
            assert!(
                (found / expected - 1.0).abs() < 1e-9,
                "{name} by {way}: {found} instead of {expected}"
            );
        }
    }
}

#[test]
fn a_cube_turned_by_90_degrees_about_its_own_axis_is_a_cylinder() {
    let cube = case("cube_quarter_turn");
    let volumes = [1e-2, 1e-3, 1e-4].map(|relative| {
        let sweep = cube.sweep(relative);
        // The chords of the corners' arcs are inside.
        assert!(
            sweep.solid.measures().volume <= PI / 2.0 + 1e-12,
            "{} more than the cylinder",
            sweep.solid.measures().volume
        );
        volume_within(&sweep, [PI / 2.0; 2])
    });
    assert_falling("quarter turn", volumes[0], volumes[1], PI / 2.0);
    assert_falling("quarter turn", volumes[1], volumes[2], PI / 2.0);
}

/// Least distance from `centre` to the faces of a ball around it.
fn inner_radius(shape: &Shape, centre: DVec3) -> f64 {
    shape
        .1
        .iter()
        .map(|t| t.map(|v| shape.0[v as usize] - centre))
        .map(|[a, b, c]| (b - a).cross(c - a).normalize().dot(a))
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn a_ball_on_a_helix_has_tube_volume() {
    let helix = case("ball_helix");
    let length = (3.0 * PI).hypot(3.0);
    let tube = |r: f64| PI * r * r * length + 4.0 / 3.0 * PI * r.powi(3);
    let bracket = [inner_radius(&helix.shape, DVec3::X), 0.3].map(tube);
    let [coarse, fine, finest] =
        [1e-2, 1e-3, 1e-4].map(|relative| volume_within(&helix.sweep(relative), bracket));
    assert_falling("helix", coarse, fine, finest);
}

#[test]
fn a_shrinking_ball_on_a_spiral_has_the_volume_of_a_canal() {
    let spiral = case("ball_log_spiral");
    // The centre is at distance e^(kt), k = ln .6, turning by 3 t; the radius is r e^(kt). Along
    // the path, the radius changes at the constant rate q = r k / |(k, 3)|. So the balls touch the
    // canal surface along discs of radius R sqrt(1 - q^2), a distance -R q ahead of their centres;
    // the discs sweep the volume between the two caps.
    let rate = 0.6f64.ln();
    let speed = rate.hypot(3.0);
    let canal = |r: f64| {
        let q = r * rate / speed;
        let cubes = (0.6f64.powi(3) - 1.0) / (3.0 * rate);
        // Integral of pi R^2 (1 - q^2) (1 - (R R')') ds; R = r e^(kt), ds = speed e^(kt) dt,
        // R' = q, (R R')' = q^2.
        let between = PI * r * r * (1.0 - q * q) * (1.0 - q * q) * speed * cubes;
        // Volume of a ball of radius 1 on one side of a plane at distance h from its centre: the
        // side of the centre.
        let cap = |h: f64| PI * (2.0 / 3.0 + h - h.powi(3) / 3.0);
        between + r.powi(3) * (cap(-q) + 0.6f64.powi(3) * cap(q))
    };
    let bracket = [inner_radius(&spiral.shape, DVec3::X), 0.3].map(canal);
    let [coarse, fine, finest] =
        [1e-2, 1e-3, 1e-4].map(|relative| volume_within(&spiral.sweep(relative), bracket));
    assert_falling("spiral", coarse, fine, finest);
}

#[test]
fn a_convex_body_that_grows_is_the_hull_of_its_two_ends() {
    let bodies = [
        shapes::icosphere(2, 0.3, DVec3::X),
        tilted(shapes::cuboid(DVec3::new(0.5, 0.5, 0.5), DVec3::ONE), 0.3),
        shapes::cone(0.5, 1.0, 12),
    ];
    for shape in &bodies {
        for scale in [0.6, 1.7] {
            let through = DVec3::new(-0.2, 0.1, -0.4);
            let ends: Vec<Vec3> = shape
                .0
                .iter()
                .flat_map(|&p| [p, through + (p - through) * scale])
                .map(|p| Vec3::new(p.x, p.y, p.z))
                .collect();
            let expected = Manifold::hull(&ends).volume();
            let growing = screw(DVec3::Z, through, 0.0, 0.0, scale);
            let found = sweep_at_default_tolerance(shape, growing)
                .solid
                .measures()
                .volume;
            assert!(
                (found / expected - 1.0).abs() < 1e-9,
                "by {scale}: {found} instead of {expected}"
            );
        }
    }
}

#[test]
fn a_ball_on_a_whole_circle_is_a_torus_without_a_seam() {
    let turn = case("ball_full_turn");
    let inner = inner_radius(&turn.shape, DVec3::X);
    let bracket = [inner, 0.3].map(|r| 2.0 * PI * PI * r * r);
    let volumes = [1e-2, 1e-3].map(|relative| {
        let sweep = turn.sweep(relative);
        let (measures, bound) = (sweep.solid.measures(), sweep.error_bound);
        assert_eq!(
            [measures.components, measures.voids, measures.genus],
            [1, 0, 1],
            "a torus at {relative}"
        );
        // A trace of the ball at the closing pose would lie inside the tube.
        for p in sweep.solid.positions() {
            let from_circle = (p.x.hypot(p.y) - 1.0).hypot(p.z);
            assert!(
                inner - bound.inside.length <= from_circle
                    && from_circle <= 0.3 + bound.outside.length,
                "{p} is {from_circle} from the circle"
            );
        }
        volume_within(&sweep, bracket)
    });
    let finest = volume_within(&turn.sweep(1e-4), bracket);
    assert_falling("torus", volumes[0], volumes[1], finest);
}

#[test]
fn a_box_on_a_whole_circle_is_an_annular_cylinder() {
    let ring = case("cube_off_axis_full_turn");
    // The farthest points are the corners (2, +-1/2); the nearest is the middle of the face x = 1.
    let expected = PI * (4.25 - 1.0);
    let [coarse, fine] =
        [3e-2, 3e-3].map(|relative| volume_within(&ring.sampled(relative), [expected; 2]));
    assert_falling("ring", coarse, fine, expected);
}

#[test]
fn a_cube_on_a_square_path_is_a_frame() {
    let measures = *case("cube_square_path").sweep(1e-3).solid.measures();
    assert!((measures.volume - 8.0).abs() < 1e-12, "{}", measures.volume);
    assert_eq!(
        [measures.components, measures.voids, measures.genus],
        [1, 0, 1],
        "a frame"
    );
}

#[test]
fn a_span_forward_and_back_adds_nothing() {
    let body = mesh(&shapes::l_prism(0.3, 0.5));
    let way = DVec3::new(0.3, 0.9, 0.4);
    let once = swept(&body, &motion(&[Generator::translation(way)]), 1e-2);
    let both = [way, -way].map(Generator::translation);
    let twice = swept(&body, &motion(&both), 1e-2);
    let [once, twice] = [once, twice].map(|sweep| sweep.solid.measures().volume);
    assert!((once - twice).abs() < 1e-12, "{once} and {twice}");
}

#[test]
fn a_tolerance_beyond_the_body_counts_as_its_size() {
    let cube = mesh(&shapes::cuboid(DVec3::ZERO, DVec3::ONE));
    let turn = motion(&[screw(DVec3::Z, DVec3::X * 3.0, 1.5, 0.0, 1.0)]);
    let [huge, size] = [1e9, cube.diagonal()].map(|tolerance| {
        let settings = SweepSettings::default().with_tolerance(tolerance);
        steadysweep::sweep(&cube, &turn, &settings).expect("a legal sweep succeeds")
    });
    assert_eq!(huge.tolerance, cube.diagonal());
    assert_eq!(huge.solid.positions(), size.solid.positions());
}

#[test]
fn the_error_of_affine_motions_and_chains_stays_below_a_quarter_of_the_tolerance() {
    // Parts of the error have opposite signs, so it need not decrease from step to step; its bound
    // does.
    for name in ["l_shear", "torus_affine", "box_keyframes", "l_keyframes"] {
        let case = case(name);
        let [coarse, fine, finest] = [1e-2, 1e-3, 1e-4].map(|relative| case.sweep(relative));
        let exact = finest.solid.measures().volume;
        for sweep in [&coarse, &fine] {
            let measures = sweep.solid.measures();
            let error = (measures.volume - exact).abs();
            assert!(
                error <= 0.25 * sweep.tolerance * measures.area,
                "{name}: error {error:e} of the volume at tolerance {}",
                sweep.tolerance
            );
        }
    }
}

#[test]
fn units_from_a_thousandth_to_a_million_change_nothing_but_the_scale() {
    let whole = motion(&[screw(DVec3::Z, DVec3::ZERO, TAU / 3.0, 0.3, 0.8)]);
    let shape = shapes::mapped(shapes::u_prism(0.25, 0.5), |p| p + DVec3::X * 2.0);
    let expected = swept(&mesh(&shape), &whole, 1e-2).solid.measures().volume;
    for unit in [1e-3, 1e6] {
        let turn = motion(&[screw(DVec3::Z, DVec3::ZERO, TAU / 3.0, 0.3 * unit, 0.8)]);
        let body = mesh(&shapes::mapped(shape.clone(), |p| p * unit));
        let sweep = swept(&body, &turn, 1e-2 * unit);
        let bound = sweep.error_bound;
        let found = sweep.solid.measures();
        assert!(
            (found.volume - expected * unit.powi(3)).abs()
                <= (bound.inside.length + bound.outside.length) * found.area,
            "in units of {unit}: {} against {expected}",
            found.volume
        );
        assert!(
            found.watertight && found.manifold,
            "closed in units of {unit}"
        );
    }
}
