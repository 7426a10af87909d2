//! Settings files: options of a command as TOML (docs/file-formats.md, "Settings").

use std::path::{Path, PathBuf};

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use poecal_numerics::error::{Error, ErrorKind, Result, nearest_or_all, position};
use poecal_storage::limits::ResourceLimit;
use poecal_storage::source_text;

use crate::renamed_words::new_key;

/// Key with the version of the file.
const VERSION_KEY: &str = "poecal_settings";

/// Setting that is a table of texts, each an entry `KEY=TEXT` of the setting.
const TABLE: &str = "record";

/// Value of a setting.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SettingValue {
    /// Text or number, as typed.
    One(String),
    /// List of these.
    Many(Vec<String>),
    /// `true` or `false`.
    Switch(bool),
}

/// One line of a settings file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SettingLine {
    /// Key.
    pub key: String,
    /// Value.
    pub value: SettingValue,
    /// Line of the value, from 1.
    pub line: usize,
    /// Column of the value, from 1.
    pub column: usize,
}

/// A settings file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Settings {
    /// File name as stated by the user.
    pub path: PathBuf,
    /// The settings, in the order of their lines.
    pub entries: Vec<SettingLine>,
}

impl Settings {
    /// Reads a settings file that may have these keys.
    ///
    /// # Errors
    /// [`ErrorKind::File`] if it cannot be read, else as [`Settings::parse`].
    pub fn read(path: impl AsRef<Path>, keys: &[&str]) -> Result<Self> {
        let path = path.as_ref();
        Settings::parse(
            &source_text::read_up_to(path, "settings (TOML, as `poecal init` writes them)", ResourceLimit::Settings)?,
            path,
            keys,
        )
    }

    /// Settings from their text; messages name it `path`.
    ///
    /// # Errors
    /// [`ErrorKind::Syntax`], with line and column, if the text is no TOML, is not of this version, or has a key that is not known
    /// or a value of a wrong kind.
    pub fn parse(text: &str, path: impl AsRef<Path>, keys: &[&str]) -> Result<Self> {
        Settings::parse_at(text, path.as_ref(), keys)
    }

    /// The part of reading that does not depend on the kind of path, compiled once.
    fn parse_at(text: &str, path: &Path, keys: &[&str]) -> Result<Self> {
        let at = |offset: usize, message: String| ErrorKind::Syntax.error(message).at_offset(path, text, offset);
        let table = DeTable::parse(text).map_err(|error| {
            at(error.span().map_or(0, |span| span.start), error.message().trim().replace('\n', ", "))
        })?;
        let (mut versioned, mut entries) = (false, Vec::new());
        for (key, value) in table.get_ref() {
            let start = value.span().start;
            if key.get_ref() == VERSION_KEY {
                versioned = text_or_number(value).is_some_and(|number| number == "1");
                continue;
            }
            if !keys.contains(&key.get_ref().as_ref()) {
                let near = new_key(key.get_ref(), keys)
                    .map_or_else(|| nearest_or_all(key.get_ref(), keys), |new| format!("it is now `{new}`"));
                let message = format!("found the key `{}`, expected a setting: {near}", key.get_ref());
                return Err(at(key.span().start, message));
            }
            if let DeValue::Table(table) = value.get_ref()
                && key.get_ref() == TABLE
            {
                for (own, value) in table {
                    let start = value.span().start;
                    let typed = text_or_date(value).ok_or_else(|| {
                        let message = format!(
                            "found {} for `{}` of `{TABLE}`, expected a text or a number",
                            value.get_ref().type_str(),
                            own.get_ref()
                        );
                        at(start, message)
                    })?;
                    let (line, column) = position(text, start);
                    let value = SettingValue::One(format!("{}={typed}", own.get_ref()));
                    entries.push(SettingLine { key: TABLE.to_owned(), value, line, column });
                }
                continue;
            }
            let value = setting(value).ok_or_else(|| {
                let message = format!(
                    "found {} for `{}`, expected a text, a number, true, false, or a list of texts or numbers",
                    value.get_ref().type_str(),
                    key.get_ref()
                );
                at(start, message)
            })?;
            let (line, column) = position(text, start);
            entries.push(SettingLine { key: key.get_ref().to_string(), value, line, column });
        }
        if !versioned {
            return Err(ErrorKind::Syntax
                .error(format!(
                    "found no `{VERSION_KEY} = 1`, expected settings with this line, the version of their form"
                ))
                .in_file(path));
        }
        entries.sort_by_key(|entry| (entry.line, entry.column));
        Ok(Settings { path: path.to_path_buf(), entries })
    }

    /// An error at one of the settings.
    #[must_use]
    pub fn error(&self, entry: &SettingLine, message: impl Into<String>) -> Error {
        ErrorKind::Option.error(message).at_position(&self.path, entry.line, entry.column)
    }
}

