//! Settings files as command-line options, so that there is one parser.

use std::error::Error as _;
use std::ffi::OsString;
use std::path::{Component, Path, PathBuf};

use clap::error::ContextKind;
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Command};
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_results::settings::{SettingLine, SettingValue, Settings};
use poecal_storage::disk;

use crate::help::command_line;

/// Settings file that is read if no model is named.
const USUAL: &str = "poecal.toml";
/// The command whose options are settings.
const COMMAND: &str = "calibrate";
/// Commands that read settings. Each reads those for which it has an option.
const READERS: [&str; 3] = [COMMAND, "check", "import"];
/// Options of a single run, which settings cannot hold.
const NOT_KEPT: [&str; 10] =
    ["settings", "verbose", "json", "timings", "quiet", "threads", "limit", "wait", "help", "force_own"];
/// The setting that is a table: a typed entry replaces the one of that key.
const TABLE: &str = "record";
/// Settings with the place of an output.
const OUTPUTS: [&str; 2] = ["out", "report"];
/// Settings with file names, relative to the settings' folder.
const FILES: [&str; 8] = ["model", "measurements", "columns", "camera", "markers", "validate", "out", "report"];
/// Values of these settings that are words and no files.
const NO_FILES: [(&str, &str); 7] = [
    ("report", "none"),
    ("camera", "unknown:"),
    ("markers", "chessboard:"),
    ("markers", "charuco:"),
    ("markers", "circles:"),
    ("markers", "tags:"),
    ("markers", "aprilgrid:"),
];

/// A command line with the settings in it, and their source.
pub(crate) struct CompletedCommand {
    /// The words, as if all had been typed.
    pub(crate) words: Vec<OsString>,
    settings: Settings,
}

/// The command line `typed`, parsed by clap as `matches`, with its settings file; `None` without one.
///
/// # Errors
/// As [`Settings::read`], and if no model is named and there are no settings.
pub(crate) fn complete(typed: &[OsString], matches: &ArgMatches) -> Result<Option<CompletedCommand>> {
    let Some((name, matches)) = matches.subcommand().filter(|(name, _)| READERS.contains(name)) else {
        return Ok(None);
    };
    let named: Option<&PathBuf> = matches.get_one("settings");
    if named.is_none() && matches.contains_id("model") {
        return Ok(None);
    }
    let path = named.map_or(Path::new(USUAL), PathBuf::as_path);
    if named.is_none() && disk::current_disk().follow(path).is_err() {
        return Err(ErrorKind::Option.error(format!(
            "found neither a model among the arguments nor this file, expected `poecal {name} MODEL FILES…`, or settings in this folder: \
             `poecal init MODEL` writes them"
        )).in_file(path));
    }
    let whole = command_line();
    let (Some(command), Some(own)) = (whole.find_subcommand(COMMAND), whole.find_subcommand(name)) else {
        return Ok(None);
    };
    let keys: Vec<&str> = setting_options(command).map(|arg| arg.get_id().as_str()).collect();
    let settings = Settings::read(path, &keys)?;
    let (mut options, mut files) = (Vec::new(), Vec::new());
    if named.is_none() {
        // The command needs the name of its settings file.
        options.push(OsString::from(format!("--settings={USUAL}")));
    }
    for arg in setting_options(own) {
        let entries = settings.entries.iter().filter(|entry| arg.get_id() == entry.key.as_str());
        let by_key = arg.get_id() == TABLE;
        let is_kept = |entry: &&SettingLine| {
            if by_key { !is_typed_in_table(entry, matches) } else { !is_replaced(arg, own, matches) }
        };
        for entry in entries.filter(is_kept) {
            let values = values(arg, entry, &settings)?;
            if arg.is_positional() {
                files.extend(values.into_iter().map(not_an_option));
            } else {
                options.extend(values);
            }
        }
    }
    Ok(Some(CompletedCommand { words: insert_options(typed, name, options, files), settings }))
}

impl CompletedCommand {
    /// clap's error about a setting, at the setting's place; `None` if it concerns a typed word.
    pub(crate) fn error(&self, error: &clap::Error) -> Option<Error> {
        let option = error.get(ContextKind::InvalidArg)?.to_string();
        let key = option.split([' ', '=']).next()?.trim_start_matches('-').replace('-', "_");
        let text = |kind| error.get(kind).map(ToString::to_string);
        let value = text(ContextKind::InvalidValue);
        let all = || self.settings.entries.iter().filter(|entry| entry.key == key);
        let is_it =
            |entry: &&SettingLine| matches!(&entry.value, SettingValue::One(own) if Some(own) == value.as_ref());
        let entry = all().find(is_it).or_else(|| all().next())?;
        let sentence = match (error.source(), text(ContextKind::InvalidValue), text(ContextKind::ValidValue)) {
            (Some(sentence), _, _) => sentence.to_string(),
            (None, Some(found), Some(expected)) => format!("found `{found}`, expected one of {expected}"),
            _ => error.kind().to_string(),
        };
        Some(self.settings.error(entry, format!("{key}: {sentence}")))
    }
}

/// Options that a settings file may have, from clap, so that there is one list.
fn setting_options(command: &Command) -> impl Iterator<Item = &Arg> {
    command.get_arguments().filter(|arg| !NOT_KEPT.contains(&arg.get_id().as_str()))
}

