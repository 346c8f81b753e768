//! The lines at which the entities of a DXF begin, and what else the parser does not report or
//! skips.

use super::super::error::{EXPORT_AGAIN, InputProblem, Place, quote};
use std::ops::RangeInclusive;

/// An entity of the drawing, as its group codes say.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct DxfEntity {
    /// Line of the file, counted from 1.
    pub(super) line: usize,
    /// Its type, such as `LINE`.
    pub(super) kind: String,
    pub(super) handle: Option<String>,
    pub(super) layer: String,
    /// Whether it belongs to a sheet of paper, not to the model.
    pub(super) on_paper: bool,
    pub(super) invisible: bool,
}

/// Entities, and parts of them, whose numbers are read.
const READ: &[&str] = &[
    "LINE",
    "ARC",
    "CIRCLE",
    "ELLIPSE",
    "SPLINE",
    "LWPOLYLINE",
    "POLYLINE",
    "VERTEX",
];

/// Group codes whose values are numbers with a fraction: coordinates, lengths, angles, weights,
/// directions.
const REAL: [RangeInclusive<i32>; 2] = [10..=59, 210..=239];

/// The entities of the section `ENTITIES`, in order.
///
/// # Errors
/// When a line that should hold a group code holds no number, or a coordinate of an entity that is
/// read is not finite.
pub(super) fn entities(bytes: &[u8]) -> Result<Vec<DxfEntity>, InputProblem> {
    let mut lines = bytes
        .split(|&byte| byte == b'\n')
        .map(|line| String::from_utf8_lossy(line))
        .zip(1usize..);
    let mut entries: Vec<DxfEntity> = Vec::new();
    let mut section = None;
    let mut names_section = false;
    while let Some((code, line)) = lines.next() {
        let Some((value, value_line)) = lines.next() else {
            break;
        };
        let (code, value) = (code.trim(), value.trim());
        let Ok(code) = code.parse::<i32>() else {
            return Err(InputProblem::Malformed {
                place: Place::Line(line),
                expected: "a group code".to_owned(),
                found: quote(code),
                remedy: EXPORT_AGAIN,
            });
        };
        let in_entities = section.as_deref() == Some("ENTITIES");
        match (code, value) {
            (0, "SECTION") => names_section = true,
            (0, "ENDSEC") => section = None,
            (0, "EOF") => break,
            (2, name) if std::mem::take(&mut names_section) => section = Some(name.to_owned()),
            (0, kind) if in_entities => {
                entries.push(DxfEntity {
                    line,
                    kind: kind.to_owned(),
                    ..DxfEntity::default()
                });
            }
            (code, value) if in_entities => {
                if let Some(entry) = entries.last_mut() {
                    if READ.contains(&entry.kind.as_str())
                        && REAL.iter().any(|codes| codes.contains(&code))
                        && !value.parse::<f64>().is_ok_and(f64::is_finite)
                    {
                        return Err(InputProblem::Malformed {
                            place: Place::Line(value_line),
                            expected: format!("a finite number in {}", entry.kind),
                            found: quote(value),
                            remedy: EXPORT_AGAIN,
                        });
                    }
                    match code {
                        5 => entry.handle = entry.handle.take().or_else(|| Some(value.to_owned())),
                        8 => entry.layer = value.to_owned(),
                        60 => entry.invisible = value == "1",
                        67 => entry.on_paper = value == "1",
                        _ => {}
                    }
                }
            }
            _ => {}
        }
    }
    Ok(entries)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entities_have_their_lines_and_properties() {
        let text = "0\r\nSECTION\r\n2\r\nENTITIES\r\n0\r\nLINE\r\n5\r\n2F\r\n8\r\nrim\r\n0\r\nHATCH\r\n67\r\n1\r\n0\r\nENDSEC\r\n0\r\nEOF\r\n";
        let found = entities(text.as_bytes()).expect("pairs");
        let line = DxfEntity {
            line: 5,
            kind: "LINE".to_owned(),
            handle: Some("2F".to_owned()),
            layer: "rim".to_owned(),
            ..DxfEntity::default()
        };
        let hatch = DxfEntity {
            line: 11,
            kind: "HATCH".to_owned(),
            on_paper: true,
            ..DxfEntity::default()
        };
        assert_eq!(found, [line, hatch]);
    }

    #[test]
    fn a_code_that_is_no_number_is_named_with_its_line() {
        let error = entities(b"0\nSECTION\n2\nENTITIES\nzero\nLINE\n").expect_err("no code");
        assert!(
            matches!(
                error,
                InputProblem::Malformed {
                    place: Place::Line(5),
                    ..
                }
            ),
            "{error}"
        );
    }
}
