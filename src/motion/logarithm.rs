//! The steady motion between two poses: the real logarithm of an affine map, or why there is none.

use super::deflation::{Deflation, largest_entry};
use super::flow::DeflatedGenerator;
use super::half_turn::{
    HalfTurn, HalfTurnBlock, Sense, check_turns, near_half_turn, positive_axis, turning_root,
};
use super::pair::{PairLogarithm, Traceless, inverse_tangent_ratio};
use super::spectrum::{Spectrum, centred_symmetric};
use super::{Flow, Logarithm, MotionError};
use crate::numeric::difference_of_products;
use crate::numeric::exact::signs::{Side, side_of_plane};
use crate::numeric::tolerance::{LOGARITHM_RESIDUAL, NEGATIVE_PAIR};
use glam::{DAffine3, DMat3, DVec2, DVec3};
use std::f64::consts::TAU;

/// The real logarithm of an affine map: the steady motion that leads from the identity to `a` in
/// one span.
///
/// # Guarantee
/// `flow.pose_at(1.0)` is `a` to `LOGARITHM_RESIDUAL` of its size (checked; 1e-15 is usual). Of
/// several real logarithms it is the principal one, with turns up to half a turn. At half a turn,
/// within 1e-9 rad, it is not the only one, and the result says so; at exactly half a turn the
/// sense is [`Sense::Positive`]. [`logarithm_turning`] chooses the sense.
///
/// # Errors
/// [`MotionError::NonFinite`], [`MotionError::Reflection`], [`MotionError::Singular`],
/// [`MotionError::NoRealLogarithm`], [`MotionError::IllConditioned`].
///
/// # Cost
/// Constant, about 0.5 us; no allocation.
///
/// # Source
/// Own; derivation in [`crate::motion`]. Solvability for real matrices up to 3 x 3: Culver, as
/// quoted by Rossignac & Vinacua, section 5.1.
///
/// # Example
/// ```
/// use glam::{DAffine3, DQuat, DVec3};
/// use steadysweep::motion::logarithm;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let pose = DAffine3::from_rotation_translation(DQuat::from_rotation_z(1.0), DVec3::ONE);
/// let steady = logarithm(&pose)?;
/// assert!(steady.unique());
/// assert!(steady.flow.pose_at(1.0).abs_diff_eq(pose, 1e-14));
///
/// // A mirror image is no pose that a body can be moved to.
/// assert!(logarithm(&DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0))).is_err());
/// # Ok(())
/// # }
/// ```
pub fn logarithm(a: &DAffine3) -> Result<Logarithm, MotionError> {
    logarithm_of(a, 0.0, None, 0)
}

/// As [`logarithm`], with a chosen sense for a half turn. Where the pose misses the half turn by an
/// angle of up to 1e-9 rad, the turn in the longer sense exceeds a half turn by that angle; the end
/// pose is `a` in either sense.
///
/// # Errors
/// As [`logarithm`].
pub fn logarithm_turning(a: &DAffine3, sense: Sense) -> Result<Logarithm, MotionError> {
    logarithm_of(a, 0.0, Some(sense), 0)
}

/// As [`logarithm`], with whole turns added to it: log A + 2 pi k J, where J turns in the invariant
/// plane of the complex pair of eigenvalues, similar to the generator of a rotation.
///
/// - `turns`: k. Above 0, the turns go on in the sense in which log A turns; below 0, they go
///   against it, so that the motion turns in the other sense. A half turn, within 1e-9 rad, goes in
///   the [`Sense`] of the sign, with that many whole turns before it. 0 gives [`logarithm`].
///
/// # Errors
/// As [`logarithm`]; [`MotionError::NothingTurns`] where there is no complex pair, or none that
/// turns by more than 1e-9 rad; [`MotionError::TooManyTurns`] beyond 25,000.
///
/// # Example
/// ```
/// use glam::{DAffine3, DQuat};
/// use std::f64::consts::{FRAC_PI_2, TAU};
/// use steadysweep::motion::{describe, logarithm_with_turns};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let quarter = DAffine3::from_quat(DQuat::from_rotation_z(FRAC_PI_2));
/// let steady = logarithm_with_turns(&quarter, 2)?;
/// assert!(steady.flow.pose_at(1.0).abs_diff_eq(quarter, 1e-14));
/// let turn_deg = describe(steady.flow.generator()).turn_deg.unwrap_or(0.0);
/// assert!((turn_deg - 810.0).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
pub fn logarithm_with_turns(a: &DAffine3, turns: i32) -> Result<Logarithm, MotionError> {
    logarithm_of(a, 0.0, None, turns)
}

