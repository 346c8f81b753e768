//! The guide: a page per job, and the reference.
//!
//! | page | what it answers |
//! |---|---|
//! | [`sweep`] | which region does a body pass through? |
//! | [`check`] | does it hit something? |
//! | [`probe`] | when is a point inside it? |
//! | [`plane`] | the same for drawings, and what is left of a blank |
//! | [`motions`] | how is a motion given? |
//! | [`library`] | how is all this called from Rust? |
//! | [`files`], [`json`], [`exit_codes`] | reference: formats, reports, numbers for scripts |
//!
//! The pages are the files next to this one, and can be read there as well. `links.md` comes first
//! in each: of two definitions of a link the first one counts, so that links lead to pages of this
//! documentation here, and to files there.

/// The region that a body passes through, as a closed solid.
///
#[doc = include_str!("../../examples/bracket_sweep.svg")]
///
#[doc = include_str!("links.md")]
#[doc = include_str!("sweep.md")]
pub mod sweep {}

/// A proof that the path is clear, or the first contact.
///
#[doc = include_str!("../../examples/bracket_contact.svg")]
///
#[doc = include_str!("links.md")]
#[doc = include_str!("check.md")]
pub mod check {}

/// The times during which points are inside a moving body.
///
#[doc = include_str!("../../examples/bracket_points.svg")]
///
#[doc = include_str!("links.md")]
#[doc = include_str!("probe.md")]
pub mod probe {}

/// Drawings that move, the regions that they sweep, and what they leave of a blank.
///
#[doc = include_str!("../../examples/lever_sweep.svg")]
///
#[doc = include_str!("../../examples/lever_pocket.svg")]
///
#[doc = include_str!("links.md")]
#[doc = include_str!("plane.md")]
pub mod plane {}

/// Motions by options and in files, and half turns.
///
#[doc = include_str!("../../examples/bracket_path.svg")]
///
#[doc = include_str!("links.md")]
#[doc = include_str!("motions.md")]
pub mod motions {}

/// The kernel called from Rust, with or without files.
///
#[doc = include_str!("links.md")]
#[doc = include_str!("library.md")]
pub mod library {}

/// Formats that are read and written.
///
#[doc = include_str!("links.md")]
#[doc = include_str!("files.md")]
pub mod files {}

/// The keys of the reports.
///
#[doc = include_str!("links.md")]
#[doc = include_str!("json.md")]
pub mod json {}

/// What the exit code tells a script.
///
#[doc = include_str!("exit_codes.md")]
pub mod exit_codes {}

/// The code of the README.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
mod readme {}
