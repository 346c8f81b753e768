//! Motion files as JSON, whatever their dimension, and the pose logs that they name.

use super::items::{Item, KeyPose};
use super::pose_log::{Logged, PoseLog, PoseLogFormat, PoseLogSettings, read_pose_log};
use super::words::{Foreign, Object, words_of_json};
use crate::io::error::{InputError, InputProblem, Place};
use crate::motion::chain::{Keyframe, Motion, Span, Steady};
use crate::motion::following::{self, Follow};
use crate::motion::scheme::{Course, Keyed, Scheme, WithoutSteady};
use crate::motion::{FitQuality, HalfTurns, MotionError};
use serde::Deserialize;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use std::fmt;
use std::marker::PhantomData;
use std::path::{Path, PathBuf};

/// A keyframe whose pose was found from pairs of points, and how well it fits them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedKey {
    /// Its number, counted from 0.
    pub keyframe: usize,
    /// How well it fits.
    pub quality: FitQuality,
}

/// A motion as a file gives it: itself, or one that is to be followed by steady spans over a body.
#[derive(Debug, Clone)]
pub struct MotionFile<F: Steady> {
    path: Option<PathBuf>,
    given: Given<F>,
    /// The length within which it is followed, if the file says so.
    deviation: Option<f64>,
    fitted: Vec<FittedKey>,
}

#[derive(Debug, Clone)]
enum Given<F: Steady> {
    /// A chain of steady spans, whose half turns are still to be decided.
    Chain(Motion<F>),
    /// Keyframes with another motion between them.
    Keyed {
        scheme: Scheme,
        without_steady: WithoutSteady,
        keys: Vec<Keyframe<F::Pose>>,
        turns: Vec<i32>,
    },
}

impl<F: Steady> MotionFile<F> {
    /// Whether it is followed over a body: its spans are not steady, or fewer spans are asked for.
    pub fn is_followed(&self) -> bool {
        self.deviation.is_some() || matches!(self.given, Given::Keyed { .. })
    }

    /// How the poses between keyframes are found.
    pub fn scheme(&self) -> Scheme {
        match self.given {
            Given::Chain(_) => Scheme::Steady,
            Given::Keyed { scheme, .. } => scheme,
        }
    }

    /// The keyframes whose poses were found from pairs of points.
    pub fn fitted(&self) -> &[FittedKey] {
        &self.fitted
    }

    /// Number of half turns whose senses are to be chosen.
    ///
    /// # Errors
    /// [`InputError`] with what is wrong with the keyframes.
    pub fn half_turns(&self) -> Result<usize, InputError> {
        match self.keyed() {
            Err(motion) => Ok(motion.half_turns()),
            Ok(keyed) => following::half_turns::<F>(&keyed).map_err(|cause| self.refused(cause)),
        }
    }

    /// The motion itself, whether it is followed or not: a pose for every time.
    ///
    /// # Errors
    /// [`InputError`] with what is wrong with the motion.
    pub fn course(&self, half_turns: &HalfTurns) -> Result<Course<F>, InputError> {
        let course = match self.keyed() {
            Ok(keyed) => Course::new(&keyed, half_turns),
            Err(motion) => motion
                .clone()
                .turning(half_turns)
                .map(|motion| Course::of_chain(&motion)),
        };
        course.map_err(|cause| self.refused(cause))
    }

    /// The motion of a body. A motion that is followed has a
    /// [`deviation`](crate::motion::Motion::deviation).
    ///
    /// - `half_turns`: the senses of its half turns.
    /// - `follow`: the body, and the largest deviation where the file gives none.
    ///
    /// # Errors
    /// [`InputError`] with what is wrong with the motion.
    pub fn over(
        &self,
        half_turns: &HalfTurns,
        follow: &Follow<F::Point>,
    ) -> Result<Motion<F>, InputError> {
        let follow = Follow {
            deviation: self.deviation.unwrap_or(follow.deviation),
            ..*follow
        };
        let motion = match self.keyed() {
            Ok(keyed) => following::keyframes(&keyed, half_turns, &follow),
            Err(motion) => motion.clone().turning(half_turns).and_then(|motion| {
                if self.deviation.is_none() {
                    return Ok(motion);
                }
                following::thinned(&motion, &follow)
            }),
        };
        motion.map_err(|cause| self.refused(cause))
    }

