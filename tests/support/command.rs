//! The binary as a process, and a directory of its own for each test.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// What a run of the binary left behind.
pub(crate) struct Run {
    /// Exit code, `None` when a signal ended it.
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

/// A directory that only one test uses; it starts empty.
pub(crate) struct Scratch(PathBuf);

impl Scratch {
    /// `name`: that of the test, unlike every other.
    pub(crate) fn new(name: &str) -> Scratch {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).expect("the scratch directory must be creatable");
        Scratch(path)
    }

    pub(crate) fn path(&self) -> &Path {
        &self.0
    }

    pub(crate) fn write(&self, name: &str, contents: impl AsRef<[u8]>) {
        std::fs::write(self.0.join(name), contents).expect("the scratch directory must be writable");
    }

    /// Names of the files in it, sorted.
    pub(crate) fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).expect("the scratch directory must be readable");
        let mut names: Vec<String> = entries
            .map(|entry| entry.expect("a directory entry must be readable").file_name())
            .map(|name| name.into_string().expect("the tests use plain names"))
            .collect();
        names.sort();
        names
    }

    /// The binary with `arguments`, separated by blanks, ready to start in this directory.
    pub(crate) fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_steadysweep"));
        command.args(arguments.split_whitespace()).current_dir(&self.0).stdin(Stdio::null());
        command
    }

    /// Runs the binary in this directory to its end.
    pub(crate) fn run(&self, arguments: &str) -> Run {
        self.command(arguments).output().expect("the binary must start").into()
    }
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
