//! Why a file could not be read or written: which file, where in it, what was found against what
//! was expected.

use super::drawing_error::DrawingError;
use crate::body::{BodyError, Defect};
use crate::motion::MotionError;
use std::fmt;
use std::path::{Path, PathBuf};

/// Most defects that a message lists.
const LISTED_DEFECTS: usize = 10;

/// Longest piece of a file that a message quotes, in characters.
const QUOTED: usize = 48;

/// Why a file was refused.
#[derive(Debug, Clone, PartialEq)]
pub struct InputError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub problem: Box<InputProblem>,
}

/// What is wrong with a file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InputProblem {
    /// There is no such file.
    #[error("there is no such file; check the path")]
    Missing,
    /// The path names a directory.
    #[error("is a directory, expected a file")]
    Directory,
    /// The operating system refuses to read it.
    #[error("cannot be read: {reason}")]
    Unreadable {
        /// The message of the operating system.
        reason: String,
    },
    /// The extension of the name is no known format.
    #[error("{}, expected one of {}; convert the file or correct its name", Extension(found), known.join(" "))]
    UnknownExtension {
        /// The extension, without the dot; `None` when there is none.
        found: Option<String>,
        /// The formats that can be read, with the dot.
        known: &'static [&'static str],
    },
    /// A drawing, where a body in space is needed.
    #[error(
        "{found} files hold drawings, which are bodies in the plane: expected a body in space, one of {}",
        known.join(" ")
    )]
    Planar {
        /// The extension, with the dot.
        found: String,
        /// The formats of bodies in space, with the dot.
        known: &'static [&'static str],
    },
    /// A format that this version cannot read.
    #[error("{found} files cannot be read yet, available are {}; convert the file", known.join(" "))]
    NotYet {
        /// The extension, with the dot.
        found: String,
        /// The formats that can be read, with the dot.
        known: &'static [&'static str],
    },
    /// The file has no bytes.
    #[error("the file is empty; export it again")]
    Empty,
    /// The header claims more than the file holds, or less.
    #[error(
        "the header claims {claimed} {what} ({claimed_bytes} bytes), but the file holds {held} ({held_bytes} bytes): \
         it is cut off or damaged; export it again"
    )]
    Claims {
        /// What is counted: triangles, vertices, faces.
        what: String,
        /// Number in the header.
        claimed: u64,
        /// Fewest bytes that this number would take.
        claimed_bytes: u128,
        /// Number for which the file has bytes.
        held: u64,
        /// Bytes that the file has for them.
        held_bytes: u64,
    },
    /// Something in the file is not as the format requires.
    #[error("{}expected {expected}, found {found}; {remedy}", AtPlace(place))]
    Malformed {
        /// Where.
        place: Place,
        /// What should be there.
        expected: String,
        /// What the file holds.
        found: String,
        /// What to do about it.
        remedy: &'static str,
    },
    /// The file asks for more time or memory than its size warrants.
    #[error("{}{what}, more than {limit}; {remedy}", AtPlace(place))]
    TooMuch {
        /// Where.
        place: Place,
        /// What the file has too much of, and how much.
        what: String,
        /// The largest number that is accepted.
        limit: u64,
        /// What to do about it.
        remedy: &'static str,
    },
    /// A motion file is not as described.
    #[error("{}{message}", AtPlace(place))]
    MotionFile {
        /// Where.
        place: Place,
        /// Which keyframe or span, what was expected and what was found.
        message: String,
    },
    /// An obstacle without triangles.
    #[error("there are no triangles in the file; export the obstacle as a triangle mesh")]
    NoTriangles,
    /// Every face has two corners at the same place.
    #[error(
        "each of the {faces} faces has two corners at one place, nothing is left of the body; if its size is lost in \
         the rounding of its coordinates, move the part nearer to the origin and export it again"
    )]
    Collapsed {
        /// Number of faces in the file.
        faces: usize,
    },
    /// The triangles make no body.
    #[error("{}", Defects(.0.defects(), "not a body"))]
    Body(BodyError),
    /// The triangles make no obstacle.
    #[error("{}", Defects(.0.defects(), "not an obstacle"))]
    Surface(BodyError),
    /// The pose log that a motion file names is refused.
    #[error("{0}")]
    PoseLog(InputError),
    /// The poses of a log make no motion.
    #[error("{}{cause}", AtPlace(place))]
    MotionAt {
        /// Where.
        place: Place,
        /// What is wrong; keyframes are the poses of the log, counted from 0.
        cause: MotionError,
    },
    /// The poses or spans make no motion.
    #[error("{0}")]
    Motion(MotionError),
    /// The drawing makes no planar body.
    #[error("{0}")]
    Drawing(#[from] DrawingError),
}

