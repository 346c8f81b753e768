//! What a run found: one documented structure per command, written as text or as one JSON object.
//!
//! The JSON keys are a contract with scripts: keys are added, never renamed, and never change meaning. Lengths are in
//! the body's units, times on the motion's clock, and the numbers are written so that reading them gives the same bits.
//! A number that is not finite is written as `null`.

use std::fmt;

use crate::body::Mesh;
use crate::io::ReadReport;
use crate::motion::{Motion, Span};
use crate::{ErrorBound, Sweep};
use serde::ser::{Serialize, SerializeMap, Serializer};

/// What `steadysweep sweep` found.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct SweepReport {
    /// The body as it was read.
    pub body: BodyReport,
    /// The motion that carried it.
    pub motion: MotionSummary,
    /// The swept solid.
    pub sweep: SolidReport,
    /// Wall-clock time, stage by stage.
    pub seconds: Seconds,
}

/// A body as it was read from a file.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct BodyReport {
    /// Number of triangles.
    pub triangles: usize,
    /// Volume, above 0.
    pub volume: f64,
    /// Whether every edge is matched; always true, since other bodies are refused.
    pub watertight: bool,
    /// Number of vertices of the file that were joined with another one near by, within 1e-9 of the diagonal.
    pub welded: usize,
    /// Largest distance between places that were joined.
    pub largest_move: f64,
    /// Number of triangles left out because two of their corners are one vertex.
    pub collapsed: usize,
    /// Whether the body was inside out as a whole and was turned.
    pub turned: bool,
}

/// A motion in short.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct MotionSummary {
    /// Number of steady spans.
    pub spans: usize,
}

/// A swept solid, measured.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct SolidReport {
    /// Number of triangles.
    pub triangles: usize,
    /// Number of vertices.
    pub vertices: usize,
    /// Volume.
    pub volume: f64,
    /// Area of the whole boundary, that of the voids included.
    pub area: f64,
    /// Number of connected solid pieces.
    pub components: usize,
    /// Number of bounded cavities.
    pub voids: usize,
    /// Sum of the genus over the boundary shells.
    pub genus: usize,
    /// Whether every edge is matched.
    pub watertight: bool,
    /// Whether exactly two triangles meet at every edge.
    pub manifold: bool,
    /// Number of edges at which the region touches itself, so that more than two triangles meet.
    pub touching_edges: usize,
    /// Least box, `[min, max]`.
    pub bounds: [[f64; 3]; 2],
    /// How far the solid may differ from the true sweep of the given body.
    pub error_bound: ErrorBoundReport,
}

/// How far a result may differ from the true swept region of the given triangles.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct ErrorBoundReport {
    /// Distance by which the true sweep may lie outside the result (shortfall).
    pub inside: f64,
    /// Whether `inside` is proven; an estimate otherwise.
    pub inside_proven: bool,
    /// Distance by which the result may stick out of the true sweep.
    pub outside: f64,
    /// Whether `outside` is proven; an estimate otherwise.
    pub outside_proven: bool,
}

/// What `steadysweep probe` found, in the order of the points.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct ProbeReport {
    /// One entry per point.
    pub points: Vec<PointReport>,
    /// Wall-clock time, stage by stage.
    pub seconds: Seconds,
}

/// One point against the moving body.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct PointReport {
    /// Whether the point is ever inside.
    pub inside: bool,
    /// Closed time intervals during which it is inside, ascending, merged across joints.
    pub intervals: Vec<[f64; 2]>,
}

/// What `steadysweep motion` found.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct MotionReport {
    /// One entry per steady span, in the order of time.
    pub spans: Vec<SpanReport>,
}

