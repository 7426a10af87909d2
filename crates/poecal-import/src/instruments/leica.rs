//! Poses and points in CSV of Leica's software for trackers. Columns have two blanks before their unit, uncertainties are expanded (`U(95)`), and
//! quaternions begin with their real part `Q0`.

use super::made_table::{CellValue, FileLine, MadeTable, Refusal, TableColumn};
use super::words::{HeadLine, lines, name_and_unit, quote_names};
use super::{FileForm, OpeningContext};

pub(crate) const FORM: FileForm = FileForm { title: "measurements of a Leica tracker", is_it, table };

/// The factor between the expanded uncertainty (95 %) of a normal distribution and its standard deviation.
const COVERAGE: f64 = 1.96;
/// Columns with a meaning, each with its name in our form.
const COLUMNS: [(&str, &str); 10] = [
    ("X", "x"),
    ("Y", "y"),
    ("Z", "z"),
    ("Q0", "qw"),
    ("Q1", "qx"),
    ("Q2", "qy"),
    ("Q3", "qz"),
    ("U(95) X", "sigma_x"),
    ("U(95) Y", "sigma_y"),
    ("U(95) Z", "sigma_z"),
];

/// Names of columns with their units.
type LeicaNames<'t> = Vec<(String, Option<&'t str>)>;

/// The header and the names in it.
fn head(text: &str) -> Option<(HeadLine<'_>, LeicaNames<'_>)> {
    let head = HeadLine::recognise(lines(text).next()?);
    let parts = head.names.iter().map(|it| name_and_unit(it, &[['[', ']']]));
    let one_blank = |name: &str| name.split_whitespace().collect::<Vec<_>>().join(" ");
    let names = parts.map(|(name, unit)| (one_blank(name), unit)).collect();
    Some((head, names))
}

fn is_it(text: &str, _: &OpeningContext<'_>) -> bool {
    let Some((_, names)) = head(text) else { return false };
    let has = |name: &str| names.iter().any(|it| it.0 == name);
    has("X") && has("Y") && has("Z") && (has("U(95)") || has("U(95) X"))
}

/// A column with a meaning: its index, whether it is an expanded uncertainty, and the column in our form.
type UsedColumn = (usize, bool, TableColumn);

/// Finds the columns with a meaning.
fn find_columns(head: &HeadLine<'_>, names: &LeicaNames<'_>) -> Result<Vec<UsedColumn>, Refusal> {
    let (mut used, mut turns) = (Vec::new(), 0);
    for (theirs, ours) in COLUMNS {
        let mut found = names.iter().enumerate().filter(|(_, it)| it.0 == theirs);
        let Some((at, (_, unit))) = found.next() else { continue };
        if found.next().is_some() {
            return FileLine(head.line).refuse(format!("found a second column `{theirs}`, expected one"));
        }
        let is_turn = theirs.starts_with('Q');
        turns += usize::from(is_turn);
        let is_expanded = ours.starts_with("sigma");
        let divided = if is_expanded { format!(" / {COVERAGE}") } else { String::new() };
        let own = head.names.get(at).copied().unwrap_or_default();
        let column = TableColumn::from(ours).made_of(|_| format!("{own}{divided}"));
        let column = match unit {
            _ if is_turn => column,
            Some(unit) => column.in_unit(unit),
            None => {
                return FileLine(head.line)
                    .refuse(format!("found the column `{theirs}` without a unit, expected one, as `{theirs} [mm]`"));
            }
        };
        used.push((at, is_expanded, column));
    }
    if matches!(turns, 0 | 4) {
        return Ok(used);
    }
    FileLine(head.line).refuse(format!("found {turns} of the columns Q0, Q1, Q2, Q3, expected all of them, or none"))
}

fn table(text: &str, _: &OpeningContext<'_>) -> Result<MadeTable, Refusal> {
    let (head, names) = head(text).ok_or("found no line")?;
    let used = find_columns(&head, &names)?;
    let mut made = MadeTable::new(head.line, used.iter().map(|it| it.2.clone()));
    for (line, found) in head.rows(text) {
        head.refuse_longer(line, &found, "the header")?;
        made.row(
            line,
            used.iter().map(|(at, is_expanded, _)| {
                let value = CellValue::cell_at(&found, *at);
                match value.number().filter(|_| *is_expanded) {
                    Some(expanded) => CellValue::Number(expanded / COVERAGE),
                    None => value,
                }
            }),
        );
    }
    made.say(format!("{} measurements", made.rows()));
    if names.iter().any(|it| it.0 == "U(95) X") {
        made.say(format!("U(95) divided by {COVERAGE} are the standard deviations"));
    }
    let is_left =
        |(at, it): &(usize, &(String, Option<&str>))| !it.0.is_empty() && !used.iter().any(|used| used.0 == *at);
    let left = quote_names(names.iter().enumerate().filter(is_left).map(|(_, it)| &it.0));
    if !left.is_empty() {
        made.say(format!("left out {left}"));
    }
    Ok(made)
}
