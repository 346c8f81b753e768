//! The velocity field v(p) = M p + tau of a steady affine motion.

use glam::{DAffine3, DMat3, DVec3};

/// Generator G = [M tau; 0 0] of a steady affine motion: its velocity field v(p) = M p + tau.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Generator {
    /// M, per span.
    pub linear: DMat3,
    /// tau: the velocity of the origin.
    pub offset: DVec3,
}

impl Generator {
    /// v(p) = M p + tau.
    pub fn velocity(&self, point: DVec3) -> DVec3 {
        self.linear * point + self.offset
    }
    /// Second derivative of the path through `point`: M v(p).
    pub fn acceleration(&self, point: DVec3) -> DVec3 {
        self.linear * self.velocity(point)
    }
    /// The generator in the frame whose pose is `pose`: pose^-1 G pose.
    pub fn in_frame(&self, pose: &DAffine3) -> Generator {
        let inverse = pose.matrix3.inverse();
        Generator {
            linear: inverse * self.linear * pose.matrix3,
            offset: inverse * self.velocity(pose.translation),
        }
    }
    /// Translation by `displacement` in one span.
    pub fn translation(displacement: DVec3) -> Generator {
        Generator {
            linear: DMat3::ZERO,
            offset: displacement,
        }
    }
    /// Turn by `turn` radians (right-hand rule, any size) about the unit vector `axis` through `through`,
    /// scaling by `scale` > 0 about it, while `through` ends `advance` further along the axis.
    pub fn screw(axis: DVec3, through: DVec3, turn: f64, advance: f64, scale: f64) -> Generator {
        let cross = DMat3::from_cols(
            DVec3::new(0.0, axis.z, -axis.y),
            DVec3::new(-axis.z, 0.0, axis.x),
            DVec3::new(axis.y, -axis.x, 0.0),
        );
        let ln = scale.ln();
        let linear = cross * turn + DMat3::from_diagonal(DVec3::splat(ln));
        let factor = if scale == 1.0 {
            1.0
        } else {
            ln / (scale - 1.0)
        };
        Generator {
            linear,
            offset: axis * (advance * factor) - linear * through,
        }
    }
}
