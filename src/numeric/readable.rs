//! Numbers as people read them, in reports and messages.

use std::fmt;

/// A number for reading: seven significant digits, without trailing zeros; all digits are in the
/// JSON form of a report.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Readable(pub(crate) f64);

impl fmt::Display for Readable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Readable(value) = *self;
        // Rounded to seven digits through the decimal form, then printed in the shortest form that
        // reads back.
        let rounded: f64 = format!("{value:.6e}").parse().unwrap_or(value);
        if rounded == 0.0 {
            write!(f, "0")
        } else if (1e-4..1e9).contains(&rounded.abs()) {
            write!(f, "{rounded}")
        } else {
            write!(f, "{rounded:e}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readable_numbers_have_seven_digits_and_no_noise() {
        let cases = [
            (0.0, "0"),
            (-0.0, "0"),
            (0.1 + 0.2, "0.3"),
            (1.0 / 3.0, "0.3333333"),
            (-12345.678949, "-12345.68"),
            (2e6, "2000000"),
            (1e-7, "1e-7"),
            (6.0e23, "6e23"),
        ];
        for (value, expected) in cases {
            assert_eq!(Readable(value).to_string(), expected, "{value:e}");
        }
    }
}
