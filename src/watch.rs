//! A run as seen from outside: it reports its stages, and it can be stopped.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

/// The observer of the stages of a run, and the flag that stops it.
pub(crate) struct Watch<'a, S> {
    observer: Option<&'a (dyn Fn(S) + Sync)>,
    interrupt: Interrupt<'a>,
}

impl<'a, S> Watch<'a, S> {
    /// Reports each stage to `observer`.
    pub(crate) fn told_to(self, observer: &'a (dyn Fn(S) + Sync)) -> Watch<'a, S> {
        Watch {
            observer: Some(observer),
            ..self
        }
    }

    /// Stops once `flag` is true.
    pub(crate) fn stopped_by(self, flag: &'a AtomicBool) -> Watch<'a, S> {
        Watch {
            interrupt: Interrupt(Some(flag)),
            ..self
        }
    }

    /// Reports that a stage begins, unless the run is to stop.
    pub(crate) fn begin(&self, stage: S) -> Result<(), Interrupted> {
        self.interrupt.check()?;
        if let Some(observer) = self.observer {
            observer(stage);
        }
        Ok(())
    }
}

// Derived implementations would require the same of the stage.
impl<S> Clone for Watch<'_, S> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<S> Copy for Watch<'_, S> {}

impl<S> Default for Watch<'_, S> {
    fn default() -> Self {
        Watch {
            observer: None,
            interrupt: Interrupt::default(),
        }
    }
}

impl<S> fmt::Debug for Watch<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Watch")
            .field("observed", &self.observer.is_some())
            .field("interrupt", &self.interrupt)
            .finish()
    }
}

/// A flag that stops a run, if there is one.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Interrupt<'a>(Option<&'a AtomicBool>);

impl Interrupt<'_> {
    /// Whether the run is to stop. The flag carries no data, so its order relative to other memory
    /// accesses does not matter.
    pub(crate) fn is_asked_for(self) -> bool {
        self.0.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// Fails once the run is to stop. Cheap enough for a loop whose steps take a microsecond.
    pub(crate) fn check(self) -> Result<(), Interrupted> {
        if self.is_asked_for() {
            Err(Interrupted)
        } else {
            Ok(())
        }
    }
}

/// The run was stopped from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Interrupted;

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn no_stage_begins_once_the_flag_is_up() {
        let (told, flag) = (Mutex::new(Vec::new()), AtomicBool::new(false));
        let tell = |stage: u8| told.lock().expect("one thread").push(stage);
        let watch = Watch::default().told_to(&tell).stopped_by(&flag);
        assert_eq!(watch.begin(1), Ok(()));
        flag.store(true, Ordering::Relaxed);
        assert_eq!(watch.begin(2), Err(Interrupted));
        assert_eq!(*told.lock().expect("one thread"), [1]);
        assert_eq!(Watch::<u8>::default().begin(3), Ok(()), "nobody listens");
    }
}
