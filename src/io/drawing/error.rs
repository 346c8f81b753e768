//! Why a drawing is no planar body.

use super::units::Unit;
use crate::body::PolygonError;
use crate::numeric::Readable;
use glam::DVec2;
use std::fmt;

/// Most ends, kinds or lines that a message lists.
const LISTED: usize = 6;

/// An element of an SVG or an entity of a DXF.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FigurePlace {
    /// Line of the file at which it begins, counted from 1.
    pub line: usize,
    /// What it is and its name in the file, such as `path "rim"` or `ARC (handle 2F)`.
    pub name: String,
}

/// An end of a curve that no other curve goes on from.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenEnd {
    /// The figure that the curve is of.
    pub figure: FigurePlace,
    /// Where it ends.
    pub at: DVec2,
    /// Distance to the nearest other open end, if there is one.
    pub gap: Option<f64>,
}

/// Figures of one kind that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnsupportedKind {
    /// Element or entity, as the file calls it, and what about it is not supported.
    pub kind: String,
    /// Lines of the file at which they begin.
    pub lines: Vec<usize>,
}

/// Why a drawing was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DrawingError {
    /// Nothing in the file draws a line.
    #[error(
        "the drawing is empty: expected {expected}, found {found}; draw the closed outline of the body"
    )]
    Empty {
        /// What can be read.
        expected: &'static str,
        /// What is there.
        found: String,
    },
    /// Curves whose ends meet no other.
    #[error("{}", OpenEnds(ends, *.distance))]
    Open {
        /// The ends, in the order of the file.
        ends: Vec<OpenEnd>,
        /// Distance within which ends are joined.
        distance: f64,
    },
    /// Figures that cannot be read.
    #[error("{}", Unsupported(.0))]
    Unsupported(Vec<UnsupportedKind>),
    /// Outlines that cross.
    #[error(
        "the outline crosses itself at ({}, {}): {} crosses {}; separate the two, or unite the areas that overlap",
        Readable(at.x), Readable(at.y), figures[0], if figures[0] == figures[1] { "itself".to_owned() } else { figures[1].to_string() }
    )]
    Crossing {
        /// The figures, in the order of the file.
        figures: Box<[FigurePlace; 2]>,
        /// Where.
        at: DVec2,
    },
    /// An outline partly inside another one, the border of which it passes at corners or along edges.
    #[error(
        "the outlines overlap: {figure} is inside of another outline from ({}, {}) on, and outside elsewhere; separate the two, or unite \
         the areas that overlap",
        Readable(at.x), Readable(at.y)
    )]
    Overlap {
        /// The figure.
        figure: FigurePlace,
        /// Where.
        at: DVec2,
    },
    /// A coordinate that is not finite or beyond what can be computed with.
    #[error("{figure} reaches ({}, {}): coordinates must be finite and not exceed 1e18; correct the place or choose a larger unit", at.x, at.y)]
    Coordinate {
        /// The figure.
        figure: FigurePlace,
        /// The coordinates.
        at: DVec2,
    },
    /// The outlines are no body for another reason.
    #[error("{0}")]
    Polygon(PolygonError),
    /// Curves would become too many corners.
    #[error(
        "{figure}: with curves flattened to within {flattening:e} the drawing has more than {limit} corners; use a larger \
         tolerance"
    )]
    TooFine {
        /// The figure at which the limit is reached.
        figure: FigurePlace,
        /// Distance allowed between curve and chord.
        flattening: f64,
        /// Largest number of corners.
        limit: usize,
    },
    /// A unit was asked for, but the file does not say which one it is in.
    #[error(
        "lengths cannot be changed to {asked}: the file does not say which unit they are in; leave the option out, or declare the \
         unit in the program that wrote the file"
    )]
    UnknownUnit {
        /// The unit that was asked for.
        asked: Unit,
    },
}

impl fmt::Display for FigurePlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} at line {}", self.name, self.line)
    }
}

struct OpenEnds<'a>(&'a [OpenEnd], f64);

impl fmt::Display for OpenEnds<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let OpenEnds(ends, distance) = self;
        let count = match ends.len() {
            1 => "one end meets".to_owned(),
            many => format!("{many} ends meet"),
        };
        write!(
            f,
            "the outline is open: {count} no other within {}:",
            Readable(*distance)
        )?;
        for end in ends.iter().take(LISTED) {
            write!(
                f,
                "\n  {} ends at ({}, {})",
                end.figure,
                Readable(end.at.x),
                Readable(end.at.y)
            )?;
            if let Some(gap) = end.gap {
                write!(f, ", {} from the nearest other open end", Readable(gap))?;
            }
        }
        if ends.len() > LISTED {
            write!(f, "\n  and {} more", ends.len() - LISTED)?;
        }
        write!(
            f,
            "\nclose the gaps in the drawing, or allow straight lines across them (--close-gaps LEN); remove lines that bound \
             nothing (axes, marks, frames)"
        )
    }
}

struct Unsupported<'a>(&'a [UnsupportedKind]);

impl fmt::Display for Unsupported<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the drawing has figures that cannot be read:")?;
        for UnsupportedKind { kind, lines } in self.0 {
            write!(
                f,
                "\n  {} {kind} at line{} ",
                lines.len(),
                if lines.len() == 1 { "" } else { "s" }
            )?;
            for (i, line) in lines.iter().take(LISTED).enumerate() {
                write!(f, "{}{line}", if i == 0 { "" } else { ", " })?;
            }
            if lines.len() > LISTED {
                write!(f, ", ...")?;
            }
        }
        write!(
            f,
            "\nconvert them to lines, arcs or curves in the program that wrote the file, or remove them"
        )
    }
}
