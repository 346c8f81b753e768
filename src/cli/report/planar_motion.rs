//! What `steadysweep motion` says about a motion in the plane.

use super::quantities::Vector;
use super::text::{write_interpolation, write_invariants, write_span, write_volume};
use super::{DeviationReport, FittedKeyReport, MarginReport, SteadinessReport};
use crate::io::FittedKey;
use crate::motion::planar::{Motion, Span, existence, invariants};
use crate::motion::scheme::Scheme;
use crate::motion::{MotionKind, Sense, volume_change};
use crate::numeric::Readable;
use glam::DAffine2;
use std::fmt;

/// What `steadysweep motion` found about a motion in the plane.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct PlanarMotionReport {
    /// What lies between its keyframes.
    pub(crate) interpolation: &'static str,
    /// How far it may be from the motion that it stands for; left out where it stands for itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) deviation: Option<DeviationReport>,
    /// How far it is from steady, over a body; left out without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) ara: Option<SteadinessReport>,
    /// One entry per steady span, in the order of time.
    pub(crate) spans: Vec<PlanarSpanReport>,
    /// Area at the end over that at the start.
    pub(crate) volume_factor: f64,
    /// Whether the area only grows, or only shrinks, or stays.
    pub(crate) volume_monotone: bool,
    /// The keyframes that were found from pairs of points.
    pub(crate) fitted: Vec<FittedKeyReport>,
}

/// One steady span in the plane, with the same keys as one in space. A field that does not apply to
/// its kind is `None`, in JSON `null`.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct PlanarSpanReport {
    /// Name of the kind of motion, such as `spiral`.
    pub(crate) kind: &'static str,
    /// Rows of [M tau], the generator of the whole span.
    pub(crate) generator: [[f64; 3]; 2],
    /// Unit vector: the direction of a translation.
    pub(crate) axis: Option<[f64; 2]>,
    /// The point that stays where it is.
    pub(crate) through: Option<[f64; 2]>,
    /// Turn in degrees, from x towards y: counter-clockwise where y is up.
    pub(crate) turn_deg: Option<f64>,
    /// Length of a translation.
    pub(crate) advance: Option<f64>,
    /// Scale factor from start to end.
    pub(crate) scale: Option<f64>,
    /// Eigenvalues of the linear part of the generator, as [re, im].
    pub(crate) eigenvalues: [[f64; 2]; 2],
    /// The only point that stays.
    pub(crate) fixed_point: Option<[f64; 2]>,
    /// Area at the end over that at the start.
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

impl PlanarMotionReport {
    /// The spans of a motion, each described as a spiral.
    ///
    /// - `scheme`: what lies between its keyframes; `fitted`: what the reader did.
    pub(crate) fn new(motion: &Motion, scheme: Scheme, fitted: &[FittedKey]) -> PlanarMotionReport {
        let rates = motion
            .spans()
            .iter()
            .map(|span| span.flow().generator().volume_rate());
        let volume = volume_change(rates);
        PlanarMotionReport {
            interpolation: scheme.name(),
            deviation: DeviationReport::of(motion),
            ara: None,
            spans: motion.spans().iter().map(PlanarSpanReport::new).collect(),
            volume_factor: volume.factor,
            volume_monotone: volume.monotone,
            fitted: FittedKeyReport::list(fitted),
        }
    }
}

impl PlanarSpanReport {
    fn new(span: &Span) -> PlanarSpanReport {
        let described = span.describe();
        let left_alone = invariants(span.flow().generator());
        PlanarSpanReport {
            kind: described.kind.name(),
            generator: span.flow().generator().rows(),
            axis: described.direction.map(|direction| direction.to_array()),
            through: described.through.map(|point| point.to_array()),
            turn_deg: described.turn_deg.or(left_alone.turn.map(f64::to_degrees)),
            advance: described.advance,
            scale: described.scale,
            eigenvalues: left_alone.eigenvalues,
            fixed_point: left_alone.fixed_point.map(|point| point.to_array()),
            volume_factor: left_alone.area_factor,
            margin: MarginReport::new(existence(&DAffine2::IDENTITY, &span.flow().pose_at(1.0))),
            duration: span.duration(),
            unique: span.unique(),
            half_turn: span.half_turn().map(Sense::symbol),
        }
    }
}

impl fmt::Display for PlanarMotionReport {
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
                "span {}: {} in the plane, duration {}",
                index + 1,
                span.kind,
                Readable(span.duration)
            )?;
            write!(f, "{span}")?;
        }
        write_volume(f, "area", self.volume_factor, self.volume_monotone)?;
        self.fitted.iter().try_for_each(|key| write!(f, "{key}"))
    }
}

impl fmt::Display for PlanarSpanReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let vectors = [("direction", self.axis), ("through", self.through)];
        for (name, vector) in vectors.into_iter().filter_map(|(name, v)| Some((name, v?))) {
            writeln!(f, "  {name:<10}{}", Vector(vector))?;
        }
        let numbers = [self.turn_deg, self.advance, self.scale];
        write_span(f, numbers, &self.generator, self.half_turn)?;
        if self.kind == MotionKind::Affine.name() {
            write_invariants(f, &self.eigenvalues, self.fixed_point, None, self.margin)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::planar::Generator;
    use glam::DVec2;

    fn report(generator: Generator) -> PlanarMotionReport {
        let span = Span::new(generator, 2.0).expect("legal");
        PlanarMotionReport::new(
            &Motion::from_spans(vec![span]).expect("legal"),
            Scheme::Steady,
            &[],
        )
    }

    #[test]
    fn a_spiral_is_told_by_centre_turn_and_scale() {
        let text = report(Generator::spiral(
            DVec2::new(3.0, -1.0),
            (-90.0_f64).to_radians(),
            0.5,
        ))
        .to_string();
        let expected = "span 1: spiral in the plane, duration 2\n  through   (3, -1)\n  turn      -90 degrees\n  scale     0.5\n  \
                        generator";
        assert!(text.starts_with(expected), "{text}");
    }

    #[test]
    fn a_translation_has_a_direction_and_a_length() {
        let report = report(Generator::translation(DVec2::new(3.0, -4.0)));
        let json = serde_json::to_string(&report).expect("always writable");
        assert_eq!(
            json,
            r#"{"interpolation":"steady","spans":[{"kind":"translation","generator":[[0.0,0.0,3.0],[0.0,0.0,-4.0]],"axis":[0.6,-0.8],"through":null,"turn_deg":null,"advance":5.0,"scale":null,"eigenvalues":[[0.0,0.0],[0.0,0.0]],"fixed_point":null,"volume_factor":1.0,"margin":{"angle_deg":180.0,"change":1.0},"duration":2.0,"unique":true,"half_turn":null}],"volume_factor":1.0,"volume_monotone":true,"fitted":[]}"#
        );
        assert!(
            report.to_string().contains("direction (0.6, -0.8)"),
            "{report}"
        );
    }
}
