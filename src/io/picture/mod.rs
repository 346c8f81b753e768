//! Swept regions as drawings: SVG, DXF and PNG.
//!
//! SVG and PNG show at a glance what happened: the body at its start, at its end and between, the
//! paths of the grazing points, and the region under all of them. The region of an SVG or DXF can
//! be read back as a body.

mod dxf;
mod png;
mod svg;

use super::drawing::DrawingFormat;
use super::drawing_file::drawing_format;
use super::error::{OutputError, OutputProblem};
use super::file::{extension, written};
use super::mesh::write_mesh;
use super::replace;
use super::units::Unit;
use glam::{DVec2, DVec3};
use std::path::Path;

/// File formats of swept regions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum RegionFormat {
    /// Scalable Vector Graphics: region, poses and paths; coordinates in full precision.
    Svg,
    /// Drawing Exchange Format: closed polylines of the region; coordinates to twelve decimals.
    Dxf,
    /// Portable Network Graphics: the picture of the SVG.
    Png,
    /// The region as triangles in the plane z = 0, Wavefront OBJ or PLY, in full precision.
    Triangles,
}

/// Extensions of the regions that can be written.
const KNOWN: &[&str] = &[".svg", ".dxf", ".png", ".obj", ".ply"];

/// Extensions of those that are pictures.
const PICTURES: &[&str] = &[".svg", ".dxf", ".png"];

/// Decimals of coordinates in a DXF.
const DXF_DECIMALS: i32 = 12;

impl RegionFormat {
    /// Largest distance by which a point of the region moves when it is written.
    pub fn rounding(self) -> f64 {
        match self {
            RegionFormat::Dxf => std::f64::consts::FRAC_1_SQRT_2 * 10f64.powi(-DXF_DECIMALS),
            RegionFormat::Svg | RegionFormat::Png | RegionFormat::Triangles => 0.0,
        }
    }
}

/// The direction of y on the screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum VerticalAxis {
    /// As in mathematics and in CAD.
    #[default]
    Up,
    /// As in SVG.
    Down,
}

impl VerticalAxis {
    /// The direction of y in files of a format.
    pub fn of(format: DrawingFormat) -> VerticalAxis {
        match format {
            DrawingFormat::Svg => VerticalAxis::Down,
            DrawingFormat::Dxf => VerticalAxis::Up,
        }
    }
}

/// What the region of a picture shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RegionSubject {
    /// The region that a body sweeps.
    #[default]
    Swept,
    /// What the body leaves of a blank.
    Left,
    /// Nothing: the paths are the untrimmed envelope.
    Envelope,
}

impl RegionSubject {
    /// The title of a picture.
    fn title(self) -> &'static str {
        match self {
            RegionSubject::Swept => "Region swept by a moving body",
            RegionSubject::Left => "What a moving body leaves of a blank",
            RegionSubject::Envelope => "Untrimmed envelope of a moving body",
        }
    }

    /// The look of the region; `None` where there is none.
    fn look(self) -> Option<Look> {
        match self {
            RegionSubject::Swept => Some(REGION),
            RegionSubject::Left => Some(Look {
                name: "what is left of the blank",
                ..REGION
            }),
            RegionSubject::Envelope => None,
        }
    }

    /// The look of the paths.
    fn paths_look(self) -> Look {
        match self {
            RegionSubject::Swept | RegionSubject::Left => PATHS,
            RegionSubject::Envelope => ENVELOPE,
        }
    }
}

/// A region and how it came about. All loops are closed, in one frame and unit.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RegionPicture {
    /// Loops of the region, which lies on their left.
    pub region: Vec<Vec<DVec2>>,
    /// What that region shows.
    pub subject: RegionSubject,
    /// Loops of the body at some times, in order: first at the start, and last at the end.
    pub poses: Vec<Vec<Vec<DVec2>>>,
    /// Paths of the grazing points.
    pub paths: Vec<Vec<DVec2>>,
    /// The direction of y.
    pub vertical: VerticalAxis,
    /// Unit of the lengths, where it is known.
    pub unit: Option<Unit>,
}

