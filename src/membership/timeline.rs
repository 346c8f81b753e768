//! From the events on the path of a point to the times during which it is inside.

use super::event::{Event, unite};
use super::path::{Path, SpanPaths, Stretch};
use crate::motion::Merged;
use crate::numeric::tolerance::JOINT_GAP;
use glam::DVec3;

/// A body at rest, prepared to be crossed by paths.
pub(super) trait Resting {
    /// Appends every event between the path over a window and the boundary.
    fn meet(&self, stretch: &Stretch, found: &mut Vec<Event>);
    /// How many times the boundary winds around a point, or `None` on the boundary. Exact.
    fn winding_number(&self, point: DVec3) -> Option<i32>;
}

/// The paths of all points over a motion, span by span, on its clock.
#[derive(Debug)]
pub(super) struct Timeline {
    pub(super) spans: Vec<SpanPaths>,
    pub(super) joint_times: Vec<f64>,
    /// Per span, the longest absences that are ignored at its start and at its end; see [`gaps`].
    pub(super) gaps: Vec<[f64; 2]>,
}

/// The longest absences that are ignored at the start and at the end of each run, in clock time:
/// [`JOINT_GAP`] of the spans there.
///
/// - `times`: clock times of the joints of the motion itself.
pub(super) fn gaps<M: Clone>(merged: &Merged<'_, M>, times: &[f64]) -> Vec<[f64; 2]> {
    let mut gaps = Vec::new();
    let mut end = 0;
    while end + 1 < times.len() {
        let spans = merged.spans_of(gaps.len());
        let length = |span: usize| JOINT_GAP * (times[span + 1] - times[span]);
        gaps.push([length(spans.start), length(spans.end - 1)]);
        end = spans.end;
    }
    gaps
}

impl Timeline {
    /// The closed time intervals during which a point is in the closed body.
    pub(super) fn intervals(&self, body: &impl Resting, point: DVec3) -> Vec<[f64; 2]> {
        let mut intervals = Vec::new();
        for span in 0..self.spans.len() {
            self.append_span(body, span, point, &mut intervals);
        }
        intervals
    }

    /// Whether there is any such interval.
    pub(super) fn is_ever_inside(&self, body: &impl Resting, point: DVec3) -> bool {
        let mut intervals = Vec::new();
        (0..self.spans.len()).any(|span| {
            self.append_span(body, span, point, &mut intervals);
            !intervals.is_empty()
        })
    }

    /// Appends the intervals within one span, and unites them with those that end where they begin.
    fn append_span(
        &self,
        body: &impl Resting,
        span: usize,
        point: DVec3,
        intervals: &mut Vec<[f64; 2]>,
    ) {
        if !point.is_finite() {
            return;
        }
        let path = self.spans[span].path(point);
        let events = self.events(body, span, &path);
        let mut append = |[start, end]: [f64; 2]| {
            let [start, end] = [self.clock(span, start), self.clock(span, end)];
            match intervals.last_mut() {
                Some(last) if start <= last[1] || self.is_joint_gap(span, [last[1], start]) => {
                    last[1] = last[1].max(end);
                }
                _ => intervals.push([start, end]),
            }
        };

        let mut winding = None;
        let mut piece_start = [0.0; 2];
        for index in 0..=events.len() {
            let event = events.get(index);
            let piece_end = event.map_or([1.0; 2], |event| [event.window[0], event.times[0]]);
            // There is no piece before an event at the very start, or after one at the very end.
            if piece_end[0] > piece_start[0] || events.is_empty() {
                let middle = piece_start[0] + (piece_end[0] - piece_start[0]) / 2.0;
                let inside = match winding {
                    Some(winding) => winding >= 1,
                    None => {
                        winding = body.winding_number(path.at(middle));
                        winding.is_none_or(|winding| winding >= 1)
                    }
                };
                debug_assert_eq!(
                    inside,
                    body.winding_number(path.at(middle))
                        .is_none_or(|winding| winding >= 1),
                    "carried winding number {winding:?} of {point} at {middle} of span {span}"
                );
                if inside {
                    append([piece_start[1], piece_end[1]]);
                }
            }
            if let Some(event) = event {
                append(event.times);
                winding = winding
                    .zip(event.change)
                    .map(|(winding, change)| winding + change);
                piece_start = [event.window[1], event.times[1]];
            }
        }
    }

    /// All events of the point in a span, in order.
    fn events(&self, body: &impl Resting, span: usize, path: &Path) -> Vec<Event> {
        let mut events = Vec::new();
        let mut start = path.tabulated(0);
        for window in 0..self.spans[span].windows() {
            let end = path.tabulated(2 * window + 2);
            body.meet(&path.window(window, start, end), &mut events);
            start = end;
        }
        unite(&mut events);
        events
    }

    /// Whether the two ends of a gap are so near the start of a span that they cannot be
    /// distinguished from it.
    fn is_joint_gap(&self, span: usize, [leaves, returns]: [f64; 2]) -> bool {
        let joint = self.joint_times[span];
        span > 0
            && joint - leaves <= self.gaps[span - 1][1]
            && returns - joint <= self.gaps[span][0]
    }

    /// The time on the motion's clock for a time within a span; exact at the joints.
    fn clock(&self, span: usize, time: f64) -> f64 {
        let (start, end) = (self.joint_times[span], self.joint_times[span + 1]);
        if time >= 1.0 {
            end
        } else {
            (start + time * (end - start)).min(end)
        }
    }
}
