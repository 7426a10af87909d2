//! Files written whole or not at all: beside their place first, then moved.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use crate::error::{Error, ErrorKind, Result};

/// Refuses a folder that exists (unless `force`) or that cannot be made: asked before the work begins.
///
/// # Errors
/// [`ErrorKind::File`].
pub fn check_folder(folder: &Path, force: bool) -> Result<()> {
    let error = |message: &str| Err(Error::new(ErrorKind::File, message).in_file(folder));
    if folder.exists() {
        if !folder.is_dir() {
            return error("found a file, expected a folder for the results: choose another with --out");
        }
        if !force {
            return error(
                "the output folder exists, expected a new one: choose another with --out, or overwrite its results with --force",
            );
        }
        return Ok(());
    }
    check_parent(folder)
}

/// Refuses a place whose folder does not exist.
fn check_parent(path: &Path) -> Result<()> {
    if parent(path).is_dir() {
        return Ok(());
    }
    let message = "the folder above does not exist, expected one to write into: create it first";
    Err(Error::new(ErrorKind::File, message).in_file(path))
}

fn parent(folder: &Path) -> PathBuf {
    match folder.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

/// A folder beside the final one, removed when dropped.
pub(super) struct Staging {
    folder: PathBuf,
}

impl Staging {
    pub(super) fn new(final_folder: &Path) -> Result<Self> {
        let name = final_folder.file_name().map_or_else(|| "out".into(), |name| name.to_string_lossy());
        let folder = parent(final_folder).join(format!(".{name}.unfinished-{}", std::process::id()));
        fs::create_dir(&folder).map_err(|error| {
            let message = format!(
                "the folder cannot be written to ({error}), expected one that can: choose another with --out"
            );
            Error::new(ErrorKind::File, message).in_file(final_folder)
        })?;
        Ok(Staging { folder })
    }

    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    pub(super) fn write(&self, name: &str, text: &str) -> Result<()> {
        let path = self.folder.join(name);
        let result = fs::File::create(&path).and_then(|mut file| {
            file.write_all(text.as_bytes())?;
            file.sync_all()
        });
        result.map_err(|error| {
            Error::new(ErrorKind::File, format!("{name} cannot be written: {error}")).in_file(&self.folder)
        })
    }

    /// Moves the files to their folder: the whole folder at once if it is new, else file by file over the old ones.
    pub(super) fn put_in_place(self, folder: &Path, names: &[String]) -> Result<()> {
        let moved = if folder.exists() {
            names.iter().try_for_each(|name| fs::rename(self.folder.join(name), folder.join(name)))
        } else {
            fs::rename(&self.folder, folder)
        };
        moved.map_err(|error| {
            Error::new(ErrorKind::File, format!("the results cannot be put in place: {error}"))
                .in_file(folder)
        })
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        // After the whole folder was moved there is nothing left, and nothing to report.
        let _ = fs::remove_dir_all(&self.folder);
    }
}

/// Writes one file whole or not at all: beside its place first, then moved.
///
/// # Errors
/// [`ErrorKind::File`] if it cannot be written.
pub fn write_file(path: &Path, text: &str) -> Result<()> {
    let error = |error: std::io::Error| {
        Error::new(
            ErrorKind::File,
            format!("the file cannot be written ({error}), expected a folder that can be written to: choose another"),
        )
        .in_file(path)
    };
    if path.is_dir() {
        let message = "found a directory, expected a file to write: name the file";
        return Err(Error::new(ErrorKind::File, message).in_file(path));
    }
    check_parent(path)?;
    let name = path.file_name().map_or_else(|| "out".into(), |name| name.to_string_lossy().into_owned());
    let beside = parent(path).join(format!(".{name}.unfinished-{}", std::process::id()));
    fs::write(&beside, text).map_err(error)?;
    fs::rename(&beside, path).map_err(|cause| {
        let _ = fs::remove_file(&beside);
        error(cause)
    })
}
