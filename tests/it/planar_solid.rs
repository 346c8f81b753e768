//! Arrangements of plane curves: winding numbers, outlines, nesting; no nearly degenerate input
//! causes a panic.

use crate::support::curves::{Curves, FAMILIES, arranged, check, distance, hard};
use crate::support::random::Random;
use glam::DVec2;
use i_overlay::core::fill_rule::FillRule as OverlayRule;
use i_overlay::float::simplify::SimplifyShape;
use steadysweep::body::{FillRule, Polygon};
use steadysweep::solid::planar::{
    Arrangement, ArrangementError, Outlines, Segment, arrange, subtract,
};

fn square(low: [f64; 2], high: [f64; 2]) -> Vec<DVec2> {
    vec![
        DVec2::from(low),
        DVec2::new(high[0], low[1]),
        DVec2::from(high),
        DVec2::new(low[0], high[1]),
    ]
}

fn turned(mut curve: Vec<DVec2>) -> Vec<DVec2> {
    curve.reverse();
    curve
}

/// The winding numbers of the triangles, ascending.
fn winding_numbers(arrangement: &Arrangement) -> Vec<i32> {
    let mut winding = arrangement.triangulation().expect("consistent").winding;
    winding.sort_unstable();
    winding
}

/// Checks area, perimeter, pieces and holes.
fn expect(curves: Curves, area: f64, perimeter: f64, pieces: usize, holes: usize) -> Outlines {
    let arrangement = arranged(&curves);
    let outlines = check(&curves, &arrangement);
    let measures = arrangement.measures(&outlines);
    assert!((measures.area - area).abs() < 1e-10, "{measures:?}");
    assert!(
        (measures.perimeter - perimeter).abs() < 1e-10,
        "{measures:?}"
    );
    assert_eq!(
        (measures.pieces, measures.holes),
        (pieces, holes),
        "{measures:?}"
    );
    outlines
}

#[test]
fn a_square_is_its_own_region() {
    let outlines = expect(vec![square([0.0, 0.0], [2.0, 1.0])], 2.0, 6.0, 1, 0);
    assert_eq!(outlines.pieces[0].vertices.len(), 4);
}

#[test]
fn overlapping_squares_are_one_piece_without_the_inner_pieces() {
    let curves = vec![
        square([0.0, 0.0], [2.0, 2.0]),
        square([1.0, 1.0], [3.0, 3.0]),
    ];
    let arrangement = arranged(&curves);
    assert_eq!(winding_numbers(&arrangement).last(), Some(&2));
    let outlines = expect(curves, 7.0, 12.0, 1, 0);
    assert_eq!(outlines.pieces[0].vertices.len(), 8);
}

#[test]
fn a_square_run_through_clockwise_takes_away() {
    let hole = turned(square([1.0, 1.0], [2.0, 2.0]));
    let island = square([1.25, 1.25], [1.75, 1.75]);
    let outlines = expect(
        vec![square([0.0, 0.0], [3.0, 3.0]), hole.clone(), island],
        8.25,
        18.0,
        2,
        1,
    );
    let holed = outlines.holes[0].piece as usize;
    assert_eq!(outlines.pieces[holed].vertices.len(), 4, "the outer square");
    // Alone it bounds nothing, and twice in a square it leaves the winding number -1.
    expect(vec![hole.clone()], 0.0, 0.0, 0, 0);
    let twice = vec![square([0.0, 0.0], [3.0, 3.0]), hole.clone(), hole];
    assert_eq!(winding_numbers(&arranged(&twice))[0], -1);
    expect(twice, 8.0, 16.0, 1, 1);
}

#[test]
fn squares_that_touch_in_a_corner_are_two_pieces() {
    expect(
        vec![
            square([0.0, 0.0], [1.0, 1.0]),
            square([1.0, 1.0], [2.0, 2.0]),
        ],
        2.0,
        8.0,
        2,
        0,
    );
}

#[test]
fn holes_that_touch_in_a_corner_or_touch_the_outside_are_holes() {
    let outer = square([0.0, 0.0], [4.0, 4.0]);
    let one = turned(square([1.0, 1.0], [2.0, 2.0]));
    let other = turned(square([2.0, 2.0], [3.0, 3.0]));
    expect(vec![outer.clone(), one, other], 14.0, 24.0, 1, 2);
    let kite = [[2.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 1.0]].map(DVec2::from);
    let perimeter = 16.0 + 4.0 * 2.0_f64.sqrt();
    expect(vec![outer, kite.to_vec()], 14.0, perimeter, 1, 1);
}