    /// The motion itself, where none is to be followed.
    ///
    /// # Errors
    /// [`InputProblem::MotionFile`] for a motion that is followed over a body.
    pub(super) fn itself(self) -> Result<ReadChain<F>, InputProblem> {
        let field = match self.given {
            Given::Chain(motion) if self.deviation.is_none() => {
                return Ok(ReadChain {
                    motion,
                    fitted: self.fitted,
                });
            }
            Given::Chain(_) => "deviation",
            Given::Keyed { scheme, .. } if scheme != Scheme::Steady => "interpolation",
            Given::Keyed { .. } => "without_steady",
        };
        Err(whole(&format!(
            "\"{field}\" asks for a motion that is followed by steady spans over a body; give one: --body FILE, in the library \
             `MotionFile::over`"
        )))
    }

    fn keyed(&self) -> Result<Keyed<'_, F::Pose>, &Motion<F>> {
        match &self.given {
            Given::Chain(motion) => Err(motion),
            Given::Keyed {
                scheme,
                without_steady,
                keys,
                turns,
            } => Ok(Keyed {
                scheme: *scheme,
                without_steady: *without_steady,
                keys,
                turns,
            }),
        }
    }

    fn refused(&self, cause: MotionError) -> InputError {
        let path = self.path.as_deref().unwrap_or(Path::new(""));
        InputError::new(path, InputProblem::Motion(cause))
    }
}

/// A motion that needs no body.
pub(super) struct ReadChain<F: Steady> {
    pub(super) motion: Motion<F>,
    pub(super) fitted: Vec<FittedKey>,
}

/// Where a motion file is, which names other files relative to its folder.
#[derive(Debug, Clone, Copy)]
pub(super) enum Origin<'a> {
    /// In a file.
    File(&'a Path),
    /// Given by its bytes: it can name no other files.
    Bytes,
}

/// The motion that a file describes.
///
/// - `foreign`: keys that belong to motions of the other dimension.
/// - `half_turns`: senses of half turns, which may be chosen anew in the end.
pub(super) fn motion_of<F: Steady>(
    bytes: &[u8],
    origin: Origin,
    foreign: &[Foreign],
    half_turns: &HalfTurns,
) -> Result<MotionFile<F>, InputProblem>
where
    KeyPose<F::Pose>: Item,
    Span<F>: Item,
    F::Pose: Logged,
{
    let path = match origin {
        Origin::File(path) => Some(path.to_owned()),
        Origin::Bytes => None,
    };
    let (written, following) = parse(bytes, foreign)?;
    let Following {
        scheme,
        without_steady,
        deviation,
    } = following;
    let is_steady = scheme == Scheme::Steady && without_steady == WithoutSteady::Refuse;
    let mut fitted = Vec::new();
    let given = match written {
        WrittenMotion::Spans(_) if !is_steady => {
            return Err(whole(
                "\"interpolation\" and \"without_steady\" say what happens between keyframes, but there are \"spans\", \
                 which are steady; leave them out",
            ));
        }
        WrittenMotion::Spans(spans) => {
            Given::Chain(Motion::from_spans(spans).map_err(InputProblem::Motion)?)
        }
        WrittenMotion::Keyframes(keys) => {
            let turns = turns_of_spans(&keys)?;
            fitted = fitted_keys(&keys);
            let keys = timed(keys)?;
            if is_steady {
                let motion = Motion::from_keyframes_with_turns(&keys, &turns, half_turns);
                Given::Chain(motion.map_err(InputProblem::Motion)?)
            } else {
                Given::Keyed {
                    scheme,
                    without_steady,
                    keys,
                    turns,
                }
            }
        }
        WrittenMotion::Log { name, settings } => {
            let log = logged::<F>(&name, origin, &settings)?;
            if is_steady {
                Given::Chain(log.steady(half_turns)?)
            } else {
                Given::Keyed {
                    scheme,
                    without_steady,
                    keys: log.log.keys,
                    turns: Vec::new(),
                }
            }
        }
    };
    Ok(MotionFile {
        path,
        given,
        deviation,
        fitted,
    })
}

/// A pose log, and where it is.
struct LogFile<F: Steady> {
    path: PathBuf,
    log: PoseLog<F::Pose>,
}

