//! The path of a point relative to the moving body, over one span.
//!
//! Key: x a world point; G = [M tau; 0 0] the generator of the span; s in [0, 1] the time within
//! it; Q the inverse of the pose in which the span begins. Relative to the body, the point is at
//! c(s) = Q exp(-sG) x.
//!
//! The span is cut into equal windows. A(m) = Q exp(-mG) is tabulated at their ends and middles m,
//! once for all points; within a window, c(m + t) = A(m) exp(-tG) x, and exp(-tG) x is expanded
//! (`motion::expansion`), once for all windows. Windows are so short that |t| ||M|| <= 1/8: the sum
//! to t^10 leaves a remainder below rounding.

use crate::motion::expansion::{Curve, remainder, rounding};
use crate::motion::{Generator, Motion};
use crate::numeric::norms::frobenius;
use crate::numeric::roots::MOST_TERMS;
use glam::{DAffine3, DMat3, DVec3};

/// Largest ||M|| times half the width of a window, unless the limit on windows forbids it. The
/// remainder is then below rounding: (1/8)^10 / 11! is less than the unit roundoff.
const LARGEST_REDUCED_TIME: f64 = 0.125;

/// Most windows per span, 240 MB of poses: enough for the most turns that a span may have. Beyond,
/// which only shears and strains by more than 10^5 are, the remainder of the expansion grows and is
/// added to the slack: still safe, but less sharp.
const MAX_WINDOWS: f64 = 1_048_576.0;

/// Most windows that are made for the sake of short chords.
const MOST_FOR_DETAIL: f64 = 65_536.0;

/// One span of a motion, prepared for the paths of all points.
#[derive(Debug, Clone)]
pub(super) struct SpanPaths {
    /// -G.
    backward: Generator,
    /// A at the times i / (2 windows): even entries are at the ends of windows, odd ones in their
    /// middles.
    poses: Vec<DAffine3>,
    /// e^(||M|| t) - 1 over half a window: the largest relative change of a derivative from its
    /// value in the middle.
    drift: f64,
    /// One entry per window.
    bounds: Vec<Bounds>,
    /// Bound on the distance of the body from its place under the motion, in the world: the
    /// rounding of its poses.
    deviation: f64,
}

/// How a window changes sizes. A motion that shrinks the body makes the world large relative to the
/// body, but only later: the bounds at its end would blur its start.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    /// ||A|| (of the linear part) in the middle.
    stretch: f64,
    /// Rounding of c: `rounding[0] + rounding[1] |x|`.
    rounding: [f64; 2],
    /// Remainder of the expansion, divided by |v(x)|.
    remainder: f64,
}

/// The path of one point over one span.
#[derive(Debug)]
pub(super) struct Path<'a> {
    span: &'a SpanPaths,
    /// exp(-tG) x.
    curve: Curve,
    /// |x| and |v(x)|.
    lengths: [f64; 2],
}

/// The path over one window, relative to the body.
#[derive(Debug)]
pub(super) struct Stretch<'a, 'b> {
    path: &'b Path<'a>,
    /// Index of the middle in the table.
    middle: usize,
    /// The positions at the ends.
    pub(super) start: DVec3,
    pub(super) end: DVec3,
    /// Bound on the distance of the path from its chord, rounding included.
    pub(super) bulge: f64,
    /// * Bound on the error of every computed position: rounding and remainder.
    pub(super) slack: f64,
}

impl SpanPaths {
    /// Span number `index` of a motion in space; otherwise as [`SpanPaths::new`].
    pub(super) fn of_span(
        motion: &Motion,
        index: usize,
        corners: &[DVec3],
        detail: f64,
    ) -> SpanPaths {
        let flow = motion.spans()[index].flow();
        let pose = motion.joints()[index] * *motion.start_pose();
        SpanPaths::new(
            flow.generator(),
            |s| flow.pose_at(s),
            &pose,
            corners,
            detail,
        )
    }

