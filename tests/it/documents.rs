//! What the documents show is true: commands run as shown, reports are those that the tool prints,
//! and motion files can be read.

use crate::support::command::{Run, Scratch};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/");

/// Lines of `sh` blocks in the README and in the guide that are not commands of the tool. The
/// examples have their own tests.
const OTHER_COMMANDS: [&str; 3] = [
    "cargo install --path .",
    "cargo test",
    "cargo run --example first_motion",
];

/// A block of code.
#[derive(Debug, Clone, PartialEq)]
struct Block {
    language: String,
    code: String,
    /// Whether only white space is between it and the block before.
    follows: bool,
}

fn blocks(text: &str) -> Vec<Block> {
    let mut found = Vec::new();
    let mut parts = text.split("```");
    let mut before = parts.next().expect("text before the first block");
    while let (Some(inside), Some(after)) = (parts.next(), parts.next()) {
        let (language, code) = inside.split_once('\n').expect("a block has lines");
        found.push(Block {
            language: language.to_owned(),
            code: code.to_owned(),
            follows: before.trim().is_empty(),
        });
        before = after;
    }
    found
}

/// The documents for users, the README first, each with its path.
fn documents() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let pages = std::fs::read_dir(root.join("src/docs")).expect("the guide is there");
    let mut pages: Vec<PathBuf> = pages.map(|page| page.expect("a page").path()).collect();
    pages.retain(|page| page.extension().is_some_and(|extension| extension == "md"));
    pages.sort();
    pages.insert(0, root.join("README.md"));
    let read = |path: PathBuf| {
        let text = std::fs::read_to_string(&path).expect("a document is readable");
        (path, text)
    };
    pages.into_iter().map(read).collect()
}

/// The arguments of a command of the tool.
fn arguments(line: &str) -> Option<&str> {
    line.strip_prefix("steadysweep ")
        .or_else(|| line.strip_prefix("cargo run --release -- "))
}

/// Runs commands from the root of the project, each of them once.
struct Runs {
    scratch: Scratch,
    known: BTreeMap<String, Run>,
}

impl Runs {
    fn run(&mut self, arguments: &str) -> &Run {
        let scratch = &self.scratch;
        let run = || {
            let mut run = scratch.run(&arguments.replace("examples/", EXAMPLES));
            run.out = run.out.replace(EXAMPLES, "examples/");
            run
        };
        self.known.entry(arguments.to_owned()).or_insert_with(run)
    }
}

#[test]
fn the_commands_of_the_documents_print_what_the_documents_show() {
    let mut runs = Runs {
        scratch: Scratch::new("documents"),
        known: BTreeMap::new(),
    };
    let mut shown = 0;
    for (path, text) in documents() {
        let blocks = blocks(&text);
        for (at, block) in blocks.iter().enumerate() {
            if block.language != "sh" {
                continue;
            }
            let mut last = None;
            for line in block.code.lines() {
                let Some(arguments) = arguments(line) else {
                    assert!(OTHER_COMMANDS.contains(&line), "{path:?}: {line}");
                    continue;
                };
                let run = runs.run(arguments);
                let meets =
                    run.out.contains("CONTACT ") || run.out.contains(r#""verdict":"contact""#);
                let expected = (Some(i32::from(meets)), "");
                assert_eq!((run.code, run.err.as_str()), expected, "{path:?}: {line}");
                last = Some(run.out.clone());
            }
            let next = blocks.get(at + 1).filter(|next| next.follows);
            if let (Some(printed), Some(next)) = (last, next) {
                let difference = match next.language.as_str() {
                    "text" => difference_of_texts(&next.code, &printed),
                    "json" => {
                        let read = |text| serde_json::from_str(text).expect("JSON");
                        difference_of_values("", &read(&next.code), &read(&printed))
                    }
                    _ => continue,
                };
                shown += 1;
                if let Some(difference) = difference {
                    panic!("{path:?}, after {}: {difference}", block.code);
                }
            }
        }
    }
    assert!(shown > 10, "outputs are shown and found: {shown}");
    for command in ["sweep ", "check ", "probe ", "motion "] {
        let is_shown = |line: &String| line.starts_with(command);
        assert!(runs.known.keys().any(is_shown), "{command} is shown");
    }
    let ignored = include_str!("../../.gitignore");
    for file in runs.scratch.files() {
        assert!(
            ignored.lines().any(|line| line == format!("/{file}")),
            "{file} would stand in the working tree"
        );
    }
}

/// The first difference between two reports, ignoring values that vary: the time taken, and the
/// ends of a bracket.
fn difference_of_texts(shown: &str, printed: &str) -> Option<String> {
    let lines = |text: &str| -> Vec<String> {
        text.lines()
            .filter(|line| !line.starts_with("time ") && !line.contains("bracket ["))
            .map(str::to_owned)
            .collect()
    };
    let (shown, printed) = (lines(shown), lines(printed));
    if shown.len() != printed.len() {
        return Some(format!("printed: {printed:#?}"));
    }
    let differ = |(shown, printed): &(&String, &String)| {
        // A lower bound may be anywhere within a thousandth below its value.
        let share = if shown.contains("never below") {
            1e-3
        } else {
            1e-6
        };
        !reads_alike(shown, printed, share)
    };
    let (shown, printed) = shown.iter().zip(&printed).find(differ)?;
    Some(format!("shown\n{shown}\nprinted\n{printed}"))
}

/// Whether two texts have the same words, and numbers near each other.
fn reads_alike(a: &str, b: &str, share: f64) -> bool {
    let words = |text: &str| -> Vec<String> {
        text.split(|c: char| c.is_whitespace() || "()[],:".contains(c))
            .filter(|word| !word.is_empty())
            .map(str::to_owned)
            .collect()
    };
    let (a, b) = (words(a), words(b));
    let alike = |a: &str, b: &str| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= share * (1.0 + a.abs()),
        _ => a == b,
    };
    a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| alike(a, b))
}

