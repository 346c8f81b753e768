//! Numbers: thresholds and their derivation, exact signs, certified zeros, areas, indices. Nothing here knows the geometry of bodies.

pub(crate) mod area;
mod index;
pub mod predicates;
pub(crate) mod roots;
pub mod tolerance;

pub(crate) use index::index;
