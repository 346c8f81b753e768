//! Motion files as JSON, whatever their dimension, and the pose logs that they name.

use super::items::{Item, KeyPose};
use super::pose_log::{Logged, PoseLogFormat, PoseLogSettings, read_pose_log};
use super::words::{Foreign, Object, words_of_json};
use crate::io::error::{InputError, InputProblem, Place};
use crate::motion::chain::{Keyframe, Motion, Span, Steady};
use crate::motion::{FitQuality, HalfTurns};
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

/// A motion as it was read.
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
pub(super) fn motion_of<F: Steady>(
    bytes: &[u8],
    origin: Origin,
    foreign: &[Foreign],
    half_turns: &HalfTurns,
) -> Result<ReadChain<F>, InputProblem>
where
    KeyPose<F::Pose>: Item,
    Span<F>: Item,
    F::Pose: Logged,
{
    let mut fitted = Vec::new();
    let motion = match parse(bytes, foreign)? {
        WrittenMotion::Keyframes(keys) => {
            let turns = turns_of_spans(&keys)?;
            fitted = fitted_keys(&keys);
            Motion::from_keyframes_with_turns(&timed(keys)?, &turns, half_turns)
        }
        WrittenMotion::Spans(spans) => Motion::from_spans(spans),
        WrittenMotion::Log { name, settings } => {
            let motion = logged(&name, origin, &settings, half_turns)?;
            return Ok(ReadChain { motion, fitted });
        }
    };
    let motion = motion.map_err(InputProblem::Motion)?;
    Ok(ReadChain { motion, fitted })
}

/// The steady motions between the poses of a log.
fn logged<F: Steady>(
    name: &str,
    origin: Origin,
    settings: &PoseLogSettings,
    half_turns: &HalfTurns,
) -> Result<Motion<F>, InputProblem>
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
    Motion::from_keyframes_turning(&log.keys, half_turns).map_err(|cause| {
        let line = cause.keyframe().and_then(|key| log.lines.get(key).copied());
        let problem = match line {
            Some(line) => InputProblem::MotionAt {
                place: Place::Line(line),
                cause,
            },
            None => InputProblem::Motion(cause),
        };
        InputProblem::PoseLog(InputError::new(&path, problem))
    })
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
) -> Result<WrittenMotion<K, S>, InputProblem> {
    let Object(file): Object<MotionFile<K, S>> = serde_json::from_slice(without_mark(bytes))
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
    match (file.keyframes, file.spans, file.poses) {
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
struct MotionFile<K, S> {
    keyframes: Option<Numbered<K>>,
    spans: Option<Numbered<S>>,
    poses: Option<String>,
    columns: Option<String>,
    rotation: Option<String>,
    format: Option<String>,
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
