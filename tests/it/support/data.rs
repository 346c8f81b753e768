//! Published bodies and scenes that lie beside the repository, if they do, and are no part of it.

use std::io::Write;
use std::path::{Path, PathBuf};

/// A part of the folder; `None` where it is not there, which is said aloud: the runner keeps what
/// passing tests print to itself, but not what they write to the error stream.
pub(crate) fn folder(part: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../shared/data")
        .join(part);
    if path.is_dir() {
        return Some(path);
    }
    let test = std::thread::current();
    let _ = writeln!(
        std::io::stderr(),
        "skipped: {}, without {}",
        test.name().unwrap_or("a test"),
        path.display()
    );
    None
}
