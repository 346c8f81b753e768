//! A surface at rest, prepared for queries: which triangles are near, how far away it is, what lies
//! inside, where it crosses itself.
//!
//! The boxes of the tree are stored in `f32`, in a frame of their own (centred on the surface,
//! scaled by a power of two), and every box contains what it stands for. Coordinates, distances and
//! signs stay in `f64`. Nothing here knows motion.

mod apart;
mod containment;
mod corners;
mod distance;
mod meeting;
mod meetings;
mod outline;
mod outward;
mod tree;

pub(crate) use apart::are_apart;
pub use containment::Location;
pub(crate) use corners::{box_corners, boxes_meet, rectangle_corners, triangle_box};
pub(crate) use distance::distance_to_triangle;
pub use meeting::Meeting;
pub(crate) use meeting::meeting;
pub use meetings::MeetingPair;
pub(crate) use outline::OutlineTree;
pub(crate) use tree::Content;
pub use tree::SurfaceTree;
