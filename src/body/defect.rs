//! The defects of a triangle list, each with index and place.

use crate::numeric::tolerance::LARGEST_COORDINATE;
use glam::DVec3;
use std::fmt;

/// A reason why a triangle list makes no body.
///
/// Triangles and vertices are counted from 0, in the order in which they were given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Defect {
    /// No triangles at all.
    #[error("the body has no triangles")]
    Empty,
    /// More triangles or vertices than 32-bit edge numbers can count.
    #[error(
        "{triangles} triangles and {vertices} vertices are too many, at most {limit} of each can be numbered"
    )]
    TooMany {
        /// Number of triangles found.
        triangles: usize,
        /// Number of vertices found.
        vertices: usize,
        /// Largest number of either.
        limit: usize,
    },
    /// A triangle uses a vertex that does not exist.
    #[error(
        "triangle {triangle} uses vertex {index}, but there are only {vertices} vertices (counted from 0)"
    )]
    IndexOutOfRange {
        /// The triangle.
        triangle: u32,
        /// The index that was found.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} is at {position}, which is not finite")]
    NonFinite {
        /// The vertex.
        vertex: u32,
        /// Its position.
        position: DVec3,
    },
    /// A coordinate is too large for the computation.
    #[error("vertex {vertex} is at {position}, coordinates must not exceed {LARGEST_COORDINATE:e}")]
    TooFar {
        /// The vertex.
        vertex: u32,
        /// Its position.
        position: DVec3,
    },
    /// A triangle uses one vertex twice.
    #[error("triangle {triangle} uses vertex {vertex}, at {position}, more than once")]
    RepeatedVertex {
        /// The triangle.
        triangle: u32,
        /// The vertex.
        vertex: u32,
        /// Its position.
        position: DVec3,
    },
    /// An edge is used by one triangle only: the mesh is not closed.
    #[error(
        "edge {}-{} of triangle {triangle}, from {} to {}, has no neighbour: the mesh is not closed",
        vertices[0], vertices[1], places[0], places[1]
    )]
    OpenEdge {
        /// The edge, in the sense of the triangle.
        vertices: [u32; 2],
        /// The triangle.
        triangle: u32,
        /// The positions of the two vertices.
        places: [DVec3; 2],
    },
    /// An edge is used by more than two triangles: the surface branches.
    #[error(
        "edge {}-{}, from {} to {}, is shared by {} triangles ({}), expected 2: the surface is non-manifold",
        vertices[0], vertices[1], places[0], places[1], triangles.len(), ShortList(triangles)
    )]
    NonManifoldEdge {
        /// The edge, smaller index first.
        vertices: [u32; 2],
        /// The triangles, ascending.
        triangles: Vec<u32>,
        /// The positions of the two vertices.
        places: [DVec3; 2],
    },
    /// Two neighbours run through their edge in the same sense: one of them is turned over.
    #[error(
        "triangles {} and {} run in the same sense through edge {}-{}, from {} to {}: one of them is turned over",
        triangles[0], triangles[1], vertices[0], vertices[1], places[0], places[1]
    )]
    OpposedTriangles {
        /// The edge, in the sense of the triangles.
        vertices: [u32; 2],
        /// The triangles, ascending.
        triangles: [u32; 2],
        /// The positions of the two vertices.
        places: [DVec3; 2],
    },
    /// A closed shell encloses no volume.
    #[error(
        "the shell of triangle {triangle} ({triangles} triangles, near {place}) is flat: mean thickness {thickness:.3e}, \
         expected more than {limit:.3e}"
    )]
    FlatShell {
        /// Its first triangle.
        triangle: u32,
        /// Number of its triangles.
        triangles: usize,
        /// Twice its volume over its area.
        thickness: f64,
        /// The thickness up to which a shell of this size counts as flat.
        limit: f64,
        /// First corner of its first triangle.
        place: DVec3,
    },
    /// A shell is turned against the rest of the body, but does not lie in its material, and so is
    /// no cavity.
    #[error(
        "the shell of triangle {triangle} ({triangles} triangles, near {place}) is inside out against the rest of the \
         body, volume {volume:.6e}, and does not lie inside it as a cavity would"
    )]
    InvertedShell {
        /// Its first triangle.
        triangle: u32,
        /// Number of its triangles.
        triangles: usize,
        /// Its signed volume, as given.
        volume: f64,
        /// First corner of its first triangle.
        place: DVec3,
    },
}

