//! Single pairs of features against a slow search: 40,000 random ones, and some that are barely
//! decided.

use crate::support::contact::pairs::{Kind, Pair, any_generator, any_pair, degenerate_pair};
use crate::support::contact::percentile;
use crate::support::contact::reference::Slow;
use crate::support::membership::exponential;
use crate::support::random::Random;
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::time::Instant;
use steadysweep::collision::pair::{PairOutcome, edge_edge, face_vertex, point_plane, vertex_face};
use steadysweep::motion::{Generator, path_bounds};

/// Widest bracket, as a share of the span, unless rounding decides for longer.
const BRACKET: f64 = 1e-12;
/// Time for which a point on a parabola is within 1e-12 of its tangent.
const TANGENT: f64 = 1e-6;

/// The defect of an outcome, given the slow one.
fn defect(outcome: &PairOutcome, slow: &Slow) -> Option<String> {
    let (clear_until, by) = match slow {
        Slow::Clear => {
            return (*outcome != PairOutcome::None).then(|| "no contact is proven".into());
        }
        Slow::GivenUp => return Some("the slow search gave up".into()),
        Slow::Doubt { clear_until, until } => (*clear_until, *until),
        Slow::Contact { clear_until, by } => (*clear_until, *by),
    };
    match outcome {
        PairOutcome::None => matches!(slow, Slow::Contact { .. }).then(|| "missed".into()),
        PairOutcome::Undecided { .. } => Some("undecided".into()),
        PairOutcome::First { bracket, .. } => {
            let [from, to] = *bracket;
            // At most of the order of the time in which the slow search cannot tell.
            let wide = to - from > BRACKET.max(2.0 * (by - clear_until));
            let early = from < clear_until - 1e-11;
            let late = from > by;
            (wide || early || late || from > to)
                .then(|| format!("wide {wide}, early {early}, late {late}"))
        }
    }
}

/// Checks random pairs of a kind and reports how many meet, miss or are in doubt, and the time of
/// the slowest call.
fn compare(
    kind: Kind,
    count: u64,
    salt: u64,
    make: impl Fn(&mut Random, Kind) -> Pair + Sync,
) -> [usize; 3] {
    let results: Vec<_> = (0..count)
        .into_par_iter()
        .map(|seed| {
            let pair = make(&mut Random::new(salt + seed), kind);
            let clock = Instant::now();
            let outcome = pair.outcome();
            let mut seconds = clock.elapsed().as_secs_f64();
            if seconds > 1e-4 {
                // It may be slow, or interrupted by another process.
                let clock = Instant::now();
                pair.outcome();
                seconds = seconds.min(clock.elapsed().as_secs_f64());
            }
            let slow = pair.slow();
            let defect = defect(&outcome, &slow)
                .map(|what| format!("{salt} + {seed}: {what}: {outcome:?}, {slow:?}, {pair:?}"));
            (slow, seconds, defect)
        })
        .collect();
    let counts = [
        results
            .iter()
            .filter(|(slow, ..)| matches!(slow, Slow::Contact { .. }))
            .count(),
        results
            .iter()
            .filter(|(slow, ..)| *slow == Slow::Clear)
            .count(),
        results
            .iter()
            .filter(|(slow, ..)| matches!(slow, Slow::Doubt { .. }))
            .count(),
    ];
    let mut seconds: Vec<f64> = results.iter().map(|result| result.1).collect();
    seconds.sort_by(f64::total_cmp);
    let at = |share: f64| percentile(&seconds, share) * 1e6;
    println!(
        "{kind:?}: {count} pairs, meet, miss, doubt {counts:?}; median {:.2} us, p99 {:.1} us, worst {:.0} us",
        at(0.5),
        at(0.99),
        at(1.0)
    );
    let defects: Vec<&String> = results
        .iter()
        .filter_map(|result| result.2.as_ref())
        .collect();
    let few = defects.iter().take(4).map(|text| format!("{text}\n"));
    assert!(
        defects.is_empty(),
        "{kind:?}: {} of {count}\n{}",
        defects.len(),
        few.collect::<String>()
    );
    counts
}

