//! A moving body or obstacle over one stretch of the clock: its pose, bounds on its speed and on
//! its coordinates, and its chart over a window.

use super::chart::Chart;
use super::commuting::{COMMUTING, commute};
use crate::motion::expansion::{rounding, terms};
use crate::motion::{Flow, Generator};
use glam::{DAffine3, DVec3};

/// Number of times at which the size of coordinates is recorded, for the rounding bound.
const RECORDS: usize = 8;

/// Size of the symmetric part of M relative to M below which a motion counts as rigid: the rounding
/// of a rotation.
const RIGID: f64 = 1e-12;

/// A moving body or obstacle over one stretch of the clock; local time runs from 0 to 1.
#[derive(Debug, Clone)]
pub(super) struct Mover {
    /// `None` when it rests.
    flow: Option<Flow>,
    /// The fraction of the span of `flow` at local time t is `fraction[0] + fraction[1] * t`.
    fraction: [f64; 2],
    /// The map from its own frame to the world, at fraction 0.
    base: DAffine3,
    /// Generator per unit of local time.
    pub(super) generator: Generator,
    /// A bound on |M|, per unit of local time.
    pub(super) size: f64,
    /// A rate with |exp(sM)| <= e^(growth |s|).
    growth: f64,
    /// Centre and half extent of its box, in its own frame.
    centre: DVec3,
    half_extent: DVec3,
    /// The part of the bound on its coordinates that is the same at all times: that of the velocity
    /// field.
    field: f64,
    /// Bounds on the coordinates up to each record; 0 where the slack is instead counted window by
    /// window from the start.
    largest: [f64; RECORDS + 1],
    /// Rounding of positions, relative to the largest coordinate.
    unit: f64,
    /// Further error of its poses.
    deviation: f64,
}

impl Mover {
    /// A mover at rest in the world.
    pub(super) fn resting(base: DAffine3, bounds: [DVec3; 2]) -> Mover {
        let still = Generator::translation(DVec3::ZERO);
        Mover::new(
            None,
            [0.0, 1.0],
            base,
            still,
            middle_and_half_extent(bounds),
        )
    }

    /// Two movers relative to the frame of the second at local time 0, if distances are the same
    /// there: both turn or move, the second one rigidly, and they commute. The first then moves by
    /// exp(t(G1 - G2)), exactly, and the second one rests.
    ///
    /// The generators fail to commute by rounding only, which is part of the rounding of positions.
    /// Where the second one turns by w, the mean of G1 over its rotations commutes with it and
    /// differs from G1 by |\[G1, G2\]| / w, at most sqrt 2 [`COMMUTING`] |G1|. Both e^(-G2) e^(G1)
    /// and e^(G1 - G2) change by no more than that, times the growth, when this mean replaces G1.
    /// Where the second one does not turn, the two differ by half of M1 tau2, which is less.
    pub(super) fn relative(movers: &[Mover; 2]) -> Option<[Mover; 2]> {
        let [a, b] = movers;
        let rigid = b.growth <= RIGID * b.size;
        if a.rests() || b.rests() || !rigid || !commute(&a.generator, &b.generator) {
            return None;
        }
        let generator = Generator {
            linear: a.generator.linear - b.generator.linear,
            offset: a.generator.offset - b.generator.offset,
        };
        let still = generator == Generator::translation(DVec3::ZERO);
        let flow = (!still).then(|| Flow::new(generator));
        let base = a.pose(0.0);
        let mut first = Mover::new(flow, [0.0, 1.0], base, generator, (a.centre, a.half_extent));
        for (record, bound) in first.largest.iter_mut().enumerate() {
            *bound = bound.max(a.largest[record]).max(b.largest[record]);
        }
        let sizes = [a, b].map(|mover| mover.generator.size());
        let replaced = 3.0 * COMMUTING * sizes[0] * a.growth.exp();
        first.unit = rounding(&sizes) + replaced;
        // The second one is rigid, so that distances are the same in its frame.
        first.deviation = a.deviation + b.deviation;
        let still = Generator::translation(DVec3::ZERO);
        let base = b.pose(0.0);
        let second = Mover::new(None, [0.0, 1.0], base, still, (b.centre, b.half_extent));
        Some([first, second])
    }

