//! Follows a point that is deeper in an obstacle than allowed, for as long as that is certain.
//!
//! A point of the body stays that deep as long as it keeps its distance from the obstacle's
//! surface. A point that rests in a closed obstacle keeps its depth; it counts while it is in the
//! body, and so until the body's surface reaches it. Each case is a search for the first time at
//! which a single point comes too near a surface. Where a body slides inside an obstacle, the first
//! kind of point lasts long; where an edge of the obstacle runs along the body, the second kind
//! does.

use super::deepest;
use super::encounter::Encounter;
use super::engulfed::{self, Engulfed};
use super::search::Search;
use super::shape::Shape;
use super::sinking::{Deep, Sinking};
use glam::DVec3;

/// Most pairs of boxes that are examined in one window for one point.
const MOST_WORK: usize = 1_000_000;

/// Most cells that are examined for the parts that the body contains.
const MOST_CELLS: usize = 2_000;

/// A point that is too deep, and the condition that keeps it so.
#[derive(Debug, Clone, Copy)]
pub(super) struct Follower {
    /// The number of the shape that carries it.
    carrier: usize,
    /// Its position in the frame of that shape.
    own: DVec3,
    /// It is too deep while it is farther than this from the surface of the other shape.
    keeps: f64,
}

impl Follower {
    /// A follower for a point of the world that rests in a closed obstacle and that the body
    /// contains at a time.
    pub(super) fn resting(encounter: &Encounter, point: DVec3, time: f64) -> Follower {
        let pose = encounter.movers[1].pose(time);
        Follower {
            carrier: 1,
            own: pose.inverse().transform_point3(point),
            keeps: 0.0,
        }
    }

    /// A follower for a point of a surface that is too deep.
    pub(super) fn on_surface(sinking: &Sinking, deep: &Deep) -> Follower {
        Follower {
            carrier: sinking.surface,
            own: sinking.own(deep),
            keeps: sinking.depth,
        }
    }
}

/// A time until which a point that is too deep at `from` certainly stays so.
pub(super) fn until(encounter: &Encounter, point: Follower, from: f64) -> f64 {
    let shape = Shape::point(point.own);
    let alone = encounter.with(point.carrier, &shape);
    let width = 1.0 / f64::from(alone.cover());
    let mut start = from;
    while start < 1.0 {
        let end = (start + width).min(1.0);
        let half = 0.5 * (end - start);
        let found =
            Search::new(&alone, point.keeps).first([start + half, half], MOST_WORK, &|| {
                encounter.work.check().is_err()
            });
        let until = found.map_or(start, |first| first.bracket[0].min(first.unknown));
        if until < end {
            return until.max(start);
        }
        start = end;
    }
    1.0
}

/// Points that are too deep at a time; empty when none are found.
pub(super) fn deep_points(sinking: &Sinking, time: f64) -> Vec<Follower> {
    let encounter = sinking.encounter;
    let is_solid = encounter.shapes[1].closed();
    if let Some(deep) = deepest::point(sinking, time) {
        let mut points = vec![Follower::on_surface(sinking, &deep)];
        if is_solid {
            points.extend(within(sinking, &deep, time));
        }
        return points;
    }
    if !is_solid {
        return Vec::new();
    }
    match engulfed::at(encounter, time, sinking.depth, MOST_CELLS) {
        Engulfed::Point(point) => {
            let pose = encounter.movers[0].pose(time);
            let carried = Follower {
                carrier: 0,
                own: pose.inverse().transform_point3(point),
                keeps: sinking.depth,
            };
            vec![Follower::resting(encounter, point, time), carried]
        }
        Engulfed::Nothing | Engulfed::Unknown => Vec::new(),
    }
}

/// A point of the obstacle in the body, near a point of its surface that is too deep.
fn within(sinking: &Sinking, deep: &Deep, time: f64) -> Option<Follower> {
    let encounter = sinking.encounter;
    let sounding = sinking.sound(deep, time);
    let inward = -encounter.normal(0, deep.triangle, time)?;
    let point = sounding.nearest.points[0] + inward * (0.5 * (sounding.depth - sinking.depth));
    let depth = encounter.solid(1, time).sound(point).depth;
    let least = depth * (-encounter.movers[1].growth()).exp();
    let is_certain = sinking.is_deep(least, 1.0) && encounter.solid(0, time).contains(point);
    is_certain.then(|| Follower::resting(encounter, point, time))
}
