//! What interrupted runs left: exchanges are completed, the rest is removed, and both are said.

use std::ffi::OsStr;
use std::io;
use std::path::Path;

use super::journal::Journal;
use super::place::Contents;
use super::staging;
use crate::io::disk::{Disk, FoundKind};

/// Settles what lies at a place without links, beside it and inside if it is a folder. Says what was done, a sentence each.
pub(super) fn settle(disk: &dyn Disk, place: &Path, say: &mut dyn FnMut(String)) {
    let is_folder = disk.look(place).is_ok_and(|found| found.kind == FoundKind::Folder);
    let target = is_folder.then_some(place);
    // What lies beside it may have to go inside first.
    if let (Some(parent), Some(name)) = (place.parent(), place.file_name()) {
        settle_in(disk, parent, &staging::prefix(Some(name)), target, say);
    }
    if is_folder {
        settle_in(disk, place, &staging::prefix(None), target, say);
    }
}

fn settle_in(
    disk: &dyn Disk,
    parent: &Path,
    prefix: &OsStr,
    target: Option<&Path>,
    say: &mut dyn FnMut(String),
) {
    // A folder that cannot be listed cannot be written to either, which is then said.
    for (folder, _lock) in staging::left(disk, parent, prefix).unwrap_or_default() {
        say(match settle_one(disk, &folder, target) {
            Ok(Settled::Completed(target)) => {
                format!(
                    "{}: an interrupted run had not put all of its files in place: completed",
                    target.display()
                )
            }
            Ok(Settled::Removed) => format!("{}: removed what an interrupted run left", folder.display()),
            Err(error) => unsettled(&folder, &error),
        });
    }
}

fn unsettled(staging: &Path, error: &io::Error) -> String {
    format!(
        "{}: an interrupted run left this, and it cannot be settled ({error}): look into it",
        staging.display()
    )
}

enum Settled<'a> {
    Completed(&'a Path),
    Removed,
}

/// `target` is the folder that the files are for, if there is one.
fn settle_one<'a>(disk: &dyn Disk, staging: &Path, target: Option<&'a Path>) -> io::Result<Settled<'a>> {
    let Some(target) = target else { return staging::remove(disk, staging).map(|()| Settled::Removed) };
    let settled = if let Some(journal) = Journal::kept(disk, staging)? {
        journal.carry_out(disk, staging, target)?;
        disk.sync_folder(target)?;
        Settled::Completed(target)
    } else {
        // Whatever it was that the run wrote.
        give_back(disk, &staging.join(staging::NEW), target, &Contents::is_of_any)?;
        Settled::Removed
    };
    staging::remove(disk, staging)?;
    Ok(settled)
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
            _ => disk.rename_new(&path, &target.join(name))?,
        }
    }
    match disk.remove_folder(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        removed => removed,
    }
}
