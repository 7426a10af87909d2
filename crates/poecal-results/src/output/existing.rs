//! Treatment of existing files.

use std::io;
use std::path::{Path, PathBuf};

use super::staging;
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_storage::disk::{Disk, DiskObject, ObjectKind};
use poecal_storage::named_files;

/// Text that identifies a report.
pub(crate) const GENERATOR: &str = "<meta name=\"generator\" content=\"poecal ";
/// Number of leading bytes that contain it.
const HEAD: u64 = 4096;

/// Treatment of existing files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExistingFiles {
    /// They stay, and nothing is written.
    Kept,
    /// Those written by poecal are replaced: a folder with a `calibration.json`, a report.
    Own,
    /// They are replaced.
    Replaced,
}

impl ExistingFiles {
    /// Variant by the state of a switch.
    #[must_use]
    pub fn from_switch(force: bool) -> Self {
        if force { ExistingFiles::Replaced } else { ExistingFiles::Kept }
    }
}

/// An error at a path.
pub(crate) fn path_error(path: &Path, message: impl Into<String>) -> Error {
    ErrorKind::File.error(message).in_file(path)
}

/// The object at a path, if there is one.
pub(crate) fn find_object(disk: &dyn Disk, path: &Path) -> Result<Option<DiskObject>> {
    staging::find_object(disk, path).map_err(|error| {
        let message = format!("the place cannot be looked at ({error}), expected one to write to: choose another");
        path_error(path, message)
    })
}

/// Path without links of a new file in an existing folder.
pub(crate) fn new_place(disk: &dyn Disk, path: &Path) -> Result<(PathBuf, PathBuf)> {
    let parent = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let Some(name) = path.file_name() else {
        return Err(path_error(path, "found no name at the end of the path, expected one: name the place"));
    };
    match disk.canonical_path(parent) {
        Ok(actual) if disk.follow(&actual).is_ok_and(|found| found.kind == ObjectKind::Folder) => {
            Ok((actual.clone(), actual.join(name)))
        }
        _ => {
            let message = "the folder above does not exist, expected one to write into: create it first";
            Err(path_error(path, message))
        }
    }
}

/// Object at the end of a link.
pub(crate) fn led_to(disk: &dyn Disk, path: &Path) -> Result<(PathBuf, DiskObject)> {
    let actual = disk.canonical_path(path).and_then(|actual| Ok((actual.clone(), disk.look(&actual)?)));
    actual.map_err(|error| {
        path_error(
            path,
            format!(
                "found a link that leads nowhere ({error}), expected one to something: remove it, or choose another"
            ),
        )
    })
}

/// Refuses to replace an input of the same run, by any path.
pub(crate) fn refuse_input(disk: &dyn Disk, path: &Path, inputs: &[&Path]) -> Result<()> {
    let Some(input) = inputs.iter().find(|input| named_files::are_same(disk, input, path)) else {
        return Ok(());
    };
    let message = format!(
        "found a file that this run reads ({}), expected another place to write to: an input is never replaced, choose another \
         with --out",
        input.display()
    );
    Err(path_error(path, message))
}

/// True if poecal wrote a file.
pub(crate) fn is_of_poecal(disk: &dyn Disk, path: &Path, mark: &str) -> bool {
    let mut head = Vec::new();
    let is_file = disk.look(path).is_ok_and(|found| found.kind == ObjectKind::File);
    let read = |file: Box<dyn io::Read + Send>| io::Read::read_to_end(&mut io::Read::take(file, HEAD), &mut head);
    is_file && disk.open(path).and_then(read).is_ok() && head.windows(mark.len()).any(|part| part == mark.as_bytes())
}
