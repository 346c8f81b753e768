//! Rotations of space as files write them: unit quaternions, and Euler angles by a name that leaves
//! nothing to guess.

use crate::numeric::tolerance::UNIT_QUATERNION;
use glam::{DQuat, DVec3};
use serde_json::Value;

/// How three angles are read: the axes in order, whose axes they are, and the unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct EulerAngles {
    axes: [DVec3; 3],
    /// Whether the axes are those of the body, which each angle turns along; otherwise those of the
    /// world.
    of_body: bool,
    in_degrees: bool,
}

impl EulerAngles {
    /// From a name such as `euler-zxz-deg` or `fixed-xyz-rad`.
    ///
    /// # Errors
    /// What names there are.
    pub(super) fn named(name: &str) -> Result<EulerAngles, String> {
        let parsed = || {
            let mut parts = name.split('-');
            let of_body = match parts.next()? {
                "euler" => true,
                "fixed" => false,
                _ => return None,
            };
            let order = parts.next()?.as_bytes();
            let axis = |letter: &u8| match letter {
                b'x' => Some(DVec3::X),
                b'y' => Some(DVec3::Y),
                b'z' => Some(DVec3::Z),
                _ => None,
            };
            let axes: Vec<DVec3> = order.iter().map(axis).collect::<Option<_>>()?;
            let axes = <[DVec3; 3]>::try_from(axes).ok()?;
            let in_degrees = match (parts.next()?, parts.next()) {
                ("deg", None) => true,
                ("rad", None) => false,
                _ => return None,
            };
            // About the same axis twice in a row would be one turn, and two angles.
            let differ = axes[0] != axes[1] && axes[1] != axes[2];
            differ.then_some(EulerAngles {
                axes,
                of_body,
                in_degrees,
            })
        };
        parsed().ok_or_else(|| {
            format!(
                "expected euler-ORDER-deg (about the axes of the body, which turn with it) or fixed-ORDER-deg (about \
                 the axes of the world), or -rad, with ORDER three of x, y and z such as zxz, found \"{name}\""
            )
        })
    }

    /// The rotation of three angles, in the order of the axes.
    pub(super) fn rotation(&self, angles: [f64; 3]) -> DQuat {
        let turn = |k: usize| {
            let angle = if self.in_degrees {
                angles[k].to_radians()
            } else {
                angles[k]
            };
            DQuat::from_axis_angle(self.axes[k], angle)
        };
        // An axis of the body has been turned by the angles before, one of the world has not.
        if self.of_body {
            turn(0) * turn(1) * turn(2)
        } else {
            turn(2) * turn(1) * turn(0)
        }
    }
}

/// The field `rotation` of a keyframe: `[x, y, z, w]`, or `{"euler-zxz-deg": [a, b, c]}`.
///
/// # Errors
/// What is wrong with it.
pub(super) fn rotation_of(written: &Value) -> Result<DQuat, String> {
    let numbers = |value: &Value| {
        let list = value.as_array()?;
        list.iter().map(Value::as_f64).collect::<Option<Vec<f64>>>()
    };
    let found = || {
        Err(format!(
            "\"rotation\": expected a quaternion of 4 numbers [x, y, z, w], or Euler angles such as \
             {{\"euler-zxz-deg\": [a, b, c]}}, found {written}"
        ))
    };
    match written {
        Value::Array(_) => match numbers(written) {
            Some(numbers) => unit_quaternion(&numbers),
            None => found(),
        },
        Value::Object(fields) if fields.len() == 1 => {
            let Some((name, value)) = fields.iter().next() else {
                return found();
            };
            let euler = EulerAngles::named(name).map_err(|text| format!("\"rotation\": {text}"))?;
            let angles = numbers(value).and_then(|angles| <[f64; 3]>::try_from(angles).ok());
            angles.map(|angles| euler.rotation(angles)).ok_or_else(|| {
                format!("\"rotation\": expected three angles for {name}, found {value}")
            })
        }
        _ => found(),
    }
}

/// A quaternion x, y, z, w of length 1.
///
/// # Errors
/// What is wrong with it.
pub(super) fn unit_quaternion(numbers: &[f64]) -> Result<DQuat, String> {
    let [x, y, z, w] = *numbers else {
        let found = numbers.len();
        return Err(format!(
            "\"rotation\": expected a quaternion of 4 numbers [x, y, z, w], found {found} numbers"
        ));
    };
    let quaternion = DQuat::from_xyzw(x, y, z, w);
    let length = quaternion.length();
    // Not `>`, so that an infinite or undefined length is refused too.
    if (length - 1.0).abs() <= UNIT_QUATERNION {
        Ok(quaternion.normalize())
    } else {
        Err(format!(
            "\"rotation\": expected a unit quaternion, length 1 within {UNIT_QUATERNION:e}, found length {length}; divide it by its \
             length"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn euler_angles_turn_about_the_axes_that_their_name_says() {
        let image = |name: &str, angles: [f64; 3], point: DVec3| {
            EulerAngles::named(name).expect("a name").rotation(angles) * point
        };
        let near = |a: DVec3, b: DVec3| assert!(a.distance(b) < 1e-15, "{a} instead of {b}");
        // A quarter turn about z carries the body's x axis to y; the second turn is about it.
        near(
            image("euler-zxz-deg", [90.0, 90.0, 0.0], DVec3::X),
            DVec3::Y,
        );
        near(
            image("euler-zxz-deg", [90.0, 90.0, 0.0], DVec3::Y),
            DVec3::Z,
        );
        // About the world's x axis instead.
        near(
            image("fixed-zxz-deg", [90.0, 90.0, 0.0], DVec3::X),
            DVec3::Z,
        );
        near(
            image("fixed-zxz-deg", [90.0, 90.0, 0.0], DVec3::Y),
            -DVec3::X,
        );
        // Fixed axes are those of the body in reverse.
        let point = DVec3::new(0.3, -0.5, 0.7);
        near(
            image("euler-xyz-rad", [0.3, -1.2, 2.1], point),
            image("fixed-zyx-rad", [2.1, -1.2, 0.3], point),
        );
    }

    #[test]
    fn other_names_are_refused() {
        for name in [
            "zxz",
            "euler-zxz",
            "euler-zzx-deg",
            "euler-xyy-deg",
            "euler-zx-deg",
            "euler-ZXZ-deg",
            "euler-zxz-grad",
            "euler-zxz-deg-",
            "rpy-xyz-deg",
            "",
            "euler-zxzx-deg",
            "euler-xyw-deg",
        ] {
            let text = EulerAngles::named(name).expect_err("refused");
            assert!(
                text.starts_with("expected euler-ORDER-deg"),
                "{name}: {text}"
            );
        }
    }
}
