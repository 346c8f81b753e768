//! A flat piece of the boundary at rest, prepared to be crossed by paths: a triangle in space, an
//! edge in the plane.

use super::event::Event;
use super::height::Height;
use super::path::Stretch;
use super::touch::HalfSpaces;
use crate::numeric::roots::Zero;
use crate::numeric::tolerance::ROOT_RESOLUTION;
use glam::DVec3;

/// A convex piece of a plane, as the intersection of the plane with half spaces. All normals are
/// unit vectors, so that heights are lengths.
#[derive(Debug, Clone)]
pub(super) struct Patch<const N: usize> {
    /// Outward normal of the plane, which passes through `corners[0]`.
    pub(super) normal: DVec3,
    pub(super) corners: [DVec3; N],
    /// Inward normals in the plane: number k is that of the side through `corners[k]`, in space of
    /// the edge from there to the next corner.
    pub(super) inward: [DVec3; N],
    /// Bound on the distance of the computed plane from the piece.
    pub(super) error: f64,
}

impl<const N: usize> Patch<N> {
    /// Appends every event between the path over a window and this piece.
    ///
    /// - `half_spaces`: from the height over the plane, the heights over half spaces, positive
    ///   inward. A point within a length d of all of them is within sqrt(2) d of the piece.
    pub(super) fn meet_within<const H: usize>(
        &self,
        stretch: &Stretch,
        half_spaces: impl Fn(&Height) -> [Height; H],
        found: &mut Vec<Event>,
    ) {
        let touch = |height: &Height, times, window, found: &mut Vec<Event>| {
            self.touch(stretch, half_spaces(height), times, window, found);
        };
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
            || (0..N).any(|k| apart(self.inward[k], self.corners[k]) < 0.0)
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
                // Near an edge the neighbour may count the same crossing, and near the end of a
                // window the next window may.
                if depth > doubt && window[0] > -reach && window[1] < reach {
                    found.push(Event {
                        window: window.map(|time| middle + time),
                        times: [middle + time; 2],
                        change: Some(if rising { -1 } else { 1 }),
                    });
                } else {
                    touch(&height, [time; 2], window, found);
                }
            }
            Zero::Flat { times, window } => touch(&height, times, window, found),
        });
    }

    /// During `window`, rounding decides whether the path is in the plane: appends the times at
    /// which it is at the piece.
    ///
    /// - `times`: best estimate of the first and the last time in the plane.
    fn touch<const H: usize>(
        &self,
        stretch: &Stretch,
        heights: [Height; H],
        times: [f64; 2],
        window: [f64; 2],
        found: &mut Vec<Event>,
    ) {
        let slack = stretch.slack + self.error;
        let reach = stretch.half_width();
        let middle = stretch.middle_time();
        // Times beyond the stretch belong to the next one.
        let window = window.map(|time| time.clamp(-reach, reach));
        HalfSpaces { heights, slack }.touches(window, |[first, last]| {
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

    /// The height over side `k`, positive inward.
    pub(super) fn over_side(&self, stretch: &Stretch, k: usize) -> Height {
        Height::new(stretch, self.inward[k], self.corners[k])
    }

    /// The least distance from the sides of a point near the plane, negative outside the piece.
    fn depth(&self, point: DVec3) -> f64 {
        let depths = self
            .inward
            .iter()
            .zip(&self.corners)
            .map(|(inward, &corner)| inward.dot(point - corner));
        depths.fold(f64::INFINITY, f64::min)
    }
}
