//! Sweeps in the plane: areas against closed forms, holes and pieces, and agreement with the exact
//! motion of points.

use crate::support::planar::{depth, disagreement, disc, motion, outline, polygon, star, swept};
use crate::support::random::pseudo_random;
use glam::{DAffine2, DMat2, DVec2};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::simplify::SimplifyShape;
use i_overlay::float::single::SingleFloatOverlay;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};
use steadysweep::body::Polygon;
use steadysweep::envelope::planar::PlanarBudget;
use steadysweep::envelope::planar::{SweepCycle, sweep_cycle};
use steadysweep::motion::planar::{Generator, Motion};
use steadysweep::planar::{Sweep, SweepError, SweepSettings, sweep};
use steadysweep::solid::planar::{Segment, arrange};

/// Checks area, pieces and holes at three tolerances, against bounds on the exact area.
fn check(body: &Polygon, motion: &Motion, area: [f64; 2], pieces: usize, holes: usize) {
    for relative in [1e-2, 1e-3, 1e-4] {
        let swept = swept(body, motion, relative);
        let found = &swept.measures;
        let bound = &swept.error_bound;
        // A layer along the boundary, including its corners, and holes of that size.
        let layer = |width: f64| found.perimeter * width + PI * width * width;
        assert!(
            found.area >= area[0] - layer(bound.inside.length)
                && found.area <= area[1] + layer(bound.outside.length),
            "{relative:e}: area {} instead of {area:?}",
            found.area
        );
        assert!(
            bound.inside.proven && bound.outside.proven,
            "both bounds are proven"
        );
        assert!(
            bound.inside.length <= swept.tolerance && bound.outside.length <= swept.tolerance,
            "{relative:e}: {bound:?}"
        );
        assert_eq!(
            (found.pieces, found.holes),
            (pieces, holes),
            "{relative:e}: pieces and holes"
        );
        // The slow method would take small steps along fine outlines that slide along themselves.
        let points = if body.edge_count() <= 60 { 200 } else { 0 };
        let defects = disagreement(body, motion, &swept, points);
        assert!(defects.is_empty(), "{relative:e}: {defects:#?}");
    }
}

fn turn(angle: f64, through: [f64; 2]) -> Motion {
    motion(&[Generator::spiral(DVec2::from_array(through), angle, 1.0)])
}

