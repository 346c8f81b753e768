//! The run of `sweep`: read, sweep, and write the solid, or in the plane the region.

use std::error::Error;
use std::path::Path;

use glam::DVec2;
use steadysweep::io::{self, DrawingSettings, MeshFormat, RegionPicture, VerticalAxis};
use steadysweep::motion::planar::{Motion, magnification};
use steadysweep::report::{
    BodyReport, MotionSummary, PlanarBodyReport, PlanarSweepReport, RegionReport, SolidReport,
    SweepReport,
};
use steadysweep::{Precision, Stage, SweepSettings, planar};

use super::cli::SweepOptions;
use super::progress::Progress;

/// Poses in the picture of a region, those at the start and at the end included: the way is clear, and bodies that overlap do not
/// yet hide each other.
const POSES: u32 = 9;

/// Distance allowed between the curves of a drawing and the edges in their place, as a share of the tolerance of the sweep.
const FLATTENING_SHARE: f64 = 0.1;

/// Sweeps a body in space.
pub(crate) fn sweep(
    options: &SweepOptions,
    progress: &Progress,
) -> Result<SweepReport, Box<dyn Error>> {
    options.drawing.none_for(&options.body)?;
    let output = options.output.as_deref();
    let precision = match output.map(io::check_output).transpose()? {
        Some(MeshFormat::Stl) => Precision::Single,
        _ => Precision::Double,
    };
    let settings = SweepSettings {
        tolerance: options.tolerance,
        precision,
    };
    progress.stage("read");
    let motion = super::motion_of(&options.motion)?;
    let (body, read) = io::read_body(&options.body)?;
    let swept = steadysweep::sweep(&body, &motion, &settings, &|stage| {
        progress.stage(name_of(stage))
    })?;
    if let Some(output) = output {
        progress.stage("write");
        io::write_mesh(output, swept.solid.positions(), swept.solid.triangles())?;
    }
    Ok(SweepReport {
        body: BodyReport::new(&body, &read),
        motion: MotionSummary {
            spans: motion.spans().len(),
        },
        sweep: SolidReport::new(&swept),
        seconds: progress.seconds(),
    })
}

/// Sweeps the outlines of a drawing.
pub(crate) fn planar_sweep(
    options: &SweepOptions,
    progress: &Progress,
) -> Result<PlanarSweepReport, Box<dyn Error>> {
    let output = options.output.as_deref();
    let rounding = output
        .map(io::check_region_output)
        .transpose()?
        .map_or(0.0, |format| format.rounding());
    progress.stage("read");
    let motion = super::planar_motion_of(&options.motion)?;
    let largest = magnification(&motion);
    let settings = DrawingSettings {
        // The body is drawn in its own frame, the tolerance holds in the world.
        flattening: options
            .tolerance
            .map(|tolerance| FLATTENING_SHARE * tolerance / largest),
        ..options.drawing.settings()
    };
    let drawing = io::read_drawing(&options.body, &settings)?;
    let settings = planar::SweepSettings {
        tolerance: options.tolerance,
    };
    let swept = planar::sweep(&drawing.polygon, &motion, &settings, &|stage| {
        progress.stage(name_of(stage))
    })?;
    if let Some(output) = output {
        progress.stage("write");
        write(output, &drawing, &motion, &swept)?;
    }
    Ok(PlanarSweepReport {
        body: PlanarBodyReport::new(&drawing),
        motion: MotionSummary {
            spans: motion.spans().len(),
        },
        sweep: RegionReport::new(
            &swept.measures,
            &swept.error_bound,
            rounding,
            drawing.flattening * largest,
        ),
        seconds: progress.seconds(),
    })
}

fn write(
    output: &Path,
    drawing: &io::Drawing,
    motion: &Motion,
    swept: &planar::Sweep,
) -> Result<(), io::OutputError> {
    let picture = RegionPicture {
        region: swept.loops().collect(),
        poses: poses(drawing, motion),
        paths: swept.paths.clone(),
        vertical: VerticalAxis::of(drawing.format),
        unit: drawing.unit,
    };
    io::write_region(output, &picture)
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
