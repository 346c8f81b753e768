//! Pose logs: text files with a pose per line, as recorders and simulators write them.
//!
//! Columns are separated by blanks or by commas. They have names, given by the motion file or by
//! the header of the log, so that nothing is guessed: neither the order of a quaternion nor that of
//! angles.

use super::items::{PLANAR, SPATIAL};
use super::rotation::{EulerAngles, unit_quaternion};
use crate::io::error::{InputError, InputProblem, Place, quote};
use crate::motion::chain::Keyframe;
use glam::{DAffine2, DAffine3, DQuat, DVec2, DVec3};
use std::fs::File;
use std::io::{BufRead, BufReader, ErrorKind};
use std::path::Path;

/// How the columns of a pose log are read.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PoseLogSettings {
    /// Names of the columns, separated by blanks; `None` where the header of the log names them.
    ///
    /// `t` (or `time`); `x`, `y`, `z`; `qx`, `qy`, `qz`, `qw`, a unit quaternion; `a`, `b`, `c`, the
    /// Euler angles of `rotation`; `m11` to `m34`, the rows of a matrix; in the plane `x`, `y`, `deg`
    /// or `rad`, `m11` to `m23`; and `-` for a column that is not read. Without `t`, the poses are
    /// one unit apart.
    pub columns: Option<String>,
    /// How `a`, `b`, `c` are read: `euler-zxz-deg` about the axes of the body, which turn with it,
    /// `fixed-xyz-rad` about those of the world, and so on.
    pub rotation: Option<String>,
    /// What is known without names of columns.
    pub format: PoseLogFormat,
}

/// A format of pose logs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum PoseLogFormat {
    /// Named columns.
    #[default]
    Columns,
    /// As in the odometry data of KITTI: the 12 numbers of a 3 x 4 matrix by rows, without times.
    Kitti,
}

const KITTI: &str = "m11 m12 m13 m14 m21 m22 m23 m24 m31 m32 m33 m34";

/// The poses of a log, and the lines on which they are, counted from 1.
#[derive(Debug)]
pub(super) struct PoseLog<Pose> {
    pub(super) keys: Vec<Keyframe<Pose>>,
    pub(super) lines: Vec<usize>,
}

/// Reads the poses of a log in space from its bytes. They map the body to the world; times need not
/// increase here.
///
/// # Errors
/// [`InputProblem`] with the line.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use steadysweep::io::{PoseLogSettings, parse_pose_log};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let settings = PoseLogSettings {
///     columns: Some("t x y z qx qy qz qw".to_owned()),
///     ..PoseLogSettings::default()
/// };
/// let keys = parse_pose_log(b"# a recorder\n0.5 1 2 3 0 0 0 1\n", &settings)?;
/// assert_eq!((keys[0].time, keys[0].pose.translation), (0.5, DVec3::new(1.0, 2.0, 3.0)));
/// # Ok(())
/// # }
/// ```
pub fn parse_pose_log(
    bytes: &[u8],
    settings: &PoseLogSettings,
) -> Result<Vec<Keyframe<DAffine3>>, InputProblem> {
    read_lines(bytes, settings).map(|log| log.keys)
}

/// Reads the poses of a log in the plane from its bytes; otherwise as [`parse_pose_log`].
///
/// # Errors
/// [`InputProblem`] with the line.
pub fn parse_planar_pose_log(
    bytes: &[u8],
    settings: &PoseLogSettings,
) -> Result<Vec<Keyframe<DAffine2>>, InputProblem> {
    read_lines(bytes, settings).map(|log| log.keys)
}

/// Reads the poses of a log line by line.
pub(super) fn read_pose_log<Pose: Logged>(
    path: &Path,
    settings: &PoseLogSettings,
) -> Result<PoseLog<Pose>, InputError> {
    opened(path)
        .and_then(|file| read_lines(file, settings))
        .map_err(|problem| InputError::new(path, problem))
}

