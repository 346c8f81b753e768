//! Splines of DXF files, clamped, unclamped and closed, as outlines.

use glam::DVec2;
use std::f64::consts::{PI, SQRT_2, TAU};
use steadysweep::io::{Drawing, DrawingFormat, DrawingSettings, InputProblem, parse_drawing};

/// The data of a spline in group codes.
struct Spline {
    /// Group 70: 1 closed, 2 periodic, 4 rational, 8 planar.
    flags: u32,
    degree: usize,
    knots: Vec<f64>,
    controls: Vec<DVec2>,
    weights: Vec<f64>,
}

fn dxf(splines: &[Spline]) -> Result<Drawing, InputProblem> {
    let mut text = "0\nSECTION\n2\nENTITIES\n".to_owned();
    for spline in splines {
        text += &format!("0\nSPLINE\n70\n{}\n71\n{}\n", spline.flags, spline.degree);
        text += &format!(
            "72\n{}\n73\n{}\n",
            spline.knots.len(),
            spline.controls.len()
        );
        let lines = |code: u32, values: &[f64]| -> String {
            values
                .iter()
                .map(|value| format!("{code}\n{value:?}\n"))
                .collect()
        };
        text += &lines(40, &spline.knots);
        text += &lines(41, &spline.weights);
        for point in &spline.controls {
            text += &format!("10\n{:?}\n20\n{:?}\n30\n0.0\n", point.x, point.y);
        }
    }
    text += "0\nENDSEC\n0\nEOF\n";
    parse_drawing(
        DrawingFormat::Dxf,
        text.as_bytes(),
        &DrawingSettings::default(),
    )
}

#[track_caller]
fn area(splines: &[Spline], expected: f64) -> Drawing {
    let drawing = dxf(splines).unwrap_or_else(|error| panic!("refused: {error}"));
    let body = &drawing.polygon;
    // The error of flattening, and that of the sums below.
    let error = drawing.flattening * body.perimeter() + 1e-6 * expected;
    assert!(
        (body.area() - expected).abs() <= error,
        "{} for {expected}",
        body.area()
    );
    assert_eq!((body.pieces(), body.holes()), (1, 0), "one outline");
    drawing
}

/// A star of `count` control points about `middle`.
fn star(count: u32, size: f64, middle: DVec2) -> Vec<DVec2> {
    let point = |i: u32| {
        let way = DVec2::from_angle(TAU * f64::from(i) / f64::from(count));
        middle + way * size * f64::from(2 + i % 2)
    };
    (0..count).map(point).collect()
}

/// The basis function of degree p with equal steps over [0, p + 1], by its recursive definition
/// (Cox & de Boor).
fn basis(degree: usize, t: f64) -> f64 {
    if degree == 0 {
        return f64::from(u8::from((0.0..1.0).contains(&t)));
    }
    let p = degree as f64;
    (t * basis(degree - 1, t) + (p + 1.0 - t) * basis(degree - 1, t - 1.0)) / p
}

/// The area inside the closed spline with equal steps, as that of a polygon of many of its points.
fn area_of_turn(degree: usize, controls: &[DVec2], weights: &[f64]) -> f64 {
    const STEPS: usize = 400;
    let count = controls.len();
    let point = |sample: usize| {
        let t = sample as f64 / STEPS as f64;
        let (mut sum, mut weight) = (DVec2::ZERO, 0.0);
        // Over the interval of t, the functions that begin at it or at one of the `degree`
        // intervals before it.
        for before in 0..=degree {
            let begin = (sample / STEPS + count * degree - before) % count;
            let share = weights[begin] * basis(degree, t.fract() + before as f64);
            sum += controls[begin] * share;
            weight += share;
        }
        sum / weight
    };
    let points: Vec<DVec2> = (0..STEPS * count).map(point).collect();
    let next = points.iter().cycle().skip(1);
    points
        .iter()
        .zip(next)
        .map(|(p, q)| p.perp_dot(*q))
        .sum::<f64>()
        / 2.0
}

fn equal_steps(count: usize, start: f64, step: f64) -> Vec<f64> {
    (0..count).map(|i| start + step * i as f64).collect()
}

#[test]
fn closed_splines_are_curves_at_every_size_and_in_every_writing() {
    for (degree, count) in [(1, 8), (2, 6), (3, 8), (3, 4), (5, 12)] {
        for size in [1e-3, 1.0, 1e4] {
            let controls = star(count, size, DVec2::new(5.0 * size, -3.0 * size));
            let count = controls.len();
            let expected = area_of_turn(degree, &controls, &vec![1.0; count]);
            let wrapped = [&controls[..], &controls[..degree]].concat();
            let long = equal_steps(count + 2 * degree + 1, -0.5, 0.25);
            let one_turn = equal_steps(count + 1, 0.0, 1.0);
            for (flags, knots, controls) in [
                // As AutoCAD and ezdxf write them, with flags and without.
                (11, long.clone(), wrapped.clone()),
                (0, long.clone(), wrapped),
                (3, long, controls.clone()),
                (1, one_turn, controls),
            ] {
                area(
                    &[Spline {
                        flags,
                        degree,
                        knots,
                        controls,
                        weights: vec![],
                    }],
                    expected,
                );
            }
        }
    }
}

