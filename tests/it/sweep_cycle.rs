//! The sweep cycle and the untrimmed envelope: what the theory says about them, checked against
//! membership.

use crate::support;
use crate::support::random::pseudo_random;
use crate::support::shapes;
use crate::support::sweep::{general_affine, mesh, motion, screw, translation};
use glam::DVec3;
use steadysweep::body::Mesh;
use steadysweep::bounds::SurfaceTree;
use steadysweep::envelope::spatial::Budget;
use steadysweep::envelope::spatial::{Fold, Source, SweepCycle, envelope, sweep_cycle};
use steadysweep::membership::Membership;
use steadysweep::motion::{Generator, Motion, Span};

/// Exact signs only, with nothing simplified.
fn fine(tolerance: f64) -> Budget {
    Budget {
        fold: 0.0,
        merge: 1e-9,
        ..Budget::of(tolerance)
    }
}

/// Winding numbers of the cycle at random points against the number of time intervals inside the
/// body. Points within the sampling error of a sheet are left out; their number is returned.
fn check_winding(body: &Mesh, motion: &Motion, budget: &Budget, points: usize) -> usize {
    let SweepCycle {
        positions,
        triangles,
        errors,
        ..
    } = sweep_cycle(&body.transformed(motion.start_pose()), motion, budget)
        .expect("the cycle fits");
    let tree = SurfaceTree::new(&positions, &triangles);
    let membership = Membership::new(body, motion);
    let [low, high] = tree.bounds().expect("the cycle has triangles");
    let mut random = pseudo_random(7);
    let mut next = || random.next().expect("random numbers do not end");
    let mut near = 0;
    for _ in 0..points {
        let point = low + (high - low) * DVec3::new(next(), next(), next());
        // Sunk sheets deviate from the exact ones by a few errors, but only inside.
        if tree.distance_to_surface(point) <= 6.0 * errors.sampling + 1e-9 {
            near += 1;
            continue;
        }
        let intervals = membership.intervals(point);
        let winding = tree
            .winding_number(point)
            .expect("the point is off the surface");
        let count = i32::try_from(intervals.len()).expect("few intervals");
        // Fins raise the winding number of points that are inside at some time, and of no other.
        assert!(
            winding >= count && (winding >= 1) == (count >= 1),
            "at {point}: winding number {winding}, intervals {intervals:?}"
        );
    }
    near
}

fn screws() -> [Generator; 3] {
    [
        screw(DVec3::new(0.1, 0.0, 1.0), DVec3::X, 1.5, 0.4, 1.0),
        screw(DVec3::new(1.0, 0.0, 0.3), DVec3::Y, 2.0, 0.4, 0.6),
        screw(
            DVec3::new(0.3, 1.0, 0.0),
            DVec3::new(1.0, 0.3, 0.5),
            -2.0,
            0.2,
            1.0,
        ),
    ]
}

#[test]
fn the_winding_number_counts_the_intervals_of_one_span() {
    let bodies = [
        shapes::u_prism(0.3, 0.5),
        shapes::l_prism(0.3, 0.5),
        shapes::torus(1.0, 0.4, 16, 8),
    ];
    let motions = [
        screw(DVec3::Z, DVec3::new(0.2, 0.1, 0.0), 9.0, 0.7, 1.0),
        screw(DVec3::new(1.0, 0.2, 0.3), DVec3::X, 2.5, 0.3, 0.4),
        general_affine(),
        translation(0.7, 0.4, 0.2),
    ];
    for body in &bodies {
        for generator in motions {
            let near = check_winding(&mesh(body), &motion(&[generator]), &fine(4e-3), 400);
            assert!(
                near < 300,
                "most points test something, but {near} are near a sheet"
            );
        }
    }
}

#[test]
fn the_winding_number_counts_the_intervals_of_a_chain() {
    let [a, b, c] = screws();
    let still = translation(0.0, 0.0, 0.0);
    let chains: [&[Generator]; 5] = [
        &[a, b, c],
        &[translation(1.0, 0.0, 0.0), translation(0.0, 1.0, 0.0), a],
        &[a, a.scaled(-1.0)],
        &[a, still, b],
        &[screw(DVec3::Z, DVec3::X, 8.0, 0.1, 1.0), c],
    ];
    for body in [
        shapes::u_prism(0.3, 0.5),
        shapes::icosphere(1, 0.5, DVec3::new(0.2, 0.0, 0.1)),
    ] {
        for chain in chains {
            check_winding(&mesh(&body), &motion(chain), &fine(4e-3), 300);
        }
    }
}