impl RegionPicture {
    /// The smallest box [min, max] around all that is shown; zero when nothing is.
    fn bounds(&self) -> [DVec2; 2] {
        let loops = self
            .region
            .iter()
            .chain(self.poses.iter().flatten())
            .chain(&self.paths);
        let around = loops
            .flatten()
            .fold(None, |around: Option<[DVec2; 2]>, &p| {
                let [low, high] = around.unwrap_or([p; 2]);
                Some([low.min(p), high.max(p)])
            });
        around.unwrap_or_default()
    }
}

/// Checks that a region can be written to `path`, before anything is computed: the format is known
/// and a file can be created in the directory. Leaves no trace.
///
/// # Errors
/// [`OutputError`] with what is wrong.
pub fn check_region_output(path: &Path) -> Result<RegionFormat, OutputError> {
    let format = match (drawing_format(path), extension(path).as_deref()) {
        (Some(DrawingFormat::Svg), _) => RegionFormat::Svg,
        (Some(DrawingFormat::Dxf), _) => RegionFormat::Dxf,
        (None, Some("png")) => RegionFormat::Png,
        (None, Some("obj" | "ply")) => RegionFormat::Triangles,
        (None, Some(solid @ ("stl" | "glb" | "3mf"))) => {
            let found = format!(".{solid}");
            let problem = OutputProblem::OtherKind {
                found,
                what: "regions of the plane",
                known: KNOWN,
            };
            return Err(OutputError::new(path, problem));
        }
        (None, found) => {
            let found = found.map(str::to_owned);
            let problem = OutputProblem::UnknownExtension {
                found,
                known: KNOWN,
            };
            return Err(OutputError::new(path, problem));
        }
    };
    replace::check_place(path).map_err(|problem| OutputError::new(path, problem))?;
    Ok(format)
}

/// Writes a region as SVG, DXF or PNG, as the extension says; the file appears once it is complete.
/// For triangles there is [`write_region_triangles`].
///
/// # Errors
/// [`OutputError`]; a file that was there before is then unharmed.
///
/// # Example
/// ```
/// use glam::DVec2;
/// use steadysweep::io::{DrawingSettings, RegionPicture, read_drawing, write_region};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let path = std::env::temp_dir().join(format!("steadysweep-{}.svg", std::process::id()));
/// let corners = [[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]].map(DVec2::from_array).to_vec();
/// write_region(&path, &RegionPicture { region: vec![corners], ..Default::default() })?;
/// let drawing = read_drawing(&path, &DrawingSettings::default())?;
/// assert_eq!(drawing.polygon.area(), 2.0);
/// # std::fs::remove_file(&path)?;
/// # Ok(())
/// # }
/// ```
pub fn write_region(path: &Path, picture: &RegionPicture) -> Result<(), OutputError> {
    match check_region_output(path)? {
        RegionFormat::Svg => written(path, |out| svg::write(out, picture)),
        RegionFormat::Dxf => written(path, |out| dxf::write(out, picture)),
        RegionFormat::Png => written(path, |out| png::write(out, picture)),
        RegionFormat::Triangles => {
            let found = format!(".{}", extension(path).unwrap_or_default());
            let problem = OutputProblem::OtherKind {
                found,
                what: "pictures",
                known: PICTURES,
            };
            Err(OutputError::new(path, problem))
        }
    }
}

/// Writes the triangles of a region as OBJ or PLY in the plane z = 0, as the extension says; the
/// file appears once it is complete.
///
/// # Errors
/// [`OutputError`]; a file that was there before is then unharmed.
pub fn write_region_triangles(
    path: &Path,
    positions: &[DVec2],
    triangles: &[[u32; 3]],
) -> Result<(), OutputError> {
    let positions: Vec<DVec3> = positions.iter().map(|p| p.extend(0.0)).collect();
    write_mesh(path, &positions, triangles)
}

/// A colour as red, green and blue, and its opacity from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Paint {
    red: u8,
    green: u8,
    blue: u8,
    opacity: f32,
}

const fn paint(red: u8, green: u8, blue: u8, opacity: f32) -> Paint {
    Paint {
        red,
        green,
        blue,
        opacity,
    }
}

