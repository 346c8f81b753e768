//! The run of `sweep`: read, sweep, and write the solid, or in the plane the region.

use std::error::Error;
use std::path::Path;

use glam::{DVec2, DVec3};

use super::dump::Dump;
use super::interrupt;
use super::motions::{alone, follow, given_motion_of, given_planar_motion_of};
use super::options::{NoDrawing, SimplifyOption, SweepOptions};
use super::planar_subject::PlanarSubject;
use super::progress::StageProgress;
use super::report::{
    BodyReport, CutReport, MotionSummary, PlanarSweepReport, RegionReport, SolidReport,
    SubjectReport, SurfaceReport, SweepReport,
};
use super::{envelope_file, grazing_file};
use crate::body::ThickenError;
use crate::bounds::box_corners;
use crate::envelope;
use crate::envelope::planar::PlanarBudget;
use crate::envelope::spatial::{Budget, sampled_envelope};
use crate::io::{
    self, DeclaredUnit, DrawingSettings, FileNumbers, MeshFormat, RegionFormat, RegionPicture,
    RegionSubject, VerticalAxis,
};
use crate::motion::planar::{Motion, magnification};
use crate::numeric::tolerance::DEFAULT_TOLERANCE;
use crate::solid::planar::subtract;
use crate::{Inspection, Precision, Simplify, Stage, SurfaceSweepError, SweepSettings, planar};

/// Number of poses in the picture of a region, including those at the start and at the end: they
/// show the path, and bodies that overlap do not yet hide each other.
const POSES: u32 = 9;

/// Distance allowed between the curves of a drawing and the edges that replace them, as a share of
/// the tolerance of the sweep.
const FLATTENING_SHARE: f64 = 0.1;

/// Sweeps a body in space.
pub(crate) fn sweep(
    options: &SweepOptions,
    progress: &StageProgress,
) -> Result<SweepReport, Box<dyn Error>> {
    options.drawing.none_for(&options.body)?;
    NoDrawing::unless(
        options.subtract_from.is_none(),
        "--subtract-from",
        &options.body,
    )?;
    check_surface(options)?;
    distinct_files(options)?;
    if let Some(path) = &options.grazing {
        grazing_file::check(path)?;
    }
    if let Some(path) = &options.envelope {
        envelope_file::check(path)?;
    }
    let output = options.output.as_deref();
    let precision = match output.map(io::check_output).transpose()? {
        Some(MeshFormat::Stl) => Precision::Single,
        _ => Precision::Double,
    };
    let tell = |stage, _| progress.stage(name_of(stage));
    let settings = SweepSettings::default()
        .with_tolerance(options.tolerance)
        .with_precision(precision)
        .with_simplify(match options.simplify {
            Some(SimplifyOption::Off) => Simplify::Off,
            Some(SimplifyOption::On) | None => Simplify::WithinTolerance,
        })
        .with_observer(&tell)
        .with_interrupt(interrupt::flag());
    progress.stage("read");
    let given = given_motion_of(&options.motion)?;
    if options.surface {
        let (surface, read) = io::read_surface(&options.body)?;
        let [low, high] = surface.bounds();
        let diagonal = low.distance(high);
        // Room for the plate that stands for the surface.
        let room = DVec3::splat(options.tolerance.unwrap_or(DEFAULT_TOLERANCE * diagonal));
        let corners = box_corners([low - room, high + room]);
        let follow = follow(&corners, diagonal, options.tolerance);
        let motion = alone(given, &options.motion.half_turn, &follow)?;
        let swept = crate::sweep_surface(&surface, &motion, &settings).map_err(|error| {
            let path = options.body.display();
            format!("{path}: {}", in_file(error, &read.numbers))
        })?;
        if let Some(output) = output {
            progress.stage("write");
            io::write_mesh(output, swept.solid.positions(), swept.solid.triangles())?;
        }
        return Ok(SweepReport {
            body: SubjectReport::Surface(SurfaceReport::new(&surface, &read)),
            motion: MotionSummary::from(&motion),
            sweep: SolidReport::new(&swept),
            seconds: progress.seconds(),
        });
    }
    let (body, read) = io::read_body(&options.body)?;
    let follow = follow(body.positions(), body.diagonal(), options.tolerance);
    let motion = alone(given, &options.motion.half_turn, &follow)?;
    let dump = options.dump.as_deref().map(Dump::new).transpose()?;
    let show = |stage: Inspection| dump.iter().for_each(|dump| dump.write(stage));
    let settings = match &dump {
        Some(_) => settings.with_inspector(&show).with_sources(),
        None => settings,
    };
    let swept = crate::sweep(&body, &motion, &settings);
    // What was written before a failure is there, too.
    if let Some(dump) = &dump {
        dump.check()?;
    }
    let swept = swept?;
    let budget = Budget::of(swept.tolerance);
    let envelope = options.envelope.as_deref().map(|path| {
        sampled_envelope(&body, &motion, &budget)
            .map(|envelope| (path, envelope))
            .map_err(|error| format!("{}: {error}", path.display()))
    });
    let envelope = envelope.transpose()?;
    if output.is_some() || options.grazing.is_some() || envelope.is_some() {
        progress.stage("write");
    }
    if let Some(output) = output {
        io::write_mesh(output, swept.solid.positions(), swept.solid.triangles())?;
    }
    if let Some(path) = &options.grazing {
        grazing_file::write(path, &body, &read.numbers, &motion)?;
    }
    if let Some((path, envelope)) = envelope {
        envelope_file::write(path, &envelope)?;
    }
    Ok(SweepReport {
        body: SubjectReport::Body(BodyReport::new(&body, &read)),
        motion: MotionSummary::from(&motion),
        sweep: SolidReport::new(&swept),
        seconds: progress.seconds(),
    })
}

