//! Numbers: thresholds and their derivation, exact signs, indices. Nothing here knows the geometry of bodies.

mod index;
pub mod predicates;
pub mod tolerance;

pub(crate) use index::index;
