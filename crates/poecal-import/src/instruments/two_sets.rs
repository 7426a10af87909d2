//! Reports of robot makers with two sets of coordinates in a row, nominal and measured. Each set is a table, and the robot decides which one is
//! taken.

use super::made_table::{CellValue, CoordinateName, FileLine, MadeTable, Refusal, TableColumn};
use super::words::{HeadLine, lines, name_and_unit, number};
use super::{FileForm, OpeningContext};
use crate::table::roles::{ColumnRole, plain_letters};

pub(crate) const FORM: FileForm = FileForm { title: "a report with two sets of coordinates", is_it, table };

/// Number of lines in which the header is sought.
const FIRST: usize = 20;
/// Names of coordinates; the conventions of the angles behind them differ by maker.
const PLACE: [&str; 3] = ["x", "y", "z"];
const ANGLES: [&str; 12] = ["a", "b", "c", "rx", "ry", "rz", "w", "p", "r", "roll", "pitch", "yaw"];

/// Role of a column of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SetColumn {
    /// Column of no set.
    Other,
    /// A coordinate of a set.
    Place(usize, &'static str),
    /// An angle of a set.
    Angle,
}

/// The sets of a table.
struct Sets<'t> {
    head: HeadLine<'t>,
    parts: Vec<SetColumn>,
    called: [CoordinateName; 2],
}

fn coordinate_name(word: &str) -> Option<CoordinateName> {
    let of = [(ColumnRole::MeasuredSet, CoordinateName::Measured), (ColumnRole::NominalSet, CoordinateName::Nominal)];
    of.into_iter().find(|it| it.0.has(word)).map(|it| it.1)
}

/// The coordinate that the name of a column states, with the name of its set.
fn coordinate(name: &str) -> Option<(&'static str, Option<CoordinateName>)> {
    let all = || PLACE.into_iter().chain(ANGLES);
    if let Some(known) = all().find(|it| *it == name) {
        return Some((known, None));
    }
    // The longest one, since `rx` ends with `x` too.
    let of = |known: &'static str| {
        let word = name.strip_suffix(known).or_else(|| name.strip_prefix(known))?;
        Some((known, Some(coordinate_name(word)?)))
    };
    all().filter_map(of).max_by_key(|it| it.0.len())
}

/// The name and the unit of a column.
fn parts(cell: &str) -> (&str, Option<&str>) {
    name_and_unit(cell, &[['[', ']'], ['(', ')']])
}

/// The columns of two sets by their names and by the words above them; such a word applies to all columns up to the next one.
fn sort(names: &[&str], over: &[&str]) -> Option<(Vec<SetColumn>, [CoordinateName; 2])> {
    let mut word = None;
    let mut found: Vec<Option<(&str, Option<CoordinateName>)>> = Vec::with_capacity(names.len());
    for (at, cell) in names.iter().enumerate() {
        let own = over.get(at).map(|it| plain_letters(it)).filter(|it| !it.is_empty());
        word = own.map_or(word, |it| coordinate_name(&it));
        found.push(coordinate(&plain_letters(parts(cell).0)).map(|(name, own)| (name, own.or(word))));
    }
    let named = |it: CoordinateName| found.contains(&Some(("x", Some(it))));
    let are_named = named(CoordinateName::Nominal) && named(CoordinateName::Measured);
    let mut seen: [Vec<&str>; 2] = Default::default();
    let mut of_sets = Vec::with_capacity(found.len());
    for coordinate in found {
        let set = coordinate.and_then(|(name, own)| match (are_named, own) {
            (true, Some(CoordinateName::Nominal)) => Some((name, 0)),
            (true, Some(CoordinateName::Measured)) => Some((name, 1)),
            (true, _) => None,
            (false, _) => Some((name, usize::from(seen[0].contains(&name)))),
        });
        let Some((name, set)) = set else {
            of_sets.push(SetColumn::Other);
            continue;
        };
        if seen[set].contains(&name) {
            return None;
        }
        seen[set].push(name);
        let place = PLACE.into_iter().find(|it| *it == name);
        of_sets.push(place.map_or(SetColumn::Angle, |it| SetColumn::Place(set, it)));
    }
    let has_all = |seen: &Vec<&str>| PLACE.iter().all(|it| seen.contains(it));
    let called =
        if are_named { [CoordinateName::Nominal, CoordinateName::Measured] } else { [CoordinateName::Unnamed; 2] };
    (seen.iter().all(has_all) && seen[0].len() == seen[1].len()).then_some((of_sets, called))
}

