//! Ctrl-C: the run is asked to stop, and stopped if it does not.

use std::process::{ExitCode, exit};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use crate::io;

/// Exit code: 128 and the number of the signal.
const INTERRUPTED: u8 = 130;

/// Time for the run to stop by itself: the library needs a few milliseconds, and nobody notices
/// the rest.
const GRACE: Duration = Duration::from_millis(200);

static ASKED_FOR: AtomicBool = AtomicBool::new(false);

/// Removes what the current run shows of its progress. None before the first run: nobody listens.
static ERASE: Mutex<Option<Box<dyn Fn() + Send>>> = Mutex::new(None);

/// The flag that Ctrl-C sets.
pub(crate) fn flag() -> &'static AtomicBool {
    &ASKED_FOR
}

/// Whether Ctrl-C was pressed.
pub(crate) fn is_asked_for() -> bool {
    ASKED_FOR.load(Ordering::Relaxed)
}

/// The exit code of a run that has stopped.
pub(crate) fn obeyed() -> ExitCode {
    ExitCode::from(INTERRUPTED)
}

/// On Ctrl-C: sets the flag, and soon ends the process whatever its threads are doing, in a long
/// file or before a reader that does not read; no unfinished file stays.
///
/// A process may run several commands, one after the other; each of them listens.
///
/// - `erase`: removes what is shown of the progress.
pub(crate) fn listen(erase: impl Fn() + Send + 'static) -> Result<(), ctrlc::Error> {
    let mut current = ERASE.lock().unwrap_or_else(PoisonError::into_inner);
    if current.is_none() {
        ctrlc::set_handler(stop)?;
    }
    *current = Some(Box::new(erase));
    Ok(())
}

/// What Ctrl-C does, on a thread of its own.
fn stop() {
    ASKED_FOR.store(true, Ordering::Relaxed);
    if let Some(erase) = &*ERASE.lock().unwrap_or_else(PoisonError::into_inner) {
        erase();
    }
    thread::sleep(GRACE);
    io::remove_unfinished();
    exit(INTERRUPTED.into());
}
