//! The velocity field v(p) = M p + tau of a steady affine motion.

use super::MotionError;
use glam::{DAffine3, DMat3, DVec3};

/// The generator G = [M tau; 0 0] of a steady affine motion: its velocity field v(p) = M p + tau.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use std::f64::consts::PI;
/// use steadysweep::motion::Generator;
///
/// // Half a turn about the z axis, three up.
/// let screw = Generator::screw(DVec3::Z, DVec3::ZERO, PI, 3.0, 1.0);
/// assert_eq!(screw.velocity(DVec3::X), DVec3::new(0.0, PI, 3.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Generator {
    /// M, for the whole span.
    pub linear: DMat3,
    /// tau: the velocity of the origin.
    pub offset: DVec3,
}

/// A screw motion as a user describes it. By default it stands still.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Screw {
    /// Direction of the axis, of any length; zero is allowed when the motion neither turns nor
    /// advances.
    pub axis: DVec3,
    /// A point on the axis.
    pub through: DVec3,
    /// Turn in radians, by the right-hand rule, of any size.
    pub turn: f64,
    /// How far `through` advances along the axis.
    pub advance: f64,
    /// Uniform scale factor at the end, above 0.
    pub scale: f64,
}

impl Default for Screw {
    fn default() -> Screw {
        Screw {
            axis: DVec3::ZERO,
            through: DVec3::ZERO,
            turn: 0.0,
            advance: 0.0,
            scale: 1.0,
        }
    }
}

impl Screw {
    /// The generator of the whole screw.
    ///
    /// # Errors
    /// [`MotionError::NonFinite`], [`MotionError::ScaleNotPositive`], and [`MotionError::ZeroAxis`]
    /// when there is a turn or an advance but no axis.
    pub fn generator(&self) -> Result<Generator, MotionError> {
        let finite = [
            ("axis", self.axis.is_finite()),
            ("point on the axis", self.through.is_finite()),
            ("turn", self.turn.is_finite()),
            ("advance", self.advance.is_finite()),
            ("scale", self.scale.is_finite()),
        ];
        if let Some(&(what, _)) = finite.iter().find(|(_, finite)| !finite) {
            return Err(MotionError::NonFinite { what });
        }
        if self.scale <= 0.0 {
            return Err(MotionError::ScaleNotPositive { scale: self.scale });
        }
        // Divided by its largest component first: an axis of length 1e-200 is a valid axis.
        let largest = self.axis.abs().max_element();
        let axis = if largest > 0.0 {
            (self.axis / largest).normalize()
        } else {
            DVec3::ZERO
        };
        if axis == DVec3::ZERO && (self.turn != 0.0 || self.advance != 0.0) {
            return Err(MotionError::ZeroAxis);
        }
        let generator = Generator::screw(axis, self.through, self.turn, self.advance, self.scale);
        if generator.is_finite() {
            Ok(generator)
        } else {
            Err(MotionError::Overflow)
        }
    }
}

impl Generator {
    /// The Frobenius norm of M, rounded up: a bound on |M v| / |v|.
    pub(crate) fn size(&self) -> f64 {
        super::enclosure::frobenius_bound(&self.linear)
    }

