//! Tables without names of columns: joint readings, with a time or a name before them, and points with a name. Others need a mapping, which names
//! columns by their numbers.

use std::collections::BTreeSet;

use super::maker::{Made, Refused, Value};
use super::words::{are_targets, cells, lines, number, repeats};
use super::{Form, Opening};
use crate::Separator;
use crate::table::column_names::numbered_column;
use crate::table::mapping::ColumnMap;

pub(crate) const FORM: Form = Form { title: "a table without names of columns", is_it, table };

/// A row: a name, if there is one, and numbers.
struct Row<'t> {
    line: usize,
    name: Option<&'t str>,
    cells: Vec<&'t str>,
}

impl Row<'_> {
    /// The same with its first number as its name.
    fn named_by_number(self) -> Self {
        let Row { line, mut cells, .. } = self;
        let name = Some(cells.remove(0));
        Row { line, name, cells }
    }
}

/// Lines that are no comments.
fn content(text: &str) -> impl Iterator<Item = (usize, &str)> {
    lines(text).filter(|it| !it.1.trim_start().starts_with('#'))
}

fn is_it(text: &str, _: &Opening<'_>) -> bool {
    let is_row = |line: &str| {
        let cells = cells(line, Separator::recognised(line));
        let numbers = cells.iter().filter(|it| number(it).is_some()).count();
        numbers >= 3 && cells.len() <= numbers + 1
    };
    let mut some = content(text).take(2).peekable();
    some.peek().is_some() && some.all(|it| is_row(it.1))
}

fn table(text: &str, opening: &Opening<'_>) -> Result<Made, Refused> {
    let by = content(text).next().map_or(Separator::Comma, |it| Separator::recognised(it.1));
    let rows: Vec<(usize, Vec<&str>)> = content(text).map(|(line, it)| (line, cells(it, by))).collect();
    let width = rows.iter().map(|it| it.1.len()).max().unwrap_or_default();
    if let Some((line, cells)) = rows.iter().find(|it| it.1.len() != width) {
        let first = rows.first().map_or(0, |it| it.0);
        return Refused::at(
            *line,
            format!("found {} cells, expected {width} as in other lines from line {first} on", cells.len()),
        );
    }
    // Columns of measurements that this table does not have are of another one.
    let is_of_this = |map: &&ColumnMap| {
        map.names_columns() && (map.names_joints() || map.measured_numbers().is_none_or(|it| it <= width))
    };
    if opening.options.mapping.as_ref().filter(is_of_this).is_some() {
        let columns: Vec<String> = (1..=width).map(numbered_column).collect();
        let mut made = Made::new(1, columns.iter().map(String::as_str));
        rows.into_iter().for_each(|(line, cells)| made.row(line, cells.into_iter().map(Value::Text)));
        return Ok(made);
    }
    let is_named = rows.iter().any(|it| it.1.first().is_some_and(|it| number(it).is_none()));
    let named: Vec<Row<'_>> = (rows.into_iter())
        .map(|(line, mut cells)| {
            let name = is_named.then(|| cells.remove(0));
            Row { line, name, cells }
        })
        .collect();
    for row in &named {
        if let Some(bad) = row.cells.iter().find(|it| number(it).is_none()) {
            return Refused::at(row.line, format!("found `{bad}`, expected a number as in other rows"));
        }
    }
    let count = opening.robot.joint_reading_names().len();
    let numbers = width - usize::from(is_named);
    let is_whole =
        |row: &Row<'_>| row.cells.first().is_some_and(|it| it.bytes().all(|it| it.is_ascii_digit()));
    let is_counted = !is_named && named.iter().all(is_whole);
    match numbers {
        it if it == count && it != 3 => Ok(joints(named, opening, false)),
        it if it == count + 1 && it != 4 && !is_named && is_rising(&named) => {
            Ok(joints(named, opening, true))
        }
        3 if count != 3 => Ok(points(named)),
        4 if is_counted && count != 3 && count != 4 => {
            Ok(points(named.into_iter().map(Row::named_by_number).collect()))
        }
        _ => Refused::at(
            named.first().map_or(1, |it| it.line),
            format!(
                "found a table without names of columns, with {}{numbers} numbers in a row, expected {count} joint readings, with a time or a name \
                 before them, or x, y, z of a point, with its name before them: put a line above that names the columns, or number them in a mapping \
                 (--columns), like `position = {{ columns = [1, 2, 3] }}`",
                if is_named { "a name and " } else { "" }
            ),
        ),
    }
}

/// Whether the first numbers become larger from row to row, as times do.
fn is_rising(rows: &[Row<'_>]) -> bool {
    let first: Vec<f64> = rows.iter().filter_map(|it| number(it.cells.first()?)).collect();
    first.len() > 1 && first.windows(2).all(|it| it[0] < it[1])
}

fn joints(rows: Vec<Row<'_>>, opening: &Opening<'_>, is_timed: bool) -> Made {
    let is_named = rows.first().is_some_and(|it| it.name.is_some());
    let before = if is_timed { Some("time[s]") } else { is_named.then_some("id") };
    let names = opening.robot.joint_reading_names();
    let mut made = Made::new(1, before.into_iter().chain(names.iter().map(String::as_str)));
    for row in rows {
        made.row(row.line, row.name.into_iter().chain(row.cells).map(Value::Text));
    }
    made.said.push(format!(
        "{} rows of joint readings{}",
        made.rows(),
        if is_timed { ", with the time before them" } else { "" }
    ));
    made
}

/// Points; names that come again and again are those of targets.
fn points(rows: Vec<Row<'_>>) -> Made {
    let names: Vec<String> = rows.iter().filter_map(|it| it.name).map(str::to_owned).collect();
    let lines: Vec<usize> = rows.iter().map(|it| it.line).collect();
    let are_targets = !names.is_empty() && are_targets(&names);
    let before = (!names.is_empty()).then_some(if are_targets { "target" } else { "id" });
    let mut made = Made::new(1, before.into_iter().chain(["x", "y", "z"]));
    for row in rows {
        made.row(row.line, row.name.into_iter().chain(row.cells).map(Value::Text));
    }
    let targets = if are_targets {
        let different: BTreeSet<&String> = names.iter().collect();
        format!(" of {} targets", different.len())
    } else {
        made.warned.extend(repeats(&names, &lines));
        String::new()
    };
    made.said.push(format!("{} points{targets}", made.rows()));
    made
}
