//! Columns, words and units that a person chooses in place of the guess.

use super::TableSample;
use super::fields::{MappedField, WAYS};
use poecal_numerics::error::{ErrorKind, Result, nearest_or_all};

impl TableSample<'_> {
    /// Takes a column or a word in place of the guess.
    pub(super) fn choose(&self, fields: &mut [MappedField], key: &str, value: &str) -> Result<()> {
        if key == "pose" {
            let expected = WAYS.join(" or ");
            let field = fields.iter_mut().find(|it| it.key == key && !it.choices.is_empty());
            field.into_iter().for_each(|it| value.clone_into(&mut it.chosen));
            return if WAYS.contains(&value) {
                Ok(())
            } else {
                ErrorKind::Option
                    .refuse(format!("--column: found `{value}` for the way of the poses, expected {expected}"))
            };
        }
        let chosen = if value.is_empty() { String::new() } else { self.known_column(value, key)? };
        let keys: Vec<&str> = fields.iter().map(|it| it.key.as_str()).collect();
        let Some(at) = keys.iter().position(|it| *it == key) else {
            let hint = nearest_or_all(key, &keys);
            return ErrorKind::Option.refuse(format!("--column: found `{key}`, expected what a column is for, {hint}"));
        };
        if let Some(field) = fields.get_mut(at) {
            field.chosen = chosen;
        }
        Ok(())
    }

    /// Finds a column of the file by its name, with or without its unit.
    fn known_column(&self, name: &str, key: &str) -> Result<String> {
        let known: Vec<&str> = self.columns.iter().map(|it| it.name.as_str()).collect();
        let found = self.index(name).or_else(|| self.names.find_exact(name)).and_then(|it| self.name(it));
        found.ok_or_else(|| {
            ErrorKind::Option.error(format!(
                "--column: found no column `{name}` for `{key}`, expected one of the file, {}",
                nearest_or_all(name, &known)
            ))
        })
    }
}