/// The names in the header of a log, if it has one.
pub(super) fn header_of(path: &Path) -> Option<Vec<String>> {
    let mut lines = Lines::new(opened(path).ok()?);
    let line = lines.next().ok()??;
    let separator = Separator::of(line.text);
    is_header(separator, line.text).then(|| names_in(separator, line.text))
}

fn opened(path: &Path) -> Result<BufReader<File>, InputProblem> {
    let unreadable = |error: std::io::Error| match error.kind() {
        ErrorKind::NotFound => InputProblem::Missing,
        ErrorKind::IsADirectory => InputProblem::Directory,
        _ => InputProblem::Unreadable {
            reason: error.to_string(),
        },
    };
    let file = File::open(path).map_err(unreadable)?;
    if file.metadata().map_err(unreadable)?.is_dir() {
        return Err(InputProblem::Directory);
    }
    Ok(BufReader::new(file))
}

/// A pose that a log can hold.
pub(super) trait Logged: Sized {
    /// The number of coordinates.
    const DIMENSION: usize;
    /// The columns that there are, in words.
    const COLUMNS: &'static str;

    /// The part of a pose that a column of this name holds.
    fn part(name: &str) -> Option<Part>;

    /// The pose of one line.
    fn new(form: &Form, numbers: &Numbers) -> Result<Self, String>;
}

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Time,
    /// A coordinate of the place of the body's origin.
    Coordinate(usize),
    /// A number of the quaternion x, y, z, w.
    Quaternion(usize),
    /// One of three angles.
    Angle(usize),
    /// The angle of a turn in the plane.
    TurnDegrees,
    TurnRadians,
    /// A number of the matrix, by row and column.
    Entry(usize, usize),
    /// Not read.
    Nothing,
}

/// The form in which the columns give a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Form {
    Matrix,
    Quaternion,
    Euler(EulerAngles),
    TurnDegrees,
    TurnRadians,
    /// Nothing turns.
    Place,
}

/// The numbers of one line, in the order of the parts.
pub(super) struct Numbers {
    time: f64,
    coordinates: [f64; 3],
    /// Of the quaternion, or the angles.
    rotation: [f64; 4],
    rows: [[f64; 4]; 3],
}

impl Logged for DAffine3 {
    const DIMENSION: usize = 3;
    const COLUMNS: &'static str =
        "t x y z, qx qy qz qw or the angles a b c of \"rotation\", or m11 to m34";

    fn part(name: &str) -> Option<Part> {
        Some(match name {
            "z" => Part::Coordinate(2),
            "qx" => Part::Quaternion(0),
            "qy" => Part::Quaternion(1),
            "qz" => Part::Quaternion(2),
            "qw" => Part::Quaternion(3),
            "a" => Part::Angle(0),
            "b" => Part::Angle(1),
            "c" => Part::Angle(2),
            _ => return None,
        })
    }

    fn new(form: &Form, numbers: &Numbers) -> Result<DAffine3, String> {
        let rotation = match form {
            Form::Matrix => {
                let column = |j: usize| DVec3::from(numbers.rows.map(|row| row[j]));
                return Ok(DAffine3::from_cols(
                    column(0),
                    column(1),
                    column(2),
                    column(3),
                ));
            }
            Form::Quaternion => unit_quaternion(&numbers.rotation)?,
            Form::Euler(euler) => {
                let [a, b, c, _] = numbers.rotation;
                euler.rotation([a, b, c])
            }
            Form::Place | Form::TurnDegrees | Form::TurnRadians => DQuat::IDENTITY,
        };
        let place = DVec3::from_array(numbers.coordinates);
        Ok(DAffine3::from_rotation_translation(rotation, place))
    }
}

impl Logged for DAffine2 {
    const DIMENSION: usize = 2;
    const COLUMNS: &'static str = "t x y, deg or rad, or m11 to m23";

    fn part(name: &str) -> Option<Part> {
        Some(match name {
            "deg" => Part::TurnDegrees,
            "rad" => Part::TurnRadians,
            _ => return None,
        })
    }

