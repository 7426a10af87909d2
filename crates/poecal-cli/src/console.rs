//! Standard output for results, standard error for messages. On a terminal with colours and its width; elsewhere without either.

use std::cell::RefCell;
use std::fmt::Display;
use std::io::{ErrorKind, Write as _};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use anstream::{AutoStream, ColorChoice};
use poecal_import::MeasurementFile;
use poecal_numerics::error::Result;
use poecal_numerics::text::{escape_invisible, visible_lines};
use poecal_results::output::ReservedFile;

use crate::progress::Progress;
use crate::{CapturedOutput, DONE, WORSE, style};

thread_local! {
    /// Captured output, if it is not printed.
    static KEPT: RefCell<Option<CapturedOutput>> = const { RefCell::new(None) };
}

/// Captures output, if that is wanted; false if it is to be printed.
fn capture_if_wanted(add: impl FnOnce(&mut CapturedOutput)) -> bool {
    KEPT.with_borrow_mut(|kept| kept.as_mut().map(add)).is_some()
}

/// Does some work, and returns its output on standard output and standard error.
pub(crate) fn capture_output(work: impl FnOnce() -> u8) -> CapturedOutput {
    KEPT.replace(Some(CapturedOutput::default()));
    let code = work();
    CapturedOutput { code, ..KEPT.take().unwrap_or_default() }
}

/// Output of clap: help, version, or a usage error.
///
/// # Errors
/// If the help cannot be printed.
pub(crate) fn usage(error: &clap::Error) -> Result<()> {
    let text = error.render().to_string();
    let add = |said: &mut CapturedOutput| {
        if error.use_stderr() { said.err.push_str(&text) } else { said.out.push_str(&text) }
    };
    if capture_if_wanted(add) {
        return Ok(());
    }
    if !error.use_stderr() {
        let is_plain = AutoStream::choice(&std::io::stdout()) == ColorChoice::Never;
        return Console::new(false).data(&if is_plain { text } else { error.render().ansi().to_string() });
    }
    match width_of(&std::io::stderr()) {
        // Lists of words are longer than a terminal is wide.
        Some(width) => anstream::eprint!("{}", style::wrap_list(&error.render().ansi().to_string(), width)),
        None => {
            let _ = error.print();
        }
    }
    Ok(())
}

/// Output of the program.
pub(crate) struct Console {
    quiet: bool,
    /// Lines of warnings and remarks.
    said: AtomicUsize,
}

/// Most columns of a line of help.
const HELP_WIDTH: usize = 100;

impl Console {
    pub(crate) fn new(quiet: bool) -> Self {
        Console { quiet, said: AtomicUsize::new(0) }
    }

    /// A result that must arrive completely; only a closed pipe is no error.
    pub(crate) fn data(&self, text: &str) -> Result<()> {
        self.bytes(text.as_bytes())
    }

    /// Bytes on standard output, as [`Console::data`]. If output is kept as text, bytes that are no UTF-8 are made visible.
    pub(crate) fn bytes(&self, bytes: &[u8]) -> Result<()> {
        if capture_if_wanted(|said| said.out.push_str(&String::from_utf8_lossy(bytes))) {
            return Ok(());
        }
        let mut out = std::io::stdout().lock();
        match out.write_all(bytes).and_then(|()| out.flush()) {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => poecal_numerics::error::ErrorKind::File.refuse(
                format!("standard output cannot be written to ({error}), expected room for {} bytes", bytes.len()),
            ),
            _ => Ok(()),
        }
    }

    /// Data to a file, or to standard output.
    pub(crate) fn deliver(&self, text: String, place: Option<ReservedFile>) -> Result<()> {
        let Some(place) = place else { return self.data(&text) };
        place.write(vec![text.into()])
    }

    /// A result to a file, or to people; `is_data` to standard output for programs.
    pub(crate) fn show(&self, text: String, place: Option<ReservedFile>, is_data: bool) -> Result<()> {
        if is_data || place.is_some() { self.deliver(text, place) } else { self.say(&text) }
    }

    /// A result, unless `--quiet` suppresses it.
    pub(crate) fn say(&self, text: &str) -> Result<()> {
        if self.quiet {
            return Ok(());
        }
        let stdout = std::io::stdout();
        // Line breaks are the report's own; other control characters come from a file.
        let text = visible_lines(text);
        let text = match width_of(&stdout) {
            Some(width) => style::narrow_report(&text, width),
            None => text.into_owned(),
        };
        let plain = AutoStream::choice(&stdout) == ColorChoice::Never;
        self.data(&if plain { text } else { style::paint_report(&text) })
    }

