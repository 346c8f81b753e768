//! The settings of a probe of many points.

use crate::watch::Watch;
use std::sync::atomic::AtomicBool;

/// The settings of a probe of many points.
#[derive(Debug, Clone, Copy, Default)]
pub struct ProbeSettings<'a> {
    pub(super) watch: Watch<'a, ProbeStage>,
}

impl<'a> ProbeSettings<'a> {
    /// The same, with an observer of the share of the points that are done, as
    /// [`SweepSettings::with_observer`](crate::SweepSettings::with_observer) tells it.
    #[must_use]
    pub fn with_observer(mut self, observer: &'a (dyn Fn(ProbeStage, f64) + Sync)) -> Self {
        self.watch = self.watch.told_to(observer);
        self
    }

    /// The same, with a flag that stops the run: when another thread sets it to true, the run ends
    /// with [`Interrupted`](crate::Interrupted).
    #[must_use]
    pub fn with_interrupt(mut self, flag: &'a AtomicBool) -> Self {
        self.watch = self.watch.stopped_by(flag);
        self
    }
}

/// A stage of a probe.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ProbeStage {
    /// Finding the times of the points.
    Points,
}