    /// - `generator`, `flow`: G and exp(sG) of the span. `pose`: the pose in which it begins.
    /// - `corners`: corners of the box around the body. With `detail`, a length, they determine the
    ///   width of the windows: paths near the body depart from their chords by about a quarter of
    ///   `detail` or less.
    pub(super) fn new(
        generator: &Generator,
        flow: impl Fn(f64) -> DAffine3,
        pose: &DAffine3,
        corners: &[DVec3],
        detail: f64,
    ) -> SpanPaths {
        let inverse = pose.inverse();
        let size = frobenius(&generator.linear);

        // In the frame of the body, the acceleration does not depend on time, and its norm is
        // convex.
        let in_body = generator.in_frame(pose);
        let acceleration = corners
            .iter()
            .map(|&corner| in_body.acceleration(corner).length())
            .fold(0.0, f64::max);
        let by_detail = (acceleration / (2.0 * detail)).sqrt();
        let by_turn = size / (2.0 * LARGEST_REDUCED_TIME);
        let windows = by_detail.min(MOST_FOR_DETAIL).max(by_turn);
        let windows = windows.ceil().clamp(1.0, MAX_WINDOWS);

        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number from 1 to MAX_WINDOWS"
        )]
        let halves = 2 * windows as usize;
        let flows: Vec<DAffine3> = (0..=halves)
            .map(|i| flow(-(i as f64) / halves as f64))
            .collect();
        let poses: Vec<DAffine3> = flows.iter().map(|flow| inverse * *flow).collect();

        let inverse_size = spectral_bound(&inverse.matrix3);
        // 1 for a rotation, with or without scale.
        let condition = frobenius(&inverse.matrix3) * frobenius(&pose.matrix3) / 3.0;
        let unit = rounding(&[size]) * condition;
        let lengths = corners.iter().map(|corner| corner.length());
        let body_size = lengths.fold(0.0, f64::max);
        let half_width = 0.5 / windows;
        let reduced = size * half_width;
        let remainder = remainder(half_width * reduced.exp(), 1, MOST_TERMS, reduced);

        // An exponential is no more accurate than the largest one up to its time.
        let [mut flow_offset, mut flow_size] = [0.0_f64; 2];
        let windows = flows.windows(3).zip(poses.windows(3)).step_by(2);
        let bounds = windows.map(|(flows, poses)| {
            for flow in flows {
                flow_offset = flow_offset.max(flow.translation.length());
                flow_size = flow_size.max(spectral_bound(&flow.matrix3));
            }
            let offset = inverse_size * (flow_offset + generator.offset.length());
            let stretch = spectral_bound(&poses[1].matrix3);
            Bounds {
                stretch,
                rounding: [
                    unit * (offset + inverse.translation.length() + body_size),
                    unit * inverse_size * flow_size,
                ],
                remainder: stretch * remainder,
            }
        });
        SpanPaths {
            backward: generator.scaled(-1.0),
            drift: reduced.exp_m1(),
            bounds: bounds.collect(),
            poses,
            deviation: 0.0,
        }
    }

    /// The same paths, for a body whose true place may differ by a distance.
    pub(super) fn deviating(self, deviation: f64) -> SpanPaths {
        SpanPaths { deviation, ..self }
    }

    /// Number of windows.
    pub(super) fn windows(&self) -> usize {
        self.poses.len() / 2
    }

    /// The time of an entry of the table.
    fn time(&self, index: usize) -> f64 {
        index as f64 / (2 * self.windows()) as f64
    }

    /// The path of a world point.
    pub(super) fn path(&self, point: DVec3) -> Path<'_> {
        let mut curve = Curve::ORIGIN;
        curve.draw(&self.backward, point, MOST_TERMS);
        Path {
            span: self,
            curve,
            lengths: [point.length(), curve.0[1].length()],
        }
    }
}

impl<'a> Path<'a> {
    /// The position at an end (even index) or middle (odd index) of a window.
    pub(super) fn tabulated(&self, index: usize) -> DVec3 {
        self.span.poses[index].transform_point3(self.curve.0[0])
    }

    /// The position at a time in [0, 1].
    pub(super) fn at(&self, time: f64) -> DVec3 {
        let middle = 2 * self.window_at(time) + 1;
        self.expanded(middle, time - self.span.time(middle))
    }

