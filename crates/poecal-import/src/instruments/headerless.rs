//! Tables without names of columns: joint readings, with a time or a name before them, and points with a name. Others need a mapping, which names
//! columns by their numbers.

use std::collections::BTreeSet;

use super::made_table::{CellValue, FileLine, MadeTable, Refusal, TableColumn};
use super::words::{are_targets, cells, lines, number, repeats};
use super::{FileForm, OpeningContext};
use crate::Separator;
use crate::table::column_names::numbered_column;
use crate::table::mapping::ColumnMap;

pub(crate) const FORM: FileForm = FileForm { title: "a table without names of columns", is_it, table };

/// A row: its line, and its cells.
type CellRow<'t> = (usize, Vec<&'t str>);

/// Lines that are no comments.
fn content(text: &str) -> impl Iterator<Item = (usize, &str)> {
    lines(text).filter(|it| !it.1.trim_start().starts_with('#'))
}

fn is_it(text: &str, _: &OpeningContext<'_>) -> bool {
    let is_row = |line: &str| {
        let cells = cells(line, Separator::recognise(line));
        let numbers = cells.iter().filter(|it| number(it).is_some()).count();
        numbers >= 3 && cells.len() <= numbers + 1
    };
    let mut some = content(text).take(2).peekable();
    some.peek().is_some() && some.all(|it| is_row(it.1))
}

fn table(text: &str, opening: &OpeningContext<'_>) -> Result<MadeTable, Refusal> {
    let by = content(text).next().map_or(Separator::Comma, |it| Separator::recognise(it.1));
    let rows: Vec<CellRow<'_>> = content(text).map(|(line, it)| (line, cells(it, by))).collect();
    let width = rows.iter().map(|it| it.1.len()).max().unwrap_or_default();
    let first = rows.first().map_or(1, |it| it.0);
    if let Some((line, cells)) = rows.iter().find(|it| it.1.len() != width) {
        let found = cells.len();
        return FileLine(*line)
            .refuse(format!("found {found} cells, expected {width} as in other lines from line {first} on"));
    }
    // Columns of measurements that this table does not have belong to another one.
    let is_of_this = |map: &&ColumnMap| {
        map.names_columns() && (map.names_joints() || map.measured_numbers().is_none_or(|it| it <= width))
    };
    if opening.options.mapping.as_ref().filter(is_of_this).is_some() {
        return Ok(make_table((1..=width).map(numbered_column), rows));
    }
    let is_named = rows.iter().any(|it| it.1.first().is_some_and(|it| number(it).is_none()));
    for (line, cells) in &rows {
        let mut numbers = cells.iter().skip(usize::from(is_named));
        if let Some(bad) = numbers.find(|it| number(it).is_none()) {
            return FileLine(*line).refuse(format!("found `{bad}`, expected a number as in other rows"));
        }
    }
    let count = opening.robot.joint_reading_names().len();
    let numbers = width - usize::from(is_named);
    let is_whole = |row: &CellRow<'_>| row.1.first().is_some_and(|it| it.bytes().all(|it| it.is_ascii_digit()));
    match numbers {
        it if it == count && it != 3 => Ok(joints(rows, is_named.then_some("id"), opening)),
        it if it == count + 1 && it != 4 && !is_named && is_rising(&rows) => {
            Ok(joints(rows, Some("time[s]"), opening))
        }
        3 if count != 3 => Ok(points(rows, is_named)),
        4 if !is_named && count != 3 && count != 4 && rows.iter().all(is_whole) => Ok(points(rows, true)),
        _ => FileLine(first).refuse(format!(
            "found a table without names of columns, with {}{numbers} numbers in a row, expected {count} joint readings, with a time or a name \
             before them, or x, y, z of a point, with its name before them: put a line above that names the columns, or number them in a mapping \
             (--columns), like `position = {{ columns = [1, 2, 3] }}`",
            if is_named { "a name and " } else { "" }
        )),
    }
}

/// True if the first numbers increase from row to row, as times do.
fn is_rising(rows: &[CellRow<'_>]) -> bool {
    let first: Vec<f64> = rows.iter().filter_map(|it| number(it.1.first()?)).collect();
    first.len() > 1 && first.windows(2).all(|it| it[0] < it[1])
}

/// The table of all cells.
fn make_table(columns: impl IntoIterator<Item = impl Into<TableColumn>>, rows: Vec<CellRow<'_>>) -> MadeTable {
    let mut made = MadeTable::new(1, columns);
    rows.into_iter().for_each(|(line, cells)| made.row(line, cells.into_iter().map(CellValue::Text)));
    made
}

/// Joint readings, with a time or a name before them.
fn joints(rows: Vec<CellRow<'_>>, before: Option<&str>, opening: &OpeningContext<'_>) -> MadeTable {
    let names = opening.robot.joint_reading_names();
    let mut made = make_table(before.into_iter().chain(names.iter().map(String::as_str)), rows);
    let time = if before == Some("time[s]") { ", with the time before them" } else { "" };
    made.say(format!("{} rows of joint readings{time}", made.rows()));
    made
}

/// Points; names that recur are those of targets.
fn points(rows: Vec<CellRow<'_>>, is_named: bool) -> MadeTable {
    let first = rows.iter().filter(|_| is_named).filter_map(|it| it.1.first());
    let names: Vec<String> = first.map(|it| (*it).to_owned()).collect();
    let lines: Vec<usize> = rows.iter().map(|it| it.0).collect();
    let are_targets = is_named && are_targets(&names);
    let before = is_named.then_some(if are_targets { "target" } else { "id" });
    let mut made = make_table(before.into_iter().chain(["x", "y", "z"]), rows);
    let targets = if are_targets {
        format!(" of {} targets", names.iter().collect::<BTreeSet<_>>().len())
    } else {
        made.warned.extend(repeats(&names, &lines));
        String::new()
    };
    made.say(format!("{} points{targets}", made.rows()));
    made
}
