//! From the sweep cycle to the swept solid: arrangement, winding number, closed boundary, measures.
//!
//! The cycle crosses itself; the cells of its arrangement have constant winding number, and the boundary of
//! {w >= 1} is the boundary of the swept region ([`crate::envelope`]). Cavities that the sampling or the
//! dropped folds made are filled (`pockets`), handles that it made cut or filled (`handles`), and vertices that a reader would take as one are joined or parted
//! (`joining`, `touching`). What of the cycle is left outside tells how far the region may fall short (`missed`).

mod arrangement;
mod halves;
mod handles;
mod islands;
mod joining;
mod loops;
mod measure;
mod missed;
pub mod planar;
mod pockets;
mod shells;
pub mod spatial;
mod touching;

pub use measure::Measures;
