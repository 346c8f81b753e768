//! The report of a check.

use super::DeviationReport;
use super::place::{PlaceReport, PoseRows, ProgressReport, pose_at_time};
use super::{BodyReport, HalfTurnReport, Seconds};
use crate::body::{Mesh, Surface};
use crate::collision::{
    Check, Clearance, ContactInterval, ContactRule, Feature, Limited, Plane, RelativeMotion, Touch,
    Verdict,
};
use crate::io::{FileNumbers, ReadReport};
use crate::motion::Motion;
use std::path::Path;

/// What `steadysweep check` found. A field that does not apply to the verdict is `None`, in JSON
/// `null`.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct CheckReport {
    /// The answer.
    pub(crate) verdict: VerdictReport,
    /// First time of contact, or first time below the clearance, on the clock of the body's motion.
    pub(crate) time: Option<f64>,
    /// Times between which `time` is certain to lie; with `undecided`, times between which nothing
    /// is proven.
    pub(crate) bracket: Option<[f64; 2]>,
    /// Span of the body's motion that contains `time`, counted from 0.
    pub(crate) span: Option<usize>,
    /// The obstacle that is met.
    pub(crate) obstacle: Option<ObstacleName>,
    /// What kept the verdict from being decided; in JSON it is the `limited` of the `clearance`.
    #[serde(skip)]
    pub(crate) undecided: Option<LimitedReport>,
    /// What meets what.
    pub(crate) features: Option<FeaturesReport>,
    /// How they meet.
    pub(crate) touch: Option<TouchReport>,
    /// The depth from which entering counts as contact; `None` where touching does.
    pub(crate) depth: Option<f64>,
    /// Point of contact in the world.
    pub(crate) point: Option<[f64; 3]>,
    /// Unit vector in the world, from the obstacle to the body.
    pub(crate) normal: Option<[f64; 3]>,
    /// Pose of the body at `time`.
    pub(crate) pose: Option<PoseRows>,
    /// How far the motion of the body has progressed at `time`.
    pub(crate) progress: Option<ProgressReport>,
    /// Pose of the obstacle that is met at `time`; `None` when it rests.
    pub(crate) obstacle_pose: Option<PoseRows>,
    /// Times in contact with any obstacle (with a clearance: closer than that; where the obstacle
    /// may be touched: deeper than allowed), ascending and merged; `None` when not asked for.
    pub(crate) intervals: Option<Vec<[f64; 2]>>,
    /// Where the body is at both ends of each of the `intervals`, in their order.
    pub(crate) interval_ends: Option<Vec<[PlaceReport; 2]>>,
    /// How close the body comes to the obstacles.
    pub(crate) clearance: ClearanceReport,
    /// The body as it was read.
    pub(crate) body: BodyReport,
    /// The motion that carried it.
    pub(crate) motion: CheckedMotionReport,
    /// The obstacles, in the order of the command line.
    pub(crate) obstacles: Vec<ObstacleReport>,
    /// Wall-clock time, stage by stage.
    pub(crate) seconds: Seconds,
}

/// The answer of a check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum VerdictReport {
    /// No contact at any time, and never closer than the clearance.
    Clear,
    /// Contact.
    Contact,
    /// No contact up to `time`, but closer than the clearance there.
    Closer,
    /// Neither could be proven.
    Undecided,
}

/// One of the obstacles.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub(crate) struct ObstacleName {
    /// File, as it was given on the command line; `None` for a plane.
    pub(crate) file: Option<String>,
    /// Number of the plane among the planes, from 0; `None` for a mesh.
    pub(crate) plane: Option<usize>,
    /// Number in the order of the command line, from 0.
    pub(crate) index: usize,
}

/// The parts that meet, by their numbers in the files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub(crate) struct FeaturesReport {
    /// The part of the body.
    pub(crate) body: FeatureReport,
    /// The part of the obstacle.
    pub(crate) obstacle: FeatureReport,
}

/// A part of a mesh by its number in the file, counted from 0; in an STL, vertex 3 i + j is corner
/// j of face i.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum FeatureReport {
    /// A vertex.
    Vertex(u32),
    /// An edge, or a diagonal of a polygon, by its ends.
    Edge([u32; 2]),
    /// A face.
    Face(u32),
    /// The plane with this number among the planes.
    Plane(usize),
}

/// How the body and an obstacle meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum TouchReport {
    /// They touch.
    Touch,
    /// They slide along each other.
    Slide,
    /// One enters the other.
    Enter,
    /// They overlap, or one is inside the other, from the start.
    Inside,
}

