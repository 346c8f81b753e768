//! Numbers: thresholds and their derivation, exact signs, certified zeros, areas, indices, and how they are
//! printed. Nothing here knows the geometry of bodies.

pub(crate) mod area;
mod index;
mod ordered;
pub mod predicates;
mod readable;
pub(crate) mod roots;
pub mod tolerance;

pub(crate) use index::index;
pub(crate) use ordered::Ordered;
pub(crate) use readable::Readable;
