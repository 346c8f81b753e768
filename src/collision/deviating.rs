//! Checks of motions that stand for others and may deviate from them.
//!
//! With D the sum of the deviations of the body and of an obstacle, the true distance of the two
//! differs from that of the chains by at most D at any time. So they are clear where the chains
//! keep more than D of distance. They are certainly in contact where one chain is deeper than D in
//! the other: a point that stays at a distance above D from a closed surface while that surface
//! moves by at most D stays on its side. The bracket of a contact runs from the last time of the
//! former kind to the first of the latter. Where only the former ends, the answer is undecided.
//! A deviation that is only an estimate decides nothing.

use super::scene::ShapeObstacle;
use super::shape::Shape;
use super::{
    Check, CheckError, CheckSettings, Clearance, ContactInterval, ContactRule, Doubt, FirstContact,
    Limited, Verdict,
};
use crate::motion::Motion;

/// What the motion of a shape may be off by.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Slack {
    length: f64,
    proven: bool,
}

impl Slack {
    const NONE: Slack = Slack {
        length: 0.0,
        proven: true,
    };

    fn of(motion: Option<&Motion>, shape: &Shape) -> Result<Slack, CheckError> {
        let Some(motion) = motion.filter(|motion| motion.deviation().is_some()) else {
            return Ok(Slack::NONE);
        };
        if shape.plane().is_some() {
            // Far along the plane, the smallest turn takes it any distance.
            return Err(CheckError::DeviatingHalfSpace);
        }
        let deviation = motion.deviation_over(shape.bounds());
        let Some(deviation) = deviation.map_err(CheckError::Motion)? else {
            return Ok(Slack::NONE);
        };
        Ok(Slack {
            length: deviation.length,
            proven: deviation.proven,
        })
    }

    fn plus(self, other: Slack) -> Slack {
        Slack {
            length: self.length + other.length,
            proven: self.proven && other.proven,
        }
    }
}

/// The check of the chains themselves against some obstacles.
type ChainCheck<'a> = dyn Fn(&[ShapeObstacle], &CheckSettings) -> Result<Check, CheckError> + 'a;

/// A check in which a motion deviates; `None` where none does.
pub(super) fn check_deviating(
    body: &Shape,
    motion: &Motion,
    obstacles: &[ShapeObstacle],
    settings: &CheckSettings,
    chains: &ChainCheck,
) -> Result<Option<Check>, CheckError> {
    let own = Slack::of(Some(motion), body)?;
    let slacks = obstacles
        .iter()
        .map(|obstacle| Ok(Slack::of(obstacle.motion, obstacle.shape)?.plus(own)))
        .collect::<Result<Vec<Slack>, CheckError>>()?;
    if slacks.iter().all(|slack| *slack == Slack::NONE) {
        return Ok(None);
    }
    let end = motion.joint_times()[motion.spans().len()];
    let mut whole: Option<Check> = None;
    for (number, slack) in slacks.into_iter().enumerate() {
        let rule = settings.rules.get(number).copied().unwrap_or_default();
        let one = Single {
            motion,
            chains,
            obstacle: obstacles[number],
            number,
            rule,
            slack,
            settings,
            end,
        };
        let check = one.check()?;
        whole = Some(match whole {
            None => check,
            Some(before) => merged(before, check),
        });
    }
    Ok(whole)
}

/// The check against one obstacle.
struct Single<'a> {
    motion: &'a Motion,
    chains: &'a ChainCheck<'a>,
    obstacle: ShapeObstacle<'a>,
    number: usize,
    rule: ContactRule,
    slack: Slack,
    settings: &'a CheckSettings<'a>,
    /// The end of the motion.
    end: f64,
}

