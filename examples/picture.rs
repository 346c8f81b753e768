//! Draws the picture of the README: the bracket at the start and at the end of a screw motion, and
//! the solid that it sweeps.
//!
//! You learn how to place a body at a pose of a motion, and that a solid is just positions and
//! triangles. Here they become an orthographic drawing, shaded by the angle to the light, with far
//! triangles drawn before near ones.
//!
//! Run: `cargo run --release --example picture [OUT.svg]` (default: `examples/bracket_sweep.svg`,
//! the file of the repository) You should see the number of triangles drawn, those that face the
//! viewer, and the size of the file, below 400 kB.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

use glam::{DVec2, DVec3};
use steadysweep::io::read_body;
use steadysweep::motion::{Motion, Screw, Span};
use steadysweep::{Stage, SweepSettings, sweep};

/// Paper units per unit of the part; corners are rounded to whole paper units.
const SCALE: f64 = 6.0;
const MARGIN: f64 = 20.0;

/// Direction from the part to the viewer.
const TO_VIEWER: DVec3 = DVec3::new(0.42, -0.75, 0.52);
const TO_LIGHT: DVec3 = DVec3::new(0.15, -0.6, 0.8);
/// Red, green and blue of a surface that faces the light, and the share that remains in the dark.
const BODY: [f64; 3] = [255.0, 140.0, 25.0];
const SOLID: [f64; 3] = [150.0, 200.0, 245.0];
const AMBIENT: f64 = 0.5;
/// Steps of brightness: consecutive triangles with the same one share a path.
const SHADES: f64 = 40.0;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args()
        .nth(1)
        .unwrap_or("examples/bracket_sweep.svg".to_owned());
    let (bracket, _) = read_body(Path::new(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/examples/bracket.stl"
    )))?;
    let screw = Screw {
        axis: DVec3::Z,
        through: DVec3::new(90.0, 20.0, 0.0),
        turn: 180_f64.to_radians(),
        advance: 60.0,
        ..Screw::default()
    };
    let motion = Motion::from_spans(vec![Span::new(screw.generator()?, 1.0)?])?;
    let tell = |stage: Stage| eprintln!("{stage:?} ...");
    let settings = SweepSettings::default()
        .with_tolerance(0.5)
        .with_observer(&tell);
    let swept = sweep(&bracket, &motion, &settings)?;

    let mut bodies = Vec::new();
    for joint in motion.joints() {
        let placed = bracket.transformed(joint);
        bodies.extend(facing(placed.positions(), placed.triangles()));
    }
    let solid = facing(swept.solid.positions(), swept.solid.triangles());
    let corners = || bodies.iter().chain(&solid).flat_map(|face| face.corners);
    let low = corners().fold(DVec2::INFINITY, DVec2::min) - MARGIN;
    let high = corners().fold(DVec2::NEG_INFINITY, DVec2::max) + MARGIN;
    let size = (high - low).ceil();

    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{:.0} {:.0} {} {}\">\n",
        low.x, low.y, size.x, size.y
    );
    draw(&mut svg, bodies.clone(), BODY, 1.0)?;
    draw(&mut svg, solid.clone(), SOLID, 0.5)?;
    svg.push_str("</svg>\n");
    std::fs::write(&path, &svg)?;
    println!("triangles {}", bodies.len() + solid.len());
    println!("bytes     {}", svg.len());
    println!("written to {path}");
    Ok(())
}

/// A triangle on paper.
#[derive(Clone)]
struct Face {
    corners: [DVec2; 3],
    /// Distance towards the viewer, at the centre.
    nearness: f64,
    /// 0 in the dark, [`SHADES`] towards the light.
    shade: f64,
}

/// The triangles that face the viewer.
fn facing(positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<Face> {
    let toward = TO_VIEWER.normalize();
    let right = DVec3::Z.cross(toward).normalize();
    let up = toward.cross(right);
    let project = |p: DVec3| (SCALE * DVec2::new(right.dot(p), -up.dot(p))).round();
    let placed = triangles.iter().map(|t| t.map(|i| positions[i as usize]));
    placed
        .filter_map(|[a, b, c]| {
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let light = normal.dot(TO_LIGHT.normalize()).max(0.0);
            let corners = [a, b, c].map(project);
            // Triangles that face the viewer run clockwise on paper, where y points down; very
            // small ones vanish.
            let is_visible = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]) < 0.0;
            is_visible.then(|| Face {
                corners,
                nearness: toward.dot(a + b + c) / 3.0,
                shade: (light * SHADES).round(),
            })
        })
        .collect()
}

/// Appends the faces, far ones first, as a group with one opacity.
fn draw(
    svg: &mut String,
    mut faces: Vec<Face>,
    colour: [f64; 3],
    opacity: f64,
) -> std::fmt::Result {
    faces.sort_by(|a, b| a.nearness.total_cmp(&b.nearness));
    writeln!(
        svg,
        "<g opacity=\"{opacity}\" stroke-width=\"2\" stroke-linejoin=\"round\">"
    )?;
    for row in faces.chunk_by(|a, b| a.shade == b.shade) {
        let brightness = AMBIENT + (1.0 - AMBIENT) * row[0].shade / SHADES;
        #[allow(clippy::cast_possible_truncation, reason = "from 0 to 255")]
        let [red, green, blue] = colour.map(|value| (value * brightness).round() as u8);
        let colour = format!("#{red:02x}{green:02x}{blue:02x}");
        // Lines in the colour of the triangle close the hairline gaps between neighbours.
        write!(svg, "<path fill=\"{colour}\" stroke=\"{colour}\" d=\"")?;
        for face in row {
            let [a, b, c] = face.corners;
            write!(
                svg,
                "M{} {}l{} {} {} {}z",
                a.x,
                a.y,
                b.x - a.x,
                b.y - a.y,
                c.x - b.x,
                c.y - b.y
            )?;
        }
        writeln!(svg, "\"/>")?;
    }
    writeln!(svg, "</g>")
}
