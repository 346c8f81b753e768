//! The command line of steadysweep: parse, call, report. The only place that prints and exits.

mod checking;
mod cli;
mod progress;
mod sweeping;

use std::error::Error;
use std::fmt::Display;
use std::io::{ErrorKind, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::{ExitCode, exit};

use clap::Parser;
use serde::Serialize;
use steadysweep::Fault;
use steadysweep::io::{self, AnyMotion, Dimension};
use steadysweep::membership::{Membership, planar};
use steadysweep::motion::{self, HalfTurns, Motion, Sense};
use steadysweep::report::{
    MotionReport, MotionSummary, PlanarMotionReport, ProbeReport, VerdictReport,
};

use cli::{
    CheckOptions, Command, DescribeOptions, HalfTurnOption, MotionOptions, MotionSource, Options,
    ProbeOptions, SweepOptions,
};
use progress::Progress;

/// Exit code of contact, and of coming closer than the clearance.
const CONTACT: u8 = 1;

/// Exit code of bad input and of an undecided check; clap uses the same one for bad usage.
const BAD_INPUT: u8 = 2;

/// Exit code after Ctrl-C: 128 and the number of the signal.
const INTERRUPTED: i32 = 130;

fn main() -> ExitCode {
    let options = Options::parse();
    let progress = Progress::new(options.quiet, stages(&options.command));
    let report = guarded(|| run(&options, &progress));
    progress.eraser()();
    let printed = report.and_then(|(text, code)| {
        print(&text).map_err(|error| unprinted(&error, &options.command))?;
        Ok(code)
    });
    match printed {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(BAD_INPUT)
        }
    }
}

/// What a run returns, or the fault of the library that it ended in by a panic: its place is on standard error by then, and no
/// unfinished file stays.
fn guarded<T>(run: impl FnOnce() -> Result<T, Box<dyn Error>>) -> Result<T, Box<dyn Error>> {
    catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|_| {
        io::replace::remove_unfinished();
        let broken = "it panicked as told above";
        Err(Fault { broken }.into())
    })
}

/// Runs the command; its report, ready to be printed, and the exit code.
fn run(options: &Options, progress: &Progress) -> Result<(String, ExitCode), Box<dyn Error>> {
    stop_on_interrupt(progress)?;
    if let Some(threads) = options.threads {
        rayon::ThreadPoolBuilder::new()
            .num_threads(usize::from(threads))
            .build_global()?;
    }
    let mut code = ExitCode::SUCCESS;
    let text = match &options.command {
        Command::Sweep(options) if io::drawing_format(&options.body).is_some() => {
            written(&sweeping::planar_sweep(options, progress)?, options.json)?
        }
        Command::Sweep(options) => written(&sweeping::sweep(options, progress)?, options.json)?,
        Command::Check(options) => {
            let report = checking::check(options, progress)?;
            code = code_of(report.verdict);
            written(&report, options.json)?
        }
        Command::Probe(options) => written(&probe(options, progress)?, options.json)?,
        Command::Motion(options) => describe(options)?,
    };
    Ok((text, code))
}

/// Number of stages that the command tells its progress of.
fn stages(command: &Command) -> u64 {
    match command {
        // Reading, the stages of the kernel, subtracting, and writing.
        Command::Sweep(options) => {
            4 + u64::from(options.output.is_some()) + u64::from(options.subtract_from.is_some())
        }
        // Reading, preparing, and the search for contact; for the least distance, or for all times; and writing.
        Command::Check(options) => {
            4 + u64::from(options.intervals) + u64::from(options.csv.is_some())
        }
        Command::Probe(_) => 2,
        Command::Motion(_) => 0,
    }
}

fn code_of(verdict: VerdictReport) -> ExitCode {
    match verdict {
        VerdictReport::Clear => ExitCode::SUCCESS,
        VerdictReport::Contact | VerdictReport::Closer => ExitCode::from(CONTACT),
        VerdictReport::Undecided => ExitCode::from(BAD_INPUT),
    }
}

fn probe(options: &ProbeOptions, progress: &Progress) -> Result<ProbeReport, Box<dyn Error>> {
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
    let intervals = membership.intervals_of(&points);
    Ok(ProbeReport::new(
        intervals,
        MotionSummary::from(&motion),
        None,
        progress.seconds(),
    ))
}

fn planar_probe(
    options: &ProbeOptions,
    progress: &Progress,
) -> Result<ProbeReport, Box<dyn Error>> {
    progress.stage("read");
    let motion = planar_motion_of(&options.motion)?;
    let drawing = io::read_drawing(&options.body, &options.drawing.settings())?;
    let points = io::read_planar_points(&options.points)?;
    progress.stage("probe");
    let membership = planar::Membership::new(&drawing.polygon, &motion);
    let intervals = membership.intervals_of(&points);
    Ok(ProbeReport::new(
        intervals,
        MotionSummary::from(&motion),
        Some(drawing.flattening),
        progress.seconds(),
    ))
}

