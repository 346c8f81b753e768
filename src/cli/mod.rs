//! The command line of steadysweep: parse, call, report. The only place that prints and exits.

mod checking;
mod dump;
mod elements;
mod envelope_file;
mod grazing_file;
mod interrupt;
mod motions;
mod options;
mod planar_subject;
mod probing;
mod progress;
mod report;
mod sweeping;

use std::error::Error;
use std::ffi::OsString;
use std::fmt::Display;
use std::io::{ErrorKind, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

use clap::Parser;
use serde::Serialize;

use crate::Fault;
use crate::io::{self, AnyMotion};
use options::{CheckOptions, Command, DescribeOptions, Options, SweepOptions};
use progress::StageProgress;
use report::{MotionReport, PlanarMotionReport, SteadinessReport, VerdictReport};

/// Stack of a thread that runs a command: the same as that of a main thread, since files nest
/// deeply.
const STACK: usize = 8 << 20;

/// Exit code when there is contact, or the body comes closer than the clearance.
const CONTACT: u8 = 1;

/// Exit code for bad input and for an undecided check; clap uses the same one for bad usage.
const BAD_INPUT: u8 = 2;

/// Runs the tool as the command line does; a process may do so several times, one after the other.
/// Ctrl-C ends the process.
///
/// - `arguments`: the name of the program, then its arguments.
///
/// The exit code: 0 done or clear, 1 contact or closer than the clearance, 2 bad input or
/// undecided, 130 interrupted.
pub fn run(arguments: impl IntoIterator<Item: Into<OsString> + Clone>) -> ExitCode {
    let options = match Options::try_parse_from(arguments) {
        Ok(options) => options,
        Err(usage) => return told(&usage),
    };
    let progress = StageProgress::new(options.quiet, stages(&options.command));
    let report = guarded(|| {
        interrupt::listen(progress.eraser())?;
        on_threads(options.threads, || {
            reported(&options, &progress).map_err(|error| error.to_string())
        })
    });
    if interrupt::is_asked_for() {
        return interrupt::obeyed();
    }
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

/// Prints what is wrong with the arguments, or the help or version for which they ask.
fn told(usage: &clap::Error) -> ExitCode {
    // Where neither stream can be written, nobody is left to report to.
    let _ = usage.print();
    if usage.use_stderr() {
        ExitCode::from(BAD_INPUT)
    } else {
        ExitCode::SUCCESS
    }
}

/// What a run returns, or a fault of the library if it panicked. By then the message of the panic
/// is on standard error, and the unfinished output file is removed.
fn guarded<T>(run: impl FnOnce() -> Result<T, Box<dyn Error>>) -> Result<T, Box<dyn Error>> {
    catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|_| {
        let broken = "it panicked as told above";
        Err(Fault { broken }.into())
    })
}

/// Runs on a pool of this many threads, made for this run; without a number on the caller's thread,
/// with the help of one thread per processor.
fn on_threads<T: Send>(
    threads: Option<u16>,
    run: impl FnOnce() -> Result<T, String> + Send,
) -> Result<T, Box<dyn Error>> {
    let ended = match threads {
        Some(threads) => rayon::ThreadPoolBuilder::new()
            .num_threads(usize::from(threads))
            .stack_size(STACK)
            .build()?
            .install(run),
        None => run(),
    };
    Ok(ended?)
}

/// Runs the command, and returns its report, ready to be printed, and the exit code.
fn reported(
    options: &Options,
    progress: &StageProgress,
) -> Result<(String, ExitCode), Box<dyn Error>> {
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
        Command::Probe(options) => written(&probing::probe(options, progress)?, options.json)?,
        Command::Motion(options) => {
            if let Some(output) = &options.output {
                io::check_table(output)?;
            }
            let motions::Described {
                motion,
                scheme,
                fitted,
                steadiness,
            } = motions::described(options)?;
            let steadiness = steadiness.as_ref().map(SteadinessReport::from);
            if let (Some(count), Some(output)) = (options.poses, &options.output) {
                motions::write_poses(&motion, count, output)?;
            }
            match motion {
                AnyMotion::Plane(motion) => written(
                    &PlanarMotionReport {
                        ara: steadiness,
                        ..PlanarMotionReport::new(&motion, scheme, &fitted)
                    },
                    options.json,
                )?,
                AnyMotion::Space(motion) => written(
                    &MotionReport {
                        ara: steadiness,
                        ..MotionReport::new(&motion, scheme, &fitted)
                    },
                    options.json,
                )?,
            }
        }
    };
    Ok((text, code))
}

/// Number of stages that the command reports as progress.
fn stages(command: &Command) -> u64 {
    match command {
        // Reading, the stages of the kernel, subtracting, and writing.
        Command::Sweep(options) => {
            4 + u64::from(options.output.is_some()) + u64::from(options.subtract_from.is_some())
        }
        // Reading, preparing, the search for contact, the search for the least distance or for all
        // times, and writing.
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

/// The error for a failure of the standard output. The solid, drawing or table that was asked for
/// is in its file by then: it is complete and was most of the work, so it stays.
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
        Command::Motion(DescribeOptions {
            output: Some(output),
            ..
        }) => {
            format!("; the poses are complete in {}", output.display())
        }
        Command::Check(CheckOptions { csv: Some(csv), .. }) => {
            format!("; the table is complete in {}", csv.display())
        }
        _ => String::new(),
    };
    format!("the report could not be written to the standard output: {error}{kept}").into()
}

/// A report as text, or as one JSON object on a single line.
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
