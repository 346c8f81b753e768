//! From `f64` boxes to the smallest `f32` boxes that contain them.

use glam::DVec3;

/// The smallest box with `f32` corners that contains the box `[min, max]`.
///
/// A bound beyond the range of `f32` becomes infinite, outward.
pub(super) fn outward([min, max]: [DVec3; 2]) -> [[f32; 3]; 2] {
    [min.to_array().map(round_down), max.to_array().map(round_up)]
}

/// The largest `f32` that is not above `x`.
fn round_down(x: f64) -> f32 {
    let nearest = narrow(x);
    if f64::from(nearest) > x {
        nearest.next_down()
    } else {
        nearest
    }
}

/// The smallest `f32` that is not below `x`.
fn round_up(x: f64) -> f32 {
    let nearest = narrow(x);
    if f64::from(nearest) < x {
        nearest.next_up()
    } else {
        nearest
    }
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "rounds to nearest; the callers correct the direction"
)]
fn narrow(x: f64) -> f32 {
    x as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Deterministic bit patterns: every exponent, both signs, denormals included.
    fn bit_patterns() -> impl Iterator<Item = f64> {
        let mut state = 0x9e37_79b9_7f4a_7c15_u64;
        (0..400_000).map(move |_| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            f64::from_bits(state)
        })
    }

    fn check(x: f64) {
        let (low, high) = (round_down(x), round_up(x));
        assert!(
            f64::from(low) <= x && x <= f64::from(high),
            "{x:e} is not in [{low:e}, {high:e}]"
        );
        assert!(
            f64::from(low.next_up()) > x,
            "{low:e} is not the largest below {x:e}"
        );
        assert!(
            f64::from(high.next_down()) < x,
            "{high:e} is not the smallest above {x:e}"
        );
    }

    #[test]
    fn random_bit_patterns_are_enclosed_as_tightly_as_possible() {
        for x in bit_patterns().filter(|x| x.is_finite()) {
            check(x);
            // The same mantissa in the range of `f32`, near its denormals and limits.
            let fraction = 1.0 + x.abs().to_bits() as f64 / u64::MAX as f64;
            let exponent = i32::try_from(x.to_bits() >> 52).expect("12 bits") % 300 - 150;
            check(fraction * 2f64.powi(exponent));
            check(-fraction * 2f64.powi(exponent));
        }
    }

    #[test]
    fn values_of_single_precision_stay_as_they_are() {
        for x in [
            0.0,
            -0.0,
            1.0,
            -2.5,
            f64::from(f32::MAX),
            f64::from(f32::MIN_POSITIVE),
        ] {
            assert_eq!(f64::from(round_down(x)), x, "rounded down");
            assert_eq!(f64::from(round_up(x)), x, "rounded up");
        }
    }

    #[test]
    fn values_out_of_range_become_infinite_outward_only() {
        assert_eq!(
            round_down(1e300),
            f32::MAX,
            "the largest finite value is below"
        );
        assert_eq!(round_up(1e300), f32::INFINITY, "nothing finite is above");
        assert_eq!(
            outward([DVec3::splat(-1e300), DVec3::ZERO]),
            [[f32::NEG_INFINITY; 3], [0.0; 3]],
            "as a box"
        );
    }
}