/// True if the option was typed, or one that excludes it.
fn is_replaced(arg: &Arg, command: &Command, matches: &ArgMatches) -> bool {
    let typed = |arg: &Arg| matches.value_source(arg.get_id().as_str()) == Some(ValueSource::CommandLine);
    let excluded = |other: &Arg| command.get_arg_conflicts_with(other).iter().any(|it| it.get_id() == arg.get_id());
    let excludes = |other: &Arg| command.get_arg_conflicts_with(arg).iter().any(|it| it.get_id() == other.get_id());
    typed(arg) || setting_options(command).any(|other| typed(other) && (excluded(other) || excludes(other)))
}

/// True if an entry of a table was typed with its key.
fn is_typed_in_table(entry: &SettingLine, matches: &ArgMatches) -> bool {
    let SettingValue::One(own) = &entry.value else { return false };
    let key = own.split('=').next();
    let typed = matches.get_many::<(String, String)>(TABLE).into_iter().flatten();
    typed.into_iter().any(|(other, _)| Some(other.as_str()) == key)
}

/// A setting as words of a command line.
fn values(arg: &Arg, entry: &SettingLine, settings: &Settings) -> Result<Vec<OsString>> {
    let key = entry.key.as_str();
    let is_switch = matches!(arg.get_action(), ArgAction::SetTrue);
    let takes_many =
        matches!(arg.get_action(), ArgAction::Append) || arg.get_num_args().is_some_and(|range| range.max_values() > 1);
    let texts = match &entry.value {
        SettingValue::Switch(on) if is_switch => {
            // Settings may come from elsewhere, with a model: they may replace results, but nothing else.
            let option = if key == "force" { "force-own".to_owned() } else { key.replace('_', "-") };
            let words = on.then(|| format!("--{option}").into());
            return Ok(words.into_iter().collect());
        }
        _ if is_switch => {
            return Err(settings.error(entry, format!("found a value for `{key}`, expected true or false")));
        }
        SettingValue::One(text) => vec![text],
        SettingValue::Many(texts) if takes_many => texts.iter().collect(),
        SettingValue::Many(_) => {
            return Err(settings.error(entry, format!("found a list for `{key}`, expected one value")));
        }
        SettingValue::Switch(_) => {
            return Err(settings.error(entry, format!("found true or false for `{key}`, expected a value")));
        }
    };
    let folder = settings.path.parent().unwrap_or(Path::new(""));
    let escaped = texts.iter().find(|text| OUTPUTS.contains(&key) && leads_out(folder, Path::new(text)));
    if let Some(text) = escaped {
        let message = format!(
            "found the place `{text}` for `{key}`, expected one in the folder of the settings: move it there, or type --{key}"
        );
        return Err(settings.error(entry, message));
    }
    let word = |text: &String| {
        let is_word =
            |(of, word): &(&str, &str)| *of == key && (text == word || word.ends_with(':') && text.starts_with(word));
        let is_file = FILES.contains(&key) && !NO_FILES.iter().any(is_word);
        let value = if is_file { folder.join(text).into_os_string() } else { OsString::from(text) };
        if arg.is_positional() {
            return value;
        }
        let mut word = OsString::from(format!("--{}=", key.replace('_', "-")));
        word.push(value);
        word
    };
    Ok(texts.into_iter().map(word).collect())
}

/// True if a path leads out of a folder, by itself or by a link.
fn leads_out(folder: &Path, path: &Path) -> bool {
    if !path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir)) {
        return true;
    }
    let disk = disk::current_disk();
    let home = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let Ok(home) = disk.canonical_path(home) else { return true };
    let whole = home.join(path);
    // A dangling link cannot be checked.
    let first = whole.ancestors().find(|place| disk.look(place).is_ok());
    first.is_none_or(|place| disk.canonical_path(place).map_or(true, |actual| !actual.starts_with(&home)))
}

/// A file name that clap does not take for an option.
fn not_an_option(name: OsString) -> OsString {
    if name.to_string_lossy().starts_with('-') { Path::new(".").join(name).into_os_string() } else { name }
}

/// Inserts options behind the command, before any `--`, and files at the end.
fn insert_options(typed: &[OsString], command: &str, options: Vec<OsString>, files: Vec<OsString>) -> Vec<OsString> {
    let at = typed.iter().position(|word| word == command).map_or(typed.len(), |index| index + 1);
    let (before, after) = typed.split_at(at);
    [before.to_vec(), options, after.to_vec(), files].concat()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn the_documented_settings_are_the_options() {
        let document = include_str!("../../../docs/file-formats.md");
        let section = document.split("\n## Settings\n").nth(1).unwrap().split("\n## ").next().unwrap();
        let names = section.lines().filter(|line| line.starts_with("| `")).filter_map(|line| line.split('|').nth(1));
        let documented: BTreeSet<&str> = names.flat_map(|cell| cell.split('`').skip(1).step_by(2)).collect();
        let whole = command_line();
        let mut expected: BTreeSet<&str> =
            setting_options(whole.find_subcommand(COMMAND).unwrap()).map(|arg| arg.get_id().as_str()).collect();
        expected.insert("poecal_settings = 1");
        assert_eq!(documented, expected);
        let example = section.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
        let keys: Vec<&str> = expected.into_iter().collect();
        assert_eq!(Settings::parse(example, "poecal.toml", &keys).unwrap().entries.len(), 6);
    }
}