    /// The index of the window that contains a time in [0, 1].
    fn window_at(&self, time: f64) -> usize {
        let windows = self.span.windows();
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the time is in [0, 1]: the index is too, after min"
        )]
        let window = ((time * windows as f64) as usize).min(windows - 1);
        window
    }

    /// The position at a time `since` the middle of a window.
    fn expanded(&self, middle: usize, since: f64) -> DVec3 {
        let displacement = self.curve.displacement(MOST_TERMS, since);
        self.tabulated(middle) + self.span.poses[middle].matrix3 * displacement
    }

    /// Bound on the error of every position computed in window number `index`: rounding and
    /// remainder.
    fn slack(&self, index: usize) -> f64 {
        let Bounds {
            stretch,
            rounding,
            remainder,
        } = self.span.bounds[index];
        let seen = stretch * (1.0 + self.span.drift) * self.span.deviation;
        rounding[0] + rounding[1] * self.lengths[0] + remainder * self.lengths[1] + seen
    }

    /// The path over window number `index`, given the positions at its ends.
    pub(super) fn window(&self, index: usize, start: DVec3, end: DVec3) -> Stretch<'a, '_> {
        let middle = 2 * index + 1;
        let width = 1.0 / self.span.windows() as f64;
        let acceleration = self.curve.0[2] * 2.0;
        let bend = self.span.poses[middle].matrix3 * acceleration;
        let bounds = &self.span.bounds[index];
        let bend = bend.length() + bounds.stretch * self.span.drift * acceleration.length();
        let slack = self.slack(index);
        Stretch {
            path: self,
            middle,
            start,
            end,
            bulge: width * width / 8.0 * bend + slack,
            slack,
        }
    }
}

impl Stretch<'_, '_> {
    /// The time in the middle.
    pub(super) fn middle_time(&self) -> f64 {
        self.path.span.time(self.middle)
    }

    /// Half the width in time.
    pub(super) fn half_width(&self) -> f64 {
        0.5 / self.path.span.windows() as f64
    }

    /// Position at a time of the span.
    pub(super) fn at(&self, time: f64) -> DVec3 {
        self.path.expanded(self.middle, time - self.middle_time())
    }

    /// Upper bound of the speed.
    pub(super) fn speed(&self) -> f64 {
        let velocity = self.path.curve.0[1];
        let in_middle = self.path.span.poses[self.middle].matrix3 * velocity;
        let stretch = self.path.span.bounds[self.middle / 2].stretch;
        in_middle.length() + stretch * self.path.span.drift * self.path.lengths[1]
    }

    /// The height of the path over the plane through `anchor` with unit normal `normal`: the
    /// coefficients of t^0 .. t^DEGREE, with t the time from the middle.
    pub(super) fn height(&self, normal: DVec3, anchor: DVec3) -> [f64; MOST_TERMS] {
        let in_world = self.path.span.poses[self.middle].matrix3.transpose() * normal;
        let mut coefficients = self.path.curve.0.map(|c| in_world.dot(c));
        coefficients[0] = normal.dot(self.path.tabulated(self.middle) - anchor);
        coefficients
    }
}

