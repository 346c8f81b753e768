//! The sign of the flux on an edge of a polygon and on a face of a mesh.

/// The sign of the flux along an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum EdgeFlux {
    /// Nowhere positive: the whole edge enters.
    Ingress,
    /// Nowhere negative: the whole edge leaves.
    Egress,
    /// Both signs occur: one point grazes.
    Cut {
        /// Position of the grazing point, above 0 at the first corner and below 1 at the second.
        at: f64,
        /// Whether the part before that point, rather than the one after it, is egress.
        egress_first: bool,
    },
}

impl EdgeFlux {
    /// Whether the edge is egress at its first corner, and at its second.
    pub(crate) fn is_egress_at_ends(&self) -> [bool; 2] {
        match *self {
            EdgeFlux::Ingress => [false; 2],
            EdgeFlux::Egress => [true; 2],
            EdgeFlux::Cut { egress_first, .. } => [egress_first, !egress_first],
        }
    }

    /// Whether the edge is egress right after a position.
    pub(crate) fn is_egress_after(&self, position: f64) -> bool {
        match *self {
            EdgeFlux::Ingress => false,
            EdgeFlux::Egress => true,
            EdgeFlux::Cut { at, egress_first } => (position < at) == egress_first,
        }
    }
}

/// A point on the border of a face at which its flux changes sign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Break {
    /// Side of the face, from corner `side` to corner `side + 1` (mod 3).
    pub side: usize,
    /// Index into [`Mesh::edges`](crate::body::Mesh::edges).
    pub edge: u32,
    /// Position on that edge, from 0 at `vertices[0]` to 1 at `vertices[1]`.
    pub t: f64,
}

/// The sign of the flux on a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum FaceFlux {
    /// Nowhere positive: the whole face enters.
    Ingress,
    /// Nowhere negative: the whole face leaves.
    Egress,
    /// Both signs occur: the segment between two breaks grazes.
    Cut {
        /// Which corners lie in the egress part.
        egress_corners: [bool; 3],
        /// The break at which the border, run counter-clockwise, leaves the egress part.
        leave: Break,
        /// The break at which it enters the egress part again.
        enter: Break,
    },
}

impl FaceFlux {
    /// Whether `corner` lies in the egress part.
    pub(crate) fn is_egress_at(&self, corner: usize) -> bool {
        match self {
            FaceFlux::Ingress => false,
            FaceFlux::Egress => true,
            FaceFlux::Cut { egress_corners, .. } => egress_corners[corner],
        }
    }
}

/// The flux by the sign rule: zero when it is below the threshold, see [`crate::grazing`].
pub(super) fn snap(flux: f64, zero: f64) -> f64 {
    if flux.abs() < zero { 0.0 } else { flux }
}

/// Whether a face is egress at one corner and ingress at another.
pub(super) fn is_mixed(g: &[f64; 3]) -> bool {
    g.iter().any(|&g| g > 0.0) && g.iter().any(|&g| g < 0.0)
}
