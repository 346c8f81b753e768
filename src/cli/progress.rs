//! The stages of a run: named on a terminal while they run, timed for the report.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::report::Seconds;
use indicatif::{ProgressBar, ProgressStyle};

/// Time between two frames of the spinner: quick enough to look alive, slow enough to cost nothing.
const FRAME: Duration = Duration::from_millis(100);

/// The stages of one run, from its creation on.
///
/// A spinner on the standard error stream names the current stage and the number of stages; nothing
/// is shown where that stream is no terminal.
pub(crate) struct StageProgress {
    bar: ProgressBar,
    start: Instant,
    times: Mutex<StageTimes>,
}

/// Stages so far.
#[derive(Default)]
struct StageTimes {
    /// Name and time of each stage that has ended, in the order in which they first began; the
    /// times of a stage that ran more than once are added up.
    ended: Vec<(&'static str, Duration)>,
    /// Name and start of the current stage.
    running: Option<(&'static str, Instant)>,
}

impl StageTimes {
    fn end(&mut self, now: Instant) {
        if let Some((name, begin)) = self.running.take() {
            let time = now - begin;
            match self.ended.iter_mut().find(|(known, _)| *known == name) {
                Some((_, total)) => *total += time,
                None => self.ended.push((name, time)),
            }
        }
    }
}

impl StageProgress {
    /// A run of `stages` that starts now, without a spinner when `quiet`.
    pub(crate) fn new(quiet: bool, stages: u64) -> StageProgress {
        let bar = if quiet {
            ProgressBar::hidden()
        } else {
            ProgressBar::new(stages)
        };
        if let Ok(style) = ProgressStyle::with_template("{spinner} {pos}/{len} {msg} ({elapsed})") {
            bar.set_style(style);
        }
        if !bar.is_hidden() {
            bar.enable_steady_tick(FRAME);
        }
        StageProgress {
            bar,
            start: Instant::now(),
            times: Mutex::default(),
        }
    }

    /// Ends the current stage and begins `name`, or continues it if it has run before.
    pub(crate) fn stage(&self, name: &'static str) {
        let now = Instant::now();
        let mut times = self.times.lock().unwrap_or_else(PoisonError::into_inner);
        // The first stage begins at the start of the run.
        let begin = if times.running.is_some() {
            now
        } else {
            self.start
        };
        times.end(now);
        if times.ended.iter().all(|(known, _)| *known != name) {
            self.bar.inc(1);
        }
        self.bar.set_message(name);
        times.running = Some((name, begin));
    }

    /// Ends the last stage: the time of the run until now, stage by stage.
    pub(crate) fn seconds(&self) -> Seconds {
        let now = Instant::now();
        let mut times = self.times.lock().unwrap_or_else(PoisonError::into_inner);
        times.end(now);
        Seconds {
            total: (now - self.start).as_secs_f64(),
            stages: times
                .ended
                .iter()
                .map(|(name, time)| (*name, time.as_secs_f64()))
                .collect(),
        }
    }

    /// A function that removes the spinner, for when something else is about to be written.
    pub(crate) fn eraser(&self) -> impl Fn() + Send + use<> {
        let bar = self.bar.clone();
        move || bar.finish_and_clear()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stages_follow_each_other_without_gaps() {
        let progress = StageProgress::new(true, 2);
        progress.stage("read");
        progress.stage("arrange");
        let seconds = progress.seconds();
        let names: Vec<&str> = seconds.stages.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["read", "arrange"], "in order");
        let sum: f64 = seconds.stages.iter().map(|(_, time)| time).sum();
        assert!(
            (sum - seconds.total).abs() < 1e-9,
            "the stages are the run: {seconds:?}"
        );
    }

    #[test]
    fn stages_that_run_again_are_summed() {
        let progress = StageProgress::new(true, 3);
        for stage in ["read", "cycle", "arrange", "cycle", "arrange", "write"] {
            progress.stage(stage);
        }
        let seconds = progress.seconds();
        let names: Vec<&str> = seconds.stages.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["read", "cycle", "arrange", "write"], "each once");
        let sum: f64 = seconds.stages.iter().map(|(_, time)| time).sum();
        assert!(
            (sum - seconds.total).abs() < 1e-9,
            "no time is lost: {seconds:?}"
        );
    }
}
