//! The stages of a run: named on a terminal while they run, timed for the report.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use steadysweep::report::Seconds;

/// Time between two frames of the spinner: quick enough to look alive, slow enough to cost nothing.
const FRAME: Duration = Duration::from_millis(100);

/// The stages of one run, from its creation on.
///
/// A spinner on the standard error stream names the stage that runs now, and says how many there are; nothing is shown where that stream is no
/// terminal.
pub(crate) struct Progress {
    bar: ProgressBar,
    start: Instant,
    /// Name and begin of each stage so far.
    stages: Mutex<Vec<(&'static str, Instant)>>,
}

impl Progress {
    /// A run of `stages` that starts now, without a spinner when `quiet`.
    pub(crate) fn new(quiet: bool, stages: u64) -> Progress {
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
        Progress {
            bar,
            start: Instant::now(),
            stages: Mutex::default(),
        }
    }

    /// The stage before ends, and `name` begins.
    pub(crate) fn stage(&self, name: &'static str) {
        self.bar.inc(1);
        self.bar.set_message(name);
        self.stages
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push((name, Instant::now()));
    }

    /// Ends the last stage: the time of the run until now, stage by stage.
    pub(crate) fn seconds(&self) -> Seconds {
        let now = Instant::now();
        let stages = self.stages.lock().unwrap_or_else(PoisonError::into_inner);
        let ends = stages.iter().skip(1).map(|(_, begin)| *begin).chain([now]);
        Seconds {
            total: (now - self.start).as_secs_f64(),
            stages: stages
                .iter()
                .zip(ends)
                .map(|((name, begin), end)| (*name, (end - *begin).as_secs_f64()))
                .collect(),
        }
    }

    /// What removes the spinner, for the moment when something else is about to be written.
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
        let progress = Progress::new(true, 2);
        progress.stage("read");
        progress.stage("arrange");
        let seconds = progress.seconds();
        let names: Vec<&str> = seconds.stages.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["read", "arrange"], "in order");
        let sum: f64 = seconds.stages.iter().map(|(_, time)| time).sum();
        assert!(
            sum <= seconds.total,
            "the stages are parts of the run: {seconds:?}"
        );
    }
}
