//! Steady motions against independent results: golden logarithms (65 digits), a naive exponential,
//! the numbers of the papers, and laws.

use crate::support::random::Random;
use crate::support::taylor::{affine, naive_exponential};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use serde_json::Value;
use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};
use steadysweep::motion::{Flow, Generator, Keyframe, Motion, MotionError, Span, logarithm};

// ---- references
// -------------------------------------------------------------------------------------------------

fn frobenius(matrix: &DMat3) -> f64 {
    matrix
        .to_cols_array()
        .iter()
        .map(|x| x * x)
        .sum::<f64>()
        .sqrt()
}

/// Relative differences of the linear parts and of the translations, each relative to its own size.
fn difference(found: &DAffine3, expected: &DAffine3) -> [f64; 2] {
    let relative = |error: f64, size: f64| if error == 0.0 { 0.0 } else { error / size };
    [
        relative(
            frobenius(&(found.matrix3 - expected.matrix3)),
            frobenius(&expected.matrix3),
        ),
        relative(
            (found.translation - expected.translation).length(),
            expected.translation.length(),
        ),
    ]
}

/// About any axis, by any angle.
fn rotation(random: &mut Random) -> DMat3 {
    let axis = random.point(1.0).normalize();
    DMat3::from_quat(DQuat::from_axis_angle(axis, PI * random.signed()))
}

// ---- golden
// -------------------------------------------------------------------------------------------------

struct Golden {
    class: String,
    a: DAffine3,
    exists: bool,
    unique: bool,
    log: Option<DAffine3>,
    power: Option<DAffine3>,
    condition: f64,
}

fn golden() -> Vec<Golden> {
    let text = include_str!("../data/motion/golden.json");
    let file: Value = serde_json::from_str(text).expect("golden.json is JSON");
    let matrix = |value: &Value| -> Option<DAffine3> {
        let numbers: Vec<f64> = value
            .as_array()?
            .iter()
            .map(|x| x.as_f64().expect("a number"))
            .collect();
        Some(affine(std::array::from_fn(|i| {
            std::array::from_fn(|j| numbers[4 * i + j])
        })))
    };
    file["cases"]
        .as_array()
        .expect("a list of cases")
        .iter()
        .map(|case| Golden {
            class: case["class"].as_str().expect("a class").to_owned(),
            a: matrix(&case["a"]).expect("twelve numbers"),
            exists: case["exists"].as_bool().expect("a verdict"),
            unique: case["unique"].as_bool().unwrap_or(true),
            log: matrix(&case["log"]),
            power: matrix(&case["pow03"]),
            condition: case["kappa"].as_f64().unwrap_or(1.0),
        })
        .collect()
}

/// The required accuracy: 20 kappa 2.2e-16 of the size.
fn forward_bar(case: &Golden) -> f64 {
    20.0 * case.condition.max(1.0) * f64::EPSILON
}

#[test]
fn golden_logarithms_are_within_their_condition() {
    let mut compared = 0;
    for (index, case) in golden().iter().enumerate().filter(|(_, case)| case.exists) {
        let log = logarithm(&case.a)
            .unwrap_or_else(|error| panic!("case {index} {}: {error}", case.class));
        if !case.unique {
            assert!(
                !log.unique(),
                "case {index} {}: a half turn must be flagged",
                case.class
            );
            continue;
        }
        if case.class == "rot180_rounded" {
            continue; // the sense of rotation is rounding noise of the input
        }
        let generator = log.flow.generator();
        let found = DAffine3 {
            matrix3: generator.linear,
            translation: generator.offset,
        };
        let expected = case.log.as_ref().expect("an existing logarithm is given");
        let bar = forward_bar(case);
        let [linear, offset] = difference(&found, expected);
        assert!(
            linear <= bar,
            "case {index} {}: M off by {linear:e}, bar {bar:e}",
            case.class
        );
        assert!(
            offset <= bar,
            "case {index} {}: tau off by {offset:e}, bar {bar:e}",
            case.class
        );
        compared += 1;
    }
    assert_eq!(
        compared, 440,
        "480 logarithms less 20 of double_neg and 20 of rot180_rounded"
    );
}

