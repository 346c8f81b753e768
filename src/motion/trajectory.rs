//! Bounds on the paths of points over a time window.
//!
//! A window is cut into pieces that are short compared with the motion. On each, the path is its
//! chord and a bulge that the second derivative bounds. Every bound holds for the exact flow of the
//! given generator, rounding included.

use super::Generator;
use super::enclosure::{Enclosure, GrowthRates, above, frobenius_bound};
use crate::numeric::tolerance::UNIT_ROUNDOFF as U;
use glam::{DMat3, DVec3};

/// Longest piece for path boxes, as a multiple of 1/|M|: the bulge of a rotation is then 0.2 % of
/// its radius.
const PATH_PIECE: f64 = 0.125;
/// Longest piece for norms, as the logarithm of the factor by which they may grow within it.
const NORM_PIECE: f64 = 0.02;
/// Looseness of the plain growth bound above which cutting into pieces is worth the time.
const LOOSE: f64 = 1.005;
/// Most pieces: with this limit, bounds get looser but not wrong, and a query stays below about
/// 0.1 ms.
const MOST_PIECES: u32 = 256;

/// Upper bound of the spectral norm of exp(t M) for t in `window`; 1 to rounding when M is skew.
///
/// - `window`: `[start, end]` in spans, `start <= end`; need not contain 0.
///
/// # Guarantee
/// Proven, rounding included. Accurate to a few units in the last place for rigid motions and
/// similarities, otherwise to about 2 % of the largest norm while the window is shorter than about
/// 5 growth times.
pub fn stretch(linear: &DMat3, window: [f64; 2]) -> f64 {
    let [start, end] = window;
    let rates = GrowthRates::new(linear);
    let GrowthRates { forward, backward } = rates;
    if !rates.largest().is_finite() {
        return f64::INFINITY;
    }
    let plain = if start >= 0.0 {
        growth(end, start, forward)
    } else if end <= 0.0 {
        growth(-start, -end, backward)
    } else {
        growth(end, 0.0, forward).max(growth(-start, 0.0, backward))
    };
    let norm_at = |t: f64| {
        if t == 0.0 {
            1.0
        } else {
            Enclosure::new(linear, t, &rates).norm()
        }
    };
    let attained = norm_at(start)
        .max(norm_at(end))
        .max(if start <= 0.0 && end >= 0.0 { 1.0 } else { 0.0 });
    if plain <= LOOSE * attained {
        return plain;
    }
    let pieces = piece_count((end - start) * rates.largest(), NORM_PIECE);
    let mut bound: f64 = 0.0;
    let mut before = norm_at(start);
    for piece in 0..pieces {
        let [from, to] = piece_of(window, piece, pieces);
        let after = norm_at(to);
        let length = to - from;
        let size =
            (before * growth(length, 0.0, forward)).min(after * growth(length, 0.0, backward));
        bound = if size.is_nan() {
            f64::INFINITY
        } else {
            bound.max(size)
        };
        before = after;
    }
    // Not `min`, which would hide a bound that is not a number.
    if above(bound) < plain {
        above(bound)
    } else {
        plain
    }
}

/// Upper bound of e^(rate t) for t between `short` and `long`, both at least 0.
fn growth(long: f64, short: f64, rate: f64) -> f64 {
    let exponent = rate * if rate > 0.0 { long } else { short };
    // A relative error of 2 u in the exponent is one of 2 u |exponent| in the exponential.
    above(exponent.exp() * (1.0 + 4.0 * U * exponent.abs()))
}

/// A box [min, max] that contains exp(tG) p for all t in `window`.
///
/// - `window`: `[start, end]` in spans, `start <= end`; need not contain 0.
///
/// # Guarantee
/// Proven, rounding included. It exceeds the smallest box by at most 0.2 % of the path's radius of
/// curvature and some 1e-13 of the coordinates, for windows of up to 32 / |M|. Infinite beyond the
/// range of f64.
///
/// # Cost
/// About 0.5 us for each eighth of 1/|M|, with at most 256 pieces.
pub fn path_bounds(generator: &Generator, point: DVec3, window: [f64; 2]) -> [DVec3; 2] {
    bounds_of_paths(generator, &[point], window)
}