#[test]
fn simplified_signs_never_raise_the_winding_number_from_zero() {
    let body = mesh(&shapes::bumpy_sphere(600));
    for generator in screws() {
        let (body, motion) = (&body, motion(&[generator]));
        let cycle = sweep_cycle(body, &motion, &Budget::of(0.02)).expect("the cycle fits");
        let tree = SurfaceTree::new(&cycle.positions, &cycle.triangles);
        let membership = Membership::new(body, &motion);
        let [low, high] = tree.bounds().expect("the cycle has triangles");
        let mut random = pseudo_random(3);
        let mut next = || random.next().expect("random numbers do not end");
        for _ in 0..2000 {
            let point = low + (high - low) * DVec3::new(next(), next(), next());
            let is_off = tree.distance_to_surface(point) > cycle.errors.sampling;
            if is_off && !membership.is_ever_inside(point) {
                assert!(
                    tree.winding_number(point) <= Some(0),
                    "outside at all times: {point}"
                );
            }
        }
    }
}

#[test]
fn sheets_stay_on_the_body_and_graze_it() {
    let body = mesh(&shapes::u_prism(0.3, 0.5));
    let spans = screws().map(|g| Span::new(g, 1.0).expect("a screw is a span"));
    let motion = Motion::from_spans(spans.to_vec()).expect("screws chain");
    let sheets = envelope(&body, &motion);
    assert!(
        sheets.iter().any(|s| s.fold == Fold::Inner),
        "a U has inner sheets"
    );
    let surface = SurfaceTree::new(body.positions(), body.triangles());
    for sheet in &sheets {
        let span = &motion.spans()[sheet.span];
        let faces = match sheet.source {
            Source::Edge(edge) => body.edges()[edge as usize].faces.to_vec(),
            Source::Face(face) => vec![face],
        };
        for (along, share) in [(0.0, 0.0), (0.3, 0.2), (0.5, 0.7), (1.0, 1.0)] {
            let point = sheet.point(&motion, along, share);
            let frame = span.flow().pose_at(share) * motion.joints()[sheet.span];
            let at_rest = frame.inverse().transform_point3(point);
            assert!(
                surface.distance_to_surface(at_rest) < 1e-12,
                "{sheet:?} leaves the body"
            );
            let velocity = span.flow().generator().velocity(point);
            let fluxes: Vec<f64> = faces
                .iter()
                .map(|&f| {
                    let [a, b, c] = body.triangles()[f as usize]
                        .map(|v| frame.transform_point3(body.positions()[v as usize]));
                    (b - a).cross(c - a).normalize().dot(velocity) / velocity.length()
                })
                .collect();
            let grazes = match fluxes[..] {
                [flux] => flux.abs() < 1e-9,
                [first, second] => first * second <= 1e-9,
                _ => false,
            };
            assert!(grazes, "fluxes {fluxes:?} on {sheet:?}");
        }
    }
}

#[test]
fn sheets_close_to_loops() {
    let body = mesh(&shapes::bumpy_sphere(1000));
    let motion = motion(&[screw(DVec3::Z, DVec3::new(-1.0, 0.2, 0.0), 2.0, 0.4, 0.7)]);
    let mut balance = std::collections::HashMap::<[u64; 3], i32>::new();
    for sheet in envelope(&body, &motion) {
        for (end, sign) in sheet.ends.iter().zip([1, -1]) {
            *balance
                .entry((*end + DVec3::ZERO).to_array().map(f64::to_bits))
                .or_default() += sign;
        }
    }
    assert!(
        balance.values().all(|&b| b == 0),
        "every end of a piece is the start of another, bit for bit"
    );
}

#[test]
fn corners_of_surviving_faces_keep_their_exact_coordinates() {
    let shape = shapes::mapped(shapes::l_prism(0.3, 0.5), |p| {
        p * 0.1 + DVec3::new(0.3, -0.07, 1.1)
    });
    let body = mesh(&shape);
    let motion = motion(&[screw(DVec3::Z, DVec3::new(-3.0, 0.0, 0.0), 0.9, 1.7, 1.0)]);
    let sweep = support::sweep::swept(&body, &motion, 1e-4);
    let places: std::collections::HashSet<[u64; 3]> = sweep
        .solid
        .positions()
        .iter()
        .map(|p| p.to_array().map(f64::to_bits))
        .collect();
    let end = motion.joints()[1];
    let kept = |frame: &dyn Fn(DVec3) -> DVec3| {
        body.positions()
            .iter()
            .filter(|&&p| places.contains(&frame(p).to_array().map(f64::to_bits)))
            .count()
    };
    // Far from the axis and rising, the lower face survives at the start and the upper one at the
    // end: 6 corners each.
    assert!(
        kept(&|p| p) >= 6,
        "only {} corners of the start",
        kept(&|p| p)
    );
    assert!(
        kept(&|p| end.transform_point3(p)) >= 6,
        "only {} corners of the end",
        kept(&|p| end.transform_point3(p))
    );
}
