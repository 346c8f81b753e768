//! Numbers: thresholds and their derivation, exact signs. Nothing here knows the geometry of bodies.

pub mod predicates;
pub mod tolerance;
