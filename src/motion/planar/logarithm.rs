//! The steady motion between two poses in the plane: the real logarithm of an affine map, or why
//! there is none.

use super::flow::PairGenerator;
use super::{Flow, Logarithm};
use crate::motion::MotionError;
use crate::motion::half_turn::{HalfTurnBlock, Sense, check_turns, near_half_turn, turning_root};
use crate::motion::pair::{Pair, PairLogarithm, Traceless};
use crate::numeric::difference_of_products;
use crate::numeric::exact::signs::{Side, side_of_line};
use crate::numeric::tolerance::{LOGARITHM_RESIDUAL, NEGATIVE_PAIR};
use glam::{DAffine2, DMat2, DVec2};
use std::f64::consts::TAU;

/// The real logarithm of an affine map of the plane: the steady motion that leads from the identity
/// to `a` in one span.
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
/// Constant, about 0.3 us; no allocation.
///
/// # Source
/// Own; derivation in [`crate::motion`], "The logarithm". SAM, appendix A, has the same cases one
/// by one.
///
/// # Example
/// ```
/// use glam::{DAffine2, DVec2};
/// use steadysweep::motion::planar::logarithm;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let pose = DAffine2::from_angle_translation(1.0, DVec2::ONE);
/// assert!(logarithm(&pose)?.flow.pose_at(1.0).abs_diff_eq(pose, 1e-14));
/// # Ok(())
/// # }
/// ```
pub fn logarithm(a: &DAffine2) -> Result<Logarithm, MotionError> {
    logarithm_of(a, 0.0, None, 0)
}

/// As [`logarithm`], with a chosen sense for a half turn. Where the pose misses the half turn by an
/// angle of up to 1e-9 rad, the turn in the longer sense exceeds a half turn by that angle; the end
/// pose is `a` in either sense.
///
/// # Errors
/// As [`logarithm`].
pub fn logarithm_turning(a: &DAffine2, sense: Sense) -> Result<Logarithm, MotionError> {
    logarithm_of(a, 0.0, Some(sense), 0)
}

/// As [`logarithm`], with whole turns added to it: log A + 2 pi k J, where J is similar to the
/// quarter turn from x towards y.
///
/// - `turns`: k, positive from x towards y. A half turn, within 1e-9 rad, goes in the [`Sense`] of
///   the sign, with that many whole turns before it. 0 gives [`logarithm`].
///
/// # Errors
/// As [`logarithm`]; [`MotionError::NothingTurns`] where there is no complex pair, or none that
/// turns by more than 1e-9 rad; [`MotionError::TooManyTurns`] beyond 25,000.
pub fn logarithm_with_turns(a: &DAffine2, turns: i32) -> Result<Logarithm, MotionError> {
    logarithm_of(a, 0.0, None, turns)
}

