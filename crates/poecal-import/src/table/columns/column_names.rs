//! Columns in a mapping, by their names or their numbers.

use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, Visitor};

/// The name of a column by its number, from 1, for tables without names.
pub(crate) fn numbered_column(number: usize) -> String {
    format!("column {number}")
}

/// The name of a column by a number of a mapping.
pub(crate) fn counted_column<E: serde::de::Error>(number: i64) -> std::result::Result<String, E> {
    usize::try_from(number)
        .ok()
        .filter(|it| *it > 0)
        .map(numbered_column)
        .ok_or_else(|| E::custom(format!("found the column {number}, expected its name, or its number from 1")))
}

/// A column by its name or its number.
struct ColumnName(String);

impl<'de> Deserialize<'de> for ColumnName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        deserializer.deserialize_any(ColumnNameVisitor).map(ColumnName)
    }
}

struct ColumnNameVisitor;

impl Visitor<'_> for ColumnNameVisitor {
    type Value = String;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the name of a column, or its number from 1")
    }

    fn visit_str<E: serde::de::Error>(self, name: &str) -> std::result::Result<String, E> {
        Ok(name.to_owned())
    }

    fn visit_i64<E: serde::de::Error>(self, number: i64) -> std::result::Result<String, E> {
        counted_column(number)
    }
}

pub(crate) fn column_name<'de, D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Option<String>, D::Error> {
    ColumnName::deserialize(deserializer).map(|it| Some(it.0))
}

pub(crate) fn three_columns<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> std::result::Result<Option<[String; 3]>, D::Error> {
    <[ColumnName; 3]>::deserialize(deserializer).map(|it| Some(it.map(|it| it.0)))
}

pub(crate) fn some_columns<'de, D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Vec<String>, D::Error> {
    column_names(deserializer).map(Option::unwrap_or_default)
}

pub(crate) fn column_names<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> std::result::Result<Option<Vec<String>>, D::Error> {
    Vec::<ColumnName>::deserialize(deserializer).map(|it| Some(it.into_iter().map(|it| it.0).collect()))
}

/// The number of a column whose name is a number, from 1.
pub(crate) fn number_of_column(name: &str) -> Option<usize> {
    name.strip_prefix("column ")?.parse().ok().filter(|it| *it > 0)
}
