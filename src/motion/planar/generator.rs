//! The velocity field v(p) = M p + tau of a steady affine motion of the plane.

use crate::motion::{self, MotionError};
use glam::{DAffine2, DMat2, DMat3, DVec2, Vec3Swizzles};

/// The generator G = [M tau; 0 0] of a steady affine motion of the plane: its velocity field
/// v(p) = M p + tau.
///
/// # Example
/// ```
/// use glam::DVec2;
/// use std::f64::consts::PI;
/// use steadysweep::motion::planar::Generator;
///
/// // Half a turn about the point (1, 0).
/// let turn = Generator::spiral(DVec2::X, PI, 1.0);
/// assert_eq!(turn.velocity(DVec2::X), DVec2::ZERO);
/// assert_eq!(turn.velocity(DVec2::new(2.0, 0.0)), DVec2::new(0.0, PI));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Generator {
    /// M, for the whole span.
    pub linear: DMat2,
    /// tau: the velocity of the origin.
    pub offset: DVec2,
}

/// A logarithmic spiral as a user describes it. By default it stands still.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spiral {
    /// The fixed point.
    pub through: DVec2,
    /// Turn in radians, from x towards y (counter-clockwise with y up), of any size.
    pub turn: f64,
    /// Uniform scale factor about `through` at the end, above 0.
    pub scale: f64,
}

impl Default for Spiral {
    fn default() -> Spiral {
        Spiral {
            through: DVec2::ZERO,
            turn: 0.0,
            scale: 1.0,
        }
    }
}

impl Spiral {
    /// The generator of the whole spiral.
    ///
    /// # Errors
    /// [`MotionError::NonFinite`], [`MotionError::ScaleNotPositive`], and [`MotionError::Overflow`]
    /// when the velocity leaves the range of f64.
    pub fn generator(&self) -> Result<Generator, MotionError> {
        let finite = [
            ("centre", self.through.is_finite()),
            ("turn", self.turn.is_finite()),
            ("scale", self.scale.is_finite()),
        ];
        if let Some(&(what, _)) = finite.iter().find(|(_, finite)| !finite) {
            return Err(MotionError::NonFinite { what });
        }
        if self.scale <= 0.0 {
            return Err(MotionError::ScaleNotPositive { scale: self.scale });
        }
        let generator = Generator::spiral(self.through, self.turn, self.scale);
        if generator.is_finite() {
            Ok(generator)
        } else {
            Err(MotionError::Overflow)
        }
    }
}

