//! The modules of a crate, and the arrows between them.

use crate::source::{Module, Names};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::Path;

/// From each module to others, with the path by which it names them.
type Arrows = BTreeMap<Names, BTreeMap<Names, String>>;

/// All modules below a root file, by their paths.
pub(crate) struct Tree(BTreeMap<Names, Module>);

impl Tree {
    /// - `text`: the content of a file by its name.
    pub(crate) fn from(root: &str, text: &dyn Fn(&str) -> Option<String>) -> Tree {
        let mut modules = BTreeMap::new();
        let mut open = vec![(Names::new(), root.to_owned())];
        while let Some((path, file)) = open.pop() {
            let content = text(&file).unwrap_or_else(|| panic!("{file} is missing"));
            let module = Module::of(file, &content);
            for child in &module.children {
                let mut below = path.clone();
                below.push(child.clone());
                let names = ["", "/mod"].map(|end| format!("{}{end}.rs", below.join("/")));
                let file = names.into_iter().find(|name| text(name).is_some());
                let file = file.unwrap_or_else(|| panic!("no file of {}", below.join("::")));
                open.push((below, file));
            }
            modules.insert(path, module);
        }
        Tree(modules)
    }

    pub(crate) fn of_sources(root: &str) -> Tree {
        Tree::from(root, &Tree::source)
    }

    /// The text of a file of `src/`; `None` when there is none.
    pub(crate) fn source(file: &str) -> Option<String> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        std::fs::read_to_string(folder.join(file)).ok()
    }

    /// The files of all modules.
    pub(crate) fn files(&self) -> impl Iterator<Item = &str> {
        self.0.values().map(|module| module.file.as_str())
    }

    /// A path from the root of the tree; `None` for names that are in no module of it.
    fn absolute(&self, module: &Names, path: &[String]) -> Option<Names> {
        let supers = path.iter().take_while(|name| *name == "super").count();
        let (base, rest) = match path[0].as_str() {
            "crate" => (&[][..], &path[1..]),
            "self" => (&module[..], &path[1..]),
            "super" => (&module[..module.len() - supers], &path[supers..]),
            child => {
                let is_child = self.0[module].children.iter().any(|name| name == child);
                (is_child.then_some(&module[..])?, path)
            }
        };
        Some([base, rest].concat())
    }

    /// The module that defines the item of a path from the root.
    fn defining(&self, path: &Names) -> Names {
        let mut length = 0;
        while length < path.len() && self.0.contains_key(&path[..=length]) {
            length += 1;
        }
        let (module, rest) = (path[..length].to_vec(), &path[length..]);
        let Some(name) = rest.first() else {
            return module;
        };
        let imports = self.0[&module].imports.iter();
        let reexport = imports
            .filter(|(_, known)| known == name)
            .find_map(|(import, _)| self.absolute(&module, import))
            .filter(|target| *target != path[..=length]);
        match reexport {
            Some(target) => self.defining(&[&target[..], &rest[1..]].concat()),
            None => module,
        }
    }

    /// Arrows between files, except between heads and files of their folders.
    pub(crate) fn arrows(&self) -> Arrows {
        let mut arrows = Arrows::new();
        for (from, module) in &self.0 {
            let imports = module.imports.iter().map(|(path, _)| path);
            for path in imports.chain(&module.paths) {
                let Some(target) = self.absolute(from, path) else {
                    continue;
                };
                let to = self.defining(&target);
                if !to.starts_with(from) && !from.starts_with(&to) {
                    let to_all = arrows.entry(from.clone()).or_default();
                    to_all.entry(to).or_insert_with(|| path.join("::"));
                }
            }
        }
        arrows
    }

    /// Circles in words: those of files, and in every folder those of its files and folders.
    pub(crate) fn circles(&self) -> Vec<String> {
        let arrows = self.arrows();
        let mut found = Vec::from_iter(circle(&arrows).map(|names| {
            let step = |pair: &[Names]| {
                let path = &arrows[&pair[0]][&pair[1]];
                format!(
                    "{} names {path} of {}",
                    self.file(&pair[0]),
                    self.file(&pair[1])
                )
            };
            let steps: Vec<String> = names.windows(2).map(step).collect();
            format!("circle of files: {}", steps.join(", "))
        }));
        let folders: BTreeSet<&[String]> = (self.0.keys())
            .flat_map(|path| (0..path.len()).map(|length| &path[..length]))
            .collect();
        for folder in folders {
            let mut between = Arrows::new();
            let inside = |path: &Names| path.starts_with(folder) && path.len() > folder.len();
            let part = |path: &Names| path[..=folder.len()].to_vec();
            for (from, all) in arrows.iter().filter(|(from, _)| inside(from)) {
                for (to, path) in all.iter().filter(|(to, _)| inside(to)) {
                    if part(from) != part(to) {
                        let words = format!("{} names {path}", self.file(from));
                        let to_all = between.entry(part(from)).or_default();
                        to_all.entry(part(to)).or_insert(words);
                    }
                }
            }
            found.extend(circle(&between).map(|names| {
                let step = |pair: &[Names]| between[&pair[0]][&pair[1]].clone();
                let steps: Vec<String> = names.windows(2).map(step).collect();
                let folder = folder.join("/");
                format!("circle in the folder src/{folder}: {}", steps.join(", "))
            }));
        }
        found
    }

    /// Arrows between the modules of the root that run up the list of their declarations.
    pub(crate) fn upwards(&self) -> Vec<String> {
        let order = &self.0[&Names::new()].children;
        let place = |path: &Names| order.iter().position(|name| Some(name) == path.first());
        let mut found = Vec::new();
        for (from, all) in self.arrows() {
            for (to, path) in all {
                if place(&from) < place(&to) {
                    found.push(format!("{} names {path}", self.file(&from)));
                }
            }
        }
        found
    }

    fn file(&self, path: &Names) -> &str {
        &self.0[path].file
    }
}

/// A shortest circle, with its first member repeated at the end.
fn circle(arrows: &Arrows) -> Option<Vec<Names>> {
    let from = |start: &Names| {
        let mut before: BTreeMap<&Names, &Names> = BTreeMap::new();
        let mut open = VecDeque::from([start]);
        while let Some(next) = open.pop_front() {
            for (to, _) in arrows.get(next).into_iter().flatten() {
                if before.contains_key(to) {
                    continue;
                }
                before.insert(to, next);
                open.push_back(to);
            }
        }
        let mut names = vec![start.clone(), (*before.get(start)?).clone()];
        while names.last() != Some(start) {
            names.push(before[&names[names.len() - 1]].clone());
        }
        names.reverse();
        Some(names)
    };
    arrows.keys().filter_map(from).min_by_key(Vec::len)
}
