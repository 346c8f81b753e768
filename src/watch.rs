//! A run as seen from outside: it reports its stages and how much of each is done, and it can be
//! stopped.
//!
//! Every loop that may take long is given its part of the [`Work`] of the stage. It counts its
//! items, and ends with [`Interrupted`] at the next one once the flag is up. Shares of work follow
//! from counts alone, never from time.

use crate::Fault;
use rayon::prelude::*;
use std::cmp::Ordering::Equal;
use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError, TryLockError};

/// The observer of a run: it is told the stage, and the share of its work that is done.
pub(crate) type Observer<'a, S> = &'a (dyn Fn(S, f64) + Sync);

/// The observer of the stages of a run, and the flag that stops it.
pub(crate) struct Watch<'a, S> {
    observer: Option<Observer<'a, S>>,
    flag: Option<&'a AtomicBool>,
}

impl<'a, S: Copy> Watch<'a, S> {
    /// Reports to `observer`.
    pub(crate) fn told_to(self, observer: Observer<'a, S>) -> Watch<'a, S> {
        Watch {
            observer: Some(observer),
            ..self
        }
    }

    /// Stops once `flag` is true.
    pub(crate) fn stopped_by(self, flag: &'a AtomicBool) -> Watch<'a, S> {
        Watch {
            flag: Some(flag),
            ..self
        }
    }

    /// A run before its first stage.
    pub(crate) fn start(self) -> Stages<'a, S> {
        Stages {
            observer: self.observer,
            signal: self.flag.map(Signal::of),
            done: AtomicU64::new(0),
            told: Mutex::new((None, 0)),
        }
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
            flag: None,
        }
    }
}

impl<S> fmt::Debug for Watch<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Watch")
            .field("observed", &self.observer.is_some())
            .field("flag", &self.flag)
            .finish()
    }
}

/// The amount of work of a stage, in the units in which it is counted.
const WHOLE: u64 = 1 << 32;

/// Number of equal shares that are reported: as fine as a bar shows them.
const STEPS: u64 = 100;

/// The stages of one run.
pub(crate) struct Stages<'a, S> {
    observer: Option<Observer<'a, S>>,
    signal: Option<Signal<'a>>,
    /// What is done of the stage, at most [`WHOLE`].
    done: AtomicU64,
    /// The stage, and the number of shares of it that the observer knows of.
    told: Mutex<(Option<S>, u64)>,
}

impl<S: Copy + Send> Stages<'_, S> {
    /// More work of a stage all of whose shares were told: it only heeds the flag.
    pub(crate) fn more(&self) -> Work<'_> {
        Work {
            signal: self.signal.as_ref(),
            listener: None,
            amount: WHOLE,
        }
    }

    /// Reports that a stage begins, unless the run is to stop, and returns its work.
    pub(crate) fn begin(&self, stage: S) -> Result<Work<'_>, Interrupted> {
        let work = self.more();
        work.check()?;
        let Some(observer) = self.observer else {
            return Ok(work);
        };
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        self.done.store(0, Ordering::Relaxed);
        *told = (Some(stage), 0);
        observer(stage, 0.0);
        Ok(Work {
            listener: Some(self),
            ..work
        })
    }
}

/// The flag that stops a run. Once it was seen up, the run is to stop, even if it is taken down
/// again: some of the work may have been left out by then.
struct Signal<'a> {
    flag: &'a AtomicBool,
    was_up: AtomicBool,
}

