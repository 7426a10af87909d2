//! Errors of columns with two meanings, and of those with none.

use std::collections::BTreeMap;

use super::super::header_cells::unit_in_name;
use super::super::inputs::{InputSource, RowInput};
use super::super::kinds::{is_our_name, our_names};
use super::builder::Builder;
use poecal_numerics::error::{Error, ErrorKind, Result, distance_within};

impl Builder<'_> {
    /// Refuses a column with two meanings. (One sigma may serve several targets, and one column several sums.)
    pub(crate) fn check_distinct(&self) -> Result<()> {
        let distinct = |input: &RowInput| !input.name.contains("sigma_") && input.sum.is_empty();
        let mut first: BTreeMap<usize, &RowInput> = BTreeMap::new();
        for input in self.inputs.iter().filter(|input| distinct(input)) {
            let InputSource::Column(index) = input.source else { continue };
            if let Some(other) = first.insert(index, input) {
                let message = if other.name == input.name {
                    format!("found one column `{0}`, {1}", input.name, clash(&input.name))
                } else {
                    format!(
                        "found one column for both `{}` and `{}`, expected a column for each; \
                         name them in a mapping file (--columns)",
                        other.name, input.name
                    )
                };
                return Err(self.header.error(ErrorKind::Measurement, index, message));
            }
        }
        Ok(())
    }

    pub(crate) fn ignored_columns(&self) -> Vec<(String, Option<String>)> {
        let cells = self.header.cells.iter().enumerate();
        let missing: Vec<&'static str> = our_names().filter(|ours| self.header.count(ours) == 0).collect();
        cells
            .filter(|(index, cell)| !self.is_used(*index) && !cell.text.is_empty())
            .map(|(_, cell)| (cell.text.clone(), resembling_name(&cell.name, &missing)))
            .collect()
    }

    /// Explains a duplicate column by a joint of the model with the name of a column with a meaning.
    pub(crate) fn explain_duplicate(&self, name: &str, error: Error) -> Error {
        let is_clash = self.readings.contains(name) && is_our_name(name);
        match self.header.second_index(name) {
            Some(second) if is_clash => {
                let message = format!("found a second column `{name}`, {}", clash(name));
                self.header.error(ErrorKind::Measurement, second, message)
            }
            _ => error,
        }
    }
}

/// A missing name of our form that an unused column resembles, except for a typing error or brackets.
fn resembling_name(name: &str, missing: &[&'static str]) -> Option<String> {
    let slips = |ours: &str| if ours.len() < 4 { 0 } else { ours.len() / 4 };
    let with_unit = |ours: &str| Some(format!("{ours}[{}]", unit_in_name(name, ours)?.symbol()));
    missing.iter().find_map(|ours| {
        let is_near = || distance_within(name, ours, slips(ours)).is_some();
        with_unit(ours).or_else(|| is_near().then(|| (*ours).to_owned()))
    })
}

/// Error and remedy if a joint has the name of a column with a meaning.
fn clash(name: &str) -> String {
    format!(
        "expected different names for the model's joint `{name}` and the measured `{name}`: call the joint's column \
         `joint_{name}`, and say so with `joints = {{ {name} = \"joint_{name}\" }}` in a mapping file (--columns)"
    )
}
