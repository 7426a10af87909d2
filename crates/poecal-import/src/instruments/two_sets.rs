//! Reports with two sets of coordinates in a row, nominal and measured, as robot makers write them: a table for each set, of which the robot
//! decides.

use super::maker::{Called, Made, Refused, Value};
use super::words::{cells, lines, number, quoted};
use super::{Form, Opening};
use crate::Separator;
use crate::table::header::bracketed;
use crate::table::roles::{Role, plain};

pub(crate) const FORM: Form = Form { title: "a report with two sets of coordinates", is_it, table };

/// Lines in which the header is sought.
const FIRST: usize = 20;
/// Coordinates; the angles behind them have as many conventions as makers.
const PLACE: [&str; 3] = ["x", "y", "z"];
const ANGLES: [&str; 12] = ["a", "b", "c", "rx", "ry", "rz", "w", "p", "r", "roll", "pitch", "yaw"];

/// A column.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Column {
    /// Of no set.
    Other,
    /// A coordinate of a set: its name with its unit, or an angle.
    Of { set: usize, name: Option<String> },
}

/// The sets of a table.
struct Sets {
    line: usize,
    by: Separator,
    columns: Vec<Column>,
    called: [Called; 2],
}

fn called(word: &str) -> Option<Called> {
    let of = [(Role::MeasuredSet, Called::Measured), (Role::NominalSet, Called::Nominal)];
    of.into_iter().find(|it| it.0.has(word)).map(|it| it.1)
}

/// A name of a column as a coordinate, with what its set is called.
fn coordinate(name: &str) -> Option<(&'static str, Option<Called>)> {
    let all = || PLACE.into_iter().chain(ANGLES);
    if let Some(known) = all().find(|it| *it == name) {
        return Some((known, None));
    }
    // The longest one, since `rx` ends with `x` too.
    let of = |known: &'static str| {
        let word = name.strip_suffix(known).or_else(|| name.strip_prefix(known))?;
        Some((known, Some(called(word)?)))
    };
    all().filter_map(of).max_by_key(|it| it.0.len())
}

/// A cell of a header without its unit, and the unit.
fn parts(cell: &str) -> (&str, Option<&str>) {
    let found = bracketed(cell, '[', ']').or_else(|| bracketed(cell, '(', ')'));
    found.map_or((cell.trim(), None), |(name, unit)| (name.trim(), Some(unit)))
}

impl Sets {
    /// The sets that a line names, below another one that may name what they are.
    fn of((line, text): (usize, &str), above: Option<&str>) -> Option<Self> {
        let by = Separator::recognised(text);
        let cells = cells(text, by);
        // A word of the line above stands over all columns up to the next one.
        let mut words: Vec<Option<Called>> = Vec::with_capacity(cells.len());
        let over = above.map(|it| super::words::cells(it, by)).unwrap_or_default();
        for at in 0..cells.len() {
            let word = over.get(at).map(|it| plain(it)).filter(|it| !it.is_empty());
            words.push(match word {
                Some(word) => called(&word),
                None => words.last().copied().flatten(),
            });
        }
        let found: Vec<Option<(&str, Option<Called>)>> = cells
            .iter()
            .zip(&words)
            .map(|(cell, over)| coordinate(&plain(parts(cell).0)).map(|(name, own)| (name, own.or(*over))))
            .collect();
        let named = |it: Called| found.iter().flatten().any(|found| found.1 == Some(it) && found.0 == "x");
        let are_named = named(Called::Nominal) && named(Called::Measured);
        let mut seen: [Vec<&str>; 2] = Default::default();
        let mut columns = Vec::with_capacity(cells.len());
        for (found, cell) in found.iter().zip(&cells) {
            let set = found.and_then(|(name, own)| {
                let set = match (are_named, own) {
                    (true, Some(Called::Nominal)) => 0,
                    (true, Some(Called::Measured)) => 1,
                    (true, _) => return None,
                    (false, _) => usize::from(seen[0].contains(&name)),
                };
                Some((name, set))
            });
            columns.push(match set {
                Some((name, set)) => {
                    if seen[set].contains(&name) {
                        return None;
                    }
                    seen[set].push(name);
                    let unit = parts(cell).1.map_or_else(String::new, |unit| format!("[{unit}]"));
                    Column::Of { set, name: PLACE.contains(&name).then(|| format!("{name}{unit}")) }
                }
                None => Column::Other,
            });
        }
        let has_all = |seen: &Vec<&str>| PLACE.iter().all(|it| seen.contains(it));
        let called = if are_named { [Called::Nominal, Called::Measured] } else { [Called::Unnamed; 2] };
        (seen.iter().all(has_all) && seen[0].len() == seen[1].len()).then_some(Sets {
            line,
            by,
            columns,
            called,
        })
    }

