//! The name of a steady motion: translation, rotation, screw, spiral, ...

use super::generator::logarithm_per_excess;
use super::{Generator, Span};
use crate::numeric::tolerance::{NEGLIGIBLE_RATE, SIMILARITY};
use glam::{DMat3, DVec3};

/// The kind of a steady motion: the first in this list that fits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum MotionKind {
    /// Nothing moves.
    Identity,
    /// Every point moves along the same vector.
    Translation,
    /// A turn about an axis.
    Rotation,
    /// A turn about an axis, with an advance along it.
    Screw,
    /// A uniform scaling about a point, without a turn.
    Scaling,
    /// A turn and a uniform scaling.
    Spiral,
    /// Shapes change.
    Affine,
}

impl MotionKind {
    /// The name in reports.
    pub fn name(self) -> &'static str {
        match self {
            MotionKind::Identity => "identity",
            MotionKind::Translation => "translation",
            MotionKind::Rotation => "rotation",
            MotionKind::Screw => "screw",
            MotionKind::Scaling => "scaling",
            MotionKind::Spiral => "spiral",
            MotionKind::Affine => "affine",
        }
    }
}

/// A steady motion described as a screw; `None` where a term does not apply.
///
/// [`Generator::screw`] of these values, with 0 (for scale: 1) for `None`, gives the generator
/// again, for every kind but `Affine`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Description {
    /// The kind of the motion.
    pub kind: MotionKind,
    /// Unit vector: the direction of a translation, or the axis about which the turn is positive.
    pub axis: Option<DVec3>,
    /// The point of the axis nearest the origin; for a scaling without turn, the fixed point.
    pub through: Option<DVec3>,
    /// Turn in degrees, above 0, of any size.
    pub turn_deg: Option<f64>,
    /// How far `through` advances along the axis; for a translation, its length.
    ///
    /// A spiral also has a fixed point, where the advance would be 0. It is not used here, because
    /// it runs off to infinity as the scale nears 1.
    pub advance: Option<f64>,
    /// Uniform scale factor at the end.
    pub scale: Option<f64>,
}

impl Span {
    /// The description of the span.
    pub fn describe(&self) -> Description {
        describe(self.flow().generator())
    }
}

/// The description of exp(G).
///
/// Rates (turn in radians, logarithm of the scale) below `NEGLIGIBLE_RATE` count as 0, and a matrix
/// counts as that of a similarity when it differs from one by less than `SIMILARITY` of its size.
pub fn describe(generator: &Generator) -> Description {
    let linear = &generator.linear;
    let rate = (linear.x_axis.x + linear.y_axis.y + linear.z_axis.z) / 3.0;
    let turn = 0.5
        * DVec3::new(
            linear.y_axis.z - linear.z_axis.y,
            linear.z_axis.x - linear.x_axis.z,
            linear.x_axis.y - linear.y_axis.x,
        );
    let nothing = Description {
        kind: MotionKind::Affine,
        axis: None,
        through: None,
        turn_deg: None,
        advance: None,
        scale: None,
    };
    let symmetric = (*linear + linear.transpose()) * 0.5 - DMat3::from_diagonal(DVec3::splat(rate));
    let size = rate.abs().max(turn.length());
    let deviation = super::deflation::largest_entry(&symmetric);
    if deviation > NEGLIGIBLE_RATE && deviation > SIMILARITY * size {
        return nothing;
    }
    let rate = if rate.abs() <= NEGLIGIBLE_RATE {
        0.0
    } else {
        rate
    };
    let angle = if turn.length() <= NEGLIGIBLE_RATE {
        0.0
    } else {
        turn.length()
    };
    if angle == 0.0 {
        describe_without_turn(rate, generator.offset, nothing)
    } else {
        describe_turn(turn / angle, angle, rate, generator.offset)
    }
}

fn describe_without_turn(rate: f64, offset: DVec3, nothing: Description) -> Description {
    let length = offset.length();
    if rate != 0.0 {
        Description {
            kind: MotionKind::Scaling,
            through: Some(-offset / rate),
            scale: Some(rate.exp()),
            ..nothing
        }
    } else if length == 0.0 {
        Description {
            kind: MotionKind::Identity,
            ..nothing
        }
    } else {
        Description {
            kind: MotionKind::Translation,
            axis: Some(offset / length),
            advance: Some(length),
            ..nothing
        }
    }
}

