//! Steady motions of the plane against outside truth: exponentials to 100 digits, the numbers of
//! the paper, laws; then the motion files and options, through the binary.

use crate::support::command;
use crate::support::command::Scratch;
use crate::support::exponential::exponential;
use crate::support::random::Random;
use glam::{DAffine2, DMat2, DVec2};
use serde_json::Value;
use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};
use steadysweep::motion::planar::{
    Flow, Generator, Keyframe, Motion, acceleration_bound, logarithm, path_bounds, stretch,
};
use steadysweep::motion::{self, MotionError};

// ---- helpers
// -------------------------------------------------------------------------------------------------

fn size(matrix: &DMat2) -> f64 {
    let squares = matrix.to_cols_array().map(|x| x * x);
    squares.iter().sum::<f64>().sqrt()
}

fn linear(rows: [[f64; 2]; 2]) -> DMat2 {
    DMat2::from_cols_array_2d(&rows).transpose()
}

fn affinity(matrix2: DMat2, translation: DVec2) -> DAffine2 {
    DAffine2 {
        matrix2,
        translation,
    }
}

/// Error of the linear part and of the translation, in units of `unit`.
fn errors(found: &DAffine2, expected: &DAffine2, unit: [f64; 2]) -> [f64; 2] {
    [
        size(&(found.matrix2 - expected.matrix2)) / unit[0],
        (found.translation - expected.translation).length() / unit[1],
    ]
}

/// Generators of every case of SAM's appendix A, and between them; `|M|` up to about 8.
fn generators(random: &mut Random) -> Vec<(&'static str, Generator)> {
    let mut all = Vec::new();
    for _ in 0..60 {
        let frame = DMat2::from_angle(PI * random.signed())
            * DMat2::from_diagonal(DVec2::new(1.0 + 0.5 * random.signed(), 1.0));
        let inverse = frame.inverse();
        let [a, b] = [3.0 * random.signed(), 3.0 * random.signed()];
        let tiny = 10.0_f64.powf(-8.0 + 6.0 * random.signed());
        let shapes = [
            ("complex pair", [[a, -b], [b, a]]),
            (
                "nearly a double eigenvalue, turning",
                [[a, -tiny], [1.0, a]],
            ),
            ("nearly a double eigenvalue, real", [[a, tiny], [1.0, a]]),
            ("two real eigenvalues", [[a, 0.0], [0.0, b]]),
            ("an eigenvalue 0", [[a, 0.0], [0.0, 0.0]]),
            ("an eigenvalue near 0", [[a, 0.0], [0.0, tiny]]),
            ("a shear", [[0.0, b], [0.0, 0.0]]),
            ("a shear that scales", [[a, b], [0.0, a]]),
            ("hardly a motion", [[tiny * a, -tiny], [tiny * b, tiny]]),
        ];
        for (name, rows) in shapes {
            for matrix in [linear(rows), frame * linear(rows) * inverse] {
                let offset = random.planar_point();
                let generator = Generator {
                    linear: matrix,
                    offset,
                };
                all.push((name, generator));
            }
        }
        let turns = Generator::spiral(random.planar_point(), 40.0 * random.signed(), 1.0);
        all.push(("many turns", turns));
        all.push((
            "a translation",
            Generator::translation(random.planar_point()),
        ));
    }
    all
}

// ---- the flow
// -------------------------------------------------------------------------------------------------

#[test]
fn poses_agree_with_the_exact_exponential() {
    // Expected: a few units in the last place of the natural size, which for the entries is at most
    // e^(|t| |M|), times |t M|.
    let mut random = Random::from_state(1);
    let mut worst = [0.0_f64; 2];
    for (name, generator) in generators(&mut random) {
        let flow = Flow::new(generator);
        for t in [1.0, -0.5, 0.125 + random.signed()] {
            let (found, expected) = (flow.pose_at(t), exponential(&generator, t));
            let reach = 1.0 + size(&generator.linear) * t.abs();
            let norm = size(&expected.matrix2).max(1.0);
            let unit = f64::EPSILON * reach * norm;
            let [first, second] = errors(
                &found,
                &expected,
                [unit, unit * generator.offset.length().max(1e-300) * t.abs()],
            );
            assert!(
                first < 4.0 && second < 4.0,
                "{name}, {generator:?} at {t}: {first} and {second} units"
            );
            worst = [worst[0].max(first), worst[1].max(second)];
        }
    }
    println!("largest errors: {worst:?} units");
}

