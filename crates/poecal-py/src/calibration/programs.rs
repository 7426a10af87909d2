//! Robot programs that are corrected, and statements about them.

use std::path::Path;

use poecal_cli::words;
use poecal_compensate::{Language, ProgramOptions, StatedFrames};
use poecal_results::calibration_file::ControllerCounts;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use super::content::Calibration;
use crate::errors::{argument, raise};
use crate::reach;
use crate::words::one_of;

/// Statements about a program beside its text.
pub(super) struct ProgramSettings<'a> {
    pub(super) language: Option<String>,
    pub(super) tools: Option<Vec<String>>,
    pub(super) frames: Option<Vec<String>>,
    pub(super) base: Option<String>,
    pub(super) flange: Option<String>,
    pub(super) start: Option<String>,
    pub(super) third_axis: Option<&'a str>,
}

impl ProgramSettings<'_> {
    /// Adds the stated frames to those of a program.
    fn give(&self, given: &mut StatedFrames, language: Language) -> PyResult<()> {
        for words in self.tools.iter().flatten() {
            given.add_tool(words, language).map_err(raise)?;
        }
        for words in self.frames.iter().flatten() {
            given.add_frame(words, language).map_err(raise)?;
        }
        if let Some(words) = &self.base {
            given.set_base(words, language).map_err(raise)?;
        }
        if let Some(words) = &self.flange {
            given.set_flange(words, language).map_err(raise)?;
        }
        if let Some(words) = &self.start {
            given.set_start(words, language).map_err(raise)?;
        }
        Ok(())
    }
}

/// Corrects a program for a calibration, whose model of this name is the actual robot.
pub(super) fn compensate<'py>(
    py: Python<'py>,
    (calibration, model): (&Calibration, &str),
    (path, stated): (&Path, ProgramSettings<'_>),
    factors: Option<&Bound<'py, PyAny>>,
    (nearest, most): (bool, reach::MaxCorrectionArgument),
    check: bool,
) -> PyResult<(Bound<'py, PyBytes>, Bound<'py, PyAny>)> {
    let actual = calibration.actual_robot(model)?;
    let taught = calibration.file().taught_robot(&actual.model.robot).map_err(raise)?;
    let factors = reach::factors(&actual.model.robot, factors)?;
    let language = reach::language(path, stated.language.as_deref())?;
    let change = reach::change(nearest, most)?;
    let third_axis = stated.third_axis.map(|word| one_of("third_axis", word, words::THIRD_AXIS)).transpose()?;
    if third_axis.is_some() && language != Language::Fanuc {
        return Err(argument("third_axis", format!("found it for {}, expected a program of FANUC", language.title())));
    }
    let ControllerCounts { controller, is_third_axis_open } =
        calibration.file().controller_counts(&taught.robot, third_axis).map_err(raise)?;
    let mut options =
        ProgramOptions { change, check, each: true, controller, is_third_axis_open, ..ProgramOptions::new(language) };
    stated.give(&mut options.given, language)?;
    options.given = options.given.with_taught_frames(&taught.base, &taught.tool);
    reach::program(py, (&taught.robot, &actual.model.robot), path, &factors, &options)
}