#[test]
fn a_ring_of_squares_that_touch_in_corners_is_pieces_without_a_hole() {
    // The square in the middle is a pocket of the region, but no hole of any of its pieces.
    let at = |x: f64, y: f64| square([x, y], [x + 1.0, y + 1.0]);
    expect(
        vec![at(1.0, 0.0), at(0.0, 1.0), at(2.0, 1.0), at(1.0, 2.0)],
        4.0,
        16.0,
        4,
        0,
    );
}

#[test]
fn curves_back_and_forth_bound_nothing_and_are_told() {
    let curves = vec![
        square([0.0, 0.0], [1.0, 1.0]),
        turned(square([0.0, 0.0], [1.0, 1.0])),
    ];
    let arrangement = arranged(&curves);
    assert!(winding_numbers(&arrangement).is_empty(), "all cancels");
    assert_eq!(arrangement.idle().len(), 4);
    expect(curves, 0.0, 0.0, 0, 0);
    expect(vec![], 0.0, 0.0, 0, 0);
    expect(vec![vec![DVec2::ONE; 5]], 0.0, 0.0, 0, 0);
    // A clockwise square and a thread: no curve bounds the region.
    let thread = vec![DVec2::new(5.0, 0.0), DVec2::new(7.0, 1.0)];
    let arrangement = arranged(&vec![turned(square([0.0, 0.0], [1.0, 1.0])), thread]);
    assert_eq!(arrangement.idle().len(), 5);
}

#[test]
fn a_pocket_is_found_with_its_depth_and_filled() {
    let curves = vec![
        square([0.0, 0.0], [3.0, 3.0]),
        turned(square([1.0, 1.0], [2.0, 2.0])),
    ];
    let mut arrangement = arranged(&curves);
    let pockets = arrangement.pockets().expect("a square");
    assert_eq!(pockets.len(), 1);
    assert!((pockets[0].area - 1.0).abs() < 1e-10);
    // Half of a square has the inradius 1 - sqrt(2) / 2.
    assert!((pockets[0].depth - (1.0 - 0.5_f64.sqrt())).abs() < 1e-10);
    // The middle is 0.5 away from the sides; each half has a corner 1 away from its nearest side.
    assert!(
        (pockets[0].reach - 0.5_f64.sqrt()).abs() < 0.3,
        "{pockets:?}"
    );
    arrangement.fill(&pockets);
    let measures = arrangement.measures(&arrangement.outlines());
    assert_eq!((measures.area, measures.holes), (9.0, 0));
    assert!(
        arrangement
            .pockets()
            .is_ok_and(|pockets| pockets.is_empty())
    );
    assert!(
        arrangement.idle().is_empty(),
        "the pieces of the pocket are inside now"
    );
}

#[test]
fn weights_count_as_often_as_a_curve_is_run_through() {
    let points = square([0.0, 0.0], [1.0, 1.0]);
    let ring = |weight| {
        (0..4).map(move |k| Segment {
            ends: [k, (k + 1) % 4],
            weight,
        })
    };
    let winding = |segments: Vec<Segment>| {
        let arrangement = arrange(&points, &segments).expect("closed");
        winding_numbers(&arrangement)
    };
    assert_eq!(winding(ring(3).collect()), [3, 3]);
    assert_eq!(winding(ring(3).chain(ring(-4)).collect()), [-1, -1]);
    assert!(winding(ring(3).chain(ring(-3)).collect()).is_empty());
}

#[test]
fn bad_curves_are_refused_with_the_place() {
    let points = square([0.0, 0.0], [1.0, 1.0]);
    let segment = |a, b| Segment {
        ends: [a, b],
        weight: 1,
    };
    let open = arrange(&points, &[segment(0, 1), segment(1, 2)]);
    assert!(
        matches!(open, Err(ArrangementError::Open { point, excess: 1 }) if point == DVec2::ZERO),
        "{open:?}"
    );
    let missing = arrange(&points, &[segment(0, 1), segment(1, 4)]);
    assert!(
        matches!(
            missing,
            Err(ArrangementError::NoSuchPoint {
                segment: 1,
                point: 4,
                count: 4
            })
        ),
        "{missing:?}"
    );
    let not_finite = arrange(&[DVec2::ZERO, DVec2::new(0.0, f64::NAN)], &[]);
    assert!(
        matches!(
            not_finite,
            Err(ArrangementError::NonFinite { point: 1, .. })
        ),
        "{not_finite:?}"
    );
}

