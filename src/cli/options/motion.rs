//! The options that describe a motion, in space or in the plane.

use super::half_turn::HalfTurnOption;
use super::{MOTION, coordinates, finite, positive_factor, triple};
use crate::io::Dimension;
use crate::motion::{Generator, Motion, MotionError, Screw, Span, planar};
use clap::Args;
use glam::{DVec2, DVec3};
use std::path::PathBuf;

/// `--motion FILE.json | --turn DEG --axis X,Y,Z [..] | --translate X,Y,Z`, as written; in the
/// plane without axis and advance, and with X,Y for points and vectors.
#[derive(Debug, Args)]
pub(crate) struct MotionOptions {
    /// Motion file with keyframes, spans or a log of poses (page "Motions" of the guide, src/docs/motions.md).
    #[arg(long, help_heading = MOTION, value_name = "FILE.json")]
    motion: Option<PathBuf>,

    /// Turn about --axis by the right-hand rule, in the plane from x towards y (clockwise on the
    /// screen in an SVG, where y points down), in degrees, of either sign, up to 25,000 turns.
    #[arg(long, help_heading = MOTION, value_name = "DEG", allow_hyphen_values = true, value_parser = finite)]
    turn: Option<f64>,

    /// Direction of the axis of --turn, of any length but zero; not in the plane.
    #[arg(long, help_heading = MOTION, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = triple)]
    axis: Option<DVec3>,

    /// Point on the axis of --turn and centre of --scale, in the body's units; in the plane X,Y;
    /// default: the origin.
    #[arg(long, help_heading = MOTION, value_name = "X,Y[,Z]", allow_hyphen_values = true, value_parser = coordinates)]
    through: Option<Coordinates>,

    /// Displacement along --axis during --turn, in the body's units; not in the plane; default: 0.
    #[arg(long, help_heading = MOTION, value_name = "LEN", allow_hyphen_values = true, value_parser = finite)]
    advance: Option<f64>,

    /// Factor, above 0, by which the body has grown at the end of --turn; default: 1.
    #[arg(long, help_heading = MOTION, value_name = "S", allow_hyphen_values = true, value_parser = positive_factor)]
    scale: Option<f64>,

    /// Displacement along a straight line from start to end, in the body's units; in the plane X,Y.
    #[arg(long, help_heading = MOTION, value_name = "X,Y[,Z]", allow_hyphen_values = true, value_parser = coordinates)]
    translate: Option<Coordinates>,

    #[command(flatten)]
    pub(crate) half_turn: HalfTurnOption,
}

/// A point or a vector, in the plane or in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Coordinates {
    Plane(DVec2),
    Space(DVec3),
}

/// The source of a motion, once the options are known to fit together.
#[derive(Debug, PartialEq)]
pub(crate) enum MotionSource<G = Generator> {
    /// A motion file.
    File(PathBuf),
    /// One span given on the command line.
    Span(G),
}

/// The one form in which the options give a motion.
enum MotionChoice {
    File(PathBuf),
    /// The turn in degrees.
    Turn(f64),
    Translation(Coordinates),
}

