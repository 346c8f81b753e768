//! Draws the pictures of the README and of the guide: a bracket on its path, the solid that it
//! sweeps, a contact, and the times during which points are inside.
//!
//! You learn how to place a body at a pose of a motion, and that a solid is just positions and
//! triangles. Here they become an orthographic drawing, shaded by the angle to the light, with far
//! triangles drawn before near ones.
//!
//! Run: `cargo run --release --example picture [FOLDER]` (default: `examples`, the folder of the
//! repository).
//!
//! You should see the number of triangles drawn in each picture, those that face the viewer, and
//! the size of its file, below 400 kB.

use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use glam::{DAffine3, DVec2, DVec3};
use steadysweep::body::Mesh;
use steadysweep::collision::{CheckSettings, Obstacle, Verdict, check};
use steadysweep::io::{read_body, read_motion, read_points, read_surface};
use steadysweep::membership::Membership;
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
const OBSTACLE: [f64; 3] = [170.0, 175.0, 180.0];
const AMBIENT: f64 = 0.5;
/// Steps of brightness: consecutive triangles with the same one share a path.
const SHADES: f64 = 40.0;

/// Poses along a motion of several spans.
const POSES: u32 = 9;
/// A grey that is legible on white and on black.
const LETTERS: &str = "#767676";

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or("examples".to_owned()));
    let example = |name: &str| {
        Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("examples")
            .join(name)
    };
    let (bracket, _) = read_body(&example("bracket.stl"))?;
    let path = read_motion(&example("path.json"))?;
    let points = read_points(&example("points.csv"))?;
    let pictures = [
        ("bracket_sweep.svg", swept(&bracket)?),
        (
            "bracket_contact.svg",
            contact(&bracket, &example("plate.obj"), &example("post.obj"))?,
        ),
        ("bracket_path.svg", along(&bracket, &path)?),
    ];
    for (name, layers) in pictures {
        let file = folder.join(name);
        let svg = drawing(&layers)?;
        std::fs::write(&file, &svg)?;
        println!("picture   {}", file.display());
        println!(
            "triangles {}",
            layers.iter().map(|layer| layer.faces.len()).sum::<usize>()
        );
        println!("bytes     {}", svg.len());
    }
    let times = Membership::new(&bracket, &path).intervals_of(&points);
    let file = folder.join("bracket_points.svg");
    std::fs::write(&file, timeline(&times, path.joint_times())?)?;
    println!("picture   {}", file.display());
    Ok(())
}

/// A screw that takes the bracket around to the other side.
fn screw(axis: DVec3) -> Result<Motion, Box<dyn Error>> {
    let screw = Screw {
        axis,
        through: DVec3::new(90.0, 20.0, 0.0),
        turn: 180_f64.to_radians(),
        advance: 60.0,
        ..Screw::default()
    };
    Ok(Motion::from_spans(vec![Span::new(
        screw.generator()?,
        1.0,
    )?])?)
}

/// The body at the start and at the end, and the solid that it sweeps.
fn swept(body: &Mesh) -> Result<Vec<Layer>, Box<dyn Error>> {
    let motion = screw(DVec3::Z)?;
    let tell = |stage: Stage, share: f64| eprint!("\r{stage:?} {:.0} %   ", 100.0 * share);
    let settings = SweepSettings::default()
        .with_tolerance(0.5)
        .with_observer(&tell);
    let swept = sweep(body, &motion, &settings)?;
    let mut bodies = Vec::new();
    for joint in motion.joints() {
        bodies.extend(placed(body, joint));
    }
    let solid = facing(swept.solid.positions(), swept.solid.triangles());
    Ok(vec![
        Layer::new(bodies, BODY, 1.0),
        Layer::new(solid, SOLID, 0.5),
    ])
}

