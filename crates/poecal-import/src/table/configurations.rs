//! A folder with the joint readings of each picture in a separate file, `configuration_1`, `configuration_2.yaml`, …, as one table.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::picture_names::number_at_end;
use poecal_numerics::error::{Error, ErrorKind, Result, shorten_name};
use poecal_storage::csv_text::cell;
use poecal_storage::disk::{self, ObjectKind};
use poecal_storage::document;
use poecal_storage::folder::{self, SkippedEntry};
use poecal_storage::hashes::sha256_of;
use poecal_storage::limits::ResourceLimit;
use poecal_storage::numbers::{LARGEST_NUMBER, push_number};
use poecal_storage::source::SQLITE_BAG;
use poecal_storage::yaml::{YamlLeaf, leaves};
use poecal_storage::{source, source_text};

/// Endings of files of readings; other files of the folder, such as pictures, are ignored.
const ENDINGS: [&str; 6] = ["", "txt", "dat", "csv", "yaml", "yml"];
/// Keys of a list of readings, and of the names of its joints.
const LISTS: [&str; 5] = ["joints", "joint_positions", "positions", "position", "q"];
const NAMES: [&str; 4] = ["joint_names", "names", "name", "joints"];
const EXPECTED: &str = "the joint readings of one picture: numbers, `joints: [0.1, …]`, or lines `joint1: 0.1`";

/// The files of a folder.
pub(crate) struct ConfigurationFolder {
    /// CSV with a row for each file: its name, as that of the picture, and the readings.
    pub(crate) text: String,
    /// SHA-256 of the texts of the files, one after the other by their numbers.
    pub(crate) sha256: String,
    /// Entries with such a name that are no files.
    pub(crate) left: Vec<SkippedEntry>,
}

/// The readings of a file; `names` is empty if it has none.
struct FileReadings {
    path: PathBuf,
    names: Vec<String>,
    values: Vec<f64>,
}

/// True if a path is a folder.
pub(crate) fn is_folder(path: &Path) -> bool {
    let is_folder = |found: disk::DiskObject| found.kind == ObjectKind::Folder;
    !source::is_standard_input(path)
        && !document::is_kept(path)
        && disk::current_disk().follow(path).is_ok_and(is_folder)
}

/// An error in the table of a folder, in the file that made the line.
pub(crate) fn in_its_file(error: Error, folder: &Path) -> Error {
    let is_of_table = |place: &&poecal_numerics::error::FilePosition| place.path == folder && is_folder(folder);
    let Some(line) = error.place().filter(is_of_table).and_then(|place| place.line) else { return error };
    let files = numbered_files(folder).unwrap_or_default().0;
    // The line is below the header.
    match line.checked_sub(2).and_then(|at| files.get(at)) {
        Some(name) => error.without_line().with_path(&folder.join(name)),
        None => error.without_line(),
    }
}

/// Remedy for a file of such a folder that is read alone.
pub(crate) fn advice(path: &Path) -> &'static str {
    let name = path.file_name().and_then(|it| it.to_str()).unwrap_or_default().to_ascii_lowercase();
    if name.starts_with("configuration") && number_at_end(&name).is_some() {
        "; the readings of each picture in a file of its own are read by the name of their folder"
    } else {
        ""
    }
}

/// Reads the files of a folder whose names end in a number.
pub(crate) fn read(folder: &Path) -> Result<ConfigurationFolder> {
    let (files, left) = numbered_files(folder)?;
    let (mut all, mut whole) = (Vec::with_capacity(files.len()), String::new());
    for name in &files {
        let path = folder.join(name);
        let text = source_text::read_up_to(&path, EXPECTED, ResourceLimit::Settings)?;
        all.push(FileReadings::from_text(&text, path)?);
        whole.push_str(&text);
    }
    let mut text = "image".to_owned();
    let first = all.first();
    for column in first.map_or_else(Vec::new, FileReadings::columns) {
        text.push(',');
        text.push_str(&cell(&column));
    }
    text.push('\n');
    for (name, own) in files.iter().zip(&all) {
        text.push_str(&cell(name));
        for value in own.ordered_as(first.unwrap_or(own))? {
            text.push(',');
            push_number(&mut text, value);
        }
        text.push('\n');
    }
    Ok(ConfigurationFolder { text, sha256: sha256_of(&whole), left })
}

