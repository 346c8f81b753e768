//! Every threshold of the kernel: meaning, unit, usual value, derivation, user.
//!
//! Two kinds, never mixed: **rounding**, computed from the data as k u L with L the largest coordinate reached,
//! and **resolution**, what the user asked for.

/// Unit roundoff of `f64`, 2^-53.
pub const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;