    /// A mover that is carried by a flow during a part of its span.
    ///
    /// - `fractions`: of the span, at the local times 0 and 1. `base`: from its own frame to the
    ///   world at fraction 0.
    pub(super) fn moving(
        flow: &Flow,
        fractions: [f64; 2],
        base: DAffine3,
        bounds: [DVec3; 2],
    ) -> Mover {
        let rate = fractions[1] - fractions[0];
        let generator = flow.generator().scaled(rate);
        if generator == Generator::translation(DVec3::ZERO) {
            return Mover::resting(base, bounds);
        }
        let fraction = [fractions[0], rate];
        let bounds = middle_and_half_extent(bounds);
        Mover::new(Some(flow.clone()), fraction, base, generator, bounds)
    }

    /// A mover that is carried by a flow over its whole span and followed from the start: the slack
    /// of a chart covers its window only, and that of earlier windows counts as well.
    pub(super) fn followed(flow: Flow, bounds: [DVec3; 2]) -> Mover {
        let generator = *flow.generator();
        if generator == Generator::translation(DVec3::ZERO) {
            return Mover::resting(DAffine3::IDENTITY, bounds);
        }
        let bounds = middle_and_half_extent(bounds);
        Mover::unmeasured(
            Some(flow),
            [0.0, 1.0],
            DAffine3::IDENTITY,
            generator,
            bounds,
        )
    }

    fn new(
        flow: Option<Flow>,
        fraction: [f64; 2],
        base: DAffine3,
        generator: Generator,
        bounds: (DVec3, DVec3),
    ) -> Mover {
        let mut mover = Mover::unmeasured(flow, fraction, base, generator, bounds);
        mover.largest = mover.farthest();
        mover
    }

    /// A mover without the records of its largest coordinates.
    fn unmeasured(
        flow: Option<Flow>,
        fraction: [f64; 2],
        base: DAffine3,
        generator: Generator,
        (centre, half_extent): (DVec3, DVec3),
    ) -> Mover {
        let size = norm(&generator);
        let symmetric = Generator {
            linear: (generator.linear + generator.linear.transpose()) * 0.5,
            offset: DVec3::ZERO,
        };
        let whole = flow.as_ref().map_or(0.0, |flow| flow.generator().size());
        Mover {
            flow,
            fraction,
            base,
            generator,
            size,
            growth: symmetric.size(),
            centre,
            half_extent,
            field: generator.offset.length() / size.max(1.0),
            largest: [0.0; RECORDS + 1],
            unit: rounding(&[whole]),
            deviation: 0.0,
        }
    }

    /// The same mover, whose true place may differ by a distance.
    pub(super) fn deviating(self, deviation: f64) -> Mover {
        Mover { deviation, ..self }
    }

    /// Bounds on the coordinates of its box and of the origin of its frame, and on the velocity
    /// field, up to each record.
    ///
    /// Proven, up to the rounding of the poses computed here. Velocities follow v' = M v: within d
    /// of a record they are at most e^(growth d) times their values there, so that nothing is
    /// farther from its place there than d e^(growth d) v. A rigid motion preserves distances from
    /// its axis and moves evenly along it, so that distances from a point q of the axis are convex
    /// in time and largest at an end: |x| <= |x at an end| + 2 |q|. The smaller of the two bounds
    /// counts.
    fn farthest(&self) -> [f64; RECORDS + 1] {
        if self.rests() {
            return [self.far_within(&self.base, 0.0); RECORDS + 1];
        }
        let distance = 0.5 / RECORDS as f64;
        let grown = (self.growth * distance).exp() * distance;
        let mut largest = 0.0_f64;
        let mut bounds = [0.0; RECORDS + 1];
        for (record, bound) in bounds.iter_mut().enumerate() {
            let pose = self.pose(record as f64 / RECORDS as f64);
            largest = largest.max(self.far_within(&pose, grown));
            *bound = largest;
        }
        if let Some(axis) = self.axis_distance() {
            let at = |time: f64| self.far_within(&self.pose(time), 0.0);
            let ends = at(0.0).max(at(1.0)) * self.growth.exp() + 2.0 * axis;
            bounds = bounds.map(|bound| bound.min(ends));
        }
        bounds
    }

