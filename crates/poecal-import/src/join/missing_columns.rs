//! Errors of a header in which a column or its unit is missing.

use std::collections::BTreeSet;

use crate::table::cells::{Separator, split};
use crate::table::header::Header;
use crate::table::header_cells::{header_cells, is_number, unit_in_name};
use poecal_numerics::error::{Error, ErrorKind, MissingColumn, Result, first_few, nearest_word};
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;

impl Header<'_> {
    /// The error for a column without a unit in the line of units or elsewhere.
    pub(crate) fn no_unit(&self, index: usize, line: usize, quantity: Unit, purpose: &str) -> Error {
        let name = self.cells.get(index).map_or("", |cell| cell.text.as_str());
        let si = NamedUnit::from(quantity).symbol();
        let message = format!(
            "found no unit below column `{name}` in the line of units (line {line}), expected one {purpose}: write `{si}` \
             there if it is in {si}"
        );
        self.error(ErrorKind::Unit, index, message)
    }

    /// Works like [`Header::find`] for a required column. `is_known` recognises names that cannot be misspellings of another column's, and `advice`
    /// is for the message.
    pub(crate) fn require(
        &self,
        name: &str,
        purpose: &str,
        is_known: impl Fn(&str) -> bool,
        advice: &str,
    ) -> Result<usize> {
        if let Some(index) = self.find(name)? {
            return Ok(index);
        }
        let hint = self.no_header(name).unwrap_or_else(|| self.other_names(name, is_known) + advice);
        let message = format!("found no column `{name}`, expected one {purpose}; {hint}");
        let error = match &self.sheet {
            Some(sheet) => {
                let message = format!("sheet `{}`, row {}: {message}", sheet.name, self.line);
                ErrorKind::Measurement.error(message).in_file(self.path)
            }
            None => ErrorKind::Measurement.error(message).at_line(self.path, self.line),
        };
        Err(error.of_missing(MissingColumn::Other))
    }

    /// The message if this line is no header.
    fn no_header(&self, name: &str) -> Option<String> {
        let has_name = |(_, text): &&(usize, String)| {
            let mut cells = Vec::new();
            split(text, Separator::recognise(text), &mut cells).is_ok()
                && header_cells(text, &cells).iter().any(|cell| cell.name == name)
        };
        if let Some((line, _)) = self.below.iter().find(has_name) {
            return Some(format!(
                "line {line} has it: put `#` in front of the lines above it, or write `skip_lines = {}` in a mapping \
                 file (--columns)",
                line - 1
            ));
        }
        let numbers = self.cells.iter().filter(|cell| is_number(&cell.text)).count();
        if 2 * numbers > self.cells.len() {
            return Some("the line holds mostly numbers: put a line above it that names the columns".to_owned());
        }
        match self.cells.as_slice() {
            [only] if only.text.len() > name.len() && only.text.contains(name) => Some(format!(
                "the whole line is one column, `{}`: separate the columns by `,`, `;`, tabs or blanks",
                only.text
            )),
            _ => None,
        }
    }

    /// Names of other columns that may be meant.
    fn other_names(&self, name: &str, is_known: impl Fn(&str) -> bool) -> String {
        let names = || {
            let named = self.cells.iter().filter(|cell| !cell.name.is_empty());
            named.map(|cell| cell.name.as_str()).filter(|found| !is_known(found))
        };
        // There may be very many columns.
        let mut seen = BTreeSet::new();
        let again: BTreeSet<&str> = names().filter(|found| !seen.insert(*found)).collect();
        if let Some(twice) = names().find(|found| again.contains(found)) {
            return format!("`{twice}` is the name of {} columns", self.count(twice));
        }
        let with_unit = names().find_map(|found| Some((found, unit_in_name(found, name)?)));
        match (with_unit, nearest_word(name, names())) {
            (Some((found, unit)), _) => {
                format!("if `{found}` is meant, write `{name}[{}]`", unit.symbol())
            }
            (None, Some(near)) => format!("the nearest name found is `{near}`"),
            (None, None) => {
                let all = self.cells.iter().map(|cell| cell.name.as_str()).filter(|name| !name.is_empty());
                format!("the columns are {}", first_few(&all.collect::<Vec<_>>()))
            }
        }
    }
}
