//! Exact signs, by `robust` and by integers of any length: on which side does a point lie?
//!
//! The answers are enums, and the sign convention is fixed here, once. Those by `robust` are exact
//! unless products of three coordinate differences leave the range of `f64`.

use dashu_int::IBig;
use glam::{DVec2, DVec3};
use robust::{Coord, Coord3D};
use std::cmp::Ordering;

/// Position of a point against an oriented plane or line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    /// The side to which the normal points; seen from there, the corners run counter-clockwise. For
    /// a line: its left.
    Above,
    /// On the plane or line.
    On,
    /// The other side.
    Below,
}

/// Side of the plane through `a`, `b`, `c` on which `point` lies.
pub(crate) fn side_of_plane(a: DVec3, b: DVec3, c: DVec3, point: DVec3) -> Side {
    let coordinates = |p: DVec3| Coord3D {
        x: p.x,
        y: p.y,
        z: p.z,
    };
    // `robust` is positive below the plane.
    from_sign(-robust::orient3d(
        coordinates(a),
        coordinates(b),
        coordinates(c),
        coordinates(point),
    ))
}

/// Side of the line from `a` to `b` on which `point` lies.
pub(crate) fn side_of_line(a: DVec2, b: DVec2, point: DVec2) -> Side {
    let coordinates = |p: DVec2| Coord { x: p.x, y: p.y };
    from_sign(robust::orient2d(
        coordinates(a),
        coordinates(b),
        coordinates(point),
    ))
}

fn from_sign(sign: f64) -> Side {
    if sign > 0.0 {
        Side::Above
    } else if sign < 0.0 {
        Side::Below
    } else {
        Side::On
    }
}

/// Sign of an exact number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Sign {
    Negative,
    Zero,
    Positive,
}

impl Sign {
    pub(crate) fn of_float(x: f64) -> Sign {
        if x > 0.0 {
            Sign::Positive
        } else if x < 0.0 {
            Sign::Negative
        } else {
            Sign::Zero
        }
    }

    pub(crate) fn of_integer(x: i128) -> Sign {
        match x.cmp(&0) {
            Ordering::Less => Sign::Negative,
            Ordering::Equal => Sign::Zero,
            Ordering::Greater => Sign::Positive,
        }
    }

    pub(crate) fn of_long(x: &IBig) -> Sign {
        if x.is_zero() {
            Sign::Zero
        } else if x.sign() == dashu_int::Sign::Positive {
            Sign::Positive
        } else {
            Sign::Negative
        }
    }

    pub(crate) fn flipped(self) -> Sign {
        match self {
            Sign::Negative => Sign::Positive,
            Sign::Zero => Sign::Zero,
            Sign::Positive => Sign::Negative,
        }
    }

    /// Flipped unless the condition holds.
    pub(crate) fn flipped_unless(self, condition: bool) -> Sign {
        if condition { self } else { self.flipped() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn above_is_where_the_corners_run_counter_clockwise() {
        let [a, b, c] = [DVec3::ZERO, DVec3::X, DVec3::Y];
        assert_eq!(
            side_of_plane(a, b, c, DVec3::Z),
            Side::Above,
            "the normal of X, Y is Z"
        );
        assert_eq!(
            side_of_plane(a, b, c, -DVec3::Z),
            Side::Below,
            "against the normal"
        );
        assert_eq!(
            side_of_plane(a, b, c, DVec3::new(5.0, -3.0, 0.0)),
            Side::On,
            "in the plane z = 0"
        );
        assert_eq!(
            side_of_line(DVec2::ZERO, DVec2::X, DVec2::Y),
            Side::Above,
            "left of the x axis"
        );
        assert_eq!(
            side_of_line(DVec2::ZERO, DVec2::X, -DVec2::Y),
            Side::Below,
            "right of the x axis"
        );
    }

    #[test]
    fn signs_are_exact_where_the_plain_determinant_is_lost_in_rounding() {
        // The line y = x through points that are a unit in the last place apart; the determinant in
        // f64 is 0.
        let [a, b] = [DVec2::splat(0.5), DVec2::splat(12.0)];
        let above = DVec2::new(24.0, 24.0_f64.next_up());
        assert_eq!(
            side_of_line(a, b, above),
            Side::Above,
            "one unit in the last place above the line"
        );
        assert_eq!(
            side_of_line(a, b, DVec2::splat(24.0)),
            Side::On,
            "on the line"
        );
        let lifted = DVec3::new(24.0, 24.0_f64.next_up(), 7.0);
        let plane = [
            DVec3::splat(0.5),
            DVec3::new(12.0, 12.0, 0.5),
            DVec3::new(12.0, 12.0, 3.0),
        ];
        assert_eq!(
            side_of_plane(plane[0], plane[1], plane[2], lifted),
            Side::Below,
            "normal (1, -1, 0)"
        );
    }
}
