//! The envelope: grazing set times time, and the closed surface that it makes with the body's start
//! and end.
//!
//! # The sweep cycle
//! For any set E of (subdivided) faces, I the rest: E at the end pose, I at the start pose and the
//! strips swept by the boundary of E close to an oriented surface. It crosses itself, and its
//! winding number at x is
//!
//! w(x) = \[x in the body at the start\] + sum over the times at which x, seen from the body,
//! crosses E, of sign(n . v).
//!
//! Proof: push the 3-chain \[0,1\] x E forward; its local degree is sign(n . v); add the body at
//! the start; take boundaries. With E the egress set every term is +1, so **w(x) is the number of
//! separate time intervals that x spends inside the body, and the swept region is exactly {w >=
//! 1}**. Any face put on the wrong side only lowers w.
//!
//! In a chain the cycles of the spans add up, less the body's boundary at each joint: at the pose
//! between spans k and k + 1 only E_k - E_{k+1} remains. Faces cut by either span are cut by both
//! there, so that everything conforms. A motion that ends where it began keeps both caps: dropping
//! them would count intervals on a circle and lose the points that never leave the body.
//!
//! # Outer and inner sheets
//! The winding number is lower on the side nu = e x v of the strip of e, where E is on the left of
//! e. A strip is *outer* (0 | 1) or *inner* (1 | 2): a convex edge is outer, a concave edge inner,
//! a segment across a face outer where n . M v > 0.
//!
//! # Sampling
//! All paths of a span are sampled at common times. The chord of a step h misses the path by at
//! most h^2/8 |M v|; the ruled patch of a straight piece misses its two triangles by its twist.
//! Both are bounded piece by piece (`spatial/sampling`), and the winding number of the sampled
//! cycle is that of the exact one farther than that from the sheets (a homotopy that does not pass
//! there). So the result sticks out of the true sweep by at most the sampling error: that is
//! proven. The shortfall lies within it of the outer sheets, but where the body is thinner than
//! twice the error not within it of the *result*: an estimate.
//!
//! A translation sweeps parallelograms, so nothing is sampled, and the signs are exact but for
//! faces along the way (`grazing`). Its shortfall is **proven** by the argument given for
//! the plane below, with the pieces of the cycle that are left outside of the result, those that
//! cancel included: as far as they are from it is added.
//!
//! Where facets of a body come to the same places one after another, steps of a rotation are chosen
//! so that their sheets are the same triangles (`spatial/alignment`), and vertices that miss each
//! other by less than the merge budget are joined (`spatial/coincidence`; counted in the bound):
//! else all sheets of a turned part about its own axis would cross each other.
//!
//! # Sinking
//! Sheets closer to each other than their sampling errors cross and leave spurious voids and
//! handles. Inner sheets are therefore moved into the body (`spatial/sinking`) by fins added to E
//! at the end and taken from it at the start; where the flux through a fin is nowhere negative this
//! lowers w nowhere.
//!
//! # Dents
//! Where the boundary of E runs to and fro, seen along the motion, its sheets lie on each other and
//! leave films open between them. Fins across such places (`spatial/straightening`) lower w nowhere
//! either, and raise it only near the body: their distance from it goes to the bound of how far the
//! result may stick out.
//!
//! # In the plane
//! The same with one dimension less: edges of a polygon for faces, and for strips the paths of the
//! points at which the flux changes sign along an outline. They are sampled at common times and
//! become polylines; nothing twists, nothing is sunk, and both error bounds are **proven**.
//!
//! Let C be the exact cycle, w its winding number, C' the sampled one with w' and R = {w' >= 1} the
//! result. The straight homotopy between C and C' moves no point farther than the sampling error e.
//! - *Excess.* Where w' >= 1 but w <= 0 (w is never negative) the homotopy passes, so a point of C,
//!   which is in the closure of the sweep, is within e. Or so it would be if all of C were its
//!   border; but the paths of C are paths of points of the body, and the caps lie in its poses, so
//!   every point of C is a point of the sweep. Hence R reaches out by at most e.
//! - *Shortfall.* Where w >= 1 but w' <= 0 the homotopy passes too, so a point y of C' is within e.
//!   If y is in the closure of R that is all. Else y is on a piece of the arrangement with w' <= 0
//!   on both sides, or on one that cancelled another. There are few of these, so their distance
//!   from R is found and bounded: the distance is 1-Lipschitz, so its values at the ends and the
//!   length bound it in between. Hence the sweep reaches out of R by at most e plus the largest
//!   distance of such a piece from R.
//!
//! Folds that are given up (`grazing`) make C' the sampled cycle of a larger body B', but
//! for a homotopy of at most their depth d. The sweep of B lies in that of B', so the shortfall is
//! at most e + d plus that distance. The excess stays e: by the formula above no choice of signs
//! makes w larger than the exact one does.
//!
//! In a chain each span k has its own B'_k. Their cycles add up to w' = sum over the spans of w_k,
//! less the number of joints at which x is in B. Let x be in B during some spans. At a joint at
//! which it is in B both spans next to it count it, and n spans have at most n - 1 joints between
//! them: w' >= 1.
//!
//! Snap rounding, and the filling of holes that only the sampling made, move the border by known
//! lengths, which are added.

pub mod planar;
pub mod spatial;
