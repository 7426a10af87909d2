//! Puts new files in place: the whole folder atomically where possible, otherwise file by file, with a journal that the next run completes.

use std::collections::BTreeSet;
use std::io;
use std::path::Path;

use super::existing::{ExistingFiles, path_error};
use super::journal::{Journal, JournalStep};
use super::output_folder::{ReservedFolder, check_existing, check_own, own_names};
use super::staging::{self, OLD, Staging};
use super::{NewFile, interruption, leftovers};
use poecal_numerics::error::{Error, Result};
use poecal_storage::disk::{Disk, Lock};
use poecal_storage::document;

/// Most attempts to lock a folder that others exchange.
const ATTEMPTS: usize = 1000;

impl ReservedFolder {
    /// Writes one of the new files into the staging folder.
    pub(crate) fn stage(&mut self, file: &NewFile) -> Result<()> {
        self.staging.write(file).map_err(|error| {
            path_error(
                &self.named.join(&file.name),
                format!(
                    "the file cannot be written ({error}), expected a folder that can be written to: choose another with --out"
                ),
            )
        })
    }

    /// Puts new files of these names in place, and removes other files of an earlier run. Returns messages. The caller holds
    /// [`interruption::hold_clean_up`].
    pub(crate) fn put(mut self, names: &[String]) -> Result<Vec<String>> {
        let place = self.named.clone();
        let failed = |cause: io::Error| {
            path_error(&place, format!("the results cannot be put in place ({cause}): nothing was changed"))
        };
        self.staging.sync().map_err(failed)?;
        document::forget();
        if !self.was_there {
            match self.staging.disk.rename_new(&self.staging.new_files(), &self.folder) {
                Ok(()) => return Ok(self.sync_names(self.folder.parent())),
                Err(error) if !is_taken(&error) => return Err(failed(error)),
                Err(_) => self.move_inside(failed)?,
            }
        }
        let _lock = lock(self.staging.disk.as_ref(), &self.folder).map_err(failed)?;
        // An earlier holder of the lock may have been killed during an exchange.
        let mut notes = Vec::new();
        leftovers::settle_inside(self.staging.disk.as_ref(), &self.folder, &mut |note| notes.push(note));
        let replaced = self.look_again(failed)?;
        for name in names.iter().filter(|name| replaced.contains(*name)) {
            // A file whose owner and permissions cannot be kept gets the default ones.
            let (from, to) = (self.folder.join(name), self.staging.new_files().join(name));
            let _ = self.staging.disk.copy_access(&from, &to);
        }
        let more = match self.exchange_folders().map_err(failed)? {
            Some(more) => more,
            None => self.exchange_files(names, &replaced)?,
        };
        Ok([notes, more].concat())
    }

    /// Messages after syncing a folder's names.
    fn sync_names(&self, folder: Option<&Path>) -> Vec<String> {
        let synced = folder.map_or(Ok(()), |folder| self.staging.disk.sync_folder(folder));
        let note = |error| {
            format!("{}: the results are in place, but may not last if power fails now ({error})", self.named.display())
        };
        synced.err().map(note).into_iter().collect()
    }

    /// The folder has been created meanwhile: continues from inside it, if that is allowed.
    fn move_inside(&mut self, failed: impl Fn(io::Error) -> Error) -> Result<()> {
        if self.existing == ExistingFiles::Kept {
            let message = "found the output folder made by another run meanwhile, expected it to be new: nothing was changed; choose \
                           another with --out, or overwrite its results with --force";
            return Err(path_error(&self.named, message));
        }
        let inside = Staging::make(&self.staging.disk, &self.folder, &staging::prefix(None)).map_err(&failed)?;
        let disk = &inside.disk;
        let moved = disk
            .remove_folder(&inside.new_files())
            .and_then(|()| disk.rename_new(&self.staging.new_files(), &inside.new_files()))
            .and_then(|()| disk.sync_folder(&inside.folder));
        moved.map_err(failed)?;
        self.staging = inside;
        self.was_there = true;
        Ok(())
    }

    /// Checks the contents of the locked folder. Returns the names of files to be replaced or removed.
    fn look_again(&self, failed: impl Fn(io::Error) -> Error) -> Result<BTreeSet<String>> {
        let disk = self.staging.disk.as_ref();
        let names = own_names(disk, &self.folder, self.contents).map_err(failed)?;
        check_existing(disk, &self.named, &self.folder, (self.contents, self.existing), &names)?;
        names.iter().try_for_each(|name| check_own(disk, &self.named.join(name), &[]))?;
        Ok(names.into_iter().collect())
    }

    /// Exchanges the whole folder; `None` if that is not possible. Nothing has changed then, nor after an error.
    fn exchange_folders(&mut self) -> io::Result<Option<Vec<String>>> {
        let Some(beside) = self.moved_beside() else { return Ok(None) };
        let (disk, new) = (self.staging.disk.clone(), beside.new_files());
        if disk.exchange(&new, &self.folder).is_err() {
            return disk.rename_new(&new, &self.staging.new_files()).map(|()| None);
        }
        let notes = self.sync_names(self.folder.parent());
        self.remove_earlier(beside);
        Ok(Some(notes))
    }

