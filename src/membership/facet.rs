//! A triangle of the body, prepared to be crossed by paths.

use super::event::Event;
use super::height::Height;
use super::path::Stretch;
use super::touch::Region;
use crate::numeric::area::{THIN, area_vector};
use crate::numeric::roots::Zero;
use crate::numeric::tolerance::{ROOT_RESOLUTION, UNIT_ROUNDOFF};
use glam::DVec3;

/// A triangle as an intersection of half spaces with a plane. All normals are unit vectors: heights are lengths.
#[derive(Debug, Clone)]
pub(super) struct Facet {
    /// Outward normal of the plane, through `corners[0]`.
    normal: DVec3,
    corners: [DVec3; 3],
    /// In the plane, inward; of the edge from `corners[k]` to the next corner.
    inward: [DVec3; 3],
    /// How far the plane, as computed, departs from the triangle at most.
    error: f64,
}

impl Facet {
    /// - `least_height`: what rounding leaves of a height, from the size of the body.
    ///
    /// `None` for a triangle that is lower than that: what passes through it passes, within rounding, its neighbours.
    pub(super) fn new([a, b, c]: [DVec3; 3], least_height: f64) -> Option<Facet> {
        // From the corner opposite the longest edge the normal is sharpest.
        let lengths = [(c - b).length(), (a - c).length(), (b - a).length()];
        let longest = lengths.into_iter().fold(0.0, f64::max);
        let corners = if lengths[0] == longest {
            [a, b, c]
        } else if lengths[1] == longest {
            [b, c, a]
        } else {
            [c, a, b]
        };
        let area = area_vector(corners);
        if area.length() <= least_height * longest {
            return None;
        }
        let normal = area.normalize();
        let edge = |from: DVec3, to: DVec3| normal.cross(to - from).normalize_or_zero();
        let inward = [
            edge(corners[0], corners[1]),
            edge(corners[1], corners[2]),
            edge(corners[2], corners[0]),
        ];
        let sine =
            area.length() / (corners[0].distance(corners[1]) * corners[0].distance(corners[2]));
        let error = CROSS_ROUNDING / sine.max(THIN) * UNIT_ROUNDOFF * longest;
        Some(Facet {
            normal,
            corners,
            inward,
            error,
        })
    }

    /// Calls `found` for every event between the path over a window and this triangle.
    pub(super) fn meet(&self, stretch: &Stretch, found: &mut Vec<Event>) {
        let bulge = stretch.bulge + self.error;
        let apart = |normal: DVec3, anchor: DVec3| {
            let heights = [
                normal.dot(stretch.start - anchor),
                normal.dot(stretch.end - anchor),
            ];
            let sign = heights[0].signum();
            if heights[0].abs() > bulge && heights[1] * sign > bulge {
                sign
            } else {
                0.0
            }
        };
        if apart(self.normal, self.corners[0]) != 0.0
            || (0..3).any(|k| apart(self.inward[k], self.corners[k]) < 0.0)
        {
            return;
        }
        let slack = stretch.slack + self.error;
        let middle = stretch.middle_time();
        let reach = stretch.half_width();
        let height = Height::new(stretch, self.normal, self.corners[0]);
        height.zeros([-reach, reach], slack, |zero| match zero {
            Zero::Crossing {
                time,
                rising,
                window,
            } => {
                let doubt = slack + stretch.speed() * (window[1] - window[0]);
                let depth = self.depth(stretch.at(middle + time));
                if depth < -doubt {
                    return;
                }
                // Near an edge the neighbour may count the same crossing, near the end of a window the next window.
                if depth > doubt && window[0] > -reach && window[1] < reach {
                    found.push(Event {
                        window: window.map(|time| middle + time),
                        times: [middle + time; 2],
                        change: Some(if rising { -1 } else { 1 }),
                    });
                } else {
                    self.touch(stretch, &height, [time; 2], window, found);
                }
            }
            Zero::Flat { times, window } => self.touch(stretch, &height, times, window, found),
        });
    }

    /// During `window` rounding decides whether the path is in the plane: when is it at the triangle?
    ///
    /// - `height`: over the plane. `times`: best guess of the first and last time in the plane.
    fn touch(
        &self,
        stretch: &Stretch,
        height: &Height,
        times: [f64; 2],
        window: [f64; 2],
        found: &mut Vec<Event>,
    ) {
        let [a, b, c] = self.corners;
        let edge = |k: usize| Height::new(stretch, self.inward[k], self.corners[k]);
        // Near a sharp corner a point may be far from the triangle and yet near the half spaces of both edges. With a
        // third one, across the corner, what is within d of all is within sqrt(2) d of the triangle.
        let tip = |corner: DVec3, next: DVec3, last: DVec3| {
            let along = |to: DVec3| (to - corner).normalize_or_zero();
            let inward = (along(next) + along(last)).normalize_or_zero();
            Height::new(stretch, inward, corner)
        };
        let heights = [
            *height,
            height.negative(),
            edge(0),
            edge(1),
            edge(2),
            tip(a, b, c),
            tip(b, c, a),
            tip(c, a, b),
        ];
        let slack = stretch.slack + self.error;
        let reach = stretch.half_width();
        let middle = stretch.middle_time();
        // What is beyond the stretch is the next one's.
        let window = window.map(|time| time.clamp(-reach, reach));
        Region { heights, slack }.touches(window, |[first, last]| {
            found.push(Event {
                window: [
                    middle + first - ROOT_RESOLUTION,
                    middle + last + ROOT_RESOLUTION,
                ],
                times: times.map(|time| middle + time.clamp(first, last)),
                change: None,
            });
        });
    }

    /// Least distance to the lines of the edges, negative outside of the triangle, of a point near its plane.
    fn depth(&self, point: DVec3) -> f64 {
        let depths = self
            .inward
            .iter()
            .zip(&self.corners)
            .map(|(inward, &corner)| inward.dot(point - corner));
        depths.fold(f64::INFINITY, f64::min)
    }
}

/// Unit roundoffs by which a cross product of two edges may be off, relative to the product of their lengths.
const CROSS_ROUNDING: f64 = 4.0;
