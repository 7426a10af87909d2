//! Points that SpatialAnalyzer exported as text, in every layout of its dialogue (manual, *Exporting ASCII formatted points*). Columns are
//! collection, group and name, index, coordinates, offsets, uncertainties and time, separated by commas or blanks.

use std::collections::BTreeSet;

use super::made_table::{CellValue, FileLine, MadeTable, Refusal, TableColumn, place};
use super::words::{are_targets, cells, is_no_number, lines, number, repeats};
use super::{FileForm, OpeningContext};
use crate::Separator;

pub(crate) const FORM: FileForm = FileForm { title: "points of SpatialAnalyzer", is_it, table };

/// Number of lines in which the comments are sought.
const FIRST: usize = 20;

/// Statements of the comments.
struct Comments<'t> {
    frame: Option<&'t str>,
    is_cylindrical: bool,
    unit: &'t str,
}

/// A line, split into its parts.
struct PointLine<'t> {
    line: usize,
    names: Vec<&'t str>,
    numbers: Vec<&'t str>,
    /// True if a time is behind the numbers.
    has_time: bool,
}

/// Meaning of the numbers of a line.
struct PointColumns {
    /// Numbers before the coordinates: a name that is a number, and the index of a point in its group.
    first: usize,
    /// True if the first of these is the name.
    is_named_by_number: bool,
    has_offsets: bool,
    has_uncertainties: bool,
}

/// The text of a comment.
fn comment(line: &str) -> Option<&str> {
    line.trim().strip_prefix("//")
}

fn is_it(text: &str, _: &OpeningContext<'_>) -> bool {
    let marks = ["SpatialAnalyzer", "Relative to Coordinate Frame", "AXES ="];
    let mut comments = lines(text).take(FIRST).filter_map(|it| comment(it.1));
    comments.any(|line| marks.iter().any(|it| line.contains(it)))
}

fn table(text: &str, _: &OpeningContext<'_>) -> Result<MadeTable, Refusal> {
    let Comments { frame, is_cylindrical, unit } = Comments::from_text(text)?;
    let points = lines(text).filter(|it| comment(it.1).is_none());
    let point =
        |(line, content): (usize, _)| PointLine::from_line(line, content).or_else(|why| FileLine(line).refuse(why));
    let points: Vec<PointLine<'_>> = points.map(point).collect::<Result<_, _>>()?;
    let first = points.first().ok_or("found comments of SpatialAnalyzer and no point, expected at least one")?;
    refuse_unlike(first, &points)?;
    let layout = PointColumns::from_points(first, &points).or_else(|why| FileLine(first.line).refuse(why))?;
    let (names, have_targets) = layout.names(&points);
    let sigmas = ["sigma_x", "sigma_y", "sigma_z"].map(|it| TableColumn::from(it).in_unit(unit));
    let columns = std::iter::once(TableColumn::from(if have_targets { "target" } else { "id" }))
        .chain(place(unit))
        .chain(sigmas.into_iter().filter(|_| layout.has_uncertainties));
    let mut made = MadeTable::new(first.line, columns);
    for (point, name) in points.iter().zip(&names) {
        let numbers = point.numbers.get(layout.first..).unwrap_or_default();
        let mut row: Vec<CellValue<'_>> = numbers.iter().map(|it| CellValue::Text(it)).collect();
        if let ([radius, angle, ..], true) = (numbers, is_cylindrical) {
            let (radius, angle) = (number(radius).unwrap_or_default(), number(angle).unwrap_or_default());
            let (sine, cosine) = angle.to_radians().sin_cos();
            row.splice(..2, [radius * cosine, radius * sine].map(CellValue::Number));
        }
        if layout.has_offsets {
            row.drain(3..5);
        }
        made.row(point.line, std::iter::once(CellValue::Text(name)).chain(row));
    }
    let count = points.len();
    made.say(match frame {
        Some(frame) => format!("{count} points in frame `{frame}`, {unit}"),
        None => format!("{count} points, {unit}"),
    });
    made.frame = frame.map(str::to_owned);
    if is_cylindrical {
        made.say("cylindrical coordinates became x, y, z");
    }
    if layout.has_offsets {
        made.say("two offsets of each point are left out");
    }
    if layout.has_uncertainties {
        made.say("three uncertainties of each point are taken as standard deviations of x, y, z");
    }
    if have_targets {
        made.say(format!("names come again, and are those of {} targets", count_different(&names)));
    } else {
        let lines: Vec<usize> = points.iter().map(|it| it.line).collect();
        made.warned.extend(repeats(&names, &lines));
    }
    Ok(made)
}

