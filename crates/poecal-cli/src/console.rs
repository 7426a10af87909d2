//! Standard output for results, standard error for everything else.

use std::fmt::Display;
use std::io::{ErrorKind, IsTerminal as _, Write as _};
use std::path::Path;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use poecal::Result;
use poecal::io::output;

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
    pub(crate) fn deliver(&self, text: &str, out: Option<&Path>) -> Result<()> {
        match out {
            Some(path) => output::write_file(path, text),
            None => self.data(text),
        }
    }

    /// A result that `--quiet` suppresses.
    pub(crate) fn say(&self, text: &str) -> Result<()> {
        if self.quiet { Ok(()) } else { self.data(text) }
    }

    pub(crate) fn warning(&self, message: impl Display) {
        if !self.quiet {
            let _ = writeln!(std::io::stderr().lock(), "warning: {message}");
        }
    }

    /// A line about the run itself, asked for and so never suppressed.
    pub(crate) fn note(&self, line: impl Display) {
        let _ = writeln!(std::io::stderr().lock(), "{line}");
    }

    pub(crate) fn error(&self, message: impl Display) {
        let _ = writeln!(std::io::stderr().lock(), "error: {message}");
    }

    /// A bar of `steps` on a terminal; nothing elsewhere.
    pub(crate) fn progress(&self, steps: u64) -> ProgressBar {
        if self.quiet || !std::io::stderr().is_terminal() {
            return ProgressBar::with_draw_target(Some(steps), ProgressDrawTarget::hidden());
        }
        let bar = ProgressBar::new(steps);
        if let Ok(style) = ProgressStyle::with_template("{bar:20} {msg} {elapsed}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(200));
        bar
    }
}
