//! The stages of a sweep: reported as they begin, and timed.

use super::Stage;
use crate::watch::{Interrupted, Stages, Watch, Work};
use std::time::Instant;

/// Reports and times the stages of a sweep, over all attempts at it.
pub(super) struct Clock<'a> {
    stages: Stages<'a, Stage>,
    seconds: [(Stage, f64); 3],
    running: Option<(Stage, Instant)>,
}

impl<'a> Clock<'a> {
    pub(super) fn new(watch: Watch<'a, Stage>) -> Clock<'a> {
        Clock {
            stages: watch.start(),
            seconds: [Stage::Cycle, Stage::Arrangement, Stage::Boundary].map(|stage| (stage, 0.0)),
            running: None,
        }
    }

    /// Ends the current stage, and begins the next unless the sweep is to stop. Returns its work.
    pub(super) fn begin(&mut self, stage: Stage) -> Result<Work<'_>, Interrupted> {
        self.end();
        let work = self.stages.begin(stage)?;
        self.running = Some((stage, Instant::now()));
        Ok(work)
    }

    /// More work of the current stage, all of whose shares were told.
    pub(super) fn more(&self) -> Work<'_> {
        self.stages.more()
    }

    /// The seconds that each stage took so far.
    pub(super) fn seconds(mut self) -> [(Stage, f64); 3] {
        self.end();
        self.seconds
    }

    fn end(&mut self) {
        let Some((stage, since)) = self.running.take() else {
            return;
        };
        for (other, seconds) in &mut self.seconds {
            if *other == stage {
                *seconds += since.elapsed().as_secs_f64();
            }
        }
    }
}
