//! Closed oriented surfaces of triangles: which triangles meet at an edge (`sides`) and belong
//! together there (`pairing`, `mates`), shells, measures, surgery along loops (`halves`), edge
//! collapses (`collapsing`), joining vertices that are meant to be one (`weld`), and points that know
//! where the inside is (`point`). This module
//! knows no bodies.

mod collapsing;
mod halves;
mod mates;
mod measure;
mod pairing;
mod point;
mod shells;
mod sides;
mod weld;

pub(crate) use collapsing::{Collapsing, Spoke};
pub(crate) use halves::Halves;
pub(crate) use mates::{Mates, next_in};
pub use measure::Measures;
pub(crate) use measure::{bounds_of, measure, touching_edges, volume_and_area};
pub(crate) use pairing::pairs_around;
pub(crate) use point::SurfacePoint;
pub(crate) use shells::{Shells, genus};
pub(crate) use sides::{Sides, edges, is_closed};
pub(crate) use weld::{PointGrid, Welded, weld};
