//! Swept volumes and first contact of bodies that move by steady affine motions.

pub mod body;
pub mod bounds;
pub mod envelope;
pub mod grazing;
pub mod io;
pub mod membership;
pub mod motion;
pub mod numeric;
pub mod report;
mod sweep;

pub use solid::spatial::Precision;
pub use sweep::{Bound, ErrorBound, Stage, Sweep, SweepError, SweepSettings, sweep};
pub mod solid;