/// The first place where two values differ by more than the digits shown; for times on the wall
/// clock only the keys count.
fn difference_of_values(path: &str, shown: &Value, printed: &Value) -> Option<String> {
    let differs = || Some(format!("{path}: shown {shown}, printed {printed}"));
    match (shown, printed) {
        (Value::Object(a), Value::Object(b)) => {
            if !a.keys().eq(b.keys()) {
                return differs();
            }
            a.iter().find_map(|(key, value)| {
                difference_of_values(&format!("{path}/{key}"), value, &b[key])
            })
        }
        (Value::Array(a), Value::Array(b)) => {
            if a.len() != b.len() {
                return differs();
            }
            let mut pairs = a.iter().zip(b).enumerate();
            pairs.find_map(|(i, (a, b))| difference_of_values(&format!("{path}/{i}"), a, b))
        }
        (Value::Number(a), Value::Number(b)) => {
            let [a, b] = [a, b].map(|number| number.as_f64().expect("a number of 64 bits"));
            let is_alike = (a - b).abs() <= 1e-6 * (1.0 + a.abs());
            if is_alike || path.starts_with("/seconds/") {
                None
            } else {
                differs()
            }
        }
        _ if shown == printed => None,
        _ => differs(),
    }
}

#[test]
fn the_motion_files_of_the_documents_move_a_body() {
    let scratch = Scratch::new("document_motions");
    scratch.write(
        "recorded.txt",
        include_bytes!("../../examples/recorded.txt"),
    );
    let bodies = [
        ("bracket.stl", "points.csv"),
        ("lever.svg", "lever_points.csv"),
    ];
    let mut moved = [0, 0];
    for (path, text) in documents() {
        // The block that follows a command is its report.
        let is_file = |block: &&Block| block.language == "json" && !block.follows;
        for block in blocks(&text).iter().filter(is_file) {
            scratch.write("path.json", &block.code);
            let codes = bodies.map(|(body, points)| {
                let files = format!("{EXAMPLES}{body} --points {EXAMPLES}{points}");
                scratch
                    .run(&format!("probe {files} --motion path.json"))
                    .code
            });
            // It must be valid in space or in the plane, but not in both.
            match codes {
                [Some(0), Some(2)] => moved[0] += 1,
                [Some(2), Some(0)] => moved[1] += 1,
                _ => panic!("{path:?}: {codes:?} of {}", block.code),
            }
        }
    }
    assert_eq!(
        moved,
        [4, 2],
        "keyframes and spans, in space and in the plane, a log, and another interpolation"
    );
}

#[test]
fn the_readme_is_read_in_some_minutes() {
    let words = include_str!("../../README.md").split_whitespace().count();
    assert!(words <= 1200, "{words} words");
}
