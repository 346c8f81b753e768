//! How far a motion has progressed at a time, described as a screw.

use super::generator::logarithm_per_excess;
use super::{Description, Motion};

/// How far a motion has progressed: the span, and how much of it is completed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// Number of the span, from 0.
    pub span: usize,
    /// Fraction of the span that is over, in [0, 1].
    pub fraction: f64,
    /// The travel since the start of the span.
    pub travelled: Travel,
    /// The travel of the whole span.
    pub whole: Travel,
}

/// Turn, advance and growth relative to the axis of a span's [`Description`]; `None` where a term
/// does not apply to its kind.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Travel {
    /// Turn in degrees, at least 0, of any size.
    pub turn_deg: Option<f64>,
    /// Displacement along the axis; for a translation, its length.
    pub advance: Option<f64>,
    /// Scale factor.
    pub scale: Option<f64>,
}

impl Motion {
    /// How far the motion has progressed within one of its spans.
    ///
    /// - `span`: number of the span, from 0, such as [`Motion::span_at_time`].
    /// - `clock`: a time on the clock; the fraction is 0 before the span and 1 after it.
    ///
    /// # Panics
    /// When there is no such span.
    pub fn progress(&self, span: usize, clock: f64) -> Progress {
        let fraction = self.fraction_of_span(span, clock);
        let described = self.spans()[span].describe();
        Progress {
            span,
            fraction,
            travelled: Travel::part(&described, fraction),
            whole: Travel::part(&described, 1.0),
        }
    }
}

impl Travel {
    /// The travel of the first `fraction` of a span that `described` describes as a whole.
    ///
    /// The turn and the logarithm of the scale grow evenly. The displacement along the axis grows
    /// like the scale: v = r x + c has the path c (e^(rt) - 1)/r, so that the fraction of it is
    /// (s^t - 1)/(s - 1), which tends to t as s tends to 1.
    fn part(described: &Description, fraction: f64) -> Travel {
        let scale = described.scale.map(|scale| scale.powf(fraction));
        let share = match (described.scale, scale) {
            (Some(whole), Some(part)) => {
                fraction * logarithm_per_excess(whole) / logarithm_per_excess(part)
            }
            _ => fraction,
        };
        Travel {
            turn_deg: described.turn_deg.map(|turn| turn * fraction),
            advance: described.advance.map(|advance| advance * share),
            scale,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Generator, Keyframe, Screw, Span, describe};
    use super::*;
    use glam::{DAffine3, DMat3, DVec3};

    fn motion(screws: &[Screw]) -> Motion {
        let span = |screw: &Screw| {
            Span::new(screw.generator().expect("a legal screw"), 2.0).expect("legal")
        };
        Motion::from_spans(screws.iter().map(span).collect()).expect("legal")
    }

    #[test]
    fn a_hinge_has_turned_240_of_270_degrees_after_eight_ninths() {
        let hinge = Screw {
            axis: DVec3::X,
            turn: 270_f64.to_radians(),
            ..Screw::default()
        };
        let progress = motion(&[hinge]).progress(0, 16.0 / 9.0);
        assert_eq!(progress.span, 0);
        // The conversion to radians and back, and a quotient: a few roundings of 270.
        let turn = progress.travelled.turn_deg.expect("it turns");
        assert!((turn - 240.0).abs() < 1e-12, "{turn}");
        let whole = progress.whole.turn_deg.expect("it turns");
        assert!((whole - 270.0).abs() < 1e-12, "{whole}");
        assert_eq!(progress.travelled.advance, None, "it does not advance");
        assert_eq!(progress.travelled.scale, None, "it does not grow");
    }

    /// A part of a span is described as the whole span would be if it ended there.
    #[test]
    fn a_part_of_a_span_is_described_like_a_span() {
        let axis = DVec3::new(0.36, 0.48, 0.8);
        let through = DVec3::new(1.0, -2.0, 0.5);
        for (turn, advance, scale) in [
            (3.0, 0.0, 1.0),
            (-9.0, 4.0, 1.0),
            (0.0, 5.0, 1.0),
            (2.0, 4.0, 0.3),
            (2.0, -4.0, 1.0 + 1e-7),
            (1.0, 0.0, 20.0),
            (0.0, 0.0, 0.5),
        ] {
            let screw = Screw {
                axis,
                through,
                turn,
                advance,
                scale,
            };
            let motion = motion(&[screw]);
            let whole = motion.spans()[0].flow().generator();
            for fraction in [0.125, 0.5, 0.9] {
                let part = describe(&Generator {
                    linear: whole.linear * fraction,
                    offset: whole.offset * fraction,
                });
                let found = motion.progress(0, 2.0 * fraction).travelled;
                for (found, expected) in [
                    (found.turn_deg, part.turn_deg),
                    (found.advance, part.advance),
                    (found.scale, part.scale),
                ] {
                    assert_eq!(found.is_some(), expected.is_some(), "{screw:?}: {part:?}");
                    let (found, expected) = (found.unwrap_or(0.0), expected.unwrap_or(0.0));
                    // Near a scale of 1 the description reads the advance off a rounded generator.
                    assert!(
                        (found - expected).abs() < 1e-12 * (1.0 + expected.abs()),
                        "{screw:?} at {fraction}: {found} against {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn in_a_chain_it_is_told_of_the_span() {
        let slide = Screw {
            axis: DVec3::X,
            advance: 10.0,
            ..Screw::default()
        };
        let turn = Screw {
            axis: DVec3::Z,
            turn: 1.0,
            ..Screw::default()
        };
        let motion = motion(&[slide, turn, slide]);
        assert_eq!(
            [-1.0, 0.0, 1.0, 2.0, 5.0, 6.0, 9.0].map(|time| motion.span_at_time(time)),
            [0, 0, 0, 1, 2, 2, 2],
            "at a joint the span that begins there"
        );
        assert_eq!(motion.progress(2, 5.0).travelled.advance, Some(5.0));
        assert_eq!(motion.progress(0, 2.0).travelled.advance, Some(10.0));
        assert_eq!(motion.progress(1, 1.0).fraction, 0.0, "not yet begun");
        assert_eq!(motion.progress(1, 9.0).fraction, 1.0, "long over");
    }

    #[test]
    fn a_shear_has_no_turn_and_no_way() {
        let shear = DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::ONE, DVec3::Z));
        let keys =
            [(3.0, DAffine3::IDENTITY), (7.0, shear)].map(|(time, pose)| Keyframe { time, pose });
        let motion = Motion::from_keyframes(&keys).expect("legal");
        let progress = motion.progress(0, 4.0);
        assert_eq!(progress.fraction, 0.25);
        let nothing = Travel {
            turn_deg: None,
            advance: None,
            scale: None,
        };
        assert_eq!((progress.travelled, progress.whole), (nothing, nothing));
    }
}