#[test]
fn golden_round_trips_are_exact_to_rounding() {
    for (index, case) in golden().iter().enumerate().filter(|(_, case)| case.exists) {
        let log = logarithm(&case.a)
            .unwrap_or_else(|error| panic!("case {index} {}: {error}", case.class));
        let [linear, translation] = difference(&log.flow.pose_at(1.0), &case.a);
        // Shears of 1e8: relative to ||A|| kappa instead, where ||A|| acts on the translation.
        let bar = if case.class == "big_shear" {
            1e-12 * frobenius(&case.a.matrix3) * case.condition.max(1.0)
        } else {
            1e-12
        };
        assert!(
            linear <= 1e-12,
            "case {index} {}: linear part off by {linear:e}",
            case.class
        );
        assert!(
            translation <= bar,
            "case {index} {}: translation off by {translation:e}",
            case.class
        );
    }
}

#[test]
fn golden_powers_are_within_their_condition() {
    for (index, case) in golden()
        .iter()
        .enumerate()
        .filter(|(_, case)| case.exists && case.unique)
    {
        if case.class == "rot180_rounded" {
            continue;
        }
        let log = logarithm(&case.a)
            .unwrap_or_else(|error| panic!("case {index} {}: {error}", case.class));
        let expected = case.power.as_ref().expect("an existing power is given");
        let bar = forward_bar(case);
        for (part, error) in ["linear part", "translation"]
            .iter()
            .zip(difference(&log.flow.pose_at(0.3), expected))
        {
            assert!(
                error <= bar,
                "case {index} {}: {part} off by {error:e}, bar {bar:e}",
                case.class
            );
        }
    }
}

#[test]
fn golden_affinities_without_a_real_logarithm_are_refused_by_name() {
    let mut refused = [0, 0];
    for (index, case) in golden().iter().enumerate().filter(|(_, case)| !case.exists) {
        let error = logarithm(&case.a).expect_err("there is no real logarithm");
        let named = match (&error, case.class.as_str()) {
            (MotionError::Reflection { determinant }, "nolog_det") => {
                refused[0] += 1;
                *determinant < 0.0
            }
            (MotionError::NoRealLogarithm { eigenvalues }, "nolog" | "nolog_jordan") => {
                refused[1] += 1;
                eigenvalues[0] <= eigenvalues[1] && eigenvalues[1] < 0.0
            }
            _ => false,
        };
        assert!(named, "case {index} {}: {error:?}", case.class);
    }
    assert_eq!(refused, [20, 40], "60 cases");
}

// ---- the exponential
// -------------------------------------------------------------------------------------------------

fn check_flow(generator: &Generator, t: f64, bar: f64) {
    let found = Flow::new(*generator).pose_at(t);
    let expected = naive_exponential(generator, t);
    // The translation is measured against |t| |tau| times the growth, from which it is computed, so
    // that a closed circle has a size.
    let size = frobenius(&expected.matrix3);
    let linear = frobenius(&(found.matrix3 - expected.matrix3)) / size;
    let length = expected
        .translation
        .length()
        .max(size * t.abs() * generator.offset.length());
    let translation =
        (found.translation - expected.translation).length() / length.max(f64::MIN_POSITIVE);
    assert!(
        linear <= bar,
        "{generator:?} at {t}: linear part off by {linear:e}, bar {bar:e}"
    );
    assert!(
        translation <= bar,
        "{generator:?} at {t}: translation off by {translation:e}, bar {bar:e}"
    );
}