/// A box [min, max] that contains the paths of all points of the box `corners` = [min, max] over
/// `window`.
///
/// At each time the image of the box is the hull of the images of its eight corners; the guarantee
/// is that of [`path_bounds`].
pub(crate) fn box_path_bounds(
    generator: &Generator,
    corners: [DVec3; 2],
    window: [f64; 2],
) -> [DVec3; 2] {
    let points: [DVec3; 8] = std::array::from_fn(|index| {
        let pick = |axis: usize| corners[(index >> axis) & 1][axis];
        DVec3::new(pick(0), pick(1), pick(2))
    });
    bounds_of_paths(generator, &points, window)
}

/// Upper bound of |d2/dt2 exp(tG) p| for t in `window`; accurate to a few units in the last place
/// for rigid motions and similarities.
pub fn acceleration_bound(generator: &Generator, point: DVec3, window: [f64; 2]) -> f64 {
    let rates = GrowthRates::new(&generator.linear);
    let pieces = piece_count((window[1] - window[0]) * rates.largest(), NORM_PIECE);
    let field = Field::new(generator);
    let mut bound: f64 = 0.0;
    for piece in 0..pieces {
        let [from, to] = piece_of(window, piece, pieces);
        let state = field.state(
            point,
            from,
            &Enclosure::new(&generator.linear, from, &rates),
        );
        let size = above(
            (state.acceleration.length() + state.acceleration_error)
                * growth(to - from, 0.0, rates.forward),
        );
        bound = if size.is_nan() {
            f64::INFINITY
        } else {
            bound.max(size)
        };
    }
    bound
}

fn bounds_of_paths(generator: &Generator, points: &[DVec3], window: [f64; 2]) -> [DVec3; 2] {
    let field = Field::new(generator);
    let rates = GrowthRates::new(&generator.linear);
    let pieces = piece_count((window[1] - window[0]) * field.size, PATH_PIECE);
    let enclosures: Vec<(f64, Enclosure)> = (0..=pieces)
        .map(|piece| {
            let t = if piece == pieces {
                window[1]
            } else {
                piece_of(window, piece, pieces)[0]
            };
            (t, Enclosure::new(&generator.linear, t, &rates))
        })
        .collect();
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for &point in points {
        let mut before = field.state(point, enclosures[0].0, &enclosures[0].1);
        for pair in enclosures.windows(2) {
            let after = field.state(point, pair[1].0, &pair[1].1);
            let reach = field.reach(&before, &after, pair[1].0 - pair[0].0, rates.forward);
            let (lowest, highest) = (
                before.position.min(after.position) - reach,
                before.position.max(after.position) + reach,
            );
            // Checked for each piece: minima and maxima would ignore NaN.
            if !(lowest.is_finite() && highest.is_finite()) {
                return [DVec3::NEG_INFINITY, DVec3::INFINITY];
            }
            (low, high) = (low.min(lowest), high.max(highest));
            before = after;
        }
    }
    [low, high]
}

fn piece_count(extent: f64, piece: f64) -> u32 {
    let wanted = (extent / piece).ceil();
    if wanted.is_nan() || wanted >= f64::from(MOST_PIECES) {
        return MOST_PIECES;
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 1 and MOST_PIECES"
    )]
    let count = wanted.max(1.0) as u32;
    count
}

/// The ends of one of several equal pieces; neighbours have the same end to the last bit.
fn piece_of(window: [f64; 2], piece: u32, pieces: u32) -> [f64; 2] {
    let at = |index: u32| {
        if index == pieces {
            window[1]
        } else {
            window[0] + (window[1] - window[0]) * (f64::from(index) / f64::from(pieces))
        }
    };
    [at(piece), at(piece + 1)]
}

/// The position of a point at some time, and its acceleration, with bounds on the errors of each
/// coordinate.
#[derive(Debug, Clone, Copy)]
struct State {
    position: DVec3,
    position_error: f64,
    acceleration: DVec3,
    acceleration_error: f64,
}

