//! Procedural bodies and naive references, shared by the tests and benches.

#![allow(
    clippy::cast_possible_truncation,
    reason = "counts of small shapes and samples"
)]

pub(crate) mod command;
pub(crate) mod contact;
pub(crate) mod curves;
pub(crate) mod data;
pub(crate) mod exponential;
pub(crate) mod membership;
pub(crate) mod planar;
pub(crate) mod random;
pub(crate) mod scratch;
pub(crate) mod shapes;
pub(crate) mod sweep;
pub(crate) mod taylor;
