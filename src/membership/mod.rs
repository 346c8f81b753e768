//! A point and a moving body: during which times is the point inside?
//!
//! A world point x is in the body at time t if and only if the point relative to the body,
//! c(t) = pose(t)^-1 x, is in the body at rest. In each span, c is a curve with a known expansion
//! (`path`). It is followed in short windows: over each of them it stays within a certified
//! distance of its chord, so that a query of the tree of the body by a thick segment finds every
//! triangle that it can meet. The height over the plane of such a triangle is a polynomial; its
//! zeros are isolated by bounds (`numeric::roots`), never by sampling. Between consecutive zeros
//! nothing can change. The winding number follows from the crossings and, wherever one is in doubt
//! (edges, vertices, tangency, joints), from the exact test at rest in the middle of the piece.
//!
//! # Rounding
//! Every position c is known to within a slack of k u L, with L the largest coordinate of the
//! point, the motion and the body, in the frame of the body up to that time (`PATH_ROUNDING`). A
//! point within a few slacks of a triangle, not only of its plane, counts as touching it (`touch`):
//! - The body is closed: sliding along a face, an edge or a vertex counts as inside, even when the
//!   body is never entered. A touch at one instant gives a degenerate interval, [t, t] or slightly
//!   longer.
//! - The time of a transversal crossing is known to the slack over the normal speed, far below 1e-9
//!   of the span for ordinary motions. At a tangency it is known to the square root of that: an
//!   absence or a visit no deeper than a few slacks may be lost or appear.
//! - Two crossings that rounding cannot separate, and anything else below this resolution, are
//!   united.

mod deviating;
mod event;
mod height;
mod patch;
mod path;
pub mod planar;
mod settings;
mod spatial;
mod timeline;
mod touch;

pub use settings::{ProbeSettings, ProbeStage};
pub use spatial::Membership;