/// Number of different names.
fn count_different(names: &[String]) -> usize {
    names.iter().collect::<BTreeSet<_>>().len()
}

/// Refuses points whose lines differ in form.
fn refuse_unlike(first: &PointLine<'_>, points: &[PointLine<'_>]) -> Result<(), Refusal> {
    let counts = |it: &PointLine<'_>| (it.names.len(), it.numbers.len());
    let (words, count) = counts(first);
    if let Some(other) = points.iter().find(|it| counts(it) != (words, count)) {
        let (own_words, own_count) = counts(other);
        return FileLine(other.line).refuse(format!(
            "found {own_words} names and {own_count} numbers, expected {words} and {count} as in line {}",
            first.line
        ));
    }
    // A line that was cut has no time, and its last number may be incomplete.
    let timed = points.iter().filter(|it| it.has_time).count();
    match points.iter().find(|it| 2 * timed > points.len() && !it.has_time) {
        Some(other) => FileLine(other.line).refuse("found no time behind the numbers of a point, expected one as in the other lines: the line was cut, export the points again, or leave it out"),
        None => Ok(()),
    }
}

impl<'t> Comments<'t> {
    fn from_text(text: &'t str) -> Result<Self, Refusal> {
        let frame = find_stated(text, "Coordinate Frame", "the frame")?.map(|it| it.1);
        let Some((line, axes)) = find_stated(text, "AXES", "axes and unit")? else {
            return Refusal::refuse_whole(
                "found points of SpatialAnalyzer without the line `// AXES = …` that states their unit, expected it: export them with comments, or \
                 name the columns by number in a mapping (--columns)",
            );
        };
        let kind = axes.trim_start_matches([' ', '=']).to_ascii_uppercase();
        let units = axes.rsplit_once('(').map_or("", |it| it.1).trim_end_matches([')', ' ']);
        let mut units = units.split(',').map(str::trim);
        let (unit, angle) = (units.next().unwrap_or_default(), units.next());
        let is_degrees = angle.is_none_or(|it| it.to_ascii_lowercase().starts_with("deg"));
        let is_cylindrical = match kind.split([':', ' ']).next() {
            Some("CARTESIAN") => false,
            Some("CYLINDRICAL") => true,
            _ => {
                return FileLine(line).refuse("found coordinates that are neither Cartesian nor cylindrical, expected x, y and z: export the points as Cartesian");
            }
        };
        if unit.is_empty() {
            return FileLine(line).refuse("found no unit in brackets, as `(mm)`, expected one");
        }
        if is_cylindrical && !is_degrees {
            return FileLine(line)
                .refuse("found angles in another unit than degrees, expected deg: export the points as Cartesian");
        }
        Ok(Comments { frame, is_cylindrical, unit })
    }
}

/// The word that the comments state behind a key, with its line. A table cannot separate points of several frames or units.
fn find_stated<'t>(text: &'t str, key: &str, what: &str) -> Result<Option<(usize, &'t str)>, Refusal> {
    let mut all = lines(text).filter_map(|(line, content)| {
        let behind = comment(content)?.split_once(key)?.1.trim_matches([' ', '=', '\'', '"']);
        Some((line, behind))
    });
    let Some(first) = all.next() else { return Ok(None) };
    match all.find(|it| it.1 != first.1) {
        Some((line, other)) => FileLine(line).refuse(format!(
            "found `{other}` as {what} of the points below, and `{}` above, expected one in a file: write the points of each into a file of its own",
            first.1
        )),
        None => Ok(Some(first)),
    }
}

