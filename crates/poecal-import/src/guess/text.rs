//! A guess as a mapping file.

use std::fmt::Write as _;

use super::draft::Draft;
use poecal_numerics::text::visible;
use poecal_numerics::unit::Unit;

/// A text in TOML's quotes.
fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}

/// A key as TOML has it.
fn key(name: &str) -> String {
    let is_bare = |it: char| it.is_ascii_alphanumeric() || it == '_' || it == '-';
    if !name.is_empty() && name.chars().all(is_bare) { name.to_owned() } else { quoted(name) }
}

fn list<'a>(names: impl Iterator<Item = &'a str>) -> String {
    format!("[{}]", names.map(quoted).collect::<Vec<_>>().join(", "))
}

/// The mapping in TOML; what has no column is a comment.
pub(crate) fn mapping(draft: &Draft, file: &str) -> String {
    let mut out = format!("# How the columns of {} are read, by the option --columns.\n", visible(file));
    let unit = |group: &str| draft.units.get(group).and_then(|it| it.map(|unit| unit.symbol()));
    for (name, column) in [("id", &draft.id), ("target", &draft.target)] {
        if let Some(column) = column {
            let _ = writeln!(out, "{name} = {}", quoted(column));
        }
    }
    if draft.is_inverted {
        out.push_str("pose = \"target_from_device\"\n");
    }
    if !draft.left_out.is_empty() {
        let _ = writeln!(out, "ignore = {}", list(draft.left_out.iter().map(String::as_str)));
    }
    out.push_str("\n[joints]\n");
    for (name, quantity, column) in &draft.joints {
        let unit = unit(if *quantity == Unit::Metre { "length" } else { "angle" });
        let _ = match (column, unit) {
            (None, _) => writeln!(out, "# {} = found no column", visible(&key(name))),
            (Some(column), None) => writeln!(out, "{} = {}", key(name), quoted(column)),
            (Some(column), Some(unit)) => {
                writeln!(out, "{} = {{ column = {}, unit = \"{unit}\" }}", key(name), quoted(column))
            }
        };
    }
    let position: Option<Vec<&str>> = draft.position.iter().map(Option::as_deref).collect();
    if let Some(columns) = position {
        section(&mut out, "position", None, &columns, unit("position"));
    }
    let parts: Option<Vec<&str>> = draft.parts.iter().map(Option::as_deref).collect();
    if let (Some(form), Some(columns)) = (draft.form, parts) {
        section(&mut out, "orientation", Some(&form.mapped()), &columns, unit("orientation"));
    }
    out
}

/// A section with columns.
fn section(out: &mut String, name: &str, form: Option<&str>, columns: &[&str], unit: Option<&str>) {
    let _ = writeln!(out, "\n[{name}]");
    if let Some(form) = form {
        let _ = writeln!(out, "form = \"{form}\"");
    }
    let _ = writeln!(out, "columns = {}", list(columns.iter().copied()));
    if let Some(unit) = unit {
        let _ = writeln!(out, "unit = \"{unit}\"");
    }
}
