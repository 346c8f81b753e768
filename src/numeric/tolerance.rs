//! Every threshold of the kernel: meaning, unit, usual value, derivation, user.
//!
//! Two kinds, never mixed: **rounding**, computed from the data as k u L with L the largest coordinate reached,
//! and **resolution**, what the user asked for.

/// Unit roundoff of `f64`, 2^-53.
pub const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// Largest allowed ||exp(log A) - A|| / ||A||, for the linear part and for the translation. No unit.
/// The usual value is 1e-15; where it exceeds this gate the logarithm exists but f64 cannot carry the motion.
/// Used by `motion::logarithm`.
pub const LOGARITHM_RESIDUAL: f64 = 1e-10;

/// Relative size below which what a plane block differs from -s I counts as rounding: a half turn. No unit.
/// A rotation by pi that was multiplied together in f64 is off by some 1e-16 to 1e-14; reading it as exact moves the end
/// pose by as much. Used by `motion::logarithm`.
pub const HALF_TURN: f64 = 1e-13;

/// A negative double eigenvalue is a Jordan block when its discriminant is below this times |L| |B0|. No unit.
/// The deflation has a backward error of some 10 units in the last place of |L|, each moves the discriminant by up to
/// 4 |B0| u |L|; below their sum its sign is noise. Used by `motion::logarithm`.
pub const NEGATIVE_PAIR: f64 = 64.0 * f64::EPSILON;
