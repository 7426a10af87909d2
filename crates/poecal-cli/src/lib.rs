//! The `poecal` program as a function from arguments to an exit code. Commands read files, call the library and print; they compute
//! nothing.
//!
//! Exit codes: 0 done, and a calibration is usable; 1 there are results, but they should not be used, are worse than `--require` demands, do not show
//! that they keep a limit of `--accept`, or could not be printed; 2 refused: wrong input or usage, and nothing was written; 3 there is no result.
//!
//! For people and scripts: options, exit codes and JSON of the program follow semantic versioning, the functions here do not. `lib.rs::parse_command_line`
//! lets clap turn typed words into arguments. If a command has settings, `settings.rs` adds those of `poecal.toml` as further words, and clap reads
//! all of them again. Not here: computation, and sentences on results, which `poecal-report` has.

mod args;
mod commands;
mod console;
mod help;
mod progress;
mod quantity;
mod renamed_words;
mod settings;
mod signals;
mod style;
mod timings;
mod without_json;
#[doc(hidden)]
pub mod words;

use std::error::Error as _;
use std::ffi::OsString;
use std::process::ExitCode;

use args::{Arguments, Command};
use clap::FromArgMatches as _;
use clap::error::ContextKind;
use console::Console;
use help::command_line;
use poecal_fit::problem::stated_level;
use poecal_numerics::error::{Error, ErrorKind};
use poecal_numerics::text::escape_invisible;
use poecal_storage::document;
use poecal_storage::limits::{self, ResourceLimits};
use poecal_storage::write_locks;
use quantity::LimitArgument;

/// Done.
pub(crate) const DONE: u8 = 0;
/// Done, but the result should not be used, or is worse than `--require` demands.
pub(crate) const WORSE: u8 = 1;
/// Refused: wrong input or usage.
const REFUSED: u8 = 2;
/// Failed without a result.
const NO_RESULT: u8 = 3;

/// A command line without control characters, for messages: clap quotes its words unchanged.
fn printable_words(typed: &[OsString]) -> Vec<OsString> {
    typed.iter().map(|word| OsString::from(escape_invisible(&word.to_string_lossy()).as_ref())).collect()
}

/// Prints help and version on standard output, usage errors on standard error: one sentence for a bad value, with clap's hints for others.
fn usage(error: &clap::Error) -> u8 {
    match (error.get(ContextKind::InvalidArg), error.source()) {
        (Some(option), Some(sentence)) => {
            let option = option.to_string();
            let option = option.split(' ').next().unwrap_or_default();
            Console::new(false).error(format!("{option}: {sentence}"));
        }
        _ => {
            if let Err(unprinted) = console::usage(error) {
                Console::new(false).error(unprinted);
                return REFUSED;
            }
        }
    }
    if error.use_stderr() { REFUSED } else { DONE }
}

/// The parsed command line with the settings file, or the exit code.
fn parse_command_line(typed: Vec<OsString>) -> Result<(Vec<OsString>, Arguments), u8> {
    let refused = |error: &Error| {
        Console::new(false).error(error);
        REFUSED
    };
    let parsed = |words: &[OsString]| {
        let matches = command_line().try_get_matches_from(words)?;
        let arguments = Arguments::from_arg_matches(&matches)?;
        Ok((matches, arguments))
    };
    let told = |words: &[OsString], error: clap::Error| match parsed(&printable_words(words)) {
        Err(shown) => match renamed_words::sentence(words, &shown).or_else(|| without_json::sentence(words, &shown)) {
            Some(sentence) => refused(&ErrorKind::Option.error(sentence)),
            None => usage(&shown),
        },
        // Words that are valid without control characters can only be wrong because of these.
        Ok(_) => {
            let message = error.to_string();
            let sentence = message.lines().next().unwrap_or_default().trim_start_matches("error: ");
            refused(&ErrorKind::Option.error(sentence))
        }
    };
    let (matches, arguments) = parsed(&typed).map_err(|error| told(&typed, error))?;
    let Some(completed) = limits::run_with_limits(stated_limits(&arguments), || settings::complete(&typed, &matches))
        .map_err(|error| refused(&error))?
    else {
        return Ok((typed, arguments));
    };
    match parsed(&completed.words) {
        Ok((_, arguments)) => Ok((completed.words, arguments)),
        Err(error) => Err(match completed.error(&error) {
            Some(error) => refused(&error),
            None => told(&completed.words, error),
        }),
    }
}

/// Runs the program in a process of its own.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    ExitCode::from(run_process(arguments))
}