/// How a kind of thing is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Look {
    /// Name in the file and in the legend.
    name: &'static str,
    fill: Option<Paint>,
    line: Paint,
    /// Width of the line, as a share of the diagonal of the picture.
    width: f64,
}

// Blue and orange, each dark and light: they can be told apart in grey, and by people who see no
// red or green.
const REGION: Look = Look {
    name: "region",
    fill: Some(paint(198, 219, 239, 1.0)),
    line: paint(8, 69, 148, 1.0),
    width: 3e-3,
};
const PATHS: Look = Look {
    name: "paths of grazing points",
    fill: None,
    line: paint(107, 174, 214, 1.0),
    width: 6e-4,
};
const ENVELOPE: Look = Look {
    name: "untrimmed envelope",
    line: REGION.line,
    width: 1.2e-3,
    ..PATHS
};
const BETWEEN: Look = Look {
    name: "body on its way",
    fill: None,
    line: paint(110, 110, 110, 0.8),
    width: 8e-4,
};
const END: Look = Look {
    name: "body at the end",
    fill: Some(paint(217, 72, 1, 0.45)),
    line: paint(127, 39, 4, 1.0),
    width: 1.5e-3,
};
const START: Look = Look {
    name: "body at the start",
    fill: Some(paint(254, 217, 118, 0.7)),
    line: paint(140, 100, 0, 1.0),
    width: 1.5e-3,
};

/// Margin around the picture, as a share of its diagonal.
const MARGIN: f64 = 0.03;

/// The parts of a picture from bottom to top, without the region.
fn layers(picture: &RegionPicture) -> Vec<(Look, Vec<&Vec<DVec2>>, PathKind)> {
    let mut layers = vec![(
        picture.subject.paths_look(),
        picture.paths.iter().collect::<Vec<_>>(),
        PathKind::Open,
    )];
    let between = picture
        .poses
        .get(1..picture.poses.len().saturating_sub(1))
        .unwrap_or_default();
    layers.push((
        BETWEEN,
        between.iter().flatten().collect(),
        PathKind::Closed,
    ));
    if let [start, .., end] = &picture.poses[..] {
        layers.push((END, end.iter().collect(), PathKind::Closed));
        layers.push((START, start.iter().collect(), PathKind::Closed));
    }
    layers.retain(|(_, loops, _)| !loops.is_empty());
    layers
}

/// Whether a list of points is a path or a loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum PathKind {
    Open,
    Closed,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square that moves to the right, with a square hole in the region.
    pub(super) fn picture() -> RegionPicture {
        let square = |x: f64, size: f64| {
            [
                [x, 0.1],
                [x + size, 0.1],
                [x + size, 0.1 + size],
                [x, 0.1 + size],
            ]
            .map(DVec2::from_array)
            .to_vec()
        };
        let mut hole = square(1.5, 0.25);
        hole.reverse();
        hole.iter_mut().for_each(|p| p.y += 0.1);
        RegionPicture {
            region: vec![
                [[0.0, 0.1], [3.0, 0.1], [3.0, 1.1], [0.0, 1.1]]
                    .map(DVec2::from_array)
                    .to_vec(),
                hole,
            ],
            subject: RegionSubject::Swept,
            poses: vec![
                vec![square(0.0, 1.0)],
                vec![square(1.0, 1.0)],
                vec![square(2.0, 1.0)],
            ],
            paths: vec![vec![DVec2::new(1.0, 0.1), DVec2::new(3.0, 0.1)]],
            vertical: VerticalAxis::Up,
            unit: Some(Unit::Millimetre),
        }
    }

    #[test]
    fn a_picture_begins_with_what_lies_below() {
        let picture = picture();
        let names: Vec<&str> = layers(&picture)
            .iter()
            .map(|(look, ..)| look.name)
            .collect();
        assert_eq!(
            names,
            [
                "paths of grazing points",
                "body on its way",
                "body at the end",
                "body at the start"
            ]
        );
        assert_eq!(
            picture.bounds(),
            [DVec2::new(0.0, 0.1), DVec2::new(3.0, 1.1)]
        );
        assert_eq!(layers(&RegionPicture::default()), [], "nothing to show");
    }
}
