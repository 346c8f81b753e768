//! Estimates the number of triangles of a cycle of many spans, from some of them.
//!
//! The number of triangles of a span grows with the pieces of its egress boundary, which are known
//! only once its grazing set is computed, and with its time steps, for which a box around the body
//! suffices. For some spans, spread over the motion, both are computed; the others are assumed to
//! have as many triangles per step of the box.

use super::carrying::{CycleError, carried, grazing_at};
use super::points::BodyPoints;
use super::room::Room;
use super::runs::Run;
use super::sampling::fewest_steps;

use crate::body::Mesh;
use crate::bounds::box_corners;
use crate::grazing::spatial::Simplification;
use crate::motion::{Flow, stretch};
use crate::numeric::tolerance::{Budget, MOST_TRIANGLES};
use crate::watch::Work;
use glam::DAffine3;
use rayon::prelude::*;

/// Number of spans that are examined: the mean over spans of similar shape is then accurate to a
/// few percent.
const SAMPLED: usize = 64;

/// Fewest spans per examined one, so that examining costs little; with fewer than eight examined,
/// the estimate means nothing.
const SPANS_EACH: usize = 16;
const FEWEST: usize = 8;

/// Refuses a motion of many spans whose cycle would be too large, before each of them is swept.
pub(super) fn refuse_many(
    body: &Mesh,
    runs: &[Run],
    budget: &Budget,
    room: &Room,
    work: Work,
) -> Result<(), CycleError> {
    let spans: Vec<(&Flow, &DAffine3)> = runs
        .iter()
        .flat_map(|run| run.flows.iter().zip(&run.frames))
        .collect();
    let sampled = (spans.len() / SPANS_EACH).min(SAMPLED);
    if sampled < FEWEST {
        return Ok(());
    }
    let corners = box_corners(body.bounds());
    let steps = |&(flow, frame): &(&Flow, &DAffine3)| {
        let generator = flow.generator();
        let growth = stretch(&generator.linear, [0.0, 1.0]);
        let corners = corners.iter().map(|&p| frame.transform_point3(p));
        fewest_steps(generator, growth, corners, budget) as f64
    };
    let all: f64 = spans.iter().map(steps).sum();
    let simplification = Simplification {
        fold: budget.fold,
        merge: budget.merge,
    };
    let look = |number: usize| {
        let (flow, frame) = spans[number];
        let grazing = grazing_at(body, frame, flow.generator(), simplification, work)?;
        let mut points = BodyPoints::default();
        let carried = carried(
            body,
            &grazing,
            (flow, frame),
            budget,
            room,
            &mut points,
            work,
        );
        carried.map(|carried| (carried.triangles(), steps(&spans[number])))
    };
    let found: Vec<Result<(f64, f64), CycleError>> = chosen(spans.len(), sampled)
        .into_par_iter()
        .map(look)
        .collect();
    let (mut triangles, mut looked) = (0.0, 0.0);
    for one in found {
        let (own, steps) = one?;
        triangles += own;
        looked += steps;
    }
    let triangles = triangles * (all / looked);
    if triangles <= MOST_TRIANGLES as f64 {
        return Ok(());
    }
    Err(CycleError::ManySpans {
        triangles,
        spans: spans.len(),
        sampled,
    })
}

/// `count` of the numbers below `all`, one in each of as many equal parts, at places that do not
/// keep step with motions that repeat.
fn chosen(all: usize, count: usize) -> Vec<usize> {
    let place = |number: usize| {
        let share = (number as f64 * GOLDEN).fract();
        let place = (number as f64 + share) * (all as f64 / count as f64);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "positive and below the number of all"
        )]
        let place = place as usize;
        place.min(all - 1)
    };
    (0..count).map(place).collect()
}

/// The golden ratio: multiples of it are spread evenly.
const GOLDEN: f64 = 0.618_033_988_749_894_8;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_span_of_each_equal_part_is_looked_at() {
        for (all, count) in [(160, 10), (1001, 64), (8, 8)] {
            let found = chosen(all, count);
            assert_eq!(found.len(), count);
            for (part, &span) in found.iter().enumerate() {
                assert!(
                    part * all / count <= span && span <= (part + 1) * all / count && span < all
                );
            }
        }
        // The chosen spans are not always at the same place of their parts, so that they are not in
        // step with a motion that repeats.
        let places: Vec<usize> = chosen(1000, 10).iter().map(|span| span % 100).collect();
        let [low, high] = [places.iter().min(), places.iter().max()];
        assert!(low < Some(&20) && high > Some(&80), "{places:?}");
    }
}
