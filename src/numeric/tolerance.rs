//! Every threshold of the kernel: meaning, unit, usual value, derivation, user.
//!
//! Two kinds, never mixed: **rounding**, computed from the data as k u L with L the largest coordinate reached,
//! and **resolution**, what the user asked for.

/// Unit roundoff of `f64`, 2^-53.
pub const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// Distance within which vertices of a file are one point, as a fraction of the bounding-box diagonal.
///
/// Resolution. Exporters that compute a shared corner once per triangle miss it by a few roundings, 1e-12 to 1e-10 of
/// the size; features of a part are far larger. User: `io::weld`.
pub const WELD_DISTANCE: f64 = 1e-9;

/// Mean thickness 2 V / A below which a shell counts as flat, as a fraction of the diagonal of the shell.
///
/// Resolution. The same length as [`WELD_DISTANCE`]: the two sides of such a sheet are one point of the file.
/// User: `body::validate`.
pub const FLAT_THICKNESS: f64 = WELD_DISTANCE;

/// Thickness below which a shell cannot be told from a flat one because its coordinates are rounded, as a factor of
/// the largest coordinate of the shell.
///
/// Rounding, k u L with k = 4: each of the two sides is off by at most u L in each of its three coordinates, 2 sqrt(3)
/// u L together. User: `body::validate`.
pub const FLAT_ROUNDING: f64 = 4.0 * UNIT_ROUNDOFF;

/// Largest magnitude of a coordinate of a body, in its own unit.
///
/// Limit of the `f32` boxes of the broad phase: the surface area of a box of twice this size, 2.4e37, still fits.
/// User: `body::validate`.
pub const LARGEST_COORDINATE: f64 = 1e18;
