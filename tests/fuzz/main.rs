//! Random files for every reader, and random curves: nothing panics, hangs or fills the memory, and
//! what is accepted is right.
//!
//! `cargo test` runs some hundred cases of each target. For more, such as half an hour of one:
//!
//! ```sh
//! FUZZ_SECONDS=1800 cargo test --test fuzz -- reader_stl --nocapture
//! ```
//!
//! The target of the arrangement in space is with its code, `solid::spatial::arrangement::fuzz`.

#![allow(
    clippy::cast_possible_truncation,
    reason = "numbers below a small count, and rounding that is wanted"
)]

mod campaign;
mod curves;
mod mutation;
#[path = "../it/support/random.rs"]
#[expect(dead_code, reason = "the other tests use the rest")]
mod random;
mod readers;
mod seeds;
