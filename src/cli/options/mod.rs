//! The options of the command line.

mod check;
mod drawing;
mod half_turn;
mod motion;

pub(crate) use check::{CheckOptions, GivenObstacle, ObstacleSource};
use drawing::DRAWINGS;
pub(crate) use drawing::{DrawingOptions, NoDrawing};
pub(crate) use half_turn::HalfTurnOption;
use motion::Coordinates;
pub(crate) use motion::{MotionOptions, MotionSource, planar_single_span, single_span};

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use glam::{DVec2, DVec3};

/// Largest number of threads that `--threads` accepts: more than any machine has on which the tool
/// was tried, and few enough that a typing error cannot exhaust the system.
const MAX_THREADS: i64 = 512;

/// Heading of the options that give a motion.
const MOTION: &str = "Motion (one of --motion, --turn, --translate)";

const EXAMPLES: &str = "\
Examples:
  steadysweep sweep part.stl --turn 540 --axis 0,0,1 --through 40,0,0 --advance 30 -o swept.stl
  steadysweep sweep part.stl --translate 0,0,-25 --json
  steadysweep check part.stl --turn 90 --axis 0,0,1 --against wall.stl stand.stl --clearance 2
  steadysweep probe part.stl --motion path.json --points points.csv
  steadysweep sweep plate.dxf --turn 90 --through 40,0 -o swept.svg
  steadysweep motion --motion path.json

Exit code: 0 done or clear, 1 contact or closer than the clearance, 2 bad input or undecided, 130 interrupted.";

/// Name that `--version` prints, after a subcommand too.
const DISPLAY_NAME: &str = "steadysweep";

/// Swept volumes of solid bodies under steady affine motions.
#[derive(Debug, Parser)]
#[command(name = DISPLAY_NAME, version, propagate_version = true, after_help = EXAMPLES, max_term_width = 100)]
pub(crate) struct Options {
    #[command(subcommand)]
    pub(crate) command: Command,

    /// Number of worker threads, 1 to 512; default: one per processor. The result does not depend
    /// on it.
    #[arg(long, value_name = "N", global = true, allow_hyphen_values = true,
          value_parser = clap::value_parser!(u16).range(1..=MAX_THREADS), help_heading = "Common options")]
    pub(crate) threads: Option<u16>,

    /// Show no progress; it is shown only on a terminal anyway.
    #[arg(long, global = true, help_heading = "Common options")]
    pub(crate) quiet: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Compute the region that a body passes through, as a closed solid or closed outlines, with a
    /// stated error bound.
    #[command(display_name = DISPLAY_NAME, after_help = "\
Examples:
  steadysweep sweep part.stl --turn 180 --axis 0,0,1 --advance 30 -o swept.stl
  steadysweep sweep plate.dxf --turn 90 --through 40,0 -o swept.svg")]
    Sweep(SweepOptions),
    /// Tell whether a moving body touches obstacles, when first and where, and how close it comes
    /// otherwise.
    #[command(display_name = DISPLAY_NAME, override_usage = "steadysweep check <BODY> <MOTION> (--against <FILE>... | --plane <PLANE>...) [OPTIONS]",
              after_help = "\
Examples:
  steadysweep check part.stl --turn 90 --axis 0,0,1 --against wall.stl stand.stl --touching stand
  steadysweep check gear.stl --motion gear.json --against rack.stl --against-motion rack.json --json

Exit code: 0 clear, 1 contact or closer than the clearance, 2 bad input or undecided, 130 interrupted.")]
    Check(CheckOptions),
    /// Tell for each point whether, and during which times, it is inside the moving body.
    #[command(display_name = DISPLAY_NAME, after_help = "\
Example:
  steadysweep probe part.stl --translate 0,0,25 --points points.csv")]
    Probe(ProbeOptions),
    /// Describe a motion span by span: kind, axis, turn, advance, scale, generator.
    #[command(display_name = DISPLAY_NAME, after_help = "\
Example:
  steadysweep motion --turn -90 --axis 0,0,1 --through 10,0,0 --scale 0.5")]
    Motion(DescribeOptions),
}

#[derive(Debug, Args)]
pub(crate) struct SweepOptions {
    /// The body: a closed triangle mesh, .stl, .obj or .ply; or outlines in the plane, .svg or
    /// .dxf.
    #[arg(value_name = "BODY")]
    pub(crate) body: PathBuf,

    #[command(flatten)]
    pub(crate) motion: MotionOptions,

    #[command(flatten)]
    pub(crate) drawing: DrawingOptions,

    /// File for the solid, .stl (binary), .obj or .ply, or in the plane for the region, .svg, .dxf,
    /// .png, or as triangles .obj or .ply, replaced when it exists; default: measure only.
    #[arg(short = 'o', long = "output", value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,

    /// Sampling error allowed, a length in the body's units; default: 1e-3 of the diagonal of its
    /// box, or the smallest usable value where that is larger.
    #[arg(long, value_name = "LEN", allow_hyphen_values = true, value_parser = positive_length)]
    pub(crate) tolerance: Option<f64>,

    /// Whether triangles are removed where the surface hardly bends, within what is left of the
    /// tolerance; not in the plane; default: on.
    #[arg(long, value_name = "on|off", value_enum, hide_possible_values = true)]
    pub(crate) simplify: Option<SimplifyOption>,

