//! What `steadysweep sweep` found for a body in the plane.

use super::half_turn::write_details;
use super::planar_subject::{PlanarBodyReport, PlanarSubjectReport};
use super::quantities::{Vector, counted};
use super::{ErrorBoundReport, MotionSummary, Seconds};
use crate::io::Drawing;
use crate::numeric::Readable;
use crate::planar::Sweep;
use crate::solid::planar::Measures;
use std::fmt;

/// What `steadysweep sweep` found for a body in the plane.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct PlanarSweepReport {
    /// The body, or the lines, as they were read.
    pub(crate) body: PlanarSubjectReport,
    /// The motion that carried it.
    pub(crate) motion: MotionSummary,
    /// The swept region.
    pub(crate) sweep: RegionReport,
    /// What the body leaves of a blank; without a blank, the JSON does not have this key.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) cut: Option<CutReport>,
    /// Wall-clock time, stage by stage.
    pub(crate) seconds: Seconds,
}

/// A swept region, measured.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct RegionReport {
    /// Number of vertices of the outlines.
    pub(crate) vertices: usize,
    /// Area.
    pub(crate) area: f64,
    /// Length of all outlines, including those of the holes.
    pub(crate) perimeter: f64,
    /// Number of pieces, connected across edges.
    pub(crate) pieces: usize,
    /// Number of holes.
    pub(crate) holes: usize,
    /// The smallest box around it, `[min, max]`.
    pub(crate) bounds: [[f64; 2]; 2],
    /// How far the region may differ from the true sweep of the given edges.
    pub(crate) error_bound: ErrorBoundReport,
    /// Largest distance, over all times, between the curves of the drawing and the edges that
    /// replace them: the region of the curves may differ from that of the edges by this much
    /// besides.
    pub(crate) flattening: f64,
    /// Number of attempts, each sampled more finely than the one before; the best one counts.
    pub(crate) attempts: usize,
}

/// A blank, and what the body leaves of it.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct CutReport {
    /// The blank as it was read.
    pub(crate) blank: PlanarBodyReport,
    /// The blank without the swept region.
    pub(crate) remaining: RemainingReport,
}

/// What is left of a blank, measured. Its cut edges are those of the swept region, with the same
/// error bounds: it may have too much where the region has too little, and too little where the
/// region has too much.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct RemainingReport {
    /// Number of vertices of the outlines.
    pub(crate) vertices: usize,
    /// Area.
    pub(crate) area: f64,
    /// Length of all outlines, including those of the holes.
    pub(crate) perimeter: f64,
    /// Number of pieces, connected across edges.
    pub(crate) pieces: usize,
    /// Number of holes.
    pub(crate) holes: usize,
    /// The smallest box around it, `[min, max]`; zero when nothing is left.
    pub(crate) bounds: [[f64; 2]; 2],
}

impl CutReport {
    /// The drawing of a blank, and the measures of what is left.
    pub(crate) fn new(blank: &Drawing, left: &Measures) -> CutReport {
        CutReport {
            blank: PlanarBodyReport::new(blank),
            remaining: RemainingReport {
                vertices: left.vertices,
                area: left.area,
                perimeter: left.perimeter,
                pieces: left.pieces,
                holes: left.holes,
                bounds: left.bounds.map(|corner| corner.to_array()),
            },
        }
    }
}

impl RegionReport {
    /// - `rounding`: how far the points of the region move when they are written.
    /// - `flattening`: that of the drawing, times the largest magnification during the motion.
    pub(crate) fn new(sweep: &Sweep, rounding: f64, flattening: f64) -> RegionReport {
        let (measures, bound) = (&sweep.measures, &sweep.error_bound);
        RegionReport {
            vertices: measures.vertices,
            area: measures.area,
            perimeter: measures.perimeter,
            pieces: measures.pieces,
            holes: measures.holes,
            bounds: measures.bounds.map(|corner| corner.to_array()),
            error_bound: ErrorBoundReport {
                inside: bound.inside.length + rounding,
                inside_proven: bound.inside.proven,
                outside: bound.outside.length + rounding,
                outside_proven: bound.outside.proven,
            },
            flattening,
            attempts: sweep.attempts,
        }
    }
}

impl fmt::Display for PlanarSweepReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.body.write(f)?;
        let spans = counted(self.motion.spans, "steady span");
        writeln!(f, "motion  {spans} in the plane")?;
        write_details(f, self.motion.deviation.as_ref(), &self.motion.half_turns)?;
        write!(f, "{}", self.sweep)?;
        if let Some(cut) = &self.cut {
            write!(f, "{cut}")?;
        }
        write!(f, "{}", self.seconds)
    }
}

