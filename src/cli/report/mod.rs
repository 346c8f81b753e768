//! What a run found: one documented structure per command, written as text or as one JSON object.
//!
//! The JSON keys are a contract with scripts: keys are added, never renamed, and never change
//! meaning. Lengths are in the body's units, times are on the motion's clock, and numbers read back
//! to the same bits. A number that is not finite is written as `null`.

mod check;
mod check_text;
mod deviation;
mod fitted;
mod half_turn;
mod place;
mod planar_motion;
mod planar_subject;
mod planar_sweep;
mod quantities;
mod steadiness;
mod surface;
mod text;

pub(crate) use check::{
    CheckReport, CheckedBody, CheckedObstacle, CheckedSolid, ObstacleMotion, VerdictReport,
};
pub(crate) use deviation::DeviationReport;
pub(crate) use fitted::FittedKeyReport;
pub(crate) use half_turn::HalfTurnReport;
pub(crate) use planar_motion::PlanarMotionReport;
pub(crate) use planar_subject::{LinesReport, PlanarBodyReport, PlanarSubjectReport};
pub(crate) use planar_sweep::{CutReport, PlanarSweepReport, RegionReport};
pub(crate) use surface::{SubjectReport, SurfaceReport};

pub(crate) use steadiness::SteadinessReport;

use crate::body::Mesh;
use crate::io::{FittedKey, ReadReport};
use crate::motion::scheme::Scheme;
use crate::motion::{Existence, Motion, MotionError, Span, existence, invariants, volume_change};
use crate::{ErrorBound, Sweep};
use glam::DAffine3;
use serde::ser::{Serialize, SerializeMap, Serializer};

/// What `steadysweep sweep` found.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct SweepReport {
    /// The body, or the surface, as it was read.
    pub(crate) body: SubjectReport,
    /// The motion that carried it.
    pub(crate) motion: MotionSummary,
    /// The swept solid.
    pub(crate) sweep: SolidReport,
    /// Wall-clock time, stage by stage.
    pub(crate) seconds: Seconds,
}

/// A body as it was read from a file.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct BodyReport {
    /// Number of triangles.
    pub(crate) triangles: usize,
    /// Volume, above 0.
    pub(crate) volume: f64,
    /// Whether every edge is matched. Always true, since other bodies are refused.
    pub(crate) watertight: bool,
    /// Number of vertices in the file that were joined with another one, within 1e-9 of the
    /// diagonal.
    pub(crate) welded: usize,
    /// Largest distance between places that were joined.
    pub(crate) largest_move: f64,
    /// Number of triangles left out because two of their corners are one vertex.
    pub(crate) collapsed: usize,
    /// Whether the body was inside out as a whole and was turned.
    pub(crate) turned: bool,
}

/// A summary of a motion.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct MotionSummary {
    /// Number of steady spans.
    pub(crate) spans: usize,
    /// Spans that are half turns between keyframes, in order of time; both senses lead to the same
    /// pose.
    pub(crate) half_turns: Vec<HalfTurnReport>,
    /// How far it may be from the motion that it stands for; left out where it stands for itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) deviation: Option<DeviationReport>,
}

/// A swept solid, measured.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct SolidReport {
    /// Number of triangles.
    pub(crate) triangles: usize,
    /// Number of triangles before edges collapsed where the surface hardly bends.
    pub(crate) raw_triangles: usize,
    /// Number of vertices.
    pub(crate) vertices: usize,
    /// Volume.
    pub(crate) volume: f64,
    /// Area of the whole boundary, including that of the voids.
    pub(crate) area: f64,
    /// Number of connected solid pieces.
    pub(crate) components: usize,
    /// Number of bounded cavities.
    pub(crate) voids: usize,
    /// Sum of the genus over the boundary shells.
    pub(crate) genus: usize,
    /// Whether every edge is matched.
    pub(crate) watertight: bool,
    /// Whether exactly two triangles meet at every edge.
    pub(crate) manifold: bool,
    /// Number of edges along which the region touches itself.
    pub(crate) touching_edges: usize,
    /// Number of pairs of triangles that cross or touch each other elsewhere than in common corners
    /// and edges.
    pub(crate) crossings: usize,
    /// The smallest box around it, `[min, max]`.
    pub(crate) bounds: [[f64; 3]; 2],
    /// How far the solid may differ from the true sweep of the given body.
    pub(crate) error_bound: ErrorBoundReport,
    /// Number of attempts, each sampled more finely than the one before; the best one counts.
    pub(crate) attempts: usize,
}

/// How far a result may differ from the true swept region of the given triangles.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub(crate) struct ErrorBoundReport {
    /// Distance by which the true sweep may lie outside the result (shortfall).
    pub(crate) inside: f64,
    /// Whether `inside` is proven; otherwise it is an estimate. So far all are.
    pub(crate) inside_proven: bool,
    /// Distance by which the result may stick out of the true sweep.
    pub(crate) outside: f64,
    /// Whether `outside` is proven; otherwise it is an estimate.
    pub(crate) outside_proven: bool,
}