fn setting(value: &Spanned<DeValue>) -> Option<SettingValue> {
    match value.get_ref() {
        DeValue::Boolean(on) => Some(SettingValue::Switch(*on)),
        DeValue::Array(items) => items.iter().map(text_or_number).collect::<Option<_>>().map(SettingValue::Many),
        DeValue::String(_) | DeValue::Integer(_) | DeValue::Float(_) | DeValue::Datetime(_) | DeValue::Table(_) => {
            text_or_number(value).map(SettingValue::One)
        }
    }
}

/// Text, number or date, as typed.
fn text_or_date(value: &Spanned<DeValue>) -> Option<String> {
    if let DeValue::Datetime(date) = value.get_ref() { Some(date.to_string()) } else { text_or_number(value) }
}

/// Text or number, as typed.
fn text_or_number(value: &Spanned<DeValue>) -> Option<String> {
    match value.get_ref() {
        DeValue::String(text) => Some(text.to_string()),
        DeValue::Integer(number) if number.radix() == 10 => Some(number.as_str().to_owned()),
        DeValue::Float(number) => Some(number.as_str().to_owned()),
        DeValue::Integer(_) | DeValue::Boolean(_) | DeValue::Datetime(_) | DeValue::Array(_) | DeValue::Table(_) => {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEYS: [&str; 4] = ["model", "measurements", "held_out", "force"];

    fn refuse_settings(text: &str) -> String {
        Settings::parse(text, "s.toml", &KEYS).unwrap_err().to_string()
    }

    #[test]
    fn values_are_as_they_would_be_typed() {
        let text =
            "# mine\nforce = true\nmeasurements = [\"a.csv\", 'b c.csv']\nheld_out = 0.30\npoecal_settings = 1\n";
        let settings = Settings::parse(text, "s.toml", &KEYS).unwrap();
        let values: Vec<_> = settings.entries.iter().map(|entry| (entry.key.as_str(), &entry.value)).collect();
        let files = SettingValue::Many(vec!["a.csv".to_owned(), "b c.csv".to_owned()]);
        assert_eq!(
            values,
            [
                ("force", &SettingValue::Switch(true)),
                ("measurements", &files),
                ("held_out", &SettingValue::One("0.30".to_owned())),
            ]
        );
        let error = settings.error(&settings.entries[2], "found it");
        assert_eq!(error.to_string(), "s.toml:4:12: found it");
    }

    #[test]
    fn mistakes_are_told_with_their_place() {
        assert_eq!(
            refuse_settings("model = 'robot.urdf'\n"),
            "s.toml: found no `poecal_settings = 1`, expected settings with this line, the version of their form"
        );
        assert_eq!(
            refuse_settings("poecal_settings = 1\nmodle = 'robot.urdf'\n"),
            "s.toml:2:1: found the key `modle`, expected a setting: the nearest is `model`"
        );
        assert_eq!(
            refuse_settings("poecal_settings = 1\n[model]\n"),
            "s.toml:2:1: found table for `model`, expected a text, a number, true, false, or a list of texts or numbers"
        );
        assert_eq!(
            refuse_settings("poecal_settings = 1\nheld_out = [[1]]\n"),
            "s.toml:2:12: found array for `held_out`, expected a text, a number, true, false, or a list of texts or numbers"
        );
        assert!(refuse_settings("poecal_settings = 1\nmodel = \n").starts_with("s.toml:2:"));
        assert!(
            refuse_settings("poecal_settings = 1\nmodel = 'a'\nmodel = 'b'\n").starts_with("s.toml:3:1: duplicate key")
        );
        assert!(refuse_settings("poecal_settings = 2\n").contains("poecal_settings = 1"));
    }

    #[test]
    fn the_record_is_a_table_of_texts() {
        let known = ["model", "record"];
        let text = "poecal_settings = 1\n[record]\nserial = \"A = 7\"\ndate = 2026-03-02\nplace = 12\n";
        let settings = Settings::parse(text, "s.toml", &known).unwrap();
        let found: Vec<_> = settings.entries.iter().map(|it| (&it.value, it.line, it.column)).collect();
        let one = |text: &str| SettingValue::One(text.to_owned());
        let expected = [(one("serial=A = 7"), 3, 10), (one("date=2026-03-02"), 4, 8), (one("place=12"), 5, 9)];
        assert!(found.iter().zip(&expected).all(|(a, b)| (a.0, a.1, a.2) == (&b.0, b.1, b.2)), "{found:?}");
        let refused = |text: &str| Settings::parse(text, "s.toml", &known).unwrap_err().to_string();
        assert_eq!(
            refused("poecal_settings = 1\n[record]\nserial = [1]\n"),
            "s.toml:3:10: found array for `serial` of `record`, expected a text or a number"
        );
    }
}
