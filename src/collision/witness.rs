//! The kind of contact that was found: features, place, and what follows.

use super::crossing::Meeting;
use super::distance::{ClosestTriangles, Still};
use super::nearest::Part;
use super::scene::Scene;
use super::search::FoundMeeting;
use super::shape::Shape;
use super::{Feature, FirstContact, Touch, Verdict};
use crate::numeric::area::area_vector;
use glam::DVec3;

pub(super) fn met(
    scene: &Scene,
    stage: usize,
    obstacle: usize,
    found: &FoundMeeting,
    bracket: [f64; 2],
) -> Verdict {
    let meeting = &found.meeting;
    let at_start = stage == 0 && meeting.after <= 0.0;
    let mut closest = ClosestTriangles {
        nearest: meeting.nearest,
        triangles: found.triangles,
    };
    let mut normal = meeting.normal;
    if at_start && scene.settings.clearance > 0.0 {
        // Many pairs may be too close from the start: the nearest one is reported.
        let start = scene.encounter(obstacle, 0);
        if let Some(nearest) = start.still(0.0).closest(closest.nearest.distance()) {
            let [a, b] = nearest.nearest.points;
            normal = (a - b).normalize_or(normal);
            closest = nearest;
        }
    }
    let touch = if at_start
        && (overlap(scene, 0, 0.0, obstacle) || coincides(scene, obstacle, found.triangles))
    {
        Touch::Inside
    } else if meeting.crosses {
        Touch::Enter
    } else {
        touch(scene, stage, meeting, obstacle)
    };
    let world = scene.encounter(obstacle, stage).to_world(meeting.time);
    let stage = &scene.stages[stage];
    let bracket = bracket.map(|time| stage.clock(time));
    let contact = FirstContact {
        time: stage.clock(meeting.time).clamp(bracket[0], bracket[1]),
        bracket,
        span: stage.span,
        obstacle,
        features: features(scene, obstacle, &closest),
        touch,
        point: world.transform_point3(closest.nearest.points[1]),
        normal: world.transform_vector3(normal),
    };
    // Too close from the start, even in contact: then it is reported as contact.
    let touches = closest.nearest.distance() == 0.0;
    if scene.settings.clearance > 0.0 && !touches {
        Verdict::Closer(contact)
    } else {
        Verdict::Contact(contact)
    }
}

fn features(scene: &Scene, obstacle: usize, closest: &ClosestTriangles) -> [Feature; 2] {
    let shapes = [scene.body, scene.obstacles[obstacle].shape];
    [0, 1].map(|which: usize| {
        feature(
            shapes[which],
            closest.triangles[which],
            closest.nearest.parts[which],
        )
    })
}

/// Whether two shapes are certainly closer than the threshold, or overlap, at a local time of a
/// stage.
fn overlap(scene: &Scene, stage: usize, time: f64, obstacle: usize) -> bool {
    let encounter = scene.encounter(obstacle, stage);
    let still = encounter.still(time);
    let slack = encounter.slack(time);
    let threshold = scene.settings.clearance;
    if threshold > 0.0 {
        still.closest(threshold - PROBE_MARGIN * slack).is_some()
    } else {
        still.overlap(PROBE_MARGIN * slack)
    }
}

/// Whether, at the start, the inner side of a triangle of the body is inside an obstacle, though
/// nothing passes through anything: surfaces that lie on each other.
fn coincides(scene: &Scene, obstacle: usize, triangles: [u32; 2]) -> bool {
    let shape = scene.obstacles[obstacle].shape;
    let poses = scene.encounter(obstacle, 0).still(0.0).poses;
    let corners = scene
        .body
        .corners(triangles[0])
        .map(|corner| poses[0].transform_point3(corner));
    let inward = -area_vector(corners).normalize_or_zero();
    let [low, high] = scene.body.bounds();
    let depth = PROBE_DISTANCE * low.distance(high);
    let inner = (corners[0] + corners[1] + corners[2]) / 3.0 + inward * depth;
    inward != DVec3::ZERO
        && scene.settings.clearance == 0.0
        && shape.contains(poses[1].inverse().transform_point3(inner))
}

/// What follows a contact in a stage, judged slightly later.
fn touch(scene: &Scene, stage: usize, meeting: &Meeting, obstacle: usize) -> Touch {
    let time = meeting.by;
    let (stage, time) = if time >= 1.0 && stage + 1 < scene.stages.len() {
        (stage + 1, 0.0)
    } else {
        (stage, time)
    };
    let encounter = scene.encounter(obstacle, stage);
    let speed = encounter.speed(time);
    let size = encounter
        .shapes
        .map(|shape| shape.bounds()[0].distance(shape.bounds()[1]));
    let step = if speed > 0.0 {
        PROBE_DISTANCE * size[0].min(size[1]) / speed
    } else {
        0.0
    };
    let later = time + step;
    if step == 0.0 || later > 1.0 {
        // Nothing follows, or nothing moves.
        return Touch::Touch;
    }
    if overlap(scene, stage, later, obstacle) {
        return Touch::Enter;
    }
    let limit = scene.settings.clearance + PROBE_MARGIN * encounter.slack(later);
    if encounter.still(later).closest(limit).is_none() {
        Touch::Touch
    } else if meeting.closing > SLIDING * speed {
        // Faces that meet flush: nothing passes through anything.
        Touch::Enter
    } else {
        Touch::Slide
    }
}

/// The contact at the start if one of the two contains a part of the other.
pub(super) fn inside(scene: &Scene, obstacle: usize) -> Option<FirstContact> {
    let stage = &scene.stages[0];
    let encounter = scene.encounter(obstacle, 0);
    let still = encounter.still(0.0);
    let (inner, vertex) = still.contained()?;
    let shape = scene.obstacles[obstacle].shape;
    let closest = if inner == 1 && shape.is_point(vertex) {
        // Of a cloud, the point that is inside counts, and not the one nearest to the surface.
        let alone = Shape::point(shape.vertex(vertex));
        let shapes = [still.shapes[0], &alone];
        let mut closest = Still { shapes, ..still }.closest(f64::INFINITY)?;
        closest.triangles[1] = vertex;
        closest
    } else {
        still.closest(f64::INFINITY)?
    };
    let time = stage.times[0];
    let [a, b] = closest.nearest.points;
    Some(FirstContact {
        time,
        bracket: [time; 2],
        span: stage.span,
        obstacle,
        features: features(scene, obstacle, &closest),
        touch: Touch::Inside,
        point: b,
        normal: (a - b).normalize_or(DVec3::Z),
    })
}

/// A part of a triangle of a shape.
pub(super) fn feature(shape: &Shape, triangle: u32, part: Part) -> Feature {
    let corners = shape.indices(triangle);
    if corners == [corners[0]; 3] {
        return Feature::Vertex(corners[0]);
    }
    match part {
        Part::Corner(k) => Feature::Vertex(corners[k]),
        Part::Side(k) => {
            let [a, b] = [corners[k], corners[(k + 1) % 3]];
            Feature::Edge([a.min(b), a.max(b)])
        }
        Part::Inside => Feature::Face(triangle),
    }
}

/// Distance that the fastest point of a contact covers before it is examined again, as a fraction
/// of the size of the smaller body: tangential paths have then parted by some 1e-10 of the size,
/// far more than rounding.
const PROBE_DISTANCE: f64 = 1e-5;

/// Speed along the normal, as a fraction of the largest speed, below which a contact that stays one
/// slides.
const SLIDING: f64 = 1e-6;

/// Number of errors of position by which things must be apart, or overlap, to count as such when a
/// contact is examined again.
const PROBE_MARGIN: f64 = 8.0;