#[test]
fn eigenvalues_far_apart_keep_the_larger_one_exact() {
    // Eigenvalues twelve powers of ten apart: in general frames the error is relative to the larger
    // one, along the axes to each of them.
    let mut random = Random::from_state(7);
    for case in 0..200 {
        let [fast, slow] = [14.0 * random.signed(), -14.0 * random.signed()];
        let frame = DMat2::from_angle(PI * random.signed());
        let along_axes = DMat2::from_diagonal(DVec2::new(fast, slow));
        for (linear, is_along_axes) in [
            (along_axes, true),
            (frame * along_axes * frame.transpose(), false),
        ] {
            let generator = Generator {
                linear,
                offset: random.planar_point(),
            };
            let (found, expected) = (
                Flow::new(generator).pose_at(1.0),
                exponential(&generator, 1.0),
            );
            let unit = f64::EPSILON * (1.0 + fast.abs().max(slow.abs()));
            let norm = size(&expected.matrix2).max(1.0);
            let [first, second] = errors(&found, &expected, [unit * norm; 2]);
            assert!(
                first < 4.0 && second < 4.0,
                "case {case}: {first} and {second} units"
            );
            if is_along_axes {
                let gaps = (found.matrix2.y_axis.y - expected.matrix2.y_axis.y).abs()
                    / expected.matrix2.y_axis.y;
                assert!(gaps < unit, "case {case}: the slow one is off by {gaps:e}");
            }
        }
    }
}

#[test]
fn shears_and_stretches_along_the_axes_have_no_limit() {
    for (rows, way) in [
        ([[1.0, 1e12], [0.0, 1.0]], DVec2::new(1.0, 2.0)),
        ([[2.0, 0.0], [1e9, 3.0]], DVec2::new(-1.0, 2.0)),
        ([[1e12, 0.0], [0.0, 1.0]], DVec2::new(3.0, 2.0)),
        ([[1e-9, 0.0], [0.0, 1e9]], DVec2::new(3.0, 2.0)),
    ] {
        let a = affinity(linear(rows), way);
        let log = logarithm(&a).expect("a logarithm");
        let back = exponential(log.flow.generator(), 1.0);
        let found = log.flow.pose_at(1.0);
        for pose in [back, found] {
            let [first, second] = errors(&pose, &a, [size(&a.matrix2), way.length()]);
            assert!(
                first < 1e-13 && second < 1e-13 * size(&a.matrix2).max(1.0),
                "{rows:?}: {first:e} and {second:e}"
            );
        }
    }
    // A point that is fixed by an axis-aligned stretch by 1e12 is fixed halfway too.
    let a = affinity(DMat2::from_diagonal(DVec2::new(1e12, 1.0)), DVec2::Y);
    let half = logarithm(&a).expect("a logarithm").flow.pose_at(0.5);
    assert_eq!(half.translation, DVec2::Y * 0.5, "exactly half of the way");
}

#[test]
fn two_flows_in_a_row_are_one() {
    let mut random = Random::from_state(2);
    for (name, generator) in generators(&mut random) {
        let flow = Flow::new(generator);
        let [s, t] = [random.signed(), random.signed()];
        let (twice, once) = (flow.pose_at(s) * flow.pose_at(t), flow.pose_at(s + t));
        let growth = [s, t, s + t].map(|t| size(&flow.pose_at(t).matrix2).max(1.0));
        let unit =
            f64::EPSILON * (1.0 + size(&generator.linear)) * growth[0] * growth[1].max(growth[2]);
        let [first, second] = errors(&twice, &once, [unit, unit * generator.offset.length()]);
        assert!(
            first < 12.0 && second < 12.0,
            "{name}: {first} and {second} units"
        );
    }
}