/// A place in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line of text, counted from 1.
    Line(usize),
    /// A line and column of text, counted from 1.
    LineColumn(usize, usize),
    /// An element of a list, counted from 0, and the byte where it starts.
    Element {
        /// What is counted: triangle, vertex, face.
        what: String,
        /// Its number.
        index: u64,
        /// Offset in the file.
        byte: u64,
    },
}

/// Remedy for numbers and words that no exporter writes.
pub(super) const EXPORT_AGAIN: &str = "the file is damaged: correct the place or export it again";

impl InputError {
    /// The problem, in this file.
    pub fn new(path: &Path, problem: InputProblem) -> InputError {
        InputError {
            path: path.to_path_buf(),
            problem: Box::new(problem),
        }
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.problem)
    }
}

impl std::error::Error for InputError {}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::File => f.write_str("the file"),
            Place::Line(line) => write!(f, "line {line}"),
            Place::LineColumn(line, column) => write!(f, "line {line}, column {column}"),
            Place::Element { what, index, byte } => {
                write!(f, "{what} {index} (counted from 0, at byte {byte})")
            }
        }
    }
}

/// A place as it stands at the beginning of a message, after the name of the file.
struct AtPlace<'a>(&'a Place);

impl fmt::Display for AtPlace<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Place::File => Ok(()),
            place => write!(f, "{place}: "),
        }
    }
}

/// The defects of a mesh, what the mesh cannot be because of them, and what to do about them; one
/// per line.
struct Defects<'a>(&'a [Defect], &'static str);

impl fmt::Display for Defects<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let [only] = self.0 {
            let counted = match only {
                Defect::Empty | Defect::TooMany { .. } => "",
                _ => " (counted from 0)",
            };
            return write!(f, "{only}{counted}; {}", only.remedy());
        }
        write!(
            f,
            "{}, {} defects (triangles and vertices counted from 0):",
            self.1,
            self.0.len()
        )?;
        for defect in self.0.iter().take(LISTED_DEFECTS) {
            write!(f, "\n  {defect}")?;
        }
        if self.0.len() > LISTED_DEFECTS {
            write!(f, "\n  and {} more", self.0.len() - LISTED_DEFECTS)?;
        }
        let mut remedies = Vec::new();
        for defect in self.0 {
            if !remedies.contains(&defect.remedy()) {
                remedies.push(defect.remedy());
            }
        }
        write!(f, "\n{}", remedies.join("; "))
    }
}

/// The extension of a file name, in words.
struct Extension<'a>(&'a Option<String>);

impl fmt::Display for Extension<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Some(extension) => write!(f, "unknown extension .{extension}"),
            None => f.write_str("the file name has no extension"),
        }
    }
}

/// The start of a piece of text, in quotation marks, with control characters escaped.
pub(super) fn quote(text: &str) -> String {
    let text = text.trim();
    if text.is_empty() {
        return "nothing".to_owned();
    }
    let start: String = text.chars().take(QUOTED).collect();
    let end = if start.len() < text.len() { "..." } else { "" };
    format!("\"{}{end}\"", start.escape_debug())
}

