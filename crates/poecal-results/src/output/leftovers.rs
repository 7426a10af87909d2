//! Remains of interrupted runs: exchanges are completed, other files removed, with messages.

use std::ffi::OsStr;
use std::io;
use std::path::{Path, PathBuf};

use super::contents::Contents;
use super::journal::Journal;
use super::{interruption, staging};
use poecal_storage::disk::{Disk, Lock, ObjectKind, SystemDisk};
use poecal_storage::write_locks;

/// Attempts to remove a folder that another thread may be writing into.
const ATTEMPTS: usize = 100;

/// Settles remains at a path without links: beside it, and inside if it is a folder. Returns messages.
pub(crate) fn settle(disk: &dyn Disk, place: &Path, say: &mut dyn FnMut(String)) {
    let is_folder = disk.look(place).is_ok_and(|found| found.kind == ObjectKind::Folder);
    // Remains beside a folder may belong inside.
    if let (Some(parent), Some(name)) = (place.parent(), place.file_name()) {
        for (folder, lock) in find_leftovers(disk, parent, &staging::prefix(Some(name))) {
            let target = is_folder.then_some(place);
            say(describe_leftover(&folder, place, settle_beside(disk, &folder, target).map(|()| false)));
            drop(lock);
        }
    }
    // Locked, so that no other run puts files in place meanwhile.
    if is_folder
        && !find_leftovers(disk, place, &staging::prefix(None)).is_empty()
        && let Ok(_locked) = disk.lock_folder(place)
    {
        settle_inside(disk, place, say);
    }
}

/// Settles remains inside a locked folder.
pub(crate) fn settle_inside(disk: &dyn Disk, place: &Path, say: &mut dyn FnMut(String)) {
    for (folder, _lock) in find_leftovers(disk, place, &staging::prefix(None)) {
        say(describe_leftover(&folder, place, settle_one(disk, &folder, place)));
    }
}

/// Staging folders in a folder. A folder that cannot be listed cannot be written to either, which is reported then.
fn find_leftovers(disk: &dyn Disk, parent: &Path, prefix: &OsStr) -> Vec<(PathBuf, Lock)> {
    staging::find_leftovers(disk, parent, prefix).unwrap_or_default()
}

fn describe_leftover(staging: &Path, place: &Path, settled: io::Result<bool>) -> String {
    match settled {
        Ok(true) => {
            format!("{}: an interrupted run had not put all of its files in place: completed", place.display())
        }
        Ok(false) => format!("{}: removed what an interrupted run left", staging.display()),
        Err(error) => {
            format!(
                "{}: an interrupted run left this, and it cannot be settled ({error}): look into it",
                staging.display()
            )
        }
    }
}

/// Settles remains beside a path; `target` is the folder there, if there is one, which may have been exchanged.
fn settle_beside(disk: &dyn Disk, staging: &Path, target: Option<&Path>) -> io::Result<()> {
    if let Some(target) = target {
        give_back(disk, &staging.join(staging::NEW), target, &Contents::is_of_any)?;
    }
    staging::remove(disk, staging)
}

/// Settles remains inside a folder; true if an exchange was completed.
fn settle_one(disk: &dyn Disk, staging: &Path, target: &Path) -> io::Result<bool> {
    let journal = Journal::find_kept(disk, staging)?;
    if let Some(journal) = &journal {
        journal.carry_out(disk, staging, target, true)?;
        disk.sync_folder(target)?;
    }
    staging::remove(disk, staging)?;
    Ok(journal.is_some())
}

/// Removes a folder that was, or was to be, exchanged for `target`: files of poecal are removed, others moved to the target.
pub(crate) fn give_back(
    disk: &dyn Disk,
    folder: &Path,
    target: &Path,
    is_own: &dyn Fn(&str) -> bool,
) -> io::Result<()> {
    let names = staging::names(disk, folder)?;
    for name in &names {
        let path = folder.join(name);
        match disk.look(&path)?.kind {
            ObjectKind::File if name.to_str().is_some_and(is_own) => disk.remove_file(&path)?,
            ObjectKind::File | ObjectKind::Folder | ObjectKind::Link | ObjectKind::Other => {
                disk.rename_new(&path, &target.join(name))?
            }
        }
    }
    staging::ignore_missing(disk.remove_folder(folder))
}

/// Removes staged files of this process after waiting for those being put in place, and blocks further ones: for a program that is about to
/// end.
pub fn clean_up() {
    for folder in interruption::at_last() {
        for _ in 0..ATTEMPTS {
            if staging::remove(&SystemDisk, &folder).is_ok() {
                break;
            }
        }
    }
    write_locks::give_back_all();
}