/// Reads the pose log that a motion file names.
fn logged<F: Steady>(
    name: &str,
    origin: Origin,
    settings: &PoseLogSettings,
) -> Result<LogFile<F>, InputProblem>
where
    F::Pose: Logged,
{
    let Origin::File(file) = origin else {
        return Err(whole(
            "\"poses\" names another file, which a motion that is given by its bytes cannot; read the motion from its file",
        ));
    };
    let path = log_path(file, name);
    let log = read_pose_log::<F::Pose>(&path, settings).map_err(InputProblem::PoseLog)?;
    Ok(LogFile { path, log })
}

impl<F: Steady> LogFile<F> {
    /// The steady motions between the poses.
    fn steady(&self, half_turns: &HalfTurns) -> Result<Motion<F>, InputProblem> {
        Motion::from_keyframes_turning(&self.log.keys, half_turns).map_err(|cause| {
            let line = cause
                .keyframe()
                .and_then(|key| self.log.lines.get(key).copied());
            let problem = match line {
                Some(line) => InputProblem::MotionAt {
                    place: Place::Line(line),
                    cause,
                },
                None => InputProblem::Motion(cause),
            };
            InputProblem::PoseLog(InputError::new(&self.path, problem))
        })
    }
}

/// The path of a pose log, which a motion file names relative to its own folder.
pub(super) fn log_path(motion_file: &Path, name: &str) -> PathBuf {
    motion_file.parent().unwrap_or(Path::new("")).join(name)
}

/// What a file holds: keyframes, spans, or the name of a pose log.
enum WrittenMotion<K, S> {
    Keyframes(Vec<K>),
    Spans(Vec<S>),
    Log {
        name: String,
        settings: PoseLogSettings,
    },
}

fn parse<K: Item, S: Item>(
    bytes: &[u8],
    foreign: &[Foreign],
) -> Result<(WrittenMotion<K, S>, Following), InputProblem> {
    let Object(file): Object<WrittenFile<K, S>> = serde_json::from_slice(without_mark(bytes))
        .map_err(|error| {
            let place = Place::LineColumn(error.line(), error.column().max(1));
            let text = error.to_string();
            let suffix = format!(" at line {} column {}", error.line(), error.column());
            let message = words_of_json(text.strip_suffix(&suffix).unwrap_or(&text), foreign);
            InputProblem::MotionFile { place, message }
        })?;
    let of_log = [
        ("columns", file.columns.is_some()),
        ("rotation", file.rotation.is_some()),
        ("format", file.format.is_some()),
    ];
    if let (None, Some((field, _))) = (&file.poses, of_log.iter().find(|(_, given)| *given)) {
        return Err(whole(&format!(
            "\"{field}\" says how a pose log is read, but there is none: add \"poses\", its name, or leave it out"
        )));
    }
    let following = Following {
        scheme: scheme_of(file.interpolation.as_deref())?,
        without_steady: without_steady_of(file.without_steady.as_deref())?,
        deviation: file.deviation,
    };
    let written = match (file.keyframes, file.spans, file.poses) {
        (Some(keys), None, None) => Ok(WrittenMotion::Keyframes(keys.0)),
        (None, Some(spans), None) => Ok(WrittenMotion::Spans(spans.0)),
        (None, None, Some(name)) => Ok(WrittenMotion::Log {
            name,
            settings: PoseLogSettings {
                columns: file.columns,
                rotation: file.rotation,
                format: format_of(file.format.as_deref())?,
            },
        }),
        (None, None, None) => Err(whole(
            "expected \"keyframes\", \"spans\" or \"poses\", found none; add one of them",
        )),
        _ => Err(whole(
            "expected either \"keyframes\", \"spans\" or \"poses\", found more than one; give one of them",
        )),
    };
    Ok((written?, following))
}

/// What a file says of the motion between its poses.
struct Following {
    scheme: Scheme,
    without_steady: WithoutSteady,
    deviation: Option<f64>,
}

fn scheme_of(name: Option<&str>) -> Result<Scheme, InputProblem> {
    let Some(name) = name else {
        return Ok(Scheme::Steady);
    };
    let found = Scheme::ALL.into_iter().find(|scheme| scheme.name() == name);
    found.ok_or_else(|| {
        let names = Scheme::ALL.map(|scheme| format!("\"{}\"", scheme.name()));
        whole(&format!(
            "\"interpolation\": expected one of {}, found \"{name}\"",
            names.join(", ")
        ))
    })
}

