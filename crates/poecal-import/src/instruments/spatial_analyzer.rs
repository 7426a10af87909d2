//! Points that SpatialAnalyzer exported as text, in every layout that its dialogue offers: collection, group and name, index, coordinates, offsets,
//! uncertainties and time, separated by commas or blanks (manual, *Exporting ASCII formatted points*).

use std::collections::BTreeSet;

use super::maker::{Made, Refused, Value};
use super::words::{are_targets, cells, is_no_number, lines, number, repeats};
use super::{Form, Opening};
use crate::Separator;

pub(crate) const FORM: Form = Form { title: "points of SpatialAnalyzer", is_it, table };

/// Lines in which the comments are sought.
const FIRST: usize = 20;

/// What the comments say.
struct Comments<'t> {
    frame: Option<&'t str>,
    axes: Axes,
    unit: &'t str,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Axes {
    Cartesian,
    Cylindrical,
    Spherical,
}

/// A line as it is written.
struct Point<'t> {
    line: usize,
    names: Vec<&'t str>,
    numbers: Vec<&'t str>,
    /// Whether a time is behind them.
    has_time: bool,
}

fn is_it(text: &str, _: &Opening<'_>) -> bool {
    lines(text).take(FIRST).any(|(_, line)| {
        line.trim_start().starts_with("//")
            && ["SpatialAnalyzer", "Relative to Coordinate Frame", "AXES ="]
                .iter()
                .any(|it| line.contains(it))
    })
}

fn table(text: &str, _: &Opening<'_>) -> Result<Made, Refused> {
    let comments = Comments::of(text)?;
    let mut points = Vec::new();
    for (line, content) in lines(text).filter(|it| !it.1.trim_start().starts_with("//")) {
        points.push(Point::of(line, content)?);
    }
    let Some(first) = points.first() else {
        return Refused::whole("found comments of SpatialAnalyzer and no point, expected at least one");
    };
    refuse_unlike(first, &points)?;
    let layout = Layout::of(&points)?;
    let (names, have_targets) = layout.names(&points);
    let sigmas: &[&str] = if layout.uncertainties { &["sigma_x", "sigma_y", "sigma_z"] } else { &[] };
    let unit = comments.unit;
    let columns: Vec<String> = [if have_targets { "target" } else { "id" }.to_owned()]
        .into_iter()
        .chain(["x", "y", "z"].iter().chain(sigmas).map(|it| format!("{it}[{unit}]")))
        .collect();
    let mut made = Made::new(first.line, columns.iter().map(String::as_str));
    for (point, name) in points.iter().zip(&names) {
        let numbers = point.numbers.get(layout.first..).unwrap_or_default();
        let mut row = vec![Value::Text(name)];
        match (comments.axes, numbers) {
            (Axes::Cylindrical, [radius, angle, height, ..]) => {
                let turned = number(angle).unwrap_or_default().to_radians();
                let radius = number(radius).unwrap_or_default();
                row.extend([
                    Value::Number(radius * turned.cos()),
                    Value::Number(radius * turned.sin()),
                    Value::Text(height),
                ]);
            }
            _ => row.extend(numbers.iter().take(3).map(|it| Value::Text(it))),
        }
        if layout.uncertainties {
            row.extend(numbers.iter().skip(layout.uncertainty_at()).take(3).map(|it| Value::Text(it)));
        }
        made.row(point.line, row);
    }
    say_points(&mut made, &comments, &layout, (&points, &names), have_targets);
    Ok(made)
}

/// Refuses points whose lines are not alike.
fn refuse_unlike(first: &Point<'_>, points: &[Point<'_>]) -> Result<(), Refused> {
    let (words, count) = (first.names.len(), first.numbers.len());
    if let Some(other) = points.iter().find(|it| it.names.len() != words || it.numbers.len() != count) {
        return Refused::at(
            other.line,
            format!(
                "found {} names and {} numbers, expected {words} and {count} as in line {}",
                other.names.len(),
                other.numbers.len(),
                first.line
            ),
        );
    }
    // A line that was cut has no time, and its last number may have been cut.
    let timed = points.iter().filter(|it| it.has_time).count();
    if let Some(other) = points.iter().find(|it| 2 * timed > points.len() && !it.has_time) {
        return Refused::at(
            other.line,
            "found no time behind the numbers of a point, expected one as in the other lines: the line was cut, export the points again, or leave it out",
        );
    }
    Ok(())
}

