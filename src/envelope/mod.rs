//! The envelope: the grazing set carried over time, and the closed surface that it forms with the
//! body's start and end.
//!
//! # The sweep cycle
//! For any set E of (subdivided) faces with complement I, the faces of E at the end pose, those of
//! I at the start pose and the strips swept by the boundary of E form a closed oriented surface. It
//! crosses itself, and its winding number at x is
//!
//! w(x) = \[x in the body at the start\] + sum over the times at which x, relative to the body,
//! crosses E, of sign(n . v).
//!
//! Proof: push the 3-chain \[0,1\] x E forward; its local degree is sign(n . v); add the body at
//! the start; take boundaries. When E is the egress set, every term is +1, so **w(x) is the number
//! of separate time intervals that x spends inside the body, and the swept region is exactly
//! {w >= 1}**. Any face put on the wrong side only lowers w.
//!
//! In a chain, the cycles of the spans are added, minus the body's boundary at each joint: at the
//! pose between spans k and k + 1, only E_k - E_{k+1} remains. Faces cut by either span are cut by
//! both there, so that everything conforms. A motion that ends where it began keeps both caps:
//! dropping them would count intervals on a circle and lose the points that never leave the body.
//!
//! # Outer and inner sheets
//! The winding number is lower on the side nu = e x v of the strip of e, where E is on the left of
//! e. A strip is *outer* (0 | 1) or *inner* (1 | 2): a convex edge is outer, a concave edge is
//! inner, and a segment across a face is outer where n . M v > 0.
//!
//! # Sampling
//! All paths of a span are sampled at common times. The chord of a step h misses the path by at
//! most h^2/8 |M v|; the ruled patch of a straight piece misses its two triangles by its twist.
//! Both are bounded piece by piece (`spatial/sampling`). Farther than this error from the sheets,
//! the winding number of the sampled cycle is that of the exact one (a homotopy that does not pass
//! there). So the result sticks out of the true sweep by at most the sampling error.
//!
//! # Both bounds are proven
//! Let e be the sampling error and R the result. Let E' be the egress region as it was chosen
//! (shallow folds dropped, break points merged), and D the parts of faces that count with the wrong
//! sign by that. Let x be a point of the sweep that R lacks.
//! - If the exact cycle of E' winds round x, the homotopy passes: a point y of the sampled cycle is
//!   within e. If y is in the closure of R, that is all. Otherwise it is on a piece of the
//!   arrangement with w <= 0 on both sides, or on one that cancelled another.
//! - If it does not, x crosses a part of D, by the formula above: x is a point that D sweeps.
//!
//! So the sweep reaches out of R by at most the larger of e plus the distance of such a piece from
//! R, and the distance from R of what D sweeps. Both are found afterwards (`solid::spatial`). What
//! D sweeps is part of the sweep, so this is no more than what is missed. The fins below lower w
//! nowhere. In a chain the same holds for the parts of all spans together.
//!
//! This leaves out faces whose flux is zero up to its rounding: they count as right, as if the body
//! were rounded. For translations nothing is left out: their signs are exact for a body nearby
//! (`grazing`), nothing is sampled, and the argument is that given for the plane.
//!
//! Where facets of a body come to the same places one after another, the steps of a rotation are
//! chosen so that their sheets are the same triangles (`spatial/alignment`), and vertices that miss
//! each other by less than the merge budget are joined (`spatial/coincidence`; counted in the
//! bound). Otherwise all sheets of a part turned about its own axis would cross each other.
//!
//! # Sinking
//! Sheets closer to each other than their sampling errors cross and leave spurious voids and
//! handles. Inner sheets are therefore moved into the body (`spatial/sinking`) by fins that are
//! added to E at the end and removed from it at the start; where the flux through a fin is nowhere
//! negative, this lowers w nowhere.
//!
//! # Dents
//! Where the boundary of E runs to and fro, seen along the motion, its sheets lie on each other and
//! leave films open between them. Fins across such places (`spatial/straightening`) lower w nowhere
//! either, and raise it only near the body: their distance from the body is added to the bound on
//! how far the result may stick out.
//!
//! # In the plane
//! The same holds with one dimension less: edges of a polygon take the place of faces, and the
//! paths of the points at which the flux changes sign along an outline take the place of strips.
//! They are sampled at common times and become polylines; nothing twists, nothing is sunk, and both
//! error bounds are **proven**.
//!
//! Let C be the exact cycle with winding number w, C' the sampled one with w', and R = {w' >= 1}
//! the result. The straight homotopy between C and C' moves no point farther than the sampling
//! error e.
//! - *Excess.* Where w' >= 1 but w <= 0 (w is never negative) the homotopy passes, so a point of C
//!   is within e. The paths of C are paths of points of the body, and the caps lie in its poses, so
//!   every point of C is a point of the sweep. Hence R reaches out by at most e.
//! - *Shortfall.* Where w >= 1 but w' <= 0 the homotopy passes too, so a point y of C' is within e.
//!   If y is in the closure of R, that is all. Otherwise y is on a piece of the arrangement with w'
//!   <= 0 on both sides, or on one that cancelled another. There are few of these, so their
//!   distance from R is found and bounded: the distance is 1-Lipschitz, so its values at the ends
//!   and the length bound it in between. Hence the sweep reaches out of R by at most e plus the
//!   largest distance of such a piece from R.
//!
//! Dropped folds (`grazing`) make C' the sampled cycle of a larger body B', up to a homotopy of at
//! most their depth d. The sweep of B lies in that of B', so the shortfall is at most e + d plus
//! that distance. The excess stays e: by the formula above, no choice of signs makes w larger than
//! the exact choice does.
//!
//! In a chain each span k has its own B'_k. Their cycles add up to w' = sum over the spans of w_k,
//! minus the number of joints at which x is in B. Suppose x is in B during some spans. At a joint
//! at which it is in B, both adjacent spans count it, and n spans have at most n - 1 joints between
//! them: so w' >= 1.
//!
//! Snap rounding, and the filling of holes that only the sampling made, move the boundary by known
//! lengths, which are added.

pub mod planar;
pub mod spatial;
