//! Where a body is at a time: its pose, and how far its motion has progressed.

use super::quantities::without_noise;
use crate::motion::{Motion, Progress, Travel};
use crate::numeric::Readable;
use std::fmt;

/// Rows of [L t], which maps a point p of the file to L p + t in world coordinates.
pub(crate) type PoseRows = [[f64; 4]; 3];

/// Where the body is at a time.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub(crate) struct PlaceReport {
    /// Time on the clock of the body's motion.
    pub(crate) time: f64,
    /// Pose of the body at that time.
    pub(crate) pose: PoseRows,
    /// How far its motion has progressed.
    pub(crate) progress: ProgressReport,
}

/// How far a motion has progressed, in the terms in which `steadysweep motion` describes the span.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub(crate) struct ProgressReport {
    /// Number of the span, from 0.
    pub(crate) span: usize,
    /// Share of the span that is over, from 0 to 1.
    pub(crate) fraction: f64,
    /// Degrees turned since the start of the span, about its axis by the right-hand rule.
    pub(crate) turn_deg: Option<f64>,
    /// Displacement along the axis since the start of the span.
    pub(crate) advance: Option<f64>,
    /// Scale factor since the start of the span.
    pub(crate) scale: Option<f64>,
    /// The same for the whole span.
    pub(crate) of: TravelReport,
}

/// What a whole span does. A field that does not apply to its kind is `None`, in JSON `null`.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub(crate) struct TravelReport {
    /// Turn in degrees, of any size.
    pub(crate) turn_deg: Option<f64>,
    /// Displacement along the axis.
    pub(crate) advance: Option<f64>,
    /// Scale factor.
    pub(crate) scale: Option<f64>,
}

impl PlaceReport {
    /// The body in the middle of a motion.
    ///
    /// - `span`: number of a span that contains `time`; at a joint, either of the two.
    pub(crate) fn new(motion: &Motion, span: usize, time: f64) -> PlaceReport {
        PlaceReport {
            time,
            pose: pose_at_time(motion, time),
            progress: ProgressReport::new(&motion.progress(span, time)),
        }
    }

    /// The body at a time of its motion; where two spans meet, in the one that begins there.
    pub(crate) fn at_time(motion: &Motion, time: f64) -> PlaceReport {
        PlaceReport::new(motion, motion.span_at_time(time), time)
    }
}

impl ProgressReport {
    fn new(progress: &Progress) -> ProgressReport {
        let Travel {
            turn_deg,
            advance,
            scale,
        } = progress.travelled;
        let whole = progress.whole;
        ProgressReport {
            span: progress.span,
            fraction: progress.fraction,
            turn_deg,
            advance,
            scale,
            of: TravelReport {
                turn_deg: whole.turn_deg,
                advance: whole.advance,
                scale: whole.scale,
            },
        }
    }
}

/// The pose of a motion at a time of its clock.
pub(super) fn pose_at_time(motion: &Motion, time: f64) -> PoseRows {
    let pose = motion.pose_at_time(time);
    [0, 1, 2].map(|row| {
        let [x, y, z] = pose.matrix3.row(row).to_array();
        [x, y, z, pose.translation[row]]
    })
}

/// `turned 240 of 270 degrees, advanced 20 of 30`; the caller adds the number of the span, since it
/// knows how many there are.
impl fmt::Display for ProgressReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let both =
            |part: Option<f64>, whole: Option<f64>| Some((Readable(part?), Readable(whole?)));
        let mut separator = "";
        if let Some((part, whole)) = both(self.turn_deg, self.of.turn_deg) {
            write!(f, "turned {part} of {whole} degrees")?;
            separator = ", ";
        }
        if let Some((part, whole)) = both(self.advance, self.of.advance) {
            write!(f, "{separator}advanced {part} of {whole}")?;
            separator = ", ";
        }
        if let Some((part, whole)) = both(self.scale, self.of.scale) {
            write!(f, "{separator}scaled by {part}, at the end by {whole}")?;
            separator = ", ";
        }
        if separator.is_empty() {
            write!(f, "{} of the span is over", Readable(self.fraction))?;
        }
        Ok(())
    }
}

/// A pose for reading, in the form of a `matrix` in a motion file:
/// `[[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0]]`.
pub(super) struct Matrix(pub(super) PoseRows);

impl fmt::Display for Matrix {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Matrix(pose) = self;
        // The linear part and the shift separately: beside a shift by thousands, a turn by a
        // billionth must not count as noise.
        let linear = without_noise([0, 1, 2, 4, 5, 6, 8, 9, 10].map(|i| pose[i / 4][i % 4]));
        let shift = without_noise(pose.map(|row| row[3]));
        let row = |i: usize| {
            let [x, y, z] = [0, 1, 2].map(|j| Readable(linear[3 * i + j]));
            format!("[{x}, {y}, {z}, {}]", Readable(shift[i]))
        };
        write!(f, "[{}]", [0, 1, 2].map(row).join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{Generator, Screw, Span};
    use glam::{DMat3, DVec3};

    fn place(generator: Generator, time: f64) -> PlaceReport {
        let span = Span::new(generator, 1.0).expect("legal");
        PlaceReport::at_time(&Motion::from_spans(vec![span]).expect("legal"), time)
    }

    fn screw(turn_deg: f64, advance: f64, scale: f64) -> Generator {
        let screw = Screw {
            axis: DVec3::Z,
            through: DVec3::X,
            turn: f64::to_radians(turn_deg),
            advance,
            scale,
        };
        screw.generator().expect("legal")
    }

    #[test]
    fn the_place_in_the_middle_of_a_screw_is_told_in_its_terms() {
        let place = place(screw(360.0, 30.0, 1.0), 0.25);
        assert_eq!(
            place.progress.to_string(),
            "turned 90 of 360 degrees, advanced 7.5 of 30"
        );
        assert_eq!(
            Matrix(place.pose).to_string(),
            "[[0, -1, 0, 1], [1, 0, 0, -1], [0, 0, 1, 7.5]]",
            "a quarter turn about (1, 0)"
        );
    }

    #[test]
    fn every_kind_of_span_has_words() {
        let shear = Generator {
            linear: DMat3::from_cols(DVec3::ZERO, DVec3::X, DVec3::ZERO),
            offset: DVec3::ZERO,
        };
        for (generator, expected) in [
            (screw(-60.0, 0.0, 1.0), "turned 30 of 60 degrees"),
            (screw(0.0, -8.0, 1.0), "advanced 4 of 8"),
            (screw(0.0, 0.0, 4.0), "scaled by 2, at the end by 4"),
            (
                screw(90.0, 6.0, 4.0),
                "turned 45 of 90 degrees, advanced 2 of 6, scaled by 2, at the end by 4",
            ),
            (shear, "0.5 of the span is over"),
            (screw(0.0, 0.0, 1.0), "0.5 of the span is over"),
        ] {
            assert_eq!(place(generator, 0.5).progress.to_string(), expected);
        }
    }

    #[test]
    fn json_has_rows_and_nulls_for_what_does_not_apply() {
        let json = serde_json::to_value(place(screw(0.0, 8.0, 1.0), 0.5)).expect("writable");
        let expected = serde_json::json!({
            "time": 0.5,
            "pose": [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 4.0]],
            "progress": {
                "span": 0, "fraction": 0.5, "turn_deg": null, "advance": 4.0, "scale": null,
                "of": {"turn_deg": null, "advance": 8.0, "scale": null}
            }
        });
        assert_eq!(json, expected);
    }
}
