//! Output folders: checks of existing files before the work begins.

use std::ffi::OsStr;
use std::io;
use std::path::{Path, PathBuf};

use super::contents::{self, Contents, REPORT};
use super::existing::{ExistingFiles, find_object, is_of_poecal, led_to, new_place, path_error, refuse_input};
use super::staging::{self, Staging};
use super::{ReservedFile, leftovers};
use poecal_numerics::error::{Error, Result};
use poecal_storage::disk::{self, Disk, ObjectKind};
use poecal_storage::write_locks::{self, ReservedPlace};

/// A reserved place for files. Nothing in it has changed yet, and nothing will unless all is written.
pub struct ReservedFolder {
    /// Path as stated by the user.
    pub(crate) named: PathBuf,
    /// Without links.
    pub(crate) folder: PathBuf,
    pub(crate) contents: Contents,
    pub(crate) existing: ExistingFiles,
    /// True if the folder existed.
    pub(crate) was_there: bool,
    pub(crate) staging: Staging,
    /// Reservation against other runs of this process.
    _held: Option<ReservedPlace>,
}

impl std::fmt::Debug for ReservedFolder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("FolderPlace").field("named", &self.named).finish_non_exhaustive()
    }
}

impl ReservedFolder {
    /// Checks that files may be written to a folder, and makes room for them: inside, or beside a new folder. Remains of an interrupted run
    /// are completed or removed first, with messages. `inputs` are files of this run, which are never replaced.
    ///
    /// # Errors
    /// [`ErrorKind::File`](poecal_numerics::error::ErrorKind::File) if the folder holds something that `existing` does not allow to replace, if
    /// something there is no regular file or is an input, or if the folder cannot be written to.
    pub fn reserve(
        folder: &Path,
        contents: Contents,
        existing: ExistingFiles,
        inputs: &[&Path],
        say: &mut dyn FnMut(String),
    ) -> Result<Self> {
        let disk = disk::current_disk();
        let cannot = |error: io::Error| unwritable_error(folder, &error);
        let there = match find_object(disk.as_ref(), folder)? {
            Some(found) if found.kind == ObjectKind::Link => Some(led_to(disk.as_ref(), folder)?),
            Some(found) => Some((disk.canonical_path(folder).map_err(cannot)?, found)),
            None => None,
        };
        let (parent, prefix, actual) = match &there {
            None => {
                let (parent, actual) = new_place(disk.as_ref(), folder)?;
                (parent, staging::prefix(actual.file_name()), actual)
            }
            Some((actual, found)) if found.kind == ObjectKind::Folder => {
                (actual.clone(), staging::prefix(None), actual.clone())
            }
            Some(_) => {
                let what = if contents == Contents::Project { "project" } else { "results" };
                let message = format!("found a file, expected a folder for the {what}: choose another with --out");
                return Err(path_error(folder, message));
            }
        };
        let held = write_locks::hold(&actual, "the folder", write_locks::patience(), say)
            .map_err(|error| error.with_path(folder))?;
        leftovers::settle(disk.as_ref(), &actual, say);
        if there.is_some() {
            let names = own_names(disk.as_ref(), &actual, contents).map_err(cannot)?;
            check_existing(disk.as_ref(), folder, &actual, (contents, existing), &names)?;
            refuse_foreign(disk.as_ref(), folder, &names)?;
            names.iter().try_for_each(|name| check_own(disk.as_ref(), &folder.join(name), inputs))?;
        }
        let staging = Staging::new(&disk, &parent, &prefix).map_err(cannot)?;
        let (named, was_there) = (folder.to_owned(), there.is_some());
        Ok(ReservedFolder { named, folder: actual, contents, existing, was_there, staging, _held: held })
    }

    /// The place of a report outside these results; `None` if its path is that among them.
    ///
    /// # Errors
    /// As [`ReservedFile::reserve`], and if it is the folder itself or the path of another result.
    pub fn reserve_report(
        &self,
        path: &Path,
        inputs: &[&Path],
        say: &mut dyn FnMut(String),
    ) -> Result<Option<ReservedFile>> {
        let disk = &self.staging.disk;
        let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let actual = disk.canonical_path(parent).unwrap_or_else(|_| parent.to_owned());
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        if path == self.named || actual.join(name) == self.folder {
            return Err(path_error(
                path,
                "found the folder of the results, expected a file for the report: choose another",
            ));
        }
        if actual == self.folder || parent == self.named {
            if name == REPORT {
                return Ok(None);
            }
            if self.contents.is_own(name) {
                return Err(path_error(
                    path,
                    "found the place of another result, expected one for the report: choose another",
                ));
            }
        }
        ReservedFile::reserve(path, self.existing, inputs, say).map(Some)
    }
}

/// Most folders of one name.
const MOST_FOLDERS: usize = 9999;