/// A generator with the norms that error bounds need.
struct Field<'a> {
    generator: &'a Generator,
    /// |M|_F.
    size: f64,
    rows: DVec3,
}

impl Field<'_> {
    fn new(generator: &Generator) -> Field<'_> {
        let rows = generator.linear.transpose();
        Field {
            generator,
            size: frobenius_bound(&generator.linear),
            rows: DVec3::new(
                rows.x_axis.length(),
                rows.y_axis.length(),
                rows.z_axis.length(),
            ),
        }
    }

    /// Bound on the rounding of v(p): gamma_4 (|M| |p| + |tau|).
    fn velocity_error(&self, point: DVec3) -> f64 {
        5.0 * U * (self.size * point.length() + self.generator.offset.length())
    }

    /// p + t phi1(tM) v(p).
    fn state(&self, point: DVec3, t: f64, enclosure: &Enclosure) -> State {
        let velocity = self.generator.velocity(point);
        let shift = enclosure.integral * velocity * t;
        let position = point + shift;
        let norm = frobenius_bound(&enclosure.integral);
        let speed = velocity.length();
        let position_error = above(
            t.abs()
                * ((enclosure.integral_error + 6.0 * U * norm) * speed
                    + norm * self.velocity_error(point))
                + 2.0 * U * (point.length() + shift.length()),
        );
        let speed_error = self.velocity_error(position) + self.size * position_error;
        let there = self.generator.velocity(position);
        let acceleration = self.generator.linear * there;
        let acceleration_error = above(self.size * (speed_error + 5.0 * U * there.length()));
        State {
            position,
            position_error,
            acceleration,
            acceleration_error,
        }
    }

    /// How far the path between two states may leave the box of the two positions, for each
    /// coordinate.
    ///
    /// The chord error is h^2/8 max|x''|; x'' moves by at most h/2 |row of M| max|x''| from its
    /// value at the nearer end.
    fn reach(&self, before: &State, after: &State, length: f64, rate: f64) -> DVec3 {
        let largest = above(
            (before.acceleration.length() + before.acceleration_error) * growth(length, 0.0, rate),
        );
        let at_ends = before.acceleration.abs().max(after.acceleration.abs())
            + before.acceleration_error.max(after.acceleration_error);
        let bulge = (at_ends + self.rows * (0.5 * length * largest)) * (0.125 * length * length);
        let rounding = before.position_error.max(after.position_error)
            + 2.0 * U * before.position.length().max(after.position.length());
        bulge * (1.0 + 16.0 * U) + rounding
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Flow;
    use crate::samples::random;
    use std::f64::consts::PI;

    fn norm(matrix: &DMat3) -> f64 {
        // Power iteration: a lower bound.
        let square = matrix.transpose() * *matrix;
        let mut direction = DVec3::new(0.6, 0.5, 0.7);
        for _ in 0..200 {
            direction = (square * direction).normalize();
        }
        (*matrix * direction).length()
    }

    #[test]
    fn rigid_motions_do_not_stretch() {
        let screw = Generator::screw(DVec3::new(0.48, 0.6, 0.64), DVec3::X, 10.0, 3.0, 1.0);
        for window in [[0.0, 1.0], [0.3, 0.4], [-2.0, 5.0], [0.0, 0.0]] {
            let bound = stretch(&screw.linear, window);
            assert!(
                (1.0..=1.0 + 8.0 * f64::EPSILON).contains(&bound),
                "{window:?}: {bound}"
            );
        }
    }

    #[test]
    fn similarities_stretch_by_their_scale() {
        let spiral = Generator::screw(DVec3::Z, DVec3::X, 7.0, 3.0, 0.25);
        for (window, expected) in [
            ([0.0, 1.0], 1.0),
            ([0.5, 1.0], 0.5),
            ([-0.5, 1.0], 2.0),
            ([-1.0, -0.5], 4.0),
        ] {
            let bound = stretch(&spiral.linear, window);
            assert!(
                (expected..expected * (1.0 + 1e-14)).contains(&bound),
                "{window:?}: {bound}, not {expected}"
            );
        }
    }

    #[test]
    fn a_growth_of_many_powers_of_ten_is_bounded_from_above() {
        let bound = stretch(&(DMat3::IDENTITY * 100.0), [0.0, 1.0]);
        let exact = 2.688_117_141_816_135_6e43; // e^100
        assert!((exact..exact * (1.0 + 1e-13)).contains(&bound), "{bound:e}");
    }

    #[test]
    fn stretch_is_above_and_near_the_largest_sampled_norm() {
        let mut next = random(11);
        for case in 0..100 {
            let linear = DMat3::from_cols_array(&std::array::from_fn(|_| 1.5 * next()));
            let window = [[0.0, 1.0], [-0.5, 0.7], [0.6, 0.9]][case % 3];
            let bound = stretch(&linear, window);
            let flow = Flow::new(Generator {
                linear,
                offset: DVec3::ZERO,
            });
            let sampled = (0..=400)
                .map(|i| {
                    norm(
                        &flow
                            .pose_at(window[0] + (window[1] - window[0]) * f64::from(i) / 400.0)
                            .matrix3,
                    )
                })
                .fold(0.0, f64::max);
            assert!(
                bound >= sampled * (1.0 - 1e-14),
                "case {case}: {bound} < {sampled}"
            );
            assert!(
                bound <= 1.02 * sampled,
                "case {case}: {bound} is loose, sampled {sampled}"
            );
        }
    }

    #[test]
    fn a_shear_stretches_more_than_its_eigenvalues_say() {
        let shear = DMat3::from_cols_array(&[0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let exact = 1.0 + 2.0_f64.sqrt();
        let bound = stretch(&shear, [0.0, 1.0]);
        assert!(
            (exact..1.02 * exact).contains(&bound),
            "norm of [1 2; 0 1] is {exact}: {bound}"
        );
    }

    #[test]
    fn path_boxes_contain_the_path_and_little_else() {
        let mut next = random(5);
        for case in 0..200 {
            let units = [1.0, 1e-3, 1e6][case % 3];
            let linear = DMat3::from_cols_array(&std::array::from_fn(|_| 2.0 * next()));
            let generator = Generator {
                linear,
                offset: DVec3::new(next(), next(), next()) * units,
            };
            let point = DVec3::new(next(), next(), next()) * units;
            let start = next();
            let window = [start, start + 1.0 + next()];
            let [low, high] = path_bounds(&generator, point, window);
            let flow = Flow::new(generator);
            let (mut tight_low, mut tight_high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            for i in 0..=500 {
                let t = window[0] + (window[1] - window[0]) * f64::from(i) / 500.0;
                let position = flow.pose_at(t).transform_point3(point);
                let slack = 1e-13 * units * norm(&flow.pose_at(t).matrix3).max(1.0);
                assert!(
                    (position - low).min_element() >= -slack
                        && (high - position).min_element() >= -slack,
                    "case {case}: {position} at {t} is outside {low} {high}"
                );
                tight_low = tight_low.min(position);
                tight_high = tight_high.max(position);
            }
            let extent = (tight_high - tight_low).max_element();
            let excess = (tight_low - low)
                .max((high - tight_high).max(DVec3::ZERO))
                .max_element();
            assert!(
                excess <= 0.02 * extent + 1e-11 * units,
                "case {case}: {excess:e} beyond {extent:e}"
            );
        }
    }

    #[test]
    fn a_full_circle_has_a_box_of_its_diameter() {
        let turn = Generator::screw(DVec3::Z, DVec3::ZERO, 2.0 * PI, 5.0, 1.0);
        let [low, high] = path_bounds(&turn, DVec3::X, [0.0, 1.0]);
        for (found, exact) in [
            (low.x, -1.0),
            (low.y, -1.0),
            (-high.x, -1.0),
            (-high.y, -1.0),
        ] {
            assert!(
                (exact - 0.003..=exact).contains(&found),
                "{found} for {exact}"
            );
        }
        assert!(
            low.z <= 0.0 && low.z > -1e-12,
            "no bulge along the axis: {}",
            low.z
        );
        assert!(
            high.z >= 5.0 && high.z < 5.0 + 1e-12,
            "no bulge along the axis: {}",
            high.z
        );
    }

    #[test]
    fn a_standing_point_has_a_box_of_rounding_size() {
        let point = DVec3::new(1.0, -2.0, 3.0);
        let [low, high] = path_bounds(&Generator::translation(DVec3::ZERO), point, [0.0, 1.0]);
        assert!(
            (low - point).max_element() <= 0.0 && (high - point).min_element() >= 0.0,
            "{low} {high}"
        );
        assert!((high - low).max_element() < 1e-14, "{low} {high}");
    }

    #[test]
    fn the_box_of_a_box_contains_every_path() {
        let generator = Generator::screw(DVec3::new(0.0, 0.6, 0.8), DVec3::X, 2.0, 1.0, 1.5);
        let corners = [DVec3::new(-1.0, 0.0, 2.0), DVec3::new(1.0, 0.5, 3.0)];
        let [low, high] = box_path_bounds(&generator, corners, [0.0, 1.0]);
        let mut next = random(2);
        for _ in 0..300 {
            let mix = DVec3::new(next(), next(), next()) * 0.5 + 0.5;
            let point = corners[0] + mix * (corners[1] - corners[0]);
            let position = Flow::new(generator)
                .pose_at(0.5 + 0.5 * next())
                .transform_point3(point);
            assert!(
                (position - low).min_element() >= 0.0 && (high - position).min_element() >= 0.0,
                "{position}"
            );
        }
    }

    #[test]
    fn acceleration_is_bounded_tightly() {
        let turn = Generator::screw(DVec3::Z, DVec3::ZERO, 3.0, 1.0, 1.0);
        let bound = acceleration_bound(&turn, DVec3::new(2.0, 0.0, 7.0), [-1.0, 4.0]);
        assert!(
            (18.0..18.0 + 1e-11).contains(&bound),
            "omega^2 r = 18: {bound}"
        );
        let mut next = random(9);
        for _ in 0..100 {
            let linear = DMat3::from_cols_array(&std::array::from_fn(|_| 1.5 * next()));
            let generator = Generator {
                linear,
                offset: DVec3::X,
            };
            let point = DVec3::new(next(), next(), next());
            let bound = acceleration_bound(&generator, point, [0.0, 1.0]);
            let flow = Flow::new(generator);
            let sampled = (0..=300)
                .map(|i| {
                    generator
                        .acceleration(flow.pose_at(f64::from(i) / 300.0).transform_point3(point))
                        .length()
                })
                .fold(0.0, f64::max);
            assert!(
                bound >= sampled * (1.0 - 1e-13) && bound <= 1.03 * sampled,
                "{bound} against {sampled}"
            );
        }
    }

    #[test]
    fn a_motion_beyond_the_range_of_numbers_has_an_infinite_box() {
        let generator = Generator {
            linear: DMat3::IDENTITY * 1e6,
            offset: DVec3::ZERO,
        };
        let [low, high] = path_bounds(&generator, DVec3::ONE, [0.0, 1.0]);
        assert!(
            low == DVec3::NEG_INFINITY && high == DVec3::INFINITY,
            "{low} {high}"
        );
        let huge = Generator {
            linear: DMat3::IDENTITY * 1e200 + DMat3::from_cols_array(&[1e200; 9]),
            offset: DVec3::ONE,
        };
        let [low, high] = path_bounds(&huge, DVec3::ONE, [0.0, 1.0]);
        assert!(
            low == DVec3::NEG_INFINITY && high == DVec3::INFINITY,
            "{low} {high}"
        );
        assert_eq!(
            stretch(&huge.linear, [0.0, 1.0]),
            f64::INFINITY,
            "no finite bound"
        );
        assert_eq!(
            stretch(&generator.linear, [0.0, 1.0]),
            f64::INFINITY,
            "no finite bound"
        );
        assert_eq!(
            acceleration_bound(&generator, DVec3::ONE, [0.0, 1.0]),
            f64::INFINITY,
            "no finite bound"
        );
    }
}