fn square() -> Vec<DVec2> {
    outline(&[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
}

#[test]
fn a_translated_square_is_exact() {
    let across = motion(&[Generator::translation(DVec2::new(3.0, 1.0))]);
    // The area, and the displacement times the width across it: 4 + 2 (3 + 1).
    check(&polygon(vec![square()]), &across, [12.0; 2], 1, 0);
}

#[test]
fn a_motion_as_small_as_rounding_is_in_the_proven_bounds() {
    // Poses this near count as the same. The right side ends at 4 + 2e-12, to the last bit.
    let factor = 1.0 + 0.5e-12;
    let corners = [[3.0, 3.0], [4.0, 3.0], [4.0, 4.0], [3.0, 4.0]];
    let square = polygon(vec![outline(&corners)]);
    for factor in [factor, 1.0 / factor] {
        let scaling = motion(&[Generator::spiral(DVec2::ZERO, 0.0, factor)]);
        let sweep = swept(&square, &scaling, 1e-3);
        let [low, high] = sweep.measures.bounds;
        let inside = sweep.error_bound.inside;
        let shortfall = (4.0 * factor.max(1.0) - high.x).max(low.x - 3.0 * factor.min(1.0));
        assert!(
            inside.proven && shortfall <= inside.length && inside.length < 1e-11,
            "short by {shortfall:e} at {inside:?}"
        );
    }
}

#[test]
fn a_body_at_rest_is_its_sweep() {
    let rest = motion(&[Generator::translation(DVec2::ZERO)]);
    check(&polygon(vec![square()]), &rest, [4.0; 2], 1, 0);
    let frame = vec![square(), disc(12, DVec2::ZERO, 0.5)];
    let area = 4.0 - 12.0 * 0.5 * 0.25 * (TAU / 12.0).sin();
    check(&polygon(frame), &rest, [area; 2], 1, 1);
}

#[test]
fn a_square_that_turns_about_its_centre_sweeps_a_disc() {
    for turns in [0.25, 1.0, 3.0] {
        let spin = turn(turns * TAU, [0.0; 2]);
        check(&polygon(vec![square()]), &spin, [TAU; 2], 1, 0);
    }
}

#[test]
fn a_needle_that_turns_about_its_end_sweeps_a_sector() {
    // The needle itself, with half of it on either side of the sector of its middle line.
    let needle = outline(&[[0.0, 0.0], [1.0, -1e-5], [1.0, 1e-5]]);
    check(
        &polygon(vec![needle]),
        &turn(1.0, [0.0; 2]),
        [0.5, 0.5 + 2e-5],
        1,
        0,
    );
}

#[test]
fn a_fine_disc_that_turns_about_its_centre_stays_a_disc() {
    for corners in [100, 1000] {
        let body = polygon(vec![disc(corners, DVec2::ZERO, 1.0)]);
        check(&body, &turn(1.0, [0.0; 2]), [body.area(), PI], 1, 0);
        check(&body, &turn(3.0 * TAU, [0.0; 2]), [PI; 2], 1, 0);
    }
}

#[test]
fn a_fine_disc_on_a_circle_sweeps_a_ring() {
    // The disc moves around a circle whose centre is 2 away: a ring of width 2, closed when it
    // comes round.
    let body = polygon(vec![disc(400, DVec2::new(2.0, 0.0), 0.5)]);
    let short_of = PI * 0.25 - body.area();
    check(
        &body,
        &turn(TAU, [0.0; 2]),
        [4.0 * PI * 0.99999, 4.0 * PI],
        1,
        1,
    );
    let half = 2.0 * PI + PI * 0.25;
    check(
        &body,
        &turn(PI, [0.0; 2]),
        [half - 10.0 * short_of, half],
        1,
        0,
    );
}

#[test]
fn a_fine_disc_along_a_logarithmic_spiral() {
    // A disc of radius r about c = X; it turns by the angle a and grows by S about the origin. With
    // M = ln S I + a J and the normal n = (cos f, sin f) the flux is n . M (c + r n) = ln S cos f +
    // a sin f + r ln S: egress for |f - tilt| < open. The area is the integral of p x dp / 2 over
    // four curves: the egress arc at the end, the path of its last point backwards, the ingress arc
    // at the start, and the path of the egress arc's first point. On a path p(t) = e^(tM) p, p x
    // dp/dt = a |p|^2 S^(2t).
    let (angle, scale, radius) = (2.0_f64, 1.6_f64, 0.2);
    let spiral = Generator::spiral(DVec2::ZERO, angle, scale);
    let centre = DVec2::X;
    let rate = scale.ln();
    let tilt = angle.atan2(rate);
    let open = (-radius * rate / rate.hypot(angle)).acos();
    let normal = DVec2::from_angle;
    let path = |f: f64| {
        let from = centre + radius * normal(f);
        0.5 * angle * from.length_squared() * (scale * scale - 1.0) / (2.0 * rate)
    };
    let arc = |f: f64, g: f64| {
        let along = centre.dot(normal(f).perp() - normal(g).perp());
        0.5 * radius * (along + radius * (g - f))
    };
    let area = scale * scale * arc(tilt - open, tilt + open) - path(tilt + open)
        + arc(tilt + open, tilt - open + TAU)
        + path(tilt - open);
    let body = polygon(vec![disc(2000, centre, radius)]);
    let share = body.area() / (PI * radius * radius);
    check(&body, &motion(&[spiral]), [area * share, area], 1, 0);
}

#[test]
fn a_sheared_triangle() {
    // The triangle (0,0) (1,1) (0,1) under the shear x' = x + 2 t y: every point moves to the right
    // by 2 y, so that the width at height y is y + 2 y.
    let body = polygon(vec![outline(&[[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]])]);
    let shear = Generator {
        linear: DMat2::from_cols(DVec2::ZERO, DVec2::new(2.0, 0.0)),
        offset: DVec2::ZERO,
    };
    check(&body, &motion(&[shear]), [1.5; 2], 1, 0);
}

#[test]
fn an_l_turned_leaves_a_hole() {
    // Its near leg is 1 away from the centre, and it makes a full turn: a ring.
    let ell = outline(&[
        [1.0, 0.0],
        [3.0, 0.0],
        [3.0, 0.5],
        [1.5, 0.5],
        [1.5, 2.0],
        [1.0, 2.0],
    ]);
    let far = 9.25;
    let body = polygon(vec![ell]);
    check(&body, &turn(TAU, [0.0; 2]), [PI * (far - 1.0); 2], 1, 1);
    // Two pieces that never meet.
    let two = vec![square(), disc(60, DVec2::new(10.0, 0.0), 1.0)];
    let [inner, ring] = [PI * 2.0, PI * (121.0 - 81.0)];
    let body = polygon(two);
    check(
        &body,
        &turn(TAU, [0.0; 2]),
        [inner + 0.998 * ring, inner + ring],
        2,
        1,
    );
}

/// An arc from one angle to another about a centre, without its last point, with edges at most
/// `sagitta` off.
fn arc(centre: DVec2, radius: f64, [from, to]: [f64; 2], sagitta: f64) -> Vec<DVec2> {
    let widest = 2.0 * (1.0 - sagitta / radius).acos();
    let steps = ((to - from).abs() / widest).ceil();
    let places = (0..).map(f64::from).take_while(|&i| i < steps);
    places
        .map(|i| centre + radius * DVec2::from_angle(from + (to - from) * i / steps))
        .collect()
}

/// The outline has half a circle of radius 18 about the origin on the left, one of 10 about (75, 0)
/// on the right, a bore of 8 about the origin, and a slot of width 8 between (30, 0) and (55, 0);
/// arcs are flattened as in drawings.
fn lever(relative: f64) -> Polygon {
    let sagitta = 0.1 * relative * 113.0;
    let quarter = 0.5 * PI;
    let joined = |arcs: [Vec<DVec2>; 2]| arcs.concat();
    let at = |x: f64| DVec2::new(x, 0.0);
    let end = |x: f64, radius: f64, from: f64| arc(at(x), radius, [from, from + PI], sagitta);
    // At the end of an arc, its last point is added as a separate corner.
    let top = |x: f64, y: f64| vec![DVec2::new(x, y)];
    polygon(vec![
        joined([
            [end(75.0, 10.0, -quarter), top(75.0, 10.0)].concat(),
            [end(0.0, 18.0, quarter), top(0.0, -18.0)].concat(),
        ]),
        arc(DVec2::ZERO, 8.0, [0.3, 0.3 + TAU], sagitta),
        joined([
            [end(55.0, 4.0, -quarter), top(55.0, 4.0)].concat(),
            [end(30.0, 4.0, quarter), top(30.0, -4.0)].concat(),
        ]),
    ])
}

/// Number of corners that turn by more than 150 degrees.
fn reversals(sweep: &Sweep) -> usize {
    let sharp = |outline: &Vec<DVec2>| {
        let at = |i: usize| outline[i % outline.len()];
        (0..outline.len())
            .filter(|&i| {
                let turn = (at(i + 1) - at(i)).angle_to(at(i + 2) - at(i + 1));
                turn.abs() > 150.0_f64.to_radians()
            })
            .count()
    };
    sweep.loops().map(|outline| sharp(&outline)).sum()
}

#[test]
fn arcs_about_the_centre_of_the_turn_leave_one_smooth_line() {
    // The lever turns by 75 degrees about its bore: the bore stays open, and the slot fills up. Its
    // sides dip into the circle of radius 18 between the angles 0 and 2 dip from its ends, where
    // tan(dip) = 8 / 75.
    let angle = 75.0_f64.to_radians();
    let dip = 8.0_f64.atan2(75.0);
    let side = 75.0_f64.hypot(8.0) - 2.0 * 18.0 * dip.sin();
    let outer = 85.0 * angle + 10.0 * PI + 2.0 * side + 18.0 * (PI - angle + 4.0 * dip);
    let expected = outer + 16.0 * PI;
    for relative in [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5] {
        let body = lever(relative);
        for start in [0.0, 0.4] {
            let placed = body.transformed(&DAffine2::from_angle(start));
            let swept = swept(&placed, &turn(angle, [0.0; 2]), relative);
            let found = &swept.measures;
            assert!(
                (found.perimeter / expected - 1.0).abs() < 0.2 * relative.sqrt(),
                "{relative:e}: {} for {expected}",
                found.perimeter
            );
            assert_eq!((found.pieces, found.holes), (1, 1), "{relative:e}");
            assert_eq!(reversals(&swept), 0, "{relative:e}");
            // At most the outline of the body twice, and the chords of the path of its tip.
            let chords = angle / (2.0 * (1.0 - 0.2 * swept.tolerance / 85.0).acos());
            let most = 2.0 * body.edge_count() as f64 + chords;
            assert!(
                (found.vertices as f64) < most,
                "{relative:e}: {} of {most}",
                found.vertices
            );
        }
    }
}

#[test]
fn drawn_arcs_leave_no_saw_teeth_wherever_the_centre_lies() {
    let bulge = |sagitta: f64| {
        let right = arc(DVec2::new(10.0, 5.0), 5.0, [-0.5 * PI, 0.5 * PI], sagitta);
        let half = (5.0_f64 / 6.25).asin();
        let left = arc(DVec2::new(-3.75, 5.0), 6.25, [half, -half], sagitta);
        polygon(vec![
            [right, vec![DVec2::new(10.0, 10.0)], left, vec![DVec2::ZERO]].concat(),
        ])
    };
    let cases: Vec<_> = [1e-2, 3e-3, 1e-3, 5e-4, 1e-4, 2e-5, 1e-5]
        .into_iter()
        .flat_map(|relative| {
            [
                (
                    bulge(0.1 * relative * 18.0),
                    turn(TAU / 3.0, [5.0, 5.0]),
                    relative,
                ),
                (lever(relative), turn(1.3, [-20.0, -30.0]), relative),
                (lever(relative), turn(2.4, [70.0, 0.0]), relative),
                (lever(relative), turn(2.4, [75.0, 0.0]), relative),
                (
                    lever(relative),
                    spiral_about(DVec2::new(30.0, 0.0)),
                    relative,
                ),
            ]
        })
        .collect();
    let defects: Vec<String> = cases
        .par_iter()
        .enumerate()
        .filter_map(|(case, (body, motion, relative))| {
            let swept = swept(body, motion, *relative);
            let reversals = reversals(&swept);
            (reversals > 0).then(|| {
                let found = &swept.measures;
                format!("{case}: {reversals} of {found:?}")
            })
        })
        .collect();
    assert!(defects.is_empty(), "{defects:#?}");
}

#[test]
fn chains_meet_without_a_seam() {
    let step = |x, y| Generator::translation(DVec2::new(x, y));
    let there_and_back = motion(&[step(3.0, 0.0), step(-3.0, 0.0)]);
    check(&polygon(vec![square()]), &there_and_back, [10.0; 2], 1, 0);
    // Around a square of side 4: 6 x 6 outside, and a hole of 2 x 2.
    let round = motion(&[
        step(4.0, 0.0),
        step(0.0, 4.0),
        step(-4.0, 0.0),
        step(0.0, -4.0),
    ]);
    check(&polygon(vec![square()]), &round, [32.0; 2], 1, 1);
    // A quarter of a turn in two halves, with a rest between them.
    let part = |angle| Generator::spiral(DVec2::ZERO, angle, 1.0);
    let parts = motion(&[part(0.25 * PI), step(0.0, 0.0), part(0.25 * PI)]);
    check(&polygon(vec![square()]), &parts, [TAU; 2], 1, 0);
    // A turn out and a turn back sweep the same as the turn out alone.
    let swing = motion(&[part(0.25 * PI), part(-0.25 * PI)]);
    let once = swept(&polygon(vec![square()]), &motion(&[part(0.25 * PI)]), 1e-4);
    let twice = swept(&polygon(vec![square()]), &swing, 1e-4);
    let difference = (once.measures.area - twice.measures.area).abs();
    let bound = once.error_bound.inside.length + twice.error_bound.inside.length;
    assert!(
        difference <= bound * once.measures.perimeter,
        "{difference:e}"
    );
}

#[test]
fn pieces_that_touch_are_swept() {
    let at = |x: f64, y: f64| outline(&[[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]]);
    let two = polygon(vec![at(0.0, 0.0), at(1.0, 1.0)]);
    let up = motion(&[Generator::translation(DVec2::new(0.0, 3.0))]);
    check(&two, &up, [8.0; 2], 1, 0);
}

#[test]
fn the_unit_of_length_does_not_matter() {
    for seed in 0..20 {
        let (body, _, relative) = random_case(seed);
        let one = swept(&body, &spiral_about(DVec2::new(0.5, 0.2)), relative);
        for unit in [1e-3, 1e6] {
            let scaled = body.transformed(&DAffine2::from_scale(DVec2::splat(unit)));
            let other = swept(
                &scaled,
                &spiral_about(DVec2::new(0.5, 0.2) * unit),
                relative,
            );
            let share = other.measures.area / (unit * unit * one.measures.area);
            assert!((share - 1.0).abs() < 1e-8, "{seed} in {unit}: {share}");
            assert_eq!(
                (other.measures.pieces, other.measures.holes),
                (one.measures.pieces, one.measures.holes),
                "{seed} in {unit}"
            );
        }
    }
}

fn spiral_about(through: DVec2) -> Motion {
    motion(&[Generator::spiral(through, 2.5, 1.3)])
}

#[test]
fn tolerances_that_cannot_be_used_are_refused_by_name() {
    let body = polygon(vec![square()]);
    let asked = |tolerance: f64| {
        let settings = SweepSettings::default().with_tolerance(tolerance);
        sweep(&body, &turn(1.0, [0.0; 2]), &settings).map(|swept| swept.tolerance)
    };
    for tolerance in [0.0, -1.0, f64::INFINITY, f64::NAN] {
        assert!(
            matches!(asked(tolerance), Err(SweepError::Tolerance { .. })),
            "{tolerance}"
        );
    }
    let Err(SweepError::BelowRounding { smallest, .. }) = asked(1e-13) else {
        panic!("1e-13 is lost in the rounding");
    };
    assert_eq!(asked(1e-6), Ok(1e-6), "as asked");
    assert!(smallest < 1e-9, "{smallest:e}");
}

#[test]
fn a_body_smaller_than_the_rounding_of_its_place_is_refused() {
    let far = DVec2::splat(1e13);
    let body = polygon(vec![square().into_iter().map(|p| p + far).collect()]);
    let turn = turn(1.0, [0.0, 0.0]);
    let refusal = sweep(&body, &turn, &SweepSettings::default());
    assert!(
        matches!(refusal, Err(SweepError::BelowRounding { smallest, .. }) if smallest > 2.0),
        "a square of size 2 at 1e13, in steps of 100"
    );
}

/// A random motion: rigid, spiral, shear or general, half a turn.
fn random_motion(kind: usize, random: &mut impl Iterator<Item = f64>) -> Motion {
    let mut next = |low: f64, high: f64| low + (high - low) * random.next().expect("endless");
    let through = DVec2::new(next(-2.0, 2.0), next(-2.0, 2.0));
    let spiral = |turn, scale| Generator::spiral(through, turn, scale);
    match kind % 5 {
        0 => motion(&[spiral(next(-7.0, 7.0), 1.0)]),
        1 => motion(&[spiral(next(-4.0, 4.0), next(0.4, 2.5))]),
        2 => motion(&[Generator {
            linear: DMat2::from_cols(DVec2::new(0.0, 0.0), DVec2::new(next(-2.0, 2.0), 0.0)),
            offset: through,
        }]),
        3 => motion(&[spiral(PI, 1.0)]),
        _ => motion(&[
            Generator {
                linear: DMat2::from_cols(
                    DVec2::new(next(-1.0, 1.0), next(-1.0, 1.0)),
                    DVec2::new(next(-1.0, 1.0), next(-1.0, 1.0)),
                ),
                offset: through,
            },
            spiral(next(-3.0, 3.0), next(0.5, 1.5)),
            Generator::translation(DVec2::new(next(-1.0, 1.0), next(-1.0, 1.0))),
        ]),
    }
}

/// A star with up to 42 corners, its motion, and a relative tolerance.
fn random_case(seed: u32) -> (Polygon, Motion, f64) {
    let mut random = pseudo_random(u64::from(seed) * 7919 + 1);
    let corners = 3 + seed * 7 % 40;
    let spread = 0.9 * random.next().expect("endless");
    let body = polygon(vec![star(corners, spread, &mut random)]);
    let motion = random_motion(seed as usize, &mut random);
    (body, motion, [1e-2, 1e-3, 1e-4][seed as usize % 3])
}

#[test]
fn random_stars_agree_with_the_exact_motion_of_points() {
    let defects: Vec<String> = (0..1000_u32)
        .into_par_iter()
        .flat_map_iter(|seed| {
            let (body, motion, relative) = random_case(seed);
            let sweep = swept(&body, &motion, relative);
            let mut defects = disagreement(&body, &motion, &sweep, 1000);
            let bound = &sweep.error_bound;
            if bound.inside.length > sweep.tolerance || sweep.measures.pieces != 1 {
                defects.push(format!(
                    "{:?} of {:e}, {} pieces {} holes",
                    bound, sweep.tolerance, sweep.measures.pieces, sweep.measures.holes
                ));
            }
            defects
                .into_iter()
                .take(3)
                .map(move |defect| format!("{seed} at {relative:e}: {defect}"))
        })
        .collect();
    assert!(
        defects.is_empty(),
        "{} defects, {defects:#?}",
        defects.len()
    );
}

/// The closed curves of a cycle, each as its corners.
fn curves(cycle: &SweepCycle) -> Vec<Vec<[f64; 2]>> {
    let mut ways: Vec<Vec<u32>> = vec![Vec::new(); cycle.points.len()];
    for (&[from, to], &weight) in cycle.segments.iter().zip(&cycle.weights) {
        let [from, to] = if weight > 0 { [from, to] } else { [to, from] };
        (0..weight.abs()).for_each(|_| ways[from as usize].push(to));
    }
    let mut curves = Vec::new();
    for start in 0..ways.len() {
        while !ways[start].is_empty() {
            let mut curve = Vec::new();
            let mut at = start;
            while let Some(next) = ways[at].pop() {
                curve.push(cycle.points[at].to_array());
                at = next as usize;
            }
            assert_eq!(at, start, "every point is left as often as entered");
            curves.push(curve);
        }
    }
    curves
}

#[test]
fn random_stars_have_the_outlines_of_an_independent_union() {
    let defects: Vec<String> = (0..300_u32)
        .into_par_iter()
        .filter_map(|seed| {
            let (body, motion, relative) = random_case(seed);
            let at_start = body.transformed(motion.start_pose());
            let budget = PlanarBudget::of(relative * at_start.diagonal());
            let cycle = sweep_cycle(&at_start, &motion, &budget).expect("small");
            let union = curves(&cycle).simplify_shape_as::<i64>(FillRule::Positive);
            let segments: Vec<Segment> = cycle
                .segments
                .iter()
                .zip(&cycle.weights)
                .map(|(&ends, &weight)| Segment { ends, weight })
                .collect();
            let arrangement = arrange(&cycle.points, &segments).expect("closed");
            let outlines = arrangement.outlines();
            let ours: Vec<Vec<[f64; 2]>> = outlines
                .loops()
                .map(|outline| {
                    let corners = outline.vertices.iter();
                    corners
                        .map(|&corner| arrangement.positions()[corner as usize].to_array())
                        .collect()
                })
                .collect();
            let difference = ours.overlay_as::<i64>(&union, OverlayRule::Xor, FillRule::EvenOdd);
            // A film along all curves of the cycle, as thick as our rounding, which is the coarser
            // one.
            let length: f64 = cycle
                .segments
                .iter()
                .map(|ends| {
                    let [from, to] = ends.map(|end| cycle.points[end as usize]);
                    from.distance(to)
                })
                .sum();
            let allowed = 2.0 * arrangement.rounding() * length;
            // Where the two differ by more, the angles subtended by the cycle decide.
            let wrong = difference.iter().flatten().find(|outline| {
                let point = inner_point(outline);
                area_of(outline).abs() > allowed
                    && is_inside(&ours, point) != (winding_number(&cycle, point) > 0.5)
            });
            let areas = [&ours, &union.into_iter().flatten().collect()]
                .map(|outlines| outlines.iter().map(|o| area_of(o)).sum::<f64>());
            (wrong.is_some() || (areas[0] - areas[1]).abs() > allowed)
                .then(|| format!("{seed}: {wrong:?}, areas {areas:?} within {allowed:e}"))
        })
        .collect();
    assert!(defects.is_empty(), "{defects:#?}");
}

fn is_inside(outlines: &[Vec<[f64; 2]>], point: DVec2) -> bool {
    let places = |o: &Vec<[f64; 2]>| o.iter().copied().map(DVec2::from_array).collect();
    depth(
        outlines.iter().map(places).collect::<Vec<_>>().iter(),
        point,
    ) > 0.0
}

fn area_of(outline: &[[f64; 2]]) -> f64 {
    let at =
        |i: usize| DVec2::from_array(outline[i % outline.len()]) - DVec2::from_array(outline[0]);
    (0..outline.len())
        .map(|i| at(i).perp_dot(at(i + 1)))
        .sum::<f64>()
        / 2.0
}

/// How often the cycle winds around a point: the sum of the angles that its segments subtend.
fn winding_number(cycle: &SweepCycle, point: DVec2) -> f64 {
    let angle = |(ends, weight): (&[u32; 2], &i32)| {
        let [from, to] = ends.map(|end| cycle.points[end as usize] - point);
        f64::from(*weight) * from.perp_dot(to).atan2(from.dot(to))
    };
    let total: f64 = cycle.segments.iter().zip(&cycle.weights).map(angle).sum();
    total / TAU
}

/// The centroid of the largest triangle of three corners in a row.
fn inner_point(outline: &[[f64; 2]]) -> DVec2 {
    let at = |i: usize| DVec2::from_array(outline[i % outline.len()]);
    let size = |i: usize| (at(i + 1) - at(i)).perp_dot(at(i + 2) - at(i)).abs();
    let i = (0..outline.len())
        .max_by(|&i, &k| size(i).total_cmp(&size(k)))
        .unwrap_or_default();
    (at(i) + at(i + 1) + at(i + 2)) / 3.0
}
