//! Interrupting the process while a result is being written. In a process of its own: nothing can be written afterwards.

use std::fs;
use std::io::Write;
use steadysweep::io::replace::{remove_unfinished, replace_file};

#[test]
fn an_interrupted_result_leaves_no_file_and_the_old_one_intact() {
    let folder =
        std::env::temp_dir().join(format!("steadysweep-interrupted-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder for temporary files");
    let names = || fs::read_dir(&folder).expect("our folder").count();
    let path = folder.join("out.stl");
    fs::write(&path, "old").expect("our folder is writable");
    let interrupted = replace_file(&path, |out| {
        out.write_all(b"half of the new")?;
        out.flush()?;
        assert_eq!(names(), 2, "the old file and the one being written");
        remove_unfinished();
        assert_eq!(names(), 1, "the old file");
        Ok(())
    });
    assert!(interrupted.is_err(), "nothing is completed afterwards");
    assert!(replace_file(&path, |_| Ok(())).is_err(), "nor begun");
    assert_eq!(fs::read(&path).expect("still there"), b"old");
    assert_eq!(names(), 1, "no trace");
    fs::remove_dir_all(&folder).expect("our folder");
}
