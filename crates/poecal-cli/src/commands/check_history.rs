//! The history that checks are appended to.

use std::path::Path;

use poecal_numerics::error::Result;
use poecal_results::validation::{HISTORY, History, current_time};

use crate::args::ReportPlace;
use crate::console::Console;

/// The history that a check is appended to.
pub(super) struct CheckHistory {
    pub(super) checks: History,
    /// True if it was requested: then it must be written.
    is_asked: bool,
    /// True if it is written at all, or the reason why not.
    is_kept: std::result::Result<bool, poecal_numerics::error::Error>,
}

impl CheckHistory {
    /// The requested history, or the one beside a calibration.
    pub(super) fn read(asked: Option<&ReportPlace>, calibration: &Path) -> Result<Self> {
        let nothing = |is_kept| CheckHistory { checks: History::default(), is_asked: false, is_kept };
        match asked {
            Some(ReportPlace::None) => Ok(nothing(Ok(false))),
            Some(ReportPlace::File(path)) => {
                Ok(CheckHistory { checks: History::read(path)?, is_asked: true, is_kept: Ok(true) })
            }
            // A calibration that is no file has no folder beside it.
            None if !calibration.is_file() => Ok(nothing(Ok(false))),
            None => Ok(match History::read(&calibration.with_file_name(HISTORY)) {
                Ok(checks) => CheckHistory { checks, is_asked: false, is_kept: Ok(true) },
                Err(error) => nothing(Err(error)),
            }),
        }
    }

    /// Appends a check with its time, by the function `write`.
    pub(super) fn append(
        &mut self,
        write: impl FnOnce(&mut History, &str) -> Result<()>,
        console: &Console,
    ) -> Result<()> {
        let Some(time) = current_time() else { return Ok(()) };
        let is_kept = std::mem::replace(&mut self.is_kept, Ok(false));
        let done = is_kept.and_then(|is_kept| if is_kept { write(&mut self.checks, &time) } else { Ok(()) });
        match done {
            Err(error) if !self.is_asked => {
                console.remark(format!("the check is not in the history: {error}"));
                Ok(())
            }
            done => done,
        }
    }
}