/// - `rounding`: bound on the errors of the entries of the linear part of `a`.
/// - `sense`: sense of a half turn; `None` for the shorter turn.
/// - `turns`: whole turns to be added; other than 0, they decide the sense of a half turn.
pub(super) fn logarithm_of(
    a: &DAffine2,
    rounding: f64,
    sense: Option<Sense>,
    turns: i32,
) -> Result<Logarithm, MotionError> {
    check_pose(a)?;
    check_turns(turns)?;
    let (form, half_turn) = linear_logarithm(&a.matrix2, rounding, sense, turns)?;
    let [linear, integral] = form.exponential_and_integral(1.0);
    let offset = solve_offset(&integral, a.translation);
    let end = DAffine2 {
        matrix2: linear,
        translation: integral * offset,
    };
    let residual = residual(&end, a);
    if residual <= LOGARITHM_RESIDUAL {
        Ok(Logarithm {
            flow: Flow::from_form(PairGenerator { offset, ..form }),
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
pub(super) fn check_pose(pose: &DAffine2) -> Result<(), MotionError> {
    if !pose.is_finite() {
        return Err(MotionError::NonFinite { what: "matrix" });
    }
    let linear = &pose.matrix2;
    let size = largest_entry(linear);
    if size == 0.0 {
        return Err(MotionError::Singular);
    }
    let scaled = *linear * (1.0 / size);
    match side_of_line(DVec2::ZERO, scaled.x_axis, scaled.y_axis) {
        Side::Above => Ok(()),
        Side::On => Err(MotionError::Singular),
        Side::Below => Err(MotionError::Reflection {
            determinant: linear.determinant(),
        }),
    }
}

/// ln L, without offset, and the sense of a half turn.
fn linear_logarithm(
    linear: &DMat2,
    rounding: f64,
    sense: Option<Sense>,
    turns: i32,
) -> Result<(PairGenerator, Option<Sense>), MotionError> {
    let [x, y] = [linear.x_axis, linear.y_axis];
    let block = Traceless::of(linear);
    let disc = block.discriminant();
    let mean = 0.5 * (x.x + y.y);
    let mean_excess = 0.5 * ((x.x - 1.0) + (y.y - 1.0));
    // Where the pair is close, mean^2 - disc: whatever the rounding of disc in a block of large
    // shear, ln and exp then agree on it. Where the pair is wide, this would cancel.
    let determinant = if disc <= 0.5 * mean * mean {
        mean.mul_add(mean, -disc)
    } else {
        difference_of_products(x.x, y.y, y.x, x.y)
    };
    let turn = block.largest();
    let form = |pair, block, diagonal| PairGenerator {
        pair,
        block,
        diagonal,
        offset: DVec2::ZERO,
    };
    // A negative pair whose discriminant has no certain sign is a Jordan block to working
    // precision.
    let noise = NEGATIVE_PAIR * largest_entry(linear) * turn;
    if let Some(half) = HalfTurnBlock::new(mean, &block, [disc, noise], rounding) {
        let sense = sense.or(half.shorter()).unwrap_or(Sense::Positive);
        let sense = Sense::of_turns(turns).unwrap_or(sense);
        let (turned, angle) = half.turning(sense, turns.unsigned_abs());
        let pair = Pair {
            mean: half.even,
            disc: -angle * angle,
            root: angle.abs(),
        };
        return Ok((form(pair, turned, None), (turns == 0).then_some(sense)));
    }
    let uncertain = mean < 0.0 && -disc <= noise;
    if uncertain || determinant <= 0.0 || (disc >= 0.0 && mean <= 0.0) {
        let width = disc.max(0.0).sqrt();
        return Err(MotionError::NoRealLogarithm {
            eigenvalues: [mean - width, mean + width],
        });
    }
    let (block, disc, determinant) = match near_half_turn(mean, &block) {
        Some(turn) => {
            let disc = -turn.lower * turn.lower;
            (turn, disc, mean.mul_add(mean, -disc))
        }
        None => (block, disc, determinant),
    };
    let logarithm = PairLogarithm::new(mean, mean_excess, disc, determinant);
    if turns != 0 {
        let root = turning_root(mean, disc, noise, rounding)?.copysign(block.lower);
        let angle = TAU.mul_add(f64::from(turns), logarithm.root.copysign(root));
        let pair = Pair {
            mean: logarithm.even,
            disc: -angle * angle,
            root: angle.abs(),
        };
        return Ok((form(pair, block.scaled(angle / root), None), None));
    }
    let pair = Pair {
        mean: logarithm.even,
        disc: logarithm.odd * logarithm.odd * disc,
        root: logarithm.root,
    };
    let diagonal = block
        .is_triangular()
        .then(|| DVec2::new(x.x.ln(), y.y.ln()));
    Ok((form(pair, block.scaled(logarithm.odd), diagonal), None))
}

/// The largest absolute value of an entry.
pub(super) fn largest_entry(matrix: &DMat2) -> f64 {
    matrix.x_axis.abs().max(matrix.y_axis.abs()).max_element()
}

/// tau with phi1(M) tau = t: no fixed point is needed.
fn solve_offset(integral: &DMat2, translation: DVec2) -> DVec2 {
    if translation == DVec2::ZERO {
        return DVec2::ZERO;
    }
    let [x, y] = [integral.x_axis, integral.y_axis];
    let determinant = difference_of_products(x.x, y.y, y.x, x.y);
    DVec2::new(
        difference_of_products(translation.x, y.y, y.x, translation.y),
        difference_of_products(x.x, translation.y, translation.x, x.y),
    ) / determinant
}

/// How far the motion misses `a`, relative to its size: the linear part relative to |L|, the
/// translation relative to |t| max(1, |L|), so that the unit of length does not matter.
fn residual(end: &DAffine2, a: &DAffine2) -> f64 {
    let size = largest_entry(&a.matrix2);
    let linear = largest_entry(&(end.matrix2 - a.matrix2)) / size;
    let shift = (end.translation - a.translation).abs().max_element();
    let length = a.translation.abs().max_element() * size.max(1.0);
    let translation = if shift == 0.0 { 0.0 } else { shift / length };
    if linear.is_nan() || translation.is_nan() {
        f64::INFINITY
    } else {
        linear.max(translation)
    }
}
