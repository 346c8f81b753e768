//! Consecutive spans with one generator, up to rounding, merged into one steady motion.
//!
//! A screw given by two hundred keyframes is one screw. The spans of a run have generators
//! G_k = c_k G, c_k >= 0. Their sum carries the body along the same path as the spans one after the
//! other, and work that is done once per span is done once.
//!
//! # How far that may be off
//! The run begins at its given pose P_0 and is at exp(s_k G) P_0 where the chain is at the joint
//! P_k, with s_k the share of the spans before. For a point x of the body, y = P_k x, the two are
//! apart by D = |P_k x - exp(s_k G) P_0 x| there. Within the span the velocities differ by
//! w(y) = (G_k - c_k G) y. Along the path of y, w changes by at most |dM| |G_k y| e^mu, where mu is
//! at least the growth rate of either motion over the span. So at any time within it (Duhamel's
//! formula)
//!
//! > e^mu (D + |w(y)| + |dM| |G_k y| e^mu)
//!
//! bounds the distance. Each term is convex in x: it is largest at a corner of the box around the
//! body. Runs are made where this *deviation* is below rounding, and it is reported, so that it
//! enters every bound.
//!
//! # Within a tolerance
//! A smooth path given by a thousand keyframes is a thousand motions that differ little. Where a
//! tolerance allows it, consecutive runs are merged into one steady motion as long as the deviation
//! is within an allowance: the number of spans is then that of the path, not of its keyframes.
//! Translations are never merged in this way, since their sweeps are exact. The merged motion ends
//! its run next to the given joint, at most the deviation away, and the next run begins at the
//! joint: the last step of the run leads its points to the joint, which moves them by as much
//! again. So the deviation counts twice.

use super::Generator;
use super::flow::Flow;
use crate::numeric::tolerance::{MERGED_ROUNDING, MERGED_TURN, SAME_POSE, UNIT_ROUNDOFF};
use glam::{DAffine3, DMat3, DVec3};
use std::borrow::Cow;
use std::ops::Range;

/// Which spans may belong to one run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Pace {
    /// Spans along the same paths, at any pace.
    Any,
    /// Spans along the same paths at the same speed: time stays even, and positions stay within a
    /// few times their rounding. A run does not turn much farther than once round.
    Even,
}

/// A motion with each run as one span.
#[derive(Debug)]
pub(crate) struct Merged<'a, M: Clone> {
    pub(crate) motion: Cow<'a, M>,
    /// The first span of each run, and at the end the number of spans; empty where every span is a
    /// run of its own.
    firsts: Vec<usize>,
    /// Largest distance of a point of the body from its position under the motion itself; 0 where
    /// nothing was merged.
    pub(crate) deviation: f64,
}

impl<'a, M: Clone> Merged<'a, M> {
    /// The motion without any merging.
    pub(super) fn unchanged(motion: &'a M) -> Merged<'a, M> {
        Merged {
            motion: Cow::Borrowed(motion),
            firsts: Vec::new(),
            deviation: 0.0,
        }
    }

    pub(super) fn new(motion: M, runs: Runs) -> Merged<'a, M> {
        Merged {
            motion: Cow::Owned(motion),
            firsts: runs.firsts,
            deviation: runs.deviation,
        }
    }

    /// The spans of the motion itself that make up a span of the merged one.
    pub(crate) fn spans_of(&self, run: usize) -> Range<usize> {
        match self.firsts.get(run..run + 2) {
            Some(&[first, next]) => first..next,
            _ => run..run + 1,
        }
    }
}

/// A chain of spans, in space.
pub(super) struct Chain<'a> {
    /// Clock times of the joints.
    pub(super) times: &'a [f64],
    /// The generators of the spans, in the world.
    pub(super) generator: Box<dyn Fn(usize) -> Generator + 'a>,
    /// The map from the world at the start to the world at a joint.
    pub(super) joint: Box<dyn Fn(usize) -> DAffine3 + 'a>,
    /// Corners of a box around the body, in the world at the start.
    pub(super) corners: &'a [DVec3],
    pub(super) pace: Pace,
    /// Largest deviation, as counted, of runs that differ by more than rounding.
    pub(super) allowance: f64,
}

/// A chain cut into runs.
#[derive(Debug, PartialEq)]
pub(super) struct Runs {
    /// The first span of each run, and at the end the number of spans.
    pub(super) firsts: Vec<usize>,
    /// Largest distance of a point of the body from its position under the chain.
    pub(super) deviation: f64,
}