    /// The sets of a text.
    fn of_text(text: &str) -> Option<Self> {
        let some: Vec<(usize, &str)> = lines(text).take(FIRST).collect();
        (0..some.len()).find_map(|at| {
            let line = *some.get(at)?;
            let is_table = cells(line.1, Separator::recognised(line.1)).iter().all(|it| number(it).is_none());
            let above = at.checked_sub(1).and_then(|at| some.get(at)).map(|it| it.1);
            if is_table { Sets::of(line, above) } else { None }
        })
    }

    /// The table of a set.
    fn table(&self, text: &str, set: usize) -> Result<Made, Refused> {
        let header = lines(text).find(|it| it.0 == self.line).map_or("", |it| it.1);
        let header = cells(header, self.by);
        let is_taken = |column: &Column| match column {
            Column::Other => true,
            Column::Of { set: own, name } => *own == set && name.is_some(),
        };
        let names =
            header.iter().zip(&self.columns).filter(|it| is_taken(it.1)).map(|(cell, column)| match column {
                Column::Of { name: Some(name), .. } => name.as_str(),
                Column::Of { name: None, .. } | Column::Other => cell,
            });
        let mut made = Made::new(self.line, names);
        let width = self.columns.len();
        for (line, content) in lines(text).filter(|it| it.0 > self.line) {
            let found = cells(content, self.by);
            if found.len() > width {
                return Refused::at(
                    line,
                    format!(
                        "found {} cells, expected {width} as in the header (line {})",
                        found.len(),
                        self.line
                    ),
                );
            }
            let cell = |at: usize| found.get(at).map_or(Value::Empty, |it| Value::Text(it));
            let taken = self.columns.iter().enumerate().filter(|it| is_taken(it.1));
            made.row(line, taken.map(|it| cell(it.0)));
        }
        let has_angles = self.columns.iter().any(|it| matches!(it, Column::Of { name: None, .. }));
        if has_angles {
            made.said.push(
                "the positions alone, since angles do not say their convention, which a mapping does (--columns)".to_owned(),
            );
        }
        Ok(made)
    }
}

fn is_it(text: &str, _: &Opening<'_>) -> bool {
    Sets::of_text(text).is_some()
}

fn table(text: &str, _: &Opening<'_>) -> Result<Made, Refused> {
    let Some(sets) = Sets::of_text(text) else { return Refused::whole("found no header") };
    let (first, second) = (sets.table(text, 0)?, sets.table(text, 1)?);
    if first.rows() == 0 {
        return Refused::at(
            sets.line,
            format!("found a header and no rows, expected rows below {}", quoted(["x"])),
        );
    }
    Ok(first.with_other(sets.called, second))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_those_of_words_before_behind_and_above() {
        for (text, called) in [
            (
                "id,Nominal X (mm),Nominal Y (mm),Nominal Z (mm),Measured X (mm),Measured Y (mm),Measured Z (mm)\n",
                [Called::Nominal, Called::Measured],
            ),
            (
                "No.;x_nom;y_nom;z_nom;a_nom;b_nom;c_nom;x_act;y_act;z_act;a_act;b_act;c_act\n",
                [Called::Nominal, Called::Measured],
            ),
            (
                "report\n,Measured,,,Nominal,,\nP,x[mm],y[mm],z[mm],x[mm],y[mm],z[mm]\n",
                [Called::Nominal, Called::Measured],
            ),
            ("X\tY\tZ\tA\tB\tC\tX\tY\tZ\tA\tB\tC\n", [Called::Unnamed; 2]),
        ] {
            let sets = Sets::of_text(text).unwrap_or_else(|| panic!("{text}"));
            assert_eq!(sets.called, called, "{text}");
        }
        // The one that is measured first.
        let text = "Measured,,,Nominal,,\nx[mm],y[mm],z[mm],x[mm],y[mm],z[mm]\n1,2,3,4,5,6\n";
        let Ok(made) = Sets::of_text(text).unwrap().table(text, 1) else { panic!() };
        assert_eq!(made.rows(), 1);
        for text in
            ["joint1,joint2,x,y,z\n1,2,3,4,5\n", "x,y,z,a,b,c\n", "nominal x,nominal y,x,y,z\n", "1,2,3\n"]
        {
            assert!(Sets::of_text(text).is_none(), "{text}");
        }
    }
}