/// - `rounding`: bound on the errors of the entries of the linear part of `a`.
/// - `sense`: sense of a half turn; `None` for the shorter turn.
/// - `turns`: whole turns to be added; other than 0, they decide the sense of a half turn.
pub(super) fn logarithm_of(
    a: &DAffine3,
    rounding: f64,
    sense: Option<Sense>,
    turns: i32,
) -> Result<Logarithm, MotionError> {
    check_pose(a)?;
    check_turns(turns)?;
    let size = largest_entry(&a.matrix3);
    let split = SplitAffinity::new(&a.matrix3);
    let (form, half_turn) = split.logarithm(size, rounding, sense, turns)?;
    let [linear, integral] = form.exponential_and_integral(1.0);
    let offset = solve_offset(&integral, form.basis * a.translation);
    let end = DAffine3 {
        matrix3: form.basis * linear * form.basis,
        translation: form.basis * (integral * offset),
    };
    let residual = residual(&end, a);
    if residual <= LOGARITHM_RESIDUAL {
        Ok(Logarithm {
            flow: Flow::from_form(DeflatedGenerator { offset, ..form }),
            half_turn,
        })
    } else {
        Err(MotionError::IllConditioned {
            residual,
            limit: LOGARITHM_RESIDUAL,
        })
    }
}

/// Checks that a pose is finite and that its determinant is positive, by its exact sign.
pub(super) fn check_pose(pose: &DAffine3) -> Result<(), MotionError> {
    if !pose.is_finite() {
        return Err(MotionError::NonFinite { what: "matrix" });
    }
    let linear = &pose.matrix3;
    let size = largest_entry(linear);
    if size == 0.0 {
        return Err(MotionError::Singular);
    }
    let scaled = *linear * (1.0 / size);
    // The origin is below the plane through the images of the axes exactly when they are
    // right-handed.
    match side_of_plane(scaled.x_axis, scaled.y_axis, scaled.z_axis, DVec3::ZERO) {
        Side::Below => Ok(()),
        Side::On => Err(MotionError::Singular),
        Side::Above => Err(MotionError::Reflection {
            determinant: linear.determinant(),
        }),
    }
}

/// L = Q [lambda r; 0 B] Q, with the excess over the identity kept separately where L is near it.
struct SplitAffinity {
    form: Deflation,
    /// L = `base` I + what `form` describes.
    base: f64,
}

impl SplitAffinity {
    fn new(linear: &DMat3) -> SplitAffinity {
        let excess = *linear - DMat3::IDENTITY;
        let (base, matrix) = if largest_entry(&excess) <= 0.5 {
            (1.0, excess)
        } else {
            (0.0, *linear)
        };
        let mut form = Deflation::new(&matrix);
        if base + form.lambda < 0.0 {
            // The eigenvalue to split off is the isolated one: a negative pair stays together.
            form = Deflation::isolated(&matrix);
        }
        SplitAffinity { form, base }
    }