#[test]
fn the_flow_agrees_with_a_naive_exponential() {
    let mut random = Random::from_state(1);
    for _ in 0..2000 {
        for size in [1e-9, 1e-3, 0.3, 1.0, 3.0, 8.0] {
            let generator = Generator {
                linear: random.matrix(1.0) * size,
                offset: random.point(1.0),
            };
            // Squaring k times multiplies the rounding of the reference by |M|; conditioning
            // multiplies ours.
            check_flow(&generator, 1.0, 1e-14 * (1.0 + 20.0 * size));
        }
    }
}

#[test]
fn any_angle_of_turn_is_right() {
    let mut random = Random::from_state(2);
    for degrees in [
        90.0,
        180.0,
        359.999_999_9,
        360.0,
        360.000_000_1,
        540.0,
        720.0,
        1080.0,
        3600.0,
        36_000.0,
    ] {
        for scale in [1.0, 0.6, 3.0] {
            let turn = f64::to_radians(degrees);
            let generator = Generator::screw(
                random.point(1.0).normalize(),
                random.point(1.0),
                turn,
                0.7,
                scale,
            );
            check_flow(&generator, 1.0, 1e-14 * (1.0 + turn));
            check_flow(&generator, -0.37, 1e-14 * (1.0 + turn));
        }
        // A complex pair beyond pi with a coupled real eigenvalue, in a skewed frame.
        let frame = random.matrix(1.0) * 0.3 + DMat3::IDENTITY;
        let spiral = Generator::screw(DVec3::Z, DVec3::ZERO, f64::to_radians(degrees), 0.0, 0.8)
            .linear
            + DMat3::from_diagonal(DVec3::Z * 0.3);
        let linear = frame * spiral * frame.inverse();
        check_flow(
            &Generator {
                linear,
                offset: random.point(1.0),
            },
            1.0,
            1e-13 * (1.0 + f64::to_radians(degrees)),
        );
    }
}

#[test]
fn confluent_and_defective_generators_are_right() {
    let mut random = Random::from_state(3);
    let rows = |a: [[f64; 3]; 3]| DMat3::from_cols_array_2d(&a).transpose();
    for gap in [0.0, 1e-16, 1e-12, 1e-8, 1e-4, 1e-2, 0.5, 2.0] {
        for level in [-3.0, -1.0, 0.0, 1e-9, 1.0, 2.5] {
            let forms = [
                rows([
                    [level, 1.0, 0.0],
                    [0.0, level + gap, 1.0],
                    [0.0, 0.0, level - gap],
                ]),
                rows([[level, 1.0, 2.0], [0.0, level, gap], [0.0, -gap, level]]),
                rows([
                    [level + gap, 0.0, 1.0],
                    [0.0, level, 1.0],
                    [0.0, 0.0, level],
                ]),
                rows([
                    [level, 0.0, 0.0],
                    [0.0, level + 3.0, 1.0],
                    [0.0, -gap, level + 3.0],
                ]),
                rows([
                    [level, 1.0, 1.0],
                    [0.0, level + 6.0, gap],
                    [0.0, 0.0, level - 6.0],
                ]),
            ];
            for form in forms {
                let frame = rotation(&mut random);
                let generator = Generator {
                    linear: frame * form * frame.transpose(),
                    offset: random.point(1.0),
                };
                check_flow(&generator, 1.0, 2e-13);
                check_flow(
                    &Generator {
                        linear: form,
                        offset: random.point(1.0),
                    },
                    1.0,
                    2e-13,
                );
            }
        }
    }
}

#[test]
fn whole_turns_close() {
    let mut random = Random::from_state(4);
    for turns in 1..=5 {
        let through = random.point(1.0);
        let generator = Generator::screw(
            random.point(1.0).normalize(),
            through,
            2.0 * PI * f64::from(turns),
            0.0,
            1.0,
        );
        let end = Flow::new(generator).pose_at(1.0);
        // A turn rounded to f64 has a relative error of 2^-53, and so has the axis.
        let bar = 4e-15 * f64::from(turns);
        let linear = frobenius(&(end.matrix3 - DMat3::IDENTITY));
        assert!(linear < bar, "{turns} turns: {linear:e}");
        assert!(
            end.translation.length() < bar * (1.0 + through.length()),
            "{turns} turns: {}",
            end.translation
        );
    }
}

