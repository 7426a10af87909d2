//! The `poecal` program as a function: arguments in, exit code out. Commands read files, call the library and print; they compute
//! nothing.
//!
//! Exit codes: 0 done; 1 the verdict is worse than `--require` asks; 2 a mistake in the input or its use; 3 the fit did not converge.

mod args;
mod commands;
mod console;
mod quantity;
mod timings;

use std::error::Error as _;
use std::ffi::OsString;
use std::process::ExitCode;

use args::{Arguments, Command};
use clap::Parser as _;
use clap::error::ContextKind;
use console::Console;

/// Done.
pub(crate) const DONE: u8 = 0;
/// Done, but the verdict is worse than `--require` asks.
pub(crate) const WORSE: u8 = 1;
/// Wrong input or usage.
const WRONG: u8 = 2;
/// The fit did not converge.
pub(crate) const NOT_CONVERGED: u8 = 3;

/// Help and version go to standard output, mistakes to standard error: one sentence for a bad value, with clap's hints for the rest.
fn usage(error: &clap::Error) -> u8 {
    match (error.get(ContextKind::InvalidArg), error.source()) {
        (Some(option), Some(sentence)) => {
            let option = option.to_string();
            let option = option.split(' ').next().unwrap_or_default();
            Console::new(false).error(format!("{option}: {sentence}"));
        }
        _ => {
            let _ = error.print();
        }
    }
    if error.use_stderr() { WRONG } else { DONE }
}

/// Runs the program.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    ExitCode::from(run_to_code(arguments))
}

/// [`run`], with the exit code as a number, for callers that end the process themselves.
pub fn run_to_code(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let typed: Vec<OsString> = arguments.into_iter().collect();
    let arguments = match Arguments::try_parse_from(&typed) {
        Ok(arguments) => arguments,
        Err(error) => return usage(&error),
    };
    let console = Console::new(arguments.quiet);
    if let Some(threads) = arguments.threads {
        // Fails only if a pool exists already, which then stays.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    }
    let result = match &arguments.command {
        Command::Calibrate(options) => commands::calibrate(options, &typed, &console),
        Command::Simulate(options) => commands::simulate(options, &console),
        Command::Validate(options) => commands::validate(options, &console),
        Command::Predict(options) => commands::predict(options, &console),
        Command::Check(options) => commands::check(options, &console),
        Command::Convert(options) => commands::convert(options, &console),
        Command::Offsets(options) => commands::offsets(options, &console),
        Command::Reproduce(options) => commands::reproduce(options, &console),
        Command::Identify(options) => commands::identify(options, &console),
        Command::Report(options) => commands::report(options, &console),
        Command::Schema => commands::schema(&console),
    };
    match result {
        Ok(code) => code,
        Err(error) => {
            console.error(&error);
            WRONG
        }
    }
}
