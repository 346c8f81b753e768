//! Does a body hold a part of a solid obstacle that is deeper than allowed, though its own surface is nowhere as deep?
//!
//! Let E be the points of the obstacle that are farther from its surface than allowed. E rests in the obstacle's frame. While the
//! surface of the body does not reach E, the number of times that it winds round a point of E stays what it is: so what the
//! body does not hold of E at the start it never will, before its surface gets there. One question at the start is enough.
//!
//! A connected part of E within the body has a deepest point. Nearest to a deepest point are faces that face away from each other: if
//! all faces that may be nearest to the points of a cell lead away from one half space, depth grows throughout it in one direction, and
//! no deepest point is in it. (At an edge or a corner of the obstacle the shortest way out is a combination of the normals there,
//! since the ball around the deepest point lies within.) Cells are divided until they are shallow, outside of the body, lead away
//! from a half space, or a point of them answers the question. Only thin places of the obstacle take small cells.
//!
//! Shells of one obstacle that overlap each other are taken as they stand: walls inside of it are surface as well.

use super::depth::Solid;
use super::halfspace::away;
use super::nearest::Part;
use super::window::Encounter;
use crate::bounds::box_corners;
use crate::numeric::area::area_vector;
use glam::{DAffine3, DVec3};

/// What became of the question.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Engulfed {
    /// The body holds nothing as deep.
    Nothing,
    /// It holds this point, in the world.
    Point(DVec3),
    /// The limit on work was reached.
    Unknown,
}

/// Cells that are looked at, a second of work.
pub(super) const MOST_CELLS: usize = 200_000;

/// Faces near a cell that are compared; where there are more it is divided.
const MOST_FACES: usize = 128;

/// Least product of a direction with the normals near a cell, far above their rounding.
const LEANING: f64 = 1e-6;

/// Errors of position by which a point has to be inside and deep.
const CERTAIN: f64 = 2.0;

impl Encounter<'_> {
    /// Whether the first shape holds a point of the second that is deeper in it than `depth`, at a local time.
    ///
    /// - `most_cells`: limit on work.
    ///
    /// What is certain to be found is what the surface of the first shape has not reached.
    pub(super) fn engulfed(&self, time: f64, depth: f64, most_cells: usize) -> Engulfed {
        let slack = self.slack(time);
        let [body, obstacle] = [0, 1]
            .map(|which: usize| Solid::new(self.shapes[which], self.movers[which].pose(time)));
        let [(low, high), (other_low, other_high)] = [0, 1].map(|which: usize| {
            let pose = self.movers[which].pose(time);
            placed(self.shapes[which].bounds(), &pose)
        });
        let (low, high) = (low.max(other_low), high.min(other_high));
        if low.cmpgt(high).any() {
            return Engulfed::Nothing;
        }
        let half = (0.5 * (high - low).max_element()).max(slack);
        let mut open = vec![(low.midpoint(high), half)];
        let mut count = 0;
        while let Some((centre, half)) = open.pop() {
            count += 1;
            if count > most_cells {
                return Engulfed::Unknown;
            }
            let reach = half * 3.0_f64.sqrt() * (1.0 + f64::EPSILON) + slack;
            let there = obstacle.sound(centre).depth;
            if there + reach <= depth {
                continue;
            }
            let here = body.sound(centre).depth;
            if here + reach <= 0.0 {
                continue;
            }
            if there > depth + CERTAIN * slack && here > CERTAIN * slack {
                return Engulfed::Point(centre);
            }
            if is_nowhere_deepest(&obstacle, centre, there.abs(), reach, depth) {
                continue;
            }
            let quarter = 0.5 * half;
            let middles = [-quarter, quarter].map(|shift| centre + DVec3::splat(shift));
            open.extend(box_corners(middles).map(|middle| (middle, quarter)));
        }
        Engulfed::Nothing
    }
}

/// Whether the faces near a cell say that it holds no deepest point, or none that is deeper than `depth`.
///
/// - `there`: distance of its centre from the surface. `reach`: of its points from the centre.
fn is_nowhere_deepest(obstacle: &Solid, centre: DVec3, there: f64, reach: f64, depth: f64) -> bool {
    let mut normals = Vec::new();
    // Faces that lie under all of the cell: their distance is a height.
    let mut under: Vec<(DVec3, f64)> = Vec::new();
    let mut count = 0;
    obstacle.for_each_within(centre, there + 2.0 * reach, |triangle, near| {
        count += 1;
        let corners = obstacle.corners(triangle);
        // Triangles without area have neighbours with the same points.
        if let Some(normal) = area_vector(corners).try_normalize() {
            normals.push(normal);
            if near.parts[1] == Part::Inside && is_around(&corners, normal, near.points[1], reach) {
                under.push((normal, near.distance()));
            }
        }
        count <= MOST_FACES
    });
    if count > MOST_FACES {
        return false;
    }
    // No point is deeper than the mean of its distances from two of them, which changes little between faces that are opposite.
    let is_thin = under.iter().enumerate().any(|(k, (normal, height))| {
        under[..k].iter().any(|(other, other_height)| {
            0.5 * (height + other_height + (*normal + *other).length() * reach) <= depth
        })
    });
    is_thin || away(&normals).is_some_and(|(_, product)| product > LEANING)
}

/// Whether a point of a triangle is farther than `reach` from its sides.
fn is_around([a, b, c]: &[DVec3; 3], normal: DVec3, point: DVec3, reach: f64) -> bool {
    [(a, b), (b, c), (c, a)].iter().all(|(from, to)| {
        let inward = normal.cross(**to - **from).normalize_or_zero();
        inward.dot(point - **from) > reach
    })
}

/// A box around a box in a pose.
fn placed([low, high]: [DVec3; 2], pose: &DAffine3) -> (DVec3, DVec3) {
    let centre = pose.transform_point3(low.midpoint(high));
    let half = pose.matrix3.abs() * (0.5 * (high - low));
    (centre - half, centre + half)
}