#[test]
fn the_flow_is_that_of_space_in_a_plane() {
    let mut random = Random::from_state(3);
    for (name, generator) in generators(&mut random) {
        let flow = Flow::new(generator);
        let in_space = motion::Flow::new(generator.in_space());
        for t in [1.0, -0.7] {
            let (planar, spatial) = (flow.pose_at(t), in_space.pose_at(t));
            let point = random.planar_point();
            let found = planar.transform_point2(point);
            let other = spatial.transform_point3(point.extend(0.0));
            let scale = size(&planar.matrix2).max(1.0) * (1.0 + size(&generator.linear));
            assert!(
                (found - other.truncate()).length() < 1e-14 * scale && other.z == 0.0,
                "{name}: {found} and {other}"
            );
        }
    }
}

// ---- the logarithm
// -------------------------------------------------------------------------------------------------

/// The relative condition of the logarithm at `a`: how much its linear part moves with the entries,
/// by differences.
fn condition(a: &DMat2) -> f64 {
    let step = 1e-6 * size(a);
    let base = logarithm(&affinity(*a, DVec2::ZERO)).expect("a logarithm");
    let base = base.flow.generator().linear;
    let mut largest = 0.0_f64;
    for k in 0..4 {
        let mut entries = a.to_cols_array();
        entries[k] += step;
        let moved = affinity(DMat2::from_cols_array(&entries), DVec2::ZERO);
        if let Ok(moved) = logarithm(&moved) {
            largest = largest.max(size(&(moved.flow.generator().linear - base)) / step);
        }
    }
    2.0 * largest * size(a) / size(&base).max(1e-300)
}

#[test]
fn the_logarithm_of_an_exact_exponential_is_its_generator() {
    // Within 20 condition numbers times the unit roundoff, as for the golden cases in space; the
    // round trip to 1e-13.
    let mut random = Random::from_state(4);
    let mut worst = [0.0_f64; 3];
    for (name, generator) in generators(&mut random) {
        let generator = if name == "many turns" {
            generator.scaled(3.0 / 40.0)
        } else {
            generator
        };
        let [x, y] = [generator.linear.x_axis, generator.linear.y_axis];
        let disc = (0.5 * (x.x - y.y)).powi(2) + y.x * x.y;
        if disc < -9.0 {
            continue; // Beyond half a turn the principal logarithm is another one.
        }
        let a = exponential(&generator, 1.0);
        let log = logarithm(&a).unwrap_or_else(|error| panic!("{name}, {generator:?}: {error}"));
        assert!(log.unique(), "{name}: {generator:?}");
        let found = log.flow.generator();
        let relative = size(&(found.linear - generator.linear))
            / size(&generator.linear).max(f64::MIN_POSITIVE);
        // Near the identity, the entries of A determine the generator only to an absolute error.
        let kappa = if generator.linear == DMat2::ZERO {
            1.0
        } else {
            condition(&a.matrix2).max(size(&a.matrix2) / size(&generator.linear))
        };
        let units = relative / (kappa * f64::EPSILON);
        assert!(units < 20.0, "{name}, {generator:?}: {units} units");
        let back = exponential(found, 1.0);
        let [first, second] = errors(
            &back,
            &a,
            [
                size(&a.matrix2),
                a.translation.length().max(1e-300) * size(&a.matrix2).max(1.0),
            ],
        );
        assert!(
            first < 1e-13 && second < 1e-13,
            "{name}, {generator:?}: round trip {first:e} and {second:e}"
        );
        worst = [
            worst[0].max(units),
            worst[1].max(first),
            worst[2].max(second),
        ];
    }
    println!("largest errors: {worst:?}");
}