/// Why motion options do not describe one motion.
#[derive(Debug, PartialEq, thiserror::Error)]
pub(crate) enum MotionOptionsError {
    #[error(
        "no motion given: add --motion FILE.json, or --turn DEG --axis X,Y,Z, or --translate X,Y,Z"
    )]
    Missing,
    #[error(
        "no motion given: add --motion FILE.json, or --turn DEG (with --through X,Y and --scale S as needed), or --translate X,Y"
    )]
    MissingInPlane,
    #[error("{first} and {second} exclude each other: a motion is given in one way only")]
    Conflict {
        first: &'static str,
        second: &'static str,
    },
    #[error("{option} belongs to --turn, which is missing: add --turn DEG (0 for no turn)")]
    WithoutTurn { option: &'static str },
    #[error(
        "{option} needs --axis X,Y,Z, the direction of the axis (0,0,1 for the upward vertical); a turn in the plane has \
         --through X,Y instead"
    )]
    WithoutAxis { option: &'static str },
    #[error(
        "--axis 0,0,0 has no direction: give a vector that is not zero, for example --axis 0,0,1"
    )]
    ZeroAxis,
    #[error("{option} has two numbers, as in the plane: in space it needs three, X,Y,Z")]
    TwoNumbers { option: &'static str },
    #[error("{option} has three numbers, as in space: in the plane it needs two, X,Y")]
    ThreeNumbers { option: &'static str },
    #[error(
        "{option} belongs to a motion in space: leave it out, in the plane --turn is from x towards y about --through X,Y"
    )]
    InSpace { option: &'static str },
    #[error("the motion of the options: {0}")]
    Motion(#[from] MotionError),
}

impl MotionOptions {
    /// The one motion in space that the options describe.
    pub(crate) fn source(&self) -> Result<MotionSource, MotionOptionsError> {
        Ok(match self.choice()? {
            MotionChoice::File(path) => MotionSource::File(path),
            MotionChoice::Turn(turn_deg) => MotionSource::Span(self.screw(turn_deg)?),
            MotionChoice::Translation(displacement) => MotionSource::Span(Generator::translation(
                displacement.in_space("--translate")?,
            )),
        })
    }

    /// The one motion in the plane that the options describe.
    pub(crate) fn planar_source(
        &self,
    ) -> Result<MotionSource<planar::Generator>, MotionOptionsError> {
        let choice = self.choice().map_err(|error| match error {
            MotionOptionsError::Missing => MotionOptionsError::MissingInPlane,
            other => other,
        })?;
        Ok(match choice {
            MotionChoice::File(path) => MotionSource::File(path),
            MotionChoice::Turn(turn_deg) => MotionSource::Span(self.spiral(turn_deg)?),
            MotionChoice::Translation(displacement) => MotionSource::Span(
                planar::Generator::translation(displacement.in_plane("--translate")?),
            ),
        })
    }

    /// Whether the options describe a motion in the plane or in space; they do not tell for a
    /// motion file.
    pub(crate) fn dimension(&self) -> Dimension {
        let vectors = [self.through, self.translate];
        let in_plane = vectors
            .iter()
            .any(|vector| matches!(vector, Some(Coordinates::Plane(_))));
        if in_plane && self.axis.is_none() && self.advance.is_none() {
            Dimension::Plane
        } else {
            Dimension::Space
        }
    }

    /// The one motion that the options choose.
    fn choice(&self) -> Result<MotionChoice, MotionOptionsError> {
        let motions = [
            ("--motion", self.motion.is_some()),
            ("--turn", self.turn.is_some()),
            ("--translate", self.translate.is_some()),
        ];
        let parts = [
            ("--axis", self.axis.is_some()),
            ("--through", self.through.is_some()),
            ("--advance", self.advance.is_some()),
            ("--scale", self.scale.is_some()),
        ];
        let given = |options: &[(&'static str, bool)]| -> Vec<&'static str> {
            options
                .iter()
                .filter(|(_, is_given)| *is_given)
                .map(|(name, _)| *name)
                .collect()
        };
        let (motions, parts) = (given(&motions), given(&parts));
        if let [first, second, ..] = motions[..] {
            return Err(MotionOptionsError::Conflict { first, second });
        }
        match (&self.motion, self.turn, self.translate) {
            (Some(_), ..) | (_, _, Some(_)) if !parts.is_empty() => {
                Err(MotionOptionsError::Conflict {
                    first: motions[0],
                    second: parts[0],
                })
            }
            (Some(path), ..) => Ok(MotionChoice::File(path.clone())),
            (_, _, Some(displacement)) => Ok(MotionChoice::Translation(displacement)),
            (_, Some(turn_deg), _) => Ok(MotionChoice::Turn(turn_deg)),
            (None, None, None) => Err(match parts.first() {
                Some(option) => MotionOptionsError::WithoutTurn { option },
                None => MotionOptionsError::Missing,
            }),
        }
    }

    fn screw(&self, turn_deg: f64) -> Result<Generator, MotionOptionsError> {
        let still = Screw::default();
        let through = self.through.map(|point| point.in_space("--through"));
        let screw = Screw {
            axis: self.axis.unwrap_or(still.axis),
            through: through.transpose()?.unwrap_or(still.through),
            turn: turn_deg.to_radians(),
            advance: self.advance.unwrap_or(still.advance),
            scale: self.scale.unwrap_or(still.scale),
        };
        match self.axis {
            Some(DVec3::ZERO) => return Err(MotionOptionsError::ZeroAxis),
            None if screw.turn != 0.0 => {
                return Err(MotionOptionsError::WithoutAxis { option: "--turn" });
            }
            None if screw.advance != 0.0 => {
                return Err(MotionOptionsError::WithoutAxis {
                    option: "--advance",
                });
            }
            // Without turn and advance the axis has no influence.
            _ => {}
        }
        Ok(screw.generator()?)
    }

    fn spiral(&self, turn_deg: f64) -> Result<planar::Generator, MotionOptionsError> {
        let foreign = [
            ("--axis", self.axis.is_some()),
            ("--advance", self.advance.is_some()),
        ];
        if let Some(&(option, _)) = foreign.iter().find(|(_, given)| *given) {
            return Err(MotionOptionsError::InSpace { option });
        }
        let still = planar::Spiral::default();
        let through = self.through.map(|point| point.in_plane("--through"));
        let spiral = planar::Spiral {
            through: through.transpose()?.unwrap_or(still.through),
            turn: turn_deg.to_radians(),
            scale: self.scale.unwrap_or(still.scale),
        };
        Ok(spiral.generator()?)
    }
}

impl Coordinates {
    fn in_space(self, option: &'static str) -> Result<DVec3, MotionOptionsError> {
        match self {
            Coordinates::Space(vector) => Ok(vector),
            Coordinates::Plane(_) => Err(MotionOptionsError::TwoNumbers { option }),
        }
    }

    fn in_plane(self, option: &'static str) -> Result<DVec2, MotionOptionsError> {
        match self {
            Coordinates::Plane(vector) => Ok(vector),
            Coordinates::Space(_) => Err(MotionOptionsError::ThreeNumbers { option }),
        }
    }
}

/// A motion of one span that lasts one unit of time.
pub(crate) fn single_span(generator: Generator) -> Result<Motion, MotionOptionsError> {
    Ok(Motion::from_spans(vec![Span::new(generator, 1.0)?])?)
}

/// A motion in the plane of one span that lasts one unit of time.
pub(crate) fn planar_single_span(
    generator: planar::Generator,
) -> Result<planar::Motion, MotionOptionsError> {
    let span = planar::Span::new(generator, 1.0)?;
    Ok(planar::Motion::from_spans(vec![span])?)
}

#[cfg(test)]
mod tests {
    use super::super::{Command, Options};
    use super::*;
    use clap::Parser;

    fn source_of(arguments: &str) -> Result<MotionSource, MotionOptionsError> {
        parsed(arguments).source()
    }

    #[test]
    fn a_turn_with_every_option_is_a_screw() {
        let expected = Generator::screw(
            -DVec3::Z,
            DVec3::new(-1.0, 2.0, 0.0),
            (-90.0_f64).to_radians(),
            -3.0,
            0.5,
        );
        assert_eq!(
            source_of("--turn -90 --axis -0,0,-7 --through -1,2,0 --advance -3 --scale .5"),
            Ok(MotionSource::Span(expected)),
            "minus signs belong to the values, and the axis may have any length"
        );
    }

    #[test]
    fn a_turn_of_zero_needs_no_axis() {
        let expected = Generator::screw(DVec3::Z, DVec3::ZERO, 0.0, 0.0, 2.0);
        assert_eq!(
            source_of("--turn 0 --scale 2"),
            Ok(MotionSource::Span(expected)),
            "a pure scaling has no axis"
        );
    }

    #[test]
    fn options_that_do_not_fit_together_are_refused_by_name() {
        use MotionOptionsError::{Conflict, Missing, WithoutAxis, WithoutTurn, ZeroAxis};
        let cases = [
            ("", Missing),
            ("--turn 90", WithoutAxis { option: "--turn" }),
            (
                "--turn 0 --advance 3",
                WithoutAxis {
                    option: "--advance",
                },
            ),
            ("--turn 90 --axis 0,0,0", ZeroAxis),
            ("--axis 0,0,1 --scale 2", WithoutTurn { option: "--axis" }),
            ("--scale 2", WithoutTurn { option: "--scale" }),
            (
                "--turn 90 --axis 0,0,1 --translate 1,0,0",
                Conflict {
                    first: "--turn",
                    second: "--translate",
                },
            ),
            (
                "--motion a.json --turn 90",
                Conflict {
                    first: "--motion",
                    second: "--turn",
                },
            ),
            (
                "--motion a.json --scale 2",
                Conflict {
                    first: "--motion",
                    second: "--scale",
                },
            ),
            (
                "--translate 1,0,0 --through 1,1,1",
                Conflict {
                    first: "--translate",
                    second: "--through",
                },
            ),
        ];
        for (arguments, expected) in cases {
            assert_eq!(source_of(arguments), Err(expected), "options: {arguments}");
        }
    }

    fn parsed(arguments: &str) -> MotionOptions {
        let words = ["steadysweep", "motion"]
            .into_iter()
            .chain(arguments.split_whitespace());
        match Options::try_parse_from(words)
            .expect("the words must parse")
            .command
        {
            Command::Motion(options) => options.motion,
            other => panic!("parsed as {other:?}"),
        }
    }

    #[test]
    fn in_the_plane_a_turn_has_a_centre_and_no_axis() {
        let spiral =
            planar::Generator::spiral(DVec2::new(-1.0, 2.0), (-90.0_f64).to_radians(), 0.5);
        let cases = [
            ("--turn -90 --through -1,2 --scale .5", spiral),
            (
                "--turn 90",
                planar::Generator::spiral(DVec2::ZERO, 90.0_f64.to_radians(), 1.0),
            ),
            (
                "--translate -1,2",
                planar::Generator::translation(DVec2::new(-1.0, 2.0)),
            ),
        ];
        for (arguments, expected) in cases {
            assert_eq!(
                parsed(arguments).planar_source(),
                Ok(MotionSource::Span(expected)),
                "{arguments}"
            );
        }
    }

    #[test]
    fn numbers_of_the_other_dimension_are_refused_by_name() {
        use MotionOptionsError::{InSpace, MissingInPlane, ThreeNumbers, TwoNumbers};
        let planar = [
            ("", MissingInPlane),
            ("--turn 9 --axis 0,0,1", InSpace { option: "--axis" }),
            (
                "--turn 9 --advance 1",
                InSpace {
                    option: "--advance",
                },
            ),
            (
                "--turn 9 --through 1,2,3",
                ThreeNumbers {
                    option: "--through",
                },
            ),
            (
                "--translate 1,2,3",
                ThreeNumbers {
                    option: "--translate",
                },
            ),
        ];
        for (arguments, expected) in planar {
            assert_eq!(
                parsed(arguments).planar_source(),
                Err(expected),
                "{arguments}"
            );
        }
        let spatial = [
            (
                "--turn 9 --axis 0,0,1 --through 1,2",
                TwoNumbers {
                    option: "--through",
                },
            ),
            (
                "--translate 1,2",
                TwoNumbers {
                    option: "--translate",
                },
            ),
        ];
        for (arguments, expected) in spatial {
            assert_eq!(parsed(arguments).source(), Err(expected), "{arguments}");
        }
    }

    #[test]
    fn the_dimension_of_options_is_seen_in_the_numbers() {
        let cases = [
            ("--turn 9 --through 1,2", Dimension::Plane),
            ("--translate 1,2", Dimension::Plane),
            ("--translate 1,2,3", Dimension::Space),
            ("--turn 9 --axis 0,0,1 --through 1,2", Dimension::Space),
            ("--turn 9", Dimension::Space),
        ];
        for (arguments, expected) in cases {
            assert_eq!(parsed(arguments).dimension(), expected, "{arguments}");
        }
    }
}
