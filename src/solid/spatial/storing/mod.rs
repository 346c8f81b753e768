//! A boundary as it is stored: vertices that a reader would take as one are joined or parted
//! (`joining`), edges of several sheets come apart (`touching`).

pub(super) mod joining;
pub(super) mod touching;
