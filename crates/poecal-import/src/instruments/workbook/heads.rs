//! Heads of tables in sheets: a row of names, or two with groups above them, a row of units below. Lines of statistics may be at the end.

use calamine::Data;

use super::super::workbook_cells::{is_empty, text, value};
use crate::table::header_cells::split_brackets;
use crate::table::roles::{plain_letters, unit_of};

/// Number of rows in which the header is sought.
const FIRST: usize = 60;
/// Smallest number of columns of a table.
const FEWEST_COLUMNS: usize = 3;
/// Names of lines that summarise the rows above them, only their letters.
const SUMS: &str = "average avg mean meanvalue max min maximum minimum std stdev stddev stddeviation standarddeviation sd rms sum total median range spread \
                    variance var count sigma σ ø mittelwert mittel standardabweichung streuung spannweite varianz anzahl summe";

/// The head of a table.
pub(super) struct SheetHead {
    pub(super) names: Vec<String>,
    /// The row that names the columns, the last of two.
    pub(super) header: usize,
    pub(super) units: Option<usize>,
    /// The first row of numbers.
    pub(super) begin: usize,
    /// True if a row of groups is above the names.
    pub(super) is_two: bool,
}

fn is_text(cell: &&Data) -> bool {
    matches!(cell, Data::String(_)) && value(cell).is_none() && !is_empty(cell)
}

/// The first head with rows of numbers below.
pub(super) fn head(rows: &[&[Data]]) -> Option<SheetHead> {
    (0..rows.len().min(FIRST)).find_map(|at| two_lines(rows, at).or_else(|| one_line(rows, at)))
}

/// The row of units, if any, and the first row of numbers below the header, if half of the columns with names have numbers.
fn begin(rows: &[&[Data]], header: usize, is_named: impl Fn(usize) -> bool) -> Option<(Option<usize>, usize)> {
    let is_blank = |row: &&[Data]| row.iter().all(is_empty);
    let first = header + 1 + rows.iter().skip(header + 1).position(|it| !is_blank(it))?;
    let has_numbers = rows.get(first).is_some_and(|it| it.iter().any(|it| value(it).is_some()));
    let begin = if has_numbers { first } else { first + 1 };
    let row = rows.get(begin)?;
    let named = || (0..row.len()).filter(|at| is_named(*at));
    let numbers = named().filter(|at| row.get(*at).is_some_and(|it| value(it).is_some())).count();
    (2 * numbers >= named().count()).then_some(((!has_numbers).then_some(first), begin))
}

/// A row of texts.
fn one_line(rows: &[&[Data]], header: usize) -> Option<SheetHead> {
    let row = rows.get(header)?;
    let texts = row.iter().filter(is_text).count();
    if texts < FEWEST_COLUMNS || row.iter().any(|it| !is_empty(it) && !is_text(&it)) {
        return None;
    }
    let (units, begin) = begin(rows, header, |at| row.get(at).is_some_and(|it| !is_empty(it)))?;
    let columns = row.iter().rposition(|it| !is_empty(it)).map_or(0, |it| it + 1);
    Some(SheetHead { names: row.iter().take(columns).map(text).collect(), header, units, begin, is_two: false })
}

/// A row of groups, each over one column or several, and a row of names or of numbers that count from 1.
fn two_lines(rows: &[&[Data]], above: usize) -> Option<SheetHead> {
    let (over, under) = (rows.get(above)?, rows.get(above + 1)?);
    let cells = |row: &[Data], at: usize| row.get(at).map_or_else(String::new, text);
    let width = [over, under].into_iter().filter_map(|row| row.iter().rposition(|it| !is_empty(it))).max()? + 1;
    let (over_texts, names): (Vec<String>, Vec<String>) =
        (0..width).map(|at| (cells(over, at), cells(under, at))).unzip();
    let counted = |at: &usize| under.get(*at).and_then(value);
    let numbers: Vec<f64> = (0..width).filter_map(|at| counted(&at)).collect();
    let is_counted = (1_u32..).zip(&numbers).all(|(expected, found)| f64::from(expected) == *found);
    let is_unit = |name: &String| unit_of(name.trim_matches(['[', ']', '(', ')'])).is_some();
    let is_name = |at: usize| names.get(at).is_some_and(|it| !it.is_empty() && !is_unit(it));
    let mut group = None;
    let mut has_span = false;
    let mut found = Vec::with_capacity(width);
    for (at, (own, name)) in over_texts.iter().zip(&names).enumerate() {
        has_span |= own.is_empty() && group.is_some() && is_name(at);
        group = if own.is_empty() { group } else { Some(own) };
        let is_number = counted(&at).is_some();
        let is_again = names.iter().filter(|it| plain_letters(it) == plain_letters(name)).count() > 1;
        found.push(match group {
            Some(group) if !name.is_empty() => join_names(group, name, is_number || is_again || is_unit(name)),
            Some(group) if !own.is_empty() => group.clone(),
            _ => name.clone(),
        });
    }
    let are_texts = over.iter().all(|it| is_empty(it) || is_text(&it)) && over.iter().any(|it| is_text(&it));
    let is_head =
        are_texts && is_counted && has_span && found.iter().filter(|it| !it.is_empty()).count() >= FEWEST_COLUMNS;
    let (units, begin) =
        begin(rows, above + 1, |at| found.get(at).is_some_and(|it| !it.is_empty())).filter(|_| is_head)?;
    Some(SheetHead { names: found, header: above + 1, units, begin, is_two: true })
}

/// A name below a group: with its words if other names are the same, and always with its unit.
fn join_names(group: &str, name: &str, with_words: bool) -> String {
    let parts = |cell: &str| -> (String, Option<String>) {
        let found = [('[', ']'), ('(', ')')].into_iter().find_map(|(open, close)| split_brackets(cell, open, close));
        let found = found.filter(|it| unit_of(it.1.trim()).is_some());
        found.map_or((cell.trim().to_owned(), None), |(name, unit)| {
            (name.trim().to_owned(), Some(unit.trim().to_owned()))
        })
    };
    let ((words, of_group), (own, unit)) = (parts(group), parts(name));
    let bare = name.trim_matches(['[', ']', '(', ')']);
    let (own, unit) = if unit_of(bare).is_some() { (String::new(), Some(bare.to_owned())) } else { (own, unit) };
    let both = if with_words { format!("{words} {own}") } else { own };
    unit.or(of_group).map_or(both.trim().to_owned(), |unit| format!("{} [{unit}]", both.trim()))
}

/// True for a row that summarises those above it: its whole name, except a unit in brackets, is such a word.
pub(super) fn is_sum(row: &[Data]) -> bool {
    let first = row.iter().find(|it| !is_empty(it)).filter(is_text);
    first.is_some_and(|it| {
        let name = text(it);
        let name = plain_letters(name.split(['(', '[']).next().unwrap_or_default());
        SUMS.split_whitespace().any(|word| name == word)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_named_by_whole_words() {
        let is_sum = |name: &str| is_sum(&[Data::Empty, Data::String(name.to_owned()), Data::Float(1.0)]);
        for name in ["Max.", "RANGE", "Ø", "Std. dev.", "Mean [mm]", "Streuung", "Σ"] {
            assert!(is_sum(name), "{name}");
        }
        for name in ["Max reach", "Minimal", "Meanwhile", "P1"] {
            assert!(!is_sum(name), "{name}");
        }
    }
}