fn random_pairs(kind: Kind, count: u64) {
    let [meet, miss, doubt] = compare(kind, count, 1_000_000, any_pair);
    let all = meet + miss + doubt;
    assert!(meet > all / 4 && miss > all / 4, "both happen");
    // Contacts at a corner or along a line cannot be certain for the slow search.
    assert!(doubt < all / 4, "few are in doubt");
}

#[test]
fn vertices_against_faces_agree_with_the_slow_search() {
    random_pairs(Kind::VertexFace, 14_000);
}

#[test]
fn faces_against_vertices_agree_with_the_slow_search() {
    random_pairs(Kind::FaceVertex, 12_000);
}

#[test]
fn edges_against_edges_agree_with_the_slow_search() {
    random_pairs(Kind::EdgeEdge, 14_000);
}

#[test]
fn pairs_that_hang_on_a_hair_agree_with_the_slow_search() {
    for kind in [Kind::VertexFace, Kind::FaceVertex, Kind::EdgeEdge] {
        compare(kind, 1_000, 2_000_000, degenerate_pair);
    }
}

/// A moving point crosses a plane where its height changes sign. The steps are so small that no
/// pair of crossings hides between them unless the height there is tiny.
#[test]
fn points_cross_planes_where_their_height_changes_sign() {
    let defects: Vec<String> = (0..4_000_u64)
        .into_par_iter()
        .filter_map(|seed| {
            let mut random = Random::new(3_000_000 + seed);
            let generator = any_generator(&mut random);
            let (point, anchor) = (random.point(1.0), random.point(1.0));
            let normal = random.direction() * random.magnitude(1e-3, 1e3);
            let height = |time: f64| {
                let pose = exponential(&generator.linear, generator.offset, time);
                (pose.transform_point3(point) - anchor).dot(normal) / normal.length()
            };
            let box_of_path = path_bounds(&generator, point, [0.0, 1.0]);
            let reach = box_of_path.iter().map(|p| p.abs().max_element());
            let reach = reach.fold(1.0, f64::max);
            let steps = 2_000;
            let heights: Vec<f64> = (0..=steps).map(|k| height(f64::from(k) / 2e3)).collect();
            let crossing = heights.windows(2).position(|pair| pair[0] * pair[1] <= 0.0);
            let outcome = point_plane(&generator, point, anchor, normal, [0.0, 1.0]);
            let time = |step: usize| step as f64 / 2e3;
            let fits = match (&outcome, crossing) {
                (PairOutcome::None, None) => true,
                (PairOutcome::First { bracket, .. }, Some(step)) => {
                    let [from, to] = *bracket;
                    let crosses = height(from - 1e-9) * height(to + 1e-9) <= 0.0;
                    let slope = (height(to + 1e-6) - height(from - 1e-6)).abs() / 2e-6;
                    // Two crossings may hide in an earlier step.
                    let earlier = from < time(step) && height(from).abs() < 1e-10;
                    to - from <= BRACKET.max(1e-12 * reach / slope)
                        && (earlier
                            || (crosses
                                && from >= time(step) - 1e-12
                                && to <= time(step + 1) + 1e-12))
                }
                (PairOutcome::First { bracket, .. }, None) => {
                    bracket[1] - bracket[0] <= 1e-5 && height(bracket[0]).abs() < 1e-10
                }
                _ => false,
            };
            (!fits).then(|| {
                format!(
                    "{seed}: {outcome:?}, {crossing:?}, {generator:?} {point} {anchor} {normal}"
                )
            })
        })
        .collect();
    assert!(
        defects.is_empty(),
        "{}: {:#?}",
        defects.len(),
        &defects[..defects.len().min(3)]
    );
}

