//! What the reader of a drawing format finds in a file.

use super::super::drawing_error::FigurePlace;
use super::super::units::DeclaredUnit;
use super::curve::Curve;
use crate::body::FillRule;
use std::collections::BTreeMap;

/// All figures of a file, in the order of the file.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::io) struct Sketch {
    pub(in crate::io) figures: Vec<Figure>,
    pub(in crate::io) declared: Option<DeclaredUnit>,
    /// What was left out, and why.
    pub(in crate::io) notes: Vec<String>,
}

/// Counts of what a reader leaves out, by its name in the singular and in the plural.
#[derive(Debug, Default)]
pub(in crate::io) struct LeftOut(BTreeMap<[String; 2], usize>);

impl LeftOut {
    pub(in crate::io) fn add(&mut self, one: &str, several: &str) {
        *self.0.entry([one, several].map(str::to_owned)).or_default() += 1;
    }

    /// A note for each name.
    pub(in crate::io) fn notes(self) -> Vec<String> {
        let note = |([one, several], count): ([String; 2], usize)| match count {
            1 => format!("left out: 1 {one}"),
            _ => format!("left out: {count} {several}"),
        };
        self.0.into_iter().map(note).collect()
    }
}

/// An element of an SVG or an entity of a DXF.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::io) struct Figure {
    pub(in crate::io) place: FigurePlace,
    pub(in crate::io) paths: Vec<Path>,
    /// The rule by which its closed paths are filled; `None`: the paths are outlines.
    pub(in crate::io) fill: Option<FillRule>,
}

/// Curves, each of which begins where the one before it ends.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::io) struct Path {
    pub(in crate::io) curves: Vec<Curve>,
    /// Whether the file says that it is closed, if need be by a line from its end to its start.
    pub(in crate::io) closed: bool,
}
