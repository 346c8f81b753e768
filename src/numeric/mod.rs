//! Numbers: thresholds and their derivation, indices. Nothing here knows the geometry of bodies.

mod index;
pub mod tolerance;

pub(crate) use index::index;
