//! From the sweep cycle to the swept solid: arrangement, winding number, closed boundary, measures.
//!
//! The cycle crosses itself; the cells of its arrangement have constant winding number, and the boundary of
//! {w >= 1} is the boundary of the swept region ([`crate::envelope`]). What remains of the sampling, cavities thinner
//! than the error bound, is tested against the exact motion of points (`pockets`).

mod arrangement;
mod joining;
mod measure;
mod pockets;
mod shells;
pub mod spatial;
mod touching;

pub use measure::Measures;