/// Writes the lines with the measures of a region.
fn write_region(
    f: &mut fmt::Formatter<'_>,
    name: &str,
    [area, perimeter]: [f64; 2],
    [pieces, holes, vertices]: [usize; 3],
    [low, high]: [[f64; 2]; 2],
) -> fmt::Result {
    writeln!(
        f,
        "{name:<7} area {}, perimeter {}",
        Readable(area),
        Readable(perimeter)
    )?;
    writeln!(
        f,
        "        {}, {}, {}",
        counted(pieces, "piece"),
        counted(holes, "hole"),
        counted(vertices, "vertex")
    )?;
    writeln!(f, "        from {} to {}", Vector(low), Vector(high))
}

impl fmt::Display for RegionReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counts = [self.pieces, self.holes, self.vertices];
        write_region(f, "sweep", [self.area, self.perimeter], counts, self.bounds)?;
        write!(f, "{}", self.error_bound)?;
        if self.flattening > 0.0 {
            let flattening = Readable(self.flattening);
            writeln!(
                f,
                "        besides, the curves of the drawing are swept as edges within {flattening} of them"
            )?;
        }
        Ok(())
    }
}

impl fmt::Display for CutReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.blank.write(f, "blank")?;
        let left = &self.remaining;
        if left.pieces == 0 {
            return writeln!(f, "left    nothing");
        }
        let counts = [left.pieces, left.holes, left.vertices];
        write_region(f, "left", [left.area, left.perimeter], counts, left.bounds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(flattening: f64) -> PlanarSweepReport {
        PlanarSweepReport {
            body: PlanarSubjectReport::Body(PlanarBodyReport {
                vertices: 4,
                area: 2.0,
                perimeter: 6.0,
                pieces: 1,
                holes: 0,
                flattening,
                joined: 0.0,
                declared_units: Some("0.1 mm".to_owned()),
                units: None,
                notes: vec!["left out: 2 TEXT".to_owned()],
            }),
            motion: MotionSummary {
                spans: 1,
                half_turns: Vec::new(),
                deviation: None,
            },
            sweep: RegionReport {
                vertices: 12,
                area: 3.5,
                perimeter: 8.0,
                pieces: 1,
                holes: 1,
                bounds: [[0.0, -1.0], [2.0, 3.0]],
                error_bound: ErrorBoundReport {
                    inside: 1e-3,
                    inside_proven: true,
                    outside: 2e-3,
                    outside_proven: true,
                },
                flattening,
                attempts: 1,
            },
            cut: None,
            seconds: Seconds::default(),
        }
    }

    #[test]
    fn the_text_tells_units_notes_and_both_errors() {
        let expected = "\
body    4 vertices, area 2, 1 piece, 0 holes
        one length of the file is 0.1 mm
        note: left out: 2 TEXT
motion  1 steady span in the plane
sweep   area 3.5, perimeter 8
        1 piece, 1 hole, 12 vertices
        from (0, -1) to (2, 3)
bounds  sticks out of the true sweep by at most 0.002 (proven), falls short of it by at most 0.001 (proven)
        besides, the curves of the drawing are swept as edges within 0.0005 of them
time    0.000 s
";
        assert_eq!(report(5e-4).to_string(), expected);
        assert!(
            !report(0.0).to_string().contains("besides"),
            "nothing is curved"
        );
    }

    #[test]
    fn what_is_left_of_a_blank_stands_after_the_errors() {
        let mut report = report(0.0);
        assert!(
            serde_json::to_value(&report).is_ok_and(|value| value.get("cut").is_none()),
            "no blank, no key"
        );
        let (area, perimeter, bounds) = (7.0, 12.0, [[0.0, 0.0], [3.0, 3.0]]);
        let remaining = RemainingReport {
            vertices: 7,
            area,
            perimeter,
            pieces: 2,
            holes: 0,
            bounds,
        };
        let PlanarSubjectReport::Body(body) = report.body.clone() else {
            panic!("a body");
        };
        let blank = PlanarBodyReport {
            notes: vec![],
            declared_units: None,
            ..body
        };
        report.cut = Some(CutReport { blank, remaining });
        let expected = "\
blank   4 vertices, area 2, 1 piece, 0 holes
left    area 7, perimeter 12
        2 pieces, 0 holes, 7 vertices
        from (0, 0) to (3, 3)
time";
        assert!(report.to_string().contains(expected), "{report}");
    }

    #[test]
    fn the_keys_are_those_of_the_contract() {
        let value = serde_json::to_value(report(0.0)).expect("always writable");
        for key in [
            "vertices",
            "area",
            "perimeter",
            "pieces",
            "holes",
            "bounds",
            "error_bound",
        ] {
            assert!(value["sweep"].get(key).is_some(), "{key} in {value}");
        }
        assert!(
            value["body"]["area"].is_number() && value["body"]["vertices"].is_number(),
            "{value}"
        );
    }
}
