//! DXF: the curves of its entities, in the units of the file, seen along the z axis.

mod entity;
mod scan;

use super::drawing::{Figure, LeftOut, Sketch};
use super::drawing_error::{FigurePlace, refuse_unsupported};
use super::error::{EXPORT_AGAIN, InputProblem, Place};
use super::units::{DeclaredUnit, Unit};
use dxf::entities::{Entity, EntityType};
use dxf::enums::Units;
use scan::DxfEntity;
use std::collections::{BTreeMap, HashMap, HashSet};

/// Entities that belong to the one before them.
const PARTS: &[&str] = &["VERTEX", "SEQEND", "ATTRIB"];

/// Entities that are by their nature no outline.
const ANNOTATION: &[&str] = &[
    "TEXT",
    "MTEXT",
    "RTEXT",
    "ARCALIGNEDTEXT",
    "ATTDEF",
    "DIMENSION",
    "ARC_DIMENSION",
    "LARGE_RADIAL_DIMENSION",
    "LEADER",
    "MULTILEADER",
    "MLEADER",
    "TOLERANCE",
    "POINT",
    "VIEWPORT",
];

/// The bytes with which a binary DXF begins.
const BINARY: &[u8] = b"AutoCAD Binary DXF";

/// Reads the figures of a DXF.
pub(super) fn read(bytes: &[u8]) -> Result<Sketch, InputProblem> {
    let malformed = |place, expected: &str, found: String, remedy| InputProblem::Malformed {
        place,
        expected: expected.to_owned(),
        found,
        remedy,
    };
    if bytes.starts_with(BINARY) {
        return Err(malformed(
            Place::File,
            "a DXF as text",
            "a binary one".to_owned(),
            "save it as text (ASCII) DXF",
        ));
    }
    let entries = scan::entities(bytes)?;
    let drawing = dxf::Drawing::load(&mut &*bytes)
        .map_err(|error| malformed(Place::File, "a DXF", error.to_string(), EXPORT_AGAIN))?;
    let hidden_layers: HashSet<String> = drawing
        .layers()
        .filter(|layer| !layer.is_layer_on)
        .map(|layer| layer.name.clone())
        .collect();
    let mut parsed: HashMap<&'static str, Vec<&Entity>> = HashMap::new();
    for entity in drawing.entities() {
        if let Some(kind) = kind_of(&entity.specific) {
            parsed.entry(kind).or_default().push(entity);
        }
    }
    let mut seen: HashMap<&str, usize> = HashMap::new();
    let mut figures = Vec::new();
    let mut unsupported: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    let mut left_out = LeftOut::default();
    for entry in &entries {
        let number = seen.entry(entry.kind.as_str()).or_default();
        let entity = parsed.get(entry.kind.as_str()).map(|all| all.get(*number));
        *number += 1;
        if PARTS.contains(&entry.kind.as_str()) {
        } else if entry.on_paper {
            left_out.add("entity on a sheet of paper", "entities on sheets of paper");
        } else if entry.invisible || hidden_layers.contains(&entry.layer) {
            left_out.add(
                "entity that is invisible or on a layer that is off",
                "entities that are invisible or on layers that are off",
            );
        } else if ANNOTATION.contains(&entry.kind.as_str()) {
            left_out.add(&entry.kind, &entry.kind);
        } else if let Some(entity) = entity {
            // The parser stops silently at an entity that it does not understand.
            let entity = entity.ok_or_else(|| {
                malformed(
                    Place::Line(entry.line),
                    &format!("a {}", entry.kind),
                    "something else".to_owned(),
                    EXPORT_AGAIN,
                )
            })?;
            match entity::paths(&entity.specific) {
                Ok(paths) if paths.is_empty() => {
                    let what = format!("{} without length", entry.kind);
                    left_out.add(&what, &what);
                }
                Ok(paths) => figures.push(Figure {
                    place: place_of(entry),
                    paths,
                    fill: None,
                }),
                Err(what) => unsupported
                    .entry(format!("{} {what}", entry.kind))
                    .or_default()
                    .push(entry.line),
            }
        } else {
            unsupported
                .entry(entry.kind.clone())
                .or_default()
                .push(entry.line);
        }
    }
    refuse_unsupported(unsupported)?;
    Ok(Sketch {
        figures,
        declared: declared(drawing.header.default_drawing_units),
        notes: left_out.notes(),
    })
}

/// The name in the file of an entity that can be read.
fn kind_of(entity: &EntityType) -> Option<&'static str> {
    match entity {
        EntityType::Line(_) => Some("LINE"),
        EntityType::Arc(_) => Some("ARC"),
        EntityType::Circle(_) => Some("CIRCLE"),
        EntityType::Ellipse(_) => Some("ELLIPSE"),
        EntityType::Spline(_) => Some("SPLINE"),
        EntityType::LwPolyline(_) => Some("LWPOLYLINE"),
        EntityType::Polyline(_) => Some("POLYLINE"),
        _ => None,
    }
}

fn place_of(entry: &DxfEntity) -> FigurePlace {
    let name = match &entry.handle {
        Some(handle) => format!("{} (handle {handle})", entry.kind),
        None => entry.kind.clone(),
    };
    FigurePlace {
        line: entry.line,
        name,
    }
}

fn declared(units: Units) -> Option<DeclaredUnit> {
    let (unit, factor) = match units {
        Units::Inches | Units::USSurveyInch => (Unit::Inch, 1.0),
        Units::Feet | Units::USSurveyFeet => (Unit::Foot, 1.0),
        Units::Yards => (Unit::Foot, 3.0),
        Units::Mils => (Unit::Inch, 1e-3),
        Units::Microinches => (Unit::Inch, 1e-6),
        Units::Microns => (Unit::Micrometre, 1.0),
        Units::Nanometers => (Unit::Micrometre, 1e-3),
        Units::Millimeters => (Unit::Millimetre, 1.0),
        Units::Centimeters => (Unit::Centimetre, 1.0),
        Units::Decimeters => (Unit::Centimetre, 10.0),
        Units::Meters => (Unit::Metre, 1.0),
        Units::Kilometers => (Unit::Metre, 1e3),
        _ => return None,
    };
    Some(DeclaredUnit { unit, factor })
}