    /// ln of the split matrix (without offset), and the half turn, if it is one.
    fn logarithm(
        &self,
        size: f64,
        rounding: f64,
        sense: Option<Sense>,
        turns: i32,
    ) -> Result<(DeflatedGenerator, Option<HalfTurn>), MotionError> {
        let SplitAffinity { form, base } = self;
        let (block, coupling) = (form.traceless(), form.coupling);
        let lambda = base + form.lambda;
        let mean = base + form.mean();
        let disc = block.discriminant();
        let excess = base - 1.0;
        let (lambda_excess, mean_excess) = (form.lambda + excess, form.mean() + excess);
        // Where the pair is close, mean^2 - disc: whatever the rounding of disc in a block of large
        // shear, ln and exp then agree on it. Where the pair is wide, this would cancel.
        let determinant = if disc <= 0.5 * mean * mean {
            mean.mul_add(mean, -disc)
        } else {
            difference_of_products(
                base + form.block[0][0],
                base + form.block[1][1],
                form.block[0][1],
                form.block[1][0],
            )
        };
        let none = || {
            let width = disc.max(0.0).sqrt();
            let mut eigenvalues = [lambda, mean - width, mean + width];
            eigenvalues.sort_by(f64::total_cmp);
            MotionError::NoRealLogarithm {
                eigenvalues: [eigenvalues[0], eigenvalues[1]],
            }
        };
        if lambda < 0.0 || determinant < 0.0 {
            return Err(none());
        }
        let at_lambda = if lambda_excess.abs() < 0.5 {
            lambda_excess.ln_1p()
        } else {
            lambda.ln()
        };
        let form_of = |spectrum, block, [coupling, coupling_of_block]: [_; 2]| DeflatedGenerator {
            basis: form.basis,
            spectrum,
            block,
            coupling,
            coupling_of_block,
            offset: DVec3::ZERO,
        };
        let turn = block.largest();
        // A negative pair whose discriminant has no certain sign is a Jordan block to working
        // precision.
        let noise = NEGATIVE_PAIR * size * turn;
        if let Some(half) = HalfTurnBlock::new(mean, &block, [disc, noise], rounding) {
            let axis = positive_axis(form.basis.x_axis);
            let hand = self.handedness(axis);
            let shorter = half.shorter().map(|sense| sense.times(hand));
            let sense = sense.or(shorter).unwrap_or(Sense::Positive);
            let sense = Sense::of_turns(turns).unwrap_or(sense);
            let (turned, angle) = half.turning(sense.times(hand), turns.unsigned_abs());
            let difference = coupling * (half.even - at_lambda) + turned.left(coupling);
            let x = coupling_of(difference, mean - lambda, &half.rest);
            let spectrum = Spectrum {
                lambda: at_lambda,
                mean: half.even,
                disc: -angle * angle,
                root: angle.abs(),
            };
            let form = form_of(spectrum, turned, [x, turned.left(x)]);
            return Ok((form, (turns == 0).then_some(HalfTurn { axis, sense })));
        }
        if (mean < 0.0 && -disc <= noise) || (disc >= 0.0 && mean <= 0.0) {
            return Err(none());
        }
        let (block, disc, determinant) = match near_half_turn(mean, &block) {
            Some(turn) => {
                let disc = -turn.lower * turn.lower;
                (turn, disc, mean.mul_add(mean, -disc))
            }
            None => (block, disc, determinant),
        };
        let pair = PairLogarithm::new(mean, mean_excess, disc, determinant);
        if turns != 0 {
            let root = turning_root(mean, disc, noise, rounding)?;
            let angle = TAU.mul_add(f64::from(turns), pair.root);
            let turned = block.scaled(angle / root);
            let difference = coupling * (pair.even - at_lambda) + turned.left(coupling);
            let x = coupling_of(difference, mean - lambda, &block);
            let spectrum = Spectrum {
                lambda: at_lambda,
                mean: pair.even,
                disc: -angle * angle,
                root: angle.abs(),
            };
            return Ok((form_of(spectrum, turned, [x, turned.left(x)]), None));
        }
        let (even, odd) = corner(lambda, at_lambda, mean, disc, determinant, &pair);
        let turned = block.left(coupling);
        let x = coupling * even + turned * odd;
        // x C0, with B0^2 = d I used where it cancels
        let x_block = (turned * even + coupling * (odd * disc)) * pair.odd;
        let spectrum = Spectrum {
            lambda: at_lambda,
            mean: pair.even,
            disc: pair.odd * pair.odd * disc,
            root: pair.root,
        };
        let form = form_of(spectrum, block.scaled(pair.odd), [x, x_block]);
        Ok((form, None))
    }

