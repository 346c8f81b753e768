//! Drawings as planar bodies: what SVG and DXF files say, and how they are refused.

use glam::DVec2;
use std::f64::consts::{PI, SQRT_2};
use std::path::Path;
use steadysweep::body::Polygon;
use steadysweep::io::{
    Drawing, DrawingFormat, DrawingSettings, InputProblem, Unit, parse_drawing, read_drawing,
};

fn svg(text: &str) -> Result<Drawing, InputProblem> {
    parse_drawing(
        DrawingFormat::Svg,
        text.as_bytes(),
        &DrawingSettings::default(),
    )
}

/// An SVG with these elements and a viewBox.
fn shapes(elements: &str) -> Result<Drawing, InputProblem> {
    svg(&format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 100 100\">\n{elements}\n</svg>\n"
    ))
}

/// A DXF with these entities, each as group codes and values separated by blanks.
fn dxf_text(entities: &[&str]) -> String {
    let mut text = "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1015\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n".to_owned();
    for entity in entities {
        entity
            .split_whitespace()
            .for_each(|word| text += &format!("{word}\n"));
    }
    text + "0\nENDSEC\n0\nEOF\n"
}

fn dxf(entities: &[&str]) -> Result<Drawing, InputProblem> {
    parse_drawing(
        DrawingFormat::Dxf,
        dxf_text(entities).as_bytes(),
        &DrawingSettings::default(),
    )
}

/// Area, with the error that flattening may have made of it, pieces and holes.
#[track_caller]
fn check(
    drawing: Result<Drawing, InputProblem>,
    area: f64,
    pieces: usize,
    holes: usize,
) -> Drawing {
    let drawing = drawing.unwrap_or_else(|error| panic!("refused: {error}"));
    let body = &drawing.polygon;
    let error = drawing.flattening * body.perimeter() + 1e-12 * area;
    assert!(
        (body.area() - area).abs() <= error,
        "area {} for {area}",
        body.area()
    );
    assert_eq!(
        (body.pieces(), body.holes()),
        (pieces, holes),
        "pieces and holes"
    );
    drawing
}

#[track_caller]
fn refused(drawing: Result<Drawing, InputProblem>, parts: &[&str]) {
    let message = drawing.expect_err("has to be refused").to_string();
    for part in parts {
        assert!(message.contains(part), "no \"{part}\" in: {message}");
    }
}

#[test]
fn published_drawings_are_bodies() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/cad2d");
    if !folder.is_dir() {
        println!("skipped: no {}", folder.display());
        return;
    }
    for name in ["gear.dxf", "wrench.dxf", "125_cycloidal.DXF", "MIL.svg"] {
        match read_drawing(&folder.join(name), &DrawingSettings::default()) {
            Ok(d) => println!(
                "{name}: area {} pieces {} holes {} corners {} declared {:?} joined {} flattening {} {:?}",
                d.polygon.area(),
                d.polygon.pieces(),
                d.polygon.holes(),
                d.polygon.edge_count(),
                d.declared,
                d.joined,
                d.flattening,
                d.notes
            ),
            Err(error) => println!("{name}: {error}"),
        }
    }
}
