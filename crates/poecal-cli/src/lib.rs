//! The `poecal` program as a function: arguments in, exit code out. Commands read files, call the library and print; they compute
//! nothing.
//!
//! Exit codes: 0 done; 2 a mistake in the input or its use; 3 the fit did not converge.

mod args;
mod commands;
mod console;
mod quantity;

use std::ffi::OsString;
use std::process::ExitCode;

use args::{Arguments, Command};
use clap::Parser as _;
use console::Console;

/// Runs the program.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        // clap prints help and version to standard output and mistakes to standard error.
        Err(error) => {
            let _ = error.print();
            return ExitCode::from(if error.use_stderr() { 2 } else { 0 });
        }
    };
    let console = Console::new(arguments.quiet);
    if let Some(threads) = arguments.threads {
        // Fails only if a pool exists already, which then stays.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    }
    let result = match &arguments.command {
        Command::Calibrate(options) => commands::calibrate(options, &console),
        Command::Simulate(options) => commands::simulate(options, &console),
    };
    match result {
        Ok(code) => code,
        Err(error) => {
            console.error(&error);
            ExitCode::from(2)
        }
    }
}
