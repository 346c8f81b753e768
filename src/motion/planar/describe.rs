//! The name of a steady motion of the plane: translation, rotation, spiral, ...

use super::{Generator, Span};
use crate::motion::MotionKind;
use crate::numeric::tolerance::{NEGLIGIBLE_RATE, SIMILARITY};
use glam::DVec2;

/// A steady motion of the plane described as a spiral; `None` where a term does not apply.
///
/// [`Generator::spiral`] of these values, with 0 (for scale: 1) for `None`, gives the generator
/// again, for rotations, scalings and spirals.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Description {
    /// The kind of the motion, never a screw.
    pub kind: MotionKind,
    /// Unit vector: the direction of a translation.
    pub direction: Option<DVec2>,
    /// The fixed point.
    pub through: Option<DVec2>,
    /// Turn in degrees, of any size, positive when counter-clockwise.
    pub turn_deg: Option<f64>,
    /// The length of a translation.
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
    let [x, y] = [generator.linear.x_axis, generator.linear.y_axis];
    let (rate, turn) = (0.5 * (x.x + y.y), 0.5 * (x.y - y.x));
    let nothing = Description {
        kind: MotionKind::Affine,
        direction: None,
        through: None,
        turn_deg: None,
        advance: None,
        scale: None,
    };
    let deviation = (0.5 * (x.x - y.y)).abs().max(0.5 * (x.y + y.x).abs());
    if deviation > NEGLIGIBLE_RATE && deviation > SIMILARITY * rate.abs().max(turn.abs()) {
        return nothing;
    }
    let certain = |rate: f64| {
        if rate.abs() <= NEGLIGIBLE_RATE {
            0.0
        } else {
            rate
        }
    };
    let (rate, turn) = (certain(rate), certain(turn));
    let offset = generator.offset;
    if (rate, turn) == (0.0, 0.0) {
        let length = offset.length();
        return if length == 0.0 {
            Description {
                kind: MotionKind::Identity,
                ..nothing
            }
        } else {
            Description {
                kind: MotionKind::Translation,
                direction: Some(offset / length),
                advance: Some(length),
                ..nothing
            }
        };
    }
    Description {
        kind: match (rate != 0.0, turn != 0.0) {
            (true, true) => MotionKind::Spiral,
            (true, false) => MotionKind::Scaling,
            (false, _) => MotionKind::Rotation,
        },
        // (rate I + turn J) q = -offset, where J^2 = -I
        through: Some((offset.perp() * turn - offset * rate) / (turn * turn + rate * rate)),
        turn_deg: (turn != 0.0).then(|| turn.to_degrees()),
        scale: (rate != 0.0).then(|| rate.exp()),
        ..nothing
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::planar::{Spiral, logarithm};
    use glam::{DAffine2, DMat2};
    use std::f64::consts::PI;

    fn check(spiral: Spiral, kind: MotionKind) -> Description {
        let generator = spiral.generator().expect("a legal spiral");
        let description = describe(&generator);
        assert_eq!(description.kind, kind, "{spiral:?}");
        let again = Generator::spiral(
            description.through.unwrap_or(DVec2::ZERO),
            description.turn_deg.unwrap_or(0.0).to_radians(),
            description.scale.unwrap_or(1.0),
        );
        let size = 1.0 + spiral.turn.abs();
        let linear = (again.linear - generator.linear).to_cols_array();
        let linear = linear.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        assert!(linear < 4e-15 * size, "{spiral:?}: {linear:e}");
        let offset = (again.offset - generator.offset).length();
        assert!(
            offset < 1e-14 * size * (1.0 + generator.offset.length()),
            "{spiral:?}: offset off by {offset:e}"
        );
        description
    }

    #[test]
    fn every_kind_is_named_and_read_back() {
        let through = DVec2::new(1.0, -2.0);
        let spiral = |turn, scale| Spiral {
            through,
            turn,
            scale,
        };
        check(Spiral::default(), MotionKind::Identity);
        check(spiral(3.0 * PI, 1.0), MotionKind::Rotation);
        check(spiral(0.0, 0.6), MotionKind::Scaling);
        for scale in [1.0 + 1e-11, 1.0 - 1e-6, 1e-3, 1e3] {
            check(spiral(-9.0, scale), MotionKind::Spiral);
        }
        let translation = describe(&Generator::translation(DVec2::new(3.0, -4.0)));
        assert_eq!(translation.kind, MotionKind::Translation);
        assert_eq!(translation.direction, Some(DVec2::new(0.6, -0.8)));
        assert_eq!(translation.advance, Some(5.0));
        let shear = Generator {
            linear: DMat2::from_cols(DVec2::ZERO, DVec2::X),
            offset: DVec2::X,
        };
        assert_eq!(describe(&shear).kind, MotionKind::Affine, "a shear");
        let stretch = Generator {
            linear: DMat2::from_diagonal(DVec2::X),
            offset: DVec2::ZERO,
        };
        assert_eq!(describe(&stretch).kind, MotionKind::Affine, "a stretch");
    }

    #[test]
    fn a_turn_keeps_its_sense_and_its_number_of_rounds() {
        let spiral = Spiral {
            turn: -3.0 * PI,
            ..Spiral::default()
        };
        let description = check(spiral, MotionKind::Rotation);
        assert_eq!(description.turn_deg, Some(-540.0), "clockwise");
        assert_eq!(description.scale, None, "no scale");
        assert_eq!(description.through, Some(DVec2::ZERO), "about the origin");
    }

    #[test]
    fn a_rotation_between_two_poses_is_recognised_up_to_the_half_turn() {
        for angle in [1e-6, 0.1, -2.0, PI - 1e-2, PI - 1e-5, PI] {
            let turn = DMat2::from_angle(angle);
            let centre = DVec2::new(3.0, 2.0);
            let a = DAffine2 {
                matrix2: turn,
                translation: centre - turn * centre,
            };
            let description = describe(logarithm(&a).expect("a logarithm").flow.generator());
            assert_eq!(
                description.kind,
                MotionKind::Rotation,
                "angle {angle}: {description:?}"
            );
            let found = description.turn_deg.expect("a turn").to_radians();
            assert!((found - angle).abs() < 1e-12, "angle {angle}: {found}");
            let found = description.through.expect("a centre");
            assert!(
                (found - centre).length() < 1e-15 / angle.abs().min(1.0) * 10.0,
                "angle {angle}: {found}"
            );
        }
    }
}