#[test]
fn nearly_degenerate_curves_are_arranged_and_their_winding_numbers_are_right() {
    for family in 0..FAMILIES {
        let mut random = Random::new(family as u64 + 1);
        for _ in 0..400 {
            let curves = hard(family, &mut random);
            check(&curves, &arranged(&curves));
        }
    }
}

/// The union by another library, on its own grid: loops that run counter-clockwise around pieces.
fn union_elsewhere(curves: &Curves) -> Curves {
    let paths: Vec<Vec<[f64; 2]>> = curves
        .iter()
        .map(|curve| curve.iter().map(|point| point.to_array()).collect())
        .collect();
    let shapes = paths.simplify_shape_as::<i64>(OverlayRule::Positive);
    let loops = shapes.into_iter().flatten();
    loops
        .map(|points| points.into_iter().map(DVec2::from_array).collect())
        .collect()
}

/// Wavy circles, many of which overlap.
fn waves(random: &mut Random) -> Curves {
    let count = 1 + random.below(30);
    (0..count)
        .map(|_| {
            let centre = DVec2::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0));
            let radius = random.between(0.1, 0.6);
            // An odd number, so that two turns do not coincide.
            let corners = 5 + 2 * random.below(30);
            let turns = random.one_of(&[1.0, 1.0, -1.0, 2.0]);
            (0..corners)
                .map(|k| {
                    let angle = turns * std::f64::consts::TAU * k as f64 / corners as f64;
                    let way = DVec2::from_angle(angle);
                    centre + radius * (1.0 + 0.3 * (5.0 * angle).sin()) * way
                })
                .collect()
        })
        .collect()
}

#[test]
fn regions_are_those_of_an_independent_union_with_the_positive_rule() {
    let mut random = Random::new(77);
    for case in 0..300 {
        let curves = if case % 2 == 0 {
            hard(0, &mut random)
        } else {
            waves(&mut random)
        };
        let arrangement = arranged(&curves);
        let outlines = check(&curves, &arrangement);
        let measures = arrangement.measures(&outlines);
        let ours: Curves = outlines
            .loops()
            .map(|outline| {
                let corners = outline.vertices.iter();
                corners
                    .map(|&corner| arrangement.positions()[corner as usize])
                    .collect()
            })
            .collect();
        let theirs = union_elsewhere(&curves);
        let area = |curves: &Curves| -> f64 {
            curves
                .iter()
                .map(|curve| {
                    (0..curve.len())
                        .map(|k| curve[k].perp_dot(curve[(k + 1) % curve.len()]) / 2.0)
                        .sum::<f64>()
                })
                .sum()
        };
        assert!((area(&theirs) - measures.area).abs() < 1e-9, "{curves:?}");
        for (some, others) in [(&ours, &theirs), (&theirs, &ours)] {
            for corner in some.iter().flatten() {
                let gap = distance(others, *corner);
                assert!(gap < 1e-9, "{corner} is {gap} away: {curves:?}");
            }
        }
    }
}

#[test]
fn a_tool_leaves_what_it_did_not_reach() {
    let blank = Polygon::new(vec![square([0.0, 0.0], [4.0, 4.0])], FillRule::NonZero)
        .expect("a square is a body");
    // Two that overlap across an edge of the blank, and one that divides it.
    let tools = [
        square([1.0, -1.0], [2.0, 1.0]),
        square([1.5, -1.0], [3.0, 0.5]),
        square([-1.0, 2.0], [5.0, 3.0]),
    ];
    let left = subtract(&blank, &tools).expect("closed");
    let measures = left.measures(&left.outlines());
    // 16 minus 1 x 1, 1 x 0.5 and 4 x 1.
    assert!((measures.area - 10.5).abs() < 1e-10, "{measures:?}");
    assert_eq!((measures.pieces, measures.holes), (2, 0));
    let nothing = subtract(&blank, &[square([-1.0, -1.0], [5.0, 5.0])]).expect("closed");
    assert_eq!(nothing.outlines(), Outlines::default());
}
