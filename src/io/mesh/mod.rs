//! Meshes: STL, OBJ and PLY files as bodies and as surfaces, and meshes as files.
//!
//! A new format needs a reader `fn(bytes) -> TriangleList` and a writer beside `stl`, and its name
//! in `format`.

mod body;
mod format;
mod list;
mod numbers;
mod obj;
mod ply;
mod ply_elements;
mod polygon;
mod stl;
mod surface;

pub use body::{ReadReport, parse_body, read_body};
pub use format::{MeshFormat, check_output, write_mesh};
pub use numbers::FileNumbers;
pub use surface::{parse_surface, read_surface};
