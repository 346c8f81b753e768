//! A swept region as DXF: one closed polyline per loop.

use super::super::units::Unit;
use super::RegionPicture;
use dxf::entities::{Entity, EntityType, LwPolyline};
use dxf::enums::{AcadVersion, Units};
use dxf::{Drawing, LwPolylineVertex};
use glam::DVec2;
use std::io::{self, Write};

/// Variables of the header that differ in every run: times, and names drawn at random. A file need
/// not have them.
const CHANGING: &[&[u8]] = &[
    b"$TDCREATE",
    b"$TDUCREATE",
    b"$TDUPDATE",
    b"$TDUUPDATE",
    b"$FINGERPRINTGUID",
    b"$VERSIONGUID",
];

/// Name of the layer of the region.
const LAYER: &str = "region";

pub(super) fn write(out: &mut impl Write, picture: &RegionPicture) -> io::Result<()> {
    let mut drawing = Drawing::new();
    // The first version in which a polyline is one entity.
    drawing.header.version = AcadVersion::R2000;
    drawing.header.default_drawing_units = units(picture.unit);
    for outline in &picture.region {
        let vertex = |p: &DVec2| LwPolylineVertex {
            x: p.x,
            y: p.y,
            ..LwPolylineVertex::default()
        };
        let mut polyline = LwPolyline {
            vertices: outline.iter().map(vertex).collect(),
            ..LwPolyline::default()
        };
        polyline.set_is_closed(true);
        let mut entity = Entity::new(EntityType::LwPolyline(polyline));
        entity.common.layer = LAYER.to_owned();
        drawing.add_entity(entity);
    }
    let mut bytes = Vec::new();
    drawing.save(&mut bytes).map_err(|error| match error {
        dxf::DxfError::IoError(error) => error,
        other => io::Error::other(other.to_string()),
    })?;
    write_unchanging(out, &bytes)
}

/// Writes the pairs of group codes and values, without the variables that change from run to run.
fn write_unchanging(out: &mut impl Write, bytes: &[u8]) -> io::Result<()> {
    let mut lines = bytes.split_inclusive(|&byte| byte == b'\n');
    let mut left_out = false;
    while let (Some(code), Some(value)) = (lines.next(), lines.next()) {
        match code.trim_ascii() {
            b"9" => left_out = CHANGING.contains(&value.trim_ascii()),
            b"0" => left_out = false,
            _ => {}
        }
        if !left_out {
            out.write_all(code)?;
            out.write_all(value)?;
        }
    }
    Ok(())
}

fn units(unit: Option<Unit>) -> Units {
    match unit {
        Some(Unit::Micrometre) => Units::Microns,
        Some(Unit::Millimetre) => Units::Millimeters,
        Some(Unit::Centimetre) => Units::Centimeters,
        Some(Unit::Metre) => Units::Meters,
        Some(Unit::Inch) => Units::Inches,
        Some(Unit::Foot) => Units::Feet,
        Some(Unit::Point | Unit::Pica) | None => Units::Unitless,
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::drawing::{DrawingFormat, DrawingSettings};
    use super::super::super::drawing_file::parse_drawing;
    use super::super::RegionFormat;
    use super::super::tests::picture;
    use super::*;

    #[test]
    fn the_same_region_has_the_same_bytes_at_any_time() {
        let written = || {
            let mut bytes = Vec::new();
            write(&mut bytes, &picture()).expect("memory");
            bytes
        };
        let first = written();
        // The times in a header have fractions of a second, and the names are new every time.
        std::thread::sleep(std::time::Duration::from_millis(20));
        assert_eq!(first, written(), "written twice");
        let text = String::from_utf8(first).expect("text");
        assert!(
            text.contains("$INSUNITS") && !text.contains("$TDCREATE"),
            "only what changes is left out"
        );
        assert!(text.trim_end().ends_with("EOF"), "the file is whole");
    }

    #[test]
    fn the_region_reads_back_with_its_unit() {
        for unit in [None, Some(Unit::Inch)] {
            let picture = RegionPicture { unit, ..picture() };
            let mut bytes = Vec::new();
            write(&mut bytes, &picture).expect("memory");
            let read = parse_drawing(DrawingFormat::Dxf, &bytes, &DrawingSettings::default())
                .expect("a drawing");
            let expected: Vec<DVec2> = picture.region.iter().flatten().copied().collect();
            let found = read.polygon.positions();
            assert_eq!(found.len(), expected.len(), "every corner");
            let largest = found
                .iter()
                .zip(&expected)
                .map(|(p, q)| p.distance(*q))
                .fold(0.0, f64::max);
            assert!(largest <= RegionFormat::Dxf.rounding(), "{largest}");
            assert_eq!((read.polygon.holes(), read.unit), (1, unit));
        }
    }
}