fn without_steady_of(name: Option<&str>) -> Result<WithoutSteady, InputProblem> {
    match name {
        None | Some("refuse") => Ok(WithoutSteady::Refuse),
        Some("polar-log") => Ok(WithoutSteady::PolarLog),
        Some(other) => Err(whole(&format!(
            "\"without_steady\": expected \"refuse\" or \"polar-log\", found \"{other}\""
        ))),
    }
}

fn format_of(name: Option<&str>) -> Result<PoseLogFormat, InputProblem> {
    match name {
        None => Ok(PoseLogFormat::Columns),
        Some("kitti") => Ok(PoseLogFormat::Kitti),
        Some(other) => Err(whole(&format!(
            "\"format\": expected \"kitti\", found \"{other}\"; leave it out and name the \"columns\", for example \
             \"t x y z qx qy qz qw\""
        ))),
    }
}

/// The bytes without the three that some editors put first to mark UTF-8.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

fn whole(message: &str) -> InputProblem {
    InputProblem::MotionFile {
        place: Place::File,
        message: message.to_owned(),
    }
}

fn fitted_keys<Pose>(keys: &[KeyPose<Pose>]) -> Vec<FittedKey> {
    let fitted = |(keyframe, key): (usize, &KeyPose<Pose>)| {
        key.fit.map(|quality| FittedKey { keyframe, quality })
    };
    keys.iter().enumerate().filter_map(fitted).collect()
}

/// The whole turns of each span, which the keyframe at its end has.
fn turns_of_spans<Pose>(keys: &[KeyPose<Pose>]) -> Result<Vec<i32>, InputProblem> {
    if keys.first().is_some_and(|first| first.turns != 0) {
        return Err(whole(
            "keyframe 0: expected no \"turns\" in the first keyframe, at which no span ends; give them in the \
             keyframe at which the turns end",
        ));
    }
    Ok(keys.iter().skip(1).map(|key| key.turns).collect())
}

/// Keyframes at the times of the file, or one unit apart when the file gives no times.
fn timed<Pose>(keys: Vec<KeyPose<Pose>>) -> Result<Vec<Keyframe<Pose>>, InputProblem> {
    let first = keys.iter().position(|key| key.time.is_some());
    let without = keys.iter().position(|key| key.time.is_none());
    if let (Some(with), Some(without)) = (first, without) {
        return Err(whole(&format!(
            "expected a time in every keyframe or in none, found one in keyframe {with} and none \
             in keyframe {without}"
        )));
    }
    let clock = (0_u32..).map(f64::from);
    Ok(clock
        .zip(keys)
        .map(|(clock, key)| Keyframe {
            time: key.time.unwrap_or(clock),
            pose: key.pose,
        })
        .collect())
}

/// The file as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, bound(deserialize = "K: Item, S: Item"))]
struct WrittenFile<K, S> {
    keyframes: Option<Numbered<K>>,
    spans: Option<Numbered<S>>,
    poses: Option<String>,
    columns: Option<String>,
    rotation: Option<String>,
    format: Option<String>,
    interpolation: Option<String>,
    deviation: Option<f64>,
    without_steady: Option<String>,
}

/// A list whose errors begin with the name and number of the item.
struct Numbered<T>(Vec<T>);

impl<'de, T: Item> Deserialize<'de> for Numbered<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Numbered<T>, D::Error> {
        deserializer.deserialize_seq(ItemVisitor(PhantomData))
    }
}

struct ItemVisitor<T>(PhantomData<T>);

impl<'de, T: Item> Visitor<'de> for ItemVisitor<T> {
    type Value = Numbered<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a list of {}s", T::NAME)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Numbered<T>, A::Error> {
        let mut items = Vec::new();
        loop {
            let place =
                |message: &dyn fmt::Display| format!("{} {}: {message}", T::NAME, items.len());
            // The message of an inner error ends with its line, which `serde_json` recognises and
            // keeps.
            let written = list
                .next_element::<Object<T::Written>>()
                .map_err(|error| A::Error::custom(place(&error)))?;
            let Some(Object(written)) = written else {
                return Ok(Numbered(items));
            };
            let item = T::new(written).map_err(|error| A::Error::custom(place(&error)))?;
            items.push(item);
        }
    }
}
