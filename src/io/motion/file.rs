//! Motion files as JSON, whatever their dimension.

use super::items::{Item, KeyPose};
use super::words::{Foreign, Object, words_of_json};
use crate::io::error::{InputProblem, Place};
use crate::motion::chain::{Keyframe, Motion, Span, Steady};
use crate::motion::{FitQuality, HalfTurns};
use serde::Deserialize;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use std::fmt;
use std::marker::PhantomData;

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

/// The motion that a file describes.
///
/// - `foreign`: keys that belong to motions of the other dimension.
pub(super) fn motion_of<F: Steady>(
    bytes: &[u8],
    foreign: &[Foreign],
    half_turns: &HalfTurns,
) -> Result<ReadChain<F>, InputProblem>
where
    KeyPose<F::Pose>: Item,
    Span<F>: Item,
{
    let mut fitted = Vec::new();
    let motion = match parse(bytes, foreign)? {
        WrittenMotion::Keyframes(keys) => {
            let turns = turns_of_spans(&keys)?;
            fitted = fitted_keys(&keys);
            Motion::from_keyframes_with_turns(&timed(keys)?, &turns, half_turns)
        }
        WrittenMotion::Spans(spans) => Motion::from_spans(spans),
    };
    let motion = motion.map_err(InputProblem::Motion)?;
    Ok(ReadChain { motion, fitted })
}

/// What a file holds: keyframes or spans.
enum WrittenMotion<K, S> {
    Keyframes(Vec<K>),
    Spans(Vec<S>),
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
    match (file.keyframes, file.spans) {
        (Some(keys), None) => Ok(WrittenMotion::Keyframes(keys.0)),
        (None, Some(spans)) => Ok(WrittenMotion::Spans(spans.0)),
        (Some(_), Some(_)) => Err(whole(
            "expected either \"keyframes\" or \"spans\", found both; give one of the two",
        )),
        (None, None) => Err(whole(
            "expected \"keyframes\" or \"spans\", found neither; add one of the two",
        )),
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