/// One steady span; what does not apply to its kind is `None`, in JSON `null`.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct SpanReport {
    /// Name of the kind of motion, such as `screw`.
    pub kind: &'static str,
    /// Rows of [M tau], the generator of the whole span.
    pub generator: [[f64; 4]; 3],
    /// Unit vector of the axis.
    pub axis: Option<[f64; 3]>,
    /// A point on the axis, or the centre of a scaling.
    pub through: Option<[f64; 3]>,
    /// Turn about the axis by the right-hand rule, in degrees.
    pub turn_deg: Option<f64>,
    /// Way along the axis.
    pub advance: Option<f64>,
    /// Factor of size from start to end.
    pub scale: Option<f64>,
    /// Length of the span on the motion's clock.
    pub duration: f64,
    /// False where another motion of the same kind joins the same two poses: a half turn.
    pub unique: bool,
}

/// Wall-clock time of a run in seconds: in JSON an object with `total` and one key per stage, in order.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Seconds {
    /// From the start of the command to the report.
    pub total: f64,
    /// Name and time of each stage, in order.
    pub stages: Vec<(&'static str, f64)>,
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
    /// `read`: what reading did to `body`.
    pub fn new(body: &Mesh, read: &ReadReport) -> BodyReport {
        BodyReport {
            triangles: body.triangles().len(),
            volume: body.volume(),
            // By construction of a `Mesh`.
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
    pub fn new(sweep: &Sweep) -> SolidReport {
        let solid = &sweep.solid;
        let measures = solid.measures();
        let ErrorBound { inside, outside } = sweep.error_bound;
        SolidReport {
            triangles: solid.triangles().len(),
            vertices: solid.positions().len(),
            volume: measures.volume,
            area: measures.area,
            components: measures.components,
            voids: measures.voids,
            genus: measures.genus,
            watertight: measures.watertight,
            manifold: measures.manifold,
            touching_edges: measures.touching_edges,
            bounds: measures.bounds.map(|corner| corner.to_array()),
            error_bound: ErrorBoundReport {
                inside: inside.length,
                inside_proven: inside.proven,
                outside: outside.length,
                outside_proven: outside.proven,
            },
        }
    }
}

impl MotionReport {
    /// The spans of a motion, each in the terms of a screw.
    pub fn new(motion: &Motion) -> MotionReport {
        MotionReport {
            spans: motion.spans().iter().map(SpanReport::new).collect(),
        }
    }
}

impl SpanReport {
    fn new(span: &Span) -> SpanReport {
        let described = span.describe();
        let generator = span.flow().generator();
        SpanReport {
            kind: described.kind.name(),
            generator: [0, 1, 2].map(|row| {
                let [x, y, z] = generator.linear.row(row).to_array();
                [x, y, z, generator.offset[row]]
            }),
            axis: described.axis.map(|axis| axis.to_array()),
            through: described.through.map(|point| point.to_array()),
            turn_deg: described.turn_deg,
            advance: described.advance,
            scale: described.scale,
            duration: span.duration(),
            unique: span.unique(),
        }
    }
}

impl PointReport {
    /// `intervals`: when the point is inside, ascending.
    pub fn new(intervals: Vec<[f64; 2]>) -> PointReport {
        PointReport {
            inside: !intervals.is_empty(),
            intervals,
        }
    }
}

impl fmt::Display for SweepReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.body)?;
        writeln!(f, "motion  {}", counted(self.motion.spans, "steady span"))?;
        write!(f, "{}{}", self.sweep, self.seconds)
    }
}

impl fmt::Display for BodyReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "body    {}, volume {}, {}",
            counted(self.triangles, "triangle"),
            Number(self.volume),
            if self.watertight {
                "watertight"
            } else {
                "not watertight"
            },
        )?;
        if self.welded > 0 {
            writeln!(
                f,
                "        {} joined with another up to {} away",
                counted(self.welded, "vertex"),
                Number(self.largest_move)
            )?;
        }
        if self.collapsed > 0 {
            writeln!(
                f,
                "        {} left out: two corners are one vertex",
                counted(self.collapsed, "triangle")
            )?;
        }
        if self.turned {
            writeln!(
                f,
                "        the triangles were inside out and have been turned"
            )?;
        }
        Ok(())
    }
}