    /// Bound on the coordinates and on the velocity field as in [`farthest`](Mover::farthest),
    /// around the time of a pose.
    ///
    /// - `grown`: d e^(growth d) for times up to d away.
    fn far_within(&self, pose: &DAffine3, grown: f64) -> f64 {
        self.far(pose) + grown * self.speed_in(pose) + self.field
    }

    /// Distance of the axis of a turning rigid motion from the origin; `None` for other motions.
    fn axis_distance(&self) -> Option<f64> {
        let Generator { linear, offset } = self.generator;
        let skew = (linear - linear.transpose()) * 0.5;
        let turn = DVec3::new(skew.y_axis.z, skew.z_axis.x, skew.x_axis.y);
        let turns = self.growth <= RIGID * self.size && turn != DVec3::ZERO;
        turns.then(|| turn.cross(offset).length() / turn.length_squared())
    }

    /// Largest distance of a point of its box, or of the origin of its frame, from the origin in a
    /// pose.
    fn far(&self, pose: &DAffine3) -> f64 {
        let extent = pose.matrix3.abs() * self.half_extent;
        let corner = pose.transform_point3(self.centre).abs() + extent;
        let square = corner.length_squared();
        square.max(pose.translation.length_squared()).sqrt()
    }

    /// The norm of the symmetric part of M, for which |exp(sM)| <= e^(growth |s|); 0 for a rigid
    /// motion.
    pub(super) fn growth(&self) -> f64 {
        self.growth
    }

    /// Largest coordinate that was recorded during the motion.
    pub(super) fn reach(&self) -> f64 {
        self.largest[RECORDS]
    }

    /// Whether it rests.
    pub(super) fn rests(&self) -> bool {
        self.flow.is_none()
    }

    /// The map from its own frame to the world at a time.
    pub(super) fn pose(&self, time: f64) -> DAffine3 {
        match &self.flow {
            None => self.base,
            Some(flow) => flow.pose_at(self.fraction[0] + self.fraction[1] * time) * self.base,
        }
    }

    /// The place of the centre of its box.
    pub(super) fn centre_at(&self, time: f64) -> DVec3 {
        self.pose(time).transform_point3(self.centre)
    }

    /// Largest speed of a point of its box.
    pub(super) fn speed(&self, time: f64) -> f64 {
        self.speed_in(&self.pose(time))
    }

    /// Largest speed of a point of its box during `duration` from a time on: velocities follow
    /// v' = M v.
    pub(super) fn speed_within(&self, time: f64, duration: f64) -> f64 {
        self.speed(time) * (self.growth * duration).exp()
    }

    /// Whether it preserves all distances.
    pub(super) fn is_rigid(&self) -> bool {
        self.rests() || self.growth <= RIGID * self.size
    }

    /// Largest speed of a point of its box, or of the origin of its frame, in a pose.
    fn speed_in(&self, pose: &DAffine3) -> f64 {
        let Generator { linear, offset } = self.generator;
        let carried = linear * pose.matrix3;
        let origin = linear * pose.translation + offset;
        let corner = (carried * self.centre + origin).abs() + carried.abs() * self.half_extent;
        corner.length_squared().max(origin.length_squared()).sqrt()
    }

