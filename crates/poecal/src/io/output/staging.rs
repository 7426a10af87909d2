//! Staging folders: where files are written and proven before they go to their place.
//!
//! A staging folder holds `lock`, which its run has locked, `new` with the new files, and while files are exchanged `old` with those
//! that they replace and a journal. One that nobody has locked is what an interrupted run left.

use std::ffi::{OsStr, OsString};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{NewFile, interrupted};
use crate::io::disk::{Disk, Found, FoundKind, Lock, Output};

/// The folder of new files in a staging folder.
pub(super) const NEW: &str = "new";
/// The folder of the files that are replaced.
pub(super) const OLD: &str = "old";
const LOCK: &str = "lock";
/// The journal of an exchange.
pub(super) const JOURNAL: &str = "journal";
/// The name under which it is written.
pub(super) const UNFINISHED_JOURNAL: &str = "journal.unfinished";
/// The name of the journal that takes its place where the exchange fails: it lies ready, since a full disk may be what fails.
pub(super) const JOURNAL_BACK: &str = "journal.back";
const JOURNALS: [&str; 3] = [UNFINISHED_JOURNAL, JOURNAL, JOURNAL_BACK];
/// What the name of a staging folder has before the numbers of its process and of itself.
const UNFINISHED: &str = ".poecal-unfinished-";
/// Names that are taken which are passed over.
const ATTEMPTS: usize = 1000;

/// A staging folder of this run, removed when dropped.
pub(super) struct Staging {
    pub(super) disk: Arc<dyn Disk>,
    pub(super) folder: PathBuf,
    /// None where the system has no locks.
    _lock: Option<Lock>,
    /// What is written and not yet synced.
    unsynced: Vec<Box<dyn Output>>,
    /// Whether an exchange is left to the next run.
    pub(super) abandoned: bool,
}

/// What the names of a place's staging folders begin with: inside the place if that is a folder, or beside it.
pub(super) fn prefix(beside: Option<&OsStr>) -> OsString {
    let mut prefix = OsString::new();
    if let Some(name) = beside {
        prefix.push(".");
        prefix.push(name);
    }
    prefix.push(UNFINISHED);
    prefix
}

impl Staging {
    /// Makes one in a folder, whose name begins with `prefix`.
    pub(super) fn new(disk: &Arc<dyn Disk>, parent: &Path, prefix: &OsStr) -> io::Result<Self> {
        // Otherwise a signal could come when the folder is made and not yet known.
        let _undisturbed = interrupted::undisturbed();
        Staging::make(disk, parent, prefix)
    }

    /// [`Staging::new`] for who holds [`interrupted::undisturbed`].
    pub(super) fn make(disk: &Arc<dyn Disk>, parent: &Path, prefix: &OsStr) -> io::Result<Self> {
        for attempt in 0..ATTEMPTS {
            let mut name = prefix.to_owned();
            name.push(format!("{}-{attempt}", std::process::id()));
            let folder = parent.join(name);
            match disk.create_folder(&folder) {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
                made => made?,
            }
            interrupted::begun(&folder);
            let lock = match disk.lock(&folder.join(LOCK)) {
                Ok(Some(lock)) => Some(lock),
                // A run that looks for what others left was faster.
                Ok(None) => {
                    interrupted::ended(&folder);
                    continue;
                }
                Err(error) if error.kind() == io::ErrorKind::NotFound => {
                    interrupted::ended(&folder);
                    continue;
                }
                Err(error) if error.kind() == io::ErrorKind::Unsupported => None,
                Err(error) => {
                    discard(disk.as_ref(), &folder);
                    return Err(error);
                }
            };
            let mut staging = Staging {
                disk: Arc::clone(disk),
                folder,
                _lock: lock,
                unsynced: Vec::new(),
                abandoned: false,
            };
            match staging.disk.create_folder(&staging.new_files()) {
                // A run that looks for what others left was faster.
                Err(error) if error.kind() == io::ErrorKind::NotFound => staging.abandoned = true,
                made => return made.map(|()| staging),
            }
        }
        Err(io::ErrorKind::AlreadyExists.into())
    }

    pub(super) fn new_files(&self) -> PathBuf {
        self.folder.join(NEW)
    }

    pub(super) fn old_files(&self) -> PathBuf {
        self.folder.join(OLD)
    }

