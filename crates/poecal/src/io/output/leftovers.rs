//! What interrupted runs left: exchanges are completed, the rest is removed, and both are said.

use std::ffi::OsStr;
use std::io;
use std::path::{Path, PathBuf};

use super::contents::Contents;
use super::journal::Journal;
use super::{interrupted, staging};
use crate::io::disk::{Disk, FoundKind, Lock, SystemDisk};

/// Another thread may be writing into a folder while it is removed.
const ATTEMPTS: usize = 100;

/// Settles what lies at a place without links, beside it and inside if it is a folder. Says what was done, a sentence each.
pub(super) fn settle(disk: &dyn Disk, place: &Path, say: &mut dyn FnMut(String)) {
    let is_folder = disk.look(place).is_ok_and(|found| found.kind == FoundKind::Folder);
    // What lies beside it may have to go inside first.
    if let (Some(parent), Some(name)) = (place.parent(), place.file_name()) {
        for (folder, lock) in left(disk, parent, &staging::prefix(Some(name))) {
            let target = is_folder.then_some(place);
            say(told(&folder, place, settle_beside(disk, &folder, target).map(|()| false)));
            drop(lock);
        }
    }
    // Nobody puts files in place meanwhile.
    if is_folder
        && !left(disk, place, &staging::prefix(None)).is_empty()
        && let Ok(_locked) = disk.lock_folder(place)
    {
        settle_inside(disk, place, say);
    }
}

/// Settles what lies inside a folder that is locked.
pub(super) fn settle_inside(disk: &dyn Disk, place: &Path, say: &mut dyn FnMut(String)) {
    for (folder, _lock) in left(disk, place, &staging::prefix(None)) {
        say(told(&folder, place, settle_one(disk, &folder, place)));
    }
}

/// A folder that cannot be listed cannot be written to either, which is then said.
fn left(disk: &dyn Disk, parent: &Path, prefix: &OsStr) -> Vec<(PathBuf, Lock)> {
    staging::left(disk, parent, prefix).unwrap_or_default()
}

fn told(staging: &Path, place: &Path, settled: io::Result<bool>) -> String {
    match settled {
        Ok(true) => {
            format!(
                "{}: an interrupted run had not put all of its files in place: completed",
                place.display()
            )
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

/// Settles what lies beside a place; `target` is the folder there, which may have been exchanged, if there is one.
fn settle_beside(disk: &dyn Disk, staging: &Path, target: Option<&Path>) -> io::Result<()> {
    if let Some(target) = target {
        give_back(disk, &staging.join(staging::NEW), target, &Contents::is_of_any)?;
    }
    staging::remove(disk, staging)
}

/// Settles what lies inside a folder; whether there was something to complete.
fn settle_one(disk: &dyn Disk, staging: &Path, target: &Path) -> io::Result<bool> {
    let journal = Journal::kept(disk, staging)?;
    if let Some(journal) = &journal {
        journal.carry_out(disk, staging, target, true)?;
        disk.sync_folder(target)?;
    }
    staging::remove(disk, staging)?;
    Ok(journal.is_some())
}

/// Removes a folder that has been exchanged for `target`, or was to be: own files go, all else moves to the target.
pub(super) fn give_back(
    disk: &dyn Disk,
    folder: &Path,
    target: &Path,
    is_own: &dyn Fn(&str) -> bool,
) -> io::Result<()> {
    let names = staging::names(disk, folder)?;
    for name in &names {
        let path = folder.join(name);
        match disk.look(&path)?.kind {
            FoundKind::File if name.to_str().is_some_and(is_own) => disk.remove_file(&path)?,
            FoundKind::File | FoundKind::Folder | FoundKind::Link | FoundKind::Other => {
                disk.rename_new(&path, &target.join(name))?
            }
        }
    }
    staging::gone(disk.remove_folder(folder))
}

/// Removes what runs of this process have written and not yet put in place. Results that are being put in place are waited for, and
/// none are afterwards: for a program that was asked to end, and ends then.
pub fn clean_up() {
    for folder in interrupted::at_last() {
        for _ in 0..ATTEMPTS {
            if staging::remove(&SystemDisk, &folder).is_ok() {
                break;
            }
        }
    }
}