impl Generator {
    /// v(p) = M p + tau.
    pub fn velocity(&self, point: DVec2) -> DVec2 {
        self.linear * point + self.offset
    }
    /// Second derivative of the path through `point`: M v(p).
    pub fn acceleration(&self, point: DVec2) -> DVec2 {
        self.linear * self.velocity(point)
    }
    /// tr M: the logarithm of the factor by which areas change.
    pub fn volume_rate(&self) -> f64 {
        self.linear.x_axis.x + self.linear.y_axis.y
    }
    /// The generator in the frame whose pose is `pose`: pose^-1 G pose.
    pub fn in_frame(&self, pose: &DAffine2) -> Generator {
        let inverse = pose.matrix2.inverse();
        Generator {
            linear: inverse * self.linear * pose.matrix2,
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
    /// growth about a point, or a shear along itself. Then nothing is sampled, and no fold is
    /// dropped.
    pub(crate) fn moves_straight(&self) -> bool {
        self.in_space().moves_straight()
    }
    /// From the rows [M | tau].
    ///
    /// # Errors
    /// [`MotionError::NonFinite`].
    pub fn from_rows(rows: [[f64; 3]; 2]) -> Result<Generator, MotionError> {
        let column = |j: usize| DVec2::new(rows[0][j], rows[1][j]);
        let generator = Generator {
            linear: DMat2::from_cols(column(0), column(1)),
            offset: column(2),
        };
        if generator.is_finite() {
            Ok(generator)
        } else {
            Err(MotionError::NonFinite { what: "generator" })
        }
    }
    /// The rows [M | tau].
    pub fn rows(&self) -> [[f64; 3]; 2] {
        let row = |i: usize| {
            let linear = self.linear.row(i);
            [linear.x, linear.y, self.offset[i]]
        };
        [row(0), row(1)]
    }
    /// The translation by `displacement` in one span.
    pub fn translation(displacement: DVec2) -> Generator {
        Generator {
            linear: DMat2::ZERO,
            offset: displacement,
        }
    }
    /// The turn by `turn` radians (counter-clockwise with y up, any size) about `through`, with
    /// scaling by `scale` > 0 about it.
    ///
    /// M = turn J + ln(scale) I with J the quarter turn, tau = -M through. For values from a user
    /// see [`Spiral`], which checks them.
    pub fn spiral(through: DVec2, turn: f64, scale: f64) -> Generator {
        let rate = scale.ln();
        let linear = DMat2::from_cols(DVec2::new(rate, turn), DVec2::new(-turn, rate));
        Generator {
            linear,
            offset: -(linear * through),
        }
    }

    /// The same motion, in the plane z = 0 of space; along z everything scales by exp(tr M / 2).
    ///
    /// This increases no bound on a norm in the plane: exp(tM) has determinant exp(t tr M), so that
    /// its larger singular value is at least exp(t tr M / 2).
    pub fn in_space(&self) -> motion::Generator {
        let [x, y] = [self.linear.x_axis, self.linear.y_axis];
        motion::Generator {
            linear: DMat3::from_cols(
                x.extend(0.0),
                y.extend(0.0),
                glam::DVec3::new(0.0, 0.0, 0.5 * (x.x + y.y)),
            ),
            offset: self.offset.extend(0.0),
        }
    }

    /// The generator of the plane z = 0 that a generator of space contains.
    pub(super) fn in_plane(generator: &motion::Generator) -> Generator {
        let linear = &generator.linear;
        Generator {
            linear: DMat2::from_cols(linear.x_axis.xy(), linear.y_axis.xy()),
            offset: generator.offset.xy(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::planar::Flow;

    #[test]
    fn the_centre_of_a_spiral_stays_and_others_turn_and_scale() {
        for scale in [1.0, 1.0 + 1e-15, 0.6, 2.5, 1e-6] {
            let spiral = Spiral {
                through: DVec2::new(1.0, 2.0),
                turn: 3.0,
                scale,
            };
            let end = Flow::new(spiral.generator().expect("a legal spiral")).pose_at(1.0);
            let centre = end.transform_point2(spiral.through);
            assert!(
                (centre - spiral.through).length() < 5e-15,
                "scale {scale}: {centre}"
            );
            let other = end.transform_point2(spiral.through + DVec2::X);
            let expected = spiral.through + DVec2::from_angle(3.0) * scale;
            assert!(
                (other - expected).length() < 1e-14,
                "scale {scale}: {other}"
            );
        }
    }

    #[test]
    fn illegal_spirals_are_refused_by_name() {
        let refused = |spiral: Spiral| spiral.generator().expect_err("must be refused");
        let spiral = Spiral {
            turn: 1.0,
            ..Spiral::default()
        };
        for scale in [0.0, -0.0, -2.0] {
            assert!(
                matches!(
                    refused(Spiral { scale, ..spiral }),
                    MotionError::ScaleNotPositive { .. }
                ),
                "scale {scale}"
            );
        }
        for scale in [f64::NAN, f64::INFINITY] {
            assert_eq!(
                refused(Spiral { scale, ..spiral }),
                MotionError::NonFinite { what: "scale" },
                "{scale}"
            );
        }
        let through = DVec2::new(f64::NAN, 0.0);
        assert_eq!(
            refused(Spiral { through, ..spiral }),
            MotionError::NonFinite { what: "centre" },
            "NaN in the centre"
        );
        let huge = Spiral {
            through: DVec2::X * 1e200,
            turn: 1e200,
            scale: 1.0,
        };
        assert_eq!(
            refused(huge),
            MotionError::Overflow,
            "finite input, infinite velocity"
        );
        assert_eq!(
            Spiral::default().generator(),
            Ok(Generator::translation(-DVec2::ZERO)),
            "standing still is legal"
        );
    }

    #[test]
    fn rows_are_read_back() {
        let rows = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]];
        let generator = Generator::from_rows(rows).expect("finite");
        assert_eq!(generator.rows(), rows, "row-major");
        assert_eq!(
            generator.velocity(DVec2::X),
            DVec2::new(4.0, 10.0),
            "first column plus offset"
        );
        assert_eq!(
            generator.acceleration(DVec2::X),
            DVec2::new(24.0, 66.0),
            "the linear part once more"
        );
        assert_eq!(
            Generator::from_rows([[1.0, 2.0, f64::INFINITY], rows[1]]),
            Err(MotionError::NonFinite { what: "generator" }),
            "infinite offset"
        );
    }

    #[test]
    fn a_generator_in_a_frame_moves_that_frames_points_alike() {
        let generator = Generator::from_rows([[0.3, -2.0, 1.0], [0.7, 0.1, -0.5]]).expect("finite");
        let pose = DAffine2::from_cols_array(&[1.0, 0.2, -0.7, 2.0, 3.0, -1.0]);
        let point = DVec2::new(0.4, 0.9);
        let inside = pose
            .matrix2
            .mul_vec2(generator.in_frame(&pose).velocity(point));
        let outside = generator.velocity(pose.transform_point2(point));
        assert!((inside - outside).length() < 1e-14, "{inside} {outside}");
    }

    #[test]
    fn straight_paths_are_recognised() {
        let shear = |offset: DVec2| Generator {
            linear: DMat2::from_cols(DVec2::ZERO, DVec2::new(2.0, 0.0)),
            offset,
        };
        assert!(
            Generator::translation(DVec2::ONE).moves_straight(),
            "translation"
        );
        assert!(
            Generator::spiral(DVec2::ONE, 0.0, 3.0).moves_straight(),
            "growth"
        );
        assert!(shear(DVec2::X).moves_straight(), "moved along itself");
        assert!(
            !shear(DVec2::Y).moves_straight(),
            "across: paths are parabolas"
        );
        assert!(
            !Generator::spiral(DVec2::ONE, 0.1, 1.0).moves_straight(),
            "turn"
        );
    }
}