    /// Whether a turn from the first to the second direction of the block is right-handed about
    /// `axis`, which is plus or minus the eigenvector: 1 if it is, else -1.
    fn handedness(&self, axis: DVec3) -> f64 {
        let basis = &self.form.basis;
        axis.dot(basis.y_axis.cross(basis.z_axis)).signum()
    }
}

/// x with x (B - lambda I) = r (f(B) - f(lambda) I): the coupling of f of [lambda r; 0 B].
///
/// - `difference`: the right-hand side; `h`: half the trace of B minus lambda; `rest`: B without
///   its trace.
fn coupling_of(difference: DVec2, h: f64, rest: &Traceless) -> DVec2 {
    (difference * h - rest.left(difference)) / h.mul_add(h, -rest.discriminant())
}

/// ln[lambda, B] = even I + odd B0.
fn corner(
    lambda: f64,
    at_lambda: f64,
    mean: f64,
    disc: f64,
    determinant: f64,
    pair: &PairLogarithm,
) -> (f64, f64) {
    let h = lambda - mean;
    let centre = (lambda + 2.0 * mean) / 3.0;
    let radius_squared = (h * h).max(disc.abs());
    if centre > 0.0 && radius_squared < 0.0625 * centre * centre {
        let odd = clustered_corner(h, disc, centre, radius_squared);
        (pair.odd + h * odd, odd)
    } else if disc <= 0.0 {
        let separation = h * h - disc;
        let difference = at_lambda - pair.even;
        (
            (difference * h - pair.odd * disc) / separation,
            (difference - pair.odd * h) / separation,
        )
    } else {
        let upper = mean + disc.sqrt();
        let lower = determinant / upper;
        let (first, second) = (
            logarithm_difference(lambda, upper),
            logarithm_difference(lambda, lower),
        );
        let odd = if h > 0.0 {
            (first - pair.odd) / (lambda - lower)
        } else {
            (second - pair.odd) / (lambda - upper)
        };
        (0.5 * (first + second), odd)
    }
}

/// ln[lambda, mu1, mu2] = -centre^-2 sum (-1)^k H_{k-2} / k, with H the complete symmetric
/// functions of the spectrum minus its centre, in units of the centre.
fn clustered_corner(h: f64, disc: f64, centre: f64, radius_squared: f64) -> f64 {
    let inverse = 1.0 / centre;
    let (e2, e3) = centred_symmetric(h * inverse, disc * inverse * inverse);
    let (mut before, mut last, mut current) = (1.0, 0.0, -e2);
    let mut sum = 0.5 - e2 / 4.0;
    let terms = if radius_squared * inverse * inverse < 1e-4 {
        12
    } else {
        34
    };
    let mut sign = -1.0;
    for k in 5..=terms {
        let next = e3 * before - e2 * last;
        (before, last, current) = (last, current, next);
        sum += sign * current / f64::from(k);
        sign = -sign;
    }
    -sum * inverse * inverse
}

/// (ln x - ln y)/(x - y) for x, y > 0.
fn logarithm_difference(x: f64, y: f64) -> f64 {
    let ratio = (x - y) / (x + y);
    if ratio.abs() < 0.4 {
        2.0 / (x + y) * inverse_tangent_ratio(ratio * ratio)
    } else {
        (x / y).ln() / (x - y)
    }
}

