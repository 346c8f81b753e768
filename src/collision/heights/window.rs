//! The heights of points over a plane in a short window of time, as polynomials.
//!
//! Key: s the time from the middle of the window, x(s) the path of a point, a(s) that of the point
//! of the plane, n(s) the unit normal, which turns with the plane. The height n . (x - a) is a
//! polynomial to rounding, as in [`Chart`], and a(s) and n(s) are constant for a plane at rest.

use crate::collision::chart::{Chart, LONGEST};
use crate::collision::mover::Mover;
use crate::collision::plane::Plane;
use crate::collision::shape::{Shape, ShapeNode};
use crate::motion::Generator;
use crate::motion::expansion::Curve;
use crate::numeric::roots::{MOST_TERMS, Searched, Zero};
use crate::numeric::tolerance::{CLEARANCE_PRECISION, ROOT_RESOLUTION, UNIT_ROUNDOFF};
use glam::{DAffine3, DVec3};

/// A window of the local time of a stage, and the motion of a body and of a plane in it.
pub(super) struct Window {
    /// Number of the stage.
    pub(super) stage: usize,
    /// The middle, in local time.
    pub(super) middle: f64,
    pub(super) half: f64,
    body: Chart,
    plane: Chart,
    /// The point of the plane in its own frame, and the normal in the world, both in the middle.
    point: DVec3,
    normal: DVec3,
    /// The height that counts as 0.
    level: f64,
    /// Bound on the error of a height.
    pub(super) slack: f64,
}

/// Number of windows that cover a stage.
pub(super) fn windows_in(movers: &[Mover; 2]) -> f64 {
    let [body, plane] = movers;
    (0.5 * (body.size + plane.size) / LONGEST).ceil().max(1.0)
}

impl Window {
    /// One of `count` equal windows of a stage.
    ///
    /// - `movers`: of the body and of the plane, which keeps its shape.
    /// - `level`: the height that counts as 0.
    pub(super) fn new(
        movers: &[Mover; 2],
        plane: &Plane,
        level: f64,
        stage: usize,
        (number, count): (f64, f64),
    ) -> Window {
        let half = 0.5 / count;
        let middle = (2.0 * number + 1.0) * half;
        let reduced = half * (movers[0].size + movers[1].size);
        let [body, carried] = [0, 1].map(|i: usize| movers[i].chart(middle, half, reduced));
        let (normal, slack) = if carried.terms == 1 && carried.pose == DAffine3::IDENTITY {
            // The plane is as it was given: only the difference and the product are rounded.
            let normal = plane.normal();
            let size = normal.abs().dot(plane.point().abs());
            (normal, body.slack + PLANE_ROUNDING * size)
        } else {
            // The direction of the normal is off as well, by as much per unit of distance.
            let normal = plane.placed(&carried.pose).normal();
            (normal, 2.0 * (body.slack + carried.slack))
        };
        Window {
            stage,
            middle,
            half,
            body,
            plane: carried,
            point: plane.point(),
            normal,
            level,
            slack,
        }
    }

    /// The local times at which it starts and ends.
    pub(super) fn times(&self) -> [f64; 2] {
        [self.middle - self.half, self.middle + self.half]
    }

    /// The generator by which the normal turns.
    fn turning(&self) -> Generator {
        Generator {
            offset: DVec3::ZERO,
            ..self.plane.generator
        }
    }

    /// The height of a point of the body.
    pub(super) fn height(&self, point: DVec3) -> Height {
        let path = self.body.curve(point);
        let mut anchor = self.plane.curve(self.point);
        let terms = self.body.terms.max(self.plane.terms);
        let mut coefficients = [0.0; MOST_TERMS];
        if self.plane.terms == 1 {
            for (k, coefficient) in coefficients[..terms].iter_mut().enumerate() {
                *coefficient = self.normal.dot(path.0[k] - anchor.0[k]);
            }
        } else {
            let mut normal = Curve::ORIGIN;
            normal.draw(&self.turning(), self.normal, self.plane.terms);
            for (a, x) in anchor.0.iter_mut().zip(path.0) {
                *a = x - *a;
            }
            for (k, coefficient) in coefficients[..terms].iter_mut().enumerate() {
                *coefficient = (0..=k).map(|i| normal.0[i].dot(anchor.0[k - i])).sum();
            }
        }
        coefficients[0] -= self.level;
        Height {
            coefficients,
            terms,
            half: self.half,
            slack: self.slack,
        }
    }

