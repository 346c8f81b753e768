//! Steady affine motions of the plane. Knows no bodies.
//!
//! As in space (see [`crate::motion`]): v(p) = M p + tau, poses A^t = exp(tG), and
//!
//! > exp(tG) p = exp(tM) p + t phi1(tM) tau,   phi1(z) = (e^z - 1)/z.
//!
//! Nothing needs to be split off here: with x = tr M / 2 and C = M - x I, C^2 = d I,
//!
//! > exp(tM) = e^(xt) (cosh(wt) I + sinh(wt)/w C),   w^2 = d,
//!
//! which is SAM's (11), with cos and sin for d < 0 and a series where w vanishes; phi1(tM) is of
//! the same form even I + odd C. This one formula covers all of SAM's cases (appendix A: a complex
//! pair, two positive eigenvalues, an eigenvalue 1, a shear, a half turn with scale), and none
//! needs a fixed point. SAM's A.4 finds the translation part through one. That fails for shears (as
//! printed, the path of the origin under a shear is straight; it is a parabola) and loses all
//! digits as an eigenvalue nears 1.
//!
//! # The logarithm
//! On L = alpha I + B0, B0^2 = d I: ln L = 1/2 ln det L  I + atanh(sqrt d / alpha)/sqrt d  B0, for
//! d < 0 with atan2(sqrt -d, alpha)/sqrt -d. It exists unless both eigenvalues are negative and not
//! a scaled half turn -s I (Culver, SAM 5.1). A rotation by `a` after a stretch by s and 1/s has
//! one iff |a| < acos(-2s/(s^2 + 1)) = pi/2 + 2 atan s (SAM (4); s <= 1), at least where
//! |a| <= (1 + s) pi/2 for 0 < s < 1.

mod affinity;
mod describe;
mod existence;
mod flow;
mod generator;
mod invariants;
mod logarithm;
mod magnification;
mod steady;
mod trajectory;

pub use affinity::from_points;
pub use describe::{Description, describe};
pub use existence::existence;
pub use flow::Flow;
pub use generator::{Generator, Spiral};
pub use invariants::{Invariants, invariants};
pub use logarithm::{logarithm, logarithm_turning, logarithm_with_turns};
pub use magnification::magnification;
pub(crate) use trajectory::in_space;
pub use trajectory::{acceleration_bound, path_bounds, stretch};

use crate::motion::chain;
use glam::DAffine2;

/// A motion in the plane: start pose (body to world) and a chain of steady spans.
pub type Motion = chain::Motion<Flow>;
/// One steady span of a motion in the plane.
pub type Span = chain::Span<Flow>;
/// A pose in the plane at a time.
pub type Keyframe = chain::Keyframe<DAffine2>;
/// log A of an affine map of the plane.
pub type Logarithm = chain::Logarithm<Flow>;
