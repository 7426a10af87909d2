//! `guess_columns`: the mapping of a foreign file.

use std::path::PathBuf;

use poecal_import::{ColumnGuess, guess_columns as guessed};
use pyo3::prelude::*;

use crate::arguments::{self as arg, NamedLinks};
use crate::errors::raise;
use crate::findings::Findings;
use crate::paths;

/// Guesses the columns of joints and measured quantities in a foreign file, as `poecal init --columns-from` does.
///
/// Check the mapping, save it (`Path("columns.toml").write_text(guess.mapping)`), and read the file by `Measurements.from_csv(path, robot,
/// columns="columns.toml")`.
///
/// Parameters
/// ----------
/// path
///     The file: CSV or a workbook.
/// robot
///     The robot, or the path of its model.
/// columns
///     Columns or words in place of the guess, by the keys of `fields`: `{"position.x": "Tx"}`; an empty text for none.
///
/// Returns
/// -------
/// ColumnGuess
///     The columns of the file, the fields of a mapping with their choices, unused columns, and the mapping as a text (TOML).
#[pyfunction]
#[pyo3(signature = (path, robot, *, columns=None))]
pub(crate) fn guess_columns(
    py: Python<'_>,
    #[pyo3(from_py_with = arg::path)] path: PathBuf,
    robot: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = arg::columns)] columns: Option<NamedLinks>,
) -> PyResult<Findings> {
    let robot = paths::robot(robot)?;
    let robot = &robot.get().model.robot;
    let chosen = columns.map_or_else(Vec::new, |columns| columns.0);
    let found = py.detach(|| guessed(&path, robot, &chosen)).map_err(raise)?;
    Findings::new("ColumnGuess", found.mapping.clone(), answer(&found), &found)
}

/// Number of fields with a column, and those without one.
fn answer(found: &ColumnGuess) -> String {
    let mapped = found.fields.iter().filter(|it| it.choices.is_empty() && !it.chosen.is_empty()).count();
    let missing = match found.missing.as_slice() {
        [] => String::new(),
        some => format!("; no column for {}", some.join(", ")),
    };
    format!("{mapped} of {} columns are mapped{missing}", found.columns.len())
}
