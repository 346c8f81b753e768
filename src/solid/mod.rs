//! From the sweep cycle to the swept solid: arrangement, winding numbers, closed boundary.
//!
//! The cycle crosses itself; the cells of its arrangement have constant winding number, and the
//! boundary of {w >= 1} is the boundary of the swept region ([`crate::envelope`]).

pub mod planar;
pub mod spatial;