#[test]
fn nothing_happens_at_time_zero_and_translations_are_exact() {
    let mut random = Random::from_state(5);
    let generator = Generator {
        linear: random.matrix(1.0),
        offset: random.point(1.0),
    };
    assert_eq!(
        Flow::new(generator).pose_at(0.0),
        DAffine3::IDENTITY,
        "exactly"
    );
    let displacement = DVec3::new(0.1, -1e6, 1e-9);
    let flow = Flow::new(Generator::translation(displacement));
    for t in [1.0, 0.3, -2.5] {
        assert_eq!(
            flow.pose_at(t),
            DAffine3::from_translation(displacement * t),
            "exactly, at {t}"
        );
    }
    let scaling = Flow::new(Generator {
        linear: DMat3::IDENTITY * 0.5,
        offset: DVec3::ZERO,
    });
    assert_eq!(
        scaling.pose_at(1.0).matrix3,
        DMat3::IDENTITY * 0.5_f64.exp(),
        "a scaling has no rounding but exp's"
    );
}

// ---- laws
// -------------------------------------------------------------------------------------------------

#[test]
fn the_exponential_of_the_logarithm_is_the_affinity() {
    let mut random = Random::from_state(6);
    let mut solved = 0;
    for case in 0..20_000 {
        let unit = [1.0, 1e-3, 1e6][case % 3];
        let shape = [1.0, 0.3, 1e-4][case % 3];
        let matrix3 = rotation(&mut random) + random.matrix(1.0) * shape;
        let a = DAffine3 {
            matrix3,
            translation: random.point(1.0) * unit,
        };
        if let Ok(log) = logarithm(&a) {
            let [linear, translation] = difference(&log.flow.pose_at(1.0), &a);
            assert!(
                linear < 1e-12 && translation < 1e-12,
                "case {case}: off by {linear:e}, {translation:e}: {a:?}"
            );
            solved += 1;
        }
    }
    assert!(
        solved > 12_000,
        "most of these have a logarithm, {solved} were found"
    );
}

#[test]
fn shears_in_any_frame_have_logarithms() {
    let mut random = Random::from_state(11);
    for shear in [1.0, 1e2, 1e4, 1e6] {
        for _ in 0..500 {
            let frame = rotation(&mut random);
            let form = DMat3::from_cols(DVec3::X, DVec3::new(shear, 1.0, 0.0), DVec3::Z);
            let a = DAffine3 {
                matrix3: frame * form * frame.transpose(),
                translation: random.point(1.0),
            };
            let log = logarithm(&a).unwrap_or_else(|error| panic!("shear {shear:e}: {error}"));
            let [linear, translation] = difference(&log.flow.pose_at(1.0), &a);
            // The square of the shear passes through the sums for the translation.
            let bar = 1e-14 * (1.0 + 1e-2 * shear) * (1.0 + shear);
            assert!(
                linear < 1e-10,
                "shear {shear:e}: linear part off by {linear:e}"
            );
            assert!(
                translation < bar,
                "shear {shear:e}: translation off by {translation:e}"
            );
        }
    }
}

#[test]
fn what_rounding_destroys_is_refused_rather_than_answered_wrongly() {
    let mut random = Random::from_state(12);
    let mut ill_conditioned = 0;
    for _ in 0..300 {
        let frame = rotation(&mut random);
        let form = DMat3::from_cols(
            DVec3::X,
            DVec3::new(1e6, 1.0, 0.0),
            DVec3::new(0.0, 1e6, 1.0),
        );
        let a = DAffine3::from_mat3(frame * form * frame.transpose());
        match logarithm(&a) {
            Ok(log) => {
                let [linear, _] = difference(&log.flow.pose_at(1.0), &a);
                assert!(linear < 1e-9, "accepted, but off by {linear:e}");
            }
            Err(MotionError::IllConditioned { residual, limit }) => {
                assert!(residual > limit, "{residual:e} is within {limit:e}");
                ill_conditioned += 1;
            }
            // Rounding alone moved the triple eigenvalue 1 across 0.
            Err(MotionError::Reflection { .. } | MotionError::NoRealLogarithm { .. }) => {}
            Err(error) => panic!("unexpected: {error}"),
        }
    }
    assert!(
        ill_conditioned > 30,
        "two shears of 1e6 ruin {ill_conditioned} of 300"
    );
}

