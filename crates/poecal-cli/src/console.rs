//! Standard output for results, standard error for everything else. On a terminal, colours and lines as wide as it; elsewhere neither.

use std::cell::RefCell;
use std::fmt::Display;
use std::io::{ErrorKind, IsTerminal as _, Write as _};
use std::path::Path;
use std::time::Duration;

use anstream::{AutoStream, ColorChoice};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use poecal::Result;
use poecal::io::output::FilePlace;
use poecal::text::{visible, visible_lines};

use crate::{DONE, Said, WORSE, style};

thread_local! {
    /// What is said, where it is kept and not printed.
    static KEPT: RefCell<Option<Said>> = const { RefCell::new(None) };
}

/// Keeps what is said, if that is wanted; false if it is to be printed.
fn kept(add: impl FnOnce(&mut Said)) -> bool {
    KEPT.with_borrow_mut(|kept| kept.as_mut().map(add)).is_some()
}

/// Does some work, and gives what is said on standard output and standard error.
pub(crate) fn captured(work: impl FnOnce() -> u8) -> Said {
    KEPT.replace(Some(Said::default()));
    let code = work();
    Said { code, ..KEPT.take().unwrap_or_default() }
}

/// What clap has to say: help, the version, or a mistake in the use.
pub(crate) fn usage(error: &clap::Error) {
    let text = error.render().to_string();
    let add = |said: &mut Said| {
        if error.use_stderr() { said.err.push_str(&text) } else { said.out.push_str(&text) }
    };
    if !kept(add) {
        let _ = error.print();
    }
}

/// Where the program speaks.
pub(crate) struct Console {
    quiet: bool,
}

impl Console {
    pub(crate) fn new(quiet: bool) -> Self {
        Console { quiet }
    }

    /// A result that must arrive whole; only a reader that has gone away (a closed pipe) is no error.
    pub(crate) fn data(&self, text: &str) -> Result<()> {
        if kept(|said| said.out.push_str(text)) {
            return Ok(());
        }
        let mut out = std::io::stdout().lock();
        match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => {
                let message = format!(
                    "standard output cannot be written to ({error}), expected room for {} bytes",
                    text.len()
                );
                Err(poecal::Error::new(poecal::ErrorKind::File, message))
            }
            _ => Ok(()),
        }
    }

    /// Data into a file, or to standard output.
    pub(crate) fn deliver(&self, text: String, place: Option<FilePlace>) -> Result<()> {
        let Some(place) = place else { return self.data(&text) };
        place.write(vec![text.into()])
    }

    /// A result that `--quiet` suppresses.
    pub(crate) fn say(&self, text: &str) -> Result<()> {
        if self.quiet {
            return Ok(());
        }
        let stdout = std::io::stdout();
        // Lines are the report's own; what else acts on a terminal comes from a file.
        let text = visible_lines(text);
        let text = match width_of(&stdout) {
            Some(width) => style::narrowed(&text, width),
            None => text.into_owned(),
        };
        let plain = AutoStream::choice(&stdout) == ColorChoice::Never;
        self.data(&if plain { text } else { style::painted(&text) })
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

    /// A result about what has been written. If it cannot be said, what was written is there all the same: gives the code to end with.
    pub(crate) fn say_of(&self, text: &str, written: &Path) -> u8 {
        self.told(self.say(text), written)
    }

    /// [`Console::say_of`] for data.
    pub(crate) fn data_of(&self, text: &str, written: &Path) -> u8 {
        self.told(self.data(text), written)
    }

    fn told(&self, said: Result<()>, written: &Path) -> u8 {
        let Err(error) = said else { return DONE };
        self.error(format!("{error}; what was to be written is in {}", written.display()));
        WORSE
    }

    /// Says warnings as they come.
    pub(crate) fn warner(&self) -> impl FnMut(String) {
        |message| self.warning(message)
    }

    pub(crate) fn warning(&self, message: impl Display) {
        if !self.quiet {
            tell("warning:", style::WARNING, &message.to_string());
        }
    }

    pub(crate) fn warnings(&self, messages: &[String]) {
        messages.iter().for_each(|message| self.warning(message));
    }

    /// A line about the run itself, asked for and so never suppressed.
    pub(crate) fn note(&self, line: impl Display) {
        let line = visible(&line.to_string()).into_owned();
        if kept(|said| said.err.push_str(&format!("{line}\n"))) {
            return;
        }
        let _ = writeln!(std::io::stderr().lock(), "{line}");
    }

    pub(crate) fn error(&self, message: impl Display) {
        tell("error:", style::ERROR, &message.to_string());
    }

    /// A bar of `steps` on a terminal that can draw it; nothing elsewhere.
    pub(crate) fn progress(&self, steps: u64) -> ProgressBar {
        let draws =
            std::io::stderr().is_terminal() && std::env::var_os("TERM").is_none_or(|term| term != "dumb");
        if self.quiet || !draws {
            return ProgressBar::with_draw_target(Some(steps), ProgressDrawTarget::hidden());
        }
        let bar = ProgressBar::new(steps);
        if let Ok(style) = ProgressStyle::with_template("{bar:20} {elapsed} {wide_msg}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(200));
        bar
    }
}

/// Columns of a stream that is a terminal.
#[cfg(unix)]
fn width_of(stream: &impl std::os::fd::AsFd) -> Option<usize> {
    terminal_size::terminal_size_of(stream).map(|(terminal_size::Width(width), _)| usize::from(width))
}

/// Columns of a stream that is a terminal.
#[cfg(windows)]
fn width_of(stream: &impl std::os::windows::io::AsHandle) -> Option<usize> {
    terminal_size::terminal_size_of(stream).map(|(terminal_size::Width(width), _)| usize::from(width))
}

/// A message on standard error: one line, or on a terminal as many as its width asks for.
fn tell(word: &str, style: anstyle::Style, message: &str) {
    let message = visible(message);
    if kept(|said| said.err.push_str(&format!("{word} {message}\n"))) {
        return;
    }
    let stderr = std::io::stderr();
    let message = match width_of(&stderr) {
        Some(width) => style::wrapped(&message, word.len() + 1, width),
        None => message.into_owned(),
    };
    let mut out = AutoStream::auto(stderr.lock());
    // Nobody is left to hear that nobody listens.
    let _ = writeln!(out, "{style}{word}{style:#} {message}");
}