fn describe_turn(axis: DVec3, angle: f64, rate: f64, offset: DVec3) -> Description {
    let along = axis.dot(offset);
    let across = offset - axis * along;
    // (rate I + angle K) q = -across in the plane of K, where K^2 = -I
    let through = (axis.cross(across) * angle - across * rate) / (angle * angle + rate * rate);
    let scale = rate.exp();
    let advance = along / logarithm_per_excess(scale);
    let advances = advance.abs() > NEGLIGIBLE_RATE * offset.length();
    Description {
        kind: match (rate != 0.0, advances) {
            (true, _) => MotionKind::Spiral,
            (false, true) => MotionKind::Screw,
            (false, false) => MotionKind::Rotation,
        },
        axis: Some(axis),
        through: Some(through),
        turn_deg: Some(angle.to_degrees()),
        advance: advances.then_some(advance),
        scale: (rate != 0.0).then_some(scale),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{Screw, logarithm};
    use glam::{DAffine3, DQuat};
    use std::f64::consts::PI;

    fn back(description: &Description) -> Generator {
        Generator::screw(
            description.axis.unwrap_or(DVec3::ZERO),
            description.through.unwrap_or(DVec3::ZERO),
            description.turn_deg.unwrap_or(0.0).to_radians(),
            description.advance.unwrap_or(0.0),
            description.scale.unwrap_or(1.0),
        )
    }

    fn check(screw: Screw, kind: MotionKind) -> Description {
        let generator = screw.generator().expect("a legal screw");
        let description = describe(&generator);
        assert_eq!(description.kind, kind, "{screw:?}");
        let again = back(&description);
        let size = 1.0 + screw.turn.abs();
        let linear = super::super::deflation::largest_entry(&(again.linear - generator.linear));
        assert!(
            linear < 4e-15 * size,
            "{screw:?}: linear part off by {linear:e}"
        );
        let offset = (again.offset - generator.offset).length();
        assert!(
            offset < 1e-14 * size * (1.0 + generator.offset.length()),
            "{screw:?}: offset off by {offset:e}"
        );
        description
    }

    #[test]
    fn every_kind_is_named_and_read_back() {
        let axis = DVec3::new(0.36, 0.48, 0.8);
        let through = DVec3::new(1.0, -2.0, 0.5);
        check(Screw::default(), MotionKind::Identity);
        check(
            Screw {
                axis,
                advance: -3.0,
                ..Screw::default()
            },
            MotionKind::Translation,
        );
        check(
            Screw {
                axis,
                through,
                turn: 3.0 * PI,
                ..Screw::default()
            },
            MotionKind::Rotation,
        );
        check(
            Screw {
                axis,
                through,
                turn: -2.0,
                advance: 0.25,
                scale: 1.0,
            },
            MotionKind::Screw,
        );
        check(
            Screw {
                through,
                scale: 0.6,
                ..Screw::default()
            },
            MotionKind::Scaling,
        );
        check(
            Screw {
                axis,
                through,
                turn: 1.0,
                advance: 0.0,
                scale: 0.6,
            },
            MotionKind::Spiral,
        );
        for scale in [1.0 + 1e-11, 1.0 - 1e-6, 1e-3, 1e3] {
            check(
                Screw {
                    axis,
                    through,
                    turn: 9.0,
                    advance: 4.0,
                    scale,
                },
                MotionKind::Spiral,
            );
        }
        let shear = Generator {
            linear: DMat3::from_cols(DVec3::ZERO, DVec3::X, DVec3::ZERO),
            offset: DVec3::X,
        };
        assert_eq!(describe(&shear).kind, MotionKind::Affine, "a shear");
        let stretch = Generator {
            linear: DMat3::from_diagonal(DVec3::X),
            offset: DVec3::ZERO,
        };
        assert_eq!(describe(&stretch).kind, MotionKind::Affine, "a stretch");
    }

    #[test]
    fn one_and_a_half_turns_are_five_hundred_and_forty_degrees() {
        let screw = Screw {
            axis: DVec3::Z,
            turn: 3.0 * PI,
            advance: 3.0,
            ..Screw::default()
        };
        let description = check(screw, MotionKind::Screw);
        assert_eq!(
            description.turn_deg,
            Some(540.0),
            "beyond what two poses can tell"
        );
        assert_eq!(description.axis, Some(DVec3::Z), "the axis as given");
        assert_eq!(description.through, Some(DVec3::ZERO), "through the origin");
        assert_eq!(description.advance, Some(3.0), "the advance as given");
        assert_eq!(description.scale, None, "no scale");
    }

    #[test]
    fn a_negative_turn_is_a_positive_one_about_the_opposite_axis() {
        let screw = Screw {
            axis: DVec3::Z,
            turn: -1.0,
            advance: 2.0,
            ..Screw::default()
        };
        let description = check(screw, MotionKind::Screw);
        assert_eq!(description.axis, Some(-DVec3::Z), "opposite");
        assert_eq!(description.advance, Some(-2.0), "and so is the advance");
    }

    #[test]
    fn a_rotation_between_two_poses_is_recognised_up_to_the_half_turn() {
        let axis = DVec3::new(0.36, 0.48, 0.8);
        for angle in [1e-6, 0.1, 2.0, PI - 1e-2, PI - 1e-5, PI] {
            let turn = DMat3::from_quat(DQuat::from_axis_angle(axis, angle));
            let centre = DVec3::new(3.0, 2.0, 1.0);
            let a = DAffine3 {
                matrix3: turn,
                translation: centre - turn * centre,
            };
            let description = describe(logarithm(&a).expect("a logarithm").flow.generator());
            assert!(
                matches!(description.kind, MotionKind::Rotation | MotionKind::Screw),
                "angle {angle}: {description:?}"
            );
            let found = description.turn_deg.expect("a turn").to_radians();
            assert!((found - angle).abs() < 1e-9, "angle {angle}: {found}");
            assert!(
                description.advance.unwrap_or(0.0).abs() < 1e-9,
                "angle {angle}: {description:?}"
            );
        }
    }
}
