//! Files appear only when they are complete: they are written beside their place under another
//! name, then renamed.

use super::error::OutputProblem;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The files that this process is writing now.
static UNFINISHED: Unfinished = Unfinished::new();

/// Files that are being written.
struct Unfinished(Mutex<List>);

struct List {
    paths: Vec<PathBuf>,
    /// Set once nothing may be begun or completed any more.
    stopped: bool,
}

impl Unfinished {
    const fn new() -> Unfinished {
        Unfinished(Mutex::new(List {
            paths: Vec::new(),
            stopped: false,
        }))
    }

    fn list(&self) -> MutexGuard<'_, List> {
        // The list is consistent even where another thread panicked while it held the lock.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Removes all files of the list; nothing is begun or completed from now on.
    #[cfg(any(test, feature = "cli"))]
    fn stop(&self) {
        let mut list = self.list();
        list.stopped = true;
        for path in list.paths.drain(..) {
            // The process is ending: nobody is left to report to.
            let _ = fs::remove_file(path);
        }
    }
}

/// Most names that are tried for an unfinished file. Two random numbers of 64 bits are hardly ever
/// equal: more than a few attempts would mean that they are not random.
const ATTEMPTS: usize = 16;

/// Writes a file by `write` and puts it at `path` once it is complete. A file that was there before
/// stays until then, and stays for good when anything fails. Where `path` is a link, the file that
/// it leads to is replaced.
///
/// Several processes may write to one path at once: each file is complete, and the last to be
/// finished stays. An unfinished file of a killed process, named `.steadysweep-*.unfinished`, is in
/// nobody's way.
///
/// # Errors
/// Those of `write` and of the operating system.
pub(super) fn replace_file(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> io::Result<()> {
    replace_listed(&UNFINISHED, path, write)
}

/// As [`replace_file`], with a given list of unfinished files.
fn replace_listed(
    unfinished: &Unfinished,
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> io::Result<()> {
    let place = &resolved(path);
    let mut sibling = Sibling::create(unfinished, place)?;
    let mut out = BufWriter::new(sibling.take_file()?);
    write(&mut out)?;
    let file = out.into_inner().map_err(io::IntoInnerError::into_error)?;
    // A rename can reach the disk before the contents do.
    file.sync_all()?;
    drop(file);
    sibling.rename_to(place)
}

/// Checks that a file can be written at `path`: creates one beside it and removes it.
pub(super) fn check_place(path: &Path) -> Result<(), OutputProblem> {
    if path.is_dir() {
        return Err(OutputProblem::Directory);
    }
    let parent = path
        .parent()
        .filter(|parent| !parent.as_os_str().is_empty());
    let directory = parent.unwrap_or(Path::new(".")).to_path_buf();
    if !directory.is_dir() {
        return Err(OutputProblem::NoDirectory { directory });
    }
    match Sibling::create(&UNFINISHED, &resolved(path)) {
        Ok(_) => Ok(()),
        Err(error) => Err(OutputProblem::NotWritable {
            directory,
            reason: error.to_string(),
        }),
    }
}

/// The file to which a link leads; the path itself when there is nothing there yet.
fn resolved(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf())
}

/// Removes all files that are being written; complete files and earlier ones stay. For use when the
/// process is about to end: from now on no file is written.
#[cfg(feature = "cli")]
pub(crate) fn remove_unfinished() {
    UNFINISHED.stop();
}

/// A new file beside its final place, removed if it is dropped before it is renamed.
struct Sibling<'a> {
    unfinished: &'a Unfinished,
    path: PathBuf,
    file: Option<File>,
}

impl<'a> Sibling<'a> {
    fn create(unfinished: &'a Unfinished, place: &Path) -> io::Result<Sibling<'a>> {
        let random = || getrandom::u64().map_err(|error| io::Error::other(error.to_string()));
        Sibling::named(unfinished, place, random)
    }

    /// As [`Sibling::create`], with a given source of the random numbers in the name.
    fn named(
        unfinished: &'a Unfinished,
        place: &Path,
        mut random: impl FnMut() -> io::Result<u64>,
    ) -> io::Result<Sibling<'a>> {
        // Under the lock, so that `stop` cannot miss a file that is being created.
        let mut list = unfinished.list();
        if list.stopped {
            return Err(io::Error::from(ErrorKind::Interrupted));
        }
        let mut attempt = 1;
        loop {
            // Not derived from the name of the result, which may be as long as names can be; nor
            // from the number of the process, which is 1 in every container.
            let name = format!(".steadysweep-{:016x}.unfinished", random()?);
            let path = place.with_file_name(name);
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => {
                    list.paths.push(path.clone());
                    return Ok(Sibling {
                        unfinished,
                        path,
                        file: Some(file),
                    });
                }
                Err(error) if error.kind() == ErrorKind::AlreadyExists && attempt < ATTEMPTS => {
                    attempt += 1;
                }
                Err(error) => return Err(error),
            }
        }
    }

    fn take_file(&mut self) -> io::Result<File> {
        self.file
            .take()
            .ok_or_else(|| io::Error::other("the file is taken already"))
    }

    fn rename_to(self, place: &Path) -> io::Result<()> {
        let mut list = self.unfinished.list();
        if list.stopped {
            return Err(io::Error::from(ErrorKind::Interrupted));
        }
        fs::rename(&self.path, place)?;
        list.paths.retain(|path| *path != self.path);
        Ok(())
    }
}