impl fmt::Display for SolidReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "sweep   volume {}, area {}",
            Number(self.volume),
            Number(self.area)
        )?;
        writeln!(
            f,
            "        {}, {}, genus {}",
            counted(self.components, "component"),
            counted(self.voids, "void"),
            self.genus
        )?;
        writeln!(
            f,
            "        {}, {}, {}, {}",
            counted(self.triangles, "triangle"),
            counted(self.vertices, "vertex"),
            if self.watertight {
                "watertight"
            } else {
                "not watertight"
            },
            if self.manifold {
                "manifold"
            } else {
                "not manifold"
            },
        )?;
        if self.touching_edges > 0 {
            writeln!(
                f,
                "        it touches itself along {}",
                counted(self.touching_edges, "edge")
            )?;
        }
        let [low, high] = self.bounds;
        writeln!(f, "        from {} to {}", Vector(low), Vector(high))?;
        write!(f, "{}", self.error_bound)
    }
}

impl fmt::Display for ErrorBoundReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let origin = |proven: bool| if proven { "proven" } else { "estimate" };
        writeln!(
            f,
            "error   sticks out of the true sweep by at most {} ({}), falls short of it by at most {} ({})",
            Number(self.outside),
            origin(self.outside_proven),
            Number(self.inside),
            origin(self.inside_proven),
        )
    }
}

impl fmt::Display for ProbeReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, point) in self.points.iter().enumerate() {
            write!(
                f,
                "point {:<5} {}",
                index + 1,
                if point.inside { "inside " } else { "outside" }
            )?;
            for [start, end] in &point.intervals {
                write!(f, "  [{}, {}]", Number(*start), Number(*end))?;
            }
            writeln!(f)?;
        }
        let inside = self.points.iter().filter(|point| point.inside).count();
        writeln!(
            f,
            "{} of {} ever inside",
            inside,
            counted(self.points.len(), "point")
        )?;
        write!(f, "{}", self.seconds)
    }
}

impl fmt::Display for MotionReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, span) in self.spans.iter().enumerate() {
            writeln!(
                f,
                "span {}: {}, duration {}",
                index + 1,
                span.kind,
                Number(span.duration)
            )?;
            write!(f, "{span}")?;
        }
        Ok(())
    }
}

impl fmt::Display for SpanReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let vectors = [("axis", self.axis), ("through", self.through)];
        for (name, vector) in vectors.into_iter().filter_map(|(name, v)| Some((name, v?))) {
            writeln!(f, "  {name:<10}{}", Vector(vector))?;
        }
        if let Some(turn) = self.turn_deg {
            writeln!(f, "  {:<10}{} degrees", "turn", Number(turn))?;
        }
        let lengths = [("advance", self.advance), ("scale", self.scale)];
        for (name, value) in lengths.into_iter().filter_map(|(name, v)| Some((name, v?))) {
            writeln!(f, "  {name:<10}{}", Number(value))?;
        }
        for (row, name) in self.generator.iter().zip(["generator", "", ""]) {
            write!(f, "  {name:<10}")?;
            for value in without_noise(*row) {
                write!(f, "{:>14}", Number(value).to_string())?;
            }
            writeln!(f)?;
        }
        if !self.unique {
            writeln!(
                f,
                "  a half turn: the opposite sense leads to the same pose; to choose it, give"
            )?;
            writeln!(f, "  the motion as spans, with a turn of -180 degrees")?;
        }
        Ok(())
    }
}

impl fmt::Display for Seconds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "time    {:.3} s", self.total)?;
        for (index, (stage, seconds)) in self.stages.iter().enumerate() {
            write!(
                f,
                "{}{stage} {seconds:.3}",
                if index == 0 { " (" } else { ", " }
            )?;
        }
        writeln!(f, "{}", if self.stages.is_empty() { "" } else { ")" })
    }
}

