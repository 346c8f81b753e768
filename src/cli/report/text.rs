//! The reports as text.

use super::half_turn::write_details;
use super::quantities::{Vector, counted, without_noise};
use super::{
    BodyReport, DeviationReport, ErrorBoundReport, MarginReport, MotionReport, ProbeReport,
    Seconds, SolidReport, SpanReport, SteadinessReport, SweepReport,
};
use crate::motion::MotionKind;
use crate::numeric::Readable;
use std::fmt;

impl fmt::Display for SweepReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.body)?;
        writeln!(f, "motion  {}", counted(self.motion.spans, "steady span"))?;
        write_details(f, self.motion.deviation.as_ref(), &self.motion.half_turns)?;
        write!(f, "{}{}", self.sweep, self.seconds)
    }
}

impl fmt::Display for BodyReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "body    {}, volume {}, {}",
            counted(self.triangles, "triangle"),
            Readable(self.volume),
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
                Readable(self.largest_move)
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
            Readable(self.volume),
            Readable(self.area)
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
        if self.crossings > 0 {
            writeln!(
                f,
                "        {} of triangles cross or touch within rounding, and could not be moved apart",
                counted(self.crossings, "pair")
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
            "bounds  sticks out of the true sweep by at most {} ({}), falls short of it by at most {} ({})",
            Readable(self.outside),
            origin(self.outside_proven),
            Readable(self.inside),
            origin(self.inside_proven),
        )
    }
}

impl fmt::Display for ProbeReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_details(f, self.motion.deviation.as_ref(), &self.motion.half_turns)?;
        for (index, point) in self.points.iter().enumerate() {
            write!(
                f,
                "point {:<5} {}",
                index + 1,
                match point.inside {
                    Some(true) => "inside ",
                    Some(false) => "outside",
                    None => "open   ",
                }
            )?;
            for [start, end] in &point.intervals {
                write!(f, "  [{}, {}]", Readable(*start), Readable(*end))?;
            }
            writeln!(f)?;
        }
        let said = |inside: Option<bool>| {
            let points = self.points.iter();
            points.filter(|point| point.inside == inside).count()
        };
        let (inside, open) = (said(Some(true)), said(None));
        writeln!(
            f,
            "{} of {} ever inside",
            inside,
            counted(self.points.len(), "point")
        )?;
        if open > 0 {
            writeln!(
                f,
                "{open} open: the deviation of the motion decides; times are those of its spans"
            )?;
        }
        if let Some(flattening) = self.flattening.filter(|&flattening| flattening > 0.0) {
            writeln!(
                f,
                "curves of the drawing are replaced by edges within {}",
                Readable(flattening)
            )?;
        }
        write!(f, "{}", self.seconds)
    }
}

/// Lines for a motion whose keyframes are joined by something else than steady spans, or that is
/// followed by fewer of them.
pub(super) fn write_interpolation(
    f: &mut fmt::Formatter<'_>,
    interpolation: &str,
    deviation: Option<&DeviationReport>,
    steadiness: Option<&SteadinessReport>,
) -> fmt::Result {
    if let Some(deviation) = deviation {
        writeln!(f, "interpolation {interpolation}, followed by steady spans")?;
        write!(f, "{deviation}")?;
    }
    match steadiness {
        None => Ok(()),
        Some(steadiness) => write!(f, "{steadiness}"),
    }
}

impl fmt::Display for MotionReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_interpolation(
            f,
            self.interpolation,
            self.deviation.as_ref(),
            self.ara.as_ref(),
        )?;
        for (index, span) in self.spans.iter().enumerate() {
            writeln!(
                f,
                "span {}: {}, duration {}",
                index + 1,
                span.kind,
                Readable(span.duration)
            )?;
            write!(f, "{span}")?;
        }
        write_volume(f, "volume", self.volume_factor, self.volume_monotone)?;
        self.fitted.iter().try_for_each(|key| write!(f, "{key}"))
    }
}

impl fmt::Display for SpanReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let vectors = [("axis", self.axis), ("through", self.through)];
        for (name, vector) in vectors.into_iter().filter_map(|(name, v)| Some((name, v?))) {
            writeln!(f, "  {name:<10}{}", Vector(vector))?;
        }
        let numbers = [self.turn_deg, self.advance, self.scale];
        write_span(f, numbers, &self.generator, self.half_turn)?;
        if self.kind == MotionKind::Affine.name() {
            let normal = self.plane_normal;
            write_invariants(f, &self.eigenvalues, self.fixed_point, normal, self.margin)?;
        }
        Ok(())
    }
}

