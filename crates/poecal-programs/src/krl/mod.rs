//! KRL: the language of KUKA.

mod data;
mod motions;
mod reason;
pub(crate) mod status;
mod values;
mod words;

use super::axes::Axes;
use super::given::Given;
use super::parsed::Parsed;
use motions::Reader;
use poecal_numerics::error::Result;
use values::Variables;
use words::{MOTIONS, Way};

pub(crate) use words::RULES;

/// Targets and motions of a program, or of a list of its data.
pub(crate) fn parse(text: &[u8], given: &Given, axes: &Axes) -> Result<Parsed> {
    let variables = Variables::from_text(text, &RULES, axes);
    if variables.is_data {
        return Ok(data::parse(&variables, given));
    }
    Reader::new(text, given, axes, &variables).read()
}
