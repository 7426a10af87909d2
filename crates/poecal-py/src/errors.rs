//! The library's errors as Python exceptions.

use poecal_numerics::error::{Error, ErrorKind};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Name of the exception class of a kind of error, in `poecal._errors`.
fn class_name(kind: ErrorKind) -> &'static str {
    match kind {
        ErrorKind::File => "FileError",
        ErrorKind::Syntax => "FormatError",
        ErrorKind::Model => "ModelError",
        ErrorKind::Measurement => "MeasurementError",
        ErrorKind::Unit => "UnitError",
        ErrorKind::Option => "OptionError",
        ErrorKind::Problem => "ProblemError",
        ErrorKind::Export => "ExportError",
        ErrorKind::Solver => "SolverError",
        // Kinds of later versions of the library.
        _ => "Error",
    }
}

/// The exception for an error of the library.
pub(crate) fn raise(error: Error) -> PyErr {
    raise_at_row(error, None)
}

/// The exception for an error in a table in memory, with its row (from 0) instead of a line.
pub(crate) fn raise_at_row(error: Error, row: Option<usize>) -> PyErr {
    Python::attach(|py| exception(py, &error, row).unwrap_or_else(|failure| failure))
}

fn exception(py: Python<'_>, error: &Error, row: Option<usize>) -> PyResult<PyErr> {
    let class = py.import("poecal._errors")?.getattr(class_name(error.kind()))?;
    let told = match row {
        Some(row) => format!("row {row}: {}", error.message()),
        None => error.to_string(),
    };
    let about = PyDict::new(py);
    about.set_item("row", row)?;
    if let (Some(place), None) = (error.place(), row) {
        about.set_item("path", place.path.display().to_string())?;
        about.set_item("line", place.line)?;
        about.set_item("column", place.column)?;
    }
    Ok(PyErr::from_value(class.call((python_words(&told),), Some(&about))?))
}

/// An exception for an argument: `name: message`.
pub(crate) fn argument(name: &str, message: impl std::fmt::Display) -> PyErr {
    raise(ErrorKind::Option.error(format!("{name}: {message}")))
}

/// An exception of the class `name` of `poecal._errors`.
fn of_class(name: &str, message: &str) -> PyErr {
    let made = |py: Python<'_>| Ok(PyErr::from_value(py.import("poecal._errors")?.getattr(name)?.call1((message,))?));
    Python::attach(|py| made(py).unwrap_or_else(|failure: PyErr| failure))
}

/// The exception for a row that does not exist.
pub(crate) fn no_row(row: isize, count: usize) -> PyErr {
    let expected = match count {
        0 => "none, since there are no rows".to_owned(),
        count => format!("a row from 0 to {}, or from -{count} to -1", count - 1),
    };
    of_class("RowError", &format!("rows: found {row}, expected {expected}"))
}

/// The exception for a Python package that is not installed.
pub(crate) fn no_package(name: &str) -> PyErr {
    of_class("PackageError", &format!("found no package `{name}`, expected it to be installed: pip install {name}"))
}

/// Names of the program's options in Python: `--held-out` is `held_out`. Commands of other programs between backticks, as `rosbags-convert --src
/// bag`, are unchanged.
pub(crate) fn python_words(message: &str) -> String {
    let is_others =
        |(at, piece): (usize, &str)| at % 2 == 1 && !piece.starts_with("--") && !piece.starts_with("poecal");
    let pieces = message.split('`').enumerate();
    let words = pieces.map(|it| if is_others(it) { it.1.to_owned() } else { rename_options(it.1) });
    words.collect::<Vec<_>>().join("`")
}

fn rename_options(message: &str) -> String {
    let mut words = String::with_capacity(message.len());
    let mut rest = message;
    while let Some(at) = rest.find("--") {
        let (before, after) = rest.split_at(at);
        words.push_str(before);
        let name = after.trim_start_matches('-');
        let end = name.find(|c: char| !c.is_ascii_lowercase() && c != '-').unwrap_or(name.len());
        let (name, left) = name.split_at(end);
        if name.is_empty() {
            words.push_str(after.get(..after.len() - left.len()).unwrap_or_default());
        } else {
            words.push_str(&name.replace('-', "_"));
        }
        rest = left;
    }
    words + rest
}
