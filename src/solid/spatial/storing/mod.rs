//! A boundary as it is stored: vertices that a reader would take for one are joined or separated
//! (`joining`), and edges of several sheets come apart (`touching`).

pub(super) mod joining;
pub(super) mod touching;
