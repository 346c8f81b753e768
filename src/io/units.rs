//! Units of length that drawings declare.

use std::fmt;
use std::str::FromStr;

/// A unit of length.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Unit {
    /// 1e-6 m.
    Micrometre,
    /// 1e-3 m.
    Millimetre,
    /// 1e-2 m.
    Centimetre,
    /// 1 m.
    Metre,
    /// 25.4 mm.
    Inch,
    /// 12 in.
    Foot,
    /// 1/72 in.
    Point,
    /// 1/6 in.
    Pica,
}

impl Unit {
    /// All units and their usual abbreviations, from small to large.
    pub const ALL: [(Unit, &'static str); 8] = [
        (Unit::Micrometre, "um"),
        (Unit::Point, "pt"),
        (Unit::Millimetre, "mm"),
        (Unit::Pica, "pc"),
        (Unit::Centimetre, "cm"),
        (Unit::Inch, "in"),
        (Unit::Foot, "ft"),
        (Unit::Metre, "m"),
    ];

    /// Its length in millimetres.
    pub fn millimetres(self) -> f64 {
        match self {
            Unit::Micrometre => 1e-3,
            Unit::Millimetre => 1.0,
            Unit::Centimetre => 10.0,
            Unit::Metre => 1e3,
            Unit::Inch => 25.4,
            Unit::Foot => 304.8,
            Unit::Point => 25.4 / 72.0,
            Unit::Pica => 25.4 / 6.0,
        }
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = Unit::ALL
            .iter()
            .find(|(unit, _)| unit == self)
            .map(|(_, name)| *name);
        f.write_str(name.expect("all units are listed"))
    }
}

impl FromStr for Unit {
    type Err = String;

    fn from_str(text: &str) -> Result<Unit, String> {
        let found = Unit::ALL.iter().find(|(_, name)| *name == text.trim());
        found.map(|(unit, _)| *unit).ok_or_else(|| {
            let known: Vec<&str> = Unit::ALL.iter().map(|(_, name)| *name).collect();
            format!("expected one of {}", known.join(" "))
        })
    }
}

/// What a file says about the unit of its lengths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeclaredUnit {
    /// The unit that the file names.
    pub unit: Unit,
    /// Number of these units in one length of the file: 1, except for the viewBox of an SVG.
    pub factor: f64,
}

impl DeclaredUnit {
    /// Factor from lengths of the file to lengths in `unit`.
    pub fn factor_to(&self, unit: Unit) -> f64 {
        if unit == self.unit {
            self.factor
        } else {
            self.factor * self.unit.millimetres() / unit.millimetres()
        }
    }
}

impl fmt::Display for DeclaredUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.factor == 1.0 {
            write!(f, "{}", self.unit)
        } else {
            write!(f, "{} {}", crate::numeric::Readable(self.factor), self.unit)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_back_as_their_units() {
        for (unit, name) in Unit::ALL {
            assert_eq!((name.parse(), unit.to_string().as_str()), (Ok(unit), name));
        }
        assert!(
            "furlong"
                .parse::<Unit>()
                .is_err_and(|error| error.contains("mm")),
            "the known ones are named"
        );
    }

    #[test]
    fn a_viewbox_of_tenths_of_a_millimetre_is_scaled() {
        let tenths = DeclaredUnit {
            unit: Unit::Millimetre,
            factor: 0.1,
        };
        assert_eq!(tenths.factor_to(Unit::Millimetre), 0.1);
        assert!((tenths.factor_to(Unit::Inch) - 0.1 / 25.4).abs() < 1e-18);
        assert_eq!(
            DeclaredUnit {
                unit: Unit::Inch,
                factor: 1.0
            }
            .factor_to(Unit::Millimetre),
            25.4
        );
    }
}
