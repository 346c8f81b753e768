//! The events on the path of a point: it meets the surface of the body.

/// A time, or a stretch of time, at which the path of a point meets a triangle, within rounding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Event {
    /// The whole event lies in this window, whatever the rounding.
    pub(super) window: [f64; 2],
    /// The first and the last time on the triangle.
    pub(super) times: [f64; 2],
    /// The change of the winding number, if this is certainly one crossing of the interior of one
    /// triangle.
    pub(super) change: Option<i32>,
}

/// Unites events whose windows overlap. The result is in order of time, within [0, 1], with gaps
/// between the windows.
///
/// An event that reaches the end of the span is extended to it: whether anything lies in between
/// cannot be decided.
pub(super) fn unite(events: &mut Vec<Event>) {
    events.sort_by(|a, b| {
        a.window[0]
            .total_cmp(&b.window[0])
            .then(a.window[1].total_cmp(&b.window[1]))
    });
    events.dedup_by(|next, last| {
        let overlap = next.window[0] <= last.window[1];
        if overlap {
            last.window[1] = last.window[1].max(next.window[1]);
            last.times = [
                last.times[0].min(next.times[0]),
                last.times[1].max(next.times[1]),
            ];
            last.change = last.change.zip(next.change).map(|(a, b)| a + b);
        }
        overlap
    });
    for event in events {
        if event.window[0] <= 0.0 {
            (event.window[0], event.times[0]) = (0.0, 0.0);
        }
        if event.window[1] >= 1.0 {
            (event.window[1], event.times[1]) = (1.0, 1.0);
        }
    }
}
