//! The run of `check`: read, check, and tabulate the distance over time.

use std::collections::HashMap;
use std::error::Error;
use std::path::Path;

use rayon::prelude::*;

use super::interrupt;
use super::motions::undecided_motion_of;
use super::options::{CheckOptions, ObstacleFiles};
use super::progress::StageProgress;
use super::report::{CheckReport, CheckedBody, CheckedObstacle, ObstacleMotion};
use crate::collision::{
    self, Check, CheckError, CheckSettings, CheckStage, Closest, ContactRule, Shape, ShapeObstacle,
    Verdict,
};
use crate::io;
use crate::motion::{Motion, MotionError};

/// Steps between the evenly spaced times of a table of distances: a smooth curve on a screen.
const DISTANCES: u32 = 256;

/// Columns of a table of distances: the nearest obstacle, the nearest points on the body and on
/// that obstacle.
const DISTANCE_COLUMNS: [&str; 9] = [
    "time",
    "distance",
    "obstacle",
    "body_x",
    "body_y",
    "body_z",
    "obstacle_x",
    "obstacle_y",
    "obstacle_z",
];

/// Reads the files, checks the body against the obstacles, and writes the table if one is asked
/// for.
pub(crate) fn check(
    options: &CheckOptions,
    progress: &StageProgress,
) -> Result<CheckReport, Box<dyn Error>> {
    if io::drawing_format(&options.body).is_some() {
        let body = options.body.display();
        return Err(format!(
            "{body}: check takes bodies in space only, .stl .obj .ply, and a drawing is a body in the plane; sweep and probe take both"
        )
        .into());
    }
    if let Some(csv) = &options.csv {
        io::check_table(csv)?;
    }
    let files = options.obstacles.files()?;
    let rules = options.rules(&files)?;
    progress.stage("read");
    let Motions {
        body: motion,
        others,
    } = motions(options, &files)?;
    let (body, body_read) = io::read_body(&options.body)?;
    let mut surfaces = Vec::with_capacity(files.len());
    for file in &files {
        surfaces.push(io::read_surface(&file.mesh)?);
    }
    let motion_of = |file: &ObstacleFiles| file.motion.as_deref().map(|path| &others[path]);
    progress.stage(name_of(CheckStage::Prepare));
    let shape = Shape::from(&body);
    let shapes: Vec<Shape> = surfaces
        .iter()
        .map(|(surface, _)| Shape::new(surface))
        .collect();
    let obstacles: Vec<ShapeObstacle<'_>> = shapes
        .iter()
        .zip(&files)
        .map(|(shape, file)| ShapeObstacle {
            shape,
            motion: motion_of(file),
        })
        .collect();
    let tell = |stage, _| progress.stage(name_of(stage));
    let mut settings = CheckSettings::default()
        .with_clearance(options.clearance.unwrap_or_default())
        .with_rules(rules.clone())
        .with_observer(&tell)
        .with_interrupt(interrupt::flag());
    settings.all_intervals = options.intervals;
    let mut found = collision::check_shapes(&shape, &motion, &obstacles, &settings)
        .map_err(|error| with_file(error, &files))?;
    if let Some(csv) = &options.csv {
        progress.stage("distance");
        let distance_at =
            |&time: &f64| collision::distance_at(&shape, &motion, &obstacles, &rules, time);
        let times = times(&motion, &found);
        let distances: Vec<Closest> = times.par_iter().map(distance_at).collect();
        // Obstacles that may be touched are in the table, but the body keeps no clearance from
        // them.
        let is_kept = |closest: &Closest| rules.get(closest.obstacle) == Some(&ContactRule::Touch);
        for (&time, closest) in times.iter().zip(&distances) {
            if is_kept(closest) {
                found.clearance.see(time, closest);
            }
        }
        let rows = times.iter().zip(distances).map(|(&time, closest)| {
            let [p, q] = closest.points.map(|point| point.to_array());
            let numbers = [time, closest.distance, p[0], p[1], p[2], q[0], q[1], q[2]];
            // The form that reads back as the same number.
            let [time, distance, px, py, pz, qx, qy, qz] = numbers.map(|x| format!("{x:?}"));
            let file = &files[closest.obstacle].mesh;
            let file = file.to_string_lossy().into_owned();
            [time, distance, file, px, py, pz, qx, qy, qz]
        });
        io::write_table(csv, DISTANCE_COLUMNS, rows)?;
    }
    let checked: Vec<CheckedObstacle<'_>> = files
        .iter()
        .zip(&surfaces)
        .zip(rules)
        .map(|((file, (surface, read)), rule)| CheckedObstacle {
            file: &file.mesh,
            surface,
            read,
            motion: file
                .motion
                .as_deref()
                .zip(motion_of(file))
                .map(|(file, motion)| ObstacleMotion { file, motion }),
            rule,
        })
        .collect();
    let body = CheckedBody {
        mesh: &body,
        read: &body_read,
        motion: &motion,
    };
    Ok(CheckReport::new(
        &found,
        settings.clearance,
        body,
        &checked,
        progress.seconds(),
    ))
}

