//! A triangle of the body, prepared to be crossed by paths.

use super::event::Event;
use super::path::{DEGREE, Stretch};
use crate::numeric::area::{THIN, area_vector};
use crate::numeric::roots::{Searched, Zero};
use crate::numeric::tolerance::UNIT_ROUNDOFF;
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
    pub(super) fn meet(&self, stretch: &Stretch, slack: f64, found: &mut Vec<Event>) {
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
        let slack = slack + self.error;
        let middle = stretch.middle_time();
        let reach = stretch.half_width();
        Height::new(stretch, self.normal, self.corners[0]).zeros([-reach, reach], slack, |zero| {
            match zero {
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
                    let is_certain = depth > doubt && window[0] > -reach && window[1] < reach;
                    let change = if rising { -1 } else { 1 };
                    let window = window.map(|time| middle + time);
                    found.push(Event {
                        window,
                        times: [middle + time; 2],
                        change: is_certain.then_some(change),
                    });
                }
                Zero::Flat { times, window } => self.slide(stretch, slack, times, window, found),
            }
        });
    }

    /// The path runs in the plane from `start` to `end`: when is it on the triangle?
    fn slide(
        &self,
        stretch: &Stretch,
        slack: f64,
        [start, end]: [f64; 2],
        window: [f64; 2],
        found: &mut Vec<Event>,
    ) {
        let middle = stretch.middle_time();
        // The path may touch the plane a little before and after; the ends of the triangle are sharper than that.
        let [before, after] = [start - window[0], window[1] - end];
        let mut cuts = vec![start, end];
        for (&inward, &corner) in self.inward.iter().zip(&self.corners) {
            let height = Height::new(stretch, inward, corner);
            height.zeros([start, end], slack, |zero| match zero {
                Zero::Crossing { time, .. } => cuts.push(time),
                Zero::Flat { times, .. } => cuts.extend(times),
            });
        }
        cuts.sort_by(f64::total_cmp);
        let doubt = slack + stretch.speed() * before.max(after);
        for pair in cuts.windows(2) {
            let time = pair[0] + (pair[1] - pair[0]) / 2.0;
            if self.depth(stretch.at(middle + time)) >= -doubt {
                found.push(Event {
                    window: [middle + pair[0] - before, middle + pair[1] + after],
                    times: [middle + pair[0], middle + pair[1]],
                    change: None,
                });
            }
        }
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

/// Height of a path over a plane during a window: a polynomial in the time from its middle.
struct Height([f64; DEGREE + 1]);

impl Height {
    fn new(stretch: &Stretch, normal: DVec3, anchor: DVec3) -> Height {
        Height(stretch.height(normal, anchor))
    }

    fn zeros(&self, window: [f64; 2], slack: f64, found: impl FnMut(Zero)) {
        let function = |time: f64| {
            self.0.iter().rev().fold([0.0, 0.0], |[value, slope], c| {
                [value * time + c, slope * time + value]
            })
        };
        let longest = window[1].abs().max(window[0].abs());
        let curvature = self
            .0
            .iter()
            .enumerate()
            .skip(2)
            .rev()
            .fold(0.0, |sum, (j, c)| {
                sum * longest + c.abs() * (j * (j - 1)) as f64
            });
        Searched {
            function,
            curvature,
            slack,
        }
        .zeros(window, found);
    }
}
