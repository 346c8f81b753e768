//! Numbers: thresholds and their derivation, exact signs, certified zeros, differences of products,
//! areas, norms, nearest points of segments, indices and sets of them, a spatial hash, and how
//! numbers are printed. Nothing here knows the geometry of bodies.

pub(crate) mod area;
pub(crate) mod closest;
mod disjoint_sets;
pub(crate) mod exact;
mod index;
pub(crate) mod norms;
mod ordered;
mod products;
mod readable;
pub(crate) mod roots;
mod spatial_hash;
pub(crate) mod tolerance;

pub(crate) use disjoint_sets::DisjointSets;
pub(crate) use index::index;
pub(crate) use ordered::Ordered;
pub(crate) use products::difference_of_products;
pub(crate) use readable::Readable;
pub(crate) use spatial_hash::{SpatialHash, cubes};
