//! A window of time, and the comparison of boxes of two moving trees in it.
//!
//! Boxes are aligned with the largest faces of their shapes. They are compared along the sides of
//! both, and along directions in which something nearby was recently found to be apart. In a window
//! a box moves along a tangent; the deviation of paths from it is bounded.

use super::chart::Chart;
use super::clip::Clipper;
use super::encounter::Encounter;
use super::shape::ShapeNode;
use crate::motion::Generator;
use glam::{DAffine3, DMat3, DVec3};

/// A window of time with both motions.
pub(super) struct Window {
    pub(super) middle: f64,
    pub(super) half: f64,
    /// The sum of |M| h over both movers.
    pub(super) reduced: f64,
    pub(super) charts: [Chart; 2],
    /// Bound on the error of a distance.
    pub(super) slack: f64,
    /// Bound on the deviation of a path from its tangent.
    pub(super) bulge: f64,
    /// The same bound along each of the axes along which boxes are compared.
    bulges: DVec3,
    pub(super) frames: [BoxFrame; 2],
    /// The axes along which boxes of the second are compared.
    pub(super) turn: DMat3,
    /// The axes across the sides of the boxes of the first.
    pub(super) axes: [SeparatingAxis; 3],
    /// Directions in which something was recently found to be apart: things nearby often are, too.
    pub(super) lately: Vec<SeparatingAxis>,
    /// The index of the one that is replaced next.
    oldest: usize,
    pub(super) clipper: Clipper,
    /// The windows of its halves, once they exist.
    pub(super) children: Option<[usize; 2]>,
}

/// The motion of boxes in a window.
pub(super) struct BoxFrame {
    /// The map from the frame of the boxes to the axes along which they are compared.
    pose: DAffine3,
    /// M times the pose: velocities as functions of points of its own frame.
    velocity: DAffine3,
    /// Half the extent of a moved box, from that of the box: entry by entry, the pose and its
    /// possible change in the window.
    extent: DMat3,
    /// The largest sum of a row of |M pose|: how fast a box of size 1 grows.
    pub(super) spin: f64,
}

/// The unit normals of the sides of the boxes of a mover.
fn sides(frame: &BoxFrame) -> [DVec3; 3] {
    let DMat3 {
        x_axis: x,
        y_axis: y,
        z_axis: z,
    } = frame.pose.matrix3;
    [y.cross(z), z.cross(x), x.cross(y)].map(|normal| normal.normalize_or(DVec3::X))
}

/// A rotation with its first axis along the first column, and the second near the second one.
fn orthonormal(matrix: &DMat3) -> DMat3 {
    let third = matrix.x_axis.cross(matrix.y_axis);
    match (matrix.x_axis.try_normalize(), third.try_normalize()) {
        (Some(x), Some(z)) => DMat3::from_cols(x, z.cross(x), z),
        _ => DMat3::IDENTITY,
    }
}

/// Number of terms of paths that are compared first: 0.07^4 / 4! is 1e-6 of the distance from the
/// axis.
const FEW_TERMS: usize = 4;

/// Number of directions that a window remembers.
const AXES: usize = 3;

/// A direction, as heights and their rates in the frames of both movers.
#[derive(Clone, Copy)]
pub(super) struct SeparatingAxis {
    pub(super) direction: DVec3,
    sides: [FrameHeights; 2],
    /// Bound on the deviation of a path from its tangent in this direction.
    bulge: f64,
}

/// Heights in the world of points of a mover's own frame, and what a box adds to the height of its
/// centre.
#[derive(Clone, Copy)]
struct FrameHeights {
    height: DVec3,
    offset: f64,
    rate: DVec3,
    rate_offset: f64,
    extent: DVec3,
}

impl SeparatingAxis {
    /// - `direction`: in the frame of the boxes. `bulge`: bound on the deviation of a path from its
    ///   tangent in that direction.
    fn new(direction: DVec3, bulge: f64, frames: &[BoxFrame; 2], half: f64) -> SeparatingAxis {
        let side = |which: usize| {
            let BoxFrame { pose, velocity, .. } = &frames[which];
            let height = pose.matrix3.transpose() * direction;
            let rate = velocity.matrix3.transpose() * direction;
            FrameHeights {
                height,
                offset: direction.dot(pose.translation),
                rate,
                rate_offset: direction.dot(velocity.translation),
                extent: height.abs() + rate.abs() * half,
            }
        };
        SeparatingAxis {
            direction,
            sides: [side(0), side(1)],
            bulge,
        }
    }

    /// The gap between two boxes in this direction at all times up to `longest` from the middle;
    /// negative when there is none.
    pub(super) fn gap(&self, nodes: [&ShapeNode; 2], longest: f64) -> f64 {
        let [a, b] = &self.sides;
        let [p, q] = nodes;
        let apart = a.height.dot(p.centre) + a.offset - (b.height.dot(q.centre) + b.offset);
        let rate = a.rate.dot(p.centre) + a.rate_offset - (b.rate.dot(q.centre) + b.rate_offset);
        let extent = a.extent.dot(p.half) + b.extent.dot(q.half);
        apart.abs() - rate.abs() * longest - extent - self.bulge
    }
}

/// A box in the world over a window: its centre and velocity in the middle, and the half extent
/// that contains it, apart from the displacement of the centre.
pub(super) struct Moved {
    centre: DVec3,
    velocity: DVec3,
    extent: DVec3,
}