/// The first of `name`, `name-2`, `name-3`, … that does not exist, or is an empty folder; the name itself if there are too many.
#[must_use]
pub fn free_folder(name: &Path) -> PathBuf {
    let disk = disk::current_disk();
    let is_free = |path: &PathBuf| match disk.look(path) {
        Err(error) => error.kind() == io::ErrorKind::NotFound,
        Ok(_) => staging::names(&*disk, path).is_ok_and(|names| names.is_empty()),
    };
    let numbered = |number: usize| {
        let mut path = name.as_os_str().to_owned();
        path.push(format!("-{number}"));
        PathBuf::from(path)
    };
    let all = std::iter::once(name.to_path_buf()).chain((2..=MOST_FOLDERS).map(numbered));
    all.into_iter().find(is_free).unwrap_or_else(|| name.to_path_buf())
}

pub(crate) fn unwritable_error(folder: &Path, error: &io::Error) -> Error {
    let message =
        format!("the folder cannot be written to ({error}), expected one that can: choose another with --out");
    path_error(folder, message)
}

/// Names in a folder that belong to the contents.
pub(crate) fn own_names(disk: &dyn Disk, folder: &Path, contents: Contents) -> io::Result<Vec<String>> {
    let names = staging::names(disk, folder)?.into_iter().filter_map(|name| name.into_string().ok());
    Ok(names.filter(|name| contents.is_own(name)).collect())
}

/// Refuses a folder whose files must not be replaced.
pub(crate) fn check_existing(
    disk: &dyn Disk,
    folder: &Path,
    actual: &Path,
    (contents, existing): (Contents, ExistingFiles),
    names: &[String],
) -> Result<()> {
    if contents == Contents::Project {
        return match contents::PROJECT.into_iter().find(|own| names.iter().any(|name| name == own)) {
            Some(name) => Err(taken_error(&folder.join(name))),
            None => Ok(()),
        };
    }
    if let Some(name) = contents.of_others()
        && disk.look(&actual.join(name)).is_ok()
    {
        let what = if contents == Contents::Validation { "a calibration" } else { "a check" };
        let message = format!("found the results of {what}, expected another folder: choose one with --out");
        return Err(path_error(folder, message));
    }
    let is_staging = |name: &OsStr| staging::is_staging(name, &staging::prefix(None));
    let all = staging::names(disk, actual).map_err(|error| unwritable_error(folder, &error))?;
    if all.iter().all(|name| is_staging(name)) {
        return Ok(());
    }
    match existing {
        ExistingFiles::Replaced => Ok(()),
        ExistingFiles::Own if is_of_poecal(disk, &actual.join(CALIBRATION), SCHEMA) => Ok(()),
        ExistingFiles::Own => Err(path_error(
            folder,
            "found a folder without results of poecal, which `force` in the settings does not let it write to, expected a new folder or \
             earlier results: choose another, or type --force",
        )),
        ExistingFiles::Kept => Err(path_error(
            folder,
            "the output folder exists, expected a new one: choose another with --out, or overwrite its results with --force",
        )),
    }
}

/// Refuses to replace a `calibration.json` of another program, whatever option was typed.
fn refuse_foreign(disk: &dyn Disk, folder: &Path, names: &[String]) -> Result<()> {
    let path = folder.join(CALIBRATION);
    let is_foreign = names.iter().any(|name| name == CALIBRATION)
        && disk.look(&path).is_ok_and(|found| found.kind == ObjectKind::File)
        && !is_of_poecal(disk, &path, SCHEMA);
    if !is_foreign {
        return Ok(());
    }
    let message = "found a file that poecal did not write, expected an earlier calibration or nothing: move it away, or choose another folder with --out";
    Err(path_error(&path, message))
}

/// Name of the file of a calibration.
const CALIBRATION: &str = "calibration.json";

/// Refuses to replace an input, or an object that is no regular file.
pub(crate) fn check_own(disk: &dyn Disk, path: &Path, inputs: &[&Path]) -> Result<()> {
    let what = match find_object(disk, path)?.map(|found| found.kind) {
        None => return Ok(()),
        Some(ObjectKind::File) => return refuse_input(disk, path, inputs),
        Some(ObjectKind::Folder) => "a directory",
        Some(ObjectKind::Link) => "a link",
        Some(ObjectKind::Other) => "a device or a pipe",
    };
    let message =
        format!("found {what}, expected a file or nothing: move it away, or choose another folder with --out");
    Err(path_error(path, message))
}

/// Text that identifies a `calibration.json`.
const SCHEMA: &str = "\"schema\": \"poecal-calibration-";

/// The error for a file in the way.
pub(crate) fn taken_error(path: &Path) -> Error {
    let message = "found this file, expected none: a project never overwrites what may have been filled in, choose another folder with --out";
    path_error(path, message)
}