    /// The new files in a staging folder beside the folder, if the folder holds only files of poecal.
    fn moved_beside(&self) -> Option<Staging> {
        let disk = self.staging.disk.clone();
        let names = staging::names(disk.as_ref(), &self.folder).ok()?;
        let is_ours = |name: &std::ffi::OsString| {
            Some(name.as_os_str()) == self.staging.folder.file_name()
                || name.to_str().is_some_and(|name| self.contents.is_own(name))
        };
        // A process in this folder would find itself in a removed one.
        let is_here = disk.canonical_path(Path::new(".")).is_ok_and(|here| here.starts_with(&self.folder));
        if is_here || !names.iter().all(is_ours) {
            return None;
        }
        disk.copy_access(&self.folder, &self.staging.new_files()).ok()?;
        let parent = self.folder.parent()?;
        let beside = Staging::make(&disk, parent, &staging::prefix(self.folder.file_name())).ok()?;
        disk.remove_folder(&beside.new_files()).ok()?;
        disk.rename_new(&self.staging.new_files(), &beside.new_files()).ok()?;
        Some(beside)
    }

    /// Removes the earlier folder, which holds this run's staging folder and is now at the place of the new one.
    fn remove_earlier(&mut self, mut beside: Staging) {
        let (disk, earlier) = (self.staging.disk.clone(), beside.new_files());
        interruption::note_end(&self.staging.folder);
        if let Some(name) = self.staging.folder.file_name() {
            self.staging.folder = earlier.join(name);
        }
        self.staging.abandoned = true;
        // The next run removes the rest.
        let _ = staging::remove(disk.as_ref(), &self.staging.folder);
        let is_own = |name: &str| self.contents.is_own(name);
        beside.abandoned = leftovers::give_back(disk.as_ref(), &earlier, &self.folder, &is_own).is_err();
    }

    /// Exchanges the files one by one.
    fn exchange_files(&mut self, names: &[String], replaced: &BTreeSet<String>) -> Result<Vec<String>> {
        let (disk, staging) = (self.staging.disk.clone(), self.staging.folder.clone());
        let (disk, folder) = (disk.as_ref(), self.folder.clone());
        let error = |message: String| Err(path_error(&self.named, message));
        let put = |name: &String| {
            let step = if replaced.contains(name) { JournalStep::Put } else { JournalStep::Add };
            (step, name.clone())
        };
        let stale = replaced.iter().filter(|name| !names.contains(name));
        let stale = stale.map(|name| (JournalStep::Remove, name.clone()));
        let journal = Journal(names.iter().map(put).chain(stale).collect());
        let kept = keep_old(disk, &self.staging, &folder, replaced)
            .and_then(|()| journal.keep(disk, &staging, &journal.undo_journal(replaced)));
        if let Err(cause) = kept {
            // After an error here, the journal must not be executed.
            self.staging.abandoned = Journal::end(disk, &staging).is_err();
            return error(format!("the results cannot be put in place ({cause}): nothing was changed"));
        }
        let Err(cause) = journal.carry_out(disk, &staging, &folder, false) else {
            let notes = self.sync_names(Some(&folder));
            let _ = Journal::end(disk, &staging);
            return Ok(notes);
        };
        let returned = Journal::turn_back(disk, &staging)
            .and_then(|()| Journal::find_kept(disk, &staging))
            .and_then(|back| back.map_or(Ok(()), |back| back.carry_out(disk, &staging, &folder, false)))
            .and_then(|()| disk.sync_folder(&folder))
            .and_then(|()| Journal::end(disk, &staging));
        if returned.is_ok() {
            return error(format!("the results cannot be put in place ({cause}): nothing was changed"));
        }
        self.staging.abandoned = true;
        error(format!(
            "the results cannot be put in place ({cause}), nor can the earlier ones be put back: they lie in {}, and the next run into \
             this folder settles it",
            staging.join(OLD).display()
        ))
    }
}

/// True if something exists at a path.
fn is_taken(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::AlreadyExists | io::ErrorKind::DirectoryNotEmpty)
}

/// Locks the folder at a path; one locked before may have been exchanged meanwhile.
fn lock(disk: &dyn Disk, folder: &Path) -> io::Result<Lock> {
    for _ in 0..ATTEMPTS {
        let before = disk.look(folder)?;
        let lock = disk.lock_folder(folder)?;
        if disk.look(folder)? == before {
            return Ok(lock);
        }
    }
    Err(io::ErrorKind::ResourceBusy.into())
}

/// Keeps the files to be replaced.
fn keep_old(disk: &dyn Disk, staging: &Staging, folder: &Path, replaced: &BTreeSet<String>) -> io::Result<()> {
    let old = staging.old_files();
    disk.create_folder(&old)?;
    replaced.iter().try_for_each(|name| staging::keep(disk, &folder.join(name), &old.join(name)))?;
    disk.sync_folder(&old)
}
