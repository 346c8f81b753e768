//! Exact arithmetic in one room: signs of determinants, numbers of twice the precision of `f64`, and
//! the integer grids of the plane and of space with the decisions on them.

pub(crate) mod double;
pub(crate) mod planar_grid;
pub(crate) mod signs;
pub(crate) mod spatial_grid;