    fn new(form: &Form, numbers: &Numbers) -> Result<DAffine2, String> {
        let [turn, ..] = numbers.rotation;
        let angle = match form {
            Form::Matrix => {
                let column = |j: usize| DVec2::new(numbers.rows[0][j], numbers.rows[1][j]);
                return Ok(DAffine2::from_cols(column(0), column(1), column(2)));
            }
            Form::TurnDegrees => turn.to_radians(),
            Form::TurnRadians => turn,
            Form::Place | Form::Quaternion | Form::Euler(_) => 0.0,
        };
        let [x, y, _] = numbers.coordinates;
        Ok(DAffine2::from_angle_translation(angle, DVec2::new(x, y)))
    }
}

/// The part that a column of this name holds, in space or in the plane.
fn part_of<Pose: Logged>(name: &str) -> Option<Part> {
    match name {
        "t" | "time" => Some(Part::Time),
        "-" => Some(Part::Nothing),
        "x" => Some(Part::Coordinate(0)),
        "y" => Some(Part::Coordinate(1)),
        _ => entry_of(name)
            .filter(|&(row, column)| row < Pose::DIMENSION && column <= Pose::DIMENSION)
            .map(|(row, column)| Part::Entry(row, column))
            .or_else(|| Pose::part(name)),
    }
}

/// Row and column, from 0, of the name `m11` to `m34`.
fn entry_of(name: &str) -> Option<(usize, usize)> {
    let [b'm', row @ b'1'..=b'3', column @ b'1'..=b'4'] = name.as_bytes() else {
        return None;
    };
    Some((usize::from(row - b'1'), usize::from(column - b'1')))
}

/// Whether columns of these names are of poses in space; otherwise they fit the plane.
pub(super) fn are_in_space<'a>(mut names: impl Iterator<Item = &'a str>) -> bool {
    names.any(|name| {
        let in_space = part_of::<DAffine3>(name).is_some();
        in_space && part_of::<DAffine2>(name).is_none()
    })
}

/// The columns of a log, once they are known to give a pose.
struct Columns {
    names: String,
    parts: Vec<Part>,
    form: Form,
    is_timed: bool,
}