impl<'a> Signal<'a> {
    fn of(flag: &'a AtomicBool) -> Signal<'a> {
        Signal {
            flag,
            was_up: AtomicBool::new(false),
        }
    }

    /// The flag carries no data, so its order relative to other memory accesses does not matter.
    fn is_up(&self) -> bool {
        let is_up = self.flag.load(Ordering::Relaxed);
        if is_up {
            self.was_up.store(true, Ordering::Relaxed);
        }
        is_up || self.was_up.load(Ordering::Relaxed)
    }
}

/// Hears of finished work.
trait Listener: Sync {
    /// Work was done, from any thread.
    fn hear(&self, amount: u64);
}

impl<S: Copy + Send> Listener for Stages<'_, S> {
    fn hear(&self, amount: u64) {
        let before = self.done.fetch_add(amount, Ordering::Relaxed);
        let share = |done: u64| (done.min(WHOLE) * STEPS) >> WHOLE.trailing_zeros();
        if share(before) == share(before + amount) {
            return;
        }
        // While one thread reports, the others go on: their shares are part of the next report.
        let mut told = match self.told.try_lock() {
            Ok(told) => told,
            Err(TryLockError::Poisoned(told)) => told.into_inner(),
            Err(TryLockError::WouldBlock) => return,
        };
        let share = share(self.done.load(Ordering::Relaxed));
        if let (Some(observer), (Some(stage), known)) = (self.observer, *told)
            && share > known
        {
            told.1 = share;
            observer(stage, share as f64 / STEPS as f64);
        }
    }
}

/// The work of a stage, or a part of it.
#[derive(Clone, Copy)]
pub(crate) struct Work<'a> {
    signal: Option<&'a Signal<'a>>,
    listener: Option<&'a dyn Listener>,
    amount: u64,
}

impl<'a> Work<'a> {
    /// Work that nobody watches.
    pub(crate) const UNWATCHED: Work<'static> = Work {
        signal: None,
        listener: None,
        amount: 0,
    };

    /// Fails once the run is to stop. Cheap enough for a loop whose steps take some nanoseconds.
    pub(crate) fn check(self) -> Result<(), Interrupted> {
        match self.signal {
            Some(signal) if signal.is_up() => Err(Interrupted),
            _ => Ok(()),
        }
    }

    /// Parts in the given proportions: what they cost, roughly.
    pub(crate) fn parts<const N: usize>(self, proportions: [u64; N]) -> [Work<'a>; N] {
        let all = proportions.iter().sum();
        proportions.map(|own| self.part(own, all))
    }

    /// The part `own` of `all`.
    pub(crate) fn part(self, own: u64, all: u64) -> Work<'a> {
        Work {
            amount: self.amount * own / all.max(1),
            ..self
        }
    }

    /// The same flag, but nothing is counted: for work that another count includes.
    pub(crate) fn uncounted(self) -> Work<'a> {
        Work {
            listener: None,
            ..self
        }
    }

    /// The work as `count` items of equal cost.
    pub(crate) fn items(self, count: usize) -> Items<'a> {
        Items {
            work: self,
            count: count as u64,
            done: AtomicU64::new(0),
        }
    }

    /// Sorts in parallel; items that compare equal must be equal.
    pub(crate) fn sort<T: Ord + Send>(self, list: &mut [T]) -> Result<(), Interrupted> {
        // Once the run is to stop, all items count as equal: then the sort soon ends, in any order.
        list.par_sort_unstable_by(|one, other| match self.check() {
            Ok(()) => one.cmp(other),
            Err(Interrupted) => Equal,
        });
        self.check()
    }

    /// All of it is done.
    pub(crate) fn done(self) {
        if let Some(listener) = self.listener {
            listener.hear(self.amount);
        }
    }
}

/// Work in items of equal cost, which any thread may count.
pub(crate) struct Items<'a> {
    work: Work<'a>,
    count: u64,
    done: AtomicU64,
}

impl Items<'_> {
    /// Counts one more as done, unless the run is to stop.
    pub(crate) fn next(&self) -> Result<(), Interrupted> {
        self.advance(1)
    }

    /// Counts some more as done, unless the run is to stop. Items beyond the given number count
    /// nothing.
    pub(crate) fn advance(&self, items: usize) -> Result<(), Interrupted> {
        self.work.check()?;
        if let Some(listener) = self.work.listener {
            let items = items as u64;
            let before = self.done.fetch_add(items, Ordering::Relaxed);
            let amount = |done: u64| self.work.amount * done.min(self.count) / self.count.max(1);
            listener.hear(amount(before + items) - amount(before));
        }
        Ok(())
    }
}

