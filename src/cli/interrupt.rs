//! Ctrl-C: the run is asked to stop, and stopped if it does not.

use std::process::{ExitCode, exit};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use crate::io;

/// Exit code: 128 and the number of the signal.
const INTERRUPTED: u8 = 130;

/// Time for the run to stop by itself: the library needs a few milliseconds, and nobody notices the rest.
const GRACE: Duration = Duration::from_millis(200);

static ASKED_FOR: AtomicBool = AtomicBool::new(false);

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

/// On Ctrl-C: sets the flag, and soon ends the process whatever its threads are doing, in a long file or before a reader that does
/// not read; no unfinished file stays. `erase` removes what is shown of the progress.
pub(crate) fn listen(erase: impl Fn() + Send + 'static) -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(move || {
        ASKED_FOR.store(true, Ordering::Relaxed);
        erase();
        thread::sleep(GRACE);
        io::remove_unfinished();
        exit(INTERRUPTED.into());
    })
}