/// [`run`] with the exit code as a number, for callers that end the process themselves. A signal that ends the process cleans up first.
pub fn run_process(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    signals::clean_up_on_signals();
    let code = run_to_code(arguments);
    signals::wait_if_ending();
    code
}

/// Captured run of the program.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CapturedOutput {
    /// Exit code.
    pub code: u8,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

/// Runs the program within another process, and captures its output.
pub fn run_captured(arguments: impl IntoIterator<Item = OsString>) -> CapturedOutput {
    console::capture_output(|| run_to_code(arguments))
}

/// Refuses commands of pictures and drawings in a program built without them: without an operating system.
fn need_pictures(typed: &[OsString]) -> Result<(), poecal_numerics::error::Error> {
    match typed.get(1).and_then(|word| word.to_str()) {
        Some(command @ ("detect" | "fleet")) if cfg!(not(any(unix, windows))) => ErrorKind::Option.refuse(format!(
            "found {command}, which this build of the program does not have, expected the program of an operating system or of the Python package"
        )),
        _ => Ok(()),
    }
}

fn run_to_code(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let typed: Vec<OsString> = arguments.into_iter().collect();
    if let Err(error) = need_pictures(&typed) {
        Console::new(false).error(&error);
        return REFUSED;
    }
    let (typed, arguments) = match parse_command_line(typed) {
        Ok(both) => both,
        Err(code) => return code,
    };
    let console = Console::new(arguments.quiet);
    if let Err(sentence) = stated_level() {
        console.error(sentence);
        return REFUSED;
    }
    // Without further threads, this one does the work: the failure to build a pool would appear later.
    if let Some(threads) = arguments.threads
        && cfg!(not(target_family = "wasm"))
    {
        // Fails only if a pool exists already, which is then used.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    }
    let work = || run_command(&arguments.command, &typed, &console);
    let work = || match arguments.command {
        // These read growing files, many sessions, or tables that are never held whole.
        Command::Watch(_) | Command::Predict(_) | Command::Compensate(_) => work(),
        #[cfg(any(unix, windows))]
        Command::Fleet(_) => work(),
        _ => document::reading(work),
    };
    let work = || write_locks::run_with_patience(arguments.wait.unwrap_or_default(), work);
    match limits::run_with_limits(stated_limits(&arguments), work) {
        Ok(code) => code,
        Err(error) => {
            // After a signal, errors from removed files mean nothing.
            signals::wait_if_ending();
            console.error(&error);
            if error.kind() == ErrorKind::Solver { NO_RESULT } else { REFUSED }
        }
    }
}

/// The limits of this thread with those that were typed.
fn stated_limits(arguments: &Arguments) -> ResourceLimits {
    arguments.limit.iter().fold(limits::current_limits(), |all, it| match it {
        LimitArgument::File(limit, most) => all.with_limit(*limit, *most),
        LimitArgument::Change(_) => all,
    })
}

/// Runs a command; returns the exit code.
fn run_command(command: &Command, typed: &[OsString], console: &Console) -> poecal_numerics::error::Result<u8> {
    match command {
        Command::Init(options) => commands::init(options, console),
        Command::Calibrate(options) => commands::calibrate(options, typed, console),
        Command::Tcp(options) => commands::tcp(options, typed, console),
        Command::HandEye(options) => commands::hand_eye(options, typed, console),
        #[cfg(any(unix, windows))]
        Command::Detect(options) => commands::detect(options, console),
        Command::Simulate(options) => commands::simulate(options, console),
        Command::Validate(options) => commands::validate(options, typed, console),
        Command::Track(options) => commands::track(options, typed, console),
        #[cfg(any(unix, windows))]
        Command::Fleet(options) => commands::fleet(options, console),
        Command::Iso9283(options) => commands::iso9283(options, typed, console),
        Command::Compare(options) => commands::compare(options, console),
        Command::Predict(options) => commands::predict(options, console),
        Command::Check(options) => commands::check(options, console),
        Command::Import(options) => commands::import(options, console),
        Command::Export(options) => commands::export(options, console),
        Command::Compensate(options) => commands::compensate(options, console),
        Command::Offsets(options) => commands::offsets(options, console),
        Command::Reproduce(options) => commands::reproduce(options, console),
        Command::Plan(options) => commands::plan(options, console),
        Command::Report(options) => commands::report(options, console),
        Command::Watch(options) => commands::watch(options, console),
        Command::Schema => commands::schema(console),
        Command::Completions(options) => commands::completions(options, console),
        Command::Man(options) => commands::man(options, console),
    }
}
