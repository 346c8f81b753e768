//! The run of `probe`: read, and find when points are inside the moving body.

use std::error::Error;

use super::interrupt;
use super::motions::{alone, follow, given_motion_of, given_planar_motion_of};
use super::options::ProbeOptions;
use super::progress::StageProgress;
use super::report::{MotionSummary, ProbeReport};
use crate::io;
use crate::membership::{Membership, ProbeSettings, planar};
use rayon::prelude::*;

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
    let given = given_motion_of(&options.motion)?;
    let (body, _) = io::read_body(&options.body)?;
    let points = io::read_points(&options.points)?;
    let follow = follow(body.positions(), body.diagonal(), None);
    let motion = alone(given, &options.motion.half_turn, &follow)?;
    progress.stage("probe");
    let membership = Membership::new(&body, &motion);
    let intervals = membership.probe(&points, &settings())?;
    let certain =
        |(&point, times): (_, &Vec<[f64; 2]>)| membership.is_inside_for_certain(point, times);
    let inside = points.par_iter().zip(&intervals).map(certain).collect();
    Ok(ProbeReport::new(
        inside,
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
    let given = given_planar_motion_of(&options.motion)?;
    let drawing = io::read_drawing(&options.body, &options.drawing.settings())?;
    let points = io::read_planar_points(&options.points)?;
    let body = &drawing.polygon;
    let follow = follow(body.positions(), body.diagonal(), None);
    let motion = alone(given, &options.motion.half_turn, &follow)?;
    progress.stage("probe");
    let membership = planar::Membership::new(&drawing.polygon, &motion);
    let intervals = membership.probe(&points, &settings())?;
    let certain =
        |(&point, times): (_, &Vec<[f64; 2]>)| membership.is_inside_for_certain(point, times);
    let inside = points.par_iter().zip(&intervals).map(certain).collect();
    Ok(ProbeReport::new(
        inside,
        intervals,
        MotionSummary::from(&motion),
        Some(drawing.flattening),
        progress.seconds(),
    ))
}