impl Single<'_> {
    fn check(&self) -> Result<Check, CheckError> {
        let off = self.slack.length;
        let clearance = self.settings.clearance;
        let depth = match self.rule {
            ContactRule::Allowed => return self.run(ContactRule::Allowed, clearance),
            ContactRule::Touch => None,
            ContactRule::Enter { depth } => Some(depth.unwrap_or(0.0)),
        };
        // What may be: nearer than the limit by the deviation, or less deep.
        let possible = match depth {
            Some(depth) if depth > off => {
                let depth = Some(depth - off);
                match self.run(ContactRule::Enter { depth }, clearance) {
                    // Less deep than can be told from touching.
                    Err(CheckError::Depth { .. }) => self.run(ContactRule::Touch, 0.0)?,
                    found => found?,
                }
            }
            Some(depth) => self.run(ContactRule::Touch, off - depth)?,
            None => self.run(ContactRule::Touch, clearance + off)?,
        };
        let certain = self.certain(depth, clearance)?;
        let mut check = possible;
        check.depths = vec![depth];
        let doubtful = check.verdict;
        check.verdict = self.verdict(doubtful, certain.as_ref().map(|check| check.verdict));
        if let Some(all) = &check.intervals {
            let sure = certain.as_ref().and_then(|check| check.intervals.clone());
            let sure = sure.filter(|_| self.slack.proven).unwrap_or_default();
            check.doubts.extend(self.doubts(all, &sure));
            check
                .doubts
                .sort_by(|a, b| a.times[0].total_cmp(&b.times[0]));
            check.intervals = Some(sure);
        }
        if let Some(certain) = &certain {
            for (stage, added) in check.seconds.iter_mut().zip(&certain.seconds) {
                stage.1 += added.1;
            }
        }
        check.clearance = self.clearance(&check);
        Ok(check)
    }

    /// The check that finds what certainly is: nearer than the clearance in spite of the deviation,
    /// or deeper.
    fn certain(&self, depth: Option<f64>, clearance: f64) -> Result<Option<Check>, CheckError> {
        let off = self.slack.length;
        let nearer = if depth.is_none() && clearance > off {
            Some(self.run(ContactRule::Touch, clearance - off)?)
        } else {
            None
        };
        if nearer
            .as_ref()
            .is_some_and(|check| !matches!(check.verdict, Verdict::Contact(_)))
        {
            return Ok(nearer);
        }
        let depth = Some(depth.unwrap_or(0.0) + off);
        let deeper = match self.run_depth(ContactRule::Enter { depth }, 0.0) {
            Ok(check) => Some(check),
            // No depth in a stretched obstacle can be certified.
            Err(CheckError::Stretched { .. }) => None,
            Err(error) => return Err(error),
        };
        let Some(mut nearer) = nearer else {
            return Ok(deeper);
        };
        // In contact by the chains: certainly too near, and perhaps in contact.
        let is_contact = deeper.is_some_and(|check| matches!(check.verdict, Verdict::Contact(_)));
        if let (Verdict::Contact(first), false) = (nearer.verdict, is_contact) {
            nearer.verdict = Verdict::Closer(first);
        }
        Ok(Some(nearer))
    }

    fn verdict(&self, possible: Verdict, certain: Option<Verdict>) -> Verdict {
        let limited = Limited::Deviation;
        let numbered = |mut first: FirstContact, from: f64| {
            first.obstacle = self.number;
            first.bracket[0] = from.min(first.bracket[0]);
            first
        };
        let undecided = |from: f64| Verdict::Undecided {
            window: [from, self.end],
            span: self.motion.span_at_time(from),
            obstacle: self.number,
            limited,
        };
        match (possible, certain) {
            (Verdict::Clear, _) if self.slack.proven => Verdict::Clear,
            (Verdict::Clear, _) => undecided(self.motion.joint_times()[0]),
            (
                Verdict::Undecided {
                    window,
                    span,
                    limited,
                    ..
                },
                _,
            ) => Verdict::Undecided {
                window,
                span,
                obstacle: self.number,
                limited,
            },
            (Verdict::Contact(first) | Verdict::Closer(first), certain) => {
                let from = first.bracket[0];
                match certain {
                    Some(Verdict::Contact(first)) if self.slack.proven => {
                        Verdict::Contact(numbered(first, from))
                    }
                    Some(Verdict::Closer(first)) if self.slack.proven => {
                        Verdict::Closer(numbered(first, from))
                    }
                    _ => undecided(from),
                }
            }
        }
    }

    /// What may be the least distance of the true motions.
    fn clearance(&self, check: &Check) -> Clearance {
        let mut clearance = check.clearance;
        let off = self.slack.length;
        clearance.obstacle = self.number;
        clearance.lower = match check.verdict {
            Verdict::Contact(_) => 0.0,
            _ if !self.slack.proven => 0.0,
            _ => (clearance.lower - off).max(0.0),
        };
        clearance.upper = match check.verdict {
            Verdict::Contact(_) => 0.0,
            _ => clearance.upper + off,
        };
        clearance.limited = match check.verdict {
            Verdict::Contact(_) => None,
            _ if clearance.is_sharp() => None,
            _ => clearance.limited.or(Some(Limited::Deviation)),
        };
        clearance
    }

    /// Times of possible contact without those of certain contact.
    fn doubts(&self, all: &[ContactInterval], sure: &[ContactInterval]) -> Vec<Doubt> {
        let mut doubts = Vec::new();
        let mut add = |from: f64, to: f64| {
            if from < to {
                doubts.push(Doubt {
                    obstacle: self.number,
                    times: [from, to],
                    limited: Limited::Deviation,
                });
            }
        };
        for interval in all {
            let [mut from, end] = interval.times;
            for known in sure {
                let [start, stop] = known.times;
                if stop <= from || start >= end {
                    continue;
                }
                add(from, start);
                from = from.max(stop);
            }
            add(from, end);
        }
        doubts
    }

    fn run(&self, rule: ContactRule, clearance: f64) -> Result<Check, CheckError> {
        let settings = CheckSettings {
            clearance,
            rules: vec![rule],
            ..self.settings.clone()
        };
        let mut check =
            (self.chains)(&[self.obstacle], &settings).map_err(|error| self.numbered(error))?;
        for interval in check.intervals.iter_mut().flatten() {
            interval.obstacle = self.number;
        }
        for doubt in &mut check.doubts {
            doubt.obstacle = self.number;
        }
        Ok(check)
    }

    /// As [`Single::run`], with the least depth where the given one is below that.
    fn run_depth(&self, rule: ContactRule, clearance: f64) -> Result<Check, CheckError> {
        match self.run(rule, clearance) {
            Err(CheckError::Depth { least, .. }) => {
                self.run(ContactRule::Enter { depth: Some(least) }, clearance)
            }
            found => found,
        }
    }

    fn numbered(&self, error: CheckError) -> CheckError {
        match error {
            CheckError::Depth { depth, least, .. } => CheckError::Depth {
                depth,
                obstacle: self.number,
                least,
            },
            CheckError::Stretched { .. } => CheckError::Stretched {
                obstacle: self.number,
            },
            CheckError::StretchedHalfSpace { .. } => CheckError::StretchedHalfSpace {
                obstacle: self.number,
            },
            error => error,
        }
    }
}