#[test]
fn nothing_is_lost_as_an_eigenvalue_nears_one() {
    // SAM's method through the fixed point loses all digits here (at 1e-15 from 1: error 2).
    for exponent in 1..17 {
        let excess = if exponent == 16 {
            0.0
        } else {
            10.0_f64.powi(-exponent)
        };
        for frame in 0..4 {
            let frame = DMat2::from_angle(0.3 + f64::from(frame));
            let generator = Generator {
                linear: frame * DMat2::from_diagonal(DVec2::new(excess, 0.7)) * frame.transpose(),
                offset: frame * DVec2::new(0.8, -0.4),
            };
            let log = logarithm(&exponential(&generator, 1.0)).expect("a logarithm");
            let (found, expected) = (log.flow.pose_at(0.5), exponential(&generator, 0.5));
            let gap = (found.translation - expected.translation).length();
            assert!(
                gap < 2e-15 * expected.translation.length(),
                "1 + {excess:e}: {gap:e}"
            );
        }
    }
}

#[test]
fn a_half_turn_with_scale_is_flagged_and_met() {
    for scale in [1.0, 0.25, 3.0, 1e-6, 1e6] {
        for centre in [DVec2::ZERO, DVec2::new(3.0, -2.0)] {
            let matrix2 = DMat2::from_angle(PI) * scale;
            let a = affinity(matrix2, centre - matrix2 * centre);
            let log = logarithm(&a).expect("a logarithm");
            assert!(!log.unique(), "both senses lead there");
            let end = log.flow.pose_at(1.0);
            let length = (1.0 + scale) * (1.0 + centre.length());
            let [first, second] = errors(&end, &a, [scale, length]);
            assert!(
                first < 1e-15 && second < 1e-15,
                "scale {scale}: {first:e}, {second:e}"
            );
            let quarter = log.flow.pose_at(0.5).matrix2;
            let expected = DMat2::from_angle(FRAC_PI_2) * scale.sqrt();
            assert!(
                size(&(quarter - expected)) < 1e-15 * size(&expected),
                "halfway a quarter turn, counter-clockwise: {quarter}"
            );
        }
    }
    for (missing, unique) in [
        (1.1e-9, true),
        (-1.1e-9, true),
        (0.9e-9, false),
        (-6e-17, false),
    ] {
        let nearly = affinity(DMat2::from_angle(PI - missing), DVec2::X);
        assert_eq!(
            logarithm(&nearly).expect("a logarithm").unique(),
            unique,
            "less than half a turn by {missing:e}"
        );
    }
}

#[test]
fn refusals_have_names() {
    let refused = |rows| logarithm(&affinity(linear(rows), DVec2::X)).expect_err("must be refused");
    assert_eq!(
        refused([[1.0, 0.0], [0.0, -2.0]]),
        MotionError::Reflection { determinant: -2.0 }
    );
    assert_eq!(refused([[1.0, 2.0], [2.0, 4.0]]), MotionError::Singular);
    assert_eq!(refused([[0.0, 0.0], [0.0, 0.0]]), MotionError::Singular);
    // The rank is one, but the determinant in floating point is not 0.
    assert_eq!(refused([[0.1, 0.3], [0.2, 0.6]]), MotionError::Singular);
    let unequal = refused([[-1.0, 0.0], [0.0, -2.0]]);
    assert_eq!(
        unequal,
        MotionError::NoRealLogarithm {
            eigenvalues: [-2.0, -1.0]
        }
    );
    assert!(
        unequal
            .to_string()
            .contains("its negative eigenvalues -2 and -1 are not an equal pair"),
        "{unequal}"
    );
    assert_eq!(
        refused([[-1.0, 1.0], [0.0, -1.0]]),
        MotionError::NoRealLogarithm {
            eigenvalues: [-1.0, -1.0]
        },
        "a Jordan block"
    );
    assert_eq!(
        refused([[f64::NAN, 0.0], [0.0, 1.0]]),
        MotionError::NonFinite { what: "matrix" }
    );
    // Jordan blocks in any frame: the sign of their discriminant is only rounding.
    let mut random = Random::from_state(5);
    for case in 0..1000 {
        let frame = random.planar_matrix();
        if frame.determinant().abs() < 0.1 {
            continue;
        }
        let scale = 10.0_f64.powf(3.0 * random.signed());
        let block = linear([[-1.0, random.signed()], [0.0, -1.0]]) * scale;
        let matrix = frame * block * frame.inverse();
        assert!(
            matches!(
                logarithm(&affinity(matrix, DVec2::ZERO)),
                Err(MotionError::NoRealLogarithm { .. })
            ),
            "case {case}: {matrix}"
        );
    }
}