fn first(outcome: PairOutcome) -> [f64; 2] {
    match outcome {
        PairOutcome::First { bracket, .. } => bracket,
        _ => panic!("{outcome:?}"),
    }
}

const WHOLE: [f64; 2] = [0.0, 1.0];
const FACE: [DVec3; 3] = [
    DVec3::new(-1.0, -1.0, 0.0),
    DVec3::new(3.0, -1.0, 0.0),
    DVec3::new(-1.0, 3.0, 0.0),
];

/// a cos t + b sin t = c on a circle.
#[test]
fn a_point_on_a_circle_meets_the_plane_at_the_angle_of_the_formula() {
    for (turn, sine) in [(1.0, 0.5), (3.0 * PI, 0.25), (6.0 * PI, 0.999_999)] {
        // From (-1/2, 0, 0) downwards about the y axis through (1/2 - 1, ..): height is -sin.
        let generator = Generator::screw(DVec3::Y, DVec3::ZERO, turn, 0.0, 1.0);
        let face = FACE.map(|p| p - DVec3::Z * sine);
        let found = first(vertex_face(&generator, DVec3::X, face, WHOLE));
        let expected = f64::asin(sine) / turn;
        // At the top of the sine the time is known only to the root of the rounding.
        let slope = (1.0 - sine * sine).sqrt() * turn;
        let slack = 1e-12 + 4e-16 / slope;
        assert!(
            found[0] <= expected + slack && expected <= found[1] + slack,
            "{found:?} for {expected}"
        );
    }
}

#[test]
fn touch_and_leave_is_a_touch_and_a_hair_above_is_none() {
    // z = z0 + (t - 1/2)^2 - 1/4.
    let generator = Generator {
        linear: DMat3::from_cols(DVec3::Z * 2.0, DVec3::ZERO, DVec3::ZERO),
        offset: DVec3::X,
    };
    let start = DVec3::new(-0.5, 0.0, 0.25);
    match vertex_face(&generator, start, FACE, WHOLE) {
        PairOutcome::First { bracket, touch } => {
            assert!(touch, "it only touches");
            // It is within 1e-12 of the plane for a time of 1e-6.
            assert!(
                (bracket[0] - 0.5).abs() < 1e-6 && bracket[1] - bracket[0] < TANGENT,
                "{bracket:?}"
            );
        }
        outcome => panic!("{outcome:?}"),
    }
    for lift in [1e-9, 1e-12] {
        let outcome = vertex_face(&generator, start + DVec3::Z * lift, FACE, WHOLE);
        assert_eq!(outcome, PairOutcome::None, "{lift:e} above");
    }
    // At a closing speed of 2e-3, rounding of 1e-13 is 1e-10 in time.
    let below = first(vertex_face(
        &generator,
        start - DVec3::Z * 1e-6,
        FACE,
        WHOLE,
    ));
    let expected = 0.5 - 1e-3;
    assert!(
        below[0] <= expected && expected <= below[1] && below[1] - below[0] < 1e-9,
        "{below:?}"
    );
}

#[test]
fn sliding_in_the_plane_is_contact_from_where_the_side_is_crossed() {
    let slide = Generator::translation(DVec3::X * 4.0);
    // From x = -2 to the side x = -1, in the plane: at a quarter.
    let from = DVec3::new(-2.0, 0.0, 0.0);
    let found = first(vertex_face(&slide, from, FACE, WHOLE));
    assert!(
        (found[0] - 0.25).abs() < 1e-11 && found[1] - found[0] < 1e-9,
        "{found:?}"
    );
    let above = vertex_face(&slide, from + DVec3::Z * 1e-9, FACE, WHOLE);
    assert_eq!(above, PairOutcome::None, "a hair above");
    let inside = first(vertex_face(&slide, DVec3::new(-0.5, 0.0, 0.0), FACE, WHOLE));
    assert_eq!(inside[0], 0.0, "in contact at the start");
}