/// What `steadysweep probe` found, in the order of the points.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct ProbeReport {
    /// One entry per point.
    pub(crate) points: Vec<PointReport>,
    /// The motion of the body.
    pub(crate) motion: MotionSummary,
    /// For a body from a drawing only: the largest distance between its curves and the edges that
    /// stand for them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) flattening: Option<f64>,
    /// Wall-clock time, stage by stage.
    pub(crate) seconds: Seconds,
}

/// One point against the moving body.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct PointReport {
    /// Whether the point is ever inside; `None`, in JSON `null`, where the deviation of the motion
    /// decides.
    pub(crate) inside: Option<bool>,
    /// Closed time intervals during which it is inside, ascending, merged across joints.
    pub(crate) intervals: Vec<[f64; 2]>,
}

/// What `steadysweep motion` found.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct MotionReport {
    /// What lies between its keyframes.
    pub(crate) interpolation: &'static str,
    /// How far it may be from the motion that it stands for; left out where it stands for itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) deviation: Option<DeviationReport>,
    /// How far it is from steady, over a body; left out without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) ara: Option<SteadinessReport>,
    /// One entry per steady span, in the order of time.
    pub(crate) spans: Vec<SpanReport>,
    /// Volume at the end over that at the start.
    pub(crate) volume_factor: f64,
    /// Whether the volume only grows, or only shrinks, or stays.
    pub(crate) volume_monotone: bool,
    /// The keyframes that were found from pairs of points.
    pub(crate) fitted: Vec<FittedKeyReport>,
}

/// How far the ends of a span are from poses that no steady motion joins.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub(crate) struct MarginReport {
    /// The angle by which the eigenvalues miss the negative axis, in degrees.
    pub(crate) angle_deg: f64,
    /// A lower bound of the least change of the linear part that puts one there, over its size.
    pub(crate) change: f64,
}

impl MarginReport {
    /// `None` where it cannot be computed.
    pub(crate) fn new(existence: Result<Existence, MotionError>) -> Option<MarginReport> {
        let existence = existence.ok()?;
        Some(MarginReport {
            angle_deg: existence.angle.to_degrees(),
            change: existence.change,
        })
    }
}

/// One steady span. A field that does not apply to its kind is `None`, in JSON `null`.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct SpanReport {
    /// Name of the kind of motion, such as `screw`.
    pub(crate) kind: &'static str,
    /// Rows of [M tau], the generator of the whole span.
    pub(crate) generator: [[f64; 4]; 3],
    /// Unit vector of the axis.
    pub(crate) axis: Option<[f64; 3]>,
    /// A point on the axis, or the centre of a scaling.
    pub(crate) through: Option<[f64; 3]>,
    /// Turn about the axis by the right-hand rule, in degrees.
    pub(crate) turn_deg: Option<f64>,
    /// Displacement along the axis.
    pub(crate) advance: Option<f64>,
    /// Scale factor from start to end.
    pub(crate) scale: Option<f64>,
    /// Eigenvalues of the linear part of the generator, as [re, im].
    pub(crate) eigenvalues: [[f64; 2]; 3],
    /// The only point that stays.
    pub(crate) fixed_point: Option<[f64; 3]>,
    /// Unit normal of the plane in which it turns.
    pub(crate) plane_normal: Option<[f64; 3]>,
    /// Volume at the end over that at the start.
    pub(crate) volume_factor: f64,
    /// How far its ends are from poses without a steady motion.
    pub(crate) margin: Option<MarginReport>,
    /// Length of the span on the motion's clock.
    pub(crate) duration: f64,
    /// False where another motion of the same kind joins the same two poses, as for a half turn.
    pub(crate) unique: bool,
    /// Sense of a half turn, `+` or `-`; the other one leads to the same pose.
    pub(crate) half_turn: Option<&'static str>,
}

/// Wall-clock time of a run in seconds: in JSON an object of numbers, with `total` and one key per
/// stage, in order. The stages add up to the total.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Seconds {
    /// From the start of the command to the report.
    pub(crate) total: f64,
    /// Name and time of each stage, in order; each name once, with the sum of its times.
    pub(crate) stages: Vec<(&'static str, f64)>,
}

impl Serialize for Seconds {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.stages.len() + 1))?;
        map.serialize_entry("total", &self.total)?;
        for (stage, seconds) in &self.stages {
            map.serialize_entry(stage, seconds)?;
        }
        map.end()
    }
}

impl BodyReport {
    /// - `read`: what the reader did to `body`.
    pub(crate) fn new(body: &Mesh, read: &ReadReport) -> BodyReport {
        BodyReport {
            triangles: body.triangles().len(),
            volume: body.volume(),
            // A `Mesh` is closed by construction.
            watertight: true,
            welded: read.welded,
            largest_move: read.largest_move,
            collapsed: read.collapsed,
            turned: body.turned(),
        }
    }
}