impl Defect {
    /// What the owner of the file can do about it.
    pub fn remedy(&self) -> &'static str {
        match self {
            Defect::Empty => "export the part as a closed triangle mesh",
            Defect::TooMany { .. } => "reduce the mesh",
            Defect::IndexOutOfRange { .. } => "the file is damaged or cut off: export it again",
            Defect::NonFinite { .. } => "the file is damaged: export it again",
            Defect::TooFar { .. } => {
                "choose a larger unit of length or move the part to the origin"
            }
            Defect::RepeatedVertex { .. } => "remove the triangle",
            Defect::OpenEdge { .. } => {
                "fill the hole in a mesh repair tool or export the part as a closed solid"
            }
            Defect::NonManifoldEdge { .. } => {
                "separate the parts that meet in this edge, or remove inner walls and doubled triangles"
            }
            Defect::OpposedTriangles { .. } => {
                "make the orientation of the triangles consistent in a mesh repair tool"
            }
            Defect::FlatShell { .. } => "remove the shell or give it a thickness",
            Defect::InvertedShell { .. } => "turn the triangles of this shell over",
        }
    }

    /// The same defect in another numbering of triangles and vertices.
    pub fn renumbered(
        self,
        triangle_of: impl Fn(u32) -> u32,
        vertex_of: impl Fn(u32) -> u32,
    ) -> Defect {
        match self {
            Defect::Empty | Defect::TooMany { .. } => self,
            Defect::IndexOutOfRange {
                triangle,
                index,
                vertices,
            } => Defect::IndexOutOfRange {
                triangle: triangle_of(triangle),
                index,
                vertices,
            },
            Defect::NonFinite { vertex, position } => Defect::NonFinite {
                vertex: vertex_of(vertex),
                position,
            },
            Defect::TooFar { vertex, position } => Defect::TooFar {
                vertex: vertex_of(vertex),
                position,
            },
            Defect::RepeatedVertex {
                triangle,
                vertex,
                position,
            } => Defect::RepeatedVertex {
                triangle: triangle_of(triangle),
                vertex: vertex_of(vertex),
                position,
            },
            Defect::OpenEdge {
                vertices,
                triangle,
                places,
            } => Defect::OpenEdge {
                vertices: vertices.map(vertex_of),
                triangle: triangle_of(triangle),
                places,
            },
            Defect::NonManifoldEdge {
                vertices,
                triangles,
                places,
            } => Defect::NonManifoldEdge {
                vertices: vertices.map(vertex_of),
                triangles: triangles.into_iter().map(triangle_of).collect(),
                places,
            },
            Defect::OpposedTriangles {
                vertices,
                triangles,
                places,
            } => Defect::OpposedTriangles {
                vertices: vertices.map(vertex_of),
                triangles: triangles.map(triangle_of),
                places,
            },
            Defect::FlatShell {
                triangle,
                triangles,
                thickness,
                limit,
                place,
            } => Defect::FlatShell {
                triangle: triangle_of(triangle),
                triangles,
                thickness,
                limit,
                place,
            },
            Defect::InvertedShell {
                triangle,
                triangles,
                volume,
                place,
            } => Defect::InvertedShell {
                triangle: triangle_of(triangle),
                triangles,
                volume,
                place,
            },
        }
    }
}

/// Most numbers that a message lists.
const LISTED: usize = 6;

/// The first few numbers of a list, and the count of the others.
struct ShortList<'a>(&'a [u32]);

impl fmt::Display for ShortList<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, number) in self.0.iter().take(LISTED).enumerate() {
            write!(f, "{}{number}", if i == 0 { "" } else { ", " })?;
        }
        if self.0.len() > LISTED {
            f.write_str(", ...")
        } else {
            Ok(())
        }
    }
}

/// Why a body was refused: all its defects, at least one.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyError {
    defects: Vec<Defect>,
}

impl BodyError {
    /// The error with these defects; `None` when there are none.
    pub fn new(defects: Vec<Defect>) -> Option<BodyError> {
        if defects.is_empty() {
            None
        } else {
            Some(BodyError { defects })
        }
    }
    /// The first defect.
    pub fn first(&self) -> &Defect {
        &self.defects[0]
    }
    /// All defects: damaged numbers first, then edges in the order of their vertices, then shells.
    pub fn defects(&self) -> &[Defect] {
        &self.defects
    }
    /// All defects, by value.
    pub fn into_defects(self) -> Vec<Defect> {
        self.defects
    }
}

impl fmt::Display for BodyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}; {}", self.first(), self.first().remedy())?;
        match self.defects.len() - 1 {
            0 => Ok(()),
            1 => f.write_str(" (and one more defect)"),
            more => write!(f, " (and {more} more defects)"),
        }
    }
}

impl std::error::Error for BodyError {}

#[cfg(test)]
mod tests {
    use super::*;

    fn open_edge(triangle: u32) -> Defect {
        Defect::OpenEdge {
            vertices: [4, 7],
            triangle,
            places: [DVec3::ZERO, DVec3::new(0.5, 0.0, 1.0)],
        }
    }

    #[test]
    fn a_message_says_what_where_and_what_to_do() {
        let error = BodyError::new(vec![open_edge(12)]).expect("one defect");
        assert_eq!(
            error.to_string(),
            "edge 4-7 of triangle 12, from [0, 0, 0] to [0.5, 0, 1], has no neighbour: the mesh is not closed; \
             fill the hole in a mesh repair tool or export the part as a closed solid"
        );
    }

    #[test]
    fn further_defects_are_counted() {
        let error =
            BodyError::new(vec![open_edge(1), open_edge(2), open_edge(3)]).expect("three defects");
        assert!(
            error.to_string().ends_with("(and 2 more defects)"),
            "{error}"
        );
        assert!(BodyError::new(Vec::new()).is_none(), "no defect, no error");
    }

    #[test]
    fn long_lists_of_triangles_are_cut() {
        let defect = Defect::NonManifoldEdge {
            vertices: [0, 1],
            triangles: (0..9).collect(),
            places: [DVec3::ZERO, DVec3::X],
        };
        assert!(
            defect
                .to_string()
                .contains("by 9 triangles (0, 1, 2, 3, 4, 5, ...)"),
            "{defect}"
        );
    }

    #[test]
    fn renumbering_reaches_every_index() {
        let defect = open_edge(2).renumbered(|t| t + 10, |v| v + 100);
        assert!(
            matches!(
                defect,
                Defect::OpenEdge {
                    vertices: [104, 107],
                    triangle: 12,
                    ..
                }
            ),
            "{defect:?}"
        );
    }
}