/// "1 edge", "2 edges", "1234567 vertices".
fn counted(count: usize, noun: &str) -> String {
    match (count, noun) {
        (1, _) => format!("1 {noun}"),
        (_, "vertex") => format!("{count} vertices"),
        _ => format!("{count} {noun}s"),
    }
}

/// A number for reading: seven significant digits, without trailing zeros; the full digits are in the JSON form.
struct Number(f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Number(value) = *self;
        // Rounded to seven digits by way of the decimal form, then printed by the shortest form that reads back.
        let rounded: f64 = format!("{value:.6e}").parse().unwrap_or(value);
        if rounded == 0.0 {
            write!(f, "0")
        } else if (1e-4..1e9).contains(&rounded.abs()) {
            write!(f, "{rounded}")
        } else {
            write!(f, "{rounded:e}")
        }
    }
}

/// A vector for reading: `(x, y, z)`.
struct Vector([f64; 3]);

impl fmt::Display for Vector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = without_noise(self.0).map(Number);
        write!(f, "({x}, {y}, {z})")
    }
}

/// Entries of a vector or matrix for reading: those that are rounding noise beside the largest one become 0.
fn without_noise<const N: usize>(entries: [f64; N]) -> [f64; N] {
    /// Some hundred roundings, as in the logarithm of a pose, and far below the seven digits that are shown.
    const NOISE: f64 = 1e-13;
    let largest = entries
        .iter()
        .fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
    entries.map(|entry| {
        if entry.abs() <= NOISE * largest {
            0.0
        } else {
            entry
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solid() -> SolidReport {
        SolidReport {
            triangles: 12,
            vertices: 8,
            volume: 2.0,
            area: 10.0,
            components: 1,
            voids: 0,
            genus: 0,
            watertight: true,
            manifold: true,
            touching_edges: 0,
            bounds: [[0.0; 3], [1.0, 1.0, 2.0]],
            error_bound: ErrorBoundReport {
                inside: 1e-3,
                inside_proven: false,
                outside: 0.1 + 0.2,
                outside_proven: true,
            },
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
        assert_eq!(
            seconds.to_string(),
            "time    3.500 s (read 0.500, arrange 2.000)\n",
            "the same as text"
        );
    }

    #[test]
    fn readable_numbers_have_seven_digits_and_no_noise() {
        let cases = [
            (0.0, "0"),
            (-0.0, "0"),
            (0.1 + 0.2, "0.3"),
            (1.0 / 3.0, "0.3333333"),
            (-12345.678949, "-12345.68"),
            (2e6, "2000000"),
            (1e-7, "1e-7"),
            (6.0e23, "6e23"),
        ];
        for (value, expected) in cases {
            assert_eq!(Number(value).to_string(), expected, "{value:e}");
        }
    }

    #[test]
    fn the_text_says_what_is_proven_and_what_is_estimated() {
        let text = solid().to_string();
        assert!(
            text.contains("sticks out of the true sweep by at most 0.3 (proven)"),
            "{text}"
        );
        assert!(
            text.contains("falls short of it by at most 0.001 (estimate)"),
            "{text}"
        );
    }

    #[test]
    fn a_half_turn_says_how_to_choose_the_other_sense() {
        let span = SpanReport {
            kind: "rotation",
            generator: [[0.0; 4]; 3],
            axis: Some([0.0, 0.0, 1.0]),
            through: Some([0.0; 3]),
            turn_deg: Some(180.0),
            advance: Some(0.0),
            scale: None,
            duration: 1.0,
            unique: false,
        };
        let text = MotionReport { spans: vec![span] }.to_string();
        assert!(text.contains("turn of -180 degrees"), "{text}");
        assert!(
            !text.contains("scale"),
            "what does not apply is left out: {text}"
        );
    }
}
