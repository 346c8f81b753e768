//! Every defect that makes a triangle list no body, with its index and place.

/// Why a body was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BodyError {
    /// No triangles at all.
    #[error("the body has no triangles")]
    Empty,
}
