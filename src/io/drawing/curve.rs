//! The curves of drawings, and the polylines that replace them.

use crate::numeric::closest::distance_in_plane;
use glam::{DAffine2, DMat2, DVec2, DVec3, Vec3Swizzles};
use std::f64::consts::{FRAC_PI_4, TAU};

/// Deepest halving of a Bézier curve. Each halving brings the control points four times closer to
/// the chord: 40 reach the rounding of any curve.
const DEEPEST: u32 = 40;

/// A piece of a drawing, as the file gives it.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::io) enum Curve {
    /// From end to end.
    Line([DVec2; 2]),
    /// Part of an ellipse: centre + axes (cos t, sin t), t from `start` by `sweep`.
    Arc {
        centre: DVec2,
        axes: DMat2,
        start: f64,
        sweep: f64,
    },
    /// Rational Bézier curve of any degree: per control point, coordinates times weight, and
    /// weight, above 0.
    Bezier(Vec<DVec3>),
}

impl Curve {
    /// A circular arc; `start` and `sweep` in radians, counter-clockwise.
    pub(in crate::io) fn circular(centre: DVec2, radius: f64, start: f64, sweep: f64) -> Curve {
        Curve::Arc {
            centre,
            axes: DMat2::from_diagonal(DVec2::splat(radius)),
            start,
            sweep,
        }
    }

    /// A Bézier curve without weights.
    pub(in crate::io) fn bezier(controls: &[DVec2]) -> Curve {
        Curve::Bezier(controls.iter().map(|p| p.extend(1.0)).collect())
    }

    /// The point at a share of the parameter, from 0 to 1.
    pub(in crate::io) fn point_at(&self, share: f64) -> DVec2 {
        match self {
            Curve::Line([a, b]) if share == 1.0 => *b,
            Curve::Line([a, b]) => a + (b - a) * share,
            Curve::Arc {
                centre,
                axes,
                start,
                sweep,
            } => {
                // A whole turn ends where it began, to the last bit.
                let share = if sweep.abs() == TAU {
                    share.fract()
                } else {
                    share
                };
                centre + *axes * DVec2::from_angle(start + share * sweep)
            }
            Curve::Bezier(controls) if share == 0.0 => place(controls[0]),
            Curve::Bezier(controls) => {
                let mut points = controls.clone();
                for level in (1..points.len()).rev() {
                    (0..level).for_each(|i| points[i] = points[i].lerp(points[i + 1], share));
                }
                place(points[0])
            }
        }
    }

    /// Its start and its end.
    pub(in crate::io) fn ends(&self) -> [DVec2; 2] {
        match self {
            Curve::Bezier(controls) => [place(controls[0]), place(controls[controls.len() - 1])],
            _ => [self.point_at(0.0), self.point_at(1.0)],
        }
    }

    /// The image under an affine map.
    pub(in crate::io) fn transformed(&self, map: &DAffine2) -> Curve {
        match self {
            Curve::Line(ends) => Curve::Line(ends.map(|p| map.transform_point2(p))),
            Curve::Arc {
                centre,
                axes,
                start,
                sweep,
            } => Curve::Arc {
                centre: map.transform_point2(*centre),
                axes: map.matrix2 * *axes,
                start: *start,
                sweep: *sweep,
            },
            Curve::Bezier(controls) => Curve::Bezier(
                controls
                    .iter()
                    .map(|p| (map.matrix2 * p.xy() + map.translation * p.z).extend(p.z))
                    .collect(),
            ),
        }
    }

