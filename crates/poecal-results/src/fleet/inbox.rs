//! The measurements in the inbox.

use std::io;
use std::path::{Path, PathBuf};

use super::Station;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_storage::disk::ObjectKind;
use poecal_storage::folder::{self, SkippedEntry};
use poecal_storage::hashes::sha256;

/// Most letters of a serial number.
const LONGEST: usize = 100;

/// A file of measurements.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct InboxFile {
    /// Serial number of its robot.
    pub serial: String,
    /// Date of its measurement from its path; empty if the path has none.
    pub date: String,
    /// Type of its robot; empty if there is only one.
    pub of_type: String,
    /// Its path.
    pub path: PathBuf,
}

impl InboxFile {
    /// The folder of its results.
    #[must_use]
    pub fn results(&self, station: &Station) -> PathBuf {
        let named = station.results.replace("{serial}", &self.serial).replace("{date}", &self.date);
        PathBuf::from(named.replace("{type}", &self.of_type))
    }

    /// The model of its type.
    #[must_use]
    pub fn model<'s>(&self, station: &'s Station) -> Option<&'s PathBuf> {
        station.models.get(&self.of_type).or_else(|| station.models.get(""))
    }

    /// Fault of its names, if they cannot be names of folders.
    #[must_use]
    pub fn fault(&self) -> Option<String> {
        let is_plain = |name: &str| {
            let known = |letter: char| letter.is_alphanumeric() || "._+- ".contains(letter);
            name.chars().all(known) && !name.starts_with('.') && name.len() <= LONGEST
        };
        let all = [("serial number", &self.serial), ("date", &self.date), ("type", &self.of_type)];
        let (what, name) = all.into_iter().find(|(_, name)| !is_plain(name))?;
        Some(format!(
            "found the {what} `{name}`, expected letters, digits and . _ - + alone, not beginning with a dot: rename the file"
        ))
    }

    /// SHA-256 of its bytes; `None` if it cannot be read.
    #[must_use]
    pub fn sha256(&self) -> Option<String> {
        sha256(&self.path).ok().flatten()
    }

    /// True if it belongs to this part of all robots, by its serial number: 1 to `of`.
    #[must_use]
    pub fn is_of_shard(&self, (number, of): (u32, u32)) -> bool {
        let hash = poecal_storage::hashes::sha256_of(&self.serial);
        let first = hash.get(..8).and_then(|it| u32::from_str_radix(it, 16).ok()).unwrap_or_default();
        first % of.max(1) + 1 == number
    }
}

/// All files of the inbox, by serial number and date, and the entries that are no measurements.
///
/// # Errors
/// [`ErrorKind::File`] if the folder before the first braces cannot be read, or a folder has too many files.
pub fn list_files(station: &Station) -> Result<(Vec<InboxFile>, Vec<SkippedEntry>)> {
    let parts: Vec<&str> = Path::new(&station.inbox).iter().filter_map(|part| part.to_str()).collect();
    let plain = parts.iter().take_while(|part| !part.contains('{')).count();
    let root: PathBuf = parts[..plain].iter().collect();
    let root = if root.as_os_str().is_empty() { PathBuf::from(".") } else { root };
    let (mut found, mut left) = (Vec::new(), Vec::new());
    let none = InboxFile { serial: String::new(), date: String::new(), of_type: String::new(), path: root.clone() };
    let cannot = |error: io::Error| ErrorKind::File.error(format!("the inbox cannot be read ({error})")).in_file(&root);
    walk(&none, (&root, &parts[plain..]), &mut found, &mut left).map_err(cannot)?;
    found.sort();
    left.sort();
    Ok((found, left))
}

/// Goes down the parts of a path, from the folder `root`.
fn walk(
    at: &InboxFile,
    (root, parts): (&Path, &[&str]),
    found: &mut Vec<InboxFile>,
    left: &mut Vec<SkippedEntry>,
) -> io::Result<()> {
    let Some((part, rest)) = parts.split_first() else { return Ok(()) };
    let (names, others) = folder::names(&at.path)?;
    left.extend(others);
    for name in names {
        let Some(own) = match_pattern(part, &name) else { continue };
        let path = at.path.join(&name);
        let kind = match folder::kind(root, &path) {
            Ok(kind) => kind,
            Err(other) => {
                left.push(other);
                continue;
            }
        };
        let pick = |key: &str, before: &String| {
            own.iter().find(|it| it.0 == key).map_or_else(|| before.clone(), |it| it.1.clone())
        };
        let next = InboxFile {
            serial: pick("serial", &at.serial),
            date: pick("date", &at.date),
            of_type: pick("type", &at.of_type),
            path,
        };
        match (rest.is_empty(), kind) {
            (true, ObjectKind::File) => found.push(next),
            (false, ObjectKind::Folder) => walk(&next, (root, rest), found, left)?,
            _ => {}
        }
    }
    Ok(())
}

/// The texts in place of the braces, if a name matches this pattern: each as short as possible.
fn match_pattern(pattern: &str, name: &str) -> Option<Vec<(String, String)>> {
    let Some(open) = pattern.find('{') else { return (pattern == name).then(Vec::new) };
    let rest = name.strip_prefix(pattern.get(..open)?)?;
    let close = open + pattern.get(open..)?.find('}')?;
    let (key, after) = (pattern.get(open + 1..close)?, pattern.get(close + 1..)?);
    let ends = rest.char_indices().map(|(at, letter)| at + letter.len_utf8());
    ends.into_iter().find_map(|end| {
        let mut others = match_pattern(after, rest.get(end..)?)?;
        others.insert(0, (key.to_owned(), rest.get(..end)?.to_owned()));
        Some(others)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_matched_by_patterns() {
        let found = match_pattern("{serial}_{date}.csv", "SN1_2026-01-02.csv").unwrap();
        assert_eq!(found, [("serial".into(), "SN1".into()), ("date".into(), "2026-01-02".into())]);
        assert_eq!(match_pattern("{serial}.csv", ".csv"), None);
        assert_eq!(match_pattern("{serial}.csv", "a.txt"), None);
    }
}
