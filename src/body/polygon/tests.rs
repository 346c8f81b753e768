//! Bodies from outlines that touch, cross, nest and repeat.

use super::super::LoopPlace;
use super::*;
use crate::numeric::tolerance::UNIT_ROUNDOFF;
use crate::samples::random_below;

fn points(coordinates: &[[f64; 2]]) -> Vec<DVec2> {
    coordinates.iter().map(|&p| DVec2::from_array(p)).collect()
}

fn square(low: f64, size: f64) -> Vec<DVec2> {
    points(&[
        [low, low],
        [low + size, low],
        [low + size, low + size],
        [low, low + size],
    ])
}

fn reversed(mut outline: Vec<DVec2>) -> Vec<DVec2> {
    outline.reverse();
    outline
}

fn polygon(loops: Vec<Vec<DVec2>>, fill: FillRule) -> Polygon {
    Polygon::new(loops, fill).expect("a body")
}

/// Checks area, pieces and holes.
#[track_caller]
fn check(polygon: &Polygon, area: f64, pieces: usize, holes: usize) {
    let rounding = 64.0
        * UNIT_ROUNDOFF
        * polygon.diagonal()
        * (polygon.diagonal() + polygon.bounds()[1].abs().max_element());
    assert!(
        (polygon.area() - area).abs() <= rounding,
        "area {} for {area}",
        polygon.area()
    );
    assert_eq!(
        (polygon.pieces(), polygon.holes()),
        (pieces, holes),
        "pieces and holes"
    );
}

#[test]
fn a_square_has_its_measures_at_any_scale_and_place() {
    for (low, size) in [(0.0, 1.0), (1e6, 1.0), (-5e3, 1e3), (0.0, 1e-3)] {
        for outline in [square(low, size), reversed(square(low, size))] {
            let body = polygon(vec![outline], FillRule::EvenOdd);
            check(&body, size * size, 1, 0);
            assert!(
                (body.perimeter() / size - 4.0).abs() < 1e-9,
                "perimeter of {size} at {low}"
            );
            assert!(
                (body.diagonal() / size - 2f64.sqrt()).abs() < 1e-9,
                "diagonal of {size} at {low}"
            );
        }
    }
}

