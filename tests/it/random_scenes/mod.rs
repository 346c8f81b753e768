//! Random scenes that aim at trouble: nothing panics, and the answers obey simple laws.
//!
//! Sweeps, probes and checks of small bodies under motions that are degenerate more often than not:
//! coplanar faces and parallel edges, axes along edges and through corners, full turns and half
//! turns, shears along faces, repeated eigenvalues, motions that return along the same paths, spans
//! that stand still, nested shells, needles, bodies that touch at the start, constant gaps, units
//! of 1e-3 and 1e6, tolerances from far too large to far too small. The build of tests has debug
//! assertions and overflow checks on: a broken invariant of a stage is a panic here.
//!
//! Every scene has a number and is the same in every run. The ordinary run does the first ones of
//! each kind;
//!
//! ```sh
//! RANDOM_SCENES=2000 cargo test --test it random_scenes
//! ```
//!
//! does two thousand of each in some minutes; `RANDOM_SCENES_FIRST=1234 RANDOM_SCENES=1` does scene
//! 1234 of each kind alone and, with `-- --nocapture`, prints them. All scenes of a kind run before
//! failures are reported.

mod contact;
mod plane;
pub(crate) mod space;

use crate::support::random::Random;
use std::hint::black_box;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Number of scenes of each kind in the ordinary run: some seconds for all on one core.
const ORDINARY: u64 = 150;

/// The debug assertions and overflow checks that this test relies on are enabled.
#[test]
fn this_build_checks_itself() {
    let remedy = "run it without --release: see [profile.dev]";
    let assertion = catch_unwind(|| debug_assert!(black_box(false), "as expected"));
    assert!(assertion.is_err(), "debug assertions: {remedy}");
    let overflow = catch_unwind(|| black_box(u8::MAX) + black_box(1));
    assert!(overflow.is_err(), "overflow checks: {remedy}");
}

/// Runs scenes of a kind, each with its own random numbers; reports which fail, and how.
///
/// - `scene`: runs one and returns its outcome.
fn run(kind: &str, scene: impl Fn(&mut Random) -> Outcome) {
    let number = |name: &str, default: u64| match std::env::var(name) {
        Ok(text) => text
            .parse()
            .unwrap_or_else(|_| panic!("{name}={text} is no number")),
        Err(_) => default,
    };
    let first = number("RANDOM_SCENES_FIRST", 0);
    let count = number("RANDOM_SCENES", ORDINARY);
    let salt: u64 = kind.bytes().map(u64::from).sum();
    let (mut failures, mut refused, mut undecided) = (Vec::new(), 0, 0);
    for seed in first..first + count {
        let attempt = catch_unwind(AssertUnwindSafe(|| {
            scene(&mut Random::new(
                seed.wrapping_mul(0x0010_0000_0001).wrapping_add(salt),
            ))
        }));
        match attempt {
            Ok(Outcome::Answered) => {}
            Ok(Outcome::Refused) => refused += 1,
            Ok(Outcome::Undecided) => undecided += 1,
            Ok(Outcome::Wrong(what)) => failures.push(format!("{kind} {seed}: {what}")),
            Err(panic) => {
                let words = panic.downcast_ref::<String>().map(String::as_str);
                let words = words.or(panic.downcast_ref::<&str>().copied());
                failures.push(format!("{kind} {seed}: panic: {}", words.unwrap_or("?")));
            }
        }
    }
    println!("{kind}: {count} scenes, {refused} refused, {undecided} undecided");
    assert!(
        failures.is_empty(),
        "{} fail:\n{}",
        failures.len(),
        failures.join("\n")
    );
    // Refusals are for tolerances below rounding and the like; too many would mean that the scenes
    // test nothing.
    assert!(
        refused <= 2 + count / 5,
        "{kind}: {refused} of {count} refused"
    );
    assert!(
        undecided <= 2 + count / 50,
        "{kind}: {undecided} of {count} undecided"
    );
}

/// Whether a single scene was asked for: it is then printed, as numbers from which a test can be
/// made.
fn is_alone() -> bool {
    std::env::var("RANDOM_SCENES").is_ok_and(|count| count == "1")
}

/// Whether a time is so near a joint that an absence there may be ignored: both of its ends are
/// within 1e-9 of their spans.
fn is_at_joint(joints: &[f64], time: f64) -> bool {
    let is_near = |triple: &[f64]| {
        let [before, joint, after] = [triple[0], triple[1], triple[2]];
        joint - time <= 1e-9 * (joint - before) && time - joint <= 1e-9 * (after - joint)
    };
    joints.windows(3).any(is_near)
}

/// How a scene ended.
pub(crate) enum Outcome {
    /// With an answer that obeys the laws.
    Answered,
    /// With a refusal that is meant for such input.
    Refused,
    /// Undecided.
    Undecided,
    /// With an answer that breaks a law: which, and where.
    Wrong(String),
}

impl Outcome {
    fn of(defects: Vec<String>) -> Outcome {
        if defects.is_empty() {
            Outcome::Answered
        } else {
            Outcome::Wrong(defects.join("; "))
        }
    }
}

#[test]
fn sweeps_in_space_keep_the_laws() {
    run("sweep in space", space::sweep);
}

#[test]
fn sweeps_in_the_plane_keep_the_laws() {
    run("sweep in the plane", plane::sweep);
}

#[test]
fn probes_in_space_keep_the_laws() {
    run("probe in space", space::probe);
}

#[test]
fn probes_in_the_plane_keep_the_laws() {
    run("probe in the plane", plane::probe);
}

#[test]
fn checks_keep_the_laws() {
    run("check", contact::check);
}