/// The checks against some obstacles and against one more as one.
fn merged(mut before: Check, last: Check) -> Check {
    before.verdict = earlier(before.verdict, last.verdict);
    if last.clearance.lower < before.clearance.lower || before.clearance.upper.is_infinite() {
        before.clearance.lower = last.clearance.lower;
        before.clearance.limited = before.clearance.limited.or(last.clearance.limited);
    }
    if last.clearance.upper < before.clearance.upper {
        let lower = before.clearance.lower;
        before.clearance = Clearance {
            lower,
            ..last.clearance
        };
    }
    if let (Some(all), Some(more)) = (&mut before.intervals, last.intervals) {
        all.extend(more);
    }
    before.doubts.extend(last.doubts);
    before.relative.extend(last.relative);
    before.depths.extend(last.depths);
    for (stage, added) in before.seconds.iter_mut().zip(&last.seconds) {
        stage.1 += added.1;
    }
    before
}

/// The verdict on two sets of obstacles. A certain contact counts before what is undecided, but its
/// bracket begins where anything may be in contact.
fn earlier(one: Verdict, other: Verdict) -> Verdict {
    let certain = |verdict: &Verdict| match verdict {
        Verdict::Contact(first) | Verdict::Closer(first) => Some(first.bracket),
        Verdict::Clear | Verdict::Undecided { .. } => None,
    };
    let from = |verdict: &Verdict| match verdict {
        Verdict::Contact(first) | Verdict::Closer(first) => first.bracket[0],
        Verdict::Undecided { window, .. } => window[0],
        Verdict::Clear => f64::INFINITY,
    };
    let start = from(&one).min(from(&other));
    let first_is_one = match (certain(&one), certain(&other)) {
        (Some(a), Some(b)) => a[1] <= b[1],
        (Some(_), None) => true,
        (None, Some(_)) => false,
        (None, None) => from(&one) <= from(&other),
    };
    let mut verdict = if first_is_one { one } else { other };
    if let Verdict::Contact(first) | Verdict::Closer(first) = &mut verdict {
        first.bracket[0] = start;
    }
    verdict
}