impl Columns {
    /// - `names`: one per column; `rotation`: the name of the angles.
    fn new<'a, Pose: Logged>(
        names: impl Iterator<Item = &'a str> + Clone,
        rotation: Option<&str>,
    ) -> Result<Columns, String> {
        let mut parts: Vec<Part> = Vec::new();
        for name in names.clone() {
            let part = part_of::<Pose>(name).ok_or_else(|| {
                let other = match Pose::DIMENSION {
                    3 => part_of::<DAffine2>(name).map(|_| PLANAR),
                    _ => part_of::<DAffine3>(name).map(|_| SPATIAL),
                };
                if let Some(other) = other {
                    return format!("the column \"{name}\" belongs to {other}");
                }
                format!(
                    "unknown column \"{name}\"; columns are {}, and - for one that is not read: name them by \"columns\" \
                     in the motion file",
                    Pose::COLUMNS
                )
            })?;
            if part != Part::Nothing && parts.contains(&part) {
                return Err(format!("the column \"{name}\" is named twice"));
            }
            parts.push(part);
        }
        let names = names.collect::<Vec<_>>().join(" ");
        let count = |is: &dyn Fn(&Part) -> bool| parts.iter().filter(|part| is(part)).count();
        let coordinates = count(&|part| matches!(part, Part::Coordinate(_)));
        let quaternion = count(&|part| matches!(part, Part::Quaternion(_)));
        let angles = count(&|part| matches!(part, Part::Angle(_)));
        let entries = count(&|part| matches!(part, Part::Entry(..)));
        let turns = count(&|part| matches!(part, Part::TurnDegrees | Part::TurnRadians));
        let whole = Pose::DIMENSION * (Pose::DIMENSION + 1);
        let form = match (coordinates, quaternion, angles, entries, turns) {
            (0, 0, 0, entries, 0) if entries == whole => Some(Form::Matrix),
            (all, 0, 0, 0, 0) if all == Pose::DIMENSION => Some(Form::Place),
            (3, 4, 0, 0, 0) => Some(Form::Quaternion),
            (3, 0, 3, 0, 0) => {
                let name = rotation.ok_or(
                    "the angles a, b, c need \"rotation\" in the motion file, for example \
                     \"rotation\": \"euler-zxz-deg\"",
                )?;
                let euler =
                    EulerAngles::named(name).map_err(|text| format!("\"rotation\": {text}"))?;
                Some(Form::Euler(euler))
            }
            (2, 0, 0, 0, 1) if parts.contains(&Part::TurnDegrees) => Some(Form::TurnDegrees),
            (2, 0, 0, 0, 1) => Some(Form::TurnRadians),
            _ => None,
        };
        let form = form.ok_or_else(|| {
            format!(
                "the columns \"{names}\" give no pose: expected all of {}",
                Pose::COLUMNS
            )
        })?;
        if rotation.is_some() && !matches!(form, Form::Euler(_)) {
            return Err(format!(
                "\"rotation\" says how the angles a, b, c are read, but the columns are \"{names}\"; leave it out"
            ));
        }
        Ok(Columns {
            names,
            is_timed: parts.contains(&Part::Time),
            parts,
            form,
        })
    }

    /// The numbers of a line; `None` where they are not finite numbers, one per column.
    fn numbers(&self, separator: Separator, line: &str) -> Option<Numbers> {
        let mut numbers = Numbers {
            time: 0.0,
            coordinates: [0.0; 3],
            rotation: [0.0; 4],
            rows: [[0.0; 4]; 3],
        };
        let mut fields = separator.fields(line);
        for part in &self.parts {
            let field = fields.next()?;
            let number = match part {
                Part::Nothing => continue,
                Part::Time => &mut numbers.time,
                Part::Coordinate(axis) => &mut numbers.coordinates[*axis],
                Part::Quaternion(k) | Part::Angle(k) => &mut numbers.rotation[*k],
                Part::TurnDegrees | Part::TurnRadians => &mut numbers.rotation[0],
                Part::Entry(row, column) => &mut numbers.rows[*row][*column],
            };
            *number = field.parse().ok().filter(|x: &f64| x.is_finite())?;
        }
        fields.next().is_none().then_some(numbers)
    }
}

/// What is between the fields of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Separator {
    Blanks,
    Commas,
}

impl Separator {
    fn of(line: &str) -> Separator {
        if line.contains(',') {
            Separator::Commas
        } else {
            Separator::Blanks
        }
    }

    fn fields(self, line: &str) -> impl Iterator<Item = &str> + Clone {
        // One of the two is empty.
        let (by_commas, by_blanks) = match self {
            Separator::Commas => (Some(line.split(',').map(str::trim)), None),
            Separator::Blanks => (None, Some(line.split_ascii_whitespace())),
        };
        by_commas
            .into_iter()
            .flatten()
            .chain(by_blanks.into_iter().flatten())
    }
}

/// Whether a line names columns: each field, quoted or not, begins with a letter and is no number.
fn is_header(separator: Separator, line: &str) -> bool {
    separator.fields(line).all(|field| {
        let field = field.trim_matches(['"', '\'']);
        field.starts_with(char::is_alphabetic) && field.parse::<f64>().is_err()
    })
}

fn names_in(separator: Separator, line: &str) -> Vec<String> {
    let name = |field: &str| field.trim_matches(['"', '\'']).to_ascii_lowercase();
    separator.fields(line).map(name).collect()
}

/// The lines of a log, but for blank ones and comments.
struct Lines<R> {
    reader: R,
    bytes: Vec<u8>,
    number: usize,
}

struct Line<'a> {
    text: &'a str,
    number: usize,
}