#[test]
fn a_clockwise_outline_is_turned_and_begins_where_it_did() {
    let body = polygon(
        vec![points(&[[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]])],
        FillRule::NonZero,
    );
    assert_eq!(
        body.positions(),
        points(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    );
    assert_eq!(body.edges().collect::<Vec<_>>(), [[0, 1], [1, 2], [2, 0]]);
    assert_eq!(
        [0, 1, 2].map(|edge| body.given_edge(edge)),
        [2, 1, 0],
        "the edges as given"
    );
}

#[test]
fn nesting_makes_holes_by_the_even_odd_rule_whatever_the_sense() {
    let squares = [(0.0, 7.0), (1.0, 5.0), (2.0, 3.0), (3.0, 1.0), (10.0, 1.0)];
    for senses in 0..32 {
        let loops = squares
            .iter()
            .enumerate()
            .map(|(i, &(low, size))| {
                let outline = square(low, size);
                if senses >> i & 1 == 0 {
                    outline
                } else {
                    reversed(outline)
                }
            })
            .collect();
        let body = polygon(loops, FillRule::EvenOdd);
        check(&body, 49.0 - 25.0 + 9.0 - 1.0 + 1.0, 3, 2);
    }
}

#[test]
fn the_nonzero_rule_goes_by_the_sense_of_the_loops() {
    let hole = polygon(
        vec![square(0.0, 3.0), reversed(square(1.0, 1.0))],
        FillRule::NonZero,
    );
    check(&hole, 8.0, 1, 1);
    let inner = polygon(vec![square(0.0, 3.0), square(1.0, 1.0)], FillRule::NonZero);
    check(&inner, 9.0, 1, 0);
    assert_eq!(inner.redundant(), [1], "the inner square bounds nothing");
    let turned = polygon(
        vec![reversed(square(0.0, 3.0)), square(1.0, 1.0)],
        FillRule::NonZero,
    );
    check(&turned, 8.0, 1, 1);
}

#[test]
fn equal_neighbours_are_one_corner() {
    let mut outline = square(0.0, 1.0);
    outline.insert(2, outline[1]);
    outline.push(outline[0]);
    assert_eq!(
        polygon(vec![outline], FillRule::EvenOdd).positions(),
        square(0.0, 1.0)
    );
}

#[test]
fn crossing_edges_are_named_with_the_point() {
    let bow = points(&[[0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [0.0, 4.0]]);
    let error = Polygon::new(vec![square(-2.0, 1.0), bow], FillRule::EvenOdd).expect_err("a bow");
    let place = |corner| LoopPlace { outline: 1, corner };
    assert_eq!(
        error,
        PolygonError::Crossing {
            edges: [place(0), place(2)],
            at: DVec2::splat(2.0)
        }
    );
    assert_eq!(
        error.to_string(),
        "the outline crosses itself at (2, 2): edge 0 of loop 1 crosses edge 2 of loop 1; separate the two, or unite the \
         areas that overlap"
    );
}

#[test]
fn a_crossing_in_a_corner_of_another_loop_is_a_crossing_too() {
    let bow = points(&[[0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [0.0, 4.0]]);
    let tip = points(&[[2.0, 2.0], [3.0, 1.75], [3.0, 2.25]]);
    assert!(matches!(
        Polygon::new(vec![tip, bow], FillRule::EvenOdd),
        Err(PolygonError::Crossing { .. })
    ));
}

#[test]
fn a_crossing_by_a_unit_in_the_last_place_is_found() {
    // The tip of a triangle near the diagonal of another: one unit in the last place across it, and
    // on it.
    let base = points(&[[0.5, 0.5], [24.5, 24.5], [0.5, 24.5]]);
    let tip = |y: f64| vec![base.clone(), points(&[[12.0, y], [30.0, 0.0], [30.0, 1.0]])];
    assert!(matches!(
        Polygon::new(tip(12f64.next_up()), FillRule::EvenOdd),
        Err(PolygonError::Crossing { .. })
    ));
    let touching = polygon(tip(12.0), FillRule::EvenOdd);
    assert_eq!((touching.pieces(), touching.holes()), (2, 0));
    assert_eq!(
        touching.edge_count(),
        7,
        "the diagonal has a corner where it is touched"
    );
}

#[test]
fn squares_that_share_a_stretch_are_one_body() {
    let beside = points(&[[1.0, 0.25], [2.0, 0.25], [2.0, 0.75], [1.0, 0.75]]);
    for fill in [FillRule::EvenOdd, FillRule::NonZero] {
        let body = polygon(vec![square(0.0, 1.0), beside.clone()], fill);
        check(&body, 1.5, 1, 0);
        assert_eq!(body.edge_count(), 8, "no edge is left between the two");
    }
}

#[test]
fn loops_that_meet_in_a_corner_are_pieces_of_their_own() {
    check(
        &polygon(vec![square(0.0, 1.0), square(1.0, 1.0)], FillRule::EvenOdd),
        2.0,
        2,
        0,
    );
    // The same, drawn as one line that passes through the common corner twice.
    let eight = points(&[
        [1.0, 1.0],
        [0.0, 1.0],
        [0.0, 0.0],
        [1.0, 0.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [2.0, 2.0],
        [2.0, 1.0],
    ]);
    check(&polygon(vec![eight.clone()], FillRule::NonZero), 2.0, 2, 0);
    // It runs around the two in opposite senses, straight through the corner: a crossing.
    assert!(matches!(
        Polygon::new(vec![eight], FillRule::EvenOdd),
        Err(PolygonError::Overlap { .. })
    ));
}

#[test]
fn loops_that_overlap_by_way_of_corners_are_refused() {
    // Two rectangles that share parts of two sides, and two diamonds that pass each other in
    // corners.
    let wide = |x: f64| points(&[[x, 0.0], [x + 4.0, 0.0], [x + 4.0, 4.0], [x, 4.0]]);
    let error = Polygon::new(vec![wide(0.0), wide(2.0)], FillRule::EvenOdd).expect_err("overlap");
    assert!(
        matches!(
            error,
            PolygonError::Overlap {
                edge: LoopPlace { outline: 1, .. },
                ..
            }
        ),
        "{error}"
    );
    let diamond = |x: f64| {
        points(&[
            [x - 2.0, 0.0],
            [x - 1.0, -1.0],
            [x, -2.0],
            [x + 1.0, -1.0],
            [x + 2.0, 0.0],
            [x + 1.0, 1.0],
            [x, 2.0],
            [x - 1.0, 1.0],
        ])
    };
    let both = vec![diamond(0.0), reversed(diamond(2.0))];
    assert!(matches!(
        Polygon::new(both.clone(), FillRule::EvenOdd),
        Err(PolygonError::Overlap { .. })
    ));
    let same_sense = both.into_iter().map(|mut outline| {
        if outline[1].y > 0.0 {
            outline.reverse()
        }
        outline
    });
    check(
        &polygon(same_sense.collect(), FillRule::NonZero),
        14.0,
        1,
        0,
    );
}

#[test]
fn a_hole_that_touches_the_outline_leaves_the_right_area() {
    let hole = points(&[[0.0, 2.0], [1.0, 1.0], [1.0, 3.0]]);
    let body = polygon(vec![square(0.0, 4.0), hole], FillRule::EvenOdd);
    check(&body, 15.0, 1, 0);
    assert_eq!(
        body.edge_count(),
        8,
        "five of the square, three of the hole"
    );
}

#[test]
fn a_slit_and_a_spike_are_gone() {
    let with_slit = points(&[
        [0.0, 0.0],
        [2.0, 0.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [2.0, 1.0],
        [2.0, 2.0],
        [0.0, 2.0],
    ]);
    check(&polygon(vec![with_slit], FillRule::EvenOdd), 4.0, 1, 0);
    let line = points(&[[0.0, 0.0], [1.0, 3.0]]);
    assert_eq!(
        Polygon::new(vec![line.clone()], FillRule::EvenOdd),
        Err(PolygonError::NoArea)
    );
    let body = polygon(vec![line, square(5.0, 1.0)], FillRule::EvenOdd);
    assert_eq!(body.redundant(), [0], "a line bounds nothing");
}

#[test]
fn damaged_numbers_are_named() {
    assert_eq!(
        Polygon::new(vec![], FillRule::EvenOdd),
        Err(PolygonError::Empty)
    );
    assert_eq!(
        Polygon::new(vec![vec![]], FillRule::EvenOdd),
        Err(PolygonError::Empty)
    );
    let mut broken = square(0.0, 1.0);
    broken[2].y = f64::INFINITY;
    let place = LoopPlace {
        outline: 1,
        corner: 2,
    };
    assert_eq!(
        Polygon::new(vec![square(3.0, 1.0), broken.clone()], FillRule::EvenOdd),
        Err(PolygonError::NonFinite {
            place,
            position: broken[2]
        })
    );
    broken[2].y = -1e19;
    assert_eq!(
        Polygon::new(vec![square(3.0, 1.0), broken.clone()], FillRule::EvenOdd),
        Err(PolygonError::TooFar {
            place,
            position: broken[2]
        })
    );
}

#[test]
fn a_pose_moves_measures_as_its_determinant_says() {
    let body = polygon(vec![square(0.0, 3.0), square(1.0, 1.0)], FillRule::EvenOdd);
    let pose =
        DAffine2::from_scale_angle_translation(DVec2::new(2.0, 3.0), 0.4, DVec2::new(10.0, -4.0));
    let moved = body.transformed(&pose);
    assert!((moved.area() - 48.0).abs() < 1e-12, "{}", moved.area());
    assert_eq!(
        (moved.loops(), moved.holes()),
        (body.loops(), 1),
        "same loops"
    );
}

/// Loops on a coarse grid, where nearly everything touches: either the loops cross, or the area is
/// that of the points inside by a naive count of crossings.
#[test]
fn random_loops_on_a_grid_enclose_what_a_count_of_crossings_says() {
    let mut random = random_below(1);
    let (mut bodies, mut crossing, mut touching, mut overlapping) = (0, 0, 0, 0);
    for _ in 0..20_000 {
        let loops: Vec<Vec<DVec2>> = (0..=random(2))
            .map(|_| {
                (0..3 + random(4))
                    .map(|_| DVec2::new(random(5) as f64, random(5) as f64))
                    .collect()
            })
            .collect();
        for fill in [FillRule::EvenOdd, FillRule::NonZero] {
            match Polygon::new(loops.clone(), fill) {
                Ok(body) => {
                    bodies += 1;
                    touching += usize::from(body.loops().len() > loops.len());
                    compare(&loops, fill, &body);
                }
                Err(PolygonError::Crossing { .. }) => {
                    crossing += 1;
                    assert!(crosses(&loops), "{loops:?}");
                }
                Err(PolygonError::NoArea) => {}
                Err(PolygonError::Overlap { .. }) => {
                    overlapping += 1;
                    assert!(!crosses(&loops), "crossing is told first: {loops:?}");
                }
                Err(error) => panic!("{error}"),
            }
        }
    }
    assert!(
        bodies > 2000 && crossing > 2000 && touching > 20 && overlapping > 20,
        "{bodies} {crossing} {touching}"
    );
}

/// Whether any two edges cross inside both.
fn crosses(loops: &[Vec<DVec2>]) -> bool {
    let edges: Vec<[DVec2; 2]> = edges_of(loops);
    let side = |[a, b]: [DVec2; 2], p: DVec2| (b - a).perp_dot(p - a);
    edges.iter().any(|&e| {
        edges
            .iter()
            .any(|&f| side(e, f[0]) * side(e, f[1]) < 0.0 && side(f, e[0]) * side(f, e[1]) < 0.0)
    })
}

fn edges_of(loops: &[Vec<DVec2>]) -> Vec<[DVec2; 2]> {
    loops
        .iter()
        .flat_map(|corners| {
            (0..corners.len()).map(|i| [corners[i], corners[(i + 1) % corners.len()]])
        })
        .collect()
}

fn winding(edges: &[[DVec2; 2]], p: DVec2) -> i32 {
    edges
        .iter()
        .map(|&[a, b]| {
            let left = (b - a).perp_dot(p - a) > 0.0;
            i32::from(a.y <= p.y && b.y > p.y && left) - i32::from(b.y <= p.y && a.y > p.y && !left)
        })
        .sum()
}

fn compare(loops: &[Vec<DVec2>], fill: FillRule, body: &Polygon) {
    let (given, found) = (edges_of(loops), {
        let place = |corner: u32| body.positions()[corner as usize];
        body.edges().map(|edge| edge.map(place)).collect::<Vec<_>>()
    });
    assert!(!crosses(loops), "{loops:?}");
    for i in 0..40 {
        // This point lies on no line through two points of the grid.
        let p = DVec2::new(
            f64::from(i) * 0.1013 + 0.00123,
            f64::from(i * 7 % 40) * 0.1017 + 0.00171,
        );
        let inside = i32::from(fill.encloses(winding(&given, p)));
        assert_eq!(
            winding(&found, p),
            inside,
            "at {p} of {loops:?} by {fill:?}: {body:?}"
        );
    }
    let mut keys: Vec<[u64; 4]> = found
        .iter()
        .map(|&[a, b]| {
            let [a, b] = if (a.x, a.y) < (b.x, b.y) {
                [a, b]
            } else {
                [b, a]
            };
            [a.x, a.y, b.x, b.y].map(f64::to_bits)
        })
        .collect();
    keys.sort_unstable();
    assert!(
        keys.windows(2).all(|pair| pair[0] != pair[1]),
        "no edge occurs twice: {body:?}"
    );
}

#[test]
fn a_large_outline_is_checked_within_a_second() {
    let corners = 100_000;
    let star = (0..corners)
        .map(|i| {
            let angle = f64::from(i) / f64::from(corners) * std::f64::consts::TAU;
            DVec2::from_angle(angle) * (1.0 + 0.3 * f64::from(i % 2))
        })
        .collect();
    let start = std::time::Instant::now();
    let body = polygon(vec![star], FillRule::EvenOdd);
    assert!(start.elapsed().as_secs_f64() < 1.0, "{:?}", start.elapsed());
    assert_eq!(body.edge_count(), 100_000, "nothing is lost");
}
