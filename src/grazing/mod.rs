//! Where the velocity grazes the body: ingress, grazing and egress.
//!
//! On a face with outward normal n the flux g(p) = n . v(p) is linear in p. A steady motion keeps
//! it constant up to a positive factor in the body's frame (L^-T n . v(A^t p) is g(p) again,
//! Rossignac & Vinacua, *Steady Affine Motions and Morphs*, 6.2), so the sets found here at the
//! start of a span hold for the whole of it:
//!
//! - **egress**, g > 0: the body moves outwards there; these faces are used at the end of the span;
//! - **ingress**, g < 0: the body moves inwards there; these faces are used at the start;
//! - **grazing**, g = 0: the boundary of the egress part: closed loops of segments across faces and
//!   of intervals of edges. Carried by the flow, it sweeps the envelope.
//!
//! The grazing point of an edge is eq. (8) of that paper with its sign corrected: on the edge q + s
//! t with direction t, s = -n.(M q + tau) / n.(M t): [`on_line_in_face`]. In the sets it is computed
//! as the root of the linear interpolation of the two corner fluxes.
//!
//! [`of`] and [`planar::of`] give the exact sets of a whole motion.
//!
//! # Sign rule
//! |g| below 1e-12 of the largest speed (`ZERO_FLUX` in `src/numeric/tolerance.rs`) counts as zero.
//! A face with no corner above zero and some below is ingress as a whole; a face with no corner
//! below zero is egress as a whole; only strictly mixed faces are cut. Whatever the signs, the loops
//! close: each is a boundary. Without the rule, rounding would cut faces of zero flux at random.
//!
//! # Shallow folds
//! On a finely tessellated body the exact loops zigzag, and sweep sheets that are only a facet's
//! sagitta apart. A face whose fold is shallower than a given depth may therefore take one sign.
//! The signs are chosen such that the loops sweep the least area (`spatial/parting`,
//! `spatial/smoothing`), and no layer deeper than the given depth is lost (`spatial/shallow`,
//! `spatial/following`): an estimate that only serves the choice. Any choice other than the exact
//! one can only lose volume (the winding number of the sweep cycle is largest for the exact choice;
//! see [`crate::envelope`]). The parts with wrong signs are kept (`spatial/wrong`), so that the loss
//! can be bounded afterwards. Motions along straight lines keep the exact choice.
//!
//! # Translations
//! The signs of a translation are exact, except for faces that are parallel to the displacement up
//! to rounding; what those can lose is proven (`spatial/projection`).
//!
//! # In the plane
//! Edges take the place of faces, and points that of segments; the sign rule is the same. The loss
//! from dropped folds is proven there (`planar/flattening`): signs are changed only to the exact
//! signs of a larger body, which contains the given one and whose outline is no farther from it
//! than a given depth.

mod flux;
pub mod planar;
pub(crate) mod spatial;

pub use spatial::{Fold, GrazingPoint, GrazingSegment, Source, SpanGrazing, of, on_line_in_face};
