//! The first meeting with any obstacle: pieces of time in order, many at once.
//!
//! Each obstacle in each window of a stage is a separate piece of work. Workers take pieces in the
//! order of time; a piece that begins after a meeting already known is skipped, or given up. The
//! pieces that count are then gathered in that order, and each of them was searched as a whole,
//! regardless of the others. So the answer does not depend on the number of workers.

use super::encounter::Encounter;
use super::orbit::Orbits;
use super::scene::Scene;
use super::search::{Earliest, FoundMeeting, MOST_VISITS, Search};
use super::{Limited, Verdict, witness};
use crate::watch::{Interrupted, Work};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

/// Pieces that are prepared at once: enough to share, and few enough to be worthwhile when the
/// first of them ends the search.
const BATCH: usize = 1024;

/// Number of pairs of boxes after which other threads join, one or two milliseconds of work: most
/// searches end before that, and waking threads for them costs more than it saves.
const WORTH_SHARING: usize = 20_000;

/// Number of pairs of boxes per triangle, for at least this many triangles, after which orbits are
/// compared: that takes about as long.
const ORBITS_AFTER: usize = 8;
const FEW: usize = 2_000;

/// Most pairs of boxes that may be examined to certify one distance: some seconds of work.
const KEEPING_WORK: usize = 20_000_000;

/// One obstacle in one window of time.
#[derive(Debug, Clone, Copy)]
struct ObstacleWindow {
    stage: usize,
    /// Number of the window, and half the width of each window.
    window: u32,
    half: f64,
    obstacle: usize,
    /// Its index among the encounters of the batch.
    encounter: usize,
    /// Number of pieces of its stage.
    among: usize,
}

impl ObstacleWindow {
    /// The stage and local time at which it begins.
    fn start(&self) -> (usize, f64) {
        (self.stage, f64::from(2 * self.window) * self.half)
    }
}

/// The position of a search over the pieces of all stages.
#[derive(Debug, Clone, Copy, Default)]
struct Cursor {
    stage: usize,
    window: u32,
}

/// What is known about the current stage.
struct StageFindings {
    stage: usize,
    best: Option<(usize, FoundMeeting)>,
    bracket: [f64; 2],
    unknown: (f64, usize),
}

impl StageFindings {
    fn nothing(stage: usize) -> StageFindings {
        StageFindings {
            stage,
            best: None,
            bracket: [f64::INFINITY, 1.0],
            unknown: (f64::INFINITY, 0),
        }
    }

    fn add(&mut self, obstacle: usize, earliest: &Earliest) {
        if earliest.unknown < self.unknown.0 {
            self.unknown = (earliest.unknown, obstacle);
        }
        if let Some(found) = earliest.found {
            self.bracket[0] = self.bracket[0].min(earliest.bracket[0]);
            self.bracket[1] = self.bracket[1].min(earliest.bracket[1]);
            if self
                .best
                .is_none_or(|(_, best)| found.meeting.time < best.meeting.time)
            {
                self.best = Some((obstacle, found));
            }
        }
    }

    /// The time up to which this stage matters.
    fn end(&self) -> (usize, f64) {
        (self.stage, self.best.map_or(1.0, |_| self.bracket[1]))
    }

    fn verdict(&self, scene: &Scene) -> Option<Verdict> {
        let stage = &scene.stages[self.stage];
        if self.unknown.0 <= self.end().1 {
            let end = match self.best {
                Some(_) => stage.clock(self.bracket[1]),
                None => scene.stages[scene.stages.len() - 1].times[1],
            };
            return Some(Verdict::Undecided {
                window: [stage.clock(self.unknown.0), end],
                span: stage.span,
                obstacle: self.unknown.1,
                limited: Limited::Work,
            });
        }
        let (number, found) = self.best?;
        Some(witness::met(
            scene,
            self.stage,
            number,
            &found,
            self.bracket,
        ))
    }
}

