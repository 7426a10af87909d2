//! Tables in memory as text of a table, read by the same rules as files.

use poecal_numerics::error::Error;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyFloat, PyList, PyString, PyTuple};

use crate::arguments::{describe_value, unexpected_error};
use crate::errors::{argument, raise_at_row};

/// Name of the data frame in messages.
pub(crate) const NAME: &str = "dataframe";

/// The table as CSV with exact numbers.
pub(crate) fn text(frame: &Bound<'_, PyAny>) -> PyResult<String> {
    let mut columns = Vec::new();
    let names = names(frame)?;
    for name in &names {
        let column = frame.get_item(name).map_err(|_| no_table(frame))?;
        let title = name.str()?.to_string();
        let no_column = || {
            argument(
                "frame",
                format!("found {} as column `{title}`, expected a value for each row", describe_value(&column)),
            )
        };
        if column.is_instance_of::<PyString>() {
            return Err(no_column());
        }
        let cells = column.try_iter().map_err(|_| no_column())?.enumerate();
        let cells = cells.map(|(row, value)| cell(&value?, row, &title)).collect::<PyResult<Vec<String>>>()?;
        columns.push(cells);
    }
    let rows = columns.first().map_or(0, Vec::len);
    if let Some((name, column)) = names.iter().zip(&columns).find(|(_, column)| column.len() != rows) {
        let message = format!("found {} values in column `{name}`, expected {rows} as in the first", column.len());
        return Err(argument("frame", message));
    }
    let header: Vec<String> =
        names.iter().map(|name| Ok(quote_cell(&name.str()?.to_cow()?))).collect::<PyResult<_>>()?;
    let mut text = header.join(",") + "\n";
    for row in 0..rows {
        let cells: Vec<&str> = columns.iter().filter_map(|column| column.get(row)).map(String::as_str).collect();
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    Ok(text)
}

/// The names of the columns: keys of a dict, fields of a structured array, or `columns` of a data frame.
fn names<'py>(frame: &Bound<'py, PyAny>) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let names = if frame.cast::<PyDict>().is_ok() {
        Some(frame.clone())
    } else if frame.hasattr("columns")? {
        Some(frame.getattr("columns")?)
    } else {
        let fields = frame.getattr("dtype").and_then(|it| it.getattr("names")).ok();
        fields.filter(|names| !names.is_none())
    };
    let names = names.ok_or_else(|| no_table(frame))?;
    names.try_iter().map_err(|_| no_table(frame))?.collect()
}

fn no_table(frame: &Bound<'_, PyAny>) -> PyErr {
    let expected = "a data frame (with `columns` and columns by name, as of pandas or polars), a dict of columns, or a structured array";
    unexpected_error("frame", frame, expected)
}

/// A value as a cell: numbers with all digits, missing values empty.
fn cell(value: &Bound<'_, PyAny>, row: usize, column: &str) -> PyResult<String> {
    let number = |number: f64| if number.is_nan() { String::new() } else { format!("{number:?}") };
    if let Ok(value) = value.cast::<PyFloat>() {
        return Ok(number(value.value()));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(quote_cell(&text.to_cow()?));
    }
    // `numpy.ma.masked` would be a number.
    if value.is_none() || value.get_type().name()? == "MaskedConstant" {
        return Ok(String::new());
    }
    if let Ok(bytes) = value.cast::<PyBytes>() {
        return Ok(quote_cell(&String::from_utf8_lossy(bytes.as_bytes())));
    }
    let is_list = value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>();
    let is_array = value.getattr("ndim").and_then(|it| it.extract::<usize>()).is_ok_and(|ndim| ndim > 0);
    if is_list || is_array || value.is_instance_of::<PyDict>() {
        let found = describe_value(value);
        let message = format!("row {row}: found {found} in column `{column}`, expected a number or a text");
        return Err(argument("frame", message));
    }
    if let (true, Ok(found)) = (value.hasattr("dtype")?, value.extract()) {
        return Ok(number(found));
    }
    let text = value.str()?;
    let text = text.to_cow()?;
    // Missing values of pandas.
    Ok(if matches!(&*text, "<NA>" | "NaT") { String::new() } else { quote_cell(&text) })
}

/// A cell, quoted if necessary, on one line.
fn quote_cell(text: &str) -> String {
    // The reader removes an apostrophe before a text that a spreadsheet would run; one in the frame is protected by another.
    let mark = if text.starts_with('\'') { "'" } else { "" };
    let text = format!("{mark}{}", text.replace(['\n', '\r'], " "));
    if text.contains([',', '"', ';', '\t', ' ', '#']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text }
}

/// The exception for an error in the table, with the row of the frame.
pub(crate) fn raise(error: Error) -> PyErr {
    // The header is the first line.
    let line = error.place().filter(|place| place.path.as_os_str() == NAME).and_then(|place| place.line);
    raise_at_row(error, line.and_then(|line| line.checked_sub(2)))
}
