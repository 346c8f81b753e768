//! Steady affine motions: velocity field, flow, logarithm, chains of spans. Knows no bodies.
//!
//! A steady motion moves every point with a velocity that depends only on its position, v(p) = M
//! p + tau. Its poses are A^t = exp(tG) with the generator G = [M tau; 0 0]:
//!
//! > exp(tG) p = exp(tM) p + t phi1(tM) tau,   phi1(z) = (e^z - 1)/z.
//!
//! Screws, spirals, scalings and shears are steady; see Rossignac & Vinacua, *Steady Affine Motions
//! and Morphs* ("SAM"). SAM, sections 3 and A, computes A^t through a fixed point of the motion. We
//! differ: as an eigenvalue of the linear part nears 1, the fixed point runs off to infinity and
//! all digits are lost (at 1e-5 from 1 the error is 1e-10; at 1e-15 no digit is left). The
//! generator stays finite and phi1 has no pole, so no case is special and translations need no
//! treatment of their own.
//!
//! # Splitting off one eigenvalue
//! Any real 3 x 3 matrix has a real eigenvalue lambda. With Q orthogonal and its first column the
//! eigenvector,
//!
//! > Q^T M Q = [lambda x; 0 C],   C = mean I + C0,   C0^2 = disc I,
//!
//! with a row x that couples the two parts. An eigenbasis, as SAM and most codes use, degenerates
//! where eigenvalues meet; this form does not: it is always backward stable. The eigenvalue is the
//! root of largest magnitude of the cubic of N = M - (tr M / 3) I, x^3 + a x = b. It has the sign
//! of b and never belongs to a cluster: the product of its distances to the other two is at least
//! 9/4 x^2. Newton's method decreases to it monotonically from the upper bound
//! sqrt(max(-a, 0)) + |b|^(1/3). The null vector comes from elimination with complete pivoting. Q
//! is one Householder reflection, hence its own inverse. Three inputs are split without rounding: a
//! column that is an eigenvector already (diagonal and permuted triangular matrices, whatever their
//! shear), a multiple of the identity plus a skew matrix (the generator of a similarity), and
//! multiples of the identity.
//!
//! # Functions of the split form
//! For any f: f(C) = even I + odd C0, and the corner is x f\[lambda, C\], a divided difference,
//! again of the form even I + odd C0. With h = lambda - mean and the divided difference
//! F = f\[lambda, mu1, mu2\] the corner's odd part is F and its even part is odd + h F. For a
//! clustered spectrum F is summed as the following series, so that everything is real and there are
//! no confluent cases:
//!
//! > f\[lambda, mu1, mu2\] = sum_k c_{k+2} H_k,   H_k = -e2 H_{k-2} + e3 H_{k-3},
//! > H_0 = 1, H_1 = 0,
//!
//! with c the Taylor coefficients of f at the centre (lambda + 2 mean)/3, H_k the complete
//! symmetric functions of the eigenvalues minus it, e2 = -h^2/3 - disc and e3 = (2h/3)(h^2/9 -
//! disc). For spread spectra quotients serve; among real eigenvalues the second difference is taken
//! over the farthest pair. The same scheme gives exp and phi1 (`spectrum.rs`) and ln
//! (`logarithm.rs`). The functions of the block alone (`pair.rs`) are all that a motion of the
//! plane needs, see [`planar`]. Evaluation never inverts phi1, so turns beyond 180 degrees, where
//! it can be singular, are ordinary.
//!
//! # The logarithm
//! exp and log share Q. On the split form of the linear part L: ln lambda; for B = alpha I + B0,
//! B0^2 = d I,
//!
//! > ln B = 1/2 ln det B  I + atanh(sqrt d / alpha)/sqrt d  B0
//! > (for d < 0: atan2(sqrt -d, alpha)/sqrt -d);
//!
//! the corner as above; then tau from phi1(M) tau = t, a triangular solve: phi1(M) is regular for
//! angles up to pi. Near the identity, L - I is split instead of L and ln(1 + .) is used, so that
//! small motions keep their digits.
//!
//! A real logarithm exists if and only if negative eigenvalues come in equal pairs without a Jordan
//! block (Culver; SAM 5.1 for 2 x 2). In f64:
//! - alpha < 0 and an angle within 1e-9 of pi: a half turn about the third direction. Both senses
//!   lead to the pose, which does not say which one is meant ([`HalfTurn`]); a chain of keyframes
//!   refuses it unless the user chooses ([`HalfTurns`]). Where B0 is a multiple of a quarter turn
//!   up to 1e-13 |alpha|, it is read as one, so that a rigid motion is rigid throughout.
//! - alpha < 0 and a discriminant whose sign is below the backward error: a Jordan block, refused.
//!   Accepting it would give |M| of 1e8 and an exponential that misses.
//!
//! Every logarithm is checked: exp(log A) must equal A to 1e-10, or the pair of poses is refused as
//! ill-conditioned.
//!
//! # Known limits
//! - A spread of 1e12 between scales within the 2 x 2 block costs some digits of tau (1e-13
//!   measured): even I +- odd C0 cancels at the small end.
//! - For shears that are not along coordinate axes, all tested frames pass the check up to 1e6
//!   (relative to the eigenvalues). At 1e8 a quarter of them are refused as ill-conditioned, and so
//!   are chains of two shears of 1e6. Along coordinate axes there is no such limit.
//!
//! # Corrections to the sources
//! SAM's printed formulas were checked numerically. Right: (4) (but the region that it calls bad is
//! the good one), (5)-(7), (9), (11), (19), (21). Wrong as printed: (8) (sign), (12) (indices
//! transposed), (15) (useless for a quarter turn; ln sqrt(det L) is meant), (18) (needs atan2), A.4
//! (sign; and the path of the origin under a shear is a parabola), A.6 (fails where the eigenvalue
//! 1 is defective). Alexa's inverse scaling and squaring returns -log A, and his angle between
//! transformations is not one. In Kaji & Ochiai (7) the arc cosine loses half the digits near half
//! turns.
//!
//! # Bounds
//! [`stretch`], [`path_bounds`] and [`acceleration_bound`] are proven bounds, rounding included.
//! They rest on the logarithmic norm mu, the largest eigenvalue of (M + M^T)/2, for which |exp(tM)|
//! <= e^(t mu) for t >= 0, with equality for similarities; and on an exponential with its own error
//! analysis (`enclosure.rs`). They hold for the flow of the generator with exactly the given
//! numbers; [`Flow::pose_at`] follows it to rounding, and the [`Flow`] of a [`Logarithm`] to the
//! rounding of the logarithm.

