//! Robot programs in the languages of their controllers: targets corrected in place, everything else unchanged, byte for byte.
//!
//! `engine.rs` places and corrects targets, `target_outcomes.rs` has the outcome of a target by the motions to it, `program_text.rs` its numbers in the text. No
//! languages here: `poecal-programs` has them.

mod engine;
mod pose_compensation;
mod program_text;
mod reasons;
mod summary;
mod target_outcomes;

use std::path::Path;

use super::ChangeOptions;
use engine::Engine;
use poecal_model::robot::{Controller, Robot};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_programs::axes::ControllerAxes;
use poecal_programs::parsed_program::PoseMeaning;
use poecal_programs::{Language, StatedFrames, parse};
use poecal_results::programs::read_program;

pub use pose_compensation::PoseCompensation;
pub use summary::ProgramSummary;

/// Options of the compensation of programs.
#[derive(Clone, Debug)]
pub struct ProgramOptions {
    /// The language.
    pub language: Language,
    /// Tools and frames that the program does not state.
    pub given: StatedFrames,
    /// True if the remaining error is recomputed from the written text by the robots' own forward kinematics.
    pub check: bool,
    /// Limits of the changes of readings.
    pub change: ChangeOptions,
    /// True if the outcome of every target is kept.
    pub each: bool,
    /// Conversion from the controller's readings, which programs state, to those of the nominal robot; `None` if they are the same.
    pub controller: Option<Controller>,
    /// True if the zero of the third axis is unknown: joint targets of FANUC are refused then.
    pub is_third_axis_open: bool,
}

impl ProgramOptions {
    /// Options for a language, with nothing else stated.
    #[must_use]
    pub fn new(language: Language) -> Self {
        ProgramOptions {
            language,
            given: StatedFrames::default(),
            check: false,
            change: ChangeOptions::default(),
            each: false,
            controller: None,
            is_third_axis_open: false,
        }
    }
}

/// Corrects the targets of a program written for `nominal` for the robot `actual` at these values of its factors (theory.md §2). Joint targets become
/// those of [`Compensation`](super::Compensation), poses those of [`PoseCompensation`]; targets that cannot be corrected with certainty are unchanged
/// and listed. All bytes except those of the changed numbers stay.
///
/// # Errors
/// Those of [`parse`] and [`Compensation::new`](super::Compensation::new).
pub fn compensate_program(
    text: &[u8],
    (nominal, actual): (&Robot, &Robot),
    factors: &[f64],
    options: &ProgramOptions,
) -> Result<(Vec<u8>, ProgramSummary)> {
    let counting = options.controller.as_ref().filter(|it| !it.is_plain());
    let counting = counting.map(Controller::controller_map).transpose()?;
    let mut engine = Engine::new((nominal, actual), factors, &options.given, &options.change)?;
    engine.counting = counting;
    let axes = ControllerAxes::from_robot(nominal);
    if let Some(start) = options.given.start.as_ref().filter(|it| it.len() != axes.count()) {
        return ErrorKind::Option.refuse(format!(
            "found {} readings as the start, expected one of each joint: {}",
            start.len(),
            axes.names.join(", ")
        ));
    }
    let parsed = parse(options.language, text, &options.given, &axes)?;
    let joints = parsed.targets.iter().find(|it| it.meant == PoseMeaning::Joints);
    if let (Language::Fanuc, true, Some(target)) = (options.language, options.is_third_axis_open, joints) {
        return Err(ErrorKind::Option.error("found a joint target, and a calibration whose rows do not show from where the third axis counts, expected \
                       `--third-axis level` where J3 counts from the level, as controllers of FANUC do by themselves, or `--third-axis arm`").at_line("", target.line));
    }
    engine.hold(axes.external.clone(), &parsed)?;
    let mut made = engine.correct(text, parsed, options.each);
    if options.check {
        let again = parse(options.language, &made.text, &options.given, &axes)?;
        made.summary.checked = Some(summary::check_written(&engine, (nominal, actual), factors, &again, &made.meant));
    }
    let corrected = made.meant.len();
    let summary = ProgramSummary { language: options.language, corrected, changes: made.summary };
    Ok((made.text, summary))
}

/// [`compensate_program`] of a file.
///
/// # Errors
/// Those of [`read_program`] and [`compensate_program`], with the line in the file.
pub fn compensate_file(
    path: impl AsRef<Path>,
    robots: (&Robot, &Robot),
    factors: &[f64],
    options: &ProgramOptions,
) -> Result<(Vec<u8>, ProgramSummary)> {
    let path = path.as_ref();
    let text = read_program(path)?;
    compensate_program(&text, robots, factors, options).map_err(|error| match error.place().and_then(|it| it.line) {
        Some(line) => error.at_line(path, line),
        None => error.in_file(path),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_robot_that_is_as_drawn_leaves_every_byte() {
        let robot = poecal_testing::sessions::unlimited_elbow();
        let options = ProgramOptions::new(Language::UrScript);
        let program = b"movej([0, 0, 0, 0, 0.5, 0])\n";
        let (text, summary) = compensate_program(program, (&robot, &robot), &[], &options).unwrap();
        assert!(summary.is_whole() && summary.corrected == 1);
        assert_eq!(text, program);
    }
}