/// The columns of a set and of no set, with their names.
fn columns(names: &[&str], of: &[SetColumn], set: usize) -> Vec<(usize, TableColumn)> {
    let column = |(at, part): (usize, &SetColumn)| {
        let cell = *names.get(at)?;
        match part {
            SetColumn::Other => Some((at, TableColumn::from(cell))),
            SetColumn::Place(own, name) if *own == set => {
                let unit = parts(cell).1;
                let column = TableColumn::from(*name);
                Some((at, unit.map_or(column.clone(), |unit| column.in_unit(unit))))
            }
            SetColumn::Place(..) | SetColumn::Angle => None,
        }
    };
    of.iter().enumerate().filter_map(column).collect()
}

/// Columns of each of two sets.
#[cfg(feature = "workbooks")]
type SetColumns = [Vec<(usize, TableColumn)>; 2];

/// The columns of each of two sets, by their names, with the names of the sets.
#[cfg(feature = "workbooks")]
pub(super) fn split(names: &[&str]) -> Option<(SetColumns, [CoordinateName; 2])> {
    let (parts, called) = sort(names, &[])?;
    Some(([0, 1].map(|set| columns(names, &parts, set)), called))
}

impl<'t> Sets<'t> {
    /// The sets in a line with their names, which may be in the line above.
    fn from_line(line: (usize, &'t str), above: Option<(usize, &'t str)>) -> Option<Self> {
        let head = HeadLine::recognise(line);
        if head.names.iter().any(|it| number(it).is_some()) {
            return None;
        }
        let over = above.map(|it| HeadLine::from_line(it, head.by).names).unwrap_or_default();
        let (parts, called) = sort(&head.names, &over)?;
        Some(Sets { head, parts, called })
    }

    /// The sets of a text.
    fn of_text(text: &'t str) -> Option<Self> {
        let some: Vec<(usize, &str)> = lines(text).take(FIRST).collect();
        let above = std::iter::once(None).chain(some.iter().copied().map(Some));
        some.iter().zip(above).find_map(|(line, above)| Sets::from_line(*line, above))
    }

    /// The table of a set.
    fn table(&self, text: &'t str, set: usize) -> Result<MadeTable, Refusal> {
        let (taken, columns): (Vec<usize>, Vec<TableColumn>) =
            columns(&self.head.names, &self.parts, set).into_iter().unzip();
        let mut made = MadeTable::new(self.head.line, columns);
        let header = format!("the header (line {})", self.head.line);
        for (line, found) in self.head.rows(text) {
            self.head.refuse_longer(line, &found, &header)?;
            made.row(line, taken.iter().map(|at| CellValue::cell_at(&found, *at)));
        }
        if self.parts.contains(&SetColumn::Angle) {
            made.say(
                "the positions alone, since angles do not state their convention, which a mapping does (--columns)",
            );
        }
        Ok(made)
    }
}

/// True if a text has two sets of coordinates and the robot reads neither, unlike in a test of commanded poses.
fn is_it(text: &str, opening: &OpeningContext<'_>) -> bool {
    let names = opening.robot.reading_names();
    let is_of_set = |name: &String| coordinate(&plain_letters(name)).is_some_and(|it| it.1.is_some());
    let is_read = !names.is_empty() && names.iter().all(is_of_set);
    !is_read && Sets::of_text(text).is_some()
}

fn table(text: &str, _: &OpeningContext<'_>) -> Result<MadeTable, Refusal> {
    let sets = Sets::of_text(text).ok_or("found no header")?;
    let (first, second) = (sets.table(text, 0)?, sets.table(text, 1)?);
    if first.rows() == 0 {
        return FileLine(sets.head.line).refuse("found a header and no rows, expected rows below `x`");
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
                [CoordinateName::Nominal, CoordinateName::Measured],
            ),
            (
                "No.;x_nom;y_nom;z_nom;a_nom;b_nom;c_nom;x_act;y_act;z_act;a_act;b_act;c_act\n",
                [CoordinateName::Nominal, CoordinateName::Measured],
            ),
            (
                "report\n,Measured,,,Nominal,,\nP,x[mm],y[mm],z[mm],x[mm],y[mm],z[mm]\n",
                [CoordinateName::Nominal, CoordinateName::Measured],
            ),
            ("X\tY\tZ\tA\tB\tC\tX\tY\tZ\tA\tB\tC\n", [CoordinateName::Unnamed; 2]),
        ] {
            let sets = Sets::of_text(text).unwrap_or_else(|| panic!("{text}"));
            assert_eq!(sets.called, called, "{text}");
        }
        // The one that is measured first.
        let text = "Measured,,,Nominal,,\nx[mm],y[mm],z[mm],x[mm],y[mm],z[mm]\n1,2,3,4,5,6\n";
        let Ok(made) = Sets::of_text(text).unwrap().table(text, 1) else { panic!() };
        assert_eq!(made.rows(), 1);
        for text in ["joint1,joint2,x,y,z\n1,2,3,4,5\n", "x,y,z,a,b,c\n", "nominal x,nominal y,x,y,z\n", "1,2,3\n"] {
            assert!(Sets::of_text(text).is_none(), "{text}");
        }
    }
}