#[test]
fn units_do_not_matter() {
    for unit in [1e-12, 1e-3, 1.0, 1e6, 1e12] {
        let a = affinity(DMat2::from_angle(2.0), DVec2::new(1.0, -2.0) * unit);
        let end = logarithm(&a).expect("a logarithm").flow.pose_at(1.0);
        let [first, second] = errors(&end, &a, [1.0, unit]);
        assert!(
            first < 1e-15 && second < 2e-15,
            "unit {unit:e}: {first:e}, {second:e}"
        );
    }
    for scale in [1e-100, 1e-9, 1e9, 1e100] {
        let a = affinity(DMat2::from_angle(2.0) * scale, DVec2::ZERO);
        let end = logarithm(&a).expect("a logarithm").flow.pose_at(1.0);
        assert!(
            size(&(end.matrix2 - a.matrix2)) < 1e-13 * scale,
            "scale {scale:e}"
        );
    }
}

// ---- SAM's numbers
// -------------------------------------------------------------------------------------------------

#[test]
fn the_example_of_the_paper_is_met() {
    // SAM 3.3: B a quarter turn, C a translation by (6, 0); the printed X_SAM is A^(1/2).
    let (b, c) = (
        DAffine2::from_angle(FRAC_PI_2),
        DAffine2::from_translation(DVec2::new(6.0, 0.0)),
    );
    let log = logarithm(&(c * b.inverse())).expect("a logarithm");
    let s = 1.0 / SQRT_2;
    let printed = affinity(
        linear([[s, s], [-s, s]]),
        DVec2::new(3.0, 3.0 * SQRT_2 - 3.0),
    );
    let half = log.flow.pose_at(0.5);
    let [first, second] = errors(&half, &printed, [1.0, 1.0]);
    assert!(first < 1e-15 && second < 2e-15, "{half}");
    let fixed = half.transform_point2(DVec2::new(3.0, -3.0));
    assert!(
        (fixed - DVec2::new(3.0, -3.0)).length() < 2e-15,
        "the centre of the turn stays: {fixed}"
    );
    let keys = [(0.0, b), (1.0, c)].map(|(time, pose)| Keyframe { time, pose });
    let middle = Motion::from_keyframes(&keys)
        .expect("legal")
        .pose_at_time(0.5);
    let expected = affinity(
        linear([[s, -s], [s, s]]),
        DVec2::new(3.0, 1.242_640_687_119_29),
    );
    let [first, second] = errors(&middle, &expected, [1.0, 1.0]);
    assert!(first < 1e-15 && second < 1e-14, "{middle}");
}

#[test]
fn a_shear_carries_the_origin_along_a_parabola() {
    // SAM A.4(3) as corrected: L = [1 1; 0 1], t = (.3, .7): tau = (-.05, .7), halfway (.0625,
    // .35).
    let a = affinity(linear([[1.0, 1.0], [0.0, 1.0]]), DVec2::new(0.3, 0.7));
    let flow = logarithm(&a).expect("a logarithm").flow;
    let tau = flow.generator().offset;
    assert!((tau - DVec2::new(-0.05, 0.7)).length() < 1e-16, "{tau}");
    let half = flow.pose_at(0.5).translation;
    assert!((half - DVec2::new(0.0625, 0.35)).length() < 1e-16, "{half}");
}

