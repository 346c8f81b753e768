//! Where the velocity grazes the body: ingress, grazing and egress.
//!
//! On a face with outward normal n the flux g(p) = n . v(p) is linear in p. A steady motion keeps
//! it constant up to a positive factor in the body's frame (L^-T n . v(A^t p) is g(p) again,
//! Rossignac & Vinacua, *Steady Affine Motions and Morphs*, 6.2), so the sets found here at the
//! start of a span hold for the whole of it:
//!
//! - **egress**, g > 0: the body leaves its place there; with the body at the end of the span;
//! - **ingress**, g < 0: the body enters; with the body at the start;
//! - **grazing**, g = 0: the boundary of the egress part, closed loops of segments across faces and
//!   of intervals of edges. Carried by the flow it is the envelope.
//!
//! The grazing point of an edge is eq. (8) of that paper with its sign corrected: on the edge q + s
//! t, t its direction, s = -n.(M q + tau) / n.(M t); here as the root of the linear interpolation
//! of the two corner fluxes.
//!
//! # Sign rule
//! |g| below [`ZERO_FLUX`](crate::numeric::tolerance::ZERO_FLUX) of the largest speed counts as zero. A face with no
//! corner above zero and some below is ingress whole; with no corner below zero, egress whole; only
//! strictly mixed faces are cut. Whatever the signs, the loops close: each is a boundary. Without
//! the rule, rounding cuts faces of zero flux at random.
//!
//! # Shallow folds
//! On a finely tessellated body the exact loops zigzag: sheets a facet's sagitta apart. A face
//! whose fold is shallower than a given depth may take one sign: such that the loops sweep the
//! least area (`spatial/parting`, `spatial/smoothing`), and no layer deeper than that is lost
//! (`spatial/shallow`, `spatial/following`). Any other choice than the exact one can only lose
//! volume (the winding number of the sweep cycle is largest for the exact choice; see
//! [`crate::envelope`]). Motions along straight lines keep the exact choice.
//!
//! # Translations
//! The signs of a translation are exact, but for faces that lie along the way up to rounding, and
//! what those can lose is proven (`spatial/projection`).
//!
//! # In the plane
//! Edges take the place of faces, and points that of segments; the sign rule is the same. What is
//! lost by giving up folds is proven there (`planar/flattening`): only such signs are given up that
//! are the exact ones of a body that contains the given one, with an outline no farther than a
//! given depth from it.

mod flux;
pub(crate) mod planar;
pub(crate) mod spatial;