    /// Writes one of the new files.
    pub(super) fn write(&mut self, file: &NewFile) -> io::Result<()> {
        let mut out = self.disk.create(&self.new_files().join(&file.name))?;
        file.write_to(&mut out)?;
        out.flush()?;
        self.unsynced.push(out);
        Ok(())
    }

    /// Waits until all new files are on the disk.
    pub(super) fn sync(&mut self) -> io::Result<()> {
        self.unsynced.drain(..).try_for_each(|mut file| file.sync())?;
        self.disk.sync_folder(&self.new_files())
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        self.unsynced.clear();
        if self.abandoned {
            interrupted::ended(&self.folder);
        } else {
            discard(self.disk.as_ref(), &self.folder);
        }
    }
}

/// Removes a staging folder of this run as far as that is possible: what stays, the next run removes.
fn discard(disk: &dyn Disk, folder: &Path) {
    let _ = remove(disk, folder);
    interrupted::ended(folder);
}

/// Removes a staging folder with the new and old files in it. If there is anything else, it stays, with an error.
pub(super) fn remove(disk: &dyn Disk, folder: &Path) -> io::Result<()> {
    // The journal first, and for good: without its files it would tell the next run half of what there was to do.
    let mut had_one = false;
    for name in JOURNALS {
        match disk.remove_file(&folder.join(name)) {
            Ok(()) => had_one = true,
            removed => gone(removed)?,
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
        gone(disk.remove_folder(&half))?;
    }
    gone(disk.remove_file(&folder.join(LOCK)))?;
    gone(disk.remove_folder(folder))
}

/// Gives a file a second name, or a copy where there are no second names.
pub(super) fn keep(disk: &dyn Disk, from: &Path, to: &Path) -> io::Result<()> {
    if disk.link(from, to).is_ok() {
        return Ok(());
    }
    let mut copy = disk.create(to)?;
    io::copy(&mut disk.open(from)?, &mut copy)?;
    copy.flush()?;
    copy.sync()
}

/// What is at a path, if anything is.
pub(super) fn there(disk: &dyn Disk, path: &Path) -> io::Result<Option<Found>> {
    match disk.look(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        found => found.map(Some),
    }
}

/// Something that is to be gone, and is if it never was.
pub(super) fn gone(removed: io::Result<()>) -> io::Result<()> {
    match removed {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        done => done,
    }
}

/// Names in a folder; none if there is no such folder.
pub(super) fn names(disk: &dyn Disk, folder: &Path) -> io::Result<Vec<OsString>> {
    match disk.names(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        names => names,
    }
}

/// Whether a name is that of a staging folder with this prefix.
pub(super) fn is_staging(name: &OsStr, prefix: &OsStr) -> bool {
    let rest = name.as_encoded_bytes().strip_prefix(prefix.as_encoded_bytes());
    rest.is_some_and(|rest| {
        !rest.is_empty() && rest.iter().all(|byte| byte.is_ascii_digit() || *byte == b'-')
    })
}

/// Whether a staging folder and what belongs into it are what they seem, and this user's: whoever can write beside a place could
/// have put links there that lead elsewhere.
fn is_real(disk: &dyn Disk, folder: &Path) -> bool {
    let is = |path: &Path, kind: FoundKind| {
        there(disk, path).is_ok_and(|found| found.is_none_or(|found| found.kind == kind && found.is_mine))
    };
    is(folder, FoundKind::Folder)
        && [NEW, OLD].into_iter().all(|half| is(&folder.join(half), FoundKind::Folder))
        && JOURNALS.into_iter().chain([LOCK]).all(|name| is(&folder.join(name), FoundKind::File))
}

/// Staging folders in a folder that nobody has locked, each with its lock, now ours.
pub(super) fn left(disk: &dyn Disk, parent: &Path, prefix: &OsStr) -> io::Result<Vec<(PathBuf, Lock)>> {
    let mut left = Vec::new();
    for name in names(disk, parent)? {
        let folder = parent.join(&name);
        let is_left = is_staging(&name, prefix) && is_real(disk, &folder);
        // Where there are no locks, nobody can tell whether a run is still at work.
        if is_left && let Ok(Some(lock)) = disk.lock(&folder.join(LOCK)) {
            left.push((folder, lock));
        }
    }
    Ok(left)
}