#[test]
fn motions_exist_where_the_paper_says() {
    // SAM (4) over the grid of its Fig. 6: a from -pi to pi, s from 0 to 1; 181 x 50 = 9050 points.
    let (mut solvable, mut in_trapezoid) = (0, 0);
    for i in -90_i32..=90 {
        for k in 1..=50 {
            let (a, s) = (f64::from(i) / 90.0 * PI, f64::from(k) / 50.0);
            let limit = (-2.0 * s / (s * s + 1.0)).acos();
            assert!((limit - (FRAC_PI_2 + 2.0 * s.atan())).abs() < 1e-7, "s {s}");
            // The largest angle at s = 1 is the half turn itself: there is a motion, but not only
            // one.
            let expected = a.abs() < limit || s == 1.0;
            // A quarter-turn frame, and a general one.
            for c in [0.0, 0.7] {
                let matrix = DMat2::from_angle(a - c)
                    * DMat2::from_diagonal(DVec2::new(1.0 / s, s))
                    * DMat2::from_angle(c);
                let found = logarithm(&affinity(matrix, DVec2::ZERO));
                match &found {
                    Ok(log) => assert_eq!(
                        log.unique(),
                        !(s == 1.0 && i.abs() == 90),
                        "a {a}, s {s}, c {c}"
                    ),
                    Err(error) => assert!(
                        matches!(error, MotionError::NoRealLogarithm { .. }),
                        "a {a}, s {s}, c {c}: {error}"
                    ),
                }
                assert_eq!(found.is_ok(), expected, "a {a}, s {s}, c {c}");
            }
            solvable += usize::from(expected);
            if a.abs() < (1.0 + s) * FRAC_PI_2 {
                in_trapezoid += 1;
                assert!(expected, "the trapezoid is good: a {a}, s {s}");
            }
        }
    }
    // The share of the good region is 1/2 + (2/pi) integral of atan s = 0.7794, that of the
    // trapezoid 3/4.
    let share = |count: usize| count as f64 / 9050.0;
    assert!((share(solvable) - 0.7794).abs() < 0.01, "{solvable}");
    assert!((share(in_trapezoid) - 0.75).abs() < 0.01, "{in_trapezoid}");
}

// ---- bounds
// -------------------------------------------------------------------------------------------------

#[test]
fn bounds_hold_and_are_near_what_is_sampled() {
    let mut random = Random::from_state(6);
    for (name, generator) in generators(&mut random).into_iter().step_by(3) {
        let (flow, point) = (Flow::new(generator), random.planar_point());
        let acceleration = acceleration_bound(&generator, point, [0.0, 1.0]);
        let [low, high] = path_bounds(&generator, point, [0.0, 1.0]);
        let norm = stretch(&generator.linear, [0.0, 1.0]);
        let mut sampled = [0.0_f64; 2];
        for step in 0..=200 {
            let pose = flow.pose_at(f64::from(step) / 200.0);
            let position = pose.transform_point2(point);
            let slack = 1e-14 * (1.0 + position.length());
            assert!(
                (position - low).min_element() >= -slack
                    && (high - position).min_element() >= -slack,
                "{name}: {position} outside {low} {high}"
            );
            sampled[0] = sampled[0].max(generator.acceleration(position).length());
            let columns = pose.matrix2;
            let spectral = {
                let square = columns.transpose() * columns;
                let [x, y] = [square.x_axis, square.y_axis];
                let (mean, half) = (0.5 * (x.x + y.y), 0.5 * (x.x - y.y));
                (mean + half.hypot(x.y)).sqrt()
            };
            sampled[1] = sampled[1].max(spectral);
        }
        assert!(
            acceleration >= sampled[0] * (1.0 - 1e-13),
            "{name}: acceleration {acceleration} below {}",
            sampled[0]
        );
        assert!(
            acceleration <= 1.05 * sampled[0] + 1e-12,
            "{name}: acceleration {acceleration} for {}",
            sampled[0]
        );
        assert!(
            norm >= sampled[1] * (1.0 - 1e-14) && norm <= 1.03 * sampled[1],
            "{name}: stretch {norm} for {}",
            sampled[1]
        );
    }
}

