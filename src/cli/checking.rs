//! The run of `check`: read, check, and tabulate the distance over time.

use std::collections::HashMap;
use std::error::Error;
use std::path::Path;

use rayon::prelude::*;

use super::interrupt;
use super::motions::{GivenMotion, follow, given_motion_of};
use super::options::{CheckOptions, GivenObstacle, ObstacleSource};
use super::progress::StageProgress;
use super::report::{CheckReport, CheckedBody, CheckedObstacle, CheckedSolid, ObstacleMotion};
use crate::body::{Mesh, Surface};
use crate::collision::{
    self, Check, CheckError, CheckSettings, CheckStage, Closest, ContactRule, Plane, Shape,
    ShapeObstacle, Verdict,
};
use crate::io::{self, ReadReport};
use crate::motion::following::Follow;
use crate::motion::{Flow, Motion};
use glam::DVec3;

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
    let given = options.obstacles.given()?;
    let rules = options.rules(&given)?;
    progress.stage("read");
    let written = written_motions(options, &given)?;
    let (body, body_read) = io::read_body(&options.body)?;
    let mut solids = Vec::with_capacity(given.len());
    for obstacle in &given {
        solids.push(match &obstacle.source {
            ObstacleSource::File(file) if is_table(file) => {
                let points = io::read_points(file)?;
                let cloud = Surface::of_points(points)
                    .map_err(|error| format!("{}: {error}", file.display()))?;
                Solid::Cloud(file, cloud)
            }
            ObstacleSource::File(file) => match io::read_surface(file)? {
                (cloud, ReadReport { faces: 0, .. }) => Solid::Cloud(file, cloud),
                (surface, read) => Solid::Mesh(file, surface, read),
            },
            ObstacleSource::Plane(number, plane) => Solid::Plane(*number, plane),
        });
    }
    let Motions {
        body: motion,
        others,
    } = motions(written, options, &body, &given, &solids)?;
    let motion_of = |given: &GivenObstacle| given.motion.as_deref().map(|path| &others[path]);
    progress.stage(name_of(CheckStage::Prepare));
    let shape = Shape::from(&body);
    let shapes: Vec<Shape> = solids
        .iter()
        .map(|solid| match solid {
            Solid::Mesh(_, surface, _) | Solid::Cloud(_, surface) => Shape::new(surface),
            Solid::Plane(_, plane) => Shape::half_space(plane),
        })
        .collect();
    let obstacles: Vec<ShapeObstacle<'_>> = shapes
        .iter()
        .zip(&given)
        .map(|(shape, given)| ShapeObstacle {
            shape,
            motion: motion_of(given),
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
        .map_err(|error| with_name(error, &given))?;
    if let Some(csv) = &options.csv {
        progress.stage("distance");
        let distance_at =
            |&time: &f64| collision::distance_at(&shape, &motion, &obstacles, &rules, time);
        let times = times(&motion, &found);
        let distances: Vec<Closest> = times.par_iter().map(distance_at).collect();
        // Obstacles that may be touched are in the table, but the body keeps no clearance from
        // them.
        let is_kept = |closest: &Closest| rules.get(closest.obstacle) == Some(&ContactRule::Touch);
        // The distances are those of the spans: the true ones may be larger by the deviations.
        let off = |motion: Option<&Motion>| {
            let deviation = motion.and_then(Motion::deviation);
            deviation.map_or(0.0, |deviation| deviation.length)
        };
        for (&time, closest) in times.iter().zip(&distances) {
            if is_kept(closest) {
                let theirs = off(obstacles[closest.obstacle].motion);
                let seen = Closest {
                    distance: closest.distance + off(Some(&motion)) + theirs,
                    ..*closest
                };
                found.clearance.see(time, &seen);
            }
        }
        let rows = times.iter().zip(distances).map(|(&time, closest)| {
            let [p, q] = closest.points.map(|point| point.to_array());
            let numbers = [time, closest.distance, p[0], p[1], p[2], q[0], q[1], q[2]];
            // The form that reads back as the same number.
            let [time, distance, px, py, pz, qx, qy, qz] = numbers.map(|x| format!("{x:?}"));
            let name = given[closest.obstacle].source.to_string();
            [time, distance, name, px, py, pz, qx, qy, qz]
        });
        io::write_table(csv, DISTANCE_COLUMNS, rows)?;
    }
    let checked: Vec<CheckedObstacle<'_>> = given
        .iter()
        .zip(&solids)
        .zip(rules)
        .map(|((given, solid), rule)| CheckedObstacle {
            solid: match solid {
                Solid::Mesh(file, surface, read) => CheckedSolid::Mesh {
                    file,
                    surface,
                    read,
                },
                Solid::Cloud(file, cloud) => CheckedSolid::Cloud { file, cloud },
                Solid::Plane(number, plane) => CheckedSolid::Plane {
                    number: *number,
                    plane,
                },
            },
            motion: given
                .motion
                .as_deref()
                .zip(motion_of(given))
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

/// An obstacle as it was read.
enum Solid<'a> {
    Mesh(&'a Path, Surface, ReadReport),
    Cloud(&'a Path, Surface),
    Plane(usize, &'a Plane),
}

/// The motions of a check, with the senses of their half turns decided.
struct Motions<'a> {
    body: Motion,
    /// The motions of the obstacles, by file.
    others: HashMap<&'a Path, Motion>,
}

/// The motions of a check as they are given: of the body, and of obstacles by file.
type GivenMotions<'a> = (GivenMotion<Flow>, Vec<(&'a Path, GivenMotion<Flow>)>);

/// Reads each file once.
fn written_motions<'a>(
    options: &CheckOptions,
    given: &'a [GivenObstacle],
) -> Result<GivenMotions<'a>, Box<dyn Error>> {
    let body = given_motion_of(&options.motion)?;
    let mut others: Vec<(&Path, GivenMotion<Flow>)> = Vec::new();
    for path in given.iter().filter_map(|given| given.motion.as_deref()) {
        if others.iter().all(|(known, _)| *known != path) {
            let half_turns = options.motion.half_turn.while_reading();
            let file = io::read_motion_file(path, &half_turns)?;
            others.push((path, GivenMotion::File(Box::new(file))));
        }
    }
    Ok((body, others))
}

/// The motions, with the senses of half turns in the order of the command line, over the body and
/// over the obstacles that move.
fn motions<'a>(
    (own, others): GivenMotions<'a>,
    options: &CheckOptions,
    body: &Mesh,
    given: &[GivenObstacle],
    solids: &[Solid],
) -> Result<Motions<'a>, Box<dyn Error>> {
    let mut counts = vec![own.half_turns()?];
    for (_, other) in &others {
        counts.push(other.half_turns()?);
    }
    let mut senses = options.motion.half_turn.shared(&counts)?.into_iter();
    let mut next = || senses.next().unwrap_or_default();
    // Obstacles are followed as closely as the body is.
    let close = follow(body.positions(), body.diagonal(), None);
    let own = own.over(&next(), &close)?;
    let mut moved = HashMap::new();
    for (path, other) in others {
        let with_motion = given.iter().zip(solids);
        let its = with_motion.filter(|(given, _)| given.motion.as_deref() == Some(path));
        let points: Vec<DVec3> = its
            .flat_map(|(_, solid)| match solid {
                Solid::Mesh(_, surface, _) | Solid::Cloud(_, surface) => surface.positions(),
                // A half-space has no end: no deviation holds for it.
                Solid::Plane(..) => &[],
            })
            .copied()
            .collect();
        let follow = Follow {
            body: &points,
            ..close
        };
        moved.insert(path, other.over(&next(), &follow)?);
    }
    Ok(Motions {
        body: own,
        others: moved,
    })
}

/// Whether a file is a list of points.
fn is_table(file: &Path) -> bool {
    file.extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("csv"))
}

/// Why a check was refused, with the name of the obstacle.
fn with_name(error: CheckError, given: &[GivenObstacle]) -> Box<dyn Error> {
    match error {
        CheckError::Depth { obstacle, .. }
        | CheckError::Stretched { obstacle }
        | CheckError::StretchedHalfSpace { obstacle } => {
            format!("{}: {error}", given[obstacle].source).into()
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