/// Sweeps the outlines of a drawing.
pub(crate) fn planar_sweep(
    options: &SweepOptions,
    progress: &StageProgress,
) -> Result<PlanarSweepReport, Box<dyn Error>> {
    if options.dump.is_some() {
        let body = options.body.display();
        return Err(format!(
            "--dump writes the stages of a sweep in space, but the body is a drawing, {body}: leave it out"
        )
        .into());
    }
    if options.simplify.is_some() {
        let body = options.body.display();
        return Err(format!(
            "--simplify is for triangles of a sweep in space, but the body is a drawing, {body}: leave it out"
        )
        .into());
    }
    check_surface(options)?;
    distinct_files(options)?;
    if let Some(path) = &options.grazing {
        grazing_file::check(path)?;
    }
    if let Some(path) = &options.envelope {
        envelope_file::check_planar(path)?;
    }
    let output = options.output.as_deref();
    let rounding = output
        .map(io::check_region_output)
        .transpose()?
        .map_or(0.0, |format| format.rounding());
    progress.stage("read");
    let given = given_planar_motion_of(&options.motion)?;
    let corners = if given.is_followed() {
        PlanarSubject::read(options, &options.drawing.settings())?.room()
    } else {
        Vec::new()
    };
    let diagonal = match corners[..] {
        [low, high, ..] => low.distance(high),
        _ => 1.0,
    };
    let follow = follow(&corners, diagonal, options.tolerance);
    let motion = alone(given, &options.motion.half_turn, &follow)?;
    let largest = magnification(&motion);
    let settings = DrawingSettings {
        // The body is drawn in its own frame, while the tolerance holds in the world.
        flattening: options
            .tolerance
            .map(|tolerance| FLATTENING_SHARE * tolerance / largest),
        ..options.drawing.settings()
    };
    let subject = PlanarSubject::read(options, &settings)?;
    let blank = options
        .subtract_from
        .as_deref()
        .map(|path| read_blank(path, options, subject.declared()))
        .transpose()?;
    let tell = |stage, _| progress.stage(name_of(stage));
    let settings = planar::SweepSettings::default()
        .with_tolerance(options.tolerance)
        .with_observer(&tell)
        .with_interrupt(interrupt::flag());
    let swept = subject.sweep(&motion, &settings)?;
    let left = blank
        .as_ref()
        .map(|blank| {
            progress.stage("subtract");
            subtract(&blank.polygon, &swept.loops().collect::<Vec<_>>())
        })
        .transpose()?;
    let region = left.as_ref().unwrap_or(&swept.arrangement);
    let outlines = region.outlines();
    let cut = blank
        .as_ref()
        .map(|blank| CutReport::new(blank, &region.measures(&outlines)));
    let budget = PlanarBudget::of(swept.tolerance);
    let body = match &subject {
        PlanarSubject::Body(drawing) => Some(&drawing.polygon),
        PlanarSubject::Lines(_) => None,
    };
    let envelope = options.envelope.as_deref().zip(body).map(|(path, body)| {
        envelope::planar::sampled_envelope(body, &motion, &budget)
            .map(|curves| (path, curves))
            .map_err(|error| format!("{}: {error}", path.display()))
    });
    let envelope = envelope.transpose()?;
    if output.is_some() || options.grazing.is_some() || envelope.is_some() {
        progress.stage("write");
    }
    let place = |&corner: &u32| region.positions()[corner as usize];
    let picture = RegionPicture {
        region: outlines
            .loops()
            .map(|outline| outline.vertices.iter().map(place).collect())
            .collect(),
        subject: match blank {
            None => RegionSubject::Swept,
            Some(_) => RegionSubject::Left,
        },
        poses: poses(&subject.loops(), &motion),
        paths: swept.paths.clone(),
        vertical: VerticalAxis::of(subject.format()),
        unit: subject.unit(),
    };
    match output.map(io::check_region_output).transpose()?.zip(output) {
        Some((RegionFormat::Triangles, output)) => {
            let found = region.region_triangles(&outlines)?;
            io::write_region_triangles(output, &found.positions, &found.triangles)?;
        }
        Some((_, output)) => io::write_region(output, &picture)?,
        None => {}
    }
    if let Some((path, body)) = options.grazing.as_deref().zip(body) {
        grazing_file::write_planar(path, body, &motion)?;
    }
    if let Some((path, curves)) = envelope {
        envelope_file::write_planar(path, &curves, &motion, picture)?;
    }
    Ok(PlanarSweepReport {
        body: subject.report(),
        motion: MotionSummary::from(&motion),
        sweep: RegionReport::new(&swept, rounding, subject.flattening() * largest),
        cut,
        seconds: progress.seconds(),
    })
}

