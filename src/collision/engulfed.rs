//! Whether a body contains a part of a solid obstacle that is deeper than allowed, though the
//! body's own surface is nowhere as deep.
//!
//! Let E be the points of the obstacle that are farther from its surface than allowed. E rests in
//! the obstacle's frame. As long as the surface of the body does not reach E, the number of times
//! that it winds around a point of E does not change: the body never contains a part of E that it
//! does not contain at the start, before its surface gets there. So one test at the start is
//! enough.
//!
//! A connected part of E within the body has a deepest point. The faces nearest to a deepest point
//! face away from each other: if all faces that may be nearest to the points of a cell lead away
//! from one half space, depth grows throughout the cell in one direction, and it contains no
//! deepest point. (At an edge or a corner of the obstacle, the shortest way out is a combination of
//! the normals there, since the ball around the deepest point lies inside.) Cells are divided until
//! they are shallow, lie outside the body, or lead away from a half space, or until a point of them
//! settles the question. Only thin places of the obstacle need small cells.
//!
//! Shells of one obstacle that overlap each other are taken as they are: walls inside it are
//! surface as well.

use super::depth::PlacedSolid;
use super::encounter::Encounter;
use super::halfspace::away;
use super::innermost;
use super::nearest::nearest;
use super::shape::ShapeNode;
use crate::bounds::box_corners;
use crate::numeric::area::area_vector;
use crate::numeric::tolerance::DEPTH_ROOM;
use crate::watch::Work;
use glam::{DAffine3, DVec3};

/// The answer to the question.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Engulfed {
    /// The body contains nothing that deep.
    Nothing,
    /// It contains this point, in the world.
    Point(DVec3),
    /// The limit on work was reached.
    Unknown,
}

/// Most cells that are examined: a second of work.
pub(super) const MOST_CELLS: usize = 200_000;

/// Number of boxes and triangles that are as much work as a cell: there are many where the faces
/// are about equally near. As many again are allowed for each triangle.
const LOOKED_AT: usize = 128;

/// Most faces near a cell that are compared; where there are more, the cell is divided.
const MOST_FACES: usize = 128;

/// Least product of a direction with the normals near a cell, far above their rounding.
const LEANING: f64 = 1e-6;

/// Number of errors of position by which a point must be inside and deep.
const CERTAIN: f64 = 2.0;

/// Whether the first shape contains a point of the second that is deeper in it than `depth`, at a
/// local time.
///
/// - `most_cells`: limit on work, apart from a part in proportion to the triangles.
///
/// Parts that the surface of the first shape has not reached are certain to be found.
pub(super) fn at(encounter: &Encounter, time: f64, depth: f64, most_cells: usize) -> Engulfed {
    let slack = encounter.slack(time);
    let [body, obstacle] = [0, 1].map(|which: usize| encounter.solid(which, time));
    let [(low, high), (other_low, other_high)] = [0, 1].map(|which: usize| {
        let pose = encounter.movers[which].pose(time);
        placed(encounter.shapes[which].bounds(), &pose)
    });
    let Some((deep_low, deep_high)) = placed_innermost(encounter, 1, time, depth) else {
        return Engulfed::Nothing;
    };
    let (low, high) = (
        low.max(other_low).max(deep_low - slack),
        high.min(other_high).min(deep_high + slack),
    );
    if low.cmpgt(high).any() {
        return Engulfed::Nothing;
    }
    let cells = CellSearch {
        work: encounter.work,
        obstacle,
        body: Some(body),
        slack,
        depth,
    };
    cells.search([low, high], most_cells)
}

/// Whether one of the shapes has no point at all that is deeper in it than `depth`, at any time,
/// because it is too thin.
pub(super) fn is_thin(encounter: &Encounter, which: usize, depth: f64) -> bool {
    if !encounter.movers[which].is_rigid() || !encounter.shapes[which].closed() {
        return false;
    }
    let Some((low, high)) = placed_innermost(encounter, which, 0.0, depth) else {
        return true;
    };
    let cells = CellSearch {
        work: encounter.work,
        obstacle: encounter.solid(which, 0.0),
        body: None,
        slack: encounter.slack(1.0),
        depth,
    };
    cells.search([low, high], MOST_CELLS) == Engulfed::Nothing
}

/// A box in the world around the part of a shape that is deeper in it than `depth`, at a local
/// time; `None` when there is no such part.
fn placed_innermost(
    encounter: &Encounter,
    which: usize,
    time: f64,
    depth: f64,
) -> Option<(DVec3, DVec3)> {
    let ShapeNode { centre, half, .. } = innermost::around(encounter, which, depth)?;
    let frame = DAffine3::from_mat3(encounter.shapes[which].frame);
    let pose = encounter.movers[which].pose(time) * frame;
    Some(placed([centre - half, centre + half], &pose))
}

/// The search cell by cell.
struct CellSearch<'a> {
    work: Work<'a>,
    obstacle: PlacedSolid<'a>,
    /// `None` when it is everywhere.
    body: Option<PlacedSolid<'a>>,
    slack: f64,
    depth: f64,
}

