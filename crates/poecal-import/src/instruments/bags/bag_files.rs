//! The files of a bag: one, or those of a folder.

use std::path::{Path, PathBuf};

use super::EXPECTED;
use crate::table::configurations::is_folder;
use crate::table::picture_names::number_at_end;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_storage::containers::mcap::MAGIC;
use poecal_storage::containers::unpack::ZSTD;
use poecal_storage::folder::{self, SkippedEntry};
use poecal_storage::limits::ResourceLimit;
use poecal_storage::source;

/// Endings of the names of files, plain and compressed as a whole.
const ENDINGS: [&str; 2] = [".mcap", ".mcap.zstd"];

/// True for the name of a part of a bag.
fn is_part(name: &str) -> bool {
    let small = name.to_ascii_lowercase();
    ENDINGS.iter().any(|it| small.ends_with(it))
}

/// True if a path is a bag, by the first bytes of the file, or by the names in the folder.
pub(crate) fn is_bag(path: &Path) -> bool {
    if is_folder(path) {
        return names(path).is_ok_and(|it| !it.0.is_empty());
    }
    let is_packed = path.to_str().is_some_and(|it| is_part(it) && !it.ends_with(ENDINGS[0]));
    let begins = |head: Vec<u8>| head.starts_with(MAGIC) || is_packed && head.starts_with(ZSTD);
    source::open_any(path, EXPECTED, ResourceLimit::Bag).is_ok_and(|(_, head)| begins(head))
}

/// Names of files of a folder that are parts of a bag, and entries with such a name that are not.
fn names(folder: &Path) -> std::io::Result<(Vec<String>, Vec<SkippedEntry>)> {
    folder::files(folder, is_part)
}

/// The files of a bag by their numbers, and the entries of its folder that are left out.
pub(crate) fn files_of_bag(path: &Path) -> Result<(Vec<PathBuf>, Vec<SkippedEntry>)> {
    if !is_folder(path) {
        return Ok((vec![path.to_path_buf()], Vec::new()));
    }
    let (mut names, left) = names(path).map_err(|error| source::unreadable_error(path, &error, EXPECTED))?;
    // Names without their numbers, which are the same for all parts of a bag.
    let stem = |name: &String| {
        let stem = name.split_once(ENDINGS[0]).map_or(name.as_str(), |it| it.0);
        stem.trim_end_matches(|it: char| it.is_ascii_digit()).to_owned()
    };
    if let Some(other) = names.iter().find(|it| Some(stem(it)) != names.first().map(stem)) {
        let first = names.first().map_or("", String::as_str);
        let message = format!(
            "found the files of two bags, `{first}` and `{other}`, expected the parts of one, whose names differ in the number at their end alone"
        );
        return Err(ErrorKind::Measurement.error(message).in_file(path));
    }
    names.sort_by_cached_key(|name| (number_at_end(name), name.clone()));
    Ok((names.into_iter().map(|name| path.join(name)).collect(), left))
}