/// How close the body comes to the obstacles over the whole motion.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct ClearanceReport {
    /// Proven lower bound of the distance at all times. 0 on contact; infinite, in JSON `null`,
    /// where every obstacle may be touched.
    pub(crate) lower: f64,
    /// Smallest distance seen.
    pub(crate) upper: Option<f64>,
    /// Time at which it was seen.
    pub(crate) time: Option<f64>,
    /// The obstacle to which it was seen.
    pub(crate) obstacle: Option<ObstacleName>,
    /// The nearest points in the world at that time, of the body and of the obstacle.
    pub(crate) points: Option<[[f64; 3]; 2]>,
    /// Pose of the body at that time.
    pub(crate) pose: Option<PoseRows>,
    /// How far the motion of the body has progressed at that time.
    pub(crate) progress: Option<ProgressReport>,
    /// Pose of that obstacle at that time; `None` when it rests.
    pub(crate) obstacle_pose: Option<PoseRows>,
    /// The required distance; 0 for contact only.
    pub(crate) required: f64,
    /// What kept `lower` from being within a thousandth of `upper`, or the verdict from being
    /// decided; `None` when nothing did.
    pub(crate) limited: Option<LimitedReport>,
}

/// What kept a least distance from being proven to a thousandth of itself, or a depth from being
/// compared with the allowed one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum LimitedReport {
    /// The limit on work.
    Work,
    /// The rounding of positions: the distance is too small, or the depth is too near the allowed
    /// one.
    Rounding,
    /// The deviation of the chain of spans from the given motion.
    Deviation,
}

/// How the body moves relative to an obstacle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum RelativeMotionReport {
    /// The obstacle rests: the motion is the body's own.
    AtRest,
    /// The two motions commute: the relative motion is steady, and exact.
    Steady,
    /// The relative motion is not steady: both paths are enclosed by bounds.
    Bounded,
}

/// The motion of a check.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct CheckedMotionReport {
    /// Number of steady spans.
    pub(crate) spans: usize,
    /// Spans that are half turns between keyframes, in order of time; both senses lead to the same
    /// pose.
    pub(crate) half_turns: Vec<HalfTurnReport>,
    /// How far it may be from the motion that it stands for; left out where it stands for itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) deviation: Option<DeviationReport>,
    /// Start and end on the clock.
    pub(crate) times: [f64; 2],
}

/// An obstacle as it was read.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct ObstacleReport {
    /// File, as it was given on the command line; `None` for a plane.
    pub(crate) file: Option<String>,
    /// The plane; `None` for a mesh.
    pub(crate) plane: Option<PlaneReport>,
    /// Number of points of a cloud; `None` for other obstacles.
    pub(crate) points: Option<usize>,
    /// Number of triangles, including those without area.
    pub(crate) triangles: usize,
    /// Whether the obstacle is closed, so that a body inside it is in contact too.
    pub(crate) closed: bool,
    /// Number of vertices in the file that were joined with another one, within 1e-9 of the
    /// diagonal.
    pub(crate) welded: usize,
    /// File of its motion; `None` when the obstacle rests.
    pub(crate) motion: Option<String>,
    /// Spans of its motion that are half turns between keyframes; both senses lead to the same
    /// pose.
    pub(crate) half_turns: Vec<HalfTurnReport>,
    /// How far its motion may be from the one that it stands for; left out where it stands for
    /// itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) deviation: Option<DeviationReport>,
    /// How the body moves relative to the obstacle.
    pub(crate) relative_motion: RelativeMotionReport,
    /// Whether the obstacle may touch the body, and was left out of the check.
    pub(crate) allowed: bool,
    /// What counts as contact with it; `None` when it was left out.
    pub(crate) contact: Option<ContactReport>,
    /// The largest depth that does not count as contact; `None` unless only entering does.
    pub(crate) depth: Option<f64>,
    /// Times in contact with the obstacle (with a clearance: closer than that; with a depth: deeper
    /// than that), ascending; `None` when they were not asked for or the obstacle was left out.
    pub(crate) intervals: Option<Vec<[f64; 2]>>,
    /// Where the body is at both ends of each of the `intervals`, in their order.
    pub(crate) interval_ends: Option<Vec<[PlaceReport; 2]>>,
    /// Parts of the `intervals` during which it could not be decided whether the body is deeper
    /// than allowed; `None` when they were not asked for, or entering does not count.
    pub(crate) doubts: Option<Vec<DoubtReport>>,
}