impl<'t> PointLine<'t> {
    /// The point of a line, or the defect of the line.
    fn from_line(line: usize, content: &'t str) -> Result<Self, String> {
        let content = content.trim();
        if content.contains(';') {
            return Err("found `;` between the cells of a point, expected commas or blanks: export the points again, or replace it".to_owned());
        }
        let is_by_commas = content.contains(',');
        let mut parts: Vec<&str> =
            if is_by_commas { cells(content, Separator::Comma) } else { content.split_whitespace().collect() };
        // The time, `02/12/25 16:52:45`, is one cell or two.
        let is_time =
            |it: &&str| it.contains('/') || it.contains(':') && !it.contains("::") || matches!(*it, "AM" | "PM");
        let end = parts.iter().rposition(|it| !is_time(it)).map_or(0, |it| it + 1);
        let has_time = end < parts.len();
        parts.truncate(end);
        if let Some(word) = parts.iter().skip(1).find(|it| is_no_number(it)) {
            return Err(format!(
                "found `{word}` in place of a number, expected a coordinate: leave out the line of a point that was not measured"
            ));
        }
        let count = parts.iter().rev().take_while(|it| number(it).is_some()).count();
        if count < 3 {
            return Err(format!(
                "found {count} numbers behind the name of a point, expected its coordinates, at least three"
            ));
        }
        let numbers = parts.split_off(parts.len() - count);
        // A name may contain blanks.
        if let ([first, .., last], false) = (parts.as_slice(), is_by_commas) {
            let of = |part: &str| part.as_ptr() as usize - content.as_ptr() as usize;
            parts = content.get(of(first)..of(last) + last.len()).into_iter().collect();
        }
        Ok(PointLine { line, names: parts, numbers, has_time })
    }
}

impl PointColumns {
    /// The meaning of the numbers of points, of which this is the first one.
    fn from_points(first: &PointLine<'_>, points: &[PointLine<'_>]) -> Result<Self, String> {
        let is_digits = |it: &str| it.bytes().all(|it| it.is_ascii_digit());
        let is_whole = |at: usize| points.iter().all(|it| it.numbers.get(at).is_some_and(|it| is_digits(it)));
        // A point has a name in any case: it may be a number.
        let is_named_by_number = first.names.is_empty() && is_whole(0);
        let named = usize::from(is_named_by_number);
        let count = first.numbers.len() - named;
        let has_index = matches!(count, 4 | 6 | 7 | 9) && is_whole(named);
        let rest = count - usize::from(has_index);
        let mut all = points.iter().flat_map(|it| it.numbers.iter().skip(named));
        let all_whole = all.all(|it| is_digits(it.trim_start_matches(['+', '-'])));
        if all_whole && rest >= 6 {
            return Err(format!(
                "found {rest} whole numbers of a point and no decimal point, expected three coordinates: decimal commas are cells of their own, export \
                 the points with decimal points"
            ));
        }
        // The index of a point in its group, and two coordinates.
        if count == 3 && points.len() > 2 && is_whole(named) && !all_whole {
            return Err("found whole numbers alone as the first of three coordinates, as of the index of a point, expected x, y and z: a column was lost".to_owned());
        }
        if !matches!(rest, 3 | 5 | 6 | 8) {
            return Err(format!(
                "found {rest} numbers of a point, expected three coordinates, and with them two offsets, three uncertainties, or both"
            ));
        }
        let first = named + usize::from(has_index);
        let (has_offsets, has_uncertainties) = (matches!(rest, 5 | 8), rest >= 6);
        Ok(PointColumns { first, is_named_by_number, has_offsets, has_uncertainties })
    }

    /// The points' names, and whether they are those of targets, since they recur.
    fn names(&self, points: &[PointLine<'_>]) -> (Vec<String>, bool) {
        let parts = |point: &PointLine<'_>| -> Vec<String> {
            let words = point.names.iter().flat_map(|it| it.split("::")).map(str::trim);
            let number = point.numbers.first().filter(|_| self.is_named_by_number);
            words.chain(number.copied()).map(str::to_owned).collect()
        };
        let parts: Vec<Vec<String>> = points.iter().map(parts).collect();
        let last: Vec<String> = parts.iter().filter_map(|it| it.last().cloned()).collect();
        let whole: Vec<String> = parts.iter().map(|it| it.join("::")).collect();
        let are_targets = are_targets(&whole);
        let is_whole = !are_targets && count_different(&whole) > count_different(&last);
        (if is_whole { whole } else { last }, are_targets)
    }
}