/// Refuses one file for two results.
fn distinct_files(options: &SweepOptions) -> Result<(), String> {
    let named = [
        ("-o", &options.output),
        ("--grazing", &options.grazing),
        ("--envelope", &options.envelope),
    ];
    let named: Vec<_> = named
        .iter()
        .filter_map(|(name, path)| path.as_deref().map(|path| (name, path)))
        .collect();
    for (place, (name, path)) in named.iter().enumerate() {
        if let Some((other, _)) = named[..place].iter().find(|(_, other)| other == path) {
            let path = path.display();
            return Err(format!(
                "{path}: {other} and {name} name the same file; give each its own"
            ));
        }
    }
    Ok(())
}

/// The error with the numbers of the file.
fn in_file(error: SurfaceSweepError, numbers: &FileNumbers) -> SurfaceSweepError {
    let SurfaceSweepError::Thicken(error) = error else {
        return error;
    };
    SurfaceSweepError::Thicken(match error {
        ThickenError::Edge {
            vertices,
            triangles,
        } => ThickenError::Edge {
            vertices: vertices.map(|v| numbers.vertex(v)),
            triangles: triangles.map(|t| numbers.face(t)),
        },
        ThickenError::NoArea { triangle } => ThickenError::NoArea {
            triangle: numbers.face(triangle),
        },
        ThickenError::TooSharp {
            triangle,
            place,
            thickness,
        } => ThickenError::TooSharp {
            triangle: numbers.face(triangle),
            place,
            thickness,
        },
        other => other,
    })
}

/// Refuses what is meant for bodies with an inside.
fn check_surface(options: &SweepOptions) -> Result<(), String> {
    if !options.surface {
        return Ok(());
    }
    let given = [
        (
            "--close-gaps",
            options.drawing.settings().close_gaps.is_some(),
        ),
        ("--grazing", options.grazing.is_some()),
        ("--envelope", options.envelope.is_some()),
        ("--dump", options.dump.is_some()),
    ];
    match given.iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => Err(format!(
            "{option} is for a body, but --surface takes {} without an inside: leave one of them out",
            options.body.display()
        )),
        None => Ok(()),
    }
}

/// Reads the blank, which must be in the unit of the body as far as the files tell.
fn read_blank(
    path: &Path,
    options: &SweepOptions,
    declared: Option<DeclaredUnit>,
) -> Result<io::Drawing, Box<dyn Error>> {
    let settings = DrawingSettings {
        flattening: options
            .tolerance
            .map(|tolerance| FLATTENING_SHARE * tolerance),
        ..options.drawing.settings()
    };
    let mut blank = io::read_drawing(path, &settings)?;
    // With --units, both are in that unit.
    let [of_blank, of_body] =
        [blank.declared, declared].map(|declared| match options.drawing.unit() {
            Some(unit) => Some(DeclaredUnit { unit, factor: 1.0 }),
            None => declared,
        });
    match (of_blank, of_body) {
        (Some(of_blank), Some(of_body)) if of_blank != of_body => {
            let unit = of_body.unit;
            return Err(format!(
                "{}: the blank is in {of_blank}, the body in {of_body}: add --units {unit} to bring them together",
                path.display()
            )
            .into());
        }
        (None, Some(unit)) => blank
            .notes
            .push(format!("the blank is taken to be in {unit}, as the body")),
        (Some(unit), None) => blank
            .notes
            .push(format!("the body is taken to be in {unit}, as the blank")),
        _ => {}
    }
    Ok(blank)
}

/// Loops of the body at some times, evenly spaced from start to end.
fn poses(loops: &[Vec<DVec2>], motion: &Motion) -> Vec<Vec<Vec<DVec2>>> {
    let times = motion.joint_times();
    let (start, end) = (times[0], times[times.len() - 1]);
    (0..POSES)
        .map(|i| start + (end - start) * f64::from(i) / f64::from(POSES - 1))
        .map(|time| {
            let pose = motion.pose_at_time(time);
            let place = |&corner: &DVec2| pose.transform_point2(corner);
            loops
                .iter()
                .map(|outline| outline.iter().map(place).collect())
                .collect()
        })
        .collect()
}

fn name_of(stage: Stage) -> &'static str {
    match stage {
        Stage::Cycle => "cycle",
        Stage::Arrangement => "arrangement",
        Stage::Boundary => "boundary",
    }
}
