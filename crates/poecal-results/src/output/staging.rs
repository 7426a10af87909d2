//! Staging folders: files are written and verified there before they are put in place.
//!
//! A staging folder holds `lock`, which its run has locked, `new` with the new files, and during an exchange `old` with the replaced files
//! and a journal. Without a locked `lock` it remains from an interrupted run.

use std::ffi::{OsStr, OsString};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{NewFile, interruption};
use poecal_storage::disk::{Disk, DiskObject, Lock, ObjectKind, Output};

/// Folder of new files in a staging folder.
pub(crate) const NEW: &str = "new";
/// Folder of replaced files.
pub(crate) const OLD: &str = "old";
const LOCK: &str = "lock";
/// Journal of an exchange.
pub(crate) const JOURNAL: &str = "journal";
/// Temporary name of the journal.
pub(crate) const UNFINISHED_JOURNAL: &str = "journal.unfinished";
/// Journal that undoes the exchange, written in advance since the disk may become full.
pub(crate) const JOURNAL_BACK: &str = "journal.back";
const JOURNALS: [&str; 3] = [UNFINISHED_JOURNAL, JOURNAL, JOURNAL_BACK];
/// Prefix of a staging folder's name, before its process and own number.
const UNFINISHED: &str = ".poecal-unfinished-";
/// Most attempts to find a free name.
const ATTEMPTS: usize = 1000;

/// A staging folder of this run, removed when dropped.
pub(crate) struct Staging {
    pub(crate) disk: Arc<dyn Disk>,
    pub(crate) folder: PathBuf,
    /// `None` if the system has no locks.
    _lock: Option<Lock>,
    /// Written and not yet synced files.
    unsynced: Vec<Box<dyn Output>>,
    /// True if the next run has to complete an exchange.
    pub(crate) abandoned: bool,
}

/// Prefix of the names of a place's staging folders: inside a folder, or beside a file.
pub(crate) fn prefix(beside: Option<&OsStr>) -> OsString {
    let mut prefix = OsString::new();
    if let Some(name) = beside {
        prefix.push(".");
        prefix.push(name);
    }
    prefix.push(UNFINISHED);
    prefix
}

/// Number of this process; 0 on systems without processes, whose disk has one user.
fn process() -> u32 {
    if cfg!(target_family = "wasm") { 0 } else { std::process::id() }
}

impl Staging {
    /// Creates a staging folder in a folder, with a name that begins with `prefix`.
    pub(crate) fn new(disk: &Arc<dyn Disk>, parent: &Path, prefix: &OsStr) -> io::Result<Self> {
        // No signal may come between its creation and its registration.
        let _undisturbed = interruption::hold_clean_up();
        Staging::make(disk, parent, prefix)
    }

    /// [`Staging::new`] for a holder of [`interruption::hold_clean_up`].
    pub(crate) fn make(disk: &Arc<dyn Disk>, parent: &Path, prefix: &OsStr) -> io::Result<Self> {
        for attempt in 0..ATTEMPTS {
            let mut name = prefix.to_owned();
            name.push(format!("{}-{attempt}", process()));
            let folder = parent.join(name);
            match disk.create_folder(&folder) {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
                made => made?,
            }
            interruption::note_begin(&folder);
            let lock = match disk.lock(&folder.join(LOCK)) {
                Ok(Some(lock)) => Some(lock),
                // Another run has already removed it as a remainder.
                Ok(None) => {
                    interruption::note_end(&folder);
                    continue;
                }
                Err(error) if error.kind() == io::ErrorKind::NotFound => {
                    interruption::note_end(&folder);
                    continue;
                }
                Err(error) if error.kind() == io::ErrorKind::Unsupported => None,
                Err(error) => {
                    discard(disk.as_ref(), &folder);
                    return Err(error);
                }
            };
            let mut staging =
                Staging { disk: Arc::clone(disk), folder, _lock: lock, unsynced: Vec::new(), abandoned: false };
            match staging.disk.create_folder(&staging.new_files()) {
                // Another run has already removed it as a remainder.
                Err(error) if error.kind() == io::ErrorKind::NotFound => staging.abandoned = true,
                made => return made.map(|()| staging),
            }
        }
        Err(io::ErrorKind::AlreadyExists.into())
    }

    pub(crate) fn new_files(&self) -> PathBuf {
        self.folder.join(NEW)
    }

    pub(crate) fn old_files(&self) -> PathBuf {
        self.folder.join(OLD)
    }

    /// Writes one of the new files.
    pub(crate) fn write(&mut self, file: &NewFile) -> io::Result<()> {
        let mut out = self.disk.create(&self.new_files().join(&file.name))?;
        file.write_to(&mut out)?;
        out.flush()?;
        self.unsynced.push(out);
        Ok(())
    }

