//! A directory of its own for each test.

use std::path::{Path, PathBuf};

/// A directory that only one test uses; it starts empty.
pub(crate) struct Scratch(PathBuf);

impl Scratch {
    /// - `name`: name of the test, different from all others.
    pub(crate) fn new(name: &str) -> Scratch {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).expect("the scratch directory must be creatable");
        Scratch(path)
    }

    pub(crate) fn path(&self) -> &Path {
        &self.0
    }

    /// Names of the files in it, sorted.
    pub(crate) fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).expect("the scratch directory must be readable");
        let mut names: Vec<String> = entries
            .map(|entry| {
                entry
                    .expect("a directory entry must be readable")
                    .file_name()
            })
            .map(|name| name.into_string().expect("the tests use plain names"))
            .collect();
        names.sort();
        names
    }
}