/// Spans taken for one run.
struct AsOne {
    /// Of the whole run.
    generator: Generator,
    /// Of the spans in it.
    shares: Vec<f64>,
    deviation: f64,
    /// Largest coordinate of the box at the joints.
    reach: f64,
}

impl Chain<'_> {
    /// Cuts the chain into runs.
    ///
    /// # Cost
    /// O(n log n) for n spans, and O(n) where rounding is as expected; about a microsecond per
    /// span.
    pub(super) fn runs(&self) -> Runs {
        let spans = self.times.len() - 1;
        let mut runs = Runs {
            firsts: Vec::new(),
            deviation: 0.0,
        };
        let mut first = 0;
        while first < spans {
            let mut sum = Sum::new();
            sum.add(&(self.generator)(first));
            let mut end = first + 1;
            while end < spans && self.goes_on(first, &sum.total(), end) {
                sum.add(&(self.generator)(end));
                end += 1;
            }
            self.settle(first..end, &mut runs);
            first = end;
        }
        runs.firsts.push(spans);
        if self.allowance > 0.0 {
            runs = self.longer(&runs);
        }
        runs
    }

    /// Joins consecutive runs, each time as many as the allowance permits.
    fn longer(&self, runs: &Runs) -> Runs {
        let joints = &runs.firsts;
        let mut longer = Runs {
            firsts: Vec::new(),
            deviation: runs.deviation,
        };
        let last = joints.len() - 1;
        let mut first = 0;
        while first < last {
            // The longest run that is known to fit, and the shortest known not to.
            let (mut fits, mut too_long) = (1, last - first + 1);
            let mut next = 2;
            while fits + 1 < too_long {
                match self.deviation_within(joints[first]..joints[first + next]) {
                    Some(deviation) => {
                        longer.deviation = longer.deviation.max(deviation);
                        fits = next;
                    }
                    None => too_long = next,
                }
                next = (2 * fits).min((fits + too_long) / 2);
            }
            longer.firsts.push(joints[first]);
            first += fits;
        }
        longer.firsts.push(joints[last]);
        longer
    }

    /// The deviation of spans as one run, as counted; `None` where it is above the allowance, where
    /// a span leads back along the run, which it could then leave at an end, or where all are
    /// translations.
    fn deviation_within(&self, spans: Range<usize>) -> Option<f64> {
        let is_translation = |span| (self.generator)(span).linear == DMat3::ZERO;
        if spans.clone().all(is_translation) {
            return None;
        }
        let one = self.as_one(&spans)?;
        let counted = 2.0 * one.deviation;
        let leads_back = one.shares.iter().any(|&share| share < 0.0);
        (!leads_back && counted <= self.allowance).then_some(counted)
    }

    /// Adds the spans as one run, or in halves where their deviation is above rounding.
    fn settle(&self, spans: Range<usize>, runs: &mut Runs) {
        let mut parts = vec![spans];
        while let Some(part) = parts.pop() {
            if let Some(deviation) = self.deviation(&part) {
                runs.firsts.push(part.start);
                runs.deviation = runs.deviation.max(deviation);
            } else {
                let middle = part.start + part.len() / 2;
                parts.extend([middle..part.end, part.start..middle]);
            }
        }
    }

    /// Whether a span continues the motion of those from `first` on, whose sum is `sum`.
    fn goes_on(&self, first: usize, sum: &Generator, span: usize) -> bool {
        let (pose, next) = ((self.joint)(span), (self.generator)(span));
        if self.pace == Pace::Even && sum.size() + next.size() > MERGED_TURN {
            return false;
        }
        let places = || {
            self.corners
                .iter()
                .map(|&corner| pose.transform_point3(corner))
        };
        let velocities = || places().map(|place| [next.velocity(place), sum.velocity(place)]);
        let share = match self.pace {
            Pace::Even => {
                let [start, joint, end] = [first, span, span + 1].map(|joint| self.times[joint]);
                (end - joint) / (joint - start)
            }
            Pace::Any => {
                let products =
                    velocities().map(|[new, old]| [new.dot(old), old.dot(old), new.dot(new)]);
                let [along, old, new] = products.fold([0.0; 3], |sums, products| {
                    std::array::from_fn(|i| sums[i] + products[i])
                });
                if old == 0.0 || new == 0.0 {
                    return true;
                }
                along / old
            }
        };
        let gap = velocities().map(|[new, old]| (new - old * share).length());
        let largest = places().map(|place| place.abs().max_element());
        share > 0.0 && gap.fold(0.0, f64::max) <= self.limit(&next) * largest.fold(0.0, f64::max)
    }

    /// Largest deviation of a run, over the largest coordinate.
    fn limit(&self, generator: &Generator) -> f64 {
        match self.pace {
            Pace::Any => SAME_POSE,
            Pace::Even => MERGED_ROUNDING * UNIT_ROUNDOFF * (1.0 + generator.size()),
        }
    }

    /// The deviation of spans as one run; `None` where it is above rounding.
    fn deviation(&self, spans: &Range<usize>) -> Option<f64> {
        if spans.len() == 1 {
            return Some(0.0);
        }
        let one = self.as_one(spans)?;
        (one.deviation <= self.limit(&one.generator) * one.reach).then_some(one.deviation)
    }

    /// Spans as one run; `None` where it leaves the range of f64.
    fn as_one(&self, spans: &Range<usize>) -> Option<AsOne> {
        let whole = self.sum(spans);
        let flow = Flow::new(whole);
        if ![1.0, -1.0]
            .into_iter()
            .all(|time| flow.pose_at(time).is_finite())
        {
            return None;
        }
        let start = (self.joint)(spans.start);
        let shares = self.shares(spans, &whole);
        let (mut deviation, mut largest, mut before) = (0.0_f64, 0.0_f64, 0.0);
        for (span, &share) in spans.clone().zip(&shares) {
            let (given, merged) = ((self.joint)(span), flow.pose_at(before) * start);
            let generator = (self.generator)(span);
            let difference = Generator {
                linear: generator.linear - whole.linear * share,
                offset: generator.offset - whole.offset * share,
            };
            let growth = growth(&generator).max(growth(&whole) * share).exp();
            for &corner in self.corners {
                let place = given.transform_point3(corner);
                let apart = place.distance(merged.transform_point3(corner));
                let turned = difference.size() * generator.velocity(place).length() * growth;
                let along = apart + difference.velocity(place).length() + turned;
                // NaN is no bound.
                deviation = if along.is_nan() {
                    f64::INFINITY
                } else {
                    deviation.max(growth * along)
                };
                largest = largest.max(place.abs().max_element());
            }
            before += share;
        }
        Some(AsOne {
            generator: whole,
            shares,
            deviation,
            reach: largest,
        })
    }

    /// The generator of a whole run.
    pub(super) fn sum(&self, spans: &Range<usize>) -> Generator {
        let mut sum = Sum::new();
        spans
            .clone()
            .for_each(|span| sum.add(&(self.generator)(span)));
        sum.total()
    }

    /// The shares of the spans of a run in the whole: they add up to 1, or are 0 where nothing
    /// moves.
    pub(super) fn shares(&self, spans: &Range<usize>, whole: &Generator) -> Vec<f64> {
        let parts: Vec<f64> = spans
            .clone()
            .map(|span| match self.pace {
                Pace::Even => self.times[span + 1] - self.times[span],
                Pace::Any => {
                    let (pose, generator) = ((self.joint)(span), (self.generator)(span));
                    let places = self
                        .corners
                        .iter()
                        .map(|&corner| pose.transform_point3(corner));
                    let both =
                        places.map(|place| [generator.velocity(place), whole.velocity(place)]);
                    let [along, square] = both.fold([0.0; 2], |[along, square], [part, whole]| {
                        [along + part.dot(whole), square + whole.dot(whole)]
                    });
                    if square == 0.0 { 0.0 } else { along / square }
                }
            })
            .collect();
        let sum: f64 = parts.iter().sum();
        if sum == 0.0 {
            return parts;
        }
        parts.into_iter().map(|part| part / sum).collect()
    }
}