#[test]
fn negative_jordan_blocks_in_any_frame_are_refused() {
    let mut random = Random::from_state(13);
    let mut seen = 0;
    while seen < 1500 {
        let frame = random.matrix(1.0);
        if frame.determinant().abs() < 0.02 {
            continue;
        }
        seen += 1;
        let scale = (2.0 * random.signed()).exp();
        let form = DMat3::from_cols(
            DVec3::new(-scale, 0.0, 0.0),
            DVec3::new(1.0, -scale, 0.0),
            DVec3::new(
                random.signed(),
                random.signed(),
                (2.0 * random.signed()).exp(),
            ),
        );
        let result = logarithm(&DAffine3::from_mat3(frame * form * frame.inverse()));
        assert!(
            matches!(result, Err(MotionError::NoRealLogarithm { .. })),
            "case {seen}: {result:?}"
        );
    }
}

#[test]
fn times_add_up() {
    let mut random = Random::from_state(7);
    for _ in 0..2000 {
        let generator = Generator {
            linear: random.matrix(1.0) * 2.0,
            offset: random.point(1.0),
        };
        let flow = Flow::new(generator);
        let (s, t) = (random.signed(), random.signed());
        let [first, second, both] = [flow.pose_at(s), flow.pose_at(t), flow.pose_at(s + t)];
        let product = second * first;
        // The rounding of the factors is carried by their norms.
        let size = frobenius(&first.matrix3) * frobenius(&second.matrix3);
        let linear = frobenius(&(product.matrix3 - both.matrix3)) / size;
        let translation = (product.translation - both.translation).length() / size;
        assert!(
            linear < 1e-14 && translation < 3e-14,
            "{generator:?}, {s} + {t}: {linear:e} {translation:e}"
        );
    }
}

#[test]
fn a_change_of_frame_changes_the_logarithm_with_it() {
    let mut random = Random::from_state(8);
    for case in 0..1000 {
        let generator = Generator {
            linear: random.matrix(1.0),
            offset: random.point(1.0),
        };
        let frame = DAffine3 {
            matrix3: rotation(&mut random) * [1.0, 1e-3, 25.4][case % 3],
            translation: random.point(1.0),
        };
        let here = Flow::new(generator).pose_at(1.0);
        let there = frame.inverse() * here * frame;
        let log = logarithm(&there).expect("eigenvalues have angles below pi");
        let expected = generator.in_frame(&frame);
        let found = log.flow.generator();
        let linear = frobenius(&(found.linear - expected.linear));
        assert!(linear < 1e-12, "case {case}: linear part off by {linear:e}");
        let offset = (found.offset - expected.offset).length() / expected.offset.length();
        assert!(offset < 1e-11, "case {case}: offset off by {offset:e}");
    }
}

#[test]
fn the_velocity_is_the_derivative_of_the_flow() {
    let mut random = Random::from_state(9);
    for _ in 0..200 {
        let generator = Generator {
            linear: random.matrix(1.0),
            offset: random.point(1.0),
        };
        let flow = Flow::new(generator);
        let (point, t, step) = (random.point(1.0), random.signed(), 1e-4);
        let position = flow.pose_at(t).transform_point3(point);
        let [before, after] = [t - step, t + step].map(|t| flow.pose_at(t).transform_point3(point));
        let speed = (after - before) / (2.0 * step);
        // Central differences: step^2 / 6 of the third derivative, about 100 here, and rounding /
        // step.
        assert!(
            (speed - generator.velocity(position)).length() < 1e-6,
            "velocity at {t}"
        );
        let acceleration = (after - 2.0 * position + before) / (step * step);
        assert!(
            (acceleration - generator.acceleration(position)).length() < 1e-5,
            "acceleration at {t}"
        );
    }
}

