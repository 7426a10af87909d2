//! A progress bar on a terminal.

/// A progress bar; without effect if standard error is no terminal.
#[cfg(any(unix, windows))]
pub(crate) struct Progress(indicatif::ProgressBar);

#[cfg(any(unix, windows))]
impl Progress {
    pub(crate) fn new(steps: u64, quiet: bool) -> Self {
        use std::io::IsTerminal as _;
        use std::time::Duration;

        use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

        let draws = std::io::stderr().is_terminal() && std::env::var_os("TERM").is_none_or(|term| term != "dumb");
        if quiet || !draws {
            return Progress(ProgressBar::with_draw_target(Some(steps), ProgressDrawTarget::hidden()));
        }
        let bar = ProgressBar::new(steps);
        if let Ok(style) = ProgressStyle::with_template("{bar:20} {elapsed} {wide_msg}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(200));
        Progress(bar)
    }

    pub(crate) fn set(&self, step: u64, words: &'static str) {
        self.0.set_position(step);
        self.0.set_message(words);
    }

    pub(crate) fn finish(&self) {
        self.0.finish_and_clear();
    }
}

/// Without an operating system there is no terminal.
#[cfg(not(any(unix, windows)))]
pub(crate) struct Progress;

#[cfg(not(any(unix, windows)))]
impl Progress {
    pub(crate) fn new(_: u64, _: bool) -> Self {
        Progress
    }

    pub(crate) fn set(&self, _: u64, _: &'static str) {}

    pub(crate) fn finish(&self) {}
}
