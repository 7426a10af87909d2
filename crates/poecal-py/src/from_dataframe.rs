//! A data frame as the text of a table, so that it is read by the same rules as files.

use poecal::Error;
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyString};

use crate::errors::{argument, raise_at_row};

/// What stands for the file in messages.
pub(crate) const NAME: &str = "dataframe";

/// The frame as CSV. Numbers read back as they are.
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

/// A value as a cell: numbers with all their digits, nothing for what is missing.
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
    // The missing values of pandas.
    Ok(if matches!(&*text, "<NA>" | "NaT") { String::new() } else { quoted(&text) })
}

/// A cell in quotes, where it needs them. A cell is one line.
fn quoted(text: &str) -> String {
    // The reader takes an apostrophe off before what a spreadsheet would run; one of the frame's own stays behind another.
    let mark = if text.starts_with('\'') { "'" } else { "" };
    let text = format!("{mark}{}", text.replace(['\n', '\r'], " "));
    if text.contains([',', '"', ';', '\t', ' ', '#']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text
    }
}

/// The exception of an error in the table, told by the frame's row.
pub(crate) fn raise(error: Error) -> PyErr {
    // The header is the first line.
    let line = error.place().filter(|place| place.path.as_os_str() == NAME).and_then(|place| place.line);
    raise_at_row(error, line.and_then(|line| line.checked_sub(2)))
}