// ---- the binary
// -------------------------------------------------------------------------------------------------

fn described(scratch: &Scratch, arguments: &str) -> Value {
    let run = scratch.run(&format!("motion {arguments} --json"));
    assert_eq!(run.code, Some(0), "{arguments}: {}", run.err);
    serde_json::from_str(&run.out).expect("one JSON object")
}

#[test]
fn planar_options_are_described_with_the_keys_of_the_contract() {
    let scratch = Scratch::new("planar_options");
    let report = described(&scratch, "--turn -540 --through 1,-2 --scale .5");
    let span = &report["spans"][0];
    assert_eq!(span["kind"], "spiral");
    let keys: Vec<&String> = span.as_object().expect("an object").keys().collect();
    assert_eq!(
        keys,
        [
            "advance",
            "axis",
            "duration",
            "eigenvalues",
            "fixed_point",
            "generator",
            "half_turn",
            "kind",
            "margin",
            "scale",
            "through",
            "turn_deg",
            "unique",
            "volume_factor"
        ]
    );
    let number = |pointer: &str| {
        span.pointer(pointer)
            .and_then(Value::as_f64)
            .expect(pointer)
    };
    assert!((number("/turn_deg") + 540.0).abs() < 1e-12, "{span}");
    assert!((number("/through/1") + 2.0).abs() < 1e-14, "{span}");
    assert!((number("/generator/0/0") - 0.5_f64.ln()).abs() < 1e-15);
    assert!((number("/generator/0/1") - 3.0 * PI).abs() < 1e-15);
    assert_eq!(span["generator"].as_array().expect("rows").len(), 2);
    assert!(
        span["axis"].is_null() && span["advance"].is_null(),
        "{span}"
    );
    let text = scratch.run("motion --translate 3,-4").out;
    assert!(
        text.contains("translation in the plane") && text.contains("(0.6, -0.8)"),
        "{text}"
    );
}

#[test]
fn a_planar_file_is_described_in_the_plane() {
    let scratch = Scratch::new("planar_file");
    scratch.write(
        "path.json",
        r#"{"keyframes": [{"matrix": [[1,0,0],[0,1,0]]}, {"translation": [0,3], "rotation_deg": 180}, {"translation": [5,3], "rotation_deg": 180}]}"#,
    );
    let report = described(&scratch, "--motion path.json");
    let kinds: Vec<&str> = report["spans"]
        .as_array()
        .expect("spans")
        .iter()
        .filter_map(|span| span["kind"].as_str())
        .collect();
    assert_eq!(kinds, ["rotation", "translation"]);
    assert_eq!(report["spans"][0]["unique"], false, "a half turn");
    assert_eq!(report["spans"][0]["half_turn"], "+", "{report}");
    assert_eq!(report["spans"][0]["turn_deg"], 180.0, "{report}");
    let centre = &report["spans"][0]["through"];
    assert!(
        (centre[1].as_f64().expect("a number") - 1.5).abs() < 1e-15,
        "{centre}"
    );
}

#[test]
fn a_planar_motion_does_not_move_a_mesh() {
    let scratch = Scratch::new("planar_for_mesh");
    scratch.write("cube.obj", command::CUBE);
    scratch.write(
        "path.json",
        r#"{"spans": [{"turn_deg": 90, "through": [1,2]}]}"#,
    );
    let cases = [
        ("--translate 1,2", "--translate has two numbers"),
        (
            "--turn 90 --axis 0,0,1 --through 1,2",
            "--through has two numbers",
        ),
        ("--motion path.json", "a mesh needs one in space"),
    ];
    for (motion, expected) in cases {
        let run = scratch.run(&format!("sweep cube.obj {motion}"));
        assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{motion}");
        assert!(run.err.contains(expected), "{motion}: {}", run.err);
    }
}