/// The names of the files of readings, by their numbers, and entries with such a name that are no files.
fn numbered_files(folder: &Path) -> Result<(Vec<String>, Vec<SkippedEntry>)> {
    const EXPECTED: &str = "`configuration_1`, `configuration_2.yaml`, … with the joint readings of each picture";
    let error = |message: String| Error::new(ErrorKind::Measurement, message).in_file(folder);
    let unreadable = |error| source::unreadable_error(folder, &error, EXPECTED);
    let is_of_bag = |name: &String| name == "metadata.yaml" || name.ends_with(".db3");
    let is_bag = folder::names(folder).map_err(unreadable)?.0.iter().any(is_of_bag);
    let is_wanted = |name: &str| {
        let ending = Path::new(name).extension().map_or("", |it| it.to_str().unwrap_or("?"));
        let is_text = ENDINGS.iter().any(|it| ending.eq_ignore_ascii_case(it));
        is_text && number_at_end(name).is_some()
    };
    let (names, left) = folder::files(folder, is_wanted).map_err(unreadable)?;
    let mut found: BTreeMap<u64, String> = BTreeMap::new();
    for name in names {
        let Some(number) = number_at_end(&name) else { continue };
        if let Some(other) = found.get(&number) {
            return Err(error(format!(
                "found two files with the number {number}, `{}` and `{}`, expected one with the joint readings of each picture: move the other one away",
                shorten_name(other),
                shorten_name(&name)
            )));
        }
        found.insert(number, name);
    }
    if found.is_empty() && is_bag {
        return Err(ErrorKind::File
            .error(format!("found {SQLITE_BAG}, expected a measurement file (CSV)"))
            .in_file(folder));
    }
    if found.is_empty() {
        return Err(error(format!(
            "found a directory without text files whose names end in a number, expected a table (CSV), or {EXPECTED}"
        )));
    }
    Ok((found.into_values().collect(), left))
}

impl FileReadings {
    fn from_text(text: &str, path: PathBuf) -> Result<Self> {
        let text = text.trim_start_matches('\u{feff}');
        let refuse = |line: usize, found: &str| {
            let message = format!("found {found}, expected {EXPECTED}");
            Err(Error::new(ErrorKind::Measurement, message).at_line(&path, line))
        };
        let lines = || text.lines().map(|line| line.split('#').next().unwrap_or_default());
        let is_between = |it: char| it.is_whitespace() || ",;[]()".contains(it);
        let words = lines()
            .enumerate()
            .flat_map(|(at, line)| line.split(is_between).filter(|it| !it.is_empty()).map(move |it| (at, it)));
        let numbers: std::result::Result<Vec<f64>, (usize, &str)> =
            words.map(|(at, word)| number(word).ok_or((at + 1, word))).collect();
        let is_yaml = || lines().any(|line| line.contains([':', '{']) || line.trim_start().starts_with("- "));
        match numbers {
            Ok(values) if values.is_empty() => refuse(1, "no number"),
            Ok(values) => Ok(FileReadings { path, names: Vec::new(), values }),
            Err(_) if is_yaml() => match of_leaves(&leaves(text, &path, EXPECTED)?) {
                Ok((names, values)) => Ok(FileReadings { path, names, values }),
                Err((line, found)) => refuse(line, &found),
            },
            Err((line, word)) => refuse(line, &format!("`{}`", shorten_name(word))),
        }
    }

    /// Names of columns: numbers of joints if there are no names.
    fn columns(&self) -> Vec<String> {
        if self.names.is_empty() {
            return (1..=self.values.len()).map(|number| format!("q{number}")).collect();
        }
        self.names.clone()
    }

    /// The values in the order of another file.
    fn ordered_as(&self, first: &Self) -> Result<Vec<f64>> {
        let refuse = |message: String| {
            let message = format!("{message} as in {}", first.path.display());
            Err(Error::new(ErrorKind::Measurement, message).in_file(&self.path))
        };
        let (found, expected) = (self.values.len(), first.values.len());
        if found != expected {
            return refuse(format!("found {found} joint readings, expected {expected}"));
        }
        match (self.names.is_empty(), first.names.is_empty()) {
            (true, true) => Ok(self.values.clone()),
            (true, false) => refuse("found readings without names, expected the names of the joints".to_owned()),
            (false, true) => refuse("found readings with names of joints, expected them without".to_owned()),
            (false, false) => {
                let own = |name: &String| self.names.iter().zip(&self.values).find(|it| it.0 == name);
                match first.names.iter().find(|name| own(name).is_none()) {
                    Some(name) => refuse(format!("found no reading of `{}`, expected one", shorten_name(name))),
                    None => Ok(first.names.iter().filter_map(own).map(|it| *it.1).collect()),
                }
            }
        }
    }
}

