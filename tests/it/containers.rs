//! Runs in process namespaces of their own, as in containers: there each run has the same process
//! number, whatever else runs.

#![cfg(target_os = "linux")]

use crate::support::command::{CUBE, Run, Scratch};
use std::process::{Child, Command, Stdio};

/// A sweep of the cube whose result is far larger than [`LIMIT`] blocks.
const SWEEP: &str = "sweep cube.obj --turn 90 --axis 0,0,1 -o out.stl --quiet";

/// Size of files, in blocks of the shell, at which a run is killed.
const LIMIT: u32 = 8;

/// A shell as process 1 of a namespace of its own, in this directory; the first process that it
/// starts is number 2.
fn container(scratch: &Scratch, script: &str) -> Command {
    let mut command = Command::new("unshare");
    command
        .args([
            "--user",
            "--map-root-user",
            "--pid",
            "--fork",
            "--kill-child",
        ])
        .args(["sh", "-c", script])
        .current_dir(scratch.path())
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

fn script(arguments: &str) -> String {
    // Not `exec`: process 1 of a namespace is not killed by the signals of the system.
    format!(
        "'{}' {arguments}; exit $?",
        env!("CARGO_BIN_EXE_steadysweep")
    )
}

fn finished(child: Child) -> Run {
    child.wait_with_output().expect("it ends").into()
}

/// An empty directory with the cube, or nothing where there are no namespaces.
fn prepared(test: &str) -> Option<Scratch> {
    let scratch = Scratch::new(test);
    scratch.write("cube.obj", CUBE);
    let numbers = container(&scratch, "sh -c 'echo $$'").output();
    match numbers {
        Ok(output) if output.stdout == b"2\n" => Some(scratch),
        found => {
            println!("skipped: no process namespaces here ({found:?})");
            None
        }
    }
}

/// The bytes of the result of a run that nothing disturbs.
fn expected(scratch: &Scratch) -> Vec<u8> {
    let run = scratch.run(SWEEP);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let bytes = std::fs::read(scratch.path().join("out.stl")).expect("it is there");
    std::fs::remove_file(scratch.path().join("out.stl")).expect("it is ours");
    bytes
}

#[test]
fn what_a_killed_run_leaves_is_in_nobodys_way() {
    let Some(scratch) = prepared("containers_killed") else {
        return;
    };
    let expected = expected(&scratch);
    // Files that earlier versions left, named by the number of the process.
    for process in 1..=2 {
        for number in 0..4 {
            let name = format!(".steadysweep-{process}-{number}.unfinished");
            scratch.write(&name, "half a solid");
        }
    }
    let before = scratch.files();
    for _ in 0..3 {
        let killed = format!("ulimit -f {LIMIT}; {}", script(SWEEP));
        let run = finished(container(&scratch, &killed).spawn().expect("it starts"));
        assert_ne!(run.code, Some(0), "the file grew too large: {}", run.err);
        assert_eq!(
            (run.out.as_str(), run.err.contains("exists")),
            ("", false),
            "{}",
            run.err
        );
    }
    let left = scratch.files();
    let unfinished = left.iter().filter(|name| name.ends_with(".unfinished"));
    assert_eq!(unfinished.count(), 8 + 3, "killed, not refused: {left:?}");
    let whole = script(SWEEP);
    let run = finished(container(&scratch, &whole).spawn().expect("it starts"));
    assert_eq!(run.code, Some(0), "{}", run.err);
    let bytes = std::fs::read(scratch.path().join("out.stl")).expect("it is there");
    assert!(bytes == expected, "the result is whole");
    let after = scratch.files();
    assert!(before.iter().all(|name| after.contains(name)), "{after:?}");
}

#[test]
fn containers_that_write_into_one_folder_do_not_stop_each_other() {
    let Some(scratch) = prepared("containers_at_once") else {
        return;
    };
    let expected = expected(&scratch);
    let whole = script(SWEEP);
    for _ in 0..3 {
        let children: Vec<Child> = (0..6)
            .map(|_| container(&scratch, &whole).spawn().expect("it starts"))
            .collect();
        for run in children.into_iter().map(finished) {
            assert_eq!(run.code, Some(0), "{}", run.err);
        }
        let bytes = std::fs::read(scratch.path().join("out.stl")).expect("it is there");
        assert!(bytes == expected, "the result is whole");
        assert_eq!(scratch.files(), ["cube.obj", "out.stl"], "nothing is left");
    }
}