/// The first meeting with an obstacle that must not be touched, or the first time below the
/// clearance; those that may be touched do not count.
///
/// # Guarantee
/// `Clear` is proven for the whole motion, and every other answer up to the start of its bracket or
/// window. The answer does not depend on the number of threads.
///
/// # Cost
/// Up to [`MOST_VISITS`] pairs of boxes for each obstacle in each window, and where the search is
/// long the orbits; if that does not suffice, the answer is `Undecided`.
pub(super) fn verdict(scene: &Scene) -> Result<Verdict, Interrupted> {
    if let Some(inside) = scene
        .forbidden()
        .find_map(|number| witness::inside(scene, number))
    {
        return Ok(Verdict::Contact(inside));
    }
    let threshold = scene.settings.clearance;
    let triangles = |number: usize| scene.obstacles[number].shape.len();
    let all = scene.body.len() + scene.forbidden().map(triangles).sum::<usize>();
    let soon = ORBITS_AFTER * (scene.stages.len() * all).max(FEW);
    // Longer searches are mostly those of surfaces that are near each other all the time, in many
    // pairs: their orbits tell them apart.
    let [short, long] = scene.work.parts([1, 3]);
    if let Some(verdict) = first(scene, threshold, soon.min(MOST_VISITS), &[], short)? {
        return Ok(verdict);
    }
    let apart = orbits_apart(scene, threshold);
    let verdict = first(scene, threshold, MOST_VISITS, &apart, long)?;
    Ok(verdict.unwrap_or(Verdict::Clear))
}

/// Obstacles whose orbits are more than a distance apart, stage by stage.
fn orbits_apart(scene: &Scene, distance: f64) -> Vec<(usize, usize)> {
    let stages = 0..scene.stages.len();
    let pairs: Vec<(usize, usize)> = stages
        .flat_map(|stage| scene.forbidden().map(move |obstacle| (stage, obstacle)))
        .collect();
    let is_apart = |&(stage, obstacle): &(usize, usize)| {
        let encounter = scene.encounter(obstacle, stage);
        Orbits::new(&encounter, f64::INFINITY).is_some_and(|mut orbits| orbits.keep(distance))
    };
    pairs.into_par_iter().filter(is_apart).collect()
}

/// The verdict of a search that skips some pairs of a stage and an obstacle, in ascending order,
/// which are known to be apart.
///
/// `None` where `limit` pairs of boxes do not suffice, unless that is the largest limit: then the
/// verdict is undecided.
fn first(
    scene: &Scene,
    threshold: f64,
    limit: usize,
    apart: &[(usize, usize)],
    work: Work,
) -> Result<Option<Verdict>, Interrupted> {
    let part = work.part(1, scene.stages.len() as u64);
    let mut cursor = Cursor::default();
    let mut gathered = StageFindings::nothing(0);
    let mut visits = 0;
    'search: while let Some(batch) = next_batch(scene, &mut cursor, apart) {
        let outcomes = batch.search(threshold, limit - visits, limit, part);
        work.check()?;
        for (piece, outcome) in batch.pieces.iter().zip(outcomes) {
            if piece.stage > gathered.stage {
                if let Some(verdict) = gathered.verdict(scene) {
                    return Ok(Some(verdict));
                }
                gathered = StageFindings::nothing(piece.stage);
            }
            if piece.start() > gathered.end() {
                // The rest of the stage is too late to matter.
                break 'search;
            }
            let Some(earliest) = outcome.filter(|_| visits < limit) else {
                if limit < MOST_VISITS {
                    return Ok(None);
                }
                gathered.unknown = (piece.start().1, piece.obstacle);
                break 'search;
            };
            visits = (visits + earliest.visits).min(limit);
            gathered.add(piece.obstacle, &earliest);
        }
    }
    Ok(Some(gathered.verdict(scene).unwrap_or(Verdict::Clear)))
}

/// Whether no obstacle that must not be touched ever comes nearer than a distance: a proof if so,
/// within a limit on work.
pub(super) fn keeps(scene: &Scene, distance: f64) -> Result<bool, Interrupted> {
    let mut cursor = Cursor::default();
    let mut visits = 0;
    while let Some(batch) = next_batch(scene, &mut cursor, &[]) {
        let work = scene.work.uncounted();
        let outcomes = batch.search(distance, KEEPING_WORK - visits, KEEPING_WORK, work);
        work.check()?;
        for outcome in outcomes {
            match outcome {
                Some(earliest) if earliest.found.is_none() && earliest.unknown == f64::INFINITY => {
                    visits = (visits + earliest.visits).min(KEEPING_WORK);
                }
                _ => return Ok(false),
            }
        }
    }
    Ok(visits < KEEPING_WORK)
}