/// A run was stopped by the flag that its settings name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("interrupted")]
pub struct Interrupted;

/// Why a stage has no result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stop {
    /// The run was stopped from outside.
    Interrupted,
    /// An invariant does not hold.
    Fault(Fault),
}

impl Stop {
    /// Why work that nobody watches has no result.
    pub(crate) fn unwatched(self) -> Fault {
        match self {
            Stop::Interrupted => Fault::new("work was stopped that nobody can stop"),
            Stop::Fault(fault) => fault,
        }
    }
}

impl From<Interrupted> for Stop {
    fn from(_: Interrupted) -> Stop {
        Stop::Interrupted
    }
}

/// The result of work that nobody watches.
pub(crate) fn unwatched<T>(run: impl FnOnce(Work) -> Result<T, Interrupted>) -> T {
    run(Work::UNWATCHED).expect("nobody stops it")
}

impl From<Fault> for Stop {
    fn from(fault: Fault) -> Stop {
        Stop::Fault(fault)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What an observer is told by a run.
    fn told(run: impl FnOnce(Watch<u8>)) -> Vec<(u8, f64)> {
        let told = Mutex::new(Vec::new());
        let tell = |stage: u8, share: f64| told.lock().expect("one thread").push((stage, share));
        run(Watch::default().told_to(&tell));
        told.into_inner().expect("one thread")
    }

    #[test]
    fn no_stage_begins_and_no_item_counts_once_the_flag_is_up() {
        let flag = AtomicBool::new(false);
        let heard = told(|watch| {
            let stages = watch.stopped_by(&flag).start();
            {
                let items = stages.begin(1).expect("the flag is down").items(2);
                assert_eq!(items.next(), Ok(()));
                flag.store(true, Ordering::Relaxed);
                assert_eq!(items.next(), Err(Interrupted));
            }
            assert!(stages.begin(2).is_err(), "no further stage");
        });
        assert_eq!(heard, [(1, 0.0), (1, 0.5)]);
        assert!(Watch::<u8>::default().start().begin(3).is_ok(), "nobody");
    }

    #[test]
    fn a_sort_ends_once_the_flag_is_up() {
        let flag = AtomicBool::new(false);
        let stages = Watch::default().stopped_by(&flag).start();
        let work = stages.begin(0_u8).expect("the flag is down");
        let mut list: Vec<u32> = (0..10_000).map(|i| i * 7 % 10_000).collect();
        assert_eq!(work.sort(&mut list), Ok(()));
        assert!(list.is_sorted(), "{list:?}");
        flag.store(true, Ordering::Relaxed);
        assert_eq!(work.sort(&mut list), Err(Interrupted));
        flag.store(false, Ordering::Relaxed);
        assert_eq!(work.check(), Err(Interrupted), "it was up");
    }

    #[test]
    fn shares_of_parts_add_up() {
        let heard = told(|watch| {
            let stages = watch.start();
            let [first, second] = stages.begin(1).expect("no flag").parts([1, 3]);
            second.items(2).next().expect("no flag");
            first.done();
            let [one, _] = second.parts([1, 1]);
            one.done();
            one.uncounted().done();
        });
        let shares = [0.0, 0.375 - 0.005, 0.625 - 0.005, 1.0];
        assert_eq!(heard.len(), shares.len(), "{heard:?}");
        for ((_, share), expected) in heard.iter().zip(shares) {
            assert!((share - expected).abs() <= 0.005, "{heard:?}");
        }
    }

    #[test]
    fn at_most_a_hundred_shares_are_told_and_they_grow() {
        let heard = told(|watch| {
            let stages = watch.start();
            let items = stages.begin(1).expect("no flag").items(100_000);
            for _ in 0..100_001 {
                items.next().expect("no flag");
            }
        });
        assert_eq!(heard.len(), 101, "one for the beginning");
        assert!(heard.is_sorted_by(|a, b| a.1 < b.1), "{heard:?}");
        assert_eq!(heard.last(), Some(&(1, 1.0)));
    }
}