/// tau with phi1(M) tau = t, both in the basis of the form: no fixed point is needed.
fn solve_offset(integral: &DMat3, translation: DVec3) -> DVec3 {
    let (b, c) = (integral.y_axis, integral.z_axis);
    let determinant = b.y * c.z - c.y * b.z;
    let y = (c.z * translation.y - c.y * translation.z) / determinant;
    let z = (b.y * translation.z - b.z * translation.y) / determinant;
    let x = (translation.x - b.x * y - c.x * z) / integral.x_axis.x;
    DVec3::new(x, y, z)
}

/// How far the motion misses `a`, relative to its size: the linear part relative to |L|, the
/// translation relative to |t| max(1, |L|), so that the unit of length does not matter.
fn residual(end: &DAffine3, a: &DAffine3) -> f64 {
    let size = largest_entry(&a.matrix3);
    let linear = largest_entry(&(end.matrix3 - a.matrix3)) / size;
    let shift = (end.translation - a.translation).abs().max_element();
    let length = a.translation.abs().max_element() * size.max(1.0);
    let translation = if shift == 0.0 { 0.0 } else { shift / length };
    if linear.is_nan() || translation.is_nan() {
        f64::INFINITY
    } else {
        linear.max(translation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;
    use std::f64::consts::PI;

    fn linear(rows: [[f64; 3]; 3]) -> DAffine3 {
        DAffine3::from_mat3(DMat3::from_cols_array_2d(&rows).transpose())
    }
    fn refused(a: &DAffine3) -> MotionError {
        logarithm(a).expect_err("must be refused")
    }

    #[test]
    fn the_identity_has_the_logarithm_zero() {
        let log = logarithm(&DAffine3::IDENTITY).expect("a logarithm");
        assert_eq!(
            log.flow.generator(),
            &crate::motion::Generator::translation(DVec3::ZERO),
            "exactly"
        );
        assert!(log.unique(), "standing still is the only one");
    }

    #[test]
    fn a_half_turn_is_flagged_as_not_unique() {
        let axis = DVec3::new(0.48, 0.6, 0.64);
        for angle in [PI, -PI] {
            let half = DAffine3::from_quat(DQuat::from_axis_angle(axis, angle));
            let log = logarithm(&half).expect("a logarithm");
            assert!(!log.unique(), "both senses lead there");
            let missed = largest_entry(&(log.flow.pose_at(1.0).matrix3 - half.matrix3));
            assert!(missed < 2e-15, "{missed:e}");
            let quarter = log.flow.pose_at(0.5).matrix3;
            let rigid = largest_entry(&(quarter.transpose() * quarter - DMat3::IDENTITY));
            assert!(rigid < 2e-15, "halfway it is still a rotation: {rigid:e}");
        }
        for (missing, unique) in [
            (2e-9, true),
            (-2e-9, true),
            (0.9e-9, false),
            (-3e-12, false),
        ] {
            let nearly = DAffine3::from_quat(DQuat::from_axis_angle(axis, PI - missing));
            let log = logarithm(&nearly).expect("a logarithm");
            assert_eq!(log.unique(), unique, "{missing:e} less than half a turn");
        }
    }

    #[test]
    fn a_rounded_rotation_near_a_half_turn_does_not_stretch() {
        let axis = DVec3::new(0.48, 0.6, 0.64);
        for missing in [3e-2, 1e-3, 1e-4, 1e-5, 1e-7, 1e-8, 2e-9, -1e-6] {
            for scale in [1.0, 0.3] {
                let turn = DMat3::from_axis_angle(axis, PI - missing) * scale;
                let a = DAffine3::from_mat3_translation(turn, DVec3::new(3.0, -2.0, 1.0));
                let log = logarithm(&a).expect("a logarithm");
                assert!(residual(&log.flow.pose_at(1.0), &a) < 1e-14, "{missing:e}");
                let linear = log.flow.generator().linear;
                let growth = DMat3::from_diagonal(DVec3::splat(scale.ln()));
                let stretch = largest_entry(&(0.5 * (linear + linear.transpose()) - growth));
                assert!(stretch < 1e-13, "{missing:e}: stretched by {stretch:e}");
            }
        }
    }

    #[test]
    fn a_half_turn_with_scale_in_the_plane_and_shear_out_of_it() {
        let a = linear([[-2.0, 0.0, 1.0], [0.0, -2.0, 3.0], [0.0, 0.0, 0.5]]);
        let log = logarithm(&a).expect("a logarithm");
        assert!(!log.unique(), "both senses lead there");
        assert!(
            residual(&log.flow.pose_at(1.0), &a) < 1e-15,
            "misses by {:e}",
            residual(&log.flow.pose_at(1.0), &a)
        );
    }

    #[test]
    fn refusals_have_names() {
        let diagonal = |x, y, z| linear([[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]]);
        assert_eq!(
            refused(&diagonal(1.0, -2.0, 1.0)),
            MotionError::Reflection { determinant: -2.0 },
            "mirror"
        );
        assert_eq!(
            refused(&diagonal(-1.0, -1.0, -1.0)),
            MotionError::Reflection { determinant: -1.0 },
            "point mirror"
        );
        assert_eq!(
            refused(&diagonal(1.0, 0.0, 1.0)),
            MotionError::Singular,
            "flat"
        );
        assert_eq!(
            refused(&diagonal(0.0, 0.0, 0.0)),
            MotionError::Singular,
            "a point"
        );
        assert_eq!(
            refused(&diagonal(-1.0, 1.0, -2.0)),
            MotionError::NoRealLogarithm {
                eigenvalues: [-2.0, -1.0]
            },
            "unequal negative eigenvalues"
        );
        assert_eq!(
            refused(&linear([
                [-1.0, 1.0, 0.0],
                [0.0, -1.0, 0.0],
                [0.0, 0.0, 1.0]
            ])),
            MotionError::NoRealLogarithm {
                eigenvalues: [-1.0, -1.0]
            },
            "a Jordan block"
        );
        assert_eq!(
            refused(&diagonal(f64::NAN, 1.0, 1.0)),
            MotionError::NonFinite { what: "matrix" },
            "NaN"
        );
        let far = DAffine3::from_translation(DVec3::new(f64::INFINITY, 0.0, 0.0));
        assert_eq!(
            refused(&far),
            MotionError::NonFinite { what: "matrix" },
            "infinite"
        );
    }

    #[test]
    fn a_singular_matrix_is_recognised_exactly() {
        // The rank is two, but the determinant in floating point is 1e-17.
        let rows = [[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]];
        let sum = std::array::from_fn(|j| rows[0][j] * 4.0 - rows[0][j] * 2.0);
        assert_eq!(
            refused(&linear([rows[0], rows[1], sum])),
            MotionError::Singular,
            "the third row is twice the first"
        );
    }

    #[test]
    fn units_do_not_matter() {
        let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 2.0);
        for unit in [1e-12, 1e-3, 1.0, 1e6, 1e12] {
            let a = DAffine3::from_rotation_translation(turn, DVec3::new(1.0, -2.0, 0.5) * unit);
            let log = logarithm(&a).expect("a logarithm");
            assert!(
                residual(&log.flow.pose_at(1.0), &a) < 2e-15,
                "unit {unit:e}: {:e}",
                residual(&log.flow.pose_at(1.0), &a)
            );
        }
        for scale in [1e-100, 1e-9, 1e9, 1e100] {
            let a = DAffine3::from_mat3(DMat3::from_quat(turn) * scale);
            let log = logarithm(&a).expect("a logarithm");
            assert!(
                residual(&log.flow.pose_at(1.0), &a) < 1e-13,
                "scale {scale:e}: {:e}",
                residual(&log.flow.pose_at(1.0), &a)
            );
        }
    }
}
