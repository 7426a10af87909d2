//! KRL: the language of KUKA.

mod data;
mod motions;
mod reason;
pub(crate) mod status;
mod values;
mod words;

use super::axes::ControllerAxes;
use super::parsed_program::ParsedProgram;
use super::stated_frames::StatedFrames;
use motions::KrlReader;
use poecal_numerics::error::Result;
use values::KrlVariables;
use words::{KrlMotionType, MOTIONS};

pub(crate) use words::RULES;

/// Targets and motions of a program, or of a list of its data.
pub(crate) fn parse(text: &[u8], given: &StatedFrames, axes: &ControllerAxes) -> Result<ParsedProgram> {
    let variables = KrlVariables::from_text(text, &RULES, axes);
    if variables.is_data {
        return Ok(data::parse(&variables, given));
    }
    KrlReader::new(text, given, axes, &variables).read()
}