/// A plane as an obstacle.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub(crate) struct PlaneReport {
    /// Number among the planes, from 0.
    pub(crate) number: usize,
    /// The point through which it was laid.
    pub(crate) point: [f64; 3],
    /// Unit normal, out of the solid.
    pub(crate) normal: [f64; 3],
}

/// A part of an interval that is in doubt.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub(crate) struct DoubtReport {
    /// First and last time.
    pub(crate) times: [f64; 2],
    /// What kept it from being decided.
    pub(crate) limited: LimitedReport,
}

/// What counts as contact with an obstacle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum ContactReport {
    /// Touching it.
    Touch,
    /// Entering it deeper than its `depth`.
    Enter,
}

/// The body that was checked, and its motion, as read from files.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CheckedBody<'a> {
    /// The body.
    pub(crate) mesh: &'a Mesh,
    /// What the reader did to it.
    pub(crate) read: &'a ReadReport,
    /// Its motion.
    pub(crate) motion: &'a Motion,
}

/// An obstacle that the body was checked against.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CheckedObstacle<'a> {
    /// The obstacle.
    pub(crate) solid: CheckedSolid<'a>,
    /// Its motion; `None` when it rests.
    pub(crate) motion: Option<ObstacleMotion<'a>>,
    /// What counts as contact with it.
    pub(crate) rule: ContactRule,
}

/// What an obstacle is.
#[derive(Debug, Clone, Copy)]
pub(crate) enum CheckedSolid<'a> {
    /// A mesh from a file.
    Mesh {
        /// Its file.
        file: &'a Path,
        /// The obstacle.
        surface: &'a Surface,
        /// What the reader did to it.
        read: &'a ReadReport,
    },
    /// Points from a file.
    Cloud {
        /// Their file.
        file: &'a Path,
        /// The points.
        cloud: &'a Surface,
    },
    /// The half-space behind a plane.
    Plane {
        /// Number among the planes.
        number: usize,
        /// The plane.
        plane: &'a Plane,
    },
}

/// The motion of an obstacle, as read from a file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ObstacleMotion<'a> {
    /// Its file.
    pub(crate) file: &'a Path,
    /// The motion.
    pub(crate) motion: &'a Motion,
}

impl CheckedSolid<'_> {
    fn file(&self) -> Option<String> {
        match self {
            CheckedSolid::Mesh { file, .. } | CheckedSolid::Cloud { file, .. } => Some(text(file)),
            CheckedSolid::Plane { .. } => None,
        }
    }

    fn plane(&self) -> Option<PlaneReport> {
        match *self {
            CheckedSolid::Mesh { .. } | CheckedSolid::Cloud { .. } => None,
            CheckedSolid::Plane { number, plane } => Some(PlaneReport {
                number,
                point: plane.point().to_array(),
                normal: plane.normal().to_array(),
            }),
        }
    }

    fn feature(&self, feature: Feature) -> FeatureReport {
        match *self {
            CheckedSolid::Mesh { read, .. } => FeatureReport::new(feature, &read.numbers),
            CheckedSolid::Cloud { .. } => match feature {
                // The only features of a point are its three equal corners.
                Feature::Vertex(point) | Feature::Edge([point, _]) | Feature::Face(point) => {
                    FeatureReport::Vertex(point)
                }
            },
            CheckedSolid::Plane { number, .. } => FeatureReport::Plane(number),
        }
    }
}

impl CheckedObstacle<'_> {
    /// The pose at a time of the clock; `None` when it rests.
    fn pose_at_time(&self, time: f64) -> Option<PoseRows> {
        self.motion.map(|own| pose_at_time(own.motion, time))
    }
}

