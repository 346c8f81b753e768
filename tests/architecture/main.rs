//! The layout of `src/`: no import circle inside or between its folders, and data flows down the
//! list of modules in `lib.rs`.
//!
//! # What counts
//! - An arrow runs from file A to file B when the code of A names something that B defines: in a
//!   `use`, or in a path that begins with `crate`, `super`, `self` or a child module. Re-exports
//!   are followed to the file with the definition: `crate::body::Mesh` leads to `body/mesh.rs`.
//! - Tests (`#[cfg(test)]`) and comments do not count.
//! - The head of a folder (`mod.rs`) and the files in it are one unit: the head holds the terms
//!   that the files share, and calls these files. So arrows between a head and the files of its
//!   folder, in either direction, do not count. All others do.
//! - There is no circle of files, and in every folder no circle of its files and folders, with each
//!   folder taken as a whole.
//! - The tree is that of the library; the binary, `main.rs`, only calls it.
//!
//! The things that the kernel does without, and the claims of ARCHITECTURE.md, are checked against
//! the sources too.

mod documents;
mod source;
mod tree;

use source::names;
use std::collections::BTreeMap;
use tree::Tree;

fn small(files: &[(&str, &str)]) -> Tree {
    let files: BTreeMap<&str, &str> = files.iter().copied().collect();
    Tree::from("lib.rs", &|file| {
        files.get(file).map(|text| (*text).to_owned())
    })
}

#[test]
fn no_imports_of_the_library_run_in_a_circle() {
    let library = Tree::of_sources("lib.rs");
    let count: usize = library.arrows().values().map(BTreeMap::len).sum();
    assert!(count > 300, "the arrows are found, {count}");
    let circles = library.circles();
    assert!(circles.is_empty(), "{}", circles.join("\n"));
}

#[test]
fn modules_use_only_what_stands_above_them_in_lib_rs() {
    let upwards = Tree::of_sources("lib.rs").upwards();
    assert!(
        upwards.is_empty(),
        "against the list: {}",
        upwards.join("\n")
    );
}

/// The files of the library that do not touch the outside world.
fn kernel(library: &Tree) -> impl Iterator<Item = &str> {
    let files = library.files();
    files.filter(|file| !file.starts_with("io/") && !file.starts_with("cli/"))
}

/// Files, streams and the process belong to `io` and to `cli`.
#[test]
fn the_kernel_reads_no_files_prints_nothing_and_exits_nowhere() {
    const OUTSIDE: [&str; 13] = [
        "fs", "File", "env", "stdin", "stdout", "stderr", "print", "println", "eprint", "eprintln",
        "dbg", "process", "exit",
    ];
    let library = Tree::of_sources("lib.rs");
    for file in kernel(&library) {
        let text = Tree::source(file).unwrap_or_else(|| panic!("{file} is there"));
        let found = names(&text).into_iter().find(|name| OUTSIDE.contains(name));
        assert_eq!(found, None, "src/{file}");
    }
}

/// Coordinates are narrowed only where boxes are rounded outward, where an STL rounds them and the
/// rounding is counted, and where files and pictures are made.
#[test]
fn single_precision_stays_where_its_rounding_is_counted() {
    const MAY_NARROW: [&str; 5] = [
        "bounds/outward.rs",
        "bounds/tree.rs",
        "solid/spatial/storing/",
        "sweep/spatial.rs",
        "io/",
    ];
    let library = Tree::of_sources("lib.rs");
    for file in library.files() {
        let text = Tree::source(file).unwrap_or_else(|| panic!("{file} is there"));
        let narrows = names(&text).iter().any(|name| name.ends_with("f32"));
        let may = MAY_NARROW.iter().any(|part| file.starts_with(part));
        assert!(may || !narrows, "src/{file}");
    }
}

/// Strings serve as errors only where a person wrote the input: in files and options. Anywhere else
/// a fault of the library is a `Fault`, and bad input has an error of its own.
#[test]
fn no_error_of_the_kernel_is_a_text() {
    let library = Tree::of_sources("lib.rs");
    for file in kernel(&library) {
        let text = Tree::source(file).unwrap_or_else(|| panic!("{file} is there"));
        for (line, code) in text.lines().enumerate() {
            let result = code.split_once("Result<").map_or("", |(_, rest)| rest);
            let is_text = [", String>", ", &'static str>"]
                .iter()
                .any(|error| result.contains(error));
            assert!(!is_text, "src/{file}, line {}: {code}", line + 1);
        }
    }
}

#[test]
fn a_circle_through_a_reexport_is_found_and_named() {
    let tree = small(&[
        ("lib.rs", "mod a;"),
        (
            "a/mod.rs",
            "mod b;\nmod c;\npub use b::B;\npub(super) use c::{self, C as D};",
        ),
        ("a/b.rs", "use super::D;\npub struct B(D);"),
        ("a/c.rs", "pub struct C;\nfn of(_: crate::a::B) {}"),
    ]);
    let circles = tree.circles();
    assert_eq!(circles.len(), 2, "of files and in the folder: {circles:?}");
    let parts = [
        "a/b.rs names super::D of a/c.rs",
        "a/c.rs names crate::a::B of a/b.rs",
    ];
    for part in parts {
        assert!(circles[0].contains(part), "{circles:?}");
    }
    assert!(circles[1].contains("src/a"), "{circles:?}");
}

#[test]
fn folders_that_use_each_other_are_found_where_no_files_do() {
    let tree = small(&[
        ("lib.rs", "mod a;\nmod b;"),
        ("a.rs", "mod one;\nmod two;"),
        ("a/one.rs", "use crate::b::one::One;"),
        ("a/two.rs", "pub struct Two;"),
        ("b.rs", "pub mod one;\nmod two;"),
        ("b/one.rs", "pub struct One;"),
        ("b/two.rs", "use crate::{a::two::{Two}, b::one};"),
    ]);
    let circles = tree.circles();
    assert_eq!(circles.len(), 1, "{circles:?}");
    assert!(
        circles[0].starts_with("circle in the folder src/:"),
        "{circles:?}"
    );
    assert_eq!(tree.upwards(), ["a/one.rs names crate::b::one::One"]);
}

#[test]
fn heads_tests_comments_and_literals_make_no_circle() {
    let tree = small(&[
        ("lib.rs", "mod a;"),
        (
            "a/mod.rs",
            "mod b;\nmod c;\npub struct Word;\nfn call() { b::run(c::C) }",
        ),
        (
            "a/b.rs",
            "use super::{Word, c::C};\n/* use super::d; /* nested */ */ pub fn run(_: C) {}\n\
             #[cfg(test)]\nuse super::d;\n#[cfg(test)]\nmod tests { use super::c::C; fn x() {} }",
        ),
        (
            "a/c.rs",
            "// use super::b;\npub struct C;\nconst TEXT: &str = \"\\\"super::b::run\";\n\
             const QUOTE: char = '\"'; const RAW: &str = r#\"super::b\"#; fn f<'a>(_: &'a str) {}",
        ),
    ]);
    assert_eq!(tree.circles(), Vec::<String>::new());
}
