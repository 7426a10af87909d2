//! A guess as a mapping file.

use std::fmt::Write as _;

use super::fields::{MappedField, WAYS};
use poecal_numerics::text::escape_invisible;

/// A text in TOML's quotes.
fn quote_toml(text: &str) -> String {
    toml::Value::from(text).to_string()
}

/// A key in TOML.
fn key(name: &str) -> String {
    let is_bare = |it: char| it.is_ascii_alphanumeric() || it == '_' || it == '-';
    if !name.is_empty() && name.chars().all(is_bare) { name.to_owned() } else { quote_toml(name) }
}

fn list<'a>(names: impl IntoIterator<Item = &'a String>) -> String {
    format!("[{}]", names.into_iter().map(|it| quote_toml(it)).collect::<Vec<_>>().join(", "))
}

/// The mapping in TOML, of poses that point in the direction `way`; an input without a column is a comment.
pub(crate) fn mapping(fields: &[MappedField], way: Option<&str>, left_out: &[String], file: &str) -> String {
    let mut out = format!("# How the columns of {} are read, by the option --columns.\n", escape_invisible(file));
    let of = |group: &'static str| fields.iter().filter(move |it| it.group == group && it.choices.is_empty());
    let word = |key: &str| {
        let field = fields.iter().find(|it| it.key == key && !it.choices.is_empty());
        field.map(|it| it.chosen.as_str()).filter(|it| !it.is_empty())
    };
    for key in ["id", "target"] {
        if let Some(column) = of("rows").find(|it| it.key == key).and_then(MappedField::chosen_column) {
            let _ = writeln!(out, "{key} = {}", quote_toml(column));
        }
    }
    if let Some(way) = way.filter(|it| *it != WAYS[0]) {
        let _ = writeln!(out, "pose = \"{way}\"");
    }
    if !left_out.is_empty() {
        let _ = writeln!(out, "ignore = {}", list(left_out));
    }
    out.push_str("\n[joints]\n");
    for joint in of("joints") {
        let name = key(&joint.key);
        let _ = match (joint.chosen_column(), word(joint.unit)) {
            (None, _) => writeln!(out, "# {} = found no column", escape_invisible(&name)),
            (Some(column), None) => writeln!(out, "{name} = {}", quote_toml(column)),
            (Some(column), Some(unit)) => {
                writeln!(out, "{name} = {{ column = {}, unit = \"{unit}\" }}", quote_toml(column))
            }
        };
    }
    for (group, form) in [("position", None), ("orientation", word("orientation"))] {
        let columns: Option<Vec<&String>> = of(group).map(MappedField::chosen_column).collect();
        let Some(columns) = columns.filter(|it| !it.is_empty()) else { continue };
        let _ = writeln!(out, "\n[{group}]");
        if let Some(form) = form {
            let _ = writeln!(out, "form = \"{form}\"");
        }
        let _ = writeln!(out, "columns = {}", list(columns));
        if let Some(unit) = word(&format!("unit.{group}")) {
            let _ = writeln!(out, "unit = \"{unit}\"");
        }
    }
    out
}