/// An upper bound of the spectral norm of a matrix, exact for diagonal ones: the smaller of the
/// bounds by Schur and by Frobenius.
fn spectral_bound(matrix: &DMat3) -> f64 {
    let largest_sum = |matrix: &DMat3| {
        let absolute = matrix.abs();
        (absolute.x_axis + absolute.y_axis + absolute.z_axis).max_element()
    };
    let by_sums = (largest_sum(matrix) * largest_sum(&matrix.transpose())).sqrt();
    by_sums.min(frobenius(matrix))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{Keyframe, Span};
    use glam::DQuat;

    const CORNER: DVec3 = DVec3::new(0.5, 0.25, 0.125);

    /// A turn, a spiral, a shear, a motion without symmetry, and a chain that begins in a sheared
    /// pose.
    fn motions() -> Vec<Motion> {
        let general = DMat3::from_cols_array(&[0.3, 2.0, -0.4, -1.7, -0.5, 0.6, 0.2, -0.9, 0.1]);
        let generators = [
            Generator::screw(DVec3::Z, DVec3::X, 10.0, 2.0, 1.0),
            Generator::screw(DVec3::Y, DVec3::new(3e3, 0.0, 0.0), 1.0, 0.0, 0.3),
            Generator {
                linear: DMat3::from_cols(DVec3::ZERO, DVec3::X, DVec3::ZERO),
                offset: DVec3::Z,
            },
            Generator {
                linear: general,
                offset: DVec3::new(0.4, -0.7, 0.5),
            },
            Generator::translation(DVec3::new(1.0, 2.0, 3.0)),
        ];
        let single =
            generators.map(|generator| Motion::from_spans(vec![Span::new(generator, 1.0)?]));
        let key = |time: f64, matrix3: DMat3| Keyframe {
            time,
            pose: DAffine3 {
                matrix3,
                translation: DVec3::splat(time),
            },
        };
        let sheared = DMat3::from_cols(
            DVec3::X,
            DVec3::new(0.7, 1.0, 0.0),
            DVec3::new(0.0, 0.3, 2.0),
        );
        let chain = Motion::from_keyframes(&[
            key(0.0, sheared),
            key(1.0, DMat3::from_quat(DQuat::from_rotation_x(1.0)) * sheared),
            key(2.0, DMat3::IDENTITY),
        ]);
        single
            .into_iter()
            .chain([chain])
            .map(|motion| motion.expect("legal"))
            .collect()
    }

    fn spans(motion: &Motion, detail: f64) -> Vec<SpanPaths> {
        let corners = [CORNER, -CORNER];
        (0..motion.spans().len())
            .map(|index| SpanPaths::of_span(motion, index, &corners, detail))
            .collect()
    }

    #[test]
    fn the_expansion_is_within_the_slack_of_the_pose() {
        for (number, motion) in motions().iter().enumerate() {
            for (index, span) in spans(motion, 0.1).iter().enumerate() {
                for point in [
                    DVec3::ZERO,
                    DVec3::new(1.0, -2.0, 0.5),
                    DVec3::new(300.0, 20.0, -50.0),
                ] {
                    let path = span.path(point);
                    for i in 0..=97 {
                        let time = f64::from(i) / 97.0;
                        let pose = motion.spans()[index].flow().pose_at(time)
                            * motion.joints()[index]
                            * *motion.start_pose();
                        let gap = path
                            .at(time)
                            .distance(pose.inverse().transform_point3(point));
                        let slack = path.slack(path.window_at(time));
                        // Both methods of computing it have an error that the slack bounds.
                        assert!(
                            gap <= 2.0 * slack,
                            "motion {number}: {gap:e} > 2 * {slack:e} at {time}"
                        );
                        assert!(
                            slack < 1e-12 * (1.0 + point.length() + span.backward.offset.length()),
                            "motion {number}: slack {slack:e}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn a_window_stays_within_its_bulge_of_the_chord() {
        for (number, motion) in motions().iter().enumerate() {
            for span in spans(motion, 0.1) {
                let path = span.path(DVec3::new(1.0, -2.0, 0.5));
                for window in 0..span.windows() {
                    let (start, end) = (path.tabulated(2 * window), path.tabulated(2 * window + 2));
                    let stretch = path.window(window, start, end);
                    let chord = (end - start).normalize_or_zero();
                    for i in 0..=10 {
                        let time = stretch.middle_time()
                            + (f64::from(i) / 5.0 - 1.0) * stretch.half_width();
                        let gap = (stretch.at(time) - start)
                            .reject_from(chord + DVec3::splat(1e-300))
                            .length();
                        assert!(
                            gap <= stretch.bulge,
                            "motion {number}: {gap:e} > {:e} at {time}",
                            stretch.bulge
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn the_height_is_the_product_with_the_position_and_the_speed_bounds_its_change() {
        for motion in &motions() {
            let span = &spans(motion, 0.1)[0];
            let path = span.path(DVec3::new(1.0, -2.0, 0.5));
            let window = span.windows() / 2;
            let stretch = path.window(
                window,
                path.tabulated(2 * window),
                path.tabulated(2 * window + 2),
            );
            let (normal, anchor) = (DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.1, 0.2, 0.3));
            let height = stretch.height(normal, anchor);
            for t in [-1.0, -0.3, 0.5, 1.0].map(|t| t * stretch.half_width()) {
                let value = height.iter().rev().fold(0.0, |sum, c| sum * t + c);
                let position = stretch.at(stretch.middle_time() + t);
                assert!(
                    (value - normal.dot(position - anchor)).abs() <= stretch.slack,
                    "height at {t}"
                );
                let travel = position.distance(path.tabulated(2 * window + 1));
                assert!(
                    travel <= stretch.speed() * t.abs() + stretch.slack,
                    "travel {travel} until {t}"
                );
            }
        }
    }
}