/// Why a result could not be written.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputError {
    /// The file to be written.
    pub path: PathBuf,
    /// Why it could not be.
    pub problem: OutputProblem,
}

/// Why a file cannot be written.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OutputProblem {
    /// The extension of the name is no known format of results.
    #[error("{}, expected one of {}", Extension(found), known.join(" "))]
    UnknownExtension {
        /// The extension, without the dot; `None` when there is none.
        found: Option<String>,
        /// The formats that can be written, with the dot.
        known: &'static [&'static str],
    },
    /// A format for results of another kind.
    #[error("{found} files do not hold {what}, expected one of {}", known.join(" "))]
    OtherKind {
        /// The extension, with the dot.
        found: String,
        /// What was to be written.
        what: &'static str,
        /// The formats that can be written, with the dot.
        known: &'static [&'static str],
    },
    /// A format that this version cannot write.
    #[error("{found} files cannot be written yet, available are {}", known.join(" "))]
    NotYet {
        /// The extension, with the dot.
        found: String,
        /// The formats that can be written, with the dot.
        known: &'static [&'static str],
    },
    /// The path names a directory.
    #[error("is a directory, expected the name of a file to write")]
    Directory,
    /// The directory of the file does not exist.
    #[error("there is no directory {}; create it first", .directory.display())]
    NoDirectory {
        /// The directory.
        directory: PathBuf,
    },
    /// The directory does not accept new files.
    #[error("no file can be created in {}: {reason}; choose another place for the result", .directory.display())]
    NotWritable {
        /// The directory.
        directory: PathBuf,
        /// The message of the operating system.
        reason: String,
    },
    /// Writing failed; a file that was there before is unharmed.
    #[error("could not be written: {reason}; an earlier file of this name was left as it was")]
    Failed {
        /// The message of the operating system.
        reason: String,
    },
}

impl OutputError {
    /// The problem, with this file.
    pub fn new(path: &Path, problem: OutputProblem) -> OutputError {
        OutputError {
            path: path.to_path_buf(),
            problem,
        }
    }
}

impl fmt::Display for OutputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.problem)
    }
}

impl std::error::Error for OutputError {}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn open_edge(triangle: u32) -> Defect {
        Defect::OpenEdge {
            vertices: [4, 7],
            triangle,
            places: [DVec3::ZERO, DVec3::X],
        }
    }

    fn message(defects: Vec<Defect>) -> String {
        let error = BodyError::new(defects).expect("defects");
        InputError::new(Path::new("part.stl"), InputProblem::Body(error)).to_string()
    }

    #[test]
    fn one_defect_is_one_line_with_file_place_and_remedy() {
        assert_eq!(
            message(vec![open_edge(12)]),
            "part.stl: edge 4-7 of triangle 12, from [0, 0, 0] to [1, 0, 0], has no neighbour: the mesh is not closed \
             (counted from 0); fill the hole in a mesh repair tool or export the part as a closed solid"
        );
    }

    #[test]
    fn many_defects_are_listed_to_ten_and_counted() {
        let text = message((0..14).map(open_edge).collect());
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 13, "{text}");
        assert_eq!(
            lines[0],
            "part.stl: not a body, 14 defects (triangles and vertices counted from 0):"
        );
        assert!(lines[10].starts_with("  edge 4-7 of triangle 9,"), "{text}");
        assert_eq!(lines[11], "  and 4 more");
        assert_eq!(lines[12], open_edge(0).remedy(), "one remedy for all");
    }

    #[test]
    fn quotations_are_short_and_printable() {
        assert_eq!(quote("  vertex 1 2\t"), "\"vertex 1 2\"");
        assert_eq!(quote("\u{0}x"), "\"\\0x\"");
        assert_eq!(quote(" "), "nothing");
        assert_eq!(
            quote(&"a".repeat(100)).len(),
            QUOTED + 5,
            "cut with three dots"
        );
    }
}