    /// The chart over the window around `middle`.
    ///
    /// - `reduced`: sum over both movers of |M| times `half`; at most
    ///   [`LONGEST`](super::chart::LONGEST) where paths are used.
    pub(super) fn chart(&self, middle: f64, half: f64, reduced: f64) -> Chart {
        let pose = self.pose(middle);
        let generator = self.generator;
        let stretch = (self.growth * half).exp();
        let (mut acceleration, mut speed, mut far) = (0.0, 0.0, 0.0);
        if self.flow.is_some() {
            let Generator { linear, offset } = generator;
            let carried = linear * pose.matrix3;
            let origin = linear * pose.translation + offset;
            let velocity = carried * self.centre + origin;
            let corner = velocity.abs() + carried.abs() * self.half_extent;
            let square = corner.length_squared().max(origin.length_squared());
            speed = stretch * square.sqrt();
            far = self.far(&pose) + half * speed + self.field;
            let bend = (linear * carried).abs() * self.half_extent;
            acceleration = ((linear * velocity).abs() + bend).length();
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to the records"
        )]
        let record = ((middle + half) * RECORDS as f64)
            .ceil()
            .clamp(0.0, RECORDS as f64) as usize;
        let acceleration = acceleration * stretch;
        Chart {
            pose,
            generator,
            half,
            reduced_half: self.size * half,
            terms: if self.rests() {
                1
            } else {
                terms(2.0 * reduced)
            },
            slack: self.unit * self.largest[record].max(far) + self.deviation,
            acceleration,
            speed,
            stretch,
        }
    }
}

/// An upper bound of |M|: the Frobenius norm of (M^T M)^2, to the power of 1/4, is at most 9% above
/// it.
fn norm(generator: &Generator) -> f64 {
    let size = generator.size();
    if size == 0.0 || !size.is_finite() {
        return size;
    }
    let unit = generator.linear * (1.0 / size);
    let square = unit.transpose() * unit;
    let linear = square * square;
    let offset = DVec3::ZERO;
    let fourth = Generator { linear, offset }.size();
    size.min(size * fourth.sqrt().sqrt() * (1.0 + NORM_ROUNDING))
}

/// Relative rounding of a norm: some 10 u for each of the entries of a product, and for a root.
const NORM_ROUNDING: f64 = 1e-14;

fn middle_and_half_extent([low, high]: [DVec3; 2]) -> (DVec3, DVec3) {
    (low.midpoint(high), (high - low) * 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::{cuboid, random};
    use glam::DMat3;

    #[test]
    fn no_coordinate_during_the_motion_is_larger_than_its_bound() {
        let mut entry = random(11);
        let bounds = [DVec3::new(1.0, -2.0, 0.0), DVec3::new(3.0, -1.0, 0.5)];
        let (corners, _) = cuboid(bounds[0], bounds[1]);
        for case in 0..300 {
            let size = [0.01, 1.0, 6.0, 40.0][case % 4];
            let mut linear = DMat3::from_cols_array(&std::array::from_fn(|_| entry() * size));
            if case % 3 == 0 {
                // Rigid.
                linear = linear - linear.transpose();
            } else if case % 3 == 1 {
                // Not so far from rigid that numbers explode.
                linear = linear - linear.transpose() + linear * (0.5 / size);
            }
            let offset = DVec3::new(entry(), entry(), entry()) * 3.0;
            let flow = Flow::new(Generator { linear, offset });
            let mover = Mover::moving(&flow, [0.0, 1.0], DAffine3::IDENTITY, bounds);
            for k in 0..=400_usize {
                let pose = mover.pose(k as f64 / 400.0);
                let places = corners.iter().map(|&c| pose.transform_point3(c).length());
                let far = places.fold(0.0, f64::max);
                let bound = mover.largest[(k * RECORDS).div_ceil(400)];
                assert!(
                    far <= bound * (1.0 + 1e-12),
                    "case {case}, step {k}: {far} beyond {bound}"
                );
            }
        }
    }
}