/// The motion of the options, described: in the plane where the options or the motion file say so.
fn describe(options: &DescribeOptions) -> Result<String, Box<dyn Error>> {
    let motion = &options.motion;
    let described = match motion.dimension() {
        Dimension::Plane => AnyMotion::Plane(planar_motion_of(motion)?),
        Dimension::Space => match motion.source()? {
            MotionSource::File(path) => described(
                io::read_any_motion(&path, &HalfTurns::All(Sense::Positive))?,
                &motion.half_turn,
            )?,
            MotionSource::Span(_) => AnyMotion::Space(motion_of(motion)?),
        },
    };
    Ok(match described {
        AnyMotion::Plane(motion) => written(&PlanarMotionReport::new(&motion), options.json)?,
        AnyMotion::Space(motion) => written(&MotionReport::new(&motion), options.json)?,
    })
}

/// A motion that shows half turns in the sense `+`, with the senses of the option if they are given.
fn described(motion: AnyMotion, option: &HalfTurnOption) -> Result<AnyMotion, Box<dyn Error>> {
    if option.is_none() {
        return Ok(motion);
    }
    Ok(match motion {
        AnyMotion::Plane(motion) => {
            let half_turns = option.of_one(motion.half_turns())?;
            AnyMotion::Plane(motion.turning(&half_turns)?)
        }
        AnyMotion::Space(motion) => {
            let half_turns = option.of_one(motion.half_turns())?;
            AnyMotion::Space(motion.turning(&half_turns)?)
        }
    })
}

/// The motion in the plane that the options give or name.
fn planar_motion_of(options: &MotionOptions) -> Result<motion::planar::Motion, Box<dyn Error>> {
    let option = &options.half_turn;
    let motion = match options.planar_source()? {
        MotionSource::File(path) => io::read_planar_motion_turning(&path, &option.while_reading())?,
        MotionSource::Span(generator) => cli::planar_single_span(generator)?,
    };
    let half_turns = option.of_one(motion.half_turns())?;
    Ok(motion.turning(&half_turns)?)
}

/// The motion that the options give or name.
fn motion_of(options: &MotionOptions) -> Result<Motion, Box<dyn Error>> {
    let motion = undecided_motion_of(options)?;
    let half_turns = options.half_turn.of_one(motion.half_turns())?;
    Ok(motion.turning(&half_turns)?)
}

/// The motion that the options give or name, before senses are shared out among its half turns and those of other motions.
fn undecided_motion_of(options: &MotionOptions) -> Result<Motion, Box<dyn Error>> {
    match options.source()? {
        MotionSource::File(path) => {
            let half_turns = options.half_turn.while_reading();
            Ok(io::read_motion_turning(&path, &half_turns)?)
        }
        MotionSource::Span(generator) => Ok(cli::single_span(generator)?),
    }
}

/// What a failure of the standard output means. The solid, drawing or table, if one was asked for, is in its file by then; it took
/// the work and is whole, so it stays.
fn unprinted(error: &std::io::Error, command: &Command) -> Box<dyn Error> {
    let kept = match command {
        Command::Sweep(SweepOptions {
            body,
            output: Some(output),
            ..
        }) => {
            let what = io::drawing_format(body).map_or("solid", |_| "drawing");
            format!("; the {what} is complete in {}", output.display())
        }
        Command::Check(CheckOptions { csv: Some(csv), .. }) => {
            format!("; the table is complete in {}", csv.display())
        }
        _ => String::new(),
    };
    format!("the report could not be written to the standard output: {error}{kept}").into()
}

/// On Ctrl-C: removes the unfinished file and exits at once, whatever the threads are doing.
fn stop_on_interrupt(progress: &Progress) -> Result<(), ctrlc::Error> {
    let erase = progress.eraser();
    ctrlc::set_handler(move || {
        io::replace::remove_unfinished();
        erase();
        exit(INTERRUPTED);
    })
}

/// A report as text, or as one JSON object on a line of its own.
fn written(report: &(impl Display + Serialize), json: bool) -> Result<String, serde_json::Error> {
    if json {
        Ok(serde_json::to_string(report)? + "\n")
    } else {
        Ok(report.to_string())
    }
}

/// Prints to the standard output. A reader that stops early (`| head`) has what it wants: no error.
fn print(text: &str) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_a_fault_of_the_library_by_name() {
        let panicked = guarded(|| -> Result<(), Box<dyn Error>> { panic!("a test") });
        let message = panicked.expect_err("a fault").to_string();
        assert!(
            message.starts_with("fault of the library: it panicked") && message.contains("report"),
            "{message}"
        );
    }
}