impl<R: BufRead> Lines<R> {
    fn new(reader: R) -> Lines<R> {
        Lines {
            reader,
            bytes: Vec::new(),
            number: 0,
        }
    }

    fn next(&mut self) -> Result<Option<Line<'_>>, InputProblem> {
        loop {
            self.bytes.clear();
            let read = self.reader.read_until(b'\n', &mut self.bytes);
            let read = read.map_err(|error| InputProblem::Unreadable {
                reason: error.to_string(),
            })?;
            if read == 0 {
                return Ok(None);
            }
            self.number += 1;
            if self.number == 1 && self.bytes.starts_with(b"\xef\xbb\xbf") {
                self.bytes.drain(..3);
            }
            let first = self.bytes.iter().find(|byte| !byte.is_ascii_whitespace());
            if !matches!(first, None | Some(b'#')) {
                break;
            }
        }
        let number = self.number;
        let text = std::str::from_utf8(&self.bytes).map_err(|_| InputProblem::Malformed {
            place: Place::Line(number),
            expected: "text".to_owned(),
            found: quote(&String::from_utf8_lossy(&self.bytes)),
            remedy: "a pose log has a line of numbers per pose; check the name of the file",
        })?;
        Ok(Some(Line {
            text: text.trim(),
            number,
        }))
    }
}

fn read_lines<Pose: Logged>(
    reader: impl BufRead,
    settings: &PoseLogSettings,
) -> Result<PoseLog<Pose>, InputProblem> {
    let at = |place: Place, message: String| InputProblem::MotionFile { place, message };
    let mut lines = Lines::new(reader);
    let mut log = PoseLog {
        keys: Vec::new(),
        lines: Vec::new(),
    };
    let given = match (settings.format, &settings.columns) {
        (PoseLogFormat::Kitti, None) => Some(KITTI),
        (PoseLogFormat::Kitti, Some(_)) => {
            let message = "expected \"columns\" or the format kitti, found both; leave out one";
            return Err(at(Place::File, message.to_owned()));
        }
        (PoseLogFormat::Columns, columns) => columns.as_deref(),
    };
    let rotation = settings.rotation.as_deref();
    let mut columns = given
        .map(|names| Columns::new::<Pose>(names.split_ascii_whitespace(), rotation))
        .transpose()
        .map_err(|message| at(Place::File, message))?;
    let mut separator = None;
    while let Some(Line { text, number }) = lines.next()? {
        let separator = match separator {
            Some(separator) => separator,
            None => {
                let first = *separator.insert(Separator::of(text));
                if is_header(first, text) {
                    if columns.is_none() {
                        let names = names_in(first, text);
                        let names = names.iter().map(String::as_str);
                        let named = Columns::new::<Pose>(names, rotation);
                        columns = Some(named.map_err(|message| at(Place::Line(number), message))?);
                    }
                    continue;
                }
                first
            }
        };
        let Some(columns) = &columns else {
            return Err(InputProblem::Malformed {
                place: Place::Line(number),
                expected: "a header with the names of the columns".to_owned(),
                found: quote(text),
                remedy: "name them in the motion file, for example \"columns\": \"t x y z qx qy qz qw\"",
            });
        };
        let Some(numbers) = columns.numbers(separator, text) else {
            let remedy = if text.contains(';') {
                "separate the numbers by commas or blanks, not by semicolons, and write decimals with points"
            } else {
                "correct or remove the line, or the names of the columns"
            };
            return Err(InputProblem::Malformed {
                place: Place::Line(number),
                expected: format!("{} finite numbers {}", columns.parts.len(), columns.names),
                found: quote(text),
                remedy,
            });
        };
        let pose = Pose::new(&columns.form, &numbers)
            .map_err(|message| at(Place::Line(number), message))?;
        let time = if columns.is_timed {
            numbers.time
        } else {
            log.keys.len() as f64
        };
        log.keys.push(Keyframe { time, pose });
        log.lines.push(number);
    }
    Ok(log)
}
