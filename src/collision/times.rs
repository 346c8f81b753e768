//! Sets of times: disjoint closed intervals in ascending order.

/// Closed intervals of time, ascending, with gaps between them.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Times {
    all: Vec<[f64; 2]>,
    /// Gaps no longer than this are closed.
    least_gap: f64,
}

impl Times {
    /// The empty set; gaps up to `least_gap` will be closed.
    pub(super) fn none(least_gap: f64) -> Times {
        Times {
            all: Vec::new(),
            least_gap,
        }
    }

    /// The intervals.
    pub(super) fn intervals(&self) -> &[[f64; 2]] {
        &self.all
    }

    /// Adds an interval.
    pub(super) fn add(&mut self, [start, end]: [f64; 2]) {
        let end = end.max(start);
        let first = self
            .all
            .partition_point(|known| known[1] + self.least_gap < start);
        let last = self
            .all
            .partition_point(|known| known[0] - self.least_gap <= end);
        let mut merged = [start, end];
        for known in &self.all[first..last] {
            merged = [merged[0].min(known[0]), merged[1].max(known[1])];
        }
        self.all.splice(first..last, [merged]);
    }

    /// The part of an interval that is not covered by the set at its start and at its end.
    pub(super) fn rest_of(&self, [mut start, mut end]: [f64; 2]) -> Option<[f64; 2]> {
        for known in &self.all {
            if known[0] <= start && start <= known[1] {
                start = known[1];
            }
            if known[0] <= end && end <= known[1] {
                end = known[0];
            }
        }
        (start < end || (start == end && !self.holds(start))).then_some([start, end])
    }

    fn holds(&self, time: f64) -> bool {
        self.all
            .iter()
            .any(|known| known[0] <= time && time <= known[1])
    }

    /// The gaps within [0, 1].
    pub(super) fn gaps(&self) -> Vec<[f64; 2]> {
        let starts = [0.0]
            .into_iter()
            .chain(self.all.iter().map(|known| known[1]));
        let ends = self.all.iter().map(|known| known[0]).chain([1.0]);
        starts
            .zip(ends)
            .filter(|(start, end)| start < end)
            .map(|(start, end)| [start, end])
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_united_and_small_gaps_closed() {
        let mut times = Times::none(1e-9);
        times.add([0.5, 0.6]);
        times.add([0.1, 0.2]);
        times.add([0.2 + 1e-10, 0.3]);
        times.add([0.9, 0.9]);
        assert_eq!(times.intervals(), [[0.1, 0.3], [0.5, 0.6], [0.9, 0.9]]);
        assert_eq!(
            times.gaps(),
            [[0.0, 0.1], [0.3, 0.5], [0.6, 0.9], [0.9, 1.0]]
        );
        times.add([0.0, 0.55]);
        assert_eq!(times.intervals(), [[0.0, 0.6], [0.9, 0.9]]);
    }

    #[test]
    fn what_is_known_is_cut_off_at_both_ends() {
        let mut times = Times::none(0.0);
        times.add([0.2, 0.4]);
        times.add([0.6, 0.7]);
        assert_eq!(times.rest_of([0.3, 0.65]), Some([0.4, 0.6]));
        assert_eq!(
            times.rest_of([0.1, 0.9]),
            Some([0.1, 0.9]),
            "both ends are open"
        );
        assert_eq!(times.rest_of([0.25, 0.35]), None, "known");
        assert_eq!(times.rest_of([0.5, 0.5]), Some([0.5, 0.5]), "an instant");
    }
}
