//! The run of `probe`: read, and find when points are inside the moving body.

use std::error::Error;

use super::interrupt;
use super::motions::{motion_of, planar_motion_of};
use super::options::ProbeOptions;
use super::progress::StageProgress;
use super::report::{MotionSummary, ProbeReport};
use crate::io;
use crate::membership::{Membership, ProbeSettings, planar};

/// Reads the files, and finds when each point is inside the moving body.
pub(crate) fn probe(
    options: &ProbeOptions,
    progress: &StageProgress,
) -> Result<ProbeReport, Box<dyn Error>> {
    if io::drawing_format(&options.body).is_some() {
        return planar_probe(options, progress);
    }
    options.drawing.none_for(&options.body)?;
    progress.stage("read");
    let motion = motion_of(&options.motion)?;
    let (body, _) = io::read_body(&options.body)?;
    let points = io::read_points(&options.points)?;
    progress.stage("probe");
    let membership = Membership::new(&body, &motion);
    let intervals = membership.probe(&points, &settings())?;
    Ok(ProbeReport::new(
        intervals,
        MotionSummary::from(&motion),
        None,
        progress.seconds(),
    ))
}

fn settings() -> ProbeSettings<'static> {
    ProbeSettings::default().with_interrupt(interrupt::flag())
}

fn planar_probe(
    options: &ProbeOptions,
    progress: &StageProgress,
) -> Result<ProbeReport, Box<dyn Error>> {
    progress.stage("read");
    let motion = planar_motion_of(&options.motion)?;
    let drawing = io::read_drawing(&options.body, &options.drawing.settings())?;
    let points = io::read_planar_points(&options.points)?;
    progress.stage("probe");
    let membership = planar::Membership::new(&drawing.polygon, &motion);
    let intervals = membership.probe(&points, &settings())?;
    Ok(ProbeReport::new(
        intervals,
        MotionSummary::from(&motion),
        Some(drawing.flattening),
        progress.seconds(),
    ))
}
