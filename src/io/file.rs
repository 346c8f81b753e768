//! Whole files: all bytes of an input, and outputs that appear only when they are complete.

use super::error::{InputProblem, OutputError, OutputProblem};
use super::replace;
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::Path;

/// The extension of a file name in lower case, without the dot.
pub(super) fn extension(path: &Path) -> Option<String> {
    path.extension()
        .map(|extension| extension.to_string_lossy().to_ascii_lowercase())
}

/// Checks that a file of some kinds can be written to `path`, before anything is computed: its
/// extension, which is returned in lower case and without the dot, is known, and a file can be
/// created in the directory. Leaves no trace.
pub(crate) fn check_kind(
    path: &Path,
    known: &'static [&'static str],
) -> Result<String, OutputError> {
    let refuse = |problem| OutputError::new(path, problem);
    let is_known = |found: &String| known.iter().any(|dotted| dotted[1..] == **found);
    match extension(path) {
        Some(found) if is_known(&found) => {
            replace::check_place(path).map_err(refuse)?;
            Ok(found)
        }
        found => Err(refuse(OutputProblem::UnknownExtension { found, known })),
    }
}

/// The bytes of a file, at least one.
pub(super) fn read_bytes(path: &Path) -> Result<Vec<u8>, InputProblem> {
    let unreadable = |error: std::io::Error| match error.kind() {
        ErrorKind::NotFound => InputProblem::Missing,
        ErrorKind::IsADirectory => InputProblem::Directory,
        _ => InputProblem::Unreadable {
            reason: error.to_string(),
        },
    };
    if fs::metadata(path).map_err(unreadable)?.is_dir() {
        return Err(InputProblem::Directory);
    }
    let bytes = fs::read(path).map_err(unreadable)?;
    if bytes.is_empty() {
        Err(InputProblem::Empty)
    } else {
        Ok(bytes)
    }
}

/// Puts a file at `path` once `write` has written all of it.
pub(crate) fn written(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), OutputError> {
    let whole = replace::replace_file(path, |out| {
        write(out)?;
        out.flush()
    });
    whole.map_err(|error| {
        let reason = error.to_string();
        OutputError::new(path, OutputProblem::Failed { reason })
    })
}