#[test]
fn parallel_edges_meet_when_their_distance_is_gone() {
    let upright = |x: f64, y: f64| [DVec3::new(x, y, 0.0), DVec3::new(x, y, 1.0)];
    let slide = Generator::translation(DVec3::new(2.0, 0.0, 0.25));
    let found = first(edge_edge(
        &slide,
        upright(-1.0, 0.0),
        upright(0.0, 0.0),
        WHOLE,
    ));
    assert!((found[0] - 0.5).abs() < 1e-11, "{found:?}");
    let beside = edge_edge(&slide, upright(-1.0, 1e-9), upright(0.0, 0.0), WHOLE);
    assert_eq!(beside, PairOutcome::None, "passes a hair beside");
    // Their ends pass each other: at 1/2 they are collinear seen from above, but one is above the
    // other.
    let rise = Generator::translation(DVec3::new(2.0, 0.0, 3.0));
    let above = edge_edge(&rise, upright(-1.0, 0.0), upright(0.0, 0.0), WHOLE);
    assert_eq!(above, PairOutcome::None, "above it");
}

#[test]
fn features_at_rest_meet_at_once_or_never() {
    let rest = Generator::translation(DVec3::ZERO);
    let on = first(vertex_face(&rest, DVec3::new(0.25, 0.25, 0.0), FACE, WHOLE));
    assert_eq!(on[0], 0.0, "on the face");
    for (vertex, side) in [
        (DVec3::Z * 1e-9, "above"),
        (DVec3::new(-1.0 - 1e-9, 0.0, 0.0), "beside"),
    ] {
        assert_eq!(
            vertex_face(&rest, vertex, FACE, WHOLE),
            PairOutcome::None,
            "{side}"
        );
        assert_eq!(
            face_vertex(&rest, FACE, vertex, WHOLE),
            PairOutcome::None,
            "{side}"
        );
    }
}

#[test]
fn a_face_without_area_is_met_as_a_segment_or_a_point() {
    let fall = Generator::translation(DVec3::Z * -2.0);
    let (a, b) = (DVec3::ZERO, DVec3::X);
    for face in [[a, b, b], [a, a, b], [a, b, b * 0.5], [b, a, b]] {
        let found = first(vertex_face(&fall, DVec3::new(0.5, 0.0, 1.0), face, WHOLE));
        assert!((found[0] - 0.5).abs() < 1e-11, "{found:?} {face:?}");
        let beside = DVec3::new(0.5, 1e-9, 1.0);
        assert_eq!(
            vertex_face(&fall, beside, face, WHOLE),
            PairOutcome::None,
            "{face:?}"
        );
    }
    let found = first(vertex_face(&fall, DVec3::Z, [a; 3], WHOLE));
    assert!((found[0] - 0.5).abs() < 1e-11, "{found:?}");
}

/// No numbers cause a panic or an endless search.
#[test]
fn hostile_numbers_end_in_an_outcome() {
    let numbers = [0.0, -0.0, 1.0, 1e-300, 5e-324, 1e17, -1e17, 1e-17, 0.1];
    let mut random = Random::new(7);
    let clock = Instant::now();
    for _ in 0..2_000 {
        let mut vector = || DVec3::from_array([0; 3].map(|_| random.one_of(&numbers)));
        let points = [(); 4].map(|()| vector());
        let linear = DMat3::from_cols(vector(), vector(), vector());
        let size = linear
            .to_cols_array()
            .iter()
            .fold(1.0_f64, |m, x| m.max(x.abs()));
        let generator = Generator {
            linear: linear * (5.0 / size),
            offset: vector(),
        };
        let [a, b, c, d] = points;
        vertex_face(&generator, a, [b, c, d], WHOLE);
        face_vertex(&generator, [a, b, c], d, WHOLE);
        edge_edge(&generator, [a, b], [c, d], WHOLE);
    }
    let seconds = clock.elapsed().as_secs_f64();
    assert!(seconds < 20.0, "{seconds} s for 6,000 pairs");
}