// ---- published and derived numbers
// ------------------------------------------------------------------------------------

/// Rossignac & Vinacua, the quarter turn about (3, -3) of their comparison with Alexa's
/// interpolation. Their printed matrix X is A^(1/2), not the pose halfway.
#[test]
fn the_quarter_turn_of_the_paper() {
    let quarter = DQuat::from_rotation_z(FRAC_PI_2);
    let start = DAffine3::from_quat(quarter);
    let end = DAffine3::from_translation(DVec3::new(6.0, 0.0, 0.0));
    let keys = [
        Keyframe {
            time: 0.0,
            pose: start,
        },
        Keyframe {
            time: 1.0,
            pose: end,
        },
    ];
    let motion = Motion::from_keyframes(&keys).expect("a quarter turn");
    let s = 0.5_f64.sqrt();
    let half = motion.spans()[0].flow().pose_at(0.5);
    let expected = affine([
        [s, s, 0.0, 3.0],
        [-s, s, 0.0, 3.0 * SQRT_2 - 3.0],
        [0.0, 0.0, 1.0, 0.0],
    ]);
    assert!(
        difference(&half, &expected)
            .iter()
            .all(|&error| error < 1e-15),
        "A^(1/2) is {half}"
    );
    let middle = motion.pose_at_time(0.5);
    let expected = affine([
        [s, -s, 0.0, 3.0],
        [s, s, 0.0, 1.242_640_687_119_29],
        [0.0, 0.0, 1.0, 0.0],
    ]);
    assert!(
        difference(&middle, &expected)
            .iter()
            .all(|&error| error < 3e-15),
        "the pose half way is {middle}"
    );
    let described = motion.spans()[0].describe();
    let through = described.through.expect("an axis");
    assert!(
        (through - DVec3::new(3.0, -3.0, 0.0)).length() < 1e-14,
        "the fixed point: {through}"
    );
}

/// Rossignac & Vinacua, A.4: in a shear along its own invariant line the path is a parabola. Their
/// formula (a straight line) is wrong; these are the right numbers.
#[test]
fn a_shear_with_translation_moves_the_origin_on_a_parabola() {
    let a = affine([
        [1.0, 1.0, 0.0, 0.3],
        [0.0, 1.0, 0.0, 0.7],
        [0.0, 0.0, 1.0, 0.0],
    ]);
    let log = logarithm(&a).expect("a shear has a logarithm");
    let offset = log.flow.generator().offset;
    assert!(
        (offset - DVec3::new(-0.05, 0.7, 0.0)).length() < 1e-15,
        "tau is {offset}"
    );
    let half = log.flow.pose_at(0.5).translation;
    assert!(
        (half - DVec3::new(0.0625, 0.35, 0.0)).length() < 1e-15,
        "half way {half}"
    );
}

/// Rossignac & Vinacua (4): R(a) diag(s, 1/s) has a real logarithm if and only if
/// |a| < acos(-2s/(s^2+1)) = pi/2 + 2 atan s.
#[test]
fn turned_stretches_are_solvable_up_to_the_published_angle() {
    for s in [0.05_f64, 0.2, 0.5, 0.8, 0.99] {
        let limit = (-2.0 * s / (s * s + 1.0)).acos();
        assert!(
            (limit - (FRAC_PI_2 + 2.0 * f64::atan(s))).abs() < 1e-13,
            "the two forms of the limit at s = {s}"
        );
        let at = |angle: f64| {
            let stretch = DMat3::from_diagonal(DVec3::new(s, 1.0 / s, 1.0));
            logarithm(&DAffine3::from_mat3(
                DMat3::from_rotation_z(angle) * stretch,
            ))
        };
        for sense in [1.0, -1.0] {
            assert!(
                at(sense * (limit - 1e-6)).is_ok(),
                "s = {s}: solvable just below the limit"
            );
            assert!(
                matches!(
                    at(sense * (limit + 1e-6)),
                    Err(MotionError::NoRealLogarithm { .. })
                ),
                "s = {s}: unsolvable just above the limit"
            );
        }
    }
}

