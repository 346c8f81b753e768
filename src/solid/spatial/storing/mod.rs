//! A boundary as it is stored: vertices that a reader would take for one are joined or separated
//! (`joining`), edges of several sheets come apart (`touching`), and so do triangles that rounding
//! moved through each other (`untangling`).

pub(super) mod joining;
pub(super) mod touching;
pub(super) mod untangling;