mod affinity;
pub mod chain;
mod deflation;
mod describe;
mod deviation;
mod enclosure;
mod error;
mod existence;
pub(crate) mod expansion;
mod flow;
pub mod following;
mod generator;
mod half_turn;
mod invariants;
mod logarithm;
mod merging;
mod pair;
pub mod planar;
mod point_trajectory;
mod progress;
pub mod scheme;
mod series;
mod spectrum;
pub mod steadiness;
mod steady;
mod trajectory;

pub use affinity::{FitQuality, PointFit, from_points};
pub use describe::{Description, MotionKind, describe};
pub use deviation::Deviation;
pub(crate) use enclosure::least_stretch;
pub use error::MotionError;
pub use existence::{Existence, existence};
pub use flow::Flow;
pub use generator::{Generator, Screw};
pub use half_turn::{HalfTurn, HalfTurns, Sense};
pub use invariants::{Invariants, VolumeChange, invariants, volume_change};
pub use logarithm::{logarithm, logarithm_turning, logarithm_with_turns};
pub(crate) use merging::{Merged, Pace};
pub use point_trajectory::Trajectory;
pub use progress::{Progress, Travel};
pub(crate) use trajectory::box_path_bounds;
pub use trajectory::{acceleration_bound, path_bounds, stretch};

use glam::DAffine3;

/// A motion: start pose (body to world) and a chain of steady spans.
pub type Motion = chain::Motion<Flow>;
/// One steady span of a motion.
pub type Span = chain::Span<Flow>;
/// A pose at a time.
pub type Keyframe = chain::Keyframe<DAffine3>;
/// log A of an affine map of space.
pub type Logarithm = chain::Logarithm<Flow>;
