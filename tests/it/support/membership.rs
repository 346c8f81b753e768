//! Membership by a slow method: many times, each with an inside test that is obviously right.

use super::shapes::Shape;
use glam::{DAffine3, DMat4, DVec3};
use steadysweep::motion::Motion;

/// A moving body at many equal steps of time.
pub(crate) struct Sampled<'a> {
    shape: &'a Shape,
    /// Times on the motion's clock, ascending.
    pub(crate) times: Vec<f64>,
    /// World to body, at these times.
    inverses: Vec<DAffine3>,
}

impl<'a> Sampled<'a> {
    /// `samples` times per span.
    pub(crate) fn new(shape: &'a Shape, motion: &Motion, samples: usize) -> Self {
        let (mut times, mut inverses) = (Vec::new(), Vec::new());
        let mut joint = DAffine3::IDENTITY;
        let joint_times = motion.joint_times();
        for (k, span) in motion.spans().iter().enumerate() {
            let generator = span.flow().generator();
            let pose = |s: f64| {
                exponential(&generator.linear, generator.offset, s) * joint * *motion.start_pose()
            };
            for i in 0..=samples {
                let s = i as f64 / samples as f64;
                times.push(joint_times[k] + s * (joint_times[k + 1] - joint_times[k]));
                inverses.push(pose(s).inverse());
            }
            joint = exponential(&generator.linear, generator.offset, 1.0) * joint;
        }
        Sampled {
            shape,
            times,
            inverses,
        }
    }

    /// The position of `point` relative to the body at time number `index`.
    pub(crate) fn seen(&self, point: DVec3, index: usize) -> DVec3 {
        self.inverses[index].transform_point3(point)
    }

    /// Checks `intervals` of `point` at every sampled time.
    ///
    /// Times at which it is within `close` of the surface are skipped, since rounding decides
    /// there.
    pub(crate) fn check(&self, point: DVec3, intervals: &[[f64; 2]], close: f64) {
        self.check_with(point, intervals, close, |seen| {
            winding_number(self.shape, seen) >= 1
        });
    }

    /// The same with another inside test for the body at rest.
    pub(crate) fn check_with(
        &self,
        point: DVec3,
        intervals: &[[f64; 2]],
        close: f64,
        is_inside: impl Fn(DVec3) -> bool,
    ) {
        for pair in intervals.windows(2) {
            assert!(
                pair[0][1] < pair[1][0],
                "{intervals:?} of {point:?} are not disjoint and ascending"
            );
        }
        for (index, &time) in self.times.iter().enumerate() {
            let seen = self.seen(point, index);
            let found = intervals
                .iter()
                .any(|&[start, end]| start <= time && time <= end);
            if found != is_inside(seen) && distance(self.shape, seen) > close {
                panic!(
                    "{point:?} at time {time}: found inside = {found}, seen at {seen:?}; intervals {intervals:?}"
                );
            }
        }
    }
}

/// How many times the surface winds around `point`: the sum of the solid angles of its triangles.
pub(crate) fn winding_number((positions, triangles): &Shape, point: DVec3) -> i32 {
    let solid_angle = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|corner| positions[corner as usize] - point);
        let (p, q, r) = (a.length(), b.length(), c.length());
        2.0 * a
            .cross(b)
            .dot(c)
            .atan2(p * q * r + a.dot(b) * r + b.dot(c) * p + c.dot(a) * q)
    };
    let total: f64 = triangles.iter().map(solid_angle).sum();
    (total / (4.0 * std::f64::consts::PI)).round() as i32
}

/// Distance to the nearest triangle, one by one.
pub(crate) fn distance((positions, triangles): &Shape, point: DVec3) -> f64 {
    let each = triangles
        .iter()
        .map(|triangle| distance_to_triangle(triangle.map(|k| positions[k as usize]), point));
    each.fold(f64::INFINITY, f64::min)
}

/// The distance to the nearest of the vertices, the feet on the lines of the edges, and the foot on
/// the plane, where they exist.
pub(crate) fn distance_to_triangle([a, b, c]: [DVec3; 3], point: DVec3) -> f64 {
    let mut nearest = a
        .distance(point)
        .min(b.distance(point))
        .min(c.distance(point));
    for (from, to) in [(a, b), (b, c), (c, a)] {
        let along = (to - from).normalize_or_zero();
        let foot = (point - from).dot(along);
        if foot > 0.0 && foot < from.distance(to) {
            nearest = nearest.min((point - from).reject_from_normalized(along).length());
        }
    }
    if let Some(normal) = (b - a).cross(c - a).try_normalize() {
        let inside = |from: DVec3, to: DVec3| (to - from).cross(point - from).dot(normal) >= 0.0;
        if inside(a, b) && inside(b, c) && inside(c, a) {
            nearest = nearest.min((point - a).dot(normal).abs());
        }
    }
    nearest
}

/// exp(s [M tau; 0 0]) by scaling, the power series, and squaring.
pub(crate) fn exponential(linear: &glam::DMat3, offset: DVec3, s: f64) -> DAffine3 {
    let columns = linear.to_cols_array_2d();
    let generator = DMat4::from_cols(
        DVec3::from(columns[0]).extend(0.0),
        DVec3::from(columns[1]).extend(0.0),
        DVec3::from(columns[2]).extend(0.0),
        offset.extend(0.0),
    );
    // The offset does not matter for the scaling: the series is affine in it.
    let size = linear
        .to_cols_array()
        .iter()
        .map(|x| x.abs())
        .fold(0.0, f64::max)
        * s.abs()
        * 3.0;
    let squarings = (size.log2().ceil().max(-1.0) + 1.0) as i32;
    let small = generator * (s / 2f64.powi(squarings));
    let (mut sum, mut term) = (DMat4::IDENTITY, DMat4::IDENTITY);
    for k in 1..=20 {
        term = term * small * (1.0 / f64::from(k));
        sum += term;
    }
    for _ in 0..squarings {
        sum = sum * sum;
    }
    let column = |k: usize| sum.col(k).truncate();
    DAffine3 {
        matrix3: glam::DMat3::from_cols(column(0), column(1), column(2)),
        translation: column(3),
    }
}
