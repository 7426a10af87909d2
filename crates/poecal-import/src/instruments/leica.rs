//! Poses and points that Leica's software for trackers writes as CSV: columns with two blanks before their unit, expanded uncertainties `U(95)`, the
//! quaternion with its real part `Q0` first.

use super::maker::{Made, Refused, Value};
use super::words::{cells, lines, number, quoted};
use super::{Form, Opening};
use crate::Separator;
use crate::table::header::bracketed;

pub(crate) const FORM: Form = Form { title: "measurements of a Leica tracker", is_it, table };

/// The factor between the expanded uncertainty (95 %) of a normal distribution and its standard deviation.
const COVERAGE: f64 = 1.96;
/// Columns with a meaning, each with ours.
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

/// A column's name without its unit, and the unit.
fn parts(text: &str) -> (String, Option<&str>) {
    let (name, unit) =
        bracketed(text, '[', ']').map_or((text, None), |(name, unit)| (name, Some(unit.trim())));
    (name.split_whitespace().collect::<Vec<_>>().join(" "), unit)
}

fn is_it(text: &str, _: &Opening<'_>) -> bool {
    let Some((_, header)) = lines(text).next() else { return false };
    let names: Vec<String> =
        cells(header, Separator::recognised(header)).into_iter().map(|it| parts(it).0).collect();
    let has = |name: &str| names.iter().any(|it| it == name);
    has("X") && has("Y") && has("Z") && (has("U(95)") || has("U(95) X"))
}

/// A column with a meaning: its place, what we call it, and its unit if it is a length.
type Used<'t> = (usize, &'static str, Option<&'t str>);

/// Finds the columns with a meaning in a header.
fn find_columns<'t>(names: &[(String, Option<&'t str>)], at: usize) -> Result<Vec<Used<'t>>, Refused> {
    let mut used = Vec::new();
    for (theirs, ours) in COLUMNS {
        let mut found = names.iter().enumerate().filter(|(_, it)| it.0 == theirs);
        let Some((column, (_, unit))) = found.next() else { continue };
        if found.next().is_some() {
            return Refused::at(at, format!("found a second column `{theirs}`, expected one"));
        }
        let is_length = !theirs.starts_with('Q');
        if is_length && unit.is_none() {
            return Refused::at(
                at,
                format!("found the column `{theirs}` without a unit, expected one, as `{theirs} [mm]`"),
            );
        }
        used.push((column, ours, unit.filter(|_| is_length)));
    }
    let rotations = used.iter().filter(|it| it.1.starts_with('q')).count();
    if !matches!(rotations, 0 | 4) {
        return Refused::at(
            at,
            format!("found {rotations} of the columns Q0, Q1, Q2, Q3, expected all of them, or none"),
        );
    }
    Ok(used)
}

fn table(text: &str, _: &Opening<'_>) -> Result<Made, Refused> {
    let Some((at, header)) = lines(text).next() else { return Refused::whole("found no line") };
    let by = Separator::recognised(header);
    let names: Vec<(String, Option<&str>)> = cells(header, by).into_iter().map(parts).collect();
    let used = find_columns(&names, at)?;
    let columns: Vec<String> = (used.iter())
        .map(|(_, ours, unit)| unit.map_or_else(|| (*ours).to_owned(), |unit| format!("{ours}[{unit}]")))
        .collect();
    let mut made = Made::new(at, columns.iter().map(String::as_str));
    for (line, content) in lines(text).skip(1) {
        let found = cells(content, by);
        if found.len() > names.len() {
            return Refused::at(
                line,
                format!("found {} cells, expected {} as in the header", found.len(), names.len()),
            );
        }
        let value = |(column, ours, _): &(usize, &str, _)| {
            let text = found.get(*column).copied().unwrap_or_default();
            match number(text).filter(|_| ours.starts_with("sigma")) {
                Some(expanded) => Value::Number(expanded / COVERAGE),
                None => Value::Text(text),
            }
        };
        made.row(line, used.iter().map(value));
    }
    let headers = cells(header, by);
    for ((column, ours, _), made_of) in used.iter().zip(&columns) {
        let own = headers.get(*column).copied().unwrap_or_default();
        let divided = if ours.starts_with("sigma") { format!(" / {COVERAGE}") } else { String::new() };
        made.sources.insert(made_of.clone(), format!("{own}{divided}"));
    }
    made.said.push(format!("{} measurements", made.rows()));
    if used.iter().any(|it| it.1 == "sigma_x") {
        made.said.push(format!("U(95) divided by {COVERAGE} are the standard deviations"));
    }
    let left = quoted(
        (names.iter().enumerate())
            .filter(|(at, it)| !it.0.is_empty() && !used.iter().any(|used| used.0 == *at))
            .map(|(_, it)| &it.0),
    );
    if !left.is_empty() {
        made.said.push(format!("left out {left}"));
    }
    Ok(made)
}
