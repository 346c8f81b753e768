//! Closed oriented surfaces of triangles: half-edges and surgery on them, shells, measures, whether
//! edges match, and vertices that are meant as one. Nothing here knows bodies.

mod closed;
mod halves;
mod measure;
mod shells;
mod weld;

pub(crate) use closed::is_closed;
pub(crate) use halves::{Halves, next_in, pairs_around};
pub use measure::Measures;
pub(crate) use measure::{bounds_of, measure, touching_edges, volume_and_area};
pub(crate) use shells::{Shells, edges, genus};
pub(crate) use weld::{Grid, Welded, weld};
