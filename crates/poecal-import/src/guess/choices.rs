//! Columns, words and units that were chosen in place of what was guessed.

use super::Sample;
use super::fields::{MappedField, UNITS, WAYS};
use poecal_numerics::error::{ErrorKind, Result, nearest_or_all};
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;

impl Sample<'_> {
    /// Takes a column or a word in place of what was guessed.
    pub(super) fn choose(&self, fields: &mut [MappedField], key: &str, value: &str) -> Result<()> {
        if key == "pose" {
            let expected = WAYS.join(" or ");
            let field = fields.iter_mut().find(|it| it.key == key && !it.choices.is_empty());
            field.into_iter().for_each(|it| value.clone_into(&mut it.chosen));
            return if WAYS.contains(&value) {
                Ok(())
            } else {
                ErrorKind::Option.refuse(format!(
                    "--column: found `{value}` for the way of the poses, expected {expected}"
                ))
            };
        }
        let chosen = if value.is_empty() { String::new() } else { self.known(value, key)? };
        let keys: Vec<&str> = fields.iter().map(|it| it.key.as_str()).collect();
        let Some(at) = keys.iter().position(|it| *it == key) else {
            let hint = nearest_or_all(key, &keys);
            return ErrorKind::Option
                .refuse(format!("--column: found `{key}`, expected what a column is for, {hint}"));
        };
        if let Some(field) = fields.get_mut(at) {
            field.chosen = chosen;
        }
        Ok(())
    }

    /// A column of the file by its name, with or without its unit.
    fn known(&self, name: &str, key: &str) -> Result<String> {
        let known: Vec<&str> = self.columns.iter().map(|it| it.name.as_str()).collect();
        let found = self.index(name).or_else(|| self.names.named(name)).and_then(|it| self.name(it));
        found.ok_or_else(|| {
            ErrorKind::Option.error(format!(
                "--column: found no column `{name}` for `{key}`, expected one of the file, {}",
                nearest_or_all(name, &known)
            ))
        })
    }
}

/// Takes a unit in place of what was guessed.
pub(super) fn choose_unit(fields: &mut [MappedField], key: &str, value: &str) -> Result<()> {
    let unit = UNITS.iter().find(|it| it.key == key);
    let of = unit.map_or(Unit::Radian, |it| it.of);
    let stated = Some(value).filter(|it| !it.is_empty()).map(|it| NamedUnit::parse(it, of));
    let stated = stated.transpose().map_err(refused)?;
    if unit.is_none() {
        return ErrorKind::Option.refuse(format!(
            "--column: found `{key}`, expected unit.angle, unit.length, unit.position or unit.orientation"
        ));
    }
    if let Some(field) = fields.iter_mut().find(|it| it.key == key) {
        field.chosen = stated.map_or("", NamedUnit::symbol).to_owned();
    }
    Ok(())
}

/// An error of a value that was chosen.
pub(super) fn refused(error: poecal_numerics::error::Error) -> poecal_numerics::error::Error {
    ErrorKind::Option.error(format!("--column: {}", error.message()))
}