impl CheckReport {
    /// - `check`: what was found for `body` against `obstacles`, in this order.
    /// - `required`: the required distance.
    pub(crate) fn new(
        check: &Check,
        required: f64,
        body: CheckedBody<'_>,
        obstacles: &[CheckedObstacle<'_>],
        seconds: Seconds,
    ) -> CheckReport {
        let (verdict, first) = match &check.verdict {
            Verdict::Clear => (VerdictReport::Clear, None),
            Verdict::Contact(first) => (VerdictReport::Contact, Some(first)),
            Verdict::Closer(first) => (VerdictReport::Closer, Some(first)),
            Verdict::Undecided { .. } => (VerdictReport::Undecided, None),
        };
        let window = match &check.verdict {
            Verdict::Clear => None,
            Verdict::Contact(first) | Verdict::Closer(first) => {
                Some((first.bracket, first.span, first.obstacle))
            }
            Verdict::Undecided {
                window,
                span,
                obstacle,
                ..
            } => Some((*window, *span, *obstacle)),
        };
        let undecided = match &check.verdict {
            Verdict::Undecided { limited, .. } => Some(LimitedReport::new(*limited)),
            _ => None,
        };
        let place = first.map(|first| PlaceReport::new(body.motion, first.span, first.time));
        let intervals = check
            .intervals
            .as_deref()
            .map(|intervals| merged(intervals.iter().map(|interval| interval.times)));
        CheckReport {
            verdict,
            time: first.map(|first| first.time),
            bracket: window.map(|(bracket, ..)| bracket),
            span: window.map(|(_, span, _)| span),
            obstacle: window.map(|(.., obstacle)| ObstacleName::new(obstacles, obstacle)),
            undecided,
            features: first.map(|first| FeaturesReport {
                body: FeatureReport::new(first.features[0], &body.read.numbers),
                obstacle: obstacles[first.obstacle].solid.feature(first.features[1]),
            }),
            touch: first.map(|first| TouchReport::new(first.touch)),
            depth: first.and_then(|first| check.depths[first.obstacle]),
            point: first.map(|first| first.point.to_array()),
            normal: first.map(|first| first.normal.to_array()),
            pose: place.map(|place| place.pose),
            progress: place.map(|place| place.progress),
            obstacle_pose: first
                .and_then(|first| obstacles[first.obstacle].pose_at_time(first.time)),
            interval_ends: intervals.as_deref().map(|times| ends(body.motion, times)),
            intervals,
            clearance: ClearanceReport::new(&check.clearance, required, body, obstacles),
            body: BodyReport::new(body.mesh, body.read),
            motion: CheckedMotionReport::new(body.motion),
            obstacles: obstacles
                .iter()
                .enumerate()
                .map(|(index, obstacle)| ObstacleReport::new(obstacle, index, check, body.motion))
                .collect(),
            seconds,
        }
    }
}

impl ObstacleName {
    fn new(obstacles: &[CheckedObstacle<'_>], index: usize) -> ObstacleName {
        let solid = &obstacles[index].solid;
        ObstacleName {
            file: solid.file(),
            plane: solid.plane().map(|plane| plane.number),
            index,
        }
    }
}

impl CheckedMotionReport {
    fn new(motion: &Motion) -> CheckedMotionReport {
        let times = motion.joint_times();
        CheckedMotionReport {
            spans: motion.spans().len(),
            half_turns: HalfTurnReport::all(motion),
            deviation: DeviationReport::of(motion),
            times: [times[0], times[times.len() - 1]],
        }
    }
}

impl FeatureReport {
    fn new(feature: Feature, numbers: &FileNumbers) -> FeatureReport {
        match feature {
            Feature::Vertex(vertex) => FeatureReport::Vertex(numbers.vertex(vertex)),
            Feature::Edge(ends) => FeatureReport::Edge(ends.map(|end| numbers.vertex(end))),
            Feature::Face(face) => FeatureReport::Face(numbers.face(face)),
        }
    }
}

impl TouchReport {
    fn new(touch: Touch) -> TouchReport {
        match touch {
            Touch::Touch => TouchReport::Touch,
            Touch::Slide => TouchReport::Slide,
            Touch::Enter => TouchReport::Enter,
            Touch::Inside => TouchReport::Inside,
        }
    }
}

impl ClearanceReport {
    fn new(
        clearance: &Clearance,
        required: f64,
        body: CheckedBody<'_>,
        obstacles: &[CheckedObstacle<'_>],
    ) -> ClearanceReport {
        // Infinite: no distance was measured.
        let seen = Some(clearance).filter(|clearance| clearance.upper.is_finite());
        let place = seen.map(|seen| PlaceReport::at_time(body.motion, seen.time));
        ClearanceReport {
            lower: clearance.lower,
            upper: seen.map(|seen| seen.upper),
            time: seen.map(|seen| seen.time),
            obstacle: seen.map(|seen| ObstacleName::new(obstacles, seen.obstacle)),
            points: seen.map(|seen| seen.points.map(|point| point.to_array())),
            pose: place.map(|place| place.pose),
            progress: place.map(|place| place.progress),
            obstacle_pose: seen.and_then(|seen| obstacles[seen.obstacle].pose_at_time(seen.time)),
            required,
            limited: clearance.limited.map(LimitedReport::new),
        }
    }
}

impl LimitedReport {
    fn new(limited: Limited) -> LimitedReport {
        match limited {
            Limited::Work => LimitedReport::Work,
            Limited::Rounding => LimitedReport::Rounding,
            Limited::Deviation => LimitedReport::Deviation,
        }
    }
}

impl RelativeMotionReport {
    fn new(relative: RelativeMotion) -> RelativeMotionReport {
        match relative {
            RelativeMotion::AtRest => RelativeMotionReport::AtRest,
            RelativeMotion::Steady => RelativeMotionReport::Steady,
            RelativeMotion::Bounded => RelativeMotionReport::Bounded,
        }
    }
}

impl ObstacleReport {
    /// - `index`: number of the obstacle; `motion`: the body's motion.
    fn new(
        obstacle: &CheckedObstacle<'_>,
        index: usize,
        check: &Check,
        motion: &Motion,
    ) -> ObstacleReport {
        let own = |intervals: &Vec<ContactInterval>| -> Vec<[f64; 2]> {
            let own = intervals
                .iter()
                .filter(|interval| interval.obstacle == index);
            own.map(|interval| interval.times).collect()
        };
        let intervals = check
            .intervals
            .as_ref()
            .filter(|_| obstacle.rule != ContactRule::Allowed)
            .map(own);
        let (triangles, closed, welded, points) = match obstacle.solid {
            CheckedSolid::Mesh { surface, read, .. } => {
                let triangles = surface.triangles().len();
                (triangles, surface.closed(), read.welded, None)
            }
            CheckedSolid::Cloud { cloud, .. } => (0, false, 0, Some(cloud.positions().len())),
            CheckedSolid::Plane { .. } => (0, true, 0, None),
        };
        ObstacleReport {
            file: obstacle.solid.file(),
            plane: obstacle.solid.plane(),
            points,
            triangles,
            closed,
            welded,
            motion: obstacle.motion.map(|motion| text(motion.file)),
            half_turns: obstacle
                .motion
                .map_or_else(Vec::new, |moved| HalfTurnReport::all(moved.motion)),
            deviation: obstacle
                .motion
                .and_then(|moved| DeviationReport::of(moved.motion)),
            relative_motion: RelativeMotionReport::new(check.relative[index]),
            allowed: obstacle.rule == ContactRule::Allowed,
            contact: match obstacle.rule {
                ContactRule::Touch => Some(ContactReport::Touch),
                ContactRule::Enter { .. } => Some(ContactReport::Enter),
                ContactRule::Allowed => None,
            },
            depth: check.depths[index],
            interval_ends: intervals.as_deref().map(|times| ends(motion, times)),
            doubts: intervals
                .as_ref()
                .filter(|_| check.depths[index].is_some())
                .map(|_| DoubtReport::of(check, index)),
            intervals,
        }
    }
}

impl DoubtReport {
    /// The doubts about one obstacle.
    fn of(check: &Check, obstacle: usize) -> Vec<DoubtReport> {
        let own = check
            .doubts
            .iter()
            .filter(|doubt| doubt.obstacle == obstacle);
        own.map(|doubt| DoubtReport {
            times: doubt.times,
            limited: LimitedReport::new(doubt.limited),
        })
        .collect()
    }
}

/// Where the body is at both ends of intervals of time.
fn ends(motion: &Motion, intervals: &[[f64; 2]]) -> Vec<[PlaceReport; 2]> {
    let place = |time| PlaceReport::at_time(motion, time);
    intervals.iter().map(|times| times.map(place)).collect()
}

fn text(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

/// The union of closed intervals, ascending.
fn merged(intervals: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let mut sorted: Vec<[f64; 2]> = intervals.collect();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut union: Vec<[f64; 2]> = Vec::with_capacity(sorted.len());
    for [start, end] in sorted {
        match union.last_mut() {
            Some(last) if start <= last[1] => last[1] = last[1].max(end),
            _ => union.push([start, end]),
        }
    }
    union
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_of_several_obstacles_are_united() {
        let intervals = [[5.0, 6.0], [0.0, 1.0], [1.0, 2.0], [0.5, 0.7], [3.0, 3.0]];
        assert_eq!(
            merged(intervals.into_iter()),
            [[0.0, 2.0], [3.0, 3.0], [5.0, 6.0]],
            "touching ones are one, a moment is one"
        );
    }

    #[test]
    fn features_have_one_key_that_says_what_they_are() {
        let features = FeaturesReport {
            body: FeatureReport::Edge([4, 7]),
            obstacle: FeatureReport::Face(12),
        };
        assert_eq!(
            serde_json::to_string(&features).expect("a report is always writable"),
            r#"{"body":{"edge":[4,7]},"obstacle":{"face":12}}"#
        );
    }
}
