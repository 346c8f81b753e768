//! Swept volumes and first contact of bodies that move by steady affine motions.

pub mod numeric;
pub mod motion;
pub mod body;
pub mod bounds;
pub mod grazing;
pub mod envelope;
pub mod membership;
pub mod solid;
pub mod io;
pub mod report;