/// |exp(sM)| <= e^growth for s in [0, 1].
fn growth(generator: &Generator) -> f64 {
    let linear = (generator.linear + generator.linear.transpose()) * 0.5;
    Generator {
        linear,
        ..*generator
    }
    .size()
}

/// A sum of generators with only one rounding (Neumaier).
struct Sum {
    high: [f64; 12],
    low: [f64; 12],
}

impl Sum {
    fn new() -> Sum {
        Sum {
            high: [0.0; 12],
            low: [0.0; 12],
        }
    }

    fn add(&mut self, generator: &Generator) {
        let rows = generator.rows();
        for (entry, &new) in rows.as_flattened().iter().enumerate() {
            let old = self.high[entry];
            let sum = old + new;
            self.low[entry] += if old.abs() >= new.abs() {
                (old - sum) + new
            } else {
                (new - sum) + old
            };
            self.high[entry] = sum;
        }
    }

    fn total(&self) -> Generator {
        let entry =
            |row: usize, column: usize| self.high[4 * row + column] + self.low[4 * row + column];
        let column = |column: usize| DVec3::from_array([0, 1, 2].map(|row| entry(row, column)));
        Generator {
            linear: DMat3::from_cols(column(0), column(1), column(2)),
            offset: column(3),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{HalfTurns, Keyframe, Motion, Sense, Span};
    use std::f64::consts::TAU;

    fn corners() -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let side = |bit: usize, low: f64, high: f64| if i >> bit & 1 == 0 { low } else { high };
            DVec3::new(side(0, 1.0, 2.0), side(1, -1.0, 1.0), side(2, 0.0, 3.0))
        })
    }

    fn screw(turn: f64, advance: f64) -> Generator {
        Generator::screw(DVec3::new(0.48, 0.6, 0.64), DVec3::X, turn, advance, 1.0)
    }

    /// Keyframes of a generator at the given shares of it and times.
    fn keyed(generator: &Generator, shares: &[f64], times: &[f64]) -> Motion {
        let flow = Flow::new(*generator);
        let keys: Vec<Keyframe> = shares
            .iter()
            .zip(times)
            .map(|(&share, &time)| Keyframe {
                time,
                pose: flow.pose_at(share),
            })
            .collect();
        Motion::from_keyframes_turning(&keys, &HalfTurns::All(Sense::Positive)).expect("legal")
    }

    fn runs(motion: &Motion, pace: Pace) -> Runs {
        runs_within(motion, pace, 0.0)
    }

    fn runs_within(motion: &Motion, pace: Pace, allowance: f64) -> Runs {
        let chain = Chain {
            times: motion.joint_times(),
            generator: Box::new(|span| *motion.spans()[span].flow().generator()),
            joint: Box::new(|joint| motion.joints()[joint]),
            corners: &corners(),
            pace,
            allowance,
        };
        chain.runs()
    }

    fn even(count: u32, end: f64) -> Vec<f64> {
        (0..=count)
            .map(|i| end * f64::from(i) / f64::from(count))
            .collect()
    }

    #[test]
    fn keyframes_of_one_generator_are_one_run() {
        let general = Generator {
            linear: DMat3::from_cols_array(&[0.3, 2.0, -0.4, -1.7, -0.5, 0.6, 0.2, -0.9, 0.1]),
            offset: DVec3::new(0.4, -0.7, 0.5),
        };
        let cases = [
            ("screw", screw(0.9 * TAU, 3.0)),
            (
                "translation",
                Generator::translation(DVec3::new(1.0, -2.0, 0.1)),
            ),
            ("rest", Generator::translation(DVec3::ZERO)),
            ("general", general),
        ];
        for (name, generator) in cases {
            for count in [2, 3, 200] {
                let shares = even(count, 1.0);
                let motion = keyed(&generator, &shares, &even(count, 5.0));
                for pace in [Pace::Any, Pace::Even] {
                    let found = runs(&motion, pace);
                    assert_eq!(
                        found.firsts,
                        [0, shares.len() - 1],
                        "{name} {count} {pace:?}"
                    );
                    assert!(found.deviation < 1e-13, "{name}: {:e}", found.deviation);
                }
            }
        }
    }

    #[test]
    fn other_speeds_are_one_run_for_those_who_do_not_ask_when() {
        let shares = [0.0, 0.1, 0.1, 0.5, 0.6, 1.0];
        let times = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        let motion = keyed(&screw(3.0, 3.0), &shares, &times);
        assert_eq!(
            runs(&motion, Pace::Any).firsts,
            [0, 5],
            "a rest in between, too"
        );
        assert_eq!(runs(&motion, Pace::Even).firsts, [0, 1, 2, 3, 4, 5]);
        // The first two and the last two have the same pace.
        let times = [0.0, 1.0, 2.0, 3.0, 3.25, 4.25];
        let motion = keyed(&screw(3.0, 3.0), &shares, &times);
        assert_eq!(runs(&motion, Pace::Even).firsts, [0, 1, 2, 5]);
    }

    #[test]
    fn what_turns_back_or_aside_is_another_run() {
        let shares = [0.0, 0.3, 0.6, 0.4, 0.2, 0.5, 0.8];
        let motion = keyed(&screw(3.0, 3.0), &shares, &even(6, 6.0));
        assert_eq!(
            runs(&motion, Pace::Any).firsts,
            [0, 2, 4, 6],
            "there and back"
        );
        // The deviation is a millionth of a millionth of the size, or a little more.
        for (aside, expected) in [(1e-10, vec![0, 1, 2]), (1e-13, vec![0, 2])] {
            let spans = [0.0, aside].map(|aside| {
                let way = Generator::translation(DVec3::new(1.0, aside, 0.0));
                Span::new(way, 1.0).expect("legal")
            });
            let motion = Motion::from_spans(spans.to_vec()).expect("legal");
            assert_eq!(runs(&motion, Pace::Any).firsts, expected, "{aside:e}");
        }
    }

    #[test]
    fn even_runs_end_after_a_turn_or_so() {
        let spans = vec![Span::new(screw(0.1 * TAU, 0.0), 1.0).expect("legal"); 100];
        let motion = Motion::from_spans(spans).expect("legal");
        assert_eq!(runs(&motion, Pace::Any).firsts, [0, 100], "ten turns");
        let firsts = runs(&motion, Pace::Even).firsts;
        assert!((8..12).contains(&firsts.len()), "{firsts:?}");
    }

    /// A path that bends so little that each span looks like the next.
    #[test]
    fn a_slow_bend_is_cut_where_it_leaves_its_chord() {
        let step = |i: u32| DVec3::new(1.0, 1e-13 * f64::from(i), 0.0) * 1e-2;
        let spans = (0..4000)
            .map(|i| Span::new(Generator::translation(step(i)), 1.0).expect("legal"))
            .collect();
        let motion = Motion::from_spans(spans).expect("legal");
        let found = runs(&motion, Pace::Any);
        assert!(
            (4..1000).contains(&found.firsts.len()),
            "{} runs",
            found.firsts.len()
        );
        // The sum of the chain departs from the chord of each run by at most the reported
        // deviation.
        for pair in found.firsts.windows(2) {
            let [from, to] = [pair[0], pair[1]].map(|joint| motion.joints()[joint].translation);
            for joint in pair[0]..=pair[1] {
                let place = motion.joints()[joint].translation;
                let way = (to - from).normalize();
                let off = (place - from).reject_from_normalized(way).length();
                assert!(
                    off <= found.deviation + 1e-14,
                    "{off:e} > {:e}",
                    found.deviation
                );
            }
        }
    }

    /// Keyframes of a path whose generator changes all the time.
    fn bent(count: u32) -> Motion {
        let pose = |s: f64| {
            let axis = DVec3::new(s.sin(), (1.3 * s).cos(), 0.5).normalize();
            let turn = glam::DQuat::from_axis_angle(axis, 1.8 * s);
            let place = DVec3::new(4.0 * s, (3.0 * s).sin(), (2.0 * s).cos());
            DAffine3::from_rotation_translation(turn, place)
        };
        let start = pose(0.0).inverse();
        let keys: Vec<Keyframe> = (0..=count)
            .map(|key| f64::from(key) / f64::from(count))
            .map(|time| Keyframe {
                time,
                pose: pose(time) * start,
            })
            .collect();
        Motion::from_keyframes(&keys).expect("legal")
    }

    /// The expectation, stated before the test ran: the gap between a path and its runs grows with
    /// the square of their length, so that a hundredth of the allowance gives ten times as many
    /// runs, whatever the number of keyframes.
    #[test]
    fn a_smooth_path_has_the_runs_of_the_path_not_of_its_keyframes() {
        let count = |keys: u32, allowance: f64| {
            runs_within(&bent(keys), Pace::Any, allowance).firsts.len() - 1
        };
        let coarse = [2_000, 8_000].map(|keys| count(keys, 1e-2));
        assert!(coarse[0].abs_diff(coarse[1]) <= 3, "{coarse:?}");
        let ratio = count(8_000, 1e-4) as f64 / coarse[1] as f64;
        assert!((6.0..14.0).contains(&ratio), "{coarse:?}, times {ratio}");
    }

    /// Points of the body moved by the chain are within the reported deviation of their paths by
    /// the runs, and the runs within that of the chain: half of the deviation each way, found by
    /// dense sampling.
    #[test]
    fn the_deviation_of_longer_runs_bounds_the_distance_of_paths() {
        let motion = bent(300);
        for allowance in [1e-1, 1e-2, 1e-3] {
            let found = motion.merged_within(&corners(), allowance);
            assert!(found.deviation <= allowance, "{:e}", found.deviation);
            let merged = &found.motion;
            assert!(merged.spans().len() < 150, "{}", merged.spans().len());
            let corner = corners()[5];
            let mut seen = 0.0_f64;
            for (run, span) in merged.spans().iter().enumerate() {
                let start = merged.joints()[run].transform_point3(corner);
                let path = |share: f64| span.flow().pose_at(share).transform_point3(start);
                let steps = 400 * found.spans_of(run).len();
                let polyline: Vec<DVec3> =
                    (0..=steps).map(|i| path(i as f64 / steps as f64)).collect();
                for part in found.spans_of(run) {
                    let flow = motion.spans()[part].flow();
                    let at = motion.joints()[part].transform_point3(corner);
                    for share in [0.0, 0.3, 0.6, 1.0] {
                        let place = flow.pose_at(share).transform_point3(at);
                        let gaps = polyline.iter().map(|p| p.distance(place));
                        seen = seen.max(gaps.fold(f64::INFINITY, f64::min));
                    }
                }
            }
            // The samples of a run are some 1e-4 apart.
            assert!(seen <= 0.5 * found.deviation + 1e-4, "{seen:e}");
            assert!(seen >= 0.02 * found.deviation, "not idle: {seen:e}");
        }
    }

    #[test]
    fn translations_and_what_turns_back_are_not_taken_for_one() {
        let zigzag = |i: u32| DVec3::new(1.0, 1e-3 * f64::from(i % 3), 0.0) * 1e-2;
        let spans = (0..50)
            .map(|i| Span::new(Generator::translation(zigzag(i)), 1.0).expect("legal"))
            .collect();
        let motion = Motion::from_spans(spans).expect("legal");
        let found = runs_within(&motion, Pace::Any, 1.0);
        assert_eq!(found, runs(&motion, Pace::Any), "exact as they are");
        // A small step back, within the allowance, from the end of a run.
        let shares = [0.0, 0.3, 0.6, 0.59, 0.58];
        let motion = keyed(&screw(3.0, 3.0), &shares, &even(4, 4.0));
        let found = runs_within(&motion, Pace::Any, 1.0);
        assert_eq!(found.firsts, [0, 2, 4], "there and back");
    }

    #[test]
    fn the_deviation_bounds_what_keys_of_fewer_digits_are_off_by() {
        let flow = Flow::new(screw(2.0, 1.0));
        let round = |x: f64| (x * 1e13).round() / 1e13;
        let keys: Vec<Keyframe> = (0..=20)
            .map(|i: u32| {
                let pose = flow.pose_at(f64::from(i) / 20.0);
                let rounded = pose.to_cols_array().map(round);
                Keyframe {
                    time: f64::from(i),
                    pose: DAffine3::from_cols_array(&rounded),
                }
            })
            .collect();
        let motion = Motion::from_keyframes(&keys).expect("legal");
        let found = runs(&motion, Pace::Any);
        assert_eq!(found.firsts, [0, 20], "thirteen digits are one run");
        let whole = Flow::new(
            *motion.merged(&corners(), Pace::Any).motion.spans()[0]
                .flow()
                .generator(),
        );
        let mut seen = 0.0_f64;
        for step in 0..=2000 {
            let time = f64::from(step) / 100.0;
            let given = motion.pose_at_time(time) * motion.start_pose().inverse();
            for corner in corners() {
                let place = given.transform_point3(corner);
                seen =
                    seen.max(place.distance(whole.pose_at(time / 20.0).transform_point3(corner)));
            }
        }
        assert!(seen <= found.deviation, "{seen:e} > {:e}", found.deviation);
        assert!(
            found.deviation < 20.0 * seen,
            "{:e} for {seen:e}",
            found.deviation
        );
    }
}
