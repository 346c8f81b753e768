//! Bodies: closed, oriented, finite triangle meshes, validated once. Knows no motion.
//!
//! A body is the set of points around which its shells wind at least once. A *shell* is a set of
//! triangles joined across edges; it may touch others at vertices. Shells that enclose negative
//! volume are cavities and must lie in the material of another shell. A positive shell in material
//! is legal and does not change the body; it is reported as [`ShellRole::Nested`]. When the whole
//! is inside out, with negative total volume, everything is turned; nothing is turned otherwise. An
//! obstacle may be less than a body: a [`Surface`].
//!
//! In the plane a body is a [`Polygon`]: outlines with the body on their left; outlines without an
//! inside are [`Polylines`].

mod columns;
mod defect;
mod edge;
mod mesh;
mod outlines;
mod parts;
mod polygon;
mod polygon_defect;
mod polylines;
mod shell;
mod sides;
mod surface;
mod thickened;
mod validate;

pub use defect::{BodyError, Defect};
pub use edge::Edge;
pub use mesh::Mesh;
pub use polygon::{FillRule, Polygon};
pub use polygon_defect::{LoopPlace, PolygonError};
pub use polylines::{PolylineError, Polylines};
pub(crate) use shell::Thickness;
pub use shell::{Shell, ShellRole};
pub use surface::Surface;
pub use thickened::ThickenError;
pub use validate::defects;