    /// A box [min, max] that contains the curve.
    pub(in crate::io) fn bounds(&self) -> [DVec2; 2] {
        let around = |points: &mut dyn Iterator<Item = DVec2>| {
            points.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[low, high], p| {
                [low.min(p), high.max(p)]
            })
        };
        match self {
            Curve::Line(ends) => around(&mut ends.iter().copied()),
            Curve::Arc { centre, axes, .. } => {
                let reach = DVec2::new(axes.row(0).length(), axes.row(1).length());
                [centre - reach, centre + reach]
            }
            Curve::Bezier(controls) => around(&mut controls.iter().map(|p| place(*p))),
        }
    }

    /// Whether it is straight, so that nothing is lost when it becomes a polyline.
    pub(in crate::io) fn is_straight(&self) -> bool {
        match self {
            Curve::Line(_) => true,
            Curve::Arc { .. } => false,
            Curve::Bezier(controls) => controls.len() == 2,
        }
    }

    /// Appends the corners of a polyline that replaces the curve, without its start; false when
    /// there would be more than `most` of them.
    ///
    /// # Guarantee
    /// The curve and the polyline are within `tolerance` of each other, up to rounding: a chord of
    /// an ellipse is off by at most its larger half axis times 1 - cos(half the step); a Bézier
    /// curve lies in the hull of its control points, and its chord replaces it where all of them
    /// are within `tolerance` of the chord.
    pub(in crate::io) fn flatten(
        &self,
        tolerance: f64,
        most: usize,
        corners: &mut Vec<DVec2>,
    ) -> bool {
        match self {
            Curve::Line([_, end]) => corners.push(*end),
            Curve::Arc { axes, sweep, .. } => {
                let longest = longest_half_axis(*axes);
                // 1 - cos(step / 2) = 2 sin^2(step / 4).
                let step = 4.0 * (tolerance / (2.0 * longest)).sqrt().min(1.0).asin();
                let steps = (sweep.abs() / step.min(FRAC_PI_4)).ceil().max(1.0);
                if steps > most as f64 {
                    return false;
                }
                let steps = steps.to_int_steps();
                corners.extend((1..=steps).map(|i| self.point_at(f64::from(i) / f64::from(steps))));
            }
            Curve::Bezier(controls) => halve(controls, tolerance, DEEPEST, corners),
        }
        corners.len() <= most
    }
}

/// A whole number of steps, at most 2^32 - 1.
trait Steps {
    fn to_int_steps(self) -> u32;
}

impl Steps for f64 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "at least 1, and limited by the caller; the cast saturates"
    )]
    fn to_int_steps(self) -> u32 {
        self as u32
    }
}

fn halve(controls: &[DVec3], tolerance: f64, depth: u32, corners: &mut Vec<DVec2>) {
    let [first, .., last] = controls else { return };
    let chord = [place(*first), place(*last)];
    let near = |p: &DVec3| distance_in_plane(chord, place(*p)) <= tolerance;
    if depth == 0 || controls.iter().all(near) {
        corners.push(chord[1]);
        return;
    }
    let (mut left, mut right, mut points) = (Vec::new(), Vec::new(), controls.to_vec());
    while let [first, .., last] = points[..] {
        left.push(first);
        right.push(last);
        points = points
            .windows(2)
            .map(|pair| pair[0].midpoint(pair[1]))
            .collect();
    }
    left.push(points[0]);
    right.push(points[0]);
    right.reverse();
    halve(&left, tolerance, depth - 1, corners);
    halve(&right, tolerance, depth - 1, corners);
}

/// The point that a control point with its weight stands for.
fn place(control: DVec3) -> DVec2 {
    control.xy() / control.z
}

