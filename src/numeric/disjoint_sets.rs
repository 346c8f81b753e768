//! Disjoint sets of numbers (union-find).

use super::index;

/// The numbers below a count in disjoint sets, at first each number in a set of its own.
///
/// The least number of a set represents it. So the resulting sets do not depend on the order in
/// which they were joined, and neither does any numbering by them.
#[derive(Debug, Clone)]
pub(crate) struct DisjointSets {
    /// Per number, another one of its set that is not greater; itself when it is the least.
    parent: Vec<u32>,
}

impl DisjointSets {
    /// `count` sets of one number.
    pub(crate) fn new(count: usize) -> DisjointSets {
        DisjointSets {
            parent: (0..index(count)).collect(),
        }
    }

    /// The least number of the set of a number. O(log n) amortised.
    pub(crate) fn first(&mut self, mut number: u32) -> u32 {
        while self.parent[number as usize] != number {
            // Path halving: every second number on the path skips a step from now on.
            let up = self.parent[self.parent[number as usize] as usize];
            self.parent[number as usize] = up;
            number = up;
        }
        number
    }

    /// Joins the sets of two numbers, and returns whether they were different.
    pub(crate) fn join(&mut self, one: u32, other: u32) -> bool {
        let (one, other) = (self.first(one), self.first(other));
        self.parent[one.max(other) as usize] = one.min(other);
        one != other
    }

    /// Per number, the least one of its set.
    pub(crate) fn firsts(mut self) -> Vec<u32> {
        for number in 0..self.parent.len() {
            // A parent is not greater, so that its own entry is already the least of the set.
            self.parent[number] = self.parent[self.parent[number] as usize];
        }
        self.parent
    }

    /// The sets in the order of their least numbers; the numbers of each are ascending.
    pub(crate) fn groups(self) -> Vec<Vec<u32>> {
        let mut groups: Vec<Vec<u32>> = Vec::new();
        let mut group_of = self.firsts();
        for number in 0..group_of.len() {
            let first = group_of[number] as usize;
            // The first number of a set comes before the others: by then its entry holds the number
            // of its group.
            let group = if first == number {
                groups.push(Vec::new());
                index(groups.len() - 1)
            } else {
                group_of[first]
            };
            group_of[number] = group;
            groups[group as usize].push(index(number));
        }
        groups
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::random_below;

    /// Compares numbers that are joined pseudo-randomly with a naive version that relabels every
    /// number.
    #[test]
    fn sets_are_those_of_relabelling_everything() {
        let count = 60;
        let mut below = random_below(1);
        let mut random = move || u32::try_from(below(count)).expect("a small number");
        let mut sets = DisjointSets::new(60);
        let mut label: Vec<u32> = (0..60).collect();
        for _ in 0..45 {
            let (one, other) = (random(), random());
            let [a, b] = [one, other].map(|number| label[number as usize]);
            assert_eq!(sets.join(one, other), a != b, "joined {one} and {other}");
            let relabel =
                |known: &mut u32| *known = if *known == a.max(b) { a.min(b) } else { *known };
            label.iter_mut().for_each(relabel);
            for number in 0..60 {
                assert_eq!(sets.first(number), label[number as usize], "of {number}");
            }
        }
        assert_eq!(sets.clone().firsts(), label);
        let groups = sets.groups();
        assert!(groups.is_sorted_by_key(|group| group[0]), "by the first");
        for group in &groups {
            let members = (0..60u32).filter(|&number| label[number as usize] == group[0]);
            assert!(members.eq(group.iter().copied()), "{group:?}");
        }
        assert_eq!(
            groups.iter().map(Vec::len).sum::<usize>(),
            60,
            "all of them"
        );
    }
}