/// The motions of a check, with the senses of their half turns decided.
struct Motions<'a> {
    body: Motion,
    /// The motions of the obstacles, by file.
    others: HashMap<&'a Path, Motion>,
}

/// Reads each file once, and assigns the senses in the order of the command line.
fn motions<'a>(
    options: &CheckOptions,
    files: &'a [ObstacleFiles],
) -> Result<Motions<'a>, Box<dyn Error>> {
    let option = &options.motion.half_turn;
    let body = undecided_motion_of(&options.motion)?;
    let mut paths: Vec<&Path> = Vec::new();
    let mut undecided = vec![body];
    for path in files.iter().filter_map(|file| file.motion.as_deref()) {
        if !paths.contains(&path) {
            paths.push(path);
            undecided.push(io::read_motion_turning(path, &option.while_reading())?);
        }
    }
    let counts: Vec<usize> = undecided.iter().map(Motion::half_turns).collect();
    let mut decided = undecided
        .into_iter()
        .zip(option.shared(&counts)?)
        .map(|(motion, half_turns)| motion.turning(&half_turns))
        .collect::<Result<Vec<Motion>, MotionError>>()?;
    Ok(Motions {
        body: decided.remove(0),
        others: paths.into_iter().zip(decided).collect(),
    })
}

/// Why a check was refused, with the file of the obstacle.
fn with_file(error: CheckError, files: &[ObstacleFiles]) -> Box<dyn Error> {
    match error {
        CheckError::Depth { obstacle, .. } | CheckError::Stretched { obstacle } => {
            format!("{}: {error}", files[obstacle].mesh.display()).into()
        }
        _ => error.into(),
    }
}

/// Times on the clock at which the distance is listed: evenly spaced ones, the joints, and those of
/// the report.
fn times(motion: &Motion, found: &Check) -> Vec<f64> {
    let joints = motion.joint_times();
    let (start, end) = (joints[0], joints[joints.len() - 1]);
    let even = (0..=DISTANCES).map(|i| {
        let fraction = f64::from(i) / f64::from(DISTANCES);
        start + fraction * (end - start)
    });
    let first = match found.verdict {
        Verdict::Contact(first) | Verdict::Closer(first) => Some(first.time),
        Verdict::Clear | Verdict::Undecided { .. } => None,
    };
    let mut times: Vec<f64> = even
        .chain(joints.iter().copied())
        .chain(first)
        .chain(Some(found.clearance.time).filter(|_| found.clearance.upper.is_finite()))
        .chain(
            found
                .intervals
                .iter()
                .flatten()
                .flat_map(|interval| interval.times),
        )
        .map(|time| time.clamp(start, end))
        .collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

fn name_of(stage: CheckStage) -> &'static str {
    match stage {
        CheckStage::Prepare => "prepare",
        CheckStage::Contact => "contact",
        CheckStage::Clearance => "clearance",
        CheckStage::Intervals => "intervals",
    }
}
