//! One number of a mapping: a column, a sum of columns, or a constant.

use std::collections::BTreeMap;
use std::fmt;

use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error as _, MapAccess, Visitor};

use super::super::column_names::{column_name, counted_column};
use super::super::mapping_values::any_unit;
use poecal_numerics::named_unit::NamedUnit;

/// One column, a sum of columns, or a constant. In TOML a column's name, or a table.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(remote = "Self", deny_unknown_fields)]
pub(crate) struct ColumnSpec {
    #[serde(default, deserialize_with = "column_name")]
    pub(crate) column: Option<String>,
    /// Columns with their factors.
    pub(crate) columns: Option<BTreeMap<String, f64>>,
    pub(crate) value: Option<f64>,
    /// Offset that is added to the columns, in the unit.
    pub(crate) offset: Option<f64>,
    #[serde(default, deserialize_with = "any_unit")]
    pub(crate) unit: Option<NamedUnit>,
}

impl<'de> Deserialize<'de> for ColumnSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        deserializer.deserialize_any(ColumnSpecVisitor)
    }
}

struct ColumnSpecVisitor;

impl<'de> Visitor<'de> for ColumnSpecVisitor {
    type Value = ColumnSpec;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the name or the number of a column, or a table with `column`, `columns` or `value`, and `offset` and `unit`")
    }

    fn visit_str<E: serde::de::Error>(self, column: &str) -> std::result::Result<ColumnSpec, E> {
        Ok(ColumnSpec { column: Some(column.to_owned()), ..ColumnSpec::default() })
    }

    fn visit_i64<E: serde::de::Error>(self, number: i64) -> std::result::Result<ColumnSpec, E> {
        Ok(ColumnSpec { column: Some(counted_column(number)?), ..ColumnSpec::default() })
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> std::result::Result<ColumnSpec, A::Error> {
        let spec = ColumnSpec::deserialize(MapAccessDeserializer::new(map))?;
        let given =
            [("column", spec.column.is_some()), ("columns", spec.columns.is_some()), ("value", spec.value.is_some())];
        let mut given = given.into_iter().filter(|(_, given)| *given).map(|(key, _)| key);
        if let (Some(first), Some(second)) = (given.next(), given.next()) {
            return Err(A::Error::custom(format!("found both `{first}` and `{second}`, expected one of them")));
        }
        spec.columns.as_ref().map_or(Ok(()), check_columns)?;
        if [spec.value, spec.offset].into_iter().flatten().any(|value| !value.is_finite()) {
            return Err(A::Error::custom("found a value that is not finite, expected a finite number"));
        }
        if spec.value.is_some() && spec.offset.is_some() {
            return Err(A::Error::custom("found `offset` beside `value`, expected their sum as `value`"));
        }
        Ok(spec)
    }
}

/// Checks that a sum has columns, with nonzero factors.
fn check_columns<E: serde::de::Error>(columns: &BTreeMap<String, f64>) -> std::result::Result<(), E> {
    if columns.is_empty() {
        return Err(E::custom(
            "found no column in `columns`, expected columns with their factors, like { J2 = -1, J3 = 1 }",
        ));
    }
    if let Some((name, factor)) = columns.iter().find(|(_, factor)| !factor.is_normal()) {
        let message =
            format!("found the factor {factor} of column `{name}`, expected a number other than 0, like 1 or -1");
        return Err(E::custom(message));
    }
    Ok(())
}