impl SolidReport {
    /// The solid of a sweep, its measures and its error bound.
    pub(crate) fn new(sweep: &Sweep) -> SolidReport {
        let solid = &sweep.solid;
        let measures = solid.measures();
        let ErrorBound { inside, outside } = sweep.error_bound;
        SolidReport {
            triangles: solid.triangles().len(),
            raw_triangles: sweep.raw_triangles,
            vertices: solid.positions().len(),
            volume: measures.volume,
            area: measures.area,
            components: measures.components,
            voids: measures.voids,
            genus: measures.genus,
            watertight: measures.watertight,
            manifold: measures.manifold,
            touching_edges: measures.touching_edges,
            crossings: sweep.crossings,
            bounds: measures.bounds.map(|corner| corner.to_array()),
            error_bound: ErrorBoundReport {
                inside: inside.length,
                inside_proven: inside.proven,
                outside: outside.length,
                outside_proven: outside.proven,
            },
            attempts: sweep.attempts,
        }
    }
}

impl MotionReport {
    /// The spans of a motion, each described as a screw.
    ///
    /// - `scheme`: what lies between its keyframes; `fitted`: what the reader did.
    pub(crate) fn new(motion: &Motion, scheme: Scheme, fitted: &[FittedKey]) -> MotionReport {
        let rates = motion
            .spans()
            .iter()
            .map(|span| span.flow().generator().volume_rate());
        let volume = volume_change(rates);
        MotionReport {
            interpolation: scheme.name(),
            deviation: DeviationReport::of(motion),
            ara: None,
            spans: motion.spans().iter().map(SpanReport::new).collect(),
            volume_factor: volume.factor,
            volume_monotone: volume.monotone,
            fitted: FittedKeyReport::list(fitted),
        }
    }
}

impl SpanReport {
    fn new(span: &Span) -> SpanReport {
        let described = span.describe();
        let generator = span.flow().generator();
        let left_alone = invariants(generator);
        SpanReport {
            kind: described.kind.name(),
            generator: generator.rows(),
            axis: described.axis.map(|axis| axis.to_array()),
            through: described.through.map(|point| point.to_array()),
            turn_deg: described.turn_deg.or(left_alone.turn.map(f64::to_degrees)),
            advance: described.advance,
            scale: described.scale,
            eigenvalues: left_alone.eigenvalues,
            fixed_point: left_alone.fixed_point.map(|point| point.to_array()),
            plane_normal: left_alone.plane_normal.map(|normal| normal.to_array()),
            volume_factor: left_alone.volume_factor,
            margin: MarginReport::new(existence(&DAffine3::IDENTITY, &span.flow().pose_at(1.0))),
            duration: span.duration(),
            unique: span.unique(),
            half_turn: span.half_turn().map(|half_turn| half_turn.sense.symbol()),
        }
    }
}

impl ProbeReport {
    /// - `inside`: whether each point is ever inside under `motion`, and `intervals`: when;
    ///   `flattening`: that of a drawing.
    pub(crate) fn new(
        inside: Vec<Option<bool>>,
        intervals: Vec<Vec<[f64; 2]>>,
        motion: MotionSummary,
        flattening: Option<f64>,
        seconds: Seconds,
    ) -> ProbeReport {
        ProbeReport {
            points: inside
                .into_iter()
                .zip(intervals)
                .map(|(inside, intervals)| PointReport { inside, intervals })
                .collect(),
            motion,
            flattening,
            seconds,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two cubes side by side.
    pub(super) fn solid() -> SolidReport {
        SolidReport {
            triangles: 12,
            raw_triangles: 12,
            vertices: 8,
            volume: 2.0,
            area: 10.0,
            components: 1,
            voids: 0,
            genus: 0,
            watertight: true,
            manifold: true,
            touching_edges: 0,
            crossings: 0,
            bounds: [[0.0; 3], [1.0, 1.0, 2.0]],
            error_bound: ErrorBoundReport {
                inside: 1e-3,
                inside_proven: true,
                outside: 0.1 + 0.2,
                outside_proven: true,
            },
            attempts: 1,
        }
    }

    #[test]
    fn numbers_keep_their_bits_in_json() {
        let text = serde_json::to_string(&solid()).expect("a report is always writable");
        assert!(
            text.contains("0.30000000000000004"),
            "all digits are written: {text}"
        );
    }

    #[test]
    fn a_number_that_is_not_finite_becomes_null() {
        let report = SolidReport {
            volume: f64::NAN,
            area: f64::INFINITY,
            ..solid()
        };
        let value = serde_json::to_value(&report).expect("a report is always writable");
        assert!(value["volume"].is_null(), "NaN is no JSON: {value}");
        assert!(value["area"].is_null(), "infinity is no JSON: {value}");
    }

    #[test]
    fn the_times_stand_in_order_after_the_total() {
        let seconds = Seconds {
            total: 3.5,
            stages: vec![("read", 0.5), ("arrange", 2.0)],
        };
        assert_eq!(
            serde_json::to_string(&seconds).expect("times are always writable"),
            r#"{"total":3.5,"read":0.5,"arrange":2.0}"#,
            "one object with the total first"
        );
    }
}