    /// A result as JSON, or as a table that `--quiet` suppresses.
    pub(crate) fn json_or_table(
        &self,
        is_json: bool,
        json: impl FnOnce() -> Result<String>,
        table: impl FnOnce() -> String,
    ) -> Result<()> {
        if is_json { self.data(&json()?) } else { self.say(&table()) }
    }

    /// A result about written files. If it cannot be printed, the files exist nevertheless: returns the exit code.
    pub(crate) fn say_of(&self, text: &str, written: &Path) -> u8 {
        self.exit_code(self.say(text), written)
    }

    /// [`Console::say_of`] for data.
    pub(crate) fn data_of(&self, text: &str, written: &Path) -> u8 {
        self.exit_code(self.data(text), written)
    }

    fn exit_code(&self, said: Result<()>, written: &Path) -> u8 {
        let Err(error) = said else { return DONE };
        self.error(format!("{error}; what was to be written is in {}", written.display()));
        WORSE
    }

    /// Prints warnings immediately.
    pub(crate) fn warner(&self) -> impl FnMut(String) {
        |message| self.warning(message)
    }

    pub(crate) fn warning(&self, message: impl Display) {
        self.print_aside("warning:", &message.to_string());
    }

    /// A warning or a remark, unless `--quiet` suppresses it.
    fn print_aside(&self, word: &str, message: &str) {
        if !self.quiet {
            self.said.fetch_add(message.chars().count().div_ceil(HELP_WIDTH), Ordering::Relaxed);
            tell(word, style::WARNING, message);
        }
    }

    /// Number of lines of warnings and remarks until now, on a wide terminal.
    pub(crate) fn lines_said(&self) -> usize {
        self.said.load(Ordering::Relaxed)
    }

    pub(crate) fn warnings(&self, messages: &[String]) {
        messages.iter().for_each(|message| self.warning(message));
    }

    /// Findings of reading files, and its warnings.
    pub(crate) fn said_of(&self, file: &MeasurementFile) {
        file.notes.iter().for_each(|note| self.remark(note));
        self.warnings(&file.warnings);
    }

    /// Sources of a result, on standard error, unless `--quiet` suppresses them.
    pub(crate) fn remark(&self, message: impl Display) {
        self.print_aside("note:", &message.to_string());
    }

    /// A line about the run itself, which was requested and is never suppressed.
    pub(crate) fn note(&self, line: impl Display) {
        let line = escape_invisible(&line.to_string()).into_owned();
        if capture_if_wanted(|said| said.err.push_str(&format!("{line}\n"))) {
            return;
        }
        let _ = writeln!(std::io::stderr().lock(), "{line}");
    }

    pub(crate) fn error(&self, message: impl Display) {
        tell("error:", style::ERROR, &message.to_string());
    }

    /// A progress bar of `steps` on a terminal; nothing elsewhere.
    pub(crate) fn progress(&self, steps: u64) -> Progress {
        Progress::new(steps, self.quiet)
    }
}

/// Width of the program's help: that of the terminal or of `COLUMNS`, at most [`HELP_WIDTH`].
pub(crate) fn help_width() -> usize {
    let stated = || std::env::var("COLUMNS").ok().and_then(|it| it.parse().ok());
    width_of(&std::io::stdout()).or_else(stated).unwrap_or(HELP_WIDTH).clamp(40, HELP_WIDTH)
}

/// Width of a stream, if it is a terminal.
#[cfg(unix)]
fn width_of(stream: &impl std::os::fd::AsFd) -> Option<usize> {
    terminal_size::terminal_size_of(stream).map(|(terminal_size::Width(width), _)| usize::from(width))
}

/// Width of a stream, if it is a terminal.
#[cfg(windows)]
fn width_of(stream: &impl std::os::windows::io::AsHandle) -> Option<usize> {
    terminal_size::terminal_size_of(stream).map(|(terminal_size::Width(width), _)| usize::from(width))
}

/// Elsewhere there are no terminals.
#[cfg(not(any(unix, windows)))]
fn width_of<S>(_: &S) -> Option<usize> {
    None
}

/// A message on standard error: one line, or on a terminal as many as its width requires.
fn tell(word: &str, style: anstyle::Style, message: &str) {
    let message = escape_invisible(message);
    if capture_if_wanted(|said| said.err.push_str(&format!("{word} {message}\n"))) {
        return;
    }
    let stderr = std::io::stderr();
    let message = match width_of(&stderr) {
        Some(width) => style::wrap_message(&message, word.len() + 1, width),
        None => message.into_owned(),
    };
    let mut out = AutoStream::auto(stderr.lock());
    // Standard error is closed too.
    let _ = writeln!(out, "{style}{word}{style:#} {message}");
}
