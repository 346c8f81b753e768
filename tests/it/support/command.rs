//! The binary as a process, run in a directory of its own for each test.

pub(crate) use super::scratch::Scratch;

use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// The outcome of a run of the binary.
pub(crate) struct Run {
    /// Exit code; `None` when a signal ended the run.
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl From<Output> for Run {
    fn from(output: Output) -> Run {
        Run {
            code: output.status.code(),
            out: String::from_utf8(output.stdout).expect("the standard output must be UTF-8"),
            err: String::from_utf8(output.stderr).expect("the error output must be UTF-8"),
        }
    }
}

impl Scratch {
    pub(crate) fn write(&self, name: &str, contents: impl AsRef<[u8]>) {
        std::fs::write(self.path().join(name), contents)
            .expect("the scratch directory must be writable");
    }

    /// The binary with `arguments`, separated by blanks, ready to start in this directory.
    pub(crate) fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_steadysweep"));
        command
            .args(arguments.split_whitespace())
            .current_dir(self.path())
            .stdin(Stdio::null());
        command
    }

    /// Runs the binary in this directory to its end.
    pub(crate) fn run(&self, arguments: &str) -> Run {
        self.command(arguments)
            .output()
            .expect("the binary must start")
            .into()
    }
}

/// Interrupts a running binary, which must end within a second and without a report.
#[cfg(unix)]
#[allow(dead_code, reason = "the tests of refusals interrupt nothing")]
pub(crate) fn interrupt(child: Child) {
    let begin = Instant::now();
    let kill = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(
        kill.expect("kill must start").success(),
        "the signal is sent"
    );
    let output = child.wait_with_output().expect("the binary must end");
    assert!(
        begin.elapsed() < Duration::from_secs(1),
        "it took {:?}",
        begin.elapsed()
    );
    assert_eq!(output.status.code(), Some(130), "interrupted");
    assert!(output.stdout.is_empty(), "no report of half a run");
}

/// A unit cube with a corner at the origin; faces are polygons.
pub(crate) const CUBE: &str = "\
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
f 4 3 2 1
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
";
