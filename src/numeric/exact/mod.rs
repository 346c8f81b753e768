//! Exact arithmetic: signs of determinants, numbers with twice the precision of `f64`, and the
//! integer grids of the plane and of space with the exact decisions on them.

pub(crate) mod double;
pub(crate) mod planar_grid;
pub(crate) mod signs;
pub(crate) mod spatial_grid;
