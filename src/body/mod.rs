//! Bodies: closed, oriented, finite triangle meshes, validated once. Knows no motion.

mod mesh;
mod validate;

pub use mesh::{Edge, Mesh};
pub use validate::BodyError;
