//! The run of a target: some cases in every test run, or as many as fit into `FUZZ_SECONDS`.
//!
//! Case number n of a target is the same in every run. `FUZZ_FIRST` is the number of the first one.

use std::any::Any;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

/// Longest time for one case, of a thread that computes all the time.
const LONGEST: Duration = Duration::from_secs(10);

/// Longest time for one case on a machine that has other work to do: after it, it hangs.
const HANGING: Duration = Duration::from_secs(300);

/// Most memory of the whole process, in kilobytes.
const MOST_MEMORY: u64 = 1 << 20;

/// Number of cases in a test run without `FUZZ_SECONDS`.
const FEW: u64 = 300;

fn setting<T: FromStr>(name: &str) -> Option<T> {
    let text = std::env::var(name).ok()?;
    let value = text.parse().ok();
    assert!(value.is_some(), "{name}={text} is no number");
    value
}

/// Runs the cases of a target.
///
/// - `make`: the input of a case by its number.
/// - `check`: what must be true of it; returns whether it was accepted.
pub(crate) fn run(
    target: &str,
    make: impl Fn(u64) -> Vec<u8>,
    check: impl Fn(&[u8]) -> bool + Send + Clone + 'static,
) {
    let first = setting("FUZZ_FIRST").unwrap_or(0);
    let seconds: Option<u64> = setting("FUZZ_SECONDS");
    let start = Instant::now();
    let (mut count, mut accepted) = (0, 0);
    let is_over = |count: u64| match seconds {
        Some(seconds) => start.elapsed() >= Duration::from_secs(seconds),
        None => count >= FEW,
    };
    while !is_over(count) {
        let number = first + count;
        let input = make(number);
        match outcome(input.clone(), check.clone()) {
            Ok(is_accepted) => accepted += u64::from(is_accepted),
            Err(why) => {
                let file = saved(target, number, &input);
                panic!(
                    "{target}, case {number}: {why}\ninput in {}; again: FUZZ_FIRST={number} FUZZ_SECONDS=1 \
                     cargo test --test fuzz -- {target}",
                    file.display()
                );
            }
        }
        count += 1;
    }
    println!("{target}: {count} cases, {accepted} accepted");
    assert!(accepted > 0, "no case was accepted: nothing was tested");
}

/// Checks one input on a thread of its own, which can be left alone if it hangs.
fn outcome(input: Vec<u8>, check: impl Fn(&[u8]) -> bool + Send + 'static) -> Result<bool, String> {
    let (send, receive) = channel();
    let thread = thread::spawn(move || {
        let found = catch_unwind(AssertUnwindSafe(|| check(&input)));
        // Nobody listens any more after a hang.
        let _ = send.send(found.map(|accepted| (accepted, busy())));
    });
    let found = match receive.recv_timeout(HANGING) {
        Ok(found) => found,
        Err(RecvTimeoutError::Timeout) => return Err(format!("it hangs for {HANGING:?}")),
        Err(RecvTimeoutError::Disconnected) => return Err("its thread died".into()),
    };
    // It has sent its result, and ends.
    let _ = thread.join();
    let (accepted, busy) = found.map_err(|panic| format!("it panics: {}", message(&*panic)))?;
    if busy > LONGEST {
        return Err(format!("it takes {busy:?}"));
    }
    match memory() {
        used if used > MOST_MEMORY => Err(format!("memory grows to {used} kB")),
        _ => Ok(accepted),
    }
}

fn message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("without a message")
}

/// The time for which this thread has computed; 0 where the system does not say.
fn busy() -> Duration {
    let text = fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanoseconds = text.split(' ').next().and_then(|word| word.parse().ok());
    Duration::from_nanos(nanoseconds.unwrap_or(0))
}

/// The most memory that the process has used so far, in kilobytes; 0 where the system does not say.
fn memory() -> u64 {
    let text = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let number = line.and_then(|line| line.split_whitespace().next());
    number.and_then(|word| word.parse().ok()).unwrap_or(0)
}

/// A file with an input that fails.
fn saved(target: &str, number: u64, input: &[u8]) -> PathBuf {
    let file = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{target}-{number}"));
    // The number is enough to make it again.
    let _ = fs::write(&file, input);
    file
}
