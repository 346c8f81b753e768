//! The envelope: grazing set times time, and the closed surface that it makes with the body's start and end.
//!
//! # The sweep cycle
//! For any set E of (subdivided) faces, I the rest: E at the end pose, I at the start pose and the strips swept by the
//! boundary of E close to an oriented surface. It crosses itself, and its winding number at x is
//!
//! w(x) = \[x in the body at the start\] + sum over the times at which x, seen from the body, crosses E, of sign(n . v).
//!
//! Proof: push the 3-chain \[0,1\] x E forward; its local degree is sign(n . v); add the body at the start; take
//! boundaries. With E the egress set every term is +1, so **w(x) is the number of separate time intervals that x
//! spends inside the body, and the swept region is exactly {w >= 1}**. Any face put on the wrong side only lowers w.
//!
//! In a chain the cycles of the spans add up, less the body's boundary at each joint: at the pose between spans k and
//! k + 1 only E_k - E_{k+1} remains. Faces cut by either span are cut by both there, so that everything conforms.
//! A motion that ends where it began keeps both caps: dropping them would count intervals on a circle and lose the
//! points that never leave the body.
//!
//! # Outer and inner sheets
//! The winding number is lower on the side nu = e x v of the strip of e, where E is on the left of e. A strip is *outer* (0 | 1) or
//! *inner* (1 | 2): a convex edge is outer, a concave edge inner, a segment across a face outer where n . M v > 0.
//!
//! # Sampling
//! All paths of a span are sampled at common times. The chord of a step h misses the path by at most h^2/8 |M v|; the
//! ruled patch of a straight piece misses its two triangles by its twist. Both are bounded piece by piece
//! (`sampling`), and the winding number of the sampled cycle is that of the exact one farther than that from the
//! sheets (a homotopy that does not pass there). So the result sticks out of the true sweep by at most the sampling
//! error: that is proven. The shortfall lies within it of the outer sheets, but where the body is thinner than
//! twice the error not within it of the *result*: an estimate.
//!
//! Where facets of a body come to the same places one after another, steps of a rotation are chosen so that their sheets are the
//! same triangles (`alignment`), and vertices that miss each other by less than the merge budget are joined
//! (`coincidence`; counted in the bound): else all sheets of a turned part about its own axis would cross each other.
//!
//! # Sinking
//! Sheets closer to each other than their sampling errors cross and leave spurious voids and handles. Inner sheets
//! are therefore moved into the body (`sinking`) by fins added to E at the end and taken from it at the start; where
//! the flux through a fin is nowhere negative this lowers w nowhere.
//!
//! # Dents
//! Where the boundary of E runs to and fro, seen along the motion, its sheets lie on each other and leave films open between
//! them. Fins across such places (`straightening`) lower w nowhere either, and raise it only near the body: their distance from
//! it goes to the bound of how far the result may stick out.

mod alignment;
mod assembly;
mod caps;
mod coincidence;
mod lines;
pub mod planar;
mod points;
mod room;
mod runs;
mod sampling;
mod sinking;
pub mod spatial;
mod straightening;
