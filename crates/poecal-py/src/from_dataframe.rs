//! Data frames as text of a table, read by the same rules as files.

use poecal::Error;
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyString};

use crate::errors::{argument, raise_at_row};

/// Name of the data frame in messages.
pub(crate) const NAME: &str = "dataframe";

/// The frame as CSV with exact numbers.
pub(crate) fn text(frame: &Bound<'_, PyAny>) -> PyResult<String> {
    let expected = "a data frame: something with `columns` and with columns by name, as of pandas or polars";
    let no_frame = |_| {
        let found = frame.get_type().name().map_or_else(|_| "something".to_owned(), |name| name.to_string());
        argument("frame", format!("found {found}, expected {expected}"))
    };
    let names = frame.getattr("columns").map_err(no_frame)?.try_iter().map_err(no_frame)?;
    let names = names.collect::<PyResult<Vec<_>>>()?;
    let mut columns = Vec::with_capacity(names.len());
    for name in &names {
        let column = frame.get_item(name).map_err(no_frame)?;
        let cells = column
            .try_iter()
            .map_err(no_frame)?
            .map(|value| cell(&value?))
            .collect::<PyResult<Vec<String>>>()?;
        columns.push(cells);
    }
    let rows = columns.first().map_or(0, Vec::len);
    if let Some((name, column)) = names.iter().zip(&columns).find(|(_, column)| column.len() != rows) {
        let message =
            format!("found {} values in column `{name}`, expected {rows} as in the first", column.len());
        return Err(argument("frame", message));
    }
    let header: Vec<String> =
        names.iter().map(|name| Ok(quoted(&name.str()?.to_cow()?))).collect::<PyResult<_>>()?;
    let mut text = header.join(",") + "\n";
    for row in 0..rows {
        let cells: Vec<&str> =
            columns.iter().filter_map(|column| column.get(row)).map(String::as_str).collect();
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    Ok(text)
}

/// A value as a cell: numbers with all digits, missing values empty.
fn cell(value: &Bound<'_, PyAny>) -> PyResult<String> {
    if value.is_none() {
        return Ok(String::new());
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(quoted(&text.to_cow()?));
    }
    if (value.is_instance_of::<PyFloat>() || value.hasattr("dtype")?)
        && let Ok(number) = value.extract::<f64>()
    {
        return Ok(if number.is_nan() { String::new() } else { format!("{number:?}") });
    }
    let text = value.str()?;
    let text = text.to_cow()?;
    // Missing values of pandas.
    Ok(if matches!(&*text, "<NA>" | "NaT") { String::new() } else { quoted(&text) })
}

/// A cell, quoted if necessary, on one line.
fn quoted(text: &str) -> String {
    // The reader removes an apostrophe before a text that a spreadsheet would run; one in the frame is protected by another.
    let mark = if text.starts_with('\'') { "'" } else { "" };
    let text = format!("{mark}{}", text.replace(['\n', '\r'], " "));
    if text.contains([',', '"', ';', '\t', ' ', '#']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text
    }
}

/// The exception for an error in the table, with the row of the frame.
pub(crate) fn raise(error: Error) -> PyErr {
    // The header is the first line.
    let line = error.place().filter(|place| place.path.as_os_str() == NAME).and_then(|place| place.line);
    raise_at_row(error, line.and_then(|line| line.checked_sub(2)))
}
