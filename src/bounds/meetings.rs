//! All pairs of triangles of a surface that meet elsewhere than in what they have in common.

use super::corners::{boxes_meet, triangle_box};
use super::meeting::{Meeting, meeting};
use super::tree::{Content, SurfaceTree};
use crate::watch::{Interrupted, Work, unwatched};
use rayon::prelude::*;

/// Pairs of nodes that are shared out to threads: enough to balance them.
const TASKS: usize = 4096;

/// Two triangles, the one with the smaller number first, and how they meet.
pub type MeetingPair = ([u32; 2], Meeting);

impl SurfaceTree {
    /// The pairs of triangles that meet elsewhere than in common corners and edges, ascending.
    ///
    /// # Guarantee
    /// Exact on the coordinates as they are, unless products of three of their differences leave the
    /// range of `f64`. Triangles have in common the corners with the same index. A triangle without
    /// area is in no pair: in a closed surface, the neighbours at its sides are. The result is the
    /// same for any number of threads.
    pub fn meetings(&self) -> Vec<MeetingPair> {
        unwatched(|work| self.meetings_during(work))
    }

    /// [`SurfaceTree::meetings`] as part of the work of a run.
    pub(crate) fn meetings_during(&self, work: Work) -> Result<Vec<MeetingPair>, Interrupted> {
        let mut found = Vec::new();
        let mut tasks = Vec::from_iter(self.nodes().first().map(|_| [0, 0]));
        while (1..TASKS).contains(&tasks.len()) {
            let mut parts = Vec::new();
            for task in tasks {
                work.check()?;
                self.descend(task, &mut parts, &mut found);
            }
            tasks = parts;
        }
        let items = work.items(tasks.len());
        let more = tasks.par_iter().map(|&task| {
            items.next()?;
            let (mut open, mut found) = (vec![task], Vec::new());
            while let Some(nodes) = open.pop() {
                work.check()?;
                self.descend(nodes, &mut open, &mut found);
            }
            Ok(found)
        });
        let more: Vec<Vec<MeetingPair>> = more.collect::<Result<_, Interrupted>>()?;
        found.extend(more.into_iter().flatten());
        found.sort_unstable();
        Ok(found)
    }

    /// Adds the pairs of parts of two nodes whose boxes meet, or those of their triangles that
    /// meet. The two nodes may be the same one.
    fn descend(
        &self,
        [one, other]: [u32; 2],
        parts: &mut Vec<[u32; 2]>,
        found: &mut Vec<MeetingPair>,
    ) {
        let node = |number: u32| &self.nodes()[number as usize];
        let mut add = |pair: [u32; 2]| {
            let [a, b] = pair.map(node);
            if a.meets(b) {
                parts.push(pair);
            }
        };
        match [one, other].map(|number| self.content(node(number))) {
            [Content::Children([left, right]), _] if one == other => {
                [[left, left], [left, right], [right, right]]
                    .into_iter()
                    .for_each(add);
            }
            [Content::Children(here), Content::Children(there)] => {
                here.into_iter()
                    .for_each(|a| there.into_iter().for_each(|b| add([a, b])));
            }
            [Content::Children(here), Content::Triangles(_)] => {
                here.into_iter().for_each(|a| add([a, other]));
            }
            [Content::Triangles(_), Content::Children(there)] => {
                there.into_iter().for_each(|b| add([one, b]));
            }
            [Content::Triangles(here), Content::Triangles(there)] => {
                for (place, &a) in here.iter().enumerate() {
                    let there = if one == other { &there[..place] } else { there };
                    there
                        .iter()
                        .for_each(|&b| self.examine([a.min(b), a.max(b)], found));
                }
            }
        }
    }

    /// Adds a pair of triangles if it meets.
    fn examine(&self, pair: [u32; 2], found: &mut Vec<MeetingPair>) {
        let [one, other] = pair.map(|triangle| triangle_box(self.corners(triangle)));
        if boxes_meet(one, other) {
            let triangles = pair.map(|triangle| self.triangles()[triangle as usize]);
            let meeting = meeting(self.positions(), triangles);
            found.extend(meeting.map(|meeting| (pair, meeting)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::{cuboid, drum, random_below};
    use glam::DVec3;

    /// All pairs, one by one.
    fn by_all_pairs(positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<MeetingPair> {
        let mut found = Vec::new();
        for (b, &second) in (0..).zip(triangles) {
            for (a, &first) in (0..b).zip(triangles) {
                let meeting = meeting(positions, [first, second]);
                found.extend(meeting.map(|meeting| ([a, b], meeting)));
            }
        }
        found.sort_unstable();
        found
    }

    #[test]
    fn a_soup_meets_where_all_pairs_do() {
        let mut below = random_below(5);
        for (vertices, width, count) in [(400, 1 << 20, 2000), (200, 8, 300), (30, 3, 60)] {
            let mut number = |limit: u64| u32::try_from(below(limit)).expect("small");
            let positions: Vec<DVec3> = (0..vertices)
                .map(|_| [(); 3].map(|()| f64::from(number(width))).into())
                .collect();
            // Most are small, so that the tree matters.
            let triangles: Vec<[u32; 3]> = (0..count)
                .map(|_| [(); 3].map(|()| number(vertices)))
                .filter(|[a, b, c]| a != b && b != c && c != a)
                .collect();
            let expected = by_all_pairs(&positions, &triangles);
            let found = SurfaceTree::new(&positions, &triangles).meetings();
            assert_eq!(found, expected, "{vertices} vertices on a grid of {width}");
            assert!(found.len() > 100, "enough of them");
        }
    }

    #[test]
    fn the_surface_of_a_body_does_not_meet_itself() {
        let body = drum(40, 30);
        let tree = SurfaceTree::new(body.positions(), body.triangles());
        assert_eq!(tree.meetings(), []);
        assert_eq!(
            SurfaceTree::new(&[], &[]).meetings(),
            [],
            "nor does nothing"
        );
    }

    #[test]
    fn boxes_through_each_other_cross_and_boxes_side_by_side_touch() {
        let two = |offset: DVec3| {
            let (mut positions, mut triangles) = cuboid(DVec3::ZERO, DVec3::ONE);
            let (more, others) = cuboid(offset, offset + DVec3::ONE);
            positions.extend(more);
            triangles.extend(others.iter().map(|t| t.map(|v| v + 8)));
            SurfaceTree::new(&positions, &triangles).meetings()
        };
        let is_there =
            |found: &[MeetingPair], how| found.iter().any(|&(_, meeting)| meeting == how);
        let through = two(DVec3::new(0.3, 0.4, 0.6));
        assert!(is_there(&through, Meeting::Cross));
        let corner = two(DVec3::ONE);
        assert!(
            !corner.is_empty() && !is_there(&corner, Meeting::Cross),
            "{corner:?}"
        );
        let next_to_it = two(DVec3::new(1.0 + f64::EPSILON, 0.0, 0.0));
        assert_eq!(next_to_it, [], "a gap of one rounding unit");
    }
}