    /// Bounds on the heights of all points below a node during the window, rounding included.
    ///
    /// By Taylor: the heights in the middle, their slopes there, and a bound on what bends paths
    /// and turns the normal.
    pub(super) fn heights(&self, shape: &Shape, node: &ShapeNode) -> [f64; 2] {
        let (body, plane, n) = (&self.body, &self.plane, self.normal);
        let centre = body.pose.transform_point3(shape.frame * node.centre);
        let carried = body.pose.matrix3 * shape.frame;
        let extent = |direction: DVec3| (carried.transpose() * direction).abs().dot(node.half);
        let anchor = plane.pose.transform_point3(self.point);
        let arm = centre - anchor;
        let middle = n.dot(arm) - self.level;
        let along = body.generator.linear.transpose() * n;
        let mut slope = n.dot(body.generator.velocity(centre)).abs() + extent(along);
        let mut bend = body.bend(n);
        if plane.terms > 1 {
            let rate = plane.generator.linear * n;
            let still = n.dot(plane.generator.velocity(anchor)).abs();
            slope += still + rate.dot(arm).abs() + extent(rate);
            // |n'| and |n''| are at most the rate of turning and its square.
            let turn = plane.reduced_half / self.half;
            let reach = (carried.x_axis.abs() * node.half.x
                + carried.y_axis.abs() * node.half.y
                + carried.z_axis.abs() * node.half.z)
                .length();
            let speeds = body.speed + plane.speed;
            let distance = arm.length() + reach + self.half * speeds;
            bend = body.acceleration + plane.acceleration + turn * (2.0 * speeds + turn * distance);
        }
        let reach =
            extent(n) + self.half * (slope + 0.5 * self.half * bend) + BOX_ROUNDING * self.slack;
        [middle - reach, middle + reach]
    }
}

/// Rounding of a bound on heights, in units of that of a height: the bound itself, the height of the
/// centre, and the slope times at most 0.07 / |M|.
const BOX_ROUNDING: f64 = 4.0;

/// Rounding of the height over a plane at rest, relative to the point of the plane along its normal:
/// a difference, and a product of three terms.
const PLANE_ROUNDING: f64 = 4.0 * UNIT_ROUNDOFF;

/// The least height of a point during a window.
pub(super) struct LeastHeight {
    /// A lower bound of the height at all times.
    pub(super) lower: f64,
    /// The least height seen, and the time from the middle of the window.
    pub(super) seen: f64,
    pub(super) time: f64,
}

/// Relative precision of a least height: half of that of a least distance, so that the rest of the
/// search may add as much.
const PRECISION: f64 = 0.5 * CLEARANCE_PRECISION;

/// A height over a plane as a polynomial of the time from the middle of a window.
pub(super) struct Height {
    coefficients: [f64; MOST_TERMS],
    terms: usize,
    half: f64,
    slack: f64,
}

impl Height {
    pub(super) fn at(&self, time: f64) -> f64 {
        self.value_and_slope(time)[0]
    }

    fn value_and_slope(&self, time: f64) -> [f64; 2] {
        let coefficients = self.coefficients[..self.terms].iter().rev();
        coefficients.fold([0.0; 2], |[value, slope], c| {
            [value * time + c, slope * time + value]
        })
    }

    /// A bound on the second derivative within the window, of the exact height, too: what the
    /// polynomial leaves out is far below the slack, and so bends by less than that in the window.
    fn curvature(&self) -> f64 {
        let bend = (2..self.terms).rev().fold(0.0, |sum, k| {
            sum * self.half + (k * (k - 1)) as f64 * self.coefficients[k].abs()
        });
        bend + self.slack / (self.half * self.half)
    }

    /// The least height during the window.
    ///
    /// - `enough`: pieces of time whose heights are certainly above this are not looked at closely.
    ///
    /// By bisection: within a piece a height is nowhere below the lower one of its ends by more than
    /// the curvature allows. Pieces are cut until that is below rounding, or little of the height.
    pub(super) fn least(&self, enough: f64) -> LeastHeight {
        let curvature = self.curvature();
        let ends = [-self.half, self.half].map(|time| (time, self.at(time)));
        let lower_end = if ends[1].1 < ends[0].1 {
            ends[1]
        } else {
            ends[0]
        };
        let mut least = LeastHeight {
            lower: f64::INFINITY,
            seen: lower_end.1,
            time: lower_end.0,
        };
        let mut open = vec![ends];
        while let Some([from, to]) = open.pop() {
            let width = to.0 - from.0;
            let bulge = curvature * width * width / 8.0;
            let lower = from.1.min(to.1) - bulge;
            let near = (1.0 - PRECISION) * least.seen.min(enough);
            if lower >= near || bulge <= self.slack || width <= ROOT_RESOLUTION {
                least.lower = least.lower.min(lower - self.slack);
                continue;
            }
            let time = from.0 + 0.5 * width;
            let middle = (time, self.at(time));
            if middle.1 < least.seen {
                (least.time, least.seen) = middle;
            }
            open.extend([[from, middle], [middle, to]]);
        }
        least
    }

    /// The times from the middle at which it is zero, or cannot be told from zero; see
    /// [`Searched::zeros`].
    pub(super) fn zeros(&self, found: impl FnMut(Zero)) {
        let searched = Searched {
            function: |time| self.value_and_slope(time),
            curvature: self.curvature(),
            slack: self.slack,
        };
        searched.zeros([-self.half, self.half], found);
    }
}
