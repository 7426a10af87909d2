//! Cells of workbooks: their numbers and texts, formulas that no program computed, and numbers displayed as dates or times.

use std::collections::BTreeMap;

use calamine::{Data, Range};

use super::made_table::Refusal;
use super::words::number;
use crate::table::source_cells::WorkbookSheet;
use crate::table::times::seconds_of;

/// Seconds of a day, the unit of times in workbooks.
const DAY_S: f64 = 86_400.0;
/// Remedy for formulas without results.
const REMEDY: &str =
    "open the workbook in a spreadsheet program and save it, so that formulas are computed, or paste the numbers";

/// Refuses formulas of a table without a result, or with 0 in the whole column: some programs do not compute them. The pair is the rows, and the
/// columns with their names. A form of workbook whose formulas cannot be read always has results.
pub(crate) fn refuse_uncomputed(
    formulas: &BTreeMap<(u32, u32), String>,
    range: &Range<Data>,
    sheet: &WorkbookSheet,
    (rows, columns): (&[usize], &[String]),
) -> Result<(), Refusal> {
    let (first_row, first_column) = range.start().unwrap_or_default();
    let place = |row: usize, column: usize| (first_row + row as u32, first_column + column as u32);
    let formula = |row: usize, column: usize| formulas.get(&place(row, column));
    for (column, name) in columns.iter().enumerate() {
        let mut zeros = 0;
        for &row in rows {
            let Some(text) = formula(row, column) else { continue };
            let cell = range.get((row, column)).unwrap_or(&Data::Empty);
            if matches!(cell, Data::Empty) {
                let at = sheet.cell(column, first_row as usize + row + 1);
                return Refusal::refuse_whole(format!(
                    "sheet `{}`, cell {at}: found the formula `={text}` without a result, expected one: {REMEDY}",
                    sheet.name
                ));
            }
            let is_zero = matches!(cell, Data::Float(value) if *value == 0.0) || matches!(cell, Data::Int(0));
            zeros += usize::from(is_zero && text.trim() != "0");
        }
        if zeros == rows.len() && zeros > 1 {
            return Refusal::refuse_whole(format!(
                "sheet `{}`: found formulas in the column `{name}` whose results are all 0, as programs store them that do not compute, expected their \
                 numbers: {REMEDY}",
                sheet.name
            ));
        }
    }
    Ok(())
}

/// The text of a cell that is displayed as a date or a time, in a column of other quantities. Its number counts days, and is no length or angle.
pub(crate) fn no_number(cell: &Data, column: &str) -> Option<String> {
    let name = column.split(['[', '(']).next().unwrap_or_default();
    let is_time = seconds_of(name, None).is_some() || seconds_of(column, None).is_some();
    let shown = if let Data::DateTime(time) = cell {
        time.as_f64().to_string()
    } else if let Data::DurationIso(text) = cell {
        text.clone()
    } else {
        return None;
    };
    (!is_time).then(|| format!("{shown} (formatted as a date or time)"))
}

/// A number of a cell.
pub(crate) fn value(cell: &Data) -> Option<f64> {
    match cell {
        Data::Float(value) => Some(*value).filter(|it| it.is_finite()),
        Data::Int(value) => Some(*value as f64),
        Data::DateTime(time) => Some(time.as_f64() * DAY_S),
        Data::DurationIso(text) => duration_s(text),
        Data::String(text) => number(text),
        Data::Bool(_) | Data::DateTimeIso(_) | Data::Error(_) | Data::Empty => None,
    }
}

/// True for a cell without content.
pub(crate) fn is_empty(cell: &Data) -> bool {
    matches!(cell, Data::Empty) || matches!(cell, Data::String(text) if text.trim().is_empty())
}

/// The text of a cell.
pub(crate) fn text(cell: &Data) -> String {
    if let Data::String(text) = cell {
        return text.trim().replace(['\n', '\r', '\t'], " ");
    }
    if is_empty(cell) { String::new() } else { cell.to_string() }
}

/// Seconds of a duration in the form of ODS, such as `PT01H02M03.5S`.
fn duration_s(text: &str) -> Option<f64> {
    let (sign, rest) = text.strip_prefix('-').map_or((1.0, text), |rest| (-1.0, rest));
    let (days, time) = rest.strip_prefix('P')?.split_once('T')?;
    let (mut seconds, mut number) = (0.0, String::new());
    for (letter, is_time) in days.chars().map(|it| (it, false)).chain(time.chars().map(|it| (it, true))) {
        let unit_s = match (letter, is_time) {
            ('D', false) => DAY_S,
            ('H', true) => 3600.0,
            ('M', true) => 60.0,
            ('S', true) => 1.0,
            ('0'..='9' | '.' | ',', _) => {
                number.push(if letter == ',' { '.' } else { letter });
                continue;
            }
            _ => return None,
        };
        seconds += unit_s * std::mem::take(&mut number).parse::<f64>().ok()?;
    }
    (number.is_empty() && text.ends_with(['D', 'H', 'M', 'S'])).then_some(sign * seconds)
}
