//! Files written whole or not at all: beside their place first, then moved.

use std::fs::{self, File};
use std::io::{ErrorKind as ErrorKindIo, Write as _};
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
pub(super) fn check_parent(path: &Path) -> Result<()> {
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

/// Stale staging folders that are passed over.
const ATTEMPTS: usize = 100;
/// Where the files that are being replaced lie in the staging folder.
const OLD: &str = "old";

/// A folder beside the final one, removed when dropped.
pub(super) struct Staging {
    folder: PathBuf,
    final_folder: PathBuf,
}

impl Staging {
    pub(super) fn new(final_folder: &Path) -> Result<Self> {
        let name = final_folder.file_name().map_or_else(|| "out".into(), |name| name.to_string_lossy());
        let stem = format!(".{name}.unfinished-{}", std::process::id());
        let mut attempt = 0;
        loop {
            // A run that was killed may have left a folder of this name.
            let suffix = if attempt == 0 { String::new() } else { format!("-{attempt}") };
            let folder = parent(final_folder).join(format!("{stem}{suffix}"));
            match fs::create_dir(&folder) {
                Ok(()) => return Ok(Staging { folder, final_folder: final_folder.to_path_buf() }),
                Err(error) if error.kind() == ErrorKindIo::AlreadyExists && attempt < ATTEMPTS => {
                    attempt += 1
                }
                Err(error) => {
                    let message = format!(
                        "the folder cannot be written to ({error}), expected one that can: choose another with --out"
                    );
                    return Err(Error::new(ErrorKind::File, message).in_file(final_folder));
                }
            }
        }
    }

    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    /// Writes a file by `fill`.
    pub(super) fn write(
        &self,
        name: &str,
        fill: impl FnOnce(&mut File) -> std::io::Result<()>,
    ) -> Result<()> {
        let written = File::create(self.folder.join(name)).and_then(|mut file| fill(&mut file));
        written.map_err(|error| {
            let message = format!(
                "the file cannot be written ({error}), expected a folder that can be written to: choose another with --out"
            );
            Error::new(ErrorKind::File, message).in_file(self.final_folder.join(name))
        })
    }

    /// Moves the files to their folder: the whole folder at once if it is new, else file by file, all or none. Of `own_names`,
    /// files that are not written anew go.
    pub(super) fn put_in_place(self, names: &[String], own_names: &[&str]) -> Result<()> {
        let folder = self.final_folder.clone();
        let error = |message: String| Err(Error::new(ErrorKind::File, message).in_file(&folder));
        if !folder.exists() {
            return fs::rename(&self.folder, &folder)
                .or_else(|cause| error(format!("the results cannot be put in place: {cause}")));
        }
        if let Some(name) = names.iter().find(|name| folder.join(name).is_dir()) {
            let message = "found a directory, expected a file or nothing: move it away, or choose another folder with --out";
            return Err(Error::new(ErrorKind::File, message).in_file(folder.join(name)));
        }
        let is_file =
            |name: &&str| fs::symlink_metadata(folder.join(name)).is_ok_and(|found| !found.is_dir());
        let stale = own_names.iter().copied().filter(|own| !names.iter().any(|name| name == own));
        let replaced: Vec<&str> = names.iter().map(String::as_str).chain(stale).filter(is_file).collect();
        let mut placed = 0;
        let Err(cause) = self.exchange(names, &replaced, &mut placed) else { return Ok(()) };
        if self.take_back(names.get(..placed).unwrap_or_default(), &replaced).is_ok() {
            return error(format!("the results cannot be put in place ({cause}): nothing was changed"));
        }
        let old = self.folder.join(OLD);
        // Nothing may remove the old results now.
        std::mem::forget(self);
        error(format!(
            "the results cannot be put in place ({cause}): the earlier ones lie in {}",
            old.display()
        ))
    }

    /// Moves the old files aside and the new ones in, and counts these.
    fn exchange(&self, names: &[String], replaced: &[&str], placed: &mut usize) -> std::io::Result<()> {
        let old = self.folder.join(OLD);
        fs::create_dir(&old)?;
        replaced.iter().try_for_each(|name| fs::rename(self.final_folder.join(name), old.join(name)))?;
        for name in names {
            fs::rename(self.folder.join(name), self.final_folder.join(name))?;
            *placed += 1;
        }
        Ok(())
    }

    /// Undoes as much of [`Staging::exchange`] as was done: new files that arrived go, old ones return.
    fn take_back(&self, placed: &[String], replaced: &[&str]) -> std::io::Result<()> {
        let old = self.folder.join(OLD);
        for name in placed {
            fs::remove_file(self.final_folder.join(name))?;
        }
        for name in replaced.iter().filter(|name| fs::symlink_metadata(old.join(name)).is_ok()) {
            fs::rename(old.join(name), self.final_folder.join(name))?;
        }
        Ok(())
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        // After the whole folder was moved there is nothing left, and nothing to report.
        let _ = fs::remove_dir_all(&self.folder);
    }
}

/// Refuses a place where no file can be written: asked before the work begins.
///
/// # Errors
/// [`ErrorKind::File`].
pub fn check_file(path: &Path) -> Result<()> {
    if path.is_dir() {
        let message = "found a directory, expected a file to write: name the file";
        return Err(Error::new(ErrorKind::File, message).in_file(path));
    }
    check_parent(path)
}

/// Writes one file, of pieces of text that follow each other, whole or not at all: beside its place first, then moved.
///
/// # Errors
/// [`ErrorKind::File`] if it cannot be written.
pub fn write_file(path: &Path, pieces: &[impl AsRef<str>]) -> Result<()> {
    let error = |error: std::io::Error| {
        Error::new(
            ErrorKind::File,
            format!("the file cannot be written ({error}), expected a folder that can be written to: choose another"),
        )
        .in_file(path)
    };
    check_file(path)?;
    let name = path.file_name().map_or_else(|| "out".into(), |name| name.to_string_lossy().into_owned());
    let beside = parent(path).join(format!(".{name}.unfinished-{}", std::process::id()));
    let write =
        |mut file: File| pieces.iter().try_for_each(|piece| file.write_all(piece.as_ref().as_bytes()));
    File::create(&beside).and_then(write).and_then(|()| fs::rename(&beside, path)).map_err(|cause| {
        let _ = fs::remove_file(&beside);
        error(cause)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn new_folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("poecal_staging_{name}_{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir(&folder).unwrap();
        folder
    }

    fn text(text: &str) -> impl FnOnce(&mut File) -> std::io::Result<()> {
        move |file| file.write_all(text.as_bytes())
    }

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_stale_staging_folder_is_passed_over_and_left_alone() {
        let folder = new_folder("stale");
        let first = Staging::new(&folder.join("out")).unwrap();
        let second = Staging::new(&folder.join("out")).unwrap();
        assert_ne!(first.folder(), second.folder());
        second.write("a", text("1")).unwrap();
        second.put_in_place(&["a".to_owned()], &[]).unwrap();
        assert!(first.folder().is_dir());
        drop(first);
        assert_eq!(names(&folder), ["out"]);
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_folder_never_mixes_two_runs() {
        let folder = new_folder("mixed");
        let out = folder.join("out");
        fs::create_dir(&out).unwrap();
        for name in ["a", "b", "mine"] {
            fs::write(out.join(name), "old").unwrap();
        }
        let staging = Staging::new(&out).unwrap();
        staging.write("a", text("new")).unwrap();
        staging.put_in_place(&["a".to_owned()], &["a", "b", "c"]).unwrap();
        assert_eq!(names(&out), ["a", "mine"]);
        assert_eq!(fs::read_to_string(out.join("a")).unwrap(), "new");
        assert_eq!(names(&folder), ["out"]);
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn what_cannot_be_put_in_place_changes_nothing() {
        let folder = new_folder("kept");
        let out = folder.join("out");
        fs::create_dir_all(out.join("b")).unwrap();
        fs::write(out.join("a"), "old").unwrap();
        let both = ["a".to_owned(), "b".to_owned()];
        let staging = Staging::new(&out).unwrap();
        staging.write("a", text("new")).unwrap();
        staging.write("b", text("new")).unwrap();
        let error = staging.put_in_place(&both, &[]).unwrap_err();
        assert_eq!(error.place().unwrap().path, out.join("b"));
        // A file that vanished fails while files are moved.
        fs::remove_dir(out.join("b")).unwrap();
        fs::write(out.join("stale"), "old").unwrap();
        let staging = Staging::new(&out).unwrap();
        staging.write("a", text("new")).unwrap();
        let error = staging.put_in_place(&both, &["stale"]).unwrap_err();
        assert!(!error.to_string().contains("unfinished"), "{error}");
        assert_eq!(names(&out), ["a", "stale"]);
        assert_eq!(fs::read_to_string(out.join("a")).unwrap(), "old");
        assert_eq!(names(&folder), ["out"]);
        fs::remove_dir_all(&folder).unwrap();
    }
}