impl CellSearch<'_> {
    fn search(&self, [low, high]: [DVec3; 2], most_cells: usize) -> Engulfed {
        let CellSearch {
            obstacle,
            body,
            slack,
            depth,
            work,
        } = self;
        let (slack, depth) = (*slack, *depth);
        // Points as deep as that up to rounding, such as the middle of a plate twice as thick, do
        // not count as deeper.
        let shallow = depth + DEPTH_ROOM * slack;
        let half = (0.5 * (high - low).max_element()).max(slack);
        let mut open = vec![(low.midpoint(high), half)];
        let most = most_cells + obstacle.triangles();
        let mut count = 0;
        while let Some((centre, half)) = open.pop() {
            count += 1;
            let looked_at = obstacle.looked_at() + body.as_ref().map_or(0, PlacedSolid::looked_at);
            let is_exhausted = count > most_cells || looked_at / LOOKED_AT > most;
            if is_exhausted || work.check().is_err() {
                return Engulfed::Unknown;
            }
            let reach = half * 3.0_f64.sqrt() * (1.0 + f64::EPSILON) + slack;
            let there = obstacle.sound(centre).depth;
            if there + reach <= shallow {
                continue;
            }
            let here = (body.as_ref()).map_or(f64::INFINITY, |body| body.sound(centre).depth);
            if here + reach <= 0.0 {
                continue;
            }
            if there > depth + CERTAIN * slack && here > CERTAIN * slack {
                return Engulfed::Point(centre);
            }
            if is_nowhere_deepest(obstacle, centre, [there.abs(), reach], shallow, slack) {
                continue;
            }
            let quarter = 0.5 * half;
            let middles = [-quarter, quarter].map(|shift| centre + DVec3::splat(shift));
            open.extend(box_corners(middles).map(|middle| (middle, quarter)));
        }
        Engulfed::Nothing
    }
}

/// A triangle near a cell.
struct Face {
    normal: DVec3,
    corners: [DVec3; 3],
    indices: [u32; 3],
    /// The distance of the centre of the cell from the face, and its height over the plane.
    distance: f64,
    height: f64,
}

/// Whether the faces near a cell show that it contains no deepest point, or none that is deeper
/// than `depth`.
///
/// - `there`: distance of its centre from the surface. `reach`: distance of its points from the
///   centre. `slack`: rounding.
fn is_nowhere_deepest(
    obstacle: &PlacedSolid,
    centre: DVec3,
    [there, reach]: [f64; 2],
    depth: f64,
    slack: f64,
) -> bool {
    let mut faces: Vec<Face> = Vec::new();
    let mut count = 0;
    obstacle.for_each_within(centre, there + 2.0 * reach, |triangle, near| {
        count += 1;
        let corners = obstacle.corners(triangle);
        // Triangles without area have neighbours with the same points.
        if let Some(normal) = area_vector(corners).try_normalize() {
            faces.push(Face {
                normal,
                corners,
                indices: obstacle.indices(triangle),
                distance: near.distance(),
                height: normal.dot(centre - corners[0]),
            });
        }
        count <= MOST_FACES
    });
    if count > MOST_FACES {
        return false;
    }
    let normals: Vec<DVec3> = faces.iter().map(|face| face.normal).collect();
    if away(&normals).is_some_and(|(_, product)| product > LEANING) {
        return true;
    }
    // Faces that lie under the whole cell: their distance is a height, up to four errors of
    // position where the foot is off by the root of rounding. No point is deeper than the mean of
    // its distances from two of them, which changes little between opposite faces.
    let under: Vec<&Face> = faces
        .iter()
        .filter(|face| face.distance - face.height.abs() <= slack)
        .filter(|face| is_under(face, &faces, centre, reach, slack))
        .collect();
    under.iter().enumerate().any(|(k, face)| {
        under[..k].iter().any(|other| {
            let turns = (face.normal + other.normal).length() * reach;
            0.5 * (face.distance + other.distance + turns) <= depth
        })
    })
}

/// Whether the foot of a cell's centre on a face is farther than `reach` from the border of the
/// flat part to which the face belongs.
///
/// - `faces`: those near the cell; among faces in one plane, only sides without a neighbour count.
fn is_under(face: &Face, faces: &[Face], centre: DVec3, reach: f64, slack: f64) -> bool {
    let foot = centre - face.normal * face.height;
    let is_level = |corner: &DVec3| face.normal.dot(*corner - face.corners[0]).abs() <= slack;
    let patch: Vec<&Face> = faces
        .iter()
        .filter(|other| other.normal.dot(face.normal) > 0.0 && other.corners.iter().all(is_level))
        .collect();
    let joins = |from: u32, to: u32| {
        patch.iter().any(|other| {
            let [a, b, c] = other.indices;
            [[a, b], [b, c], [c, a]].contains(&[to, from])
        })
    };
    patch.iter().all(|part| {
        (0..3).all(|k: usize| {
            let next = (k + 1) % 3;
            let side = [part.corners[k], part.corners[next], part.corners[next]];
            nearest(&[foot], &side).distance() > reach || joins(part.indices[k], part.indices[next])
        })
    })
}

/// A box around a box in a pose.
fn placed([low, high]: [DVec3; 2], pose: &DAffine3) -> (DVec3, DVec3) {
    let centre = pose.transform_point3(low.midpoint(high));
    let half = pose.matrix3.abs() * (0.5 * (high - low));
    (centre - half, centre + half)
}