/// The next pieces in the order of time, without those of stages and obstacles that are known to be
/// `apart`.
fn next_batch<'a>(
    scene: &'a Scene,
    cursor: &mut Cursor,
    apart: &[(usize, usize)],
) -> Option<Batch<'a>> {
    let mut batch = Batch::default();
    while cursor.stage < scene.stages.len() && batch.pieces.len() < BATCH {
        let first = batch.encounters.len();
        let obstacles: Vec<usize> = scene.forbidden().collect();
        let encounters = obstacles
            .iter()
            .map(|&number| scene.encounter(number, cursor.stage));
        batch.encounters.extend(encounters);
        let finest = batch.encounters[first..].iter().map(Encounter::cover).max();
        let count = finest.unwrap_or(0);
        while cursor.window < count && batch.pieces.len() < BATCH {
            let left = obstacles
                .iter()
                .enumerate()
                .filter(|(_, obstacle)| apart.binary_search(&(cursor.stage, **obstacle)).is_err());
            let among = count as usize * left.clone().count();
            let piece = |(place, &obstacle): (usize, &usize)| ObstacleWindow {
                stage: cursor.stage,
                window: cursor.window,
                half: 0.5 / f64::from(count),
                obstacle,
                encounter: first + place,
                among,
            };
            batch.pieces.extend(left.map(piece));
            cursor.window += 1;
        }
        if cursor.window >= count {
            *cursor = Cursor {
                stage: cursor.stage + 1,
                window: 0,
            };
        }
    }
    (!batch.pieces.is_empty()).then_some(batch)
}

/// Pieces that are searched together.
#[derive(Default)]
struct Batch<'a> {
    encounters: Vec<Encounter<'a>>,
    pieces: Vec<ObstacleWindow>,
}

impl Batch<'_> {
    /// The result for each piece; `None` for those that do not count, because they begin after a
    /// meeting, or after `limit` pairs of boxes.
    ///
    /// - `most`: most pairs of boxes for one piece; see [`Search::first`].
    /// - `part`: the work of one stage; when it is stopped, the results mean nothing.
    fn search(
        &self,
        threshold: f64,
        limit: usize,
        most: usize,
        part: Work,
    ) -> Vec<Option<Earliest>> {
        let outcomes: Vec<OnceLock<Earliest>> =
            self.pieces.iter().map(|_| OnceLock::new()).collect();
        let (next, visits) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let end = Mutex::new((usize::MAX, f64::INFINITY));
        let is_late = |piece: &ObstacleWindow| {
            piece.start() > *end.lock().unwrap_or_else(PoisonError::into_inner)
        };
        // Takes pieces until no more are wanted, or until this many pairs of boxes were examined:
        // then it returns that more may remain.
        let work = |until: usize| -> bool {
            while visits.load(Ordering::Relaxed) < until && part.check().is_ok() {
                let number = next.fetch_add(1, Ordering::Relaxed);
                let Some(piece) = self.pieces.get(number).filter(|piece| !is_late(piece)) else {
                    return false;
                };
                let encounter = &self.encounters[piece.encounter];
                let middle = f64::from(2 * piece.window + 1) * piece.half;
                let is_unwanted = || is_late(piece) || part.check().is_err();
                let found = Search::new(encounter, threshold).first(
                    [middle, piece.half],
                    most,
                    &is_unwanted,
                );
                part.part(1, piece.among as u64).done();
                let Some(earliest) = found else {
                    if !is_unwanted() {
                        // The limit was exceeded: nothing after it counts either.
                        visits.fetch_add(most, Ordering::Relaxed);
                    }
                    continue;
                };
                visits.fetch_add(earliest.visits, Ordering::Relaxed);
                if earliest.found.is_some() {
                    let mut end = end.lock().unwrap_or_else(PoisonError::into_inner);
                    let by = (piece.stage, earliest.bracket[1]);
                    if by < *end {
                        *end = by;
                    }
                }
                // No other worker took this piece.
                let _ = outcomes[number].set(earliest);
            }
            true
        };
        if work(limit.min(WORTH_SHARING)) {
            rayon::scope(|scope| {
                for _ in 0..rayon::current_num_threads() {
                    scope.spawn(|_| {
                        work(limit);
                    });
                }
            });
        }
        outcomes.into_iter().map(OnceLock::into_inner).collect()
    }
}