fn number(text: &str) -> Option<f64> {
    text.parse().ok().filter(|it: &f64| it.abs() <= LARGEST_NUMBER)
}

/// Names, if any, and values of a mapping or a list; else the line with the defect there.
fn of_leaves(all: &[YamlLeaf]) -> std::result::Result<(Vec<String>, Vec<f64>), (usize, String)> {
    let below = |key: &&str| -> Vec<&YamlLeaf> {
        all.iter().filter(|leaf| leaf.path.len() > 1 && leaf.path.first().is_some_and(|it| it == key)).collect()
    };
    let is_number = |leaf: &&YamlLeaf| number(&leaf.text).is_some();
    let lists = LISTS.iter().map(below);
    let listed = lists.filter(|it| !it.is_empty()).max_by_key(|it| it.iter().all(is_number));
    let (entries, depth) = listed.map_or_else(|| (all.iter().collect(), 0), |it| (it, 1));
    let names = NAMES.iter().map(below).find(|it| it.len() == entries.len() && !it.iter().any(is_number));
    let (mut keys, mut values) = (Vec::new(), Vec::new());
    for leaf in &entries {
        let path = leaf.path.join(".");
        let value = number(&leaf.text).filter(|_| leaf.path.len() == depth + 1);
        let of = if path.is_empty() { String::new() } else { format!(" for `{}`", shorten_name(&path)) };
        let found = || (leaf.line, format!("`{}`{of}", shorten_name(&leaf.text)));
        values.push(value.ok_or_else(found)?);
        keys.extend(leaf.path.last().cloned());
    }
    let is_list = keys.iter().enumerate().all(|(at, key)| *key == at.to_string());
    if values.is_empty() {
        return Err((1, "no reading".to_owned()));
    }
    Ok(match names {
        Some(names) if is_list => (names.iter().map(|it| it.text.clone()).collect(), values),
        None if is_list => (Vec::new(), values),
        _ => (keys, values),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn readings_of_text(text: &str) -> std::result::Result<(Vec<String>, Vec<f64>), String> {
        let found = FileReadings::from_text(text, PathBuf::from("configuration_1"));
        found.map(|it| (it.names, it.values)).map_err(|error| error.to_string())
    }

    #[test]
    fn readings_are_the_same_however_they_are_written() {
        for text in [
            "0.1 -0.2 1e-3",
            "0.1, -0.2, 1e-3\n",
            "\u{feff}# joints\n0.1\r\n-0.2\r\n1e-3\r\n",
            "[0.1, -0.2, 1e-3]",
            "(0.1; -0.2; 1e-3)",
            "- 0.1\n- -0.2\n- 1e-3\n",
            "joints: [0.1, -0.2, 1e-3]",
            "joint_positions:\n- 0.1\n- -0.2\n- 1e-3\n",
            "q: [0.1, -0.2, 1e-3] # at rest\nstamp: 17\n",
        ] {
            assert_eq!(readings_of_text(text), Ok((Vec::new(), vec![0.1, -0.2, 1e-3])), "{text}");
        }
        for text in [
            "a: 0.1\nb: -0.2\n",
            "joints: {a: 0.1, b: -0.2}",
            "name: [a, b]\nposition: [0.1, -0.2]\n",
            "{joints: [a, b], positions: [0.1, -0.2]}",
        ] {
            assert_eq!(readings_of_text(text), Ok((vec!["a".to_owned(), "b".to_owned()], vec![0.1, -0.2])), "{text}");
        }
    }

    #[test]
    fn what_is_no_reading_is_named_with_its_line() {
        for (text, part) in [
            ("0.1 0.2\nhome\n", "configuration_1:2: found `home`, expected the joint readings"),
            ("0.1 nan", "configuration_1:1: found `nan`"),
            ("# nothing\n", "found no number"),
            ("a: 0.1\nb: up\n", "configuration_1:2: found `up` for `b`"),
            ("robot: {q: [0.1]}", "found `0.1` for `robot.q.0`"),
            ("joints: []", "found"),
            ("a: [", "found broken YAML"),
            ("1e9", "found `1e9`"),
        ] {
            let error = readings_of_text(text).unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