#[test]
fn closed_splines_may_be_rational() {
    let controls = star(10, 1.0, DVec2::ZERO);
    let weights: Vec<f64> = (0..10).map(|i| [1.0, 3.0, 0.5][i % 3]).collect();
    let expected = area_of_turn(3, &controls, &weights);
    let plain = area_of_turn(3, &controls, &[1.0; 10]);
    assert!(
        (expected - plain).abs() > 0.01 * plain,
        "weights matter: {expected} {plain}"
    );
    let knots = equal_steps(17, 0.0, 1.0);
    let wrapped = |values: &[f64]| [values, &values[..3]].concat();
    area(
        &[Spline {
            flags: 15,
            degree: 3,
            knots: knots.clone(),
            controls: [&controls[..], &controls[..3]].concat(),
            weights: wrapped(&weights),
        }],
        expected,
    );
    let one_turn = |weights: Vec<f64>| Spline {
        flags: 7,
        degree: 3,
        knots: knots.clone(),
        controls: controls.clone(),
        weights,
    };
    area(&[one_turn(weights.clone())], expected);
    area(&[one_turn(vec![2.0])], plain);
    let error = dxf(&[one_turn(weights[..4].to_vec())]).expect_err("weights are missing");
    assert!(error.to_string().contains("number of weights"), "{error}");
}

#[test]
fn the_clamped_spline_of_a_circle_is_a_circle() {
    // Nine control points of a square, with weights alternating between 1 and sqrt(1/2).
    let ways = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 0.0];
    let reach = |way: f64| if way % 2.0 == 0.0 { 1.0 } else { SQRT_2 };
    let drawing = area(
        &[Spline {
            flags: 4,
            degree: 2,
            knots: vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.0],
            controls: ways
                .iter()
                .map(|&way| DVec2::from_angle(TAU * way / 8.0) * reach(way))
                .collect(),
            weights: ways.iter().map(|&way| 1.0 / reach(way)).collect(),
        }],
        PI,
    );
    on_circle(&drawing);
}

#[track_caller]
fn on_circle(drawing: &Drawing) {
    let corners = drawing.polygon.positions().iter();
    let off = corners
        .map(|p| (p.length() - 1.0).abs())
        .fold(0.0, f64::max);
    assert!(off < 1e-14, "corners on the circle: {off}");
}

#[test]
fn the_periodic_spline_of_a_circle_is_a_circle() {
    // Three quadratic arcs of 120 degrees over a triangle, with weights 1 at the points of tangency
    // and 1/2 at its corners.
    let (mut controls, mut weights) = (Vec::new(), Vec::new());
    for i in 0..6 {
        let radius = if i % 2 == 0 { 1.0 } else { 2.0 };
        controls.push(DVec2::from_angle(TAU * f64::from(i) / 6.0) * radius);
        weights.push(1.0 / radius);
    }
    // Each knot occurs twice: the points of tangency belong to two equal knots, the corners to two
    // different ones.
    let knots = [-1.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0];
    let drawing = area(
        &[Spline {
            flags: 7,
            degree: 2,
            knots: knots.to_vec(),
            controls,
            weights,
        }],
        PI,
    );
    on_circle(&drawing);
}

#[test]
fn an_unclamped_spline_is_the_curve_of_its_interval() {
    // A parabola y = 1 - x^2 has the blossom 1 - st, at the knots -2 -1.5 -1 1 2 4; the control
    // points are its values at pairs of neighbours.
    let knots = vec![-2.0, -1.5, -1.0, 1.0, 2.0, 4.0];
    let blossom = |s: f64, t: f64| DVec2::new((s + t) / 2.0, 1.0 - s * t);
    let controls = vec![blossom(-1.5, -1.0), blossom(-1.0, 1.0), blossom(1.0, 2.0)];
    let arch = Spline {
        flags: 8,
        degree: 2,
        knots,
        controls,
        weights: vec![],
    };
    let chord = Spline {
        flags: 8,
        degree: 1,
        knots: vec![0.0, 0.0, 1.0, 1.0],
        controls: vec![DVec2::new(-1.0, 0.0), DVec2::new(1.0, 0.0)],
        weights: vec![],
    };
    area(&[arch, chord], 4.0 / 3.0);
}

#[test]
fn what_is_no_spline_is_refused_by_what_is_wrong() {
    let controls = star(6, 1.0, DVec2::ZERO);
    let spline = |degree: usize, knots: Vec<f64>| Spline {
        flags: 3,
        degree,
        knots,
        controls: controls.clone(),
        weights: vec![],
    };
    let mut descending = equal_steps(13, 0.0, 1.0);
    descending.swap(5, 6);
    for (spline, part) in [
        (spline(3, equal_steps(12, 0.0, 1.0)), "knots whose number"),
        (spline(3, vec![]), "knots whose number"),
        (spline(3, descending), "knots that do not ascend"),
        (
            spline(3, vec![0.0, 1.0, 3.0, 4.0, 5.0, 6.0, 7.0]),
            "knots whose number",
        ),
        (
            spline(0, equal_steps(7, 0.0, 1.0)),
            "of a degree that is not from 1 to 25",
        ),
        (
            spline(3000, equal_steps(7, 0.0, 1.0)),
            "of a degree that is not from 1 to 25",
        ),
    ] {
        let error = dxf(&[spline]).expect_err("no spline").to_string();
        assert!(
            error.contains(part) && error.contains("at line 5"),
            "{part}: {error}"
        );
    }
    // A clamped spline whose ends do not meet is open, whatever its flags say.
    let open = spline(3, vec![0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0, 3.0]);
    let error = dxf(&[open]).expect_err("open").to_string();
    assert!(error.contains("the outline is open"), "{error}");
}