    /// Blank that the moving body cuts, a drawing in world coordinates; the result is what is left
    /// of it; default: none.
    #[arg(long, value_name = "BLANK", help_heading = DRAWINGS)]
    pub(crate) subtract_from: Option<PathBuf>,

    /// Sweep the surface of the mesh alone, or the lines of the drawing, open or closed, without an
    /// inside; default: the body that it encloses.
    #[arg(long)]
    pub(crate) surface: bool,

    /// File for the points and segments at which the body grazes, exact, span by span and in the
    /// body's own coordinates, .csv or .obj; default: none.
    #[arg(long, value_name = "FILE")]
    pub(crate) grazing: Option<PathBuf>,

    /// File for the untrimmed envelope, sampled within the tolerance, .obj or .ply, or in the plane
    /// .svg or .csv; default: none.
    #[arg(long, value_name = "FILE")]
    pub(crate) envelope: Option<PathBuf>,

    /// Folder for the stages of the sweep as PLY files (grazing, cycle, arrangement, region,
    /// sources of its triangles), made when it is missing, for debugging; not in the plane; default:
    /// none.
    #[arg(long, value_name = "DIR")]
    pub(crate) dump: Option<PathBuf>,

    /// Print the report as one JSON object; default: as text.
    #[arg(long)]
    pub(crate) json: bool,
}

/// The value of `--simplify`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum SimplifyOption {
    On,
    Off,
}

#[derive(Debug, Args)]
pub(crate) struct ProbeOptions {
    /// The body: a closed triangle mesh, .stl, .obj or .ply; or outlines in the plane, .svg or
    /// .dxf.
    #[arg(value_name = "BODY")]
    pub(crate) body: PathBuf,

    #[command(flatten)]
    pub(crate) motion: MotionOptions,

    #[command(flatten)]
    pub(crate) drawing: DrawingOptions,

    /// Points in the world, one `x,y,z` (in the plane `x,y`) per line in the body's units; a first
    /// line that begins with `#`, or each field of which begins with a letter, is a header.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) points: PathBuf,

    /// Print the report as one JSON object; default: as text.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct DescribeOptions {
    #[command(flatten)]
    pub(crate) motion: MotionOptions,

    /// Body over which the motion is followed where its file names an interpolation or a deviation: a
    /// triangle mesh, .stl, .obj or .ply, or a drawing, .svg or .dxf; default: none, and such a motion
    /// is refused.
    #[arg(long, value_name = "FILE")]
    pub(crate) body: Option<PathBuf>,

    /// Write N poses, 2 or more, evenly spaced in time from the start to the end, to the file of
    /// --output; default: none.
    #[arg(long, value_name = "N", requires = "output", value_parser = clap::value_parser!(u32).range(2..))]
    pub(crate) poses: Option<u32>,

    /// File for the poses of --poses, .csv: the time and the rows of the matrix that maps the body
    /// to the world, with a header; a motion file reads it as a log of poses.
    #[arg(
        short = 'o',
        long = "output",
        value_name = "OUT.csv",
        requires = "poses"
    )]
    pub(crate) output: Option<PathBuf>,

    /// Print the report as one JSON object; default: as text.
    #[arg(long)]
    pub(crate) json: bool,
}

fn finite(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err("the number must be finite".to_owned()),
        Err(_) => Err("expected a number, for example 12.5 or -3e-2".to_owned()),
    }
}

fn positive(text: &str, remedy: &str) -> Result<f64, String> {
    match finite(text)? {
        value if value > 0.0 => Ok(value),
        _ => Err(format!("must be above 0; {remedy}")),
    }
}

fn positive_length(text: &str) -> Result<f64, String> {
    positive(
        text,
        "leave it out for 1e-3 of the diagonal of the body's box",
    )
}

fn positive_factor(text: &str) -> Result<f64, String> {
    positive(text, "1 keeps the size, 0.5 halves it")
}

fn triple(text: &str) -> Result<DVec3, String> {
    let expected = "three numbers X,Y,Z without spaces";
    match numbers(text, expected)?[..] {
        [x, y, z] => Ok(DVec3::new(x, y, z)),
        ref other => Err(format!("expected {expected}, found {}", other.len())),
    }
}

fn coordinates(text: &str) -> Result<Coordinates, String> {
    let expected = "three numbers X,Y,Z without spaces, or two X,Y in the plane";
    match numbers(text, expected)?[..] {
        [x, y] => Ok(Coordinates::Plane(DVec2::new(x, y))),
        [x, y, z] => Ok(Coordinates::Space(DVec3::new(x, y, z))),
        ref other => Err(format!("expected {expected}, found {}", other.len())),
    }
}

fn numbers(text: &str, expected: &str) -> Result<Vec<f64>, String> {
    text.split(',')
        .map(finite)
        .collect::<Result<_, String>>()
        .map_err(|reason| format!("expected {expected}: {reason}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_options_are_consistent() {
        Options::command().debug_assert();
    }

    #[test]
    fn vectors_that_are_not_three_finite_numbers_are_refused() {
        for text in ["", "1,2", "1,2,3,4", "1,2,x", "1,2,NaN", "inf,0,0"] {
            assert!(triple(text).is_err(), "{text:?} is no vector");
        }
    }
}