    /// Opens one of the new files, to be written and then kept.
    pub(crate) fn create(&mut self, name: &str) -> io::Result<Box<dyn Output>> {
        self.disk.create(&self.new_files().join(name))
    }

    /// Keeps a file that was written.
    pub(crate) fn keep(&mut self, mut out: Box<dyn Output>) -> io::Result<()> {
        out.flush()?;
        self.unsynced.push(out);
        Ok(())
    }

    /// Syncs all new files.
    pub(crate) fn sync(&mut self) -> io::Result<()> {
        self.unsynced.drain(..).try_for_each(|mut file| file.sync())?;
        self.disk.sync_folder(&self.new_files())
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        self.unsynced.clear();
        if self.abandoned {
            interruption::note_end(&self.folder);
        } else {
            discard(self.disk.as_ref(), &self.folder);
        }
    }
}

/// Removes a staging folder of this run as far as possible; the next run removes the rest.
fn discard(disk: &dyn Disk, folder: &Path) {
    let _ = remove(disk, folder);
    interruption::note_end(folder);
}

/// Removes a staging folder with its new and old files. If it holds anything else, it stays, with an error.
pub(crate) fn remove(disk: &dyn Disk, folder: &Path) -> io::Result<()> {
    // The journal first, and synced: without its files it would be executed in part by the next run.
    let mut had_one = false;
    for name in JOURNALS {
        match disk.remove_file(&folder.join(name)) {
            Ok(()) => had_one = true,
            removed => ignore_missing(removed)?,
        }
    }
    if had_one {
        disk.sync_folder(folder)?;
    }
    for half in [NEW, OLD] {
        let half = folder.join(half);
        for name in names(disk, &half)? {
            disk.remove_file(&half.join(name))?;
        }
        ignore_missing(disk.remove_folder(&half))?;
    }
    ignore_missing(disk.remove_file(&folder.join(LOCK)))?;
    ignore_missing(disk.remove_folder(folder))
}

/// Creates a second name of a file, or a copy if there are no hard links.
pub(crate) fn keep(disk: &dyn Disk, from: &Path, to: &Path) -> io::Result<()> {
    if disk.link(from, to).is_ok() {
        return Ok(());
    }
    let mut copy = disk.create(to)?;
    io::copy(&mut disk.open(from)?, &mut copy)?;
    copy.flush()?;
    copy.sync()
}

/// The object at a path, if there is one.
pub(crate) fn find_object(disk: &dyn Disk, path: &Path) -> io::Result<Option<DiskObject>> {
    match disk.look(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        found => found.map(Some),
    }
}

/// Ignores the error of removing an object that does not exist.
pub(crate) fn ignore_missing(removed: io::Result<()>) -> io::Result<()> {
    match removed {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        done => done,
    }
}

/// Names in a folder; empty if there is no such folder.
pub(crate) fn names(disk: &dyn Disk, folder: &Path) -> io::Result<Vec<OsString>> {
    match disk.names(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        names => names,
    }
}

/// True if a name is that of a staging folder with this prefix.
pub(crate) fn is_staging(name: &OsStr, prefix: &OsStr) -> bool {
    let rest = name.as_encoded_bytes().strip_prefix(prefix.as_encoded_bytes());
    rest.is_some_and(|rest| !rest.is_empty() && rest.iter().all(|byte| byte.is_ascii_digit() || *byte == b'-'))
}

/// True if a staging folder and its contents are as expected and this user's: others with access to the parent folder could have put links there.
fn is_real(disk: &dyn Disk, folder: &Path) -> bool {
    let is = |path: &Path, kind: ObjectKind| {
        find_object(disk, path).is_ok_and(|found| found.is_none_or(|found| found.kind == kind && found.is_mine))
    };
    is(folder, ObjectKind::Folder)
        && [NEW, OLD].into_iter().all(|half| is(&folder.join(half), ObjectKind::Folder))
        && JOURNALS.into_iter().chain([LOCK]).all(|name| is(&folder.join(name), ObjectKind::File))
}

/// Unlocked staging folders in a folder, each with its lock, which this run then holds.
pub(crate) fn find_leftovers(disk: &dyn Disk, parent: &Path, prefix: &OsStr) -> io::Result<Vec<(PathBuf, Lock)>> {
    let mut left = Vec::new();
    for name in names(disk, parent)? {
        let folder = parent.join(&name);
        let is_left = is_staging(&name, prefix) && is_real(disk, &folder);
        // Without locks, it is unknown whether a run is still active.
        if is_left && let Ok(Some(lock)) = disk.lock(&folder.join(LOCK)) {
            left.push((folder, lock));
        }
    }
    Ok(left)
}