/// Writes the part of a span that looks the same in the plane and in space.
///
/// - `numbers`: turn in degrees, advance and scale.
pub(super) fn write_span<const N: usize>(
    f: &mut fmt::Formatter<'_>,
    [turn, advance, scale]: [Option<f64>; 3],
    generator: &[[f64; N]],
    half_turn: Option<&str>,
) -> fmt::Result {
    if let Some(turn) = turn {
        writeln!(f, "  {:<10}{} degrees", "turn", Readable(turn))?;
    }
    let lengths = [("advance", advance), ("scale", scale)];
    for (name, value) in lengths.into_iter().filter_map(|(name, v)| Some((name, v?))) {
        writeln!(f, "  {name:<10}{}", Readable(value))?;
    }
    for (index, row) in generator.iter().enumerate() {
        write!(f, "  {:<10}", if index == 0 { "generator" } else { "" })?;
        for value in without_noise(*row) {
            write!(f, "{:>14}", Readable(value).to_string())?;
        }
        writeln!(f)?;
    }
    if let Some(sense) = half_turn {
        let other = if sense == "+" { "-" } else { "+" };
        writeln!(
            f,
            "  a half turn in the sense {sense}; the sense {other} leads to the same pose: sweep, check and probe"
        )?;
        writeln!(
            f,
            "  are told which by --half-turn, by a keyframe between, or by a span"
        )?;
    }
    Ok(())
}

/// Writes what a span leaves alone in which shapes change.
pub(super) fn write_invariants<const N: usize>(
    f: &mut fmt::Formatter<'_>,
    eigenvalues: &[[f64; 2]],
    fixed_point: Option<[f64; N]>,
    plane_normal: Option<[f64; N]>,
    margin: Option<MarginReport>,
) -> fmt::Result {
    let factors = eigenvalues.iter().filter(|[_, im]| *im >= 0.0);
    for (index, [re, im]) in factors.enumerate() {
        write!(f, "  {:<10}", if index == 0 { "grows" } else { "" })?;
        write!(f, "{} times", Readable(re.exp()))?;
        if *im > 0.0 {
            write!(f, " in the plane in which it turns")?;
        }
        writeln!(f)?;
    }
    let vectors = [("normal", plane_normal), ("fixed", fixed_point)];
    for (name, vector) in vectors.into_iter().filter_map(|(name, v)| Some((name, v?))) {
        writeln!(f, "  {name:<10}{}", Vector(vector))?;
    }
    if let Some(MarginReport { angle_deg, change }) = margin {
        writeln!(
            f,
            "  {:<10}{} degrees, {} of the size of the linear part",
            "margin",
            Readable(angle_deg),
            Readable(change)
        )?;
    }
    Ok(())
}

/// Writes how the volume changes, or the area, where it does.
pub(super) fn write_volume(
    f: &mut fmt::Formatter<'_>,
    what: &str,
    factor: f64,
    monotone: bool,
) -> fmt::Result {
    let course = match (factor > 1.0, monotone) {
        (_, true) if Readable(factor).to_string() == "1" => return Ok(()),
        (true, true) => "only grows",
        (false, true) => "only shrinks",
        (_, false) => "grows and shrinks",
    };
    writeln!(
        f,
        "the {what} {course}, to {} times that at the start",
        Readable(factor)
    )
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

#[cfg(test)]
mod tests {
    use super::super::tests::solid;
    use super::*;

    #[test]
    fn the_times_stand_on_one_line() {
        let seconds = Seconds {
            total: 3.5,
            stages: vec![("read", 0.5), ("arrange", 2.0)],
        };
        let text = seconds.to_string();
        assert_eq!(text, "time    3.500 s (read 0.500, arrange 2.000)\n");
    }

    #[test]
    fn the_text_says_that_the_bounds_are_proven() {
        let text = solid().to_string();
        assert!(
            text.contains("sticks out of the true sweep by at most 0.3 (proven)"),
            "{text}"
        );
        assert!(
            text.contains("falls short of it by at most 0.001 (proven)"),
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
            eigenvalues: [[0.0; 2]; 3],
            fixed_point: None,
            plane_normal: None,
            volume_factor: 1.0,
            margin: None,
            duration: 1.0,
            unique: false,
            half_turn: Some("+"),
        };
        let text = MotionReport {
            interpolation: "steady",
            deviation: None,
            ara: None,
            spans: vec![span],
            volume_factor: 1.0,
            volume_monotone: true,
            fitted: Vec::new(),
        }
        .to_string();
        assert!(text.contains("in the sense +; the sense - leads"), "{text}");
        assert!(text.contains("--half-turn"), "{text}");
        assert!(
            !text.contains("scale"),
            "what does not apply is left out: {text}"
        );
    }
}