/// Says what was understood of points.
fn say_points(
    made: &mut Made,
    comments: &Comments<'_>,
    layout: &Layout,
    (points, names): (&[Point<'_>], &[String]),
    have_targets: bool,
) {
    let unit = comments.unit;
    made.frame = comments.frame.map(str::to_owned);
    made.said.push(match comments.frame {
        Some(frame) => format!("{} points in frame `{frame}`, {unit}", points.len()),
        None => format!("{} points, {unit}", points.len()),
    });
    if comments.axes == Axes::Cylindrical {
        made.said.push("cylindrical coordinates became x, y, z".to_owned());
    }
    if layout.offsets {
        made.said.push("two offsets of each point are left out".to_owned());
    }
    if layout.uncertainties {
        made.said
            .push("three uncertainties of each point are taken as standard deviations of x, y, z".to_owned());
    }
    if have_targets {
        let all: BTreeSet<&str> = names.iter().map(String::as_str).collect();
        made.said.push(format!("names come again, and are those of {} targets", all.len()));
    } else {
        let lines: Vec<usize> = points.iter().map(|it| it.line).collect();
        made.warned.extend(repeats(names, &lines));
    }
}

impl<'t> Comments<'t> {
    fn of(text: &'t str) -> Result<Self, Refused> {
        let comment = |(at, line): (usize, &'t str)| Some((at, line.trim().strip_prefix("//")?.trim()));
        let all: Vec<(usize, &str)> = lines(text).filter_map(comment).collect();
        let behind = |key: &'static str| {
            all.iter().filter_map(move |(at, it)| {
                Some((*at, it.split_once(key)?.1.trim_matches([' ', '=', '\'', '"'])))
            })
        };
        // Points of several frames or units in one file are not told apart by a table.
        let only = |key: &'static str, what: &str| {
            let first = behind(key).next();
            match first.and_then(|first| behind(key).find(|it| it.1 != first.1)) {
                Some((line, other)) => Refused::at(
                    line,
                    format!(
                        "found `{other}` as {what} of the points below, and `{}` above, expected one in a file: write the points of each into a file of its own",
                        first.map_or("", |it| it.1)
                    ),
                ),
                None => Ok(first),
            }
        };
        let frame = only("Coordinate Frame", "the frame")?.map(|it| it.1);
        let Some((line, axes)) = only("AXES", "axes and unit")? else {
            return Refused::whole(
                "found points of SpatialAnalyzer without the line `// AXES = …` that states their unit, expected it: export them with comments, or \
                 name the columns by number in a mapping (--columns)",
            );
        };
        let kind = axes.trim_start_matches([' ', '=']).to_ascii_uppercase();
        let units = axes.rsplit_once('(').map_or("", |it| it.1).trim_end_matches([')', ' ']);
        let mut units = units.split(',').map(str::trim);
        let (unit, angle) = (units.next().unwrap_or_default(), units.next());
        let axes = match kind.split([':', ' ']).next().unwrap_or_default() {
            "CARTESIAN" => Axes::Cartesian,
            "CYLINDRICAL" => Axes::Cylindrical,
            _ => Axes::Spherical,
        };
        if axes == Axes::Spherical {
            return Refused::at(
                line,
                "found coordinates that are neither Cartesian nor cylindrical, expected x, y and z: export the points as Cartesian",
            );
        }
        if unit.is_empty() {
            return Refused::at(line, "found no unit in brackets, as `(mm)`, expected one");
        }
        let is_degrees = angle.is_none_or(|it| it.to_ascii_lowercase().starts_with("deg"));
        if axes == Axes::Cylindrical && !is_degrees {
            return Refused::at(
                line,
                "found angles in another unit than degrees, expected deg: export the points as Cartesian",
            );
        }
        Ok(Comments { frame, axes, unit })
    }
}

impl<'t> Point<'t> {
    fn of(line: usize, content: &'t str) -> Result<Self, Refused> {
        let content = content.trim();
        if content.contains(';') {
            return Refused::at(
                line,
                "found `;` between the cells of a point, expected commas or blanks: export the points again, or replace it",
            );
        }
        let is_by_commas = content.contains(',');
        let mut parts: Vec<&str> = if is_by_commas {
            cells(content, Separator::Comma)
        } else {
            content.split_whitespace().collect()
        };
        let mut has_time = false;
        // The time, `02/12/25 16:52:45`, which is one cell or two.
        while parts.last().is_some_and(|it| {
            it.contains('/') || it.contains(':') && !it.contains("::") || matches!(*it, "AM" | "PM")
        }) {
            parts.pop();
            has_time = true;
        }
        if let Some(word) = parts.iter().skip(1).find(|it| is_no_number(it)) {
            return Refused::at(
                line,
                format!(
                    "found `{word}` in place of a number, expected a coordinate: leave out the line of a point that was not measured"
                ),
            );
        }
        let numbers = parts.iter().rev().take_while(|it| number(it).is_some()).count();
        let at = parts.len() - numbers;
        let mut names: Vec<&str> = parts.drain(..at).collect();
        if numbers < 3 {
            return Refused::at(
                line,
                format!(
                    "found {numbers} numbers behind the name of a point, expected its coordinates, at least three"
                ),
            );
        }
        // A name may have blanks in it.
        if !is_by_commas && names.len() > 1 {
            let of = |part: &str| part.as_ptr() as usize - content.as_ptr() as usize;
            let end = parts.first().map_or(content.len(), |it| of(it));
            names = content.get(..end).map(str::trim_end).into_iter().collect();
        }
        Ok(Point { line, names, numbers: parts, has_time })
    }
}

/// What the numbers of a line are.
struct Layout {
    /// Numbers before the coordinates: a name that is one, and the index of a point in its group.
    first: usize,
    /// Whether the first of these is the name.
    is_named_by_number: bool,
    offsets: bool,
    uncertainties: bool,
}

impl Layout {
    fn of(points: &[Point<'_>]) -> Result<Self, Refused> {
        let Some(first) = points.first() else { return Refused::whole("found no point") };
        let is_whole = |at: usize| {
            points
                .iter()
                .all(|it| it.numbers.get(at).is_some_and(|it| it.bytes().all(|it| it.is_ascii_digit())))
        };
        // A point has a name in any case: it may be a number.
        let is_named_by_number = first.names.is_empty() && is_whole(0);
        let named = usize::from(is_named_by_number);
        let count = first.numbers.len() - named;
        let has_index = matches!(count, 4 | 6 | 7 | 9) && is_whole(named);
        let rest = count - usize::from(has_index);
        let is_whole_number =
            |it: &&str| it.trim_start_matches(['+', '-']).bytes().all(|it| it.is_ascii_digit());
        let all_whole =
            points.iter().flat_map(|it| it.numbers.get(named..).unwrap_or_default()).all(is_whole_number);
        if all_whole && rest >= 6 {
            return Refused::at(
                first.line,
                format!(
                    "found {rest} whole numbers of a point and no decimal point, expected three coordinates: decimal commas are cells of their own, export \
                     the points with decimal points"
                ),
            );
        }
        // The index of a point in its group, and two coordinates.
        if count == 3 && points.len() > 2 && is_whole(named) && !all_whole {
            return Refused::at(
                first.line,
                "found whole numbers alone as the first of three coordinates, as of the index of a point, expected x, y and z: a column was lost",
            );
        }
        let (offsets, uncertainties) = match rest {
            3 => (false, false),
            5 => (true, false),
            6 => (false, true),
            8 => (true, true),
            _ => {
                return Refused::at(
                    first.line,
                    format!(
                        "found {rest} numbers of a point, expected three coordinates, and with them two offsets, three uncertainties, or both"
                    ),
                );
            }
        };
        Ok(Layout { first: named + usize::from(has_index), is_named_by_number, offsets, uncertainties })
    }

    fn uncertainty_at(&self) -> usize {
        if self.offsets { 5 } else { 3 }
    }

    /// The points' names, and whether they are those of targets, since they come again and again.
    fn names(&self, points: &[Point<'_>]) -> (Vec<String>, bool) {
        let own = |point: &Point<'_>| -> Vec<String> {
            let mut parts: Vec<String> =
                point.names.iter().flat_map(|it| it.split("::")).map(|it| it.trim().to_owned()).collect();
            if self.is_named_by_number {
                parts.extend(point.numbers.first().map(|it| (*it).to_owned()));
            }
            parts
        };
        let parts: Vec<Vec<String>> = points.iter().map(own).collect();
        let last: Vec<String> = parts.iter().filter_map(|it| it.last().cloned()).collect();
        let whole: Vec<String> = parts.iter().map(|it| it.join("::")).collect();
        let count = |names: &[String]| names.iter().collect::<BTreeSet<_>>().len();
        if are_targets(&whole) {
            (last, true)
        } else if count(&whole) > count(&last) {
            (whole, false)
        } else {
            (last, false)
        }
    }
}
