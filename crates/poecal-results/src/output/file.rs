//! Output to one file, complete or not at all, or to a stream.

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use super::existing::{
    ExistingFiles, GENERATOR, find_object, is_of_poecal, led_to, new_place, path_error, refuse_input,
};
use super::staging::{self, Staging};
use super::{NewFile, PagePieces, interruption, leftovers};
use poecal_numerics::error::{Error, Result};
use poecal_storage::disk::{self, Disk, ObjectKind};
use poecal_storage::document;

/// Name of the file in its staging folder.
const NAME: &str = "file";

/// True if a path is a stream of this process.
fn is_stream(path: &Path) -> bool {
    let number = |path: &str| {
        let number = path.strip_prefix("/dev/fd/").or_else(|| path.strip_prefix("/proc/self/fd/"))?;
        Some(!number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit()))
    };
    path.to_str().is_some_and(|path| ["/dev/stdout", "/dev/stderr"].contains(&path) || number(path).unwrap_or(false))
}

/// A reserved place for a file. Nothing has changed yet.
pub struct ReservedFile {
    /// Path as stated by the user.
    named: PathBuf,
    way: WriteMethod,
}

enum WriteMethod {
    /// A stream.
    Stream(PathBuf),
    /// A file, written beside its place and then moved there.
    Staged { path: PathBuf, existing: ExistingFiles, replaces: bool, staging: Staging },
}

impl std::fmt::Debug for ReservedFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("FilePlace").field("named", &self.named).finish_non_exhaustive()
    }
}

/// A replaced file that can still be restored.
pub(crate) struct ReplacedFile(Option<(PathBuf, bool, Staging)>);

impl ReservedFile {
    /// Checks that a file may be written, and makes room for it beside its place. Devices and pipes are written directly; links are
    /// followed. Remains of an interrupted run are removed first, with a message. `inputs` are files of this run, which are never replaced.
    ///
    /// # Errors
    /// [`ErrorKind::File`](poecal_numerics::error::ErrorKind::File) if `existing` does not allow replacement, if it is an input or a folder, or if
    /// nothing can be written there.
    pub fn reserve(
        path: &Path,
        existing: ExistingFiles,
        inputs: &[&Path],
        say: &mut dyn FnMut(String),
    ) -> Result<Self> {
        let disk = disk::current_disk();
        let named = path.to_owned();
        if is_stream(path) {
            return Ok(ReservedFile { named, way: WriteMethod::Stream(path.to_owned()) });
        }
        let there = match find_object(disk.as_ref(), path)? {
            Some(found) if found.kind == ObjectKind::Link => Some(led_to(disk.as_ref(), path)?),
            Some(found) => Some((path.to_owned(), found)),
            None => None,
        };
        let at = there.as_ref().map_or(path, |(actual, _)| actual);
        match there.as_ref().map(|(_, found)| found.kind) {
            Some(ObjectKind::Folder) => {
                return Err(path_error(path, "found a directory, expected a file to write: name the file"));
            }
            Some(ObjectKind::Other | ObjectKind::Link) => {
                return Ok(ReservedFile { named, way: WriteMethod::Stream(at.to_owned()) });
            }
            Some(ObjectKind::File) | None => {}
        }
        let (parent, place) = new_place(disk.as_ref(), at)?;
        leftovers::settle(disk.as_ref(), &place, say);
        let replaces = there.is_some();
        if replaces {
            refuse_input(disk.as_ref(), path, inputs)?;
            if !may_go(disk.as_ref(), at, existing) {
                return Err(path_error(path, IN_THE_WAY));
            }
        }
        let prefix = staging::prefix(place.file_name());
        let staging = Staging::new(&disk, &parent, &prefix).map_err(|error| unwritable_error(path, &error))?;
        Ok(ReservedFile { named, way: WriteMethod::Staged { path: place, existing, replaces, staging } })
    }

    /// Writes the file from consecutive pieces.
    ///
    /// # Errors
    /// [`ErrorKind::File`](poecal_numerics::error::ErrorKind::File) if it cannot be written; then nothing has changed.
    pub fn write(mut self, page: PagePieces) -> Result<()> {
        self.stage(page)?;
        let _undisturbed = interruption::hold_clean_up();
        self.put().map(ReplacedFile::finish)
    }

    /// Writes the file from the pieces that `make` passes on, so that it is never held whole.
    ///
    /// # Errors
    /// Those of `make`, and [`ErrorKind::File`](poecal_numerics::error::ErrorKind::File) if the file cannot be written; then nothing has changed,
    /// except for the pieces that a stream has received.
    pub fn write_by<T>(self, make: impl FnOnce(&mut dyn FnMut(&str) -> Result<()>) -> Result<T>) -> Result<T> {
        self.write_pieces(|out| make(&mut |piece| out(piece.as_bytes())))
    }

