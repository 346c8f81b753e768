//! Compares what ARCHITECTURE.md and the other documents say about the tree with the tree.

use crate::source::names;
use crate::tree::Tree;
use std::collections::BTreeSet;
use std::path::Path;

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{path:?}: {error}"))
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The texts between backticks in a text without blocks.
fn quoted(text: &str) -> Vec<&str> {
    text.split('`').skip(1).step_by(2).collect()
}

/// The cells of the rows of a section's table, without the header.
fn rows<'a>(document: &'a str, section: &str) -> Vec<Vec<&'a str>> {
    let (_, rest) = document
        .split_once(&format!("## {section}\n"))
        .unwrap_or_else(|| panic!("no section {section}"));
    let section = rest.split("\n## ").next().unwrap_or(rest);
    let lines = section.lines().filter(|line| line.starts_with('|'));
    let cells = |line: &'a str| line.trim_matches('|').split('|').map(str::trim).collect();
    lines.skip(2).map(cells).collect()
}

/// Whether a path in a document means a file of `src/`, or the folder that contains it.
fn is_meant(path: &str, file: &str) -> bool {
    path.strip_prefix("src/")
        .is_some_and(|part| file == part || part.ends_with('/') && file.starts_with(part))
}

#[test]
fn paths_that_documents_name_exist() {
    let pages = std::fs::read_dir(root().join("src/docs")).expect("the guide is there");
    let pages = pages.map(|page| page.expect("a page").path());
    let documents =
        ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].map(|name| root().join(name));
    let is_text = |path: &std::path::PathBuf| path.extension().is_some_and(|end| end == "md");
    let mut count = 0;
    for document in documents.into_iter().chain(pages.filter(is_text)) {
        let whole = read(&document);
        let outside: Vec<&str> = whole.split("```").step_by(2).collect();
        let text = outside.concat();
        let folder = document.parent().expect("a file is in a folder");
        // Links are relative to the document, and names in the text to the root.
        let links = text
            .split("](")
            .skip(1)
            .filter_map(|rest| rest.split(')').next());
        let definitions = text
            .lines()
            .filter_map(|line| line.strip_prefix('[')?.split_once("]: "));
        let links = links.chain(definitions.map(|(_, target)| target));
        let links = links.filter(|link| {
            !link.starts_with("http") && !link.contains("::") && !link.starts_with('[')
        });
        let is_path = |name: &&str| {
            let first = name.split('/').next().unwrap_or_default();
            let is_folder = ["src", "tests", "examples", "benches", ".ci"].contains(&first);
            is_folder && name.contains('/') && !name.contains(' ') && !name.contains("MACHINE")
        };
        let named = quoted(&text).into_iter().filter(is_path);
        let paths = links
            .map(|link| folder.join(link))
            .chain(named.map(|name| root().join(name)));
        for path in paths {
            count += 1;
            assert!(path.exists(), "{document:?} names {path:?}");
        }
    }
    assert!(count > 60, "paths are found: {count}");
}

#[test]
fn the_code_map_has_every_module_and_what_it_does_not_use() {
    let document = read(&root().join("ARCHITECTURE.md"));
    let map = rows(&document, "Code map");
    let folder = |row: &Vec<&str>| {
        let name = row[0].trim_matches('`').strip_prefix("src/");
        name.and_then(|name| name.strip_suffix('/'))
            .unwrap_or_else(|| panic!("no folder: {row:?}"))
            .to_owned()
    };
    let found: BTreeSet<String> = map.iter().map(folder).collect();
    let entries = std::fs::read_dir(root().join("src")).expect("sources are there");
    let entries = entries.map(|entry| entry.expect("an entry").path());
    let expected: BTreeSet<String> = entries
        .filter(|path| path.is_dir())
        .map(|path| {
            path.file_name()
                .expect("named")
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    assert_eq!(found, expected);
    let arrows = Tree::of_sources("lib.rs").arrows();
    let mut claims = 0;
    for row in &map {
        let Some((_, unused)) = row[1].split_once("Uses no ") else {
            continue;
        };
        let module = folder(row);
        for unused in quoted(unused) {
            claims += 1;
            let used = arrows
                .iter()
                .filter(|(from, _)| from.first() == Some(&module))
                .flat_map(|(from, all)| all.keys().map(move |to| (from, to)))
                .find(|(_, to)| to.first().is_some_and(|name| name == unused));
            assert_eq!(used, None, "{module} uses no {unused}");
        }
    }
    assert!(claims > 10, "the map says what is not used: {claims}");
}

#[test]
fn each_dependency_is_in_the_table_and_stays_where_it_says() {
    let manifest = read(&root().join("Cargo.toml"));
    let (_, rest) = manifest
        .split_once("\n[dependencies]\n")
        .expect("dependencies");
    let dependencies = rest.split("\n[").next().unwrap_or(rest);
    let expected: BTreeSet<&str> = dependencies
        .lines()
        .filter_map(|line| line.split_once(" = "))
        .map(|(name, _)| name)
        .collect();
    let document = read(&root().join("ARCHITECTURE.md"));
    let table = rows(&document, "Dependencies");
    let found: BTreeSet<&str> = table.iter().map(|row| row[0].trim_matches('`')).collect();
    assert_eq!(found, expected);
    let library = Tree::of_sources("lib.rs");
    for row in &table {
        let name = row[0].trim_matches('`').replace('-', "_");
        let places = quoted(row[1]);
        if places.is_empty() {
            assert_eq!(row[1], "everywhere", "{name}");
            continue;
        }
        let mut used = BTreeSet::new();
        for file in library.files() {
            let text = Tree::source(file).unwrap_or_else(|| panic!("{file} is there"));
            if !names(&text).contains(&name.as_str()) {
                continue;
            }
            let place = places.iter().find(|place| is_meant(place, file));
            used.insert(*place.unwrap_or_else(|| panic!("{name} is named in src/{file}")));
        }
        let listed: BTreeSet<&str> = places.into_iter().collect();
        assert_eq!(used, listed, "{name} is used where the table says");
    }
}