/// Largest singular value of the axes of an ellipse.
fn longest_half_axis(axes: DMat2) -> f64 {
    let [p, q] = [axes.x_axis, axes.y_axis];
    let (sum, difference) = (
        p.length_squared() + q.length_squared(),
        p.length_squared() - q.length_squared(),
    );
    ((sum + difference.hypot(2.0 * p.dot(q))) / 2.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, SQRT_2};

    /// The polyline and the curve are within the tolerance of each other, and the polyline has at
    /// most `most` edges.
    #[track_caller]
    fn check(curve: &Curve, tolerance: f64, most: f64) {
        let mut corners = vec![curve.ends()[0]];
        assert!(
            curve.flatten(tolerance, usize::MAX, &mut corners),
            "no limit"
        );
        assert!(
            corners.len() as f64 <= most + 1.0,
            "{} edges",
            corners.len() - 1
        );
        assert!(
            corners[corners.len() - 1].distance(curve.ends()[1]) < 1e-12,
            "ends where the curve does"
        );
        let distance = |p: DVec2| {
            let edges = corners
                .windows(2)
                .map(|edge| distance_in_plane([edge[0], edge[1]], p));
            edges.fold(f64::INFINITY, f64::min)
        };
        let points: Vec<DVec2> = (0..=2000)
            .map(|i| curve.point_at(f64::from(i) / 2000.0))
            .collect();
        for p in &points {
            assert!(
                distance(*p) <= tolerance * (1.0 + 1e-9),
                "{p} is off by {}",
                distance(*p)
            );
        }
    }

    #[test]
    fn a_circle_is_within_its_tolerance_with_as_few_edges_as_need_be() {
        let circle = Curve::circular(DVec2::new(3.0, -2.0), 2.0, 0.3, TAU);
        for tolerance in [1.0, 1e-2, 1e-4, 1e-6] {
            // Sagitta r (1 - cos(step / 2)).
            let least = TAU / (2.0 * (1.0f64 - tolerance / 2.0).acos());
            check(&circle, tolerance, least.ceil().max(8.0));
        }
    }

    #[test]
    fn an_ellipse_under_a_shear_is_within_its_tolerance() {
        let shear = DAffine2::from_cols(
            DVec2::new(1.0, 0.2),
            DVec2::new(3.0, 0.5),
            DVec2::new(5.0, 6.0),
        );
        let arc = Curve::Arc {
            centre: DVec2::X,
            axes: DMat2::from_diagonal(DVec2::new(2.0, 0.5)),
            start: 1.0,
            sweep: -4.0,
        };
        let moved = arc.transformed(&shear);
        assert!(
            moved
                .point_at(0.25)
                .distance(shear.transform_point2(arc.point_at(0.25)))
                < 1e-14,
            "same points"
        );
        check(&moved, 1e-3, 200.0);
        let [low, high] = moved.bounds();
        assert!((0..100).all(|i| {
            let p = moved.point_at(f64::from(i) / 99.0);
            p.cmpge(low).all() && p.cmple(high).all()
        }));
    }

    #[test]
    fn bezier_curves_of_all_degrees_are_within_their_tolerance() {
        let controls = [
            DVec2::ZERO,
            DVec2::new(0.0, 2.0),
            DVec2::new(3.0, -2.0),
            DVec2::new(3.0, 1.0),
            DVec2::new(5.0, 0.0),
        ];
        for degree in 1..=4 {
            let curve = Curve::bezier(&controls[..=degree]);
            check(&curve, 1e-2, 40.0);
            check(&curve, 1e-5, 1200.0);
        }
        // A curve that turns back on itself.
        check(
            &Curve::bezier(&[DVec2::ZERO, DVec2::X * 4.0, DVec2::X]),
            1e-3,
            60.0,
        );
    }

    #[test]
    fn a_rational_quadratic_with_weight_half_root_two_is_a_quarter_circle() {
        let weight = SQRT_2 / 2.0;
        let curve = Curve::Bezier(vec![
            DVec3::new(1.0, 0.0, 1.0),
            DVec3::new(weight, weight, weight),
            DVec3::new(0.0, 1.0, 1.0),
        ]);
        for i in 0..=10 {
            let p = curve.point_at(f64::from(i) / 10.0);
            assert!((p.length() - 1.0).abs() < 1e-15, "on the circle: {p}");
        }
        // The control point is twice as far from a chord as the curve: 79 pieces, and a power of
        // two.
        check(&curve, 1e-4, 128.0);
    }

    #[test]
    fn a_quarter_of_a_circle_ends_on_the_axes() {
        let [start, end] = Curve::circular(DVec2::ZERO, 1.0, 0.0, FRAC_PI_2).ends();
        assert!(
            start.distance(DVec2::X) < 1e-15 && end.distance(DVec2::Y) < 1e-15,
            "{start} {end}"
        );
    }
}