    /// Writes the file from bytes, which need not be text of a known encoding.
    ///
    /// # Errors
    /// As [`ReservedFile::write`].
    pub fn write_bytes(self, bytes: &[u8]) -> Result<()> {
        self.write_pieces(|out| out(bytes))
    }

    fn write_pieces<T>(mut self, make: impl FnOnce(&mut dyn FnMut(&[u8]) -> Result<()>) -> Result<T>) -> Result<T> {
        let named = self.named.clone();
        let failed = |error: &io::Error| unwritable_error(&named, error);
        let made = match &mut self.way {
            WriteMethod::Stream(path) => {
                let mut out = disk::current_disk().stream(path).map_err(|error| failed(&error))?;
                let made = make(&mut |piece| match out.write_all(piece) {
                    // A closed pipe is no error.
                    Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
                    written => written.map_err(|error| failed(&error)),
                })?;
                out.sync().map_err(|error| failed(&error))?;
                made
            }
            WriteMethod::Staged { staging, .. } => {
                let mut out = staging.create(NAME).map_err(|error| failed(&error))?;
                let made = make(&mut |piece| out.write_all(piece).map_err(|error| failed(&error)))?;
                staging.keep(out).and_then(|()| staging.sync()).map_err(|error| failed(&error))?;
                made
            }
        };
        let _undisturbed = interruption::hold_clean_up();
        self.put().map(ReplacedFile::finish)?;
        Ok(made)
    }

    /// Writes the new text beside its place, or to the stream.
    pub(crate) fn stage(&mut self, page: PagePieces) -> Result<()> {
        let staged = match &mut self.way {
            WriteMethod::Stream(path) => disk::current_disk().stream(path).and_then(|mut out| {
                let written = page.iter().try_for_each(|piece| out.write_all(piece.as_bytes()));
                match written.and_then(|()| out.sync()) {
                    // A closed pipe is no error.
                    Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
                    written => written,
                }
            }),
            WriteMethod::Staged { staging, .. } => {
                staging.write(&NewFile::of_page(NAME, page)).and_then(|()| staging.sync())
            }
        };
        staged.map_err(|error| unwritable_error(&self.named, &error))
    }

    /// Puts the new text in place.
    pub(crate) fn put(self) -> Result<ReplacedFile> {
        let WriteMethod::Staged { path, existing, replaces, staging } = self.way else {
            return Ok(ReplacedFile(None));
        };
        document::forget();
        let (disk, new, old) = (staging.disk.clone(), staging.new_files().join(NAME), staging.old_files());
        let replaces = replaces && disk.look(&path).is_ok();
        if replaces && !may_go(disk.as_ref(), &path, existing) {
            return Err(path_error(&self.named, IN_THE_WAY));
        }
        let moved = if replaces {
            // A file whose owner and permissions cannot be kept gets the default ones.
            let _ = disk.copy_access(&path, &new);
            let kept = disk.create_folder(&old).and_then(|()| staging::keep(disk.as_ref(), &path, &old.join(NAME)));
            kept.and_then(|()| disk.rename(&new, &path))
        } else {
            disk.rename_new(&new, &path)
        };
        match moved {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Err(path_error(
                &self.named,
                "found this file made by another run meanwhile, expected none: nothing was changed",
            )),
            Err(error) => Err(unwritable_error(&self.named, &error)),
            Ok(()) => Ok(ReplacedFile(Some((path, replaces, staging)))),
        }
    }
}

impl ReplacedFile {
    /// Restores the earlier text; extends an error if that fails too.
    pub(crate) fn take_back(self, error: Error) -> Error {
        let Some((path, replaces, staging)) = self.0 else { return error };
        let disk = staging.disk.as_ref();
        let taken =
            if replaces { disk.rename(&staging.old_files().join(NAME), &path) } else { disk.remove_file(&path) };
        match taken {
            Ok(()) => error,
            Err(cause) => error.with_more(&format!(
                "but {} holds the new report, which could not be taken back ({cause})",
                path.display()
            )),
        }
    }

    /// Keeps the new text.
    pub(crate) fn finish(self) {
        if let Some((path, _, staging)) = self.0
            && let Some(parent) = path.parent()
        {
            // The file is in place; a sync failure changes nothing about that.
            let _ = staging.disk.sync_folder(parent);
        }
    }
}

/// Message for a file that must not be replaced.
const IN_THE_WAY: &str = "found this file, expected none: choose another, or write over this one with --force";

/// True if a file may be replaced.
fn may_go(disk: &dyn Disk, path: &Path, existing: ExistingFiles) -> bool {
    match existing {
        ExistingFiles::Kept => false,
        ExistingFiles::Own => is_of_poecal(disk, path, GENERATOR),
        ExistingFiles::Replaced => true,
    }
}

fn unwritable_error(path: &Path, error: &io::Error) -> Error {
    let message =
        format!("the file cannot be written ({error}), expected a folder that can be written to: choose another");
    path_error(path, message)
}