    /// v(p) = M p + tau.
    pub fn velocity(&self, point: DVec3) -> DVec3 {
        self.linear * point + self.offset
    }
    /// Second derivative of the path through `point`: M v(p).
    pub fn acceleration(&self, point: DVec3) -> DVec3 {
        self.linear * self.velocity(point)
    }
    /// tr M: the logarithm of the factor by which volumes change.
    pub fn volume_rate(&self) -> f64 {
        self.linear.x_axis.x + self.linear.y_axis.y + self.linear.z_axis.z
    }
    /// The generator in the frame whose pose is `pose`: pose^-1 G pose.
    pub fn in_frame(&self, pose: &DAffine3) -> Generator {
        let inverse = pose.matrix3.inverse();
        Generator {
            linear: inverse * self.linear * pose.matrix3,
            offset: inverse * self.velocity(pose.translation),
        }
    }
    /// The generator of the motion `factor` times as fast.
    pub fn scaled(&self, factor: f64) -> Generator {
        Generator {
            linear: self.linear * factor,
            offset: self.offset * factor,
        }
    }
    /// Whether every entry is finite.
    pub fn is_finite(&self) -> bool {
        self.linear.is_finite() && self.offset.is_finite()
    }
    /// Whether all paths are straight lines that are parallel or meet in one point: a translation,
    /// growth about a point, or a shear along itself. Then segments sweep flat pieces.
    ///
    /// The paths of a shear M = s n^T that moves across s, but not along n, are straight too. But
    /// their directions differ, so that segments sweep twisted pieces.
    pub(crate) fn moves_straight(&self) -> bool {
        let (linear, offset) = (self.linear, self.offset);
        let grows = linear == DMat3::from_diagonal(DVec3::splat(linear.x_axis.x));
        let is_along = |column: DVec3| column.cross(offset) == DVec3::ZERO;
        let shears = linear * linear == DMat3::ZERO && linear * offset == DVec3::ZERO;
        grows || shears && [linear.x_axis, linear.y_axis, linear.z_axis].map(is_along) == [true; 3]
    }
    /// From the rows [M | tau].
    ///
    /// # Errors
    /// [`MotionError::NonFinite`].
    pub fn from_rows(rows: [[f64; 4]; 3]) -> Result<Generator, MotionError> {
        let column = |j: usize| DVec3::new(rows[0][j], rows[1][j], rows[2][j]);
        let generator = Generator {
            linear: DMat3::from_cols(column(0), column(1), column(2)),
            offset: column(3),
        };
        if generator.is_finite() {
            Ok(generator)
        } else {
            Err(MotionError::NonFinite { what: "generator" })
        }
    }
    /// The rows [M | tau].
    pub fn rows(&self) -> [[f64; 4]; 3] {
        let row = |i: usize| {
            let linear = self.linear.row(i);
            [linear.x, linear.y, linear.z, self.offset[i]]
        };
        [row(0), row(1), row(2)]
    }
    /// The translation by `displacement` in one span.
    pub fn translation(displacement: DVec3) -> Generator {
        Generator {
            linear: DMat3::ZERO,
            offset: displacement,
        }
    }
    /// The turn by `turn` radians (right-hand rule, any size) about the line through `through`
    /// along the unit vector `axis`, with scaling by `scale` > 0, while `through` advances by
    /// `advance` along the axis.
    ///
    /// M = turn K + ln(scale) I with K the cross-product matrix of the axis, tau = -M through +
    /// axis advance ln(scale)/(scale - 1). For values from a user see [`Screw`], which checks them.
    pub fn screw(axis: DVec3, through: DVec3, turn: f64, advance: f64, scale: f64) -> Generator {
        let turn = axis * turn;
        let rate = scale.ln();
        let linear = DMat3::from_cols(
            DVec3::new(rate, turn.z, -turn.y),
            DVec3::new(-turn.z, rate, turn.x),
            DVec3::new(turn.y, -turn.x, rate),
        );
        Generator {
            linear,
            offset: axis * (advance * logarithm_per_excess(scale)) - linear * through,
        }
    }
}

