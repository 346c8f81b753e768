//! Ctrl-C: asks the run to stop, and ends it if it does not.

use std::process::{ExitCode, exit};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use crate::io;

/// Exit code: 128 plus the number of the signal.
const INTERRUPTED: u8 = 130;

/// Time for the run to stop by itself: the library needs a few milliseconds, and nobody notices the
/// rest.
const GRACE: Duration = Duration::from_millis(200);

static ASKED_FOR: AtomicBool = AtomicBool::new(false);

/// Removes the progress of the current run from the screen; `None` before the first run, when
/// nobody listens.
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

/// On Ctrl-C: sets the flag, and soon after ends the process, even while its threads read a long
/// file or write to a pipe that nobody reads. No unfinished file stays.
///
/// A process may run several commands, one after the other; each of them listens.
///
/// - `erase`: removes the progress from the screen.
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