/// The perturbation study of Rossignac & Vinacua, repeated: every entry moved by -p, 0 or p.
#[test]
fn perturbed_rotations_keep_their_logarithm() {
    for (largest, p) in [(2.0 * PI / 3.0, 0.295), (FRAC_PI_2, 0.333)] {
        for axis in [
            DVec3::Z,
            DVec3::new(1.0, 1.0, 1.0),
            DVec3::new(1.0, -2.0, 3.0),
        ] {
            for step in 0..=4 {
                let angle = largest * f64::from(step) / 4.0;
                let rotation = DMat3::from_axis_angle(axis.normalize(), angle);
                for pattern in 0..19_683_u32 {
                    let mut digits = pattern;
                    let moved: [f64; 9] = std::array::from_fn(|_| {
                        let digit = digits % 3;
                        digits /= 3;
                        p * (f64::from(digit) - 1.0)
                    });
                    let matrix3 = rotation + DMat3::from_cols_array(&moved);
                    let result = logarithm(&DAffine3::from_mat3(matrix3));
                    assert!(
                        result.is_ok(),
                        "angle {angle}, p {p}, pattern {pattern}: {:?}",
                        result.err()
                    );
                }
            }
        }
    }
}

/// An eigenvalue passes through 1: a fixed point would run through infinity and lose every digit;
/// the generator is not affected.
#[test]
fn accuracy_does_not_depend_on_how_near_an_eigenvalue_is_to_one() {
    let mut random = Random::from_state(10);
    for excess in [1e-1, 1e-5, 1e-9, 1e-13, 1e-15, 0.0, -1e-15, -1e-9, -1e-1] {
        for _ in 0..40 {
            let frame = rotation(&mut random);
            let form = DMat3::from_diagonal(DVec3::new(f64::ln_1p(excess), 0.4, -0.3))
                + DMat3::from_cols(DVec3::ZERO, DVec3::X * 0.5, DVec3::Y * 0.2);
            let generator = Generator {
                linear: frame * form * frame.transpose(),
                offset: random.point(1.0),
            };
            let a = naive_exponential(&generator, 1.0);
            let half = naive_exponential(&generator, 0.5);
            let log = logarithm(&a).expect("positive eigenvalues");
            let [linear, translation] = difference(&log.flow.pose_at(0.5), &half);
            // Measured 1e-15; the reference itself is off by some 1e-14.
            assert!(
                linear < 1e-13 && translation < 1e-13,
                "lambda - 1 = {excess:e}: {linear:e} {translation:e}"
            );
        }
    }
}

#[test]
fn a_screw_of_one_and_a_half_turns_goes_where_it_must() {
    let generator = Generator::screw(DVec3::Z, DVec3::ZERO, 3.0 * PI, 3.0, 1.0);
    let motion =
        Motion::from_spans(vec![Span::new(generator, 2.0).expect("a screw")]).expect("one span");
    for (clock, expected) in [
        (0.0, DVec3::new(1.0, 0.0, 0.0)),
        (1.0 / 3.0, DVec3::new(0.0, 1.0, 0.5)),
        (2.0 / 3.0, DVec3::new(-1.0, 0.0, 1.0)),
        (4.0 / 3.0, DVec3::new(1.0, 0.0, 2.0)),
        (2.0, DVec3::new(-1.0, 0.0, 3.0)),
    ] {
        let found = motion.pose_at_time(clock).transform_point3(DVec3::X);
        assert!(
            (found - expected).length() < 4e-15,
            "at {clock}: {found} instead of {expected}"
        );
    }
}
