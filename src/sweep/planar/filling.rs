//! Fills the holes that only the sampling made.

use crate::body::Polygon;
use crate::membership::planar::Membership;
use crate::motion::planar::Motion;
use crate::solid::planar::Arrangement;
use crate::watch::{Stop, Work};

/// Number of filled pockets.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Filled {
    pub(super) pockets: usize,
    /// Bound on the distance of their points from the region without them.
    pub(super) depth: f64,
}

/// Largest depth of a pocket to be filled, as a share of the tolerance: with the sampling error,
/// the region still reaches out by less than the tolerance.
const POCKET_SHARE: f64 = 0.5;

/// Fills the holes that only the sampling and the dropped folds made: shallow holes in which every
/// examined place is covered by the body at one time or another.
///
/// Holes deeper than the error of the curves are real, and so are those with an examined place that
/// is never covered.
pub(super) fn fill(
    arrangement: &mut Arrangement,
    body: &Polygon,
    motion: &Motion,
    tolerance: f64,
    work: Work,
) -> Result<Filled, Stop> {
    let deepest = POCKET_SHARE * tolerance;
    let mut pockets = Vec::new();
    for pocket in arrangement.each_pocket(work.uncounted()) {
        let pocket = pocket?;
        if pocket.reach <= deepest {
            pockets.push(pocket);
        }
    }
    if pockets.is_empty() {
        return Ok(Filled::default());
    }
    let membership = Membership::new(body, motion);
    let items = work.items(pockets.len());
    let mut swept = Vec::new();
    for pocket in pockets {
        items.next()?;
        let mut witnesses = pocket.witnesses.iter();
        if witnesses.all(|&place| membership.is_ever_inside(place)) {
            swept.push(pocket);
        }
    }
    let pockets = swept;
    arrangement.fill(&pockets);
    Ok(Filled {
        pockets: pockets.len(),
        depth: pockets
            .iter()
            .map(|pocket| pocket.reach)
            .fold(0.0, f64::max),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::FillRule;
    use crate::motion::planar::{Generator, Span};
    use crate::samples::loops_of_four;
    use crate::solid::planar::{Segment, arrange};
    use glam::DVec2;

    /// What is filled of a region from (0, 0) to (3, 3) with a hole of width 1/100 at `height`. The
    /// square of size 1 at the origin sweeps the region up to a height of 1, over a length of 2
    /// along x.
    fn filled(height: f64, tolerance: f64) -> (usize, bool) {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(DVec2::from_array);
        let body = Polygon::new(vec![square.to_vec()], FillRule::EvenOdd).expect("a square");
        let span = Span::new(Generator::translation(2.0 * DVec2::X), 1.0).expect("a span");
        let motion = Motion::from_spans(vec![span]).expect("a motion");
        let top = height + 0.01;
        let loops = [
            [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0]],
            [[1.0, height], [1.0, top], [2.0, top], [2.0, height]],
        ];
        let (points, ends) = loops_of_four(&loops);
        let segments: Vec<Segment> = ends
            .into_iter()
            .map(|ends| Segment { ends, weight: 1 })
            .collect();
        let mut region = arrange(&points, &segments).expect("two loops");
        let filled =
            fill(&mut region, &body, &motion, tolerance, Work::UNWATCHED).expect("no fault");
        assert!(filled.depth <= POCKET_SHARE * tolerance);
        let holes = region.measures(&region.outlines()).holes;
        (filled.pockets, holes == 0)
    }

    #[test]
    fn a_shallow_hole_that_the_body_covers_is_filled() {
        assert_eq!(filled(0.5, 0.1), (1, true));
    }

    #[test]
    fn a_hole_that_is_never_covered_stays() {
        assert_eq!(filled(1.5, 0.1), (0, false));
    }

    #[test]
    fn a_hole_deeper_than_the_sampling_stays() {
        // The width of the hole is more than half of the tolerance.
        assert_eq!(filled(0.5, 0.015), (0, false));
    }
}
