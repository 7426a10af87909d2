//! Training rows selected by the value of a column.

use std::str::FromStr;

use serde::Deserialize;

use poecal_numerics::error::{Error, ErrorKind, Result};

/// Rows with one of `values` in `column` are fitted, all others held out: `stage=stationing,2` as typed. Cells compare as text or as numbers.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields, rename = "SetSpec")]
pub struct FitWhere {
    /// Name of the column, with or without its unit.
    pub column: String,
    /// Values that mark a training row.
    #[serde(rename = "fit")]
    pub values: Vec<String>,
}

impl FitWhere {
    /// Index of the value that equals a cell.
    pub(crate) fn matching_index(&self, cell: &str) -> Option<usize> {
        self.values.iter().position(|value| value == cell).or_else(|| {
            let number = number(cell)?;
            self.values.iter().position(|value| self::number(value) == Some(number))
        })
    }
}

fn number(text: &str) -> Option<f64> {
    text.parse().or_else(|_| text.replace(',', ".").parse()).ok()
}

impl FromStr for FitWhere {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let parts = text.split_once('=').map(|(column, values)| {
            let values: Vec<String> = values.split(',').map(|value| value.trim().to_owned()).collect();
            FitWhere { column: column.trim().to_owned(), values }
        });
        let is_whole = |rule: &FitWhere| !rule.column.is_empty() && rule.values.iter().all(|value| !value.is_empty());
        parts.filter(is_whole).ok_or_else(|| {
            ErrorKind::Option.error(format!("found `{text}` as the rows to fit, expected COLUMN=VALUE[,VALUE]"))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_compare_as_text_and_as_numbers() {
        let rule: FitWhere = "run=1, b".parse().unwrap();
        assert_eq!(rule.matching_index("1.0"), Some(0));
        assert_eq!(rule.matching_index("1,0"), Some(0));
        assert_eq!(rule.matching_index("b"), Some(1));
        assert_eq!(rule.matching_index("c"), None);
        assert_eq!(rule.matching_index(""), None);
    }

    #[test]
    fn other_forms_are_refused() {
        for bad in ["run", "=1", "run=", "run=1,,2", ""] {
            assert!(bad.parse::<FitWhere>().is_err(), "{bad}");
        }
    }
}
