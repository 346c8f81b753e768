//! Draws the blank of the README: a plate with rounded corners and four screw holes, as an SVG in
//! millimetres.
//!
//! You learn how your own outlines become a drawing that is read as you meant it: a unit, one
//! filled path, arcs as arcs, and holes by the fill rule.
//!
//! Run: `cargo run --example make_blank [OUT.svg]` (default: `examples/blank.svg`, the file of the
//! repository).
//!
//! You should see four holes and an area of 15,632 square mm, that of the rounded plate without
//! them.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

use glam::DVec2;
use steadysweep::io::{DrawingSettings, read_drawing};

/// Opposite corners, in mm; the lever of the README swings between them.
const LOW: DVec2 = DVec2::new(-10.0, 0.0);
const HIGH: DVec2 = DVec2::new(118.0, 124.0);
/// Radius of the corners.
const ROUNDING: f64 = 10.0;
/// The holes: radius, and distance of the centre from both edges.
const HOLE: f64 = 3.5;
const INSET: f64 = 10.0;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args()
        .nth(1)
        .unwrap_or("examples/blank.svg".to_owned());
    std::fs::write(&path, blank()?)?;

    let drawing = read_drawing(Path::new(&path), &DrawingSettings::default())?;
    println!("area      {:.3}", drawing.polygon.area());
    println!("holes     {}", drawing.polygon.holes());
    println!("curves    within {:.1e}", drawing.flattening);
    println!("written to {path}");
    Ok(())
}

/// The drawing.
fn blank() -> Result<String, std::fmt::Error> {
    let size = HIGH - LOW;
    let mut svg = String::new();
    writeln!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}mm\" height=\"{}mm\" viewBox=\"{} {} {} {}\">",
        size.x, size.y, LOW.x, LOW.y, size.x, size.y
    )?;
    writeln!(
        svg,
        "<title>A plate with rounded corners and four holes</title>"
    )?;
    // With this rule a loop inside another one is a hole, whichever way it runs.
    write!(
        svg,
        "<path fill=\"#d8d8d8\" fill-rule=\"evenodd\"\n d=\"{}",
        plate()
    )?;
    for x in [LOW.x + INSET, HIGH.x - INSET] {
        for y in [LOW.y + INSET, HIGH.y - INSET] {
            write!(svg, "\n    {}", hole(DVec2::new(x, y)))?;
        }
    }
    writeln!(svg, "\"/>\n</svg>")?;
    Ok(svg)
}

/// The outer loop: H and V draw lines, and A draws arcs.
fn plate() -> String {
    let [left, top, right, bottom] = [LOW.x, LOW.y, HIGH.x, HIGH.y];
    let r = ROUNDING;
    format!(
        "M{} {top} H{} A{r} {r} 0 0 1 {right} {} V{} A{r} {r} 0 0 1 {} {bottom} H{} A{r} {r} 0 0 1 {left} {} V{} A{r} {r} 0 0 1 {} {top} Z",
        left + r,
        right - r,
        top + r,
        bottom - r,
        right - r,
        left + r,
        bottom - r,
        top + r,
        left + r,
    )
}

/// A circle as two half circles.
fn hole(centre: DVec2) -> String {
    let DVec2 { x, y } = centre;
    let r = HOLE;
    format!(
        "M{} {y} A{r} {r} 0 1 0 {} {y} A{r} {r} 0 1 0 {} {y} Z",
        x + r,
        x - r,
        x + r
    )
}
