//! Closed oriented surfaces of triangles: which meet at which edges (`sides`) and belong together
//! there (`pairing`, `mates`), shells, measures, surgery along loops (`halves`), collapses of edges
//! (`collapsing`), and vertices that are meant as one (`weld`). Nothing here knows bodies.

mod collapsing;
mod halves;
mod mates;
mod measure;
mod pairing;
mod shells;
mod sides;
mod weld;

pub(crate) use collapsing::{Collapsing, Spoke};
pub(crate) use halves::Halves;
pub(crate) use mates::{Mates, next_in};
pub use measure::Measures;
pub(crate) use measure::{bounds_of, measure, touching_edges, volume_and_area};
pub(crate) use pairing::pairs_around;
pub(crate) use shells::{Shells, genus};
pub(crate) use sides::{Sides, edges, is_closed};
pub(crate) use weld::{Grid, Welded, weld};