impl BoxFrame {
    /// - `turned`: from the frame of the boxes to that of the shape. `axes`: the axes along which
    ///   boxes are compared.
    fn new(chart: &Chart, turned: &DMat3, axes: &DMat3, half: f64) -> BoxFrame {
        let Generator { linear, offset } = chart.generator;
        let own = chart.pose.matrix3 * *turned;
        let place = chart.pose.translation;
        let back = axes.transpose();
        let pose = DAffine3 {
            matrix3: back * own,
            translation: back * place,
        };
        let velocity = DAffine3 {
            matrix3: back * (linear * own),
            translation: back * (linear * place + offset),
        };
        let spin = velocity.matrix3.abs();
        BoxFrame {
            pose,
            extent: pose.matrix3.abs() + spin * half,
            spin: (spin.x_axis + spin.y_axis + spin.z_axis).max_element(),
            velocity,
        }
    }

    pub(super) fn moved(&self, node: &ShapeNode) -> Moved {
        Moved {
            centre: self.pose.transform_point3(node.centre),
            velocity: self.velocity.transform_point3(node.centre),
            extent: self.extent * node.half,
        }
    }
}

impl Window {
    pub(super) fn new(encounter: &Encounter, middle: f64, half: f64) -> Window {
        let movers = &encounter.movers;
        let reduced = half * (movers[0].size + movers[1].size);
        let charts = [0, 1].map(|which| movers[which].chart(middle, half, reduced));
        let slack = charts[0].slack + charts[1].slack;
        // Along the boxes of the second, which are thin where its faces are flat.
        let turned = [0, 1].map(|which: usize| encounter.shapes[which].frame);
        let axes = orthonormal(&(charts[1].pose.matrix3 * turned[1]));
        let frames =
            [0, 1].map(|which: usize| BoxFrame::new(&charts[which], &turned[which], &axes, half));
        let departs = |acceleration: f64| 0.5 * half * half * acceleration;
        let bulge = departs(charts[0].acceleration + charts[1].acceleration);
        let along =
            |direction: DVec3| departs(charts[0].bend(direction) + charts[1].bend(direction));
        let bulges = DVec3::new(along(axes.x_axis), along(axes.y_axis), along(axes.z_axis));
        let sides = sides(&frames[0]);
        let axis = |side: DVec3| SeparatingAxis::new(side, along(axes * side), &frames, half);
        Window {
            middle,
            half,
            reduced,
            slack,
            bulge,
            bulges,
            clipper: Clipper::new(
                [charts[0].generator, charts[1].generator],
                [movers[0].size, movers[1].size],
                half,
                [charts[0].stretch, charts[1].stretch],
            ),
            axes: sides.map(axis),
            frames,
            charts,
            lately: Vec::with_capacity(AXES),
            oldest: 0,
            turn: axes,
            children: None,
        }
    }

    /// Remembers a direction.
    pub(super) fn remember(&mut self, direction: DVec3) {
        let bend = self.charts[0].bend(direction) + self.charts[1].bend(direction);
        let bulge = 0.5 * self.half * self.half * bend;
        let seen = self.turn.transpose() * direction;
        let axis = SeparatingAxis::new(seen, bulge, &self.frames, self.half);
        if self.lately.len() < AXES {
            self.lately.push(axis);
        } else {
            self.lately[self.oldest] = axis;
            self.oldest = (self.oldest + 1) % AXES;
        }
    }

    /// Both motions with paths of few terms.
    pub(super) fn coarse(&self) -> [Chart; 2] {
        let mut charts = self.charts.clone();
        charts.iter_mut().for_each(|chart| chart.shorten(FEW_TERMS));
        charts
    }

    /// Whether in one of the directions two boxes are farther apart than `reach` during a stretch.
    pub(super) fn separates(
        &self,
        nodes: [&ShapeNode; 2],
        reach: f64,
        [from, to]: [f64; 2],
    ) -> bool {
        let longest = from.abs().max(to.abs());
        let pad = self.slack + reach;
        for axis in &self.lately {
            if axis.gap(nodes, longest) > pad {
                return true;
            }
        }
        for axis in &self.axes {
            if axis.gap(nodes, longest) > pad {
                return true;
            }
        }
        false
    }

    /// The part of a stretch during which two boxes, in either order, may be closer than `reach`.
    pub(super) fn entered(
        &self,
        a: &Moved,
        b: &Moved,
        reach: f64,
        stretch: [f64; 2],
    ) -> Option<[f64; 2]> {
        let extent = a.extent + b.extent + self.bulges + (self.slack + reach);
        let (offset, velocity) = (a.centre - b.centre, a.velocity - b.velocity);
        let [mut from, mut to] = stretch;
        let way = velocity.abs() * from.abs().max(to.abs());
        if (offset.abs() - extent).cmpgt(way).any() {
            return None;
        }
        for axis in 0..3 {
            let speed = velocity[axis];
            if speed == 0.0 {
                continue;
            }
            let (low, high) = (-extent[axis] - offset[axis], extent[axis] - offset[axis]);
            let inverse = 1.0 / speed;
            let (one, other) = (low * inverse, high * inverse);
            from = from.max(one.min(other));
            to = to.min(one.max(other));
        }
        (from <= to).then_some([from, to])
    }

    /// A lower bound of the distance of two boxes during a stretch.
    pub(super) fn gap(&self, a: &Moved, b: &Moved, [from, to]: [f64; 2]) -> f64 {
        let extent = a.extent + b.extent + self.bulges + self.slack;
        let (offset, velocity) = (a.centre - b.centre, a.velocity - b.velocity);
        let (start, end) = (offset + velocity * from, offset + velocity * to);
        // Along an axis, the boxes stay this far apart if they do not change sides.
        let apart = start.abs().min(end.abs());
        let apart = DVec3::select((start * end).cmpgt(DVec3::ZERO), apart, DVec3::ZERO);
        (apart - extent).max(DVec3::ZERO).length()
    }
}
