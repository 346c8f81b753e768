//! Two shapes, both in motion, over one stretch of the clock.

use super::depth::PlacedSolid;
use super::distance::Still;
use super::mover::Mover;
use super::shape::Shape;
use crate::numeric::area::area_vector;
use crate::watch::Work;
use glam::{DAffine3, DVec3};

/// Two moving shapes over one stretch of the clock; local time runs from 0 to 1.
pub(super) struct Encounter<'a> {
    pub(super) shapes: [&'a Shape; 2],
    pub(super) movers: [Mover; 2],
    /// The mover that carries the frame in which both are given; `None` for the world.
    carrier: Option<Mover>,
    /// The work that the encounter is a part of: a search that is stopped ends like one that has
    /// used up its work, and the check ends without an answer.
    pub(super) work: Work<'a>,
}

impl<'a> Encounter<'a> {
    /// - `movers`: the movers of both, in the world.
    pub(super) fn new(shapes: [&'a Shape; 2], movers: [Mover; 2]) -> Encounter<'a> {
        match Mover::relative(&movers) {
            None => Encounter {
                shapes,
                movers,
                carrier: None,
                work: Work::UNWATCHED,
            },
            Some(relative) => {
                let [_, second] = movers;
                Encounter {
                    shapes,
                    movers: relative,
                    carrier: Some(second),
                    work: Work::UNWATCHED,
                }
            }
        }
    }

    /// The same encounter, as a part of some work.
    pub(super) fn during(self, work: Work<'a>) -> Encounter<'a> {
        Encounter { work, ..self }
    }

    /// The same encounter, with a part of one of the shapes in its place.
    pub(super) fn with<'b>(&'b self, which: usize, part: &'b Shape) -> Encounter<'b> {
        let mut shapes: [&'b Shape; 2] = self.shapes;
        shapes[which] = part;
        Encounter {
            shapes,
            movers: self.movers.clone(),
            carrier: self.carrier.clone(),
            work: self.work,
        }
    }

    /// The map from the frame in which both are given to the world, at a local time.
    pub(super) fn to_world(&self, time: f64) -> DAffine3 {
        match &self.carrier {
            None => DAffine3::IDENTITY,
            Some(carrier) => carrier.pose(time) * self.movers[1].pose(time).inverse(),
        }
    }
    /// Points of the frame in which both are given, in the world at a local time.
    pub(super) fn in_world(&self, points: [DVec3; 2], time: f64) -> [DVec3; 2] {
        let world = self.to_world(time);
        points.map(|point| world.transform_point3(point))
    }

    /// The number of windows of equal width with which a search over the whole time starts.
    pub(super) fn cover(&self) -> u32 {
        let turned = (0.5 * (self.movers[0].size + self.movers[1].size) / WIDEST).ceil();
        let boxes: usize = self.shapes.iter().map(|shape| shape.nodes.len()).sum();
        let fewest = if boxes >= MANY { SHARES } else { 1.0 };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped"
        )]
        let count = turned.clamp(fewest, MOST_WINDOWS) as u32;
        count
    }

    /// Number of triangles of both shapes.
    pub(super) fn triangles(&self) -> usize {
        self.shapes.iter().map(|shape| shape.len()).sum()
    }

    /// Both shapes at a local time.
    pub(super) fn still(&self, time: f64) -> Still<'_> {
        Still {
            shapes: self.shapes,
            poses: [0, 1].map(|which: usize| self.movers[which].pose(time)),
            work: self.work,
        }
    }

    /// One of the shapes as a solid at a local time.
    pub(super) fn solid(&self, which: usize, time: f64) -> PlacedSolid<'a> {
        PlacedSolid::new(self.shapes[which], self.movers[which].pose(time))
    }

    /// The outward unit normal of a triangle at a local time; `None` for a triangle without area.
    pub(super) fn normal(&self, which: usize, triangle: u32, time: f64) -> Option<DVec3> {
        let pose = self.movers[which].pose(time);
        let corners = self.shapes[which].corners(triangle);
        area_vector(corners.map(|corner| pose.transform_point3(corner))).try_normalize()
    }

    /// The vector from the centre of the second shape to that of the first, halfway in time.
    pub(super) fn between_centres(&self) -> DVec3 {
        let [a, b] = [0, 1].map(|which: usize| self.movers[which].centre_at(0.5));
        a - b
    }

    /// Bound on the error of a distance at a local time.
    pub(super) fn slack(&self, time: f64) -> f64 {
        self.movers
            .iter()
            .map(|mover| mover.chart(time, 0.0, 0.0).slack)
            .sum()
    }

    /// Largest speed of any point relative to any other during `duration` from a local time on.
    pub(super) fn speed_within(&self, time: f64, duration: f64) -> f64 {
        self.movers
            .iter()
            .map(|mover| mover.speed_within(time, duration))
            .sum()
    }

    /// Largest speed of any point relative to any other at a local time.
    pub(super) fn speed(&self, time: f64) -> f64 {
        self.movers.iter().map(|mover| mover.speed(time)).sum()
    }
}

/// Largest |M| h, over both movers, of the windows with which a search starts: the path of a point
/// then departs from its tangent by half of its square.
const WIDEST: f64 = 0.5;

/// Most windows with which a search starts; beyond, they are wider, and are halved more often.
const MOST_WINDOWS: f64 = 1e6;

/// Number of boxes of both shapes from which on even straight paths are cut into several windows,
/// so that several threads can work on them.
const MANY: usize = 2_000;

/// Fewest windows into which these are cut.
const SHARES: f64 = 4.0;