/// ln(s)/(s - 1), 1 at s = 1.
pub(super) fn logarithm_per_excess(scale: f64) -> f64 {
    let excess = scale - 1.0;
    if excess == 0.0 {
        1.0
    } else if excess.abs() < 0.5 {
        excess.ln_1p() / excess
    } else {
        scale.ln() / excess
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Flow;

    #[test]
    fn the_point_on_the_axis_ends_advance_away() {
        for scale in [1.0, 1.0 + 1e-15, 1.0 - 1e-9, 0.6, 2.5, 1e-6] {
            let screw = Screw {
                axis: DVec3::new(0.0, 3.0, 4.0),
                through: DVec3::new(1.0, 2.0, 3.0),
                turn: 3.0,
                advance: 5.0,
                scale,
            };
            let generator = screw.generator().expect("a legal screw");
            let end = Flow::new(generator)
                .pose_at(1.0)
                .transform_point3(screw.through);
            let expected = screw.through + DVec3::new(0.0, 3.0, 4.0);
            assert!(
                (end - expected).length() < 2e-14,
                "scale {scale}: {end} instead of {expected}"
            );
        }
    }

    #[test]
    fn illegal_screws_are_refused_by_name() {
        let screw = Screw {
            axis: DVec3::Z,
            turn: 1.0,
            ..Screw::default()
        };
        let refused = |screw: Screw| screw.generator().expect_err("must be refused");
        assert_eq!(
            refused(Screw {
                axis: DVec3::ZERO,
                ..screw
            }),
            MotionError::ZeroAxis,
            "turn without axis"
        );
        assert_eq!(
            refused(Screw {
                advance: 1.0,
                ..Screw::default()
            }),
            MotionError::ZeroAxis,
            "advance without axis"
        );
        for scale in [0.0, -0.0, -2.0] {
            assert!(
                matches!(
                    refused(Screw { scale, ..screw }),
                    MotionError::ScaleNotPositive { .. }
                ),
                "scale {scale}"
            );
        }
        for scale in [f64::NAN, f64::INFINITY] {
            assert_eq!(
                refused(Screw { scale, ..screw }),
                MotionError::NonFinite { what: "scale" },
                "{scale}"
            );
        }
        let axis = DVec3::new(0.0, f64::NAN, 1.0);
        assert_eq!(
            refused(Screw { axis, ..screw }),
            MotionError::NonFinite { what: "axis" },
            "NaN in the axis"
        );
        assert_eq!(
            Screw::default().generator(),
            Ok(Generator::translation(DVec3::ZERO)),
            "standing still is legal"
        );
        let huge = Screw {
            axis: DVec3::Z,
            turn: 1e200,
            through: DVec3::X * 1e200,
            ..Screw::default()
        };
        assert_eq!(
            refused(huge),
            MotionError::Overflow,
            "finite input, infinite velocity"
        );
    }

    #[test]
    fn an_axis_of_any_length_is_a_direction() {
        let unit = Screw {
            axis: DVec3::Y,
            turn: 1.0,
            ..Screw::default()
        }
        .generator();
        for length in [1e-250, 1e-3, 1e6, 1e250] {
            let other = Screw {
                axis: DVec3::Y * length,
                turn: 1.0,
                ..Screw::default()
            }
            .generator();
            assert_eq!(other, unit, "length {length:e}");
        }
    }

    #[test]
    fn straight_motions_are_recognised() {
        let shear = |offset: DVec3| Generator {
            linear: DMat3::from_cols(DVec3::ZERO, DVec3::X * 2.0, DVec3::X * 3.0),
            offset,
        };
        let screw = |turn, scale| Generator::screw(DVec3::Z, DVec3::ONE, turn, 0.0, scale);
        for (straight, what) in [
            (Generator::translation(DVec3::ONE), "translation"),
            (screw(0.0, 3.0), "growth"),
            (shear(DVec3::X), "a shear that moves along itself"),
            (shear(DVec3::ZERO), "a shear"),
        ] {
            assert!(straight.moves_straight(), "{what}");
        }
        for (bent, what) in [
            (shear(DVec3::Y), "parabolas"),
            (shear(DVec3::new(0.0, 3.0, -2.0)), "straight, but twisted"),
            (screw(0.1, 1.0), "a turn"),
            (screw(0.1, 2.0), "a spiral"),
        ] {
            assert!(!bent.moves_straight(), "{what}");
        }
    }

    #[test]
    fn rows_are_read_back() {
        let rows = [
            [1.0, 2.0, 3.0, 4.0],
            [5.0, 6.0, 7.0, 8.0],
            [9.0, 10.0, 11.0, 12.0],
        ];
        let generator = Generator::from_rows(rows).expect("finite");
        assert_eq!(generator.rows(), rows, "row-major");
        assert_eq!(
            generator.velocity(DVec3::X),
            DVec3::new(5.0, 13.0, 21.0),
            "first column plus offset"
        );
        let bad = [[1.0, 2.0, 3.0, f64::INFINITY], rows[1], rows[2]];
        assert_eq!(
            Generator::from_rows(bad),
            Err(MotionError::NonFinite { what: "generator" }),
            "infinite offset"
        );
    }
}
