//! Time steps of a rotation that bring points of the body to places where others have been.
//!
//! When a part with rotational symmetry, such as a round bar or a gear wheel, turns about its own
//! axis, it sweeps sheets that lie on each other. Sampled at common times, these are the same
//! triangles if the step divides the angle from facet to facet. Otherwise there are as many
//! different sheets as facets, and each crosses all others.

use crate::motion::{Generator, MotionKind, describe};
use glam::DVec3;
use std::f64::consts::TAU;

/// Most points that are examined: enough to detect a symmetry, and few enough to try a hundred step
/// lengths in no time.
const MOST_POINTS: usize = 2000;

/// Fewest steps for which alignment is worthwhile: shorter motions have few sheets on each other.
const FEWEST_STEPS: usize = 4;

/// The length of a step, as a share of the motion and at most 1 / `steps`, for which the `points`
/// (world, at the start) take clearly fewer different places in a turn than with `steps` equal
/// ones; `None` where there is none or the motion is no rotation.
///
/// Lengths down to half of the largest are tried, all of which divide a full turn. Places within
/// `distance` of each other count as one. The choice affects only speed: any answer is right.
pub(super) fn aligned_step(
    generator: &Generator,
    points: impl Iterator<Item = DVec3>,
    steps: usize,
    distance: f64,
) -> Option<f64> {
    let rotation = describe(generator);
    let (MotionKind::Rotation, Some(axis), Some(through), Some(turn)) = (
        rotation.kind,
        rotation.axis,
        rotation.through,
        rotation.turn_deg,
    ) else {
        return None;
    };
    if steps < FEWEST_STEPS {
        return None;
    }
    let orbits = PointCircles::new(points, axis, through, distance);
    let turn = turn.to_radians();
    let largest = turn / steps as f64;
    let places = |step: f64| orbits.different(step) as f64 / step;
    let usual = places(largest);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positive; saturates"
    )]
    let fewest = (TAU / largest * (1.0 - EQUAL_ANGLES)).ceil() as u64;
    let (places, step) = (fewest..=fewest.saturating_mul(2).min(fewest + MOST_TRIALS))
        .map(|per_turn| TAU / per_turn as f64)
        .map(|step| (places(step), step))
        .min_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)))?;
    (places <= WORTHWHILE * usual).then_some(step / turn)
}

/// Largest share of the places that may remain for other steps to be worthwhile.
const WORTHWHILE: f64 = 0.75;

/// Relative difference up to which two angles count as equal.
const EQUAL_ANGLES: f64 = 1e-9;

/// Bound on the step lengths that are tried, for motions of very many steps.
const MOST_TRIALS: u64 = 500;

/// Points by the circle on which they move.
struct PointCircles {
    /// Per circle, the angles of its points, and the angle below which two of them count as one.
    circles: Vec<(Vec<f64>, f64)>,
}

impl PointCircles {
    fn new(
        points: impl Iterator<Item = DVec3>,
        axis: DVec3,
        through: DVec3,
        distance: f64,
    ) -> PointCircles {
        let side = axis.any_orthonormal_vector();
        let up = axis.cross(side);
        let mut all: Vec<([i64; 2], f64, f64)> = points
            .map(|p| {
                let offset = p - through;
                let (x, y) = (offset.dot(side), offset.dot(up));
                let radius = x.hypot(y);
                // Cells whose borders are not at round numbers.
                let cell = |length: f64| whole((length / distance + 0.377).floor());
                ([radius, offset.dot(axis)].map(cell), y.atan2(x), radius)
            })
            .collect();
        all.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        all.dedup_by(|a, b| a.0 == b.0 && (a.1 - b.1).abs() * b.2 <= distance);
        let mut circles: Vec<(Vec<f64>, f64)> = all
            .chunk_by(|a, b| a.0 == b.0)
            .map(|circle| {
                let angles = circle.iter().map(|point| point.1).collect();
                (angles, distance / circle[0].2.max(distance))
            })
            .collect();
        // Circles with many points say most.
        circles.sort_by_key(|circle| std::cmp::Reverse(circle.0.len()));
        let mut points = 0;
        let enough = circles
            .iter()
            .take_while(|circle| {
                points += circle.0.len();
                points <= MOST_POINTS
            })
            .count();
        circles.truncate(enough.max(1));
        PointCircles { circles }
    }

    /// The number of points that remain different when points a whole number of steps apart count
    /// as one.
    fn different(&self, step: f64) -> usize {
        let mut rests = Vec::new();
        self.circles
            .iter()
            .map(|(angles, same)| {
                rests.clear();
                rests.extend(angles.iter().map(|angle| angle.rem_euclid(step)));
                rests.sort_by(f64::total_cmp);
                let steps_up = rests.windows(2).filter(|pair| pair[1] - pair[0] > *same);
                let around = rests[0] + step - rests[rests.len() - 1] > *same;
                // Around the circle of remainders there are as many points as gaps.
                (steps_up.count() + usize::from(around)).max(1)
            })
            .sum()
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "saturates; cells are compared for equality only"
)]
fn whole(x: f64) -> i64 {
    x as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(corners: u32) -> impl Iterator<Item = DVec3> {
        (0..corners).map(move |i| {
            let angle = TAU * f64::from(i) / f64::from(corners);
            DVec3::new(2.0 + angle.cos(), angle.sin(), 0.5)
        })
    }

    fn turn(angle: f64) -> Generator {
        Generator::screw(DVec3::Z, DVec3::X * 2.0, angle, 0.0, 1.0)
    }

    #[test]
    fn the_step_divides_the_angle_between_corners() {
        for (corners, steps, angle) in [
            (24, 69, TAU),
            (48, 70, TAU),
            (7, 69, TAU),
            (24, 20, 1.7),
            (128, 70, TAU),
        ] {
            let step = aligned_step(&turn(angle), ring(corners), steps, 1e-5)
                .expect("a regular polygon about its own axis")
                * angle;
            let largest = angle / f64::from(u32::try_from(steps).unwrap());
            assert!(
                step <= largest * (1.0 + 1e-9) && step >= largest / 2.1,
                "{corners}: {step} against {largest}"
            );
            let facets = TAU / f64::from(corners) / step;
            let steps_per_facet = if facets < 1.0 { facets.recip() } else { facets };
            assert!(
                (steps_per_facet - steps_per_facet.round()).abs() < 1e-6,
                "{corners} corners: {facets} steps from one to the next"
            );
        }
    }

    #[test]
    fn a_body_off_the_axis_and_other_motions_keep_their_steps() {
        let far = ring(24).map(|p| p + DVec3::new(5.0, 1.3, 0.0));
        assert_eq!(
            aligned_step(&turn(TAU), far, 69, 1e-5),
            None,
            "off the axis"
        );
        let screw = Generator::screw(DVec3::Z, DVec3::X * 2.0, TAU, 0.3, 1.0);
        assert_eq!(aligned_step(&screw, ring(24), 69, 1e-5), None, "a screw");
        assert_eq!(
            aligned_step(&turn(0.1), ring(24), 2, 1e-5),
            None,
            "two steps"
        );
    }
}
