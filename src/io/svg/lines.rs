//! The line numbers of the bytes of a text.

/// Where the lines of a text end.
pub(super) struct Lines(Vec<usize>);

impl Lines {
    pub(super) fn of(text: &str) -> Lines {
        Lines(text.match_indices('\n').map(|(place, _)| place).collect())
    }

    /// The line that contains a byte, counted from 1. O(log n); the parser would read the text from
    /// its start.
    pub(super) fn at(&self, byte: usize) -> usize {
        1 + self.0.partition_point(|&end| end < byte)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_of_a_line_belongs_to_it() {
        let lines = Lines::of("ab\n\nc");
        let found: Vec<usize> = (0..5).map(|byte| lines.at(byte)).collect();
        assert_eq!(found, [1, 1, 1, 2, 3]);
    }
}
