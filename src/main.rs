//! The command line tool `steadysweep`.

use std::process::ExitCode;

fn main() -> ExitCode {
    steadysweep::cli::run(std::env::args_os())
}
