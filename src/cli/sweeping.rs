//! The run of `sweep`: read, sweep, and write the solid, or in the plane the region.

use std::error::Error;
use std::path::Path;

use glam::DVec2;

use super::dump::Dump;
use super::interrupt;
use super::motions::{motion_of, planar_motion_of};
use super::options::{NoDrawing, SimplifyOption, SweepOptions};
use super::progress::StageProgress;
use super::report::{
    BodyReport, CutReport, MotionSummary, PlanarBodyReport, PlanarSweepReport, RegionReport,
    SolidReport, SweepReport,
};
use crate::io::{
    self, DeclaredUnit, DrawingSettings, MeshFormat, RegionPicture, RegionSubject, VerticalAxis,
};
use crate::motion::planar::{Motion, magnification};
use crate::solid::planar::subtract;
use crate::{Inspection, Precision, Simplify, Stage, SweepSettings, planar};

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
    let motion = motion_of(&options.motion)?;
    let (body, read) = io::read_body(&options.body)?;
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
    if let Some(output) = output {
        progress.stage("write");
        io::write_mesh(output, swept.solid.positions(), swept.solid.triangles())?;
    }
    Ok(SweepReport {
        body: BodyReport::new(&body, &read),
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
    let output = options.output.as_deref();
    let rounding = output
        .map(io::check_region_output)
        .transpose()?
        .map_or(0.0, |format| format.rounding());
    progress.stage("read");
    let motion = planar_motion_of(&options.motion)?;
    let largest = magnification(&motion);
    let settings = DrawingSettings {
        // The body is drawn in its own frame, while the tolerance holds in the world.
        flattening: options
            .tolerance
            .map(|tolerance| FLATTENING_SHARE * tolerance / largest),
        ..options.drawing.settings()
    };
    let drawing = io::read_drawing(&options.body, &settings)?;
    let blank = options
        .subtract_from
        .as_deref()
        .map(|path| read_blank(path, options, &drawing))
        .transpose()?;
    let tell = |stage, _| progress.stage(name_of(stage));
    let settings = planar::SweepSettings::default()
        .with_tolerance(options.tolerance)
        .with_observer(&tell)
        .with_interrupt(interrupt::flag());
    let swept = planar::sweep(&drawing.polygon, &motion, &settings)?;
    let mut region: Vec<Vec<DVec2>> = swept.loops().collect();
    let mut cut = None;
    if let Some(blank) = &blank {
        progress.stage("subtract");
        let left = subtract(&blank.polygon, &region)?;
        let outlines = left.outlines();
        cut = Some(CutReport::new(blank, &left.measures(&outlines)));
        let place = |&corner: &u32| left.positions()[corner as usize];
        region = outlines
            .loops()
            .map(|outline| outline.vertices.iter().map(place).collect())
            .collect();
    }
    if let Some(output) = output {
        progress.stage("write");
        let picture = RegionPicture {
            region,
            subject: match blank {
                None => RegionSubject::Swept,
                Some(_) => RegionSubject::Left,
            },
            poses: poses(&drawing, &motion),
            paths: swept.paths.clone(),
            vertical: VerticalAxis::of(drawing.format),
            unit: drawing.unit,
        };
        io::write_region(output, &picture)?;
    }
    Ok(PlanarSweepReport {
        body: PlanarBodyReport::new(&drawing),
        motion: MotionSummary::from(&motion),
        sweep: RegionReport::new(&swept, rounding, drawing.flattening * largest),
        cut,
        seconds: progress.seconds(),
    })
}

/// Reads the blank, which must be in the unit of the body as far as the files tell.
fn read_blank(
    path: &Path,
    options: &SweepOptions,
    body: &io::Drawing,
) -> Result<io::Drawing, Box<dyn Error>> {
    let settings = DrawingSettings {
        flattening: options
            .tolerance
            .map(|tolerance| FLATTENING_SHARE * tolerance),
        ..options.drawing.settings()
    };
    let mut blank = io::read_drawing(path, &settings)?;
    // With --units, both are in that unit.
    let [of_blank, of_body] = [&blank, body].map(|drawing| match options.drawing.unit() {
        Some(unit) => Some(DeclaredUnit { unit, factor: 1.0 }),
        None => drawing.declared,
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

/// The loops of the body at some times, evenly spaced from start to end.
fn poses(drawing: &io::Drawing, motion: &Motion) -> Vec<Vec<Vec<DVec2>>> {
    let times = motion.joint_times();
    let (start, end) = (times[0], times[times.len() - 1]);
    let body = &drawing.polygon;
    (0..POSES)
        .map(|i| start + (end - start) * f64::from(i) / f64::from(POSES - 1))
        .map(|time| {
            let pose = motion.pose_at_time(time);
            let place = |&corner: &u32| pose.transform_point2(body.positions()[corner as usize]);
            body.loops()
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