impl Drop for Sibling<'_> {
    fn drop(&mut self) {
        let mut list = self.unfinished.list();
        if list.paths.contains(&self.path) {
            list.paths.retain(|path| *path != self.path);
            // A failure to clean up must not hide the original error.
            let _ = fs::remove_file(&self.path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::Folder;
    use super::*;
    use std::io::Write;

    #[test]
    fn a_file_is_replaced_when_the_new_one_is_whole() {
        let folder = Folder::new("replace");
        let path = folder.path("out.txt");
        fs::write(&path, "old").expect("a folder of our own");
        replace_file(&path, |out| {
            out.write_all(b"new")?;
            assert_eq!(fs::read(&path)?, b"old", "untouched until the end");
            Ok(())
        })
        .expect("written");
        assert_eq!(fs::read(&path).expect("there"), b"new");
        assert_eq!(folder.names(), ["out.txt"], "nothing else is left");
    }

    #[test]
    #[cfg(unix)]
    fn a_link_stays_and_its_file_is_replaced() {
        let folder = Folder::new("link");
        let (file, link) = (folder.path("file.txt"), folder.path("link.txt"));
        fs::write(&file, "old").expect("a folder of our own");
        std::os::unix::fs::symlink("file.txt", &link).expect("a folder of our own");
        replace_file(&link, |out| out.write_all(b"new")).expect("written");
        assert!(link.is_symlink(), "the link stays");
        assert_eq!(fs::read(&file).expect("there"), b"new");
    }

    #[test]
    fn a_failure_leaves_the_old_file_and_nothing_else() {
        let folder = Folder::new("failure");
        let path = folder.path("out.txt");
        fs::write(&path, "old").expect("a folder of our own");
        let error = replace_file(&path, |out| {
            out.write_all(b"half")?;
            Err(io::Error::other("no space"))
        });
        assert_eq!(error.expect_err("failed").to_string(), "no space");
        assert_eq!(fs::read(&path).expect("there"), b"old");
        assert_eq!(folder.names(), ["out.txt"]);
        assert!(
            replace_file(&folder.path("missing/out.txt"), |_| Ok(())).is_err(),
            "no such directory"
        );
    }

    #[test]
    fn a_name_that_is_taken_is_left_to_its_file() {
        let folder = Folder::new("taken");
        let place = folder.path("out.txt");
        let taken = ".steadysweep-0000000000000007.unfinished";
        fs::write(folder.path(taken), "of a run that was killed").expect("a folder of our own");
        let mut numbers = [7, 7, 8].into_iter();
        let next = || Ok(numbers.next().expect("no more are asked for"));
        let sibling = Sibling::named(&UNFINISHED, &place, next).expect("the third name is free");
        assert!(
            sibling
                .path
                .ends_with(".steadysweep-0000000000000008.unfinished")
        );
        drop(sibling);
        assert_eq!(folder.names(), [taken], "it stays, and nothing else does");
        let error = Sibling::named(&UNFINISHED, &place, || Ok(7))
            .err()
            .expect("never a free name");
        assert_eq!(
            error.kind(),
            ErrorKind::AlreadyExists,
            "and no endless loop"
        );
    }

    #[test]
    fn of_several_that_write_at_once_one_stays_whole() {
        let folder = Folder::new("at-once");
        let path = folder.path("out.txt");
        let texts: Vec<String> = (0..8).map(|i| i.to_string().repeat(100_000)).collect();
        std::thread::scope(|scope| {
            for text in &texts {
                scope.spawn(|| {
                    replace_file(&path, |out| out.write_all(text.as_bytes())).expect("written");
                });
            }
        });
        let found = fs::read_to_string(&path).expect("there");
        assert!(texts.contains(&found), "{} bytes", found.len());
        assert_eq!(folder.names(), ["out.txt"], "nothing else is left");
    }
    #[test]
    fn an_interrupted_result_leaves_no_file_and_the_old_one_intact() {
        // A list of its own: the other tests go on writing.
        let unfinished = Unfinished::new();
        let folder = Folder::new("interrupted");
        let path = folder.path("out.stl");
        fs::write(&path, "old").expect("our folder is writable");
        let interrupted = replace_listed(&unfinished, &path, |out| {
            out.write_all(b"half of the new")?;
            out.flush()?;
            assert_eq!(
                folder.names().len(),
                2,
                "the old file and the one being written"
            );
            unfinished.stop();
            assert_eq!(folder.names(), ["out.stl"], "the old file");
            Ok(())
        });
        assert!(interrupted.is_err(), "nothing is completed afterwards");
        let next = replace_listed(&unfinished, &path, |_| Ok(()));
        assert!(next.is_err(), "nor begun");
        assert_eq!(fs::read(&path).expect("still there"), b"old");
        assert_eq!(folder.names(), ["out.stl"], "no trace");
    }
}