/// The body at the start and where it meets the post, on its plate.
fn contact(body: &Mesh, plate: &Path, post: &Path) -> Result<Vec<Layer>, Box<dyn Error>> {
    let motion = screw(DVec3::new(0.0, 0.1, 1.0))?;
    let [(plate, _), (post, _)] = [read_surface(plate)?, read_surface(post)?];
    let obstacle = Obstacle {
        surface: &post,
        motion: None,
    };
    let found = check(body, &motion, &[obstacle], &CheckSettings::default())?;
    let Verdict::Contact(contact) = found.verdict else {
        return Err("the bracket meets the post".into());
    };
    let meeting = motion.pose_at_time(contact.time);
    // The post is in front of the bracket.
    Ok(vec![
        Layer::new(facing(plate.positions(), plate.triangles()), OBSTACLE, 0.4),
        Layer::new(placed(body, motion.start_pose()), BODY, 0.35),
        Layer::new(placed(body, &meeting), BODY, 1.0),
        Layer::new(facing(post.positions(), post.triangles()), OBSTACLE, 0.9),
    ])
}

/// The body along its path, later poses before earlier ones.
fn along(body: &Mesh, motion: &Motion) -> Result<Vec<Layer>, Box<dyn Error>> {
    let times = motion.joint_times();
    let (start, end) = (times[0], times[times.len() - 1]);
    let layer = |number: u32| {
        let time = start + (end - start) * f64::from(number) / f64::from(POSES - 1);
        let is_key = times.contains(&time);
        let opacity = if is_key { 1.0 } else { 0.3 };
        Layer::new(placed(body, &motion.pose_at_time(time)), BODY, opacity)
    };
    // Poses farther from the viewer come first.
    Ok((0..POSES).rev().map(layer).collect())
}

/// Triangles of one colour.
struct Layer {
    faces: Vec<Face>,
    colour: [f64; 3],
    opacity: f64,
}

impl Layer {
    fn new(faces: Vec<Face>, colour: [f64; 3], opacity: f64) -> Layer {
        Layer {
            faces,
            colour,
            opacity,
        }
    }
}

/// The layers, the first one at the back.
fn drawing(layers: &[Layer]) -> Result<String, std::fmt::Error> {
    let corners = || {
        let faces = layers.iter().flat_map(|layer| &layer.faces);
        faces.flat_map(|face| face.corners)
    };
    let low = corners().fold(DVec2::INFINITY, DVec2::min) - MARGIN;
    let high = corners().fold(DVec2::NEG_INFINITY, DVec2::max) + MARGIN;
    let size = (high - low).ceil();
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{:.0} {:.0} {} {}\">\n",
        low.x, low.y, size.x, size.y
    );
    for layer in layers {
        draw(&mut svg, layer.faces.clone(), layer.colour, layer.opacity)?;
    }
    svg.push_str("</svg>\n");
    Ok(svg)
}

/// A row for each point, with a bar for every interval during which it is inside.
fn timeline(points: &[Vec<[f64; 2]>], joints: &[f64]) -> Result<String, std::fmt::Error> {
    const SECOND: f64 = 160.0;
    const ROW: f64 = 30.0;
    let (start, end) = (joints[0], joints[joints.len() - 1]);
    let at = |time: f64| 80.0 + SECOND * (time - start);
    let bottom = ROW * (points.len() as f64 + 0.5);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\">\n\
         <g font-family=\"sans-serif\" font-size=\"15\" fill=\"{LETTERS}\">\n",
        at(end) + 20.0,
        bottom + ROW
    );
    for &time in joints {
        let x = at(time);
        writeln!(
            svg,
            "<path stroke=\"{LETTERS}\" stroke-width=\"0.5\" d=\"M{x} 5V{bottom}\"/>\
             <text x=\"{x}\" y=\"{}\" text-anchor=\"middle\">{time}</text>",
            bottom + 0.6 * ROW
        )?;
    }
    for (number, intervals) in points.iter().enumerate() {
        let y = ROW * (number as f64 + 0.3);
        writeln!(
            svg,
            "<text x=\"5\" y=\"{}\">point {}</text>",
            y + 15.0,
            number + 1
        )?;
        for &[from, to] in intervals {
            let (x, width) = (at(from), SECOND * (to - from));
            writeln!(
                svg,
                "<rect x=\"{x:.1}\" y=\"{y}\" width=\"{width:.1}\" height=\"20\" fill=\"#ff8c19\"/>"
            )?;
        }
    }
    svg.push_str("</g>\n</svg>\n");
    Ok(svg)
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

/// The faces of a body at a pose.
fn placed(body: &Mesh, pose: &DAffine3) -> Vec<Face> {
    let placed = body.transformed(pose);
    facing(placed.positions(), placed.triangles())
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
